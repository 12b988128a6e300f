"""Writes the XDMF files beside it: pip install vtk numpy h5py meshio."""

import glob
import os

import h5py
import meshio
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import meshes

# Types that meshio reads and writes, but has forgotten here.
meshio._mesh.topological_dimension.update(wedge15=3, wedge18=3, pyramid13=3)
os.chdir(os.path.dirname(os.path.abspath(__file__)))

NAMES = {10: "tetra", 12: "hexahedron", 13: "wedge", 14: "pyramid", 24: "tetra10", 25: "hexahedron20",
         29: "hexahedron27", 26: "wedge15", 32: "wedge18", 27: "pyramid13"}  # fmt: skip


def parts(grid):
    points = vtk_to_numpy(grid.GetPoints().GetData())
    s, v = (vtk_to_numpy(grid.GetPointData().GetArray(name)) for name in "sv")
    c = vtk_to_numpy(grid.GetCellData().GetArray("c"))
    cells = []
    for number in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(number)
        ids = np.array([[cell.GetPointId(i) for i in range(cell.GetNumberOfPoints())]])
        cells.append((cell.GetCellType(), ids))
    return points, cells, s, v, c


def of_meshio(grid, name, format, kinds=None):
    """Mixed, or of one type."""
    points, cells, s, v, c = parts(grid)
    blocks = [(NAMES[kind], ids) for kind, ids in cells]
    if kinds == 1:
        blocks = [(blocks[0][0], np.concatenate([ids for _, ids in blocks]))]
        c = [c]
    else:
        c = [c[i : i + 1] for i in range(len(c))]
    mesh = meshio.Mesh(points, blocks, {"s": s, "v": v}, {"c": c})
    mesh.write(f"xdmf_{name}.xdmf", data_format=format)


def text(name, body, version="3.0"):
    with open(f"xdmf_{name}.xdmf", "w") as file:
        file.write(f'<?xml version="1.0"?>\n<!DOCTYPE Xdmf SYSTEM "Xdmf.dtd" []>\n<Xdmf Version="{version}" xmlns:xi="http://www.w3.org/2001/XInclude"><Domain>{body}</Domain></Xdmf>\n')


def item(name, path, shape, more='NumberType="Float" Precision="8"'):
    return f'<DataItem Dimensions="{" ".join(map(str, shape))}" {more} Format="HDF">xdmf_{name}.h5:/{path}</DataItem>'


def attribute(name, center, kind, item):
    return f'<Attribute Name="{name}" AttributeType="{kind}" Center="{center}">{item}</Attribute>'


def dolfin():
    """The layout of DOLFIN: a series whose later steps include topology and geometry of the first; two functions."""
    points, cells, s, _, _ = parts(meshes.hexahedra())
    ids = np.concatenate([own for _, own in cells])
    with h5py.File("xdmf_dolfin.h5", "w") as file:
        file["Mesh/0/mesh/topology"], file["Mesh/0/mesh/geometry"] = ids, points
        body = ""
        for function in "Tu":
            grids = ""
            for step, time in enumerate([0.0, 0.5]):
                path = f"VisualisationVector/{function}{step}"
                values = s[:, None] + 100 * time if function == "T" else np.stack([s, 0 * s, 0 * s + time], 1)
                file.create_dataset(path, data=values, chunks=(5, values.shape[1]), compression="gzip", shuffle=True)
                mesh = (
                    f'<Topology NumberOfElements="{len(ids)}" TopologyType="Hexahedron" NodesPerElement="8">'
                    + item("dolfin", "Mesh/0/mesh/topology", ids.shape, 'NumberType="UInt"')
                    + '</Topology><Geometry GeometryType="XYZ">' + item("dolfin", "Mesh/0/mesh/geometry", points.shape, "")
                    + "</Geometry>"
                )  # fmt: skip
                path_of_first = f"//Grid[@Name=&quot;TimeSeries_{function}&quot;]/Grid[1]/*[self::Topology or self::Geometry]"
                include = f'<xi:include xpointer="xpointer({path_of_first})" />'
                kind = "Scalar" if function == "T" else "Vector"
                own = attribute(function, "Node", kind, item("dolfin", path, values.shape, ""))
                grids += f'<Grid Name="mesh" GridType="Uniform">{include if step else mesh}<Time Value="{time}" />{own}</Grid>'
            body += f'<Grid Name="TimeSeries_{function}" GridType="Collection" CollectionType="Temporal">{grids}</Grid>'
    text("dolfin", body)


