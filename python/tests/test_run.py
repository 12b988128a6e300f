"""`run`, `check`: pipeline files, as the command line takes them."""

import json
import os
import subprocess
import sys

import numpy as np
import pytest
from conftest import PIPELINES, ROOT

import voltet

SMALL = {"view.size": [64, 48], "picture.engine": "cpu"}


def test_a_file_gives_pictures_and_a_report(tmp_path):
    out = tmp_path / "q.png"
    result = voltet.run(PIPELINES / "quickstart.toml", set={**SMALL, "file.path": out})
    rgba = result.images["picture"]
    assert rgba.shape == (48, 64, 4) and rgba.dtype == np.float32 and rgba.flags.writeable
    assert np.isfinite(rgba).all() and 0.1 < rgba[..., 3].max() <= 1.0
    assert result.report["engine"] == "cpu" and result.report["counts"]["segments"] > 1000
    assert result.report["runs"][0]["engine"] == "cpu" and "voltet" in result.report["versions"]
    assert result.files == [str(out)] and out.stat().st_size > 0


def program():
    path = os.environ.get("VOLTET_PROGRAM")
    if not path:
        pytest.skip("VOLTET_PROGRAM names no program to compare with")
    return path


def test_the_picture_is_the_programs_own(tmp_path):
    file = tmp_path / "q.toml"
    p = voltet.Pipeline.open(PIPELINES / "quickstart.toml")
    p.set({**SMALL, "file.path": "p.exr"})
    p.save(file)
    subprocess.run([program(), "run", file, "--quiet"], check=True)
    again = voltet.run(tmp_path / "p.exr", set={"file.path": "again.exr"}).images["picture"]
    assert np.array_equal(again, p.run().images["picture"])


def test_mistakes_have_text_place_and_remedy(tmp_path):
    file = tmp_path / "wrong.toml"
    file.write_text('[pipeline]\nformat = 1\n\n[nodes.view]\ntype = "camera"\neye = [0, 0, 1]\ntarget = [0, 0, 0]\nfov = 30\n')
    with pytest.raises(voltet.Error) as raised:
        voltet.check(file)
    error = raised.value
    assert isinstance(error, voltet.UsageError) and isinstance(error, ValueError)
    assert (error.file, error.line, error.column, error.node) == (str(file), 8, 1, "view")
    assert "fov" in error.what and "fov_y" in error.expected and error.remedy == error.expected
    assert error.what in str(error) and f"{file}:8:1" in str(error)


def test_what_the_command_line_refuses_is_refused(tmp_path):
    with pytest.raises(voltet.UsageError, match="cannot be read"):
        voltet.run(tmp_path / "nowhere.toml")
    with pytest.raises(voltet.UsageError, match="no node 'veiw'") as raised:
        voltet.run(PIPELINES / "quickstart.toml", set={"veiw.size": [4, 4]})
    assert "view" in raised.value.expected
    with pytest.raises(voltet.UsageError, match="out of range|'size'"):
        voltet.run(PIPELINES / "quickstart.toml", set={"view.size": [0, 4]})
    with pytest.raises(voltet.UsageError, match="overwrite"):
        voltet.check(PIPELINES / "quickstart.toml", set={"grid.path": "quickstart.png"})
    with pytest.raises(voltet.UsageError, match="names no parameter"):
        voltet.run(PIPELINES / "quickstart.toml", set={"view": 1})


@pytest.mark.parametrize("name", sorted(path.name for path in PIPELINES.glob("*.toml")))
def test_the_pipelines_that_ship_are_in_order(name):
    assert isinstance(voltet.check(PIPELINES / name), list)


def test_errors_travel_between_processes():
    import pickle

    with pytest.raises(voltet.Error) as raised:
        voltet.check("nowhere.toml")
    back = pickle.loads(pickle.dumps(raised.value))
    assert type(back) is voltet.UsageError and str(back) == str(raised.value) and back.what == raised.value.what


def test_importing_loads_neither_numpy_nor_vtk():
    code = "import sys, voltet; print([m for m in ('numpy', 'vtk', 'vtkmodules', 'pyvista') if m in sys.modules])"
    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)
    assert done.stdout.strip() == "[]"


def test_probes_and_histograms_are_arrays():
    pipeline = voltet.Pipeline.open(PIPELINES / "histogram.toml")
    name = next(node for node in pipeline if pipeline[node].type == "histogram")
    found = pipeline.figures(name)
    assert found["volumes"].shape == (found["g"]["bins"], found["s"]["bins"])
    within = found["volume"] - found["volume_outside"] - found["volume_not_finite"]
    assert found["volumes"].sum() == pytest.approx(within, rel=1e-9)
    assert len(found["s_edges"]) == found["s"]["bins"] + 1


def test_a_study_is_rows_and_a_reference(slab, tmp_path, monkeypatch):
    monkeypatch.setenv("XDG_CACHE_HOME", str(tmp_path))
    found = slab.study(only=["analytic", "riemann"], frames=1, patience=1.0)
    assert found["reference"].shape == (16, 16, 4)
    labels = {row["label"].split()[0] for row in found["rows"]}
    assert labels and all(row["errors"] and row["cost"] for row in found["rows"])
    assert json.dumps({key: value for key, value in found.items() if key != "reference"})
    with pytest.raises(voltet.UsageError, match="only"):
        slab.study(only=["analytical"])
