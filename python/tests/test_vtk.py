"""The VTK filters, by VTK's own habits: update twice, change an input array, disconnect, delete in any order."""

import gc
import weakref

import numpy as np
import pytest

vtk = pytest.importorskip("vtk")
from conftest import PIPELINES, box  # noqa: E402
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy  # noqa: E402

import voltet  # noqa: E402
import voltet.vtk as vv  # noqa: E402
from voltet._vtk_volume import VoltetVolume  # noqa: E402


def cube(n=6, wide=True, dtype=np.float64):
    points, tetrahedra = box(n)
    ug = vtk.vtkUnstructuredGrid()
    vp = vtk.vtkPoints()
    vp.SetData(numpy_to_vtk(points.astype(dtype), deep=True))
    ug.SetPoints(vp)
    cells = vtk.vtkCellArray()
    kind = np.int64 if wide else np.int32
    offsets = numpy_to_vtk(np.arange(0, tetrahedra.size + 1, 4, dtype=kind), deep=True)
    connectivity = numpy_to_vtk(tetrahedra.reshape(-1).astype(kind), deep=True)
    cells.SetData(offsets, connectivity)
    ug.SetCells(10, cells)
    for name, values in (("T", points @ [1.0, 2.0, 0.0]), ("V", points[:, 2]), ("U", points)):
        array = numpy_to_vtk(values.astype(dtype), deep=True)
        array.SetName(name)
        ug.GetPointData().AddArray(array)
    array = numpy_to_vtk(np.arange(len(tetrahedra), dtype=float), deep=True)
    array.SetName("c")
    ug.GetCellData().AddArray(array)
    ug.GetPointData().SetActiveScalars("T")
    return ug


UNIFORM = [voltet.widgets.uniform(color=[1.0, 0.5, 0.25], extinction=2.0, region={"s": [-1e9, 1e9], "g": [-1e9, 1e9]})]


def renderer(data=None, size=(24, 16)):
    r = vv.VoltetRenderer()
    if data is not None:
        r.SetInputData(data)
    r.SetSize(*size)
    r.SetWidgets(UNIFORM)
    r.SetUnitDistance(1.0)
    r.SetParameter("picture.engine", "cpu")
    camera = vtk.vtkCamera()
    camera.SetPosition(0.5, -4, 0.5)
    camera.SetFocalPoint(0.5, 0.5, 0.5)
    camera.SetViewUp(0, 0, 1)
    camera.ParallelProjectionOn()
    camera.SetParallelScale(0.25)
    r.SetCamera(camera)
    r.test_camera = camera
    return r


def executed(filter):
    """Counts executions."""
    count = [0]
    own = filter._execute

    def counted(*args):
        count[0] += 1
        return own(*args)

    filter._execute = counted
    return count


def test_a_picture_of_the_formula_with_rows_from_below():
    data = cube()
    r = renderer(data)
    r.SetOutputScalarTypeToFloat()
    r.Update()
    out = r.GetOutput()
    assert out.GetDimensions() == (24, 16, 1) and out.GetScalarTypeAsString() == "float"
    rgba = vtk_to_numpy(out.GetPointData().GetScalars()).reshape(16, 24, 4)
    assert np.allclose(rgba[8, 12, 3], 1 - np.exp(-2), atol=1e-5)
    # The upper half alone: rows count from below in VTK.
    data.GetPoints().GetData()
    points = vtk_to_numpy(data.GetPoints().GetData())
    points[:, 2] = 0.5 + 0.5 * points[:, 2]
    data.GetPoints().GetData().Modified()
    data.GetPoints().Modified()
    r.Update()
    rgba = vtk_to_numpy(r.GetOutput().GetPointData().GetScalars()).reshape(16, 24, 4)
    assert rgba[1, 12, 3] == 0 and rgba[14, 12, 3] > 0.8
    assert np.array_equal(r.GetPicture()[::-1], rgba)
    r.SetOutputScalarTypeToUnsignedChar()
    r.Update()
    assert r.GetOutput().GetScalarTypeAsString() == "unsigned char"
    pixel = vtk_to_numpy(r.GetOutput().GetPointData().GetScalars()).reshape(16, 24, 4)[14, 12]
    assert abs(int(pixel[0]) - 255) <= 1 and abs(int(pixel[3]) - round(255 * (1 - np.exp(-2)))) <= 1


