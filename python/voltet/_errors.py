"""The one family of exceptions, and the category of warnings."""

from __future__ import annotations

import sys
import warnings
from collections.abc import Iterable, Mapping
from difflib import get_close_matches
from operator import index
from typing import Any


class Error(Exception):
    """What was wrong: the program's own text, and its parts.

    Attributes
    ----------
    what : str
        What is wrong, in a clause.
    found, expected : str or None
        What was found, and what would be right: the remedy.
    file, line, column : str, int, int or None
        Where, in a pipeline or data file (line and column from 1).
    node, item : str or None
        The node of the pipeline; the port, parameter or array of it.
    """

    def __init__(
        self,
        text: str,
        *,
        what: str | None = None,
        found: str | None = None,
        expected: str | None = None,
        file: str | None = None,
        line: int | None = None,
        column: int | None = None,
        node: str | None = None,
        item: str | None = None,
    ):
        super().__init__(text)
        self.what = what if what is not None else text
        self.found = found
        self.expected = expected
        self.file = file
        self.line = line
        self.column = column
        self.node = node
        self.item = item

    @property
    def remedy(self) -> str | None:
        """What would be right: another name of `expected`."""
        return self.expected

    def __reduce__(self):
        return _rebuilt, (type(self), str(self), dict(self.__dict__))


class UsageError(Error, ValueError):
    """A mistake in a pipeline, a parameter or an argument: nothing ran."""


class ArgumentTypeError(UsageError, TypeError):
    """An argument of a wrong type, such as 2.5 where a whole number is due."""


class RunError(Error, RuntimeError):
    """A failure of the run: a file that is damaged, memory that ends, a filter that raised."""


class Cancelled(Error):
    """The run was stopped."""


class Bug(Error, RuntimeError):
    """A mistake of voltet itself. The pipeline can be used again; please report it."""


class VoltetWarning(UserWarning):
    """What should be known of a picture or grid that was made all the same: the category of Python's warnings."""


KINDS = {"usage": UsageError, "run": RunError, "cancelled": Cancelled, "bug": Bug}


def exception(kind: str, text: str, fields: dict) -> Error:
    """The exception that stands for an error of the program."""
    return KINDS[kind](text, **fields)


def usage(what: str, found: object = None, expected: str | None = None, item: str | None = None) -> UsageError:
    """The exception for a wrong argument, worded as the program words its own."""
    return _worded(UsageError, what, found, expected, item)


def nearest_or_one_of(word: str, known: Iterable[str], listed: Iterable[str]) -> str:
    """What was expected in place of a word: the nearest known one, if one is near, or those listed."""
    near = get_close_matches(word.lower(), list(known), 1)
    nearest = f"'{near[0]}', the nearest name, or " if near else ""
    return f"{nearest}one of {', '.join(listed)}"


def argument_type(what: str, found: object = None, expected: str | None = None) -> ArgumentTypeError:
    """The exception for an argument of a wrong type."""
    error = _worded(ArgumentTypeError, what, found, expected, None)
    assert isinstance(error, ArgumentTypeError)
    return error


def whole(name: str, value: object, low: int = 0, high: int = 2**32 - 1) -> int:
    """A whole number within limits, of any integer type. Others are refused: nothing is rounded."""
    expected = f"a whole number, {low} or more" if high == 2**32 - 1 else f"a whole number, {low} to {high}"
    try:
        number = None if isinstance(value, bool) else index(value)  # type: ignore[arg-type]
    except TypeError:
        number = None
    if number is None:
        raise _worded(ArgumentTypeError, f"'{name}' is no whole number", repr(value), expected, None)
    if not low <= number <= high:
        raise usage(f"'{name}' is out of range", number, expected)
    return number


def number(name: str, value: Any, expected: str = "a number") -> float:
    """A real number of any type that is one, 0-dimensional arrays among them; finite in 64 bits or infinite by itself."""
    is_real = getattr(getattr(value, "dtype", None), "kind", "f") in "iuf" and getattr(value, "ndim", 0) == 0
    # Which float() would take, too.
    if is_real and not isinstance(value, (str, bytes, bytearray, bool)):
        try:
            return float(value)
        except (TypeError, ValueError, OverflowError):
            pass
    raise argument_type(f"'{name}' is no number", repr(value)[:80], expected)


def real_numbers(value: Any, count: int) -> list[float] | None:
    """So many real numbers; None where it is none such. Texts and mappings are no lists of numbers."""
    try:
        found = [] if isinstance(value, (str, bytes, bytearray, Mapping)) else [number("", part) for part in value]
    except TypeError:
        return None
    return found if len(found) == count else None


def sequence(name: str, value: Any, expected: str) -> list[Any]:
    """Values one after the other, as a list; None is an empty one. `expected`: an example of one."""
    if value is None:
        return []
    try:
        if not isinstance(value, (str, bytes, bytearray, Mapping)):
            return list(value)
    except TypeError:
        pass
    raise argument_type(f"'{name}' is no list", repr(value)[:80], expected)


def mapping(name: str, value: Any, expected: str) -> dict[str, Any]:
    """A mapping by words, as a dictionary; None is an empty one. `expected`: an example of one."""
    if value is None:
        return {}
    if not (isinstance(value, Mapping) and all(isinstance(word, str) for word in value)):
        raise argument_type(f"'{name}' is no mapping", repr(value)[:80], expected)
    return dict(value)


def picture_size(name: str, value: Any) -> tuple[int, int]:
    """Width and height of a picture, pixels."""
    try:
        width, height = value
    except (TypeError, ValueError):
        what = f"'{name}' is no pair of whole numbers"
        raise _worded(ArgumentTypeError, what, repr(value), "width and height, 1 to 32768 pixels", None) from None
    return whole(name, width, 1, 32768), whole(name, height, 1, 32768)


def warn(texts: Iterable[str]) -> None:
    """Shows warnings at the line of the program that called the package."""
    level, frame = 1, sys._getframe()
    while frame.f_back is not None and frame.f_globals.get("__name__", "").partition(".")[0] in _OWN:
        level, frame = level + 1, frame.f_back
    for text in texts:
        warnings.warn(text, VoltetWarning, stacklevel=level)


#: Packages whose lines a user did not write.
_OWN = {"voltet", "vtkmodules", "pyvista", "paraview"}


def _worded(kind: type[UsageError], what: str, found: object, expected: str | None, item: str | None) -> UsageError:
    text = what
    if found is not None:
        found = str(found)
        if "\n" in found:
            # Objects of other packages describe themselves in several lines.
            found = " ".join(found.split())
        text += f": found {found}"
    if expected is not None:
        text += f"; expected {expected}"
    if item is not None:
        text += f" ('{item}')"
    return kind(text, what=what, found=found, expected=expected, item=item)


def _rebuilt(kind: type[Error], text: str, state: dict) -> Error:
    error = kind(text)
    error.__dict__.update(state)
    return error
