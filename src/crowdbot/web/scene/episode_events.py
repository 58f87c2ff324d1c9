"""Events and series of a recorded episode, for its scrubber and its plots."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core.outlines import outline_of
from crowdbot.metrics import outline_clearance
from crowdbot.recording import RecordedEpisode
from crowdbot.simulation import PushOrder
from crowdbot.typing import Floats

NEAR_MISS = 0.2
"""Clearance [m] below which passing is a near miss; CrowdNav calls it discomfort."""
STALL_SPEED, STALL = 0.05, 1.0
"""Speed [m/s] below which a robot stands, and time [s] after which this is a stall."""
APART = 1.0
"""Time [s] within which contacts with the same body are one event."""
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
    for number, robot in enumerate(episode.robots):
        name = f"robot {number + 1}" if len(episode.robots) > 1 else "the robot"
        found += _near_misses(episode, robot, name) + _stalls(episode, robot, name)
    return sorted(found)


def episode_series(episode: RecordedEpisode) -> dict[str, list[float | None]]:
    """Return time [s], clearance [m] and speed [m/s] of the first robot, and the number of people.

    Long episodes are thinned; the smallest clearance of each interval is kept.
    """
    times = episode.times
    people = episode.active.copy()
    people[:, list(episode.robots)] = False
    stride = max(1, math.ceil(len(times) / MOST_POINTS))
    result = {"time": _plain(times[::stride]), "people": _plain(people.sum(axis=1)[::stride].astype(np.float64))}
    if episode.robots:
        robot = episode.robots[0]
        nearest = _clearance(episode, robot).min(axis=1)
        starts = np.arange(0, len(times), stride)
        result["clearance"] = _plain(np.minimum.reduceat(nearest, starts))
        result["speed"] = _plain(np.hypot(*episode.velocity[:, robot].T)[::stride])
    return result


def _clearance(episode: RecordedEpisode, robot: int) -> Floats:
    """Return the smallest clearance ``[T, A]`` [m] of each agent to the outline of a robot since the last record."""
    footprint = episode.footprints[episode.robots.index(robot)]
    return outline_clearance(
        episode.times,
        episode.position,
        episode.velocity,
        episode.heading[:, robot],
        episode.radius,
        episode.active,
        robot,
        None if footprint is None else outline_of(footprint),
    ).swept


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


def _near_misses(episode: RecordedEpisode, robot: int, name: str) -> list[EpisodeEvent]:
    gaps = _clearance(episode, robot)
    events = []
    for person in np.flatnonzero((gaps < NEAR_MISS).any(axis=0)).tolist():
        for first, last in _stretches(gaps[:, person] < NEAR_MISS):
            k = first + int(np.argmin(gaps[first:last, person]))
            if gaps[k, person] > 0.0:
                about = f"{name} passes person {int(episode.ids[person])} at {gaps[k, person]:.2f} m"
                events.append(EpisodeEvent(round(float(episode.times[k]), 3), "near miss", about))
    return events


def _stalls(episode: RecordedEpisode, robot: int, name: str) -> list[EpisodeEvent]:
    stands = np.hypot(*episode.velocity[:, robot].T) < STALL_SPEED
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
