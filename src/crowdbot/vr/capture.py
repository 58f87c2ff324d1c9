"""Motion capture suits that participants wear with the headset."""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from crowdbot.bridges import FootLock, MotionSample, PoseStream, Retargeting, SourceSkeleton, StreamStatistics
from crowdbot.core import wrap_angle
from crowdbot.humans import BodyPose, People, eye_offsets, rest_skeleton
from crowdbot.typing import Floats

from .rigid_transform import RigidTransform, matrices, unit_quaternions


def sample_record(sample: MotionSample) -> dict[str, Any]:
    """Return a sample as it came, JSON: positions ``[J, 3]`` [m] and quaternions ``[J, 4]`` of its joints.

    >>> sample_record(MotionSample(3, 0.5, np.zeros((1, 3)), np.eye(3)[None]))["rotation"]
    [[1.0, 0.0, 0.0, 0.0]]
    """
    turns = np.array([unit_quaternions(item) for item in sample.rotation])
    return {
        "number": sample.number, "time": sample.time, "position": sample.position.round(4).tolist(),
        "rotation": turns.round(5).tolist(),
    }  # fmt: skip


class StreamTap(PoseStream):
    """Gives the samples of an open stream, and tells each with its subject; it neither opens nor closes the stream.

    Args:
        stream: an open stream.
        tell: called with ``{"capture": subject, "step": simulated time [s], ...}`` and :func:`sample_record`.
    """

    def __init__(self, stream: PoseStream, tell: Callable[[dict[str, Any]], None]) -> None:
        self.stream, self.live = stream, stream.live
        self._tell = tell

    def subjects(self) -> tuple[str, ...]:
        return self.stream.subjects()

    def read(self, subject: str, now: float, ahead: float) -> list[tuple[float, MotionSample]]:
        result = self.stream.read(subject, now, ahead)
        for time, sample in result:
            self._tell({"capture": subject, "step": round(time, 6), **sample_record(sample)})
        return result

    def statistics(self, subject: str = "") -> StreamStatistics:
        return self.stream.statistics(subject)

    def latency(self) -> tuple[float, float] | None:
        return self.stream.latency()


TURN, PLACE = 10.0, 2.0
"""Time constants [s] with which heading and place of the suit follow those of the headset: suits drift slowly."""
JUMP = 0.5
"""Distance [m] of suit and headset above which the suit is placed anew."""
TIMEOUT = 0.25
"""Age of the latest sample [s] above which the suit is silent."""
DIGITS = 6


class Suit:
    """The whole body of a participant: joints from the suit, place and heading from the headset.

    A suit of inertial sensors measures the body well, but its place and heading drift. The headset measures both. The
    head segment of the suit is turned and moved onto the head, slowly, so that planted feet stay where they are.

    Args:
        stream: an open stream.
        subject: name of the subject in the stream; empty: the first one.
    """

    def __init__(self, stream: PoseStream, subject: str = "") -> None:
        self.stream, self.subject = stream, subject
        self.people, self.number = People.of(["man-20"]), 0
        self._fit: tuple[SourceSkeleton, FootLock] | None = None
        self._sample: tuple[float, MotionSample] | None = None
        self._aligned: tuple[float, float, Floats] | None = None

    def dress(self, people: People, number: int) -> None:
        """Give the suit to a person of a group."""
        self.people, self.number = people, number
        self._fit = self._sample = self._aligned = None

    def pose(self, head: Floats, now: float, ahead: float) -> BodyPose | None:
        """Return the pose of the body for the next step, or None while the suit is silent.

        Args:
            head: x, y, z [m] and quaternion of the eyes in the virtual room, from the headset.
            now: simulated time [s].
            ahead: simulated time of the next step [s].
        """
        for time, sample in self.stream.read(self.subject, now, ahead)[-1:]:
            self._sample = (min(time, ahead), sample)
        if self._sample is None or self._sample[1].skeleton is None or now - self._sample[0] > TIMEOUT:
            self._aligned = None
            return None
        sample = self._sample[1]
        lock = self._lock(self._sample[1].skeleton)
        turn = self._turn(sample, head, now)
        pose = lock.pose(sample.number, sample.time, sample.position @ turn.T, turn @ sample.rotation)
        return self._moved(pose, head, now)

    def raw(self) -> dict[str, Any] | None:
        """Return the latest sample as it came, JSON: positions ``[J, 3]`` [m] and quaternions ``[J, 4]``."""
        return None if self._sample is None else sample_record(self._sample[1])

    def _lock(self, skeleton: SourceSkeleton) -> FootLock:
        if self._fit is None or self._fit[0] is not skeleton:
            self._fit = (skeleton, FootLock(Retargeting(skeleton, rest_skeleton(self.people, self.number))))
        return self._fit[1]

    def _turn(self, sample: MotionSample, head: Floats, now: float) -> Floats:
        """Return the rotation about z that turns the head segment to the heading of the headset, smoothed."""
        assert sample.skeleton is not None
        own = sample.rotation[sample.skeleton.roles["head"]]
        wish = wrap_angle(_heading(matrices(head[3:])) - _heading(own))
        if self._aligned is None:
            self._aligned = (now, wish, np.full(2, np.nan))
        time, angle, shift = self._aligned
        angle += (1.0 - math.exp(-(now - time) / TURN)) * wrap_angle(wish - angle)
        self._aligned = (time, angle, shift)
        return RigidTransform.at(0.0, 0.0, angle).rotation

    def _moved(self, pose: BodyPose, head: Floats, now: float) -> BodyPose:
        """Return the pose with its eyes where those of the headset are, smoothed, on the floor."""
        assert pose.skeleton is not None
        assert self._aligned is not None
        time, angle, shift = self._aligned
        wish = head[:2] - self._eyes(pose)[:2]
        if not np.hypot(*(wish - shift)) < JUMP:
            shift = wish
        shift = shift + (1.0 - math.exp(-(now - time) / PLACE)) * (wish - shift)
        self._aligned = (now, angle, shift)
        x, y = (round(float(item), DIGITS) for item in (pose.x + shift[0], pose.y + shift[1]))
        return BodyPose(x, y, pose.heading, skeleton=(x, y, *pose.skeleton[2:]))

    def _eyes(self, pose: BodyPose) -> Floats:
        """Return the middle between the eyes of the person in a pose [m]."""
        assert pose.skeleton is not None
        bones = rest_skeleton(self.people, self.number)
        turns = matrices(np.array(pose.skeleton[3:]).reshape(-1, 4))
        chain, k = [], bones.bone("head")
        while k >= 0:
            chain.append(k)
            k = bones.parents[k]
        turn, place = RigidTransform.at(0.0, 0.0, pose.heading).rotation, np.array(pose.skeleton[:3])
        for b in reversed(chain):
            if bones.parents[b] >= 0:
                place = place + turn @ (bones.head[b] - bones.head[bones.parents[b]])
            turn = turn @ turns[b]
        eye = eye_offsets(self.people)[self.number]
        return np.asarray(place + turn @ eye)


def _heading(turn: Floats) -> float:
    """Return the heading of a face [rad], also of one that looks down or up."""
    x, y = turn[:2, 0] - turn[2, 0] * turn[:2, 2]
    return math.atan2(y, x)
