#!/usr/bin/env python3
"""Seconds and memory of one picture of a grid in pieces: one process of voltet, several by MPI, and ParaView's pvbatch by the same MPI.

    cargo build --release --features mpi
    xvfb-run -a -s -noreset lab/scripts/several-processes.py [--side 100] [--ids] [--rounds 3] [--processes 2] [--folder FOLDER] [--program FILE] [--paraview no]

Needs numpy, mpirun (`MPIRUN` names another one), and pvbatch with an X server (scripts/install-paraview.sh), which ends with
its first program without -noreset. Writes 6·side³ tetrahedra as a .pvtu of eight blocks, with --ids with global ids of the points. All runs have as many threads in all as there are processes in the row of several. They
take turns. Medians of wall seconds with start and reading, files in the page cache; of processor seconds of all processes together, in which a process of
MPI that waits counts, too; the largest memory (maximum resident set) of a process.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
SCENE = """[pipeline]
format = 1

[nodes.grid]
type = "reader"
path = "blocks.pvtu"
scalar = "t"

[nodes.look]
type = "transfer-function"
unit_distance = 1.0
inputs = { volume = "grid" }

[[nodes.look.widgets]]
kind = "colormap"
colormap = "inferno"
range = [-1.0, 1.0]
extinction = 4.0
opacity = [[0.0, 0.0], [0.5, 0.1], [1.0, 1.0]]

[nodes.view]
type = "camera"
eye = [2.3, -1.9, 1.7]
target = [0.5, 0.5, 0.5]
up = [0.0, 0.0, 1.0]
fov_y = 30.0
size = [1024, 768]

[nodes.picture]
type = "renderer"
engine = "cpu"
inputs = { volume = "grid", transfer_function = "look", camera = "view" }

[nodes.out]
type = "image-writer"
path = "picture.exr"
inputs = { image = "picture" }
"""
# The same scene for ParaView: its ramps of colour and opacity, and the same camera.
PARAVIEW = """
from paraview.simple import *

