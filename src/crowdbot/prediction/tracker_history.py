"""TrackerHistory: the last rows of a tracker, at any clock, as rows of a constant time step."""

from __future__ import annotations

from collections import deque
from collections.abc import Hashable
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError, kernel
from crowdbot.typing import Bools, Floats, Ints

from .tracker_frame import TrackerFrame
from .tracker_plausibility import TrackerPlausibility

FIRST_NUMBER = 1 << 40
"""Numbers of identities that are not integers start here."""
BRIDGE = 1.0
"""Longest gap of a track that is interpolated at irregular time stamps [s]."""
VELOCITY_TIME = 0.8
"""The velocity of a hidden person is the mean of this time before the last observation [s]."""
MAX_ROWS = 2000
"""Largest number of stored rows, whatever the rate of the tracker."""
SHORTEST_JUMP = 0.5
"""Shorter steps are no jumps, at any speed [m]: of frames some ms apart, noise alone looks fast."""


class _Row(NamedTuple):
    time: float
    who: Ints
    place: Floats
    robots: frozenset[int]
    covariance: Floats | None
    existence: Floats


class TrackedRows(NamedTuple):
    """Rows of A agents at a constant time step.

    Fields:
        position: ``[T, A, 2]`` [m]; 0 where absent.
        present: ``[T, A]``.
        robot: ``[A]``.
        id: ``[A]``, sorted.
        existence: ``[A]`` probability that an agent is there: the last one of the tracker, which decays while the agent
            is hidden.
        covariance: ``[T, A, 2, 2]`` [m^2] of the positions, NaN where the tracker gave none; None if there are none.
        radius: ``[A]`` [m] last known radius of each agent, NaN where unknown; None if all are.
        uncertainty: ``[A, 3, 3]`` covariance of the placement of the frame in which each agent was last seen, 0 without
            odometry; None if all are.
    """

    position: Floats
    present: Bools
    robot: Bools
    id: Ints
    existence: Floats
    covariance: Floats | None
    radius: Floats | None
    uncertainty: Floats | None


