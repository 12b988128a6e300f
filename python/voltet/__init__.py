"""voltet: volume pictures of results on unstructured grids, straight from the cells, with transfer functions over a scalar
and its gradient magnitude.

>>> import voltet
>>> result = voltet.run("pipelines/quickstart.toml", set={"view.size": [64, 48]})    # doctest: +SKIP
>>> result.images["picture"].shape                                                   # doctest: +SKIP
(48, 64, 4)

====================  =====================================================================================
`render`              the picture of a mesh of PyVista, VTK, meshio, xarray or numpy, in one line
`run`, `check`        pipeline files and the pictures that carry one
`Pipeline`            a pipeline opened or built in code, changed, drawn again and again, saved
`Grid`                a grid of numpy arrays, lent without a copy where their layout allows
`scene`               a pipeline about a grid of yours, to begin with
`nodes`, `widgets`    what can be stated, with signatures made from the program's own declarations
`gradient_filter`     gradient filters that are Python functions
`grid_reader`         readers of file formats that are Python functions
`gradient_test`       how right a gradient filter is, and what it costs
`Error`               what everything here raises, with place and remedy
`VoltetWarning`       the category of warnings: of an empty picture, of cells that are left out
`voltet.vtk`          the same as VTK filters (needs the package vtk)
`voltet.pyvista`      accessors of grids and plotters (loaded by PyVista itself)
====================  =====================================================================================

Pictures are float32 arrays of height × width × 4: premultiplied linear RGBA, row 0 at the top. Lengths are in the grid's own
units, angles in degrees.
"""

import os as _os
from typing import TYPE_CHECKING

from ._errors import ArgumentTypeError, Bug, Cancelled, Error, RunError, UsageError, VoltetWarning
from ._native import VERSION as __version__

if TYPE_CHECKING:
    from . import nodes as nodes, widgets as widgets
    from ._filters import Parameter as Parameter, gradient_filter as gradient_filter
    from ._grid import Grid as Grid
    from ._readers import grid_reader as grid_reader
    from ._series import Frame as Frame
    from ._picture import Picture as Picture, Result as Result
    from ._node import Node as Node
    from ._pipeline import Pipeline as Pipeline
    from ._gradient_test import gradient_test as gradient_test
    from ._run import check as check, run as run
    from ._scene import render as render, scene as scene
    from ._shown import Shown as Shown

# Mesa's layer that chooses among Vulkan devices asks for a Wayland display, and complains of a missing one, wherever devices are looked
# for; the program switches it off in the same way.
if "XDG_RUNTIME_DIR" not in _os.environ:
    _os.environ.setdefault("NODEVICE_SELECT", "1")

# Loaded when asked for: `import voltet` alone loads neither numpy nor anything that needs it.
_HOMES = {
    "Frame": "_series",
    "Grid": "_grid",
    "Node": "_node",
    "Parameter": "_filters",
    "Picture": "_picture",
    "Pipeline": "_pipeline",
    "Result": "_picture",
    "check": "_run",
    "Shown": "_shown",
    "gradient_filter": "_filters",
    "gradient_test": "_gradient_test",
    "grid_reader": "_readers",
    "nodes": "",
    "render": "_scene",
    "run": "_run",
    "scene": "_scene",
    "widgets": "",
}

__all__ = ["ArgumentTypeError", "Bug", "Cancelled", "Error", "RunError", "UsageError", "VoltetWarning", *_HOMES]


def __getattr__(name: str):
    home = _HOMES.get(name)
    if home is None:
        raise AttributeError(f"module 'voltet' has no attribute {name!r}")
    from importlib import import_module

    module = import_module(f"voltet.{home or name}")
    found = getattr(module, name) if home else module
    globals()[name] = found
    return found


def __dir__():
    return sorted([*globals(), *_HOMES])
