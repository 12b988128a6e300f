"""VTK data sets as grids: arrays shared where their memory is plain, nothing of the data set changed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from itertools import count
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkIdList
from vtkmodules.vtkCommonDataModel import (
    vtkCompositeDataSet,
    vtkDataObject,
    vtkDataSet,
    vtkDataSetAttributes,
    vtkGenericCell,
    vtkMultiBlockDataSet,
    vtkPartitionedDataSet,
    vtkPartitionedDataSetCollection,
    vtkPolyData,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkAppendFilter

from ._errors import usage
from ._grid import Grid

POINT, CELL = vtkDataObject.FIELD_ASSOCIATION_POINTS, vtkDataObject.FIELD_ASSOCIATION_CELLS

_POLYHEDRON = 42
_GHOSTS = vtkDataSetAttributes.GhostArrayName()
#: Names of global ids of points, where none are marked as such.
_GLOBAL_IDS = ("GlobalPointIds", "vtkGlobalPointIds", "GlobalNodeIds", "GlobalNodeId")


def numbers(array: vtkDataArray) -> np.ndarray:
    """An array's numbers: its own memory, or a copy where it has none to share (implicit, affine and structured arrays)."""
    if not array.HasStandardMemoryLayout():
        plain = vtkDataArray.CreateDataArray(array.GetDataType())
        plain.DeepCopy(array)
        array = plain
    return vtk_to_numpy(array)


def _pieces(data: vtkDataObject | None, blocks: Iterator[int]) -> Iterator[tuple[vtkDataSet, int]]:
    """The data sets of a composite one, each with the number of its block: partitions of one data set share theirs."""
    if isinstance(data, vtkDataSet):
        yield data, next(blocks)
    elif isinstance(data, vtkPartitionedDataSet):
        block = next(blocks)
        for i in range(data.GetNumberOfPartitions()):
            if isinstance(part := data.GetPartition(i), vtkDataSet):
                yield part, block
    elif isinstance(data, vtkPartitionedDataSetCollection):
        for i in range(data.GetNumberOfPartitionedDataSets()):
            yield from _pieces(data.GetPartitionedDataSet(i), blocks)
    elif isinstance(data, vtkMultiBlockDataSet):
        for i in range(data.GetNumberOfBlocks()):
            yield from _pieces(data.GetBlock(i), blocks)
    elif isinstance(data, vtkCompositeDataSet):
        for leaf in _leaves(data):
            yield from _pieces(leaf, blocks)


def parts(data: vtkDataObject) -> list[vtkDataSet]:
    """The data sets whose points a grid of these data holds, one after the other."""
    return [part for part, _ in _drawn(data)]


def copy_shallow(data: vtkDataObject, to: vtkDataObject) -> None:
    """Shares all arrays, so that others can be added: partitions, which VTK shares as they are, become objects of their own."""
    to.ShallowCopy(data)
    if isinstance(data, vtkPartitionedDataSet):
        for i in range(data.GetNumberOfPartitions()):
            if (part := data.GetPartition(i)) is not None:
                own = part.NewInstance()
                own.ShallowCopy(part)
                to.SetPartition(i, own)


def _drawn(data: vtkDataObject) -> list[tuple[vtkDataSet, int]]:
    """The data sets with cells, each with the number of its block; none of surfaces beside volumes, as several formats give them."""
    with_cells = [(part, block) for part, block in _pieces(data, count()) if part.GetNumberOfCells()]
    if len(with_cells) < 2:
        return with_cells
    return [(part, block) for part, block in with_cells if _has_volume(part)] or with_cells


def _unstructured(data: vtkDataSet) -> vtkUnstructuredGrid:
    """A data set as an unstructured grid: itself, or its cells as such."""
    if isinstance(data, vtkUnstructuredGrid):
        return data
    append = vtkAppendFilter()
    append.AddInputData(data)
    append.Update()
    return append.GetOutput()


def _has_volume(data: vtkDataSet) -> bool:
    if isinstance(data, vtkPolyData):
        return False
    if not isinstance(data, vtkUnstructuredGrid):
        return True
    cell = vtkGenericCell()
    for code in np.unique(_types(data)):
        cell.SetCellType(int(code))
        if cell.GetCellDimension() == 3:
            return True
    return False


def has_cells(data: vtkDataObject | None) -> bool:
    """Whether a data set, or a part of a composite one, has cells of any kind."""
    parts = _leaves(data) if isinstance(data, vtkCompositeDataSet) else [data]
    return any(isinstance(part, vtkDataSet) and part.GetNumberOfCells() > 0 for part in parts)


def _leaves(data: vtkCompositeDataSet) -> Iterable[vtkDataObject]:
    iterator = data.NewIterator()
    iterator.SkipEmptyNodesOn()
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        yield iterator.GetCurrentDataObject()
        iterator.GoToNextItem()