def dolfinx():
    """The layout of DOLFINx: a mesh, series that include it, and tags of its facets."""
    points, cells, s, _, _ = parts(meshes.hexahedra())
    ids = np.concatenate([own for _, own in cells])
    with h5py.File("xdmf_dolfinx.h5", "w") as file:
        file["Mesh/mesh/topology"], file["Mesh/mesh/geometry"], file["Facets"] = ids, points, ids[:, :4]
        geometry = '<Geometry GeometryType="XYZ">' + item("dolfinx", "Mesh/mesh/geometry", points.shape) + "</Geometry>"
        mesh = (
            f'<Grid Name="mesh" GridType="Uniform"><Topology TopologyType="Hexahedron" NumberOfElements="{len(ids)}" NodesPerElement="8">'
            + item("dolfinx", "Mesh/mesh/topology", ids.shape, 'NumberType="Int" Precision="8"') + "</Topology>" + geometry + "</Grid>"
        )  # fmt: skip
        facets = (
            '<Grid Name="facets" GridType="Uniform"><xi:include xpointer="xpointer(/Xdmf/Domain/Grid/Geometry)" />'
            f'<Topology TopologyType="Quadrilateral" NumberOfElements="{len(ids)}">'
            + item("dolfinx", "Facets", (len(ids), 4), 'NumberType="Int" Precision="8"') + "</Topology></Grid>"
        )  # fmt: skip
        grids = ""
        for step in range(2):
            file[f"Function/f/{step}"] = s + 100.0 * step
            grids += (
                "<Grid Name=\"f\" GridType=\"Uniform\"><xi:include xpointer=\"xpointer(/Xdmf/Domain/Grid[@GridType='Uniform'][1]/*[self::Topology or self::Geometry])\" />"
                + f'<Time Value="{step}" />' + attribute("T", "Node", "Scalar", item("dolfinx", f"Function/f/{step}", s.shape)) + "</Grid>"
            )  # fmt: skip
    text("dolfinx", mesh + f'<Grid Name="f" GridType="Collection" CollectionType="Temporal">{grids}</Grid>' + facets)


def structured():
    """Three grids side by side in a tree, and the parts of others that they take by slabs, references and functions."""
    n, points = (3, 2, 2), meshes.box(start=(10.0, 0.0, 0.0))
    shape = n[::-1]
    with h5py.File("xdmf_blocks.h5", "w") as file:
        for axis in range(3):
            file["XYZ"[axis]] = points[:, axis].reshape(shape)
        # Twice as many values along x, of which every other one is meant; and two steps of them.
        slab = np.zeros((2, 2, 2, 6))
        slab[1, :, :, 1::2] = meshes.field(points).reshape(shape)
        file.create_dataset("slab", data=slab, chunks=(1, 2, 2, 4), compression="gzip")
    coordinates = "".join(item("blocks", axis, shape) for axis in "XYZ")
    slab = '<DataItem ItemType="HyperSlab" Dimensions="2 2 3" Type="HyperSlab"><DataItem Dimensions="3 4" Format="XML" NumberType="Int">1 0 0 1  1 1 1 2  1 2 2 3</DataItem>{}</DataItem>'
    s = slab.format(item("blocks", "slab", (2, 2, 2, 6)))
    join = f'<DataItem ItemType="Function" Function="JOIN($0, $1, $2)" Dimensions="2 2 3 3">{coordinates}</DataItem>'
    curvilinear = (
        f'<Grid Name="curvilinear"><Topology TopologyType="3DSMesh" Dimensions="2 2 3"/><Geometry GeometryType="X_Y_Z">{coordinates}</Geometry>'
        + attribute("s", "Node", "Scalar", s) + attribute("place", "Node", "Vector", join) + "</Grid>"
    )  # fmt: skip

    def xml(values, shape=None):
        values = np.asarray(values)
        dims = " ".join(map(str, shape or values.shape))
        return f'<DataItem Dimensions="{dims}" Format="XML" Precision="8">{" ".join(map(repr, values.ravel().tolist()))}</DataItem>'

    def of(axes):
        k, j, i = np.meshgrid(*axes[::-1], indexing="ij")
        points = np.stack([i, j, k], -1)
        return attribute("s", "Node", "Scalar", xml(meshes.field(points))) + attribute("place", "Node", "Vector", xml(points))

    axes = [np.array([0.0, 1.0, 3.0]), np.array([0.0, 2.0]), np.array([1.0, 2.0])]
    rectilinear = (
        '<Grid Name="rectilinear"><Topology TopologyType="3DRectMesh" Dimensions="2 2 3"/><Geometry GeometryType="VXVYVZ">'
        + "".join(map(xml, axes)) + "</Geometry>" + of(axes) + "</Grid>"
    )  # fmt: skip
    axes = [20.0 + 0.5 * np.arange(3), 2.0 + np.arange(2), 3.0 + 2.0 * np.arange(2)]
    image = (
        '<Grid Name="image"><Topology TopologyType="3DCoRectMesh" Dimensions="2 2 3"/><Geometry GeometryType="ORIGIN_DXDYDZ">'
        + '<DataItem Reference="/Xdmf/Domain/DataItem[@Name=\'origin\']"/><DataItem Reference="XML">/Xdmf/Domain/DataItem[2]</DataItem>'
        + "</Geometry>" + of(axes) + "</Grid>"
    )  # fmt: skip
    shared = xml([3.0, 2.0, 20.0]).replace("<DataItem", '<DataItem Name="origin"') + xml([2.0, 1.0, 0.5])
    inner = f'<Grid Name="outer" GridType="Collection" CollectionType="Spatial">{rectilinear}{image}</Grid>'
    text("blocks", f'{shared}<Grid Name="all" GridType="Tree">{curvilinear}{inner}</Grid>', "2.0")


