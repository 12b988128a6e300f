"""A grid in pieces is the grid that was cut, by every door: files, pieces of arrays, partitions of VTK."""

import numpy as np
import pytest

vtk = pytest.importorskip("vtk")
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: E402

import voltet  # noqa: E402
import voltet.vtk as vv  # noqa: E402

N = 6
CORNERS = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def whole():
    """Hexahedra and wedges: points, cells, values at points and at cells."""
    axis = np.linspace(0.0, 1.0, N + 1)
    z, y, x = np.meshgrid(axis, axis, axis, indexing="ij")
    points = np.stack([x, y, z], -1).reshape(-1, 3)
    cells = []
    for number in range(N**3):
        i, j, k = number % N, number // N % N, number // N**2
        a, b, c, d, e, f, g, h = [i + u + (N + 1) * (j + v + (N + 1) * (k + w)) for u, v, w in CORNERS]
        # A wedge's triangles are cut as the hexahedron's quadrilateral, from its lowest corner.
        cells += [(12, [a, b, c, d, e, f, g, h])] if number % 3 else [(13, [a, b, c, e, f, g]), (13, [a, c, d, e, g, h])]
    s = np.sin(5 * points[:, 0]) * np.cos(4 * points[:, 1]) + points[:, 2]
    centre = np.array([points[corners].mean(0) for _, corners in cells])
    return points, cells, s, np.sin(9 * centre[:, 0]) + centre[:, 1], centre


def cut(count, way, ids, ghosts):
    """Arguments of `Grid.from_pieces`, cells in the grid's order within each piece."""
    points, cells, s, at_cells, centre = whole()
    if way == "slabs":
        part = np.minimum((centre[:, 2] * count).astype(int), count - 1)
    else:
        part = np.random.default_rng(3).integers(0, count, len(cells))
    pieces = []
    for own in range(count):
        touched = {p for (_, corners), q in zip(cells, part) if q == own for p in corners}
        kept = [i for i in range(len(cells)) if part[i] == own or ghosts and touched & set(cells[i][1])]
        used = sorted({p for i in kept for p in cells[i][1]})
        number = {p: n for n, p in enumerate(used)}
        piece = {
            "points": points[used],
            "types": np.array([cells[i][0] for i in kept], np.uint8),
            "offsets": np.cumsum([0] + [len(cells[i][1]) for i in kept]),
            "connectivity": np.array([number[p] for i in kept for p in cells[i][1]]),
            "point_data": {"s": s[used]},
            "cell_data": {"c": at_cells[kept]},
            "ghost": np.array([part[i] != own for i in kept], np.uint8) if ghosts else None,
            "global_ids": np.array(used) * 3 + 5 if ids else None,
        }
        pieces.append(piece)
    return pieces


def unstructured(piece):
    data = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(piece["points"], deep=True))
    data.SetPoints(points)
    cells = vtk.vtkCellArray()
    cells.SetData(*(numpy_to_vtk(piece[name].astype(np.int64), deep=True) for name in ("offsets", "connectivity")))
    data.SetCells(numpy_to_vtk(piece["types"], deep=True), cells)

    def add(attributes, name, values):
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
        array.SetName(name)
        attributes.AddArray(array)
        return array

    add(data.GetPointData(), "s", piece["point_data"]["s"])
    add(data.GetCellData(), "c", piece["cell_data"]["c"])
    if piece["ghost"] is not None:
        add(data.GetCellData(), "vtkGhostType", piece["ghost"])
    if piece["global_ids"] is not None:
        data.GetPointData().SetGlobalIds(add(data.GetPointData(), "numbers", piece["global_ids"].astype(np.int64)))
    return data


