"""Values of whole crowds for many parameter sets at once: single file, corridors, flows through doors and queues."""

from __future__ import annotations

import dataclasses
from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from crowdbot.models import CrowdModel
from crowdbot.typing import Floats
from crowdbot.validation.bottleneck import bottleneck_flow
from crowdbot.validation.corridor import corridor_crowd
from crowdbot.validation.crowd_motion import each_start, simulate_periodic
from crowdbot.validation.evacuation import CORNER_CROWD, DEPTH, DOOR_PEOPLE, LIMIT, TWO_ROOMS, corner_walks, hall_walks
from crowdbot.validation.scenario import FREE_SPEED, SPECIFIC_FLOW, STEP, line_speed, stream_of, weidmann_speed
from crowdbot.validation.single_file import LENGTH, file_crowd

__all__ = ["CrowdValues", "measure_crowds", "with_sets"]

FILE_DENSITIES = (0.5, 1.0, 1.5, 2.0)
"""People per metre."""
CORRIDOR_DENSITIES = (2.0,)
"""People per square metre of the one-way corridor, 12 m long and 3 m wide."""
CORRIDOR = (12.0, 3.0)
TWO_WAY = (12.0, 2.0, 2.0)
"""Length and width of the narrow two-way corridor [m], and people per square metre."""
SECONDS, LAST = 25.0, 10.0
"""Duration of the periodic runs and part of it that is measured [s]."""
DOORS = (0.8, 1.6)
"""Widths of the bottlenecks [m]."""
PEOPLE = 60
POOR = 4.0
"""Penalty on periodic tracks above which doors and rooms, the expensive part, are not run."""


class CrowdValues(NamedTuple):
    """Values of one parameter set.

    Fields:
        single_file: root mean square deviation from the published line of single file [m/s].
        corridor: root mean square deviation from Weidmann's curve [m/s].
        flow: specific flow through bottlenecks [1/(m s)].
        two_way: mean forward speed in a narrow two-way corridor, relative to the free speed.
        queues: people who queue before a corridor and at an exit as wide as it (RiMEA 12).
        corner: time of a crowd around a wide corner (RiMEA 15) [s].
        stuck: share of people who do not get through the two rooms, or out of a hall by two doors (RiMEA 9).
    """

    single_file: float
    corridor: float
    flow: float
    two_way: float
    queues: tuple[float, float]
    corner: float
    stuck: float

    @property
    def penalty(self) -> float:
        """Sum of the distances from the limits of the checks, in their units of tolerance; 0 if all are held.

        >>> CrowdValues(0.05, 0.1, SPECIFIC_FLOW, 0.7, (28.0, 2.0), 40.0, 0.0).penalty
        0.0
        """
        above = (
            (self.single_file - 0.12) / 0.1,
            (self.corridor - 0.20) / 0.1,
            (abs(self.flow - SPECIFIC_FLOW) - 0.15) / 0.1,
            (0.2 - self.two_way) / 0.2,
            (self.queues[1] - 3.0) / 2.0,
            (8.0 - self.queues[0]) / 2.0,
            (self.corner - 47.0) / 3.0,
            self.stuck / 0.05,
        )
        return float(sum(max(0.0, item) for item in above))


NOT_RUN = CrowdValues(0.0, 0.0, 0.0, 1.0, (0.0, 20.0), 60.0, 1.0)
"""Values of sets without runs of doors and rooms."""


def with_sets(model: CrowdModel, sets: Sequence[Mapping[str, float]], copies: int = 1) -> CrowdModel:
    """Return the model for S x copies environments, the sets repeated ``copies`` times in a row.

    >>> from crowdbot.models import People
    >>> with_sets(People(), [{"strength": 2.0}, {"strength": 3.0}], 2).strength.tolist()
    [[2.0], [3.0], [2.0], [3.0]]
    """
    names = sets[0] if sets else ()
    values: dict[str, Any] = {name: np.tile([float(set_[name]) for set_ in sets], copies)[:, None] for name in names}
    return dataclasses.replace(model, **values)


