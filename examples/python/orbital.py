"""A field of numpy in one line: the density of a hydrogen orbital (n = 4, l = 2, m = 0), in the colours of its sign.

python examples/python/orbital.py [PICTURE]
"""

import sys

import numpy as np

import voltet

n = 48
x, y, z = np.mgrid[-24 : 24 : n * 1j, -24 : 24 : n * 1j, -24 : 24 : n * 1j]
r = np.sqrt(x * x + y * y + z * z)
# Radial part (1 - r/12) r² exp(-r/4), angular part 3 cos² - 1; atomic units, not normalised.
psi = (1.0 - r / 12.0) * np.exp(-r / 4.0) * (3.0 * z * z - r * r)
top = float(np.abs(psi).max())
picture = voltet.render(
    psi,
    cmap="coolwarm",
    clim=(-top, top),
    opacity=[[0.0, 1.0], [0.35, 0.35], [0.46, 0.0], [0.54, 0.0], [0.65, 0.35], [1.0, 1.0]],
    extinction=0.6,
    unit_distance=4.0,
    camera={"view": "isometric", "zoom": 1.2},
    size=(480, 360),
)
picture.save(sys.argv[1] if len(sys.argv) > 1 else "orbital.jpg")
