#!/usr/bin/env python3
"""Seconds that voltet, VTK and meshio take to read one grid of tetrahedra from files of every format.

    pip install vtk meshio h5py netCDF4 numpy lz4
    lab/scripts/read-speed.py [--side 60] [--rounds 5] [--only vtu,gmsh] [--folder FOLDER] [--program FILE] [--others no]

Writes the files into the folder (6·side³ tetrahedra; 2 GB for side 60) and prints a table. Each reading is a process of its own,
the programs take turns, files are in the page cache. voltet and VTK give points, cells and one array (VTK's readers that cannot be told give
all), meshio everything. Medians of wall seconds and, in brackets, of CPU seconds. MB/s are bytes of the files by voltet's seconds, the
share is that of reading the file into memory by one thread. "codec": of compressed files, the seconds in which zlib, LZ4 or LZMA as other
programs have them alone decompress the arrays that are read, in memory, on one thread, by the number of processors and by voltet's seconds:
1 is as fast as decompression can be. The arrays are kept, as a reader keeps them: blocks that are freed at once stay in the processor's
cache, and no reader of more than a few MB can be as fast. "tetrahedra": with what drawing asks for beside, the check for overlaps and
hanging points. `--others no` leaves out VTK and meshio.
"""

import argparse
import json
import os
import statistics
import subprocess
import sys
import time
from pathlib import Path

sys.path.insert(0, str(Path(__file__).resolve().parent))
ROOT = Path(__file__).resolve().parents[2]

# Readers of VTK by the ending of a file.
VTK = {
    ".vtu": "vtkXMLUnstructuredGridReader", ".vtk": "vtkUnstructuredGridReader", ".vtkhdf": "vtkHDFReader", ".e": "vtkExodusIIReader",
    ".cgns": "vtkCGNSReader", "foam": "vtkOpenFOAMReader", ".case": "vtkGenericEnSightReader", ".dat": "vtkTecplotReader",
    ".ucd": "vtkAVSucdReader", ".xdmf": "vtkXdmfReader",
}
MESHIO = {
    ".vtu": "vtu", ".vtk": "vtk", ".e": "exodus", ".xdmf": "xdmf", ".msh": "gmsh", ".dat": "tecplot", ".ucd": "avsucd",
    ".inp": "abaqus", ".su2": "su2", ".bdf": "nastran", ".cgns": "cgns",
}


def ending(path):
    return "foam" if path.is_dir() else path.suffix


def by_vtk(path, array):
    import vtk

    reader = getattr(vtk, VTK[ending(path)])()
    start, cpu = time.perf_counter(), time.process_time()
    name = str(path / "case.foam" if path.is_dir() else path)
    getattr(reader, "SetCaseFileName" if ending(path) == ".case" else "SetFileName")(name)
    if ending(path) == "foam":
        reader.CreateCellToPointOff()
    reader.UpdateInformation()
    if ending(path) == ".e":
        reader.SetPointResultArrayStatus(array, 1)
    else:
        for kind in ["Point", "Cell"]:
            selection = getattr(reader, f"Get{kind}DataArraySelection", lambda: None)()
            if selection:
                selection.DisableAllArrays()
                selection.EnableArray(array.removeprefix("cell:"))
    reader.Update()
    seconds = time.perf_counter() - start, time.process_time() - cpu
    found = reader.GetOutputDataObject(0)
    leaves = [found]
    if found.IsA("vtkCompositeDataSet"):
        leaves = []
        walk = found.NewIterator()
        walk.InitTraversal()
        while not walk.IsDoneWithTraversal():
            leaves.append(walk.GetCurrentDataObject())
            walk.GoToNextItem()
    return *seconds, sum(leaf.GetNumberOfCells() for leaf in leaves)


def appended_blocks(path, array):
    """Codec, compressed blocks and their sizes unpacked, of the arrays of a .vtu with raw appended data that are read."""
    import re

    import numpy as np

    content = path.read_bytes()
    begin = content.index(b"_", content.index(b"<AppendedData")) + 1
    head = content[:begin].decode(errors="replace")
    codec = re.search(r'compressor="vtk(\w+)DataCompressor"', head)[1]
    word = np.dtype("<u8" if 'header_type="UInt64"' in head else "<u4")
    blocks = []
    for tag in re.findall(r"<DataArray[^>]*>", head):
        attributes = dict(re.findall(r'(\w+)="([^"]*)"', tag))
        if attributes["Name"] not in ["Points", "connectivity", "offsets", "types", array]:
            continue
        at = begin + int(attributes["offset"])
        count, size, last = (int(n) for n in np.frombuffer(content, word, 3, at))
        lengths = np.frombuffer(content, word, count, at + 3 * word.itemsize)
        at += (3 + count) * word.itemsize
        for place, length in enumerate(lengths):
            blocks.append((content[at:at + int(length)], last if last and place == count - 1 else size))
            at += int(length)
    return codec, blocks


def chunks(path, array):
    """Chunks of the arrays of a VTKHDF file or of meshio's XDMF that are read."""
    import h5py

    names = ["VTKHDF/Points", "VTKHDF/Connectivity", "VTKHDF/Offsets", "VTKHDF/Types", f"VTKHDF/PointData/{array}"]
    with h5py.File(path) as file:
        names = names if "VTKHDF" in file else ["data0", "data1", "data2"]
        for name in names:
            own = file[name].id
            for place in range(own.get_num_chunks()):
                yield own.read_direct_chunk(own.get_chunk_info(place).chunk_offset)[1]


