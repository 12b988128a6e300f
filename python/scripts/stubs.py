"""Writes voltet/nodes.pyi and voltet/widgets.pyi from the program's declarations; with --check says whether they are so.

python scripts/stubs.py [--check]
"""

from __future__ import annotations

import sys
from keyword import iskeyword
from pathlib import Path

from voltet._declared import declarations, function_name, ports, widget_kinds

FOLDER = Path(__file__).parent.parent / "voltet"
HEAD = """# Made by scripts/stubs.py from the program's declarations.
from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Any, Literal

"""


def taken(parameters: list[dict]) -> list[str]:
    """Parameters as arguments."""
    lines = []
    for parameter in parameters:
        form = parameter["form"]
        given = f"{parameter['name']}: {form}" if parameter["required"] else f"{parameter['name']}: {form} | None = None"
        if not iskeyword(parameter["name"]):
            lines.append(given)
    return lines


def function(name: str, first: list[str], named: list[str], result: str, summary: str) -> str:
    """One function with its docstring."""
    body = "".join(f"    {line},\n" for line in [*first, *(["*"] if named and not named[0].startswith("**") else []), *named])
    return f"def {function_name(name)}(\n{body}) -> {result}:\n    {docstring(summary)}\n"


def docstring(text: str) -> str:
    return '"""' + text.replace("\\", "\\\\").replace('"""', "'''") + '"""'


def exported(declared: list[dict]) -> str:
    names = ", ".join(f'"{name}"' for name in sorted(function_name(one["name"]) for one in declared))
    return f"__all__ = [{names}]\n\n"


def nodes() -> str:
    text = HEAD + "from ._node import Node\nfrom ._pipeline import Pipeline\n\n" + exported(declarations()["nodes"])
    text += "_Source = str | Node | Sequence[str | Node]\n\n"
    for node in declarations()["nodes"]:
        wires = [f"{port}: _Source | None = None" for port in ports(node["name"])]
        more = any(parameter["type"] == "name of a gradient filter" for parameter in node["parameters"])
        named = wires + taken(node["parameters"]) + (["**of_method: Any"] if more else [])
        text += function(node["name"], ["pipeline: Pipeline", "node: str", "/"], named, "Node", node["summary"])
    return text


def widgets() -> str:
    text = HEAD + exported(widget_kinds())
    for kind in widget_kinds():
        text += function(kind["name"], [], taken(kind["parameters"]), "dict[str, Any]", kind["summary"])
    return text


def main() -> int:
    wrong = 0
    for name, text in (("nodes", nodes()), ("widgets", widgets())):
        path = FOLDER / f"{name}.pyi"
        if "--check" not in sys.argv:
            path.write_text(text)
        elif not path.exists() or path.read_text() != text:
            print(f"{path} is not what the declarations make: run scripts/stubs.py")
            wrong = 1
    return wrong


if __name__ == "__main__":
    sys.exit(main())
