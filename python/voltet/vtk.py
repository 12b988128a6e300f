"""VTK filters: the renderer, the gradient magnitude, pipeline files and probes, for pipelines of VTK.

They keep VTK's contract: an update does nothing where nothing has changed, inputs are shared and never modified, arrays are chosen
by SetInputArrayToProcess, progress and abort work, multi-block and partitioned data are taken. VTK prints exceptions in such
filters and forgets them; here `Update()` of the filter raises, and after an update of a later filter `GetError()` has what was
wrong.

>>> from vtkmodules.vtkImagingCore import vtkRTAnalyticSource
>>> import voltet.vtk
>>> source = vtkRTAnalyticSource()
>>> source.SetWholeExtent(-4, 4, -4, 4, -4, 4)
>>> renderer = voltet.vtk.VoltetRenderer()
>>> renderer.SetInputConnection(source.GetOutputPort())
>>> renderer.SetSize(64, 48)
>>> renderer.Update()
>>> renderer.GetOutput().GetDimensions()
(64, 48, 1)
"""

from ._vtk_grid import grid
from ._vtk_images import VoltetPipeline, VoltetRenderer
from ._vtk_scene import camera_parameters
from ._vtk_values import VoltetGradientMagnitude, VoltetProbe
from ._vtk_volume import VoltetVolume

__all__ = [
    "VoltetGradientMagnitude", "VoltetPipeline", "VoltetProbe", "VoltetRenderer", "VoltetVolume", "camera_parameters", "grid",
]
