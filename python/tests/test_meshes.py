"""Meshes of other packages, drawn in one line."""

from pathlib import Path

import numpy as np
import pytest
from conftest import box

import voltet

CAMERA = {"eye": [0.5, -4.0, 0.5], "target": [0.5, 0.5, 0.5], "height": 0.5, "fov_y": None}
LOOK = [voltet.widgets.uniform(color=[1, 1, 1], extinction=2.0, region={"s": [-1e9, 1e9]})]


def opacity(mesh, scalars=None):
    """Opacity in the middle of a unit cube of extinction 2: 1 - exp(-2)."""
    drawn = voltet.render(mesh, scalars, widgets=LOOK, camera=CAMERA, size=(8, 8), unit_distance=1.0, engine="cpu")
    return drawn[4, 4, 3]


def hexahedra(n=4):
    """Points, hexahedra and T = x of a unit cube."""
    axis = np.linspace(0.0, 1.0, n)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(n**3).reshape(n, n, n)
    m = n - 1
    corners = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]
    return points, np.stack([number[i : m + i, j : m + j, k : m + k].reshape(-1) for i, j, k in corners], -1)


def of_meshio():
    meshio = pytest.importorskip("meshio")
    points, cells = hexahedra()
    lines = [("line", [[0, 1]])]
    return meshio.Mesh(points, [*lines, ("hexahedron", cells)], point_data={"T": points[:, 0]}, cell_data={"c": [[7.0], np.ones(len(cells))]})


def of_xarray(start=1, turned=False):
    xarray = pytest.importorskip("xarray")
    points, tetrahedra = box(4)
    table = np.full((len(tetrahedra), 6), -1, np.int32)
    table[:, :4] = tetrahedra + start
    about = {
        "cf_role": "mesh_topology", "topology_dimension": 3, "node_coordinates": "x y z", "volume_node_connectivity": "volumes",
        "volume_dimension": "volume",
    }
    dims = ("corner", "volume") if turned else ("volume", "corner")
    return xarray.Dataset(
        {
            "mesh": ((), 0, about),
            "volumes": (dims, table.T if turned else table, {"_FillValue": -1, "start_index": start}),
            "T": (("node",), points[:, 0]), "c": (("volume",), np.ones(len(tetrahedra))), "series": (("time", "node"), np.ones((2, 64))),
        },
        coords={name: (("node",), points[:, i]) for i, name in enumerate("xyz")},
    )


def test_meshes_of_every_package_are_drawn_alike():
    pv = pytest.importorskip("pyvista")
    points, cells = hexahedra()
    grid = pv.UnstructuredGrid({12: cells}, points)
    grid["T"] = points[:, 0]
    rows = np.column_stack([np.full(len(cells), 8), cells]).reshape(-1)
    mapping = {"points": points, "cells": rows, "types": np.full(len(cells), 12), "point_data": {"T": points[:, 0]}}
    expected = pytest.approx(1 - np.exp(-2), abs=1e-5)
    assert opacity(grid) == expected
    assert opacity(grid, "T") == expected
    assert opacity(mapping) == expected
    assert opacity(voltet.Grid.from_mesh(mapping)) == expected
    values = np.zeros((2, 2, 2))
    assert opacity(values) == expected
    with pytest.warns(voltet.VoltetWarning, match="cells of type line"):
        assert opacity(of_meshio(), "T") == expected
    with pytest.warns(voltet.VoltetWarning, match=r"series \(isel"):
        assert opacity(of_xarray(), "T") == expected
    with pytest.warns(voltet.VoltetWarning, match=r"series \(isel"):
        assert opacity(of_xarray(0, turned=True), "c") == expected


def test_active_scalars_of_a_mesh_are_drawn():
    pv = pytest.importorskip("pyvista")
    grid = pv.ImageData(dimensions=(3, 3, 3)).cast_to_unstructured_grid()
    grid["a"], grid["b"] = np.zeros(27), np.ones(27)
    grid.set_active_scalars("a")
    assert voltet.Grid.from_mesh(grid).about["scalar"] == "a"
    assert voltet.Grid.from_mesh(grid, scalar="b").about["scalar"] == "b"