def test_nothing_changed_nothing_runs():
    data = cube()
    r = renderer(data)
    count = executed(r)
    r.Update()
    r.Update()
    assert count == [1]
    r.SetSize(24, 16)
    r.SetWidgets(UNIFORM)
    r.SetUnitDistance(1.0)
    r.SetCamera(r.test_camera)
    r.SetParameter("picture.engine", "cpu")
    r.Update()
    assert count == [1]
    r.test_camera.Azimuth(10)
    r.Update()
    assert count == [2] and next(n for n in r.GetReport()["nodes"] if n["name"] == "gradient")["reused"]
    array = data.GetPointData().GetArray("T")
    array.SetValue(0, 7.0)
    r.Update()
    assert count == [2], "VTK goes by modified times"
    array.Modified()
    r.Update()
    assert count == [3]
    assert not next(n for n in r.GetReport()["nodes"] if n["name"] == "gradient")["reused"], "of what is no more"
    r.SetParameter("picture.integrator", "adaptive")
    r.Update()
    assert count == [4]
    data.GetPointData().GetArray("V").Modified()
    before = r._taken[1]
    r.Update()
    assert r._taken[1] is before, "an array that nobody looks at"


def test_inputs_are_shared_and_never_modified():
    data = cube()
    keep = vtk.vtkUnstructuredGrid()
    keep.DeepCopy(data)
    time = data.GetMTime()
    r = renderer(data)
    r.Update()
    g = vv.VoltetGradientMagnitude()
    g.SetInputData(data)
    g.SetComputeGradient(True)
    g.Update()
    out = g.GetOutput()
    assert data.GetMTime() == time
    for kind in ("GetPointData", "GetCellData"):
        own, given, before = getattr(out, kind)(), getattr(data, kind)(), getattr(keep, kind)()
        for i in range(given.GetNumberOfArrays()):
            name = given.GetArrayName(i)
            assert own.GetArray(name) is given.GetArray(name)
            assert np.array_equal(vtk_to_numpy(given.GetArray(name)), vtk_to_numpy(before.GetArray(name)))
        assert given.GetNumberOfArrays() == before.GetNumberOfArrays()
    assert out.GetPoints() is data.GetPoints() and out.GetPointData().GetScalars().GetName() == "T"
    assert np.allclose(vtk_to_numpy(out.GetPointData().GetArray("T_gradient")), [1, 2, 0])
    assert np.allclose(vtk_to_numpy(out.GetPointData().GetArray("T_gradient_magnitude")), np.sqrt(5))
    assert r._taken[1].about["points_lent"]


@pytest.mark.parametrize("wide, dtype", [(True, np.float64), (False, np.float64), (True, np.float32)])
def test_layouts_draw_the_same(wide, dtype):
    r = renderer(cube(wide=wide, dtype=dtype))
    r.Update()
    assert np.allclose(r.GetPicture()[8, 12, 3], 1 - np.exp(-2), atol=1e-5)
    if not wide:
        assert r._taken[1].about["tetrahedra_lent"]


@pytest.mark.skipif(not hasattr(vtk.vtkCellArray, "ConvertToFixedSize64BitStorage"), reason="needs VTK 9.6")
def test_affine_offsets():
    data = cube()
    cells = data.GetCells()
    assert cells.ConvertToFixedSize64BitStorage() and not cells.GetOffsetsArray().HasStandardMemoryLayout()
    r = renderer(data)
    r.Update()
    assert np.allclose(r.GetPicture()[8, 12, 3], 1 - np.exp(-2), atol=1e-5)


