"""Posture on uneven ground: the feet stand on the surface, and the pelvis is as high as the legs permit."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats, Ints

from .asset import shapes
from .people import People
from .posture import SOFT, STRAIGHT, Posture, bend_leg, place_chain

LEGS = (20, 24)
"""First bones of the left and right leg: thigh, shank, foot, toes."""


def ankle_positions(posture: Posture) -> Floats:
    """Return the positions ``[N, 2, 3]`` [m] of the left and right ankle."""
    return posture.position[:, [first + 2 for first in LEGS]]


@kernel
def _raise(
    thigh: float, shank: float, yaw: float, up: Floats, first: Ints, head: Floats, frame: Floats, parents: Ints,
    R: Floats, P: Floats,
) -> None:  # fmt: skip
    """Raise the feet of one person, and the pelvis by the mean, or less if a leg is too short."""
    ankle = np.empty((2, 3))
    lift = 0.5 * (up[0] + up[1])
    low, limit = lift, np.empty(2)
    longest = STRAIGHT * (thigh + shank)
    for f in range(2):
        hip, foot = P[first[f]], P[first[f] + 2]
        ankle[f, 0], ankle[f, 1], ankle[f, 2] = foot[0], foot[1], foot[2] + up[f]
        dx, dy = foot[0] - hip[0], foot[1] - hip[1]
        tall = math.sqrt(max(longest * longest - dx * dx - dy * dy, (0.5 * longest) ** 2))
        # the pose on level ground may stretch a leg a little more than this
        limit[f] = max(ankle[f, 2] + tall - hip[2], up[f])
        low = min(low, limit[f])
    far = math.exp((low - limit[0]) / SOFT) + math.exp((low - limit[1]) / SOFT) + math.exp((low - lift) / SOFT)
    # the smooth minimum of three equal heights is that height
    lift = low - SOFT * math.log(far / 3.0) if low < lift else low
    lift = min(lift, low)
    for b in range(len(P)):
        P[b, 2] += lift
    for f in range(2):
        b = first[f]
        hip = P[b, 0], P[b, 1], P[b, 2]
        bend_leg(hip, (ankle[f, 0], ankle[f, 1], ankle[f, 2]), thigh, shank, yaw, frame, f, R, b)
        place_chain(first[f] + 1, first[f] + 4, head, parents, R, P)


@kernel
def _raise_all(
    lengths: Floats, yaw: Floats, up: Floats, first: Ints, heads: Floats, frames: Floats, parents: Ints, R: Floats,
    P: Floats,
) -> None:  # fmt: skip
    for i in range(len(up)):
        if up[i, 0] != 0.0 or up[i, 1] != 0.0:
            _raise(lengths[i, 0], lengths[i, 1], yaw[i], up[i], first, heads[i], frames[i], parents, R[i], P[i])


def stand_on_ground(posture: Posture, people: People, yaw: Floats, up: Floats) -> Posture:
    """Return the posture of people whose feet are raised to the ground under them.

    Args:
        posture: posture of N people on level ground.
        people: their bodies.
        yaw: headings ``[N]`` [rad].
        up: height of the ground ``[N, 2]`` [m] under the left and the right foot.

    >>> from crowdbot.humans import Gait
    >>> people = People.of(["man-20"])
    >>> gait = Gait(people)
    >>> level = gait.posture(gait.start([[0.0, 0.0]], [0.0]))
    >>> found = stand_on_ground(level, people, np.zeros(1), np.array([[0.2, 0.2]]))
    >>> (found.position - level.position)[0, [0, 5, 22, 26], 2].round(3).tolist()
    [0.2, 0.2, 0.2, 0.2]
    """
    body = people.measures
    result = Posture(posture.rotation.copy(), posture.position.copy())
    lengths = np.stack([body.thigh, body.shank], axis=1)
    parents, first = shapes().parents, np.array(LEGS, dtype=np.int64)
    _raise_all(lengths, yaw, up, first, body.head, body.frame, parents, result.rotation, result.position)
    return result