def write(folder, pieces):
    """A .pvtu with its pieces, and one .vtu with all of them as elements."""
    elements = []
    for number, piece in enumerate(pieces):
        writer = vtk.vtkXMLUnstructuredGridWriter()
        writer.SetFileName(str(folder / f"{number}.vtu"))
        writer.SetInputData(unstructured(piece))
        writer.SetDataModeToAscii()
        writer.Write()
        text = (folder / f"{number}.vtu").read_text()
        elements.append(text[text.index("<Piece") : text.index("</Piece>") + len("</Piece>")])
    sources = "".join(f'<Piece Source="{number}.vtu"/>' for number in range(len(pieces)))
    (folder / "pieces.pvtu").write_text(
        f'<VTKFile type="PUnstructuredGrid" version="1.0"><PUnstructuredGrid>{sources}</PUnstructuredGrid></VTKFile>'
    )
    (folder / "pieces.vtu").write_text(
        '<VTKFile type="UnstructuredGrid" version="2.2" byte_order="LittleEndian" header_type="UInt64"><UnstructuredGrid>'
        + "".join(elements)
        + "</UnstructuredGrid></VTKFile>"
    )
    return [folder / "pieces.pvtu", folder / "pieces.vtu"]


CAMERA = {"eye": [1.9, -2.2, 1.7], "target": [0.5, 0.5, 0.5], "up": [0, 0, 1], "fov_y": 30.0}
SIZE = (48, 40)


def widgets(scalar):
    if scalar == "s":
        return [voltet.widgets.gaussian(color=[1, 0.5, 0.2], extinction=6.0, centre=[0.6, 3.0], sigma=[0.3, 1.0])]
    return [voltet.widgets.gaussian(color=[0.2, 0.5, 1], extinction=6.0, centre=[0.9, 4.0], sigma=[0.3, 3.0])]


def drawn(pipeline, scalar):
    pipeline.add("gradient", "gradient-magnitude", grid="grid")
    pipeline.add("look", "transfer-function", widgets=widgets(scalar), unit_distance=1.0)
    pipeline.add("view", "camera", **CAMERA, size=list(SIZE))
    pipeline.add("picture", "renderer", engine="cpu", volume="gradient", transfer_function="look", camera="view")
    return np.asarray(pipeline.render("picture"))


def of_grid(grid, scalar):
    pipeline = voltet.Pipeline()
    pipeline.add("grid", "given-grid", scalar=scalar)
    pipeline.give(grid)
    return drawn(pipeline, scalar)


def of_file(path, scalar):
    pipeline = voltet.Pipeline()
    pipeline.add("grid", "reader", path=str(path), scalar=scalar)
    return drawn(pipeline, scalar)


def partitioned(pieces):
    data = vtk.vtkPartitionedDataSet()
    for number, piece in enumerate(pieces):
        data.SetPartition(number, unstructured(piece))
    return data


def of_vtk(data, scalar):
    renderer = vv.VoltetRenderer()
    renderer.SetInputData(data)
    renderer.SetInputArrayToProcess(0, 0, 0, 0 if scalar == "s" else 1, scalar)
    renderer.SetWidgets(widgets(scalar))
    renderer.SetUnitDistance(1.0)
    renderer.SetSize(*SIZE)
    renderer.SetParameter("picture.engine", "cpu")
    renderer.SetOutputScalarTypeToFloat()
    camera = vtk.vtkCamera()
    camera.SetPosition(*CAMERA["eye"])
    camera.SetFocalPoint(*CAMERA["target"])
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(CAMERA["fov_y"])
    renderer.SetCamera(camera)
    renderer.Update()
    values = vtk_to_numpy(renderer.GetOutput().GetPointData().GetScalars())
    return values.reshape(SIZE[1], SIZE[0], 4)[::-1]


WAYS = [(count, way, ids, ghosts) for count in (2, 8, 64) for way in ("slabs", "scattered") for ids in (0, 1) for ghosts in (0, 1)]


