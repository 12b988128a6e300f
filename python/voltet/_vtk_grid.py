"""VTK data sets as grids: arrays shared where their memory is plain, nothing of the data set changed."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from itertools import count
from typing import Any, NamedTuple

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkDataArray, vtkIdList
from vtkmodules.vtkCommonDataModel import (
    vtkCompositeDataSet,
    vtkDataObject,
    vtkDataSet,
    vtkDataSetAttributes,
    vtkGenericCell,
    vtkImageData,
    vtkMultiBlockDataSet,
    vtkPartitionedDataSet,
    vtkPartitionedDataSetCollection,
    vtkPolyData,
    vtkRectilinearGrid,
    vtkStructuredGrid,
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


class Part(NamedTuple):
    """A data set of a composite one, or all of one that is not."""

    data: vtkDataSet
    #: Number of its block: partitions of one data set share theirs.
    block: int
    #: Where it is, for messages.
    where: str


def _parts(data: vtkDataObject | None, blocks: Iterator[int], path: tuple[str, ...] = ()) -> Iterator[Part]:
    """The data sets of a composite one."""
    if isinstance(data, vtkDataSet):
        yield Part(data, next(blocks), ", ".join(path) or "the data set")
    elif isinstance(data, vtkPartitionedDataSet):
        block = next(blocks)
        for i in range(data.GetNumberOfPartitions()):
            if isinstance(part := data.GetPartition(i), vtkDataSet):
                yield Part(part, block, ", ".join([*path, f"partition {i}"]))
    elif isinstance(data, (vtkPartitionedDataSetCollection, vtkMultiBlockDataSet)):
        is_multi_block = isinstance(data, vtkMultiBlockDataSet)
        for i in range(data.GetNumberOfBlocks() if is_multi_block else data.GetNumberOfPartitionedDataSets()):
            block = data.GetBlock(i) if is_multi_block else data.GetPartitionedDataSet(i)
            about = data.GetMetaData(i) if data.HasMetaData(i) else None
            name = about.Get(vtkCompositeDataSet.NAME()) if about and about.Has(vtkCompositeDataSet.NAME()) else None
            yield from _parts(block, blocks, (*path, f"block {i}" + (f" '{name}'" if name else "")))
    elif isinstance(data, vtkCompositeDataSet):
        for i, leaf in enumerate(_leaves(data)):
            yield from _parts(leaf, blocks, (*path, f"part {i}"))


def parts(data: vtkDataObject | None) -> tuple[list[Part], list[Part]]:
    """The data sets whose points a grid of these data holds, one after the other; and those without volume cells that are passed
    over beside them, as several formats give surfaces."""
    with_cells = [part for part in _parts(data, count()) if part.data.GetNumberOfCells()]
    if len(with_cells) < 2:
        return with_cells, []
    has_volume = [_has_volume(part.data) for part in with_cells]
    if not any(has_volume):
        return with_cells, []
    drawn, passed = ([part for part, has in zip(with_cells, has_volume) if has is kind] for kind in (True, False))
    return drawn, passed


def copy_shallow(data: vtkDataObject, to: vtkDataObject) -> None:
    """Shares all arrays, so that others can be added: data sets of composite ones become objects of their own."""
    if not isinstance(data, vtkCompositeDataSet):
        to.ShallowCopy(data)
        return
    to.CopyStructure(data)
    iterator = data.NewIterator()
    iterator.InitTraversal()
    while not iterator.IsDoneWithTraversal():
        own = iterator.GetCurrentDataObject().NewInstance()
        own.ShallowCopy(iterator.GetCurrentDataObject())
        to.SetDataSet(iterator, own)
        iterator.GoToNextItem()
    to.GetFieldData().ShallowCopy(data.GetFieldData())


def array_names(data: vtkDataSet, association: int) -> list[str]:
    """The arrays of numbers on points or cells."""
    attributes = data.GetAttributes(association)
    arrays = (attributes.GetArray(i) for i in range(attributes.GetNumberOfArrays()))
    names = [array.GetName() for array in arrays if array is not None]
    return [name for name in dict.fromkeys(names) if name and name != _GHOSTS]


def find_array(among: Sequence[Part], name: str, associations: Sequence[int]) -> int:
    """Whether all parts have an array on points or on cells: the first of these associations where they have it."""
    has = {place: [part.data.GetAttributes(place).GetArray(name) is not None for part in among] for place in associations}
    for place in associations:
        if all(has[place]):
            return place
    place = max(associations, key=lambda place: sum(has[place]))
    lacking = among[has[place].index(False)]
    words: dict[int, str] = {POINT: " on points", CELL: " on cells"}
    known = [f"'{name}'{words[other]}" for other in words for name in array_names(lacking.data, other)]
    what = f"{lacking.where} has no array '{name}'" + (words[place] if len(associations) == 1 or any(has[place]) else "")
    raise usage(what, None, "one of " + ", ".join(known) if known else "arrays on points or cells")


def common_arrays(among: Sequence[Part], first: int = POINT) -> dict[str, int]:
    """The arrays that all parts have, each on points or on cells; `first`: where one is taken that both have."""
    found: dict[str, int] = {}
    if not among:
        return found
    for place in (first, POINT + CELL - first):
        for name in array_names(among[0].data, place):
            if all(part.data.GetAttributes(place).GetArray(name) is not None for part in among):
                found.setdefault(name, place)
    return found


def _unstructured(data: vtkDataSet) -> vtkUnstructuredGrid:
    """A data set as an unstructured grid: itself, or its cells as such."""
    if isinstance(data, vtkUnstructuredGrid):
        return data
    append = vtkAppendFilter()
    append.AddInputData(data)
    append.Update()
    return append.GetOutput()


def _has_volume(data: vtkDataSet) -> bool:
    if isinstance(data, (vtkImageData, vtkRectilinearGrid, vtkStructuredGrid)):
        return data.GetDataDimension() == 3
    if not isinstance(data, vtkUnstructuredGrid):
        return not isinstance(data, vtkPolyData)
    cell = vtkGenericCell()
    for code in np.unique(_types(data)):
        cell.SetCellType(int(code))
        if cell.GetCellDimension() == 3:
            return True
    return False


def has_cells(data: vtkDataObject | None) -> bool:
    """Whether a data set, or a part of a composite one, has cells of any kind."""
    return any(part.data.GetNumberOfCells() > 0 for part in _parts(data, count()))


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
        The quantities that are taken. Default: all of numbers that every block and partition has.
    scalar : str
        The quantity that is drawn where a pipeline names none.
    association : FIELD_ASSOCIATION_POINTS or _CELLS
        Where quantities are looked for that points and cells have. Default: points.
    watch : bool
        Whether changes in place are noticed; VTK's filters go by modified times instead.
    **options
        As of `voltet.Grid`: `subdivision`, `constant_cells`.
    """
    pieces, notes = pieces_of(data, arrays, association)
    return Grid._of_pieces(pieces, scalar=scalar, watch=watch, warnings=notes, **options)


