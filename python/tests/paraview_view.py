"""Run by pvpython: volumes in a render view, among surfaces, in states, in views that are closed. Arguments: the plug-in, a folder."""

import gc
import inspect
import sys

if not hasattr(inspect, "getargspec"):
    inspect.getargspec = inspect.getfullargspec

import numpy as np
from paraview import simple
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

plugin, folder = sys.argv[1:3]
simple.LoadPlugin(plugin, remote=False, ns=globals())
simple._DisableFirstRenderCameraReset()

import voltet  # noqa: E402
import voltet.paraview  # noqa: E402

SIZE = [64, 48]


def screenshot(view, resolution=SIZE):
    path = folder + "/shot.png"
    simple.SaveScreenshot(path, view, ImageResolution=resolution)
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    width, height, _ = reader.GetOutput().GetDimensions()
    assert [width, height] == resolution
    return vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).reshape(height, width, -1)[::-1, :, :3].astype(float)


def over(picture, behind):
    """A picture over colours of the window, in bytes."""
    rgba = picture.rgba8().astype(float)
    alpha = rgba[..., 3:] / 255.0
    return rgba[..., :3] * alpha + behind * (1.0 - alpha)


def overlay(view):
    found = voltet.paraview.overlays(view)
    assert len(found) == 1, found
    found[0].raise_error()
    return found[0]


wavelet = simple.Wavelet(WholeExtent=[-5, 5] * 3)
volume = VoltetVolume(Input=wavelet, Scalar=["POINTS", "RTData"], Extinction=1.0)  # noqa: F821
view = simple.CreateView("RenderView")
view.ViewSize = SIZE
view.OrientationAxesVisibility = 0
if hasattr(view, "UseColorPaletteForBackground"):
    view.UseColorPaletteForBackground = 0
view.Background = [0, 0, 0]
outline = simple.Show(volume, view)
# Its lines would end rays.
outline.Opacity = 0.0
view.CameraParallelProjection = 1
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [0, -30, 0], [0, 0, 0], [0, 0, 1]
view.CameraParallelScale = 7.0

# What is seen is the program's own picture, and follows the camera; nothing is drawn where nothing has changed.
shown = screenshot(view)
draws = overlay(view).draws
assert np.array_equal(screenshot(view), shown) and overlay(view).draws == draws
overlay(view).pipeline.save(folder + "/view.toml")
own = voltet.Pipeline.open(folder + "/view.toml").render()
assert own[..., 3].max() > 0.9
assert np.abs(shown - over(own, 0.0)).max() <= 1.5
view.CameraPosition = [0, 30, 0]
turned = screenshot(view)
assert overlay(view).draws > draws and np.abs(turned[:, ::-1] - shown).mean() < 10
view.CameraPosition = [0, -30, 0]
# Larger pictures than the window are made of tiles.
large = screenshot(view, [128, 96])
assert np.abs(large.reshape(48, 2, 64, 2, 3).mean((1, 3)) - shown).mean() < 2.0

# Surfaces: in the middle, before, behind.
plane = simple.Plane(Origin=[-20, 0, -20], Point1=[20, 0, -20], Point2=[-20, 0, 20])
surface = simple.Show(plane, view)
surface.Representation, surface.Ambient, surface.Diffuse = "Surface", 1.0, 0.0
surface.AmbientColor = surface.DiffuseColor = [0.0, 0.0, 1.0]
blue = np.array([0.0, 0.0, 255.0])
ended = voltet.Pipeline.open(folder + "/view.toml").render_until(np.full((48, 64), 30.0))
assert np.abs(ended - own).max() > 0.1
for y, expected in ((0, over(ended, blue)), (-8, np.broadcast_to(blue, shown.shape)), (8, over(own, blue))):
    plane.Origin, plane.Point1, plane.Point2 = [-20, y, -20], [20, y, -20], [-20, y, 20]
    found = screenshot(view)
    overlay(view)
    assert np.abs(found - expected).max() <= 2.5, (y, np.abs(found - expected).max())
simple.Delete(surface)
simple.Delete(plane)
del surface, plane

# Properties, visibility.
volume.Extinction = 0.1
assert screenshot(view).mean() < shown.mean()
simple.Hide(volume, view)
assert screenshot(view).max() == 0
simple.Show(volume, view)
# An array that there is not: the overlay holds what is wrong, and the view goes on.
volume.Scalar = ["POINTS", "nope"]
screenshot(view)
(failed,) = voltet.paraview.overlays(view)
assert "no array 'nope'" in str(failed.error) and "'RTData' on points" in failed.error.expected, failed.error
volume.Scalar = ["POINTS", "RTData"]
volume.Extinction = 1.0
assert np.abs(screenshot(view) - shown).max() <= 1

# A state, in a session that knows nothing of it.
simple.SaveState(folder + "/view.pvsm")
simple.ResetSession()
simple.LoadPlugin(plugin, remote=False, ns=globals())
simple.LoadState(folder + "/view.pvsm")
view = simple.GetRenderViews()[0]
assert np.abs(screenshot(view) - shown).max() <= 1

# A second view; the first is closed, then the filter goes.
volume = next(proxy for (name, _), proxy in simple.GetSources().items() if "Volume" in name)
other = simple.CreateView("RenderView")
other.ViewSize = SIZE
simple.Show(volume, other)
simple.ResetCamera(other)
simple.Render(other)
assert overlay(other).picture[..., 3].max() > 0.9
simple.Delete(view)
del view
gc.collect()
screenshot(other)
overlay(other)
simple.Delete(volume)
del volume
gc.collect()
screenshot(other)
assert not voltet.paraview.overlays(other), "the filter is gone"
print("done")
