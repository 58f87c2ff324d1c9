"""TrackHistory: the past positions of people around a robot, as arrays, and forecasts from them."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, Walls, storable, stream
from crowdbot.data import Forecast, Windows
from crowdbot.prediction import Predictor
from crowdbot.typing import Floats

LENGTH = 40
"""Default number of rows: 4 s at 10 Hz."""
HORIZON = 4.8
"""Default time of a forecast [s]: 12 rows of 0.4 s, as usual for people."""
SAME = 1e-6
"""Tolerance of times [s]."""


@storable
@dataclass(frozen=True, eq=False)
class TrackHistory:
    """Positions of N people at the last T instants, at most ``length``.

    Fields:
        times: ``[T]`` increasing [s].
        ids: ``[N]`` increasing identities of everybody who was seen at one of these instants.
        position: ``[T, N, 2]`` [m], newest row last; NaN where a person was not seen.
        length: largest number of rows.

    >>> tracks = TrackHistory.empty(length=2)
    >>> for k in range(3):
    ...     tracks = tracks.update(0.1 * k, [7], [[0.2 * k, 0.0]])
    >>> tracks.position[:, 0].tolist()
    [[0.2, 0.0], [0.4, 0.0]]
    """

    times: Floats
    ids: NDArray[np.int64]
    position: Floats
    length: int = LENGTH

    @classmethod
    def empty(cls, length: int = LENGTH) -> TrackHistory:
        """Return a history without rows.

        Raises:
            InputError: ``length`` is below 1.
        """
        if length < 1:
            raise InputError(f"track history: length = {length} rows must be at least 1")
        return cls(np.zeros(0), np.zeros(0, dtype=np.int64), np.zeros((0, 0, 2)), length)

    def update(self, time: float, ids: ArrayLike, position: ArrayLike) -> TrackHistory:
        """Return the history with one more row; the oldest row is dropped at the maximum length.

        Args:
            time: time of the row [s], after the newest row.
            ids: ``[N]`` identities of the people seen now.
            position: ``[N, 2]`` [m].

        Raises:
            InputError: the time is not after the newest row, shapes do not match, a position is not finite, or an
                identity is duplicate.
        """
        who = np.asarray(ids, dtype=np.int64).reshape(-1)
        place = np.asarray(position, dtype=np.float64).reshape(-1, 2)
        if len(who) != len(place):
            raise InputError(f"track history: {len(who)} identities and {len(place)} positions; they must be equal")
        if not np.all(np.isfinite(place)):
            raise InputError(f"track history: the position of {who[~np.isfinite(place).all(axis=1)][0]} is not finite")
        if len(np.unique(who)) != len(who):
            raise InputError(f"track history: identities {who.tolist()} must be distinct")
        if not math.isfinite(time) or (len(self.times) and time <= self.times[-1]):
            newest = f" and after the newest row at {self.times[-1]:g} s" if len(self.times) else ""
            raise InputError(f"track history: time = {time} s must be finite{newest}")
        rows = self.position[max(0, len(self.times) - self.length + 1) :]
        there = ~np.isnan(rows[..., 0]).all(axis=0)
        every = np.union1d(self.ids[there], who)
        after = np.full((len(rows) + 1, len(every), 2), np.nan)
        after[:-1, np.searchsorted(every, self.ids[there])] = rows[:, there]
        after[-1, np.searchsorted(every, who)] = place
        times = np.append(self.times[len(self.times) - len(rows) :], float(time))
        return TrackHistory(times, every, after, self.length)

    def windows(self, dt: float | None = None, walls: Walls | None = None) -> Windows:
        """Return the history as one window of a predictor, with all people of :attr:`ids`.

        Args:
            dt: time between the rows of the window [s]; default: between the two newest rows. Instants without a row
                within 1 microsecond are rows without people.
            walls: walls of the stage.

        Raises:
            InputError: there is no row, there is one row and no ``dt``, or ``dt`` is not above 0.
        """
        if len(self.times) == 0:
            raise InputError("track history: no row yet; call update first")
        if dt is None:
            if len(self.times) < 2:
                raise InputError("track history: a single row does not define the time step; give dt")
            dt = float(self.times[-1] - self.times[-2])
        if not 0.0 < dt < math.inf:
            raise InputError(f"track history: dt = {dt} s must be finite and above 0")
        back = (self.times[-1] - self.times) / dt
        steps = np.rint(back)
        fits = np.abs(back - steps) * dt < SAME
        T, N = int(steps[fits].max()) + 1, len(self.ids)
        position, present = np.zeros((1, T, N, 2)), np.zeros((1, T, N), dtype=np.bool_)
        row = T - 1 - steps[fits].astype(np.int64)
        seen = ~np.isnan(self.position[fits, :, 0])
        position[0, row] = np.where(seen[..., None], self.position[fits], 0.0)
        present[0, row] = seen
        nobody = np.zeros((1, N), dtype=np.bool_)
        frame = round(float(self.times[-1]) / dt) - T + 1 + np.arange(T)
        rings = () if walls is None else _rings(walls)
        return Windows(
            position, present, nobody, nobody, self.ids[None], frame[None], dt, "live", "track history", rings
        )

    def forecast(
        self,
        predictor: Predictor,
        seconds: float,
        *,
        dt: float | None = None,
        walls: Walls | None = None,
        samples: int = 1,
        seed: int = 0,
    ) -> Forecast:
        """Return the forecast of the people seen in the newest row, in the order of :attr:`ids`.

        Args:
            predictor: any predictor whose goal does not require the future.
            seconds: time to predict [s], rounded up to whole rows.
            dt: time between rows [s]; default: between the two newest rows.
            walls: walls of the stage.
            samples: number of futures.
            seed: random seed; the random stream also depends on the number of the newest row.

        Raises:
            InputError: ``seconds`` is not above 0, the predictor requires the future, or :meth:`windows` fails.
        """
        if problem := forecast_problem(predictor, seconds):
            raise InputError(problem)
        past = self.windows(dt, walls)
        steps = math.ceil(seconds / past.dt - SAME)
        return predictor.predict(past, steps, samples, stream(seed, "forecast", int(past.frame[0, -1])))


def choose_predictor(
    given: Predictor | None, usual: Predictor | None, dt: float | None, usual_dt: float | None
) -> tuple[Predictor, float | None]:
    """Return the predictor of a forecast and the time between its rows [s], None: of the tracks.

    Args:
        given, dt: arguments of the forecast.
        usual, usual_dt: predictor of the robot in the trial, and its time step [s]; both apply together.

    Raises:
        InputError: there is no predictor.
    """
    if given is not None:
        return given, dt
    if usual is None:
        raise InputError("observation: forecast needs a predictor: pass one, or name it in the trial with <predictor>")
    return usual, usual_dt if dt is None else dt


def forecast_problem(predictor: object, seconds: float) -> str:
    """Return why a predictor cannot forecast people around a robot; empty if it can."""
    if not isinstance(predictor, Predictor):
        return f"forecast: {predictor!r} is not a predictor; pass an instance of crowdbot.Predictor"
    goal = getattr(predictor, "goal", None)
    if getattr(goal, "knows_future", False):
        return f"forecast: {type(goal).__name__} requires the future, which a robot does not know"
    return "" if 0.0 < seconds < math.inf else f"forecast: seconds = {seconds} must be finite and above 0"


def _rings(walls: Walls) -> tuple[Floats, ...]:
    """Return the corners ``[N, 2]`` of each ring of the walls."""
    rings, begin = [], 0
    while begin < len(walls):
        end = int(walls.previous[begin]) + 1
        rings.append(walls.start[begin:end])
        begin = end
    return tuple(rings)
