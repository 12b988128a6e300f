"""Readers of file formats that are Python functions."""

import re

import numpy as np
import pytest
from conftest import ROOT

import voltet

LOOK = {"kind": "piecewise-linear", "points": [[0.0, 0.1, 0.2, 0.9, 0.1], [1.5, 0.2, 0.8, 0.3, 0.5], [3.0, 0.9, 0.1, 0.1, 2.0]]}


def scene(path, type="reader", **settings):
    """A pipeline that reads a file, and draws it at 24 × 16 pixels."""
    pipeline = voltet.Pipeline()
    pipeline.add("grid", type, path=str(path), **settings)
    pipeline.add("look", "transfer-function", unit_distance=1.0, widgets=[LOOK])
    pipeline.add("view", "camera", eye=[-1.5, -2.5, 1.8], target=[0.5, 0.5, 0.5], size=[24, 16])
    pipeline.add("picture", "renderer", volume="grid", transfer_function="look", camera="view", engine="cpu")
    return pipeline


def draw(path, type="reader", **settings):
    return scene(path, type, **settings).render()


@pytest.fixture
def written(cube, tmp_path):
    """The cube's file as VTK's XML, written by the program."""
    given = scene(tmp_path / "none", scalar="T")
    given.add("file", "grid-writer", volume="grid", path=str(tmp_path / "cube.vtu"), point_arrays=["T", "U"])
    given.give(voltet.Grid(**cube), "grid")
    given.run()
    return tmp_path / "cube.vtu"


@pytest.fixture
def archive(cube, tmp_path):
    """The cube as an archive of numpy."""
    path = tmp_path / "cube.archive"
    with path.open("wb") as file:
        np.savez(file, points=cube["points"], tetrahedra=cube["tetrahedra"], **cube["point_data"])
    return path


def arguments(path):
    file = np.load(path)
    return {"points": file["points"], "tetrahedra": file["tetrahedra"], "point_data": {"T": file["T"], "U": file["U"]}}


def test_a_file_gives_the_picture_of_a_vtu(written, archive, cube):
    @voltet.grid_reader("archives", extensions=[".archive"], summary="Reads archives.")
    def read(path, *, scale: float = 1.0):
        given = arguments(path)
        return {**given, "points": scale * given["points"], "scalar": "T"}

    for scalar in (None, "T", "U:0"):
        wanted = draw(written, scalar=scalar or "T")
        assert wanted[..., 3].max() > 0.3
        for type in ("archives", "reader"):
            assert draw(archive, type, scalar=scalar).tobytes() == wanted.tobytes()
    # Its parameter is its own, and is checked.
    assert draw(archive, "archives", scale=0.5).tobytes() != draw(archive, "archives").tobytes()
    with pytest.raises(voltet.UsageError, match="scale"):
        draw(archive, "archives", scale="x")
    with pytest.raises(voltet.UsageError, match="scale"):
        draw(archive, scale=0.5)
    with pytest.raises(voltet.RunError, match="V") as raised:
        draw(archive, scalar="V")
    assert raised.value.node == "grid" and "'T'" in raised.value.expected and str(archive) in str(raised.value)
    # A cell array of the same numbers is drawn as that of a file.
    @voltet.grid_reader("archives-of-cells", extensions=[])
    def with_cells(path):
        given = arguments(path)
        return {**given, "point_data": {}, "cell_data": {"C": np.arange(len(given["tetrahedra"])) % 3}}

    grid = voltet.Grid(cube["points"], tetrahedra=cube["tetrahedra"], cell_data={"C": np.arange(len(cube["tetrahedra"])) % 3})
    lent = scene(archive, scalar="C")
    lent.give(grid, "grid")
    assert draw(archive, "archives-of-cells").tobytes() == lent.render().tobytes()


def test_meshes_are_taken_as_grids_are(written, archive):
    pv = pytest.importorskip("pyvista")
    meshio = pytest.importorskip("meshio")
    wanted = draw(written, scalar="T")
    made = {
        "pyvista": lambda path: pv.read(written),
        "grid": lambda path: voltet.Grid(**arguments(path), scalar="T"),
        "meshio": lambda path: meshio.Mesh(arguments(path)["points"], [("tetra", arguments(path)["tetrahedra"])], arguments(path)["point_data"]),
        "series": lambda path: {"mesh": pv.read(written), "times": [2.5]},
    }
    for name, function in made.items():
        voltet.grid_reader(f"mesh-of-{name}", extensions=[".archive"])(function)
        assert draw(archive, f"mesh-of-{name}", scalar="T").tobytes() == wanted.tobytes(), name
    blocks = pv.MultiBlock([pv.read(written), pv.read(written)])
    voltet.grid_reader("mesh-of-blocks", extensions=[])(lambda path: blocks)
    with pytest.raises(voltet.RunError, match="the reader 'mesh-of-blocks': the reader gave several grids: found 2"):
        draw(archive, "mesh-of-blocks")


