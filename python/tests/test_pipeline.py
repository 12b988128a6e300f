"""Pipelines built, changed and saved in code."""

import subprocess

import numpy as np
import pytest
from conftest import PIPELINES, uniform
from test_run import program

import voltet
from voltet import nodes, widgets


def test_a_uniform_slab_is_the_formula(slab):
    rgba = slab.render()
    opacity = 1.0 - np.exp(-2.0)
    assert np.allclose(rgba[..., 3], opacity, atol=2e-6)
    assert np.allclose(rgba[8, 8, :3], opacity * np.array([1.0, 0.5, 0.25]), atol=2e-6)


def test_what_serves_again_is_used_again(slab):
    slab.render()
    slab["view"]["eye"] = [0.6, -4.0, 0.5]
    ran = {node["name"]: node["reused"] for node in slab.render().report["nodes"]}
    assert ran["grid"] and ran["gradient"] and not ran["picture"]
    picture = slab.render()
    expected = picture.copy()
    # It is whose it is: what is written into it is not what is drawn next.
    picture[:] = 7.0
    assert np.array_equal(slab.render(), expected)
    slab.run()
    ran = {node["name"]: node["reused"] for node in slab.run().report["nodes"]}
    assert all(ran.values())


def test_functions_of_nodes_state_what_files_do(cube):
    p = voltet.Pipeline(title="T")
    grid = nodes.reader(p, "grid", path="data.vtu", scalar="T")
    gradient = nodes.gradient_magnitude(p, "gradient", grid=grid, method="least-squares")
    look = nodes.transfer_function(
        p, "look", unit_distance=1.0, widgets=[widgets.gaussian(color=[1, 1, 1], extinction=1.0, centre=[0, 0], sigma=[1, 1])]
    )
    view = nodes.camera(p, "view", eye=(0, -3, 0), target=np.zeros(3), size=np.array([8, 8]))
    nodes.renderer(p, "picture", volume=gradient, transfer_function=look, camera=view)
    assert list(p) == ["grid", "gradient", "look", "view", "picture"] and p.check() == []
    assert 'inputs = { volume = "gradient"' in p.text and "[[nodes.look.widgets]]" in p.text
    assert p["view"]["size"] == [8, 8] and p["look"]["widgets.0.centre"] == [0, 0]
    assert p["picture"].inputs == {"volume": "gradient", "transfer_function": "look", "camera": "view"}
    assert "camera" in nodes.camera.__doc__.lower() or nodes.camera.__doc__
    import inspect

    assert list(inspect.signature(nodes.camera).parameters)[:2] == ["pipeline", "node"]
    assert inspect.signature(nodes.reader).parameters["path"].default is inspect.Parameter.empty


def test_a_camera_is_stated_by_a_side_of_the_data(cube):
    widget = voltet.widgets.uniform(color=[1.0, 0.5, 0.25], extinction=2.0, region={"s": [-1e9, 1e9], "g": [-1e9, 1e9]})
    camera = {"view": "+x", "height": "auto", "zoom": 0.5}
    p = voltet.scene(voltet.Grid(**cube), widgets=[widget], camera=camera, size=(16, 16), engine="cpu")
    assert p["view"].inputs == {"volume": "gradient"}
    # Half of 94 % of 16 pixels, from 4.24 to 11.76.
    seen = p.render()[..., 3] > 0
    assert seen[4:12, 4:12].all() and seen.sum() == 64
    with pytest.raises(voltet.UsageError, match="exclude each other") as raised:
        p["view"]["eye"] = [0, 0, 9]
    assert raised.value.node == "view"


