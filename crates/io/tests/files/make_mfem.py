#!/usr/bin/env python3
"""Writes the samples in mfem/ by MFEM itself (pip install mfem, 4.10): a mesh of all solids, straight and curved, with fields of formulas."""

import sys
from pathlib import Path

import mfem.ser as mfem

OUT = Path(sys.argv[1] if len(sys.argv) > 1 else Path(__file__).parent / "mfem")


class Formula(mfem.PyCoefficient):
    def __init__(self, formula):
        super().__init__()
        self.formula = formula

    def EvalValue(self, x):
        return self.formula(*x)


class Vector(mfem.VectorPyCoefficient):
    def __init__(self, formula):
        super().__init__(3)
        self.formula = formula

    def EvalValue(self, x):
        return self.formula(*x)


def linear(x, y, z):
    return 1 + 2 * x - 3 * y + 4 * z


def quadratic(x, y, z):
    return linear(x, y, z) + x * x - y * z + z * z / 2


def bent(x, y, z):
    return [x + y * y / 8, y + z * z / 8, z + x * y / 8]


def solids():
    """A cube, prisms, pyramids and tetrahedra in a row."""
    mesh = mfem.Mesh(3, 14, 7, 0, 3)
    for z in range(2):
        for x, y in [(0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (2, 1)]:
            mesh.AddVertex(float(x), float(y), float(z))
    mesh.AddVertex(0.5, 0.5, 1.75)
    mesh.AddVertex(2.75, 0.5, 0.5)
    mesh.AddHex([0, 1, 2, 3, 6, 7, 8, 9], 3)
    mesh.AddWedge([1, 4, 2, 7, 10, 8], 1)
    mesh.AddWedge([4, 5, 2, 10, 11, 8], 1)
    mesh.AddPyramid([6, 7, 8, 9, 12], 2)
    mesh.AddTet([7, 10, 8, 12], 2)
    mesh.AddTet([10, 11, 8, 12], 2)
    mesh.AddPyramid([4, 5, 11, 10, 13], 3)
    mesh.FinalizeMesh()
    return mesh


def fields(mesh):
    """Fields of the mesh, which the coefficients keep alive."""
    made = {}
    for name, order, formula in [("linear", 1, linear), ("quadratic", 2, quadratic)]:
        collection = mfem.H1_FECollection(order, mesh.Dimension())
        space = mfem.FiniteElementSpace(mesh, collection)
        made[name] = (mfem.GridFunction(space), Formula(formula), space, collection)
    for name, ordering in [("by_nodes", mfem.Ordering.byNODES), ("by_vdim", mfem.Ordering.byVDIM)]:
        collection = mfem.H1_FECollection(2, mesh.Dimension())
        space = mfem.FiniteElementSpace(mesh, collection, 3, ordering)
        made[name] = (mfem.GridFunction(space), Vector(lambda x, y, z: [x * y, linear(x, y, z), quadratic(x, y, z)]), space, collection)
    collection = mfem.L2_FECollection(0, mesh.Dimension())
    space = mfem.FiniteElementSpace(mesh, collection)
    made["constant"] = (mfem.GridFunction(space), Formula(linear), space, collection)
    for function, coefficient, _, _ in made.values():
        function.ProjectCoefficient(coefficient)
    return made


def third(mesh, formula, pyramids):
    """A field of the third order; 0: with the functions of Bergot on pyramids, 1: with those of Fuentes."""
    own = mfem.H1_FECollection(3, mesh.Dimension(), mfem.BasisType.GaussLobatto, pyramids)
    space = mfem.FiniteElementSpace(mesh, own)
    function, coefficient = mfem.GridFunction(space), Formula(formula)
    function.ProjectCoefficient(coefficient)
    return {"third": (function, coefficient, space, own)}


def collection(name, mesh, made, time=0.25, cycle=3):
    folder = OUT / name
    folder.mkdir(parents=True, exist_ok=True)
    own = mfem.VisItDataCollection(name, mesh)
    own.SetPrefixPath(str(folder) + "/")
    own.SetPrecision(15)
    for key, (function, *_) in made.items():
        own.RegisterField(key, function)
    own.SetCycle(cycle)
    own.SetTime(time)
    own.Save()


if __name__ == "__main__":
    OUT.mkdir(parents=True, exist_ok=True)
    mesh = solids()
    collection("straight", mesh, fields(mesh))
    mesh.SetCurvature(2)
    mesh.Transform(Vector(bent))
    collection("curved", mesh, fields(mesh))
    mesh = solids()
    collection("third", mesh, third(mesh, quadratic, 1))
    mesh.SetCurvature(3)
    mesh.Transform(Vector(bent))
    collection("bent", mesh, third(mesh, linear, 0))