@pytest.mark.parametrize("count, way, ids, ghosts", WAYS)
@pytest.mark.parametrize("scalar", ["s", "c"])
def test_pieces_are_one_grid(tmp_path, count, way, ids, ghosts, scalar):
    if count == 64 and way == "slabs":
        count = N
    (one,) = cut(1, way, False, False)
    one.pop("global_ids")
    expected = of_grid(voltet.Grid(**one), scalar)
    assert expected[..., 3].max() > 0.3
    pieces = cut(count, way, ids, ghosts)
    doors = {"from_pieces": of_grid(voltet.Grid.from_pieces(pieces), scalar), "VTK": of_vtk(partitioned(pieces), scalar)}
    for path in write(tmp_path, pieces):
        doors[path.name] = of_file(path, scalar)
    for door, found in doors.items():
        assert np.abs(found - expected).max() <= 1e-6, door


def test_an_array_that_jumps_between_pieces_parts_only_the_points_of_its_own_picture():
    pieces = cut(3, "scattered", False, False)
    expected = of_grid(voltet.Grid.from_pieces(pieces), "s")
    for number, piece in enumerate(pieces):
        piece["point_data"] = {**piece["point_data"], "rank": np.full(len(piece["points"]), float(number))}
    grid = voltet.Grid.from_pieces(pieces)
    assert grid.point_count == sum(len(piece["points"]) for piece in pieces)
    assert np.array_equal(of_grid(grid, "s"), expected)


@pytest.mark.parametrize("ghosts", [False, True])
@pytest.mark.parametrize("ids", [False, True])
@pytest.mark.parametrize("scalar", ["s", "c"])
def test_the_gradient_of_pieces_is_that_of_the_grid(scalar, ids, ghosts):
    def gradients(data):
        g = vv.VoltetGradientMagnitude()
        g.SetInputData(data)
        g.SetInputArrayToProcess(0, 0, 0, 0 if scalar == "s" else 1, scalar)
        g.SetComputeGradient(True)
        g.Update()
        return g.GetOutputDataObject(0)

    (one,) = cut(1, "slabs", False, False)
    found = gradients(unstructured(one)).GetPointData()
    points = {tuple(point): row for row, point in enumerate(one["points"])}
    pieces = cut(3, "scattered", ids, ghosts)
    data = partitioned(pieces)
    output = gradients(data)
    assert output.GetNumberOfPartitions() == 3
    given = voltet.Pipeline()
    given.add("grid", "given-grid", scalar=scalar)
    given.add("gradient", "gradient-magnitude", grid="grid")
    given.give(voltet.Grid.from_pieces(pieces))
    values = given.volume("gradient", gradient=True)
    begin = 0
    for i in range(3):
        part = output.GetPartition(i)
        rows = [points[tuple(point)] for point in vtk_to_numpy(part.GetPoints().GetData())]
        for name in ("gradient_magnitude", "gradient"):
            of_part, of_whole = (vtk_to_numpy(where.GetArray(f"{scalar}_{name}")) for where in (part.GetPointData(), found))
            for own in (of_part, values[name][begin : begin + len(rows)]):
                assert np.abs(own - of_whole[rows]).max() <= 1e-11, name
        begin += len(rows)
        # The input stays as it was.
        assert data.GetPartition(i).GetPointData().GetArray(f"{scalar}_gradient") is None
    assert begin == len(values["gradient"])


def blocks(*named):
    """A multi-block data set of blocks by name."""
    data = vtk.vtkMultiBlockDataSet()
    for number, (name, block) in enumerate(named):
        data.SetBlock(number, block)
        data.GetMetaData(number).Set(vtk.vtkCompositeDataSet.NAME(), name)
    return data


def inlet():
    source = vtk.vtkSphereSource()
    source.Update()
    return source.GetOutput()


def outlet():
    """A surface of triangles in an unstructured grid, as readers of Exodus give it, without the arrays of volumes."""
    append = vtk.vtkAppendFilter()
    append.AddInputData(inlet())
    append.Update()
    return append.GetOutput()


