"""Simulation: a running trial, advanced in time steps.

Order of a step from tick k to tick k + 1 (see docs/concepts/steps.md):

1. **time**: the clock allows the step: immediately (free), when due (paced), or on request (external);
2. **crowd**: people move, from the scene of tick k;
3. **robots**: drives follow the current commands, from the scene of tick k;
4. **physics**: overlaps are resolved and contacts during the step are detected; the scene is at k + 1;
5. **flow**: people at their goal or in an exit leave, others enter; contacts and arrivals are evaluated;
6. **sensors** that are due measure the new scene, then navigators that are due decide;
7. **bridges** forward the readings and may change commands;
8. **recorders** write scene, readings, contacts and commands that are due.

At tick 0, only parts 6 to 8 run. Sensors, navigators and recorders are due every n-th tick.
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
"""Tolerance of times [s]."""
ARRIVED = 0.3
"""Distance [m] to the own goal point within which people in a goal zone leave."""


WALL = -2
"""Code of a wall instead of an agent id, as in scans."""


class RobotContact(NamedTuple):
    """A contact of a robot during a step: ids of both agents (-2: a wall) and the smallest clearance [m], negative."""

    robot: int
    other: int
    clearance: float


@dataclass(frozen=True)
class StepRecord:
    """The record of one time step.

    Fields:
        tick: number of steps since the start.
        nanoseconds: simulated time [ns].
        scene: all agents, including absent ones; E = 1.
        ids: ``[A]`` ids of the agents; an index can be reused by another person.
        twists, commands: ``[R, 3]`` forward [m/s], turn [rad/s], left [m/s] of each robot: actual and commanded.
        readings: readings of this step with robot and mount; hits are person ids.
        due: whether the scene is recorded; otherwise only readings and contacts.
        touches: contacts of the last step.
        forces: contact forces of the last step, in the physics world.
        collisions: contact events that ended since the last record, in the physics world.
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
    """State of a robot in a simulation: agent index, latest readings and current command."""

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
    """State of the navigator after its first decision."""
    begun: bool = False
    arrived: bool = False


