"""Poses of limbs as capsules of the engine, and movements of limbs after contacts."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.humans import limb_chain
from crowdbot.typing import Bools, Floats, Ints

from .mjcf_model import LIMB_NAMES


def chain_rows(limb: str) -> list[int]:
    """Return the rows of the arm or leg of a limb; empty for the trunk."""
    return [LIMB_NAMES.index(name) for name in limb_chain(limb)]


@kernel
def move_limbs(
    here: Ints, walk: Floats, touched: Ints, wary: Ints, toward: Floats, speeds: Floats, step: float, fresh: Bools,
    late: Bools, stride: Floats, limbs: Floats, walked: Floats, swing: Floats, position: Floats, rotation: Floats,
    size: Floats, bound: Floats,
) -> None:  # fmt: skip
    """Move limbs according to the gait, and write the poses of their capsules, in place.

    Limbs of people in contact keep their pose and return slowly afterwards. Towards what a person touched, they move
    even more slowly.

    Args:
        here: bodies in use ``[P]``.
        walk: ends of the limbs ``[P, L, 6]`` [m] by the gait.
        touched, wary: engine steps for which limbs keep their pose, and return slowly ``[S]``.
        toward: horizontal unit vectors ``[S, 2]`` from the person to what it touched.
        speeds: largest speeds [m/s] in general, after a contact, and towards what was touched.
        step: duration of the engine step [s].
        fresh, late: whether bodies are new, and whether their limbs are behind the gait ``[S]``.
        stride: velocities of the ends ``[S, L, 6]`` [m/s] by the gait.
        limbs, walked, swing: ends of the limbs [m], those by the gait, and velocities [m/s] ``[S, L, 6]``.
        position, rotation, size, bound: capsules, see :class:`BodyShapes`.
    """
    count = walk.shape[1]
    moved, guarded, share = np.empty((count, 6)), np.empty((count, 6)), np.empty(count)
    for k in range(len(here)):
        s = here[k]
        held = touched[s] > 0 and not fresh[s]
        slow = held or late[s]
        fastest = speeds[1] if slow else speeds[0]
        tx, ty = (toward[s, 0], toward[s, 1]) if slow and wary[s] > 0 else (0.0, 0.0)
        behind = held
        for limb in range(count):
            first, second = 0.0, 0.0
            for c in range(6):
                lag = walk[k, limb, c] - limbs[s, limb, c]
                moved[limb, c] = lag
                if c < 3:
                    first += lag * lag
                else:
                    second += lag * lag
            part = min(1.0, fastest * step / max(math.sqrt(max(first, second)), 1e-12))
            if held:
                part = 0.0
            if fresh[s]:
                part = 1.0
            share[limb] = part
            behind = behind or part < 1.0
            for end in range(0, 6, 3):
                for c in range(3):
                    moved[limb, end + c] = part * moved[limb, end + c]
                    guarded[limb, end + c] = moved[limb, end + c]
                excess = max(0.0, moved[limb, end] * tx + moved[limb, end + 1] * ty - speeds[2] * step)
                guarded[limb, end] -= excess * tx
                guarded[limb, end + 1] -= excess * ty
                for c in range(3):
                    behind = behind or guarded[limb, end + c] != moved[limb, end + c]
        late[s] = slow and behind
        fresh[s] = False
        for limb in range(count):
            keeps = late[s] or share[limb] < 1.0
            for c in range(6):
                limbs[s, limb, c] = limbs[s, limb, c] + guarded[limb, c] if keeps else walk[k, limb, c]
                swing[s, limb, c] = guarded[limb, c] / step if keeps else stride[s, limb, c]
                walked[s, limb, c] = walk[k, limb, c]
            _write_capsule(s, limb, limbs, position, rotation, size, bound)


@kernel(inline=True)
def _write_capsule(
    s: int, limb: int, limbs: Floats, position: Floats, rotation: Floats, size: Floats, bound: Floats
) -> None:
    """Write middle, rotation, half length and bounding radius of a limb; the rotation takes the z axis to the limb."""
    a = limbs[s, limb]
    x, y, z = a[3] - a[0], a[4] - a[1], a[5] - a[2]
    length = max(math.sqrt(x * x + y * y + z * z), 1e-9)
    for c in range(3):
        position[s, limb, c] = 0.5 * (a[3 + c] + a[c])
    size[s, limb, 1] = 0.5 * length
    bound[s, limb] = 0.5 * length + size[s, limb, 0]
    x, y, z = x / length, y / length, z / length
    q0, q1, q2 = 1.0 + z, -y, x
    if z < -1.0 + 1e-9:
        q0, q1, q2 = 0.0, 1.0, 0.0
    norm = math.sqrt(q0 * q0 + q1 * q1 + q2 * q2)
    rotation[s, limb, 0], rotation[s, limb, 1] = q0 / norm, q1 / norm
    rotation[s, limb, 2], rotation[s, limb, 3] = q2 / norm, 0.0
