"""Computes heat_sink.vtu: steady heat conduction in an electronic assembly under a pin-fin heat sink.

A processor and a voltage regulator sit on a circuit board; each gives its heat through a thermal pad to an aluminium
heat sink with round pins and two embedded heat pipes, and a little of it to the board. Every outer face is cooled by
convection. Solved with quadratic tetrahedra; the temperatures at their vertices are written as a linear grid.

    -div(k grad T) = q  in the parts,      -k dT/dn = h (T - T_air)  on the outer faces

Units: mm, W, K (temperatures in degrees Celsius). Hence k in W/(mm K), h in W/(mm^2 K), q in W/mm^3.

    python -m venv venv && venv/bin/pip install -r requirements.txt
    venv/bin/python heat_sink.py            # writes heat_sink.vtu beside this script

gmsh also needs the system's X11 and OpenGL libraries, although it opens no window (Debian: libglu1-mesa libxft2
libxcursor1 libxinerama1).
"""

import struct
import zlib
from pathlib import Path

import gmsh
import numpy as np
import skfem
from scipy.sparse import diags
from scipy.sparse.csgraph import reverse_cuthill_mckee
from scipy.sparse.linalg import cg
from skfem.helpers import dot, grad

T_AIR = 25.0  # degrees Celsius
H_SINK = 80e-6  # forced air on heat sink and components, W/(mm^2 K)
H_BOARD = 15e-6  # board, W/(mm^2 K)

# name: conductivity W/(mm K), mesh size mm, heat W (spread evenly over the part)
PARTS = {
    "board": (1.0e-3, 2.2, 0.0),  # glass-fibre laminate with copper layers
    "processor": (0.10, 0.9, 42.0),  # silicon and package lid
    "regulator": (0.10, 0.9, 9.0),
    "pad": (5.0e-3, 0.34, 0.0),  # gap-filling thermal pad
    "base": (0.10, 1.6, 0.0),  # die-cast aluminium
    "pipe": (50.0, 0.65, 0.0),  # heat pipe: its vapour core as a solid of very high conductivity
    "pin": (0.10, 1.05, 0.0),
}

# Heights (z) at which the layers meet, mm: board, component, pad, base, tips of the pins.
Z_BOARD, Z_PART, Z_PAD, Z_BASE, Z_TOP, Z_TIP = -1.6, 0.0, 2.4, 3.4, 9.4, 29.4
PIPE_RADIUS, PIN_RADIUS = 1.9, 1.6
CHIPS = {"processor": (-14.0, 3.0, 14.0), "regulator": (17.0, -9.0, 8.0)}  # centre x, y and side
BASE = (-31.0, -23.0, 62.0, 46.0)  # x, y, extent
BOARD = (-36.0, -28.0, 72.0, 56.0)


