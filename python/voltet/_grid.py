"""Grids of numpy arrays."""

from __future__ import annotations

import json
from collections.abc import Iterable, Mapping, Sequence
from inspect import signature
from typing import TYPE_CHECKING, Any

import numpy as np

from . import _native
from ._errors import argument_type, usage, whole

if TYPE_CHECKING:
    from numpy.typing import ArrayLike, NDArray

#: What is stated of a grid as a whole, whatever its pieces.
_OF_ALL = ("scalar", "subdivision", "constant_cells", "watch")


class Grid:
    """An unstructured grid of your arrays.

    Parameters
    ----------
    points : array, n × 3
        Positions. 64-bit floats whose rows lie one after the other are lent, others copied.
    tetrahedra : array of whole numbers, m × 4
        The cells, if all are tetrahedra: numbers of points. Of 32 bits, and ascending in every row, they are lent.
    types, offsets, connectivity : arrays of whole numbers, m, m + 1 and any
        Cells of any of VTK's types, as a `vtkCellArray` holds them, in place of `tetrahedra`.
    cells : array of whole numbers
        In place of offsets and connectivity: for each cell the number of its points and these, as PyVista holds them.
    faces, face_locations : arrays of whole numbers
        Of polyhedra (type 42), as VTK's files of version 2 hold them: at each polyhedron's place the number of its faces, then
        each face's count and points; a place for each cell, -1 for others.
    point_data, cell_data : mappings of name to array, n or n × k (m or m × k)
        Quantities. Those on cells become means at the points, unless `constant_cells`.
    scalar : str
        The quantity that is drawn where the pipeline names none. Default: the only one of one component, if there is one.
    ghost : array, m
        VTK's `vtkGhostType`: 1 is a ghost of another piece, which serves gradients and means of cell data and is not drawn; 8 and 32
        leave the cell out.
    degrees : array, m × 3
        Degrees of Lagrange and Bézier cells along their axes, where they differ.
    subdivision : int
        Pieces along the edges of curved cells, 1 to 64.
    constant_cells : bool
        Whether every cell keeps its own value, so that neighbours share none.
    watch : bool
        Whether arrays that were changed in place are noticed before each picture, which reads them once more. Without it, call
        `modified` after a change.

    The arrays are held as long as anything is drawn of them, and never written.

    >>> import numpy as np, voltet
    >>> points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])
    >>> grid = voltet.Grid(points, tetrahedra=[[0, 1, 2, 3]], point_data={"T": points[:, 0]})
    >>> grid.cell_count, grid.bounds
    (1, ((0.0, 0.0, 0.0), (1.0, 1.0, 1.0)))
    """

    def __new__(cls, *arguments: Any, **named: Any) -> Grid:
        # Subclasses may have arguments of their own.
        if arguments and cls.__init__ is Grid.__init__:
            # Python's own message for a second argument by position says nothing of the right call.
            if len(arguments) > 1:
                raise _by_position(arguments)
            first = arguments[0]
            is_mesh = hasattr(first, "GetClassName") or isinstance(first, Mapping) or package_of(first) in ("meshio", "xarray")
            # PyVista's and VTK's arrays have the attributes of their VTK objects, too.
            if is_mesh and not isinstance(first, np.ndarray):
                raise argument_type("the points are no array", _kind(first), "Grid.from_mesh(mesh), or Grid(points, tetrahedra=cells)")
        return super().__new__(cls)

    def __init__(
        self,
        points: ArrayLike,
        *,
        tetrahedra: ArrayLike | None = None,
        types: ArrayLike | None = None,
        offsets: ArrayLike | None = None,
        connectivity: ArrayLike | None = None,
        cells: ArrayLike | None = None,
        faces: ArrayLike | None = None,
        face_locations: ArrayLike | None = None,
        point_data: Mapping[str, ArrayLike] | None = None,
        cell_data: Mapping[str, ArrayLike] | None = None,
        scalar: str | None = None,
        ghost: ArrayLike | None = None,
        degrees: ArrayLike | None = None,
        subdivision: int = 1,
        constant_cells: bool = False,
        watch: bool = True,
    ):
        given = {
            "points": points,
            "tetrahedra": tetrahedra,
            "types": types,
            "offsets": offsets,
            "connectivity": connectivity,
            "cells": cells,
            "faces": faces,
            "face_locations": face_locations,
            "point_data": point_data,
            "cell_data": cell_data,
            "ghost": ghost,
            "degrees": degrees,
        }
        self._set([given], scalar=scalar, subdivision=subdivision, constant_cells=constant_cells, watch=watch)

    @classmethod
    def from_mesh(cls, mesh: Any, *, scalar: str | None = None, watch: bool | None = None, **options: Any) -> Grid:
        """The grid of a mesh of another package.

        Parameters
        ----------
        mesh : mesh
            A PyVista or VTK data set (also a composite one), a `meshio.Mesh`, an `xarray.Dataset` of the UGRID conventions with a
            topology of three dimensions, a mapping of the arguments of `Grid`, a `Grid`, or an array of three dimensions: values at
            points one unit apart, `values[i, j, k]` at (i, j, k). What a mapping or `Grid` states of the arguments below holds where
            they are left out.
        scalar : str
            The quantity that is drawn where the pipeline names none. Default: the mesh's active scalars, else the only one of one
            component.
        watch, **options
            As of `Grid`: `subdivision`, `constant_cells`.

        >>> import numpy as np, voltet
        >>> voltet.Grid.from_mesh(np.zeros((3, 3, 3))).point_count
        27
        """
        stated = {**options, **{name: value for name, value in (("scalar", scalar), ("watch", watch)) if value is not None}}
        if isinstance(mesh, Grid):
            return cls._of_pieces(mesh._pieces, **{**mesh._options, "watch": mesh._watch, **stated}) if stated else mesh
        # A data set of xarray is a mapping, too.
        if isinstance(mesh, Mapping) and package_of(mesh) != "xarray":
            stated = {**{name: mesh[name] for name in _OF_ALL if name in mesh}, **stated}
            piece = {name: value for name, value in mesh.items() if name not in _OF_ALL}
            return cls.from_pieces([{"name": "the mapping", **piece}], **stated)
        from ._meshes import pieces_of

        pieces, active, notes = pieces_of(mesh)
        return cls._of_pieces(pieces, **{"scalar": active, "warnings": notes, **stated})

    @classmethod
    def from_pieces(
        cls,
        pieces: Iterable[Mapping[str, Any]],
        *,
        scalar: str | None = None,
        subdivision: int = 1,
        constant_cells: bool = False,
        watch: bool = True,
    ) -> Grid:
        """The grid that was cut into these pieces: points of different pieces become one where their global ids are equal, or without
        ids at equal positions with equal values of the arrays that a picture requests; the counts of the grid are those of all arrays. Ghost
        cells of which a piece has the original are left out.

        Parameters
        ----------
        pieces : list of mappings
            Of each piece the arguments of `Grid` from `points` to `degrees`, and `global_ids`, an array of n whole numbers. Pieces of
            different `block`, a whole number, are different grids, whose points stay apart. `name`: what messages call it.
        scalar, subdivision, constant_cells, watch
            As of `Grid`.

        >>> import voltet
        >>> halves = [
        ...     {"points": [[0, 0, z], [1, 0, 0], [0, 1, 0], [0, 0, 0]], "tetrahedra": [[0, 1, 2, 3]], "point_data": {"T": [z, 1, 1, 0]}}
        ...     for z in (-1.0, 1.0)
        ... ]
        >>> voltet.Grid.from_pieces(halves).point_count
        5
        """
        known = {*signature(Grid.__init__).parameters, "global_ids", "block", "name"} - {"self", *_OF_ALL}
        given = [{"name": f"piece {number}", **piece} for number, piece in enumerate(pieces)]
        for piece in given:
            if wrong := sorted(map(str, set(piece) - known)):
                raise usage(f"{piece['name']} has an argument that is not known", wrong[0], ", ".join(sorted(known)))
            if piece.get("points") is None:
                raise usage(f"{piece['name']} has no points", None, "points and cells")
        return cls._of_pieces(given, scalar=scalar, subdivision=subdivision, constant_cells=constant_cells, watch=watch)

    @classmethod
    def _of_pieces(cls, pieces: list[dict[str, Any]], **options: Any) -> Grid:
        grid = cls.__new__(cls)
        grid._set(pieces, **options)
        return grid

    def __getstate__(self) -> dict[str, Any]:
        return {"pieces": self._pieces, "watch": self._watch, **self._options}

    def __setstate__(self, state: dict[str, Any]) -> None:
        self._set(**state)

    def _set(
        self,
        pieces: list[dict[str, Any]],
        *,
        scalar: str | None = None,
        subdivision: int = 1,
        constant_cells: bool = False,
        watch: bool = True,
        warnings: Sequence[str] = (),
    ) -> None:
        self._pieces = pieces
        self._options: dict[str, Any] = {
            "scalar": scalar_name(scalar),
            "subdivision": whole("subdivision", subdivision),
            "constant_cells": bool(constant_cells),
            "warnings": list(warnings),
        }
        self._watch = bool(watch)
        self._made: dict[bool, _native.Grid] = {}
        self._current()

    def _current(self, keep_cells: bool = False, look: bool = True) -> _native.Grid:
        """The grid as the arrays are now; as they were when it was made, where nobody is to `look` at them. `keep_cells`: one that
        knows which of its points is which of the arrays'."""
        made = self._made.get(keep_cells)
        if made is not None and look and self._watch and made.changed():
            made = None
        if made is None:
            made = self._made[keep_cells] = self._make(keep_cells)
        return made

    def _make(self, keep_cells: bool) -> _native.Grid:
        taken = _Taken()
        pieces = [_piece(given, taken) for given in self._pieces]
        _check_same_arrays(self._pieces, pieces)
        watch = taken.sources if self._watch else []
        return _native.Grid(pieces, keep_cells=keep_cells, watch=watch, **self._options)

    def modified(self) -> None:
        """Says that an array was changed in place: what was made of the arrays is made anew."""
        self._made.clear()

    @property
    def about(self) -> dict[str, Any]:
        """What is known of it: counts, bounds, arrays with components and ranges, bytes lent and copied, warnings."""
        return json.loads(self._current().about())

    def _about(self, scalar: str) -> dict[str, Any]:
        """What is known of what is drawn of a scalar alone: values of other arrays that are not finite do not count."""
        return json.loads(self._current().about(scalar))

    @property
    def point_count(self) -> int:
        """Points that cells use."""
        return self.about["points"]

    @property
    def cell_count(self) -> int:
        """Tetrahedra that the cells were split into."""
        return self.about["tetrahedra"]

    @property
    def bounds(self) -> tuple[tuple[float, ...], ...]:
        """Two opposite corners, in the grid's units."""
        return tuple(map(tuple, self.about["bounds"]))

    @property
    def arrays(self) -> dict[str, tuple[float, float] | None]:
        """The quantities, each with its range; None for one of several components."""
        return {name: known["range"] and tuple(known["range"]) for name, known in self.about["arrays"].items()}

    def __repr__(self) -> str:
        about = self.about
        names = ", ".join(about["arrays"])
        return f"<voltet.Grid: {about['points']} points, {about['tetrahedra']} tetrahedra, arrays {names}>"

    def _repr_html_(self) -> str:
        from ._html import table

        about = self.about
        rows = [("points", f"{about['points']:,}"), ("tetrahedra", f"{about['tetrahedra']:,}")]
        rows.append(("bounds", " … ".join(str(corner) for corner in self.bounds)))
        for name, known in about["arrays"].items():
            size = f"{known['components']} components"
            rows.append((name, "{:.9g} … {:.9g}".format(*known["range"]) if known["range"] else size))
        rows.append(("lent, copied", f"{about['bytes_lent']:,} and {about['bytes_copied']:,} bytes"))
        return table("Grid", rows, about["warnings"])