def polyhedra():
    """Polyhedra in a mixed topology, numbered from 1."""
    grid = meshes.polyhedra()
    points, cells, s, v, c = parts(grid)
    numbers = []
    for number in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(number)
        numbers += [16, cell.GetNumberOfFaces()]
        for f in range(cell.GetNumberOfFaces()):
            face = cell.GetFace(f)
            numbers += [face.GetNumberOfPoints(), *(face.GetPointId(i) + 1 for i in range(face.GetNumberOfPoints()))]
    xml = lambda values, kind="Float": (
        f'<DataItem Dimensions="{" ".join(map(str, values.shape))}" Format="XML" NumberType="{kind}" Precision="8">'
        f'{" ".join(map(repr, values.ravel().tolist()))}</DataItem>'
    )
    body = f'<Grid><Topology TopologyType="Mixed" NumberOfElements="{len(cells)}" BaseOffset="1">{xml(np.array(numbers), "Int")}</Topology>'
    body += f'<Geometry GeometryType="XYZ">{xml(points)}</Geometry>' + attribute("s", "Node", "Scalar", xml(s))
    body += attribute("v", "Node", "Vector", xml(v)) + attribute("c", "Cell", "Scalar", xml(c)) + "</Grid>"
    text("polyhedra", body)


every = meshes.row([kind for kind in meshes.LINEAR + meshes.QUADRATIC if kind not in (vtk.vtkVoxel, vtk.vtkTriQuadraticPyramid)])
for format in ("HDF", "XML", "Binary"):
    of_meshio(every, format.lower(), format)
for kind in meshes.LINEAR[:1] + meshes.QUADRATIC[:4]:
    own = meshes.row([kind, kind])
    of_meshio(own, kind.__name__[3:].lower(), "HDF", kinds=1)
    meshes.write_vtu(own, f"xdmf_{kind.__name__[3:].lower()}.vtu")
points, cells, s, v, c = parts(meshes.hexahedra())
with meshio.xdmf.TimeSeriesWriter("xdmf_series.xdmf") as writer:
    writer.write_points_cells(points, [("hexahedron", np.concatenate([ids for _, ids in cells]))])
    for time in (0.0, 0.5):
        writer.write_data(time, point_data={"T": s + 100 * time}, cell_data={"c": [c]})
dolfin()
dolfinx()
structured()
polyhedra()
meshes.pack(glob.glob("xdmf_*.h5") + glob.glob("xdmf_*.xdmf") + glob.glob("xdmf_*.bin"))
