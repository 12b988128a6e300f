"""Grids of numpy arrays: what is lent, what is refused."""

import gc
import warnings
import weakref

import numpy as np
import pytest
from conftest import box, uniform

import voltet


def test_arrays_in_form_are_lent(cube):
    about = voltet.Grid(**cube).about
    assert about["points_lent"] and about["tetrahedra_lent"] and about["bytes_copied"] == 0
    assert about["points"] == 216 and about["tetrahedra"] == 625
    assert about["arrays"]["T"] == {"components": 1, "range": [0.0, 3.0]} and about["scalar"] == "T"


@pytest.mark.parametrize("dtype", [np.int32, np.uint32])
def test_vtk_cells_of_32_bits_are_lent(cube, dtype):
    tetrahedra = cube.pop("tetrahedra")
    grid = voltet.Grid(
        types=np.full(len(tetrahedra), 10), offsets=np.arange(0, tetrahedra.size + 1, 4),
        connectivity=tetrahedra.reshape(-1).astype(dtype), **cube,
    )
    assert grid.about["tetrahedra_lent"]


def test_other_forms_are_copied_and_draw_the_same(cube):
    expected = uniform(voltet.Grid(**cube)).render()
    tetrahedra = cube["tetrahedra"]
    padded = np.column_stack([np.full(len(tetrahedra), 4), tetrahedra]).reshape(-1)
    types = np.full(len(tetrahedra), 10, np.uint8)
    forms = [
        {"tetrahedra": tetrahedra.astype(np.int64)},
        {"tetrahedra": tetrahedra.tolist()},
        {"tetrahedra": tetrahedra.astype(">i4")},
        {"tetrahedra": np.asfortranarray(tetrahedra.astype(np.int16))},
        {"types": types, "cells": padded, "tetrahedra": None},
        {"points": np.asfortranarray(cube["points"])},
        {"points": cube["points"].astype(">f8")},
        {"points": np.repeat(cube["points"], 2, axis=0)[::2]},
        {"point_data": {"T": cube["point_data"]["T"].astype(np.float32)}},
    ]
    for form in forms:
        rgba = uniform(voltet.Grid(**{**cube, **form})).render()
        assert np.allclose(rgba, expected, atol=1e-6), form.keys()


def test_mixed_cells_with_unused_points_and_a_polyhedron():
    points = np.array([[9.0, 9, 9], [0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0], [0, 0, 1], [1, 0, 1], [1, 1, 1], [0, 1, 1]])
    faces = [6, 4, 1, 2, 3, 4, 4, 5, 6, 7, 8, 4, 1, 2, 6, 5, 4, 2, 3, 7, 6, 4, 3, 4, 8, 7, 4, 4, 1, 5, 8]
    for kind in ({"types": [12]}, {"types": [42], "faces": faces, "face_locations": [0]}):
        grid = voltet.Grid(points, offsets=[0, 8], connectivity=range(1, 9), point_data={"z": points[:, 2]}, **kind)
        assert grid.cell_count >= 5 and grid.bounds == ((0, 0, 0), (1, 1, 1))
        assert np.allclose(uniform(grid).render()[8, 8, 3], 1 - np.exp(-2), atol=1e-5)
        values = voltet.scene(grid, size=(4, 4)).volume("gradient", gradient=True)
        assert np.isnan(values["gradient"][0]).all() and np.allclose(values["gradient"][1:], [0, 0, 1])


