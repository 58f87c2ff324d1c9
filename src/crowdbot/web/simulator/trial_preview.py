"""Preview and thumbnail of a trial: people on straight lines, drawn without a simulation."""

from __future__ import annotations

import functools
import math
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import (
    ROBOT_COLOR,
    WALL_COLOR,
    CrowdbotError,
    Disc,
    Path2D,
    draw_svg,
    without_running_code,
)
from crowdbot.trials import Trial, load_builtin_trial, load_trial, trial_titles
from crowdbot.typing import Floats

MOST = 150
PACE = 1.3
"""Speed [m/s] of people and robots in a preview."""
SMALLEST = 0.036
"""Smallest radius of a disc in a thumbnail as a share of its width: 5 px across at a width of 72 px."""
WAY = "#9aa7b5"
"""Colour of the straight line from a robot to its goal."""


def trial_preview(trial: Trial) -> dict[str, Any]:
    """Return walls, bounds [m] and moving discs [x, y, vx, vy, radius, 1 for a robot] of a trial.

    This is no simulation: nobody reacts to anybody. It needs no compiled code.

    >>> from crowdbot.trials import load_trial
    >>> len(trial_preview(load_trial("frontal"))["discs"])
    2
    """
    rng = np.random.default_rng(0)
    discs = [_disc((agent.x, agent.y), _first(agent.goal), agent.radius, 0) for agent in trial.agents]
    goals = {journey.name: _stop(journey) for journey in trial.journeys}
    for spawner in trial.spawners:
        zone = np.asarray(spawner.zone, dtype=np.float64)
        goal = np.asarray(spawner.goal, dtype=np.float64).mean(axis=0) if spawner.goal else goals.get(spawner.journey)
        for place in _points(zone, min(spawner.count, MOST - len(discs)), rng):
            ahead = None if goal is None else (place + goal - zone.mean(axis=0))
            discs.append(_disc(place, ahead, 0.25, 0))
    discs += [_disc((robot.x, robot.y), robot.goal.position, float(robot.radius), 1) for robot in trial.robots]
    rings = [np.asarray(ring) for ring in trial.stage.rings]
    every = np.concatenate([*rings, np.array([disc[:2] for disc in discs]).reshape(-1, 2), np.zeros((0, 2))])
    low, high = (
        (every.min(axis=0) - 1.0, every.max(axis=0) + 1.0) if len(every) else (np.full(2, -5.0), np.full(2, 5.0))
    )
    return {
        "bounds": [*low.round(2).tolist(), *high.round(2).tolist()],
        "walls": [ring.round(3).tolist() for ring in rings],
        "discs": discs,
    }


def _disc(place: Any, goal: Any, radius: float, robot: int) -> list[float]:
    x, y = float(place[0]), float(place[1])
    way = (0.0, 0.0) if goal is None else (float(goal[0]) - x, float(goal[1]) - y)
    length = math.hypot(*way)
    speed = PACE / length if length > 0.1 else 0.0
    return [round(item, 3) for item in (x, y, way[0] * speed, way[1] * speed, radius, robot)]


def _first(points: Any) -> Any:
    return points[0] if points else None


def _stop(journey: Any) -> Floats | None:
    for stop in journey.stops:
        points = getattr(stop, "points", None)
        if points:
            middle: Floats = np.asarray(points, dtype=np.float64).mean(axis=0)
            return middle
        if hasattr(stop, "x"):
            return np.array([stop.x, stop.y], dtype=np.float64)
    return None


def _points(zone: Floats, count: int, rng: np.random.Generator) -> list[Floats]:
    """Return random points in a polygon."""
    low, high = zone.min(axis=0), zone.max(axis=0)
    points: list[Floats] = []
    for place in rng.uniform(low, high, (max(0, 40 * count), 2)):
        if len(points) >= count:
            break
        if _is_inside(place, zone):
            points.append(place)
    return points


def _is_inside(place: Floats, zone: Floats) -> bool:
    ahead, crossing = np.roll(zone, -1, axis=0), False
    for (x, y), (u, v) in zip(zone, ahead, strict=True):
        if (y > place[1]) != (v > place[1]) and place[0] < (u - x) * (place[1] - y) / (v - y) + x:
            crossing = not crossing
    return crossing


def trial_thumbnail(trial: Trial) -> str:
    """Return an SVG drawing that can be read at a width of 70 px; of people that cover each other some are left out.

    >>> trial_thumbnail(load_trial("frontal")).count("<circle")
    2
    """
    found = trial_preview(trial)
    rings = [np.asarray(ring + ring[:1] if len(ring) > 2 else ring, dtype=np.float64) for ring in found["walls"]]
    ways = [np.array([(robot.x, robot.y), robot.goal.position], dtype=np.float64) for robot in trial.robots]
    entering = [_disc(np.mean(source.zone, axis=0), None, 0.25, 0) for source in trial.sources]
    corners = np.concatenate([np.reshape(found["bounds"], (2, 2)), *ways])
    least = SMALLEST * max(np.ptp(corners, axis=0) * (1.0, 4.0 / 3.0))  # draw_svg fits into 4 : 3
    discs: list[Disc] = []
    for x, y, _, _, radius, robot in [*entering, *found["discs"]][::-1]:  # robots first
        hidden = (
            math.hypot(x - one.x, y - one.y) < (1.0 if one.color == ROBOT_COLOR else 1.7) * least for one in discs
        )
        if robot:
            discs.append(Disc(x, y, max(radius, 1.3 * least), ROBOT_COLOR))
        elif not any(hidden):
            discs.append(Disc(x, y, max(radius, least)))
    lines = [*(Path2D(way, WAY, 5.0) for way in ways), *(Path2D(ring, WALL_COLOR, 9.0) for ring in rings)]
    return draw_svg(lines, discs[::-1])


def thumbnail(name: str, file: Path | None) -> bytes:
    """Return the thumbnail of a built-in trial, or of a trial file, whose code is not run.

    Args:
        name: name of the trial.
        file: its file, or None for a built-in trial.

    Raises:
        KeyError: there is no such built-in trial.
    """
    if file is None:
        return _builtin(name)
    try:
        with without_running_code():
            return trial_thumbnail(load_trial(file)).encode()
    except (CrowdbotError, OSError, ValueError):  # an error in the file is told when it is opened
        return draw_svg([]).encode()


@functools.lru_cache(maxsize=256)
def _builtin(name: str) -> bytes:
    if name not in trial_titles():
        raise KeyError(name)
    return trial_thumbnail(load_builtin_trial(name)).encode()
