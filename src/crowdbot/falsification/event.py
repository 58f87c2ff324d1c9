"""What happens in a failure, in words: with whom, and from which side."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import wrap_angle
from crowdbot.simulation import WALL, Episode

SIDES = ("ahead", "left", "behind", "right")


def describe_event(episode: Episode) -> str:
    """Return what a failure is, such as ``collision, person left``.

    The side is where the other body is, in the frame of the first robot, in quarters of 90 degrees: ahead is 45 degrees
    to the left to 45 degrees to the right.

    >>> from crowdbot.simulation import simulate
    >>> from crowdbot.trials import load_trial
    >>> describe_event(simulate(load_trial("frontal", duration=1.0)))
    'timeout'
    """
    if episode.outcome == "error":
        return "error" if episode.failure is None else f"error: {str(episode.failure)[:60]}"
    robot = episode.robots[0]
    own = int(episode.ids[robot])
    touched = next(((time, one) for time, one in episode.contacts if own in (one.robot, one.other)), None)
    if touched is None or not episode.metrics.get("collision"):
        return episode.outcome
    time, contact = touched
    other = contact.other if contact.robot == own else contact.robot
    if other == WALL:
        return f"{episode.outcome}, wall"
    kind = "robot" if other in [int(episode.ids[k]) for k in episode.robots] else "person"
    row = min(int(np.searchsorted(episode.times, time - 1e-9)), len(episode.times) - 1)
    column = np.flatnonzero(episode.ids == other)
    if not len(column) or not episode.active[row, column[0]]:
        return f"{episode.outcome}, {kind}"
    away = episode.position[row, column[0]] - episode.position[row, robot]
    angle = wrap_angle(math.atan2(away[1], away[0]) - float(episode.heading[row, robot]))
    side = SIDES[round(angle / (math.pi / 2.0)) % 4]
    return f"{episode.outcome}, {kind} {side}"
