"""Grids, pipelines and pictures in other processes: pickled, as spawn, Dask and joblib do it."""

import pickle
from multiprocessing import get_context
from pathlib import Path

import numpy as np
import pytest
from conftest import PIPELINES, uniform

import voltet


def drawn(pipeline):
    return pipeline.render()


def bounds(grid):
    return grid.bounds


@pytest.fixture(scope="module")
def spawned():
    with get_context("spawn").Pool(1) as pool:
        yield pool


def test_a_pipeline_with_its_grid_is_drawn_in_a_spawned_process(cube, spawned):
    pipeline = uniform(voltet.Grid(**cube))
    there = spawned.apply(drawn, (pipeline,))
    assert isinstance(there, voltet.Picture) and np.array_equal(there, pipeline.render())
    assert there.report["engine"] == "cpu" and there[8, 8, 3] == pytest.approx(1 - np.exp(-2), abs=1e-5)


def test_a_grid_keeps_arrays_options_and_warnings(cube, spawned):
    grid = voltet.Grid(**cube, constant_cells=True, watch=False)
    again = pickle.loads(pickle.dumps(grid))
    assert again.about == grid.about and again._options == grid._options and again._watch is False
    assert spawned.apply(bounds, (grid,)) == grid.bounds
    again._pieces[0]["point_data"]["T"][:] = 0.0
    again.modified()
    assert again.arrays["T"] == (0.0, 0.0) and grid.arrays["T"] == (0.0, 3.0)


def test_a_file_is_found_from_its_folder_and_what_was_changed_stays(tmp_path, monkeypatch):
    monkeypatch.chdir(PIPELINES)
    pipeline = voltet.Pipeline.open("contours.toml")
    pipeline["view"]["size"] = [16, 12]
    data = pickle.dumps(pipeline)
    monkeypatch.chdir(tmp_path)
    again = pickle.loads(data)
    assert again.text == pipeline.text and again.path == str(PIPELINES / "contours.toml")
    assert again.render().shape == (12, 16, 4)
    # One that was never saved, and an empty one.
    for own in (voltet.Pipeline(), voltet.Pipeline(title="nothing yet")):
        again = pickle.loads(pickle.dumps(own))
        assert again.text == own.text and again.path is None


def test_a_picture_that_carries_its_pipeline_is_not_written_over(tmp_path):
    (tmp_path / "a.toml").write_text((PIPELINES / "contours.toml").read_text())
    pipeline = voltet.Pipeline.open(tmp_path / "a.toml")
    pipeline["view"]["size"] = [16, 12]
    (picture,) = pipeline.run().files
    again = pickle.loads(pickle.dumps(voltet.Pipeline.open(picture)))
    with pytest.raises(voltet.UsageError, match="no file yet"):
        pickle.loads(pickle.dumps(again))._native.save(None, [])
    assert again.render().shape == (12, 16, 4)
    # Nor one that is not seen from the other process.
    data = pickle.dumps(voltet.Pipeline.open(picture))
    Path(picture).unlink()
    again = pickle.loads(data)
    with pytest.raises(voltet.UsageError, match="no file yet"):
        again._native.save(None, [])
    assert again.path == str(Path(picture)) and again.render().shape == (12, 16, 4)


def test_results_keep_their_reports(cube):
    pipeline = uniform(voltet.Grid(**cube))
    result = pickle.loads(pickle.dumps(pipeline.run()))
    assert result.report["runs"] and result.images["picture"].report["engine"] == "cpu"
    part = pickle.loads(pickle.dumps(result.images["picture"][:2]))
    assert part.shape == (2, 16, 4) and part.report == result.report