# What help and editors show: the arguments of __init__.
Grid.__signature__ = signature(Grid.__init__).replace(  # type: ignore[attr-defined]
    parameters=list(signature(Grid.__init__).parameters.values())[1:]
)


def package_of(value: object) -> str:
    """The package of the type of a value."""
    return type(value).__module__.partition(".")[0]


def _kind(value: object) -> str:
    """The type of a value, and its shape where it has one."""
    shape = getattr(value, "shape", None)
    return type(value).__qualname__ + (f" of shape {tuple(shape)}" if isinstance(shape, tuple) else "")


def scalar_name(scalar: Any) -> str | None:
    """The name of an array, of an argument that is one or None."""
    if scalar is not None and not isinstance(scalar, str):
        expected = 'the name of an array of the mesh, such as "T" after mesh["T"] = values'
        raise argument_type("the scalar is no name", _kind(scalar), expected)
    return scalar


def _by_position(arguments: tuple[Any, ...]) -> Exception:
    """The exception for arguments by position beyond the points, with the call that they look like."""

    def is_points(value: Any) -> bool:
        return getattr(value, "ndim", 0) == 2 and value.shape[1] == 3 and value.dtype.kind == "f"

    places = [place for place, value in enumerate(arguments) if is_points(value)]
    rest = len(arguments) - 1
    if rest == 1:
        call = "Grid(points, tetrahedra=cells), or Grid(points, cells=cells, types=types)"
    elif rest == 2:
        call = "Grid(points, cells=cells, types=types)"
    else:
        call = "Grid(points, types=types, offsets=offsets, connectivity=connectivity)"
    order = f"; the points are argument {places[0] + 1}" if places and places[0] > 0 else ""
    found = ", ".join(map(_kind, arguments)) + order
    return argument_type("only the points are given by position, and first", found, call)


