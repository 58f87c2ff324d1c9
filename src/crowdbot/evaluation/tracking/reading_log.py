"""ReadingLog: the readings of one sensor with the true people at the same instants."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError, Walls, did_you_mean
from crowdbot.perception import Detector
from crowdbot.recording import iterate_steps, read_episode
from crowdbot.sensors import Reading
from crowdbot.simulation import Simulation, SimulationRun, StepRecord
from crowdbot.trials import Trial, check_trial, parse_trial

MIN_BEAMS = 3
"""People who return fewer beams are hidden: they need not be found."""


@dataclass(frozen=True)
class LoggedReading:
    """One reading, and who was there.

    Fields:
        reading: reading of one environment.
        people: true positions x, y [m] by id.
        beams: number of beams that returned from each id.
        others: positions of the other robots [m] by id; they need not be found.
        robot: x, y [m] of the robot itself.
    """

    reading: Reading
    people: dict[int, tuple[float, float]]
    beams: dict[int, int]
    others: dict[int, tuple[float, float]]
    robot: tuple[float, float]

    @property
    def time(self) -> float:
        """Time of the reading [s]."""
        return float(np.max(self.reading.time))

    def hidden_ids(self, min_beams: int = MIN_BEAMS) -> list[int]:
        """Return the ids of those who need not be found."""
        return [who for who in self.people if self.beams.get(who, 0) < min_beams] + list(self.others)


@dataclass(frozen=True)
class ReadingLog:
    """The readings of one sensor in one run.

    Fields:
        name: name of the trial or of the file.
        seed: seed of the run.
        sensor: ``robot/sensor``.
        walls: walls of the stage.
        rows: readings with the true people, in the order of time.
    """

    name: str
    seed: int
    sensor: str
    walls: Walls
    rows: tuple[LoggedReading, ...]


class _Sink:
    """Keeps the readings of one sensor and the scenes at their instants."""

    def __init__(self, trial: Trial, sensor: str) -> None:
        self.robot, _, self.name = sensor.partition("/")
        self.count = len(trial.robots)
        self.scenes: dict[int, dict[int, tuple[float, float]]] = {}
        self.robots: set[int] = set()
        self.own = -1
        self.readings: list[Reading] = []

    def take(self, frame: StepRecord) -> None:
        """Keep the record of a step."""
        there = np.flatnonzero(frame.scene.active[0])
        self.scenes[frame.nanoseconds] = {
            int(frame.ids[a]): (float(frame.scene.position[0, a, 0]), float(frame.scene.position[0, a, 1]))
            for a in there
        }
        self.robots.update(frame.robot_ids)
        for robot, number in zip(frame.robots, frame.robot_ids, strict=True):
            self.own = number if robot.name == self.robot else self.own
        self.readings += [
            reading for robot, mount, reading in frame.readings if (robot.name, mount.name) == (self.robot, self.name)
        ]

    def rows(self) -> Iterator[LoggedReading]:
        """Yield the readings at whose instants the scene is known."""
        for reading in self.readings:
            scene = self.scenes.get(round(float(np.max(reading.time)) * 1e9))
            if scene is not None:
                people = {who: place for who, place in scene.items() if who not in self.robots}
                others = {who: place for who, place in scene.items() if who in self.robots and who != self.own}
                yield LoggedReading(reading, people, _count_beams(reading), others, scene[self.own])


def log_readings(trial: Trial, seed: int, detector: Detector, sensor: str = "") -> ReadingLog:
    """Run a trial and return the readings of one of its sensors.

    Args:
        trial: the trial.
        seed: seed of the run.
        detector: detector that shall understand the readings.
        sensor: ``robot/sensor``; default: the first one that the detector understands.

    Raises:
        InputError: no robot has such a sensor.
        TrialError: the trial is impossible.
    """
    check_trial(trial, seed)
    names = [f"{robot.name}/{mount.name}" for robot in trial.robots for mount in robot.sensors]
    sink = _Sink(trial, _chosen(sensor, names, trial.name) if sensor else _first_fitting(trial, detector))
    running = SimulationRun(Simulation(trial, seed), [sink])
    while running.outcome is None:
        running.step()
    end = running.ends[0]
    if end is not None and end.failure is not None:
        raise InputError(f"trial {trial.name!r} ended with an error: {end.failure}")
    rows = tuple(sink.rows())
    _check_rows(rows, detector, f"{sink.robot}/{sink.name}", trial.name)
    return ReadingLog(trial.name, seed, f"{sink.robot}/{sink.name}", trial.stage.as_walls(), rows)


def read_readings(path: Path | str, detector: Detector, sensor: str = "") -> ReadingLog:
    """Return the readings of one sensor in an episode file.

    Readings at instants without recorded people are left out.

    Args:
        path: file of ``crowdbot run --out``.
        detector: detector that shall understand the readings.
        sensor: ``robot/sensor``; default: the first one that the detector understands.

    Raises:
        EpisodeError: the file is not an episode.
        InputError: the episode has no such readings.
    """
    episode = read_episode(path)
    trial = parse_trial(episode.xml)
    rows: list[LoggedReading] = []
    chosen, names = sensor, set[str]()
    for step in iterate_steps(path):
        names |= set(step.readings)
        if not chosen:
            chosen = next((name for name, reading in step.readings.items() if isinstance(reading, detector.reads)), "")
        reading = step.readings.get(chosen)
        if reading is None or step.people is None:
            continue
        people = {
            int(who): (float(x), float(y)) for who, (x, y) in zip(step.people.ids, step.people.position, strict=True)
        }
        own = chosen.partition("/")[0]
        others = {-10 - k: (item.x, item.y) for k, (name, item) in enumerate(step.robots.items()) if name != own}
        robot = step.robots[own]
        rows.append(LoggedReading(reading, people, _count_beams(reading), others, (robot.x, robot.y)))
    if not rows:
        _chosen(sensor, sorted(names), Path(path).name)
    _check_rows(tuple(rows), detector, chosen, Path(path).name)
    return ReadingLog(Path(path).name, episode.seed, chosen, trial.stage.as_walls(), tuple(rows))


def _chosen(sensor: str, names: Sequence[str], where: str) -> str:
    if sensor in names and sensor:
        return sensor
    known = f"it has {', '.join(names)}" if names else "it has no readings"
    raise InputError(f"{where}: there is no sensor {sensor!r}{did_you_mean(sensor, names)}; {known}")


def _first_fitting(trial: Trial, detector: Detector) -> str:
    kinds = {kind.__name__ for kind in detector.reads}
    for robot in trial.robots:
        for mount in robot.sensors:
            if READINGS.get(type(mount.sensor).__name__) in kinds:
                return f"{robot.name}/{mount.name}"
    known = ", ".join(f"{robot.name}/{mount.name}" for robot in trial.robots for mount in robot.sensors)
    raise InputError(
        f"trial {trial.name!r}: no sensor gives a {' or '.join(sorted(kinds))}, which {type(detector).__name__} reads;"
        f" it has {known or 'none'}"
    )


READINGS = {
    "Lidar2D": "Scan",
    "PulsedLidar2D": "Scan",
    "Lidar3D": "PointCloud",
    "DepthCamera": "DepthImage",
    "RGBCamera": "RgbImage",
    "ExposedCamera": "RgbImage",
}
"""Readings of the sensors that detectors understand."""


def _check_rows(rows: Sequence[LoggedReading], detector: Detector, sensor: str, where: str) -> None:
    if not rows:
        raise InputError(f"{where}: {sensor or 'no sensor'} has no reading at an instant with recorded people")
    detector.check(rows[0].reading)


def _count_beams(reading: Any) -> dict[int, int]:
    hits, counts = np.unique(reading.hit[reading.hit >= 0], return_counts=True)
    return dict(zip(hits.tolist(), counts.tolist(), strict=True))
