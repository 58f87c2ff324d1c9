"""TrackerMessages: people, odometry and transforms of ROS as frames of a tracker in one fixed coordinate frame."""

from __future__ import annotations

import dataclasses
from collections import deque
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.data import DETECTIONS, PEOPLE_TYPES, PERSON_CLASSES, Frames, detected_people, frame_name, stamp_of
from crowdbot.typing import Floats

from .tracker_frame import TrackerFrame

SECOND = 1_000_000_000
ODOMETRY = "nav_msgs/msg/Odometry"
TRANSFORMS = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
KEPT = 10 * SECOND
"""How long transforms are kept [ns]."""
QUEUE = 20
"""Largest number of messages of people that wait for the transform of their stamp, as in the filters of tf2."""


class _People(NamedTuple):
    """A message of people: stamp [ns], coordinate frame, and what it says of N people there."""

    stamp: int
    frame: str
    labels: list[int | str]
    position: Floats
    """``[N, 3]`` [m]."""
    covariance: Floats
    """``[N, 3, 3]`` [m^2], NaN where unknown."""
    radius: Floats
    existence: Floats


class TrackerMessages:
    """Turns messages of ROS into frames of a tracker.

    Args:
        frame: name of the fixed coordinate frame of all positions; None: the first one above the first message.
        robot: name of a coordinate frame of the robot, such as ``base_link``, that is added to each frame as a robot.
        classes: classes of people in detections.
    """

    def __init__(self, frame: str | None, robot: str | None, classes: Sequence[str] = PERSON_CLASSES) -> None:
        self.frame = None if frame is None else frame_name(frame)
        self.robot = None if robot is None else frame_name(robot)
        self.classes = classes
        self._frames = Frames()
        self._waiting: deque[_People] = deque()

    def add(self, message: Any, topic: str) -> list[TrackerFrame]:
        """Return the frames that a message completes, see :meth:`Live.update_from`."""
        kind = _kind(message)
        if kind in PEOPLE_TYPES:
            self._waiting.append(_people(kind, message, self.classes))
        elif kind == ODOMETRY:
            if not frame_name(message.header.frame_id) or not frame_name(message.child_frame_id):
                raise InputError(
                    f"live: odometry of frame_id {message.header.frame_id!r} and child_frame_id"
                    f" {message.child_frame_id!r} must name both frames, such as odom and base_link"
                )
            self._frames.add_odometry(topic or "/odom", message)
            self._frames.forget(stamp_of(message.header) - KEPT)
        elif kind in TRANSFORMS:
            self._frames.add_transforms(topic or "/tf", message)
            for row in message.transforms[:1]:
                self._frames.forget(stamp_of(row.header) - KEPT)
        else:
            known = ", ".join((*PEOPLE_TYPES, ODOMETRY, TRANSFORMS[0]))
            raise InputError(f"live: a message of type {kind} has no people and no transforms; types are {known}")
        return self._completed()

    def _completed(self) -> list[TrackerFrame]:
        tracker_frames = []
        while self._waiting:
            people = self._waiting[0]
            try:
                frame = self._frame(people)
            except InputError:
                self._waiting.popleft()
                raise
            if frame is None:
                break
            tracker_frames.append(frame)
            self._waiting.popleft()
        if len(self._waiting) > QUEUE:
            people = self._waiting.popleft()
            raise InputError(
                f"live: no transform of {people.frame} to {self.frame} has come for people of"
                f" {people.stamp / SECOND:.3f} s, and {QUEUE} messages wait; the clocks of tracker and odometry differ,"
                " or odometry has stopped"
            )
        return tracker_frames

    def _frame(self, people: _People) -> TrackerFrame | None:
        """Return the frame of a message, or None if a transform of its stamp may still come.

        Raises:
            InputError: no transform joins the frames, or they begin after the stamp.
        """
        target = self._target(people.frame)
        N = len(people.labels)
        turn, shift = self._placement(people.frame, target, people.stamp)
        labels: list[Any] = list(people.labels)
        position, covariance = people.position @ turn.T + shift, turn @ people.covariance @ turn.T
        radius, existence, robots = people.radius, people.existence, list[str]()
        if self.robot is not None:
            if not self._frames.connects(self.robot, target):
                raise InputError(self._unknown(self.robot, target))
            _, place = self._placement(self.robot, target, people.stamp)
            robots, labels = [self.robot], [*labels, self.robot]
            position = np.concatenate([position, place[None]])
            covariance = np.concatenate([covariance, np.full((1, 3, 3), np.nan)])
            radius, existence = np.append(radius, np.nan), np.append(existence, 1.0)
        if np.isnan(position[N:]).any() or np.isnan(turn).any():
            names = [people.frame] if self.robot is None else [people.frame, self.robot]
            if not all(self._frames.may_come(name, target, people.stamp) for name in names):
                raise InputError(
                    f"live: no transform of {' and '.join(names)} to {target} at {people.stamp / SECOND:.3f} s, the"
                    " stamp of the people: transforms begin later or have a gap; send odometry before people, with the"
                    " same clock"
                )
            return None
        spread = None if np.isnan(covariance).all() else covariance[:, :2, :2]
        time = people.stamp / SECOND
        frame = TrackerFrame.of(labels, position[:, :2], robots, time, spread, radius, existence)
        sources = [people.frame] * N + robots
        uncertainty = {name: self._uncertainty(name, target, people.stamp) for name in {*sources}}
        rows = [uncertainty[name] for name in sources]
        return dataclasses.replace(frame, uncertainty=np.array(rows).reshape(-1, 3, 3))

    def _target(self, frame: str) -> str:
        """Return the fixed frame of all positions, which the first message of people decides."""
        chain = self._frames.above(frame)
        if self.frame is None:
            self.frame = next((name for name in chain if self._frames.is_fixed(name)), None)
        if self.frame is None or not self._frames.connects(frame, self.frame):
            raise InputError(self._unknown(frame, self.frame))
        return self.frame

    def _unknown(self, frame: str, target: str | None) -> str:
        to = "a fixed frame (map, odom, world)" if target is None else f"the fixed frame {target}"
        return (
            f"live: no transform joins the frame {frame} with {to}; known are {self._frames.describe()}; send odometry"
            " and /tf_static before people, or name the fixed frame with Live(..., frame=NAME)"
        )

    def _uncertainty(self, frame: str, target: str, stamp: int) -> Floats:
        """Return the covariance ``[3, 3]`` of the placement of a frame, see :meth:`Frames.pose_covariance`."""
        try:
            return self._frames.pose_covariance(frame, target, stamp)
        except InputError as error:
            raise InputError(f"live: {error}") from None

    def _placement(self, frame: str, target: str, stamp: int) -> tuple[Floats, Floats]:
        placement = self._frames.placement(frame, target, np.array([stamp], dtype=np.int64))
        return placement.turn[0], placement.shift[0]