def _piece(given: Mapping[str, Any], taken: _Taken) -> dict[str, Any]:
    """A piece in the form in which it is lent."""
    points = taken.floats("points", given["points"])
    if points.ndim != 2 or points.shape[1] != 3:
        raise usage("the points are not three numbers each", f"shape {points.shape}", "(n, 3), as in Grid(points, tetrahedra=cells)", "points")
    cells, cell_count = _cells(given, taken)
    arrays = []
    for key, count, what in (("point_data", len(points), "point"), ("cell_data", cell_count, "cell")):
        named = given.get(key)
        if named is not None and not hasattr(named, "items"):
            raise argument_type(f"'{key}' is no mapping", _kind(named), '{"T": values}')
        for name, values in (named or {}).items():
            array = taken.floats(str(name), values)
            arrays.append((str(name), array, components(str(name), array.shape, count, what), what == "cell"))
    piece: dict[str, Any] = {"points": points, "cells": cells, "arrays": arrays, "block": whole("block", given.get("block", 0))}
    piece["cell_count"] = cell_count
    for name, shape in (("ghost", (cell_count,)), ("degrees", (cell_count, 3))):
        values = given.get(name)
        piece[name] = None if values is None else taken.bytes(name, values, shape)
    ids = given.get("global_ids")
    piece["global_ids"] = None if ids is None else taken.whole("global_ids", ids)
    if ids is not None and piece["global_ids"].shape != (len(points),):
        found = f"shape {piece['global_ids'].shape}"
        raise usage("an array has the wrong shape", found, f"({len(points)},), one a point", "global_ids")
    return piece


