"""PyVista accessors: `grid.voltet.render()`, `grid.voltet.gradient()`, `plotter.voltet.add_volume(grid)`.

PyVista 0.48 and later load them when one of them is first used; nothing need be imported. Words and defaults (`scalars`, `clim`,
`cmap`, `opacity`, `opacity_unit_distance`) are those of PyVista's own `add_volume`; what is drawn is the cells themselves.

>>> import pyvista as pv
>>> grid = pv.examples.load_hexbeam().cast_to_unstructured_grid()
>>> grid["z"] = grid.points[:, 2]
>>> grid.voltet.render("z", window_size=(64, 48)).shape
(48, 64, 4)
>>> "z_gradient_magnitude" in grid.voltet.gradient("z").point_data
True
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from itertools import count
from typing import TYPE_CHECKING, Any

import numpy as np
import pyvista as pv

from . import _vtk_grid
from ._errors import picture_size, usage
from ._grid import Grid
from ._look import Look
from ._plotted import Plotted, draw_volumes
from ._picture import Picture
from ._pipeline import Pipeline
from ._scene import pipeline_of
from ._vtk_scene import look_from
from ._vtk_values import VoltetGradientMagnitude
from ._words import headlight, options_of

if TYPE_CHECKING:
    from numpy.typing import NDArray

__all__ = ["GridAccessor", "PlotterAccessor"]


@pv.register_dataset_accessor("voltet", pv.DataObject)
class GridAccessor:
    """What voltet does with a data set."""

    def __init__(self, data: Any):
        self._data = data

    def grid(self, arrays: Sequence[str] | None = None, **options: Any) -> Grid:
        """The data set as a `voltet.Grid`, its memory shared: `arrays` (default: all of numbers), options as of that."""
        return _vtk_grid.grid(self._data, arrays, watch=True, **options)

    def render(
        self,
        scalars: str | NDArray[Any] | None = None,
        *,
        clim: float | Sequence[float] | None = None,
        cmap: Any = None,
        opacity: Any = "linear",
        n_colors: int = 256,
        opacity_unit_distance: float | None = None,
        widgets: Sequence[Mapping[str, Any]] | None = None,
        camera: Any = None,
        window_size: Sequence[int] | None = None,
        preference: str = "point",
        component: int | None = None,
        flip_scalars: bool = False,
        categories: bool | int = False,
        log_scale: bool = False,
        above_color: Any = None,
        below_color: Any = None,
        shade: bool = False,
        ambient: float | None = None,
        diffuse: float | None = None,
        method: str | Mapping[str, Any] | None = None,
        **renderer: Any,
    ) -> Picture:
        """The picture of the data set: a float32 array, height × width × 4, premultiplied RGBA, row 0 at the top.

        Parameters
        ----------
        scalars : str or array
            The quantity; default: the active scalars. Of vectors the magnitude.
        component : int
            The component of an array of several, from 0, in place of the magnitude.
        clim, cmap, opacity, n_colors, opacity_unit_distance, flip_scalars, categories, log_scale
            As of `pyvista.Plotter.add_volume`. The colours are composited as they are, as VTK does. A `LookupTable` as cmap states
            clim, opacity, number, order and scale of the colours and those beyond; these words have no effect beside it.
        above_color, below_color
            Colours of values beyond `clim`, with the opacity of its ends.
        shade, ambient, diffuse
            Light from the eye: colour times (ambient + diffuse |gradient · view|); default 0 and 0.7.
        widgets : list of dict
            A transfer function over s and g in their place, by `voltet.widgets`: colours are linear then.
        camera : pyvista.Camera or camera position
            Where it is seen from; default: where PyVista's plotter would stand.
        window_size : pair of int
            Width and height in pixels; default: the theme's.
        preference : "point" or "cell"
            Where arrays are looked for that both have.
        method : str or mapping
            The gradient filter.
        **renderer
            Parameters of the node `renderer`: `integrator`, `engine`, `light`, …; `annotation` as of `voltet.scene`. Other words of
            `add_volume` are refused with the reason.
        """
        options = options_of(renderer, headlight(shade, ambient, diffuse))
        look = Look(
            self._data, scalars, preference=preference, component=component, clim=options.pop("clim", clim),
            cmap=options.pop("cmap", cmap), opacity=opacity, n_colors=n_colors, flip_scalars=flip_scalars, categories=categories,
            log_scale=log_scale, above_color=above_color, below_color=below_color, opacity_unit_distance=opacity_unit_distance,
            widgets=widgets,
        )
        size = picture_size("window_size", pv.global_theme.window_size if window_size is None else window_size)
        pipeline = pipeline_of(
            look.grid(), look.scalar, widgets=look.widgets, unit_distance=look.unit_distance, look=look.axes, size=size,
            method=method, **options,
        )
        look_from(pipeline, _camera(self._data, camera, size), size, headlight=shade)
        return pipeline.render()

    def gradient(
        self,
        scalars: str | None = None,
        method: str = "least-squares",
        *,
        vectors: bool = True,
        preference: str = "point",
        **parameters: Any,
    ) -> Any:
        """The same data set with `NAME_gradient_magnitude`, and with `vectors` `NAME_gradient`, at its points; arrays are shared.

        `method` is a gradient filter of voltet, or one of `voltet.gradient_filter`, with its parameters."""
        filter = VoltetGradientMagnitude()
        filter.SetMethod(method, **parameters)
        filter.SetComputeGradient(vectors)
        if scalars is not None:
            place = 1 if preference == "cell" else 0
            others = getattr(self._data, ("point_data", "cell_data")[1 - place], {})
            own = getattr(self._data, ("point_data", "cell_data")[place], {})
            filter.SetInputArrayToProcess(0, 0, 0, place if scalars in own or scalars not in others else 1 - place, scalars)
        filter.SetInputDataObject(0, self._data)
        filter.Update()
        return pv.wrap(filter.GetOutputDataObject(0))


def _camera(data: Any, camera: Any, size: Sequence[int]) -> Any:
    """The vtkCamera that is meant."""
    if isinstance(camera, pv.Camera):
        return camera
    # One that PyVista itself would set up about the bounds.
    plotter = pv.Plotter(off_screen=True, window_size=list(size))
    try:
        plotter.add_mesh(pv.Box(data.bounds), opacity=0.0)
        if camera is not None:
            try:
                plotter.camera_position = camera
            except Exception as error:
                expected = 'a pyvista.Camera, (position, focal point, up), or a side such as "xy"'
                raise usage("the camera is not known to PyVista", repr(camera)[:80], expected) from error
        else:
            plotter.view_isometric()
        own = pv.Camera()
        own.DeepCopy(plotter.camera)
        return own
    finally:
        plotter.close()


#: Pixels that a label of a scalar bar takes, at most: nine characters.
_LABEL_WIDTH = 90


def _bar(plotter: Any, given: Mapping[str, Any] | None) -> dict[str, Any]:
    """Arguments of a scalar bar whose labels do not reach beyond the window, nor into each other, where PyVista's own would."""
    bar = dict(given or {})
    is_vertical = bar.get("vertical")
    if is_vertical is None:
        is_vertical = pv.global_theme.colorbar_orientation == "vertical"
    if not is_vertical:
        width = bar.get("width") or pv.global_theme.colorbar_horizontal.width
        left, _, right, _ = plotter.renderer.viewport
        room = width * (right - left) * plotter.window_size[0]
        bar.setdefault("position_x", 0.5 - width / 2)
        bar.setdefault("n_labels", min(5, max(2, int(room / _LABEL_WIDTH))))
        if room < 2 * _LABEL_WIDTH:
            # VTK makes letters no smaller by itself.
            bar.setdefault("label_font_size", 8)
            bar.setdefault("title_font_size", 10)
    return bar


