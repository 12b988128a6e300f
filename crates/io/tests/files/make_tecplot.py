"""Writes the binary Tecplot files beside it: pip install vtk numpy; and TecIO, Tecplot's own library, as a shared library whose path
is the argument. TecIO writes version 112; the files of older versions are by `old`, after the guide's list of what changed."""

import ctypes
import os
import struct
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import meshes

os.chdir(os.path.dirname(os.path.abspath(__file__)))
TECIO = ctypes.CDLL(sys.argv[1])
NAMES = ["X", "Y [m]", "Z", "s", "c"]


def call(name, *values):
    """Numbers and lists of numbers by pointers, texts as such."""
    given = []
    for value in values:
        if isinstance(value, str):
            given.append(value.encode())
        elif value is None:
            given.append(None)
        elif isinstance(value, float):
            given.append(ctypes.byref(ctypes.c_double(value)))
        elif isinstance(value, int):
            given.append(ctypes.byref(ctypes.c_int32(value)))
        else:
            array = np.ascontiguousarray(value, np.float64 if np.asarray(value).dtype.kind == "f" else np.int32)
            given.append(array.ctypes.data_as(ctypes.c_void_p))
    result = getattr(TECIO, name + "142")(*given)
    assert name == "tecforeign" or result == 0, name


def data(values):
    values = np.ascontiguousarray(values, np.float64)
    call("tecdat", values.size, values, 1)


def zone(title, kind, sizes, faces=(0, 0, 0), time=0.0, strand=0, passive=None, at_cells=(0, 0, 0, 0, 1), share=None, cells=0):
    # 1 means nodes, 0 cells.
    location = [1 - own for own in at_cells]
    call("teczne", title, kind, *sizes, 0, 0, 0, time, strand, 0, 1, 0, 0, *faces, passive, location, share, cells)


def open_file(path, double=1, big=0):
    call("tecforeign", big)
    call("tecini", "every kind of zone", " ".join(name.replace(" ", "") for name in NAMES), path, ".", 0, 0, 0, double)


def parts(grid):
    points = vtk_to_numpy(grid.GetPoints().GetData())
    return points, vtk_to_numpy(grid.GetPointData().GetArray("s")), vtk_to_numpy(grid.GetCellData().GetArray("c"))


def corners(grid, count):
    """Points of the cells, the last one repeated: a pyramid is a brick whose upper corners are one."""
    cells = []
    for number in range(grid.GetNumberOfCells()):
        ids = [grid.GetCell(number).GetPointId(i) for i in range(grid.GetCell(number).GetNumberOfPoints())]
        # A wedge: two corners of both quadrangles are one.
        ids = [*ids[:3], ids[2], *ids[3:], ids[5]] if len(ids) == 6 else ids
        cells.append(ids + [ids[-1]] * (count - len(ids)))
    return np.array(cells)


def arrays(points, s, c):
    for values in [*points.T, s, c]:
        data(values)


def extras():
    """Records that a reader of fields passes over. TecIO takes them before the zones."""
    call("tectxt", 1.0, 2.0, 0.0, 0, 0, 1, 0, 1, 3.0, 0, 1.0, 1.0, 0, 0, 30.0, 0, 1.0, 0, 0, 0, "a text", "a macro")
    lines = np.array([0, 1, 2], np.float32).ctypes.data_as(ctypes.c_void_p)
    for kind in range(5):
        pointer = lambda value: ctypes.byref((ctypes.c_double if isinstance(value, float) else ctypes.c_int32)(value))
        own = [0.0, 0.0, 0.0, 6 if kind == 0 else 0, 0, 1, 1, 2, 1, kind, 0, 2.0, 0.4, 60, 0, 0, 5.0, 12.0, 0, 0, 1, 3]
        result = TECIO.tecgeo142(*map(pointer, own), lines, lines, lines, b"")
        assert result == 0
    call("teclab", '"one", "two"')
    call("tecusr", "a record")
    call("tecauxstr", "Source", "a formula")
    call("tecvauxstr", 4, "Unit", "K")


def faces(grid):
    """Faces once, and the cells on both sides; right-hand normals lead out of the cell on the left."""
    known, nodes, left, right = {}, [], [], []
    for number in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(number)
        for i in range(cell.GetNumberOfFaces()):
            ids = [cell.GetFace(i).GetPointId(k) for k in range(cell.GetFace(i).GetNumberOfPoints())]
            key = tuple(sorted(ids))
            if key in known:
                right[known[key]] = number + 1
            else:
                known[key] = len(nodes)
                nodes.append(ids)
                left.append(number + 1)
                right.append(0)
    return nodes, left, right


