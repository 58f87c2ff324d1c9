"""Table of the people of an episode: one row for each person."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Floats

from .agent_states import AgentLog
from .contacts import contact_events
from .motion import jerk
from .proximity import ZONES, clearance, swept_clearance

PEOPLE_COLUMNS: dict[str, tuple[str, str]] = {
    "id": ("1", "id of the person"),
    "begin": ("s", "time of the first record of the person"),
    "end": ("s", "time of the last record of the person"),
    "time_present": ("s", "total time between consecutive records with the person"),
    "left": ("1", "1 if the person left before the last record, at the goal or in an exit, otherwise 0"),
    "time_to_leave": ("s", "time from the first to the last record if the person left, otherwise NaN"),
    "distance_walked": ("m", "sum of |p_k+1 - p_k| over consecutive records"),
    "mean_speed": ("m/s", "mean norm of the velocity in the records"),
    "max_speed": ("m/s", "maximum norm of the velocity in the records"),
    "mean_jerk": ("m/s3", "mean norm of the second difference of the velocity, as for robots; NaN with gaps"),
    "min_clearance": ("m", "minimum clearance to any robot (swept); NaN without robots"),
    "intrusion_time": ("s", "time in which a robot is in the personal space, below 1.2 m clearance"),
    "contacts": ("1", "number of contacts with robots, by discs as in the metrics of robots"),
    "contact_time": ("s", "total duration of these contacts"),
    "peak_force": ("N", "maximum force of an impact by a robot; 0 without impact, NaN in the planar world"),
    "max_severity": ("1", "maximum severity of an impact by a robot; 0 without impact, NaN in the planar world"),
}
"""Unit and definition of each column of :func:`people_table`; with several robots, ``NAME.min_clearance`` follow."""


class TableRobot(NamedTuple):
    """A robot of a table of people: its id, its name, and whether it is a ghost, which has no contacts."""

    id: int
    name: str
    ghost: bool = False


class PersonImpact(NamedTuple):
    """An impact of a robot on a person: its id, the peak force [N] and the severity."""

    person: int
    peak_force: float
    severity: float


def people_table(
    log: AgentLog, robots: Sequence[TableRobot], impacts: Iterable[PersonImpact] | None = None
) -> dict[str, NDArray[Any]]:
    """Return the columns of :data:`PEOPLE_COLUMNS` with one row for each person who is in at least one record.

    Args:
        log: people and robots, with ids as columns.
        robots: robots in the log.
        impacts: impacts of robots on people; None in the planar world.

    >>> place = np.zeros((3, 2, 2)); place[:, 1, 0] = [2.0, 1.0, 2.0]
    >>> still, disc = np.zeros((3, 2)), np.full((3, 2), 0.25)
    >>> log = AgentLog(np.arange(3.0), place, 0 * place, still, disc, np.ones((3, 2), bool))
    >>> table = people_table(log, [TableRobot(0, "robot")])
    >>> table["id"].tolist(), table["distance_walked"].tolist(), table["min_clearance"].tolist()
    ([1], [2.0], [0.5])
    """
    machines = {robot.id for robot in robots}
    people = np.array([k for k in np.flatnonzero(log.active.any(axis=0)).tolist() if k not in machines], dtype=np.int64)
    rows = [_motion(log, int(person)) for person in people]
    columns: dict[str, NDArray[Any]] = {"id": people}
    for name in ("begin", "end", "time_present", "left", "time_to_leave", "distance_walked"):
        columns[name] = np.array([row[name] for row in rows], dtype=np.float64)
    for name in ("mean_speed", "max_speed", "mean_jerk"):
        columns[name] = np.array([row[name] for row in rows], dtype=np.float64)
    near, more = _nearness(log, robots, people)
    return {**columns, **near, **_impacts(people, impacts), **more}


def _motion(log: AgentLog, person: int) -> dict[str, float]:
    here = np.flatnonzero(log.active[:, person])
    times, place, velocity = log.times[here], log.position[here, person], log.velocity[here, person]
    joined = np.diff(here) == 1
    step, speed = np.diff(place, axis=0)[joined], np.hypot(velocity[:, 0], velocity[:, 1])
    left = here[-1] < len(log.times) - 1
    jerks = jerk(times, velocity) if joined.all() else np.zeros(0)
    return {
        "begin": float(times[0]),
        "end": float(times[-1]),
        "time_present": float(np.sum(np.diff(times)[joined])),
        "left": float(left),
        "time_to_leave": float(times[-1] - times[0]) if left else math.nan,
        "distance_walked": float(np.sum(np.hypot(step[:, 0], step[:, 1]))),
        "mean_speed": float(np.mean(speed)),
        "max_speed": float(np.max(speed)),
        "mean_jerk": float(np.mean(jerks)) if len(jerks) else math.nan,
    }


def _nearness(
    log: AgentLog, robots: Sequence[TableRobot], people: NDArray[np.int64]
) -> tuple[dict[str, Floats], dict[str, Floats]]:
    """Return the columns of all robots together, and the smallest clearance to each of several robots."""
    radius = np.where(log.active, log.radius, 0.0).max(axis=0, initial=0.0)
    least: list[Floats] = []
    count, time = np.zeros(len(people)), np.zeros(len(people))
    close = np.zeros((len(log.times), len(people)), dtype=np.bool_)
    for robot in robots:
        gap = clearance(log.position, radius, log.active, robot.id)[:, people]
        swept = swept_clearance(log.times, log.position, radius, log.active, robot.id)[:, people]
        least.append(swept.min(axis=0, initial=math.inf))
        close |= gap < ZONES["personal"]
        if robot.ghost:
            continue
        met = np.append(people[least[-1] < 0.0], robot.id)
        few = (log.position[:, met], log.velocity[:, met], radius[met], log.active[:, met])
        for event in contact_events(log.times, *few, len(met) - 1) if len(met) > 1 else ():
            row = np.searchsorted(people, met[event.person])
            count[row] += 1.0
            time[row] += event.end - event.begin
    found = {
        "min_clearance": np.min(least, axis=0) if least else np.full(len(people), math.nan),
        "intrusion_time": np.sum(close[1:] * np.diff(log.times)[:, None], axis=0),
        "contacts": count,
        "contact_time": time,
    }
    each = {f"{robot.name}.min_clearance": row for robot, row in zip(robots, least, strict=True)}
    return found, each if len(robots) > 1 else {}


def _impacts(people: NDArray[np.int64], impacts: Iterable[PersonImpact] | None) -> Mapping[str, Floats]:
    force, severity = (np.full(len(people), math.nan if impacts is None else 0.0) for _ in range(2))
    rows = {person: k for k, person in enumerate(people.tolist())}
    for impact in impacts or ():
        if impact.person in rows:
            row = rows[impact.person]
            force[row], severity[row] = np.fmax(force[row], impact.peak_force), np.fmax(severity[row], impact.severity)
    return {"peak_force": force, "max_severity": severity}
