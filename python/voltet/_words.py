"""PyVista's words of `add_volume` and `add_mesh`: other names of words, and words for what is not drawn here."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np

from ._errors import usage

#: PyVista's own other names.
_ALIASES = {"rng": "clim", "colormap": "cmap"}

#: Words of `voltet.scene` that have another name or place in PyVista.
_ELSEWHERE = {
    "camera": "the camera of the plotter",
    "extinction": "opacity, or widgets",
    "look": "log_scale=True, or voltet.scene",
    "scalar": "scalars=NAME",
    "size": "window_size of the plotter or the picture",
    "unit_distance": "opacity_unit_distance=LENGTH",
}

_MAPPER = "none of VTK's mappers draws"
_SHAPE = "the cells are drawn as they are"

#: Each word that is refused: the values that request nothing, the reason, and the remedy.
REFUSED: dict[str, tuple[tuple[Any, ...], str, str]] = {
    "blending": (("composite",), "rays are integrated by absorption and emission, not by the largest, least or mean value", 'blending="composite"'),
    "culling": ((False,), _SHAPE, "no culling of faces, of which a volume has none"),
    "mapper": ((None,), _MAPPER, 'engine="cpu", "gpu" or "auto"'),
    "multi_colors": ((False,), "blocks are one grid with one transfer function", "a call of add_volume for each block"),
    "nan_color": ((None,), "cells with a point that has no value are not drawn", "values in place of NaN, such as nan_to_num"),
    "nan_opacity": ((None, 0, 0.0), "cells with a point that has no value are not drawn", "nan_opacity=0, or values in place of NaN"),
    "pickable": ((False,), "VTK's pickers see surfaces", "volume.pick(x, y), which gives the cells along a pixel's ray, or a surface of the grid to pick"),
    "resolution": ((None,), _SHAPE, "pyvista.ImageData(spacing=…) for an array"),
    "specular": ((0, 0.0), "light is diffuse", "shade=True, ambient and diffuse"),
    "specular_power": ((), "light is diffuse", "shade=True, ambient and diffuse"),
    "style": (("volume",), _SHAPE, "add_mesh for surfaces, points and edges"),
    "user_matrix": ((None,), "a volume stands where its data set does", "grid.transform(matrix, inplace=False)"),
}


def options_of(words: Mapping[str, Any], light: Mapping[str, Any] | None) -> dict[str, Any]:
    """Parameters of the node `renderer` among these words, and `clim` and `cmap` where they stand there by other names. Words of
    PyVista that request nothing are left out, others refused with the reason. `light`: that of `shade`."""
    options = dict(words)
    for word, value in words.items():
        if word in _ALIASES:
            options[_ALIASES[word]] = options.pop(word)
        elif word in _ELSEWHERE:
            raise usage(f"'{word}' is no word of add_volume", None, _ELSEWHERE[word])
        elif word in REFUSED:
            nothing, reason, remedy = REFUSED[word]
            del options[word]
            is_identity = word == "user_matrix" and np.shape(value) == (4, 4) and np.array_equal(value, np.eye(4))
            if not is_identity and not any(type(value) is type(none) and value == none for none in nothing):
                raise usage(f"'{word}' means nothing here: {reason}", repr(value), remedy)
    if light is not None:
        if "light" in options:
            raise usage("the light is stated twice", "'shade' and 'light'", "one of them")
        options["light"] = dict(light)
    return options


def headlight(shade: bool, ambient: float | None, diffuse: float | None) -> dict[str, Any] | None:
    """The light of `shade`, whose direction follows the camera; PyVista's defaults."""
    if not shade:
        for name, value in (("ambient", ambient), ("diffuse", diffuse)):
            if value is not None:
                raise usage(f"'{name}' belongs to shade", value, "shade=True")
        return None
    return {"direction": [0.0, 0.0, 1.0], "ambient": 0.0 if ambient is None else float(ambient), "diffuse": 0.7 if diffuse is None else float(diffuse)}