def every_zone(path, double, big):
    tetrahedra = meshes.row([vtk.vtkTetra] * 2)
    bricks = meshes.row([vtk.vtkHexahedron, vtk.vtkWedge, vtk.vtkPyramid], start=3.0)
    box = meshes.hexahedra((3, 4, 2), start=(10.0, 0.0, 0.0))
    poly = meshes.polyhedra()
    all_of = vtk.vtkAppendFilter()
    for grid in (tetrahedra, bricks, box, poly):
        all_of.AddInputData(grid)
    all_of.Update()
    meshes.write_vtu(all_of.GetOutput(), "tecplot_zones.vtu")
    open_file(path, double, big)
    sizes = lambda grid, faces=0: (grid.GetNumberOfPoints(), grid.GetNumberOfCells(), faces)
    extras()
    zone("tetrahedra", 4, sizes(tetrahedra))
    call("teczauxstr", "Part", "all of it")
    arrays(*parts(tetrahedra))
    call("tecnod", corners(tetrahedra, 4).ravel() + 1)
    zone("wall", 2, (3, 1, 0), at_cells=(0, 0, 0, 0, 0))
    for values in ([0.0, 1.0, 0.0], [0.0, 0.0, 1.0], [0.0] * 3, [1.0] * 3, [2.0] * 3):
        data(values)
    call("tecnod", [1, 2, 3])
    zone("bricks", 5, sizes(bricks))
    arrays(*parts(bricks))
    call("tecnod", corners(bricks, 8).ravel() + 1)
    zone("box", 0, (3, 4, 2))
    arrays(*parts(box))
    nodes, left, right = faces(poly)
    count = sum(map(len, nodes))
    zone("polyhedra", 7, sizes(poly, len(nodes)), (count, 0, 0))
    arrays(*parts(poly))
    call("tecpolyface", len(nodes), list(map(len, nodes)), np.concatenate(nodes) + 1, left, right)
    call("tecend")


def steps(path):
    """Two steps that share points and cells, a part of all times, and a variable that one part lacks."""
    bricks = meshes.hexahedra((3, 2, 2))
    points, s, c = parts(bricks)
    open_file(path)
    other = points + [5.0, 0.0, 0.0]
    zone("fixed", 5, (12, 2, 0), passive=[0, 0, 0, 0, 1])
    for values in [*other.T, meshes.field(other)]:
        data(values)
    call("tecnod", corners(bricks, 8).ravel() + 1)
    for number, time in enumerate([0.5, 0.75, 2.0]):
        shared = {} if number == 0 else {"share": [2, 2, 2, 0, 2], "cells": 2}
        zone("moving", 5, (12, 2, 0), time=time, strand=1, **shared)
        for place, values in enumerate([*points.T, s + 100.0 * number, c]):
            if not shared or place == 3:
                data(values)
        if not shared:
            call("tecnod", corners(bricks, 8).ravel() + 1)
    call("tecend")


def old(path, version, packed, big=False):
    """A zone of bricks and a box of an older version: `packed`, the variables of a node side by side."""
    order = ">" if big else "<"
    out = bytearray(b"#!TDV" + str(version).encode())
    words = lambda *values: out.extend(struct.pack(f"{order}{len(values)}i", *values))
    text = lambda own: words(*own.encode(), 0)
    mark = lambda value: out.extend(struct.pack(order + "f", value))
    words(1)
    if version >= 111:
        words(0)
    text("an old file")
    words(len(NAMES))
    for name in NAMES:
        text(name)
    bricks = meshes.row([vtk.vtkHexahedron] * 2)
    box = meshes.hexahedra((3, 2, 4), start=(10.0, 0.0, 0.0))
    at_cells = not packed
    for title, kind, sizes in [("bricks", 5, (16, 2, 0, 0, 0)), ("box", 0, (3, 2, 4))]:
        mark(299.0)
        text(title)
        words(-1, -1)
        out.extend(struct.pack(order + "d", 0.0))
        words(-1, kind, int(packed), int(at_cells))
        if at_cells:
            words(0, 0, 0, 0, 1)
        if version >= 108:
            words(1 if kind == 5 else 0)
        # Neighbours by hand: one connection, and its mode.
        words(1, 0)
        if version >= 108 and kind != 0:
            words(0)
        words(*sizes)
        words(0)
    mark(357.0)
    for grid, kind in [(bricks, 5), (box, 0)]:
        points, s, c = parts(grid)
        mark(299.0)
        words(2, 1, 2, 2, 1, 0, 0, -1)
        columns = [*points.T, s, np.resize(c, len(points)) if packed else c]
        out.extend(np.array([[own.min(), own.max()] for own in columns], order + "f8").tobytes())
        types = [order + own for own in ("f8", "f4", "f8", "f8", "f4")]
        if packed:
            rows = np.empty(len(points), [(str(i), own) for i, own in enumerate(types)])
            for i, own in enumerate(columns):
                rows[str(i)] = own
            out.extend(rows.tobytes())
        else:
            if kind == 0:
                # Cells have the numbers of points along all axes but the last.
                padded = np.full((3, 2, 3), -1e9)
                padded[:, :1, :2] = c.reshape(3, 1, 2)
                columns[4] = padded.ravel()
            for own, number_type in zip(columns, types):
                out.extend(np.asarray(own).astype(number_type).tobytes())
        if kind == 5:
            words(*corners(grid, 8).ravel())
            if version >= 108:
                words(*[-1] * 12)
        words(1, 2, 1)
    with open(path, "wb") as file:
        file.write(out)
    truth = vtk.vtkAppendFilter()
    truth.AddInputData(bricks)
    truth.AddInputData(box)
    truth.Update()
    meshes.write_vtu(truth.GetOutput(), "tecplot_old.vtu")


every_zone("tecplot_double.plt", 1, 0)
every_zone("tecplot_single.plt", 0, 1)
steps("tecplot_steps.plt")
old("tecplot_107.plt", 107, False, big=True)
old("tecplot_108.plt", 108, True)
old("tecplot_111.plt", 111, False)
meshes.pack(f"tecplot_{own}.plt" for own in ("double", "single", "steps", "107", "108", "111"))
