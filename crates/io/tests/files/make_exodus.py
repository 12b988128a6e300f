"""Writes the Exodus files beside it, packed: pip install netCDF4 numpy.

One element of each kind in a block of its own, at nodes of its own, one unit apart along x; the scalar T at nodes and the vector disp are
formulas of the place and the time; p in elements is missing in the block of tetrahedra.
"""

import ctypes
import gzip
import os

import numpy as np
from netCDF4 import Dataset

HEX = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
TET = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
WEDGE = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (0, 1, 1)]
PYRAMID = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)]
QUAD = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0)]


def middle(corners, groups):
    """The nodes in the middle of groups of corners, numbered from 1 as in figure 4.2 of the manual."""
    return [tuple(np.mean([corners[i - 1] for i in group], axis=0)) for group in groups]


HEX_EDGES = [(1, 2), (2, 3), (3, 4), (4, 1), (1, 5), (2, 6), (3, 7), (4, 8), (5, 6), (6, 7), (7, 8), (8, 5)]
HEX_FACES = [range(1, 9), (1, 2, 3, 4), (5, 6, 7, 8), (1, 4, 8, 5), (2, 3, 7, 6), (1, 2, 6, 5), (3, 4, 8, 7)]
TET_EDGES = [(1, 2), (2, 3), (3, 1), (1, 4), (2, 4), (3, 4)]
TET_FACES = [(1, 2, 4), (2, 3, 4), (1, 3, 4), (1, 2, 3)]
WEDGE_EDGES = [(1, 2), (2, 3), (3, 1), (1, 4), (2, 5), (3, 6), (4, 5), (5, 6), (6, 4)]
WEDGE_FACES = [(1, 2, 5, 4), (2, 3, 6, 5), (1, 3, 6, 4)]
PYRAMID_EDGES = [(1, 2), (2, 3), (3, 4), (4, 1), (1, 5), (2, 5), (3, 5), (4, 5)]

HEX20 = HEX + middle(HEX, HEX_EDGES)
TET10 = TET + middle(TET, TET_EDGES)
WEDGE15 = WEDGE + middle(WEDGE, WEDGE_EDGES)
KINDS = [
    ("hexes", "HEX8", HEX),
    ("hexes 20", "HEX20", HEX20),
    ("hexes 27", "hex", HEX20 + middle(HEX, HEX_FACES)),
    ("tets", "TETRA", TET),
    ("tets 8", "TETRA8", TET + middle(TET, TET_FACES)),
    ("tets 10", "TETRA10", TET10),
    ("tets 14", "TET14", TET10 + middle(TET, TET_FACES)),
    ("wedges", "WEDGE", WEDGE),
    ("wedges 15", "WEDGE15", WEDGE15),
    ("wedges 18", "WEDGE18", WEDGE15 + middle(WEDGE, WEDGE_FACES)),
    ("pyramids", "PYRAMID5", PYRAMID),
    ("pyramids 13", "PYRAMID13", PYRAMID + middle(PYRAMID, PYRAMID_EDGES)),
    ("walls", "SHELL4", QUAD),
]
TIMES = [0.5, 1.5]


def temperature(points, time):
    x, y, z = points.T
    return 1 + x + 2 * y + 3 * z * (1 - y) + time * x * x


def displacement(points, time):
    x, y, z = points.T
    return np.stack([time * y, 0 * x, 0.25 * time * x], axis=1)


def letters(file, name, texts, dimension, length="len_string"):
    variable = file.createVariable(name, "S1", (dimension, length))
    for i, text in enumerate(texts):
        variable[i, :] = np.frombuffer(text.encode().ljust(33, b"\0"), dtype="S1")


