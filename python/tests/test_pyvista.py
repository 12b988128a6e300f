"""PyVista: accessors, and a volume in a plotter that follows it."""

import gc
import weakref

import numpy as np
import pytest

pv = pytest.importorskip("pyvista")
from conftest import box  # noqa: E402

import voltet  # noqa: E402

pv.OFF_SCREEN = True


def cube(n=6):
    points, tetrahedra = box(n)
    cells = np.column_stack([np.full(len(tetrahedra), 4), tetrahedra]).reshape(-1)
    grid = pv.UnstructuredGrid(cells, np.full(len(tetrahedra), 10, np.uint8), points)
    grid["T"] = points @ [1.0, 2.0, 0.0]
    grid["U"] = points
    return grid


def plotter(**options):
    p = pv.Plotter(off_screen=True, window_size=(120, 90), **options)
    p.background_color = "white"
    return p


def shown(p):
    p.show(auto_close=False)
    return p.screenshot(return_img=True)


def test_accessors_come_by_entry_points():
    import subprocess
    import sys

    code = "import pyvista as pv, sys; assert 'voltet' not in sys.modules; pv.Sphere().voltet; pv.Plotter(off_screen=True).voltet"
    subprocess.run([sys.executable, "-c", code], check=True)


def test_a_picture_of_a_grid():
    rgba = cube().voltet.render("T", opacity=[1.0, 1.0], window_size=(40, 30), engine="cpu")
    assert rgba.shape == (30, 40, 4) and 0.5 < rgba[15, 20, 3] < 1.0 and rgba[0, 0, 3] == 0
    again = cube().voltet.render("T", opacity="sigmoid", cmap="inferno", clim=(0, 1), camera="xy", window_size=(8, 8), engine="cpu")
    assert again.shape == (8, 8, 4)
    look = [voltet.widgets.gaussian(color=[1, 1, 1], extinction=5, centre=["50 %", "50 %"], sigma=["9 %", "90 %"])]
    assert cube().voltet.render("T", widgets=look, window_size=(8, 8)).max() > 0


def test_opacity_and_colour_are_pyvistas_own():
    # Constant opacity over a unit distance, one colour: the formula of VTK's volume rendering.
    camera = pv.Camera()
    camera.position, camera.focal_point, camera.up = (0.5, -4, 0.5), (0.5, 0.5, 0.5), (0, 0, 1)
    camera.parallel_projection = True
    camera.parallel_scale = 0.25
    rgba = cube().voltet.render("T", opacity=[0.6, 0.6], cmap=["red", "red"], opacity_unit_distance=0.5, camera=camera, window_size=(9, 9))
    alpha = round(0.6 * 255) / 255
    assert np.allclose(rgba[4, 4], np.array([1, 0, 0, 1]) * (1 - (1 - alpha) ** 2), atol=3e-3)


def test_gradients_are_added_to_a_copy_that_shares():
    grid = cube()
    names = list(grid.array_names)
    found = grid.voltet.gradient("T")
    assert grid.array_names == names and isinstance(found, pv.UnstructuredGrid)
    assert np.allclose(found["T_gradient"], [1, 2, 0]) and np.allclose(found["T_gradient_magnitude"], np.sqrt(5))
    assert np.shares_memory(found["T"], grid["T"]) and np.shares_memory(found.points, grid.points)
    assert "T_gradient" not in grid.voltet.gradient("T", vectors=False).array_names
    blocks = pv.MultiBlock([cube(), cube()])
    assert "T_gradient" in blocks.voltet.gradient("T")[1].array_names
    image = pv.ImageData(dimensions=(5, 5, 5))
    image["z"] = image.points[:, 2]
    assert np.allclose(image.voltet.gradient("z")["z_gradient"], [0, 0, 1])


def test_a_volume_follows_camera_and_window_and_is_drawn_once():
    grid = cube()
    p = plotter()
    v = p.voltet.add_volume(grid, "T", opacity=[1.0, 1.0], show_scalar_bar=False, engine="cpu")
    first = shown(p)
    assert v.draws == 1 and v.error is None and (first != 255).any()
    p.render()
    p.render()
    assert v.draws == 1
    p.camera.azimuth = 30
    p.render()
    assert v.draws == 2 and not np.array_equal(p.screenshot(return_img=True), first)
    p.window_size = (60, 50)
    p.render()
    assert v.draws == 3 and v.picture.shape == (50, 60, 4)
    grid["T"][:] = 0.0
    grid.GetPointData().GetArray("T").Modified()
    p.render()
    assert v.draws == 4
    v.pipeline["picture"]["integrator"] = "adaptive"
    v.modified()
    p.render()
    assert v.draws == 5
    v.remove()
    p.render()
    assert v.draws == 5 and not p.voltet.volumes
    p.close()


