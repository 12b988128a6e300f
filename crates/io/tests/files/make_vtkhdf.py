"""Writes the VTKHDF files beside it: pip install vtk h5py (VTK 9.7 wrote them)."""

import glob
import os
import pathlib

import h5py
import numpy as np
import vtk
from vtkmodules.util.vtkAlgorithm import VTKPythonAlgorithmBase

import meshes

os.chdir(os.path.dirname(os.path.abspath(__file__)))


def write(data, name, **settings):
    writer = vtk.vtkHDFWriter()
    if isinstance(data, VTKPythonAlgorithmBase):
        writer.SetInputConnection(data.GetOutputPort())
    else:
        writer.SetInputDataObject(data)
    writer.SetFileName(f"vtkhdf_{name}.vtkhdf")
    settings = {"ChunkSize": 64, "CompressionLevel": 4, **settings}
    for key, value in settings.items():
        getattr(writer, "Set" + key)(value)
    writer.Write()


class Steps(VTKPythonAlgorithmBase):
    """Three steps; the points move along x by the time where the mesh does, and T = s + 100 t."""

    def __init__(self, moves):
        super().__init__(nInputPorts=0, nOutputPorts=1, outputType="vtkUnstructuredGrid")
        self.grid, self.moves, self.first = meshes.hexahedra(), moves, vtk.vtkUnstructuredGrid()
        self.first.DeepCopy(self.grid)

    def RequestInformation(self, request, inputs, outputs):
        own, keys = outputs.GetInformationObject(0), vtk.vtkStreamingDemandDrivenPipeline
        own.Set(keys.TIME_STEPS(), [0.0, 0.5, 2.0], 3)
        own.Set(keys.TIME_RANGE(), [0.0, 2.0], 2)
        return 1

    def RequestData(self, request, inputs, outputs):
        own = outputs.GetInformationObject(0)
        time = own.Get(vtk.vtkStreamingDemandDrivenPipeline.UPDATE_TIME_STEP())
        out = vtk.vtkUnstructuredGrid.GetData(own)
        out.ShallowCopy(self.first)
        points = meshes.box()
        if self.moves:
            moved = vtk.vtkPoints()
            moved.SetData(meshes.array("Points", points + [time, 0, 0]))
            out.SetPoints(moved)
        out.GetPointData().AddArray(meshes.array("T", meshes.field(points) + 100 * time))
        return 1


def collection():
    data = vtk.vtkPartitionedDataSetCollection()
    data.SetNumberOfPartitionedDataSets(2)
    data.SetPartition(0, 0, meshes.hexahedra(start=(9.0, 0.0, 0.0)))
    data.SetPartition(0, 1, meshes.hexahedra(start=(11.0, 0.0, 0.0)))
    data.SetPartition(1, 0, meshes.hexahedra())
    for number, name in enumerate(["rotor", "casing"]):
        data.GetMetaData(number).Set(vtk.vtkCompositeDataSet.NAME(), name)
    tree = vtk.vtkDataAssembly()
    tree.AddDataSetIndex(tree.AddNode("fluid"), 0)
    tree.AddDataSetIndex(tree.AddNode("solid"), 1)
    data.SetDataAssembly(tree)
    return data


def multi_block():
    data, inner = vtk.vtkMultiBlockDataSet(), vtk.vtkMultiBlockDataSet()
    data.SetBlock(0, meshes.hexahedra())
    inner.SetBlock(0, meshes.hexahedra(start=(9.0, 0.0, 0.0)))
    data.SetBlock(1, inner)
    data.GetMetaData(0).Set(vtk.vtkCompositeDataSet.NAME(), "casing")
    data.GetMetaData(1).Set(vtk.vtkCompositeDataSet.NAME(), "fluid")
    inner.GetMetaData(0).Set(vtk.vtkCompositeDataSet.NAME(), "rotor")
    return data


