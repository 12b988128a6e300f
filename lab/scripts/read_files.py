"""One grid of tetrahedra in every file format that voltet reads, by other programs' writers where there are such (VTK, meshio, h5py,
netCDF4), else after the format's description. For read-speed.py.

Points hold `p` and `u`, cells `q`. Text has the digits that the writers give by themselves.
"""

import shutil
from pathlib import Path

import h5py
import meshio
import netCDF4
import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, numpy_to_vtkIdTypeArray

# meshio writes numbers by their representation, which numpy 2 gives a type's name.
np.set_printoptions(legacy="1.25")


class Mesh:
    """Boxes of six tetrahedra each, whose inner points are moved a little."""

    def __init__(self, side):
        self.points = np.stack(np.meshgrid(*[np.linspace(0, 1, side + 1)] * 3, indexing="ij"), -1).reshape(-1, 3)
        inner = np.all((self.points > 0) & (self.points < 1), axis=1)
        self.points[inner] += np.random.default_rng(1).uniform(-0.1 / side, 0.1 / side, (inner.sum(), 3))
        n = side + 1
        i, j, k = (a.ravel() for a in np.meshgrid(*[np.arange(side)] * 3, indexing="ij"))
        base = (i * n + j) * n + k
        steps = np.array([n * n, n, 1])
        cells = []
        for a, b, c in [(0, 1, 2), (1, 2, 0), (2, 0, 1), (0, 2, 1), (2, 1, 0), (1, 0, 2)]:
            path = np.stack([base, base + steps[a], base + steps[a] + steps[b], base + steps.sum()], -1)
            odd = (a, b, c) in [(0, 2, 1), (2, 1, 0), (1, 0, 2)]
            cells.append(path[:, [0, 2, 1, 3]] if odd else path)
        self.cells = np.stack(cells, 1).reshape(-1, 4).astype(np.int64)
        x, y, z = self.points.T
        self.p = np.sin(7 * x) * np.cos(5 * y) + z
        self.u = np.stack([-y, x, np.sin(9 * z)], -1)
        self.q = self.p[self.cells].mean(axis=1)


def vtk_grid(mesh):
    grid = vtk.vtkUnstructuredGrid()
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(mesh.points, deep=1))
    grid.SetPoints(points)
    cells = vtk.vtkCellArray()
    offsets = numpy_to_vtkIdTypeArray(np.arange(0, mesh.cells.size + 1, 4, dtype=np.int64), deep=1)
    cells.SetData(offsets, numpy_to_vtkIdTypeArray(mesh.cells.ravel(), deep=1))
    grid.SetCells(10, cells)
    for data, name, values in [
        (grid.GetPointData(), "p", mesh.p), (grid.GetPointData(), "u", mesh.u), (grid.GetCellData(), "q", mesh.q),
    ]:
        array = numpy_to_vtk(np.ascontiguousarray(values), deep=1)
        array.SetName(name)
        data.AddArray(array)
    return grid


def vtu(mesh, path, mode, compressor=None):
    writer = vtk.vtkXMLUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(vtk_grid(mesh))
    {"raw": writer.SetDataModeToAppended, "base64": writer.SetDataModeToBinary, "ascii": writer.SetDataModeToAscii}[mode]()
    writer.EncodeAppendedDataOff()
    {None: writer.SetCompressorTypeToNone, "zlib": writer.SetCompressorTypeToZLib, "lz4": writer.SetCompressorTypeToLZ4, "lzma": writer.SetCompressorTypeToLZMA}[compressor]()
    writer.Write()


def legacy(mesh, path, binary):
    writer = vtk.vtkUnstructuredGridWriter()
    writer.SetFileName(str(path))
    writer.SetInputData(vtk_grid(mesh))
    (writer.SetFileTypeToBinary if binary else writer.SetFileTypeToASCII)()
    writer.Write()


