"""Computes heat_flow.vtp and sensors.csv from heat_sink.vtu: lines along which the heat flows, and temperatures at some places.

The heat flux -k grad T is constant in a cell; at points it is the mean of the cells around, weighted by their volumes. Lines begin in
the thermal pads and are followed both ways (Runge-Kutta 4/5).

    python -m venv venv && venv/bin/pip install vtk==9.7.2 numpy
    venv/bin/python heat_flow.py            # writes both files beside this script
"""

from pathlib import Path

import numpy as np
import vtk
from vtk.util.numpy_support import numpy_to_vtk, vtk_to_numpy

HERE = Path(__file__).resolve().parent
# W/(mm K) of board, processor, regulator, pad, base, pipe and pin, as in heat_sink.py.
CONDUCTIVITY = np.array([1.0e-3, 0.10, 0.10, 5.0e-3, 0.10, 50.0, 0.10])
PAD_MIDDLE = 2.9  # z, mm
# Middle, side and number of lines along each side of the pads' grids of seeds.
SEEDS = [((-14.0, 3.0), 12.6, 6), ((17.0, -9.0), 6.6, 3)]
SENSORS = [
    ("processor", -14.0, 3.0, 1.2), ("regulator", 17.0, -9.0, 1.2), ("board", -29.0, -20.0, -0.8),
    ("base left", -28.0, 0.0, 6.4), ("base right", 28.0, 16.0, 6.4), ("pin near", -14.0, -19.0, 20.0),
    ("pin middle", 0.0, 0.0, 24.0), ("pin far", 27.0, 20.1, 27.0),
]  # fmt: skip


def read():
    reader = vtk.vtkXMLUnstructuredGridReader()
    reader.SetFileName(str(HERE / "heat_sink.vtu"))
    reader.Update()
    return reader.GetOutput()


def with_flux(grid):
    """The grid with the heat flux at its points, W/mm^2."""
    points = vtk_to_numpy(grid.GetPoints().GetData()).astype(float)
    cells = vtk_to_numpy(grid.GetCells().GetConnectivityArray()).reshape(-1, 4)
    temperature = vtk_to_numpy(grid.GetPointData().GetArray("Temperature")).astype(float)
    part = vtk_to_numpy(grid.GetCellData().GetArray("part"))
    edges = points[cells[:, 1:]] - points[cells[:, :1]]
    rises = temperature[cells[:, 1:]] - temperature[cells[:, :1]]
    flux = -CONDUCTIVITY[part][:, None] * np.linalg.solve(edges, rises[..., None])[..., 0]
    volume = np.abs(np.linalg.det(edges))
    total = np.zeros(len(points))
    at_points = np.zeros((len(points), 3))
    for corner in cells.T:
        np.add.at(total, corner, volume)
        np.add.at(at_points, corner, flux * volume[:, None])
    array = numpy_to_vtk(at_points / total[:, None], deep=True)
    array.SetName("flux")
    grid.GetPointData().AddArray(array)
    grid.GetPointData().SetActiveVectors("flux")
    return grid


def seeds():
    points = vtk.vtkPoints()
    for (x, y), side, count in SEEDS:
        steps = (np.arange(count) + 0.5) / count * side - side / 2
        for dx in steps:
            for dy in steps:
                points.InsertNextPoint(x + dx, y + dy, PAD_MIDDLE)
    cloud = vtk.vtkPolyData()
    cloud.SetPoints(points)
    return cloud


def write_lines(grid):
    tracer = vtk.vtkStreamTracer()
    tracer.SetInputData(grid)
    tracer.SetSourceData(seeds())
    tracer.SetInputArrayToProcess(0, 0, 0, vtk.vtkDataObject.FIELD_ASSOCIATION_POINTS, "flux")
    tracer.SetIntegratorTypeToRungeKutta45()
    tracer.SetIntegrationDirectionToForward()
    tracer.SetIntegrationStepUnit(vtk.vtkStreamTracer.LENGTH_UNIT)
    tracer.SetInitialIntegrationStep(0.2)
    tracer.SetMinimumIntegrationStep(0.05)
    tracer.SetMaximumIntegrationStep(0.6)
    tracer.SetMaximumPropagation(200.0)
    tracer.SetTerminalSpeed(1e-7)
    tracer.SetComputeVorticity(False)
    lines = {}
    for direction in ("Forward", "Backward"):
        getattr(tracer, f"SetIntegrationDirectionTo{direction}")()
        tracer.Update()
        found = tracer.GetOutput()
        points = vtk_to_numpy(found.GetPoints().GetData())
        values = vtk_to_numpy(found.GetPointData().GetArray("Temperature"))
        number = vtk_to_numpy(found.GetCellData().GetArray("SeedIds"))
        for cell in range(found.GetNumberOfCells()):
            ids = found.GetCell(cell).GetPointIds()
            own = [ids.GetId(k) for k in range(ids.GetNumberOfIds())]
            row = np.column_stack([points[own], values[own]])
            before = lines.get(number[cell])
            lines[number[cell]] = row if before is None else np.vstack([row[::-1], before[1:]])
    every = [thinned(line) for _, line in sorted(lines.items())]
    result, places, cells = vtk.vtkPolyData(), vtk.vtkPoints(), vtk.vtkCellArray()
    values = vtk.vtkFloatArray()
    values.SetName("Temperature")
    for line in every:
        cells.InsertNextCell(len(line))
        for x, y, z, temperature in line:
            cells.InsertCellPoint(places.InsertNextPoint(x, y, z))
            values.InsertNextValue(temperature)
    result.SetPoints(places)
    result.SetLines(cells)
    result.GetPointData().AddArray(values)
    writer = vtk.vtkXMLPolyDataWriter()
    writer.SetFileName(str(HERE / "heat_flow.vtp"))
    writer.SetInputData(result)
    writer.SetIdTypeToInt32()
    writer.SetDataModeToAppended()
    writer.EncodeAppendedDataOff()
    writer.Write()
    print(f"{len(every)} lines of {places.GetNumberOfPoints()} points")


def thinned(line):
    """The points of a line that lie at least 0.5 mm apart, and its last one; rounded to 1/4096 mm and 0.001 K."""
    kept = [0]
    for k in range(1, len(line)):
        if np.linalg.norm(line[k, :3] - line[kept[-1], :3]) >= 0.5 or k == len(line) - 1:
            kept.append(k)
    line = line[kept]
    return np.column_stack([np.round(line[:, :3] * 4096) / 4096, np.round(line[:, 3], 3)])


def write_sensors(grid):
    cloud, points = vtk.vtkPolyData(), vtk.vtkPoints()
    for _, x, y, z in SENSORS:
        points.InsertNextPoint(x, y, z)
    cloud.SetPoints(points)
    probe = vtk.vtkProbeFilter()
    probe.SetSourceData(grid)
    probe.SetInputData(cloud)
    probe.Update()
    values = vtk_to_numpy(probe.GetOutput().GetPointData().GetArray("Temperature"))
    valid = vtk_to_numpy(probe.GetOutput().GetPointData().GetArray("vtkValidPointMask"))
    assert valid.all(), [name for (name, *_), inside in zip(SENSORS, valid) if not inside]
    rows = [f"{name},{x},{y},{z},{value:.2f}" for (name, x, y, z), value in zip(SENSORS, values)]
    (HERE / "sensors.csv").write_text("name,x,y,z,Temperature\n" + "\n".join(rows) + "\n")


if __name__ == "__main__":
    whole = with_flux(read())
    write_lines(whole)
    write_sensors(whole)