class TrackerHistory:
    """The last rows of a tracker, in the order of their time stamps.

    Rows are kept as they came; jumps and interpolation are computed when they are read. So the order of arrival does
    not matter.

    Args:
        dt: time step of :meth:`rows`, and between rows without a time stamp [s].
        observe: largest number T of rows.
        coast: how long hidden agents are kept [s].
        allowed_lateness: how much older than the newest a frame may be [s].
        plausibility: judges the stream; tracks are cut at steps that are faster than its ``max_speed``.
    """

    def __init__(
        self, dt: float, observe: int, coast: float, allowed_lateness: float, plausibility: TrackerPlausibility
    ) -> None:
        self.dt, self.observe, self.coast, self.allowed_lateness = dt, observe, coast, allowed_lateness
        self.plausibility = plausibility
        self.count = 0
        self.drop_count = 0
        self._stamped = False
        self._rows: deque[_Row] = deque()
        self._labels: dict[int, Hashable] = {}
        self._numbers: dict[Hashable, int] = {}
        self._next = FIRST_NUMBER
        self._radii: dict[int, tuple[float, float]] = {}  # time [s] and radius [m]
        self._uncertainty: dict[int, tuple[float, Floats]] = {}  # time [s] and covariance [3, 3]

    def add(self, frame: TrackerFrame) -> None:
        """Put a frame at its time; one with the stamp of a stored frame is merged with it, one too old is dropped."""
        newest = self._rows[-1].time if self._rows else -np.inf
        stamp = self._stamp(frame.time)
        if stamp < newest - self.allowed_lateness - 1e-9:
            self.drop_count += 1
            self.plausibility.report_late(stamp, newest, self.allowed_lateness)
            return
        who = np.array([self._number(label) for label in frame.labels], dtype=np.int64)
        order = np.argsort(who)
        machines = frozenset(self._number(label) for label in frame.robots)
        spread = None if frame.covariance is None else frame.covariance[order]
        row = _Row(stamp, who[order], frame.position[order], machines, spread, frame.existence[order])
        known = ~np.isnan(frame.radius)
        for number, size in zip(who[known].tolist(), frame.radius[known].tolist(), strict=True):
            if stamp >= self._radii.get(number, (-np.inf, 0.0))[0]:
                self._radii[number] = (stamp, size)
        if frame.uncertainty is not None:
            for number, own in zip(who.tolist(), frame.uncertainty, strict=True):
                if stamp >= self._uncertainty.get(number, (-np.inf, own))[0]:
                    self._uncertainty[number] = (stamp, own)
        if stamp > newest:
            self._judge(row, stamp - newest, frame.time is not None)
        self._stamped = self._stamped or frame.time is not None
        self._insert(row)
        self._forget()

    def _insert(self, row: _Row) -> None:
        at = len(self._rows)
        while at and self._rows[at - 1].time > row.time:
            at -= 1
        if at and self._rows[at - 1].time == row.time:
            self._rows[at - 1] = _merged(self._rows[at - 1], row)
        else:
            self._rows.insert(at, row)
            self.count += 1

    def _judge(self, row: _Row, step: float, stamped: bool) -> None:
        """Judge a row that is newer than all others."""
        if stamped and self._rows:
            self.plausibility.judge_step(step)
        people = ~np.isin(row.who, list(row.robots)) if row.robots else slice(None)
        self.plausibility.judge_speeds(row.time, row.who[people], row.place[people])

    def numbers(self) -> Ints:
        """Return the numbers ``[A]`` of the agents in the last row and of the hidden ones, sorted."""
        if not self._rows:
            return np.zeros(0, dtype=np.int64)
        now = self._rows[-1].time
        kept = [self._rows[-1].who]
        kept += [row.who for row in self._rows if self.coast > 0.0 and now - row.time <= self.coast + 1e-9]
        return np.unique(np.concatenate(kept))

    def labels(self, numbers: Ints) -> list[Hashable]:
        """Return the identities of numbers."""
        return [self._labels[int(number)] for number in numbers]

    def number_of(self, label: Hashable) -> int:
        """Return the number of an identity.

        Raises:
            InputError: the identity, which is not an integer, is unknown.
        """
        result = self._numbers.get(label)
        if result is not None:
            return result
        if isinstance(label, int | np.integer):
            return int(label)
        raise InputError(
            f"live: the plan is for {label!r}, who is not tracked; known are {sorted(map(str, self._numbers))}"
        )

    def rows(self) -> TrackedRows:
        """Return the last rows; those with time stamps are interpolated at steps of ``dt`` before the last one."""
        id = self.numbers()
        track = self._tracks(id)
        times = self._times()
        position, present = np.zeros((len(times), len(id), 2)), np.zeros((len(times), len(id)), dtype=np.bool_)
        known = any(row.covariance is not None for row in self._rows)
        covariance = np.full((len(times), len(id), 2, 2), np.nan) if known else None
        existence = self._last_existence(id)
        for slot, number in enumerate(id):
            seen, place, spread = track[int(number)]
            position[:, slot], present[:, slot], own = self._at(times, seen, place, spread)
            if covariance is not None:
                covariance[:, slot] = own
            hidden = times[-1] - seen[-1]
            if hidden > 1e-9:
                position[-1, slot], present[-1, slot] = _coast(seen, place, hidden), True
                existence[slot] *= 0.5 ** (2.0 * hidden / self.coast)
                if covariance is not None:
                    covariance[-1, slot] = _coasted_covariance(seen, spread, hidden)
        robots: frozenset[int] = frozenset().union(*(row.robots for row in self._rows))
        return TrackedRows(position, present, np.isin(id, sorted(robots)), id, existence, covariance,
                           self._last_radii(id), self._last_uncertainty(id))  # fmt: skip

    def _last_existence(self, id: Ints) -> Floats:
        """Return the existence probabilities ``[A]`` in the last frames of agents."""
        last: dict[int, float] = {}
        for row in self._rows:
            last.update(zip(row.who.tolist(), row.existence.tolist(), strict=True))
        return np.array([last[int(number)] for number in id])

    def _last_radii(self, id: Ints) -> Floats | None:
        """Return radii ``[A]`` [m], or None if none is known."""
        found = np.array([self._radii.get(int(number), (0.0, np.nan))[1] for number in id])
        return None if np.isnan(found).all() else found

    def _last_uncertainty(self, id: Ints) -> Floats | None:
        """Return covariances ``[A, 3, 3]`` of placements, or None if all are 0."""
        found = np.array([self._uncertainty.get(int(n), (0.0, np.zeros((3, 3))))[1] for n in id]).reshape(-1, 3, 3)
        return found if found.any() else None

    def _stamp(self, time: float | None) -> float:
        if time is not None:
            return time
        return self._rows[-1].time + self.dt if self._rows else 0.0

    def _number(self, label: Hashable) -> int:
        number = self._numbers.get(label)
        if number is None:
            plain = isinstance(label, int) and 0 <= label < FIRST_NUMBER
            number = int(label) if plain else self._next  # type: ignore[call-overload]
            self._next += 0 if plain else 1
            self._numbers[label], self._labels[number] = number, label
        return number

    def _forget(self) -> None:
        """Drop rows and identities that can no longer count."""
        kept = max((self.observe - 1) * self.dt, self.coast + VELOCITY_TIME)
        while len(self._rows) > 2 and self._rows[1].time <= self._rows[-1].time - kept - 1e-9:
            self._rows.popleft()
        if len(self._rows) > MAX_ROWS:
            self._rows.popleft()
        if self.count % self.observe == 0:
            alive = {int(n) for row in self._rows for n in (*row.who, *row.robots)}
            self._labels = {number: label for number, label in self._labels.items() if number in alive}
            self._numbers = {label: number for number, label in self._labels.items()}
            self._radii = {number: size for number, size in self._radii.items() if number in alive}
            self._uncertainty = {number: own for number, own in self._uncertainty.items() if number in alive}

    def _times(self) -> Floats:
        """Return the times of the rows: multiples of ``dt`` before now that are not before the first stored row."""
        if not self._rows:
            return np.zeros(0)
        now, first = self._rows[-1].time, self._rows[0].time
        count = min(self.observe, int((now - first) / self.dt + 1e-6) + 1)
        # a track shorter than dt still has a velocity
        count = min(self.observe, max(count, min(2, len(self._rows))))
        return now - self.dt * np.arange(count - 1, -1, -1.0)

    def _tracks(self, id: Ints) -> dict[int, tuple[Floats, Floats, Floats]]:
        """Return times ``[N]``, positions ``[N, 2]`` and covariances ``[N, 2, 2]`` of agents, since their last jump."""
        if not len(id):
            return {}
        who = np.concatenate([row.who for row in self._rows])
        order = np.argsort(who, kind="stable")
        time = np.repeat([row.time for row in self._rows], [len(row.who) for row in self._rows])[order]
        place = np.concatenate([row.place for row in self._rows])[order]
        spread = np.concatenate([_covariances(row) for row in self._rows])[order]
        who = who[order]
        first, last = (np.searchsorted(who, id, side=side) for side in ("left", "right"))
        if np.isfinite(self.plausibility.max_speed):
            self._cut_at_jumps(id, first, last, who, time, place)
        return {int(n): (time[a:b], place[a:b], spread[a:b]) for n, a, b in zip(id, first, last, strict=True)}

    def _cut_at_jumps(self, id: Ints, first: Ints, last: Ints, who: Ints, time: Floats, place: Floats) -> None:
        """Let the tracks ``first[A]`` to ``last[A]``, in observations sorted by person, begin after their last jump."""
        gap, length = np.diff(time), np.hypot(*np.diff(place, axis=0).T)
        fast = length > np.maximum(SHORTEST_JUMP, self.plausibility.max_speed * gap)
        jumps = np.flatnonzero(fast & (who[1:] == who[:-1])) + 1
        for number in np.intersect1d(who[jumps], id):
            slot = int(np.searchsorted(id, number))
            own = jumps[(first[slot] < jumps) & (jumps < last[slot])]
            # who jumps in most frames is rather a person in wrong units
            if 2 * len(own) < last[slot] - first[slot]:
                step = own[-1] - 1
                self.plausibility.report_jump(self._labels[int(number)], float(length[step]), float(gap[step]))
            first[slot] = own[-1]

    def _at(self, times: Floats, seen: Floats, place: Floats, spread: Floats) -> tuple[Floats, Bools, Floats]:
        """Return positions ``[T, 2]`` at times ``[T]``, whether they are known, and their covariances ``[T, 2, 2]``."""
        found, known, noise = interpolate_track(times, seen, place, spread, 1e-6 * self.dt, self._stamped)
        exact = abs(seen[-1] - times[-1]) <= 1e-6 * self.dt
        if self._stamped and len(seen) > 1 and len(times) > 1 and not known[:-1].any():  # observed for less than dt
            found[-2] = found[-1] - self.dt * _velocity(seen, place)
            known[-2] = exact
            noise[-2] = _coasted_covariance(seen, spread, -self.dt)
        return np.where(known[:, None], found, 0.0), known, np.where(known[:, None, None], noise, np.nan)