def test_mistakes_are_refused_where_they_are_made(slab):
    before = slab.text
    with pytest.raises(voltet.UsageError, match="fov") as raised:
        slab["view"]["fov"] = 30
    assert "fov_y" in raised.value.expected and raised.value.node == "view"
    with pytest.raises(voltet.UsageError, match="unknown node type"):
        slab.add("x", "rendrer")
    with pytest.raises(voltet.UsageError, match="already"):
        slab.add("view", "camera", eye=[0, 0, 1], target=[0, 0, 0])
    with pytest.raises(voltet.UsageError):
        slab["look"]["widgets.0.extinction"] = -1
    with pytest.raises(voltet.UsageError):
        slab["view"]["eye"] = "here"
    with pytest.raises(voltet.UsageError, match="type that pipelines do not know"):
        slab["view"]["eye"] = object()
    loop = []
    loop.append(loop)
    with pytest.raises(voltet.UsageError, match="too deeply"):
        slab["view"]["eye"] = loop
    with pytest.raises(voltet.UsageError, match="no node 'nobody'"):
        slab["nobody"]
    with pytest.raises(voltet.UsageError, match="not stated"):
        slab["view"]["near"]
    assert slab.text == before


def test_wires_names_and_nodes_change(slab):
    slab.rename("gradient", "slope")
    assert slab["picture"].inputs["volume"] == "slope"
    slab.add("other", "gradient-magnitude", grid="grid", method="cell-average")
    slab["picture"].connect("volume", "other")
    del slab["slope"]
    assert "slope" not in slab and len(slab) == 5
    assert slab.render().shape == (16, 16, 4)
    assert slab.undo() and "slope" in slab
    slab["picture"].connect("camera", None)
    with pytest.raises(voltet.UsageError, match="camera"):
        slab.render()


def test_comments_stay_in_files_that_are_changed(tmp_path):
    text = (PIPELINES / "quickstart.toml").read_text()
    p = voltet.Pipeline.open(PIPELINES / "quickstart.toml")
    p["view"]["size"] = [32, 24]
    p["file"]["path"] = str(tmp_path / "x.png")
    saved = tmp_path / "sub.toml"
    p.save(saved)
    new = saved.read_text()
    comments = [line.partition("#")[2] for line in text.splitlines() if "#" in line]
    assert comments and all(comment in new for comment in comments)
    # Its data are found from there, too.
    assert voltet.run(saved).images["picture"].shape == (24, 32, 4)


def test_a_saved_pipeline_runs_in_the_program(slab, tmp_path):
    before = slab.render()
    slab.add("file", "image-writer", path="slab.exr", image="picture")
    path = slab.save(tmp_path / "slab.toml")
    assert (tmp_path / "slab.grid.vtu").exists()
    assert np.array_equal(slab.render("picture"), before)
    again = voltet.run(path).images["picture"]
    assert np.array_equal(again, before)
    subprocess.run([program(), "check", path], check=True)
    subprocess.run([program(), "run", path, "--quiet"], check=True)
    assert (tmp_path / "slab.exr").stat().st_size > 0


def test_what_is_saved_writes_its_picture(slab, tmp_path):
    path = slab.save(tmp_path / "slab.toml")
    assert slab["file"]["path"] == "slab.png" and slab["file"].inputs == {"image": "picture"}
    subprocess.run([program(), "run", path, "--quiet"], check=True)
    assert np.array_equal(voltet.Pipeline.open(tmp_path / "slab.png").render(), slab.render("picture"))
    # One that writes is saved as it is.
    before = slab.text
    slab.save(tmp_path / "slab.toml")
    assert slab.text == before


def test_a_picture_is_opened_as_the_pipeline_that_it_carries(tmp_path):
    png = tmp_path / "q.png"
    own = voltet.Pipeline.open(PIPELINES / "quickstart.toml")
    own.set({"view.size": [32, 24], "file.path": "q.png"})
    own.save(tmp_path / "q.toml")
    first = own.run().images["picture"]
    p = voltet.Pipeline.open(png)
    assert p.path == str(png) and p["view"]["size"] == [32, 24]
    assert np.array_equal(p.render(), first)
    p.save(tmp_path / "from_picture.toml")
    assert png.stat().st_size > 0 and p.path == str(tmp_path / "from_picture.toml")


def test_progress_is_told_and_may_stop(slab):
    told = []
    slab.render(progress=lambda *moment: told.append(moment))
    assert told and all(len(moment) == 3 and 0.0 <= moment[2] <= 1.0 for moment in told)

    class Enough(Exception):
        pass

    def stop(node, stage, fraction):
        raise Enough

    with pytest.raises(Enough):
        slab.render(progress=stop)
    assert slab.render().shape == (16, 16, 4)
    slab["view"]["size"] = [20, 20]
    slab.render(progress=True)
    with pytest.raises(voltet.UsageError, match="call-back"):
        slab.render(progress="yes")


