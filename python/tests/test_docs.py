"""The examples in docstrings run, and the stubs are those of the declarations."""

import doctest
import importlib
import inspect
import subprocess
import sys

import pytest
from conftest import ROOT

import voltet

MODULES = ["voltet", "voltet._grid", "voltet._pipeline", "voltet._filters", "voltet._readers", "voltet._scene", "voltet.nodes", "voltet.widgets", "voltet.vtk", "voltet.pyvista"]


@pytest.mark.parametrize("name", MODULES)
def test_examples_run(name):
    found = doctest.testmod(importlib.import_module(name))
    assert found.failed == 0


def test_everything_public_is_described():
    for name in voltet.__all__:
        found = getattr(voltet, name)
        assert inspect.getdoc(found), name
        if inspect.isclass(found):
            for key, member in vars(found).items():
                if not key.startswith("_") and (callable(member) or isinstance(member, property)):
                    assert inspect.getdoc(member), f"{name}.{key}"


def test_stubs_are_made_of_the_declarations():
    subprocess.run([sys.executable, ROOT / "python/scripts/stubs.py", "--check"], check=True)


def test_stubs_fit_the_module():
    pytest.importorskip("mypy")
    stubs = ["voltet._native", "voltet.nodes", "voltet.widgets", "voltet.vtk", "voltet.pyvista"]
    config = ["--mypy-config-file", str(ROOT / "python/pyproject.toml")]
    done = subprocess.run([sys.executable, "-m", "mypy.stubtest", *stubs, *config], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_annotations_are_sound():
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", "mypy", "-p", "voltet"]
    done = subprocess.run(command, capture_output=True, text=True, cwd=ROOT / "python")
    assert done.returncode == 0, done.stdout


EXAMPLES = sorted((ROOT / "examples/python").glob("*.py"))


@pytest.mark.parametrize("script", EXAMPLES, ids=lambda script: script.stem)
def test_examples_draw_their_pictures(script, tmp_path):
    for package in ("matplotlib", "pyvista"):
        pytest.importorskip(package)
    picture = tmp_path / f"{script.stem}.jpg"
    done = subprocess.run([sys.executable, script, picture], capture_output=True, text=True, cwd=tmp_path, timeout=600)
    assert done.returncode == 0, done.stderr
    assert picture.read_bytes().startswith(b"\xff\xd8"), "a JPEG"


def test_examples_are_typed():
    pytest.importorskip("mypy")
    config = ["--config-file", ROOT / "python/pyproject.toml"]
    done = subprocess.run([sys.executable, "-m", "mypy", "--strict", *config, *EXAMPLES], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_the_gallery_has_every_example():
    page = (ROOT / "docs/src/gallery.md").read_text()
    assert len(EXAMPLES) > 3 and all(f"images/gallery/{script.stem}.jpg" in page for script in EXAMPLES)


def test_the_example_of_the_page_on_migration_runs(tmp_path, monkeypatch):
    import re

    pytest.importorskip("pyvista")
    monkeypatch.chdir(tmp_path)
    page = (ROOT / "docs/src/how-to/migration.md").read_text()
    (block,) = re.findall(r"```python\n(.*?)```", page, re.S)
    names = {}
    exec(compile(block, "docs/src/how-to/migration.md", "exec"), names)
    assert names["picture"].shape == (480, 640, 4) and (tmp_path / "T.png").exists()


def test_the_page_is_true(cube, tmp_path, monkeypatch):
    import re

    import numpy as np

    matplotlib = pytest.importorskip("matplotlib")
    page = (ROOT / "docs/src/how-to/python.md").read_text()
    (tmp_path / "scene.toml").write_text((ROOT / "pipelines/quickstart.toml").read_text())
    (tmp_path / "pipelines").mkdir()
    (tmp_path / "data").symlink_to(ROOT / "data")
    (tmp_path / "pipelines/quickstart.toml").write_text((ROOT / "pipelines/quickstart.toml").read_text())
    write_series(tmp_path)
    monkeypatch.chdir(tmp_path)
    matplotlib.use("agg")
    tetrahedra = cube["tetrahedra"]
    names = {
        "voltet": voltet, "np": np, "points": cube["points"], "temperature": cube["point_data"]["T"],
        "cell_types": np.full(len(tetrahedra), 10), "offsets": np.arange(0, tetrahedra.size + 1, 4),
        "connectivity": tetrahedra.reshape(-1), "gradient": None, "mesh": {key: cube[key] for key in ("points", "tetrahedra", "point_data")},
    }
    vtk = pytest.importorskip("vtk")
    names["reader"] = vtk.vtkRTAnalyticSource(whole_extent=(-4, 4, -4, 4, -4, 4))
    names["camera"] = vtk.vtkCamera(position=(0, -40, 0), view_up=(0, 0, 1))
    for block in re.findall(r"```python\n(.*?)```", page, re.S):
        if "pyvista" in block:
            pv = pytest.importorskip("pyvista")
            names["grid"] = pv.ImageData(dimensions=(5, 5, 5)).cast_to_unstructured_grid()
            names["grid"]["T"] = np.linspace(0, 100, 125)
        exec(compile(block.replace('0, "T")', '0, "RTData")'), "docs/src/how-to/python.md", "exec"), names)
    first, last = [(tmp_path / f"run_{step:04}.png").read_bytes() for step in (0, 5)]
    assert first != last and not (tmp_path / "run_0001.png").exists()
    assert names["picture"].shape == (600, 800, 4) and (tmp_path / "T.toml").exists() and (tmp_path / "figure.png").exists()


def write_series(folder):
    """A pipeline of a series of six steps: a = x, more of it in every step."""
    steps = ""
    for step in range(6):
        values = " ".join(str(i % 3 * (step + 1)) for i in range(27))
        (folder / f"step{step}.vti").write_text(
            '<VTKFile type="ImageData" version="0.1"><ImageData WholeExtent="0 2 0 2 0 2" Origin="0 0 0" Spacing="1 1 1">'
            f'<Piece Extent="0 2 0 2 0 2"><PointData><DataArray type="Float64" Name="a" format="ascii">{values}'
            "</DataArray></PointData></Piece></ImageData></VTKFile>"
        )
        steps += f'<DataSet timestep="{step}" file="step{step}.vti"/>'
    (folder / "all.pvd").write_text(f'<VTKFile type="Collection" version="0.1"><Collection>{steps}</Collection></VTKFile>')
    (folder / "series.toml").write_text("""[pipeline]
format = 1
[nodes.grid]
type = "reader"
path = "all.pvd"
[nodes.look]
type = "transfer-function"
unit_distance = 1.0
[[nodes.look.widgets]]
kind = "colormap"
range = [0.0, 12.0]
extinction = 1.0
[nodes.view]
type = "camera"
view = "isometric"
size = [32, 24]
inputs = { volume = "grid" }
[nodes.picture]
type = "renderer"
inputs = { volume = "grid", transfer_function = "look", camera = "view" }
[nodes.file]
type = "image-writer"
path = "series.png"
inputs = { image = "picture" }
""")
