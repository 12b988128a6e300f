#!/usr/bin/env python3
"""Sets frames of this program beside those of VTK's unstructured-grid volume mappers, in one run: times and errors.

lab/bench/beside_vtk.py [--scenes bluntfin,heatsink] [--sizes 256,512] [--frames 5] [--adapter NAME] [--voltet PROGRAM]

The scenes are piecewise-linear in the scalar: the blunt fin (VOLTET_TEST_DATA/bluntfin.vtu), and the heat sink that ships. Rows:
the native engine; on a graphics device what the hardware blends, as the cells' outlines (raster) and as the triangles of the
papers (triangles), both in the order of centroids; and VTK. Both programs turn the camera by one degree before each frame; medians. Errors are those of 8-bit premultiplied colours on black against this program's
64-bit reference, in steps of 1/255. VTK draws off-screen by whatever OpenGL there is: without a graphics card, in software.
Needs Python 3.11 with the package `vtk` (lab/scripts/compare-vtk.sh makes an environment with it) and the program `voltet`.
"""

import argparse
import json
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from dataclasses import dataclass
from pathlib import Path

import vtk
from vtk.util.numpy_support import vtk_to_numpy

ROOT = Path(__file__).resolve().parent.parent


@dataclass
class Scene:
    """What is drawn; of points s, red, green, blue, extinction for each world unit."""

    grid: Path
    scalar: str
    eye: tuple
    target: tuple
    fov_y: float
    points: list


UP = (0.0, 0.0, 1.0)
SCENES = {
    # The look of lab/bench/scenes/bluntfin.toml.
    "bluntfin": Scene(
        Path(os.environ.get("VOLTET_TEST_DATA", ".")) / "bluntfin.vtu",
        "density",
        (-12.0314, -30.8182, 24.7259),
        (3.2732, 4.1638, 2.8621),
        30.0,
        [
            (0.2, 0.1, 0.2, 0.9, 0.0),
            (1.4, 0.1, 0.8, 0.9, 0.1),
            (2.6, 0.2, 0.8, 0.2, 0.5),
            (3.8, 0.9, 0.8, 0.1, 0.2),
            (4.97, 0.9, 0.1, 0.1, 1.5),
        ],
    ),
    # The view of pipelines/quickstart_1d.toml.
    "heatsink": Scene(
        ROOT / "data" / "heat_sink.vtu",
        "Temperature",
        (-70.0, -130.0, 75.0),
        (0.0, -1.0, 9.5),
        24.5,
        [
            (25.0, 0.02, 0.35, 0.20, 0.01),
            (46.0, 0.02, 0.50, 0.20, 0.05),
            (56.0, 0.10, 0.55, 0.90, 0.02),
            (61.0, 1.00, 0.48, 0.06, 0.20),
            (68.0, 1.00, 0.05, 0.02, 0.15),
            (108.0, 1.00, 0.90, 0.75, 0.30),
        ],
    ),
}
MAPPERS = {
    "VTK, projected tetrahedra": vtk.vtkProjectedTetrahedraMapper,
    "VTK, Bunyk ray caster": vtk.vtkUnstructuredGridVolumeRayCastMapper,
}


# Compositors that a device blends by, in the order of centroids.
BLENDED = ["raster", "triangles"]


def pipeline(scene: Scene, picture: Path) -> str:
    points = ",\n".join(f"    {list(point)}" for point in scene.points)
    return f"""[pipeline]
format = 1

[nodes.grid]
type = "reader"
path = {str(scene.grid.resolve())!r}
scalar = "{scene.scalar}"

[nodes.look]
type = "transfer-function"
unit_distance = 1.0

[[nodes.look.widgets]]
kind = "piecewise-linear"
points = [
{points},
]

[nodes.view]
type = "camera"
eye = {list(scene.eye)}
target = {list(scene.target)}
up = {list(UP)}
fov_y = {scene.fov_y}
size = [512, 512]

[nodes.picture]
type = "renderer"
engine = "cpu"
inputs = {{ volume = "grid", transfer_function = "look", camera = "view" }}

[nodes.file]
type = "image-writer"
path = {str(picture)!r}
inputs = {{ image = "picture" }}
"""


