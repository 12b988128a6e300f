"""What is found out by pipelines: figures, values at points, pixels, error against time."""

from __future__ import annotations

import json
from collections.abc import Sequence
from os import PathLike, fspath
from typing import TYPE_CHECKING, Any

from ._errors import whole
from ._picture import picture
from ._progress import Progress, followed
from ._shown import Shown

if TYPE_CHECKING:
    import numpy as np
    from numpy.typing import NDArray

    from . import _native as native


class Measured:
    """A pipeline, as far as it finds something out."""

    _native: native.Pipeline

    def _lend(self, keep_cells: bool = False, look: bool = True) -> list[native.Grid]:
        raise NotImplementedError

    def figures(self, node: str, progress: bool | None | Progress = None) -> dict[str, Any]:
        """What a node reports, such as a probe or a histogram.

        Rows of tables become an array (`rows`, named by `columns`). Of a histogram there are also `volumes`, the volume of every
        bin (bins of g × bins of s), and `s_edges`, `g_edges`, the limits of the bins."""
        from ._figures import figures

        self._lend()
        with followed(progress) as told:
            return figures(json.loads(self._native.figures(node, told)))

    def volume(
        self,
        node: str,
        *,
        gradient_magnitude: bool = True,
        gradient: bool = False,
        progress: bool | None | Progress = None,
    ) -> dict[str, NDArray[np.float64]]:
        """What a node that gives a volume or a grid knows at the points: arrays by name.

        `scalar` (n), `gradient_magnitude` (n, units of the scalar per unit of length) and `gradient` (n × 3) where asked for. Of
        a grid that you gave the points are yours, in your order; NaN at points of no cell."""
        self._lend(keep_cells=True)
        with followed(progress) as told:
            return self._native.volume(node, bool(gradient_magnitude), bool(gradient), told)

    def pixel(
        self,
        x: int,
        y: int,
        node: str | None = None,
        *,
        sample: int = 0,
        all: bool = False,
        progress: bool | None | Progress = None,
    ) -> Shown:
        """What a pixel is made of, as `voltet pixel` says it: the cells along its ray, and what each of them adds.

        Parameters
        ----------
        x, y : int
            Column from the left and row from the top, from 0.
        node : str
            The node that draws, where there are several.
        sample : int
            Which ray of the pixel is shown, from 0, where the camera has several.
        all : bool
            Whether the table has every cell; else the 24 that add most.

        Returns
        -------
        Shown
            What `--json` writes: `cells` from the eye on, each with `entry`, `exit`, `at_entry`, `at_exit`, `widgets`, `opacity`, `adds`;
            `referee_rgba`, the pixel by the 64-bit referee; `drawn`, as the pipeline draws it; `integrators`, by every one. `print`
            shows the table, notebooks that and a plot along the ray. Cells are numbered as yours are."""
        column, row, ray = whole("x", x, -(2**63), 2**63 - 1), whole("y", y, -(2**63), 2**63 - 1), whole("sample", sample)
        self._lend(keep_cells=True)
        with followed(progress) as told:
            return Shown(self._native.pixel(column, row, node, ray, bool(all), told))

    def study(
        self,
        node: str | None = None,
        *,
        only: Sequence[str] = (),
        engine: str = "cpu",
        adapter: str | None = None,
        frames: int = 3,
        patience: float = 10.0,
        max_error: float | None = None,
        output: str | PathLike[str] | None = None,
        progress: bool | None | Progress = None,
    ) -> dict[str, Any]:
        """Error against run time of every integrator and setting, as `voltet study` measures them.

        Parameters
        ----------
        node : str
            The node that draws, where there are several.
        only : list of str
            Integrators to look at; all where it is empty.
        engine : "cpu", "gpu" or "all"
            Where.
        frames, patience : int, float
            Frames of each setting at most, and the seconds after which no further one begins.
        max_error : float
            The largest error of a pixel that is allowed, for the recommendation (1 = full scale).
        output : path
            A folder for the page, table and plots that `voltet study` writes.

        Returns
        -------
        dict
            What its study.json holds: `rows` with `label`, `setting`, `cost` (`picture`: milliseconds), `errors`, …; and
            `reference`, the picture of the 64-bit referee.
        """
        frames = whole("frames", frames)
        self._lend()
        output = None if output is None else fspath(output)
        with followed(progress) as told:
            found, reference = self._native.study(
                node, list(only), engine, adapter, frames, patience, max_error, output, told
            )
        return {**json.loads(found), "reference": picture(reference)}