def test_only_what_is_drawn_is_read(archive):
    class Lazy:
        """An array that counts how often it is read."""

        def __init__(self, values):
            self.values, self.shape, self.reads = values, values.shape, 0

        def __array__(self, dtype=None, copy=None):
            self.reads += 1
            return np.asarray(self.values, dtype)

    calls, arrays = [], {}

    @voltet.grid_reader("lazy", extensions=[])
    def read(path, step):
        calls.append(step)
        given = arguments(path)
        arrays.update({name: Lazy(values + step) for name, values in given.pop("point_data").items()})
        return {**given, "points": Lazy(given["points"]), "point_data": dict(arrays), "times": [0.0, 1.0, 4.0], "scalar": "T"}

    pipeline = scene(archive, "lazy")
    first = pipeline.render()
    assert calls == [0] and arrays["T"].reads == 1 and arrays["U"].reads == 0
    pipeline["view"]["size"] = [20, 16]
    pipeline.render()
    assert calls == [0], "the grid that was read serves again"
    second = draw(archive, "lazy", time=0.9)
    assert calls == [0, 0, 1] and second.tobytes() != first.tobytes()
    with pytest.raises(voltet.RunError, match="no such step"):
        draw(archive, "lazy", time_step=3)


@pytest.mark.parametrize(
    "changed, match",
    [
        ({"points": None}, "the reader gave no points"), ({"points": [0.0, 1.0]}, "the points are not three numbers each"),
        ({"tetrahedra": None}, "cells are not stated"), ({"tetrahedra": [[0, 1, 2]]}, "not four point numbers"),
        ({"tetrahedra": [[0, 1, 2, 216]]}, "216"), ({"tetrahedra": [[0, 1, 2, -1]]}, "-1"), ({"tetrahedra": [[0.0, 1, 2, 3]]}, "float"),
        ({"point_data": {"T": np.zeros(3)}}, "wrong shape"), ({"point_data": {"T": [[1.0], [1.0, 2.0]]}}, "cannot be made"),
        ({"point_data": {"T": np.zeros(216, complex)}}, "complex"), ({"point_data": {}}, "no quantity"), ({"scalar": "V"}, "'V'"),
        ({"times": [1.0, 1.0]}, "do not ascend"), ({"times": [0.0, 1.0]}, "takes no step"), ({"arrays": {}}, "not known: found arrays"),
    ],
)  # fmt: skip
def test_what_it_gives_wrongly_is_one_error(archive, changed, match):
    @voltet.grid_reader("wrong", extensions=[".archive"])
    def read(path):
        return {**arguments(path), **changed}

    with pytest.raises(voltet.RunError, match=re.escape(match)) as raised:
        draw(archive, "wrong", scalar=None if "scalar" in changed else "T")
    assert raised.value.node == "grid" and str(archive) in str(raised.value)


def test_what_it_raises_is_the_cause(archive):
    @voltet.grid_reader("torn", extensions=[])
    def torn(path):
        raise OSError("line 7 is torn")

    for given, match in ((torn, "raised an exception.*line 7 is torn"), (lambda path: 3, "gave no grid: found a builtins.int")):
        voltet.grid_reader("torn", extensions=[])(given)
        with pytest.raises(voltet.RunError, match=match) as raised:
            draw(archive, "torn")
        assert raised.value.__cause__ is not None and str(archive) in str(raised.value)


def test_declarations_that_contradict_themselves_are_refused():
    for arguments in ({"name": "reader"}, {"name": "wavelet"}, {"parameters": {"path": "x"}}, {"extensions": ".xyz"}, {"extensions": [""]}, {"magic": b"x" * 65}):
        with pytest.raises(voltet.UsageError):
            voltet.grid_reader(**{"name": "odd", "extensions": [".xyz"], **arguments})(lambda path: None)


def test_first_bytes_decide_and_pictures_name_the_reader(archive, tmp_path):
    (tmp_path / "renamed").write_bytes(archive.read_bytes())

    @voltet.grid_reader("by-begin", extensions=[], magic=b"PK\x03\x04")
    def read(path):
        return {**arguments(path), "scalar": "T"}

    pipeline = scene(tmp_path / "renamed")
    pipeline.add("file", "image-writer", image="picture", path=str(tmp_path / "named.png"))
    report = pipeline.run().report
    assert report["nodes"][0]["type"] == "by-begin"
    assert b'"plugins":[{"node":"grid","name":"Python"' in (tmp_path / "named.png").read_bytes()


def test_the_tutorial_is_true(monkeypatch):
    page = (ROOT / "docs/src/tutorials/reader.md").read_text()
    (code,) = re.findall(r"```python\n(.*?)```", page, re.S)
    monkeypatch.chdir(ROOT)
    names: dict = {}
    exec(compile(code, "docs/src/tutorials/reader.md", "exec"), names)
    assert names["picture"].shape == (120, 160, 4) and names["picture"][..., 3].max() > 0.1
    # The numbers are those of the file's second step, in C's order.
    given = names["read_cells"]("examples/plugin_c/box.cells", step=1)
    text = (ROOT / "examples/plugin_c/box.cells").read_text().split()
    assert given["cell_data"]["material"].reshape(-1).tolist() == [float(word) for word in text[-64:]]
