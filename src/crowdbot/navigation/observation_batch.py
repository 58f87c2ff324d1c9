"""ObservationBatch: the observations of one robot in several environments, as arrays, and forecasts from them."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, Twist, Walls, dense, kernel, stream
from crowdbot.data import Forecast, Windows
from crowdbot.prediction import Predictor
from crowdbot.sensors import Reading
from crowdbot.typing import Bools, Floats, Ints

from .observation import CERTAIN, DISC, NO_GESTURE, DriveLimits, Observation, VisiblePeople
from .track_batch import TrackBatch
from .track_history import HORIZON, SAME, TrackHistory, choose_predictor, forecast_problem

FLOAT, BOOL, INTEGER = np.dtype(np.float64), np.dtype(np.bool_), np.dtype(np.int64)
TYPES = {"seen": BOOL, "ids": INTEGER, "gesture": INTEGER}
SEEDS = 2**63
"""Predictors draw the seed of each window below this number; see ``crowdbot.prediction.window_streams``."""


@dataclass(frozen=True)
class AgentsInView:
    """People and other robots around one robot in N environments, with A places each.

    Fields:
        position, velocity: ``[N, A, 2]`` [m], [m/s]; arbitrary where nobody is seen.
        radius: ``[N, A]`` [m].
        seen: ``[N, A]`` bool, whether the robot sees the agent; False for itself and for free places.
        ids: ``[N, A]`` identities.
        existence: ``[N, A]`` probability that there is an agent; default 1.
        gesture: ``[N, A]`` code of the gesture that each makes, see :class:`VisiblePeople`; default 0, none.
    """

    position: Floats
    velocity: Floats
    radius: Floats
    seen: Bools
    ids: NDArray[np.int64]
    existence: Floats = field(default_factory=lambda: CERTAIN)
    gesture: NDArray[np.int64] = field(default_factory=lambda: NO_GESTURE)

    def __post_init__(self) -> None:
        if self.existence is CERTAIN:
            object.__setattr__(self, "existence", np.ones(self.radius.shape))
        if self.gesture is NO_GESTURE:
            object.__setattr__(self, "gesture", np.zeros(self.radius.shape, dtype=np.int64))

    @classmethod
    def none(cls, count: int) -> AgentsInView:
        """Return nobody in ``count`` environments."""
        empty = np.zeros((count, 0, 2))
        return cls(empty, empty, np.zeros((count, 0)), np.zeros((count, 0), np.bool_), np.zeros((count, 0), np.int64))


@dataclass(frozen=True, kw_only=True)
class ObservationBatch:
    """Input of a decision of one robot in N environments at once; :meth:`environment` returns one of them.

    The values are not checked here: an environment with a value that is not finite fails alone, in
    :meth:`crowdbot.navigation.Navigator.decide_batch`.

    Fields:
        pose: ``[N, 3]`` x, y [m] and heading [rad].
        goal: ``[N, 2]`` [m].
        radius: ``[N]`` radius of the robot [m].
        limits: limits of the drive.
        dt: time until the next decision [s].
        twist: ``[N, 3]`` current forward [m/s], turn [rad/s], left [m/s]; default 0.
        people: visible people and other robots; default nobody.
        walls: walls of the stage.
        time: ``[N]`` simulated time [s]; default 0.
        waypoint: ``[N, 2]`` next point of each planned path [m]; default: the goals.
        readings: latest reading of each sensor by name, with N rows.
        arrived: ``[N]`` bool by name of a sensor, whether its reading has arrived in the environment; a sensor that is
            not listed has a reading everywhere.
        tracks: N histories of the visible people, or empty; a sequence of histories becomes a :class:`TrackBatch`.
        predictor, predictor_step: default predictor of :meth:`forecast` and the time between its rows [s], or None.
        outline: corners ``[K, 2]`` of the outline of the robot [m], see :class:`Observation`.

    Raises:
        InputError: a shape is wrong.

    >>> goals = np.array([[4.0, 0.0], [0.0, 4.0]])
    >>> batch = ObservationBatch(
    ...     pose=np.zeros((2, 3)), goal=goals, radius=np.full(2, 0.3), limits=DriveLimits(1.0, 2.0), dt=0.1
    ... )
    >>> len(batch), batch.environment(1).goal
    (2, (0.0, 4.0))
    """

    pose: Floats
    goal: Floats
    radius: Floats
    limits: DriveLimits
    dt: float
    twist: Floats = field(default_factory=lambda: np.zeros(0))
    people: AgentsInView = field(default_factory=lambda: AgentsInView.none(0))
    walls: Walls = field(default_factory=Walls.of)
    time: Floats = field(default_factory=lambda: np.zeros(0))
    waypoint: Floats = field(default_factory=lambda: np.zeros(0))
    readings: Mapping[str, Reading] = field(default_factory=dict)
    arrived: Mapping[str, Bools] = field(default_factory=dict)
    tracks: TrackBatch | Sequence[TrackHistory] = ()
    predictor: Predictor | None = None
    predictor_step: float | None = None
    outline: Floats = field(default_factory=lambda: DISC)

    def __post_init__(self) -> None:
        N = len(self.pose)
        for name, empty in (("twist", (N, 3)), ("time", (N,))):
            if getattr(self, name).size == 0:
                object.__setattr__(self, name, np.zeros(empty))
        if self.waypoint.size == 0:
            object.__setattr__(self, "waypoint", self.goal)
        if len(self.people.radius) == 0:
            object.__setattr__(self, "people", AgentsInView.none(N))
        for name, shape in (("pose", 3), ("goal", 2), ("waypoint", 2), ("twist", 3), ("radius", 0), ("time", 0)):
            _require(self, name, (N, shape) if shape else (N,))
        A = self.people.radius.shape[-1]
        kinds = {"position": 2, "velocity": 2, "radius": 0, "seen": 0, "ids": 0, "existence": 0, "gesture": 0}
        for name, kind in kinds.items():
            _require(self.people, name, (N, A, kind) if kind else (N, A), TYPES.get(name, FLOAT))
        if len(self.tracks) not in (0, N):
            raise InputError(f"observations: {len(self.tracks)} tracks in {N} environments; give one for each, or none")
        if not isinstance(self.tracks, TrackBatch) and len({track.length for track in self.tracks}) == 1:
            object.__setattr__(self, "tracks", TrackBatch.of(self.tracks))

    @classmethod
    def of(
        cls,
        scene: Scene,
        robot: int,
        limits: DriveLimits,
        *,
        dt: float,
        twist: Floats,
        seen: Bools | None = None,
        environments: NDArray[np.int64] | None = None,
        **others: Any,
    ) -> ObservationBatch:
        """Return the observations of a robot in a scene, with the true state of the visible people.

        Args:
            scene: current scene of E environments, with the goal of the robot.
            robot: index of the robot.
            limits: limits of its drive.
            dt: time until the next decision [s].
            twist: ``[E, 3]`` current forward, turn, left.
            seen: ``[E, A]`` visible agents; default all.
            environments: ``[N]`` environments in which the robot decides; default all E.
            others: ``waypoint``, ``readings``, ``arrived``, ``tracks`` and ``time`` of the N environments; ``ids``
                (default: indices) and ``gesture`` (default: none) ``[E, A]`` of all agents.

        >>> scene = Scene.of([[[0.0, 0.0], [2.0, 0.0]]] * 3, goal=[[[9.0, 0.0], [0.0, 0.0]]] * 3)
        >>> batch = ObservationBatch.of(scene, 0, DriveLimits(1.0, 2.0), dt=0.1, twist=np.zeros((3, 3)),
        ...     environments=np.array([0, 2]))
        >>> batch.people.seen.tolist()
        [[False, True], [False, True]]
        """
        E, A = shape = scene.shape
        which = np.arange(E) if environments is None else np.asarray(environments, dtype=np.int64)
        ids, gesture = others.pop("ids", None), others.pop("gesture", None)
        numbers = np.broadcast_to(np.arange(A), shape) if ids is None else ids
        N = len(which)
        pose, goal, radius, moving = np.empty((N, 3)), np.empty((N, 2)), np.empty(N), np.empty((N, 3))
        people = AgentsInView(
            np.empty((N, A, 2)),
            np.empty((N, A, 2)),
            np.empty((N, A)),
            np.empty((N, A), BOOL),
            np.empty((N, A), INTEGER),
            gesture=NO_GESTURE if gesture is None else np.asarray(gesture, dtype=np.int64)[which],
        )
        values: Any = (
            which,
            robot,
            *[dense(value, (*shape, 2), FLOAT) for value in (scene.position, scene.velocity, scene.goal)],
            *[dense(value, shape, FLOAT) for value in (scene.heading, scene.radius)],
            dense(scene.active, shape, BOOL),
            dense(scene.active if seen is None else seen, shape, BOOL),
            dense(numbers, shape, INTEGER),
            dense(twist, (E, 3), FLOAT),
            *(pose, goal, radius, moving),
            *(people.position, people.velocity, people.radius, people.seen, people.ids),
        )
        if not _gather(*values):
            raise IndexError(f"robot {robot} in environments {which.tolist()}: the scene has the shape {list(shape)}")
        time = np.empty(N)
        time[:] = scene.time[which] if isinstance(scene.time, np.ndarray) else scene.time
        batch = object.__new__(cls)  # these arrays need no checks
        batch.__dict__.update(
            pose=pose, goal=goal, radius=radius, limits=limits, dt=dt, twist=moving, people=people, walls=scene.walls,
            time=time, waypoint=goal, readings={}, arrived={}, tracks=(), predictor=None, predictor_step=None,
            outline=DISC,
        )  # fmt: skip
        if unknown := others.keys() - cls.__dataclass_fields__.keys():
            raise TypeError(f"{cls.__name__} has no field {min(unknown)!r}")
        batch.__dict__.update(others)
        if not others.keys().isdisjoint(("waypoint", "tracks", "time")):
            batch.__post_init__()
        return batch

    def __len__(self) -> int:
        """Return the number of environments."""
        return len(self.pose)

    def environment(self, k: int) -> Observation:
        """Return the observation in environment ``k``, 0 to N - 1.

        Raises:
            InputError: a number of this environment is not finite or not above 0, as in :class:`Observation`.
        """
        seen = self.people.seen[k]
        forward, turn, left = self.twist[k].tolist()
        x, y, heading = self.pose[k].tolist()
        readings = {
            name: reading_of(reading, k, len(self))
            for name, reading in self.readings.items()
            if name not in self.arrived or self.arrived[name][k]
        }
        return Observation(
            pose=(x, y, heading),
            goal=(float(self.goal[k, 0]), float(self.goal[k, 1])),
            radius=float(self.radius[k]),
            limits=self.limits,
            dt=self.dt,
            twist=Twist(forward, turn, left),
            people=VisiblePeople(
                self.people.position[k, seen],
                self.people.velocity[k, seen],
                self.people.radius[k, seen],
                self.people.ids[k, seen],
                self.people.existence[k, seen],
                self.people.gesture[k, seen],
            ),
            walls=self.walls,
            time=float(self.time[k]),
            readings=readings,
            waypoint=(float(self.waypoint[k, 0]), float(self.waypoint[k, 1])),
            tracks=self.tracks[k] if self.tracks else None,
            predictor=self.predictor,
            predictor_step=self.predictor_step,
            outline=self.outline,
        )

    def forecast(
        self,
        predictor: Predictor | None = None,
        seconds: float = HORIZON,
        *,
        samples: int = 1,
        seed: int = 0,
        dt: float | None = None,
    ) -> Forecast:
        """Return the forecasts in all environments, equal to those of each :meth:`environment`.

        Window k of the forecast is environment k; its people are ``tracks[k].ids``, then places without a prediction.
        A built-in predictor predicts environments with equally many rows in one call. Arguments and errors are those of
        :meth:`Observation.forecast`.
        """
        if not self.tracks:
            raise InputError("observation: forecast needs tracks, but they are None")
        known, step = choose_predictor(predictor, self.predictor, dt, self.predictor_step)
        steps = [step if step or len(track.times) > 1 else self.dt for track in self.tracks]
        return forecast_tracks(self.tracks, known, seconds, steps, self.walls, samples, seed)


@kernel
def _gather(
    which: Ints, robot: int, position: Floats, velocity: Floats, goal: Floats, heading: Floats, radius: Floats,
    active: Bools, seen: Bools, ids: Ints, twist: Floats, pose: Floats, target: Floats, size: Floats, moving: Floats,
    place: Floats, pace: Floats, wide: Floats, visible: Bools, numbers: Ints,
) -> bool:  # fmt: skip
    """Write pose, goal, radius and twist of a robot in some environments, and the fields of the people around it.

    Return False if an environment or the robot is not in the scene.
    """
    E, A = active.shape
    for k in range(len(which)):
        e = which[k]
        if not (0 <= e < E and 0 <= robot < A):
            return False
        pose[k, 0], pose[k, 1], pose[k, 2] = position[e, robot, 0], position[e, robot, 1], heading[e, robot]
        target[k, 0], target[k, 1], size[k] = goal[e, robot, 0], goal[e, robot, 1], radius[e, robot]
        moving[k, 0], moving[k, 1], moving[k, 2] = twist[e, 0], twist[e, 1], twist[e, 2]
        for a in range(A):
            place[k, a, 0], place[k, a, 1] = position[e, a, 0], position[e, a, 1]
            pace[k, a, 0], pace[k, a, 1], wide[k, a] = velocity[e, a, 0], velocity[e, a, 1], radius[e, a]
            visible[k, a], numbers[k, a] = active[e, a] and seen[e, a] and a != robot, ids[e, a]
    return True


def _require(owner: Any, name: str, shape: tuple[int, ...], kind: np.dtype[Any] = FLOAT) -> None:
    """Check the shape of an array field and make it fit for kernels: of one type, C-contiguous and writeable."""
    value = getattr(owner, name)
    if value.shape != shape:
        raise InputError(
            f"observations: {name} has shape {list(value.shape)}, it must be {list(shape)} in {shape[0]} environments"
        )
    if value.dtype is not kind or not value.flags.carray:
        object.__setattr__(owner, name, np.require(value, kind, ["C", "W"]))


def reading_of(reading: Reading, k: int, count: int) -> Reading:
    """Return the reading of environment ``k`` of ``count``, with one row.

    Raises:
        InputError: the reading has another number of rows.
    """
    rows = len(reading.pose.position)
    if rows != count:
        raise InputError(f"observations: a {type(reading).__name__} has {rows} rows, it must have {count}")
    return reading.environment(k)


class _WindowSeeds:
    """A generator that gives window k the first number of the random stream of environment k."""

    def __init__(self, seeds: NDArray[np.int64]) -> None:
        self._seeds, self._begin = seeds, 0

    def integers(self, low: int, high: int, size: int) -> NDArray[np.int64]:
        """Return the numbers of the next windows; every other use of the generator is an error."""
        if (low, high) != (0, SEEDS):
            raise InputError(f"forecast: the predictor draws from {low} to {high}, it must call window_streams")
        first, self._begin = self._begin, self._begin + size
        return self._seeds[first : self._begin]


def forecast_tracks(
    tracks: Sequence[TrackHistory],
    predictor: Predictor,
    seconds: float,
    steps: Sequence[float | None],
    walls: Walls,
    samples: int = 1,
    seed: int = 0,
) -> Forecast:
    """Return the forecasts from N histories as N windows, equal to :meth:`TrackHistory.forecast` of each.

    Args:
        tracks: the histories.
        predictor: the predictor; a ``batched`` one predicts histories with equally many rows in one call.
        seconds: time to predict [s].
        steps: time between rows of each [s], None: between its two newest rows.
        walls: walls of the stage.
        samples: number of futures.
        seed: random seed.

    Raises:
        InputError: as :meth:`TrackHistory.forecast`, or the time steps differ.
    """
    if problem := forecast_problem(predictor, seconds):
        raise InputError(problem)
    pasts = [track.windows(step, walls) for track, step in zip(tracks, steps, strict=True)]
    dt, largest = pasts[0].dt, max(past.present.shape[2] for past in pasts)
    if any(abs(past.dt - dt) > SAME for past in pasts):
        raise InputError(f"forecast: the time steps differ, from {min(past.dt for past in pasts):g} s; give dt")
    groups: dict[tuple[float, int], list[int]] = {}
    for k, past in enumerate(pasts):
        groups.setdefault((past.dt, past.position.shape[1]) if predictor.batched else (float(k), -1), []).append(k)
    found: dict[int, Forecast] = {}
    for rows in groups.values():
        part = _predict(
            [pasts[k] for k in rows], predictor, math.ceil(seconds / pasts[rows[0]].dt - SAME), samples, seed
        )
        found |= {k: part[j : j + 1] for j, k in enumerate(rows)}
    return _join([found[k] for k in range(len(pasts))], largest)


def _predict(pasts: Sequence[Windows], predictor: Predictor, steps: int, samples: int, seed: int) -> Forecast:
    """Return the forecasts from windows with equally many rows."""
    streams = [stream(seed, "forecast", int(past.frame[0, -1])) for past in pasts]
    if len(pasts) == 1:
        return predictor.predict(pasts[0], steps, samples, streams[0])
    most = max(past.present.shape[2] for past in pasts)

    def joined(name: str, axis: int, fill: Any) -> NDArray[Any]:
        rows = []
        for past in pasts:
            value = getattr(past, name)
            pad = [(0, 0)] * value.ndim
            pad[axis] = (0, most - value.shape[axis])
            rows.append(np.pad(value, pad, constant_values=fill))
        return np.concatenate(rows)

    whole = dataclasses.replace(
        pasts[0],
        position=joined("position", 2, 0.0),
        present=joined("present", 2, False),
        scored=joined("scored", 1, False),
        robot=joined("robot", 1, False),
        id=joined("id", 1, -1),
        frame=np.concatenate([past.frame for past in pasts]),
    )
    seeds: Any = _WindowSeeds(np.array([rng.integers(0, SEEDS, size=1)[0] for rng in streams]))
    return predictor.predict(whole, steps, samples, seeds)


def _join(parts: Sequence[Forecast], agents: int) -> Forecast:
    """Return forecasts as the windows of one, padded to the number of agents, futures and rows of the largest."""
    K, T = (max(part.position.shape[axis] for part in parts) for axis in (1, 2))
    shapes = {
        "position": (K, T, agents, 2), "weight": (K,), "valid": (agents,), "covariance": (T, agents, 2, 2),
        "existence": (agents,), "out_of_distribution": (agents,), "person_weight": (K, agents),
        "future_covariance": (K, T, agents, 2, 2),
    }  # fmt: skip
    joined: dict[str, Any] = {}
    for name, shape in shapes.items():
        values = [getattr(part, name) for part in parts]
        if any(value is None for value in values):
            continue
        joined[name] = np.zeros((len(parts), *shape), dtype=values[0].dtype)
        for row, value in zip(joined[name], values, strict=True):
            inside = value[0][tuple(map(slice, shape))]
            row[tuple(map(slice, inside.shape))] = inside
    return Forecast(dt=parts[0].dt, predictor=parts[0].predictor, **joined)
