"""Prints the reference page of the module from its docstrings; needs Python alone, not the built module.

python scripts/reference.py [LINE BELOW THE TITLE]
"""

from __future__ import annotations

import ast
import inspect
import re
import sys
from pathlib import Path

FOLDER = Path(__file__).parent.parent / "voltet"
DECLARED = {"nodes", "widgets"}
VTK_BASES = {"Filter": "_vtk_filter", "Scene": "_vtk_scene"}
OTHERS = {"vtk": "VTK filters", "pyvista": "PyVista accessors", "paraview": "ParaView"}


def parse(module: str) -> ast.Module:
    return ast.parse((FOLDER / f"{module}.py").read_text(encoding="utf-8"))


def homes() -> dict[str, str]:
    """Module of each public name, as the package declares them."""
    found = {}
    for node in parse("__init__").body:
        if isinstance(node, ast.ImportFrom) and node.module == "_errors":
            found |= {alias.name: node.module for alias in node.names}
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "_HOMES":
            found |= ast.literal_eval(node.value)
    return found


def prose(node: ast.AST) -> str:
    """Docstring as Markdown: examples and tables stand in blocks of code."""
    text = inspect.cleandoc(ast.get_docstring(node, clean=False) or "")
    parts = []
    for part in re.split(r"\n\s*\n", text):
        if part.lstrip().startswith(">>>"):
            parts.append(f"```python\n{part}\n```")
        elif heading := re.match(r"(\w+)\n-+\n", part):
            entries = re.sub(r"^(\S[^\n]*)\n((?:    [^\n]*(?:\n|$))+)", item, part[heading.end() :] + "\n", flags=re.M)
            parts.append(f"**{heading[1]}**\n\n{entries.rstrip()}")
        elif part.startswith("==") or part.startswith("    "):
            parts.append(f"```text\n{part}\n```")
        else:
            parts.append(part.replace("*", "\\*") if "`" not in part else part)
    return "\n\n".join(parts)


def item(entry: re.Match) -> str:
    """One entry of a docstring's list of parameters, as an item of a Markdown list."""
    name, _, kind = entry[1].partition(" : ")
    about = " ".join(line.strip() for line in entry[2].splitlines())
    return f"- `{name}`" + (f" ({kind})" if kind else "") + f": {about}\n"


def signature(function: ast.FunctionDef | ast.AsyncFunctionDef, name: str) -> str:
    arguments = ast.unparse(function.args)
    arguments = re.sub(r"^(self|cls)(, |$)", "", arguments)
    result = f" -> {ast.unparse(function.returns)}" if function.returns else ""
    return f"```python\n{name}({arguments}){result}\n```"


def is_decorated(function: ast.FunctionDef, word: str) -> bool:
    return any(ast.unparse(decorator).endswith(word) for decorator in function.decorator_list)


def members(node: ast.ClassDef, module: str) -> list[ast.stmt]:
    """Members of a class and of those that it derives from in private modules of the package."""
    found = list(node.body)
    imported = {alias.name: one.module for one in parse(module).body if isinstance(one, ast.ImportFrom) and one.level for alias in one.names}
    for base in node.bases:
        home = imported.get(ast.unparse(base))
        if home and not home.startswith("_vtk") and ast.unparse(base) not in homes():
            found += next(members(one, home) for one in parse(home).body if getattr(one, "name", "") == ast.unparse(base))
    return found


def describe_class(node: ast.ClassDef, module: str, level: str) -> list[str]:
    text = [prose(node)]
    for member in members(node, module):
        if not isinstance(member, ast.FunctionDef) or is_decorated(member, ".setter") or is_decorated(member, "overload"):
            continue
        if member.name == "__init__" and ast.unparse(member.args) != "self":
            text.insert(0, signature(member, node.name))
        elif not member.name.startswith(("_", "Request", "FillInput", "ProcessRequest")) and ast.get_docstring(member):
            text.append(f"{level}# {node.name}.{member.name}")
            if not is_decorated(member, "property"):
                text.append(signature(member, member.name))
            text.append(prose(member))
    return text


def describe(module: str, name: str, level: str) -> list[str]:
    for node in parse(module).body:
        if isinstance(node, ast.ClassDef) and node.name == name:
            bases = ", ".join(f"`{base}`" for base in map(ast.unparse, node.bases) if base.endswith(("Error", "Exception", "Warning")) or base in VTK_BASES)
            head = [f"{level} {name}"] + ([f"A kind of {bases}."] if bases else [])
            return head + describe_class(node, module, level)
        if isinstance(node, ast.FunctionDef) and node.name == name and not is_decorated(node, "overload"):
            return [f"{level} {name}", signature(node, name), prose(node)]
    raise SystemExit(f"{module}.py has no {name}")


def public_names(module: str) -> list[tuple[str, str]]:
    """Public classes and functions of a module, each with the module that defines it."""
    tree = parse(module)
    for node in tree.body:
        if isinstance(node, ast.Assign) and getattr(node.targets[0], "id", "") == "__all__":
            wanted = ast.literal_eval(node.value)
            break
    else:
        kinds = (ast.ClassDef, ast.FunctionDef)
        described = (node for node in tree.body if isinstance(node, kinds) and ast.get_docstring(node))
        wanted = [node.name for node in described if not node.name.startswith("_")]
    imported = {alias.name: node.module for node in tree.body if isinstance(node, ast.ImportFrom) and node.level for alias in node.names}
    return [(imported.get(name) or module, name) for name in wanted]


def main() -> int:
    text = ["# The Python module", *sys.argv[1:2], prose(parse("__init__"))]
    for name, module in sorted(homes().items(), key=lambda item: item[0].lower()):
        if name in DECLARED:
            text += [f"## {name}", prose(parse(name))]
            text.append("Signatures follow from the [declarations of the nodes](nodes.md); the stub files have them.")
        else:
            text += describe(module, name, "##")
    for module, title in OTHERS.items():
        text += [f"## voltet.{module}", f"{title}.", prose(parse(module))]
        bases = [(home, name) for name, home in VTK_BASES.items()] if module == "vtk" else []
        for home, name in public_names(module) + bases:
            text += describe(home, name, "###")
    sys.stdout.reconfigure(encoding="utf-8")
    print("\n\n".join(part for part in text if part))
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
