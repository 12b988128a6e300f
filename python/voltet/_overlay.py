"""A picture over a renderer of VTK: drawn when something has changed, laid over each frame."""

from __future__ import annotations

import weakref
from typing import TYPE_CHECKING, Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk, vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkFloatArray, vtkOutputWindow

from ._errors import usage
from ._picture import Picture
from ._vtk_scene import look_from

if TYPE_CHECKING:
    from ._pipeline import Pipeline
    from ._shown import Shown
    from ._vtk_volume import VoltetVolume

#: Left, bottom, right and top in pixels, rows from below.
_Box = tuple[int, int, int, int]


class Overlay:
    """A volume over the frames of a renderer.

    Attributes
    ----------
    picture : Picture or None
        The last picture: what is seen of the volume; row 0 at the top.
    pipeline : voltet.Pipeline
        What draws it; changes of it are drawn after `modified()`.
    error : Exception or None
        What the last frame raised: VTK draws frames, and would forget it. `raise_error()` raises it.
    draws : int
        How often it was drawn.
    """

    pipeline: Pipeline

    def __init__(self, scale: float = 1.0, linear: bool = True, headlight: bool = False):
        if not 0.1 <= scale <= 1.0:
            raise usage("'scale' is out of range", scale, "0.1 to 1")
        self.picture: Picture | None = None
        self.error: BaseException | None = None
        self.draws = 0
        #: Width and height of the renderer that the last picture was drawn for, pixels.
        self._window_size = (1, 1)
        #: Pixels of the picture per pixel of the window.
        self._scale = scale
        self._linear = linear
        self._headlight = headlight
        self._seen: tuple | None = None
        self._pixels: Any = None

    def modified(self) -> None:
        """Says that the pipeline was changed: the next frame draws anew."""
        self._seen = None

    def raise_error(self) -> None:
        """Raises what the last frame raised, if it did."""
        if self.error is not None:
            raise self.error

    def pick(self, x: int, y: int) -> Shown:
        """The cells along the ray of a pixel, as `Pipeline.pixel` gives them: with entry, exit, values and share of the colour. x, y:
        column from the left and row from the top of the renderer, pixels of the window. Opaque surfaces do not end the ray."""
        if self.picture is None:
            raise usage("nothing was drawn yet", None, "a frame: show() or render() of the plotter")
        # The pixel of the picture in which the middle of the window's lies.
        width, height = self._window_size
        rows, columns = self.picture.shape[:2]
        column = min(max(int((x + 0.5) * columns / width), 0), columns - 1)
        row = min(max(int((y + 0.5) * rows / height), 0), rows - 1)
        return self.pipeline.pixel(column, row, "picture")

    def frame(self, renderer: Any) -> None:
        """Lays it over what the renderer has drawn; to be called when it has, while its window is current."""
        error: BaseException | None = None
        try:
            self._draw(renderer)
        except BaseException as raised:
            error = raised
        # Each frame raises the same until something is changed.
        is_new = error is not None and str(error) != str(self.error)
        self.error = error
        if is_new and not isinstance(error, KeyboardInterrupt):
            vtkOutputWindow.GetInstance().DisplayErrorText(f"ERROR: In voltet: {error}\n")

    def _current(self) -> Any:
        """Brings the pipeline up to date; what changes where it did."""
        return None

    def _draw(self, renderer: Any) -> None:
        window = renderer.GetRenderWindow()
        # A selector's frames show numbers of cells as colours.
        if window is None or renderer.GetSelector() is not None:
            return
        width, height = renderer.GetSize()
        place, part = _places(window, renderer)
        if min(width, height, part[2] - part[0], part[3] - part[1]) < 1:
            return
        size = (max(1, round(width * self._scale)), max(1, round(height * self._scale)))
        current = self._current()
        camera = renderer.GetActiveCamera()
        ends = _ends(window, camera, place, part, (width, height), size)
        look_from(self.pipeline, camera, size, tiles=window.GetTileScale()[1], headlight=self._headlight)
        seen = (self.pipeline.text, current, (width, height), None if ends is None else hash(ends.tobytes()))
        if seen != self._seen:
            picture = self.pipeline.render("picture") if ends is None else self.pipeline.render_until(ends, "picture")
            self.picture, self._window_size = picture, (width, height)
            self.draws += 1
            self._pixels = _pixels(picture, (width, height), self._linear)
            self._seen = seen
        left, bottom, right, top = part
        pixels = np.ascontiguousarray(self._pixels[bottom:top, left:right]).reshape(-1, 4)
        x, y = place
        window.SetRGBAPixelData(
            x, y, x + right - left - 1, y + top - bottom - 1, numpy_to_vtk(pixels), 0 if window.GetDoubleBuffer() else 1, 1
        )


