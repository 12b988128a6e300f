"""Dictionaries of what was found, that show themselves."""

from __future__ import annotations

import json
from html import escape
from typing import Any


class Shown(dict[str, Any]):
    """What was found: a dictionary. `print` shows a table for people, notebooks that and the plot."""

    #: The table.
    text: str
    #: The plot, SVG.
    plot: str

    def __init__(self, shown: tuple[str, str, str], **more: Any):
        words, self.text, self.plot = shown
        super().__init__({**json.loads(words), **more})

    def __str__(self) -> str:
        return self.text

    def __repr__(self) -> str:
        return f"<voltet.Shown: {', '.join(self)}>"

    def _repr_html_(self) -> str:
        return f"{self.plot}<pre>{escape(self.text)}</pre>"
