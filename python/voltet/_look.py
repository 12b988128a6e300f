"""PyVista's words for transfer functions, as a widget."""

from __future__ import annotations

import warnings
from collections.abc import Mapping, Sequence
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista as pv

from . import _vtk_grid
from ._errors import VoltetWarning, number, real_numbers, usage, whole
from ._grid import Grid

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: Opacity beyond which nothing behind is seen in eight bits: it stands for 1, whose extinction has no end.
_OPAQUE = 1.0 - 2.0**-12


class Look:
    """A quantity of a data set and its transfer function, by PyVista's words."""

    def __init__(
        self,
        data: Any,
        scalars: Any = None,
        *,
        preference: str = "point",
        component: int | None = None,
        clim: float | Sequence[float] | None = None,
        cmap: Any = None,
        opacity: Any = "linear",
        n_colors: int = 256,
        flip_scalars: bool = False,
        categories: bool | int = False,
        log_scale: bool = False,
        above_color: Any = None,
        below_color: Any = None,
        annotations: Mapping[float, str] | None = None,
        opacity_unit_distance: float | None = None,
        widgets: Sequence[Mapping[str, Any]] | None = None,
    ):
        if preference not in ("point", "cell"):
            raise usage("'preference' is neither", repr(preference), '"point" or "cell"')
        self.data = data
        self._association = _vtk_grid.CELL if preference == "cell" else _vtk_grid.POINT
        self._taken: tuple[tuple, Grid] | None = None
        if isinstance(data, np.ndarray):
            data = self.data = _wrapped(data)
        if not hasattr(data, "GetClassName"):
            raise usage("this is no data set", f"a {type(data).__qualname__}", "a data set of PyVista with cells, or a three-dimensional array")
        if isinstance(scalars, np.ndarray):
            self.data = data.copy(deep=False)
            place = self.data.point_data if len(scalars) == data.n_points else self.data.cell_data
            place["Data"] = _plain(scalars)
            scalars = "Data"
        self.name: str = self._named(scalars)
        fields = [field for widget in widgets or [] for field in widget.get("fields", [])]
        self.names = list(dict.fromkeys([self.name, *fields]))
        grid = self.grid()
        known = grid.about["arrays"][self.name]
        self.scalar = self._component(known["components"], component)
        table = cmap if isinstance(cmap, pv.LookupTable) else None
        if table is not None:
            # As PyVista does: it states all of it.
            clim, log_scale, opacity = table.scalar_range, table.log_scale, table.values[:, 3] / 255.0
            n_colors = table.n_values
            above_color = table.above_range_color if table.GetUseAboveRangeColor() else None
            below_color = table.below_range_color if table.GetUseBelowRangeColor() else None
        self.range = known["range"] or self._range_of_magnitude()
        self.clim = _limits(clim, self.range, log_scale)
        if categories and table is None:
            n_colors = max(2, self._category_count() if categories is True else whole("categories", categories, 1, 65536))
        self._n_colors, self._opacity, self._log = whole("n_colors", n_colors, 2, 65536), opacity, bool(log_scale)
        self._cmap = _reversed(cmap) if flip_scalars and table is None else cmap
        self._above, self._below = _color("above_color", above_color), _color("below_color", below_color)
        self._annotations = dict(annotations or {})
        self.unit_distance = self._distance(opacity_unit_distance, widgets)
        self.widgets = [dict(widget) for widget in widgets] if widgets is not None else self._colormap()
        #: Parameters of the node `transfer-function` beside widgets and unit distance.
        self.axes = {"s_scale": "log"} if self._log else {}
        # Those of a colour map are composited as they are, as VTK does; widgets state linear ones.
        self.linear = widgets is not None

    def _component(self, count: int, component: int | None) -> str:
        """The scalar of an array of so many components."""
        if component is not None:
            return f"{self.name}:{whole('component', component, 0, count - 1)}" if count > 1 else self.name
        return self.name if count == 1 else f"{self.name}:magnitude"

    def _category_count(self) -> int:
        """The number of different values, of which none is NaN."""
        values = self._values()
        return len(np.unique(values[np.isfinite(values)]))

    def grid(self) -> Grid:
        """The data as a grid, as they are now: the same one while nothing has changed."""
        state = _vtk_grid.state(self.data, self.names)
        if self._taken is None or self._taken[0] != state:
            self._taken = None
            self._taken = (state, _vtk_grid.grid(self.data, self.names, association=self._association))
        return self._taken[1]

    def lookup_table(self) -> pv.LookupTable:
        """The colours, for a scalar bar."""
        table = self._colors() if self._n_colors <= 256 else self._colors(256)
        table.scalar_range = self.clim
        table.log_scale = self._log
        if self._above is not None:
            table.above_range_color = self._above
        if self._below is not None:
            table.below_range_color = self._below
        if self._annotations:
            table.annotations = self._annotations
        return table

    def _colors(self, count: int | None = None) -> pv.LookupTable:
        if isinstance(self._cmap, pv.LookupTable):
            table = pv.LookupTable()
            table.DeepCopy(self._cmap)
            return table
        return pv.LookupTable(cmap=self._cmap or pv.global_theme.cmap, n_values=count or self._n_colors)

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

    def _values(self) -> NDArray[np.float64]:
        """The scalar at the points of cells. The run that draws it shows the grid's warnings, so that this one is silent."""
        from ._scene import pipeline_of

        with warnings.catch_warnings():
            warnings.simplefilter("ignore", VoltetWarning)
            return pipeline_of(self.grid(), self.scalar, widgets=[]).volume("gradient", gradient_magnitude=False)["scalar"]

    def _range_of_magnitude(self) -> list[float]:
        values = self._values()
        return [float(np.nanmin(values)), float(np.nanmax(values))]

    def _distance(self, given: float | None, widgets: Any) -> float | None:
        if given is not None:
            length = number("opacity_unit_distance", given, "a length above 0")
            if not (np.isfinite(length) and length > 0):
                raise usage("'opacity_unit_distance' is out of range", given, "a length above 0")
            return length
        if widgets is not None:
            return None
        dimensions = getattr(self.data, "dimensions", None)
        # PyVista's own defaults.
        return 1.0 if dimensions is None else float(self.data.length / (np.mean(dimensions) - 1))

    def _colormap(self) -> list[dict[str, Any]]:
        count = self._n_colors
        try:
            colors = self._colors().values[:, :3] / 255.0
            alphas = np.asarray(self._opacity if isinstance(self._cmap, pv.LookupTable) else pv.opacity_transfer_function(self._opacity, count) / 255.0, float)
        except Exception as error:
            raise usage("the colour map or opacity is not known to PyVista", error, "what add_volume takes") from error
        extinction = -np.log1p(-np.minimum(alphas, _OPAQUE))
        at = np.geomspace(*self.clim, count) if self._log else np.linspace(*self.clim, count)
        points = [[float(s), *map(float, color), float(k)] for s, color, k in zip(at, colors, extinction)]
        if self._above is None and self._below is None:
            # Beyond the limits the ends hold.
            low, high = self.range
            if low < self.clim[0] and not (self._log and low <= 0.0):
                points.insert(0, [low, *points[0][1:]])
            if high > self.clim[1]:
                points.append([high, *points[-1][1:]])
            return [{"kind": "piecewise-linear", "points": points}]
        within = [-np.inf, np.inf]
        widgets = []
        for color, end, side in ((self._below, 0, 0), (self._above, -1, 1)):
            if color is not None:
                limit = self.clim[side]
                within[side] = limit
                region = [5e-324 if self._log else -np.inf, limit] if side == 0 else [limit, np.inf]
                widgets.append({"kind": "uniform", "color": color, "extinction": points[end][4], "region": {"s": region}})
        return [{"kind": "piecewise-linear", "points": points, "region": {"s": within}}, *widgets]


