"""Figures that nodes report, with arrays for their tables."""

from __future__ import annotations

from typing import Any

import numpy as np


def figures(found: dict[str, Any]) -> dict[str, Any]:
    """The same with `rows` as an array, and the bins of a histogram as one."""
    if "columns" not in found or "rows" not in found:
        return found
    rows = np.asarray(found["rows"], float).reshape(-1, len(found["columns"]))
    found = {**found, "rows": rows}
    if found["columns"] == ["s_low", "s_high", "g_low", "g_high", "volume"]:
        edges = [np.linspace(axis["low"], axis["high"], axis["bins"] + 1) for axis in (found["s"], found["g"])]
        volumes = np.zeros((found["g"]["bins"], found["s"]["bins"]))
        # A row is a bin that is not empty: the edge nearest to its own is its number.
        places = [
            np.clip(np.rint((low - edge[0]) / max(edge[1] - edge[0], 1e-300)), 0, len(edge) - 2).astype(int)
            for low, edge in ((rows[:, 0], edges[0]), (rows[:, 2], edges[1]))
        ]
        volumes[places[1], places[0]] = rows[:, 4]
        found |= {"volumes": volumes, "s_edges": edges[0], "g_edges": edges[1]}
    return found
