"""ScanScores: predicted scans of a log against the true ones, by horizon."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, Walls, check_number, stream
from crowdbot.evaluation.intervals import Estimate, bootstrap_estimate
from crowdbot.evaluation.tracking.reading_log import LoggedReading, ReadingLog
from crowdbot.metrics import (
    OccupancyGrid,
    occupancy_iou,
    range_error,
    scan_time_to_collision,
    structural_similarity,
    weighted_squared_error,
)
from crowdbot.perception import ScanForecast, ScanPredictor, TrackedScene, hide_walls, walk_straight
from crowdbot.sensors import Scan, planar_pose
from crowdbot.typing import Floats

WARM_UP = 1.0
"""Time of a log before the first forecast [s], if all scans are seen."""


@dataclass(frozen=True, kw_only=True)
class ScanProtocol:
    """Protocol of the evaluation of predictors of scans.

    Fields:
        horizons: times ahead [s]; each is rounded to a scan.
        every: time between forecasts [s].
        past: number of scans that a forecast sees; 0: all before, at least 1 s.
        grid: cells of the occupancy.
        known_motion: whether the future poses of the sensor are given, as from a plan; otherwise they are predicted.
        range_max: range that counts for missing returns [m].

    Raises:
        InputError: a value is not allowed.

    >>> ScanProtocol().horizons
    (0.1, 0.5, 1.0, 2.0, 3.0)
    """

    horizons: tuple[float, ...] = (0.1, 0.5, 1.0, 2.0, 3.0)
    every: float = 0.5
    past: int = 0
    grid: OccupancyGrid = field(default_factory=OccupancyGrid)
    known_motion: bool = True
    range_max: float = 10.0

    def __post_init__(self) -> None:
        if not self.horizons:
            raise InputError("ScanProtocol: horizons is empty, at least one time ahead is needed")
        for ahead in self.horizons:
            check_number("ScanProtocol", "horizons", ahead, "s", exclusive_min=0.0)
        check_number("ScanProtocol", "every", self.every, "s", exclusive_min=0.0)
        check_number("ScanProtocol", "past", self.past, min=0, whole=True)
        check_number("ScanProtocol", "range_max", self.range_max, "m", exclusive_min=0.0)

    def first(self, period: float) -> int:
        """Return the number of the scan of the first forecast, for the time between scans [s]."""
        return self.past - 1 if self.past else round(WARM_UP / period)

    def min_duration(self, period: float) -> float:
        """Return the shortest log with a forecast [s], for the time between scans [s].

        >>> SOGMP.min_duration(0.1)
        1.9
        """
        return round(self.first(period) * period + max(self.horizons), 9)


SOGMP = ScanProtocol(
    horizons=(0.1, 0.3, 0.5, 0.7, 1.0), past=10, grid=OccupancyGrid(dilation=0), known_motion=False
)  # fmt: skip
"""Protocol of Xie and Dames (2023), Stochastic occupancy grid map prediction in dynamic scenes.

