"""The test of gradient filters."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike, fspath
from typing import Any

from . import _native
from ._errors import whole
from ._progress import Progress, followed
from ._shown import Shown


def gradient_test(
    name: str,
    *,
    set: Mapping[str, Any] | None = None,
    beside: Sequence[str] | None = None,
    hold_to: Sequence[str] = ("finite", "linear", "order", "invariance"),
    order: float = 0.8,
    linear_error: float = 1e-9,
    levels: Sequence[int] = (4, 8, 16, 24),
    timed: int = 40,
    rounds: int = 5,
    output: str | PathLike[str] | None = None,
    progress: bool | None | Progress = None,
) -> Shown:
    """Measures a gradient filter, as `voltet gradient-test` does: how right it is, how it scales, what it costs, what it does to a
    picture, beside others. Truth is formulas alone.

    Parameters
    ----------
    name : str
        A filter: one that ships, or one of `voltet.gradient_filter`.
    set : mapping
        Its parameters.
    beside : list of str
        Filters to measure beside it; all others without it, none for an empty list.
    hold_to : list of str
        What it is held to: a finite vector at every point, exact on linear fields, converging inside, the same wherever the grid
        stands and however it is numbered; "boundary": converging on the boundary, too, which is a warning otherwise.
    order, linear_error : float
        The least order of convergence inside; the largest error on linear fields, by the largest gradient.
    levels : list of int
        Boxes along a side of each grid, coarse to fine, 2 to 128.
    timed, rounds : int
        Boxes along a side of the grid that is timed, 2 to 200, and how often.
    output : path
        Where a page (.html) of it is written.

    Returns
    -------
    Shown
        What `--json` writes, `filters` (the first is the one that was asked about), `requirements`, …, and `passed`. `print` shows
        the table, notebooks that and a plot.

    >>> import voltet
    >>> found = voltet.gradient_test("least-squares", beside=[], levels=[2, 4], timed=4, rounds=1)
    >>> found["passed"], found["filters"][0]["name"]
    (True, 'least-squares')
    """
    others = None if beside is None else [str(other) for other in beside]
    counts = [whole("levels", level) for level in levels], whole("timed", timed), whole("rounds", rounds)
    with followed(progress) as told:
        shown, passed, page = _native.gradient_test(
            str(name), dict(set or {}), others, list(hold_to), float(order), float(linear_error), *counts, told
        )
    if output is not None:
        with open(fspath(output), "w", encoding="utf-8") as file:
            file.write(page)
    return Shown(shown, passed=passed)