def vtkhdf(mesh, path, **options):
    with h5py.File(path, "w") as file:
        root = file.create_group("VTKHDF")
        root.attrs["Version"] = (2, 0)
        root.attrs.create("Type", np.bytes_("UnstructuredGrid"))
        arrays = {
            "NumberOfPoints": np.array([len(mesh.points)]), "NumberOfCells": np.array([len(mesh.cells)]),
            "NumberOfConnectivityIds": np.array([mesh.cells.size]),
        }
        for name, values in arrays.items():
            root.create_dataset(name, data=values)
        large = {
            "Points": mesh.points, "Connectivity": mesh.cells.ravel(), "Offsets": np.arange(0, mesh.cells.size + 1, 4),
            "Types": np.full(len(mesh.cells), 10, np.uint8), "PointData/p": mesh.p, "PointData/u": mesh.u, "CellData/q": mesh.q,
        }
        for name, values in large.items():
            chunks = (min(1 << 16, len(values)),) + values.shape[1:] if options else None
            root.create_dataset(name, data=values, chunks=chunks, **options)


def exodus(mesh, path, form):
    with netCDF4.Dataset(path, "w", format=form) as file:
        file.title, file.api_version, file.version, file.floating_point_word_size = "", np.float32(8.03), np.float32(8.03), 8
        sizes = dict(
            len_string=33, len_name=33, four=4, time_step=None, num_dim=3, num_nodes=len(mesh.points), num_elem=len(mesh.cells),
            num_el_blk=1, num_el_in_blk1=len(mesh.cells), num_nod_per_el1=4, num_nod_var=4, num_elem_var=1,
        )
        for name, size in sizes.items():
            file.createDimension(name, size)
        file.createVariable("time_whole", "f8", ("time_step",))[:] = [0.0]
        file.createVariable("eb_status", "i4", ("num_el_blk",))[:] = [1]
        ids = file.createVariable("eb_prop1", "i4", ("num_el_blk",))
        ids.setncattr("name", "ID")
        ids[:] = [1]
        for axis, name in enumerate("xyz"):
            file.createVariable(f"coord{name}", "f8", ("num_nodes",))[:] = mesh.points[:, axis]
        connect = file.createVariable("connect1", "i4", ("num_el_in_blk1", "num_nod_per_el1"))
        connect.elem_type = "TETRA"
        connect[:] = mesh.cells + 1
        for kind, names in [("nod", ["p", "u_x", "u_y", "u_z"]), ("elem", ["q"])]:
            variable = file.createVariable(f"name_{kind}_var", "S1", (f"num_{kind}_var", "len_name"))
            variable[:] = np.array([list(name.ljust(33, "\0")) for name in names], "S1")
        for number, values in enumerate([mesh.p, *mesh.u.T], 1):
            file.createVariable(f"vals_nod_var{number}", "f8", ("time_step", "num_nodes"))[0] = values
        file.createVariable("vals_elem_var1eb1", "f8", ("time_step", "num_el_in_blk1"))[0] = mesh.q


def by_meshio(mesh, path, arrays=True, **options):
    points, cells = dict(p=mesh.p, u=mesh.u), dict(q=[mesh.q])
    if not arrays:
        points, cells = {}, {}
    meshio.Mesh(mesh.points, [("tetra", mesh.cells)], points, cells).write(path, **options)


def tecplot(mesh, path):
    points = dict(p=mesh.p, **{f"u_{axis}": mesh.u[:, i] for i, axis in enumerate("xyz")})
    meshio.Mesh(mesh.points, [("tetra", mesh.cells)], points, dict(q=[mesh.q])).write(path, file_format="tecplot")


def ucd(mesh, path):
    meshio.Mesh(mesh.points, [("tetra", mesh.cells)], dict(p=mesh.p), dict(q=[mesh.q])).write(path, file_format="avsucd")