@pytest.mark.skipif(not hasattr(vtk, "vtkConstantArray"), reason="needs VTK 9.7")
def test_implicit_arrays():
    data = cube()
    r = renderer(data)
    constant = vtk.vtkConstantArray["float64"]()
    constant.SetNumberOfTuples(data.GetNumberOfPoints())
    constant.ConstructBackend(3.0)
    constant.SetName("k")
    data.GetPointData().AddArray(constant)
    r.SetInputArrayToProcess(0, 0, 0, 0, "k")
    r.Update()
    assert r._taken[1].arrays["k"] == (3.0, 3.0) and np.isfinite(r.GetPicture()).all()


def test_arrays_that_vtk_reallocates_are_not_read_from_where_they_were():
    data = cube()
    r = renderer(data)
    r.Update()
    for size in (10_000_000, 216):
        array = data.GetPointData().GetArray("T")
        array.Resize(size)
        array.SetNumberOfTuples(216)
        array.Squeeze()
        values = vtk_to_numpy(array)
        values[:] = np.linspace(0, 1, 216)
        array.Modified()
        r.test_camera.Azimuth(1)
        r.Update()
        assert np.isfinite(r.GetPicture()).all()


def test_arrays_are_chosen_by_set_input_array_to_process():
    data = cube()
    g = vv.VoltetGradientMagnitude()
    g.SetInputData(data)
    for name, association, expected in (("V", 0, 1.0), ("U", 0, None), ("c", 1, None)):
        g.SetInputArrayToProcess(0, 0, 0, association, name)
        g.Update()
        added = [n for n in map(g.GetOutput().GetPointData().GetArrayName, range(9)) if n and n.endswith("magnitude")]
        assert len(added) == 1 and added[0].startswith(name)
        if expected:
            assert np.allclose(vtk_to_numpy(g.GetOutput().GetPointData().GetArray(added[0])), expected)
    g.SetInputArrayToProcess(0, 0, 0, 0, "U")
    g.SetComponent(1)
    g.Update()
    assert np.allclose(vtk_to_numpy(g.GetOutput().GetPointData().GetArray("U:1_gradient_magnitude")), 1.0)


def test_errors_are_raised_after_update_and_kept(capfd):
    data = cube()
    r = renderer(data)
    told = []
    r.AddObserver("ErrorEvent", lambda *_: told.append(1))
    r.SetInputArrayToProcess(0, 0, 0, 0, "nope")
    with pytest.raises(voltet.UsageError, match="no array 'nope'") as raised:
        r.Update()
    assert "T" in raised.value.expected and told and r.GetError() is raised.value
    # Whoever updates a later filter asks.
    later = vtk.vtkImageCast()
    later.SetInputConnection(r.GetOutputPort())
    later.Update()
    with pytest.raises(voltet.UsageError):
        r.RaiseError()
    r.SetInputArrayToProcess(0, 0, 0, 0, "T")
    r.Update()
    assert r.GetError() is None
    r.SetParameter("picture.integrator", "analytical")
    with pytest.raises(voltet.UsageError, match="integrator"):
        r.Update()
    r.SetParameter("picture.integrator", None)
    r.Update()
    with pytest.raises(voltet.UsageError):
        r.SetSize(0, 3)


def test_progress_and_abort():
    source = cube(24)
    r = renderer(source, (600, 600))
    told = []
    r.AddObserver("ProgressEvent", lambda *_: told.append(r.GetProgress()))
    r.Update()
    assert told == sorted(told) and told[-1] == 1.0

    r.test_camera.Azimuth(1)
    r.SetParameter("picture.integrator", "reference")
    tag = r.AddObserver("ProgressEvent", lambda *_: r.SetAbortExecute(1))
    r.Update()
    assert r.GetOutput().GetNumberOfPoints() == 0 or r.GetPicture() is not None
    r.RemoveObserver(tag)
    r.SetAbortExecute(0)
    r.SetParameter("picture.integrator", None)
    r.Modified()
    r.Update()
    assert r.GetOutput().GetDimensions() == (600, 600, 1)


