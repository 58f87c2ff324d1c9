"""Replay of recorded tracks, with optional release of people when a robot comes near."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, kernel
from crowdbot.typing import Bools, Floats

Numbers = NDArray[np.int64]

SCRIPT = "script"
"""Name in the memory of a scene ``[E, A]``: one of the states below."""
NONE, FOLLOWS, FREE, GONE = 0.0, 1.0, 2.0, 3.0
AHEAD = 1.5
"""A released person walks to the recorded position this much later [s]."""
HURRY = 1.5
"""Speed limit of a released person, as a multiple of the largest speed in the track."""
SLOWEST = 0.5
"""Lower bound of this speed limit [m/s]."""
ARRIVED = 0.3
"""A released person leaves within this distance [m] of the end of the track."""
MOVING = 0.05
"""The heading follows the velocity above this speed [m/s]."""
EARLY = 1e-4
"""Tolerance [s] for clocks whose step is rounded to nanoseconds."""


class ReplayedTrack(NamedTuple):
    """A recorded track: index of the agent, ascending times ``[T]`` [s] and positions ``[T, 2]`` [m]."""

    agent: int
    time: Floats
    position: Floats


@dataclass(frozen=True)
class ReplayedPeople:
    """Agents that follow recorded tracks, interpolated linearly between recorded positions.

    An agent is present from the first to the last time of its track. With ``release``, an agent is released when a
    robot visible to people comes closer than this distance (occlusion is ignored). The crowd model then moves it
    towards the recorded position 1.5 s ahead, and it leaves at the end of the track.

    Fields:
        tracks: recorded tracks, at most one per agent.
        release: distance between centres [m], for all or for each track; 0: no release.

    Raises:
        InputError: times of a track do not increase, or a value is not finite.

    >>> script = ReplayedPeople([ReplayedTrack(0, np.array([0.0, 2.0]), np.array([[0.0, 0.0], [2.0, 1.0]]))])
    >>> start = script.start(Scene.of([[9.0, 9.0]]), 1.0)
    >>> start.position[0].tolist(), script.follower_mask(start).tolist()
    ([[1.0, 0.5]], [[True]])
    """

    tracks: Sequence[ReplayedTrack]
    release: float | Sequence[float] = 0.0
    _rows: _Rows = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        tracks = tuple(ReplayedTrack(int(a), np.asarray(t, float), np.asarray(p, float)) for a, t, p in self.tracks)
        object.__setattr__(self, "tracks", tracks)
        far = np.asarray(self.release, dtype=np.float64)
        if far.shape not in ((), (len(tracks),)) or not np.all((far >= 0.0) & (far < math.inf)):
            raise InputError(
                f"ReplayedPeople: release = {self.release} m must be finite and at least 0; give one value, or "
                f"one per track"
            )
        if len({track.agent for track in tracks}) < len(tracks):
            raise InputError("ReplayedPeople: an agent has two tracks; at most one is allowed")
        for track in tracks:
            if len(track.time) == 0 or track.position.shape != (len(track.time), 2):
                raise InputError(
                    f"ReplayedPeople: the track of agent {track.agent} must have positions [T, 2] for times [T]"
                )
            if not (np.all(np.isfinite(track.position)) and np.all(np.diff(track.time) > 0.0)):
                raise InputError(
                    f"ReplayedPeople: the track of agent {track.agent} has values that are not finite, or times "
                    f"that do not increase"
                )
        object.__setattr__(self, "_rows", _Rows.of(tracks))

    def follower_mask(self, scene: Scene) -> Bools:
        """Return ``[E, A]``, whether an agent follows a recorded track."""
        state = scene.memory.get(SCRIPT)
        return np.zeros(scene.shape, dtype=np.bool_) if state is None else np.asarray(state == FOLLOWS)

    def start(self, scene: Scene, time: float = 0.0) -> Scene:
        """Return the scene at a time [s] of the recording, with each person on the recorded track."""
        state = np.zeros(scene.shape)
        state[:, self._rows.agent] = FOLLOWS
        return self.place(scene.replace(memory={**scene.memory, SCRIPT: state}), time)

    def place(self, scene: Scene, time: float | Floats) -> Scene:
        """Return the scene with replayed people at their positions, and released people with a goal.

        Args:
            scene: current scene.
            time: time of the recording [s], one or ``[E]``.
        """
        rows, agent = self._rows, self._rows.agent
        if len(agent) == 0:
            return scene
        now = np.broadcast_to(np.asarray(time, dtype=np.float64), (scene.shape[0],))
        state = scene.memory[SCRIPT].copy()
        position, velocity, heading = scene.position.copy(), scene.velocity.copy(), scene.heading.copy()
        active, goal, speed = scene.active.copy(), scene.goal.copy(), scene.preferred_speed.copy()
        top = scene.max_speed.copy()
        follows, free = state[:, agent] == FOLLOWS, state[:, agent] == FREE
        place, pace = rows.at(now)
        there = (now[:, None] >= rows.begin - EARLY) & (now[:, None] <= rows.end + EARLY)
        turned = follows & (np.hypot(pace[..., 0], pace[..., 1]) > MOVING)
        position[:, agent] = np.where(follows[..., None], place, position[:, agent])
        velocity[:, agent] = np.where(follows[..., None], pace, velocity[:, agent])
        heading[:, agent] = np.where(turned, np.arctan2(pace[..., 1], pace[..., 0]), heading[:, agent])
        active[:, agent] = np.where(follows, there, active[:, agent])
        goal[:, agent] = np.where(follows[..., None], rows.last, goal[:, agent])
        speed[:, agent] = np.where(follows, rows.pace, speed[:, agent])
        if np.any(free):
            left = np.hypot(*np.moveaxis(rows.last - position[:, agent], -1, 0))
            gone = free & (left < ARRIVED) & (now[:, None] >= rows.end - AHEAD)
            active[:, agent] &= ~gone
            state[:, agent] = np.where(gone, GONE, state[:, agent])
            ahead = rows.at(now + AHEAD)[0]
            away = np.hypot(*np.moveaxis(ahead - position[:, agent], -1, 0))
            goal[:, agent] = np.where(free[..., None], ahead, goal[:, agent])
            speed[:, agent] = np.where(free, np.minimum(away / AHEAD, HURRY * rows.pace), speed[:, agent])
            top[:, agent] = np.where(free, 1.3 * HURRY * rows.pace, top[:, agent])
        moved = scene.replace(
            position=position, velocity=velocity, heading=heading, active=active, goal=goal,
            preferred_speed=speed, max_speed=top, memory={**scene.memory, SCRIPT: state},
        )  # fmt: skip
        return self._released(moved)

    def _released(self, scene: Scene) -> Scene:
        robots = scene.external & scene.active & scene.visible
        if not np.any(robots) or not np.any(self.release):
            return scene
        state = scene.memory[SCRIPT].copy()
        far = np.zeros(scene.shape[1])
        far[self._rows.agent] = self.release
        near = np.zeros(scene.shape, dtype=np.bool_)
        for robot in np.flatnonzero(np.any(robots, axis=0)).tolist():
            away = scene.position - scene.position[:, robot : robot + 1]
            near |= robots[:, robot : robot + 1] & (np.hypot(away[..., 0], away[..., 1]) < far)
        state[near & scene.active & (state == FOLLOWS)] = FREE
        return scene.replace(memory={**scene.memory, SCRIPT: state})


@kernel
def _count_rows(table: Floats, first: Numbers, time: Floats, out: Numbers) -> None:
    """Write the index of the last row up to a time for each environment and track, ``first[n] - 1`` before a track."""
    for e in range(len(time)):
        for n in range(len(first) - 1):
            low, high = first[n], first[n + 1]
            while low < high:
                middle = (low + high) // 2
                if table[middle] <= time[e]:
                    low = middle + 1
                else:
                    high = middle
            out[e, n] = low - 1


class _Rows(NamedTuple):
    """All tracks in one table: ``[M]`` rows sorted by track and time, and ``[N]`` values by track."""

    time: Floats
    position: Floats
    first: Numbers
    agent: Numbers
    begin: Floats
    end: Floats
    last: Floats
    pace: Floats

    @classmethod
    def of(cls, tracks: Sequence[ReplayedTrack]) -> _Rows:
        if not tracks:
            none = np.zeros(0)
            no = np.zeros(0, dtype=np.int64)
            return cls(none, np.zeros((0, 2)), no, no, none, none, np.zeros((0, 2)), none)
        count = np.array([len(track.time) for track in tracks])
        return cls(
            np.concatenate([track.time for track in tracks]),
            np.concatenate([track.position for track in tracks]),
            np.concatenate([[0], np.cumsum(count)]),
            np.array([track.agent for track in tracks], dtype=np.int64),
            np.array([track.time[0] for track in tracks]),
            np.array([track.time[-1] for track in tracks]),
            np.array([track.position[-1] for track in tracks]),
            np.array([max(SLOWEST, _max_speed(track)) for track in tracks]),
        )

    def at(self, time: Floats) -> tuple[Floats, Floats]:
        """Return positions ``[E, N, 2]`` [m] and velocities [m/s] at times ``[E]`` [s].

        Before and after a track, its ends at rest.
        """
        k = np.empty((len(time), len(self.agent)), dtype=np.int64)
        _count_rows(self.time, self.first, time + EARLY, k)
        here = np.clip(k, self.first[:-1], self.first[1:] - 1)
        following = np.minimum(here + 1, self.first[1:] - 1)
        span = self.time[following] - self.time[here]
        step = self.position[following] - self.position[here]
        inside = (k >= self.first[:-1]) & (span > 0.0)
        share = np.where(inside, (time[:, None] - self.time[here]) / np.where(span > 0.0, span, 1.0), 0.0)
        pace = step * np.where(inside, 1.0 / np.where(span > 0.0, span, 1.0), 0.0)[..., None]
        return self.position[here] + step * np.maximum(share, 0.0)[..., None], pace


def _max_speed(track: ReplayedTrack) -> float:
    """Return the largest speed [m/s] over at least one second of a track; 0 for shorter tracks."""
    step = np.searchsorted(track.time, track.time + 1.0 - EARLY)
    whole = step < len(track.time)
    if not np.any(whole):
        return 0.0
    way = track.position[step[whole]] - track.position[whole]
    return float(np.max(np.hypot(way[:, 0], way[:, 1]) / (track.time[step[whole]] - track.time[whole])))