def partitions():
    """The grid of every cell in two partitions, contiguous, as h5py writes it."""
    from vtk.util.numpy_support import vtk_to_numpy

    grids = [meshes.row(meshes.LINEAR), meshes.row(meshes.QUADRATIC, start=1.5 * len(meshes.LINEAR))]
    whole = meshes.every_cell()
    get = lambda own: vtk_to_numpy(own)
    with h5py.File("vtkhdf_partitions.vtkhdf", "w", libver="latest") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = [2, 0]
        root.attrs["Type"] = np.bytes_("UnstructuredGrid")
        cells = [grid.GetCells() for grid in grids]
        root["NumberOfPoints"] = [grid.GetNumberOfPoints() for grid in grids]
        root["NumberOfCells"] = [grid.GetNumberOfCells() for grid in grids]
        root["NumberOfConnectivityIds"] = [own.GetNumberOfConnectivityIds() for own in cells]
        root["Points"] = get(whole.GetPoints().GetData())
        root["Types"] = get(whole.GetCellTypes())
        root["Offsets"] = np.concatenate([get(own.GetOffsetsArray()) for own in cells])
        root["Connectivity"] = np.concatenate([get(own.GetConnectivityArray()) for own in cells])
        data = root.create_group("PointData")
        data.attrs["Scalars"] = np.bytes_("s")
        data["s"] = get(whole.GetPointData().GetArray("s")).astype(">f4")
        data["v"] = get(whole.GetPointData().GetArray("v"))
        data["texts"] = ["a", "b"]
        root.create_group("CellData")["c"] = get(whole.GetCellData().GetArray("c"))


def arrays():
    """Each array of the grid of every cell by an external link of its own."""
    with h5py.File("vtkhdf_partitions.vtkhdf") as whole, h5py.File("vtkhdf_arrays.vtkhdf", "w", libver="latest") as file:
        root = file.create_group("VTKHDF")
        for name, value in whole["VTKHDF"].attrs.items():
            root.attrs[name] = value

        def link(name, item):
            if isinstance(item, h5py.Dataset):
                root[name] = h5py.ExternalLink("vtkhdf_partitions.vtkhdf", "/VTKHDF/" + name)

        whole["VTKHDF"].visititems(link)


def short_offsets():
    """The grid of every cell in a file whose offsets and lengths take four bytes, in packed chunks."""
    sizes = h5py.h5p.create(h5py.h5p.FILE_CREATE)
    sizes.set_sizes(4, 4)
    short = h5py.h5f.create(b"vtkhdf_short_offsets.vtkhdf", h5py.h5f.ACC_TRUNC, sizes)
    with h5py.File("vtkhdf_cells.vtkhdf") as whole, h5py.File(short) as file:

        def copy(name, item):
            if isinstance(item, h5py.Dataset):
                chunks = tuple(max(1, min(n, 50)) for n in item.shape)
                to = file.create_dataset(name, data=item[()], chunks=chunks, compression="gzip", shuffle=True, maxshape=item.maxshape)
            else:
                to = file.create_group(name)
            for key, value in item.attrs.items():
                to.attrs[key] = value

        whole.visititems(copy)


def structured():
    n, points = (3, 2, 2), meshes.box()
    curvilinear = vtk.vtkStructuredGrid()
    curvilinear.SetDimensions(n)
    own = vtk.vtkPoints()
    own.SetData(meshes.array("Points", points))
    curvilinear.SetPoints(own)
    axes = [np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0]), np.array([1.0, 2.0])]
    boxes = vtk.vtkRectilinearGrid()
    boxes.SetDimensions(n)
    boxes.SetXCoordinates(meshes.array("x", axes[0]))
    boxes.SetYCoordinates(meshes.array("y", axes[1]))
    boxes.SetZCoordinates(meshes.array("z", axes[2]))
    image = vtk.vtkImageData()
    image.SetExtent(1, 3, 0, 1, 2, 3)
    image.SetOrigin(1.0, 2.0, 3.0)
    image.SetSpacing(0.5, 1.0, 2.0)
    image.SetDirectionMatrix(0, -1, 0, 1, 0, 0, 0, 0, 1)
    for name, grid in [("curvilinear", curvilinear), ("rectilinear", boxes), ("image", image)]:
        points = np.array([grid.GetPoint(i) for i in range(grid.GetNumberOfPoints())])
        grid.GetPointData().SetScalars(meshes.array("s", meshes.field(points)))
        grid.GetPointData().AddArray(meshes.array("v", np.stack([points[:, 0], points[:, 1], meshes.field(points)], 1)))
        grid.GetCellData().AddArray(meshes.array("c", np.arange(float(grid.GetNumberOfCells()))))
        write(grid, name)


def image_steps():
    """An image of two steps, as the specification has it: the time is the first axis."""
    with h5py.File("vtkhdf_image_steps.vtkhdf", "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"], root.attrs["Type"] = [2, 0], np.bytes_("ImageData")
        root.attrs["WholeExtent"] = [0, 2, 0, 1, 0, 1]
        root.attrs["Origin"], root.attrs["Spacing"] = [0.0, 0.0, 0.0], [1.0, 1.0, 1.0]
        k, j, i = np.meshgrid(np.arange(2.0), np.arange(2.0), np.arange(3.0), indexing="ij")
        s = meshes.field(np.stack([i, j, k], -1))
        data = root.create_group("PointData")
        data.create_dataset("s", data=np.stack([s, s + 100]), chunks=(1, 2, 2, 3), compression="gzip", shuffle=True)
        steps = root.create_group("Steps")
        steps.attrs["NSteps"], steps["Values"] = 2, [0.0, 1.0]
        steps.create_group("PointDataOffsets")["s"] = [0, 1]


