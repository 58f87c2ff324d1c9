"""Trial of a recording: people by a crowd model from their recorded starts to their recorded goals."""

from __future__ import annotations

import csv
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import explain_write_errors
from crowdbot.models import ORCA
from crowdbot.navigation import ExternalNavigator, ORCANavigator
from crowdbot.trials import (
    Distribution,
    Points,
    RobotGoal,
    RobotPose,
    RobotSpec,
    SourceSpec,
    Spawner,
    Stage,
    Trial,
    Wall,
)
from crowdbot.typing import Floats
from crowdbot.world import DifferentialDrive

from .robot_recording import PERSON_RADIUS, RobotRecording

JITTER = 0.2
"""Starts and goals are drawn from a square of twice this size [m] around the recorded ones."""
SPEED_SPREAD = 0.1
"""Standard deviation of the preferred speed [m/s] around the recorded mean."""
LEAST_SPEED = 0.1
EXTRA_TIME = 1.5
"""Longest time of a robot with a navigator, as a multiple of the recorded time."""
POSES = "robot-poses.csv"


def recorded_trial(recording: RobotRecording, folder: Path, mirror: bool = True) -> Trial:
    """Return a trial with the people and the robot of a recording.

    Each person enters at the recorded time near the recorded start, and walks by ORCA to the end of the track, with a
    preferred speed near the recorded mean. The squares of starts and goals and the spread of the speeds make the runs
    of different seeds differ.

    Args:
        recording: the recording.
        folder: folder of the trial; the poses of the robot are written there.
        mirror: whether the robot follows its recorded path; otherwise it starts and ends there, with ORCA.

    Raises:
        InputError: the poses cannot be written.
    """
    agents = recording.agents
    robot, times = agents.position[:, 0], agents.times
    duration = float(times[-1])
    spawners, sources = [], []
    for k in range(1, agents.active.shape[1]):
        rows = np.flatnonzero(agents.active[:, k])
        place = agents.position[rows, k]
        walk = float(np.hypot(*np.diff(place, axis=0).T).sum())
        speed = max(LEAST_SPEED, walk / max(1e-9, float(times[rows[-1]] - times[rows[0]])))
        people: dict[str, Any] = {
            "name": f"person-{k}",
            "zone": _square(place[0]),
            "goal": _square(recording.ends[k]),
            "speed": _speeds(speed),
            "radius": Distribution.of(PERSON_RADIUS),
        }
        if rows[0] == 0:
            spawners.append(Spawner(count=1, **people))
        else:
            begin = round(float(times[rows[0]]), 6)
            sources.append(SourceSpec(rate=1e4, timing="regular", begin=begin, max_count=1, **people))
    spec = RobotSpec(
        x=round(float(robot[0, 0]), 6),
        y=round(float(robot[0, 1]), 6),
        heading=round(float(agents.heading[0, 0]), 6) if mirror else _heading(robot),
        radius=recording.radius,
        goal=RobotGoal(float(recording.goal[0]), float(recording.goal[1]), recording.tolerance),
        drive=DifferentialDrive(max_speed=_top_speed(agents.velocity[:, 0])),
        navigator=ExternalNavigator() if mirror else ORCANavigator(speed=_top_speed(agents.velocity[:, 0])),
        pose=RobotPose(source="file", file=POSES, folder=folder) if mirror else None,
        folder=folder,
    )
    if mirror:
        _write_poses(folder / POSES, times, robot, agents.heading[:, 0])
    return Trial(
        name=recording.name[:60],
        duration=round(duration if mirror else EXTRA_TIME * duration, 6),
        crowd=ORCA(),
        stage=Stage(walls=tuple(Wall(Points.of([*ring.tolist(), ring[0].tolist()])) for ring in recording.walls)),
        spawners=tuple(spawners),
        sources=tuple(sources),
        robots=(spec,),
        folder=folder,
    )


def _speeds(mean: float) -> Distribution:
    spread = min(SPEED_SPREAD, 0.2 * mean)
    return Distribution("normal", tuple(round(value, 4) for value in (mean, spread, 0.5 * mean, 1.5 * mean)))


def _square(place: Floats) -> Points:
    x, y = (round(float(value), 4) for value in place)
    return Points.of([(x + a * JITTER, y + b * JITTER) for a, b in ((-1, -1), (1, -1), (1, 1), (-1, 1))])


def _top_speed(velocity: Floats) -> float:
    return round(max(0.1, float(np.hypot(*velocity.T).max())), 4)


def _heading(path: Floats) -> float:
    away = path - path[0]
    far = np.flatnonzero(np.hypot(*away.T) > 0.1)
    return float(np.arctan2(*away[far[0]][::-1])) if len(far) else 0.0


def _write_poses(file: Path, times: Floats, path: Floats, heading: Floats) -> None:
    with explain_write_errors(file):
        file.parent.mkdir(parents=True, exist_ok=True)
        with file.open("w", newline="", encoding="utf-8") as stream:
            writer = csv.writer(stream, lineterminator="\n")
            writer.writerow(("time", "x", "y", "heading"))
            for row in zip(times, *path.T, heading, strict=True):
                writer.writerow([f"{value:.6f}" for value in row])
