"""What the tests share: a grid with every array a formula, and the pipelines that ship."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

import voltet

ROOT = Path(__file__).parent.parent.parent
PIPELINES = ROOT / "pipelines"


def box(n: int = 6) -> tuple[np.ndarray, np.ndarray]:
    """Points of a unit cube, n a side, and five tetrahedra a cell, alternating, with ascending point numbers."""
    axis = np.linspace(0.0, 1.0, n)
    points = np.stack(np.meshgrid(axis, axis, axis, indexing="ij"), -1).reshape(-1, 3)
    number = np.arange(n**3).reshape(n, n, n)
    corner = {
        (i, j, k): number[i : n - 1 + i, j : n - 1 + j, k : n - 1 + k].reshape(-1)
        for i in (0, 1) for j in (0, 1) for k in (0, 1)
    }
    i, j, k = np.meshgrid(*[np.arange(n - 1)] * 3, indexing="ij")
    odd = ((i + j + k) % 2).reshape(-1).astype(bool)
    sets = {
        False: ["000 100 010 001", "110 100 010 111", "101 100 001 111", "011 010 001 111", "100 010 001 111"],
        True: ["100 000 110 101", "010 000 110 011", "001 000 101 011", "111 110 101 011", "000 110 101 011"],
    }
    cells = []
    for flag, texts in sets.items():
        for text in texts:
            four = [corner[tuple(map(int, word))][odd == flag] for word in text.split()]
            cells.append(np.stack(four, -1))
    return points, np.sort(np.concatenate(cells), axis=1).astype(np.uint32)


@pytest.fixture
def cube() -> dict:
    """Arguments of a grid: the cube, with T = x + 2 y and U = its gradient."""
    points, tetrahedra = box()
    t = points @ [1.0, 2.0, 0.0]
    u = np.tile([1.0, 2.0, 0.0], (len(points), 1))
    return {"points": points, "tetrahedra": tetrahedra, "point_data": {"T": t, "U": u}, "scalar": "T"}


@pytest.fixture
def slab(cube) -> voltet.Pipeline:
    """The cube from the front with one uniform widget: opacity 1 − exp(−2 · depth) in the middle."""
    return uniform(voltet.Grid(**cube))


def uniform(grid: voltet.Grid, size=(16, 16), **options) -> voltet.Pipeline:
    widget = voltet.widgets.uniform(color=[1.0, 0.5, 0.25], extinction=2.0, region={"s": [-1e9, 1e9], "g": [-1e9, 1e9]})
    camera = {"eye": [0.5, -4.0, 0.5], "target": [0.5, 0.5, 0.5], "up": [0, 0, 1], "height": 0.5, "fov_y": None}
    return voltet.scene(
        grid, widgets=[widget], camera=camera, size=size, unit_distance=1.0, engine="cpu", **options
    )