@kernel
def interpolate_track(
    times: Floats, seen: Floats, place: Floats, spread: Floats, same: float, between: bool
) -> tuple[Floats, Bools, Floats]:  # pragma: no cover - compiled
    """Return positions ``[T, 2]`` at times ``[T]``, whether they are known, and their covariances ``[T, 2, 2]``.

    Args:
        times: times [s].
        seen, place, spread: times ``[N]``, positions ``[N, 2]`` and covariances ``[N, 2, 2]`` of a track.
        same: largest difference [s] of times that are the same.
        between: whether positions between two rows are interpolated.
    """
    T, N = len(times), len(seen)
    found, known, noise = np.zeros((T, 2)), np.zeros(T, dtype=np.bool_), np.full((T, 2, 2), np.nan)
    after = 0
    for t in range(T):
        while after < N - 1 and seen[after] < times[t] - same:
            after += 1
        if abs(seen[after] - times[t]) <= same:
            found[t], noise[t], known[t] = place[after], spread[after], True
            continue
        before = max(after - 1, 0)
        gap = seen[after] - seen[before]
        if not between or not (seen[before] < times[t] and times[t] < seen[after] and gap <= BRIDGE):
            continue
        share, known[t] = (times[t] - seen[before]) / gap, True
        for c in range(2):
            found[t, c] = place[before, c] + share * (place[after, c] - place[before, c])
            for d in range(2):
                noise[t, c, d] = (1.0 - share) ** 2 * spread[before, c, d] + share**2 * spread[after, c, d]
    return found, known, noise


