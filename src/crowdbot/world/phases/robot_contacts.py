"""Robot contacts, the third phase of a step: contacts of robots on the straight motion of all agents."""

from __future__ import annotations

import math
from collections.abc import Collection, Sequence

import numpy as np

from crowdbot.core import Scene
from crowdbot.metrics import step_clearance
from crowdbot.world.world import Contact

__all__ = ["find_contacts"]


def find_contacts(before: Scene, after: Scene, robots: Sequence[int], ghosts: Collection[int]) -> tuple[Contact, ...]:
    """Return the pairs of a robot and another agent with negative clearance during a step, each once, in order.

    >>> start = Scene.of([[0.0, 0.0], [1.0, 0.0]], radius=0.3)
    >>> find_contacts(start, start.replace(position=[[[0.5, 0.0], [1.0, 0.0]]]), [0], ())[0].other
    1
    """
    found: list[Contact] = []
    for number, robot in enumerate(robots):
        gap, least = step_clearance(before.position, after.position, after.radius, after.active, robot)
        if least < 0.0 and robot not in ghosts:
            gap[:, list(robots[: number + 1])] = math.inf
            found += [Contact(e, robot, a, float(gap[e, a])) for e, a in np.argwhere(gap < 0.0).tolist()]
    return tuple(sorted(found))