class Simulation:
    """A running simulation of a trial.

    Args:
        trial, seed: the trial and its seed.
        clock: a clock at tick 0 with the time step of the trial; None: a free clock.
        posed: compute body poses for rendering even if no sensor needs them.

    Attributes:
        around: the world for sensors and cameras.
        world: moves people and robots; has the clock.
        robots: states of the robots.
        event: ``success`` or ``collision``, whichever occurred first.
        touches: contacts of the latest step.
        begun: whether parts 6 to 8 of tick 0 have run.
        ended: the outcome after another end condition of the trial.
        failure: the exception that ended the run, or None.

    Raises:
        TrialError: people cannot be placed with this seed.
        InputError: the clock has another time step, or is not at tick 0.

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
        self.robots = [self._robot_runtime(robot, len(people) + k) for k, robot in enumerate(trial.robots)]
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
        yield from self.world.step_requests({runtime.agent: runtime.command for runtime in self.robots})
        self._let_leave()
        self.world.pose_people()
        self._judge(before, ids)

    def sense(self) -> tuple[tuple[RobotSpec, Mount, Reading], ...]:
        """Measure with due sensors and return the readings that arrive now: the first half of part 6."""
        new = []
        for runtime in self.robots:
            for probe in runtime.probes:
                name = probe.mount.name
                for told in probe.work(self.tick, runtime.agent, self.around, self.ids):
                    runtime.readings[name] = told.reading
                    if told.seen is not None:
                        runtime.seen[name] = told.seen
                    new.append((runtime.robot, probe.mount, told.reading))
        return tuple(new)

    def decide(self) -> None:
        """Let due navigators decide: the second half of part 6."""
        for runtime in self.robots:
            if self.tick % runtime.control_every == 0:
                self._decide(runtime)

    def _decide(self, runtime: RobotRuntime) -> None:
        navigator, observation = runtime.robot.navigator, self.observation(runtime)
        if not runtime.begun:
            runtime.memory, runtime.begun = navigator.begin(observation), True
        action, runtime.memory = navigator.decide(observation, runtime.memory, robot=runtime.robot.name)
        runtime.command = action.twist

    def observation(self, runtime: RobotRuntime) -> Observation:
        """Return the observation of a robot: the people in the latest readings of its sensors.

        Positions and velocities are exact, as from a perfect tracker.
        """
        scene = self.around.flat
        seen = np.zeros(scene.shape[1], dtype=np.bool_)
        for hit in runtime.seen.values():
            seen |= np.isin(self.ids, hit)
        scans = [reading for reading in runtime.readings.values() if isinstance(reading, Scan)]
        return Observation.of(
            scene,
            runtime.agent,
            runtime.limits,
            dt=runtime.robot.control_period,
            twist=self.world.twists[runtime.agent].at(0),
            seen=seen,
            scan=scans[0] if scans else None,
        )

    def frame(
        self, readings: tuple[tuple[RobotSpec, Mount, Reading], ...] = (), due: bool = True, last: bool = False
    ) -> StepRecord:
        """Return the record of the current step: part 8. The ``last`` one includes open contact events."""
        twists = [self.world.twists[runtime.agent].at(0) for runtime in self.robots]
        return StepRecord(
            self.tick,
            self.world.clock.nanoseconds,
            self.world.scene,
            self.ids.copy(),
            _rows(twists),
            _rows([runtime.command for runtime in self.robots]),
            readings,
            due,
            self.touches,
            self.forces,
            self._collisions(last),
        )

    @property
    def forces(self) -> tuple[ContactForce, ...]:
        """Contact forces of the last step; none in the planar world."""
        return self.world.forces

    @property
    def eventful(self) -> bool:
        """Whether there is something to record although no scene is due."""
        return bool(self.touches or self.forces)

    def _collisions(self, last: bool) -> tuple[BodyContactEvent, ...]:
        """Return the contact events that ended since the previous call, ordered by end."""
        now = self.world.clock.time
        over = [one for one in self.world.contact_events if last or now - one.end > HOLD + INSTANT]
        over.sort(key=lambda one: (one.end, one.begin, one.first, one.second))
        new, self._told = over[self._told :], len(over)
        return tuple(new)

    def replace_trial(self, trial: Trial, seed: int) -> None:
        """Continue with another trial; see :func:`crowdbot.simulation.apply_overrides`, which changes the world."""
        self.trial, self.seed = trial, seed
        self.around.change(trial)

    def ask(self, robot: str, command: Twist) -> None:
        """Set the command of a robot until the next decision of its navigator; used by bridges, part 7.

        Raises:
            InputError: there is no robot of this name.
        """
        for runtime in self.robots:
            if runtime.robot.name == robot:
                runtime.command = Twist(*map(float, command))
                return
        known = ", ".join(runtime.robot.name for runtime in self.robots) or "none"
        raise InputError(f"there is no robot {robot!r}; the trial has {known}")

    @property
    def tick(self) -> int:
        """Number of steps since the start."""
        return self.world.clock.tick

    @property
    def ids(self) -> NDArray[np.int64]:
        """Ids ``[A]`` of the agents."""
        return np.asarray(self.world.ids[0])

    def _robot_runtime(self, robot: RobotSpec, agent: int) -> RobotRuntime:
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
                f"the clock is at tick {clock.tick} with steps of {clock.dt} s, but the trial starts at tick 0 with"
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
        """Detect contacts and arrivals; ``ids`` are from before the step, since an index may be reused."""
        now = self.world.scene
        touches = [RobotContact(int(ids[one.robot]), int(ids[one.other]), one.clearance) for one in self.world.contacts]
        for runtime in self.robots:
            gap = float(self.world.wall_clearance(runtime.agent)[0])
            if gap < 0.0:
                touches.append(RobotContact(int(ids[runtime.agent]), WALL, gap))
            away = float(np.hypot(*(now.position[0, runtime.agent] - np.array(runtime.robot.goal.position))))
            runtime.arrived |= away < runtime.robot.goal.tolerance
        self.touches = tuple(touches)
        collided = bool(touches)
        if self.event is None and collided:
            self.event = "collision"
        elif self.event is None and self.robots and all(runtime.arrived for runtime in self.robots):
            self.event = "success"
        if self.ended is None:
            robots = {runtime.robot.name: runtime.agent for runtime in self.robots}
            self.ended = end_outcome(self.trial, self.world, self.people, robots)


def _rows(twists: Sequence[Twist]) -> NDArray[np.float64]:
    return np.array([tuple(twist) for twist in twists], dtype=np.float64).reshape(-1, 3)
