"""Plot of the ways of participants and robots from above, a panel for each condition."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from .study import COLORS, TrialMeasures

if TYPE_CHECKING:
    from matplotlib.figure import Figure


COLUMNS = 3
WIDE = 2.0
"""Width over height of the ways above which the panels are below each other."""


def draw_paths(trials: Sequence[TrialMeasures]) -> Figure:
    """Return a panel for each condition.

    Args:
        trials: trials with the curves ``person`` and ``robot`` ``[T, 2]`` [m], and maybe a point ``mark`` ``[2]`` and
            walls ``wall 1``, ``wall 2``, ... ``[N, 2]``.
    """
    import matplotlib.pyplot as plt

    conditions = list(dict.fromkeys(trial.condition for trial in trials))
    places = np.concatenate([curve.reshape(-1, 2) for trial in trials for curve in trial.curves.values()])
    width, height = np.nanmax(places, axis=0) - np.nanmin(places, axis=0)
    wide = bool(width > WIDE * height)
    columns = 1 if wide else min(COLUMNS if len(conditions) != 4 else 2, len(conditions))
    rows = -(-len(conditions) // columns)
    size = (8.0, 2.6 * rows) if wide else (3.4 * columns, 3.8 * rows)
    figure, axes = plt.subplots(rows, columns, figsize=size, squeeze=False, sharex=True, sharey=True)
    for axis in axes.flat[len(conditions) :]:
        axis.remove()
    for k, (axis, condition) in enumerate(zip(axes.flat, conditions, strict=False)):
        color = COLORS[k % len(COLORS)]
        for trial in (one for one in trials if one.condition == condition):
            axis.plot(*trial.curves["robot"].T, color="0.2", linewidth=1.0, linestyle="--")
            axis.plot(*trial.curves["person"].T, color=color, linewidth=0.9)
            axis.plot(*trial.curves["person"][0], "o", color=color, markersize=3)
            mark = trial.curves.get("mark")
            if mark is not None and np.isfinite(mark).all():
                axis.plot(*mark, "x", color=color, markersize=6)
            for name, wall in trial.curves.items():
                if name.startswith("wall "):
                    axis.plot(*wall.T, color="0.6", linewidth=2.0)
        axis.set_title(condition, fontsize=9, loc="left")
        axis.set_aspect("equal")
        axis.tick_params(labelsize=7)
        axis.set_xlabel("x [m]", fontsize=8)
        axis.set_ylabel("y [m]", fontsize=8)
    figure.tight_layout()
    return figure
