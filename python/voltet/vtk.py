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

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import fspath
from typing import TYPE_CHECKING, Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import VTK_FLOAT, VTK_UNSIGNED_CHAR, vtkDoubleArray, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkDataSet, vtkImageData, vtkTable
from vtkmodules.vtkCommonExecutionModel import vtkAlgorithm, vtkStreamingDemandDrivenPipeline as executive

from . import _vtk_grid
from ._errors import usage
from ._picture import Picture
from ._pipeline import Pipeline
from ._scene import scene
from ._vtk_filter import Filter, Watched, changed
from ._vtk_grid import grid

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkCamera

__all__ = ["VoltetGradientMagnitude", "VoltetPipeline", "VoltetProbe", "VoltetRenderer", "camera_parameters", "grid"]


def camera_parameters(camera: vtkCamera, size: Sequence[int]) -> dict[str, Any]:
    """Parameters of a node `camera` that sees what a vtkCamera sees in a window of this size, pixels."""
    from math import atan, degrees, radians, tan

    if camera.GetUseHorizontalViewAngle():
        half = radians(camera.GetViewAngle() / 2.0)
        fov_y = 2.0 * degrees(atan(tan(half) * size[1] / size[0]))
    else:
        fov_y = camera.GetViewAngle()
    seen = {
        "eye": list(camera.GetPosition()),
        "target": list(camera.GetFocalPoint()),
        "up": list(camera.GetViewUp()),
        "size": [int(side) for side in size],
    }
    if camera.GetParallelProjection():
        return {**seen, "height": 2.0 * camera.GetParallelScale(), "fov_y": None}
    return {**seen, "fov_y": fov_y, "height": None}


def look_from(pipeline: Pipeline, camera: vtkCamera, size: Sequence[int], node: str = "view") -> bool:
    """Gives a node the parameters of a vtkCamera; whether they are others than before."""
    stated = pipeline[node].parameters
    seen = camera_parameters(camera, size)
    other = {key: value for key, value in seen.items() if stated.get(key) != value}
    pipeline.set({f"{node}.{key}": value for key, value in other.items()})
    return bool(other)


class _Images(Filter):
    """What the filters share that give pictures."""

    def __init__(self, inputs: int):
        self._float = False
        self._picture: Picture | None = None
        super().__init__(inputs, "vtkDataSet", "vtkImageData")

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
        """The last picture: a float32 array, height × width × 4, premultiplied linear RGBA, row 0 at the top; with its report."""
        return self._picture

    def GetReport(self) -> dict[str, Any]:
        """What was done for it, as `voltet run --report` says it."""
        return {} if self._picture is None else self._picture.report

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


class VoltetRenderer(_Images):
    """A grid in, its picture out: a vtkImageData of RGBA.

    The scalar is chosen by `SetInputArrayToProcess(0, 0, 0, association, name)`, else the active scalars are drawn. Without widgets
    it is drawn in viridis over its range; without a camera from where all of it is seen."""

    def __init__(self) -> None:
        self._size = (640, 480)
        self._widgets: list[dict[str, Any]] | None = None
        self._unit_distance: float | None = None
        self._component: int | None = None
        self._parameters: dict[str, Any] = {}
        self._camera: Watched | None = None
        self._scene: Pipeline | None = None
        self._made: tuple | None = None
        super().__init__(1)

    @changed
    def SetSize(self, width, height=None):
        """Width and height of the picture, pixels."""
        size = tuple(map(int, width if height is None else (width, height)))
        if len(size) != 2 or min(size) < 1:
            raise usage("the picture's size is out of range", size, "width and height, 1 to 32768 pixels")
        self._size, before = size, self._size
        return size != before

    def GetSize(self):
        """Width and height."""
        return self._size

    @changed
    def SetWidgets(self, widgets):
        """The transfer function: dictionaries, as `voltet.widgets` makes them. None: viridis over the range."""
        given = None if widgets is None else [dict(widget) for widget in widgets]
        self._widgets, before = given, self._widgets
        return repr(given) != repr(before)

    @changed
    def SetUnitDistance(self, length):
        """The length over which extinctions are stated, in the grid's units. None: a hundredth of its diagonal."""
        self._unit_distance, before = length, self._unit_distance
        return length != before

    @changed
    def SetComponent(self, component):
        """The component that is drawn of an array of several. None: the magnitude."""
        self._component, before = component, self._component
        return component != before

    @changed
    def SetParameter(self, name, value):
        """A parameter by its place in the pipeline: `"picture.integrator"`, `"picture.light"`, `"gradient.method"`; None takes it back."""
        before = self._parameters.get(name)
        if value is None:
            self._parameters.pop(name, None)
        else:
            self._parameters[name] = value
        return repr(before) != repr(value)

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

    def GetPipeline(self) -> Pipeline | None:
        """The pipeline that drew the last picture, to be saved for `voltet run` and `voltet edit`."""
        return self._scene

    def RequestInformation(self, request, inInfo, outInfo):
        """The extent of the picture."""
        self._inform(outInfo, self._size)
        return 1

    def _execute(self, inInfo, outInfo):
        data = self.GetInputData(inInfo, 0, 0)
        name, association = self._quantity(data)
        names = [name, *_fields(self._widgets)]
        given, other = self._grid(data, list(dict.fromkeys(names)), association)
        components = given.about["arrays"][name]["components"]
        scalar = name if components == 1 else f"{name}:{'magnitude' if self._component is None else self._component}"
        made = (scalar, repr(self._widgets), self._unit_distance, repr(self._parameters), self._camera is None and self._size)
        if self._scene is None or made != self._made or other and self._widgets is None:
            self._scene = self._begin(given, scalar)
            self._made = made
        elif other:
            self._scene.give(given, "grid")
        if self._camera is not None:
            look_from(self._scene, self._camera.subject, self._size)
        return self._give(outInfo, self._scene.render("picture", self._follow))

    def _begin(self, given: Any, scalar: str) -> Pipeline:
        parameters = {key: value for key, value in self._parameters.items() if not key.startswith("picture.")}
        drawing = {key.partition(".")[2]: value for key, value in self._parameters.items() if key.startswith("picture.")}
        method = {key.partition(".")[2]: value for key, value in parameters.items() if key.startswith("gradient.")}
        pipeline = scene(
            given, scalar, widgets=self._widgets, size=self._size, unit_distance=self._unit_distance, method=method, **drawing
        )
        pipeline.set({key: value for key, value in parameters.items() if not key.startswith("gradient.")})
        return pipeline


