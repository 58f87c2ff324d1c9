"""Plot of the reactions of people to robots in an episode."""

from __future__ import annotations

import itertools
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, explain_write_errors
from crowdbot.world import REACTIONS

COLORS = {
    "ignore": "#525252", "impassive": "#8c510a", "curious": "#0072b2", "scared": "#d55e00", "block": "#cc79a7",
    "follow": "#009e73", "give-way": "#e69f00", "look": "#56b4e9",
}  # fmt: skip
"""Colours that are distinguishable with colour blindness (Okabe & Ito), then brown and grey."""
NONE = "#c8c8c8"
MOST_NAMES = 30


def plot_reactions(episode: Any, file: Path | str) -> Path:
    """Draw the paths of people and robots, coloured by the reaction in force, and who reacts when; return the file.

    Args:
        episode: an :class:`~crowdbot.simulation.Episode` or a recorded episode.
        file: PNG, PDF or SVG file to write.

    Raises:
        InputError: nobody can react to robots in this episode.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> plot_reactions(simulate(load_trial("frontal", duration=0.5), 0), "reactions.png")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: nobody can react to robots in this episode: its trial has no <reaction>
    """
    from matplotlib.backends.backend_agg import FigureCanvasAgg
    from matplotlib.figure import Figure
    from matplotlib.lines import Line2D

    if episode.reactions is None:
        raise InputError("nobody can react to robots in this episode: its trial has no <reaction>")
    robots = set(episode.robots)
    people = [a for a in range(len(episode.ids)) if a not in robots and episode.active[:, a].any()]
    rows = [a for a in people if episode.reactions[:, a].any()]
    tall = 0.5 + 0.22 * max(1, len(rows))
    figure = Figure(figsize=(8.0, 4.6 + tall), dpi=120, layout="constrained")
    FigureCanvasAgg(figure)
    paths, times = figure.subplots(2, 1, height_ratios=[4.6, tall])
    for ring in episode.walls:
        paths.plot(*np.concatenate([ring, ring[:1]]).T, color="#303030", linewidth=1.2)
    for a in people:
        _path(paths, episode, a)
    for a in episode.robots:
        paths.plot(*episode.position[episode.active[:, a], a].T, color="black", linewidth=1.6, linestyle="--")
    paths.set(aspect="equal", xlabel="x [m]", ylabel="y [m]")
    for k, a in enumerate(rows):
        for code, begin, end in _spans(episode.reactions[:, a]):
            if not code:
                continue
            left, right = episode.times[begin], episode.times[min(end, len(episode.times) - 1)]
            times.barh(k, right - left, left=left, height=0.7, color=COLORS[REACTIONS[code]])
    times.set(xlabel="time [s]", ylabel="person", xlim=(episode.times[0], episode.times[-1] + 1e-3))
    times.set_ylim(len(rows) - 0.5 if rows else 0.5, -0.5)
    if len(rows) <= MOST_NAMES:
        times.set_yticks(range(len(rows)), [str(episode.ids[a]) for a in rows])
    kinds = [REACTIONS[code] for code in sorted({*np.unique(episode.reactions).tolist()} - {0})]
    lines = [Line2D([], [], color=COLORS[kind], linewidth=2.0, label=kind) for kind in kinds]
    lines += [Line2D([], [], color=NONE, linewidth=2.0, label="no reaction in force")]
    lines += [Line2D([], [], color="black", linestyle="--", label="robot")]
    figure.legend(handles=lines, loc="outside upper center", ncols=min(5, len(lines)), frameon=False)
    file = Path(file)
    with explain_write_errors(file):
        figure.savefig(file)
    return file


def _path(axis: Any, episode: Any, a: int) -> None:
    """Draw the path of a person, with a dot where it begins."""
    for code, begin, end in _spans(np.where(episode.active[:, a], episode.reactions[:, a].astype(np.int64), -1)):
        if code >= 0:
            place = episode.position[begin : end + 1, a][episode.active[begin : end + 1, a]]
            axis.plot(*place.T, color=COLORS.get(REACTIONS[code], NONE), linewidth=1.8 if code else 1.0)
    first = int(np.argmax(episode.active[:, a]))
    axis.plot(*episode.position[first, a], "o", color="#303030", markersize=3)


def _spans(codes: NDArray[Any]) -> list[tuple[int, int, int]]:
    """Return runs of equal codes: code, first row, and the row after the last."""
    cuts = np.flatnonzero(np.diff(codes)) + 1
    ends = [0, *cuts.tolist(), len(codes)]
    return [(int(codes[i]), i, j) for i, j in itertools.pairwise(ends)]
