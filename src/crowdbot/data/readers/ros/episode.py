"""Bags and episodes: people and robots of ROS recordings become tracks.

The reader uses a topic of people (``/people`` or the one that the user names, see ``PEOPLE_TYPES``), and
``/<robot>/ground_truth/odom`` (nav_msgs/msg/Odometry of a robot, in the world frame; in files without it every
``.../odom``). People in a frame that moves, such as ``base_link``, are brought to a fixed frame by ``/tf``,
``/tf_static`` and odometry. Recorded trials have ``walls`` (JSON list of rings) and ``robots`` (ids) in the metadata
record ``crowdbot``; the file of a killed run is read up to its last complete record. Frames number the messages of
people.
"""

from __future__ import annotations

import json
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, TickSchedule, did_you_mean
from crowdbot.data.readers.assemble import assemble
from crowdbot.data.readers.reader import Reader, ReadOptions
from crowdbot.data.source import Source, parse_errors
from crowdbot.data.trajectories import Trajectories

from .bags import Bag, read_bag
from .detections import DETECTIONS, detected_people
from .frames import SECOND, Frames, frame_name, stamp_of

PEOPLE = "/people"
ODOMETRY_ENDING, ODOMETRY_TYPE = "/odom", "nav_msgs/msg/Odometry"
TRUTH_ENDING = "/ground_truth/odom"
TF_TYPES = ("tf2_msgs/msg/TFMessage", "tf/msg/tfMessage")
METADATA, ENDING = "crowdbot", "crowdbot.end"
SHORTEST_STEP = 0.25
"""Shortest time between two messages, in periods."""
HUNAV_ROBOT = 2
"""Type of an agent of HuNavSim that is a robot."""

_Person = tuple[str, Any]
PEOPLE_TYPES: Mapping[str, Callable[[Any], Iterator[_Person]]] = {
    "people_msgs/msg/People": lambda message: ((p.name, p.position) for p in message.people),
    "people_msgs/msg/PositionMeasurementArray": lambda message: ((p.object_id, p.pos) for p in message.people),
    "spencer_tracking_msgs/msg/TrackedPersons": lambda message: (
        (str(p.track_id), p.pose.pose.position) for p in message.tracks
    ),
    "pedsim_msgs/msg/TrackedPersons": lambda message: ((str(p.track_id), p.pose.pose.position) for p in message.tracks),
    "pedsim_msgs/msg/AgentStates": lambda message: (
        (str(p.id), p.pose.position if hasattr(p, "pose") else p.position) for p in message.agent_states
    ),
    "hunav_msgs/msg/Agents": lambda message: (
        (str(p.id), p.position.position) for p in message.agents if p.type != HUNAV_ROBOT
    ),
    DETECTIONS: lambda message: ((person.name, person.point) for person in detected_people(message)),
}
"""Message types of people; each gives names and positions. AgentState of pedsim once had a position, now a pose."""


@dataclass
class _People:
    """Messages of a topic: stamps [ns], frames, and persons as number of the message, name, x, y, z."""

    stamps: list[int] = field(default_factory=list)
    frames: list[str] = field(default_factory=list)
    persons: list[tuple[int, str, float, float, float]] = field(default_factory=list)


