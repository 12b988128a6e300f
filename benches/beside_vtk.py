#!/usr/bin/env python3
"""Sets frames of this program beside those of VTK's unstructured-grid volume mappers, in one run: times and errors.

benches/beside_vtk.py [GRID.vtu] [--sizes 512,1024] [--frames 5] [--voltet PROGRAM]

The scene is piecewise-linear in the scalar: the blunt fin (VOLTET_TEST_DATA/bluntfin.vtu) without an argument. Both programs turn
the camera by one degree before each frame; medians. Errors are those of 8-bit premultiplied colours on black against this program's
64-bit reference, in steps of 1/255. VTK draws off-screen by whatever OpenGL there is: without a graphics card, in software.
Needs Python 3.11 with the package `vtk` (scripts/compare-vtk.sh makes an environment with it) and the program `voltet`.
"""

import argparse
import os
import re
import statistics
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import vtk
from vtk.util.numpy_support import vtk_to_numpy

SCALAR = "density"
EYE, TARGET, UP, FOV = (-12.0314, -30.8182, 24.7259), (3.2732, 4.1638, 2.8621), (0.0, 0.0, 1.0), 30.0
# s, red, green, blue, extinction for each world unit: those of benches/scenes/bluntfin.toml.
POINTS = [
    (0.2, 0.1, 0.2, 0.9, 0.0),
    (1.4, 0.1, 0.8, 0.9, 0.1),
    (2.6, 0.2, 0.8, 0.2, 0.5),
    (3.8, 0.9, 0.8, 0.1, 0.2),
    (4.97, 0.9, 0.1, 0.1, 1.5),
]
MAPPERS = {
    "VTK, projected tetrahedra": vtk.vtkProjectedTetrahedraMapper,
    "VTK, Bunyk ray caster": vtk.vtkUnstructuredGridVolumeRayCastMapper,
}


def pipeline(grid: Path, picture: Path) -> str:
    points = ",\n".join(f"    {list(point)}" for point in POINTS)
    return f"""[pipeline]
format = 1

[nodes.grid]
type = "reader"
path = {str(grid)!r}
scalar = "{SCALAR}"

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
eye = {list(EYE)}
target = {list(TARGET)}
up = {list(UP)}
fov_y = {FOV}
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


def by_vtk(grid, mapper_type, size: int, frames: int):
    """Milliseconds of the frames, and the first one's colours."""
    color, opacity = vtk.vtkColorTransferFunction(), vtk.vtkPiecewiseFunction()
    for s, red, green, blue, extinction in POINTS:
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
    camera.SetPosition(*EYE)
    camera.SetFocalPoint(*TARGET)
    camera.SetViewUp(*UP)
    camera.SetViewAngle(FOV)

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


def by_voltet(program: str, file: Path, size: int, frames: int) -> float:
    """The median of the exact order's frames, milliseconds."""
    table = run([program, "time", str(file), "--engine", "cpu", "--frames", str(frames), "--patience", "60", "--size", f"{size}x{size}"])
    rows = [[cell.strip() for cell in line.strip("| ").split("|")] for line in table.splitlines() if line.startswith("|")]
    head = next(row for row in rows if any("frame" in cell for cell in row))
    row = next(row for row in rows if "exact" in " ".join(row))
    at = next(place for place, name in enumerate(head) if re.match(r"frame|whole", name))
    return float(row[at].strip("* "))


def errors(found, wanted) -> str:
    steps = 255.0 * abs(found - wanted)
    return f"{(steps**2).mean() ** 0.5:.2f} | {steps.max():.0f}"


def main() -> None:
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    folder = Path(os.environ.get("VOLTET_TEST_DATA", "."))
    arguments.add_argument("grid", nargs="?", type=Path, default=folder / "bluntfin.vtu", help="with the point array 'density'")
    arguments.add_argument("--sizes", default="512,1024", help="pixels a side")
    arguments.add_argument("--frames", type=int, default=5, help="frames that count")
    arguments.add_argument("--voltet", default="voltet", help="the program")
    wish = arguments.parse_args()
    if not wish.grid.is_file():
        sys.exit(f"there is no {wish.grid}: name a grid, or a folder with bluntfin.vtu by VOLTET_TEST_DATA")
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(wish.grid))
    reader.Update()
    split = vtk.vtkDataSetTriangleFilter()
    split.SetInputConnection(reader.GetOutputPort())
    split.TetrahedraOnlyOn()
    split.Update()
    grid = split.GetOutput()
    grid.GetPointData().SetActiveScalars(SCALAR)
    print(f"{wish.grid.name}: {grid.GetNumberOfCells()} tetrahedra, {os.cpu_count()} processors, VTK {vtk.vtkVersion.GetVTKVersion()}\n")
    print("| | size | frame, ms | by this program's | rms error, 1/255 | largest |\n| --- | ---: | ---: | ---: | ---: | ---: |")
    with tempfile.TemporaryDirectory() as temporary:
        file, picture = Path(temporary) / "scene.toml", Path(temporary) / "picture.png"
        file.write_text(pipeline(wish.grid.resolve(), picture))
        for size in map(int, wish.sizes.split(",")):
            there = ["--quiet", "--set", f"view.size=[{size},{size}]"]
            run([wish.voltet, "run", str(file), *there, "--set", "picture.integrator=reference"])
            wanted = colors(picture)
            run([wish.voltet, "run", str(file), *there])
            own, own_ms = colors(picture), by_voltet(wish.voltet, file, size, wish.frames)
            print(f"| this program, exact order | {size}² | {own_ms:.1f} | 1 | {errors(own, wanted)} |", flush=True)
            for name, mapper in MAPPERS.items():
                times, found = by_vtk(grid, mapper, size, wish.frames)
                ms = statistics.median(times)
                print(f"| {name} | {size}² | {ms:.1f} | {ms / own_ms:.2f} | {errors(found, wanted)} |", flush=True)


if __name__ == "__main__":
    main()
