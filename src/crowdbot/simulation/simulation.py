"""Simulation: a trial that is running, one step of time at a time.

The order of a step, from tick k to tick k + 1 (docs/concepts/steps.md gives the reasons):

1. **time**: the clock allows the step: immediately (free), when due (paced), or on request (external);
2. **crowd**: people move, from the scene of tick k;
3. **robots**: drives follow the commands the robots hold, from the same scene of tick k;
4. **physics**: bodies that overlap are pushed apart; contacts are found, swept over the step; the scene is at k + 1;
5. **flow**: people who have arrived or are in an exit leave, others enter; contacts and arrivals are judged;
6. **sensors** that are due measure the new scene, then navigators that are due decide; commands are held meanwhile;
7. **bridges** pass on what was measured and may give robots other commands;
8. **recorders** write what is due: scene, readings, contacts and commands.

At tick 0 only 6 to 8 happen. A sensor, a navigator and a recorder are due every n-th tick, n being whole.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError, Scene, TrialError, Twist
from crowdbot.metrics.contacts import HOLD
from crowdbot.navigation import DriveLimits, Observation
from crowdbot.sensors import Reading, Scan
from crowdbot.trials import Mount, RobotSpec, Trial, element_word, people_appearance, place
from crowdbot.world import StepGenerator, run_step

from .failure import RunFailure
from .mounted_sensor import MountedSensor, mounted_sensors
from .termination import end_outcome, goal_zones
from .world_builder import build_world, limits_of, start_scene
from .world_view import WorldView

if TYPE_CHECKING:
    from crowdbot.world import BodyContactEvent, ContactForce

__all__ = ["RobotContact", "RobotRuntime", "Simulation", "StepRecord", "start_scene"]

INSTANT = 1e-9
"""Times [s] that differ by less are the same."""
ARRIVED = 0.3
"""People also leave this near [m] to their own point of the goal zone."""


WALL = -2
"""Code for a wall in place of the id of a touched agent; as in scans."""


class RobotContact(NamedTuple):
    """A robot and what it touched during a step: their ids (-2: a wall) and the smallest clearance [m], negative."""

    robot: int
    other: int
    clearance: float


@dataclass(frozen=True)
class StepRecord:
    """The record of one instant.

    Fields:
        tick: number of steps since the start.
        nanoseconds: simulated time [ns].
        scene: all agents, absent ones included; E is 1.
        ids: ``[A]`` ids of the agents; several people may use one index in turn.
        twists, commands: ``[R, 3]`` forward [m/s], turn [rad/s], left [m/s] of each robot: actual and commanded.
        readings: the readings of this instant with robot and mount; hits are person ids.
        due: whether the scene is to be recorded; otherwise only the readings and contacts are.
        touches: the contacts of the step that ended now.
        forces: in the physics world what bodies did to each other in that step.
        collisions: in the physics world those that have come to an end since the last frame.
    """

    tick: int
    nanoseconds: int
    scene: Scene
    ids: NDArray[np.int64]
    twists: NDArray[np.float64]
    commands: NDArray[np.float64]
    readings: tuple[tuple[RobotSpec, Mount, Reading], ...]
    due: bool
    touches: tuple[RobotContact, ...] = ()
    forces: tuple[ContactForce, ...] = ()
    collisions: tuple[BodyContactEvent, ...] = ()


@dataclass
class RobotRuntime:
    """The state of a robot in a simulation: its agent index, latest readings and current command."""

    robot: RobotSpec
    agent: int
    limits: DriveLimits
    control_every: int
    probes: tuple[MountedSensor, ...]
    readings: dict[str, Reading] = field(default_factory=dict)
    seen: dict[str, NDArray[np.int64]] = field(default_factory=dict)
    """Ids of the people in the latest reading of each sensor."""
    command: Twist = field(default_factory=Twist)
    memory: Any = None
    """Memory of the navigator, once it has begun."""
    begun: bool = False
    arrived: bool = False


class Simulation:
    """A running simulation of a trial.

    Args:
        trial, seed: what to simulate.
        clock: a clock at tick 0 with the time step of the trial; None is a free clock.
        posed: compute body poses for rendering even if no sensor needs them.

    Attributes:
        around: the world as sensors and cameras see it.
        world: moves people and robots, and holds the clock.
        carriers: the robots.
        event: ``success`` or ``collision`` once that has happened, whichever came first.
        touches: contacts of the latest step.
        begun: whether the parts 6 to 8 of tick 0 are done.
        ended: the outcome once another condition of the trial for its end holds.
        failure: the exception that ended the run, if one did.

    Raises:
        TrialError: people do not fit with this seed.
        InputError: the clock has other steps, or has run before.

    >>> from crowdbot.models import ORCA
    >>> simulation = Simulation(Trial(name="empty", duration=1.0, crowd=ORCA()), seed=0)
    >>> simulation.step()
    >>> simulation.frame().nanoseconds
    50000000
    """

    def __init__(self, trial: Trial, seed: int, clock: Clock | None = None, *, posed: bool = False) -> None:
        self.trial = trial
        self.seed = seed
        recorded = [(one, one.walks(trial.duration)) for one in trial.recorded]
        people, problems = place(trial.stage, trial.spawners, trial.robots, seed, trial.agents, recorded)
        if problems:
            what = ((element_word(type(one)), one.name, sentence) for one, sentence in problems)
            raise TrialError(*(f"trial {trial.name!r}: {word} {name!r}: {sentence}" for word, name, sentence in what))
        self.people = people
        self.world, figures = build_world(trial, people, seed)
        if posed and figures is None:
            figures = people_appearance(trial, people, self.world.scene.shape[1], seed)
        skins = trial.bodies == "skins" or any(m.sensor.sees_skins for r in trial.robots for m in r.sensors)
        self.around = WorldView(trial, self.world, figures, seed, skins)
        self.carriers = [self._carrier(robot, len(people) + k) for k, robot in enumerate(trial.robots)]
        self.event: str | None = None
        self.touches: tuple[RobotContact, ...] = ()
        self.begun = False
        if clock is not None:
            self._keep_time(clock)
        self.ended: str | None = None
        self.failure: RunFailure | None = None
        self._ways_out = goal_zones(people)
        self._told = 0

    def step(self) -> None:
        """Advance one step: parts 1 to 5."""
        run_step(self.step_requests())

    def step_requests(self) -> StepGenerator[None]:
        """Advance one step and yield the requests to the crowd model; see :func:`crowdbot.simulation.run_batch`."""
        before, ids = self.world.scene, self.ids.copy()
        yield from self.world.step_requests({carrier.agent: carrier.command for carrier in self.carriers})
        self._let_leave()
        self.world.pose_people()
        self._judge(before, ids)

    def sense(self) -> tuple[tuple[RobotSpec, Mount, Reading], ...]:
        """Let due sensors measure and return the readings that arrive now: the first half of part 6."""
        new = []
        for carrier in self.carriers:
            for probe in carrier.probes:
                name = probe.mount.name
                for told in probe.work(self.tick, carrier.agent, self.around, self.ids):
                    carrier.readings[name] = told.reading
                    if told.seen is not None:
                        carrier.seen[name] = told.seen
                    new.append((carrier.robot, probe.mount, told.reading))
        return tuple(new)

    def decide(self) -> None:
        """Let due navigators decide: the second half of part 6."""
        for carrier in self.carriers:
            if self.tick % carrier.control_every == 0:
                self._decide(carrier)

    def _decide(self, carrier: RobotRuntime) -> None:
        navigator, observation = carrier.robot.navigator, self.observation(carrier)
        if not carrier.begun:
            carrier.memory, carrier.begun = navigator.begin(observation), True
        action, carrier.memory = navigator.decide(observation, carrier.memory, robot=carrier.robot.name)
        carrier.command = action.twist

    def observation(self, carrier: RobotRuntime) -> Observation:
        """Return what a robot observes: the people in the latest readings of its sensors.

        Their true positions and velocities are given, as from a perfect tracker.
        """
        scene = self.around.flat
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

    def frame(
        self, readings: tuple[tuple[RobotSpec, Mount, Reading], ...] = (), due: bool = True, last: bool = False
    ) -> StepRecord:
        """Return what is to be recorded of this instant: part 8; the ``last`` one has collisions that go on."""
        twists = [self.world.twists[carrier.agent].at(0) for carrier in self.carriers]
        return StepRecord(
            self.tick,
            self.world.clock.nanoseconds,
            self.world.scene,
            self.ids.copy(),
            _rows(twists),
            _rows([carrier.command for carrier in self.carriers]),
            readings,
            due,
            self.touches,
            self.forces,
            self._collisions(last),
        )

    @property
    def forces(self) -> tuple[ContactForce, ...]:
        """What bodies of the physics world did to each other in the latest step; none in the plane."""
        return self.world.forces

    @property
    def eventful(self) -> bool:
        """Whether something has happened that is recorded even when no scene is due."""
        return bool(self.touches or self.forces)

    def _collisions(self, last: bool) -> tuple[BodyContactEvent, ...]:
        """Return the collisions that have ended since they were asked for before, by their ends."""
        now = self.world.clock.time
        over = [one for one in self.world.contact_events if last or now - one.end > HOLD + INSTANT]
        over.sort(key=lambda one: (one.end, one.begin, one.first, one.second))
        new, self._told = over[self._told :], len(over)
        return tuple(new)

    def turn_to(self, trial: Trial, seed: int) -> None:
        """Go on by another trial; see :func:`crowdbot.simulation.apply_overrides`, which changes the world first."""
        self.trial, self.seed = trial, seed
        self.around.change(trial)

    def ask(self, robot: str, command: Twist) -> None:
        """Give a robot another command, which it holds until its navigator decides again: for bridges, part 7.

        Raises:
            InputError: there is no robot of this name.
        """
        for carrier in self.carriers:
            if carrier.robot.name == robot:
                carrier.command = Twist(*map(float, command))
                return
        known = ", ".join(carrier.robot.name for carrier in self.carriers) or "none"
        raise InputError(f"there is no robot {robot!r}; the trial has {known}")

    @property
    def tick(self) -> int:
        """Number of steps since the beginning."""
        return self.world.clock.tick

    @property
    def ids(self) -> NDArray[np.int64]:
        """Ids of the agents ``[A]``."""
        return np.asarray(self.world.ids[0])

    def _carrier(self, robot: RobotSpec, agent: int) -> RobotRuntime:
        every = self.world.clock.every
        return RobotRuntime(
            robot,
            agent,
            limits_of(robot.drive),
            every(robot.control_period),
            mounted_sensors(self.trial, robot, self.world, self.seed),
        )

    def _keep_time(self, clock: Clock) -> None:
        own = self.world.clock
        if clock.tick or clock.step_ns != own.step_ns:
            raise InputError(
                f"the clock is at tick {clock.tick} with steps of {clock.dt} s, but the trial begins at tick 0 with"
                f" steps of {own.dt} s"
            )
        self.world.clock = clock

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

    def _judge(self, before: Scene, ids: NDArray[np.int64]) -> None:
        """Find contacts and arrivals; ``ids`` are from before the step, since an index may be reused."""
        now = self.world.scene
        touches = [RobotContact(int(ids[one.robot]), int(ids[one.other]), one.clearance) for one in self.world.contacts]
        for carrier in self.carriers:
            gap = float(self.world.wall_clearance(carrier.agent)[0])
            if gap < 0.0:
                touches.append(RobotContact(int(ids[carrier.agent]), WALL, gap))
            away = float(np.hypot(*(now.position[0, carrier.agent] - np.array(carrier.robot.goal.position))))
            carrier.arrived |= away < carrier.robot.goal.tolerance
        self.touches = tuple(touches)
        collided = bool(touches)
        if self.event is None and collided:
            self.event = "collision"
        elif self.event is None and self.carriers and all(carrier.arrived for carrier in self.carriers):
            self.event = "success"
        if self.ended is None:
            robots = {carrier.robot.name: carrier.agent for carrier in self.carriers}
            self.ended = end_outcome(self.trial, self.world, self.people, robots)


def _rows(twists: Sequence[Twist]) -> NDArray[np.float64]:
    return np.array([tuple(twist) for twist in twists], dtype=np.float64).reshape(-1, 3)
