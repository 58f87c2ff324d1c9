"""Who can touch whom in a physics world: bits of MuJoCo's ``contype`` and ``conaffinity``.

Two shapes touch when one's type is in the other's affinity. People do not touch each other (their crowd model keeps
them apart) nor the floor (their feet are placed on it); of a person only the trunk touches walls and what stands fast.
"""

from __future__ import annotations

__all__ = ["DYNAMIC", "GROUND", "LIMB", "PULLED", "ROBOT", "STANDING", "TRUNK"]

_ROBOT, _STAGE, _PERSON, _MOVED, _FLOOR = 1, 2, 4, 8, 16


def _bits(kind: int, touches: int) -> dict[str, str]:
    return {"contype": str(kind), "conaffinity": str(touches)}


PULLED = (_ROBOT, _ROBOT | _STAGE | _PERSON | _MOVED)
"""Robots whose base is pulled along: what of them would rub on the floor does not."""
ROBOT = (_ROBOT, PULLED[1] | _FLOOR)
GROUND = _bits(_FLOOR, 0)
STANDING = _bits(_STAGE, _ROBOT | _MOVED)
DYNAMIC = _bits(_MOVED, _ROBOT | _STAGE | _PERSON | _MOVED | _FLOOR)
LIMB = _bits(_PERSON, _ROBOT | _MOVED)
TRUNK = _bits(_PERSON, _ROBOT | _MOVED | _STAGE)
