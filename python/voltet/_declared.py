"""What can be stated, as the program declares it; functions made from that, with signatures and help."""

from __future__ import annotations

import json
from functools import lru_cache
from inspect import Parameter, Signature
from keyword import iskeyword
from typing import Any

from . import _native


@lru_cache(maxsize=1)
def declarations() -> dict[str, Any]:
    """Node types and gradient filters with ports and parameters."""
    return json.loads(_native.declarations())


@lru_cache(maxsize=None)
def ports(type: str) -> tuple[str, ...]:
    """The names of a node type's inputs that none of its parameters has; none for a type that there is not."""
    for node in declarations()["nodes"]:
        if node["name"] == type:
            names = {parameter["name"] for parameter in node["parameters"]}
            known = (port["name"] for port in node["inputs"] + node["optional_inputs"])
            return tuple(name for name in known if name not in names)
    return ()


def parameters(type: str) -> tuple[str, ...]:
    """The names of a node type's parameters; none for a type that there is not."""
    return tuple(parameter["name"] for node in declarations()["nodes"] if node["name"] == type for parameter in node["parameters"])


def widget_kinds() -> list[dict[str, Any]]:
    """The kinds of widgets."""
    node = next(node for node in declarations()["nodes"] if node["name"] == "transfer-function")
    return next(parameter for parameter in node["parameters"] if parameter["name"] == "widgets")["kinds"]


def function_name(name: str) -> str:
    """`gradient-magnitude` as Python names it."""
    return name.replace("-", "_")


def signature(parameters: list[dict[str, Any]], wires: list[dict[str, Any]] = [], more: bool = False) -> Signature:
    """Of a function that takes these by keyword."""
    taken = [Parameter(port["name"], Parameter.KEYWORD_ONLY, default=None) for port in wires]
    for parameter in parameters:
        default = Parameter.empty if parameter["required"] else None
        if not iskeyword(parameter["name"]):
            taken.append(Parameter(parameter["name"], Parameter.KEYWORD_ONLY, default=default))
    if more:
        taken.append(Parameter("of_method", Parameter.VAR_KEYWORD))
    return Signature(taken)


def described(summary: str, parameters: list[dict[str, Any]], wires: list[dict[str, Any]] = []) -> str:
    """The docstring: what it is, then each parameter with type, unit and default."""
    lines = [summary]
    if wires:
        lines += ["", "Inputs", "------"]
        lines += [f"{port['name']} : {port['type']}\n    {port['summary']}" for port in wires]
    if parameters:
        lines += ["", "Parameters", "----------"]
    for parameter in parameters:
        unit = f", {parameter['unit']}" if parameter["unit"] else ""
        lines.append(f"{parameter['name']} : {parameter['type']}{unit}")
        lines.append(f"    {parameter['help']} ({parameter['default']})")
    return "\n".join(lines)