def build_mesh():
    """Returns points (n, 3), tetrahedra (m, 4) and the part of each tetrahedron (index into PARTS)."""
    gmsh.initialize()
    gmsh.option.setNumber("General.Verbosity", 2)
    gmsh.option.setNumber("General.NumThreads", 1)  # one thread: the same mesh each time
    gmsh.option.setNumber("Mesh.RandomSeed", 1)
    cad = gmsh.model.occ
    solids = []  # (part, tag)

    x, y, lx, ly = BOARD
    solids.append(("board", cad.addBox(x, y, Z_BOARD, lx, ly, Z_PART - Z_BOARD)))
    for name, (cx, cy, side) in CHIPS.items():
        corner = (cx - side / 2, cy - side / 2)
        solids.append((name, cad.addBox(*corner, Z_PART, side, side, Z_PAD - Z_PART)))
        solids.append(("pad", cad.addBox(*corner, Z_PAD, side, side, Z_BASE - Z_PAD)))
    x, y, lx, ly = BASE
    solids.append(("base", cad.addBox(x, y, Z_BASE, lx, ly, Z_TOP - Z_BASE)))
    for sign in (1, -1):
        solids.append(("pipe", add_pipe(cad, sign)))
    columns, rows = 9, 7
    for i in range(columns):
        for j in range(rows):
            px = BASE[0] + BASE[2] * (i + 0.5) / columns
            py = BASE[1] + BASE[3] * (j + 0.5) / rows
            solids.append(("pin", cad.addCylinder(px, py, Z_TOP, 0, 0, Z_TIP - Z_TOP, PIN_RADIUS)))

    tags = [(3, tag) for _, tag in solids]
    _, pieces = cad.fragment(tags, [])
    cad.synchronize()
    # A later solid owns what it shares with an earlier one: the pipes are cut out of the base.
    part_of_volume = {}
    names = list(PARTS)
    for (part, _), made in zip(solids, pieces):
        for _, volume in made:
            part_of_volume[volume] = names.index(part)

    set_mesh_size(part_of_volume)
    gmsh.option.setNumber("Mesh.Algorithm3D", 1)  # Delaunay
    gmsh.option.setNumber("Mesh.Optimize", 1)
    gmsh.option.setNumber("Mesh.OptimizeNetgen", 1)
    gmsh.model.mesh.generate(3)

    node_tags, coordinates, _ = gmsh.model.mesh.getNodes()
    number = np.zeros(int(node_tags.max()) + 1, dtype=np.int64)
    number[node_tags.astype(np.int64)] = np.arange(len(node_tags))
    tetrahedra, parts = [], []
    for volume, part in sorted(part_of_volume.items()):
        _, nodes = gmsh.model.mesh.getElementsByType(4, volume)
        tetrahedra.append(number[nodes.astype(np.int64)].reshape(-1, 4))
        parts.append(np.full(len(tetrahedra[-1]), part))
    gmsh.finalize()
    return tidy(coordinates.reshape(-1, 3), np.concatenate(tetrahedra), np.concatenate(parts))


def add_pipe(cad, sign):
    """A heat pipe inside the base: straight over the processor, then bent outwards to the cool end."""
    z = 0.5 * (Z_BASE + Z_TOP)
    y0 = CHIPS["processor"][1]
    bend = 12.0
    near, far = y0 + sign * 4.0, y0 + sign * 4.0 + sign * bend * 2 * (1 - np.cos(np.radians(40)))
    start, turn = -25.0, -1.0
    dx = bend * np.sin(np.radians(40))
    end = 28.0
    points = [(start, near), (turn, near), (turn + dx, 0.5 * (near + far)), (turn + 2 * dx, far), (end, far)]
    c1, c2 = (turn, near + sign * bend), (turn + 2 * dx, far - sign * bend)
    p = [cad.addPoint(px, py, z) for px, py in points]
    centre = [cad.addPoint(*c, z) for c in (c1, c2)]
    wire = cad.addWire([
        cad.addLine(p[0], p[1]),
        cad.addCircleArc(p[1], centre[0], p[2]),
        cad.addCircleArc(p[2], centre[1], p[3]),
        cad.addLine(p[3], p[4]),
    ])
    disk = cad.addDisk(start, near, z, PIPE_RADIUS, PIPE_RADIUS, zAxis=[1, 0, 0], xAxis=[0, 0, 1])
    swept = cad.addPipe([(2, disk)], wire, "Frenet")
    cad.remove([(2, disk)], recursive=True)
    cad.remove([(1, wire)], recursive=True)
    return next(tag for dim, tag in swept if dim == 3)


def set_mesh_size(part_of_volume):
    """A size per part, and small cells in the board round the components, where the temperature falls steeply."""
    field = gmsh.model.mesh.field
    names = list(PARTS)
    fields = []
    for index, name in enumerate(names):
        volumes = [v for v, part in part_of_volume.items() if part == index]
        one = field.add("Constant")
        field.setNumbers(one, "VolumesList", volumes)
        field.setNumber(one, "VIn", PARTS[name][1])
        field.setNumber(one, "VOut", 10.0)
        fields.append(one)
    for cx, cy, side in CHIPS.values():
        r, w = side / 2, 0.4
        boxes = [  # x, y, z limits and size: under the component, over its pad, along its four lower edges
            ((cx - r, cx + r), (cy - r, cy + r), (Z_BOARD, Z_PART), 0.8),
            ((cx - r, cx + r), (cy - r, cy + r), (Z_BASE, Z_BASE + 1.5), 0.8),
        ]
        for side_sign in (-1, 1):
            ex, ey = cx + side_sign * r, cy + side_sign * r
            boxes.append(((ex - w, ex + w), (cy - r - w, cy + r + w), (Z_PART - 0.8, Z_PART), 0.4))
            boxes.append(((cx - r - w, cx + r + w), (ey - w, ey + w), (Z_PART - 0.8, Z_PART), 0.4))
        for *limits, size in boxes:
            box = field.add("Box")
            for axis, (low, high) in zip("XYZ", limits):
                field.setNumber(box, axis + "Min", low)
                field.setNumber(box, axis + "Max", high)
            for key, value in (("VIn", size), ("VOut", 10.0), ("Thickness", 45.0)):
                field.setNumber(box, key, value)
            fields.append(box)
    smallest = field.add("Min")
    field.setNumbers(smallest, "FieldsList", fields)
    field.setAsBackgroundMesh(smallest)
    for option in ("MeshSizeExtendFromBoundary", "MeshSizeFromPoints", "MeshSizeFromCurvature"):
        gmsh.option.setNumber("Mesh." + option, 0)