def cgns(mesh, path):
    """After the SIDS and their mapping to HDF5: a group for each node, its value in the array ' data'."""

    def node(parent, name, label, value=None):
        group = parent.create_group(name)
        kind = "MT"
        if value is not None:
            kind = {"i4": "I4", "i8": "I8", "f8": "R8", "i1": "C1"}[value.dtype.str[1:]]
            group.create_dataset(" data", data=value)
        for key, text, size in [("name", name, 33), ("label", label, 33), ("type", kind, 3)]:
            group.attrs.create(key, np.bytes_(text), dtype=f"S{size}")
        group.attrs["flags"] = np.array([1], np.int32)
        return group

    text = lambda word: np.frombuffer(word.encode(), np.int8)
    with h5py.File(path, "w") as file:
        for key, word, size in [("name", "HDF5 MotherNode", 33), ("label", "Root Node of HDF5 File", 33), ("type", "MT", 3)]:
            file.attrs.create(key, np.bytes_(word), dtype=f"S{size}")
        file.create_dataset(" format", data=text("IEEE_LITTLE_32\0"))
        file.create_dataset(" hdf5version", data=np.frombuffer(b"HDF5 Version 1.10".ljust(33, b"\0"), np.int8))
        node(file, "CGNSLibraryVersion", "CGNSLibraryVersion_t", np.array([3.4], np.float32).astype("f8"))
        base = node(file, "Base", "CGNSBase_t", np.array([3, 3], np.int32))
        zone = node(base, "Zone", "Zone_t", np.array([[len(mesh.points)], [len(mesh.cells)], [0]], np.int64))
        node(zone, "ZoneType", "ZoneType_t", text("Unstructured"))
        coordinates = node(zone, "GridCoordinates", "GridCoordinates_t")
        for axis, name in enumerate("XYZ"):
            node(coordinates, f"Coordinate{name}", "DataArray_t", np.ascontiguousarray(mesh.points[:, axis]))
        elements = node(zone, "Tetrahedra", "Elements_t", np.array([10, 0], np.int32))
        node(elements, "ElementRange", "IndexRange_t", np.array([1, len(mesh.cells)], np.int64))
        node(elements, "ElementConnectivity", "DataArray_t", mesh.cells.ravel() + 1)
        for place, arrays in [("Vertex", dict(p=mesh.p, uX=mesh.u[:, 0], uY=mesh.u[:, 1], uZ=mesh.u[:, 2])), ("CellCenter", dict(q=mesh.q))]:
            solution = node(zone, f"{place}Solution", "FlowSolution_t")
            node(solution, "GridLocation", "GridLocation_t", text(place))
            for name, values in arrays.items():
                node(solution, name, "DataArray_t", np.ascontiguousarray(values))


def ensight(mesh, path, binary):
    stem = path.stem
    path.write_text(
        f"FORMAT\ntype: ensight gold\n\nGEOMETRY\nmodel: {stem}.geo\n\nVARIABLE\n"
        f"scalar per node: p {stem}.p\nvector per node: u {stem}.u\nscalar per element: q {stem}.q\n"
    )

    def part(ending, head, blocks):
        with open(path.with_suffix(ending), "wb") as file:
            def line(word):
                file.write(word.encode().ljust(80) if binary else f"{word}\n".encode())

            for word in (["C Binary"] if binary and ending == ".geo" else []) + head:
                line(word)
            for block in blocks:
                if isinstance(block, str):
                    line(block)
                elif binary:
                    file.write(block.astype("i4" if block.dtype.kind == "i" else "f4").tobytes())
                else:
                    np.savetxt(file, block, "%10d" if block.dtype.kind == "i" else "%12.5e", delimiter="")

    one = np.array([[1]])
    count = lambda items: np.array([[len(items)]])
    part(".geo", ["a", "b", "node id off", "element id off"], [
        "part", one, "grid", "coordinates", count(mesh.points), mesh.points.T.reshape(-1, 1),
        "tetra4", count(mesh.cells), mesh.cells + 1,
    ])
    part(".p", ["p"], ["part", one, "coordinates", mesh.p.reshape(-1, 1)])
    part(".u", ["u"], ["part", one, "coordinates", mesh.u.T.reshape(-1, 1)])
    part(".q", ["q"], ["part", one, "tetra4", mesh.q.reshape(-1, 1)])


