"""Meshes of other packages as the arguments of `Grid`: PyVista, VTK, meshio, xarray (UGRID), mappings and arrays of numpy."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import TYPE_CHECKING, Any

import numpy as np

from ._errors import usage

if TYPE_CHECKING:
    from numpy.typing import NDArray

#: What can be drawn, for messages.
EXPECTED = (
    "a voltet.Grid, a PyVista, VTK or meshio mesh, an xarray.Dataset of UGRID, a mapping of the arguments of voltet.Grid, or a "
    "three-dimensional array"
)

#: VTK's codes of meshio's volume cells, which have VTK's order of points (a wedge its mirror image).
_MESHIO = {
    "tetra": 10, "hexahedron": 12, "wedge": 13, "pyramid": 14, "penta_prism": 15, "hexa_prism": 16, "tetra10": 24, "hexahedron20": 25,
    "wedge15": 26, "pyramid13": 27, "hexahedron27": 29, "wedge12": 31, "wedge18": 32, "hexahedron24": 33, "VTK_LAGRANGE_TETRAHEDRON": 71,
    "VTK_LAGRANGE_HEXAHEDRON": 72, "VTK_LAGRANGE_WEDGE": 73, "VTK_LAGRANGE_PYRAMID": 74,
}

#: VTK's codes of UGRID's volumes by their number of points.
_UGRID = {4: 10, 5: 14, 6: 13, 8: 12}


#: Arrays of xarray without a mesh.
_REGULAR = "of a regular grid, the values: array.to_numpy()"


def pieces_of(mesh: Any) -> tuple[list[dict[str, Any]], str | None, list[str]]:
    """A mesh as pieces of a grid, the scalar that it marks, and what was left out, in sentences."""
    from ._grid import Grid, package_of

    if isinstance(mesh, Grid):
        return mesh._pieces, mesh._options["scalar"], []
    if isinstance(mesh, np.ndarray):
        return [_of_array(mesh)], "values", []
    package = package_of(mesh)
    if package == "meshio":
        piece, notes = _of_meshio(mesh)
        return [piece], None, notes
    if package == "xarray":
        piece, notes = _of_ugrid(mesh)
        return [piece], None, notes
    if isinstance(mesh, (str, PathLike)):
        raise usage("a path is no mesh", repr(str(mesh)), "the mesh: pyvista.read(path) or meshio.read(path); or a pipeline with the node 'reader'")
    if not hasattr(mesh, "GetClassName"):
        raise usage("this is no mesh", f"a {type(mesh).__module__}.{type(mesh).__qualname__}", EXPECTED)
    from . import _vtk_grid

    pieces, notes = _vtk_grid.pieces_of(mesh)
    return pieces, _active_scalar(mesh, pieces), notes


def _active_scalar(mesh: Any, pieces: Sequence[Mapping[str, Any]]) -> str | None:
    """The active scalars of a data set, where they have one component."""
    for attributes in ("GetPointData", "GetCellData"):
        found = getattr(mesh, attributes)().GetScalars() if hasattr(mesh, attributes) else None
        if found is not None and found.GetNumberOfComponents() == 1 and found.GetName():
            name = str(found.GetName())
            if any(name in pieces[0][key] for key in ("point_data", "cell_data")):
                return name
    return None


def _of_array(values: NDArray[Any]) -> dict[str, Any]:
    """Values at the points of a regular grid: `values[i, j, k]` stands at (i, j, k)."""
    if values.ndim != 3 or min(values.shape) < 2:
        raise usage("an array is no volume", f"shape {values.shape}", "three dimensions, of 2 or more points each")
    points = np.stack(np.meshgrid(*map(np.arange, values.shape), indexing="ij"), -1).reshape(-1, 3).astype(float)
    number = np.arange(values.size, dtype=np.int64).reshape(values.shape)
    x, y, z = (count - 1 for count in values.shape)
    # VTK's order of a hexahedron.
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = np.stack([number[i : x + i, j : y + j, k : z + k].reshape(-1) for i, j, k in corners], -1)
    return {**_rows([(12, cells)]), "points": points, "point_data": {"values": values.reshape(-1)}}


def _rows(blocks: Sequence[tuple[int, NDArray[Any]]]) -> dict[str, NDArray[Any]]:
    """Types, offsets and connectivity of blocks of cells, each of one type, a row a cell."""
    sizes = np.concatenate([np.full(len(rows), rows.shape[1], np.int64) for _, rows in blocks])
    return {
        "types": np.concatenate([np.full(len(rows), code, np.uint8) for code, rows in blocks]),
        "offsets": np.concatenate([[0], np.cumsum(sizes)]).astype(np.int64),
        "connectivity": np.concatenate([np.asarray(rows, np.int64).reshape(-1) for _, rows in blocks]),
    }


def _of_meshio(mesh: Any) -> tuple[dict[str, Any], list[str]]:
    """A meshio.Mesh: its volume cells."""
    is_known = [block.type in _MESHIO or block.type.startswith("polyhedron") for block in mesh.cells]
    taken = [i for i, block in enumerate(mesh.cells) if is_known[i] and len(block.data)]
    passed = [block for block, known in zip(mesh.cells, is_known) if not known]
    notes = []
    for has_volume, reason in ((False, "only volume cells are drawn"), (True, "their type is not known")):
        if names := sorted({block.type for block in passed if (block.dim == 3) is has_volume}):
            notes.append(f"passed over, as {reason}: cells of type {', '.join(names)}")
    if not taken:
        found = ", ".join(sorted({block.type for block in passed})) or "a mesh without cells"
        raise usage("there is nothing to draw", found, f"cells of type {', '.join(_MESHIO)}, polyhedron")
    rows: list[tuple[int, NDArray[Any]]] = []
    faces: list[int] = []
    places: list[int] = []
    for block in (mesh.cells[i] for i in taken):
        if block.type in _MESHIO:
            rows.append((_MESHIO[block.type], np.asarray(block.data)))
            places += [-1] * len(block.data)
            continue
        for cell in block.data:
            rows.append((42, np.unique(np.concatenate(cell))[None]))
            places.append(len(faces))
            faces += [len(cell), *(number for face in cell for number in (len(face), *face))]
    piece = {
        **_rows(rows),
        **({"faces": np.asarray(faces, np.int64), "face_locations": np.asarray(places, np.int64)} if faces else {}),
        "points": np.asarray(mesh.points),
        "point_data": dict(mesh.point_data),
        "cell_data": {name: np.concatenate([np.asarray(values[i]) for i in taken]) for name, values in mesh.cell_data.items()},
    }
    return piece, notes


def _of_ugrid(data: Any) -> tuple[dict[str, Any], list[str]]:
    """An xarray.Dataset with a three-dimensional topology by the UGRID conventions (Jagers et al., UGRID 1.0)."""
    if not hasattr(data, "data_vars"):
        raise usage("this is no data set of xarray", f"a {type(data).__qualname__}", f"an xarray.Dataset, which holds the mesh, too; {_REGULAR}")
    meshes = {name: array.attrs for name, array in data.variables.items() if array.attrs.get("cf_role") == "mesh_topology"}
    volumes = {name: about for name, about in meshes.items() if _whole(about.get("topology_dimension")) == 3}
    if len(volumes) != 1:
        found = ", ".join(f"'{name}' of {about.get('topology_dimension')} dimensions" for name, about in meshes.items())
        raise usage("the data set has no mesh of volumes, or several", found or "no mesh_topology", f"one of topology_dimension 3; {_REGULAR}")
    (mesh, about), = volumes.items()

    def named(key: str) -> list[Any]:
        names = str(about.get(key, "")).split()
        if not names or any(name not in data.variables for name in names):
            raise usage(f"the mesh '{mesh}' does not state its {key}", " ".join(names) or None, "names of variables of the data set")
        return [data.variables[name] for name in names]

    axes = named("node_coordinates")
    if len(axes) != 3:
        raise usage(f"the points of the mesh '{mesh}' are not three numbers each", f"{len(axes)} node_coordinates", "x, y and z")
    if axes[0].ndim != 1 or any(axis.dims != axes[0].dims for axis in axes):
        found = ", ".join(f"({', '.join(map(str, axis.dims))})" for axis in axes)
        raise usage(f"the node_coordinates of the mesh '{mesh}' are not along the nodes", f"dimensions {found}", "one dimension, the same of all")
    (table,) = named("volume_node_connectivity")[:1]
    if table.ndim != 2:
        found = f"dimensions ({', '.join(map(str, table.dims))})"
        raise usage(f"the volume_node_connectivity of the mesh '{mesh}' is no table", found, "two dimensions: volumes, and their points")
    points = np.stack([np.asarray(axis.values, float) for axis in axes], -1)
    # xarray makes floats with NaN of whole numbers with a fill value, unless it is told not to.
    numbers = np.asarray(table.values)
    absent = ~np.isfinite(numbers) if numbers.dtype.kind == "f" else np.zeros(numbers.shape, bool)
    if (fill := table.attrs.get("_FillValue")) is not None:
        absent |= numbers == fill
    if about.get("volume_dimension") == table.dims[1]:
        numbers, absent = numbers.T, absent.T
    numbers = np.where(absent, 0, numbers).astype(np.int64)
    first = table.attrs.get("start_index", 0)
    if _whole(first) not in (0, 1):
        raise usage(f"the mesh '{mesh}' counts its points from an unknown start_index", repr(first), "0 or 1")
    numbers -= _whole(first)
    counts = (~absent).sum(axis=1)
    if unknown := sorted(set(counts.tolist()) - _UGRID.keys()):
        raise usage(f"the mesh '{mesh}' has a volume of a number of points that is not known", unknown[0], "4, 5, 6 or 8 points")
    sizes = np.concatenate([[0], np.cumsum(counts)]).astype(np.int64)
    codes = np.zeros(9, np.uint8)
    codes[list(_UGRID)] = list(_UGRID.values())
    at_points, at_cells = axes[0].dims[0], table.dims[1 if about.get("volume_dimension") == table.dims[1] else 0]
    # Other attributes hold names of dimensions, and words for people.
    own = {name for key in about if key.endswith(("_connectivity", "_coordinates")) for name in str(about[key]).split()} | {mesh}
    values = {name: array for name, array in data.variables.items() if name not in own and array.dtype.kind in "fiub"}
    piece = {
        "points": points,
        "types": codes[counts],
        "offsets": sizes,
        "connectivity": numbers[~absent],
        "point_data": {str(name): array.values for name, array in values.items() if array.dims == (at_points,)},
        "cell_data": {str(name): array.values for name, array in values.items() if array.dims == (at_cells,)},
    }
    left = sorted(str(name) for name, array in values.items() if array.dims not in ((at_points,), (at_cells,)))
    return piece, [f"left out, as they are not one number a point or volume: {', '.join(left)} (isel(time=0) takes one step)"] if left else []


def _whole(attribute: Any) -> int | None:
    """A whole number of an attribute, where it is one."""
    try:
        found = int(attribute)
        return found if found == float(attribute) else None
    except (TypeError, ValueError, OverflowError):
        return None
