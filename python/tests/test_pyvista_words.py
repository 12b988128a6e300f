"""PyVista's words of `add_volume`: those that mean something here work, others are refused with the reason."""

import importlib.util
import io
import inspect
import time

import numpy as np
import pytest

pv = pytest.importorskip("pyvista")
from conftest import ROOT  # noqa: E402
from test_pyvista import cube, plotter, shown  # noqa: E402

import voltet  # noqa: E402
from voltet import _words  # noqa: E402

SIZE = {"window_size": (9, 9), "engine": "cpu"}


def front(scale=0.25):
    camera = pv.Camera()
    camera.position, camera.focal_point, camera.up = (0.5, -4, 0.5), (0.5, 0.5, 0.5), (0, 0, 1)
    camera.parallel_projection = True
    camera.parallel_scale = scale
    return camera


def ramp(low=1.0, high=9.0):
    """A cube with T rising along z: rows of the picture from below."""
    grid = cube(9)
    grid["T"] = low + (high - low) * grid.points[:, 2]
    return grid


def column(grid, **words):
    """The middle column of a picture from below, without opacity: colours alone."""
    rgba = np.asarray(grid.voltet.render("T", opacity=[0.9, 0.9], camera=front(0.5), window_size=(16, 16), engine="cpu", **words))
    return (rgba[:, 8, :3] / rgba[:, 8, 3:])[::-1]


def test_every_word_of_add_volume_works_or_is_refused_by_name():
    from voltet.pyvista import PlotterAccessor

    words = set(inspect.signature(pv.Plotter.add_volume).parameters) - {"self", "kwargs"}
    taken = set(inspect.signature(PlotterAccessor.add_volume).parameters)
    assert words - taken <= set(_words.REFUSED)
    assert not taken & set(_words.REFUSED)


@pytest.mark.parametrize("word", _words.REFUSED)
def test_refused_words_say_the_reason_and_the_remedy(word):
    _, reason, remedy = _words.REFUSED[word]
    with pytest.raises(voltet.UsageError) as raised:
        cube().voltet.render("T", **{word: "something"}, **SIZE)
    assert str(raised.value) == f"'{word}' means nothing here: {reason}: found 'something'; expected {remedy}"
    p = plotter()
    with pytest.raises(voltet.UsageError, match=f"'{word}' means nothing here"):
        p.voltet.add_volume(cube(), "T", **{word: "something"})
    p.close()


def test_words_that_request_nothing_are_taken():
    plain = cube().voltet.render("T", **SIZE)
    nothing = {word: values[0] for word, (values, _, _) in _words.REFUSED.items() if values}
    assert np.array_equal(cube().voltet.render("T", **nothing, **SIZE), plain)
    assert np.array_equal(cube().voltet.render("T", user_matrix=np.eye(4), **SIZE), plain)
    with pytest.raises(voltet.UsageError, match="'user_matrix' means nothing here"):
        cube().voltet.render("T", user_matrix=2 * np.eye(4), **SIZE)
    with pytest.raises(voltet.UsageError, match="scalars=NAME"):
        cube().voltet.render(scalar="T", **SIZE)


def test_words_of_a_scene_are_refused_with_those_of_pyvista():
    p = plotter()
    for word, value in {"size": (9, 9), "unit_distance": 1.0, "extinction": 1.0, "look": {}}.items():
        with pytest.raises(voltet.UsageError, match=f"'{word}' is no word of add_volume; expected"):
            cube().voltet.render("T", **{word: value})
        with pytest.raises(voltet.UsageError, match=f"'{word}' is no word of add_volume; expected"):
            p.voltet.add_volume(cube(), scalars="T", **{word: value})
    for word in ("camera", "annotation"):
        with pytest.raises(voltet.UsageError, match=f"'{word}' is no word of add_volume; expected"):
            p.voltet.add_volume(cube(), scalars="T", **{word: {}})
    p.close()


