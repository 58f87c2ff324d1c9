"""Collision filters of the physics world: values of MuJoCo's ``contype`` and ``conaffinity``.

Two geoms collide if the type of one is in the affinity of the other. People do not collide with each other (the crowd
model separates them) or with the floor (their feet are placed on it). Of the limbs of a person, only the trunk collides
with walls and fixed objects.
"""

from __future__ import annotations

__all__ = ["DYNAMIC", "GROUND", "LEAF", "LIMB", "PULLED", "RAISED", "ROBOT", "STANDING", "TRUNK"]

_ROBOT, _STAGE, _PERSON, _MOVED, _FLOOR, _RAISED = 1, 2, 4, 8, 16, 32


def _bits(kind: int, touches: int) -> dict[str, str]:
    return {"contype": str(kind), "conaffinity": str(touches)}


PULLED = (_ROBOT, _ROBOT | _STAGE | _PERSON | _MOVED | _RAISED)
"""Robots with a pulled base; parts that would rub on the floor do not collide with it. Raised ground stops them."""
ROBOT = (_ROBOT, PULLED[1] | _FLOOR)
GROUND = _bits(_FLOOR, 0)
RAISED = _bits(_FLOOR | _RAISED, 0)
LEAF = _bits(0, _ROBOT | _PERSON | _MOVED)
"""Leaves of doors do not touch the walls beside them."""
STANDING = _bits(_STAGE, _ROBOT | _MOVED)
DYNAMIC = _bits(_MOVED, _ROBOT | _STAGE | _PERSON | _MOVED | _FLOOR)
LIMB = _bits(_PERSON, _ROBOT | _MOVED)
TRUNK = _bits(_PERSON, _ROBOT | _MOVED | _STAGE)
