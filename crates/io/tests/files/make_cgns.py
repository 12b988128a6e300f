"""Writes the CGNS files beside it: pip install vtk numpy pyCGNS."""

import glob
import os

import CGNS.MAP
import numpy as np
import vtk
from vtk.util.numpy_support import vtk_to_numpy

import meshes

os.chdir(os.path.dirname(os.path.abspath(__file__)))

# VTK's cell type: CGNS's number, and for each of its nodes the place in VTK's order.
HEXA = [*range(12), 16, 17, 18, 19, 12, 13, 14, 15, 24, 22, 21, 23, 20, 25, 26]
TYPES = {
    10: (10, range(4)),
    12: (17, range(8)),
    13: (14, range(6)),
    14: (12, range(5)),
    24: (11, range(10)),
    25: (18, HEXA[:20]),
    29: (19, HEXA),
    26: (15, [*range(9), 12, 13, 14, 9, 10, 11]),
    32: (16, [*range(9), 12, 13, 14, 9, 10, 11, 15, 16, 17]),
    27: (21, range(13)),
}
# The centres of faces by SIDS: bottom, y-, x+, y+, x-, top; VTK: x-, x+, y-, y+, bottom, top.
VTK_OF_CGNS = {"bottom": 24, "y-": 22, "x+": 21, "y+": 23, "x-": 20, "top": 25}
TYPES[29] = (19, [*HEXA[:20], *VTK_OF_CGNS.values(), 26])


def node(name, label, value=None, children=()):
    if isinstance(value, str):
        value = np.array([*value.encode()], dtype=np.uint8).view("S1")
    elif value is not None:
        value = np.asfortranarray(value)
    return [name, value, list(children), label]


def arrays(**values):
    return [node(name, "DataArray_t", value) for name, value in values.items()]


def coordinates(points, shape=None, name="GridCoordinates"):
    own = [points[:, axis].reshape(shape, order="F") if shape else points[:, axis] for axis in range(3)]
    return node(name, "GridCoordinates_t", None, arrays(CoordinateX=own[0], CoordinateY=own[1], CoordinateZ=own[2]))


def solution(name, location, children):
    return node(name, "FlowSolution_t", None, [node("GridLocation", "GridLocation_t", location), *children])


def solutions(grid, axes="XYZ"):
    s, v = (vtk_to_numpy(grid.GetPointData().GetArray(name)) for name in "sv")
    c = vtk_to_numpy(grid.GetCellData().GetArray("c"))
    vector = {f"v{axis}": v[:, place].copy() for place, axis in enumerate(axes)}
    return [
        solution("Solution", "Vertex", arrays(s=s.astype(np.float32), **vector)),
        solution("Cells", "CellCenter", arrays(c=c)),
    ]


def zone(name, sizes, kind, children):
    return node(name, "Zone_t", np.array(sizes, dtype=np.int64), [node("ZoneType", "ZoneType_t", kind), *children])


def section(name, kind, first, count, connectivity, offsets=None):
    children = [node("ElementRange", "IndexRange_t", np.array([first, first + count - 1], dtype=np.int32))]
    children += arrays(ElementConnectivity=np.array(connectivity, dtype=np.int64))
    if offsets is not None:
        children += arrays(ElementStartOffset=np.array(offsets, dtype=np.int64))
    return node(name, "Elements_t", np.array([kind, 0], dtype=np.int32), children)


def cells_of(grid):
    points = vtk_to_numpy(grid.GetPoints().GetData())
    cells = []
    for number in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(number)
        ids = [cell.GetPointId(i) for i in range(cell.GetNumberOfPoints())]
        kind, order = TYPES[cell.GetCellType()]
        cells.append((kind, [ids[place] + 1 for place in order]))
    return points, cells


def of_3_0(kind):
    """The number of an element type in the library 3.0, which had PYRA_13 behind PYRA_5."""
    return 13 if kind == 21 else kind + (12 < kind < 21)