def test_readers_thresholds_and_image_filters(tmp_path):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(tmp_path / "c.vtu"))
    writer.SetInputData(cube())
    writer.Write()
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(tmp_path / "c.vtu"))
    threshold = vtk.vtkThreshold()
    threshold.SetInputConnection(reader.GetOutputPort())
    threshold.SetInputArrayToProcess(0, 0, 0, 0, "V")
    threshold.SetUpperThreshold(0.5)
    threshold.SetThresholdFunction(vtk.vtkThreshold.THRESHOLD_UPPER)
    g = vv.VoltetGradientMagnitude()
    g.SetInputConnection(threshold.GetOutputPort())
    g.SetInputArrayToProcess(0, 0, 0, 0, "T")
    r = renderer()
    r.SetInputConnection(g.GetOutputPort())
    r.SetInputArrayToProcess(0, 0, 0, 0, "T")
    smooth = vtk.vtkImageGaussianSmooth()
    smooth.SetInputConnection(r.GetOutputPort())
    flip = vtk.vtkImageFlip()
    flip.SetInputConnection(smooth.GetOutputPort())
    png = vtk.vtkPNGWriter()
    png.SetFileName(str(tmp_path / "c.png"))
    png.SetInputConnection(flip.GetOutputPort())
    png.Write()
    assert (tmp_path / "c.png").read_bytes()[:4] == b"\x89PNG"
    count = executed(r)
    threshold.SetUpperThreshold(0.9)
    png.Write()
    assert count == [1]
    picture = r.GetPicture()
    assert (picture[..., 3] == 0).any() or picture[-1, 12, 3] < picture[0, 12, 3] + 1


def test_streamed_and_partial_extents():
    r = renderer(cube())
    clip = vtk.vtkImageClip()
    clip.SetInputConnection(r.GetOutputPort())
    clip.SetOutputWholeExtent(4, 9, 3, 5, 0, 0)
    clip.ClipDataOn()
    clip.Update()
    assert clip.GetOutput().GetDimensions() == (6, 3, 1)


def test_structured_inputs():
    source = vtk.vtkRTAnalyticSource()
    source.SetWholeExtent(-4, 4, -4, 4, -4, 4)
    for filter in (vv.VoltetRenderer(), vv.VoltetGradientMagnitude()):
        filter.SetInputConnection(source.GetOutputPort())
        filter.Update()
    assert filter.GetOutput().GetClassName() == "vtkImageData"
    assert filter.GetOutput().GetPointData().GetArray("RTData_gradient_magnitude").GetNumberOfTuples() == 729


def test_time_steps_are_asked_for_and_passed_on():
    from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase
    from vtkmodules.vtkCommonExecutionModel import vtkStreamingDemandDrivenPipeline as executive

    class Series(VTKPythonAlgorithmBase):
        def __init__(self):
            super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkUnstructuredGrid")

        def RequestInformation(self, request, inInfo, outInfo):
            info = outInfo.GetInformationObject(0)
            info.Set(executive.TIME_STEPS(), [0.0, 1.0, 2.0], 3)
            info.Set(executive.TIME_RANGE(), [0.0, 2.0], 2)
            return 1

        def RequestData(self, request, inInfo, outInfo):
            info = outInfo.GetInformationObject(0)
            time = info.Get(executive.UPDATE_TIME_STEP()) if info.Has(executive.UPDATE_TIME_STEP()) else 0.0
            data = cube()
            values = vtk_to_numpy(data.GetPointData().GetArray("T"))
            values *= 1.0 + time
            output = vtk.vtkUnstructuredGrid.GetData(outInfo)
            output.ShallowCopy(data)
            output.GetInformation().Set(vtk.vtkDataObject.DATA_TIME_STEP(), time)
            return 1

    g = vv.VoltetGradientMagnitude()
    series = Series()
    g.SetInputConnection(series.GetOutputPort())
    for time in (0.0, 2.0, 1.0):
        g.UpdateTimeStep(time)
        found = vtk_to_numpy(g.GetOutput().GetPointData().GetArray("T_gradient_magnitude"))
        assert np.allclose(found, np.sqrt(5) * (1 + time))
        assert g.GetOutput().GetInformation().Get(vtk.vtkDataObject.DATA_TIME_STEP()) == time


