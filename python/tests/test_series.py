"""Pictures of a series from Python, as `voltet run` draws them with the options of the same names."""

import numpy as np
import pytest
from test_docs import write_series

import voltet


@pytest.fixture
def series(tmp_path):
    """Six steps at the times 0 to 5, of a that grows; relative to the data nothing."""
    write_series(tmp_path)
    return voltet.Pipeline.open(tmp_path / "series.toml")


def test_steps_are_those_of_the_command_and_the_pipeline_stays_as_it_was(series):
    before = series.text
    frames = list(series.frames(steps="0:5:2"))
    assert [(frame.number, frame.step, frame.time) for frame in frames] == [(0, 0, 0.0), (1, 2, 2.0), (2, 4, 4.0)]
    assert frames[1].label == "step 2, time 2" and series.text == before and not series.undo()
    for frame in frames:
        series["grid"]["time_step"] = frame.step
        assert np.array_equal(series.render(), frame.picture)
    assert not np.array_equal(frames[0].picture, frames[1].picture)


@pytest.mark.parametrize(
    ("words", "steps"),
    [
        ({"steps": "all"}, [0, 1, 2, 3, 4, 5]), ({"steps": "3,-1"}, [3, 5]), ({"steps": range(1, 3)}, [1, 2]), ({"steps": np.array([4])}, [4]),
        ({"steps": 2}, [2]), ({"times": "1:3"}, [1, 2, 3]), ({"steps": "all", "part": "2/3"}, [1, 4]),
    ],
)
def test_selections(series, words, steps):
    assert [frame.step for frame in series.frames(**words)] == steps


def test_sweeps_and_turns_of_the_camera(series):
    values = [0.5, 1.0, 2.0]
    swept = list(series.frames(steps=5, sweep={"look.widgets.0.extinction": values}))
    light = [float(frame.picture[..., 3].sum()) for frame in swept]
    assert light == sorted(light) and light[0] < light[-1]
    assert ["extinction = 0.5" in frame.label for frame in swept] == [True, False, False]
    series["view"]["orbit"] = 90.0
    turned = list(series.frames(steps=5, turns=3))
    assert [frame.number for frame in turned] == [0, 1, 2] and not np.array_equal(turned[0].picture, turned[2].picture)


def test_files_in_place_of_the_readers_own(series, tmp_path):
    frames = list(series.frames(files=[tmp_path / "step*.vti"]))
    assert len(frames) == 6 and frames[3].label == "step3"
    one = list(series.frames(files=str(tmp_path / "step*.vti")))
    assert [frame.label for frame in one] == [frame.label for frame in frames]
    alike = [frame.picture for frame in series.frames(steps="all")]
    assert all(np.array_equal(frame.picture, other) for frame, other in zip(frames, alike))


def test_a_frame_that_fails_leaves_the_pipeline_as_it_was(series, tmp_path):
    before = series.text
    (tmp_path / "step1.vti").write_text("no file of VTK")
    frames = series.frames(steps="0:2", ranges="step")
    next(frames)
    with pytest.raises(voltet.RunError):
        next(frames)
    assert series.text == before


def test_wrong_selections_say_what_would_be_right(series):
    for words, match in (
        ({"steps": "0:x"}, "'steps' is not understood: found 0:x"), ({"steps": 9}, "9"), ({"steps": "1", "times": "1"}, "'steps' or 'times'"),
        ({"ranges": "some"}, "'ranges' is no such word: found some"), ({"part": "3/2"}, "'part' is not understood: found 3/2"),
        ({"sweep": {"nothing": [1]}}, "a sweep names no parameter: found nothing; expected node.parameter"),
        ({"sweep": {"look.nothing": [1]}}, "nothing"), ({"steps": [None]}, "'steps' is no selection"), ({"steps": []}, "'steps' is no selection"),
        ({"files": ["no_such_*.vtu"]}, "no file has such a name: found 'no_such_"), ({"turns": 0}, "'turns' is out of range: found 0"),
        ({"turns": -1}, "'turns' is out of range: found -1"), ({"sweep": {"look.unit_distance": []}}, "a sweep has no values: found look.unit_distance"),
        ({"sweep": {"look..a": [1]}}, "a sweep names no parameter"), ({"sweep": {"look.unit_distance": "12"}}, "the values of a sweep are no list: found '12'"),
    ):
        with pytest.raises(voltet.UsageError, match=match):
            list(series.frames(**words))
