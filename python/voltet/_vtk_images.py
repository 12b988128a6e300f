"""VTK filters that give pictures."""

from __future__ import annotations

from collections.abc import Sequence
from os import fspath
from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import VTK_FLOAT, VTK_UNSIGNED_CHAR
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkImageData
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline as executive

from . import _vtk_grid
from ._errors import picture_size, usage
from ._picture import Picture
from ._pipeline import Pipeline
from ._vtk_filter import Filter, Watched, changed
from ._vtk_scene import Scene, look_from


class _Images(Filter):
    """What the filters share that give pictures."""

    _float = False
    _picture: Picture | None = None

    @changed
    def SetOutputScalarTypeToFloat(self):
        """The picture as the program computes it: 32-bit floats, premultiplied linear RGBA."""
        self._float, before = True, self._float
        return not before

    @changed
    def SetOutputScalarTypeToUnsignedChar(self):
        """The picture for screens and files: bytes, sRGB with alpha that is not multiplied in. The default."""
        self._float, before = False, self._float
        return before

    def GetPicture(self) -> Picture | None:
        """The picture of the last update: a float32 array, height × width × 4, premultiplied linear RGBA, row 0 at the top; with its
        report. None where the update failed or was aborted."""
        return self._picture

    def GetReport(self) -> dict[str, Any]:
        """What was done for it, as `voltet run --report` says it."""
        return {} if self._picture is None else self._picture.report

    def _empty(self) -> None:
        super()._empty()
        self._picture = None

    def _inform(self, outInfo, size: Sequence[int]) -> None:
        info = outInfo.GetInformationObject(0)
        info.Set(executive.WHOLE_EXTENT(), (0, size[0] - 1, 0, size[1] - 1, 0, 0), 6)
        info.Set(vtkDataObject.SPACING(), (1.0, 1.0, 1.0), 3)
        info.Set(vtkDataObject.ORIGIN(), (0.0, 0.0, 0.0), 3)
        vtkDataObject.SetPointDataActiveScalarInfo(info, VTK_FLOAT if self._float else VTK_UNSIGNED_CHAR, 4)

    def _give(self, outInfo, picture: Picture) -> int:
        """VTK counts rows from below."""
        rgba = np.asarray(picture) if self._float else picture.rgba8()
        height, width, _ = rgba.shape
        output = vtkImageData.GetData(outInfo)
        output.SetExtent(0, width - 1, 0, height - 1, 0, 0)
        values = numpy_to_vtk(np.ascontiguousarray(rgba[::-1]).reshape(-1, 4), deep=True)
        values.SetName("RGBA")
        output.GetPointData().SetScalars(values)
        self._picture = picture
        return 1


class VoltetRenderer(_Images, Scene):
    """A grid in, its picture out: a vtkImageData of RGBA.

    The scalar is chosen by `SetInputArrayToProcess(0, 0, 0, association, name)`, else the active scalars are drawn. Without widgets
    it is drawn in viridis over its range; without a camera from where all of it is seen. Of an input without cells, as a threshold
    may leave it, the picture is transparent."""

    def __init__(self) -> None:
        self._size = (640, 480)
        self._camera: Watched | None = None
        super().__init__("vtkImageData")

    @changed
    def SetSize(self, width, height=None):
        """Width and height of the picture, pixels."""
        size = picture_size("size", width if height is None else (width, height))
        self._size, before = size, self._size
        return size != before

    def GetSize(self):
        """Width and height."""
        return self._size

    @changed
    def SetCamera(self, camera):
        """A vtkCamera that is followed: a picture is drawn anew once it moves. None: one that sees all of the grid."""
        before = None if self._camera is None else self._camera.subject
        if camera is before:
            return False
        if self._camera is not None:
            self._camera.end()
        self._camera = None if camera is None else Watched(self, camera)
        return True

    def RequestInformation(self, request, inInfo, outInfo):
        """The extent of the picture."""
        self._inform(outInfo, self._size)
        return 1

    def _execute(self, inInfo, outInfo):
        data = self.GetInputData(inInfo, 0, 0)
        if not _vtk_grid.has_cells(data):
            width, height = self._size
            return self._give(outInfo, np.zeros((height, width, 4), np.float32).view(Picture))
        pipeline = self._prepare(data, self._size, fitted=self._camera is None)
        if self._camera is not None:
            look_from(pipeline, self._camera.subject, self._size)
        return self._give(outInfo, pipeline.render("picture", self._follow))


class VoltetPipeline(_Images):
    """A pipeline file as a filter: the picture of one of its nodes. The input, where there is one, stands in for what it reads."""

    def __init__(self) -> None:
        self._path: str | None = None
        self._node: str | None = None
        self._grid_node: str | None = None
        self._parameters: dict[str, Any] = {}
        self._scene: Pipeline | None = None
        super().__init__(1, "vtkDataSet", "vtkImageData")

    def FillInputPortInformation(self, port, info):
        """The input may be missing."""
        super().FillInputPortInformation(port, info)
        info.Set(vtkAlgorithm.INPUT_IS_OPTIONAL(), 1)
        return 1

    @changed
    def SetFileName(self, path):
        """The pipeline file, or a picture that carries one."""
        path = None if path is None else fspath(path)
        if path != self._path:
            self._scene = None
        self._path, before = path, self._path
        return path != before

    def GetFileName(self):
        """The file."""
        return self._path

    @changed
    def SetPictureNode(self, name):
        """The node whose picture is given, where there are several."""
        self._node, before = name, self._node
        return name != before

    @changed
    def SetGridNode(self, name):
        """The node that the input stands in for, where several read."""
        self._grid_node, before = name, self._grid_node
        self._scene = None if name != before else self._scene
        return name != before

    @changed
    def SetParameter(self, name, value):
        """Another value of a parameter: `"view.size"`, `"look.widgets.0.extinction"`."""
        before = self._parameters.get(name)
        self._parameters[name] = value
        if repr(before) != repr(value) and self._scene is not None:
            self._scene.set({name: value})
        return repr(before) != repr(value)

    def GetPipeline(self) -> Pipeline | None:
        """The pipeline, as it is now."""
        return self._scene

    def RequestInformation(self, request, inInfo, outInfo):
        """The extent of the picture, as the file states it."""
        self._inform(outInfo, self._opened().size(self._node))
        return 1

    def _opened(self) -> Pipeline:
        if self._path is None:
            raise usage("the pipeline file is not named", None, "SetFileName(path)")
        if self._scene is None:
            pipeline = Pipeline.open(self._path)
            pipeline.set(self._parameters)
            self._scene = pipeline
            self._taken = None
        return self._scene

    def _execute(self, inInfo, outInfo):
        pipeline = self._opened()
        count = inInfo[0].GetNumberOfInformationObjects()
        data = self.GetInputData(inInfo, 0, 0) if count else None
        if data is not None:
            _, association = self._asked()
            first = _vtk_grid.POINT if association is None else association
            drawn, _ = _vtk_grid.parts(data)
            given, other = self._grid(data, list(_vtk_grid.common_arrays(drawn, first)), first)
            if other:
                pipeline.give(given, self._grid_node)
        elif self._taken is not None:
            # The input was taken away: the file's own data are drawn again.
            self._taken = None
            pipeline.give(None, self._grid_node)
        return self._give(outInfo, pipeline.render(self._node, self._follow))