view = CreateRenderView(ViewSize=[1024, 768], OrientationAxesVisibility=0, UseColorPaletteForBackground=0, Background=[0, 0, 0])
grid = XMLPartitionedUnstructuredGridReader(FileName=["blocks.pvtu"], PointArrayStatus=["t"])
shown = Show(grid, view, "UnstructuredGridRepresentation")
shown.SetRepresentationType("Volume")
ColorBy(shown, ("POINTS", "t"))
colors = GetColorTransferFunction("t")
colors.ApplyPreset("Inferno (matplotlib)", True)
colors.RescaleTransferFunction(-1.0, 1.0)
opacity = GetOpacityTransferFunction("t")
opacity.Points = [-1.0, 0.0, 0.5, 0.0, 0.0, 0.33, 0.5, 0.0, 1.0, 0.98, 0.5, 0.0]
view.CameraPosition, view.CameraFocalPoint, view.CameraViewUp = [2.3, -1.9, 1.7], [0.5, 0.5, 0.5], [0.0, 0.0, 1.0]
view.CameraViewAngle = 30.0
Render(view)
SaveScreenshot("paraview.png", view)
"""
# Corners of a cube's six tetrahedra along its diagonal, by the order in which the axes are stepped along.
ORDERS = [(0, 1, 2), (1, 0, 2), (1, 2, 0), (2, 1, 0), (2, 0, 1), (0, 2, 1)]


def write_grid(folder, side, with_ids):
    """The pieces and blocks.pvtu, with the point array t."""
    import numpy as np

    half = side // 2
    ends = [(0, half), (half, side)]
    for piece in range(8):
        ranges = [ends[piece >> axis & 1] for axis in range(3)]
        axes = [np.arange(low, high + 1) for low, high in ranges]
        k, j, i = np.meshgrid(axes[2], axes[1], axes[0], indexing="ij")
        counts = [len(axis) for axis in axes]
        lattice = np.stack([i, j, k], axis=-1).reshape(-1, 3)
        x, y, z = (lattice / side).T
        points = np.stack([x, y, z], axis=-1) + 0.3 / side * np.sin(9.0 * np.stack([y, z, x], axis=-1))
        values = np.sin(7.0 * x + 2.0 * z) * np.cos(5.0 * y) * np.cos(4.0 * z + x)
        steps = [1, counts[0], counts[0] * counts[1]]
        corner = np.arange(len(lattice)).reshape(counts[::-1])[:-1, :-1, :-1].reshape(-1)
        cells = []
        for number, order in enumerate(ORDERS):
            a, b, c = (steps[axis] for axis in order)
            tetrahedron = np.stack([corner, corner + a, corner + a + b, corner + a + b + c], axis=-1)
            # Every other order is a mirror image.
            cells.append(tetrahedron[:, [0, 2, 1, 3]] if number % 2 else tetrahedron)
        cells = np.stack(cells, axis=1).reshape(-1, 4)
        ids = lattice @ [1, side + 1, (side + 1) ** 2]
        write_piece(folder / f"blocks_{piece}.vtu", points, cells, values, ids if with_ids else None)
    sources = "".join(f'<Piece Source="blocks_{piece}.vtu"/>' for piece in range(8))
    ids = '<PDataArray type="Int64" Name="GlobalNodeIds"/>' if with_ids else ""
    arrays = f'<PPointData><PDataArray type="Float64" Name="t"/>{ids}</PPointData>'
    arrays += '<PPoints><PDataArray type="Float64" Name="Points" NumberOfComponents="3"/></PPoints>'
    text = f'<VTKFile type="PUnstructuredGrid" byte_order="LittleEndian" header_type="UInt64"><PUnstructuredGrid>{arrays}{sources}</PUnstructuredGrid></VTKFile>'
    (folder / "blocks.pvtu").write_text(text)


def write_piece(path, points, cells, values, ids):
    import numpy as np

    blocks = []

    def array(name, values, components=1):
        offset = sum(len(block) for block in blocks)
        values = np.ascontiguousarray(values)
        blocks.append(np.uint64(values.nbytes).tobytes() + values.tobytes())
        kind = {"float64": "Float64", "int64": "Int64", "uint8": "UInt8"}[str(values.dtype)]
        return f'<DataArray type="{kind}" Name="{name}" NumberOfComponents="{components}" format="appended" offset="{offset}"/>'

    point_data = array("t", values) + (array("GlobalNodeIds", ids) if ids is not None else "")
    where = array("Points", points, 3)
    topology = array("connectivity", cells.astype(np.int64)) + array("offsets", np.arange(4, 4 * len(cells) + 1, 4))
    topology += array("types", np.full(len(cells), 10, np.uint8))
    head = '<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" header_type="UInt64"><UnstructuredGrid>'
    head += f'<Piece NumberOfPoints="{len(points)}" NumberOfCells="{len(cells)}"><PointData>{point_data}</PointData>'
    head += f'<Points>{where}</Points><Cells>{topology}</Cells></Piece></UnstructuredGrid><AppendedData encoding="raw">_'
    path.write_bytes(head.encode() + b"".join(blocks) + b"</AppendedData></VTKFile>")


def measured(folder, command, count, threads):
    """Wall seconds, processor seconds, and the largest memory of each process (MB). `count`: processes by MPI; None: without it."""
    for file in folder.glob("usage_*"):
        file.unlink()
    probe = [sys.executable, __file__, "--measure", *map(str, command)]
    # Of voltet, of VTK's filters and of Mesa, which draws for ParaView.
    limits = ["RAYON_NUM_THREADS", "VTK_SMP_MAX_THREADS", "LP_NUM_THREADS"]
    environment = os.environ | dict.fromkeys(limits, str(threads))
    # More processes than cores, and root in a container.
    environment |= dict.fromkeys(["OMPI_MCA_rmaps_base_oversubscribe", "OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"], "1")
    launcher = [] if count is None else [os.environ.get("MPIRUN", "mpirun"), "-n", str(count)]
    start = time.perf_counter()
    ran = subprocess.run(launcher + probe, cwd=folder, env=environment, capture_output=True, text=True)
    seconds = time.perf_counter() - start
    if ran.returncode != 0:
        sys.exit(f"{' '.join(launcher + probe)} failed:\n{ran.stdout[-2000:]}{ran.stderr[-2000:]}")
    usages = [json.loads(file.read_text()) for file in folder.glob("usage_*")]
    return seconds, sum(usage[0] for usage in usages), sorted((usage[1] / 1000 for usage in usages), reverse=True)


def measure(command):
    """Runs a command, and writes its processor seconds and largest memory (kB) to a file of its process."""
    child = os.spawnvp(os.P_NOWAIT, command[0], command)
    _, status, usage = os.wait4(child, 0)
    Path(f"usage_{os.getpid()}").write_text(json.dumps([usage.ru_utime + usage.ru_stime, usage.ru_maxrss]))
    sys.exit(os.waitstatus_to_exitcode(status))


def main():
    if sys.argv[1:2] == ["--measure"]:
        measure(sys.argv[2:])
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--side", type=int, default=100, help="cubes of six tetrahedra along a side; even")
    parser.add_argument("--ids", action="store_true", help="with global ids of the points")
    parser.add_argument("--rounds", type=int, default=3)
    parser.add_argument("--processes", type=int, default=2)
    parser.add_argument("--folder", type=Path, default=Path("target/several-processes"))
    parser.add_argument("--program", type=Path, default=ROOT / "target/release/voltet")
    parser.add_argument("--paraview", choices=["yes", "no"], default="yes")
    options = parser.parse_args()
    folder = options.folder.resolve()
    folder.mkdir(parents=True, exist_ok=True)
    made = {"side": options.side, "ids": options.ids}
    stamp = folder / "made.json"
    if not stamp.exists() or json.loads(stamp.read_text()) != made:
        write_grid(folder, options.side, options.ids)
        stamp.write_text(json.dumps(made))
    (folder / "scene.toml").write_text(SCENE)
    (folder / "scene.py").write_text(PARAVIEW)
    count = options.processes
    one, several = ([options.program.resolve(), "run", "scene.toml", "--output", f"{name}.exr", "--report", f"{name}.json", "--quiet"] for name in ["one", "several"])
    rows = {"voltet, 1 process": (one, None, count), f"voltet, {count} processes": (several, count, 1)}
    if options.paraview == "yes":
        rows |= {"pvbatch, 1 process": (["pvbatch", "scene.py"], None, count), f"pvbatch, {count} processes": (["pvbatch", "scene.py"], count, 1)}
    results = {name: [] for name in rows}
    for _ in range(options.rounds):
        for name, row in rows.items():
            results[name].append(measured(folder, *row))
    print("| program | threads each | seconds | processor seconds | memory of a process |\n| --- | ---: | ---: | ---: | ---: |")
    for name, runs in results.items():
        wall, processor = (statistics.median(run[place] for run in runs) for place in range(2))
        memory = [statistics.median(run[2][place] for run in runs) for place in range(len(runs[0][2]))]
        print(f"| {name} | {rows[name][2]} | {wall:.2f} | {processor:.2f} | {', '.join(f'{own:.0f}' for own in memory)} MB |")


if __name__ == "__main__":
    main()
