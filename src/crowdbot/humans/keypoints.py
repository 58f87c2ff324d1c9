"""Keypoints (COCO) and bones of people, for labels and for programs that pose the whole skeleton."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from crowdbot.typing import Floats

from .asset import shapes
from .people import People
from .posture import Posture

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


class RestSkeleton(NamedTuple):
    """The 28 bones of a person in the rest shape: x forward, y left, z up, feet on the floor.

    Fields:
        names: names of the bones, in the order of ``BodyPose.skeleton``.
        parents: index of the parent of each bone, -1 for the pelvis.
        head: start of each bone ``[28, 3]`` [m].
        hands: axes of the left and right hand ``[2, 3, 3]``: columns to the fingers, left, out of the back of the hand.
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    head: Floats
    hands: Floats

    def bone(self, name: str) -> int:
        """Return the index of a bone."""
        return self.names.index(name)


def rest_skeleton(people: People, number: int = 0) -> RestSkeleton:
    """Return the bones of a person of a group, scaled to the stature of the person.

    Args:
        people: the group.
        number: index of the person.

    >>> bones = rest_skeleton(People.of(["man-20"]))
    >>> bones.names[0], len(bones.names), bones.parents[bones.bone("foot_l")] == bones.bone("calf_l")
    ('pelvis', 28, True)
    """
    every, body = shapes(), int(people.body[number])
    return RestSkeleton(
        every.bones, tuple(every.parents.tolist()), people.measures.head[number].copy(), people.rows.hands[body].copy()
    )