def unstructured(name, grid, mixed, old=False, number=int, axes="XYZ"):
    """A boundary section of triangles, then the cells: one section each, or all in one of mixed types."""
    points, cells = cells_of(grid)
    sections = [section("Wall", 5, 1, 1, [1, 2, 3])]
    if mixed:
        connectivity = [own for kind, nodes in cells for own in (number(kind), *nodes)]
        offsets = np.concatenate([[0], np.cumsum([len(nodes) + 1 for _, nodes in cells])])
        sections.append(section("Mixed", number(20), 2, len(cells), connectivity, None if old else offsets))
    else:
        sections += [section(f"E{i}", number(kind), 2 + i, 1, nodes) for i, (kind, nodes) in enumerate(cells)]
        # The order in the file is not that of the element numbers.
        sections = sections[::-1]
    sizes = [[len(points), len(cells), 0]]
    return zone(name, sizes, "Unstructured", [coordinates(points), *sections, *solutions(grid, axes)])


def faces(name, grid, old):
    """Polyhedra: the faces of a cell point outwards; those that two share are stored once."""
    points = vtk_to_numpy(grid.GetPoints().GetData())
    known, all_faces, cells = {}, [], []
    for number in range(grid.GetNumberOfCells()):
        cell, own = grid.GetCell(number), []
        for f in range(cell.GetNumberOfFaces()):
            face = cell.GetFace(f)
            ids = [face.GetPointId(i) + 1 for i in range(face.GetNumberOfPoints())]
            key = tuple(sorted(ids))
            if key in known:
                own.append(-known[key])
            else:
                all_faces.append(ids)
                known[key] = len(all_faces)
                own.append(known[key])
        cells.append(own)

    def lists(title, kind, first, parts):
        if old:
            return section(title, kind, first, len(parts), [n for part in parts for n in (len(part), *part)])
        offsets = np.concatenate([[0], np.cumsum([len(part) for part in parts])])
        return section(title, kind, first, len(parts), [n for part in parts for n in part], offsets)

    sections = [lists("NGon", 22, 1, all_faces), lists("NFace", 23, len(all_faces) + 1, cells)]
    sizes = [[len(points), len(cells), 0]]
    return zone(name, sizes, "Unstructured", [coordinates(points), *sections, *solutions(grid)])


def structured(name, start=(0.0, 0.0, 0.0), rind=False):
    n = (3, 2, 2)
    points = meshes.box(n, start)
    s = meshes.field(points).reshape(n, order="F")
    c = np.arange(2.0).reshape(2, 1, 1)
    children = []
    if rind:
        s = np.pad(s, [(1, 2), (0, 1), (0, 0)], constant_values=1e9)
        children = [node("Rind", "Rind_t", np.array([1, 2, 0, 1, 0, 0], dtype=np.int32))]
    sizes = np.array([n, [m - 1 for m in n], [0, 0, 0]]).T
    return zone(
        name,
        sizes,
        "Structured",
        [
            coordinates(points, n),
            solution("Solution", "Vertex", [*children, *arrays(s=s)]),
            solution("Cells", "CellCenter", arrays(c=c)),
        ],
    )


def steps():
    """Two steps, with moving coordinates; the second solution is also one without a step."""
    own = unstructured("Zone", meshes.hexahedra(), False)
    points, s = meshes.box(), meshes.field(meshes.box())
    own[2] = [child for child in own[2] if child[3] != "FlowSolution_t"]
    own[2].append(coordinates(points + [1.0, 0, 0], name="GridCoordinates#2"))
    for step in (1, 2):
        own[2].append(solution(f"Solution#{step}", "Vertex", arrays(T=s + 100.0 * (step - 1))))
    names = lambda *texts: np.array([[*text.ljust(32).encode()] for text in texts], dtype=np.uint8).view("S1").T
    own[2].append(
        node("ZoneIterativeData", "ZoneIterativeData_t", None,
             arrays(FlowSolutionPointers=names("Solution#1", "Solution#2"),
                    GridCoordinatesPointers=names("GridCoordinates", "GridCoordinates#2")))
    )  # fmt: skip
    times = node("BaseIterativeData", "BaseIterativeData_t", np.array([2], dtype=np.int32), arrays(TimeValues=np.array([0.0, 0.25])))
    return base("Base", own, times)


