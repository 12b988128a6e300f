"""Gradient filters that are Python functions."""

import subprocess
import sys
import textwrap

import numpy as np
import pytest

import voltet


def scene(cube, method):
    return voltet.scene(voltet.Grid(**cube), size=(8, 8), method=method, engine="cpu")


def test_a_function_is_a_filter(cube):
    seen = {}

    @voltet.gradient_filter("exact-plane", summary="The plane's own.")
    def plane(points, tetrahedra, scalar, *, factor: float = 1.0, upside: bool = False):
        seen.update(points=points, tetrahedra=tetrahedra, scalar=scalar)
        return np.tile([1.0, 2.0, 0.0], (len(points), 1)) * factor * (-1 if upside else 1)

    found = scene(cube, {"method": "exact-plane", "factor": 3.0}).volume("gradient", gradient=True)
    assert np.allclose(found["gradient"], [3, 6, 0])
    assert np.array_equal(seen["points"], cube["points"]) and np.array_equal(seen["tetrahedra"], cube["tetrahedra"])
    assert np.array_equal(seen["scalar"], cube["point_data"]["T"])
    # The arrays are the function's own.
    seen["points"][:] = 0
    assert cube["points"].any()
    with pytest.raises(voltet.UsageError, match="factr") as raised:
        scene(cube, {"method": "exact-plane", "factr": 3.0})
    assert "factor" in raised.value.expected
    with pytest.raises(voltet.UsageError):
        scene(cube, {"method": "exact-plane", "factor": "x"})


def test_a_filter_reads_other_arrays_and_ranges_hold(cube):
    @voltet.gradient_filter(arrays=["U"], parameters={"power": voltet.Parameter(1.0, "a power", range=(0, 4)), "word": voltet.Parameter("a", choices=["a", "b"])})
    def from_array(points, tetrahedra, scalar, arrays, power, word):
        return arrays["U"] * power

    found = scene(cube, {"method": "from-array", "power": 2}).volume("gradient", gradient=True)
    assert np.allclose(found["gradient"], [2, 4, 0])
    for wrong in ({"power": 5}, {"word": "c"}):
        with pytest.raises(voltet.UsageError):
            scene(cube, {"method": "from-array", **wrong})


def test_registered_again_it_is_the_new_one(cube):
    def register(value):
        @voltet.gradient_filter("again")
        def function(points, tetrahedra, scalar):
            return np.full((len(points), 3), value)

    register(1.0)
    p = scene(cube, "again")
    assert p.volume("gradient", gradient=True)["gradient"][0, 0] == 1.0
    register(2.0)
    assert p.volume("gradient", gradient=True)["gradient"][0, 0] == 2.0


def test_what_it_raises_is_the_cause(cube):
    @voltet.gradient_filter
    def broken(points, tetrahedra, scalar):
        raise ZeroDivisionError("seven")

    with pytest.raises(voltet.RunError, match="broken.*seven") as raised:
        scene(cube, "broken").volume("gradient")
    assert isinstance(raised.value.__cause__, ZeroDivisionError) and raised.value.node == "gradient"


@pytest.mark.parametrize(
    "given, match",
    [
        (np.zeros((3, 3)), "shape"), (np.zeros(216), "shape"), (None, "shape"), ("text", "shape"), ([[1.0, 2.0], [3.0]], "shape"),
        (np.zeros((216, 3), complex), "complex"), (np.full((216, 3), np.nan), "finite"),
    ],
    ids=["few", "flat", "none", "text", "ragged", "complex", "nan"],
)
def test_wrong_gradients_are_refused(cube, given, match):
    @voltet.gradient_filter("wrong-gradient")
    def wrong(points, tetrahedra, scalar):
        return given

    with pytest.raises(voltet.RunError, match=match) as raised:
        scene(cube, "wrong-gradient").volume("gradient")
    if match != "finite":
        assert raised.value.what == "the gradient filter 'wrong-gradient' gave no gradient" and raised.value.node == "gradient"
        assert raised.value.expected == "(216, 3), real numbers: the gradient at every point" and raised.value.__cause__ is None


def test_names_that_are_taken_and_defaults_that_are_none():
    with pytest.raises(voltet.UsageError, match="already"):
        voltet.gradient_filter("least-squares")(lambda points, tetrahedra, scalar: points)
    with pytest.raises(voltet.UsageError, match="wrong type"):
        voltet.gradient_filter("x", parameters={"a": [1, 2]})(lambda points, tetrahedra, scalar, a: points)
    with pytest.raises(voltet.UsageError):
        voltet.gradient_filter("y", parameters={"type": 1.0})(lambda points, tetrahedra, scalar: points)


def test_what_runs_when_a_former_filter_is_freed_may_register_another():
    """The registry is not locked then: it would wait for itself, or for threads that wait for it."""
    code = """
        import gc, voltet

        class Former:
            __name__ = "filter"

            def __call__(self, points, tetrahedra, scalar):
                return points

            def __del__(self):
                voltet.gradient_filter("second")(lambda points, tetrahedra, scalar: points)
                print("freed")

        voltet.gradient_filter("first")(Former())
        voltet.gradient_filter("first")(lambda points, tetrahedra, scalar: points)
        gc.collect()
    """
    done = subprocess.run([sys.executable, "-c", textwrap.dedent(code)], capture_output=True, text=True, timeout=300)
    assert (done.returncode, done.stdout) == (0, "freed\n"), done.stderr


def test_pictures_name_the_filter(cube, tmp_path):
    @voltet.gradient_filter("named")
    def named(points, tetrahedra, scalar):
        return np.zeros((len(points), 3))

    report = scene(cube, "named").render().report
    assert report is not None