def test_aliases_and_flipped_scalars():
    grid = ramp()
    viridis = column(grid, cmap="viridis", clim=(1, 9))
    assert np.array_equal(column(grid, colormap="viridis", rng=(1, 9)), viridis)
    flipped = column(grid, cmap="viridis", clim=(1, 9), flip_scalars=True)
    assert np.allclose(flipped, viridis[::-1], atol=0.01) and np.array_equal(flipped, column(grid, cmap="viridis_r", clim=(1, 9)))
    colors = ["red", "lime", "blue"]
    assert np.allclose(column(grid, cmap=colors, flip_scalars=True), column(grid, cmap=colors[::-1]))


def test_log_scale_stretches_the_colours_by_decades():
    grid = ramp(1.0, 100.0)
    got = column(grid, cmap="gray", log_scale=True, clim=(1, 100))
    # The middle of a row: z = (k + 0.5) / 16.
    values = 1.0 + 99.0 * (np.arange(16) + 0.5) / 16
    assert np.allclose(got[:, 0], np.log10(values) / 2, atol=0.02)
    for words, match in (({"clim": (0, 1)}, "'clim' is out of range.*numbers above 0, with log_scale"), ({}, "'log_scale' needs values above 0: found -1.0 to 9.0")):
        with pytest.raises(voltet.UsageError, match=match):
            ramp(-1.0).voltet.render("T", log_scale=True, **words, **SIZE)


def test_limits_are_numbers_of_any_type():
    grid = ramp()
    plain = column(grid, clim=(-9.0, 9.0))
    for clim in (9, np.float32(9), np.int64(9), np.array(9.0), np.array([-9, 9]), [np.float32(-9), 9]):
        assert np.array_equal(column(grid, clim=clim), plain), clim
    for clim in ("12", b"12", ("0", "1"), {0: 1, 1: 2}, (0, 10**400), (0, None), (1, 2, 3), True):
        with pytest.raises(voltet.UsageError, match="'clim' is no pair"):
            column(grid, clim=clim)
    with pytest.raises(voltet.UsageError, match="'opacity_unit_distance' is no number"):
        column(grid, opacity_unit_distance="far")


@pytest.mark.filterwarnings("default::voltet.VoltetWarning")
@pytest.mark.parametrize("words", [{"scalars": "U"}, {"scalars": "T", "categories": True}])
def test_each_warning_is_told_once(words):
    grid = cube(5)
    grid["U"][7] = grid["T"][7] = np.nan
    with pytest.warns(voltet.VoltetWarning, match="finite") as told:
        grid.voltet.render(**words, **SIZE)
    assert len(told) == 1, [str(warning.message) for warning in told]


def test_arrays_are_copied_as_numbers_that_vtk_has():
    x = np.linspace(1.0, 2.0, 64).reshape(4, 4, 4)
    drawn = lambda values: volume_of(values).picture
    expected = drawn(x)
    assert np.array_equal(drawn(pv.wrap(x)), expected) and expected[..., 3].max() > 0
    for values in (np.ma.masked_array(x), x.astype(np.longdouble)):
        assert np.array_equal(drawn(values), expected)
    half = x.astype(np.float16)
    assert np.array_equal(drawn(half), drawn(half.astype(float)))
    masked = np.ma.masked_where(x > 1.5, x)
    with pytest.warns(voltet.VoltetWarning, match="finite"):
        part = drawn(masked)
    with pytest.warns(voltet.VoltetWarning, match="finite"):
        assert np.array_equal(part, drawn(np.where(x > 1.5, np.nan, x)))
    for wrong in (x.astype("datetime64[s]"), x.astype(complex), x.astype(str)):
        with pytest.raises(voltet.UsageError, match="an array has a wrong type"):
            drawn(wrong)


def volume_of(values):
    """An array as a volume of a plotter that is shown."""
    p = plotter()
    volume = p.voltet.add_volume(values, show_scalar_bar=False, engine="cpu")
    p.show(auto_close=False)
    return volume


