"""Grids of every cell type with a field that is a formula, for the files of several formats (pip install vtk numpy)."""

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

LINEAR = [vtk.vtkTetra, vtk.vtkHexahedron, vtk.vtkWedge, vtk.vtkPyramid, vtk.vtkVoxel]
QUADRATIC = [
    vtk.vtkQuadraticTetra,
    vtk.vtkQuadraticHexahedron,
    vtk.vtkTriQuadraticHexahedron,
    vtk.vtkQuadraticWedge,
    vtk.vtkBiQuadraticQuadraticWedge,
    vtk.vtkQuadraticPyramid,
    vtk.vtkTriQuadraticPyramid,
]


def field(p):
    """Quadratic, and different along each axis: a node out of its place shows."""
    x, y, z = p[..., 0], p[..., 1], p[..., 2]
    return 1 + x + 2 * y * y - 3 * z * y + 0.5 * x * z


def array(name, values):
    own = numpy_to_vtk(np.ascontiguousarray(values), deep=True)
    own.SetName(name)
    return own


def grid_of(cells, points, types):
    """An unstructured grid with the point arrays s, v and the cell array c."""
    grid = vtk.vtkUnstructuredGrid()
    own = vtk.vtkPoints()
    own.SetData(array("Points", points))
    grid.SetPoints(own)
    grid.Allocate(len(cells))
    for ids, code in zip(cells, types):
        grid.InsertNextCell(code, len(ids), ids)
    centres = np.array([points[ids].mean(axis=0) for ids in cells])
    grid.GetPointData().SetScalars(array("s", field(points)))
    grid.GetPointData().AddArray(array("v", np.stack([points[:, 0], 2 * points[:, 1], field(points)], 1)))
    grid.GetCellData().AddArray(array("c", field(centres)))
    return grid


def row(kinds, start=0.0, seed=1):
    """Cells of these kinds side by side along x, each with points of its own that are a little displaced."""
    points, cells, types = [], [], []
    for number, kind in enumerate(kinds):
        cell = kind()
        parametric = cell.GetParametricCoords() if hasattr(cell, "GetParametricCoords") else None
        count = cell.GetNumberOfPoints()
        if not parametric:
            raise RuntimeError(kind)
        own = np.array([parametric[3 * i : 3 * i + 3] for i in range(count)])
        # An affine map, so that nodes on edges stay in their middles and planes plane.
        if kind is not vtk.vtkVoxel:
            own = own @ np.array([[1.0, 0.1, 0.05], [0.0, 0.9, 0.1], [0.1, 0.0, 0.8]])
        own = own + [start + 1.5 * number, 0.1 * number, 0.0]
        first = sum(map(len, points))
        points.append(own)
        cells.append(list(range(first, first + count)))
        types.append(cell.GetCellType())
    return grid_of(cells, np.concatenate(points), types)


def every_cell():
    return row(LINEAR + QUADRATIC)


def box(n=(3, 2, 2), start=(0.0, 0.0, 0.0)):
    """Points of a curvilinear grid, the first axis fastest."""
    k, j, i = np.meshgrid(*(np.arange(m, dtype=float) for m in reversed(n)), indexing="ij")
    points = np.stack([i + 0.1 * j, j + 0.2 * k, k], -1).reshape(-1, 3)
    return points + start


def hexahedra(n=(3, 2, 2), start=(0.0, 0.0, 0.0)):
    points = box(n, start)
    at = lambda i, j, k: i + n[0] * (j + n[1] * k)
    cells = [
        [at(i, j, k), at(i + 1, j, k), at(i + 1, j + 1, k), at(i, j + 1, k),
         at(i, j, k + 1), at(i + 1, j, k + 1), at(i + 1, j + 1, k + 1), at(i, j + 1, k + 1)]
        for k in range(n[2] - 1) for j in range(n[1] - 1) for i in range(n[0] - 1)
    ]  # fmt: skip
    return grid_of(cells, points, [12] * len(cells))


def polyhedra():
    """Two hexahedra and a wedge as polyhedra."""
    grid = vtk.vtkAppendFilter()
    grid.AddInputData(hexahedra())
    grid.AddInputData(row([vtk.vtkWedge], start=5.0))
    convert = vtk.vtkConvertToPolyhedra()
    convert.SetOutputAllCells(True)
    convert.SetInputConnection(grid.GetOutputPort())
    convert.Update()
    return convert.GetOutput()


def write_vtu(grid, path):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetInputData(grid)
    writer.SetFileName(path)
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.SetCompressorTypeToZLib()
    writer.Write()


def pack(paths):
    """Packs files, most of which HDF5 leaves empty."""
    import gzip
    import os

    for path in paths:
        with open(path, "rb") as file, gzip.GzipFile(path + ".gz", "wb", 9, mtime=0) as packed:
            packed.write(file.read())
        os.remove(path)
