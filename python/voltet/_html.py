"""Tables for notebooks."""

from __future__ import annotations

from collections.abc import Iterable
from html import escape


def table(title: str, rows: Iterable[tuple[object, object]], notes: Iterable[str] = ()) -> str:
    """Rows of a name and a text, and lines under them."""
    body = "".join(
        f"<tr><th style='text-align:left'>{escape(str(name))}</th>"
        f"<td style='text-align:left'>{escape(str(text))}</td></tr>"
        for name, text in rows
    )
    lines = "".join(f"<p>{escape(note)}</p>" for note in notes)
    return f"<table><caption>{escape(title)}</caption>{body}</table>{lines}"