def test_colours_beyond_the_limits():
    got = column(ramp(0.0, 1.0), cmap=["lime", "lime"], clim=(0.25, 0.75), above_color="red", below_color="blue")
    expected = np.repeat([[0.0, 0, 1], [0, 1, 0], [1, 0, 0]], [4, 8, 4], axis=0)
    assert np.allclose(got, expected, atol=1e-3)
    # In a logarithm, too; and one alone.
    got = column(ramp(1.0, 9.0), cmap=["lime", "lime"], clim=(3.0, 7.0), log_scale=True, above_color="red", below_color="blue")
    assert np.allclose(got, expected, atol=1e-3)
    got = column(ramp(0.0, 1.0), cmap=["lime", "lime"], clim=(0.25, 0.75), above_color="red")
    assert np.allclose(got, np.repeat([[0.0, 1, 0], [1, 0, 0]], [12, 4], axis=0), atol=1e-3)
    with pytest.raises(voltet.UsageError, match="'above_color' is no colour"):
        cube().voltet.render("T", above_color="no such colour", **SIZE)


def test_categories_count_the_values():
    grid = cube(5)
    grid["T"] = np.floor(3.999 * grid.points[:, 2])
    for categories, count in ((True, 4), (7, 7), (False, 256)):
        p = plotter()
        v = p.voltet.add_volume(grid, "T", categories=categories, engine="cpu")
        assert len(v.pipeline["look"]["widgets.0.points"]) == count
        p.close()


def test_a_lookup_table_states_colours_opacity_and_range():
    table = pv.LookupTable(cmap=["red", "blue"], n_values=2, scalar_range=(1.0, 9.0))
    table.apply_opacity([0.5, 0.5])
    plain = cube().voltet.render("T", camera=front(), cmap=table, **SIZE)
    assert np.array_equal(cube().voltet.render("T", camera=front(), cmap=table, categories=3, **SIZE), plain)
    same = cube().voltet.render("T", camera=front(), cmap=["red", "blue"], n_colors=2, clim=(1, 9), opacity=[0.5, 0.5], **SIZE)
    assert np.allclose(plain, same, atol=4e-3)
    table.above_range_color = "lime"
    grid = ramp(9.0, 20.0)
    lime = grid.voltet.render("T", camera=front(), cmap=table, **SIZE)[4, 4]
    assert lime[1] == pytest.approx(lime[3], abs=1e-5) and lime[0] < 1e-5


def test_a_component_is_drawn_in_place_of_the_magnitude():
    grid = cube()
    for component in range(3):
        v = grid.voltet.render("U", component=component, camera=front(), opacity=[0.0, 1.0], **SIZE)
        grid["c"] = np.ascontiguousarray(grid["U"][:, component])
        assert np.allclose(v, grid.voltet.render("c", camera=front(), opacity=[0.0, 1.0], **SIZE), atol=1e-6)
    with pytest.raises(voltet.UsageError, match="'component' is out of range: found 3; expected a whole number, 0 to 2"):
        grid.voltet.render("U", component=3, **SIZE)


def test_shade_is_light_from_the_eye():
    # The gradient along the view: all of the light; across: the ambient share.
    along, across = cube(), cube()
    along["T"], across["T"] = along.points[:, 1], across.points[:, 0]
    words = {"cmap": ["white", "white"], "opacity": [0.9, 0.9], "camera": front(), "shade": True, **SIZE}
    for grid, ambient, diffuse, expected in ((along, None, None, 0.7), (along, 0.25, 0.5, 0.75), (across, 0.25, 0.5, 0.25)):
        rgba = grid.voltet.render("T", ambient=ambient, diffuse=diffuse, **words)[4, 4]
        assert rgba[0] / rgba[3] == pytest.approx(expected, abs=1e-3)
    p = plotter()
    v = p.voltet.add_volume(along, "T", shade=True, show_scalar_bar=False, engine="cpu")
    shown(p)
    first = v.pipeline["picture"]["light.direction"]
    p.camera.azimuth = 90
    p.render()
    second = v.pipeline["picture"]["light.direction"]
    assert abs(np.dot(first, second)) < 0.9 and np.allclose(second, p.camera.direction * -np.ones(3)) and v.draws == 2
    p.close()
    for words, match in (({"ambient": 0.3}, "'ambient' belongs to shade"), ({"shade": True, "light": {"direction": [0, 0, 1]}}, "stated twice")):
        with pytest.raises(voltet.UsageError, match=match):
            cube().voltet.render("T", **words, **SIZE)


