"""Events and series of a recorded episode, for its scrubber and its plots."""

from __future__ import annotations

import math
from collections.abc import Iterator, Mapping
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core.outlines import outline_of
from crowdbot.metrics import outline_clearance
from crowdbot.recording import RecordedEpisode
from crowdbot.simulation import PushOrder
from crowdbot.typing import Floats, Ints

NEAR_MISS = 0.2
"""Clearance [m] below which passing is a near miss; CrowdNav calls it discomfort."""
STALL_SPEED, STALL = 0.05, 1.0
"""Speed [m/s] below which a robot stands, and time [s] after which this is a stall."""
APART = 1.0
"""Time [s] within which contacts with the same body are one event."""
PART = 500
"""Number of times whose clearances are computed at once."""
MOST_POINTS = 2000
"""Largest number of points of a plot."""


class EpisodeEvent(NamedTuple):
    """Something to look at: time [s], kind and a description.

    Kinds are ``contact``, ``fall``, ``push``, ``near miss`` and ``stall``.
    """

    time: float
    kind: str
    about: str


def episode_events(episode: RecordedEpisode) -> list[EpisodeEvent]:
    """Return contacts, near misses and stalls of the robots of an episode, falls of people and pushes, by time."""
    found = _contacts(episode) + _falls(episode)
    names = {
        robot: f"robot {number + 1}" if len(episode.robots) > 1 else "the robot"
        for number, robot in enumerate(episode.robots)
    }
    for robot, name in names.items():
        found += _near_misses(episode, robot, names) + _stalls(episode, robot, name)
    return sorted(found)


def episode_series(episode: RecordedEpisode) -> dict[str, list[float | None]]:
    """Return time [s], clearance [m] and speed [m/s] of the first robot, and the number of people.

    Long episodes are thinned; the smallest clearance of each interval is kept.
    """
    times, rows = episode.times, episode.rows
    robots = np.isin(rows.ids, episode.robots)
    people = np.diff(np.concatenate([[0], np.cumsum(~robots)])[rows.starts])
    stride = max(1, math.ceil(len(times) / MOST_POINTS))
    result = {"time": _plain(times[::stride]), "people": _plain(people[::stride].astype(np.float64))}
    if episode.robots:
        robot = episode.robots[0]
        nearest = np.concatenate([gaps.min(axis=1) for _, _, gaps in _clearances(episode, robot)])
        starts = np.arange(0, len(times), stride)
        result["clearance"] = _plain(np.minimum.reduceat(nearest, starts))
        result["speed"] = _plain(_speeds(episode, robot)[::stride])
    return result


def _speeds(episode: RecordedEpisode, robot: int) -> Floats:
    """Return the speed ``[T]`` [m/s] of a robot."""
    return np.asarray(np.hypot(*episode.rows.log([robot]).velocity[:, 0].T))


def _clearances(episode: RecordedEpisode, robot: int) -> Iterator[tuple[int, Ints, Floats]]:
    """Yield the smallest clearance ``[P, N]`` [m] of agents to the outline of a robot since the last record.

    The episode comes in parts of P times, each with the number of its first time and the ids ``[N]`` of those who are
    present in it, so that arrays stay small where each arrival has a new id.
    """
    footprint, rows = episode.footprints[episode.robots.index(robot)], episode.rows
    for first in range(0, len(rows.times), PART):
        before, last = max(0, first - 1), min(first + PART, len(rows.times))
        ids = np.union1d(rows.present(before, last), robot)
        log = rows.log(ids, before, last)
        own = int(np.searchsorted(ids, robot))
        swept = outline_clearance(
            log.times,
            log.position,
            log.velocity,
            log.heading[:, own],
            log.radius[0],
            log.active,
            own,
            None if footprint is None else outline_of(footprint),
        ).swept
        yield first, ids, swept[first - before :]


def _contacts(episode: RecordedEpisode) -> list[EpisodeEvent]:
    found, latest = list[EpisodeEvent](), dict[tuple[str, str], float]()
    for contact in episode.contacts:
        pair = str(contact.robot), str(contact.other)
        time = float(contact.time)
        if time - latest.get(pair, -math.inf) > APART:
            found.append(EpisodeEvent(round(time, 3), "contact", f"{pair[0]} touches {_body(pair[1])}"))
        latest[pair] = time
    return found


def _falls(episode: RecordedEpisode) -> list[EpisodeEvent]:
    """Return falls, and forces on people by orders."""
    events = []
    for fall in episode.falls:
        cause = f", pushed by {_body(fall.cause)}" if fall.cause else ""
        events.append(EpisodeEvent(round(fall.begin, 3), "fall", f"person {fall.person} falls {fall.direction}{cause}"))
    for time, order in episode.orders:
        if isinstance(order, PushOrder):
            text = f"person {order.person} is pushed with {order.force:g} N for {order.duration:g} s"
            events.append(EpisodeEvent(round(time, 3), "push", text))
    return events


def _body(name: str) -> str:
    return f"person {name}" if name.isdecimal() else name


def _near_misses(episode: RecordedEpisode, robot: int, names: Mapping[int, str]) -> list[EpisodeEvent]:
    found: dict[int, list[tuple[int, float]]] = {}  # times and clearances by person
    for first, ids, gaps in _clearances(episode, robot):
        for k, column in np.argwhere(gaps < NEAR_MISS).tolist():
            found.setdefault(int(ids[column]), []).append((first + k, float(gaps[k, column])))
    events = []
    for person, passes in found.items():
        steps = np.array([k for k, _ in passes])
        for stretch in np.split(np.arange(len(steps)), np.flatnonzero(np.diff(steps) > 1) + 1):
            k, gap = min((passes[n] for n in stretch.tolist()), key=lambda item: item[1])
            if gap > 0.0:
                other = names.get(person) or f"person {person}"
                about = f"{names[robot]} passes {other} at {gap:.2f} m"
                events.append(EpisodeEvent(round(float(episode.times[k]), 3), "near miss", about))
    return events


def _stalls(episode: RecordedEpisode, robot: int, name: str) -> list[EpisodeEvent]:
    stands = _speeds(episode, robot) < STALL_SPEED
    events = []
    for first, last in _stretches(stands):
        time = float(episode.times[last - 1] - episode.times[first])
        if time >= STALL:
            events.append(
                EpisodeEvent(round(float(episode.times[first]), 3), "stall", f"{name} stands for {time:.1f} s")
            )
    return events


def _stretches(flags: NDArray[np.bool_]) -> list[tuple[int, int]]:
    edges = np.flatnonzero(np.diff(np.concatenate([[False], flags, [False]]).astype(np.int8)))
    return [(int(first), int(last)) for first, last in edges.reshape(-1, 2)]


def _plain(values: Any) -> list[float | None]:
    return [round(item, 4) if math.isfinite(item) else None for item in np.asarray(values, dtype=np.float64).tolist()]