def test_the_window_holds_the_picture_over_what_is_behind():
    p = plotter()
    p.background_color = (0.0, 0.0, 1.0)
    v = p.voltet.add_volume(cube(), "T", opacity=[0.9, 0.9], cmap=["red", "red"], show_scalar_bar=False, engine="cpu")
    img = shown(p).astype(float) / 255
    rgba = np.asarray(v.picture)
    expected = rgba[..., :3] + (1 - rgba[..., 3:]) * [0.0, 0.0, 1.0]
    assert np.abs(img - expected).max() < 2.5 / 255
    p.close()


def test_the_camera_is_set_to_see_the_volume():
    p = plotter()
    p.voltet.add_volume(cube(), "T", engine="cpu")
    shown(p)
    assert np.allclose(p.camera.focal_point, 0.5, atol=1e-6)
    p.close()


def test_several_volumes_renderers_and_scales():
    p = plotter(shape=(1, 2))
    one = p.voltet.add_volume(cube(), "T", name="a", opacity=[1, 1], show_scalar_bar=False, engine="cpu")
    p.subplot(0, 1)
    two = p.voltet.add_volume(cube(), "U", scale=0.5, opacity=[1, 1], show_scalar_bar=False, engine="cpu")
    img = shown(p)
    assert one.picture.shape == (90, 60, 4) and two.picture.shape == (45, 30, 4)
    assert (img[:, :60] != 255).any() and (img[:, 60:] != 255).any()
    p.subplot(0, 0)
    other = p.voltet.add_volume(cube(), "T", name="a", engine="cpu")
    assert p.voltet.volumes["a"] is other and len(p.voltet.volumes) == 2
    p.close()


def test_closed_plotters_and_wrong_words():
    p = plotter()
    v = p.voltet.add_volume(cube(), "T", engine="cpu")
    shown(p)
    accessor = p.voltet
    p.close()
    with pytest.raises(voltet.UsageError, match="closed"):
        accessor.add_volume(cube(), "T")
    v.remove()
    v.modified()
    p = plotter()
    for words, match in (
        ({"scalars": "nope"}, "no array 'nope'"), ({"scalars": 3}, "no name"), ({"cmap": "no such map"}, "colour map"),
        ({"opacity": "no such word"}, "opacity"), ({"clim": (1, 0)}, "clim"), ({"clim": (np.nan, 1)}, "clim"),
        ({"opacity_unit_distance": -1}, "opacity_unit_distance"), ({"n_colors": 1}, "n_colors"), ({"scale": 3}, "scale"),
        ({"preference": "edge"}, "preference"), ({"integrator": "analytical"}, "integrator"), ({"method": "best"}, "gradient filter"),
    ):
        with pytest.raises(voltet.Error, match=match):
            p.voltet.add_volume(cube(), **{"scalars": "T", **words})
    with pytest.raises(voltet.Error, match="nothing to draw|volume|cells"):
        p.voltet.add_volume(pv.Sphere(), "Normals")
    assert not p.voltet.volumes
    p.close()


def test_whole_numbers_are_not_rounded():
    for words in ({"window_size": (40.5, 30)}, {"window_size": 40}, {"n_colors": 64.0}):
        with pytest.raises(TypeError, match="whole number") as raised:
            cube().voltet.render("T", **words)
        assert isinstance(raised.value, voltet.UsageError)


def test_a_frame_of_a_volume_that_shows_nothing_warns():
    grid = cube()
    grid["T"][:] = 4.0
    p = plotter()
    p.voltet.add_volume(grid, "T", show_scalar_bar=False, engine="cpu")
    with pytest.warns(voltet.VoltetWarning, match="the picture is empty"):
        shown(p)
    p.close()


