"""Recorded steps of an episode file."""

from __future__ import annotations

import functools
import json
import math
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, NamedTuple, TypeVar, overload

import numpy as np

from crowdbot.core import EpisodeError, Pose
from crowdbot.data import McapChannel, McapMessage, McapPlace, McapReader, read_message
from crowdbot.humans import FallPose
from crowdbot.messages import (
    CODECS,
    COLLISIONS,
    FALL_POSES,
    FALLS,
    FORCES,
    KIND,
    MAP,
    REST,
    ContactEventRecord,
    ContactForceRecord,
    FallRecord,
    Messages,
    decode_reading,
    read_contact_events,
    read_fall_poses,
    read_falls,
    read_forces,
)
from crowdbot.metrics import AgentStates
from crowdbot.sensors import Reading, Scan
from crowdbot.simulation import ScanRow, scan_row

from .metadata import CONTACTS, DIGEST, GESTURE_TOPIC, GROUND_TRUTH, ORDERS, REACTION_TOPIC, heading_of

T = TypeVar("T")
R = TypeVar("R", bound=Reading)
UNUSED = ("/clock", "/map", "/crowd/markers")
"""Topics that are for other tools only."""
SCAN = "sensor_msgs/msg/LaserScan"


class ReadingPlace(NamedTuple):
    """Where the messages of a reading are in an episode file.

    Fields:
        path: the file.
        name: ``robot/sensor``.
        parts: suffix of the topic, type and place of each message.
    """

    path: Path
    name: str
    parts: tuple[tuple[str, str, McapPlace], ...]

    @property
    def time(self) -> float:
        """Simulated time [s] at which the robot received the reading."""
        return self.parts[0][2].stamp / 1e9


@functools.lru_cache(maxsize=8)
def read_reading(place: ReadingPlace) -> Reading:
    """Return a reading from its file; the latest eight are kept.

    Raises:
        EpisodeError: the file cannot be read, has changed, or its messages are damaged.
    """
    try:
        found = {
            suffix: Messages().decode_message(read_message(place.path, at), kind) for suffix, kind, at in place.parts
        }
        return decode_reading(found.pop(REST), found)
    except OSError as error:
        raise EpisodeError(f"cannot read {place.path}: {error.strerror}") from None
    except Exception as error:  # damaged files cause many kinds of exceptions
        raise EpisodeError(
            f"{place.path} is damaged: reading {place.name} at {place.time:g} s:"
            f" {type(error).__name__}: {str(error)[:80] or 'no details'}"
        ) from error


def read_scan(scan: ReadingPlace | ScanRow) -> ScanRow:
    """Return a scan from its file; scans of files without records of readings are known."""
    if isinstance(scan, ScanRow):
        return scan
    reading = read_reading(scan)
    if not isinstance(reading, Scan):
        raise EpisodeError(f"{scan.path} is damaged: reading {scan.name} at {scan.time:g} s: it is no scan")
    return scan_row(reading)


@dataclass(frozen=True, eq=False, repr=False)
class RecordedSequence(Sequence[T]):
    """Readings or scans of a sensor, each read from the file of the episode when it is asked for.

    Fields:
        places: where they are.
        read: reads one; it raises :class:`~crowdbot.core.EpisodeError` if the file is damaged or has changed.
    """

    places: Sequence[Any]
    read: Callable[[Any], T]

    @property
    def times(self) -> list[float]:
        """Times [s] at which the robot received them, without reading them."""
        return [float(place.time) for place in self.places]

    def __len__(self) -> int:
        return len(self.places)

    @overload
    def __getitem__(self, k: int) -> T: ...
    @overload
    def __getitem__(self, k: slice) -> RecordedSequence[T]: ...
    def __getitem__(self, k: int | slice) -> T | RecordedSequence[T]:
        if isinstance(k, slice):
            return RecordedSequence(self.places[k], self.read)
        return self.read(self.places[k])

    def __repr__(self) -> str:
        return f"<{len(self)} readings, read when they are asked for>"


