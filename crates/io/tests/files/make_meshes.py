"""Writes mesh.* with meshio (pip install meshio): the same mesh as UCD, SU2, Abaqus, Nastran, Tecplot and .vtu; the field
f = x² - x y + 2 y z + z - 0.5 at the nodes and the number g of each cell where the format has arrays."""

import sys

import meshio
import numpy as np

AFFINE = np.array([[1.0, 0.2, 0.1], [0.0, 0.9, 0.3], [0.1, 0.0, 1.1]])
# The corners of the element, then pairs whose means are further nodes.
TRIANGLE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
UP = np.array([0, 0, 1])
RING = [(0, 1), (1, 2), (2, 3), (3, 0)]
LINEAR = [
    ("tetra", TRIANGLE + [[0, 0, 1]], []),
    ("hexahedron", SQUARE + [list(UP + p) for p in SQUARE], []),
    ("wedge", TRIANGLE + [list(UP + p) for p in TRIANGLE], []),
    ("pyramid", SQUARE + [[0, 0, 1]], []),
]
QUADRATIC = [
    ("tetra10", TRIANGLE + [[0, 0, 1]], [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]),
    (
        "hexahedron20",
        SQUARE + [list(UP + p) for p in SQUARE],
        RING + [(a + 4, b + 4) for a, b in RING] + [(a, a + 4) for a in range(4)],
    ),
]


def mesh(kinds):
    points, cells = [], []
    for place, (kind, corners, pairs) in enumerate(kinds):
        corners = np.array(corners, float) @ AFFINE.T + [3.0 * place, 0.5, 0]
        own = np.vstack([corners, *[corners[list(pair)].mean(0)[None] for pair in pairs]])
        cells.append((kind, [list(range(len(points), len(points) + len(own)))]))
        points += list(own)
    points = np.array(points)
    x, y, z = points.T
    f = x**2 - x * y + 2 * y * z + z - 0.5
    return meshio.Mesh(points, cells, {"f": f}, {"g": [[float(i)] for i in range(len(cells))]})


folder = sys.argv[1] if len(sys.argv) > 1 else "."
linear, quadratic = mesh(LINEAR), mesh(LINEAR + QUADRATIC)
meshio.write(f"{folder}/linear.vtu", linear)
meshio.write(f"{folder}/quadratic.vtu", quadratic)
bare = lambda mesh: meshio.Mesh(mesh.points, mesh.cells)
meshio.write(f"{folder}/mesh.ucd", linear, "avsucd")
meshio.write(f"{folder}/mesh.su2", bare(linear))
meshio.write(f"{folder}/mesh.bdf", bare(quadratic))
# meshio writes no pyramids for Abaqus.
without = [block for block in quadratic.cells if block.type != "pyramid"]
meshio.write(f"{folder}/mesh.inp", meshio.Mesh(quadratic.points, without), "abaqus")
meshio.write(f"{folder}/mesh.dat", meshio.Mesh(linear.points, linear.cells[:2], linear.point_data), "tecplot")
