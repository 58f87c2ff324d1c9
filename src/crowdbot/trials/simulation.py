"""Simulation: a trial that is running, one step of time at a time.

The order of a step, from tick k to tick k + 1:

1. the crowd and the robots move together from the scene of tick k (the world), the robots by the command they hold;
2. time is at tick k + 1;
3. people who have reached their goal zone leave;
4. contacts and arrivals are judged, swept over the step;
5. sensors that are due measure the new scene;
6. navigators that are due decide, and their command is held until they decide again;
7. recorders that are due write scene, readings and commands.

At tick 0 only 5 to 7 happen. A sensor, a navigator and a recorder are due every n-th tick, n being whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, TrialError, Twist, stream
from crowdbot.metrics import wall_clearance
from crowdbot.navigation import Limits, Observation
from crowdbot.sensors import Reading, Scan
from crowdbot.world import PlanarWorld

from .spawn import People, place
from .stage import area
from .trial import Mount, Robot, Trial

__all__ = ["Carrier", "Frame", "Simulation", "start_scene"]

ARRIVED = 0.3
"""People also leave this near [m] to their own point of the goal zone."""


@dataclass(frozen=True)
class Frame:
    """What is recorded at one instant.

    Fields:
        tick: number of steps since the beginning.
        nanoseconds: simulated time [ns].
        scene: people first, then robots; E is 1.
        twists, commands: ``[R, 3]`` forward [m/s], turn [rad/s], left [m/s] of each robot: as it moves, as it is asked.
        readings: what was measured at this instant, with who measured it.
        due: whether the scene is to be recorded; otherwise only the readings are.
    """

    tick: int
    nanoseconds: int
    scene: Scene
    twists: NDArray[np.float64]
    commands: NDArray[np.float64]
    readings: tuple[tuple[Robot, Mount, Reading], ...]
    due: bool


@dataclass
class Carrier:
    """A robot that is running: its place among the agents, what its sensors said last and what it is asked to do."""

    robot: Robot
    agent: int
    limits: Limits
    control_every: int
    sensor_every: tuple[int, ...]
    randomness: tuple[np.random.Generator, ...]
    readings: dict[str, Reading] = field(default_factory=dict)
    command: Twist = field(default_factory=Twist)
    arrived: bool = False


class Simulation:
    """A trial that is running.

    Attributes:
        trial, seed: what runs.
        world: who moves people and robots, and counts the time.
        carriers: the robots.
        event: ``success`` or ``collision`` once that has happened, whichever came first.

    Raises:
        TrialError: people do not fit with this seed.

    >>> from crowdbot.models import ORCA
    >>> simulation = Simulation(Trial(name="empty", duration=1.0, crowd=ORCA()), seed=0)
    >>> simulation.step()
    >>> simulation.frame().nanoseconds
    50000000
    """

    def __init__(self, trial: Trial, seed: int) -> None:
        self.trial = trial
        self.seed = seed
        people, problems = place(trial.stage, trial.spawners, trial.robots, seed)
        if problems:
            raise TrialError(*(f"trial {trial.name!r}: spawner {s.name!r}: {sentence}" for s, sentence in problems))
        self.people = people
        scene = start_scene(trial, people)
        drives = {len(people) + k: robot.drive for k, robot in enumerate(trial.robots)}
        self.world = PlanarWorld(scene, trial.crowd, drives, trial.step, seed)
        self.carriers = [self._carrier(robot, len(people) + k) for k, robot in enumerate(trial.robots)]
        self.event: str | None = None
        self._segments = scene.walls.segments()
        self._exits = [self._exit(k) for k in range(len(trial.spawners))]

    def step(self) -> None:
        """Go one step on: parts 1 to 4 of the order."""
        before = self.world.scene
        self.world.step({carrier.agent: carrier.command for carrier in self.carriers})
        self._let_leave()
        self._judge(before)

    def sense(self) -> tuple[tuple[Robot, Mount, Reading], ...]:
        """Return what the sensors that are due measure: part 5."""
        new = []
        for carrier in self.carriers:
            pose = self.world.pose(carrier.agent)
            others = self.world.scene.without(carrier.agent)
            rows = zip(carrier.robot.sensors, carrier.sensor_every, carrier.randomness, strict=True)
            for mount, every, rng in rows:
                if self.tick % every == 0:
                    reading = mount.sensor.measure(others, pose.mounted(mount.x, mount.y, mount.heading), rng)
                    carrier.readings[mount.name] = reading
                    new.append((carrier.robot, mount, reading))
        return tuple(new)

    def decide(self) -> None:
        """Ask the navigators that are due: part 6."""
        for carrier in self.carriers:
            if self.tick % carrier.control_every == 0:
                carrier.command = _asked(carrier.robot, self.observation(carrier))

    def observation(self, carrier: Carrier) -> Observation:
        """Return what a robot knows: of the people, those whom its latest scans hit with at least one beam.

        These it knows by their true positions and velocities, as from a perfect tracker.
        """
        scene = self.world.scene
        seen = np.zeros(scene.shape[1], dtype=np.bool_)
        scans = [reading for reading in carrier.readings.values() if isinstance(reading, Scan)]
        for scan in scans:
            seen |= scan.seen(scene.shape[1])[0]
        return Observation.of(
            scene,
            carrier.agent,
            carrier.limits,
            dt=carrier.robot.control_period,
            twist=self.world.twists[carrier.agent].at(0),
            seen=seen,
            scan=scans[0] if scans else None,
        )

    def frame(self, readings: tuple[tuple[Robot, Mount, Reading], ...] = (), due: bool = True) -> Frame:
        """Return what is to be recorded of this instant: part 7."""
        twists = [self.world.twists[carrier.agent].at(0) for carrier in self.carriers]
        return Frame(
            self.tick,
            self.world.clock.nanoseconds,
            self.world.scene,
            _rows(twists),
            _rows([carrier.command for carrier in self.carriers]),
            readings,
            due,
        )

    @property
    def tick(self) -> int:
        """Number of steps since the beginning."""
        return self.world.clock.tick

    def _carrier(self, robot: Robot, agent: int) -> Carrier:
        every = self.world.clock.every
        return Carrier(
            robot,
            agent,
            _limits(robot.drive),
            every(robot.control_period),
            tuple(every(1.0 / mount.sensor.rate) for mount in robot.sensors),
            tuple(stream(self.seed, "sensor", robot.name, mount.name) for mount in robot.sensors),
        )

    def _exit(self, spawner: int) -> tuple[NDArray[np.int64], Any]:
        """Return the people of a spawner who leave, and the zone in which they do."""
        import shapely

        spec = self.trial.spawners[spawner]
        zone = area(spec.goal)
        shapely.prepare(zone)
        leaving = self.people.spawner == spawner if spec.arrival == "leave" else np.zeros(len(self.people), bool)
        return np.flatnonzero(leaving), zone

    def _let_leave(self) -> None:
        import shapely

        scene = self.world.scene
        gone = np.zeros(scene.shape[1], dtype=np.bool_)
        for members, zone in self._exits:
            there = members[scene.active[0, members]]
            if len(there):
                x, y = scene.position[0, there].T
                away = np.hypot(*(scene.goal[0, there] - scene.position[0, there]).T)
                gone[there] = shapely.contains_xy(zone, x, y) | (away < ARRIVED)
        if np.any(gone):
            self.world.scene = scene.replace(active=scene.active & ~gone)

    def _judge(self, before: Scene) -> None:
        now = self.world.scene
        collided = len(self.world.contacts) > 0
        for carrier in self.carriers:
            path = np.stack([before.position[0, carrier.agent], now.position[0, carrier.agent]])
            collided |= bool(np.any(wall_clearance(path, carrier.robot.radius, self._segments)[1:] < 0.0))
            away = float(np.hypot(*(path[1] - np.array(carrier.robot.goal.position))))
            carrier.arrived |= away < carrier.robot.goal.tolerance
        if self.event is None and collided:
            self.event = "collision"
        elif self.event is None and self.carriers and all(carrier.arrived for carrier in self.carriers):
            self.event = "success"


def start_scene(trial: Trial, people: People) -> Scene:
    """Return the scene at the beginning, E = 1: people first, walking towards their goals, then standing robots."""
    count = len(trial.robots)
    away = people.goal - people.position
    distance = np.hypot(away[:, 0], away[:, 1])
    moving = away * (people.speed / np.maximum(distance, 1e-9))[:, None]
    robots = np.array([robot.position for robot in trial.robots], dtype=np.float64).reshape(-1, 2)
    goals = np.array([robot.goal.position for robot in trial.robots], dtype=np.float64).reshape(-1, 2)
    tops = np.array([_limits(robot.drive).max_speed for robot in trial.robots])
    heading = np.concatenate([np.arctan2(moving[:, 1], moving[:, 0]), [robot.heading for robot in trial.robots]])
    own = np.arange(len(people) + count) < len(people)
    return Scene.of(
        np.concatenate([people.position, robots]),
        np.concatenate([moving, np.zeros((count, 2))]),
        heading=heading,
        radius=np.concatenate([people.radius, [robot.radius for robot in trial.robots]]),
        goal=np.concatenate([people.goal, goals]),
        preferred_speed=np.concatenate([people.speed, tops]),
        max_speed=np.concatenate([1.3 * people.speed, tops]),
        visible=np.concatenate([np.ones(len(people), bool), [robot.visible for robot in trial.robots]]).astype(bool),
        external=~own,
        walls=trial.stage.as_walls(),
    )


def _asked(robot: Robot, observation: Observation) -> Twist:
    answer: Any = robot.navigator.act(observation)
    if not isinstance(answer, Twist):
        raise InputError(
            f"navigator {type(robot.navigator).__name__} of robot {robot.name!r} gave a {type(answer).__name__},"
            " it must give a Twist"
        )
    return Twist(*map(float, answer))


def _limits(drive: Any) -> Limits:
    """Return the limits of a drive by the names that drives use; a drive without them is taken as 1 m/s and 1 rad/s."""
    known = {name: float(getattr(drive, name)) for name in Limits._fields if hasattr(drive, name)}
    return Limits(**({"max_speed": 1.0, "max_turn_rate": 1.0} | known))


def _rows(twists: Sequence[Twist]) -> NDArray[np.float64]:
    return np.array([tuple(twist) for twist in twists], dtype=np.float64).reshape(-1, 3)