def test_values_of_an_array_stand_at_their_numbers():
    values = np.arange(2 * 3 * 4, dtype=float).reshape(2, 3, 4)
    grid = voltet.Grid.from_mesh(values)
    assert grid.bounds == ((0.0, 0.0, 0.0), (1.0, 2.0, 3.0)) and grid.arrays == {"values": (0.0, 23.0)}
    pipeline = voltet.scene(grid)
    gradient = pipeline.volume("gradient", gradient=True)["gradient"]
    assert np.allclose(gradient, [12.0, 4.0, 1.0])


def test_colour_maps_of_voltet_and_of_matplotlib():
    pytest.importorskip("matplotlib")
    from matplotlib.colors import ListedColormap

    values = np.linspace(0.0, 1.0, 27).reshape(3, 3, 3)
    options = {"size": (24, 18), "engine": "cpu", "extinction": 0.5, "opacity": "constant", "unit_distance": 1.0}
    own = voltet.render(values, cmap="viridis", **options)
    # The same colours, sampled: 256 of them against the knots of voltet's.
    from matplotlib import colormaps

    assert np.abs(voltet.render(values, cmap=colormaps["viridis"], **options) - own).max() < 0.01
    turned = voltet.render(values, cmap="viridis_r", **options)
    assert np.abs(turned - own).max() > 0.1
    assert np.abs(voltet.render(values, cmap=colormaps["viridis_r"], **options) - turned).max() < 0.01
    red = voltet.render(values, cmap=["red", "red"], clim=(0.0, 0.5), **options)
    assert np.allclose(red[..., 0], red[..., 3]) and not red[..., 1:3].any()
    assert np.allclose(voltet.render(values, cmap=ListedColormap(["red"]), **options), red)
    points = [[0.0, 0.0], [0.5, 0.0], [0.5, 1.0], [1.0, 1.0]]
    for cmap in ("viridis", "Reds"):
        half = voltet.render(values, cmap=cmap, clim=(0.0, 1.0), **{**options, "opacity": points})
        assert 0 < half[..., 3].sum() < own[..., 3].sum()
    assert voltet.render(values, cmap="turbo", clim=("5 %", "p95"), **options).any()


def test_a_field_that_is_the_same_everywhere_has_colours_of_matplotlibs():
    pytest.importorskip("matplotlib")
    drawn = voltet.render(np.full((3, 3, 3), 7.0), cmap="Reds", opacity="constant", extinction=2.0, size=(8, 8), engine="cpu")
    assert drawn[4, 4, 3] > 0.5


def test_a_field_that_is_the_same_everywhere_is_said_to_begin_the_opacity():
    with pytest.warns(voltet.VoltetWarning, match=r"every value of 'values' is 7, where the opacity of a colour map begins"):
        drawn = voltet.render(np.full((3, 3, 3), 7.0), size=(8, 8), engine="cpu")
    assert not drawn.any()
    remedies = ({"opacity": "constant"}, {"clim": (0, 7)})
    assert all(voltet.render(np.full((3, 3, 3), 7.0), size=(8, 8), engine="cpu", **remedy).any() for remedy in remedies)


def test_a_scene_of_a_mesh_is_a_pipeline_file():
    values = np.linspace(0.0, 1.0, 27).reshape(3, 3, 3)
    text = str(voltet.scene(values, cmap="inferno_r", clim=(0.25, 0.75), extinction=0.5))
    for line in ('colormap = "inferno"', "reversed = true", "range = [0.25, 0.75]", "extinction = 0.5"):
        assert line in text