def test_multi_block_and_partitioned_inputs():
    data = cube(7)
    multi = vtk.vtkMultiBlockDataSet()
    multi.SetBlock(0, data)
    multi.SetBlock(1, None)
    other = vtk.vtkUnstructuredGrid()
    other.DeepCopy(cube())
    points = vtk_to_numpy(other.GetPoints().GetData())
    points += [2.0, 0.0, 0.0]
    multi.SetBlock(2, other)
    r = renderer(multi)
    r.SetOutputScalarTypeToFloat()
    r.Update()
    assert r._taken[1].about["tetrahedra"] == data.GetNumberOfCells() + other.GetNumberOfCells()
    g = vv.VoltetGradientMagnitude()
    g.SetInputData(multi)
    g.Update()
    out = g.GetOutputDataObject(0)
    assert out.IsA("vtkMultiBlockDataSet")
    assert np.allclose(vtk_to_numpy(out.GetBlock(2).GetPointData().GetArray("T_gradient_magnitude")), np.sqrt(5))
    pieces = vtk.vtkPartitionedDataSet()
    pieces.SetNumberOfPartitions(2)
    pieces.SetPartition(0, data)
    pieces.SetPartition(1, other)
    r = renderer(pieces)
    r.Update()
    assert r._taken[1].about["tetrahedra"] == data.GetNumberOfCells() + other.GetNumberOfCells()


def test_of_what_a_threshold_leaves_empty_the_picture_is_transparent():
    threshold = vtk.vtkThreshold()
    threshold.SetInputData(cube())
    threshold.SetInputArrayToProcess(0, 0, 0, 0, "T")
    threshold.SetThresholdFunction(vtk.vtkThreshold.THRESHOLD_UPPER)
    r, volume = vv.VoltetRenderer(), VoltetVolume()
    for drawn in (r, volume):
        drawn.SetInputConnection(threshold.GetOutputPort())
        drawn.SetInputArrayToProcess(0, 0, 0, 0, "T")
    r.SetSize(24, 16)
    for least, is_empty in ((-1e9, False), (1e9, True), (-1e9, False)):
        threshold.SetUpperThreshold(least)
        for drawn in (r, volume):
            drawn.Update()
        assert r.GetOutput().GetDimensions() == (24, 16, 1)
        assert vtk_to_numpy(r.GetOutput().GetPointData().GetScalars()).any() != is_empty
        assert volume.IsEmpty() == is_empty
        assert (volume.GetOutput().GetNumberOfPoints() == 0) == is_empty
    r.SetInputConnection(None)
    r.SetInputDataObject(vtk.vtkMultiBlockDataSet())
    r.Update()
    assert not vtk_to_numpy(r.GetOutput().GetPointData().GetScalars()).any()


