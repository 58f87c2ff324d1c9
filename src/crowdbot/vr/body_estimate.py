"""Body of a participant from head and hands, and its measures from a calibration pose."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, wrap_angle
from crowdbot.humans import BodyPose, People, eye_offsets, names, rest_skeleton
from crowdbot.typing import Floats

from .headset_sample import HeadsetSample
from .rigid_transform import RigidTransform, matrices, unit_quaternions

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
        ahead, up = (float(item) for item in (eye - neck)[[0, 2]])
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
    return tuple(round(item, DIGITS) for item in pose.tolist())


def _is_near(hand: Floats, head: Floats) -> bool:
    """Return whether a hand is where an arm can bring it; a controller on a table is not."""
    return bool(np.linalg.norm(hand[:3] - head[:3]) < 1.5)


POSE_SAMPLES = 30
"""Samples of which the median is taken."""
STILL = 0.03
"""Largest standard deviation [m] of head and wrists in a pose that is held."""
UNEQUAL = 0.1
"""Largest difference [m] between both arms."""
LEVEL, LOW = math.radians(25.0), math.radians(70.0)
"""Angle of the arms below the horizontal up to which the pose is a T, and up to which it is an A."""
SHORTEST, TALLEST = 0.5, 2.5
BETTER = 0.01
"""Gain in the length of the arms [m] for which the avatar gets another body."""


class BodyMeasure(NamedTuple):
    """Size of a participant.

    Fields:
        stature: height of the body [m], from the height of the eyes.
        arm: shoulder to wrist [m], the mean of both arms; None if only the height was measured.
        body: name of the body of the same kind whose arms fit best at this stature.
        difference: length of the arms of that body less that of the participant [m], or None.
        pose: ``T`` or ``A``, or empty.
    """

    stature: float
    arm: float | None
    body: str
    difference: float | None
    pose: str


def measure_pose(samples: Sequence[HeadsetSample], body: str) -> BodyMeasure:
    """Return the size of a participant who stands upright with straight arms out to the sides (T) or down (A).

    The shoulders are where those of the avatar are, relative to the eyes, at the stature of the participant. The other
    body is of the same kind, such as another man: bodies differ in proportions by a few centimetres.

    Args:
        samples: the latest samples, with head and both wrists.
        body: name of the body of the avatar.

    Raises:
        InputError: head or wrists are not tracked, move, or are in another pose.

    >>> eyes = np.array([0.0, 0.0, 1.63, 1.0, 0.0, 0.0, 0.0])
    >>> def wrist(y): return np.array([0.0, y, 1.42, 1.0, 0.0, 0.0, 0.0])
    >>> found = measure_pose([HeadsetSample(0.0, eyes, wrist(0.70), wrist(-0.70))] * 30, "man-30")
    >>> found.pose, 1.7 < found.stature < 1.8, 0.45 < found.arm < 0.6, abs(found.difference) < 0.05
    ('T', True, True, True)
    """
    whole = [(sample.head, sample.left, sample.right) for sample in samples if _is_whole(sample)][-POSE_SAMPLES:]
    if len(whole) < POSE_SAMPLES:
        raise InputError("head and both hands must be tracked for half a second")
    points = np.array([[part[:3] for part in row if part is not None] for row in whole])
    if np.max(np.linalg.norm(points.std(axis=0), axis=1)) > STILL:
        raise InputError("the participant moves: hold the pose still")
    head, left, right = np.median(points, axis=0)
    people = People.of([body])
    size = BodySize.of(people)
    stature = round(float(head[2]) * size.stature / size.eye_height, 3)
    if not SHORTEST <= stature <= TALLEST:
        raise InputError(f"the eyes of the participant are {head[2]:.2f} m high: set the floor of the headset first")
    arms = _arms(head, left, right, People.of([body], height=stature))
    down = [math.asin(-arm[2] / float(np.linalg.norm(arm))) for arm in arms]
    lengths = [float(np.linalg.norm(arm)) for arm in arms]
    if max(down) > LOW or min(down) < -LEVEL or abs(lengths[0] - lengths[1]) > UNEQUAL:
        raise InputError("this is neither a T nor an A pose: stretch both arms out to the sides")
    arm = 0.5 * sum(lengths)
    best, difference = _best_body(body, stature, arm)
    return BodyMeasure(stature, round(arm, 3), best, round(difference, 3), "T" if max(down) < LEVEL else "A")


def _is_whole(sample: HeadsetSample) -> bool:
    return sample.head is not None and sample.left is not None and sample.right is not None


def _arms(head: Floats, left: Floats, right: Floats, people: People) -> list[Floats]:
    """Return the vectors from shoulder to wrist of the left and right arm."""
    bones = rest_skeleton(people)
    eyes = bones.head[bones.bone("head")] + eye_offsets(people)[0]
    aside = (left - right)[:2] / max(1e-9, float(np.linalg.norm((left - right)[:2])))
    turn = np.array([[aside[1], aside[0], 0.0], [-aside[0], aside[1], 0.0], [0.0, 0.0, 1.0]])
    shoulders = [bones.head[bones.bone(f"upperarm_{side}")] - eyes for side in "lr"]
    return [wrist - head - turn @ offset for wrist, offset in zip((left, right), shoulders, strict=True)]


def _best_body(body: str, stature: float, arm: float) -> tuple[str, float]:
    """Return the body of the same kind with the best arms, and their difference [m]; the same one if it is as good."""
    kind = body.partition("-")[0]
    known = [name for name in names() if name.partition("-")[0] == kind]
    lengths = People.of(known, height=stature).measures.arm.sum(axis=1) - arm
    best = known[int(np.argmin(np.abs(lengths)))]
    own = float(lengths[known.index(body)])
    found = float(lengths[known.index(best)])
    return (best, found) if abs(found) < abs(own) - BETTER else (body, own)
