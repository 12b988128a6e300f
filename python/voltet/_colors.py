"""Colour maps in Python's words, as a widget."""

from __future__ import annotations

from collections.abc import Sequence
from os import PathLike, fspath
from typing import Any

import numpy as np

from ._declared import widget_kinds
from ._errors import nearest_or_one_of, usage

#: Points along a colour map of matplotlib.
_COUNT = 256

#: The shapes of opacity that the widget `colormap` declares, as points [place, share], for colour maps that it does not have; but for
#: `peaks`, which are narrower than the points of these lie apart.
_SHAPES = {
    "ramp": [[0.0, 0.0], [1.0, 1.0]],
    "fall": [[0.0, 1.0], [1.0, 0.0]],
    "constant": [[0.0, 1.0], [1.0, 1.0]],
    "ends": [[0.0, 1.0], [0.5, 0.0], [1.0, 1.0]],
    "middle": [[0.0, 0.0], [0.5, 1.0], [1.0, 0.0]],
}


def names() -> list[str]:
    """The colour maps that voltet has itself."""
    declared = next(kind for kind in widget_kinds() if kind["name"] == "colormap")
    parameter = next(parameter for parameter in declared["parameters"] if parameter["name"] == "colormap")
    return [word for word in parameter["type"].split(" | ") if " " not in word]


def colormap_widget(cmap: Any, clim: Sequence[Any] | None, opacity: Any, extinction: float, range: Sequence[float] | None) -> dict[str, Any]:
    """A widget of a colour map: the kind `colormap` for maps that voltet has and files of ParaView's, else the colours of matplotlib's,
    one by one. `range`: that of the scalar, where it is known."""
    ends = ["0 %", "100 %"] if clim is None else list(clim) if isinstance(clim, (Sequence, np.ndarray)) else []
    if len(ends) != 2 or isinstance(clim, str):
        raise usage("'clim' is no pair", clim, '(low, high): numbers, or texts such as "5 %" and "p95"')
    is_of_numbers = all(isinstance(end, (int, float, np.number)) for end in ends)
    if is_of_numbers and not (np.isfinite(ends).all() and ends[0] < ends[1]):
        raise usage("'clim' is out of range", clim, "two numbers, the first the less")
    opacity = "ramp" if opacity is None else opacity if isinstance(opacity, str) else _curve(opacity)
    cmap = "viridis" if cmap is None else fspath(cmap) if isinstance(cmap, PathLike) else cmap
    if isinstance(cmap, str):
        name, reversed = (cmap.removesuffix("_r"), True) if cmap.endswith("_r") else (cmap, False)
        if name in names() or cmap.endswith((".json", ".xml")):
            widget = {"kind": "colormap", "colormap": name, "opacity": opacity, "extinction": extinction}
            return {**widget, **({"reversed": True} if reversed else {}), **({} if clim is None else {"range": ends})}
    places = np.linspace(0.0, 1.0, _COUNT)
    colors = _of_matplotlib(cmap, places)
    if isinstance(opacity, str) and opacity not in _SHAPES:
        raise usage("the opacity has no such shape", repr(opacity), f"points [place, share], or one of {', '.join(_SHAPES)}")
    shares = np.asarray(_SHAPES[opacity] if isinstance(opacity, str) else opacity, float)
    density = extinction * np.interp(places, shares[:, 0], shares[:, 1])
    if clim is None and range is not None and range[0] == range[1]:
        # A field that is the same everywhere.
        ends, is_of_numbers = [range[0], range[0] + max(abs(range[0]), 1.0) * 1e-6], True
    if is_of_numbers:
        at: list[Any] = np.linspace(float(ends[0]), float(ends[1]), _COUNT).tolist()
    elif clim is None:
        at = [f"{100.0 * place:.9g} %" for place in places]
    else:
        raise usage("'clim' is relative to the data, which a colour map of matplotlib is not", clim, "two numbers")
    rows = [[s, *map(float, color), float(k)] for s, color, k in zip(at, colors, density)]
    return {"kind": "piecewise-linear", "points": rows}


def _curve(opacity: Any) -> list[list[float]]:
    """Points [place, share] of an opacity that is no word."""
    try:
        rows = np.asarray(opacity, float)
    except (TypeError, ValueError):
        rows = np.empty(0)
    is_curve = rows.ndim == 2 and rows.shape[1] == 2 and len(rows) > 0
    if not (is_curve and ((rows >= 0.0) & (rows <= 1.0)).all() and (np.diff(rows[:, 0]) >= 0.0).all()):
        expected = f"points [place, share] from 0 to 1, places ascending, as [[0, 0], [1, 0.5]]; or one of {', '.join(_SHAPES)}, peaks"
        raise usage("the opacity is no curve", repr(opacity)[:80], expected)
    return rows.tolist()


def _of_matplotlib(cmap: Any, places: np.ndarray) -> np.ndarray:
    """Linear RGB of a colour map of matplotlib: by its name, itself, or a list of colours that it is made of."""
    try:
        import matplotlib
        from matplotlib.colors import Colormap, LinearSegmentedColormap
    except ImportError as error:
        raise usage("the colour map is not known", repr(cmap)[:80], f"one of {', '.join(names())}; or matplotlib, for others") from error
    try:
        if isinstance(cmap, str):
            cmap = matplotlib.colormaps[cmap]
        elif not isinstance(cmap, Colormap):
            first, second, *rest = cmap
            cmap = LinearSegmentedColormap.from_list("given", [first, second, *rest])
        colors = np.asarray(cmap(places), float)[:, :3]
    except (KeyError, ValueError, TypeError) as error:
        word, known = (cmap, [*names(), *matplotlib.colormaps]) if isinstance(cmap, str) else ("", [])
        listed = [*names(), "a name or Colormap of matplotlib", "or a list of two or more colours"]
        expected = nearest_or_one_of(word, known, listed)
        raise usage("the colour map is not known", repr(cmap)[:80], expected) from error
    return np.where(colors <= 0.04045, colors / 12.92, ((colors + 0.055) / 1.055) ** 2.4)
