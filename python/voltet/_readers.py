"""Readers of file formats that are Python functions."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from . import _native
from ._errors import usage
from ._filters import Parameter, declaration, takes
from ._grid import Grid, _piece, _Taken, components
from ._meshes import EXPECTED, pieces_of

#: What states the cells, and what else a mapping may hold.
_CELLS = ("tetrahedra", "types", "offsets", "connectivity", "cells", "faces", "face_locations")
_KNOWN = ("points", *_CELLS, "point_data", "cell_data", "ghost", "degrees", "scalar", "times", "format", "mesh")


def grid_reader(
    name: str | None = None,
    *,
    extensions: Sequence[str],
    magic: bytes = b"",
    summary: str | None = None,
    parameters: Mapping[str, Parameter | bool | int | float | str] | None = None,
):
    """Registers a function as a reader of a file format, for use as a decorator. Pipelines name it by `type = "NAME"`; the node
    `reader` hands it the files of this format, too.

    The function is called with the file's path and by keyword with its parameters. It gives a PyVista, VTK or meshio mesh, a `Grid`,
    or a mapping with the arguments of `Grid` from `points` to `degrees` and where they are due

    - `times`: the time of each step, ascending, if the file is a series; the function takes a keyword `step` then, the number of
      the step from 0,
    - `mesh`: a mesh in place of points, cells and quantities,
    - `scalar`: the quantity that is drawn where the pipeline names none,
    - `format`: how the file is written, for people.

    Quantities and points may be anything that has a `shape` and of which numpy makes an array, such as data sets of h5py or
    `numpy.memmap`: what nobody looks at is not read. It runs on a thread of the program, once a picture (twice for a later step);
    what it raises is the cause of the `RunError` that the run raises.

    Parameters
    ----------
    name : str
        Its type in pipelines. Default: the function's name, with hyphens. A name that is taken by a former function is its from now on.
    extensions : sequence of str
        What the names of its files end with: `[".xyz"]`.
    magic : bytes
        How its files begin, at most 64 bytes; decides in place of the name.
    summary : str
        What it reads, a sentence. Default: the first line of its docstring.
    parameters : mapping of name to Parameter or default
        Its parameters. Default: the keyword-only arguments of the function, with their defaults.

    >>> import numpy as np, voltet
    >>> @voltet.grid_reader(extensions=[".corner"])
    ... def corner(path, *, size=1.0):
    ...     "Reads the temperatures at the corners of one tetrahedron."
    ...     points = size * np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    ...     return {"points": points, "tetrahedra": [[0, 1, 2, 3]], "point_data": {"T": np.loadtxt(path)}}
    """
    endings = [str(ending).removeprefix(".").lower() for ending in extensions]
    if isinstance(extensions, str) or not all(endings):
        raise usage("the extensions of a reader are no list of texts", repr(extensions), '[".xyz"]')
    if not isinstance(magic, (bytes, bytearray)):
        raise usage("the begin of a reader's files is no bytes", repr(magic), 'b"XYZ"')
    if len(magic) > 64:
        raise usage("the begin of a reader's files is too long", f"{len(magic)} bytes", "at most 64")

    def register(function: Callable[..., Any]) -> Callable[..., Any]:
        about = declaration(function, name, summary, parameters, "step")
        _native.register_reader(*about, endings, bytes(magic), _Reader(function))
        return function

    return register


class _Reader:
    """What the program calls."""

    def __init__(self, function: Callable[..., Any]):
        self._function = function
        self._takes_step = takes(function, "step")

    def __call__(self, path: str, step: int, parameters: Mapping[str, Any]) -> _Contents:
        more = {"step": step} if self._takes_step else {}
        contents = _Contents(self._function(path, **parameters, **more))
        if len(contents.times) > 1 and not self._takes_step:
            raise usage("the file is a series, and the function takes no step", None, "a keyword argument 'step'")
        return contents


class _Contents:
    """A file of which nothing was read that waits until it is looked at."""

    def __init__(self, given: Any):
        about: Mapping[str, Any] = given if isinstance(given, Mapping) else {"mesh": given}
        if wrong := sorted(map(str, set(about) - set(_KNOWN))):
            raise usage("the reader gave something that is not known", wrong[0], ", ".join(_KNOWN))
        both = sorted(key for key in about if key not in ("mesh", "scalar", "times", "format") and about[key] is not None)
        if about.get("mesh") is not None and both:
            raise usage("the reader gave a mesh, and further what a mesh holds", both[0], "a mesh, or points, cells and quantities")
        for key, kind, expected in (("scalar", str, "a text"), ("format", str, "a text"), ("point_data", Mapping, "names with values"), ("cell_data", Mapping, "names with values")):
            if about.get(key) is not None and not isinstance(about[key], kind):
                raise usage(f"the reader gave '{key}' as something else", repr(about[key])[:80], expected)
        piece, scalar, self.warnings = (dict(about), None, []) if about.get("mesh") is None else _piece_of(about["mesh"])
        self.scalar: str | None = about.get("scalar") or scalar
        self.format: str | None = about.get("format")
        self.times = _times(about.get("times"))
        if piece.get("points") is None:
            raise usage("the reader gave no points", None, "points, cells and quantities")
        self._geometry = {key: piece[key] for key in ("points", *_CELLS) if piece.get(key) is not None}
        shape = _shape("points", piece["points"])
        if len(shape) != 2 or shape[1] != 3:
            raise usage("the points are not three numbers each", f"shape {shape}", "(n, 3)", "points")
        self.point_count = shape[0]
        cells = piece["tetrahedra"] if piece.get("tetrahedra") is not None else piece.get("types")
        if cells is None:
            raise usage("the grid's cells are not stated", None, "tetrahedra; types, offsets and connectivity; or types and cells")
        self.cell_count = (_shape("cells", cells) or (0,))[0]
        self.cell_bytes = sum(8 * int(np.prod(_shape(key, self._geometry[key]))) for key in _CELLS if key in self._geometry)
        own = {"vtkGhostType": piece.get("ghost"), "HigherOrderDegrees": piece.get("degrees")}
        on_cells = {**(piece.get("cell_data") or {}), **{name: values for name, values in own.items() if values is not None}}
        self._values, self.arrays = [], []
        for quantities, count, what in ((piece.get("point_data") or {}, self.point_count, "point"), (on_cells, self.cell_count, "cell")):
            for key, values in quantities.items():
                self._values.append(values)
                self.arrays.append((str(key), what == "cell", components(str(key), _shape(str(key), values), count, what)))

    def read(self, geometry: bool, places: Sequence[int]) -> tuple[dict[str, Any] | None, list[np.ndarray]]:
        """Points and cells, where they are asked for, and the arrays at these places."""
        taken = _Taken()
        arrays = [taken.floats(self.arrays[place][0], self._values[place]) for place in places]
        return _piece(self._geometry, taken) if geometry else None, arrays


def _times(given: Any) -> list[float]:
    times = np.asarray([] if given is None else given, np.float64).reshape(-1)
    if not (np.isfinite(times).all() and (np.diff(times) > 0).all()):
        raise usage("the times of the steps do not ascend", times[:8].tolist(), "finite numbers, each above the one before", "times")
    return times.tolist()


def _shape(name: str, values: Any) -> tuple[int, ...]:
    try:
        return tuple(map(int, np.shape(values)))
    except Exception as error:
        raise usage("an array cannot be made of this", error, "numbers in rows of one length", name) from error


def _piece_of(mesh: Any) -> tuple[dict[str, Any], str | None, list[str]]:
    """A mesh as the arguments of `Grid`, the scalar that it marks, and what was left out."""
    if not isinstance(mesh, Grid) and not hasattr(mesh, "GetClassName") and type(mesh).__module__.partition(".")[0] not in ("meshio", "xarray"):
        found = f"a {type(mesh).__module__}.{type(mesh).__qualname__}"
        raise usage("the reader gave no grid", found, EXPECTED)
    pieces, scalar, notes = pieces_of(mesh)
    if len(pieces) != 1:
        raise usage("the reader gave several grids", len(pieces), "one; PyVista's combine() makes one of blocks")
    return dict(pieces[0]), scalar, notes