def test_annotations_stand_at_the_scalar_bar():
    p = plotter()
    v = p.voltet.add_volume(cube(), "T", annotations={0.0: "cold", 3.0: "hot"}, above_color="red", engine="cpu")
    table = p.scalar_bars["T"].GetLookupTable()
    assert [table.GetAnnotation(i) for i in range(2)] == ["cold", "hot"] and table is v.mapper.lookup_table
    assert p.scalar_bars["T"].GetDrawAboveRangeSwatch()
    p.close()


@pytest.mark.parametrize("size", [(160, 120), (400, 300), (1024, 768)])
def test_labels_of_the_scalar_bar_are_not_cut_nor_run_into_each_other(size):
    grid = cube()
    grid["T"] = np.linspace(-12345.6, -1e-7, grid.n_points)
    p = pv.Plotter(off_screen=True, window_size=size)
    p.background_color = "white"
    v = p.voltet.add_volume(grid, "T", scalar_bar_args={"color": "black"}, engine="cpu")
    v.visibility = False
    dark = (shown(p).astype(int).max(axis=-1) < 100).any(axis=0)
    assert dark.any() and not dark[:2].any() and not dark[-2:].any()
    gaps = np.diff(np.flatnonzero(dark))
    count = p.scalar_bars["T"].GetNumberOfLabels()
    # Between labels there is more room than between letters.
    assert (gaps > 6).sum() >= count - 1
    p.close()


def test_picking_gives_cells_and_values():
    p = plotter()
    v = p.voltet.add_volume(cube(), "T", opacity=[0.5, 0.5], scale=0.5, show_scalar_bar=False, engine="cpu")
    with pytest.raises(voltet.UsageError, match="nothing was drawn yet"):
        v.pick(60, 45)
    shown(p)
    found = v.pick(60, 45)
    assert found["cells"] and all(0 <= cell["at_entry"]["s"] <= 3 for cell in found["cells"])
    assert np.allclose(found["drawn"]["rgba"], v.picture[22, 30], atol=1e-5)
    # The last pixel of the window, whatever its size was rounded to.
    v.pick(119, 89)
    p.close()


def test_the_page_lists_the_refused_words():
    page = (ROOT / "docs/src/how-to/migration.md").read_text()
    _, _, rest = page.partition("| word | reason | in its place |\n| --- | --- | --- |\n")
    rows = [f"| `{word}` | {reason} | {remedy} |" for word, (_, reason, remedy) in _words.REFUSED.items()]
    assert rest.split("\n\n")[0].splitlines() == rows


def test_opacity_and_unit_distance_beside_pyvistas():
    spec = importlib.util.spec_from_file_location("opacity", ROOT / "python/benches/opacity.py")
    bench = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(bench)
    for case in bench.CASES:
        formula, own, _ = bench.measured(*case)
        # PyVista's table cuts opacities off to eight bits, which is less than a level.
        assert abs(own - formula) <= 1.0, case
    assert bench.table() in (ROOT / "docs/src/how-to/migration.md").read_text()


def test_frames_that_a_remote_view_sends_hold_the_volume():
    # As trame's remote view makes them.
    Image = pytest.importorskip("PIL.Image")
    from vtkmodules.vtkWebCore import vtkWebApplication

    p = plotter()
    v = p.voltet.add_volume(cube(), "T", opacity=[0.9, 0.9], cmap=["black", "black"], show_scalar_bar=False, engine="cpu")
    shown(p)
    sender = vtkWebApplication()
    sender.SetImageEncoding(0)

    def sent():
        # It encodes on threads, and gives the last frame that is ready.
        sender.InvalidateCache(p.render_window)
        sender.StillRender(p.render_window, 100)
        for _ in range(500):
            if not sender.GetHasImagesBeingProcessed(p.render_window):
                break
            time.sleep(0.01)
        return np.array(Image.open(io.BytesIO(bytes(memoryview(sender.StillRender(p.render_window, 100))))).convert("RGB")).astype(int)

    for azimuth in (0, 40):
        p.camera.azimuth = azimuth
        frame = sent()
        assert v.error is None and frame.min() < 100
        # JPEG of the best quality rounds, and greys have no colours that it leaves out.
        assert np.abs(frame - p.screenshot(return_img=True)).max() <= 4
    assert v.draws == 2
    p.close()