class VoltetGradientMagnitude(Filter):
    """A grid in, the same grid out with the gradient magnitude of an array at its points, and the gradient where asked for.

    Arrays, points and cells of the input are shared. Names: `NAME_gradient_magnitude`, `NAME_gradient`. NaN at points of no cell."""

    SHARES = {"grid": (0.0, 0.2), "gradient": (0.2, 1.0)}

    def __init__(self) -> None:
        self._method: dict[str, Any] = {"method": "least-squares"}
        self._vectors = False
        self._component: int | None = None
        super().__init__(1, "vtkDataSet", "vtkDataSet")

    @changed
    def SetMethod(self, method, **parameters):
        """The gradient filter, with its parameters: one that ships, or one of `voltet.gradient_filter`."""
        given = {"method": method, **parameters}
        self._method, before = given, self._method
        return repr(given) != repr(before)

    @changed
    def SetComputeGradient(self, flag):
        """Whether the vectors are added, too."""
        self._vectors, before = bool(flag), self._vectors
        return self._vectors != before

    @changed
    def SetComponent(self, component):
        """The component of an array of several. None: the magnitude."""
        self._component, before = component, self._component
        return component != before

    def FillInputPortInformation(self, port, info):
        """Composite data are taken block by block, as VTK's own filters do."""
        info.Set(vtkAlgorithm.INPUT_REQUIRED_DATA_TYPE(), "vtkDataSet")
        return 1

    def RequestDataObject(self, request, inInfo, outInfo):
        """The output is of the input's type."""
        data = self.GetInputData(inInfo, 0, 0)
        info = outInfo.GetInformationObject(0)
        former = info.Get(vtkDataObject.DATA_OBJECT())
        if data is not None and (former is None or former.GetClassName() != data.GetClassName()):
            info.Set(vtkDataObject.DATA_OBJECT(), data.NewInstance())
        return 1

    def _execute(self, inInfo, outInfo):
        data = self.GetInputData(inInfo, 0, 0)
        output = vtkDataSet.GetData(outInfo)
        output.ShallowCopy(data)
        if data.GetNumberOfCells() == 0:
            return 1
        name, association = self._quantity(data)
        given, _ = self._grid(data, [name], association)
        components = given.about["arrays"][name]["components"]
        scalar = name if components == 1 else f"{name}:{'magnitude' if self._component is None else self._component}"
        pipeline = Pipeline()
        pipeline.add("grid", "given-grid", scalar=scalar)
        pipeline.add("gradient", "gradient-magnitude", grid="grid", **self._method)
        pipeline.give(given)
        found = pipeline.volume("gradient", gradient=self._vectors, progress=self._follow)
        for key in ("gradient_magnitude", *(["gradient"] if self._vectors else [])):
            # VTK's own memory: it may outlive what computed it.
            array = numpy_to_vtk(found[key], deep=True)
            array.SetName(f"{scalar}_{key}")
            output.GetPointData().AddArray(array)
        return 1


