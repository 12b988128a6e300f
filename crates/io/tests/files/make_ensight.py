"""Writes ensight/: two unstructured grids as parts by VTK's EnSight writer (pip install vtk), C binary, with their cells as
.vtu beside; the field f = x² - x y + 2 y z + z - 0.5 at the points, the position p as a vector, and the cell numbers g."""

import os
import sys

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

folder = sys.argv[1] if len(sys.argv) > 1 else "ensight"
os.makedirs(folder, exist_ok=True)
AFFINE = np.array([[1.0, 0.25, 0.125], [0.0, 0.875, 0.375], [0.125, 0.0, 1.125]])
KINDS = [vtk.vtkTetra, vtk.vtkHexahedron, vtk.vtkWedge, vtk.vtkPyramid]
grid = vtk.vtkUnstructuredGrid()
points, cells, numbers = [], [], []
for place, kind in enumerate(KINDS * 2):
    cell = kind()
    own = np.array(cell.GetParametricCoords()).reshape(-1, 3) @ AFFINE.T + [3.0 * place, 0.5, 0.25]
    cells.append((cell.GetCellType(), list(range(len(points), len(points) + len(own)))))
    points += list(own)
points = np.array(points, np.float32)
data = vtk.vtkPoints()
data.SetData(numpy_to_vtk(points, deep=True))
grid.SetPoints(data)
for kind, corners in cells:
    grid.InsertNextCell(kind, len(corners), corners)
x, y, z = points.astype(float).T


def array(to, name, values):
    values = numpy_to_vtk(np.array(values), deep=True)
    values.SetName(name)
    to.AddArray(values)


array(grid.GetPointData(), "f", (x**2 - x * y + 2 * y * z + z - 0.5).astype(np.float32))
array(grid.GetPointData(), "p", points)
array(grid.GetCellData(), "g", np.arange(8, dtype=np.float32))
array(grid.GetCellData(), "BlockId", np.array([1] * 4 + [2] * 4, np.int32))
writer = vtk.vtkXMLUnstructuredGridWriter()
writer.SetInputData(grid)
writer.SetFileName(f"{folder}/parts.vtu")
writer.Write()
writer = vtk.vtkEnSightWriter()
writer.SetPath(folder)
writer.SetBaseName("parts")
writer.SetFileName(f"{folder}/parts")
writer.SetInputData(grid)
writer.Write()
writer.WriteCaseFile(1)