def test_cell_data_and_ghosts_and_subdivision(cube):
    count = len(cube["tetrahedra"])
    grid = voltet.Grid(cube["points"], tetrahedra=cube["tetrahedra"], cell_data={"c": np.ones(count)}, constant_cells=True)
    assert grid.point_count == 4 * count
    ghost = np.zeros(count, bool)
    ghost[: count // 2] = True
    assert voltet.Grid(**cube, ghost=ghost).cell_count == count - count // 2


def test_the_arrays_live_as_long_as_they_are_lent(cube):
    grid = voltet.Grid(**cube)
    points = weakref.ref(cube.pop("points"))
    cube.clear()
    slab = uniform(grid)
    slab.render()
    del grid
    gc.collect()
    assert points() is not None and slab.render().shape == (16, 16, 4)
    del slab
    gc.collect()
    assert points() is None


def test_lent_arrays_cannot_be_taken_away(cube):
    points = cube["points"].copy()
    grid = voltet.Grid(**{**cube, "points": points})
    with pytest.raises(ValueError):
        points.resize((1, 3))
    assert grid.point_count == 216


def test_arrays_changed_in_place_are_drawn_anew(cube):
    slab = uniform(voltet.Grid(**cube))
    before = slab.render()
    cube["points"][:, 1] *= 0.5
    after = slab.render()
    assert np.allclose(after[8, 8, 3], 1 - np.exp(-1), atol=1e-5) and not np.allclose(before, after)
    # Converted ones, too.
    low = cube["points"].astype(np.float32)
    slab = uniform(voltet.Grid(**{**cube, "points": low}))
    slab.render()
    low[:, 1] *= 2
    assert np.allclose(slab.render()[8, 8, 3], 1 - np.exp(-2), atol=1e-5)


def test_arrays_that_are_as_they_were_are_found_so_however_many_cores_looked():
    points = np.random.default_rng(7).random((200_000, 3))
    tetrahedra = np.arange(len(points), dtype=np.uint32).reshape(-1, 4)
    grid = voltet.Grid(points, tetrahedra=tetrahedra, point_data={"x": points[:, 0].copy()})
    made = grid._current()
    assert all(grid._current() is made for _ in range(200))
    points[-1, 2] += 1.0
    assert grid._current() is not made


def test_a_change_is_noticed_while_a_picture_is_drawn_and_it_is_drawn_anew(cube):
    grid = voltet.Grid(**cube)
    slab = uniform(grid, (300, 300))
    slab.render()
    made, told = grid._current(), []

    def change(node, stage, fraction):
        # Before anything is drawn, and after Python has handed over what there was.
        if not told:
            cube["points"][:, 1] *= 0.5
        told.append(node)

    assert np.allclose(slab.render(progress=change)[150, 150, 3], 1 - np.exp(-1), atol=1e-5)
    assert grid._current(look=False) is not made
    # What is raised meanwhile is raised, changed or not.
    def stop(node, stage, fraction):
        cube["points"][:, 1] *= 2
        raise LookupError("enough")

    with pytest.raises(LookupError):
        slab.render(progress=stop)
    assert np.allclose(slab.render()[150, 150, 3], 1 - np.exp(-2), atol=1e-5)


def test_without_watching_changes_are_said(cube):
    grid = voltet.Grid(**cube, watch=False)
    slab = uniform(grid)
    slab.render()
    made = grid._current()
    cube["points"][:, 1] *= 0.5
    slab.render()
    assert grid._current() is made
    grid.modified()
    assert np.allclose(slab.render()[8, 8, 3], 1 - np.exp(-1), atol=1e-5)


def test_numbers_out_of_range_written_between_pictures_are_refused(cube):
    slab = uniform(voltet.Grid(**cube))
    slab.render()
    cube["tetrahedra"][7, 3] = 100_000
    with pytest.raises(voltet.Error, match="100000"):
        slab.render()
    cube["tetrahedra"][:] = box()[1]
    assert slab.render().shape == (16, 16, 4)


def test_nan_leaves_cells_out_with_a_warning(cube):
    cube["point_data"]["T"][40] = np.nan
    grid = voltet.Grid(**cube)
    assert grid.cell_count < 625 and any("finite" in text for text in grid.about["warnings"])
    assert np.isfinite(uniform(grid).render()).all()


def test_nan_of_an_array_that_is_not_drawn_leaves_nothing_out(cube):
    plain = uniform(voltet.Grid(**cube)).render()
    mask, own = np.ones(216), np.zeros(625)
    mask[40] = own[300] = np.nan
    grid = voltet.Grid(**{**cube, "point_data": {**cube["point_data"], "mask": mask}, "cell_data": {"c": own}})
    assert grid.cell_count < 625
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        scene = uniform(grid)
        drawn = scene.render()
    assert np.array_equal(drawn, plain) and drawn.report["counts"] == plain.report["counts"]
    assert np.array_equal(scene.volume("gradient")["scalar"], cube["point_data"]["T"])
    # Drawn itself, or looked at by a widget, it leaves its cells out; after that the other one is whole again.
    for name in ("mask", "c"):
        with pytest.warns(voltet.VoltetWarning, match="finite"):
            assert not np.array_equal(uniform(grid, scalar=name).render(), plain)
    widgets = scene["look"]["widgets"]
    scene["look"]["widgets"] = [voltet.widgets.gaussian_nd(fields=["mask"], centre=[1.0], sigma=[9.0], color=[1.0, 0.5, 0.25], extinction=2.0)]
    with pytest.warns(voltet.VoltetWarning, match="finite"):
        assert not np.isnan(scene.render()).any()
    scene["look"]["widgets"] = widgets
    assert np.array_equal(scene.render(), plain)
    # Nor does one without any finite value, of which nothing could be drawn.
    empty = np.full(216, np.nan)
    grid = voltet.Grid(**{**cube, "point_data": {**cube["point_data"], "mask": mask, "empty": empty}})
    assert np.array_equal(uniform(grid).render(), plain)
    with pytest.raises(voltet.Error, match="nothing to draw: .*not finite"):
        uniform(grid, scalar="empty").render()


WRONG = {
    "points of two": ({"points": np.zeros((4, 2))}, r"three numbers", "(n, 3)"),
    "points of text": ({"points": [["a", "b", "c"]]}, "wrong type", "real numbers"),
    "points complex": ({"points": np.zeros((4, 3), complex)}, "wrong type", "real numbers"),
    "points ragged": ({"points": [[0, 0, 0], [1]]}, "array", "real numbers"),
    "points of objects": ({"points": np.full((4, 3), None)}, "wrong type", "real numbers"),
    "numbers of floats": ({"tetrahedra": np.zeros((1, 4))}, "wrong type", "whole numbers"),
    "five a cell": ({"tetrahedra": [[0, 1, 2, 3, 4]]}, "four point numbers", "(m, 4)"),
    "negative": ({"tetrahedra": np.array([[0, 1, 2, -3]], np.int32)}, r"tetrahedra\[3\]", "0 or more"),
    "negative of 64": ({"tetrahedra": np.array([[0, 1, 2, -3]])}, r"\[3\]", "0"),
    "beyond": ({"tetrahedra": [[0, 1, 2, 216]]}, "216", None),
    "beyond 32 bits": ({"tetrahedra": [[0, 1, 2, 2**33]]}, r"\[3\]", None),
    "beyond 64 bits": ({"tetrahedra": np.array([[0, 1, 2, 2**63]], np.uint64)}, "out of range", None),
    "no cells": ({"tetrahedra": None}, "not stated", "tetrahedra"),
    "twice": ({"types": [10]}, "not stated", "tetrahedra"),
    "few offsets": ({"tetrahedra": None, "types": [10], "offsets": [0], "connectivity": [0, 1, 2, 3]}, "offsets", "2"),
    "falling": ({"tetrahedra": None, "types": [10, 10], "offsets": [0, 4, 2], "connectivity": [0, 1, 2, 3]}, r"offsets\[2\]", "4"),
    "past the end": ({"tetrahedra": None, "types": [10], "offsets": [0, 9], "connectivity": [0, 1, 2, 3]}, r"offsets\[1\]", "4"),
    "below": ({"tetrahedra": None, "types": [10], "offsets": [-4, 4], "connectivity": [0, 1, 2, 3]}, r"offsets\[0\]", "0"),
    "no type": ({"tetrahedra": None, "types": [300], "offsets": [0, 4], "connectivity": [0, 1, 2, 3]}, "type", "255"),
    "unknown type": ({"tetrahedra": None, "types": [200], "offsets": [0, 4], "connectivity": [0, 1, 2, 3]}, "200", None),
    "padding": ({"tetrahedra": None, "types": [10], "cells": [9, 0, 1, 2, 3]}, r"cells\[0\]", "number"),
    "two-dimensional types": ({"tetrahedra": None, "types": [[10]], "offsets": [0, 4], "connectivity": [0, 1, 2, 3]}, "shape", None),
    "no places": ({"tetrahedra": None, "types": [42], "offsets": [0, 4], "connectivity": [0, 1, 2, 3]}, "face_locations", "place"),
    "places past": (
        {"tetrahedra": None, "types": [42], "offsets": [0, 4], "connectivity": [0, 1, 2, 3], "faces": [4], "face_locations": [7]},
        "polyhedron", None,
    ),
    "short array": ({"point_data": {"T": np.zeros(3)}}, "wrong shape", "(216,)"),
    "cube of an array": ({"point_data": {"T": np.zeros((216, 2, 2))}}, "wrong shape", "(216,)"),
    "no columns": ({"point_data": {"T": np.zeros((216, 0))}}, "wrong shape", "(216,)"),
    "no arrays": ({"point_data": {}, "scalar": None}, "no arrays", "scalar"),
    "no such scalar": ({"scalar": "t"}, "scalar", "T"),
    "vector as scalar": ({"scalar": "U"}, "scalar", "T"),
    "same name": ({"cell_data": {"T": np.zeros(625)}}, "same name", None),
    "masked": ({"point_data": {"T": np.ma.masked_less(np.arange(216.0), 5)}}, "masked", "NaN"),
    "short ghost": ({"ghost": [0]}, "wrong shape", "(625,)"),
    "subdivision": ({"subdivision": 0}, "subdivision", "64"),
    "subdivision of text": ({"subdivision": "2"}, "whole number", None),
    "nothing finite": ({"points": np.full((216, 3), np.nan)}, "nothing to draw", "cell"),
}


@pytest.mark.parametrize("name", WRONG)
def test_wrong_arrays_are_refused_with_what_was_expected(cube, name):
    changed, match, expected = WRONG[name]
    with pytest.raises(voltet.Error, match=match) as raised:
        voltet.Grid(**{**cube, **changed})
    if expected:
        assert expected in (raised.value.expected or ""), raised.value


def test_a_grid_may_name_its_scalar_at_the_node(cube):
    cube["scalar"] = None
    cube["point_data"]["V"] = cube["point_data"]["T"] + 1
    grid = voltet.Grid(**cube)
    assert grid.about["scalar"] is None
    with pytest.raises(voltet.UsageError, match="not named") as raised:
        voltet.scene(grid)
    assert "T" in raised.value.expected
    for scalar in ("T", "U:magnitude", "U:1"):
        assert voltet.scene(grid, scalar, size=(4, 4)).render().shape == (4, 4, 4)
    with pytest.raises(voltet.Error, match="no array 'W'"):
        voltet.scene(grid, "W", size=(4, 4)).render()


def test_gradients_come_back_at_the_points_that_were_given(cube):
    found = voltet.scene(voltet.Grid(**cube)).volume("gradient", gradient=True)
    assert np.allclose(found["gradient"], [1, 2, 0]) and np.allclose(found["gradient_magnitude"], np.sqrt(5))
    assert np.array_equal(found["scalar"], cube["point_data"]["T"])


def test_what_is_no_grid_cannot_be_given(slab):
    with pytest.raises(voltet.UsageError, match="no grid"):
        slab.give(np.zeros(3))
    with pytest.raises(voltet.UsageError, match="gives no grid"):
        slab.give(None, "view")
    slab.give(None)
    with pytest.raises(voltet.UsageError, match="no grid"):
        slab.render()


@pytest.mark.parametrize(
    ("order", "found", "call"),
    [
        (("points", "tetrahedra"), "ndarray of shape", r"Grid\(points, tetrahedra=cells\)"),
        (("tetrahedra", "points"), "the points are argument 2", r"Grid\(points, tetrahedra=cells\)"),
        (("cells", "types", "points"), "the points are argument 3", r"Grid\(points, cells=cells, types=types\)"),
        (("points", "types", "offsets", "connectivity"), "ndarray", r"Grid\(points, types=types, offsets=offsets, connectivity=connectivity\)"),
    ],
)
def test_arguments_by_position_give_the_right_call(cube, order, found, call):
    tetrahedra = cube["tetrahedra"]
    known = {
        "points": cube["points"], "tetrahedra": tetrahedra, "types": np.full(len(tetrahedra), 10),
        "offsets": np.arange(0, tetrahedra.size + 1, 4), "connectivity": tetrahedra.reshape(-1),
        "cells": np.column_stack([np.full(len(tetrahedra), 4), tetrahedra]).reshape(-1),
    }
    with pytest.raises(voltet.ArgumentTypeError, match=f"only the points are given by position.*{found}.*expected {call}"):
        voltet.Grid(*[known[name] for name in order])
    by_name = {name: known[name] for name in order if name != "points"}
    assert voltet.Grid(known["points"], **by_name, point_data=cube["point_data"]).cell_count == len(tetrahedra)


def test_points_and_cells_in_each_others_place_and_meshes_give_the_right_call(cube):
    with pytest.raises(voltet.UsageError, match=r"found shape .*expected \(n, 3\), as in Grid\(points, tetrahedra=cells\)"):
        voltet.Grid(cube["tetrahedra"], tetrahedra=cube["points"])
    with pytest.raises(voltet.UsageError, match=r"cells are not stated: found nothing; expected Grid\(points, tetrahedra=cells\)"):
        voltet.Grid(cube["points"])
    with pytest.raises(voltet.ArgumentTypeError, match=r"found dict; expected Grid.from_mesh\(mesh\)"):
        voltet.Grid(cube)
    # Arrays of PyVista have the attributes of their VTK objects.
    pv = pytest.importorskip("pyvista")
    mesh = pv.UnstructuredGrid({10: cube["tetrahedra"]}, cube["points"])
    again = voltet.Grid(mesh.points, cells=mesh.cells, types=mesh.celltypes, point_data={"T": cube["point_data"]["T"]})
    assert again.cell_count == len(cube["tetrahedra"])
    import inspect

    assert list(inspect.signature(voltet.Grid).parameters)[:2] == ["points", "tetrahedra"]


def test_a_subclass_may_have_arguments_of_its_own(cube):
    class Scaled(voltet.Grid):
        def __init__(self, points, factor, **given):
            super().__init__(factor * points, **given)

    given = {name: value for name, value in cube.items() if name != "points"}
    assert Scaled(cube["points"], 2.0, **given).bounds == ((0, 0, 0), (2, 2, 2))


def test_a_mapping_and_a_grid_keep_what_they_state_of_the_whole(cube):
    stated = {"constant_cells": True, "subdivision": 2, "watch": False}
    cube["point_data"]["V"] = cube["points"][:, 2]
    grid = voltet.Grid(**cube, **stated)
    for mesh in ({**cube, **stated}, grid):
        for more, scalar in (({}, "T"), ({"scalar": "V"}, "V")):
            again = voltet.Grid.from_mesh(mesh, **more)
            assert again._options == {"scalar": scalar, "subdivision": 2, "constant_cells": True, "warnings": []} and again._watch is False
    assert voltet.Grid.from_mesh(grid) is grid and voltet.Grid.from_mesh(grid, watch=True)._watch is True
    with pytest.raises(voltet.UsageError, match="the mapping has an argument that is not known: found point_dat;"):
        voltet.Grid.from_mesh({**cube, "point_dat": {}})
    with pytest.raises(voltet.UsageError, match="the mapping has no points"):
        voltet.Grid.from_mesh({"tetrahedra": cube["tetrahedra"]})
