"""A volume in a plotter of PyVista."""

from __future__ import annotations

import weakref
from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import pyvista as pv

from ._errors import usage
from ._overlay import Overlay
from ._scene import scene

if TYPE_CHECKING:
    from ._look import Look


class Plotted(Overlay, pv.Actor):
    """A volume in a plotter: an actor of it, which is hidden and removed as others are. What VTK draws of it is the outline of its
    bounds, fully transparent; the picture is laid over the frames of the renderers that have the actor, while it is visible.
    Its attributes are those of `Overlay`."""

    def __init__(self, plotter: Any, look: Look, method: Any, scale: float, headlight: bool, options: Mapping[str, Any]):
        Overlay.__init__(self, scale, look.linear, headlight)
        self._plotter = weakref.ref(plotter)
        self._look = look
        self._given = look.grid()
        self.pipeline = scene(
            self._given, look.scalar, widgets=look.widgets, unit_distance=look.unit_distance, look=look.axes, method=method,
            annotation=None, **options
        )
        low, high = self._given.bounds
        box = pv.Box(tuple(value for pair in zip(low, high) for value in pair)).outline()
        mapper = pv.DataSetMapper(box)
        # The scalar bar's; it goes with the actor.
        mapper.lookup_table = look.lookup_table()
        mapper.scalar_range = look.clim
        mapper.scalar_visibility = False
        pv.Actor.__init__(self, mapper, pv.Property(opacity=0.0))

    def remove(self) -> None:
        """Takes the volume out of the plotter."""
        plotter = self._plotter()
        if plotter is not None and plotter.render_window is not None:
            plotter.remove_actor(self, render=False)

    def _draw(self, renderer: Any) -> None:
        if not self.GetMatrix().IsIdentity():
            what = f"the volume '{self.name}' was moved, turned or scaled as an actor"
            raise usage(what, None, "the data set moved, turned or scaled, and its plotter's scale left at 1")
        super()._draw(renderer)

    def _current(self) -> int:
        grid = self._look.grid()
        if grid is not self._given:
            self.pipeline.give(grid, "grid")
            self._given = grid
        return id(grid)


def draw_volumes(renderer: Any, _: str) -> None:
    """Lays the volumes of a renderer that are visible over its frame."""
    for prop in renderer.GetViewProps():
        if isinstance(prop, Plotted) and prop.GetVisibility():
            prop.frame(renderer)