class StepReadings(Mapping[str, T]):
    """Readings or scans of a step by ``robot/sensor``, each read from the file when it is asked for.

    Args:
        places: where they are.
        read: reads one, see :class:`RecordedSequence`.
    """

    def __init__(self, places: Mapping[str, Any], read: Callable[[Any], T]) -> None:
        self.places, self.read = places, read

    def __getitem__(self, name: str) -> T:
        return self.read(self.places[name])

    def __iter__(self) -> Iterator[str]:
        return iter(self.places)

    def __len__(self) -> int:
        return len(self.places)

    def of(self, kind: type[R]) -> Iterator[tuple[str, R]]:
        """Yield the readings of a class by name; those with messages of other types are not read."""
        types = [set(codec.types.values()) for cls, codec in CODECS.items() if issubclass(cls, kind)]
        for name, place in self.places.items():
            sent = {found for suffix, found, _ in place.parts if suffix != REST}
            if any(sent <= known for known in types) and isinstance(reading := self[name], kind):
                yield name, reading


class RecordedContact(NamedTuple):
    """A recorded contact: time [s], robot, other body (an id, a robot or ``wall``) and smallest clearance [m]."""

    time: float
    robot: str
    other: str
    clearance: float


class RobotState(NamedTuple):
    """State of a robot: position [m], heading [rad], velocity [m/s] in the world, and twist in its own frame."""

    x: float
    y: float
    heading: float
    vx: float
    vy: float
    twist: tuple[float, float, float]


@dataclass
class RecordedStep:
    """A recorded step.

    Fields:
        nanoseconds: simulated time.
        people: the people present, without robots; None if only readings or contacts were due.
        robots: robots by name.
        commands: commands by robot name: forward [m/s], turn [rad/s], left [m/s].
        readings: readings by ``robot/sensor``; each is read from the file when it is asked for.
        scans: scans of planar laser scanners, by ``robot/sensor``, likewise.
        joints: position [rad or m] and velocity of joints by robot and name.
        transforms: parent frame, child frame, position [m] and rotation w, x, y, z.
        forces, collisions, falls: contact forces of this step, and contact events and falls that ended, in the
            physics world.
        fall_poses: poses of people out of balance by id.
        contacts: contacts of this step.
        orders: orders from outside in this step, as JSON.
        reactions: ids of the people who react to robots, by kind of reaction; None if nobody can.
        gestures: ids of the people who make a gesture, by its name; None if nobody can.
        digest: digest of the episode as if it was interrupted here.
    """

    nanoseconds: int
    people: AgentStates | None = None
    robots: dict[str, RobotState] = field(default_factory=dict)
    commands: dict[str, tuple[float, float, float]] = field(default_factory=dict)
    readings: StepReadings[Reading] = field(default_factory=lambda: StepReadings({}, read_reading))
    scans: StepReadings[ScanRow] = field(default_factory=lambda: StepReadings({}, read_scan))
    joints: dict[str, dict[str, tuple[float, float]]] = field(default_factory=dict)
    transforms: list[tuple[str, str, tuple[float, ...]]] = field(default_factory=list)
    forces: list[ContactForceRecord] = field(default_factory=list)
    collisions: list[ContactEventRecord] = field(default_factory=list)
    falls: list[FallRecord] = field(default_factory=list)
    fall_poses: dict[int, FallPose] = field(default_factory=dict)
    contacts: list[RecordedContact] = field(default_factory=list)
    orders: list[str] = field(default_factory=list)
    reactions: dict[str, list[int]] | None = None
    gestures: dict[str, list[int]] | None = None
    digest: str = ""

    @property
    def time(self) -> float:
        """Simulated time [s]."""
        return self.nanoseconds / 1e9

    def largest_ids(self) -> set[int]:
        """Return the largest id of people in this step, if any; this reads all readings."""
        seen = [] if self.people is None else [int(self.people.ids.max(initial=-1))]
        hits = [getattr(reading, "hit", None) for reading in self.readings.values()]
        hits += [self.scans[name].hit for name in self.scans if name not in self.readings]
        return {*seen, *(int(hit.max(initial=-1)) for hit in hits if hit is not None)}

    def everyone(self, robots: Mapping[str, tuple[int, float]]) -> AgentStates:
        """Return people and robots together.

        Args:
            robots: id and radius [m] of robots by name.
        """
        people = self.people
        assert people is not None
        states = [(robots[name], state) for name, state in self.robots.items() if name in robots]
        rows = np.array([(s.x, s.y, s.vx, s.vy, s.heading, own[1]) for own, s in states]).reshape(-1, 6)
        ids = np.concatenate([people.ids, np.array([own[0] for own, _ in states], dtype=np.int64)])
        order = np.argsort(ids)
        return AgentStates(
            self.time,
            ids[order],
            np.concatenate([people.position, rows[:, 0:2]])[order],
            np.concatenate([people.velocity, rows[:, 2:4]])[order],
            np.concatenate([people.heading, rows[:, 4]])[order],
            np.concatenate([people.radius, rows[:, 5]])[order],
        )


