"""Keypoints of people: the 17 points of COCO, from the bones and the head."""

from __future__ import annotations

import numpy as np

from crowdbot.humans.asset import shapes
from crowdbot.humans.people import People
from crowdbot.humans.posture import Posture
from crowdbot.typing import Floats

KEYPOINTS = (
    "nose", "left_eye", "right_eye", "left_ear", "right_ear", "left_shoulder", "right_shoulder", "left_elbow",
    "right_elbow", "left_wrist", "right_wrist", "left_hip", "right_hip", "left_knee", "right_knee", "left_ankle",
    "right_ankle",
)  # fmt: skip
KEYPOINT_EDGES = (
    (16, 14), (14, 12), (17, 15), (15, 13), (12, 13), (6, 12), (7, 13), (6, 7), (6, 8), (7, 9), (8, 10), (9, 11),
    (2, 3), (1, 2), (1, 3), (2, 4), (3, 5), (4, 6), (5, 7),
)  # fmt: skip
"""Pairs of keypoints that the skeleton of COCO connects, counted from 1."""
BONES = ("upperarm", "lowerarm", "hand", "thigh", "calf", "foot")
"""Bones that begin at shoulders, elbows, wrists, hips, knees and ankles."""


def keypoint_places(people: People, posture: Posture) -> Floats:
    """Return the keypoints ``[N, 17, 3]`` [m] of people in a posture, in the order of :data:`KEYPOINTS`.

    Source of the order: Lin et al. 2014, Microsoft COCO, doi:10.1007/978-3-319-10602-1_48.
    """
    every = shapes()
    head = every.bone("head")
    away = people.rows.face[people.body] * people.scale[:, None, None] - people.measures.head[:, head, None]
    turned = np.einsum("nij,nkj->nki", posture.rotation[:, head], away) + posture.position[:, head, None]
    bones = [every.bone(f"{name}_{side}") for name in BONES for side in ("l", "r")]
    return np.concatenate([turned, posture.position[:, bones]], axis=1)