@dataclass
class _EpisodeData:
    """Content of a bag: its people, poses of robots by topic, with the frame of the topic, and what else is used."""

    topic: str
    people: _People
    poses: dict[str, list[tuple[int, float, float, float]]]
    pose_frames: dict[str, str]
    frames: Frames
    walls: str = "[]"
    robots: str = "[]"
    schedule: TickSchedule | None = None
    cut: bool = False


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read people and robots; robots without an id get ids above those of people, in channel order."""
    with parse_errors(source, "a bag" if source.kind != "mcap" else "MCAP"):
        messages = _read_messages(source, options)
    people = messages.people
    stamps = np.asarray(people.stamps, dtype=np.int64)
    period, frames, drift = _frames(source.name, messages.topic, stamps, messages.schedule)
    message = np.asarray([person[0] for person in people.persons], dtype=np.int64)
    place = np.asarray([person[2:] for person in people.persons], dtype=np.float64).reshape(-1, 3)
    target, moved, remarks = _to_fixed_frame(source, options, messages, stamps[message], place)
    known = ~np.isnan(moved[:, :2]).any(axis=1) | np.isnan(place[:, :2]).any(axis=1)
    columns: list[NDArray[Any]] = [
        _number_names([person[1] for person in people.persons])[known],
        frames[message][known],
    ]
    columns += [moved[known, axis] for axis in (0, 1)]
    robots, about_robots = _robots(messages, stamps, frames, columns[0], target)
    id, frame, x, y = (np.concatenate(parts) for parts in zip(columns, *robots, strict=True))
    cut = "the run was killed before its end" if messages.cut else ""
    return assemble(
        source,
        options,
        id=id,
        frame=frame,
        x=x,
        y=y,
        row_rate=SECOND / period,
        frame_step=1,
        note="; ".join(filter(None, (cut, drift, *remarks, *about_robots))),
        walls=_walls(source.name, messages.walls),
        robots=frozenset(int(robot[0][0]) for robot in robots),
    )


def _read_messages(source: Source, options: ReadOptions) -> _EpisodeData:
    people: dict[str, _People] = {}
    poses: dict[str, list[tuple[int, float, float, float]]] = {}
    pose_frames: dict[str, str] = {}
    frames, transforms = Frames(), list[tuple[str, Callable[[], Any]]]()

    def receive(topic: str, kind: str, decode: Callable[[], Any]) -> None:
        if kind in PEOPLE_TYPES:
            _add_people(people.setdefault(topic, _People()), kind, decode())
        elif kind == ODOMETRY_TYPE:
            message = decode()
            frames.add_odometry(topic, message)
            if topic.endswith(ODOMETRY_ENDING):
                place = message.pose.pose.position
                pose_frames.setdefault(topic, frame_name(message.header.frame_id))
                poses.setdefault(topic, []).append((stamp_of(message.header), place.x, place.y, place.z))
        else:
            transforms.append((topic, decode))

    bag = read_bag(source, lambda topic, kind: _is_wanted(topic, kind, options), receive)
    topic = _people_topic(source.name, bag, people, options.topic)
    own = bag.metadata.get(METADATA, {})
    if "format" not in own:  # recorded trials have everything in the world frame
        for name, decode in transforms:
            frames.add_transforms(name, decode())
    return _EpisodeData(
        topic,
        people[topic],
        poses,
        pose_frames,
        frames,
        own.get("walls", "[]"),
        own.get("robots", "[]"),
        _schedule(own),
        "format" in own and ENDING not in bag.metadata and "digest" not in own,
    )


def _is_wanted(topic: str, kind: str, options: ReadOptions) -> bool:
    if kind in PEOPLE_TYPES:
        return options.topic in (None, topic)
    return kind == ODOMETRY_TYPE or (kind in TF_TYPES and topic.endswith(("/tf", "/tf_static")))


def _people_topic(name: str, bag: Bag, people: Mapping[str, _People], chosen: str | None) -> str:
    """Return the topic that is read: the one of the user, else /people, else the only one.

    Raises:
        DataError: there is none, or there are several.
    """
    if chosen is not None:
        if chosen in people:
            return chosen
        held = bag.topics.get(chosen)
        if held in PEOPLE_TYPES:
            raise DataError(f"{name}: there are no messages on the topic {chosen}")
        wrong = (
            f"its topic {chosen} is {held}" if held else f"it has no topic {chosen}{did_you_mean(chosen, bag.topics)}"
        )
        raise DataError(f"{name}: {wrong}; types of people are {', '.join(PEOPLE_TYPES)}")
    if PEOPLE in people or len(people) == 1:
        return PEOPLE if PEOPLE in people else next(iter(people))
    if people:
        raise DataError(f"{name} has several topics of people, {', '.join(sorted(people))}; choose one with --topic")
    held = ", ".join(sorted(bag.topics)) or "no topics"
    raise DataError(
        f"{name} has no topic {PEOPLE} of people_msgs/msg/People, nor another type of people; it has {held}"
    )


def _add_people(people: _People, kind: str, message: Any) -> None:
    number = len(people.stamps)
    people.stamps.append(stamp_of(message.header))
    people.frames.append(frame_name(message.header.frame_id))
    people.persons += [(number, str(name), p.x, p.y, p.z) for name, p in PEOPLE_TYPES[kind](message)]


def _to_fixed_frame(
    source: Source, options: ReadOptions, messages: _EpisodeData, stamps: NDArray[np.int64], place: NDArray[np.float64]
) -> tuple[str | None, NDArray[np.float64], list[str]]:
    """Return the frame of the tracks, positions ``[N, 3]`` of people there, NaN where unknown, and remarks.

    Args:
        source, options, messages: the bag.
        stamps, place: stamps ``[N]`` [ns] and positions ``[N, 3]`` of people, in the frames of their messages.

    Raises:
        DataError: people are in a frame that no transforms join with a fixed one.
    """
    people, frames = messages.people, messages.frames
    names = sorted(set(people.frames))
    target = _target(source.name, messages, names, options.frame)
    if names == [target]:
        if not target:
            return None, place, ["the messages name no frame: positions are taken as those of a fixed frame"]
        if options.frame is not None and not frames.is_fixed(target):
            return None, place, [f"positions are relative to {target}, which perhaps moves"]
        return target if options.frame is not None or frames.is_fixed(target) else None, place, []
    numbers = np.asarray([person[0] for person in people.persons], dtype=np.int64)
    own = np.asarray(people.frames)[numbers]
    moved, remarks = place.copy(), []
    for name in names:
        if name == target:
            continue
        rows = own == name
        with np.errstate(invalid="ignore"):
            moved[rows] = frames.placement(name, target, stamps[rows]).apply(place[rows])
        topics = " and ".join(frames.topics(name, target))
        remarks.append(f"people are in the frame {name}, moved to {target} by {topics}")
    lost = np.asarray(np.isnan(moved[:, :2]).any(axis=1) & ~np.isnan(place[:, :2]).any(axis=1))
    if len(lost) and np.all(lost):
        raise DataError(
            f"{source.name}: the positions on {messages.topic} are in the frame {names[-1]}, and the transforms to"
            f" {target} are of other times; record {' and '.join(frames.topics(names[-1], target))} at the same time"
        )
    if np.any(lost):
        remarks.append(f"{int(lost.sum())} of {len(lost)} positions are left out, at times without a transform")
    return target, moved, remarks


def _target(name: str, messages: _EpisodeData, names: list[str], chosen: str | None) -> str:
    """Return the frame of the tracks: the one of the user, that of the people if it is fixed, or the root above it.

    Raises:
        DataError: people are in a frame that no transforms join with a fixed one.
    """
    frames = messages.frames
    if chosen is not None:
        target = frame_name(chosen)
        apart = next((frame for frame in names if not frames.connects(frame, target)), None)
        if apart is not None:
            raise DataError(
                f"{name}: the positions on {messages.topic} are in the frame {apart!r}, and no transform joins it with"
                f" {target!r}{did_you_mean(target, [*frames.edges, *frames.odometry, apart])}; transforms are"
                f" {frames.describe()}"
            )
        return target
    if len(names) == 1 and (not names[0] or frames.is_fixed(names[0])):
        return names[0]
    roots = {frames.above(frame)[-1] for frame in names}
    if len(roots) == 1 and frames.is_fixed(root := roots.pop()):
        return root
    moving = next((frame for frame in names if not frames.is_fixed(frames.above(frame)[-1])), names[0])
    raise DataError(
        f"{name}: the positions on {messages.topic} are in the frame {moving!r}, and no transform joins it with a fixed"
        f" frame (transforms: {frames.describe()}). Record /tf and /tf_static, or odometry whose child_frame_id is"
        f" {frames.above(moving)[-1]!r}; if the frame does not move, give --frame {moving or 'NAME'}"
    )


def _schedule(known: Mapping[str, str]) -> TickSchedule | None:
    """Return the recorded ticks of a trial whose recording period is not a whole number of time steps."""
    try:
        return TickSchedule(int(known["step_ns"]), int(known["period_ns"]))
    except (KeyError, ValueError, InputError):
        return None


def _frames(
    name: str, topic: str, stamps: NDArray[np.int64], schedule: TickSchedule | None
) -> tuple[float, NDArray[np.int64], str]:
    """Return the period of the topic of people [ns], the frame of each message, and a remark on a clock that drifts.

    A frame is a multiple of the period. If the stamps drift away from these, each message is a whole number of frames
    after the one before, and the period is the mean.
    """
    if len(stamps) < 2:
        raise DataError(f"{name} has {len(stamps)} messages on {topic}, at least 2 are required")
    steps = np.diff(stamps)
    if np.any(steps <= 0):
        index = int(np.argmax(steps <= 0)) + 1
        raise DataError(f"{name}: the stamp of message {index + 1} on {topic} is not later than the previous one")
    if schedule is None:
        period = float(np.median(steps))
        frames = np.rint((stamps - stamps[0]) / period).astype(np.int64)
        follow = np.concatenate([[0], np.cumsum(np.maximum(1, np.rint(steps / period)))]).astype(np.int64)
        if np.all(steps >= SHORTEST_STEP * period) and np.any(np.diff(frames) != np.diff(follow)):
            period = float((stamps[-1] - stamps[0]) / follow[-1])
            off = float(np.max(np.abs(stamps - stamps[0] - follow * period))) / SECOND
            return period, follow, f"stamps are up to {off:.2g} s off a regular step of {period / SECOND:.4g} s"
    else:
        period = float(schedule.period_ns)
        frames = schedule.index(stamps // schedule.step_ns)
        frames -= frames[0]
    if np.any(np.diff(frames) == 0):
        raise DataError(
            f"{name}: the stamps on {topic} are not regular, some steps are far shorter than {period / 1e6:.3g} ms"
        )
    return period, frames, ""


def _number_names(names: list[str]) -> NDArray[np.int64]:
    """Return names as numbers; if one is a word, all are numbered from 1 in order of appearance."""
    if all(name.lstrip("-").isdecimal() and len(name) < 18 for name in names):
        return np.asarray([int(name) for name in names], dtype=np.int64)
    known = {name: number for number, name in enumerate(dict.fromkeys(names), 1)}
    return np.asarray([known[name] for name in names], dtype=np.int64)


def _is_truth(topic: str) -> bool:
    return topic.endswith(TRUTH_ENDING)


def _robots(
    messages: _EpisodeData,
    stamps: NDArray[np.int64],
    frames: NDArray[np.int64],
    people: NDArray[np.int64],
    target: str | None,
) -> tuple[list[list[NDArray[Any]]], list[str]]:
    """Return id, frame, x, y of every robot at the stamps of people, interpolated between its own, and remarks.

    The poses are brought to the frame ``target`` of the people, unless it is None or nothing joins the two.
    """
    found, remarks = [], list[str]()
    measured = {topic.removesuffix(TRUTH_ENDING) + ODOMETRY_ENDING for topic in messages.poses if _is_truth(topic)}
    tracks = {topic: sorted(poses) for topic, poses in messages.poses.items() if poses and topic not in measured}
    for (topic, poses), id in zip(tracks.items(), _robot_ids(messages, [*tracks], people), strict=True):
        times = np.asarray([pose[0] for pose in poses], dtype=np.int64)
        place = np.asarray([pose[1:] for pose in poses], dtype=np.float64)
        own = messages.pose_frames[topic]
        if target is not None and own != target:
            if messages.frames.connects(own, target):
                place = messages.frames.placement(own, target, times).apply(place)
            else:
                remarks.append(f"{topic} is in the frame {own}, people in {target}: both are taken as the same")
        known = ~np.isnan(place[:, :2]).any(axis=1)
        if not np.any(known):
            remarks.append(f"{topic} is left out, its frame {own} has no transform to {target} at its times")
            continue
        since, at = (times[known] - stamps[0]).astype(np.float64), (stamps - stamps[0]).astype(np.float64)
        inside = (at >= since[0]) & (at <= since[-1])
        rows = [np.interp(at[inside], since, place[known, axis]) for axis in (0, 1)]
        if np.any(inside):
            found.append([np.full(int(inside.sum()), id), frames[inside], *rows])
    return found, remarks


def _robot_ids(messages: _EpisodeData, topics: list[str], people: NDArray[np.int64]) -> list[int]:
    """Return the ids of robots in the metadata if all are valid, else new ids above those of people."""
    try:
        rows = json.loads(messages.robots)
        known = {f"/{robot['name']}{end}": robot["id"] for robot in rows for end in (ODOMETRY_ENDING, TRUTH_ENDING)}
    except (ValueError, TypeError, KeyError, RecursionError):
        known = {}
    ids = [known.get(topic) for topic in topics]
    if all(type(id) is int and id not in people for id in ids) and len(set(ids)) == len(ids):
        return [int(id) for id in ids if id is not None]
    return list(range(int(people.max(initial=0)) + 1, int(people.max(initial=0)) + 1 + len(topics)))


def _walls(name: str, text: str) -> tuple[NDArray[np.float64], ...]:
    try:
        rings = tuple(np.asarray(ring, dtype=np.float64) for ring in json.loads(text))
    except (ValueError, TypeError, RecursionError):
        raise DataError(f"{name}: the metadata 'walls' is not a JSON list of rings") from None
    wrong = next((k for k, r in enumerate(rings) if r.ndim != 2 or r.shape[1] != 2 or not np.all(np.isfinite(r))), None)
    if wrong is not None:
        raise DataError(f"{name}: ring {wrong} of the metadata 'walls' is not a list of finite points [N, 2]")
    return rings


def _is_bag(source: Source) -> bool:
    """Return whether an SQLite file has the tables of a ROS 2 bag; their definitions are in its first pages."""
    return source.kind == "sqlite" and b"CREATE TABLE topics" in source.head and b"serialization_format" in source.head


READER = Reader(
    "episode", "recorded trial or ROS 2 bag, MCAP with a topic of people", lambda source: source.kind == "mcap", read
)
SQLITE = Reader("rosbag2", "ROS 2 bag in SQLite (.db3) with a topic of people", _is_bag, read)
ROS1 = Reader("rosbag1", "ROS 1 bag (.bag) with a topic of people", lambda source: source.kind == "rosbag", read)
