"""Run by pvpython off-screen: the plug-in's filters, a state saved and loaded again. Arguments: the plug-in, a folder."""

import inspect
import sys

# ParaView 5.11 asks for a function that Python 3.11, which Debian builds it with, no longer has.
if not hasattr(inspect, "getargspec"):
    inspect.getargspec = inspect.getfullargspec

import numpy as np
from paraview import simple
from vtkmodules.util.numpy_support import vtk_to_numpy

plugin, folder = sys.argv[1:3]
simple.LoadPlugin(plugin, remote=False, ns=globals())

wavelet = simple.Wavelet(WholeExtent=[-5, 5] * 3)
gradient = VoltetGradientMagnitude(Input=wavelet, Scalar=["POINTS", "RTData"], ComputeGradient=1)  # noqa: F821
gradient.UpdatePipeline()
point = gradient.PointData
assert {"RTData", "RTData_gradient", "RTData_gradient_magnitude"} <= {point[i].GetName() for i in range(len(point))}
picture = VoltetRenderer(Input=gradient, Scalar=["POINTS", "RTData"], Size=[40, 30])  # noqa: F821
picture.UpdatePipeline()


def pixels(proxy):
    data = simple.servermanager.Fetch(proxy)
    assert data.GetDimensions() == (40, 30, 1), data.GetDimensions()
    return vtk_to_numpy(data.GetPointData().GetArray("RGBA")).copy()


first = pixels(picture)
assert first[:, 3].max() > 20, first[:, 3].max()
picture.Extinction = 1.0
picture.UpdatePipeline()
assert not np.array_equal(pixels(picture), first)
picture.Extinction = 0.2
picture.Method = "cell-average"
picture.UpdatePipeline()
before = pixels(picture)

# Blocks, with a surface among them.
group = simple.GroupDatasets(Input=[simple.Sphere(), wavelet])
of_blocks = VoltetGradientMagnitude(Input=group, Scalar=["POINTS", "RTData"])  # noqa: F821
of_blocks.UpdatePipeline()
blocks = simple.servermanager.Fetch(of_blocks)
magnitudes = [vtk_to_numpy(blocks.GetBlock(i).GetPointData().GetArray("RTData_gradient_magnitude")) for i in range(2)]
assert np.isnan(magnitudes[0]).all() and np.isfinite(magnitudes[1]).all()
simple.Delete(of_blocks)
simple.Delete(group)
del of_blocks, group

# A table of a region.
probe = VoltetProbe(Input=wavelet, Scalar=["POINTS", "RTData"])  # noqa: F821


def probed():
    table = simple.servermanager.Fetch(probe)
    assert table.GetNumberOfRows() == 2 and table.GetValue(0, 0).ToString() == "s"
    return table.GetValueByName(0, "mean").ToDouble()


means = [probed()]
probe.Region, probe.Low, probe.High = "box", [-1, -1, -1], [1, 1, 1]
means.append(probed())
probe.Region, probe.Centre, probe.Radius = "sphere", [4, 4, 4], 0.5
means.append(probed())
assert means[1] > means[0] > means[2], means

simple.SaveState(folder + "/state.pvsm")
simple.ResetSession()
simple.LoadPlugin(plugin, remote=False, ns=globals())
simple.LoadState(folder + "/state.pvsm")
again = next(proxy for (name, _), proxy in simple.GetSources().items() if "Renderer" in name)
again.UpdatePipeline()
assert np.array_equal(pixels(again), before)
probe = next(proxy for (name, _), proxy in simple.GetSources().items() if "Probe" in name)
assert probed() == means[2]
print("done")