def grid(
    data: vtkDataObject,
    arrays: Iterable[str] | None = None,
    *,
    scalar: str | None = None,
    association: int | None = None,
    watch: bool = False,
    **options: Any,
) -> Grid:
    """A VTK data set as a grid.

    Parameters
    ----------
    data : vtkDataSet or composite data set
        Unstructured grids share their memory; cells of others are written out.
    arrays : list of str
        The quantities that are taken. Default: all of numbers.
    scalar : str
        The quantity that is drawn where a pipeline names none.
    association : FIELD_ASSOCIATION_POINTS or _CELLS
        Where quantities are looked for that points and cells have. Default: points.
    watch : bool
        Whether changes in place are noticed; VTK's filters go by modified times instead.
    **options
        As of `voltet.Grid`: `subdivision`, `constant_cells`.
    """
    if not isinstance(data, (vtkDataSet, vtkCompositeDataSet)):
        found = "nothing" if data is None else f"a {data.GetClassName()}"
        raise usage("this is no data set with cells", found, "a vtkDataSet, or a composite one of these")
    first = CELL if association == CELL else POINT
    names = list(arrays) if arrays is not None else None
    parts = [(_unstructured(part), block) for part, block in _drawn(data)]
    if not parts:
        raise usage("there is nothing to draw", "a grid without cells", "at least one three-dimensional cell")
    several = len({block for _, block in parts}) > 1
    wheres = [f"block {block}" if several else "the data set" for _, block in parts]
    pieces = [_piece(part, block, names, first, where) for (part, block), where in zip(parts, wheres)]
    if len(pieces) == 1:
        piece = pieces[0]
        del piece["block"], piece["global_ids"]
        return Grid(**piece, scalar=scalar, watch=watch, **options)
    return Grid.from_pieces(pieces, scalar=scalar, watch=watch, **options)


def _piece(given: vtkUnstructuredGrid, block: int, names: list[str] | None, first: int, where: str) -> dict[str, Any]:
    """The arguments of `Grid.from_pieces` for one piece."""
    cells, types = given.GetCells(), _types(given)
    ghosts = given.GetCellData().GetArray(_GHOSTS)
    degrees = given.GetCellData().GetHigherOrderDegrees()
    found = [given.GetPointData().GetGlobalIds(), *map(given.GetPointData().GetArray, _GLOBAL_IDS)]
    ids = next((array for array in found if array is not None), None)
    return {
        "points": numbers(given.GetPoints().GetData()),
        "types": types,
        "offsets": numbers(cells.GetOffsetsArray()),
        "connectivity": numbers(cells.GetConnectivityArray()),
        **_faces(given, types),
        **_quantities(given, names, first, where),
        "ghost": None if ghosts is None else numbers(ghosts),
        "degrees": None if degrees is None else numbers(degrees).astype(np.uint8),
        "global_ids": None if ids is None else numbers(ids),
        "block": block,
    }


def _types(given: vtkUnstructuredGrid) -> np.ndarray:
    # Deprecated where the other gives the array itself.
    plain = isinstance(_call(given.GetCellTypes), vtkDataArray)
    return numbers(given.GetCellTypes() if plain else given.GetCellTypesArray())


def _call(function: Any) -> Any:
    """What a method of newer versions gives; older ones of this name ask for an argument."""
    try:
        return function()
    except TypeError:
        return None


def _quantities(given: vtkUnstructuredGrid, names: list[str] | None, first: int, where: str) -> dict[str, dict[str, np.ndarray]]:
    found: dict[int, dict[str, np.ndarray]] = {POINT: {}, CELL: {}}
    order = (first, POINT + CELL - first)
    for association in order:
        attributes = given.GetAttributes(association)
        for i in range(attributes.GetNumberOfArrays()):
            array = attributes.GetArray(i)
            name = None if array is None else array.GetName()
            if not name or name == _GHOSTS or names is not None and name not in names:
                continue
            if association == order[1] and name in found[first]:
                continue
            found[association][name] = numbers(array)
    if names is not None:
        for name in names:
            if name not in found[POINT] and name not in found[CELL]:
                known = [
                    attributes.GetArrayName(i)
                    for attributes in (given.GetPointData(), given.GetCellData())
                    for i in range(attributes.GetNumberOfArrays())
                ]
                raise usage(f"{where} has no array '{name}'", None, "one of " + ", ".join(map(str, known)) if known else None)
    return {"point_data": found[POINT], "cell_data": found[CELL]}


def _faces(given: vtkUnstructuredGrid, types: np.ndarray) -> dict[str, Any]:
    """Faces of polyhedra, one stream a cell."""
    places = np.flatnonzero(types == _POLYHEDRON)
    if not len(places):
        return {}
    stream: list[int] = []
    locations = np.full(len(types), -1, np.int64)
    ids = vtkIdList()
    for cell in places:
        given.GetFaceStream(int(cell), ids)
        locations[cell] = len(stream)
        stream.extend(ids.GetId(i) for i in range(ids.GetNumberOfIds()))
    return {"faces": np.array(stream, np.int64), "face_locations": locations}


def state(data: vtkDataObject | None, names: Iterable[str]) -> tuple:
    """What changes when points, cells or these arrays do, or VTK gives them other memory: nothing of the memory is read."""
    if isinstance(data, vtkCompositeDataSet):
        names = tuple(names)
        return tuple(state(part, names) for part in _leaves(data))
    if not isinstance(data, vtkUnstructuredGrid):
        return (id(data), None if data is None else data.GetMTime())
    cells, points = data.GetCells(), data.GetPoints()
    objects = [data.GetCellData().GetArray(_GHOSTS)]
    if points is not None and cells is not None:
        objects += [points.GetData(), cells.GetOffsetsArray(), cells.GetConnectivityArray()]
    for name in names:
        objects += [data.GetPointData().GetArray(name), data.GetCellData().GetArray(name)]
    return (data.GetNumberOfCells(), cells and cells.GetMTime(), points and points.GetMTime(), *map(_state, objects))


def _state(array: vtkDataArray | None) -> tuple | None:
    if array is None:
        return None
    plain = array.HasStandardMemoryLayout()
    place = array.GetVoidPointer(0) if plain and array.GetNumberOfValues() else None
    return (array.GetAddressAsString(""), array.GetMTime(), place, array.GetNumberOfValues())