def components(name: str, shape: tuple[int, ...], count: int, what: str) -> int:
    """Numbers of a tuple of an array of this shape, with one at each of `count` points or cells."""
    if len(shape) not in (1, 2) or shape[0] != count or shape[-1] == 0 and len(shape) == 2:
        raise usage("an array has the wrong shape", f"shape {tuple(shape)}", f"({count},) or ({count}, k), a row a {what}", name)
    return shape[1] if len(shape) == 2 else 1


def _check_same_arrays(given: Sequence[Mapping[str, Any]], pieces: Sequence[Mapping[str, Any]]) -> None:
    """Refuses pieces whose arrays differ. Those without cells have none that count."""
    first: tuple[str, dict[str, str]] | None = None
    for piece, form in zip(given, pieces):
        if not form["cell_count"]:
            continue
        kinds = {
            name: f"on {'cells' if on_cells else 'points'}, components: {components}"
            for name, _, components, on_cells in form["arrays"]
        }
        own = (piece.get("name", "the grid"), kinds)
        first = first or own
        for (where, has), (other, of_other) in ((own, first), (first, own)):
            for name, kind in of_other.items():
                if name not in has:
                    raise usage(f"{where} lacks the array '{name}'", None, f"the same arrays in every piece: {other} has it")
                if has[name] != kind:
                    raise usage(f"{where} has another array '{name}' than {other}", has[name], kind)


class _Taken:
    """Brings arrays into the form in which they are lent, and notes what is to be watched."""

    def __init__(self) -> None:
        self.sources: list[NDArray[np.uint8]] = []

    def _array(self, name: str, values: Any, kinds: str, expected: str) -> NDArray[Any]:
        try:
            array = np.asarray(values)
        except Exception as error:
            raise usage("an array cannot be made of this", error, expected, name) from error
        # An empty list has no type of its own.
        if array.dtype.kind not in kinds and (array.size or array.dtype.kind != "f"):
            raise usage("an array has the wrong type", f"dtype {array.dtype}", expected, name)
        if np.ma.isMaskedArray(values) and np.ma.is_masked(values):
            raise usage("an array is masked", None, "numbers; NaN where there is none, for quantities", name)
        if array.flags.c_contiguous and array.size:
            self.sources.append(array.reshape(-1).view(np.uint8))
        return array

    def floats(self, name: str, values: Any) -> NDArray[np.float64]:
        array = self._array(name, values, "fiub", "real numbers")
        return np.require(array, np.float64, ["C", "A"])

    def whole(self, name: str, values: Any, narrow: bool = False) -> NDArray[Any]:
        """Whole numbers of 64 bits; `narrow`: those of 32 stay, as unsigned ones."""
        array = self._array(name, values, "iu", "whole numbers")
        if narrow and array.dtype.itemsize == 4 and array.dtype.isnative:
            array = np.require(array, None, ["C", "A"])
            if array.dtype.kind == "i" and array.size and array.min() < 0:
                place = int(np.argmax(array.reshape(-1) < 0))
                raise usage(f"{name}[{place}] is no number of a point", array.reshape(-1)[place], "0 or more")
            return array.view(np.uint32)
        if array.dtype.kind == "u" and array.dtype.itemsize == 8 and array.size and array.max() >> np.uint64(63):
            raise usage("a whole number is out of range", array.max(), f"below {2**63}", name)
        return np.require(array, np.int64, ["C", "A"])

    def bytes(self, name: str, values: Any, shape: tuple[int, ...]) -> NDArray[np.uint8]:
        array = self._array(name, values, "iub", "whole numbers")
        if array.shape != shape:
            raise usage("an array has the wrong shape", f"shape {array.shape}", str(shape), name)
        if array.dtype.kind != "b" and array.size and (array.min() < 0 or array.max() > 255):
            raise usage("a number is out of range", f"{array.min()} to {array.max()}", "0 to 255", name)
        return np.require(array, np.uint8, ["C", "A"])


