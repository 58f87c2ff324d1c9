"""Body measures for the gait: legs, feet, arms, and rest frames of limbs."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crowdbot.typing import Floats

from .asset import shapes

CHAINS = ("thigh_l", "thigh_r", "calf_l", "calf_r", "upperarm_l", "upperarm_r", "lowerarm_l", "lowerarm_r")
"""Bones whose rotation is computed from the directions of axis and hinge, in the order of ``frame``."""
ENDS = ("calf_l", "calf_r", "foot_l", "foot_r", "lowerarm_l", "lowerarm_r", "hand_l", "hand_r")


class Measures(NamedTuple):
    """Lengths of N bodies [m]; both legs are assumed equal.

    Fields: ``leg [N]`` height of the hip joint; ``thigh``, ``shank [N]``; ``ankle [N]`` height of the ankle;
    ``ball [N, 2]`` distance ahead of the ankle and height; ``heel``, ``toe [N]`` distance ahead of the ankle;
    ``arm [N, 2]`` upper and lower arm; ``head [N, B, 3]`` start of each bone at rest; ``frame [N, 8, 3, 3]`` axis,
    hinge and their cross product (rows) of each of :data:`CHAINS` at rest; ``height [N]`` stature.
    """

    leg: Floats
    thigh: Floats
    shank: Floats
    ankle: Floats
    ball: Floats
    heel: Floats
    toe: Floats
    arm: Floats
    head: Floats
    frame: Floats
    height: Floats


def measures(heads: Floats, sole: Floats, scale: Floats, height: Floats) -> Measures:
    """Return the measures of N bodies with ``scale [N]`` and ``height [N]`` [m].

    Args:
        heads: start of each bone at rest ``[N, B, 3]`` [m], before scaling.
        sole: rear and front end of the sole ``[N, 2]`` [m], before scaling.
        scale: ratio of stature to that at rest ``[N]``.
        height: stature ``[N]`` [m].
    """
    every = shapes()
    head = heads * scale[:, None, None]

    def length(a: str, b: str) -> Floats:
        return np.asarray(np.linalg.norm(head[:, every.bone(b)] - head[:, every.bone(a)], axis=-1))

    ankle = head[:, every.bone("foot_l")]
    ball = head[:, every.bone("ball_l")]
    heel, toe = (sole * scale[:, None]).T
    return Measures(
        leg=head[:, every.bone("thigh_l"), 2].copy(),
        thigh=length("thigh_l", "calf_l"),
        shank=length("calf_l", "foot_l"),
        ankle=ankle[:, 2].copy(),
        ball=np.stack([ball[:, 0] - ankle[:, 0], ball[:, 2]], axis=1),
        heel=heel - ankle[:, 0],
        toe=toe - ankle[:, 0],
        arm=np.stack([length("upperarm_l", "lowerarm_l"), length("lowerarm_l", "hand_l")], axis=1),
        head=head,
        frame=_frames(head),
        height=np.asarray(height, dtype=np.float64),
    )


def _frames(head: Floats) -> Floats:
    """Return the rest frames of :data:`CHAINS`: knees bend about the left axis of the body, elbows as at rest."""
    every = shapes()
    axis = np.stack([head[:, every.bone(e)] - head[:, every.bone(c)] for c, e in zip(CHAINS, ENDS, strict=True)], 1)
    axis = axis / np.linalg.norm(axis, axis=-1, keepdims=True)
    hinge = np.zeros_like(axis)
    hinge[:, :4, 1] = 1.0
    elbow = np.cross(axis[:, 4:6], axis[:, 6:8])
    hinge[:, 4:6], hinge[:, 6:8] = elbow, elbow
    hinge = hinge - axis * (hinge * axis).sum(-1, keepdims=True)
    hinge = hinge / np.linalg.norm(hinge, axis=-1, keepdims=True)
    return np.stack([axis, hinge, np.cross(axis, hinge)], axis=2)
