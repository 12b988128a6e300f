"""A volume and surfaces in one plotter of PyVista: each stands before and behind the other as it should.

python examples/python/plotter.py [PICTURE]
"""

import sys

import numpy as np
import pyvista as pv

grid = pv.ImageData(dimensions=(25, 25, 25), spacing=(1 / 12,) * 3, origin=(-1, -1, -1)).cast_to_unstructured_grid()
x, y, z = grid.points.T
grid["pressure"] = np.cos(3 * x) * np.cos(3 * y) * np.cos(2 * z) - 0.4 * z
grid["velocity"] = np.column_stack([-y, x, 0.4 * np.ones(len(x))])

plotter = pv.Plotter(off_screen=True, window_size=(480, 360))
plotter.background_color = "black"
volume = plotter.voltet.add_volume(
    grid, "pressure", cmap="viridis", opacity=[0.9, 0.3, 0.0, 0.3, 0.9], opacity_unit_distance=0.3, shade=True, ambient=0.4, diffuse=0.6,
    scalar_bar_args={"color": "white"},
)
lines = grid.streamlines("velocity", n_points=12, source_radius=0.9, max_length=30.0)
plotter.add_mesh(lines.tube(radius=0.015), color="orange", show_scalar_bar=False)
plotter.add_mesh(grid.outline(), color="grey")
plotter.show(auto_close=False)
volume.raise_error()
plotter.screenshot(sys.argv[1] if len(sys.argv) > 1 else "plotter.jpg")
