"""Episodes, the recordings of trials: MCAP with ROS 2 messages; people and robots become tracks.

The reader uses ``/people`` (people_msgs/msg/People, the name is the id), ``/<robot>/ground_truth/odom``
(nav_msgs/msg/Odometry of a robot, in the world frame; in files without it every ``.../odom``), and ``walls`` (JSON list
of rings) and ``robots`` (ids) of the metadata record ``crowdbot``. The file of a killed run is read up to its last
complete record. Frames number the messages on /people.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, TickSchedule
from crowdbot.data.mcap_reader import McapChannel, McapError, McapReader, has_summary
from crowdbot.data.source import Source, parse_errors
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

__all__ = ["READER"]

PEOPLE, PEOPLE_TYPE = "/people", "people_msgs/msg/People"
ODOMETRY_ENDING, ODOMETRY_TYPE = "/odom", "nav_msgs/msg/Odometry"
TRUTH_ENDING = "/ground_truth/odom"
METADATA, ENDING = "crowdbot", "crowdbot.end"
SECOND = 1_000_000_000


@dataclass
class _EpisodeData:
    """Content of the messages: stamps [ns] of /people, persons with the number of their message, poses by topic."""

    stamps: list[int] = field(default_factory=list)
    persons: list[tuple[int, str, float, float]] = field(default_factory=list)
    poses: dict[str, list[tuple[int, float, float]]] = field(default_factory=dict)
    walls: str = "[]"
    robots: str = "[]"
    schedule: TickSchedule | None = None
    cut: bool = False


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read people and robots; robots without an id get ids above those of people, in channel order."""
    with parse_errors(source, "MCAP"):
        messages = _read_messages(source)
    stamps = np.asarray(messages.stamps, dtype=np.int64)
    period, frames = _frames(source.name, stamps, messages.schedule)
    message = np.asarray([person[0] for person in messages.persons], dtype=np.int64)
    columns = [_number_names([person[1] for person in messages.persons]), frames[message]]
    columns += [np.asarray([person[axis] for person in messages.persons]) for axis in (2, 3)]
    robots = _robots(messages, stamps, frames, columns[0])
    id, frame, x, y = (np.concatenate(parts) for parts in zip(columns, *robots, strict=True))
    return assemble(
        source,
        options,
        id=id,
        frame=frame,
        x=x,
        y=y,
        row_rate=SECOND / period,
        frame_step=1,
        note="the run was killed before its end" if messages.cut else "",
        walls=_walls(source.name, messages.walls),
        robots=frozenset(int(robot[0][0]) for robot in robots),
    )


def _read_messages(source: Source) -> _EpisodeData:
    from rosbags.typesys import Stores, get_types_from_msg, get_typestore

    store = get_typestore(Stores.ROS2_HUMBLE)
    messages, wanted = _EpisodeData(), dict[McapChannel, bool]()
    with source.path.open("rb") as file:
        tape = McapReader(file)
        for topic, _, data in tape.messages():
            if topic not in wanted:
                wanted[topic] = _is_wanted(topic.topic, topic.kind)
                if wanted[topic]:
                    types = get_types_from_msg(topic.text, topic.kind)
                    store.register({name: definition for name, definition in types.items() if name not in store.types})
            if wanted[topic]:
                _add_message(messages, topic.topic, store.deserialize_cdr(data, topic.kind))
        known = tape.metadata.get(METADATA, {})
        if "format" not in known and not has_summary(file):
            raise McapError("it has no summary section")
    if not any(topic.topic == PEOPLE for topic, chosen in wanted.items() if chosen):
        held = ", ".join(sorted(topic.topic for topic in tape.topics.values())) or "no topics"
        raise DataError(f"{source.name} has no topic {PEOPLE} of {PEOPLE_TYPE}; it has {held}")
    messages.cut = "format" in known and ENDING not in tape.metadata and "digest" not in known
    messages.schedule = _schedule(known)
    messages.walls, messages.robots = known.get("walls", "[]"), known.get("robots", "[]")
    return messages


