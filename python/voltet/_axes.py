"""Pictures in the axes of matplotlib."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import usage
from ._picture import encoded_srgb

if TYPE_CHECKING:
    from collections.abc import Callable

    from matplotlib.axes import Axes
    from matplotlib.image import AxesImage

    from ._pipeline import Pipeline
    from ._progress import Progress

#: Largest part of an axis's unit vector that is none of a direction along it.
_SKEW = 1e-6


def imshow(
    pipeline: Pipeline, ax: Axes | None, node: str | None, colorbar: bool, progress: bool | None | Progress, options: dict[str, Any]
) -> AxesImage:
    """See `Pipeline.imshow`."""
    try:
        from matplotlib import axes
        from matplotlib.cm import ScalarMappable
        from matplotlib.colors import FuncNorm, ListedColormap, LogNorm, Normalize, to_rgb

        if ax is None:
            import matplotlib.pyplot as pyplot

            ax = pyplot.gca()
    except ImportError as error:
        raise usage("matplotlib is missing", error, "pip install matplotlib") from error
    if not isinstance(ax, axes.Axes):
        raise usage("these are no axes of matplotlib", f"a {type(ax).__qualname__}", "axes that plt.subplots gives, or None for the present ones")
    picture = pipeline.render(node, progress)
    about = json.loads(pipeline._native.picture_axes(node))
    (x, y), (width, height) = about["middle"], about["size"]
    # Composited over the axes' own colour in linear light, as everywhere; matplotlib would do it in sRGB.
    ground = np.asarray(to_rgb(ax.get_facecolor()))
    linear = np.where(ground <= 0.04045, ground / 12.92, ((ground + 0.055) / 1.055) ** 2.4)
    options = {
        "extent": (x - width / 2, x + width / 2, y - height / 2, y + height / 2),
        "interpolation": "antialiased",
        **options,
        "origin": "upper",
    }
    shown = ax.imshow(picture.srgb8(tuple(linear)), **options)
    names = [name for direction in (about["right"], about["up"]) if (name := _axis_name(direction))]
    if about["is_orthographic"] and len(names) == 2:
        ax.set_xlabel(names[0].removeprefix("-"))
        ax.set_ylabel(names[1].removeprefix("-"))
        # Coordinates of the grid, which may fall to the right.
        for name, axis in zip(names, (ax.xaxis, ax.yaxis)):
            if name.startswith("-"):
                axis.set_major_formatter(lambda value, _: f"{-value:.10g}")
    else:
        # Positions of several depths fall together: lengths have no one scale, or no one axis.
        ax.set_xticks([])
        ax.set_yticks([])
    if colorbar and (scale := about["scale"]) is not None:
        low, high = scale["range"]
        norm = {
            "linear": lambda: Normalize(low, high),
            "log": lambda: LogNorm(low, high),
            "symlog": lambda: FuncNorm(_symlog(scale["linear_below"]), low, high),
        }[scale["form"]]()
        colors = ListedColormap(encoded_srgb(np.asarray(scale["colors"])))
        ax.figure.colorbar(ScalarMappable(norm, colors), ax=ax, label=scale["name"])
    return shown


def _symlog(below: float) -> tuple[Callable[[np.ndarray], np.ndarray], Callable[[np.ndarray], np.ndarray]]:
    """Places along voltet's symmetric logarithm, sign(v) · log(1 + |v| / below), and the values at places."""
    return lambda v: np.sign(v) * np.log1p(np.abs(v) / below), lambda p: np.sign(p) * below * np.expm1(np.abs(p))


def _axis_name(direction: list[float]) -> str | None:
    """The axis of space that a direction lies along, with its sign."""
    for name, part in zip("xyz", direction):
        if abs(abs(part) - 1.0) < _SKEW:
            return name if part > 0 else f"-{name}"
    return None