def test_what_is_no_mesh_and_what_is_stated_twice():
    values = np.zeros((3, 3, 3))
    for call, match in (
        (lambda: voltet.render(3), "this is no mesh: found a builtins.int; expected a voltet.Grid, a PyVista"),
        (lambda: voltet.render(np.zeros((3, 3))), r"an array is no volume: found shape \(3, 3\)"),
        (lambda: voltet.render(values, cmap="no such map"), "the colour map is not known: found 'no such map'"),
        (lambda: voltet.render(values, cmap="Virdis"), "the colour map is not known: found 'Virdis'; expected 'viridis', the nearest name, or one of"),
        (lambda: voltet.render(values, cmap="spectal_r"), "found 'spectal_r'; expected '.*', the nearest name, or one of"),
        (lambda: voltet.render(values, cmap="Reds", clim=("5 %", 1.0)), "relative to the data"),
        (lambda: voltet.render(values, cmap="Reds", opacity="peaks"), "opacity has no such shape"),
        (lambda: voltet.render(values, cmap="Reds", opacity=[0, 0.2, 1]), "the opacity is no curve: found .0, 0.2, 1.; expected points"),
        (lambda: voltet.render(values, opacity=0.5), "the opacity is no curve: found 0.5"),
        (lambda: voltet.render(values, opacity=[[0.5, 0], [0.2, 1]]), "the opacity is no curve"),
        (lambda: voltet.render(values, cmap="Reds", clim=(1.0, 0.0)), "'clim' is out of range"),
        (lambda: voltet.render(values, clim=3), "'clim' is no pair"),
        (lambda: voltet.render(values, cmap="viridis", widgets=LOOK), "stated twice: found 'widgets' and 'cmap'"),
    ):
        with pytest.raises(voltet.UsageError, match=match):
            call()


def test_wrong_words_and_values_in_their_place_show_the_right_ones():
    values = np.random.default_rng(1).random((3, 3, 3))
    points = np.array([[0.0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]])

    class Described:
        def __repr__(self):
            return "Table\n  of colours" + 200 * "."

    for call, match in (
        (lambda: voltet.render(values, values), "the scalar is no name: found ndarray of shape .3, 3, 3.; expected the name of an array"),
        (lambda: voltet.scene(values, 3), "the scalar is no name: found int"),
        (lambda: voltet.Grid.from_mesh(values, scalar=values), "the scalar is no name: found ndarray"),
        (lambda: voltet.render(values, scalar="values"), "unknown word 'scalar'; expected 'scalars'"),
        (lambda: voltet.scene(values, scalars="values"), "unknown word 'scalars'; expected 'scalar', the nearest name, or one of scalar, cmap,"),
        (lambda: voltet.render(values, Cmap="Reds"), "unknown word 'Cmap'; expected 'cmap', the nearest name"),
        (lambda: voltet.render(values, window_size=(8, 8)), "unknown word 'window_size'; expected .*one of .*size.*engine"),
        (lambda: voltet.render("grid.vtu"), "a path is no mesh: found 'grid.vtu'; expected the mesh: pyvista.read"),
        (lambda: voltet.render(Path("grid.vtu")), "a path is no mesh: found 'grid.vtu'"),
        (lambda: voltet.render(values, cmap=Described()), "the colour map is not known: found Table of colours[.]*; expected one of viridis"),
        (lambda: voltet.Grid(points, tetrahedra=[[0, 1, 2, 3]], point_data=[1, 2, 3, 4]), "'point_data' is no mapping: found list"),
        (lambda: voltet.Grid(points, tetrahedra=[[0, 1, 2, 3]], cell_data=np.ones(2)), "'cell_data' is no mapping: found ndarray of shape .2,."),
    ):
        with pytest.raises(voltet.UsageError, match=match) as error:
            call()
        assert "\n" not in str(error.value) and len(str(error.value)) < 500


def test_what_was_left_out_of_a_mesh_is_told_where_it_is_requested():
    with pytest.warns(voltet.VoltetWarning, match="left out.*series.*isel"), pytest.raises(voltet.Error, match="no array 'series'"):
        voltet.render(of_xarray(), "series", size=(8, 8), engine="cpu")