def tidy(points, tetrahedra, parts):
    """Drops unused points, numbers neighbours close to each other, sorts the cells: the file compresses better."""
    used = np.unique(tetrahedra)
    points, tetrahedra = points[used], np.searchsorted(used, tetrahedra)
    # Steps of 1/4096 mm: far below any tolerance, exact in 32-bit floats, and the file is a third smaller.
    points = np.round(points * 4096) / 4096
    mesh = skfem.MeshTet(np.ascontiguousarray(points.T), np.ascontiguousarray(tetrahedra.T))
    basis = skfem.Basis(mesh, skfem.ElementTetP1(), intorder=1)
    graph = skfem.BilinearForm(lambda u, v, w: u * v).assemble(basis).tocsr()
    order = reverse_cuthill_mckee(graph, symmetric_mode=True)
    new_number = np.empty_like(order)
    new_number[order] = np.arange(len(order))
    tetrahedra = new_number[tetrahedra]
    # Lowest number first keeps the orientation when the other three are turned, not swapped.
    for i in range(len(tetrahedra)):
        a = tetrahedra[i]
        j = int(np.argmin(a))
        even = [(0, 1, 2, 3), (1, 0, 3, 2), (2, 3, 0, 1), (3, 2, 1, 0)][j]
        tetrahedra[i] = a[list(even)]
    sequence = np.lexsort((tetrahedra[:, 3], tetrahedra[:, 2], tetrahedra[:, 1], tetrahedra[:, 0]))
    return points[order], tetrahedra[sequence], parts[sequence]


def solve(points, tetrahedra, parts, element):
    """Returns the temperature at the mesh points, and the heat in and out in W."""
    mesh = skfem.MeshTet(np.ascontiguousarray(points.T), np.ascontiguousarray(tetrahedra.T), validate=False)
    volume = np.abs(np.linalg.det(points[tetrahedra[:, 1:]] - points[tetrahedra[:, :1]])) / 6
    names = list(PARTS)
    conductivity = np.array([PARTS[name][0] for name in names])[parts]
    source = np.zeros(len(parts))
    for name, (_, _, watts) in PARTS.items():
        mine = parts == names.index(name)
        source[mine] = watts / volume[mine].sum()

    cells = skfem.Basis(mesh, element)
    faces = skfem.FacetBasis(mesh, element)
    constant = skfem.Basis(mesh, skfem.ElementTetP0(), quadrature=cells.quadrature)
    k, q = constant.interpolate(conductivity), constant.interpolate(source)

    def film(w):
        return np.where(w.x[2] <= Z_PART + 1e-6, H_BOARD, H_SINK)

    conduction = skfem.BilinearForm(lambda u, v, w: w.k * dot(grad(u), grad(v))).assemble(cells, k=k)
    convection = skfem.BilinearForm(lambda u, v, w: film(w) * u * v).assemble(faces)
    # Unknown: the rise above the air's temperature.
    load = skfem.LinearForm(lambda v, w: w.q * v).assemble(cells, q=q)
    matrix = (conduction + convection).tocsr()
    jacobi = diags(1.0 / matrix.diagonal())
    rise, failed = cg(matrix, load, rtol=1e-12, maxiter=20000, M=jacobi)
    if failed:
        raise RuntimeError("the linear solver did not converge")
    at_points = T_AIR + rise[cells.nodal_dofs[0]]
    return at_points, load.sum(), convection.dot(rise).sum()