def test_pictures_show_themselves(slab, tmp_path):
    rgba = slab.render()
    png = rgba._repr_png_()
    assert png.startswith(b"\x89PNG") and (rgba * 2)[0, 0, 3] > 1 and not hasattr(rgba[0, 0, 0], "report")
    assert rgba[0]._repr_png_() is None
    rgba.save(tmp_path / "a.png", background=(1, 1, 1))
    rgba.save(tmp_path / "a.exr")
    assert (tmp_path / "a.exr").read_bytes()[:4] == b"\x76\x2f\x31\x01"
    with pytest.raises(voltet.UsageError, match="png or .exr"):
        rgba.save(tmp_path / "a.gif")
    result = slab.run()
    assert "<img" in result._repr_html_() and "cpu" in result._repr_html_()
    assert "<table" in slab._repr_html_() and "renderer" in slab._repr_html_()
    assert rgba.srgb8().shape == (16, 16, 3) and rgba.rgba8().shape == (16, 16, 4)


def test_the_size_is_known_before_drawing(slab):
    assert slab.size() == (16, 16)
    grid = voltet.Grid([[0, 0, 0], [1, 0, 0], [0, 1, 0], [0, 0, 1]], tetrahedra=[[0, 1, 2, 3]], point_data={"s": [0, 1, 2, 3]})
    assert uniform(grid, (8, 4)).size("picture") == (8, 4)
    with pytest.raises(voltet.UsageError, match="gives no picture"):
        slab.size("view")


def test_rays_that_end_see_what_is_before_their_end(slab):
    # The slab begins 4 before the eye and is 1 deep.
    depths = np.full((16, 16), np.inf)
    depths[:, :8] = 4.25
    depths[0] = 3.0
    rgba = slab.render_until(depths)
    assert np.allclose(rgba[1:, :8, 3], 1 - np.exp(-2 * 0.25), atol=1e-5)
    assert np.allclose(rgba[1:, 8:], slab.render()[1:, 8:], atol=1e-6) and (rgba[0] == 0).all()
    with pytest.raises(voltet.UsageError, match="shape"):
        slab.render_until(np.zeros((4, 4)))
    with pytest.raises(voltet.UsageError, match="not a number"):
        slab.render_until(np.full((16, 16), np.nan))
    # In several colours, too, where segments are sorted.
    look = slab["look"]["widgets"]
    slab["look"]["widgets"] = look + [{**look[0], "color": [0.0, 1.0, 0.0], "extinction": 1.0}]
    rgba = slab.render_until(depths)
    assert np.allclose(rgba[5, 3, 3], 1 - np.exp(-3 * 0.25), atol=1e-5)


def test_warnings_of_reports_are_warnings_of_python(cube):
    import warnings

    cube["point_data"]["T"][:] = 4.0
    grid = voltet.Grid(**cube)
    flat = voltet.scene(grid, size=(8, 8), engine="cpu")
    for draw in (flat.render, flat.run):
        with pytest.warns(voltet.VoltetWarning, match="picture: the picture is empty") as told:
            done = draw()
        assert [str(warning.message) for warning in told] == done.report["warnings"]
        assert [warning.filename for warning in told] == [__file__]
    # What a grid leaves out, at each entry that gives numbers or a picture.
    cube["point_data"]["T"][:] = cube["points"][:, 0]
    cube["point_data"]["T"][40] = np.nan
    some = voltet.scene(voltet.Grid(**cube), size=(8, 8), engine="cpu")
    some.add("seen", "histogram", volume="gradient")
    ends = np.full((8, 8), np.inf)
    entries = (
        lambda: some.render("picture"),
        lambda: some.volume("gradient"),
        lambda: some.figures("seen"),
        lambda: some.render_until(ends),
        lambda: some.pixel(4, 4),
        lambda: some.study(only=["analytic"], frames=1, patience=0.1),
    )
    for entry in entries:
        with pytest.warns(voltet.VoltetWarning, match="finite"):
            entry()
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        cube["point_data"]["T"][40] = 0.0
        some.render("picture")


