"""Pictures in axes of matplotlib."""

import numpy as np
import pytest
from conftest import uniform

import voltet

matplotlib = pytest.importorskip("matplotlib")
matplotlib.use("agg")
import matplotlib.pyplot as plt  # noqa: E402


@pytest.fixture
def axes():
    figure = plt.figure(figsize=(4, 3), dpi=50)
    yield figure.add_subplot()
    plt.close(figure)


def ramp(values=None, **options):
    """A cube of 2³ points whose value rises along z from 1 to 100."""
    values = np.broadcast_to([1.0, 100.0], (2, 2, 2)).copy() if values is None else values
    camera = {"eye": [0.5, -4, 0.5], "target": [0.5, 0.5, 0.5], "height": 2.0, "fov_y": None}
    return voltet.scene(values, camera=camera, size=(64, 32), engine="cpu", **options)


def test_an_orthographic_view_along_an_axis_has_coordinates(axes):
    shown = ramp(extinction=50.0, opacity="constant", unit_distance=1.0).imshow(axes)
    assert shown.get_extent() == [-1.5, 2.5, -0.5, 1.5]
    assert (axes.get_xlabel(), axes.get_ylabel()) == ("x", "z")
    pixels = shown.get_array()
    # The cube from 0 to 1 of both axes, before the white of the axes.
    filled = (pixels != 255).any(-1)
    rows, columns = np.flatnonzero(filled.any(1)), np.flatnonzero(filled.any(0))
    assert (rows[0], rows[-1], columns[0], columns[-1]) == (8, 23, 24, 39)


def test_coordinates_from_the_other_side_fall_to_the_right(axes):
    pipeline = ramp()
    pipeline.set({"view.eye": [0.5, 5.0, 0.5]})
    pipeline.imshow(axes)
    assert axes.get_xlabel() == "x" and axes.xaxis.get_major_formatter()(-1234567.5) == "1234567.5"


def test_other_views_have_no_ticks(axes):
    pipeline = ramp()
    pipeline.set({"view.eye": [3.0, -4.0, 2.0]})
    pipeline.imshow(axes)
    assert not len(axes.get_xticks()) and not axes.get_xlabel()


def test_the_colour_bar_has_the_colours_of_the_scalar(axes):
    for look, norm, middle in ((None, "Normalize", 50.5), ({"s_scale": "log"}, "LogNorm", 10.0)):
        axes.figure.clear()
        ax = axes.figure.add_subplot()
        ramp(cmap=["red", "lime"], clim=(1.0, 100.0), look=look).imshow(ax)
        bar = ax.figure.axes[1]._colorbar
        assert type(bar.norm).__name__ == norm and (bar.vmin, bar.vmax) == pytest.approx((1.0, 100.0))
        low, high = bar.cmap(0.0), bar.cmap(1.0)
        assert low[:3] == pytest.approx((1, 0, 0), abs=0.1) and high[:3] == pytest.approx((0, 1, 0), abs=0.1)
        assert bar.norm(middle) == pytest.approx(0.5, abs=1e-3) and ax.figure.axes[1].get_ylabel() == "values"


def test_a_symmetric_logarithm_is_that_of_the_scale(axes):
    look = {"s_scale": "symlog", "s_linear_below": 1.0}
    ramp(np.broadcast_to([0.0, 99.0], (2, 2, 2)).copy(), cmap=["red", "lime"], clim=(0.0, 99.0), look=look).imshow(axes)
    bar = axes.figure.axes[1]._colorbar
    # sign(v) · log(1 + |v| / 1): half of the decades from 1 to 100 at 10.
    assert bar.norm(9.0) == pytest.approx(0.5, abs=1e-6) and bar.norm.inverse(0.5) == pytest.approx(9.0)


def test_figures_of_annotations_and_transfer_functions_over_the_gradient(axes):
    pipeline = ramp(annotation={"title": "a ramp"}, widgets=[voltet.widgets.gaussian(color=[1, 1, 1], extinction=1, centre=[50, 99], sigma=[9, 9])])
    pipeline.imshow(axes, interpolation="nearest")
    assert len(axes.figure.axes) == 1, "colours over s and g have no bar"
    assert axes.images[0].get_interpolation() == "nearest"


def test_the_picture_is_composited_over_the_axes_in_linear_light(axes, cube):
    pipeline = uniform(voltet.Grid(**cube))
    axes.set_facecolor("white")
    shown = pipeline.imshow(axes)
    assert np.array_equal(shown.get_array(), pipeline.render().srgb8((1.0, 1.0, 1.0)))
    axes.set_facecolor((0.5, 0.5, 0.5))
    shown = pipeline.imshow(axes, colorbar=False)
    assert np.array_equal(shown.get_array(), pipeline.render().srgb8((((0.5 + 0.055) / 1.055) ** 2.4,) * 3))


def test_without_matplotlib_the_remedy_is_said(monkeypatch, cube):
    import sys

    monkeypatch.setitem(sys.modules, "matplotlib.pyplot", None)
    with pytest.raises(voltet.UsageError, match="matplotlib is missing: .*pip install matplotlib"):
        uniform(voltet.Grid(**cube)).imshow()


def test_what_is_no_axes_is_said(cube):
    scene = voltet.scene(voltet.Grid(**cube), size=(8, 8), engine="cpu")
    with pytest.raises(voltet.UsageError, match="no axes of matplotlib: found a ndarray"):
        scene.imshow(np.empty(2))
