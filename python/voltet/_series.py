"""Pictures of a series: time steps, files, values of parameters, places of the camera."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any, NamedTuple

from ._errors import usage, whole
from ._picture import Picture
from ._progress import Progress

if TYPE_CHECKING:
    from ._pipeline import Pipeline


class Frame(NamedTuple):
    """One picture of a series."""

    #: Its number, from 0.
    number: int
    #: The number of its time step, from 0.
    step: int
    #: The time, where the data have times.
    time: float | None
    #: Words that tell it from the others: "step 7, time 0.35".
    label: str
    #: The picture.
    picture: Picture


def frames(
    pipeline: Pipeline,
    node: str | None,
    steps: str | int | Iterable[int] | None,
    times: str | float | Iterable[float] | None,
    ranges: str | None,
    files: str | PathLike[str] | Iterable[str | PathLike[str]],
    sweep: Mapping[str, Sequence[Any]] | None,
    turns: int | None,
    part: str | None,
    progress: bool | None | Progress,
) -> Iterator[Frame]:
    """See `Pipeline.frames`."""
    for path, values in (sweep or {}).items():
        if isinstance(values, (str, bytes)) or not isinstance(values, Iterable):
            raise usage("the values of a sweep are no list", repr(values), "values that are drawn one after the other, as [1, 2, 4]", str(path))
    words = {
        "steps": _words("steps", steps),
        "times": _words("times", times),
        "ranges": ranges,
        "files": [fspath(file) for file in ([files] if isinstance(files, (str, PathLike)) else files)],
        "sweeps": [(path, list(values)) for path, values in (sweep or {}).items()],
        "turns": None if turns is None else whole("turns", turns, 1),
        "part": part,
    }
    pipeline._lend()
    for number, (label, step, time, changes) in enumerate(pipeline._native.frames(words)):
        yield Frame(number, step, time, label, _drawn(pipeline, node, changes, progress))


def _drawn(pipeline: Pipeline, node: str | None, changes: Sequence[tuple[str, str, Any]], progress: bool | None | Progress) -> Picture:
    """The picture with these changes, which are taken back."""
    changed = 0
    try:
        for where, parameter, value in changes:
            before = pipeline.text
            if parameter.startswith("inputs."):
                pipeline[where].connect(parameter.removeprefix("inputs."), value)
            else:
                pipeline.set({f"{where}.{parameter}": value})
            changed += pipeline.text != before
        return pipeline.render(node, progress)
    finally:
        for _ in range(changed):
            pipeline.undo()


def _words(name: str, given: Any) -> str | None:
    """A selection as the option of `voltet run` has it: `"0:365:5"`, or numbers."""
    if given is None or isinstance(given, str):
        return given
    numbers = list(given) if isinstance(given, Iterable) else [given]
    if not all(isinstance(number, (int, float)) or hasattr(number, "dtype") for number in numbers) or not numbers:
        raise usage(f"'{name}' is no selection", repr(given), 'numbers, or a text such as "0:365:5", "3,5,-1" or "all"')
    return ",".join(str(number.item() if hasattr(number, "item") else number) for number in numbers)