def wall():
    """A side of a structured block, as readers of CGNS give it."""
    grid = vtk.vtkStructuredGrid()
    grid.SetDimensions(3, 3, 1)
    points = vtk.vtkPoints()
    for i in range(9):
        points.InsertNextPoint(i % 3, i // 3, 0)
    grid.SetPoints(points)
    return grid


def halves():
    return [unstructured(piece) for piece in cut(2, "slabs", False, False)]


def test_blocks_stay_apart_and_surfaces_are_passed_over_and_counted():
    pieces = cut(2, "slabs", False, False)
    lower, upper = halves()
    nested = blocks(("inlet", inlet()), ("upper", upper), ("outlet", outlet()))
    data = blocks(("inlet", inlet()), ("wall", wall()), ("lower", lower), ("rest", nested), ("empty", vtk.vtkUnstructuredGrid()))
    words = (
        r"passed over, as they have no volume cells: 4 of 6 parts \(block 0 'inlet'; block 1 'wall'; "
        r"block 3 'rest', block 0 'inlet'; block 3 'rest', block 2 'outlet'\)"
    )
    expected = of_vtk(blocks(("lower", lower), ("upper", upper)), "s")
    assert expected[..., 3].max() > 0.3
    with pytest.warns(voltet.VoltetWarning, match=words):
        assert np.array_equal(of_vtk(data, "s"), expected)
    points = sum(len(piece["points"]) for piece in pieces)
    grid = vv.grid(data, ["s"])
    assert grid.point_count == points and any("4 of 6 parts" in text for text in grid.about["warnings"])
    assert voltet.Grid.from_pieces(pieces).point_count == (N + 1) ** 3 < points
    # Surfaces have the arrays, too, so that filters behind find them everywhere.
    gradient = vv.VoltetGradientMagnitude()
    gradient.SetInputData(data)
    gradient.SetInputArrayToProcess(0, 0, 0, 0, "s")
    with pytest.warns(voltet.VoltetWarning, match=words):
        gradient.Update()
    output = gradient.GetOutputDataObject(0)
    names = [output.GetMetaData(i).Get(vtk.vtkCompositeDataSet.NAME()) for i in range(5)]
    assert names == ["inlet", "wall", "lower", "rest", "empty"]
    for block, is_finite in ((output.GetBlock(0), False), (output.GetBlock(2), True), (output.GetBlock(3).GetBlock(1), True)):
        found = vtk_to_numpy(block.GetPointData().GetArray("s_gradient_magnitude"))
        assert np.isfinite(found).all() == is_finite and np.isnan(found).all() != is_finite
    assert data.GetBlock(2).GetPointData().GetArray("s_gradient_magnitude") is None
    probe = vv.VoltetProbe()
    probe.SetInputData(data)
    probe.SetInputArrayToProcess(0, 0, 0, 0, "s")
    with pytest.warns(voltet.VoltetWarning, match=words):
        probe.Update()
    assert probe.GetFigures()["volume"] == pytest.approx(1.0, rel=1e-9)


def test_partitions_of_several_collections_are_named():
    lower, upper = halves()
    data = vtk.vtkPartitionedDataSetCollection()
    data.SetPartition(0, 0, inlet())
    data.SetPartition(1, 0, lower)
    data.SetPartition(1, 1, outlet())
    data.SetPartition(2, 0, upper)
    data.GetMetaData(1).Set(vtk.vtkCompositeDataSet.NAME(), "lower")
    with pytest.warns(voltet.VoltetWarning, match=r"2 of 4 parts \(block 0, partition 0; block 1 'lower', partition 1\)"):
        of_vtk(data, "s")
    upper.GetPointData().RemoveArray("s")
    with pytest.raises(voltet.UsageError, match="block 2, partition 0 has no array 's'"):
        of_vtk(data, "s")


def test_an_array_that_a_block_lacks_is_said_with_the_block():
    lower, upper = halves()
    upper.GetPointData().RemoveArray("s")
    cells = lower.GetCellData().GetArray("c")
    data = blocks(("inlet", inlet()), ("lower", lower), ("upper", upper))
    filters = [vv.VoltetRenderer(), vv.VoltetGradientMagnitude(), vv.VoltetProbe(), vv.VoltetVolume()]
    for filter in filters:
        filter.SetInputData(data)
        filter.SetInputArrayToProcess(0, 0, 0, 0, "s")
        with pytest.raises(voltet.UsageError, match="block 2 'upper' has no array 's' on points") as raised:
            filter.Update()
        assert raised.value.expected == "one of 'c' on cells" and filter.GetError() is raised.value
        # Cells where points are meant.
        filter.SetInputArrayToProcess(0, 0, 0, 0, "c")
        with pytest.raises(voltet.UsageError, match="block 1 'lower' has no array 'c' on points") as raised:
            filter.Update()
        assert raised.value.expected == "one of 's' on points, 'c' on cells"
        filter.SetInputArrayToProcess(0, 0, 0, 1, "c")
        with pytest.warns(voltet.VoltetWarning, match="1 of 3 parts"):
            filter.Update()
    with pytest.raises(voltet.UsageError, match="block 2 'upper' has no array 's'"):
        vv.grid(data, ["s"])
    # All arrays are those that all have.
    grid = vv.grid(data)
    assert list(grid.arrays) == ["c"]
    assert any(text == "left out, as not all parts have them: 1 of 2 arrays ('s')" for text in grid.about["warnings"])
    # None that all have.
    lower.GetCellData().RemoveArray("c")
    with pytest.raises(voltet.UsageError, match="no array is on all of the 2 parts: found 's'; 'c'; expected one that all have"):
        voltet.render(data)
    lower.GetCellData().AddArray(cells)
    # On points of one and cells of another.
    values = numpy_to_vtk(np.zeros(upper.GetNumberOfCells()), deep=True)
    values.SetName("s")
    upper.GetCellData().AddArray(values)
    with pytest.raises(voltet.UsageError, match="block 2 'upper' has no array 's' on points; expected one of 'c' on cells, 's' on cells"):
        vv.grid(data, ["s"])


def test_a_surface_alone_is_refused():
    for data in (inlet(), outlet(), blocks(("inlet", inlet()), ("outlet", outlet()))):
        for part in [data] if data.IsA("vtkDataSet") else [data.GetBlock(0), data.GetBlock(1)]:
            values = numpy_to_vtk(np.zeros(part.GetNumberOfPoints()), deep=True)
            values.SetName("s")
            part.GetPointData().AddArray(values)
        with pytest.raises(voltet.Error, match="nothing to draw"):
            of_vtk(data, "s")


def test_what_a_piece_lacks_is_said():
    pieces = cut(2, "slabs", False, False)
    for wrong, words in [
        ({"point_data": {"other": pieces[1]["point_data"]["s"]}}, "piece 1 lacks the array 's'"),
        ({"point_data": {"s": pieces[1]["points"]}}, "piece 1 has another array 's' than piece 0"),
        ({"cell_data": {**pieces[1]["cell_data"], "more": pieces[1]["cell_data"]["c"]}}, "piece 0 lacks the array 'more'"),
        ({"name": "upper", "cell_data": {}}, "upper lacks the array 'c'"),
        ({"global_ids": [1, 2]}, "wrong shape"),
        ({"scalar": "s"}, "not known"),
    ]:
        with pytest.raises(voltet.Error, match=words):
            voltet.Grid.from_pieces([pieces[0], {**pieces[1], **wrong}])
    with pytest.raises(voltet.Error, match="nothing to join"):
        voltet.Grid.from_pieces([])


def test_ghosts_without_owner_are_counted():
    (one,) = cut(1, "slabs", False, False)
    one.pop("global_ids")
    one["ghost"] = (np.arange(len(one["types"])) % 4 == 0).astype(np.uint8)
    warnings = voltet.Grid(**one).about["warnings"]
    assert any(f"{one['ghost'].sum()} ghost cells have no owner" in warning for warning in warnings)
