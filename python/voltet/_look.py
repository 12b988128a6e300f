"""PyVista's words for transfer functions, as a widget."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
import pyvista as pv

from . import _vtk_grid
from ._errors import usage, whole
from ._grid import Grid

#: Opacity beyond which nothing behind is seen in eight bits: it stands for 1, whose extinction has no end.
_OPAQUE = 1.0 - 2.0**-12


class Look:
    """A quantity of a data set and its transfer function."""

    def __init__(
        self,
        data: Any,
        scalars: Any,
        preference: str,
        clim: float | Sequence[float] | None,
        cmap: Any,
        opacity: Any,
        n_colors: int,
        opacity_unit_distance: float | None,
        widgets: Sequence[Mapping[str, Any]] | None,
    ):
        if preference not in ("point", "cell"):
            raise usage("'preference' is neither", repr(preference), '"point" or "cell"')
        self.data = data
        self._association = _vtk_grid.CELL if preference == "cell" else _vtk_grid.POINT
        self._taken: tuple[tuple, Grid] | None = None
        if isinstance(scalars, np.ndarray):
            self.data = data.copy(deep=False)
            place = self.data.point_data if len(scalars) == data.n_points else self.data.cell_data
            place["Data"] = scalars
            scalars = "Data"
        self.name: str = self._named(scalars)
        fields = [field for widget in widgets or [] for field in widget.get("fields", [])]
        self.names = list(dict.fromkeys([self.name, *fields]))
        grid = self.grid()
        known = grid.about["arrays"][self.name]
        self.scalar = self.name if known["components"] == 1 else f"{self.name}:magnitude"
        self._cmap, self._n_colors, self._opacity = cmap, whole("n_colors", n_colors, 2, 65536), opacity
        self.range = known["range"] or self._range_of_magnitude()
        self.clim = _limits(clim, self.range)
        self.unit_distance = self._distance(opacity_unit_distance, widgets)
        self.widgets = [dict(widget) for widget in widgets] if widgets is not None else [self._widget()]
        # Those of a colour map are composited as they are, as VTK does; widgets state linear ones.
        self.linear = widgets is not None

    def grid(self) -> Grid:
        """The data as a grid, as they are now: the same one while nothing has changed."""
        state = _vtk_grid.state(self.data, self.names)
        if self._taken is None or self._taken[0] != state:
            self._taken = None
            self._taken = (state, _vtk_grid.grid(self.data, self.names, association=self._association))
        return self._taken[1]

    def lookup_table(self) -> pv.LookupTable:
        """The colours, for a scalar bar."""
        table = pv.LookupTable(cmap=self._cmap or pv.global_theme.cmap, n_values=min(self._n_colors, 256))
        table.scalar_range = self.clim
        return table

    def _named(self, scalars: Any) -> str:
        if scalars is None:
            drawn, _ = _vtk_grid.parts(self.data)
            name = pv.wrap(drawn[0].data).active_scalars_name if drawn else None
            if name is None:
                raise usage("the data set has no active scalars", None, "scalars=NAME")
            return str(name)
        if not isinstance(scalars, str):
            raise usage("'scalars' is no name", repr(scalars), "the name of an array, or an array")
        return scalars

    def _range_of_magnitude(self) -> list[float]:
        from ._scene import scene

        values = scene(self.grid(), self.scalar, widgets=[]).volume("gradient", gradient_magnitude=False)["scalar"]
        return [float(np.nanmin(values)), float(np.nanmax(values))]

    def _distance(self, given: float | None, widgets: Any) -> float | None:
        if given is not None:
            if not (np.isfinite(given) and given > 0):
                raise usage("'opacity_unit_distance' is out of range", given, "a length above 0")
            return float(given)
        if widgets is not None:
            return None
        dimensions = getattr(self.data, "dimensions", None)
        # PyVista's own defaults.
        return 1.0 if dimensions is None else float(self.data.length / (np.mean(dimensions) - 1))

    def _widget(self) -> dict[str, Any]:
        count = self._n_colors
        try:
            colors = pv.LookupTable(cmap=self._cmap or pv.global_theme.cmap, n_values=count).values[:, :3] / 255.0
            alphas = np.asarray(pv.opacity_transfer_function(self._opacity, count), float) / 255.0
        except Exception as error:
            raise usage("the colour map or opacity is not known to PyVista", error, "what add_volume takes") from error
        extinction = -np.log1p(-np.minimum(alphas, _OPAQUE))
        at = np.linspace(*self.clim, count)
        points = [[float(s), *map(float, color), float(k)] for s, color, k in zip(at, colors, extinction)]
        # Beyond the limits the ends hold.
        low, high = self.range
        if low < self.clim[0]:
            points.insert(0, [low, *points[0][1:]])
        if high > self.clim[1]:
            points.append([high, *points[-1][1:]])
        return {"kind": "piecewise-linear", "points": points}


def _limits(clim: float | Sequence[float] | None, range: Sequence[float]) -> tuple[float, float]:
    if clim is None:
        low, high = range
        # A field that is the same everywhere.
        return (low, high) if high > low else (low, low + max(abs(low), 1.0) * 1e-6)
    low, high = (-clim, clim) if isinstance(clim, (int, float)) else clim
    if not (np.isfinite([low, high]).all() and low < high):
        raise usage("'clim' is out of range", clim, "two numbers, the first the less")
    return float(low), float(high)
