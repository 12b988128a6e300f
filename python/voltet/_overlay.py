"""A picture over a renderer of PyVista: drawn when something has changed, laid over each frame."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista as pv
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkFloatArray

from ._errors import usage
from ._picture import Picture
from ._pipeline import Pipeline
from ._scene import scene
from .vtk import camera_parameters

if TYPE_CHECKING:
    from ._look import Look


class Overlay:
    """A volume in a plotter.

    Attributes
    ----------
    picture : Picture or None
        The last picture: what is seen of the volume; row 0 at the top.
    pipeline : voltet.Pipeline
        What draws it; changes of it are drawn after `modified()`.
    error : Exception or None
        What the last frame raised: VTK draws frames, and would forget it. `raise_error()` raises it.
    """

    def __init__(self, owner: Any, name: str, plotter: Any, look: Look, method: Any, scale: float, options: Mapping[str, Any]):
        if not 0.1 <= scale <= 1.0:
            raise usage("'scale' is out of range", scale, "0.1 to 1")
        self.name = name
        self.picture: Picture | None = None
        self.error: BaseException | None = None
        self.scalar_bar: Any = None
        self.draws = 0
        self._owner, self._plotter, self._look, self._scale = owner, plotter, look, scale
        self._renderer = plotter.renderer
        grid = look.grid()
        self._given = grid
        self.pipeline: Pipeline = scene(
            grid, look.scalar, widgets=look.widgets, unit_distance=look.unit_distance, method=method, **options
        )
        self._seen: tuple | None = None
        self._pixels: Any = None
        self._tag: int | None = None
        self._bounds: Any = None

    def begin(self, reset_camera: bool | None) -> None:
        """Follows the renderer; its bounds are those of the volume, too."""
        low, high = self._given.bounds
        box = pv.Box(tuple(value for pair in zip(low, high) for value in pair)).outline()
        self._bounds = self._plotter.add_mesh(
            box, opacity=0.0, pickable=False, show_scalar_bar=False, name=f"{self.name} bounds",
            reset_camera=reset_camera, render=False,
        )
        self._tag = self._renderer.AddObserver("EndEvent", self._frame)

    def end(self) -> None:
        """Follows no longer; the plotter closes."""
        if self._tag is not None:
            self._renderer.RemoveObserver(self._tag)
            self._tag = None

    def remove(self) -> None:
        """Takes the volume out of the plotter."""
        self.end()
        self._owner._overlays.pop(self.name, None)
        if self._plotter.render_window is not None:
            self._plotter.remove_actor(self._bounds, render=False)
            if self.scalar_bar is not None:
                self._plotter.remove_actor(self.scalar_bar, render=False)

    def modified(self) -> None:
        """Says that the pipeline was changed: the next frame draws anew."""
        self._seen = None

    def raise_error(self) -> None:
        """Raises what the last frame raised, if it did."""
        if self.error is not None:
            raise self.error

    # --- frames

    def _frame(self, *_: Any) -> None:
        try:
            self._draw()
            self.error = None
        except BaseException as error:
            self.error = error
            if not isinstance(error, KeyboardInterrupt):
                from vtkmodules.vtkCommonCore import vtkOutputWindow

                vtkOutputWindow.GetInstance().DisplayErrorText(f"ERROR: In voltet: {error}\n")

    def _draw(self) -> None:
        window = self._renderer.GetRenderWindow()
        if window is None:
            return
        left, bottom = self._renderer.GetOrigin()
        width, height = self._renderer.GetSize()
        if min(width, height) < 1:
            return
        size = (max(1, round(width * self._scale)), max(1, round(height * self._scale)))
        grid = self._look.grid()
        camera = self._renderer.GetActiveCamera()
        view = camera_parameters(camera, size)
        ends = _ends(window, camera, (left, bottom), (width, height), size)
        seen = (repr(view), id(grid), None if ends is None else hash(ends.tobytes()))
        if seen != self._seen:
            if grid is not self._given:
                self.pipeline.give(grid, "grid")
                self._given = grid
            stated = self.pipeline["view"].parameters
            self.pipeline.set({f"view.{key}": value for key, value in view.items() if stated.get(key) != value})
            if ends is None:
                self.picture = self.pipeline.render("picture")
            else:
                self.picture = self.pipeline.render_until(ends, "picture")
            self.draws += 1
            self._pixels = _pixels(self.picture, (width, height), self._look.linear)
            self._seen = seen
        window.SetRGBAPixelData(
            left, bottom, left + width - 1, bottom + height - 1, self._pixels, 0 if window.GetDoubleBuffer() else 1, 1
        )


def _ends(
    window: Any, camera: Any, corner: tuple[int, int], window_size: tuple[int, int], size: tuple[int, int]
) -> np.ndarray | None:
    """How far each pixel's ray goes before it meets a surface, along the view direction; None where none does."""
    values = vtkFloatArray()
    (left, bottom), (width, height) = corner, window_size
    if not window.GetZbufferData(left, bottom, left + width - 1, bottom + height - 1, values):
        return None
    z = vtk_to_numpy(values).reshape(height, width)[::-1]
    if not (z < 1.0).any():
        return None
    rows = ((np.arange(size[1]) + 0.5) * height / size[1]).astype(int)
    columns = ((np.arange(size[0]) + 0.5) * width / size[0]).astype(int)
    z = z[rows][:, columns].astype(float)
    near, far = camera.GetClippingRange()
    if camera.GetParallelProjection():
        depth = near + z * (far - near)
    else:
        depth = near * far / (far - z * (far - near))
    return np.where(z < 1.0, depth, np.inf).astype(np.float32)


def _pixels(picture: Picture, size: tuple[int, int], linear: bool) -> Any:
    """The picture as VTK lays it over: rows from below, alpha not multiplied in, colours as the window shows them."""
    if linear:
        rgba = picture.rgba8().astype(np.float32) / 255.0
    else:
        rgba = np.array(picture, np.float32)
        np.divide(rgba[..., :3], rgba[..., 3:], out=rgba[..., :3], where=rgba[..., 3:] > 0)
    rows = ((np.arange(size[1]) + 0.5) * rgba.shape[0] / size[1]).astype(int)
    columns = ((np.arange(size[0]) + 0.5) * rgba.shape[1] / size[0]).astype(int)
    if rgba.shape[:2] != (size[1], size[0]):
        rgba = rgba[rows][:, columns]
    return numpy_to_vtk(np.ascontiguousarray(rgba[::-1], np.float32).reshape(-1, 4), deep=True)
