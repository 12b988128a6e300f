"""What the VTK filters share that draw a grid: cameras, the transfer function, the pipeline."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

from ._errors import picture_size, whole
from ._pipeline import Pipeline
from ._scene import scene
from ._vtk_filter import Filter, changed

if TYPE_CHECKING:
    from vtkmodules.vtkRenderingCore import vtkCamera


def camera_parameters(camera: vtkCamera, size: Sequence[int], tiles: int = 1) -> dict[str, Any]:
    """Parameters of a node `camera` that sees what a vtkCamera sees in a window of this size, pixels. `tiles`: how many of its views
    stand one above another in the window, where it is narrowed to one."""
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
        "size": list(picture_size("size", size)),
    }
    if camera.GetParallelProjection():
        return {**seen, "height": 2.0 * camera.GetParallelScale() * tiles, "fov_y": None}
    if tiles > 1:
        fov_y = 2.0 * degrees(atan(tan(radians(fov_y) / 2.0) * tiles))
    return {**seen, "fov_y": fov_y, "height": None}


def look_from(
    pipeline: Pipeline, camera: vtkCamera, size: Sequence[int], node: str = "view", tiles: int = 1, headlight: bool = False
) -> bool:
    """Gives a node the parameters of a vtkCamera; whether they are others than before. `headlight`: the light of the node `picture`
    comes from the eye."""
    stated = pipeline[node].parameters
    seen = camera_parameters(camera, size, tiles)
    other = {key: value for key, value in seen.items() if stated.get(key) != value}
    pipeline.set({f"{node}.{key}": value for key, value in other.items()})
    if headlight and pipeline["picture"]["light.direction"] != (direction := list(camera.GetViewPlaneNormal())):
        pipeline.set({"picture.light.direction": direction})
        return True
    return bool(other)


class Scene(Filter):
    """A filter that has a grid drawn by a pipeline of its own.

    The scalar is chosen by `SetInputArrayToProcess(0, 0, 0, association, name)`, else the active scalars are drawn. Without widgets
    it is drawn in viridis over its range."""

    def __init__(self, output_type: str) -> None:
        self._widgets: list[dict[str, Any]] | None = None
        self._unit_distance: float | None = None
        self._component: int | None = None
        self._parameters: dict[str, Any] = {}
        self._scene: Pipeline | None = None
        self._made: tuple | None = None
        super().__init__(1, "vtkDataSet", output_type)

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
        component = None if component is None else whole("component", component)
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

    def GetPipeline(self) -> Pipeline | None:
        """The pipeline of the last update, to be saved for `voltet run` and `voltet edit`."""
        return self._scene

    def _prepare(self, data: Any, size: Sequence[int], fitted: bool) -> Pipeline:
        """The pipeline that draws the data: the former one, with another grid, where no more has changed. `fitted`: its camera is to
        see all, in a picture of this size."""
        name, association = self._quantity(data)
        names = [name, *_fields(self._widgets)]
        given, other = self._grid(data, list(dict.fromkeys(names)), association)
        components = given.about["arrays"][name]["components"]
        scalar = name if components == 1 else f"{name}:{'magnitude' if self._component is None else self._component}"
        made = (scalar, repr(self._widgets), self._unit_distance, repr(self._parameters), fitted and tuple(size))
        if self._scene is None or made != self._made or other and self._widgets is None:
            self._scene = self._begin(given, scalar, size)
            self._made = made
        elif other:
            self._scene.give(given, "grid")
        return self._scene

    def _begin(self, given: Any, scalar: str, size: Sequence[int]) -> Pipeline:
        parameters = {key: value for key, value in self._parameters.items() if not key.startswith("picture.")}
        drawing = {key.partition(".")[2]: value for key, value in self._parameters.items() if key.startswith("picture.")}
        method = {key.partition(".")[2]: value for key, value in parameters.items() if key.startswith("gradient.")}
        pipeline = scene(
            given, scalar, widgets=self._widgets, size=(size[0], size[1]), unit_distance=self._unit_distance, method=method,
            annotation=None, **drawing
        )
        pipeline.set({key: value for key, value in parameters.items() if not key.startswith("gradient.")})
        return pipeline


def _fields(widgets: Sequence[Mapping[str, Any]] | None) -> list[str]:
    """Arrays that widgets look at beside s."""
    return [field for widget in widgets or [] for field in widget.get("fields", [])]