def write(path, form, points, blocks, names=True, old=False, ids=None, numbers=None, strings=False, **options):
    """blocks: (name, element type, connectivity from 0)."""
    file = Dataset(path, "w", format=form)
    # The library of Exodus opens no file without these.
    file.title = "formulas"
    file.api_version, file.version = np.float32(5.22), np.float32(5.22)
    file.floating_point_word_size, file.file_size = np.int32(8), np.int32(not old)
    file.createDimension("num_elem", sum(len(block[2]) for block in blocks))
    file.createDimension("len_string", 33)
    file.createDimension("time_step", None)
    file.createDimension("num_dim", 3)
    file.createDimension("num_nodes", len(points))
    file.createDimension("num_el_blk", len(blocks))
    file.createDimension("num_node_sets", 2)
    file.createDimension("num_nod_var", 4)
    file.createDimension("num_elem_var", 1)
    file.createVariable("time_whole", "f8", ("time_step",))[:] = TIMES
    file.createVariable("eb_prop1", "i4", ("num_el_blk",))[:] = numbers or [10 * (i + 1) for i in range(len(blocks))]
    file.createVariable("eb_status", "i4", ("num_el_blk",))[:] = 1
    file["eb_prop1"].setncattr("name", "ID")
    file.createVariable("ns_prop1", "i4", ("num_node_sets",))[:] = [7, 9]
    if strings:
        file.createVariable("eb_names", str, ("num_el_blk",))[:] = np.array([block[0] for block in blocks], dtype=object)
    elif names:
        letters(file, "eb_names", [block[0] for block in blocks], "num_el_blk")
        letters(file, "ns_names", ["inlet", ""], "num_node_sets")
    if ids is not None:
        file.createVariable("node_num_map", "i4", ("num_nodes",))[:] = np.asarray(ids) + 1
    if old:
        file.createVariable("coord", "f8", ("num_dim", "num_nodes"))[:] = points.T
        values = file.createVariable("vals_nod_var", "f4", ("time_step", "num_nod_var", "num_nodes"))
    else:
        for axis, name in enumerate(["coordx", "coordy", "coordz"]):
            file.createVariable(name, "f8", ("num_nodes",), **options)[:] = points[:, axis]
        values = [
            file.createVariable(f"vals_nod_var{k}", "f8", ("time_step", "num_nodes"), **options) for k in range(1, 5)
        ]
    letters(file, "name_nod_var", ["T", "disp_x", "disp_y", "disp_z"], "num_nod_var")
    letters(file, "name_elem_var", ["p"], "num_elem_var")
    for step, time in enumerate(TIMES):
        fields = [temperature(points, time), *displacement(points, time).T]
        for k, field in enumerate(fields):
            if old:
                values[step, k, :] = field
            else:
                values[k][step, :] = field
    table = []
    for number, (name, kind, connectivity) in enumerate(blocks, 1):
        file.createDimension(f"num_el_in_blk{number}", len(connectivity))
        file.createDimension(f"num_nod_per_el{number}", len(connectivity[0]))
        axes = (f"num_el_in_blk{number}", f"num_nod_per_el{number}")
        variable = file.createVariable(f"connect{number}", "i4", axes)
        variable.elem_type = kind
        variable[:] = np.asarray(connectivity) + 1
        table.append(int(name != "tets"))
        if name != "tets":
            values = file.createVariable(f"vals_elem_var1eb{number}", "f8", ("time_step", axes[0]))
            for step, time in enumerate(TIMES):
                values[step, :] = [number + time] * len(connectivity)
    file.createVariable("elem_var_tab", "i4", ("num_el_blk", "num_elem_var"))[:] = np.reshape(table, (-1, 1))
    file.close()
    with open(path, "rb") as plain, open(path + ".gz", "wb") as packed:
        packed.write(gzip.compress(plain.read(), mtime=0))
    os.remove(path)


def apart(kinds):
    points, blocks = [], []
    for place, (name, kind, nodes) in enumerate(kinds):
        first = len(points)
        points += [(x + 2 * place, y, z) for x, y, z in nodes]
        blocks.append((name, kind, [range(first, len(points))]))
    return np.array(points, dtype=float), blocks


def row(count):
    """A row of hexahedra along x that share their faces, two blocks."""
    points = np.array([(x, y, z) for x in range(count + 1) for z in (0, 1) for y in (0, 1)], dtype=float)
    corner = lambda x, y, z: 4 * x + 2 * z + y  # noqa: E731
    order = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    cells = [[corner(x + dx, dy, dz) for dx, dy, dz in order] for x in range(count)]
    return points, cells


class InitParameters(ctypes.Structure):
    NAMES = "dim nodes edge edge_blk face face_blk elem elem_blk node_sets edge_sets face_sets side_sets elem_sets node_maps"
    NAMES += " edge_maps face_maps elem_maps assembly blob"
    _fields_ = [("title", ctypes.c_char * 81), *[(name, ctypes.c_int64) for name in NAMES.split()]]