def test_ghost_cells_are_left_out():
    data = cube()
    ghost = np.zeros(data.GetNumberOfCells(), np.uint8)
    ghost[: len(ghost) // 2] = vtk.vtkDataSetAttributes.DUPLICATECELL
    array = numpy_to_vtk(ghost, deep=True)
    array.SetName("vtkGhostType")
    data.GetCellData().AddArray(array)
    r = renderer(data)
    r.Update()
    assert r._taken[1].cell_count == len(ghost) - len(ghost) // 2


def test_mixed_cells_and_polyhedra():
    source = vtk.vtkCellTypeSource()
    for kind in (10, 12, 13, 14, 25, 42, 72):
        source.SetCellType(kind)
        try:
            source.Update()
        except Exception:
            continue
        data = source.GetOutput()
        if data.GetNumberOfCells() == 0:
            continue
        g = vv.VoltetGradientMagnitude()
        g.SetInputData(data)
        g.SetInputArrayToProcess(0, 0, 0, 0, "DistanceToCenter")
        g.Update()
        found = vtk_to_numpy(g.GetOutput().GetPointData().GetArray("DistanceToCenter_gradient_magnitude"))
        assert len(found) == data.GetNumberOfPoints(), kind


@pytest.mark.parametrize("kind", [vv.VoltetRenderer, vv.VoltetGradientMagnitude, vv.VoltetProbe, vv.VoltetVolume])
@pytest.mark.parametrize("way", ["RemoveAllInputConnections", "RemoveAllInputs", "SetInputConnection", "SetInputDataObject"])
def test_a_filter_whose_input_was_taken_away_says_so(kind, way):
    f = kind()
    with pytest.raises(voltet.UsageError, match=f"{kind.__name__} has no input"):
        f.Update()
    f.SetInputData(cube())
    f.Update()
    assert f.GetError() is None and f.GetOutput().GetNumberOfElements(0) + f.GetOutput().GetNumberOfElements(6) > 0
    getattr(f, way)(*{"RemoveAllInputConnections": [0], "RemoveAllInputs": []}.get(way, [None]))
    assert "no input" in str(f.GetError())
    for update in (f.Update, f.UpdateWholeExtent, lambda: f.UpdateTimeStep(0.0)):
        with pytest.raises(voltet.UsageError, match="no input") as raised:
            update()
    assert "SetInputData" in raised.value.expected
    # The former output would be taken for the new one.
    assert f.GetOutput().GetNumberOfElements(0) == f.GetOutput().GetNumberOfElements(6) == 0
    f.SetInputData(cube())
    f.Update()
    assert f.GetError() is None and f.GetOutput().GetNumberOfElements(0) + f.GetOutput().GetNumberOfElements(6) > 0


def test_errors_of_other_updates_are_raised_too():
    r = renderer(cube())
    r.SetInputArrayToProcess(0, 0, 0, 0, "nope")
    for update in (r.UpdateWholeExtent, lambda: r.UpdateTimeStep(0.0), lambda: r.UpdatePiece(0, 1, 0), lambda: r.UpdateExtent([0, 1, 0, 1, 0, 0])):
        r.Modified()
        with pytest.raises(voltet.UsageError, match="no array 'nope'"):
            update()


def test_nothing_of_a_former_result_stays_where_an_update_fails():
    r, probe, file = renderer(cube()), vv.VoltetProbe(), vv.VoltetPipeline()
    probe.SetInputData(cube())
    file.SetFileName(PIPELINES / "quickstart.toml")
    file.SetParameter("view.size", [8, 6])
    for filter in (r, probe, file):
        filter.AddObserver("ErrorEvent", lambda *_: None)
        filter.Update()
    assert r.GetPicture() is not None and probe.GetFigures() and file.GetPicture() is not None
    for filter in (r, probe):
        filter.SetInputArrayToProcess(0, 0, 0, 0, "nope")
    file.SetFileName("nowhere.toml")
    for filter in (r, probe, file):
        with pytest.raises(voltet.UsageError):
            filter.Update()
        assert filter.GetOutput().GetNumberOfElements(0) == filter.GetOutput().GetNumberOfElements(6) == 0
    assert r.GetPicture() is file.GetPicture() is None and r.GetReport() == probe.GetFigures() == {}
    for filter in (r, probe):
        filter.SetInputArrayToProcess(0, 0, 0, 0, "T")
        filter.Update()
    assert r.GetPicture() is not None and probe.GetFigures()


def test_an_array_on_the_other_association_is_said_to_be_there():
    r = renderer(cube())
    for association, name, words in ((0, "c", "'c' on cells"), (1, "T", "'T' on points")):
        r.SetInputArrayToProcess(0, 0, 0, association, name)
        with pytest.raises(voltet.UsageError, match=f"no array '{name}' on {('points', 'cells')[association]}") as raised:
            r.Update()
        assert words in raised.value.expected


def test_a_constant_field_is_said_to_be_blank_at_the_line_that_updates():
    data = cube()
    vtk_to_numpy(data.GetPointData().GetArray("T"))[:] = 4.0
    r = vv.VoltetRenderer()
    r.SetInputData(data)
    r.SetSize(8, 8)
    with pytest.warns(voltet.VoltetWarning, match="the picture is empty") as told:
        r.Update()
    # Old versions of VTK use what numpy deprecates.
    (own,) = [warning for warning in told if warning.category is voltet.VoltetWarning]
    assert own.filename == __file__ and r.GetReport()["warnings"] == [str(own.message)]
    # Made an error, it is one.
    import warnings

    with warnings.catch_warnings():
        warnings.simplefilter("error", voltet.VoltetWarning)
        r.Modified()
        with pytest.raises(voltet.VoltetWarning, match="the picture is empty"):
            r.Update()


def test_an_overlay_holds_the_error_of_its_filter():
    from voltet._overlay import VolumeOverlay

    v = vv.VoltetVolume()
    v.SetInputData(cube())
    overlay, window, view = VolumeOverlay(v), vtk.vtkRenderWindow(), vtk.vtkRenderer()
    window.OffScreenRenderingOn()
    window.SetSize(16, 12)
    window.AddRenderer(view)
    view.AddObserver("EndEvent", lambda *_: overlay.frame(view))
    view.GetActiveCamera().SetPosition(0.5, -4, 0.5)
    view.GetActiveCamera().SetFocalPoint(0.5, 0.5, 0.5)
    view.GetActiveCamera().SetViewUp(0, 0, 1)
    v.Update()
    window.Render()
    assert overlay.error is None and overlay.draws == 1
    v.SetInputArrayToProcess(0, 0, 0, 0, "nope")
    with pytest.raises(voltet.UsageError):
        v.Update()
    window.Render()
    assert overlay.error is v.GetError() and "no array 'nope'" in str(overlay.error) and overlay.draws == 1
    v.SetInputArrayToProcess(0, 0, 0, 0, "V")
    v.Update()
    window.Render()
    assert overlay.error is None and overlay.draws == 2
    v.RemoveAllInputConnections(0)
    window.Render()
    assert "no input" in str(overlay.error)


def test_whole_numbers_are_not_rounded():
    r, g, camera = renderer(cube()), vv.VoltetGradientMagnitude(), vtk.vtkCamera()
    size = r.GetSize()
    for call in (
        lambda: r.SetSize(2.5, 3), lambda: r.SetSize((3, 2.0)), lambda: r.SetSize("12"), lambda: r.SetSize(3), lambda: r.SetSize(True, 3),
        lambda: r.SetComponent(0.5), lambda: r.SetComponent("x"), lambda: g.SetComponent(1.0), lambda: vv.camera_parameters(camera, (4.5, 3)),
    ):
        with pytest.raises(TypeError, match="whole number") as raised:
            call()
        assert isinstance(raised.value, voltet.UsageError) and raised.value.expected
    for call in (lambda: r.SetSize(0, 3), lambda: r.SetSize(3, 40_000), lambda: r.SetComponent(-1)):
        with pytest.raises(voltet.UsageError, match="out of range"):
            call()
    assert r.GetSize() == size
    r.SetSize(np.int32(5), np.uint8(4))
    assert r.GetSize() == (5, 4)


def test_disconnected_and_deleted_in_any_order():
    data = cube()
    r = renderer(data)
    r.Update()
    r.RemoveAllInputs()
    with pytest.raises(Exception):
        r.Update()
        r.RaiseError()
        raise voltet.UsageError("VTK itself said that the input is missing")
    r.SetInputData(data)
    r.Update()
    output = r.GetOutput()
    camera = r.test_camera
    gone = weakref.ref(r)
    del r
    gc.collect()
    assert gone() is None, "a filter that nobody has is gone"
    camera.Azimuth(5)
    assert output.GetDimensions() == (24, 16, 1)
    r = renderer(cube())
    camera = r.test_camera
    del r.test_camera, camera
    gc.collect()
    r.Update()
    del data
    gc.collect()
    r.Modified()
    r.Update()


def test_a_pipeline_file_is_a_filter(tmp_path):
    p = vv.VoltetPipeline()
    with pytest.raises(voltet.UsageError, match="not named"):
        p.Update()
    p.SetFileName(PIPELINES / "quickstart.toml")
    p.SetParameter("view.size", [40, 30])
    p.SetParameter("picture.engine", "cpu")
    p.Update()
    assert p.GetOutput().GetDimensions() == (40, 30, 1)
    expected = voltet.run(PIPELINES / "quickstart.toml", set={"view.size": [40, 30], "picture.engine": "cpu", "file.path": tmp_path / "q.png"})
    assert np.array_equal(p.GetPicture(), expected.images["picture"])
    p.SetParameter("view.size", [20, 10])
    p.Update()
    assert p.GetOutput().GetDimensions() == (20, 10, 1)
    # An input stands in for what the file reads.
    data = cube()
    data.GetPointData().GetArray("T").SetName("Temperature")
    p.SetInputData(data)
    p.Update()
    assert not np.array_equal(p.GetPicture(), expected.images["picture"])
    # Taken away, the file's own data are drawn again.
    p.RemoveAllInputConnections(0)
    p.SetParameter("view.size", [40, 30])
    p.Update()
    assert np.array_equal(p.GetPicture(), expected.images["picture"])
    p.SetFileName("nowhere.toml")
    with pytest.raises(voltet.UsageError, match="cannot be read"):
        p.Update()


def test_a_probe_gives_a_table():
    p = vv.VoltetProbe()
    p.SetInputData(cube())
    p.Update()
    assert p.GetFigures()["volume"] == pytest.approx(1.0, rel=1e-9), "all of the grid"
    p.SetBox([0, 0, 0], [0.5, 1, 1])
    p.Update()
    table = p.GetOutputDataObject(0)
    assert table.GetNumberOfRows() == 2 and table.GetValue(0, 0).ToString() == "s"
    assert table.GetValueByName(0, "mean").ToDouble() == pytest.approx(0.25 + 1.0, rel=1e-6)
    assert p.GetFigures()["volume"] == pytest.approx(0.5, rel=1e-9)
    p.SetSphere([0.5, 0.5, 0.5], 0.2)
    p.Update()
    assert table.GetNumberOfRows() == 2 and p.GetFigures()["volume"] == pytest.approx(4 / 3 * np.pi * 0.008, rel=1e-4)
    p.SetFields(["V", "T"])
    p.Update()
    assert p.GetFigures()["fields"] == ["V", "T"]


def test_a_volume_gives_its_outline_and_says_when_it_is_another():
    data = cube()
    v = vv.VoltetVolume()
    v.SetInputData(data)
    v.SetWidgets(UNIFORM)
    v.Update()
    assert v.GetOutput().GetBounds() == pytest.approx((0, 1) * 3) and v.GetOutput().GetNumberOfLines() == 12
    assert v.GetPipeline().render().shape == (480, 640, 4)
    version = v.GetVersion()
    v.Update()
    assert v.GetVersion() == version
    data.GetPointData().GetArray("T").Modified()
    v.Update()
    assert v.GetVersion() != version
    with pytest.raises(voltet.UsageError, match="scale"):
        v.SetScale(2.0)


def test_a_moving_grid_given_again_and_again_does_not_grow():
    import resource

    def peak():
        return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss

    data = cube(20)
    r = renderer(data, (8, 8))
    for _ in range(3):
        data.GetPoints().GetData().Modified()
        r.Update()
    before = peak()
    for _ in range(40):
        data.GetPoints().GetData().Modified()
        data.Modified()
        r.Update()
    assert peak() - before < 40_000, "KiB"
