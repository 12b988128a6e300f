"""Nodes of pipelines."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

from ._errors import usage

if TYPE_CHECKING:
    from ._pipeline import Pipeline


class Node:
    """A node of a pipeline: its parameters by name, as its file states them.

    `node["size"] = [640, 480]` sets one, `del node["near"]` takes it out, `node["widgets.0.extinction"] = 2` sets a part."""

    def __init__(self, pipeline: Pipeline, name: str):
        self.pipeline = pipeline
        self.name = name

    @property
    def type(self) -> str:
        """The name of its type."""
        return self.pipeline._native.node(self.name)[0]

    @property
    def parameters(self) -> dict[str, Any]:
        """What is stated, by name: a copy."""
        return self.pipeline._native.node(self.name)[1]

    @property
    def inputs(self) -> dict[str, str | list[str]]:
        """What feeds its inputs: a copy."""
        return self.pipeline._native.node(self.name)[2]

    def connect(self, port: str, source: str | Node | Sequence[str | Node] | None) -> None:
        """Wires an input to a node, or several; None takes its wires out."""
        self.pipeline._native.connect(self.name, port, [] if source is None else sources(source))

    def __getitem__(self, path: str) -> Any:
        found: Any = self.parameters
        for step in path.split("."):
            try:
                found = found[int(step)] if isinstance(found, list) else found[step]
            except (KeyError, IndexError, ValueError, TypeError):
                known = ", ".join(found) if isinstance(found, dict) else None
                what = f"'{path}' is not stated at the node '{self.name}'"
                raise usage(what, None, known and f"one of {known}") from None
        return found

    def __setitem__(self, path: str, value: Any) -> None:
        self._put(path, value)

    def __delitem__(self, path: str) -> None:
        self._put(path, None)

    def _put(self, path: str, value: Any) -> None:
        self.pipeline._native.set([(self.name, path, value)])

    def __str__(self) -> str:
        return self.name

    def __repr__(self) -> str:
        return f"<voltet.Node {self.name} ({self.type})>"


def sources(source: Any) -> list[str]:
    listed = source if isinstance(source, (list, tuple)) else [source]
    for one in listed:
        if not isinstance(one, (str, Node)):
            raise usage("this feeds no input", repr(one), "a node, its name, or \"node.port\"")
    return [str(one) for one in listed]