def test_whole_numbers_are_not_rounded(cube, slab):
    grid = voltet.Grid(**cube)
    for call in (
        lambda: voltet.scene(grid, size=(2.5, 3)), lambda: voltet.scene(grid, size=8), lambda: slab.pixel(1.5, 2), lambda: slab.pixel(1, "2"),
        lambda: slab.pixel(1, 2, sample=0.0), lambda: slab.study(frames=2.5), lambda: voltet.Grid(**cube, subdivision=2.0),
        lambda: voltet.Grid(**cube, subdivision=True), lambda: voltet.gradient_test("least-squares", levels=[2.5]),
        lambda: voltet.gradient_test("least-squares", timed=4.0), lambda: voltet.gradient_test("least-squares", rounds="1"),
        lambda: voltet.Grid.from_pieces([{**{key: cube[key] for key in ("points", "tetrahedra", "point_data")}, "block": 0.5}]),
    ):
        with pytest.raises(TypeError, match="whole number") as raised:
            call()
        assert isinstance(raised.value, voltet.UsageError) and raised.value.expected
    for call in (lambda: slab.study(frames=-1), lambda: slab.pixel(1, 2, sample=-1), lambda: voltet.scene(grid, size=(0, 3))):
        with pytest.raises(voltet.UsageError, match="out of range"):
            call()
    # Parameters of pipelines are checked by their declarations.
    for path, value in (("view.size", [2.5, 3]), ("view.size", [8.0, 8.0]), ("picture.segments", 2.5)):
        with pytest.raises(voltet.UsageError, match=path.partition(".")[2]):
            slab.set({path: value})


def test_an_annotation_is_written_over_the_last_picture(cube):
    grid = voltet.Grid(**cube)
    plain = voltet.scene(grid, size=(200, 150), engine="cpu")
    annotated = voltet.scene(grid, size=(200, 150), engine="cpu", annotation={"axes": "directions", "unit": "K"})
    assert "figure" not in plain and list(annotated)[-1] == "figure"
    # Unnamed, the picture is the one that no other node writes over.
    drawn = annotated.render()
    assert np.array_equal(annotated.render("picture"), plain.render())
    changed = np.any(drawn != plain.render(), axis=2)
    assert 0.02 < changed.mean() < 0.5 and changed[:, 100:].any() and changed[75:, :60].any()


def test_a_scene_has_surfaces_and_clips(cube, tmp_path):
    grid = voltet.Grid(**cube)
    widget = voltet.widgets.uniform(color=[1.0, 0.5, 0.25], extinction=0.0, region={"s": [-1e9, 1e9]})
    scene = lambda **options: voltet.scene(
        grid, widgets=[widget], size=(40, 40), engine="cpu", camera={"view": "-y", "height": 0.5}, **options
    )
    slice = {"type": "slice", "normal": [0, 1, 0], "color": [0.25, 0.5, 1.0]}
    stl = tmp_path / "a.stl"
    stl.write_text("solid a\nfacet normal 0 0 0\nouter loop\nvertex -9 0 -9\nvertex 9 0 -9\nvertex 0 0 9\nendloop\nendfacet\nendsolid a\n")
    read = {"type": "surface-reader", "path": str(stl), "color": [1.0, 0.0, 0.0], "opacity": 0.5, "ambient": 1.0}
    both = scene(surfaces=[slice, read])
    assert list(both)[-3:] == ["surface_0", "surface_1", "picture"]
    assert np.allclose(scene(surfaces=[slice]).render()[20, 20], [0.25, 0.5, 1.0, 1.0])
    # The triangle stands before the cut.
    assert np.allclose(both.render()[20, 20], [0.625, 0.25, 0.5, 1.0])
    dense = [voltet.widgets.uniform(color=[1.0, 1.0, 1.0], extinction=2.0, region={"s": [-1e9, 1e9]})]
    half = {"kind": "plane", "origin": [0, 0.5, 0], "normal": [0, 1, 0]}
    through_the_middle = {"kind": "plane", "normal": [0, 1, 0]}
    for clip, depth in ((None, 1.0), ([half], 0.5), ([through_the_middle], 0.5), ([half, {**half, "invert": True}], 0.0)):
        picture = voltet.scene(
            grid, widgets=dense, size=(8, 8), engine="cpu", unit_distance=1.0, camera={"direction": [0, -1, 0], "height": 0.5}, clip=clip
        ).render()
        assert np.allclose(picture[4, 4, 3], 1.0 - np.exp(-2.0 * depth), atol=1e-5), clip
    for wrong in ([{"normal": [1, 0, 0]}], ["slice"]):
        with pytest.raises(voltet.UsageError, match="a surface is not stated"):
            scene(surfaces=wrong)
    with pytest.raises(voltet.UsageError, match="slcie"):
        scene(surfaces=[{"type": "slcie"}])
    with pytest.raises(voltet.UsageError, match="kind"):
        scene(clip=[{"normal": [1, 0, 0]}]).render()