class VoltetPipeline(_Images):
    """A pipeline file as a filter: the picture of one of its nodes. The input, where there is one, stands in for what it reads."""

    def __init__(self) -> None:
        self._path: str | None = None
        self._node: str | None = None
        self._grid_node: str | None = None
        self._parameters: dict[str, Any] = {}
        self._scene: Pipeline | None = None
        super().__init__(1)

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
            name, association = self._asked()
            names = _all_names(data)
            given, other = self._grid(data, names, _vtk_grid.POINT if association is None else association)
            if other:
                pipeline.give(given, self._grid_node)
        return self._give(outInfo, pipeline.render(self._node, self._follow))


class VoltetProbe(Filter):
    """A grid in, a table out: mean, deviation, least and greatest of s and g in a region, by the node `probe`, exact in every cell.

    Columns: `field` (s, g or an array), `mean`, `deviation`; the rows are the fields. `GetFigures()` has all that is known:
    covariance, volume, cells."""

    def __init__(self) -> None:
        self._region: dict[str, Any] = {}
        self._method: dict[str, Any] = {"method": "least-squares"}
        self._fields: list[str] = []
        self._figures: dict[str, Any] = {}
        super().__init__(1, "vtkDataSet", "vtkTable")

    @changed
    def SetBox(self, low, high):
        """The region: a box between two corners, in the grid's units."""
        return self._set_region({"box": {"low": list(low), "high": list(high)}})

    @changed
    def SetSphere(self, centre, radius):
        """The region: a ball."""
        return self._set_region({"sphere": {"centre": list(centre), "radius": radius}})

    @changed
    def SetPoints(self, points):
        """The region: points, n × 3, that count alike."""
        return self._set_region({"points": np.asarray(points, float).reshape(-1, 3).tolist()})

    @changed
    def SetWholeGrid(self):
        """The region: all cells. The default."""
        return self._set_region({})

    def _set_region(self, region: dict[str, Any]) -> bool:
        self._region, before = region, self._region
        return repr(region) != repr(before)

    @changed
    def SetFields(self, names):
        """One to eight arrays to look at in place of s and g."""
        self._fields, before = list(names), self._fields
        return self._fields != before

    @changed
    def SetMethod(self, method, **parameters):
        """The gradient filter, with its parameters."""
        given = {"method": method, **parameters}
        self._method, before = given, self._method
        return repr(given) != repr(before)

    def GetFigures(self) -> dict[str, Any]:
        """What was found: fields, centre, sigma, covariance, matrix, cells, volume."""
        return self._figures

    def _execute(self, inInfo, outInfo):
        data = self.GetInputData(inInfo, 0, 0)
        name, association = self._quantity(data)
        given, _ = self._grid(data, list(dict.fromkeys([name, *self._fields])), association)
        scalar = name if given.about["arrays"][name]["components"] == 1 else f"{name}:magnitude"
        pipeline = Pipeline()
        pipeline.add("grid", "given-grid", scalar=scalar)
        pipeline.add("gradient", "gradient-magnitude", grid="grid", **self._method)
        fields = {"fields": self._fields} if self._fields else {}
        pipeline.add("probe", "probe", volume="gradient", **self._region, **fields)
        pipeline.give(given)
        self._figures = pipeline.run(self._follow).found["probe"]
        table = vtkTable.GetData(outInfo)
        table.Initialize()
        names = vtkStringArray()
        names.SetName("field")
        for field in self._figures["fields"]:
            names.InsertNextValue(field)
        table.AddColumn(names)
        for title, key in (("mean", "centre"), ("deviation", "sigma")):
            column = vtkDoubleArray()
            column.SetName(title)
            for value in self._figures[key]:
                column.InsertNextValue(value)
            table.AddColumn(column)
        return 1


def _fields(widgets: Sequence[Mapping[str, Any]] | None) -> list[str]:
    """Arrays that widgets look at beside s."""
    return [field for widget in widgets or [] for field in widget.get("fields", [])]


def _all_names(data: Any) -> list[str]:
    """The names of all arrays of numbers of a data set, or of the first part of one."""
    leaf = data if isinstance(data, vtkDataSet) else next(iter(_vtk_grid._leaves(data)), None)
    if leaf is None:
        return []
    attributes = (leaf.GetPointData(), leaf.GetCellData())
    arrays = [found.GetArray(i) for found in attributes for i in range(found.GetNumberOfArrays())]
    names = [array.GetName() for array in arrays if array is not None]
    return [name for name in dict.fromkeys(names) if name and name != "vtkGhostType"]
