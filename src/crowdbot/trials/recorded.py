"""Recorded: an episode as it is read from its file, without running anything."""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import EpisodeError, Pose
from crowdbot.data import Trajectories

from .episode import ScanRow, tracks_of
from .episode_file import KEYS, MAP, METADATA, from_json, heading_of

__all__ = ["Recorded", "read_episode"]

Floats = NDArray[np.float64]

MAGIC = b"\x89MCAP0\r\n"


@dataclass(frozen=True, eq=False)
class Recorded:
    """What an episode file holds; the fields of :class:`Episode` that a file keeps, under the same names.

    Fields:
        path: the file.
        metadata: the record ``crowdbot`` as text: trial (XML), seed, versions, digest, outcome, ...
        times: ``[T]`` [s].
        position, velocity: ``[T, A, 2]`` [m], [m/s]; 0 for who is not there.
        heading: ``[T, A]`` [rad].
        radius: ``[A]`` [m].
        active: ``[T, A]``.
        ids: ``[A]``.
        robots: indices of the robots.
        commands: ``[T, R, 3]`` forward [m/s], turn [rad/s], left [m/s].
        scans_by_topic: by ``robot/sensor``; ranges have the 32 bits of the message.
        walls: rings ``[N, 2]`` [m].
        metrics: by name.
    """

    path: Path
    metadata: Mapping[str, str]
    times: Floats
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats
    active: NDArray[np.bool_]
    ids: NDArray[np.int64]
    robots: tuple[int, ...]
    commands: Floats
    scans_by_topic: Mapping[str, tuple[ScanRow, ...]]
    walls: tuple[Floats, ...]
    metrics: Mapping[str, float]

    @property
    def xml(self) -> str:
        """The trial as XML."""
        return self.metadata["trial"]

    @property
    def name(self) -> str:
        """Name of the trial."""
        return self.metadata["trial_name"]

    @property
    def seed(self) -> int:
        """Seed of the run."""
        return int(self.metadata["seed"])

    @property
    def steps(self) -> int:
        """Number of time steps done."""
        return int(self.metadata["steps"])

    @property
    def outcome(self) -> str:
        """How the run ended."""
        return self.metadata["outcome"]

    @property
    def digest(self) -> str:
        """Hash of the episode as it was run."""
        return self.metadata["digest"]

    @property
    def version(self) -> str:
        """Version of crowdbot that ran it."""
        return self.metadata["version"]

    @property
    def scans(self) -> tuple[ScanRow, ...]:
        """What the first laser scanner of the first robot measured."""
        return next(iter(self.scans_by_topic.values()), ())

    def tracks(self, dt: float = 0.4) -> Trajectories:
        """Return people and robots every ``dt`` [s] as trajectories, as :meth:`Episode.tracks` does."""
        return tracks_of(self, self.name, dt)


def read_episode(path: Path | str) -> Recorded:
    """Read an episode file.

    Raises:
        EpisodeError: the file is missing, cut off, damaged, or no episode of crowdbot.
    """
    path = Path(path)
    _check_file(path)
    try:
        metadata, messages = _contents(path)
    except Exception as error:  # a damaged file makes its readers fail in many ways; all mean the same to the user
        raise EpisodeError(f"{path} is damaged: {type(error).__name__}: {str(error)[:80] or 'no details'}") from error
    if metadata is None or any(key not in metadata for key in KEYS):
        raise EpisodeError(f"{path} is an MCAP file but not an episode of crowdbot: it has no record {METADATA!r}")
    try:
        return _assembled(path, metadata, messages)
    except (KeyError, ValueError, IndexError, TypeError, AttributeError) as error:
        raise EpisodeError(f"{path} does not hold what its record {METADATA!r} says: {str(error)[:80]}") from error


def _check_file(path: Path) -> None:
    if not path.exists():
        raise EpisodeError(f"there is no episode file {path}")
    if not path.is_file():
        raise EpisodeError(f"{path} is not a file; give the episode.mcap itself")
    try:
        with path.open("rb") as stream:
            head = stream.read(len(MAGIC))
            size = stream.seek(0, 2)
            stream.seek(max(0, size - len(MAGIC)))
            tail = stream.read()
    except OSError as error:
        raise EpisodeError(f"{path} cannot be read: {error.strerror}") from None
    if not size:
        raise EpisodeError(f"{path} is empty")
    if head != MAGIC:
        raise EpisodeError(f"{path} is not an MCAP file: it begins with {head!r}")
    if tail != MAGIC or size < 2 * len(MAGIC):
        raise EpisodeError(f"{path} is cut off: its end is missing; record or copy it again")


@dataclass
class _Contents:
    """The messages of a file, by what they are about."""

    people: list[tuple[int, Any]] = field(default_factory=list)
    poses: dict[tuple[int, str], tuple[str, float, float, float]] = field(default_factory=dict)
    odometry: dict[tuple[str, int], Any] = field(default_factory=dict)
    commands: dict[tuple[str, int], Any] = field(default_factory=dict)
    scans: dict[str, list[tuple[int, Any]]] = field(default_factory=dict)