def _cells(given: Mapping[str, Any], taken: _Taken) -> tuple[dict[str, Any], int]:
    """The cells in the form that is lent, and their number."""
    stated = {name for name in ("tetrahedra", "types", "offsets", "connectivity", "cells") if given.get(name) is not None}
    if stated == {"tetrahedra"}:
        tetrahedra = taken.whole("tetrahedra", given["tetrahedra"], narrow=True)
        if tetrahedra.ndim != 2 or tetrahedra.shape[1] != 4:
            raise usage("the tetrahedra are not four point numbers each", f"shape {tetrahedra.shape}", "(m, 4)")
        if tetrahedra.dtype == np.uint32:
            return {"tetrahedra": tetrahedra}, len(tetrahedra)
        count = len(tetrahedra)
        return {
            "types": np.full(count, 10, np.uint8),
            "offsets": np.arange(0, 4 * count + 1, 4, dtype=np.int64),
            "connectivity": tetrahedra.reshape(-1),
        }, count
    if stated == {"types", "cells"}:
        offsets, connectivity = _unpadded(taken.whole("cells", given["cells"]))
    elif stated == {"types", "offsets", "connectivity"}:
        offsets = taken.whole("offsets", given["offsets"])
        connectivity = taken.whole("connectivity", given["connectivity"], narrow=True)
    else:
        found = ", ".join(sorted(stated)) or "nothing"
        expected = (
            "Grid(points, tetrahedra=cells), Grid(points, cells=cells, types=types), or "
            "Grid(points, types=types, offsets=offsets, connectivity=connectivity)"
        )
        raise usage("the grid's cells are not stated", found, expected)
    types = taken.whole("types", given["types"])
    for name, array in (("types", types), ("offsets", offsets), ("connectivity", connectivity)):
        if array.ndim != 1:
            raise usage("an array has the wrong shape", f"shape {array.shape}", "one dimension", name)
    if types.size and (types.min() < 0 or types.max() > 255):
        raise usage("a cell type is out of range", f"{types.min()} to {types.max()}", "VTK's codes, 0 to 255")
    if len(offsets) != len(types) + 1:
        raise usage("the cells have the wrong number of offsets", len(offsets), f"{len(types) + 1}, one more than types")
    cells = {"types": types.astype(np.uint8), "offsets": offsets, "connectivity": connectivity}
    for name in ("faces", "face_locations"):
        if given.get(name) is not None:
            cells[name] = taken.whole(name, given[name]).reshape(-1)
    return cells, len(types)


def _unpadded(cells: NDArray[Any]) -> tuple[NDArray[Any], NDArray[Any]]:
    """Offsets and connectivity of cells that are preceded by the number of their points."""
    places, counts = [], []
    cells = np.ascontiguousarray(cells).reshape(-1)
    place = 0
    # Cells of one size, as most are, need no loop.
    if len(cells) and 0 < (size := int(cells[0])) and len(cells) % (size + 1) == 0:
        rows = cells.reshape(-1, size + 1)
        if (rows[:, 0] == size).all():
            offsets = np.arange(0, size * len(rows) + 1, size, dtype=np.int64)
            return offsets, np.ascontiguousarray(rows[:, 1:]).reshape(-1)
    while place < len(cells):
        count = int(cells[place])
        if count < 0 or place + 1 + count > len(cells):
            expected = "the number of the cell's points, then these"
            raise usage(f"cells[{place}] is wrong", count, expected)
        places.append(place)
        counts.append(count)
        place += 1 + count
    offsets = np.concatenate([[0], np.cumsum(counts, dtype=np.int64)]).astype(np.int64)
    return offsets, np.delete(cells, places)