def run(command: list[str]) -> str:
    ran = subprocess.run(command, capture_output=True, text=True)
    if ran.returncode:
        sys.exit(f"{' '.join(command)}: {ran.stderr.strip()}")
    return ran.stdout


def colors(png: Path):
    """Linear colours of a picture, row 0 at the bottom."""
    reader = vtk.vtkPNGReader()
    reader.SetFileName(str(png))
    reader.Update()
    srgb = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars())[:, :3] / 255.0
    low = srgb <= 0.04045
    linear = ((srgb + 0.055) / 1.055) ** 2.4
    linear[low] = srgb[low] / 12.92
    return linear


def by_vtk(scene: Scene, grid, mapper_type, size: int, frames: int):
    """Milliseconds of the frames, and the first one's colours."""
    color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for s, red, green, blue, extinction in scene.points:
        color.AddRGBPoint(s, red, green, blue)
        opacity.AddPoint(s, extinction)
    look = vtk.vtkVolumeProperty()
    look.SetColor(color)
    look.SetScalarOpacity(opacity)
    look.SetScalarOpacityUnitDistance(1.0)
    look.SetInterpolationTypeToLinear()
    look.ShadeOff()
    mapper = mapper_type()
    mapper.SetInputData(grid)
    if hasattr(mapper, "SetAutoAdjustSampleDistances"):
        mapper.SetAutoAdjustSampleDistances(0)
        mapper.SetImageSampleDistance(1.0)
    volume = vtk.vtkVolume()
    volume.SetMapper(mapper)
    volume.SetProperty(look)
    renderer = vtk.vtkRenderer()
    renderer.SetBackground(0, 0, 0)
    renderer.AddVolume(volume)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(size, size)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*scene.eye)
    camera.SetFocalPoint(*scene.target)
    camera.SetViewUp(*UP)
    camera.SetViewAngle(scene.fov_y)

    def frame() -> float:
        start = time.perf_counter()
        renderer.ResetCameraClippingRange()
        window.Render()
        window.WaitForCompletion()
        return 1e3 * (time.perf_counter() - start)

    frame()
    shot = vtk.vtkWindowToImageFilter()
    shot.SetInput(window)
    shot.SetInputBufferTypeToRGB()
    shot.ReadFrontBufferOff()
    shot.ShouldRerenderOff()
    shot.Update()
    first = vtk_to_numpy(shot.GetOutput().GetPointData().GetScalars())[:, :3] / 255.0
    times = []
    for _ in range(frames):
        camera.Azimuth(1.0)
        times.append(frame())
    return times, first


def by_voltet(program: str, file: Path, size: int, frames: int, *options: str) -> dict[tuple[str, str], float]:
    """The medians of the frames by engine and order, milliseconds."""
    timed = ["--frames", str(frames), "--patience", "60", "--in-flight", "1", "--size", f"{size}x{size}"]
    table = run([program, "time", str(file), *timed, *options])
    rows = [[cell.strip() for cell in line.strip("| ").split("|")] for line in table.splitlines() if line.startswith("|")]
    head = next(row for row in rows if any("frame" in cell for cell in row))
    engine, order, at = head.index("engine"), head.index("order"), next(i for i, name in enumerate(head) if name.startswith("frame"))
    numbers = ((row, re.fullmatch(r"\*\*([0-9.]+)\*\*", row[at])) for row in rows)
    return {(row[engine], row[order]): float(number[1]) for row, number in numbers if number}


