"""Grids and pipelines drawn by lot: an exception of the family, or a picture of finite numbers; never anything else."""

import os

import numpy as np
import pytest
from conftest import box, uniform

import voltet

# What is drawn by lot is left out or blank now and then.
pytestmark = pytest.mark.filterwarnings("ignore::voltet.VoltetWarning")
ROUNDS = int(os.environ.get("VOLTET_FUZZ", "300"))


def spoilt(random, array):
    """The array with one thing wrong, or none."""
    array = np.array(array)
    way = random.integers(0, 9)
    if way == 0:
        return array.astype(random.choice([np.float32, np.float64, np.int8, np.int64, np.uint16, np.complex64, object, bool, "U8"]))
    if way == 1 and array.size:
        flat = array.reshape(-1)
        extremes = [0, 1, -1, 2**31, 2**63 - 1] if flat.dtype.kind in "iu" else [np.nan, np.inf, -np.inf, 1e308, 5e-324, 0.0]
        info = np.iinfo(flat.dtype) if flat.dtype.kind in "iu" else None
        value = random.choice(np.array(extremes, object))
        flat[random.integers(0, flat.size, random.integers(1, 6))] = value if info is None else np.clip(value, info.min, info.max)
        return array
    if way == 2:
        return array[: random.integers(0, len(array) + 1)]
    if way == 3:
        return array.T
    if way == 4:
        return array[::-1]
    if way == 5:
        return array.reshape(-1)
    if way == 6:
        return np.asfortranarray(array)
    if way == 7:
        return np.repeat(array, 2, axis=0)
    return array


def test_grids_by_lot():
    random = np.random.default_rng(20261123)
    drawn = 0
    for _ in range(ROUNDS):
        points, tetrahedra = box(int(random.integers(2, 4)))
        count = len(tetrahedra)
        types = np.full(count, 10, np.uint8)
        types[random.integers(0, count, random.integers(0, 3))] = random.integers(0, 256)
        mixed = {"types": types, "offsets": np.arange(0, 4 * count + 1, 4), "connectivity": tetrahedra.reshape(-1).astype(random.choice([np.int32, np.int64]))}
        cells = {"tetrahedra": tetrahedra} if random.random() < 0.4 else mixed
        given = {"points": points, **cells}
        for name in random.choice(list(given), random.integers(0, 3)):
            given[name] = spoilt(random, given[name])
        data = {"T": spoilt(random, points[:, 0]) if random.random() < 0.4 else points[:, 0]}
        try:
            rgba = uniform(voltet.Grid(**given, point_data=data, scalar="T"), (6, 6)).render()
        except voltet.Bug:
            raise
        except voltet.Error as error:
            assert str(error)
        else:
            drawn += 1
            assert np.isfinite(rgba).all()
    assert ROUNDS // 10 < drawn < ROUNDS


def test_parameters_by_lot(slab):
    random = np.random.default_rng(7)
    values = [None, True, 0, -1, 2**70, 1e308, float("nan"), float("inf"), "", "x\0y", [], [1], [[1]], [1, "a"], {}, {"a": 1}, "é" * 99, np.arange(3), np.float32(2), b"x", object()]
    paths = ["view.size", "view.eye", "view.fov_y", "look.widgets", "look.widgets.0", "look.widgets.0.color", "look.widgets.7.color",
             "look.unit_distance", "picture.integrator", "picture.segments", "gradient.method", "grid.scalar", "picture.light", "picture.inputs", "picture.type", "nobody.x", "view"]
    for _ in range(ROUNDS):
        node, _, path = random.choice(paths).partition(".")
        text = slab.text
        try:
            slab.set({f"{node}.{path}": values[random.integers(0, len(values))]})
            if max(slab.size()) < 100:
                assert np.isfinite(slab.render()).all()
        except voltet.Bug:
            raise
        except voltet.Error as error:
            assert str(error)
        while slab.text != text and slab.undo():
            pass
        assert slab.text == text