def read_steps(tape: McapReader, path: Path) -> Iterator[RecordedStep]:
    """Yield the steps of a file, without their readings.

    Args:
        tape: reader of the file.
        path: the file, for the readings.

    Raises:
        McapError: the file is damaged; invalid content raises other errors.
    """
    messages, topics = Messages(), _ReadingTopics(tape)
    fixed: Poses = {}
    for stamp, group in _steps(tape, topics.is_read_later):
        sensors = {item.topic.topic.removesuffix(REST) for item in group if item.topic.kind == KIND}
        parts: dict[str, dict[str, tuple[str, McapPlace]]] = {topic: {} for topic in sorted(sensors)}
        decoded = []
        for item in group:
            name, kind = item.topic.topic, item.topic.kind
            sensor, suffix = topics.parts.get(name, ("", ""))
            if sensor in sensors:
                parts[sensor][suffix] = kind, item.place
            elif name not in UNUSED and kind in messages.store.types:
                decoded.append((name, messages.decode_message(item.data or read_message(path, item.place), kind)))
        readings = {}
        for topic, found in parts.items():
            name = topic.strip("/")
            readings[name] = ReadingPlace(path, name, tuple((suffix, *part) for suffix, part in found.items()))
        yield _moment(stamp, decoded, fixed, readings)


class _ReadingTopics:
    """Topics of readings in a file: those of sensors that have a topic for the remaining fields."""

    def __init__(self, tape: McapReader) -> None:
        self._tape, self._known = tape, 0
        self._suffixes = {suffix for codec in CODECS.values() for suffix in codec.types} | {REST}
        self.parts: dict[str, tuple[str, str]] = {}

    def is_read_later(self, channel: McapChannel) -> bool:
        """Return whether the messages of a channel are parts of readings, or not used."""
        if len(self._tape.topics) != self._known:
            self._known = len(self._tape.topics)
            sensors = {topic.topic.removesuffix(REST) for topic in self._tape.topics.values() if topic.kind == KIND}
            self.parts = {name + suffix: (name, suffix) for name in sensors for suffix in self._suffixes}
        return channel.topic in self.parts or channel.topic in UNUSED


def _steps(tape: McapReader, later: Callable[[McapChannel], bool]) -> Iterator[tuple[int, list[McapMessage]]]:
    """Yield the messages of each time [ns]; those of one time may be in several chunks."""
    waiting: dict[int, list[McapMessage]] = {}
    chunk = None
    for message in tape.messages(later):
        if message.place.record is not chunk:
            chunk = message.place.record
            for stamp in sorted(stamp for stamp in waiting if stamp < chunk.begin):
                yield stamp, waiting.pop(stamp)
        waiting.setdefault(message.stamp, []).append(message)
    for stamp in sorted(waiting):
        yield stamp, waiting.pop(stamp)


Poses = dict[str, tuple[str, float, float, float]]
"""Parent frame, x, y [m] and heading [rad] by frame."""


def _moment(
    stamp: int,
    messages: list[tuple[str, Any]],
    fixed: Poses | None = None,
    readings: Mapping[str, ReadingPlace] | None = None,
) -> RecordedStep:
    readings = readings or {}
    scans: dict[str, ReadingPlace | ScanRow] = {
        name: place for name, place in readings.items() if any(kind == SCAN for _, kind, _ in place.parts)
    }
    moment = RecordedStep(stamp, readings=StepReadings(readings, read_reading), scans=StepReadings(scans, read_scan))
    fixed = {} if fixed is None else fixed
    poses: Poses = {}
    for topic, message in messages:
        if topic == "/tf_static":
            _take(moment, fixed, topic, message)
            continue
        _take(moment, poses, topic, message)
    for topic, message in messages:
        if message.__msgtype__ == SCAN:
            name = topic.strip("/")
            scans[name] = _scan({**fixed, **poses}, name, moment.time, message)
    return moment