def damaged():
    """What no writer makes: each file has one fault."""

    def hexahedron(name, change):
        points = np.array([[i, j, k] for k in (0, 1) for j, i in ((0, 0), (0, 1), (1, 1), (1, 0))], dtype=float)
        with h5py.File(f"vtkhdf_{name}.vtkhdf", "w", libver="latest") as file:
            root = file.create_group("VTKHDF")
            root.attrs["Version"], root.attrs["Type"] = [2, 0], np.bytes_("UnstructuredGrid")
            root["NumberOfPoints"], root["NumberOfCells"], root["NumberOfConnectivityIds"] = [8], [1], [8]
            root["Points"], root["Connectivity"], root["Offsets"], root["Types"] = points, np.arange(8), [0, 8], np.uint8([12])
            root.create_group("PointData")["s"] = np.arange(8.0)
            change(root)

    def replace(name, values):
        def change(root):
            del root[name]
            if values is not None:
                root[name] = values

        return change

    def tree(root):
        for name in [*root]:
            del root[name]
        root.attrs["Type"] = np.bytes_("MultiBlockDataSet")
        root.create_group("Block").attrs["Type"] = np.bytes_("UnstructuredGrid")
        inner = root.create_group("Assembly/a")
        inner["b"] = root["Assembly"]

    hexahedron("bad_huge", replace("NumberOfCells", np.array([2**63], dtype="u8")))
    hexahedron("bad_points", replace("Points", None))

    def chunks(root):
        replace("Points", None)(root)
        replace("NumberOfPoints", [2**40])(root)
        root.create_dataset("Points", (2**40, 3), chunks=(2**16, 3), dtype="f8")

    hexahedron("bad_chunks", chunks)
    hexahedron("bad_link", replace("Points", h5py.SoftLink("/VTKHDF/Points")))
    hexahedron("bad_external", replace("PointData", h5py.ExternalLink("vtkhdf_bad_external.vtkhdf", "/VTKHDF/PointData")))
    hexahedron("bad_tree", tree)
    hexahedron("bad_version", lambda root: root.attrs.__setitem__("Version", [3, 0]))
    hexahedron("bad_text", replace("Points", np.full((8, 3), b"a")))

    def virtual(root):
        layout = h5py.VirtualLayout((8, 3), dtype="f8")
        for half in (0, 1):
            layout[4 * half:4 * half + 4] = h5py.VirtualSource(f"values_{half}.h5", "points", (4, 3))
        replace("Points", None)(root)
        root.create_virtual_dataset("Points", layout)

    hexahedron("bad_virtual", virtual)

    # In another file: at the address of the virtual dataset this one has a virtual dataset of other files.
    elsewhere = pathlib.Path("vtkhdf_bad_elsewhere.vtkhdf")
    elsewhere.write_bytes(pathlib.Path("vtkhdf_bad_virtual.vtkhdf").read_bytes().replace(b"values_", b"others_"))
    with h5py.File(elsewhere, "a", libver="latest") as file:
        file.move("VTKHDF", "own")
        file["VTKHDF"] = h5py.ExternalLink("vtkhdf_bad_virtual.vtkhdf", "/VTKHDF")

    def filtered(root):
        replace("Points", None)(root)
        root.create_dataset("Points", (8, 3), dtype="f8", chunks=(8, 3), data=np.zeros((8, 3)), compression="lzf")

    hexahedron("bad_filter", filtered)


meshes.write_vtu(meshes.every_cell(), "cells.vtu")
meshes.write_vtu(meshes.polyhedra(), "polyhedra.vtu")
write(meshes.every_cell(), "cells")
write(meshes.polyhedra(), "polyhedra")
write(Steps(False), "static", WriteAllTimeSteps=True)
write(Steps(True), "moving", WriteAllTimeSteps=True)
write(collection(), "collection")
write(collection(), "linked", UseExternalComposite=True)
write(multi_block(), "blocks")
partitions()
arrays()
short_offsets()
structured()
image_steps()
damaged()
meshes.pack(glob.glob("*.vtkhdf"))
