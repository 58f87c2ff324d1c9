"""Draw the picture of the README: ``python tools/picture.py FILE.png``.

The built-in trial ``crossing-flows`` with its own seed, at the instant when most people are near the robot.
"""

from __future__ import annotations

import sys
from typing import TYPE_CHECKING

import matplotlib as mpl
import numpy as np
from matplotlib.figure import Figure

import crowdbot as cb
from crowdbot.recording import run

if TYPE_CHECKING:
    from matplotlib.axes import Axes

STEP, OBSERVE, PREDICT, NEAR = 0.4, 8, 12, 5.0
EAST, WEST, ROBOT, PATH, TRUTH = "#9ec5e8", "#f0b3a6", "#00796b", "#0072b2", "#333333"


def draw(path: str) -> None:
    """Run the trial and write the picture."""
    episode = run(cb.load_trial("crossing-flows"))
    past, future = episode.tracks(STEP).windows(OBSERVE, PREDICT, near=NEAR)
    busiest = int(np.argmax(future.scored.sum(axis=1)))
    now = past.dt * (past.frame[busiest, -1] - past.frame[0, 0]) / (past.frame[0, 1] - past.frame[0, 0])
    frame = int(np.argmin(np.abs(episode.times - episode.times[0] - now)))
    forecast = cb.Simulated(cb.ORCA()).predict(past[busiest : busiest + 1], PREDICT)
    mpl.rcParams["font.size"] = 9
    figure = Figure(figsize=(11, 4.4), dpi=110, layout="constrained")
    axes = figure.add_subplot()
    _stage(axes, episode, frame)
    for person in np.flatnonzero(future.scored[busiest]):
        begin = past.position[busiest, -1, person]
        for positions, style in (
            (future.position[busiest, :, person], "--"),
            (forecast.position[0, 0, :, person], "-"),
        ):
            line = np.concatenate([begin[None], positions])
            axes.plot(*line.T, style, color="#333333" if style == "--" else PATH, lw=1.3 if style == "--" else 2)
    axes.set_title(
        f"crossing-flows after {episode.times[frame]:.1f} s: LiDAR returns (green), predicted paths for the next"
        f" {PREDICT * STEP:.1f} s (blue) and what then happened (dashed)",
        fontsize=10,
    )
    figure.savefig(path)


def _stage(axes: Axes, episode: cb.Episode, frame: int) -> None:
    for ring in episode.walls:
        axes.plot(*np.concatenate([ring, ring[:1]]).T, color="#59636f", lw=2.5)
    for agent in np.flatnonzero(episode.active[frame]):
        heading = episode.heading[frame, agent]
        color = ROBOT if agent in episode.robots else EAST if np.cos(heading) > 0 else WEST
        x, y = episode.position[frame, agent]
        radius = episode.radius[agent]
        axes.add_patch(mpl.patches.Circle((x, y), radius, color=color))
        axes.plot([x, x + radius * np.cos(heading)], [y, y + radius * np.sin(heading)], color="#37414d", lw=1)
    robot = episode.robots[0]
    axes.plot(*episode.position[: frame + 1, robot].T, color=ROBOT, lw=1.5, alpha=0.6)
    scan = max((s for s in episode.scans if s.time <= episode.times[frame] + 1e-9), key=lambda s: s.time)
    seen = np.isfinite(scan.ranges)
    angle = scan.pose[2] + scan.angles[seen]
    axes.scatter(
        scan.pose[0] + scan.ranges[seen] * np.cos(angle),
        scan.pose[1] + scan.ranges[seen] * np.sin(angle),
        s=4,
        color=ROBOT,
    )
    goal = episode.trial.robots[0].goal
    axes.plot(goal.x, goal.y, "+", color=ROBOT, ms=14, mew=2)
    axes.set_aspect("equal")
    axes.set_xlim(-14, 14)
    axes.set_xlabel("x [m]")
    axes.set_ylabel("y [m]")


if __name__ == "__main__":
    draw(sys.argv[1])
