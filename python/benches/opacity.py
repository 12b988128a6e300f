"""Opacity and unit distance here and in PyVista's volume rendering of unstructured grids: a unit cube of one value, seen from the front.

python benches/opacity.py         prints the table of docs/src/how-to/migration.md

PyVista draws it with vtkUnstructuredGridVolumeRayCastMapper. Numbers are grey levels of 255 over black, the median over the cube's face.
"""

from __future__ import annotations

import numpy as np
import pyvista as pv

#: Opacity over a unit distance, and the unit distance; the cube is one unit deep.
CASES = [(0.5, 1.0), (0.5, 0.5), (0.5, 2.0), (0.1, 1.0), (0.9, 1.0)]


def cube() -> pv.UnstructuredGrid:
    """A cube of side 1 of 8³ × 5 tetrahedra, whose value is 1."""
    grid = pv.ImageData(dimensions=(9, 9, 9), spacing=(1 / 8,) * 3).cast_to_unstructured_grid().triangulate()
    grid["T"] = np.ones(grid.n_points)
    return grid


def plotter() -> pv.Plotter:
    """A plotter that looks at the middle half of the cube's front, in parallel projection, over black."""
    p = pv.Plotter(off_screen=True, window_size=(64, 64))
    p.background_color = "black"
    p.camera.position, p.camera.focal_point, p.camera.up = (0.5, -4.0, 0.5), (0.5, 0.5, 0.5), (0.0, 0.0, 1.0)
    p.camera.parallel_projection = True
    p.camera.parallel_scale = 0.25
    return p


def measured(opacity: float, unit_distance: float) -> tuple[float, float, float]:
    """Grey levels by 255 (1 - (1 - opacity)^(1 / unit_distance)), by voltet, and by PyVista's ray caster."""
    look = {"opacity": [opacity, opacity], "cmap": ["white", "white"], "clim": (0.0, 2.0), "opacity_unit_distance": unit_distance}
    levels = []
    for own in (True, False):
        p = plotter()
        (p.voltet if own else p).add_volume(cube(), scalars="T", show_scalar_bar=False, reset_camera=False, **look)
        p.show(auto_close=False)
        levels.append(float(np.median(p.screenshot(return_img=True)[..., 0])))
        p.close()
    return 255 * (1 - (1 - opacity) ** (1 / unit_distance)), levels[0], levels[1]


def table() -> str:
    """The table, in Markdown."""
    lines = ["| opacity | unit distance | formula | voltet | PyVista's ray caster |", "| ---: | ---: | ---: | ---: | ---: |"]
    for opacity, unit_distance in CASES:
        formula, own, vtk = measured(opacity, unit_distance)
        lines.append(f"| {opacity} | {unit_distance} | {formula:.1f} | {own:.0f} | {vtk:.0f} |")
    return "\n".join(lines)


if __name__ == "__main__":
    print(table())