def _places(window: Any, renderer: Any) -> tuple[tuple[int, int], _Box]:
    """Where in the window the renderer's frame begins, and which part of the renderer it shows: all of it, but for the tiles of
    which pictures are made that are larger than the window. The camera is narrowed to the tile then."""
    left, bottom = renderer.GetOrigin()
    width, height = renderer.GetSize()
    begin_x, begin_y, end_x, end_y = window.GetTileViewport()
    whole_x, whole_y = window.GetSize()
    tile = (round(begin_x * whole_x), round(begin_y * whole_y), round(end_x * whole_x), round(end_y * whole_y))
    part = (
        max(tile[0] - left, 0), max(tile[1] - bottom, 0), min(tile[2] - left, width), min(tile[3] - bottom, height),
    )
    return (max(left - tile[0], 0), max(bottom - tile[1], 0)), part


def _ends(
    window: Any, camera: Any, place: tuple[int, int], part: _Box, window_size: tuple[int, int], size: tuple[int, int]
) -> np.ndarray | None:
    """How far each pixel's ray goes before it meets a surface, along the view direction: 0 outside the part; None where none does."""
    values = vtkFloatArray()
    (x, y), (left, bottom, right, top), (width, height) = place, part, window_size
    if not window.GetZbufferData(x, y, x + right - left - 1, y + top - bottom - 1, values):
        return None
    z = vtk_to_numpy(values).reshape(top - bottom, right - left)
    if not (z < 1.0).any():
        return None
    rows, columns = _nearest(size[1], height)[::-1] - bottom, _nearest(size[0], width) - left
    rows_here, columns_here = (0 <= rows) & (rows < top - bottom), (0 <= columns) & (columns < right - left)
    z = z[rows[rows_here]][:, columns[columns_here]].astype(float)
    near, far = camera.GetClippingRange()
    if camera.GetParallelProjection():
        depth = near + z * (far - near)
    else:
        depth = near * far / (far - z * (far - near))
    ends = np.zeros((size[1], size[0]), np.float32)
    ends[np.ix_(rows_here, columns_here)] = np.where(z < 1.0, depth, np.inf)
    return ends


def _nearest(count: int, of: int) -> np.ndarray:
    """The pixels in which the middles of others lie, that are `count` along the same length."""
    return ((np.arange(count) + 0.5) * of / count).astype(int)


def _pixels(picture: Picture, size: tuple[int, int], linear: bool) -> np.ndarray:
    """The picture as VTK lays it over: rows from below, alpha not multiplied in, colours as the window shows them."""
    if linear:
        rgba = picture.rgba8().astype(np.float32) / 255.0
    else:
        rgba = np.array(picture, np.float32)
        np.divide(rgba[..., :3], rgba[..., 3:], out=rgba[..., :3], where=rgba[..., 3:] > 0)
    if rgba.shape[:2] != (size[1], size[0]):
        rgba = rgba[_nearest(size[1], rgba.shape[0])][:, _nearest(size[0], rgba.shape[1])]
    return rgba[::-1]


class VolumeOverlay(Overlay):
    """The volume of a filter over the frames of a renderer: drawn again when the filter was executed again, too."""

    def __init__(self, volume: VoltetVolume):
        super().__init__()
        # The filter goes when its pipeline does.
        self._volume = weakref.ref(volume)

    def _draw(self, renderer: Any) -> None:
        volume = self._volume()
        if volume is None:
            return
        volume.RaiseError()
        if volume.IsEmpty() or (pipeline := volume.GetPipeline()) is None:
            return
        self.pipeline, self._scale = pipeline, volume.GetScale()
        super()._draw(renderer)

    def _current(self) -> Any:
        volume = self._volume()
        return volume and (volume.GetVersion(), self._scale)