def test_blocks_of_surfaces_are_passed_over_and_an_array_that_a_block_lacks_is_said():
    one, two = cube(), cube()
    two.points += [2.0, 0.0, 0.0]
    blocks = pv.MultiBlock({"inlet": pv.Sphere(), "one": one, "two": two})
    one.set_active_scalars("T")
    with pytest.warns(voltet.VoltetWarning, match=r"1 of 3 parts \(block 0 'inlet'\)"):
        assert blocks.voltet.render(window_size=(8, 8), engine="cpu")[..., 3].any()
    with pytest.warns(voltet.VoltetWarning, match="1 of 3 parts"):
        assert "T_gradient" in blocks.voltet.gradient("T")["two"].array_names
    del two.point_data["T"]
    for call in (lambda: blocks.voltet.render("T"), lambda: blocks.voltet.gradient("T"), lambda: blocks.voltet.grid(["T"])):
        with pytest.raises(voltet.UsageError, match="block 2 'two' has no array 'T'"):
            call()


def test_what_a_frame_raises_is_kept():
    p = plotter()
    grid = cube()
    v = p.voltet.add_volume(grid, "T", engine="cpu")
    shown(p)
    grid.GetPointData().RemoveArray("T")
    p.camera.azimuth = 5
    p.render()
    assert isinstance(v.error, voltet.Error)
    with pytest.raises(voltet.Error, match="no array 'T'"):
        v.raise_error()
    p.close()


def test_nothing_stays_of_a_plotter_that_is_closed():
    p = plotter()
    v = p.voltet.add_volume(cube(), "T", engine="cpu")
    shown(p)
    gone = weakref.ref(v)
    p.close()
    del v, p
    gc.collect()
    assert gone() is None


def test_surfaces_stand_in_the_volume_by_depth():
    camera = pv.Camera()
    camera.position, camera.focal_point, camera.up = (0.5, -4, 0.5), (0.5, 0.5, 0.5), (0, 0, 1)
    for parallel in (False, True):
        camera.parallel_projection = parallel
        camera.parallel_scale = 0.4
        for place, depth in ((-1.0, 0.0), (0.25, 0.25), (0.5, 0.5), (3.0, 1.0)):
            p = plotter()
            plane = pv.Plane(center=(0.5, place, 0.5), direction=(0, 1, 0), i_size=9, j_size=9)
            p.add_mesh(plane, color=(0.0, 0.0, 1.0), lighting=False)
            v = p.voltet.add_volume(
                cube(), "T", opacity=[0.9, 0.9], cmap=["red", "red"], show_scalar_bar=False, engine="cpu"
            )
            p.camera = camera.copy()
            img = shown(p)[45, 60].astype(float) / 255
            assert v.error is None
            alpha = 1 - (1 - round(0.9 * 255) / 255) ** depth
            assert np.abs(img - [alpha, 0, 1 - alpha]).max() < 0.015, (parallel, place, img, alpha)
            draws = v.draws
            p.render()
            assert v.draws == draws
            plane.points[:, 1] += 0.1
            plane.Modified()
            p.render()
            assert v.draws == draws + 1, "moved surfaces end rays elsewhere"
            p.close()


def test_pictures_larger_than_the_window_show_the_volume_where_it_is():
    p = plotter()
    p.voltet.add_volume(cube(), "T", opacity=[1.0, 1.0], show_scalar_bar=False, engine="cpu")
    p.add_mesh(pv.Plane(center=(0.5, 0.5, 0.5), direction=(1, 1, 1)), color="blue", lighting=False)
    small = shown(p).astype(float)
    large = p.screenshot(return_img=True, scale=2).astype(float)
    assert large.shape == (180, 240, 3)
    difference = np.abs(large.reshape(90, 2, 120, 2, 3).mean((1, 3)) - small)
    # Edges of surfaces fall otherwise.
    assert np.median(difference) < 1 and difference.mean() < 3, difference.mean()


WAYS = {
    "clear": lambda p, v: p.clear(),
    "clear_actors": lambda p, v: p.clear_actors(),
    "remove_actor": lambda p, v: p.remove_actor(v),
    "remove_actor before the next render": lambda p, v: p.remove_actor(v, render=False),
    "remove_actor by name": lambda p, v: p.remove_actor(v.name),
    "remove": lambda p, v: v.remove(),
    "hide": lambda p, v: v.SetVisibility(False),
    "visibility": lambda p, v: setattr(v, "visibility", False),
}


