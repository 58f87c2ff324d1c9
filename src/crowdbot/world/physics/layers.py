"""Collision filters of the physics world: values of MuJoCo's ``contype`` and ``conaffinity``.

Two geoms collide if the type of one is in the affinity of the other. People do not collide with the floor (their feet
are placed on it), and with each other only if one of them is out of balance: otherwise the crowd model separates them.
Of the limbs of a person, only the trunk collides with walls and fixed objects.
"""

from __future__ import annotations

from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.humans import LIMBS

_ROBOT, _STAGE, _PERSON, _MOVED, _FLOOR, _RAISED, _UNSTEADY = 1, 2, 4, 8, 16, 32, 64


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
TRUNK = _bits(_PERSON, _ROBOT | _MOVED | _STAGE | _UNSTEADY)
_IS_TRUNK = np.array([limb.region == "torso" for limb in LIMBS])


def write_layers(
    model: Any,
    geoms: NDArray[np.int64],
    bodies: NDArray[np.int64],
    unsteady: NDArray[np.bool_],
    down: NDArray[np.bool_],
) -> None:
    """Let people out of balance push others: with the trunk while they stand, with all limbs on their way down.

    Args:
        model: engine model.
        geoms, bodies: limbs ``[S, L]`` and bodies ``[S]`` of people.
        unsteady, down: ``[S]`` whether a body is out of balance, and whether it falls or lies.
    """
    if not len(bodies):
        return
    pushing = (unsteady[:, None] & _IS_TRUNK) | down[:, None]
    model.geom_contype[geoms.ravel()] = np.where(pushing, _PERSON | _UNSTEADY, _PERSON).ravel()
    model.body_contype[bodies] = np.where(unsteady | down, _PERSON | _UNSTEADY, _PERSON)
