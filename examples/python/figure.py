"""A figure of matplotlib: a heat sink from the front and its distribution of temperature, from a file without VTK.

python examples/python/figure.py [PICTURE]
"""

import sys
from pathlib import Path

import matplotlib

import voltet

matplotlib.use("agg")
import matplotlib.pyplot as plt

DATA = Path(__file__).parents[2] / "data/heat_sink.vtu"

pipeline = voltet.Pipeline(title="A heat sink")
pipeline.add("grid", "reader", path=str(DATA), scalar="Temperature")
pipeline.add("look", "transfer-function", volume="grid", widgets=[voltet.widgets.colormap(colormap="inferno", extinction=0.25, opacity="constant")])
pipeline.add("view", "camera", volume="grid", view="-y", height="auto", size=[640, 320])
pipeline.add("picture", "renderer", volume="grid", transfer_function="look", camera="view")

plt.style.use("dark_background")
figure, (left, right) = plt.subplots(1, 2, figsize=(9.6, 3.6), width_ratios=[2, 1], layout="constrained")
pipeline.imshow(left)
left.set_title("from the front, mm")
temperature = pipeline.volume("grid", gradient_magnitude=False)["scalar"]
right.hist(temperature, bins=60, color="tab:orange")
right.set(title="points", xlabel="°C", yscale="log")
figure.savefig(sys.argv[1] if len(sys.argv) > 1 else "figure.jpg", dpi=80)
