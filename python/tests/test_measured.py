"""One pixel cell by cell, and the test of gradient filters."""

import json
import subprocess

import numpy as np
import pytest
from conftest import PIPELINES
from test_run import program

import voltet


def test_a_pixel_is_the_sum_of_its_cells(slab):
    drawn = slab.render()
    found = slab.pixel(8, 5)
    assert np.allclose(found["drawn"]["rgba"], drawn[5, 8], atol=1e-6)
    assert np.allclose(found["referee_rgba"], drawn[5, 8], atol=1e-5)
    assert np.allclose(np.sum([cell["adds"] for cell in found["cells"]], axis=0), found["referee_rgba"], atol=1e-9)
    assert sum(cell["length"] for cell in found["cells"]) == pytest.approx(1.0, abs=1e-9)
    assert all(0 <= cell["cell"] < 625 and cell["cell_type"] == "tetrahedron" for cell in found["cells"])
    first = found["cells"][0]["at_entry"]
    assert first["s"] == pytest.approx(found["ray"]["origin"][0], abs=1e-6) and first["g"] == pytest.approx(np.sqrt(5))
    assert "uniform" in str(found) and found.plot.startswith("<svg") and "<svg" in found._repr_html_()
    with pytest.raises(voltet.UsageError, match="16"):
        slab.pixel(16, 0)
    with pytest.raises(voltet.UsageError):
        slab.pixel(0, 0, "view")
    # The picture is as it was.
    assert np.array_equal(slab.render(), drawn)


def test_a_pixel_is_what_the_program_says(tmp_path):
    p = voltet.Pipeline.open(PIPELINES / "quickstart.toml")
    p.set({"view.size": [40, 30], "picture.engine": "cpu"})
    p.save(tmp_path / "q.toml")
    out = tmp_path / "pixel.json"
    subprocess.run([program(), "pixel", tmp_path / "q.toml", "20", "15", "--json", out], check=True, capture_output=True)
    expected, found = json.loads(out.read_text()), dict(p.pixel(20, 15))
    # What engines draw is rounded to 32 bits, by their versions in ways of their own.
    assert found.pop("drawn")["rgba"] == pytest.approx(expected.pop("drawn")["rgba"], abs=1e-4)
    assert found == expected


def test_a_filter_of_ones_own_is_tested():
    @voltet.gradient_filter("not-a-gradient")
    def zero(points, tetrahedra, scalar, *, value: float = 0.0):
        return np.full((len(points), 3), value)

    small = {"levels": [2, 4], "timed": 4, "rounds": 1}
    found = voltet.gradient_test("not-a-gradient", beside=["least-squares"], set={"value": 1.0}, **small)
    assert not found["passed"] and [f["name"] for f in found["filters"]] == ["not-a-gradient", "least-squares"]
    assert found["filters"][0]["parameters"] == [["value", "1.0"]]
    broken = {one["what"] for one in found["requirements"] if not one["holds"]}
    assert any("linear" in what for what in broken) and "not-a-gradient" in str(found)
    assert voltet.gradient_test("not-a-gradient", beside=[], hold_to=["finite"], **small)["passed"]


def test_a_page_is_written_and_mistakes_are_refused(tmp_path):
    small = {"levels": [2, 4], "timed": 4, "rounds": 1, "beside": []}
    stages = set()
    voltet.gradient_test("cell-average", output=tmp_path / "c.html", progress=lambda *told: stages.add(told[0]), **small)
    assert "<svg" in (tmp_path / "c.html").read_text() and stages
    for wrong in ({"levels": [4]}, {"timed": 1}, {"rounds": 0}, {"hold_to": ["all"]}, {"set": {"x": 1}}, {"beside": ["least"]}):
        with pytest.raises(voltet.UsageError):
            voltet.gradient_test("cell-average", **{**small, **wrong})
    with pytest.raises(voltet.UsageError, match="least-squares"):
        voltet.gradient_test("least-square")
    with pytest.raises(voltet.UsageError, match="array"):
        voltet.gradient_test("array")
