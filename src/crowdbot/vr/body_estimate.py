"""BodyEstimator: where a participant stands and faces, from the poses of head and hands."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import wrap_angle
from crowdbot.humans import BodyPose, People, eye_offsets, rest_skeleton
from crowdbot.typing import Floats

from .headset_sample import HeadsetSample
from .rigid_transform import RigidTransform
from .rotation_matrices import matrices, unit_quaternions

NECK = math.radians(50.0)
"""Largest angle between head and trunk; beyond it the trunk turns with the head."""
SETTLE, SETTLE_WALKING = 2.0, 0.4
"""Time constant [s] with which the trunk turns to the direction of the head, standing and walking."""
WALKING = 0.5
"""Speed of the head [m/s] above which the participant walks."""
PAUSE = 0.5
"""Interval [s] between two samples above which the estimate starts anew."""
BOW = (math.radians(20.0), math.radians(60.0))
"""Downward pitch of the head from which on a lower head is a bow, and from which on it is nothing but a bow."""
DIGITS = 5
"""Decimals of poses [m] in orders."""


class BodySize(NamedTuple):
    """Lengths of a body that relate the eyes to the trunk [m].

    Fields:
        eye_height: height of the eyes in upright standing.
        eyes: eyes relative to the lower end of the neck, ahead and up.
        neck: lower end of the neck ahead of the pelvis.
        trunk: height of the lower end of the neck above the hips.
        stature: height of the body.
    """

    eye_height: float
    eyes: tuple[float, float]
    neck: float
    trunk: float
    stature: float

    @classmethod
    def of(cls, people: People, number: int = 0) -> BodySize:
        """Return the size of a person of a group.

        >>> size = BodySize.of(People.of(["man-20"]))
        >>> 0.9 < size.eye_height / size.stature < 0.96
        True
        """
        bones = rest_skeleton(people, number)
        eye = bones.head[bones.bone("head")] + eye_offsets(people)[number]
        neck, pelvis = bones.head[bones.bone("neck_01")], bones.head[0]
        hips = float(bones.head[bones.bone("thigh_l"), 2])
        ahead, up = (float(one) for one in (eye - neck)[[0, 2]])
        away = float(neck[0] - pelvis[0])
        return cls(float(eye[2]), (ahead, up), away, float(neck[2]) - hips, float(people.measures.height[number]))


class BodyEstimator:
    """Estimates position and trunk heading of a participant, sample after sample.

    The trunk faces where the head does, up to 50 degrees aside: a look over the shoulder does not turn the body, and
    walking ahead turns it sooner. The pelvis is below the neck; if the head is lower than in standing and looks down,
    the participant bows, so the pelvis is behind. Head and hands are where they were measured; the inverse kinematics
    of the avatar brings trunk, arms and legs there, and its gait sets the feet, which stay where they are planted.

    Args:
        size: body of the avatar.

    >>> estimator = BodyEstimator(BodySize.of(People.of(["man-20"])))
    >>> eyes = np.array([1.0, 2.0, 1.6, 1.0, 0.0, 0.0, 0.0])
    >>> pose = estimator.update(HeadsetSample(0.0, eyes), RigidTransform.at(0.0, 0.0))
    >>> 0.7 < pose.x < 1.0, pose.y, pose.heading
    (True, 2.0, 0.0)
    """

    def __init__(self, size: BodySize) -> None:
        self.size = size
        self._time = -math.inf
        self._trunk = 0.0
        self._place = np.zeros(2)

    def update(self, sample: HeadsetSample, room: RigidTransform) -> BodyPose | None:
        """Return the pose in the virtual room, or None if the head is not tracked.

        Args:
            sample: what the headset measured, in its room.
            room: transform from the room of the headset to the virtual one.
        """
        if sample.head is None:
            return None
        head = _move(sample.head, room)
        turn = matrices(head[3:])
        heading, down = _direction(turn)
        neck = head[:3] - self.size.eyes[0] * turn[:, 0] - self.size.eyes[1] * turn[:, 2]
        self._turn_trunk(sample.time, heading, neck[:2])
        behind = self.size.neck + self._bow(float(neck[2]), down)
        x, y = neck[:2] - behind * np.array([math.cos(self._trunk), math.sin(self._trunk)])
        hands = {
            f"{name}_hand": _numbers(_move(part, room))
            for name, part in (("left", sample.left), ("right", sample.right))
            if part is not None and _is_near(_move(part, room), head)
        }
        trunk = round(wrap_angle(self._trunk), DIGITS)
        return BodyPose(round(float(x), DIGITS), round(float(y), DIGITS), trunk, head=_numbers(head), **hands)

    def _turn_trunk(self, time: float, heading: float, place: Floats) -> None:
        step = time - self._time
        if not 0.0 <= step <= PAUSE:
            self._trunk = heading
        elif step > 0.0:
            walking = float(np.linalg.norm(place - self._place)) > WALKING * step
            share = 1.0 - math.exp(-step / (SETTLE_WALKING if walking else SETTLE))
            aside = wrap_angle(heading - self._trunk)
            self._trunk += share * aside
            aside = wrap_angle(heading - self._trunk)
            self._trunk += aside - max(-NECK, min(NECK, aside))
        self._time, self._place = time, place

    def _bow(self, height: float, down: float) -> float:
        """Return how far a neck at a height [m] is ahead of its place in upright standing [m]."""
        share = min(1.0, max(0.0, (down - BOW[0]) / (BOW[1] - BOW[0])))
        upright = self.size.eye_height - self.size.eyes[1]
        drop = min(max(0.0, upright - height), self.size.trunk) * share
        return math.sqrt(max(0.0, self.size.trunk**2 - (self.size.trunk - drop) ** 2))


def _direction(turn: Floats) -> tuple[float, float]:
    """Return the heading of the face [rad], also of one that looks straight down or up, and its downward pitch."""
    ahead, up = turn[:, 0], turn[:, 2]
    x, y = ahead[:2] - ahead[2] * up[:2]
    return math.atan2(y, x), -math.asin(max(-1.0, min(1.0, float(ahead[2]))))


def _move(pose: Floats, room: RigidTransform) -> Floats:
    return np.concatenate([room.apply(pose[:3]), unit_quaternions(room.turn(matrices(pose[3:])))])


def _numbers(pose: Floats) -> tuple[float, ...]:
    return tuple(round(one, DIGITS) for one in pose.tolist())


def _is_near(hand: Floats, head: Floats) -> bool:
    """Return whether a hand is where an arm can bring it; a controller on a table is not."""
    return bool(np.linalg.norm(hand[:3] - head[:3]) < 1.5)
