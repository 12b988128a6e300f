"""VTK's own habits, with pipelines around the filters: pieces and ghost levels, time, abort, deep copies, composite data."""

import gc

import numpy as np
import pytest

vtk = pytest.importorskip("vtk")
from test_vtk import UNIFORM, cube, renderer  # noqa: E402
from vtkmodules.util.numpy_support import vtk_to_numpy  # noqa: E402
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase  # noqa: E402

import voltet.vtk as vv  # noqa: E402

EXECUTIVE = vtk.vtkStreamingDemandDrivenPipeline


class Source(VTKPythonAlgorithmBase):
    """A cube with time steps that notes what it is asked for; T is scaled by the time."""

    def __init__(self, kind="vtkUnstructuredGrid"):
        self.asked = []
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType=kind)

    def RequestInformation(self, request, inInfo, outInfo):
        info = outInfo.GetInformationObject(0)
        info.Set(EXECUTIVE.TIME_STEPS(), [1.0, 2.0, 4.0], 3)
        info.Set(EXECUTIVE.TIME_RANGE(), [1.0, 4.0], 2)
        info.Set(vtk.vtkAlgorithm.CAN_HANDLE_PIECE_REQUEST(), 1)
        return 1

    def RequestData(self, request, inInfo, outInfo):
        info = outInfo.GetInformationObject(0)
        time = info.Get(EXECUTIVE.UPDATE_TIME_STEP()) if info.Has(EXECUTIVE.UPDATE_TIME_STEP()) else 1.0
        keys = (EXECUTIVE.UPDATE_PIECE_NUMBER(), EXECUTIVE.UPDATE_NUMBER_OF_PIECES(), EXECUTIVE.UPDATE_NUMBER_OF_GHOST_LEVELS())
        self.asked.append((*map(info.Get, keys), time))
        data = cube()
        vtk_to_numpy(data.GetPointData().GetArray("T"))[:] *= time
        output = vtk.vtkDataObject.GetData(outInfo)
        if output.IsA("vtkMultiBlockDataSet"):
            other = cube()
            other.GetPoints().SetData(shifted(other, 2.0))
            output.SetBlock(0, data)
            output.SetBlock(1, other)
        else:
            output.ShallowCopy(data)
        output.GetInformation().Set(vtk.vtkDataObject.DATA_TIME_STEP(), time)
        return 1


def shifted(data, by):
    from vtkmodules.util.numpy_support import numpy_to_vtk

    return numpy_to_vtk(vtk_to_numpy(data.GetPoints().GetData()) + [by, 0.0, 0.0], deep=True)


def gradient(source):
    g = vv.VoltetGradientMagnitude()
    g.SetInputConnection(source.GetOutputPort())
    g.SetInputArrayToProcess(0, 0, 0, 0, "T")
    return g


def drawn(source):
    r = renderer()
    r.SetInputConnection(source.GetOutputPort())
    return r


@pytest.mark.parametrize("make", [gradient, drawn])
def test_a_piece_with_ghost_levels_is_made_of_all_of_the_input(make):
    source = Source()
    filter = make(source)
    filter.UpdatePiece(1, 4, 2)
    assert source.asked == [(0, 1, 0, 1.0)]
    whole = make(Source())
    whole.Update()
    assert filter.GetOutput().GetNumberOfPoints() == whole.GetOutput().GetNumberOfPoints() > 0


@pytest.mark.parametrize("make", [gradient, drawn])
def test_a_time_is_passed_up_and_down(make):
    source = Source()
    filter = make(source)
    filter.UpdateInformation()
    steps = filter.GetOutputInformation(0).Get(EXECUTIVE.TIME_STEPS())
    assert tuple(steps) == (1.0, 2.0, 4.0)
    filter.UpdateTimeStep(2.0)
    filter.UpdateTimeStep(4.0)
    filter.UpdateTimeStep(4.0)
    assert [time for *_, time in source.asked] == [2.0, 4.0]
    if make is gradient:
        g = vtk_to_numpy(filter.GetOutput().GetPointData().GetArray("T_gradient_magnitude"))
        assert np.allclose(g, 4.0 * np.sqrt(5.0))
        assert filter.GetOutput().GetInformation().Get(vtk.vtkDataObject.DATA_TIME_STEP()) == 4.0


def test_vtks_own_filters_ask_for_times_behind_the_filter():
    g = gradient(Source())
    between = vtk.vtkTemporalInterpolator()
    between.SetInputConnection(g.GetOutputPort())
    between.UpdateTimeStep(3.0)
    found = vtk_to_numpy(between.GetOutputDataObject(0).GetPointData().GetArray("T_gradient_magnitude"))
    assert np.allclose(found, 3.0 * np.sqrt(5.0))


@pytest.mark.parametrize("kind", ["vtkUnstructuredGrid", "vtkMultiBlockDataSet"])
def test_copies_of_outputs_outlive_filter_and_input(kind):
    g = gradient(Source(kind))
    g.Update()
    output = g.GetOutputDataObject(0)
    assert output.IsA(kind)
    copies = []
    for way in ("DeepCopy", "ShallowCopy"):
        copy = output.NewInstance()
        getattr(copy, way)(output)
        copies.append(copy)
    del g, output
    gc.collect()
    for copy in copies:
        blocks = [copy.GetBlock(i) for i in range(2)] if copy.IsA("vtkMultiBlockDataSet") else [copy]
        for block in blocks:
            assert np.allclose(vtk_to_numpy(block.GetPointData().GetArray("T_gradient_magnitude")), np.sqrt(5.0))


def test_a_deep_copy_of_a_picture_is_a_picture():
    r = drawn(Source())
    r.Update()
    copy = vtk.vtkImageData()
    copy.DeepCopy(r.GetOutput())
    before = vtk_to_numpy(r.GetOutput().GetPointData().GetScalars()).copy()
    del r
    gc.collect()
    assert copy.GetDimensions() == (24, 16, 1)
    assert np.array_equal(vtk_to_numpy(copy.GetPointData().GetScalars()), before)


def test_an_aborted_update_leaves_nothing_and_the_next_one_runs():
    # Takes much longer than from one sign of progress to the next, which is 20 ms.
    r = renderer()
    r.SetInputDataObject(0, cube(24))
    r.SetSize(2048, 1536)

    def abort(*_):
        r.SetAbortExecute(1)

    tag = r.AddObserver("ProgressEvent", abort)
    r.Update()
    assert r.GetPicture() is None
    r.RemoveObserver(tag)
    r.SetAbortExecute(0)
    r.SetSize(64, 48)
    r.Update()
    assert r.GetPicture() is not None and r.GetPicture().shape == (48, 64, 4)


def test_a_multi_block_input_follows_a_change_of_its_blocks():
    source = Source("vtkMultiBlockDataSet")
    r = drawn(source)
    r.SetWidgets(UNIFORM)
    r.Update()
    first = r.GetPicture().copy()
    blocks = vtk.vtkMultiBlockDataSet()
    blocks.DeepCopy(r.GetInput())
    r.RemoveAllInputConnections(0)
    r.SetInputDataObject(0, blocks)
    r.Update()
    assert np.array_equal(r.GetPicture(), first)
    blocks.SetBlock(0, None)
    blocks.Modified()
    r.Update()
    assert not np.array_equal(r.GetPicture(), first)