def _merged(row: _Row, other: _Row) -> _Row:
    """Return a row of all people of two rows of the same time; those of both are as in the second one."""
    who = np.concatenate([other.who, row.who])
    number, at = np.unique(who, return_index=True)  # the first occurrence
    spread = None
    if row.covariance is not None or other.covariance is not None:
        spread = np.concatenate([_covariances(other), _covariances(row)])[at]
    place, existence = (np.concatenate(both)[at] for both in ((other.place, row.place), (other.existence,
                                                                                         row.existence)))  # fmt: skip
    return _Row(row.time, number, place, row.robots | other.robots, spread, existence)


def _covariances(row: _Row) -> Floats:
    """Return the covariances ``[N, 2, 2]`` of a row, NaN where the tracker gave none."""
    return np.full((len(row.who), 2, 2), np.nan) if row.covariance is None else row.covariance


def _velocity_base(seen: Floats) -> tuple[int, float]:
    """Return the observation from which the velocity of a track is measured, and the time since then [s]."""
    first = min(int(np.searchsorted(seen, seen[-1] - VELOCITY_TIME - 1e-9)), max(0, len(seen) - 2))
    return first, float(seen[-1] - seen[first])


def _velocity(seen: Floats, place: Floats) -> Floats:
    """Return the mean velocity ``[2]`` [m/s] of the last 0.8 s of a track; 0 for a single observation."""
    first, time = _velocity_base(seen)
    return np.asarray((place[-1] - place[first]) / time if time > 0.0 else np.zeros(2))


def _coast(seen: Floats, place: Floats, hidden: float) -> Floats:
    """Return the position ``[2]`` [m] of an agent some time after the last observation."""
    return np.asarray(place[-1] + hidden * _velocity(seen, place))


def _coasted_covariance(seen: Floats, spread: Floats, ahead: float) -> Floats:
    """Return the covariance ``[2, 2]`` [m^2] of a position that :func:`_velocity` extrapolates by ``ahead`` [s]."""
    first, time = _velocity_base(seen)
    ratio = ahead / time if time > 0.0 else 0.0
    return np.asarray((1.0 + ratio) ** 2 * spread[-1] + ratio**2 * spread[first])
