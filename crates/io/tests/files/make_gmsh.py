"""Writes the meshes of this folder that end in .msh, with the Gmsh SDK and with meshio (pip install gmsh meshio); meshio.vtu is the
same mesh as meshio_2.msh.

Elements of every type that is read, each the affine image of Gmsh's own reference element, at a place of its own; the field
f = x² - x y + 2 y z + z - 0.5 at the nodes, by element (at the mean of its nodes) and by element and node (f + number of the
element); time steps 0, 1.5 and 4 of f (1 + t). Nodes and elements have gaps in their numbers, which are large.
"""

import sys

import gmsh
import meshio
import numpy as np

VOLUMES = [4, 5, 6, 7, 11, 12, 13, 14, 17, 18, 19, 29]
LINEAR = [4, 5, 6, 7]
AFFINE = np.array([[1.0, 0.2, 0.1], [0.0, 0.9, 0.3], [0.1, 0.0, 1.1]])


def field(p):
    x, y, z = p.T
    return x**2 - x * y + 2 * y * z + z - 0.5


def mesh(kinds, groups):
    """One element of each kind, each in an entity; `groups`: name and places in `kinds` of the physical groups."""
    gmsh.clear()
    gmsh.model.add("elements")
    elements, nodes = [], {}
    node_tag, element_tag = 1_000_000, 70_000_000
    surface = gmsh.model.addDiscreteEntity(2)
    for place, kind in enumerate(kinds):
        local = np.array(gmsh.model.mesh.getElementProperties(kind)[4]).reshape(-1, 3)
        points = local @ AFFINE.T + [4.0 * (place % 4), 4.0 * (place // 4), 0.25]
        entity = gmsh.model.addDiscreteEntity(3)
        tags = [node_tag + 3 * i for i in range(len(points))][::-1]
        node_tag += 3 * len(points) + 11
        gmsh.model.mesh.addNodes(3, entity, tags, points.flatten())
        gmsh.model.mesh.addElementsByType(entity, kind, [element_tag], tags)
        gmsh.model.mesh.addElementsByType(surface, 2, [element_tag + 1], tags[:3])
        nodes.update(zip(tags, points))
        elements.append((element_tag, tags))
        element_tag -= 7
    gmsh.model.addPhysicalGroup(2, [surface], 7, "wall")
    for number, (name, places) in enumerate(groups):
        gmsh.model.addPhysicalGroup(3, [place + 1 for place in places], 30 - number, name)
    return elements, nodes


def write(path, elements, nodes, version, binary):
    gmsh.option.setNumber("Mesh.MshFileVersion", version)
    gmsh.option.setNumber("Mesh.Binary", binary)
    gmsh.option.setNumber("PostProcessing.SaveMesh", 0)
    gmsh.write(path)
    tags = sorted(nodes)
    points = np.array([nodes[tag] for tag in tags])
    own = {tag: np.array([nodes[node] for node in of]) for tag, of in elements}
    by_element = [tag for tag, _ in elements]

    def view(name, kind, tags, values, time=0.0, step=0, components=1):
        number = gmsh.view.add(name)
        gmsh.view.addModelData(number, step, "elements", kind, tags, values, time, components)
        gmsh.view.write(number, path, append=True)

    view("f", "NodeData", tags, field(points)[:, None])
    if len(elements) == len(LINEAR):
        view("position", "NodeData", tags, points, components=3)
    view("mean f", "ElementData", by_element, [[field(own[tag].mean(0)[None])[0]] for tag in by_element])
    jumps = [field(own[tag]) + number for number, tag in enumerate(by_element)]
    view("jumps", "ElementNodeData", by_element, jumps)
    if len(elements) != len(LINEAR):
        return
    number = gmsh.view.add("transient")
    for step, time in enumerate([0.0, 1.5, 4.0]):
        gmsh.view.addModelData(number, step, "elements", "NodeData", tags, field(points)[:, None] * (1 + time), time)
    gmsh.view.write(number, path, append=True)


gmsh.initialize()
gmsh.option.setNumber("General.Terminal", 0)
gmsh.option.setNumber("PostProcessing.SaveInterpolationMatrices", 0)
folder = sys.argv[1] if len(sys.argv) > 1 else "."
every = mesh(VOLUMES, [("fluid", [0, 1, 4, 5]), ("solid", [2, 3, 6, 7, 8, 9, 10, 11])])
write(f"{folder}/every_element_4.msh", *every, 4.1, 1)
write(f"{folder}/every_element_2.msh", *every, 2.2, 1)
linear = mesh(LINEAR, [("fluid", [1, 2]), ("solid part", [0, 3])])
write(f"{folder}/linear_4.msh", *linear, 4.1, 0)
write(f"{folder}/linear_2.msh", *linear, 2.2, 0)

# Elements with nodes in VTK's order: the corners of the reference element, then pairs whose means are further nodes.
TRIANGLE = [[0, 0, 0], [1, 0, 0], [0, 1, 0]]
SQUARE = [[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]]
UP = np.array([0, 0, 1])
RING = [(0, 1), (1, 2), (2, 3), (3, 0)]
KINDS = [
    ("tetra", TRIANGLE + [[0, 0, 1]], []),
    ("hexahedron", SQUARE + [list(UP + p) for p in SQUARE], []),
    ("wedge", TRIANGLE + [list(UP + p) for p in TRIANGLE], []),
    ("pyramid", SQUARE + [[0, 0, 1]], []),
    ("tetra10", TRIANGLE + [[0, 0, 1]], [(0, 1), (1, 2), (2, 0), (0, 3), (1, 3), (2, 3)]),
    (
        "hexahedron20",
        SQUARE + [list(UP + p) for p in SQUARE],
        RING + [(a + 4, b + 4) for a, b in RING] + [(a, a + 4) for a in range(4)],
    ),
]
points, cells = [], []
for place, (kind, corners, pairs) in enumerate(KINDS):
    corners = np.array(corners, float) @ AFFINE.T + [3.0 * place, 0.5, 0]
    own = np.vstack([corners, *[corners[list(pair)].mean(0)[None] for pair in pairs]])
    cells.append((kind, [list(range(len(points), len(points) + len(own)))]))
    points += list(own)
points = np.array(points)
grid = meshio.Mesh(points, cells, point_data={"f": field(points)}, cell_data={"g": [[float(i)] for i in range(len(cells))]})
meshio.write(f"{folder}/meshio.vtu", grid)
meshio.write(f"{folder}/meshio_2.msh", grid, "gmsh22", binary=True)