def openfoam(mesh, path, binary):
    """Faces between cells first, in the order of the cells on their sides, then those of the boundary."""
    corners = mesh.cells[:, [[1, 2, 3], [0, 3, 2], [0, 1, 3], [0, 2, 1]]].reshape(-1, 3)
    cell = np.repeat(np.arange(len(mesh.cells)), 4)
    key = np.sort(corners, axis=1)
    order = np.lexsort((cell, key[:, 2], key[:, 1], key[:, 0]))
    key, corners, cell = key[order], corners[order], cell[order]
    is_first = np.ones(len(key), bool)
    is_first[1:] = np.any(key[1:] != key[:-1], axis=1)
    first = np.flatnonzero(is_first)
    is_inner = np.append(np.diff(first), len(key) - first[-1]) == 2
    owner, faces = cell[first], corners[first]
    neighbour = np.where(is_inner, cell[np.minimum(first + 1, len(cell) - 1)], -1)
    # A lower cell first; the stable sort above had them ascending.
    order = np.lexsort((neighbour, owner, ~is_inner))
    owner, neighbour, faces = owner[order], neighbour[order], faces[order]
    inner = int(is_inner.sum())
    shutil.rmtree(path, ignore_errors=True)
    folder = path / "constant/polyMesh"
    folder.mkdir(parents=True)
    (path / "0").mkdir()
    (path / "system").mkdir()

    def write(where, name, kind, body, note=""):
        form = "binary" if binary else "ascii"
        head = f'FoamFile\n{{\n    version 2.0;\n    format {form};\n    arch "LSB;label=32;scalar=64";\n    class {kind};\n{note}    object {name};\n}}\n\n'
        with open(where / name, "wb") as file:
            file.write(head.encode())
            for piece in body:
                file.write(piece if isinstance(piece, bytes) else piece.encode())

    def numbers(values, form):
        rows = len(values)
        if binary:
            return [f"{rows}\n(", values.astype("i4" if values.dtype.kind in "iu" else "f8").tobytes(), ")\n"]
        lines = "\n".join([form] * rows) % tuple(values.ravel().tolist())
        return [f"{rows}\n(\n", lines, "\n)\n"]

    note = f'    note "nPoints:{len(mesh.points)}  nCells:{len(mesh.cells)}  nFaces:{len(faces)}  nInternalFaces:{inner}";\n'
    write(folder, "points", "vectorField", numbers(mesh.points, "(%.12g %.12g %.12g)"))
    if binary:
        ends = np.arange(0, 3 * len(faces) + 1, 3)
        write(folder, "faces", "faceCompactList", numbers(ends, "") + numbers(faces.ravel(), ""))
    else:
        write(folder, "faces", "faceList", numbers(faces, "3(%d %d %d)"))
    write(folder, "owner", "labelList", numbers(owner, "%d"), note)
    write(folder, "neighbour", "labelList", numbers(neighbour[:inner], "%d"), note)
    outside = f"1\n(\n    walls\n    {{\n        type wall;\n        nFaces {len(faces) - inner};\n        startFace {inner};\n    }}\n)\n"
    write(folder, "boundary", "polyBoundaryMesh", [outside])
    means = mesh.u[mesh.cells].mean(axis=1)
    for name, kind, values, form in [("q", "Scalar", mesh.q, "%.12g"), ("U", "Vector", means, "(%.12g %.12g %.12g)")]:
        body = ["dimensions [0 0 0 0 0 0 0];\n", f"internalField nonuniform List<{kind.lower()}>\n", *numbers(values, form)]
        body.append(";\nboundaryField\n{\n    walls\n    {\n        type zeroGradient;\n    }\n}\n")
        write(path / "0", name, f"vol{kind}Field", body)
    (path / "system/controlDict").write_text("FoamFile\n{\n    version 2.0;\n    format ascii;\n    class dictionary;\n    object controlDict;\n}\nstartTime 0;\n")
    (path / "case.foam").touch()


