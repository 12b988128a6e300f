"""Gradient filters that are Python functions."""

from __future__ import annotations

import inspect
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from tokenize import TokenError
from typing import Any

import numpy as np

from . import _native
from ._errors import usage


@dataclass(frozen=True)
class Parameter:
    """A parameter of a gradient filter or a reader.

    Attributes
    ----------
    default : bool, int, float or str
        What holds where the pipeline does not say; its type is the parameter's. None: the pipeline must say a number.
    help, unit : str
        A sentence for help, and the unit.
    range : pair of numbers
        Least and greatest value, of numbers; None leaves an end open.
    choices : sequence of str
        The words that it may be, of a text.
    """

    default: bool | int | float | str | None = None
    help: str = ""
    unit: str = ""
    range: tuple[float | None, float | None] | None = None
    choices: Sequence[str] | None = None

    def declared(self, name: str) -> dict[str, Any]:
        """What the program is told."""
        if self.choices is not None:
            kind = "choice"
        else:
            types = {bool: "boolean", int: "integer", float: "number", str: "text", type(None): "number"}
            kind = types.get(type(self.default), "")
        if not kind:
            raise usage("the default of a parameter has a wrong type", repr(self.default), "a bool, number or text", name)
        help = self.help or f"{name} of the function"
        return {
            "name": name,
            "type": kind,
            "default": self.default,
            "unit": self.unit,
            "help": help,
            "range": None if self.range is None else list(self.range),
            "choices": None if self.choices is None else list(self.choices),
        }


def gradient_filter(
    name: str | Callable[..., Any] | None = None,
    *,
    summary: str | None = None,
    parameters: Mapping[str, Parameter | bool | int | float | str] | None = None,
    arrays: Sequence[str] = (),
):
    """Registers a function as a gradient filter, which pipelines name by `method = "NAME"`; for use as a decorator.

    The function is called with `points` (n × 3 float64, in the grid's units), `tetrahedra` (m × 4 uint32, ascending in every
    row) and `scalar` (n float64), then by keyword with its parameters, and `arrays` where some are asked for: the point arrays
    of these names, float64. It gives the gradient at the points, n × 3, in units of the scalar per unit of length. The arrays
    are its own. It runs on a thread of the program; what it raises is the cause of the `RunError` that the run raises.

    Parameters
    ----------
    name : str
        Its name in pipelines. Default: the function's, with hyphens. A name that is taken by a former function is its from now on.
    summary : str
        What it does, a sentence. Default: the first line of its docstring.
    parameters : mapping of name to Parameter or default
        Its parameters. Default: the keyword-only arguments of the function, with their defaults.
    arrays : sequence of str
        Point arrays that it reads beside the scalar.

    >>> import numpy as np, voltet
    >>> @voltet.gradient_filter
    ... def up(points, tetrahedra, scalar, *, slope=1.0):
    ...     "The same everywhere."
    ...     return np.tile([0.0, 0.0, slope], (len(points), 1))
    """
    if callable(name):
        return gradient_filter(None)(name)

    def register(function: Callable[..., Any]) -> Callable[..., Any]:
        about = declaration(function, name, summary, parameters, "arrays")
        _native.register_filter(*about, list(arrays), _Filter(function, bool(arrays)))
        return function

    return register


def declaration(
    function: Callable[..., Any],
    name: str | None,
    summary: str | None,
    parameters: Mapping[str, Parameter | bool | int | float | str] | None,
    other: str,
) -> tuple[str, str, list[dict[str, Any]], str, str]:
    """What the program is told of a function: name, summary, parameters, file, text. `other`: the keyword that is no parameter."""
    own = name or getattr(function, "__name__", "function").replace("_", "-")
    text = summary or (inspect.getdoc(function) or "A Python function.").splitlines()[0]
    declared = [
        (given if isinstance(given, Parameter) else Parameter(given)).declared(key)
        for key, given in (_keywords(function, other) if parameters is None else parameters).items()
    ]
    return own, text, declared, *_source(function)


def _keywords(function: Callable[..., Any], other: str) -> dict[str, Any]:
    """The keyword-only arguments, but one."""
    keywords = [p for p in _arguments(function) if p.kind is p.KEYWORD_ONLY and p.name != other]
    return {p.name: None if p.default is p.empty else p.default for p in keywords}


def _arguments(function: Callable[..., Any]) -> list[inspect.Parameter]:
    try:
        return list(inspect.signature(function).parameters.values())
    except (TypeError, ValueError):
        return []


def takes(function: Callable[..., Any], name: str) -> bool:
    """Whether a function takes an argument of this name."""
    return any(p.name == name or p.kind is p.VAR_KEYWORD for p in _arguments(function))


def _source(function: Callable[..., Any]) -> tuple[str, str]:
    """The file of a function and its text, as far as they are known."""
    try:
        return inspect.getsourcefile(function) or "Python", inspect.getsource(function)
    except (OSError, TypeError, SyntaxError, TokenError):
        # No file, or one of another language that the text of the function stands in.
        code = getattr(function, "__code__", None)
        return getattr(code, "co_filename", "Python"), repr(getattr(code, "co_code", function))


class _Filter:
    """What the program calls."""

    def __init__(self, function: Callable[..., Any], with_arrays: bool):
        self._function = function
        self._with_arrays = with_arrays

    def __call__(self, points, tetrahedra, scalar, arrays, parameters):
        if self._with_arrays:
            parameters = {**parameters, "arrays": arrays}
        given = self._function(points, tetrahedra, scalar, **parameters)
        try:
            found = np.asarray(given)
        except ValueError:
            # Rows of several lengths.
            found = np.array(None)
        return np.require(found, np.float64, ["C", "A"]) if found.dtype.kind in "fiub" else found