def _wrapped(values: NDArray[Any]) -> Any:
    """A three-dimensional array as PyVista takes it: a copy."""
    if values.ndim != 3:
        raise usage("an array is no volume", f"shape {values.shape}", "three dimensions")
    return pv.wrap(_plain(values))


def _plain(values: NDArray[Any]) -> NDArray[Any]:
    """An array of a type that VTK has, NaN where it is masked."""
    if values.dtype.kind not in "biuf":
        raise usage("an array has a wrong type", values.dtype, "real numbers")
    if isinstance(values, np.ma.MaskedArray):
        return np.ma.filled(values.astype(np.float64), np.nan)
    if values.dtype.kind == "b":
        return values.astype(np.uint8)
    return values.astype(np.float64) if values.dtype.kind == "f" and values.dtype.itemsize not in (4, 8) else values


def _limits(clim: float | Sequence[float] | None, range: Sequence[float], log: bool) -> tuple[float, float]:
    if clim is None:
        low, high = range
        if log and low <= 0.0:
            raise usage("'log_scale' needs values above 0", f"{low} to {high}", "clim=(low, high), both above 0")
        # A field that is the same everywhere.
        return (low, high) if high > low else (low, low + max(abs(low), 1.0) * 1e-6)
    is_one = isinstance(clim, Real) or getattr(clim, "ndim", None) == 0
    ends = real_numbers([clim], 1) if is_one else real_numbers(clim, 2)
    if ends is None:
        raise usage("'clim' is no pair", repr(clim)[:80], "two numbers, or one for both sides of 0")
    low, high = (-ends[0], ends[0]) if is_one else ends
    if not (np.isfinite([low, high]).all() and low < high):
        raise usage("'clim' is out of range", clim, "two numbers, the first the less")
    if log and low <= 0.0:
        raise usage("'clim' is out of range", clim, "numbers above 0, with log_scale")
    return low, high


def _reversed(cmap: Any) -> Any:
    """A colour map from its other end."""
    cmap = cmap or pv.global_theme.cmap
    if isinstance(cmap, (list, tuple)):
        return list(cmap)[::-1]
    try:
        return pv.plotting.colors.get_cmap_safe(cmap).reversed()
    except Exception as error:
        raise usage("the colour map is not known to PyVista", error, "what add_volume takes") from error


def _color(name: str, color: Any) -> list[float] | None:
    """A colour in PyVista's words, as shares of red, green and blue."""
    if color is None:
        return None
    try:
        return list(pv.Color(color).float_rgb)
    except Exception as error:
        raise usage(f"'{name}' is no colour", repr(color), "a name, '#rrggbb' or three numbers from 0 to 1") from error
