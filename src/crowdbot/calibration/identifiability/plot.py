"""Plot of parameter profiles."""

from __future__ import annotations

import os
from collections.abc import Sequence
from pathlib import Path

from .profile import ParameterProfile

COLUMNS = 3
LINE, RANGE, BEST = "#0072b2", "#e69f00", "#d55e00"


def plot_profiles(profiles: Sequence[ParameterProfile], file: Path) -> Path:
    """Draw one panel for each parameter and return the file, PNG.

    The line is the cost with all other parameters fitted anew, the band the 95 % interval of its difference to the
    calibrated cost over people, the vertical line the calibrated value and the shaded range its interval.

    Args:
        profiles: result of :func:`~crowdbot.calibration.profile_parameters`.
        file: output file; its folder exists.
    """
    from matplotlib.figure import Figure

    columns = min(COLUMNS, len(profiles))
    rows = -(-len(profiles) // columns)
    figure = Figure(figsize=(3.1 * columns + 0.4, 2.5 * rows + 0.3), dpi=110, layout="constrained")
    axes = figure.subplots(rows, columns, squeeze=False, sharey=True)
    for axis, one in zip(axes.flat, profiles, strict=False):
        start = float(one.cost[one.values == one.best][0]) if one.best in one.values else float(one.cost.min())
        axis.axvspan(*one.interval, color=RANGE, alpha=0.25, linewidth=0)
        axis.axvline(one.best, color=BEST, linewidth=1.2)
        axis.fill_between(one.values, start + one.low, start + one.high, color=LINE, alpha=0.2, linewidth=0)
        axis.plot(one.values, one.cost, "o-", color=LINE, markersize=3, linewidth=1.2)
        axis.set_xlabel(f"{one.name.replace('_', ' ')} [{one.unit}]", fontsize=9)
        axis.set_title(f"identified: {one.identified}", fontsize=9)
        axis.tick_params(labelsize=8)
        axis.grid(alpha=0.25, linewidth=0.6)
    for axis in axes.flat[len(profiles) :]:
        axis.set_visible(False)
    figure.supylabel("mean cost [m]", fontsize=9)
    draft = file.with_suffix(".part")
    figure.savefig(draft, format="png", metadata={"Software": None})
    os.replace(draft, file)
    return file
