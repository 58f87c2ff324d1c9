"""RobotRecording: a recording of a robot or vehicle among people, as a log for metrics."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import DataError, check_number
from crowdbot.data import Recording, Trajectories
from crowdbot.metrics import AgentLog, NavigationMetrics, RobotLog, log_metrics
from crowdbot.typing import Floats

from .run_metrics import REGIONS

LONGEST_GAP = 2.0
"""Longest gap in a track [s] that is interpolated."""
PERSON_RADIUS = 0.25


@dataclass(frozen=True, eq=False)
class RobotRecording:
    """A recording of one robot among people, sampled at equal times while the robot is there.

    Fields:
        name: name of the recording.
        agents: states of all agents; column 0 is the robot.
        ends: ``[A, 2]`` last positions of the whole tracks [m], also after the robot has left.
        radius: radius of the robot [m].
        goal: ``[2]`` goal [m] (default of the loader: last position of the robot).
        tolerance: distance below which the goal is reached [m].
        mass, height: of the robot [kg], [m]; NaN if unknown.
        walls: rings ``[N, 2]`` [m].
    """

    name: str
    agents: AgentLog
    ends: Floats
    radius: float
    goal: Floats
    tolerance: float
    mass: float
    height: float
    walls: tuple[Floats, ...] = ()

    def log(self) -> RobotLog:
        """Return the log of the robot, up to its goal."""
        return RobotLog.of(
            self.agents,
            0,
            self.goal,
            self.tolerance,
            walls=self._segments(),
            max_speed=float(np.hypot(*self.agents.velocity[:, 0].T).max()),
            mass=self.mass,
            height=self.height,
            regions=REGIONS,
            path=np.stack([self.agents.position[0, 0], self.goal]) if not self.walls else None,
        )

    def metrics(self) -> dict[str, float]:
        """Return the metrics of navigation and of all families that need one log."""
        base = NavigationMetrics(0, self.radius, self.goal, self.tolerance, walls=self._segments())
        base.update_log(self.agents, np.zeros(len(self.agents.times), dtype=np.bool_))
        return base.result() | log_metrics(self.log())

    def _segments(self) -> Floats:
        parts = [np.concatenate([ring, np.roll(ring, -1, axis=0)], axis=1) for ring in self.walls]
        return np.concatenate(parts) if parts else np.zeros((0, 4))


def load_robot_recording(
    path: Path | str | Recording,
    robot_file: Path | str | Recording | None = None,
    *,
    robot: int | None = None,
    radius: float = 0.3,
    goal: Sequence[float] | None = None,
    tolerance: float = 0.3,
    mass: float = math.nan,
    height: float = math.nan,
    step: float = 0.1,
    **options: Any,
) -> RobotRecording:
    """Load a recording of a robot among people.

    Velocities are differences of positions over one step.

    Args:
        path: recording of people, and of the robot unless ``robot_file`` has it; any format
            of :func:`crowdbot.data.load`.
        robot_file: recording of the robot, on the same clock: with the same times, or the same frames in files without
            times.
        robot: id of the robot (default: the robot of the recording, or the only track of ``robot_file``).
        radius: radius of the robot [m].
        goal: goal of the robot [m] (default: its last position).
        tolerance: distance below which the goal is reached [m].
        mass, height: of the robot [kg], [m], for severities.
        step: time step of the log [s].
        options: how paths are read, fields of :class:`crowdbot.data.Recording`: ``fps``, ``format``, ``units``,
            ``columns``, ``transform``, ... A :class:`crowdbot.data.Recording` has its own. Cyclists and cars count as
            people unless ``agents="pedestrians"``.

    Raises:
        InputError: a number is out of range.
        DataError: a file cannot be read, or it does not say who the robot is.
    """
    check_number("recording", "radius", radius, "m", exclusive_min=0.0)
    check_number("recording", "step", step, "s", exclusive_min=0.0)
    source, *other = (_recording(item, options) for item in (path, robot_file) if item is not None)
    people = _metres(source.original)
    vehicle = _metres(other[0].original) if other else people
    who = _robot_id(vehicle, robot, robot_file is not None)
    own = np.flatnonzero(vehicle.id == who)
    start = vehicle.clock[own[0]]
    times = vehicle.clock[own] - start
    moments = times[0] + step * np.arange(math.floor((times[-1] - times[0]) / step + 1e-6) + 1)
    if len(moments) < 3:
        raise DataError(
            f"{vehicle.name}: robot {who} has {times[-1] - times[0]:.2g} s, too short for steps of {step:g} s"
        )
    tracks = [(times, vehicle.position[own])]
    for item in people.ids.tolist():
        rows = np.flatnonzero(people.id == item)
        if item in people.robots or (robot_file is None and item == who):
            continue
        tracks.append((people.clock[rows] - start, people.position[rows]))
    agents, ends = _agents(tracks, moments, radius)
    end = agents.position[-1, 0] if goal is None else np.asarray(goal, dtype=np.float64)
    return RobotRecording(
        Path(source.path).stem, agents, ends, radius, end, tolerance, mass, height, tuple(people.walls)
    )


def _recording(path: Path | str | Recording, options: dict[str, Any]) -> Recording:
    return path if isinstance(path, Recording) else Recording(str(path), **{"agents": "all", **options})


def _metres(tracks: Trajectories) -> Trajectories:
    return tracks if tracks.units == "m" else tracks.metres()


def _robot_id(vehicle: Trajectories, robot: int | None, alone: bool) -> int:
    known = sorted(vehicle.robots) or (vehicle.ids.tolist() if alone else [])
    if robot is not None:
        if robot not in vehicle.ids:
            raise DataError(f"{vehicle.name} has no track of id {robot}")
        return robot
    if len(known) != 1:
        count = "no robot" if not known else f"{len(known)} robots"
        raise DataError(f"{vehicle.name} has {count}; name one by its id (--robot-id), or give its file (--robot-file)")
    return int(known[0])


def _agents(tracks: Sequence[tuple[Floats, Floats]], moments: Floats, radius: float) -> tuple[AgentLog, Floats]:
    """Return the states of all tracks at the moments, and the ends of the tracks ``[A, 2]``.

    A person is absent outside of the track and in long gaps.
    """
    shape = (len(moments), len(tracks))
    position, active = np.zeros((*shape, 2)), np.zeros(shape, dtype=np.bool_)
    for k, (times, place) in enumerate(tracks):
        inside = (moments >= times[0] - 1e-9) & (moments <= times[-1] + 1e-9)
        after = np.clip(np.searchsorted(times, moments), 1, max(1, len(times) - 1))
        gap = times[after] - times[after - 1] if len(times) > 1 else np.zeros(len(moments))
        active[:, k] = inside & (gap <= LONGEST_GAP)
        position[:, k] = np.stack([np.interp(moments, times, place[:, axis]) for axis in range(2)], axis=1)
    keep = np.asarray(active.any(axis=0)) | (np.arange(len(tracks)) == 0)
    ends = np.array([place[-1] for _, place in tracks])[keep]
    position, active = position[:, keep], active[:, keep]
    step = moments[1] - moments[0]
    change = np.diff(position, axis=0) / step
    steady = active[1:] & active[:-1]
    velocity = np.zeros_like(position)
    velocity[1:] = np.where(steady[..., None], change, 0.0)
    entered = active & ~np.concatenate([np.zeros_like(active[:1]), active[:-1]])
    later = np.concatenate([velocity[1:], np.zeros_like(velocity[:1])])
    velocity = np.where(entered[..., None], later, velocity)
    heading = np.arctan2(velocity[..., 1], velocity[..., 0])
    size = np.full(active.shape, PERSON_RADIUS)
    size[:, 0] = radius
    place = np.where(active[..., None], position, 0.0)
    return AgentLog(moments - moments[0], place, velocity, heading, size, active), ends