def _is_wanted(topic: str, kind: str) -> bool:
    return (topic == PEOPLE and kind == PEOPLE_TYPE) or (topic.endswith(ODOMETRY_ENDING) and kind == ODOMETRY_TYPE)


def _is_truth(topic: str) -> bool:
    return topic.endswith(TRUTH_ENDING)


def _add_message(messages: _EpisodeData, topic: str, message: Any) -> None:
    stamp = message.header.stamp.sec * SECOND + message.header.stamp.nanosec
    if topic == PEOPLE:
        number = len(messages.stamps)
        messages.stamps.append(stamp)
        messages.persons += [(number, p.name, p.position.x, p.position.y) for p in message.people]
    else:
        place = message.pose.pose.position
        messages.poses.setdefault(topic, []).append((stamp, place.x, place.y))


def _schedule(known: Mapping[str, str]) -> TickSchedule | None:
    """Return the recorded ticks of a trial whose recording period is not a whole number of time steps."""
    try:
        return TickSchedule(int(known["step_ns"]), int(known["period_ns"]))
    except (KeyError, ValueError, InputError):
        return None


def _frames(name: str, stamps: NDArray[np.int64], schedule: TickSchedule | None) -> tuple[float, NDArray[np.int64]]:
    """Return the period of /people [ns] and the frame of each message, from its stamp."""
    if len(stamps) < 2:
        raise DataError(f"{name} has {len(stamps)} messages on {PEOPLE}, at least 2 are required")
    steps = np.diff(stamps)
    if np.any(steps <= 0):
        index = int(np.argmax(steps <= 0)) + 1
        raise DataError(f"{name}: the stamp of message {index + 1} on {PEOPLE} is not later than the previous one")
    if schedule is None:
        period = float(np.median(steps))
        frames = np.rint((stamps - stamps[0]) / period).astype(np.int64)
    else:
        period = float(schedule.period_ns)
        frames = schedule.index(stamps // schedule.step_ns)
        frames -= frames[0]
    if np.any(np.diff(frames) == 0):
        raise DataError(
            f"{name}: the stamps on {PEOPLE} are not regular, some steps are far shorter than {period / 1e6:.3g} ms"
        )
    return period, frames


def _number_names(names: list[str]) -> NDArray[np.int64]:
    """Return names as numbers; if one is a word, all are numbered from 1 in order of appearance."""
    if all(name.lstrip("-").isdecimal() and len(name) < 18 for name in names):
        return np.asarray([int(name) for name in names], dtype=np.int64)
    known = {name: number for number, name in enumerate(dict.fromkeys(names), 1)}
    return np.asarray([known[name] for name in names], dtype=np.int64)


def _robots(
    messages: _EpisodeData, stamps: NDArray[np.int64], frames: NDArray[np.int64], people: NDArray[np.int64]
) -> list[list[NDArray[Any]]]:
    """Return id, frame, x, y of every robot at the stamps of /people, interpolated between its own."""
    found = []
    measured = {topic.removesuffix(TRUTH_ENDING) + ODOMETRY_ENDING for topic in messages.poses if _is_truth(topic)}
    tracks = {topic: sorted(poses) for topic, poses in messages.poses.items() if poses and topic not in measured}
    for id, poses in zip(_robot_ids(messages, [*tracks], people), tracks.values(), strict=True):
        own = np.asarray([pose[0] - int(stamps[0]) for pose in poses], dtype=np.float64)
        at = (stamps - stamps[0]).astype(np.float64)
        inside = (at >= own[0]) & (at <= own[-1])
        place = [np.interp(at[inside], own, [pose[axis] for pose in poses]) for axis in (1, 2)]
        if np.any(inside):
            found.append([np.full(int(inside.sum()), id), frames[inside], *place])
    return found


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


READER = Reader(
    "episode", "recorded trial, MCAP with /people and /robot/odom", lambda source: source.kind == "mcap", read
)