def on_device(program: str, file: Path, there: list[str], size: int, frames: int, adapter: str | None, picture: Path, report: Path):
    """Rows of the device: name, milliseconds, colours. The first row names the adapter."""
    wish = ["--set", "picture.engine=gpu"] + (["--set", f"picture.adapter={adapter}"] if adapter else [])
    times = None
    for way in BLENDED:
        how = ["--set", f"picture.compositor={way}", "--set", "picture.order=centroid"]
        run([program, "run", str(file), *there, *wish, *how, "--report", str(report)])
        found = json.loads(report.read_text())["runs"][0]
        if times is None:
            same = ["--engine", "gpu", "--adapter", found["adapter"].split(" (")[0], "--compositor", ",".join(BLENDED)]
            times = by_voltet(program, file, size, frames, *same, *wish, *how)
        yield f"{way}, centroid order, {found['adapter']}", times.get((f"gpu {way}", "centroid")), colors(picture)


def errors(found, wanted) -> str:
    steps = 255.0 * abs(found - wanted)
    return f"{(steps**2).mean() ** 0.5:.2f} | {steps.max():.0f}"


def rows(scene: Scene, grid, wish, size: int, temporary: Path):
    """The rows of a scene at a size: name, milliseconds or none, errors."""
    file, picture, report = temporary / "scene.toml", temporary / "picture.png", temporary / "report.json"
    file.write_text(pipeline(scene, picture))
    there = ["--quiet", "--set", f"view.size=[{size},{size}]"]
    run([wish.voltet, "run", str(file), *there, "--set", "picture.integrator=reference"])
    wanted = colors(picture)
    run([wish.voltet, "run", str(file), *there])
    own = colors(picture)
    times = by_voltet(wish.voltet, file, size, wish.frames, "--engine", "cpu")
    yield "this program, exact order, CPU", times["cpu", "exact"], errors(own, wanted)
    if not wish.without_device:
        for name, ms, found in on_device(wish.voltet, file, there, size, wish.frames, wish.adapter, picture, report):
            yield f"this program, {name}", ms, errors(found, wanted)
    for name, mapper in MAPPERS.items():
        taken, found = by_vtk(scene, grid, mapper, size, wish.frames)
        yield name, statistics.median(taken), errors(found, wanted)


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("--scenes", default=",".join(SCENES), help="of " + ", ".join(SCENES))
    arguments.add_argument("--sizes", default="256,512", help="pixels a side")
    arguments.add_argument("--frames", type=int, default=5, help="frames that count")
    arguments.add_argument("--adapter", help="the graphics device: a part of its name, or discrete, integrated, software; else the fastest")
    arguments.add_argument("--without-device", action="store_true", help="leave out the rows of a graphics device")
    arguments.add_argument("--voltet", default="voltet", help="the program")
    wish = arguments.parse_args()
    for name in wish.scenes.split(","):
        scene = SCENES.get(name) or sys.exit(f"there is no scene {name}: of {', '.join(SCENES)}")
        if not scene.grid.is_file():
            sys.exit(f"there is no {scene.grid}: name a folder with it by VOLTET_TEST_DATA, or leave the scene out by --scenes")
        reader = vtk.vtkXMLUnstructuredGridReader()
        reader.SetFileName(str(scene.grid))
        reader.Update()
        split = vtk.vtkDataSetTriangleFilter()
        split.SetInputConnection(reader.GetOutputPort())
        split.TetrahedraOnlyOn()
        split.Update()
        grid = split.GetOutput()
        grid.GetPointData().SetActiveScalars(scene.scalar)
        cells = f"{grid.GetNumberOfCells()} tetrahedra"
        print(f"\n{scene.grid.name}: {cells}, {os.cpu_count()} processors, VTK {vtk.vtkVersion.GetVTKVersion()}\n")
        print("| | size | frame, ms | by this program's on the CPU | rms error, 1/255 | largest |\n| --- | ---: | ---: | ---: | ---: | ---: |")
        with tempfile.TemporaryDirectory() as temporary:
            for size in map(int, wish.sizes.split(",")):
                own = None
                for name, ms, wrong in rows(scene, grid, wish, size, Path(temporary)):
                    own = own or ms
                    time_taken = f"{ms:.1f} | {ms / own:.2f}" if ms else " | "
                    print(f"| {name} | {size}² | {time_taken} | {wrong} |", flush=True)


if __name__ == "__main__":
    main()
