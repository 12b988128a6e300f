"""Pipeline files run and checked, as the commands do it."""

from __future__ import annotations

from collections.abc import Mapping
from os import PathLike
from typing import Any

from ._picture import Result
from ._pipeline import Pipeline
from ._progress import Progress


def run(
    path: str | PathLike[str],
    set: Mapping[str, Any] | None = None,
    progress: bool | None | Progress = None,
) -> Result:
    """Runs a pipeline file, or a picture that carries one, as the command `voltet run` does: what it writes is written.

    Parameters
    ----------
    path : path
        A pipeline file (.toml), or a picture that carries one.
    set : mapping
        Other values of parameters: `{"view.size": [64, 64], "look.widgets.0.extinction": 2.0}`.
    progress : True or function
        A bar, or a function of (node, stage, fraction), called every 20 ms; what it raises stops the run.

    Returns
    -------
    Result
        `images`: the picture of every node by its name, float32, height × width × 4, premultiplied linear RGBA, row 0 at the
        top. `report`: what was done, a dictionary.
    """
    pipeline = Pipeline.open(path)
    pipeline.set(set or {})
    return pipeline.run(progress)


def check(path: str | PathLike[str], set: Mapping[str, Any] | None = None) -> list[str]:
    """Checks a pipeline file as `voltet check` does, without reading data: its warnings. Raises `Error` for what is wrong."""
    pipeline = Pipeline.open(path)
    pipeline.set(set or {})
    return pipeline.check()
