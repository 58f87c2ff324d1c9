"""Collision filters of the physics world: values of MuJoCo's ``contype`` and ``conaffinity``.

Two geoms collide if the type of one is in the affinity of the other. People do not collide with each other (the crowd
model separates them) or with the floor (their feet are placed on it). Of the limbs of a person, only the trunk collides
with walls and fixed objects.
"""

from __future__ import annotations

__all__ = ["DYNAMIC", "GROUND", "LIMB", "PULLED", "ROBOT", "STANDING", "TRUNK"]

_ROBOT, _STAGE, _PERSON, _MOVED, _FLOOR = 1, 2, 4, 8, 16


def _bits(kind: int, touches: int) -> dict[str, str]:
    return {"contype": str(kind), "conaffinity": str(touches)}


PULLED = (_ROBOT, _ROBOT | _STAGE | _PERSON | _MOVED)
"""Robots with a pulled base; parts that would rub on the floor do not collide with it."""
ROBOT = (_ROBOT, PULLED[1] | _FLOOR)
GROUND = _bits(_FLOOR, 0)
STANDING = _bits(_STAGE, _ROBOT | _MOVED)
DYNAMIC = _bits(_MOVED, _ROBOT | _STAGE | _PERSON | _MOVED | _FLOOR)
LIMB = _bits(_PERSON, _ROBOT | _MOVED)
TRUNK = _bits(_PERSON, _ROBOT | _MOVED | _STAGE)
