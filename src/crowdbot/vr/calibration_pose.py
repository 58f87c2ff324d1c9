"""Calibration pose: stature and arm length of a participant who stands with both arms out to the sides."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.humans import People, eye_offsets, names, rest_skeleton
from crowdbot.typing import Floats

from .body_estimate import BodySize
from .headset_sample import HeadsetSample

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
    whole = [(one.head, one.left, one.right) for one in samples if _is_whole(one)][-POSE_SAMPLES:]
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
