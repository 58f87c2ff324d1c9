"""The 23 body segments of Xsens MVN and a rest pose for them."""

from __future__ import annotations

import numpy as np

from crowdbot.typing import Floats

from .source_skeleton import SourceSkeleton

SEGMENTS = (
    "Pelvis", "L5", "L3", "T12", "T8", "Neck", "Head",
    "RightShoulder", "RightUpperArm", "RightForeArm", "RightHand",
    "LeftShoulder", "LeftUpperArm", "LeftForeArm", "LeftHand",
    "RightUpperLeg", "RightLowerLeg", "RightFoot", "RightToe",
    "LeftUpperLeg", "LeftLowerLeg", "LeftFoot", "LeftToe",
)  # fmt: skip
"""Names of the segments in the order of their ids, which begin with 1."""
PARENTS = (-1, 0, 1, 2, 3, 4, 5, 4, 7, 8, 9, 4, 11, 12, 13, 0, 15, 16, 17, 0, 19, 20, 21)
LEG = 0.86
"""Length of the leg of the default rest pose from hip to ankle [m]."""


def xsens_skeleton(origins: Floats | None = None, leg: float = LEG) -> SourceSkeleton:
    """Return the segments of an actor in the T-pose, in which all orientations are identity.

    Args:
        origins: origins of the segments in the T-pose ``[23, 3]`` [m], as in MXTP13 datagrams and MVNX files (default:
            an actor of average proportions).
        leg: length of the leg of the default actor [m].

    >>> round(xsens_skeleton(leg=0.9).leg_length("l"), 3)
    0.9
    """
    return SourceSkeleton(SEGMENTS, PARENTS, _average() * (leg / LEG) if origins is None else origins)


def _average() -> Floats:
    """Return the origins of the segments of an actor of average proportions, 1.75 m tall."""
    trunk = [(0, 0, 0.95), (0, 0, 1.05), (0, 0, 1.16), (0, 0, 1.26), (0, 0, 1.36), (0, 0, 1.5), (0.02, 0, 1.59)]
    arm = [(0, 0.03, 1.45), (0, 0.18, 1.45), (0, 0.47, 1.45), (0, 0.73, 1.45)]
    foot = 0.95 - LEG
    leg = [(0, 0.09, 0.95), (0, 0.09, 0.95 - 0.44), (0, 0.09, foot), (0.15, 0.09, 0.02)]
    right = [[(x, -y, z) for x, y, z in limb] for limb in (arm, leg)]
    return np.array([*trunk, *right[0], *arm, *right[1], *leg], dtype=np.float64)