def pieces_of(
    data: vtkDataObject, arrays: Iterable[str] | None = None, association: int | None = None
) -> tuple[list[dict[str, Any]], list[str]]:
    """The arguments of `Grid.from_pieces` for a data set, and what was left out, in sentences."""
    if not isinstance(data, (vtkDataSet, vtkCompositeDataSet)):
        found = "nothing" if data is None else f"a {data.GetClassName()}"
        raise usage("this is no data set with cells", found, "a vtkDataSet, or a composite one of these")
    first = CELL if association == CELL else POINT
    drawn, passed = parts(data)
    if not drawn:
        raise usage("there is nothing to draw", "a grid without cells", "at least one three-dimensional cell")
    notes = []
    if passed:
        of_all = f"{len(passed)} of {len(drawn) + len(passed)} parts"
        notes.append(f"passed over, as they have no volume cells: {of_all} ({_listed(part.where for part in passed)})")
    if arrays is None:
        places = common_arrays(drawn, first)
        every = [name for part in drawn for place in (POINT, CELL) for name in array_names(part.data, place)]
        others = [f"'{name}'" for name in dict.fromkeys(every) if name not in places]
        if others and not places:
            expected = "one that all have; those of cells become arrays on points by cell_data_to_point_data"
            raise usage(f"no array is on all of the {len(drawn)} parts", _listed(others), expected)
        if others:
            of_all = f"{len(others)} of {len(others) + len(places)} arrays"
            notes.append(f"left out, as not all parts have them: {of_all} ({_listed(others)})")
    else:
        places = {name: find_array(drawn, name, (first, POINT + CELL - first)) for name in arrays}
    return [_piece(part, places) for part in drawn], notes


def _listed(names: Iterable[str]) -> str:
    """The first few of some names."""
    names = list(names)
    return "; ".join(names[:5]) + ("; …" if len(names) > 5 else "")


def _piece(part: Part, places: Mapping[str, int]) -> dict[str, Any]:
    """The arguments of `Grid.from_pieces` for one piece; `places`: its arrays, on points or cells."""
    given = _unstructured(part.data)
    cells, types = given.GetCells(), _types(given)
    ghosts = given.GetCellData().GetArray(_GHOSTS)
    degrees = given.GetCellData().GetHigherOrderDegrees()
    found = [given.GetPointData().GetGlobalIds(), *map(given.GetPointData().GetArray, _GLOBAL_IDS)]
    ids = next((array for array in found if array is not None), None)
    quantities: dict[int, dict[str, np.ndarray]] = {POINT: {}, CELL: {}}
    for name, place in places.items():
        quantities[place][name] = numbers(given.GetAttributes(place).GetArray(name))
    return {
        "points": numbers(given.GetPoints().GetData()),
        "types": types,
        "offsets": numbers(cells.GetOffsetsArray()),
        "connectivity": numbers(cells.GetConnectivityArray()),
        **_faces(given, types),
        "point_data": quantities[POINT],
        "cell_data": quantities[CELL],
        "ghost": None if ghosts is None else numbers(ghosts),
        "degrees": None if degrees is None else numbers(degrees).astype(np.uint8),
        "global_ids": None if ids is None else numbers(ids),
        "block": part.block,
        "name": part.where,
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