def polyhedra(path):
    """Polyhedra, polygons and a brick by Sandia's own library, of which VTK holds a copy: pip install vtk."""
    import vtk

    import meshes

    folder = os.path.join(os.path.dirname(vtk.__file__), "vtkmodules")
    library = ctypes.CDLL(os.path.join(folder, "libvtkexodusII.so"))

    def call(name, *values):
        given = []
        for value in values:
            array = value if isinstance(value, np.ndarray) else None
            given.append(array.ctypes.data_as(ctypes.c_void_p) if array is not None else value)
        result = getattr(library, "vtkexodusII_ex_" + name)(*given)
        assert result >= 0, (name, result)
        return result

    grid, brick = meshes.polyhedra(), meshes.hexahedra((2, 2, 2), start=(20.0, 0.0, 0.0))
    points = [[own.GetPoint(i) for i in range(own.GetNumberOfPoints())] for own in (grid, brick)]
    first = len(points[0])
    points = np.array(points[0] + points[1])
    numbers, faces, cells = {}, [], []
    for number in range(grid.GetNumberOfCells()):
        cell = grid.GetCell(number)
        cells.append([])
        for i in range(cell.GetNumberOfFaces()):
            face = cell.GetFace(i)
            ids = [face.GetPointId(k) + 1 for k in range(face.GetNumberOfPoints())]
            key = tuple(sorted(ids))
            if key not in numbers:
                numbers[key] = len(faces) + 1
                faces.append(ids)
            cells[-1].append(numbers[key])
    # Two blocks of faces: those of four nodes, and the others.
    order = sorted(range(len(faces)), key=lambda place: len(faces[place]) != 4)
    renumbered = {old + 1: new + 1 for new, old in enumerate(order)}
    faces = [faces[place] for place in order]
    cells = [[renumbered[face] for face in cell] for cell in cells]
    quads = [face for face in faces if len(face) == 4]
    others = [face for face in faces if len(face) != 4]
    word = ctypes.c_int(8)
    other_word = ctypes.c_int(8)
    # A file that is there is written anew; 64-bit offsets.
    mode = 0x0008 | 0x0020
    file = call("create_int", path.encode(), mode, ctypes.byref(word), ctypes.byref(other_word), 904)
    init = InitParameters(title=b"polyhedra", dim=3, nodes=len(points), face=len(faces), face_blk=2, elem=len(cells) + 3, elem_blk=3)
    call("put_init_ext", file, ctypes.byref(init))
    element, face_kind = 1, 8
    ids = lambda value: ctypes.c_int64(value)
    flat = lambda lists: np.array([value for own in lists for value in own], np.int32)
    counts = lambda lists: np.array([len(own) for own in lists], np.int32)

    def block(kind, number, name, count, nodes, faces=0):
        call("put_block", file, kind, ids(number), name, ids(count), ids(nodes), ids(0), ids(faces), ids(0))

    block(face_kind, 1, b"nsided", len(quads), 4 * len(quads))
    block(face_kind, 2, b"nsided", len(others), len(flat(others)))
    block(element, 10, b"nfaced", len(cells), 0, len(flat(cells)))
    polygons = [[1, 2, 5, 4], [1, 2, 5]]
    block(element, 20, b"nsided", len(polygons), 7)
    block(element, 30, b"HEX8", 1, 8)
    for number, own in [(1, quads), (2, others)]:
        call("put_conn", file, face_kind, ids(number), flat(own), None, None)
        call("put_entity_count_per_polyhedra", file, face_kind, ids(number), counts(own))
    call("put_conn", file, element, ids(10), None, None, flat(cells))
    call("put_entity_count_per_polyhedra", file, element, ids(10), counts(cells))
    call("put_conn", file, element, ids(20), flat(polygons), None, None)
    call("put_entity_count_per_polyhedra", file, element, ids(20), counts(polygons))
    call("put_conn", file, element, ids(30), np.arange(first + 1, first + 9, dtype=np.int32)[[0, 1, 3, 2, 4, 5, 7, 6]], None, None)
    call("put_coord", file, *[np.ascontiguousarray(axis) for axis in points.T])
    for number, name in [(10, b"cells"), (20, b"wall"), (30, b"bricks")]:
        call("put_name", file, element, ids(number), name)
    call("put_variable_param", file, 14, 1)
    call("put_variable_param", file, element, 1)
    call("put_variable_name", file, 14, 1, b"s")
    call("put_variable_name", file, element, 1, b"c")
    call("put_time", file, 1, np.array([0.5]))
    call("put_var", file, 1, 14, 1, ids(1), ids(len(points)), meshes.field(points))
    for number, own in [(10, [1.0, 2.0, 3.0]), (20, [4.0, 5.0]), (30, [6.0])]:
        call("put_var", file, 1, element, 1, ids(number), ids(len(own)), np.array(own))
    call("close", file)
    file = Dataset(path, "a")
    file["vals_nod_var1"].units = "K"
    file.close()
    with open(path, "rb") as plain, open(path + ".gz", "wb") as packed:
        packed.write(gzip.compress(plain.read(), mtime=0))
    os.remove(path)


if __name__ == "__main__":
    os.chdir(os.path.dirname(os.path.abspath(__file__)))
    points, blocks = apart(KINDS)
    write("exodus_kinds.exo", "NETCDF3_64BIT_OFFSET", points, blocks)
    write("exodus_kinds.ex2", "NETCDF3_64BIT_DATA", points, blocks)
    points, blocks = apart([KINDS[0], KINDS[3], KINDS[8]])
    write("exodus_hdf5.e", "NETCDF4", points, blocks, zlib=True, chunksizes=None)
    points, blocks = apart([("Gehäuse", "HEX8", HEX), ("Träger", "TETRA", TET)])
    write("exodus_letters.e", "NETCDF4", points, blocks)
    write("exodus_strings.e", "NETCDF4", points, blocks, strings=True)
    points, cells = row(4)
    write("exodus_old.g", "NETCDF3_CLASSIC", points, [("", "HEX", cells[:2]), ("", "HEX", cells[2:])], names=False, old=True)
    # One process has the first block and a cell of the second, the other the rest.
    for process, (own, numbers) in enumerate([([[0, 1], [2]], [10, 20]), ([[3]], [20])]):
        used = sorted({node for block in own for cell in block for node in cells[cell]})
        place = {node: i for i, node in enumerate(used)}
        names = {10: "left", 20: "right"}
        parts = [
            (names[number], "HEX8", [[place[node] for node in cells[cell]] for cell in block])
            for number, block in zip(numbers, own)
        ]
        write(f"exodus_row.e.2.{process}", "NETCDF3_CLASSIC", points[used], parts, ids=used, numbers=numbers)
    polyhedra("exodus_faces.e")
