"""Prints what the Python route costs: python python/benches/bars.py [FILE.vtu [SCALAR]]

FILE: an unstructured grid, such as the blunt fin; standard: the heat sink that ships. A frame's cost beyond the program's own run is
what Python adds: the camera set, the pipeline's text read and checked, a thread, arrays looked at again.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import numpy as np

import voltet

ROOT = Path(__file__).parent.parent.parent


def median(work, rounds=9):
    times = []
    for i in range(rounds):
        start = time.perf_counter()
        work(i)
        times.append(time.perf_counter() - start)
    return float(np.median(times))


def importing():
    code = "import time; t = time.perf_counter(); import voltet; print(time.perf_counter() - t)"
    times = [float(subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True).stdout) for _ in range(7)]
    print(f"import voltet: {1e3 * float(np.median(times)):.1f} ms (bar: 100)")


def frames(path, scalar):
    import pyvista as pv

    data = pv.read(path)
    low, high = voltet.vtk.grid(data, [scalar]).arrays[scalar]
    look = [voltet.widgets.gaussian(color=[1, 0.5, 0.2], extinction=2.0, centre=[0.5 * (low + high), 0.0], sigma=[0.2 * (high - low), float("inf")])]
    own = voltet.scene(voltet.vtk.grid(data, [scalar], watch=True), scalar, widgets=look, size=(512, 512), engine="cpu")
    eye = own["view"]["eye"]
    whole, inside = [], []
    for i in range(61):
        start = time.perf_counter()
        own["view"]["eye"] = [eye[0] * (1 + 0.001 * i), *eye[1:]]
        picture = own.render()
        whole.append(time.perf_counter() - start)
        inside.append(picture.report["seconds"])
    # The first one computes the gradient.
    with_python, program = (1e3 * float(np.median(seconds[1:])) for seconds in (whole, inside))
    more = 100 * (with_python / program - 1)
    print(f"a frame at 512²: {with_python:.1f} ms, of it the program's own run {program:.1f} ms: {more:.1f} % more (bar: 3)")


def four_million():
    n = 94
    axis = np.linspace(0.0, 1.0, n)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(n**3, dtype=np.uint32).reshape(n, n, n)
    corner = lambda i, j, k: number[i : n - 1 + i, j : n - 1 + j, k : n - 1 + k].reshape(-1)  # noqa: E731
    ways = [(1, 2, 4), (1, 4, 2), (2, 1, 4), (2, 4, 1), (4, 1, 2), (4, 2, 1)]
    cells = []
    for way in ways:
        at = np.cumsum([0, *way])
        cells.append(np.stack([corner(a >> 2 & 1, a >> 1 & 1, a & 1) for a in at], -1))
    tetrahedra = np.sort(np.concatenate(cells), axis=1)
    start = time.perf_counter()
    about = voltet.Grid(points, tetrahedra=tetrahedra, point_data={"x": points[:, 0].copy()}).about
    print(
        f"{about['tetrahedra']:,} cells from numpy in {time.perf_counter() - start:.2f} s: "
        f"{about['bytes_lent'] / 2**20:.0f} MiB lent, {about['bytes_copied']} bytes copied (bar: 0 of points and connectivity)"
    )


def plotters(path, scalar):
    import pyvista as pv

    data = pv.read(path)
    words = {"cmap": "inferno", "opacity": "linear", "opacity_unit_distance": data.length / 20, "show_scalar_bar": False}

    def shown(add):
        plotter = pv.Plotter(off_screen=True, window_size=(512, 512))
        plotter.background_color = "black"
        given = add(plotter)
        plotter.camera_position = "iso"
        plotter.show(auto_close=False)
        first = plotter.screenshot(return_img=True).astype(float) / 255
        count = 5

        def turn(i):
            plotter.camera.azimuth = 3.0 * (i + 1)
            plotter.render()

        return first, 1.0 / median(turn, count), plotter, given

    ours, our_rate, plotter, volume = shown(lambda p: p.voltet.add_volume(data.copy(), scalar, engine="cpu", **words))
    theirs, their_rate, other, _ = shown(lambda p: p.add_volume(data.copy(), scalars=scalar, **words))
    plotter.camera_position = "iso"
    plotter.render()
    volume.pipeline["picture"]["integrator"] = "reference"
    reference = np.asarray(volume.pipeline.render("picture"))[..., :3]
    for name, image, rate in (("plotter.voltet.add_volume", ours, our_rate), ("plotter.add_volume", theirs, their_rate)):
        error = np.abs(image - reference)
        print(f"{name}: {rate:.2f} frames/s at 512², error against the reference: largest {error.max():.4f}, mean {error.mean():.5f}")


if __name__ == "__main__":
    import voltet.vtk  # noqa: F401

    path = Path(sys.argv[1]) if len(sys.argv) > 1 else ROOT / "data/heat_sink.vtu"
    scalar = sys.argv[2] if len(sys.argv) > 2 else "Temperature"
    importing()
    four_million()
    frames(path, scalar)
    plotters(path, scalar)