# Name, writer, the file's name, the array that is read.
FILES = {
    "vtu raw": (lambda m, p: vtu(m, p, "raw"), "raw.vtu", "p"),
    "vtu zlib": (lambda m, p: vtu(m, p, "raw", "zlib"), "zlib.vtu", "p"),
    "vtu lz4": (lambda m, p: vtu(m, p, "raw", "lz4"), "lz4.vtu", "p"),
    "vtu lzma": (lambda m, p: vtu(m, p, "raw", "lzma"), "lzma.vtu", "p"),
    "vtu base64": (lambda m, p: vtu(m, p, "base64"), "base64.vtu", "p"),
    "vtu text": (lambda m, p: vtu(m, p, "ascii"), "ascii.vtu", "p"),
    "vtk binary": (lambda m, p: legacy(m, p, True), "binary.vtk", "p"),
    "vtk text": (lambda m, p: legacy(m, p, False), "ascii.vtk", "p"),
    "vtkhdf": (lambda m, p: vtkhdf(m, p), "plain.vtkhdf", "p"),
    "vtkhdf gzip": (lambda m, p: vtkhdf(m, p, compression="gzip", compression_opts=4), "gzip.vtkhdf", "p"),
    "Exodus netCDF-3": (lambda m, p: exodus(m, p, "NETCDF3_64BIT_OFFSET"), "netcdf3.e", "p"),
    "Exodus netCDF-4": (lambda m, p: exodus(m, p, "NETCDF4"), "netcdf4.e", "p"),
    "CGNS": (cgns, "plain.cgns", "p"),
    "XDMF, HDF5 gzip": (lambda m, p: by_meshio(m, p), "gzip.xdmf", "p"),
    "Gmsh 4.1 binary": (lambda m, p: by_meshio(m, p, file_format="gmsh", binary=True), "gmsh41b.msh", "p"),
    "Gmsh 4.1 text": (lambda m, p: by_meshio(m, p, file_format="gmsh", binary=False), "gmsh41a.msh", "p"),
    "Gmsh 2.2 binary": (lambda m, p: by_meshio(m, p, file_format="gmsh22", binary=True), "gmsh22b.msh", "p"),
    "Gmsh 2.2 text": (lambda m, p: by_meshio(m, p, file_format="gmsh22", binary=False), "gmsh22a.msh", "p"),
    "OpenFOAM binary": (lambda m, p: openfoam(m, p, True), "foam_binary", "cell:q"),
    "OpenFOAM text": (lambda m, p: openfoam(m, p, False), "foam_ascii", "cell:q"),
    "EnSight binary": (lambda m, p: ensight(m, p, True), "binary.case", "p"),
    "EnSight text": (lambda m, p: ensight(m, p, False), "ascii.case", "p"),
    "Tecplot text": (tecplot, "text.dat", "p"),
    "UCD": (ucd, "text.ucd", "p"),
    "Abaqus": (lambda m, p: by_meshio(m, p, False, file_format="abaqus"), "mesh.inp", "-"),
    "SU2": (lambda m, p: by_meshio(m, p, False, file_format="su2"), "mesh.su2", "-"),
    "Nastran": (lambda m, p: by_meshio(m, p, False, file_format="nastran"), "mesh.bdf", "-"),
}


def write(folder, side, names):
    """Writes the files that are not there, and returns their paths and arrays by name."""
    folder.mkdir(parents=True, exist_ok=True)
    mesh = None
    paths = {}
    for name in names:
        writer, file, array = FILES[name]
        path = folder / f"{side}" / file
        paths[name] = (path, array)
        if not path.exists():
            path.parent.mkdir(exist_ok=True)
            mesh = mesh or Mesh(side)
            print(f"writing {path}", flush=True)
            writer(mesh, path)
    return paths


if __name__ == "__main__":
    import sys
    write(Path(sys.argv[1]), int(sys.argv[2]), sys.argv[3:] or FILES)