def write_vtu(path, points, tetrahedra, temperature, parts):
    """XML unstructured grid: raw appended data, zlib, little-endian, UInt32 header."""
    cell_count = len(tetrahedra)
    arrays = [
        ("PointData", "Temperature", 1, temperature.astype("<f4")),
        ("CellData", "part", 1, parts.astype("u1")),
        ("Points", "Points", 3, points.astype("<f4")),
        ("Cells", "connectivity", 1, tetrahedra.astype("<i4")),
        ("Cells", "offsets", 1, (4 * np.arange(1, cell_count + 1)).astype("<i4")),
        ("Cells", "types", 1, np.full(cell_count, 10, dtype="u1")),
    ]
    type_name = {"f4": "Float32", "i4": "Int32", "u1": "UInt8"}
    block = 32768
    appended, xml = b"", []
    for section in ("PointData", "CellData", "Points", "Cells"):
        scalars = ' Scalars="Temperature"' if section == "PointData" else ""
        xml.append(f"      <{section}{scalars}>")
        for where, name, components, values in arrays:
            if where != section:
                continue
            raw = values.tobytes()
            blocks = [zlib.compress(raw[i : i + block], 9) for i in range(0, len(raw), block)]
            last = len(raw) % block
            sizes = [len(b) for b in blocks]
            kind = type_name[values.dtype.str[-2:]]
            tuples = "" if components == 1 else f' NumberOfComponents="{components}"'
            xml.append(
                f'        <DataArray type="{kind}" Name="{name}"{tuples} format="appended" offset="{len(appended)}"/>'
            )
            appended += struct.pack(f"<{3 + len(sizes)}I", len(blocks), block, last, *sizes) + b"".join(blocks)
        xml.append(f"      </{section}>")
    head = (
        '<?xml version="1.0"?>\n<VTKFile type="UnstructuredGrid" version="1.0" byte_order="LittleEndian" '
        'header_type="UInt32" compressor="vtkZLibDataCompressor">\n  <UnstructuredGrid>\n'
        f'    <Piece NumberOfPoints="{len(points)}" NumberOfCells="{cell_count}">\n'
    )
    tail = '\n    </Piece>\n  </UnstructuredGrid>\n  <AppendedData encoding="raw">\n   _'
    path.write_bytes((head + "\n".join(xml) + tail).encode() + appended + b"\n  </AppendedData>\n</VTKFile>\n")


def main():
    points, tetrahedra, parts = build_mesh()
    linear, *_ = solve(points, tetrahedra, parts, skfem.ElementTetP1())
    temperature, heat_in, heat_out = solve(points, tetrahedra, parts, skfem.ElementTetP2())
    difference = np.abs(temperature - linear)
    temperature = np.round(temperature, 3)  # the last bits differ from machine to machine
    path = Path(__file__).with_name("heat_sink.vtu")
    write_vtu(path, points, tetrahedra, temperature, parts)
    print(f"{len(tetrahedra):,} tetrahedra, {len(points):,} points, {path.stat().st_size:,} bytes")
    print(f"heat in {heat_in:.6f} W, out by convection {heat_out:.6f} W, balance {heat_out / heat_in - 1:+.1e}")
    edges = points[tetrahedra[:, 1:]] - points[tetrahedra[:, :1]]
    differences = temperature[tetrahedra[:, 1:]] - temperature[tetrahedra[:, :1]]
    steepness = np.linalg.norm(np.linalg.solve(edges, differences[..., None])[..., 0], axis=1)
    print("part          cells  T min  T max (C)   |grad T| 5 %  median    95 % (K/mm)")
    for index, name in enumerate(PARTS):
        mine = parts == index
        t, g = temperature[tetrahedra[mine]], np.percentile(steepness[mine], (5, 50, 95))
        print(f"{name:10} {mine.sum():8,} {t.min():6.1f} {t.max():6.1f}   {g[0]:14.3f} {g[1]:8.3f} {g[2]:8.3f}")
    print(f"linear elements instead: {difference.mean():.2f} K away on average, {difference.max():.2f} K at most")


if __name__ == "__main__":
    main()