@pytest.mark.parametrize(
    "words, what",
    [
        ({"widgets": 5}, "'widgets' is no list: found 5"), ({"widgets": {"kind": "uniform"}}, "'widgets' is no list"),
        ({"clip": 5}, "'clip' is no list: found 5"), ({"clip": "plane"}, "'clip' is no list"), ({"surfaces": 5}, "'surfaces' is no list"),
        ({"surfaces": [{"type": 5}]}, "the type of a surface is no name"), ({"look": 5}, "'look' is no mapping"),
        ({"look": {"widgets": []}}, "the scene states 'widgets' itself: found in look; expected widgets=… of the scene itself"),
        ({"look": {"unit_distance": 1}}, "the scene states 'unit_distance' itself"), ({"method": {"grid": "grid"}}, "the scene states 'grid' itself"),
        ({"annotation": {"image": "picture"}}, "the scene states 'image' itself"), ({"transfer_function": "x"}, "the scene states 'transfer_function' itself"),
        ({"surfaces": [{"type": "slice", "volume": "gradient"}]}, "the scene states 'volume' itself"),
        ({"camera": {"volume": "gradient"}}, "the scene states 'volume' itself"), ({"extinction": "2"}, "'extinction' is no number"),
        ({"extinction": True}, "'extinction' is no number"), ({"extinction": bytearray(b"2")}, "'extinction' is no number"),
        ({"extinction": 10**400}, "'extinction' is no number"), ({"extinction": np.ones(1)}, "'extinction' is no number"),
        ({"size": 5}, "'size' is no pair"),
    ],
)
def test_words_of_a_scene_that_are_none_are_said(cube, words, what):
    with pytest.raises(voltet.UsageError) as raised:
        voltet.scene(voltet.Grid(**cube), **words)
    assert str(raised.value).startswith(what)


def test_no_surfaces_and_clips_are_nothing(cube):
    scene = voltet.scene(voltet.Grid(**cube), surfaces=None, clip=[], look=None, extinction=np.float32(2), size=(8, 8))
    assert "surfaces" not in scene["picture"].inputs and "clip" not in scene["picture"].parameters


def test_a_threshold_takes_infinite_ends(cube):
    pipeline = voltet.scene(voltet.Grid(**cube), size=(16, 16), engine="cpu")
    pipeline.add("part", "threshold", volume="gradient", range=[-float("inf"), 1.5], smooth=True)
    pipeline.add("again", "renderer", volume="part", transfer_function="look", camera="view", engine="cpu")
    part = pipeline.render("again")
    assert 0.0 < part[..., 3].sum() < pipeline.render("picture")[..., 3].sum()


def test_backgrounds_and_nodes_that_are_none_are_said(slab, tmp_path):
    picture = slab.render()
    for background in ("white", (1, 1), 3, "111", b"111", ("1", "1", "1"), {0: 1, 1: 1, 2: 1}, (0, 0, 10**400)):
        for call in (lambda: picture.srgb8(background), lambda: picture.save(tmp_path / "a.png", background=background)):
            with pytest.raises(voltet.UsageError, match="the background is no colour: found"):
                call()
    for call in (lambda: slab.figures("nosuch"), lambda: slab.volume("nosuch")):
        with pytest.raises(voltet.UsageError, match="there is no node 'nosuch'; expected one of grid, gradient, look, view, picture"):
            call()
