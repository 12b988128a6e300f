"""The one family of exceptions."""

from __future__ import annotations


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


class RunError(Error, RuntimeError):
    """A failure of the run: a file that is damaged, memory that ends, a filter that raised."""


class Cancelled(Error):
    """The run was stopped."""


class Bug(Error, RuntimeError):
    """A mistake of voltet itself. The pipeline can be used again; please report it."""


KINDS = {"usage": UsageError, "run": RunError, "cancelled": Cancelled, "bug": Bug}


def exception(kind: str, text: str, fields: dict) -> Error:
    """The exception that stands for an error of the program."""
    return KINDS[kind](text, **fields)


def usage(what: str, found: object = None, expected: str | None = None, item: str | None = None) -> UsageError:
    """The exception for a wrong argument, worded as the program words its own."""
    text = what
    if found is not None:
        text += f": found {found}"
    if expected is not None:
        text += f"; expected {expected}"
    if item is not None:
        text += f" ('{item}')"
    return UsageError(text, what=what, found=None if found is None else str(found), expected=expected, item=item)


def _rebuilt(kind: type[Error], text: str, state: dict) -> Error:
    error = kind(text)
    error.__dict__.update(state)
    return error