def _contents(path: Path) -> tuple[Mapping[str, str] | None, _Contents]:
    from mcap.reader import make_reader

    found = _Contents()
    with path.open("rb") as stream:
        reader = make_reader(stream, validate_crcs=True)
        records = [record.metadata for record in reader.iter_metadata() if record.name == METADATA]
        if not records:
            return None, found
        for topic, now, message in _decoded(reader):
            _sort_in(found, topic, now, message)
    return records[-1], found


def _decoded(reader: Any) -> Iterator[tuple[str, int, Any]]:
    from .messages import Messages

    messages = Messages()
    for schema, channel, message in reader.iter_messages(log_time_order=False):
        kind = getattr(schema, "name", "")
        if channel.topic != "/crowd/markers" and kind in messages.store.types:
            yield channel.topic, message.log_time, messages.decoded(message.data, kind)


def _sort_in(found: _Contents, topic: str, now: int, message: Any) -> None:
    kind = message.__msgtype__
    robot = topic.strip("/").rpartition("/")[0]
    if topic == "/people":
        found.people.append((now, message))
    elif kind == "tf2_msgs/msg/TFMessage":
        for row in message.transforms:
            shift = row.transform.translation
            place = (row.header.frame_id, shift.x, shift.y, heading_of(row.transform.rotation))
            found.poses[now, row.child_frame_id] = place
    elif kind == "nav_msgs/msg/Odometry":
        found.odometry[robot, now] = message
    elif kind == "geometry_msgs/msg/Twist":
        found.commands[robot, now] = message
    elif kind == "sensor_msgs/msg/LaserScan":
        found.scans.setdefault(topic.strip("/"), []).append((now, message))


def _assembled(path: Path, metadata: Mapping[str, str], found: _Contents) -> Recorded:
    robots = json.loads(metadata["robots"])
    places = [int(robot["id"]) for robot in robots]
    stamps = [now for now, _ in found.people]
    shape = (len(stamps), int(metadata["people"]) + len(robots))
    arrays = _Arrays(
        np.zeros((*shape, 2)), np.zeros((*shape, 2)), np.zeros(shape), np.zeros(shape[1]), np.zeros(shape, dtype=bool)
    )
    for k, (_, message) in enumerate(found.people):
        for person in message.people:
            arrays.person(k, person)
    commands = np.zeros((len(stamps), len(robots), 3))
    for r, robot in enumerate(robots):
        arrays.radius[places[r]] = float(robot["radius"])
        for k, now in enumerate(stamps):
            arrays.robot(k, places[r], found.odometry[robot["name"], now])
            asked = found.commands[robot["name"], now]
            commands[k, r] = asked.linear.x, asked.angular.z, asked.linear.y
    return Recorded(
        path,
        dict(metadata),
        np.array(stamps) / 1e9,
        arrays.position,
        arrays.velocity,
        arrays.heading,
        arrays.radius,
        arrays.active,
        np.arange(shape[1], dtype=np.int64),
        tuple(places),
        commands,
        {topic: tuple(_scan(found, topic, *row) for row in rows) for topic, rows in found.scans.items()},
        tuple(np.array(ring, dtype=np.float64) for ring in json.loads(metadata["walls"])),
        from_json(metadata["metrics"]),
    )


@dataclass
class _Arrays:
    position: Floats
    velocity: Floats
    heading: Floats
    radius: Floats
    active: NDArray[np.bool_]

    def person(self, k: int, person: Any) -> None:
        agent = int(person.name)
        tags = dict(zip(person.tagnames, person.tags, strict=True))
        self.position[k, agent] = person.position.x, person.position.y
        self.velocity[k, agent] = person.velocity.x, person.velocity.y
        self.heading[k, agent] = float(tags["heading"])
        self.radius[agent] = float(tags["radius"])
        self.active[k, agent] = True

    def robot(self, k: int, agent: int, message: Any) -> None:
        pose, twist = message.pose.pose, message.twist.twist
        heading = heading_of(pose.orientation)
        cos, sin = math.cos(heading), math.sin(heading)
        forward, left = twist.linear.x, twist.linear.y
        self.position[k, agent] = pose.position.x, pose.position.y
        self.velocity[k, agent] = cos * forward - sin * left, sin * forward + cos * left
        self.heading[k, agent] = heading
        self.active[k, agent] = True


def _scan(found: _Contents, topic: str, now: int, message: Any) -> ScanRow:
    carrier, *mount = found.poses[now, topic]
    parent, *place = found.poses[now, carrier]
    if parent != MAP:
        raise ValueError(f"frame {carrier!r} is not in {MAP!r}")
    pose = Pose.of(place[:2], place[2]).mounted(*mount)
    return ScanRow(
        now / 1e9,
        (float(pose.position[0, 0]), float(pose.position[0, 1]), float(pose.heading[0])),
        message.angle_min + message.angle_increment * np.arange(len(message.ranges)),
        message.ranges.astype(np.float64),
        message.intensities.astype(np.int64),
    )
