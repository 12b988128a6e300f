"""Writes the adaptive grids beside it: pip install vtk h5py (VTK 9.7 wrote them). The cell array c is the linear field below."""

import os

import h5py
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk

import meshes

os.chdir(os.path.dirname(os.path.abspath(__file__)))


def field(x, y, z):
    return 1 + 2 * x - 3 * y + 0.5 * z


def trees():
    """Trees of random depth, of which a part is masked."""
    source = vtk.vtkRandomHyperTreeGridSource()
    source.SetDimensions(3, 4, 3)
    source.SetMaxDepth(3)
    source.SetSeed(5)
    source.SetSplitFraction(0.3)
    source.SetMaskedFraction(0.15)
    source.SetOutputBounds(-1, 1, 0, 3, 2, 4)
    source.Update()
    grid = source.GetOutput()
    values, cursor = np.zeros(grid.GetNumberOfCells()), vtk.vtkHyperTreeGridNonOrientedGeometryCursor()

    def visit():
        box = [0.0] * 6
        cursor.GetBounds(box)
        x0, x1, y0, y1, z0, z1 = box
        values[cursor.GetGlobalNodeIndex()] = field((x0 + x1) / 2, (y0 + y1) / 2, (z0 + z1) / 2)
        for child in range(0 if cursor.IsLeaf() else cursor.GetNumberOfChildren()):
            cursor.ToChild(child)
            visit()
            cursor.ToParent()

    for tree in range(grid.GetMaxNumberOfTrees()):
        grid.InitializeNonOrientedGeometryCursor(cursor, tree)
        visit()
    array = numpy_to_vtk(values, deep=1)
    array.SetName("c")
    grid.GetCellData().AddArray(array)
    leaves = vtk.vtkHyperTreeGridToUnstructuredGrid()
    leaves.SetInputData(grid)
    leaves.Update()
    print("leaves that are not masked:", leaves.GetOutput().GetNumberOfCells())
    for version, mode in [(1, "Ascii"), (1, "Appended"), (2, "Binary"), (2, "Appended")]:
        writer = vtk.vtkXMLHyperTreeGridWriter()
        writer.SetInputData(grid)
        getattr(writer, f"SetDataModeTo{mode}")()
        writer.SetDataSetMajorVersion(version)
        # Bits of one byte in base64 without compression have padding of their own.
        if mode == "Appended":
            writer.SetCompressorTypeToNone()
        writer.SetFileName(f"trees_{version}_{mode.lower()}.htg")
        writer.Write()
    writer = vtk.vtkHDFWriter()
    writer.SetInputData(grid)
    writer.SetChunkSize(64)
    writer.SetCompressionLevel(4)
    writer.SetFileName("vtkhdf_trees.vtkhdf")
    writer.Write()


def patches():
    """Two levels at two times, as the specification has them (no writer of VTK makes such files); the finer boxes move."""
    origin, spacing = np.array([-1.0, 0.0, 0.5]), np.array([0.5, 0.5, 0.25])
    coarse = [[0, 1, 0, 3, 0, 3], [2, 3, 0, 3, 0, 3]]
    fine = [[[2, 5, 2, 5, 0, 3]], [[0, 3, 2, 5, 0, 3], [4, 5, 2, 3, 2, 7]]]
    with h5py.File("vtkhdf_patches.vtkhdf", "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"], root.attrs["Type"] = [2, 3], np.bytes_("OverlappingAMR")
        root.attrs["GridDescription"], root.attrs["Origin"] = np.bytes_("XYZ"), origin
        steps = root.create_group("Steps")
        steps.attrs["NSteps"], steps["Values"] = 2, [0.0, 1.5]
        for number, boxes in enumerate([[coarse, coarse], fine]):
            level, step = root.create_group(f"Level{number}"), steps.create_group(f"Level{number}")
            h = spacing / 2**number
            level.attrs["Spacing"] = h
            cells, points, first = [], [], [[], []]
            for time, own in zip([0.0, 1.5], boxes):
                first[0].append(sum(map(len, cells)))
                first[1].append(sum(map(len, points)))
                for i0, i1, j0, j1, k0, k1 in own:
                    for values, shift, end in [(cells, 0.5, 1), (points, 0.0, 2)]:
                        axes = [np.arange(k0, k1 + end), np.arange(j0, j1 + end), np.arange(i0, i1 + end)]
                        k, j, i = np.meshgrid(*axes, indexing="ij")
                        x, y, z = [origin[a] + h[a] * (n + shift) for a, n in enumerate([i, j, k])]
                        values.append((field(x, y, z) + 100 * time).ravel())
            level["AMRBox"] = np.concatenate(boxes).astype("i4")
            level.create_group("CellData").create_dataset("c", data=np.concatenate(cells), chunks=(64,), compression="gzip")
            level.create_group("PointData")["p"] = np.concatenate(points)
            step["NumberOfAMRBoxes"] = [len(own) for own in boxes]
            step["AMRBoxOffsets"] = [0, len(boxes[0])]
            step.create_group("CellDataOffsets")["c"], step.create_group("PointDataOffsets")["p"] = first


trees()
patches()
meshes.pack(["vtkhdf_trees.vtkhdf", "vtkhdf_patches.vtkhdf", *[f"trees_{name}.htg" for name in ["1_ascii", "1_appended", "2_binary", "2_appended"]]])