def _kind(message: Any) -> str:
    """Return the type of a message of rosbags, rclpy or rospy, with ``/msg/``."""
    name = getattr(message, "__msgtype__", None) or getattr(message, "_type", None)
    if name is None:
        cls = type(message)
        name = f"{cls.__module__.partition('.')[0]}/msg/{cls.__name__}"
    package, _, rest = str(name).partition("/")
    return f"{package}/msg/{rest.rpartition('/')[2]}"


def _people(kind: str, message: Any, classes: Sequence[str]) -> _People:
    """Return the people of a message.

    Raises:
        InputError: it has no frame, or detections are not of tracked people.
    """
    frame = frame_name(message.header.frame_id)
    if not frame:
        raise InputError(f"live: a message of type {kind} names no frame (header.frame_id is empty)")
    if kind == DETECTIONS:
        try:
            detections = list(detected_people(message, classes))
        except InputError as error:
            raise InputError(f"live: {error}") from None
        pairs = [(person.name, person.point) for person in detections]
        spreads = [person.covariance for person in detections]
        shares = [person.score for person in detections]
    else:
        pairs = list(PEOPLE_TYPES[kind](message))
        tracks = getattr(message, "tracks", ())
        spreads = [np.asarray(track.pose.covariance, dtype=float).reshape(6, 6)[:3, :3] for track in tracks]
        shares = [person.reliability for person in getattr(message, "people", ())]
    N = len(pairs)
    place = np.array([(point.x, point.y, point.z) for _, point in pairs], dtype=float).reshape(N, 3)
    covariance, radius, existence = np.full((N, 3, 3), np.nan), np.full(N, np.nan), np.full(N, np.nan)
    for k, spread in enumerate(spreads):
        if spread is not None and spread.any():  # trackers without covariances leave zeros
            covariance[k] = spread
    for k, share in enumerate(shares):
        existence[k] = share or np.nan  # 0 where it is not filled in
    for k, person in enumerate(getattr(message, "people", ())):
        tags = dict(zip(getattr(person, "tagnames", ()), getattr(person, "tags", ()), strict=False))
        radius[k] = _number(tags.get("radius", "nan"))
    labels = [_label(name) for name, _ in pairs]
    return _People(stamp_of(message.header), frame, labels, place, covariance, radius, existence)


def _label(name: str) -> int | str:
    """Return a whole number where the name is one, as the tracks of recordings."""
    return int(name) if name.isdecimal() and str(int(name)) == name else name


def _number(text: str) -> float:
    try:
        return float(text)
    except ValueError:
        return float("nan")
