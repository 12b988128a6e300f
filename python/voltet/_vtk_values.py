"""VTK filters that give numbers: gradients at the points, figures of a region."""

from __future__ import annotations

from typing import Any

import numpy as np
from vtkmodules.util.numpy_support import numpy_to_vtk
from vtkmodules.vtkCommonCore import vtkDoubleArray, vtkStringArray
from vtkmodules.vtkCommonDataModel import vtkDataObject, vtkTable

from . import _vtk_grid
from ._errors import whole
from ._pipeline import Pipeline
from ._vtk_filter import Filter, changed


class VoltetGradientMagnitude(Filter):
    """A grid in, the same grid out with the gradient magnitude of an array at its points, and the gradient where asked for.

    Arrays, points and cells of the input are shared. Names: `NAME_gradient_magnitude`, `NAME_gradient`. NaN at points of no cell of
    a volume. Partitions of a data set are one grid; blocks are grids of their own."""

    SHARES = {"grid": (0.0, 0.2), "gradient": (0.2, 1.0)}

    def __init__(self) -> None:
        self._method: dict[str, Any] = {"method": "least-squares"}
        self._vectors = False
        self._component: int | None = None
        super().__init__(1, "vtkDataSet", "vtkDataObject")

    @changed
    def SetMethod(self, method, **parameters):
        """The gradient filter, with its parameters: one that ships, or one of `voltet.gradient_filter`."""
        given = {"method": method, **parameters}
        self._method, before = given, self._method
        return repr(given) != repr(before)

    @changed
    def SetComputeGradient(self, flag):
        """Whether the vectors are added, too."""
        self._vectors, before = bool(flag), self._vectors
        return self._vectors != before

    @changed
    def SetComponent(self, component):
        """The component of an array of several. None: the magnitude."""
        component = None if component is None else whole("component", component)
        self._component, before = component, self._component
        return component != before

    def RequestDataObject(self, request, inInfo, outInfo):
        """The output is of the input's type."""
        data = self.GetInputData(inInfo, 0, 0)
        info = outInfo.GetInformationObject(0)
        former = info.Get(vtkDataObject.DATA_OBJECT())
        if data is not None and (former is None or former.GetClassName() != data.GetClassName()):
            info.Set(vtkDataObject.DATA_OBJECT(), data.NewInstance())
        return 1

    def _execute(self, inInfo, outInfo):
        data = self.GetInputData(inInfo, 0, 0)
        output = vtkDataObject.GetData(outInfo)
        _vtk_grid.copy_shallow(data, output)
        if not _vtk_grid.has_cells(data):
            return 1
        name, association = self._quantity(data)
        given, _ = self._grid(data, [name], association)
        components = given.about["arrays"][name]["components"]
        scalar = name if components == 1 else f"{name}:{'magnitude' if self._component is None else self._component}"
        pipeline = Pipeline()
        pipeline.add("grid", "given-grid", scalar=scalar)
        pipeline.add("gradient", "gradient-magnitude", grid="grid", **self._method)
        pipeline.give(given)
        found = pipeline.volume("gradient", gradient=self._vectors, progress=self._follow)
        drawn, passed = _vtk_grid.parts(output)
        begin = 0
        for part in [part.data for part in drawn + passed]:
            end = begin + part.GetNumberOfPoints()
            for key in ("gradient_magnitude", *(["gradient"] if self._vectors else [])):
                values = found[key][begin:end]
                if end > len(found[key]):
                    values = np.full((part.GetNumberOfPoints(), *values.shape[1:]), np.nan)
                # VTK's own memory: it may outlive what computed it.
                array = numpy_to_vtk(values, deep=True)
                array.SetName(f"{scalar}_{key}")
                part.GetPointData().AddArray(array)
            begin = end
        return 1


class VoltetProbe(Filter):
    """A grid in, a table out: mean, deviation, least and greatest of s and g in a region, by the node `probe`, exact in every cell.

    Columns: `field` (s, g or an array), `mean`, `deviation`; the rows are the fields. `GetFigures()` has all that is known:
    covariance, volume, cells."""

    #: The region that is all of the grid, as the node states it.
    _WHOLE = {"box": {"low": ["0 %"] * 3, "high": ["100 %"] * 3}}

    def __init__(self) -> None:
        self._region: dict[str, Any] = self._WHOLE
        self._method: dict[str, Any] = {"method": "least-squares"}
        self._fields: list[str] = []
        self._figures: dict[str, Any] = {}
        super().__init__(1, "vtkDataSet", "vtkTable")

    @changed
    def SetBox(self, low, high):
        """The region: a box between two corners, in the grid's units."""
        return self._set_region({"box": {"low": list(low), "high": list(high)}})

    @changed
    def SetSphere(self, centre, radius):
        """The region: a ball."""
        return self._set_region({"sphere": {"centre": list(centre), "radius": radius}})

    @changed
    def SetPoints(self, points):
        """The region: points, n × 3, that count alike."""
        return self._set_region({"points": np.asarray(points, float).reshape(-1, 3).tolist()})

    @changed
    def SetWholeGrid(self):
        """The region: all cells. The default."""
        return self._set_region(self._WHOLE)

    def _set_region(self, region: dict[str, Any]) -> bool:
        self._region, before = region, self._region
        return repr(region) != repr(before)

    @changed
    def SetFields(self, names):
        """One to eight arrays to look at in place of s and g."""
        self._fields, before = list(names), self._fields
        return self._fields != before

    @changed
    def SetMethod(self, method, **parameters):
        """The gradient filter, with its parameters."""
        given = {"method": method, **parameters}
        self._method, before = given, self._method
        return repr(given) != repr(before)

    def GetFigures(self) -> dict[str, Any]:
        """What was found: fields, centre, sigma, covariance, matrix, cells, volume. Nothing where the last update failed."""
        return self._figures

    def _empty(self) -> None:
        super()._empty()
        self._figures = {}

    def _execute(self, inInfo, outInfo):
        data = self.GetInputData(inInfo, 0, 0)
        name, association = self._quantity(data)
        given, _ = self._grid(data, list(dict.fromkeys([name, *self._fields])), association)
        scalar = name if given.about["arrays"][name]["components"] == 1 else f"{name}:magnitude"
        pipeline = Pipeline()
        pipeline.add("grid", "given-grid", scalar=scalar)
        pipeline.add("gradient", "gradient-magnitude", grid="grid", **self._method)
        fields = {"fields": self._fields} if self._fields else {}
        pipeline.add("probe", "probe", volume="gradient", **self._region, **fields)
        pipeline.give(given)
        self._figures = pipeline.run(self._follow).found["probe"]
        table = vtkTable.GetData(outInfo)
        table.Initialize()
        names = vtkStringArray()
        names.SetName("field")
        for field in self._figures["fields"]:
            names.InsertNextValue(field)
        table.AddColumn(names)
        for title, key in (("mean", "centre"), ("deviation", "sigma")):
            column = vtkDoubleArray()
            column.SetName(title)
            for value in self._figures[key]:
                column.InsertNextValue(value)
            table.AddColumn(column)
        return 1