def measure_crowds(model: CrowdModel, sets: Sequence[Mapping[str, float]], start: int = 0) -> list[CrowdValues]:
    """Return the values of S parameter sets, all of them with the same start.

    Args:
        model: crowd model.
        sets: values of parameters that differ from those of the model.
        start: number of the start: initial positions and free speeds.
    """
    tracks = zip(_file(model, sets, start), _corridor(model, sets, start), _two_way(model, sets, start), strict=True)
    crowd_values = [NOT_RUN._replace(single_file=float(a), corridor=float(b), two_way=float(c)) for a, b, c in tracks]
    good = [k for k, one in enumerate(crowd_values) if one.penalty - NOT_RUN.penalty <= POOR]
    for k, door in zip(good, _doors(model, [sets[k] for k in good], start), strict=True):
        crowd_values[k] = crowd_values[k]._replace(**door)
    return crowd_values


def _ignore(share: float) -> None:
    """Report nothing."""


def _doors(model: CrowdModel, sets: Sequence[Mapping[str, float]], start: int) -> list[dict[str, Any]]:
    """Return flow, queues and stuck share of each set."""
    if not sets:
        return []
    numbers, each = [start] * len(sets), with_sets(model, sets)
    flow = np.mean([np.asarray(bottleneck_flow(each, door, PEOPLE, numbers, STEP)) / door for door in DOORS], axis=0)
    rooms = TWO_ROOMS.run(each, numbers, False, _ignore)
    hall = hall_walks(each, DOOR_PEOPLE, (-1.0,), [start + 1] * len(sets), LIMIT, _ignore)
    y = hall.position[..., 1]
    left = np.any(((y < -0.5) | (y > DEPTH + 0.5)) & hall.present, axis=0).mean(axis=1)
    corner, _ = corner_walks(each, "corner", CORNER_CROWD, numbers, 120.0, _ignore)
    seconds = [float(walk.times[-1]) for walk in each_start(corner)]
    return [
        {
            "flow": float(flow[s]),
            "queues": (float(row["queues"][0]), float(row["queues"][1])),
            "corner": seconds[s],
            "stuck": max(1.0 - row["out"] / row["people"], 1.0 - float(left[s])),
        }
        for s, row in enumerate(rooms)
    ]


def _file(model: CrowdModel, sets: Sequence[Mapping[str, float]], start: int) -> Floats:
    """Return the deviations ``[S]`` of single file."""
    runs = [(round(density * LENGTH), start) for density in FILE_DENSITIES for _ in sets]
    speed = _speeds(model, sets, file_crowd(runs), LENGTH, len(FILE_DENSITIES))
    return _deviation(speed, line_speed(FILE_DENSITIES))


def _corridor(model: CrowdModel, sets: Sequence[Mapping[str, float]], start: int) -> Floats:
    """Return the deviations ``[S]`` in a one-way corridor."""
    runs = [("one-way", density, start) for density in CORRIDOR_DENSITIES for _ in sets]
    crowd = corridor_crowd(runs, *CORRIDOR, two_way=False, spread=0.05)
    speed = _speeds(model, sets, crowd, CORRIDOR[0], len(CORRIDOR_DENSITIES))
    return _deviation(speed, weidmann_speed(CORRIDOR_DENSITIES))


def _two_way(model: CrowdModel, sets: Sequence[Mapping[str, float]], start: int) -> Floats:
    """Return the relative forward speeds ``[S]`` in a narrow two-way corridor."""
    length, width, density = TWO_WAY
    crowd = corridor_crowd([("narrow", density, start) for _ in sets], length, width, two_way=True, spread=0.26)
    return np.asarray(_speeds(model, sets, crowd, length, 1)[0] / FREE_SPEED)


def _speeds(model: CrowdModel, sets: Sequence[Mapping[str, float]], crowd: Any, length: float, copies: int) -> Floats:
    """Return the mean forward speeds ``[copies, S]`` at the end of a run on a periodic track [m/s]."""
    rng = stream_of("population", "model")
    walk = simulate_periodic(with_sets(model, sets, copies), crowd, length, SECONDS, rng, lambda part: None, STEP)
    first = int(np.searchsorted(walk.times, walk.times[-1] - LAST - 1e-9))
    way = (walk.position[-1] - walk.position[first])[..., 0] * np.sign(crowd.preferred_velocity[..., 0])
    here = crowd.active
    mean = np.sum(np.where(here, way, 0.0), axis=1) / here.sum(axis=1) / (walk.times[-1] - walk.times[first])
    return np.asarray(mean.reshape(copies, len(sets)))


def _deviation(speed: Floats, curve: Floats) -> Floats:
    return np.asarray(np.sqrt(np.mean((speed - curve[:, None]) ** 2, axis=0)))