def units():
    """Pressure in pascals, a velocity in the centimetres of its solution, a number without unit, one without exponents."""

    def names(*own):
        rows = [[*text.ljust(32).encode()] for text in own]
        return node("DimensionalUnits", "DimensionalUnits_t", np.array(rows, dtype=np.uint8).view("S1").T)

    def exponents(*own):
        return node("DimensionalExponents", "DimensionalExponents_t", np.array(own, dtype=np.float32))

    si = names("Kilogram", "Meter", "Second", "Kelvin", "Degree")
    own = structured("Zone")
    values = meshes.box()[:, 0].reshape((3, 2, 2), order="F")
    fields = arrays(Pressure=values, Mach=values, Other=values)
    fields[0][2].append(exponents(1, -1, -2, 0, 0))
    fields[1][2].append(exponents(0, 0, 0, 0, 0))
    moving = arrays(VelocityX=values, VelocityY=values, VelocityZ=values)
    for field in moving:
        field[2].append(exponents(0, 1, -1, 0, 0))
    cgs = names("Gram", "Centimeter", "Second", "Kelvin", "Degree")
    own[2] += [solution("Of the flow", "Vertex", fields), solution("Moving", "Vertex", [cgs, *moving])]
    return base("Base", own, si)


def base(name, *children, dimensions=(3, 3)):
    return node(name, "CGNSBase_t", np.array(dimensions, dtype=np.int32), children)


def write(name, *bases, version=4.2, links=()):
    tree = node("CGNSTree", "CGNSTree_t", None, [node("CGNSLibraryVersion", "CGNSLibraryVersion_t", np.array([version], dtype=np.float32)), *bases])
    CGNS.MAP.save(f"cgns_{name}.cgns", tree, links=[*links])


every = meshes.row([kind for kind in meshes.LINEAR + meshes.QUADRATIC if kind not in (vtk.vtkVoxel, vtk.vtkTriQuadraticPyramid)])
meshes.write_vtu(every, "cgns_cells.vtu")
append = vtk.vtkAppendFilter()
append.AddInputData(meshes.hexahedra())
append.AddInputData(meshes.row([vtk.vtkWedge], start=5.0))
append.Update()
write("cells", base("Base", unstructured("Zone", every, False)))
write("mixed", base("Base", unstructured("Zone", every, True)))
write("mixed_old", base("Base", unstructured("Zone", every, True, old=True)), version=3.1)
axes = ["_x", "_y", "_z"]
for name, mixed in [("cells_3_0", False), ("mixed_3_0", True)]:
    write(name, base("Base", unstructured("Zone", every, mixed, old=True, number=of_3_0, axes=axes)), version=3.0)
write("polyhedra", base("Base", faces("Zone", append.GetOutput(), False)))
write("polyhedra_old", base("Base", faces("Zone", append.GetOutput(), True)), version=3.1)
surface = zone("Skin", [[3, 1, 0]], "Unstructured", [coordinates(np.eye(3)), section("E", 5, 1, 1, [1, 2, 3])])
write(
    "zones",
    base("Fluid", structured("Rotor", (9.0, 0.0, 0.0)), structured("Casing", rind=True)),
    base("Wall", surface, dimensions=(2, 3)),
    base("Solid", unstructured("Block", meshes.hexahedra(start=(20.0, 0.0, 0.0)), False)),
)
write("steps", steps())
write("units", units())
# A file of a solution, whose coordinates lie in another file.
linked = unstructured("Zone", every, True)
linked[2] = [child for child in linked[2] if child[0] != "GridCoordinates"]
place = "/Base/Zone/GridCoordinates"
write("linked", base("Base", linked), links=[["", "cgns_cells.cgns", place, place, 64]])
meshes.pack(glob.glob("*.cgns"))
