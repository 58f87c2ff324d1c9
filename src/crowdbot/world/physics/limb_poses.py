"""Poses of limbs as capsules of the engine, and movements of limbs after contacts."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.humans import limb_chain

from .mjcf_model import LIMB_NAMES

__all__ = ["capsule_poses", "chain_rows", "guard_limbs"]

Floats = NDArray[np.float64]


def chain_rows(limb: str) -> list[int]:
    """Return the rows of the arm or leg of a limb; empty for the trunk."""
    return [LIMB_NAMES.index(name) for name in limb_chain(limb)]


def guard_limbs(moved: Floats, toward: Floats, farthest: float) -> Floats:
    """Return movements of limb ends that approach what a person touched by at most ``farthest`` [m].

    Args:
        moved: movements of both ends ``[P, L, 6]`` [m].
        toward: horizontal unit vectors ``[P, 2]`` from the person to what it touched; 0 for nothing.
        farthest: largest movement in this direction [m].
    """
    ends = moved.reshape(*moved.shape[:2], 2, 3).copy()
    closing = ends[..., 0] * toward[:, None, None, 0] + ends[..., 1] * toward[:, None, None, 1]
    ends[..., :2] -= np.maximum(0.0, closing - farthest)[..., None] * toward[:, None, None]
    return ends.reshape(moved.shape)


def capsule_poses(limbs: Floats) -> tuple[Floats, Floats, Floats]:
    """Return middle ``[P, L, 3]``, half length ``[P, L]`` [m] and rotation ``[P, L, 4]`` of limbs ``[P, L, 6]``."""
    ends = limbs.reshape(-1, 6)
    axis = ends[:, 3:] - ends[:, :3]
    length = np.maximum(np.sqrt(np.sum(axis * axis, axis=1)), 1e-9)
    middle = (0.5 * (ends[:, 3:] + ends[:, :3])).reshape(*limbs.shape[:2], 3)
    turn = _upright_to(axis / length[:, None]).reshape(*limbs.shape[:2], 4)
    return middle, (0.5 * length).reshape(limbs.shape[:2]), turn


def _upright_to(direction: Floats) -> Floats:
    """Return quaternions ``[N, 4]`` that rotate the z axis to unit vectors ``[N, 3]``."""
    x, y, z = direction.T
    turn = np.stack([1.0 + z, -y, x, np.zeros_like(x)], axis=-1)
    turn[z < -1.0 + 1e-9] = (0.0, 1.0, 0.0, 0.0)
    return np.asarray(turn / np.sqrt(np.sum(turn * turn, axis=1, keepdims=True)))