def test_data_sets_of_xarray_without_volumes_say_what_is_missing():
    data = of_xarray()
    flat = data.copy()
    flat["mesh"].attrs["topology_dimension"] = 2
    with pytest.raises(voltet.UsageError, match="no mesh of volumes, or several: found 'mesh' of 2 dimensions; expected one of topology_dimension 3"):
        voltet.Grid.from_mesh(flat)
    with pytest.raises(voltet.UsageError, match="does not state its volume_node_connectivity: found volumes"):
        voltet.Grid.from_mesh(data.drop_vars("volumes"))
    with pytest.raises(voltet.UsageError, match="found a DataArray; expected an xarray.Dataset, .*; of a regular grid, the values: array.to_numpy"):
        voltet.Grid.from_mesh(data["T"])
    data["volumes"].values[3, 4] = 1
    data["volumes"].values[3, 5] = 1
    data["volumes"].values[4, 4:] = -1
    data["volumes"].values[5, 3] = -1
    with pytest.raises(voltet.UsageError, match="a volume of a number of points that is not known: found 3"):
        voltet.Grid.from_mesh(data)


def test_polyhedra_of_meshio_are_drawn_and_volumes_of_unknown_types_are_named():
    meshio = pytest.importorskip("meshio")
    points, cells = hexahedra(3)
    faces = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])
    polyhedra = [list(cell[faces]) for cell in cells[4:]]
    blocks = [("polyhedron8", polyhedra), ("hexahedron", cells[:4]), ("tetra20", [list(range(20))])]
    values = {"c": [np.arange(4.0, 8.0), np.arange(4.0), [9.0]]}
    mesh = meshio.Mesh(points, blocks, point_data={"T": points[:, 0]}, cell_data=values)
    grid = voltet.Grid.from_mesh(mesh, scalar="T")
    assert grid.arrays["c"] == (0.0, 7.0)
    assert grid.about["warnings"] == ["passed over, as their type is not known: cells of type tetra20"]
    with pytest.warns(voltet.VoltetWarning, match="tetra20"):
        assert opacity(mesh, "T") == pytest.approx(1 - np.exp(-2), abs=1e-5)


def test_words_in_attributes_of_ugrid_hide_no_variable():
    data = of_xarray()
    data["mesh"].attrs["long_name"] = "grid of T and c in series"
    assert set(voltet.Grid.from_mesh(data, scalar="T").arrays) == {"T", "c"}
    with pytest.raises(voltet.UsageError, match=r"volume_node_connectivity of the mesh 'mesh' is no table: found dimensions \(volume\)"):
        voltet.Grid.from_mesh(data.assign(volumes=data["volumes"][:, 0]))
    with pytest.raises(voltet.UsageError, match=r"node_coordinates of the mesh 'mesh' are not along the nodes: found dimensions \(node\), \(other\)"):
        voltet.Grid.from_mesh(data.assign_coords(y=(("other",), np.zeros(3))))


def test_a_warning_of_a_mesh_is_told_once():
    with pytest.warns(voltet.VoltetWarning) as told:
        voltet.render(of_meshio(), "T", size=(8, 8), engine="cpu")
    assert [str(warning.message) for warning in told] == ["grid: passed over, as only volume cells are drawn: cells of type line"]


@pytest.mark.parametrize("words", [
    {"extinction": "thin"}, {"extinction": [1.0, 2.0]}, {"camera": "xy"}, {"camera": {1: 2}}, {"method": 3}, {"look": "log"}, {"annotation": True},
    {"annotation": "title"}, {"cmap": []}, {"cmap": ["red"]},
])
def test_words_of_a_wrong_type_are_refused_by_name(words):
    (name,) = words
    pytest.importorskip("matplotlib")
    named = "colour map" if name == "cmap" else f"'{name}' is no "
    with pytest.raises(voltet.UsageError, match=named) as raised:
        voltet.render(np.zeros((3, 3, 3)), size=(8, 8), engine="cpu", **words)
    assert raised.value.expected


@pytest.mark.parametrize("name, value, message", [
    ("mesh", {"topology_dimension": "three"}, "'mesh' of three dimensions"), ("volumes", {"start_index": "one"}, "an unknown start_index"),
    ("volumes", {"start_index": 0.5}, "an unknown start_index"), ("volumes", {"start_index": float("inf")}, "an unknown start_index"),
])
def test_attributes_of_ugrid_that_are_no_numbers_are_said(name, value, message):
    data = of_xarray()
    data[name].attrs.update(value)
    with pytest.raises(voltet.UsageError, match=message):
        voltet.Grid.from_mesh(data, scalar="T")
