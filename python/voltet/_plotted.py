"""A volume in a plotter of PyVista."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import pyvista as pv

from ._overlay import Overlay
from ._scene import scene

if TYPE_CHECKING:
    from ._look import Look


class Plotted(Overlay):
    """A volume in a plotter."""

    __doc__ = Overlay.__doc__

    def __init__(self, owner: Any, name: str, plotter: Any, look: Look, method: Any, scale: float, options: Mapping[str, Any]):
        super().__init__(scale, look.linear)
        self.name = name
        self.scalar_bar: Any = None
        self._owner, self._plotter, self._look = owner, plotter, look
        self._renderer = plotter.renderer
        self._given = look.grid()
        self.pipeline = scene(
            self._given, look.scalar, widgets=look.widgets, unit_distance=look.unit_distance, method=method, **options
        )
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
        self._tag = self._renderer.AddObserver("EndEvent", lambda *_: self.frame(self._renderer))

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

    def _current(self) -> int:
        grid = self._look.grid()
        if grid is not self._given:
            self.pipeline.give(grid, "grid")
            self._given = grid
        return id(grid)