@pytest.mark.parametrize("rendered", [False, True], ids=["at once", "after a frame"])
@pytest.mark.parametrize("way", WAYS)
def test_a_volume_goes_as_other_actors_do(way, rendered):
    def volume():
        return p.voltet.add_volume(cube(), "T", name="v", opacity=[0.9, 0.9], show_scalar_bar=way not in ("hide", "visibility"), engine="cpu")

    p = plotter()
    p.camera_position = [(3, -2, 2), (0.5, 0.5, 0.5), (0, 0, 1)]
    v = volume()
    if rendered:
        assert (shown(p)[30:60, 45:75] != 255).any(-1).any()
    WAYS[way](p, v)
    is_hidden = way in ("hide", "visibility")
    assert list(p.voltet.volumes) == (["v"] if is_hidden else [])
    assert is_hidden or not p.scalar_bars.keys()
    # The next frame, and what is added to it.
    draws = v.draws
    p.render()
    assert (p.screenshot(return_img=True)[:70] == 255).all()
    p.add_mesh(pv.Plane(center=(0.5, 0.5, 0.5), direction=(1, 1, 1), i_size=9, j_size=9), color="blue", lighting=False)
    p.reset_camera_clipping_range()
    p.render()
    assert (p.screenshot(return_img=True)[45, 60] == [0, 0, 255]).all()
    assert v.draws == draws
    # What is removed can come again.
    if is_hidden:
        v.visibility = True
    else:
        assert volume() is p.voltet.volumes["v"]
        p.remove_actor("v")
        p.add_actor(v, name="v")
    p.render()
    assert v.draws > draws and v.error is None
    assert (p.screenshot(return_img=True)[45, 60] != [0, 0, 255]).any()
    p.close()


def test_nothing_stays_of_a_volume_that_is_cleared():
    p = plotter()
    v = p.voltet.add_volume(cube(), "T", engine="cpu")
    shown(p)
    gone = weakref.ref(v.pipeline)
    p.clear()
    del v
    gc.collect()
    assert gone() is None
    # One that nobody but the plotter has is drawn.
    p.voltet.add_volume(cube(), "T", opacity=[1.0, 1.0], show_scalar_bar=False, engine="cpu")
    gc.collect()
    p.render()
    (v,) = p.voltet.volumes.values()
    assert v.draws == 1 and (p.screenshot(return_img=True) != 255).any()
    p.close()


def test_a_volume_of_a_name_is_replaced_in_every_renderer():
    p = plotter(shape=(1, 2))
    old = p.voltet.add_volume(cube(), "T", name="v", show_scalar_bar=False, engine="cpu")
    p.subplot(0, 1)
    new = p.voltet.add_volume(cube(), "T", name="v", show_scalar_bar=False, engine="cpu")
    shown(p)
    assert p.voltet.volumes == {"v": new} and (old.draws, new.draws) == (0, 1)
    p.close()


def test_a_volume_that_is_moved_as_an_actor_says_so():
    p = plotter()
    v = p.voltet.add_volume(cube(), "T", engine="cpu")
    v.position = (1.0, 0.0, 0.0)
    shown(p)
    with pytest.raises(voltet.UsageError, match="'voltet 0' was moved"):
        v.raise_error()
    v.position = (0.0, 0.0, 0.0)
    p.render()
    assert v.error is None
    p.close()


def test_arrays_are_volumes_and_what_is_no_data_set_is_said():
    p = plotter()
    drawn = p.voltet.add_volume(np.arange(27.0).reshape(3, 3, 3), opacity=[0.0, 1.0], show_scalar_bar=False, engine="cpu")
    assert shown(p).any() and drawn.picture[..., 3].any()
    for wrong, message in ((3, "a int"), (None, "a NoneType"), (np.zeros((3, 3)), r"shape \(3, 3\)")):
        with pytest.raises(voltet.UsageError, match=message):
            p.voltet.add_volume(wrong)
    p.close()


def test_cameras_and_limits_that_are_none_are_said():
    with pytest.raises(voltet.UsageError, match="the camera is not known to PyVista: found 'nope'"):
        cube().voltet.render("T", camera="nope", window_size=(8, 8))
    with pytest.raises(voltet.UsageError, match="'clim' is no pair: found 'low'"):
        cube().voltet.render("T", clim="low", window_size=(8, 8))
