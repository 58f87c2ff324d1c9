"""Group cohesion: group membership and group forces (Moussaïd et al. 2010)."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene, kernel
from crowdbot.typing import Floats, Ints


class Groups(NamedTuple):
    """Group members: the group of a row is ``member[begin[row]:end[row]]``, including the row itself."""

    member: Ints
    begin: Ints
    end: Ints


def groups_of(scene: Scene) -> Groups:
    """Return the groups of ``scene``: agents of one environment with the same number, by rows ``e * A + a``.

    >>> pairs = groups_of(Scene.of([[0, 0], [5, 0], [1, 0]], group=[7, -1, 7]))
    >>> pairs.member.tolist(), pairs.begin.tolist(), pairs.end.tolist()
    ([0, 2], [0, 0, 0], [2, 0, 2])
    """
    environment = np.repeat(np.arange(scene.shape[0]), scene.shape[1])
    group = scene.group.reshape(-1)
    begin, end = np.zeros((2, len(group)), dtype=np.int64)
    member = np.flatnonzero((group >= 0) & scene.active.reshape(-1))
    place = scene.position.reshape(-1, 2)[member]
    # sorted by position within a group: sums do not depend on the order of agents
    member = member[np.lexsort((place[:, 1], place[:, 0], group[member], environment[member]))]
    if len(member) > 0:
        first = np.flatnonzero(np.diff(group[member], prepend=-1) | np.diff(environment[member], prepend=-1))
        size = np.diff(first, append=len(member))
        begin[member] = np.repeat(first, size)
        end[member] = np.repeat(first + size, size)
    return Groups(member, begin, end)


@kernel
def group_acceleration(
    row: int, begin: int, end: int, member: Ints, seen: NDArray[np.bool_], place: Floats, velocity: Floats,
    gaze: float, view_angle: float, cohesion: float, repulsion: float, apart: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the acceleration by the group: gaze, cohesion and repulsion (Moussaïd et al. 2010)."""
    x, y = place[row, 0], place[row, 1]
    ax = ay = sx = sy = 0.0
    others = 0
    for k in range(begin, end):
        mate = member[k]
        if mate == row or not seen[mate]:
            continue
        dx, dy = x - place[mate, 0], y - place[mate, 1]
        gap = math.sqrt(dx * dx + dy * dy)
        if 0.0 < gap < apart:
            ax, ay = ax + repulsion * dx / gap, ay + repulsion * dy / gap
        sx, sy = sx - dx, sy - dy
        others += 1
    length = math.sqrt(sx * sx + sy * sy)
    if length == 0.0:
        return ax, ay
    if length / (others + 1) > 0.5 * others:
        ax, ay = ax + cohesion * sx / length, ay + cohesion * sy / length
    vx, vy = velocity[row, 0], velocity[row, 1]
    speed = math.sqrt(vx * vx + vy * vy)
    if speed > 0.0:
        turned = math.acos(min(1.0, max(-1.0, (vx * sx + vy * sy) / (speed * length)))) - view_angle
        if turned > 0.0:
            ax, ay = ax - gaze * turned * vx, ay - gaze * turned * vy
    return ax, ay


@kernel
def pysocialforce_group_acceleration(
    row: int, begin: int, end: int, member: Ints, seen: NDArray[np.bool_], place: Floats, heading: Floats,
    repulsion: float, apart: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the acceleration by the group as PySocialForce 1.1.2 computes it.

    ``heading`` contains the unit direction to the goal and its distance [m]. Cohesion assumes that the distance to the
    centre is 0; the factors of gaze and cohesion are always 1.
    """
    x, y = place[row, 0], place[row, 1]
    ax = ay = sx = sy = 0.0
    others = 0
    for k in range(begin, end):
        mate = member[k]
        if mate == row or not seen[mate]:
            continue
        dx, dy = x - place[mate, 0], y - place[mate, 1]
        if dx * dx + dy * dy <= apart * apart:
            ax, ay = ax + repulsion * dx, ay + repulsion * dy
        sx, sy = sx - dx, sy - dy
        others += 1
    if others == 0:
        return 0.0, 0.0
    soft = 0.5 * (math.tanh(-0.5 * others) + 1.0) / (others + 1)
    ax, ay = ax + soft * sx, ay + soft * sy
    ex, ey, distance = heading[row, 0], heading[row, 1], heading[row, 2]
    if distance > 0.0:
        size = (sx * ex + sy * ey) / (others * distance)
        ax, ay = ax + size * ex, ay + size * ey
    return ax, ay
