"""VTK data sets as grids: arrays shared where their memory is plain, nothing of the data set changed."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkIdList
from vtkmodules.vtkCommonDataModel import (
    vtkCompositeDataSet,
    vtkDataObject,
    vtkDataSet,
    vtkDataSetAttributes,
    vtkPartitionedDataSet,
    vtkUnstructuredGrid,
)
from vtkmodules.vtkFiltersCore import vtkAppendFilter

from ._errors import usage
from ._grid import Grid

POINT, CELL = vtkDataObject.FIELD_ASSOCIATION_POINTS, vtkDataObject.FIELD_ASSOCIATION_CELLS

_POLYHEDRON = 42
_GHOSTS = vtkDataSetAttributes.GhostArrayName()
#: Cells that another piece draws, that a finer one replaces, or that are blanked.
_LEFT_OUT = vtkDataSetAttributes.DUPLICATECELL | vtkDataSetAttributes.REFINEDCELL | vtkDataSetAttributes.HIDDENCELL


def numbers(array: vtkDataArray) -> np.ndarray:
    """An array's numbers: its own memory, or a copy where it has none to share (implicit, affine and structured arrays)."""
    if not array.HasStandardMemoryLayout():
        plain = vtkDataArray.CreateDataArray(array.GetDataType())
        plain.DeepCopy(array)
        array = plain
    return vtk_to_numpy(array)


def unstructured(data: vtkDataObject | None) -> vtkUnstructuredGrid:
    """A data set as an unstructured grid: itself, its cells as such, or all parts of a composite one together.

    Points of the partitions of one data set that lie at the same place become one; blocks keep their own."""
    if isinstance(data, vtkUnstructuredGrid):
        return data
    append = vtkAppendFilter()
    if isinstance(data, vtkDataSet):
        append.AddInputData(data)
    elif isinstance(data, vtkCompositeDataSet):
        append.SetMergePoints(isinstance(data, vtkPartitionedDataSet))
        parts = [part for part in _leaves(data) if isinstance(part, vtkDataSet) and part.GetNumberOfCells()]
        if not parts:
            raise usage("there is nothing to draw", "a composite data set without cells", "at least one three-dimensional cell")
        for part in parts:
            append.AddInputData(part)
    else:
        found = "nothing" if data is None else f"a {data.GetClassName()}"
        raise usage("this is no data set with cells", found, "a vtkDataSet, or a composite one of these")
    append.Update()
    return append.GetOutput()


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
    given = unstructured(data)
    points = given.GetPoints()
    if points is None or given.GetNumberOfCells() == 0:
        raise usage("there is nothing to draw", "a grid without cells", "at least one three-dimensional cell")
    cells = given.GetCells()
    # Deprecated where the other gives the array itself.
    types = given.GetCellTypes() if isinstance(_call(given.GetCellTypes), vtkDataArray) else given.GetCellTypesArray()
    types = numbers(types)
    names = list(arrays) if arrays is not None else None
    taken: dict[str, Any] = _quantities(given, names, CELL if association == CELL else POINT)
    ghosts = given.GetCellData().GetArray(_GHOSTS)
    degrees = given.GetCellData().GetHigherOrderDegrees()
    return Grid(
        numbers(points.GetData()),
        types=types,
        offsets=numbers(cells.GetOffsetsArray()),
        connectivity=numbers(cells.GetConnectivityArray()),
        **_faces(given, types),
        **taken,
        scalar=scalar,
        ghost=None if ghosts is None else numbers(ghosts) & _LEFT_OUT,
        degrees=None if degrees is None else numbers(degrees).astype(np.uint8),
        watch=watch,
        **options,
    )


def _call(function: Any) -> Any:
    """What a method of newer versions gives; older ones of this name ask for an argument."""
    try:
        return function()
    except TypeError:
        return None


def _quantities(given: vtkUnstructuredGrid, names: list[str] | None, first: int) -> dict[str, dict[str, np.ndarray]]:
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
                raise usage(f"the data set has no array '{name}'", None, "one of " + ", ".join(map(str, known)) if known else None)
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
