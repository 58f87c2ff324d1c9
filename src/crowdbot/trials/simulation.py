"""Simulation: a trial that is running, one step of time at a time.

The order of a step, from tick k to tick k + 1:

1. the crowd and the robots move together from the scene of tick k (the world), the robots by the command they hold;
2. time is at tick k + 1; people who are in an exit or at the end of their journey leave, and others come in;
3. people who have reached their goal zone leave;
4. contacts and arrivals are judged, swept over the step;
5. sensors that are due measure the new scene;
6. navigators that are due decide, and their command is held until they decide again;
7. recorders that are due write scene, readings and commands.

At tick 0 only 5 to 7 happen. A sensor, a navigator and a recorder are due every n-th tick, n being whole.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, TrialError, Twist, stream
from crowdbot.metrics import wall_clearance
from crowdbot.navigation import Limits, Observation
from crowdbot.sensors import Reading, Scan

from .ending import ended, ways_out
from .opening import limits_of, start_scene, world_of
from .spawn import place
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
        scene: people who were there at the beginning, robots, and who came in or left; E is 1.
        ids: ``[A]`` who is who in the scene; a place may be taken by one person after the other.
        twists, commands: ``[R, 3]`` forward [m/s], turn [rad/s], left [m/s] of each robot: as it moves, as it is asked.
        readings: what was measured at this instant, with who measured it; scans hit people by their ids.
        due: whether the scene is to be recorded; otherwise only the readings are.
    """

    tick: int
    nanoseconds: int
    scene: Scene
    ids: NDArray[np.int64]
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
    seen: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    """Ids of those whom each sensor hit last."""
    command: Twist = field(default_factory=Twist)
    arrived: bool = False


class Simulation:
    """A trial that is running.

    Attributes:
        trial, seed: what runs.
        world: who moves people and robots, and counts the time.
        carriers: the robots.
        event: ``success`` or ``collision`` once that has happened, whichever came first.
        ended: the outcome once another condition of the trial for its end holds.

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
        recorded = [(one, one.walks(trial.duration)) for one in trial.recorded]
        people, problems = place(trial.stage, trial.spawners, trial.robots, seed, trial.agents, recorded)
        if problems:
            what = ((type(one).__name__.lower(), one.name, sentence) for one, sentence in problems)
            raise TrialError(*(f"trial {trial.name!r}: {word} {name!r}: {sentence}" for word, name, sentence in what))
        self.people = people
        self.world = world_of(trial, people, seed)
        self.carriers = [self._carrier(robot, len(people) + k) for k, robot in enumerate(trial.robots)]
        self.event: str | None = None
        self.ended: str | None = None
        self._segments = self.world.scene.walls.segments()
        self._ways_out = ways_out(people)

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
                    if isinstance(reading, Scan):
                        carrier.seen[mount.name] = self.ids[reading.seen(len(self.ids))[0]]
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
        for hit in carrier.seen.values():
            seen |= np.isin(self.ids, hit)
        scans = [reading for reading in carrier.readings.values() if isinstance(reading, Scan)]
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
            self.ids.copy(),
            _rows(twists),
            _rows([carrier.command for carrier in self.carriers]),
            tuple((robot, mount, _by_id(reading, self.ids)) for robot, mount, reading in readings),
            due,
        )

    @property
    def tick(self) -> int:
        """Number of steps since the beginning."""
        return self.world.clock.tick

    @property
    def ids(self) -> NDArray[np.int64]:
        """Who is who ``[A]``."""
        return np.asarray(self.world.ids[0])

    def _carrier(self, robot: Robot, agent: int) -> Carrier:
        every = self.world.clock.every
        return Carrier(
            robot,
            agent,
            limits_of(robot.drive),
            every(robot.control_period),
            tuple(every(1.0 / mount.sensor.rate) for mount in robot.sensors),
            tuple(stream(self.seed, "sensor", robot.name, mount.name) for mount in robot.sensors),
        )

    def _let_leave(self) -> None:
        import shapely

        scene = self.world.scene
        gone = np.zeros(scene.shape[1], dtype=np.bool_)
        for members, zone in self._ways_out:
            there = members[scene.active[0, members] & (self.ids[members] == members)]
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
        if self.ended is None:
            self.ended = ended(self)


def _asked(robot: Robot, observation: Observation) -> Twist:
    answer: Any = robot.navigator.act(observation)
    if not isinstance(answer, Twist):
        raise InputError(
            f"navigator {type(robot.navigator).__name__} of robot {robot.name!r} gave a {type(answer).__name__},"
            " it must give a Twist"
        )
    return Twist(*map(float, answer))


def _by_id(reading: Reading, ids: NDArray[np.int64]) -> Reading:
    """Return a reading in which people are named by who they are, not by their places among the agents."""
    if not isinstance(reading, Scan) or np.array_equal(ids, np.arange(len(ids))):
        return reading
    return dataclasses.replace(reading, hit=np.where(reading.hit >= 0, ids[reading.hit], reading.hit))


def _rows(twists: Sequence[Twist]) -> NDArray[np.float64]:
    return np.array([tuple(twist) for twist in twists], dtype=np.float64).reshape(-1, 3)