def by_codec(path, array):
    """Seconds of decompression alone."""
    import zlib

    if path.suffix != ".vtu":
        packed = list(chunks(path.with_suffix(".h5") if path.suffix == ".xdmf" else path, array))
        start = time.perf_counter()
        arrays = [zlib.decompress(block) for block in packed]
        return time.perf_counter() - start, 0, sum(map(len, arrays))
    import lzma

    import lz4.block

    codec, blocks = appended_blocks(path, array)
    unpack = {
        "ZLib": lambda packed, _: zlib.decompress(packed),
        "LZMA": lambda packed, _: lzma.decompress(packed),
        "LZ4": lambda packed, size: lz4.block.decompress(packed, uncompressed_size=size),
    }[codec]
    start = time.perf_counter()
    arrays = [unpack(packed, size) for packed, size in blocks]
    return time.perf_counter() - start, 0, sum(map(len, arrays))


def by_meshio(path, _):
    import meshio

    start, cpu = time.perf_counter(), time.process_time()
    mesh = meshio.read(path, file_format=MESHIO[ending(path)])
    seconds = time.perf_counter() - start, time.process_time() - cpu
    return *seconds, sum(len(block.data) for block in mesh.cells)


def by_voltet(program, form, path, array):
    """Wall seconds as the program gives them, CPU seconds of the process, cells or bytes; None where it fails."""
    process = subprocess.Popen([program, form, str(path), array], stdout=subprocess.PIPE, text=True)
    words = process.stdout.read().split()
    _, status, usage = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    if process.returncode:
        return None
    return float(words[0]), usage.ru_utime + usage.ru_stime, int(words[1])


def by_other(who, path, array):
    """A reader of Python in a process of its own; None where it fails."""
    command = [sys.executable, __file__, "--one", who, str(path), array]
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    lines = [line for line in done.stdout.splitlines() if line.startswith("{")]
    return json.loads(lines[-1])["result"] if done.returncode == 0 and lines else None


def size(path):
    """Bytes of a file and of those that belong to it."""
    if path.is_dir():
        return sum(file.stat().st_size for file in path.rglob("*") if file.is_file())
    beside = {".case": [".geo", ".p"], ".xdmf": [".h5"]}.get(path.suffix, [])
    return path.stat().st_size + sum(path.with_suffix(end).stat().st_size for end in beside)


def shown(runs):
    runs = [run for run in runs if run]
    return f"{statistics.median(run[0] for run in runs):.2f} ({statistics.median(run[1] for run in runs):.2f})" if runs else "–"


def ratio(other, own):
    pairs = [(a[0], b[0]) for a, b in zip(other, own) if a and b]
    return f"{statistics.median(a / b for a, b in pairs):.2f}" if pairs else "–"


def is_compressed(name):
    return any(word in name for word in ["zlib", "lz4", "lzma", "gzip"])


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--side", type=int, default=60)
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--only", default="", help="formats whose names contain one of these")
    parser.add_argument("--folder", type=Path, default=Path("target/read-speed"))
    parser.add_argument("--program", help="read_speed, if it is built already")
    parser.add_argument("--others", choices=["yes", "no"], default="yes")
    parser.add_argument("--one", nargs=3, help=argparse.SUPPRESS)
    options = parser.parse_args()
    if options.one:
        who, path, array = options.one
        result = {"vtk": by_vtk, "meshio": by_meshio, "codec": by_codec}[who](Path(path), array)
        os.write(1, ("\n" + json.dumps({"result": result}) + "\n").encode())
        # Some libraries take seconds to free what they have read.
        os._exit(0)
    import read_files

    program = options.program
    if not program:
        build = ["cargo", "build", "--release", "-q", "-p", "voltet-bench", "--bin", "read_speed"]
        subprocess.run(build, cwd=ROOT, check=True)
        target = os.environ.get("CARGO_TARGET_DIR", ROOT / "target")
        program = str(Path(target) / "release/read_speed")
    words = options.only.lower().split(",")
    names = [name for name in read_files.FILES if any(word in name.lower() for word in words)]
    files = read_files.write(options.folder, options.side, names)
    print("| format | MB | voltet: s (CPU s) | MB/s | share | codec | tetrahedra | VTK | times | meshio | times |")
    print("| --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for name, (path, array) in files.items():
        own, full, plain, codec, vtk, mesh = [], [], [], [], [], []
        plain_path = path.with_suffix({".case": ".geo", ".xdmf": ".h5"}.get(path.suffix, path.suffix))
        for _ in range(options.rounds):
            plain.append(by_voltet(program, "bytes", plain_path, "-"))
            own.append(by_voltet(program, "cells", path, array))
            full.append(by_voltet(program, "tetrahedra", path, array))
            if is_compressed(name):
                codec.append(by_other("codec", path, array))
            if options.others == "yes" and ending(path) in VTK:
                vtk.append(by_other("vtk", path, array))
            if options.others == "yes" and ending(path) in MESHIO:
                mesh.append(by_other("meshio", path, array))
        if not all(own):
            sys.exit(f"{name}: voltet cannot read {path}")
        counts = {run[2] for runs in [own, vtk, mesh] for run in runs if run}
        if len(counts) > 1:
            print(f"{name}: the readers give different numbers of cells, {sorted(counts)}", file=sys.stderr)
        bytes_read = size(path)
        seconds = statistics.median(run[0] for run in own)
        rate = plain[0][2] / statistics.median(run[0] for run in plain)
        threads = len(os.sched_getaffinity(0))
        alone = ratio([(run[0] / threads,) for run in codec if run], own)
        print(
            f"| {name} | {bytes_read / 1e6:.0f} | {shown(own)} | {bytes_read / seconds / 1e6:.0f} | {bytes_read / seconds / rate:.2f} "
            f"| {alone} | {shown(full)} | {shown(vtk)} | {ratio(vtk, own)} | {shown(mesh)} | {ratio(mesh, own)} |",
            flush=True,
        )


if __name__ == "__main__":
    main()
