"""Views of one grid by spawned processes, as Dask and joblib work: pipelines and grids pickle. A sheet of six of them.

python examples/python/processes.py [PICTURE]
"""

import sys
from multiprocessing import get_context

import numpy as np

import voltet


def view(pipeline: voltet.Pipeline, azimuth: float) -> voltet.Picture:
    """The picture from this angle, in degrees."""
    pipeline["view"]["azimuth"] = azimuth
    return pipeline.render()


def main() -> None:
    x, y, z = np.mgrid[-1.8:1.8:40j, -1.8:1.8:40j, -0.8:0.8:20j]
    # A trefoil-like field: distance from a curve that winds twice round a ring.
    ring = np.hypot(x, y) - 1.2
    turn = 1.5 * np.arctan2(y, x)
    field = np.minimum((ring - 0.45 * np.cos(turn)) ** 2 + (z - 0.45 * np.sin(turn)) ** 2, (ring + 0.45 * np.cos(turn)) ** 2 + (z + 0.45 * np.sin(turn)) ** 2)
    pipeline = voltet.scene(field, cmap="plasma_r", clim=(0.0, 0.25), opacity=[[0.0, 1.0], [1.0, 0.0]], extinction=6.0, unit_distance=8.0, size=(160, 150),
        camera={"view": "isometric", "zoom": 1.05})
    with get_context("spawn").Pool(2) as pool:
        pictures = pool.starmap(view, [(pipeline, angle) for angle in range(0, 360, 60)])
    sheet = np.concatenate([np.concatenate(row, axis=1) for row in (pictures[:3], pictures[3:])], axis=0)
    np.ascontiguousarray(sheet).view(voltet.Picture).save(sys.argv[1] if len(sys.argv) > 1 else "processes.jpg")


if __name__ == "__main__":
    main()