@pv.register_plotter_component("voltet")
class PlotterAccessor:
    """What voltet draws in a plotter."""

    def __init__(self, plotter: Any):
        self._plotter = plotter
        #: Addresses of the renderers whose frames are followed.
        self._followed: set[str] = set()

    def add_volume(
        self,
        volume: Any,
        scalars: str | NDArray[Any] | None = None,
        clim: float | Sequence[float] | None = None,
        opacity: Any = "linear",
        n_colors: int = 256,
        cmap: Any = None,
        *,
        opacity_unit_distance: float | None = None,
        widgets: Sequence[Mapping[str, Any]] | None = None,
        preference: str = "point",
        component: int | None = None,
        flip_scalars: bool = False,
        categories: bool | int = False,
        log_scale: bool = False,
        above_color: Any = None,
        below_color: Any = None,
        annotations: Mapping[float, str] | None = None,
        shade: bool = False,
        ambient: float | None = None,
        diffuse: float | None = None,
        method: str | Mapping[str, Any] | None = None,
        name: str | None = None,
        show_scalar_bar: bool = True,
        scalar_bar_args: Mapping[str, Any] | None = None,
        reset_camera: bool | None = None,
        scale: float = 1.0,
        render: bool = True,
        **renderer: Any,
    ) -> Plotted:
        """Draws a volume in the active renderer, over what is there, and follows camera and window.

        Parameters
        ----------
        volume : data set with cells, a composite one, or array
            What is drawn; unstructured grids share their memory. A three-dimensional array of real numbers is copied as it is now: what
            is masked becomes NaN, whose cells are left out.
        scalars, clim, opacity, n_colors, cmap, opacity_unit_distance, preference, flip_scalars, categories, log_scale, annotations
            As of `pyvista.Plotter.add_volume`.
        component, above_color, below_color, shade, ambient, diffuse
            As of `render`.
        widgets : list of dict
            A transfer function over s and g in place of `cmap` and `opacity`, by `voltet.widgets`.
        method : str or mapping
            The gradient filter.
        name : str
            A volume of this name is replaced.
        show_scalar_bar, scalar_bar_args
            As of `add_volume`; none with `widgets`. A level bar stands in the middle, with as many labels as have room.
        reset_camera : bool
            Whether the camera is set to see all; default: where none was set.
        scale : float
            Pixels of the picture per pixel of the window, 0.1 to 1: less is faster, and coarser.
        render : bool
            Whether to draw at once, where the plotter is shown already.
        **renderer
            Parameters of the node `renderer`. Other words of `add_volume` are refused with the reason.

        Returns
        -------
        Plotted
            The actor, with `picture`, `pipeline`, `modified()` and `remove()`: it is hidden (`volume.visibility = False`), removed
            (`remove_actor`, `clear`) and added again as other actors. Moved it cannot be.

        It is drawn again when camera, window, data (by VTK's modified times) or opaque surfaces in it change, and not otherwise.
        Before and behind opaque surfaces it stands as it should: rays end where they meet one (on the CPU, by the native engine).
        Several volumes in one renderer are laid one over the other in the order in which they were added.
        """
        plotter = self._plotter
        if getattr(plotter, "_closed", False) or getattr(plotter, "render_window", None) is None:
            raise usage("the plotter is closed", None, "a plotter that is open")
        options = options_of(renderer, headlight(shade, ambient, diffuse))
        if "annotation" in options:
            raise usage("'annotation' is no word of add_volume", None, "scalar_bar_args, or the plotter's add_text and show_bounds")
        look = Look(
            volume, scalars, preference=preference, component=component, clim=options.pop("clim", clim), cmap=options.pop("cmap", cmap),
            opacity=opacity, n_colors=n_colors, flip_scalars=flip_scalars, categories=categories, log_scale=log_scale,
            above_color=above_color, below_color=below_color, annotations=annotations,
            opacity_unit_distance=opacity_unit_distance, widgets=widgets,
        )
        overlay = Plotted(plotter, look, method, scale, shade, options)
        name = name or next(name for i in count() if (name := f"voltet {i}") not in self.volumes)
        for follower in plotter.renderers:
            if (address := follower.GetAddressAsString("")) not in self._followed:
                self._followed.add(address)
                follower.AddObserver("EndEvent", draw_volumes)
        # Replaces the one of this name, in whichever renderer it is.
        plotter.remove_actor(self.volumes.get(name), render=False)
        plotter.add_actor(overlay, name=name, reset_camera=reset_camera, pickable=False, render=False)
        if show_scalar_bar and widgets is None:
            plotter.add_scalar_bar(
                **{"title": look.name, **_bar(plotter, scalar_bar_args)}, mapper=overlay.mapper, render=False
            )
        if render and plotter.render_window is not None and getattr(plotter, "_rendered_once", False):
            plotter.render()
        return overlay

    @property
    def volumes(self) -> dict[str, Plotted]:
        """The volumes of all renderers, by name."""
        props = [prop for renderer in self._plotter.renderers for prop in renderer.GetViewProps()]
        return {prop.name: prop for prop in props if isinstance(prop, Plotted)}