def _take(moment: RecordedStep, poses: Poses, topic: str, message: Any) -> None:
    """Process a message that is not a reading."""
    robot = topic.strip("/").rpartition("/")[0]
    kind = message.__msgtype__
    if topic == "/people":
        moment.people = _people(moment.time, message.people)
    elif topic == DIGEST:
        moment.digest = str(message.data)
    elif topic == ORDERS:
        moment.orders.append(str(message.data))
    elif topic == REACTION_TOPIC:
        moment.reactions = json.loads(message.data)
    elif topic == GESTURE_TOPIC:
        moment.gestures = json.loads(message.data)
    elif topic == CONTACTS:
        moment.contacts = [RecordedContact(moment.time, c.robot, c.other, c.clearance) for c in message.contacts]
    elif topic == FORCES:
        moment.forces = read_forces(moment.time, message)
    elif topic == COLLISIONS:
        moment.collisions = read_contact_events(message)
    elif topic == FALLS:
        moment.falls = read_falls(message)
    elif topic == FALL_POSES:
        moment.fall_poses = read_fall_poses(message)
    elif kind == "tf2_msgs/msg/TFMessage":
        for row in message.transforms:
            shift, turn = row.transform.translation, row.transform.rotation
            poses[row.child_frame_id] = row.header.frame_id, shift.x, shift.y, heading_of(turn)
            values = (shift.x, shift.y, shift.z, turn.w, turn.x, turn.y, turn.z)
            moment.transforms.append((row.header.frame_id, row.child_frame_id, values))
    elif kind == "nav_msgs/msg/Odometry" and topic.endswith(GROUND_TRUTH):
        moment.robots[topic.removesuffix(GROUND_TRUTH).strip("/")] = _robot(message)
    elif kind == "sensor_msgs/msg/JointState":
        moment.joints[robot] = dict(
            zip(message.name, zip(message.position.tolist(), message.velocity.tolist(), strict=True), strict=True)
        )
    elif kind == "geometry_msgs/msg/Twist":
        moment.commands[robot] = message.linear.x, message.angular.z, message.linear.y


def _people(time: float, people: Any) -> AgentStates:
    numbers = np.empty((len(people), 6))
    ids = np.empty(len(people), dtype=np.int64)
    for k, person in enumerate(people):
        tags = dict(zip(person.tagnames, person.tags, strict=True))
        place, moving = person.position, person.velocity
        ids[k] = int(person.name)
        numbers[k] = place.x, place.y, moving.x, moving.y, float(tags["heading"]), float(tags["radius"])
    return AgentStates(time, ids, numbers[:, 0:2], numbers[:, 2:4], numbers[:, 4], numbers[:, 5])


def _robot(message: Any) -> RobotState:
    pose, twist = message.pose.pose, message.twist.twist
    heading = heading_of(pose.orientation)
    cos, sin = math.cos(heading), math.sin(heading)
    forward, left = twist.linear.x, twist.linear.y
    return RobotState(
        pose.position.x,
        pose.position.y,
        heading,
        cos * forward - sin * left,
        sin * forward + cos * left,
        (forward, twist.angular.z, left),
    )


def _scan(poses: Poses, topic: str, time: float, message: Any) -> ScanRow:
    pose = _pose_in_map(poses, topic)
    return ScanRow(
        time,
        (float(pose.position[0, 0]), float(pose.position[0, 1]), float(pose.heading[0])),
        message.angle_min + message.angle_increment * np.arange(len(message.ranges)),
        message.ranges.astype(np.float64),
        message.intensities.astype(np.int64),
    )


def _pose_in_map(poses: Poses, frame: str) -> Pose:
    """Return the pose of a frame from the transforms of its parents.

    Raises:
        ValueError: the frame is not below the map.
    """
    chain: list[tuple[float, float, float]] = []
    name = frame
    while name != MAP:
        if name not in poses or len(chain) > len(poses):
            raise ValueError(f"frame {frame!r} is not in {MAP!r}")
        name, x, y, heading = poses[name]
        chain.append((x, y, heading))
    pose = Pose.of(chain[-1][:2], chain[-1][2])
    for place in reversed(chain[:-1]):
        pose = pose.offset(*place)
    return pose
