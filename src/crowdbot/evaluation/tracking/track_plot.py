"""Plot of tracks over the true paths of people."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.sensors import PointCloud

from .tracking_run import TrackingRun

COLORS = ("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c510a")
"""Colours that are distinguishable with colour blindness (Okabe & Ito), and brown; tracks repeat them."""
TRUE, WALL, SCAN = "#b8b8b8", "#404040", "#000000"
LAST = 6.0
"""Time before the last reading that is drawn [s]."""


def plot_tracks(run: TrackingRun, file: Path) -> Path:
    """Draw true paths, tracks and the last reading of a run as PNG, and return the file.

    The plot shows the last 6 s: visible people in grey, dotted while they are hidden; tracks in colours, one for each
    identity, with a cross at the last instant.

    Args:
        run: the run.
        file: output file.
    """
    import matplotlib

    matplotlib.use("Agg")
    from matplotlib import pyplot

    rows, end = run.log.rows, run.log.rows[-1].time
    first = next(k for k, row in enumerate(rows) if row.time >= end - LAST)
    figure, axis = pyplot.subplots(figsize=(10, 7), dpi=110)
    for segment in run.log.walls.segments():
        axis.plot(segment[[0, 2]], segment[[1, 3]], color=WALL, linewidth=1.5)
    _draw_people(axis, run, first)
    _draw_tracks(axis, run, first)
    reading: Any = rows[-1].reading
    points = reading.points(in_world=True) if isinstance(reading, PointCloud) else reading.points()
    ends = points.reshape(-1, points.shape[-1])
    axis.plot(ends[:, 0], ends[:, 1], ".", color=SCAN, markersize=2, label="last reading")
    path = np.array([row.robot for row in rows[first:]])
    axis.plot(path[:, 0], path[:, 1], color=SCAN, linewidth=2.5, label="robot")
    seen = np.concatenate([path, ends[np.isfinite(ends[:, 0])][:, :2]])
    low, high = seen.min(axis=0) - 1.0, seen.max(axis=0) + 1.0
    axis.set(xlim=(low[0], high[0]), ylim=(low[1], high[1]), aspect="equal", xlabel="x [m]", ylabel="y [m]")
    axis.set_title(f"{run.log.name}, seed {run.log.seed}, {run.log.sensor}: last {end - rows[first].time:.0f} s")
    axis.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0), frameon=False)
    figure.savefig(file, bbox_inches="tight")
    pyplot.close(figure)
    return file


def _draw_people(axis: Any, run: TrackingRun, first: int) -> None:
    """Draw the true paths, and where people are hidden."""
    rows = run.log.rows[first:]
    names = {"visible person": "-", "hidden person": ":"}
    for who in sorted({who for row in rows for who in row.people}):
        place = np.array([row.people.get(who, (np.nan, np.nan)) for row in rows])
        hidden = np.array([who in row.hidden_ids() for row in rows])
        for wanted, (name, style) in zip((False, True), names.items(), strict=True):
            part = np.where((hidden == wanted)[:, None], place, np.nan)
            if not np.isnan(part).all():
                known = axis.get_legend_handles_labels()[1]
                label = None if name in known else name
                width = 1.0 if wanted else 5.0
                axis.plot(part[:, 0], part[:, 1], style, color=TRUE, linewidth=width, label=label)


def _draw_tracks(axis: Any, run: TrackingRun, first: int) -> None:
    """Draw the tracks, and a cross where each is at the last instant."""
    table: dict[int, list[tuple[float, float]]] = {}
    for tracks in run.tracks[first:]:
        for who, (x, y) in zip(tracks.ids.tolist(), tracks.position.tolist(), strict=True):
            table.setdefault(who, []).append((x, y))
    for k, (who, places) in enumerate(sorted(table.items())):
        path, color = np.array(places), COLORS[who % len(COLORS)]
        axis.plot(path[:, 0], path[:, 1], color=color, linewidth=1.4, label=None if k else "track, by identity")
    last = run.tracks[-1]
    for who, (x, y) in zip(last.ids.tolist(), last.position.tolist(), strict=True):
        axis.plot(x, y, "x", color=COLORS[who % len(COLORS)], markersize=7)
