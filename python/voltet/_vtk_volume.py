"""A VTK filter whose grid is drawn into render views."""

from __future__ import annotations

from vtkmodules.vtkCommonDataModel import vtkPolyData
from vtkmodules.vtkFiltersSources import vtkOutlineSource

from . import _vtk_grid
from ._errors import usage
from ._vtk_filter import changed
from ._vtk_scene import Scene


class VoltetVolume(Scene):
    """A grid in, the outline of its bounds out. What shows the outline knows where the volume is; the volume itself is laid over
    the frames of a renderer by `voltet._overlay.VolumeOverlay`, as the ParaView plug-in does it."""

    def __init__(self) -> None:
        self._version = 0
        self._is_empty = False
        self._scale = 1.0
        super().__init__("vtkPolyData")

    @changed
    def SetScale(self, scale):
        """Pixels of the picture per pixel of the window, 0.1 to 1: less is faster, and coarser."""
        if not 0.1 <= scale <= 1.0:
            raise usage("'scale' is out of range", scale, "0.1 to 1")
        self._scale, before = float(scale), self._scale
        return self._scale != before

    def GetScale(self) -> float:
        """Pixels of the picture per pixel of the window."""
        return self._scale

    def IsEmpty(self) -> bool:
        """Whether the input of the last update had no cells, as a threshold may leave it: nothing is drawn then."""
        return self._is_empty

    def GetVersion(self) -> int:
        """Changes where what is drawn does."""
        return self._version

    def _execute(self, inInfo, outInfo):
        data = self.GetInputData(inInfo, 0, 0)
        self._is_empty = not _vtk_grid.has_cells(data)
        if self._is_empty:
            self._version += 1
            vtkPolyData.GetData(outInfo).Initialize()
            return 1
        # Its camera is the renderer's.
        self._prepare(data, (640, 480), fitted=False)
        self._version += 1
        low, high = self._taken[1].bounds
        outline = vtkOutlineSource()
        outline.SetBounds(*[value for pair in zip(low, high) for value in pair])
        outline.Update()
        vtkPolyData.GetData(outInfo).ShallowCopy(outline.GetOutput())
        return 1
