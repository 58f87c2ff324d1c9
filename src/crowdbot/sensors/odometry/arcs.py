"""Arcs of constant twist between planar poses."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import Pose
from crowdbot.typing import Floats


def arc_between(before: Pose, after: Pose) -> tuple[Floats, Floats, Floats]:
    """Return forward [m], left [m] and turn [rad] of the arcs of constant twist between two poses, ``[E]`` each.

    >>> [part.round(3).tolist() for part in arc_between(Pose.of((0.0, 0.0), 0.0), Pose.of((1.0, 1.0), math.pi / 2))]
    [[1.571], [0.0], [1.571]]
    """
    turn = math.pi - (math.pi - (after.heading - before.heading)) % (2.0 * math.pi)
    step = after.position - before.position
    middle = before.heading + 0.5 * turn
    cos, sin = np.cos(middle), np.sin(middle)
    bend = 1.0 / np.sinc(turn / (2.0 * math.pi))  # arc over chord
    return bend * (cos * step[:, 0] + sin * step[:, 1]), bend * (cos * step[:, 1] - sin * step[:, 0]), turn


def along_arc(pose: Pose, forward: Floats, left: Floats, turn: Floats) -> Pose:
    """Return the pose at the end of arcs, ``[E]``; the inverse of :func:`arc_between`."""
    middle = pose.heading + 0.5 * turn
    cos, sin = np.cos(middle), np.sin(middle)
    chord = np.sinc(turn / (2.0 * math.pi))
    step = np.stack([cos * forward - sin * left, sin * forward + cos * left], axis=1) * chord[:, None]
    return Pose(pose.position + step, pose.heading + turn)