10 past scans at 10 Hz, 64 x 64 cells of 0.1 m without dilation, motion of the robot predicted, up to 10 scans ahead
(https://proceedings.mlr.press/v229/xie23a.html).
"""


DEFAULT = ScanProtocol()
SCAN_SCORES = {
    "occupancy_iou": "",
    "range_error": "m",
    "time_to_collision_error": "s",
    "weighted_squared_error": "",
    "structural_similarity": "",
}
"""Scores with their units."""
WALL_MARGIN = 0.15
"""Points at most this far [m] from the walls of the stage are not dynamic."""
ROBOT_RADIUS = 0.3
"""Radius around the sensor [m] of the robot whose time to collision is predicted."""
LONGEST = 5.0
"""Largest time to collision [s]; later collisions and none count as this."""


@dataclass(frozen=True)
class TruePeople:
    """Reference, not a predictor: the true people and robots walk on with their true velocities.

    The surfaces are those of :class:`crowdbot.perception.TrackedScene`, which renders the scans.

    Fields:
        scene: renders the scans.
    """

    scene: TrackedScene

    def forecast(self, rows: Sequence[LoggedReading], ahead: Floats, pose: Pose | None) -> ScanForecast:
        """Return scans after the last of the rows."""
        last, before = ({**row.people, **row.others} for row in (rows[-1], rows[-2] if len(rows) > 1 else rows[-1]))
        passed = rows[-1].time - rows[-2].time if len(rows) > 1 else 1.0
        place = np.array(list(last.values())).reshape(-1, 2)
        earlier = np.array([before.get(who, xy) for who, xy in last.items()]).reshape(-1, 2)
        velocity = (place - earlier) / passed
        scans: list[Any] = [row.reading for row in rows[-self.scene.memory :]]
        return self.scene.render(scans, place, velocity, walk_straight(place, velocity, ahead)[None], ahead, pose)


@dataclass(frozen=True)
class ScanScores:
    """Scores of one predictor on several logs.

    Fields:
        values: ``[S, L, H]`` mean of each score over the forecasts of each log, by horizon.
        horizons: ``[H]`` [s].
    """

    values: Floats
    horizons: tuple[float, ...]

    def estimates(self, seed: int = 0) -> dict[str, list[Estimate]]:
        """Return the mean over logs with 95 % intervals by bootstrap, by score and horizon."""
        return {
            name: [bootstrap_estimate(self.values[s, :, h], seed=seed) for h in range(len(self.horizons))]
            for s, name in enumerate(SCAN_SCORES)
        }


def score_scans(
    logs: Sequence[ReadingLog],
    predictor: ScanPredictor | TruePeople,
    protocol: ScanProtocol = DEFAULT,
    *,
    samples: int = 1,
    seed: int = 0,
) -> ScanScores:
    """Return the scores of a predictor.

    Args:
        logs: logs of a planar scanner.
        predictor: the predictor, or the reference.
        protocol: horizons, past, occupancy and motion of the sensor.
        samples: number of futures.
        seed: seed of the samples.

    Raises:
        InputError: a log is too short, or is not of a planar scanner.
    """
    values = [_score_log(log, predictor, protocol, samples, seed) for log in logs]
    return ScanScores(np.stack(values, axis=1), tuple(float(horizon) for horizon in protocol.horizons))


def _score_log(
    log: ReadingLog, predictor: ScanPredictor | TruePeople, protocol: ScanProtocol, samples: int, seed: int
) -> Floats:
    """Return the means ``[S, H]`` over the forecasts of one log."""
    if not log.rows or not isinstance(log.rows[0].reading, Scan):
        raise InputError(f"{log.name}: {log.sensor} is not a planar laser scanner")
    time = np.array([row.time for row in log.rows])
    period = float(np.median(np.diff(time))) if len(time) > 1 else 0.1
    steps = np.maximum(1, np.rint(np.asarray(protocol.horizons) / period)).astype(np.int64)
    first, stride = protocol.first(period), max(1, round(protocol.every / period))
    starts = range(first, len(log.rows) - int(steps.max()), stride)
    if not starts:
        shortest = protocol.min_duration(period) + period
        raise InputError(f"{log.name}: {time[-1] - time[0]:.1f} s of scans; at least {shortest:.1f} s are needed")
    found = []
    for k, forecast in _forecasts(log, predictor, protocol, starts, steps, samples, seed):
        future = [_scan(log.rows[k + int(step)]) for step in steps]
        pose = _poses(future)
        velocity = _velocity([_scan(log.rows[k + int(step) - 1]) for step in steps], future, pose)
        found.append(_compare(future, forecast, pose, velocity, log.walls, protocol))
    with np.errstate(invalid="ignore"):
        return np.asarray(_mean(np.stack(found)))


def _forecasts(
    log: ReadingLog, predictor: ScanPredictor | TruePeople, protocol: ScanProtocol, starts: Sequence[int],
    steps: NDArray[np.int64], samples: int, seed: int,
) -> Iterator[tuple[int, ScanForecast]]:  # fmt: skip
    """Yield each start and the forecast from there."""
    rng, past = stream(seed, "predict"), protocol.past
    time = np.array([row.time for row in log.rows])
    state = None if isinstance(predictor, TruePeople) or past else predictor.begin()
    seen = 0
    for k in starts:
        ahead = time[k + steps] - time[k]
        known = _poses([_scan(log.rows[k + int(step)]) for step in steps]) if protocol.known_motion else None
        if isinstance(predictor, TruePeople):
            yield k, predictor.forecast(log.rows[: k + 1], ahead, known)
            continue
        if past:
            state, seen = predictor.begin(), k + 1 - past
        for row in log.rows[seen : k + 1]:
            state = predictor.update(_scan(row), state)
        seen = k + 1
        yield k, predictor.forecast(state, ahead, known, samples, rng)


def _mean(values: Floats) -> Floats:
    """Return the mean over the first axis without NaN; NaN without values."""
    there = np.isfinite(values)
    return np.asarray(np.where(there, values, 0.0).sum(axis=0) / np.where(there.any(axis=0), there.sum(axis=0), np.nan))


def _scan(row: LoggedReading) -> Scan:
    assert isinstance(row.reading, Scan)
    return row.reading


def _poses(scans: Sequence[Scan]) -> Pose:
    poses = [planar_pose(scan.pose) for scan in scans]
    return Pose(np.concatenate([p.position for p in poses]), np.concatenate([p.heading for p in poses]))


def _velocity(before: Sequence[Scan], future: Sequence[Scan], pose: Pose) -> Floats:
    """Return the velocity ``[H, 2]`` of the sensor in its own frame [m/s], from the true scans before."""
    passed = np.array([float(np.max(b.time)) - float(np.max(a.time)) for a, b in zip(before, future, strict=True)])
    way = (pose.position - _poses(before).position) / passed[:, None]
    cos, sin = np.cos(pose.heading), np.sin(pose.heading)
    return np.stack([cos * way[:, 0] + sin * way[:, 1], cos * way[:, 1] - sin * way[:, 0]], axis=-1)


def _compare(
    future: Sequence[Scan], forecast: ScanForecast, pose: Pose, velocity: Floats, walls: Walls, protocol: ScanProtocol
) -> Floats:
    """Return the scores ``[S, H]`` of one forecast."""
    grid, ranges = protocol.grid, np.stack([scan.ranges[0] for scan in future])
    limit = np.where(np.isfinite(ranges) & (ranges > 0.0), ranges, np.inf)
    predicted = np.where(forecast.ranges <= protocol.range_max, forecast.ranges, np.inf)
    truth = grid.occupied(_dynamic_points(limit[None], pose, forecast.angles, walls)[0])
    cells = grid.occupied(_dynamic_points(predicted, forecast.pose, forecast.angles, walls))
    chance = np.einsum("k,ktxy->txy", forecast.weight, cells.astype(np.float64))
    error = np.einsum("k,kt->t", forecast.weight, range_error(limit[None], forecast.ranges, protocol.range_max))
    till, expected = (
        scan_time_to_collision(_points(item, forecast.angles), velocity, ROBOT_RADIUS, LONGEST)
        for item in (limit[None], predicted)
    )
    return np.stack(
        [
            occupancy_iou(truth, chance),
            error,
            np.einsum("k,kt->t", forecast.weight, np.abs(till - expected)),
            weighted_squared_error(truth, chance),
            structural_similarity(truth, chance),
        ]
    )


def _points(ranges: Floats, angles: Floats) -> Floats:
    """Return the end points ``[K, T, R, 2]`` in the sensor frame [m], NaN without a return."""
    away = np.where(np.isfinite(ranges), ranges, np.nan)
    return np.asarray(away[..., None] * np.stack([np.cos(angles), np.sin(angles)], axis=-1))


def _dynamic_points(ranges: Floats, pose: Pose, angles: Floats, walls: Walls) -> Floats:
    """Return the end points ``[K, T, R, 2]`` in the sensor frame that are not on walls of the stage; NaN otherwise."""
    away, points = np.where(np.isfinite(ranges), ranges, np.nan), _points(ranges, angles)
    bearing = pose.heading[:, None] + angles
    world = pose.position[:, None] + away[..., None] * np.stack([np.cos(bearing), np.sin(bearing)], axis=-1)
    use = np.isfinite(away)
    if len(walls):
        flat, kept = np.ascontiguousarray(world.reshape(-1, 2)), np.ascontiguousarray(use.reshape(-1))
        hide_walls(flat, np.ascontiguousarray(walls.segments()), WALL_MARGIN, kept)
        use = kept.reshape(use.shape)
    return np.asarray(np.where(use[..., None], points, np.nan))
