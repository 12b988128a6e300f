"""Call-backs that follow runs."""

from __future__ import annotations

import sys
from collections.abc import Callable, Iterator
from contextlib import contextmanager

from ._errors import usage

#: Called every 20 ms with the node, its stage and how much of that is done (0 … 1). What it raises stops the run.
Progress = Callable[[str, str, float], object]


@contextmanager
def followed(progress: bool | None | Progress) -> Iterator[Progress | None]:
    """The call-back that is meant: a function; True for a bar, by tqdm where that is installed, else a line of text; None."""
    if progress is None or progress is False:
        yield None
    elif callable(progress):
        yield progress
    elif progress is True:
        bar = _bar()
        try:
            yield bar.show
        finally:
            bar.close()
    else:
        raise usage("'progress' is no call-back", repr(progress), "True, None or a function of (node, stage, fraction)")


def _bar() -> _Tqdm | _Line:
    try:
        from tqdm.auto import tqdm
    except ImportError:
        return _Line()
    return _Tqdm(tqdm)


class _Tqdm:
    def __init__(self, tqdm):
        self._bar = tqdm(total=100, unit="%", leave=False, bar_format="{desc} {percentage:3.0f}% |{bar}| {elapsed}")

    def show(self, node: str, stage: str, fraction: float) -> None:
        self._bar.set_description_str(f"{node} {stage}".strip(), refresh=False)
        self._bar.n = round(100.0 * min(max(fraction, 0.0), 1.0))
        self._bar.refresh()

    def close(self) -> None:
        self._bar.close()


class _Line:
    def __init__(self):
        self._shown = 0

    def show(self, node: str, stage: str, fraction: float) -> None:
        text = f"{node} {stage} {100.0 * fraction:3.0f}%"
        print("\r" + text.ljust(self._shown), end="", file=sys.stderr, flush=True)
        self._shown = len(text)

    def close(self) -> None:
        if self._shown:
            print("\r" + " " * self._shown + "\r", end="", file=sys.stderr, flush=True)
