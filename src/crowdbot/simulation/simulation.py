"""Simulation: the running environments of a trial, advanced together in time steps.

Order of a step from tick k to tick k + 1 (see docs/concepts/steps.md):

1. **time**: the clock allows the step: immediately (free), when due (paced), or on request (external);
2. **crowd**: people move, from the scene of tick k;
3. **robots**: drives follow the current commands, from the scene of tick k;
4. **physics**: overlaps are resolved and contacts during the step are detected; the scene is at k + 1;
5. **flow**: people at their goal or in an exit leave, others enter; contacts and arrivals are evaluated;
6. **sensors** that are due measure the new scene, then navigators that are due decide;
7. **orders** from outside are applied: commands of bridges, changes of the scene;
8. **recorders** write scene, readings, contacts, orders and commands that are due.

At tick 0, only parts 6 to 8 run. Sensors, navigators and recorders are due every n-th tick.
"""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import (
    PERSON_COLOR,
    ROBOT_COLOR,
    WALL_COLOR,
    Clock,
    Disc,
    InputError,
    Path2D,
    Storage,
    Twist,
    draw_svg,
    every,
    some,
    tree,
)
from crowdbot.metrics import HOLD
from crowdbot.navigation import Observation
from crowdbot.sensors import Reading
from crowdbot.trials import Mount, RobotSpec, Trial, floor_plan
from crowdbot.typing import Bools, Ints
from crowdbot.world import World, put_environments, select_environments, step_environments

from .failure import RunFailure
from .mounted_sensor import SensorReadings, shows_avatars
from .robot_control import RobotControl
from .robot_joints import follow_joint_targets, move_wanted_joints
from .step_record import WALL, RobotContact, StepRecord
from .termination import end_condition_numbers, goal_zones, leave_goal_zones, may_be_near, note_events, run_outcome
from .world_builder import check_clock, environment_index
from .world_template import WorldTemplate
from .world_view import WorldView

if TYPE_CHECKING:
    from crowdbot.world import BodyContactEvent, Fall

    from .orders.order import Order

INSTANT = 1e-9
"""Tolerance of times [s]."""
NONE, COLLISION, SUCCESS = 0, 1, 2
"""First event of an environment."""

Seeds = int | Sequence[int]
RobotReadings = list[tuple[RobotControl, SensorReadings]]
"""Readings of several environments that arrived in one step, with their robots."""


class Simulation:
    """The running simulation of a trial in E environments, one for each seed.

    All environments advance together; each has its own people, random numbers, time, events and failure. Environment e
    is bit-identical to a simulation of its seed alone. Single environments can be restarted at any time.

    Args:
        trial: the trial, without sweeps, or its template.
        seeds: one seed, or one for each environment.
        clock: a clock at tick 0 with the time step of the trial; None: a free clock.
        posed: compute body poses for rendering even if no sensor needs them.

    Attributes:
        trial, seeds: the trial and the seed of each environment; of variants, the first.
        template: makes the worlds; its trial is that of the start.
        world: moves people and robots; has the clock.
        around: the world for sensors and cameras.
        robots: state of each robot.
        former_robots: robots that orders have removed.
        readings: readings that arrived in the latest step, with their robots; see :meth:`new_readings`.
        event: ``[E]`` the first of :data:`COLLISION` and :data:`SUCCESS`, :data:`NONE` before.
        ended: ``[E]`` number of the end condition that has ended an environment.
        failures: the exception that ended each environment, or None.
        begun: ``[E]`` whether parts 6 to 8 of tick 0 have run.
        failed: ``[E]`` whether an exception has ended an environment.
        broken: ``[E]`` whether this happened before part 6, so that the step cannot be recorded.

    Raises:
        TrialError: people cannot be placed with a seed.
        InputError: the clock has another time step, or is not at tick 0.

    >>> from crowdbot.models import ORCA
    >>> simulation = Simulation(Trial(name="empty", duration=1.0, crowd=ORCA()), seeds=[0, 1])
    >>> simulation.advance()
    >>> simulation.ticks.tolist(), simulation.record(1).nanoseconds
    ([1, 1], 50000000)
    """

    storage = Storage(
        constants=("trial", "people", "around", "_ways_out", "template"),
        shared=("seeds", "world", "robots", "former_robots", "readings", "failures", "_contacts"),
        last=("readings",),
    )

    def __init__(
        self, trial: Trial | WorldTemplate, seeds: Seeds = 0, clock: Clock | None = None, *, posed: bool = False
    ) -> None:
        self.template = trial if isinstance(trial, WorldTemplate) else WorldTemplate(trial, posed)
        self.trial = trial = self.template.trial
        self.seeds = [int(seeds)] if isinstance(seeds, int | np.integer) else [int(seed) for seed in seeds]
        if not self.seeds:
            raise InputError("a simulation needs at least one seed, such as seeds=range(8)")
        self.world, self.people = self.template.begin(self.seeds)
        self._set_around()
        count, first = len(self.seeds), trial.people
        self.robots = [
            RobotControl.of(trial, robot, first + k, self.world, self.seeds) for k, robot in enumerate(trial.robots)
        ]
        self.template.set_goals(self.robots)
        self.former_robots: list[RobotControl] = []
        self.readings: RobotReadings = []
        self.event = np.zeros(count, dtype=np.int8)
        self.ended = np.zeros(count, dtype=np.int64)
        self.failures: list[RunFailure | None] = [None] * count
        self._contacts: dict[int, tuple[RobotContact, ...]] = {}
        self.begun, self.failed, self.broken = (np.zeros(count, dtype=np.bool_) for _ in range(3))
        self._told, self._fallen = np.zeros(count, dtype=np.int64), np.zeros(count, dtype=np.int64)
        self._ways_out = goal_zones(self.people)
        if clock is not None:
            self.world.clock = check_clock(clock, self.world.clock)

    def begin(self) -> None:
        """Run part 6 of tick 0 in the environments in which it has not run."""
        new = ~self.begun
        self.begun[:] = True
        self.readings = self._observe(new & ~self.failed)

    def advance(self) -> None:
        """Advance all environments by one step: parts 1 to 6.

        An exception in a crowd model, sensor or navigator ends the environment in which it occurs, see
        :attr:`failures`. Such an environment senses and decides nothing more until it is restarted.
        """
        if not every(self.begun):
            self.begin()
        self._step()
        self.readings = self._observe(~self.failed)

    @property
    def count(self) -> int:
        """Number of environments E."""
        return len(self.seeds)

    @property
    def ticks(self) -> Ints:
        """Number of steps of each environment since its start, ``[E]``."""
        return self.world.ticks

    @property
    def tick(self) -> int:
        """Number of steps of the first environment since its start."""
        return int(self.world.ticks[0])

    def observation(self, robot: str, environment: int = 0) -> Observation:
        """Return the observation of a robot in one environment.

        Raises:
            InputError: there is no robot of this name.
        """
        return self.control_of(robot).observation(self.around, environment)

    def agent_of(self, robot: str) -> int:
        """Return the index of a robot in the scene.

        Raises:
            InputError: there is no robot of this name.
        """
        return self.control_of(robot).agent

    def command(self, robot: str, twist: Twist, environment: int = 0) -> None:
        """Set the command of a robot until its navigator decides again; part 7.

        Raises:
            InputError: there is no robot of this name.
        """
        self.control_of(robot).ask(environment, twist, self.ticks)

    def contacts(self, environment: int = 0) -> tuple[RobotContact, ...]:
        """Return the contacts of robots in the latest step of an environment."""
        return self._contacts.get(environment, ())

    def new_readings(self, environment: int = 0) -> tuple[tuple[RobotSpec, Mount, Reading], ...]:
        """Return the readings that arrived in the latest step of an environment, with robot and mount."""
        return tuple(
            (robot.robot, robot.mount(told.name), told.row(int(row)))
            for robot, told in self.readings
            for row in np.flatnonzero(told.environments == environment)
        )

    def record(
        self,
        environment: int = 0,
        due: bool = True,
        last: bool = False,
        orders: tuple[Order, ...] = (),
        number: int | None = None,
        collisions: bool = True,
    ) -> StepRecord:
        """Return the record of the current step of an environment: part 8.

        Args:
            environment: index of the environment.
            due: whether the scene is recorded.
            last: whether open contact events are included.
            orders: orders that were applied in this step.
            number: number of the environment in the record; default its index.
            collisions: whether finished contact events are taken, each once, in the physics world.
        """
        world, e = self.world, environment
        twists = [world.twists[robot.agent].at(e) for robot in self.robots]
        return StepRecord(
            int(world.ticks[e]),
            int(world.ticks[e]) * world.clock.step_ns,
            world.environment_scene(e),
            world.ids[e, : world.slots[e]].copy(),
            np.array([tuple(twist) for twist in twists], dtype=np.float64).reshape(-1, 3),
            np.array([robot.command[e] for robot in self.robots], dtype=np.float64).reshape(-1, 3),
            self.new_readings(e),
            due,
            self.contacts(e),
            world.forces_of(e),
            self.ended_contact_events(e, last) if collisions else (),
            self.ended_falls(e, last) if collisions else (),
            orders,
            e if number is None else number,
            tuple(robot.robot for robot in self.robots),
            tuple(world.ids[e, [robot.agent for robot in self.robots]].tolist()),
            world.fall_poses_of(e) if due else {},
        )

    def _repr_svg_(self) -> str:
        """Return a drawing of the first environment for notebooks, with doors at their current angle."""
        return _simulation_svg(self, 0)

    def is_eventful(self) -> Bools:
        """Return ``[E]`` whether there is something to record although no scene is due."""
        found = np.zeros(self.count, dtype=np.bool_)
        if self._contacts:
            found[list(self._contacts)] = True
        for _, told in self.readings:
            found[told.environments] = True
        if self.world.walls_fixed:
            found |= [bool(self.world.forces_of(e)) for e in range(self.count)]
        return found & ~self.broken

    def may_end(self) -> Bools:
        """Return ``[E]`` whether :meth:`outcome` is not None."""
        end = self.trial.end
        found: Bools = self.failed | (self.ended != 0) | (self.ticks >= self.trial.ticks)
        if end.collision:
            found = found | (self.event == COLLISION)
        return found | (self.event == SUCCESS) if end.goal else found

    def outcome(self, environment: int = 0) -> str | None:
        """Return the outcome that an environment would have if it ended now, None while it continues.

        A run ends at a recorded instant, or with an error.
        """
        if self.failures[environment] is not None:
            return "error"
        event = ("", "collision", "success")[self.event[environment]]
        over = int(self.ticks[environment]) >= self.trial.ticks
        return run_outcome(self.trial.end, event, int(self.ended[environment]), over, bool(self.robots))

    def fail(self, environment: int, error: Exception) -> None:
        """End an environment with an exception."""
        self.failures[environment] = RunFailure.of(error, float(self.world.times[environment]), self.trial.folder)
        self.failed[environment] = True

    def restart(self, environments: Sequence[int] | Ints, seeds: Sequence[int]) -> None:
        """Restart some environments of the trial with new seeds, and run part 6 of their tick 0.

        Raises:
            TrialError: people cannot be placed with a seed.
            InputError: an environment does not exist or is given twice, or there is not one seed for each.
        """
        index = environment_index(environments, self.count, len(seeds))
        start = [self.trial.people + k for k in range(len(self.robots))]
        if self.former_robots or [robot.agent for robot in self.robots] != start:
            raise InputError("robots were added or removed in this simulation; make a new one instead of a restart")
        self.template = self.template.of_trial(self.trial)
        new = Simulation(self.template.of_environments(index), seeds)
        new.begin()
        kept = np.zeros(self.count, dtype=np.bool_)
        kept[index] = True
        old = [(robot, told) for robot, item in self.readings if (told := item.without(kept)) is not None]
        robots = dict(zip(map(id, new.robots), self.robots, strict=True))
        fresh = [(robots[id(robot)], item.renumber(index)) for robot, item in new.readings]
        self.put(index, new)
        self.readings = old + fresh

    def select(self, environments: Sequence[int] | Ints) -> Simulation:
        """Return an independent simulation of some environments, which may be repeated, in their current state."""
        index = environment_index(environments, self.count)
        some = tree.take(self, index)
        some.seeds = [self.seeds[e] for e in index]
        some._take_template(self.template.of_environments(index))
        some.world = select_environments(self.world, index)
        some._set_around()
        some.robots = [robot.select(index) for robot in self.robots]
        some.former_robots = list(self.former_robots)
        robots = dict(zip(map(id, self.robots), some.robots, strict=True))
        some.readings = [
            (robots[id(robot)], part) for robot, told in self.readings if (part := told.matching(index)) is not None
        ]
        some.failures = [self.failures[e] for e in index]
        some._contacts = {k: self._contacts[e] for k, e in enumerate(index.tolist()) if e in self._contacts}
        return some

    def put(self, environments: Sequence[int] | Ints, other: Simulation) -> None:
        """Replace some environments by those of another simulation of the same trial, which must not be used again."""
        index = environment_index(environments, self.count, other.count)
        vars(self).update(vars(tree.put(self, index, other, self.count)))
        self._take_template(self.template.with_environments(index, other.template))
        self.world = put_environments(self.world, index, other.world)
        self._set_around()
        for mine, new in zip(self.robots, other.robots, strict=True):
            mine.put(index, new)
        for k, e in enumerate(index.tolist()):
            self.seeds[e], self.failures[e] = other.seeds[k], other.failures[k]
            self._contacts.pop(e, None)
            if k in other._contacts:
                self._contacts[e] = other._contacts[k]

    def _take_template(self, template: WorldTemplate) -> None:
        if template is not self.template:
            self.template, self.trial = template, template.trial

    def control_of(self, name: str) -> RobotControl:
        """Return the state of a robot.

        Raises:
            InputError: there is no robot of this name.
        """
        for robot in self.robots:
            if robot.robot.name == name:
                return robot
        known = ", ".join(robot.robot.name for robot in self.robots) or "none"
        raise InputError(f"there is no robot {name!r}; the trial has {known}")

    def _set_around(self) -> None:
        trial = self.trial
        whole = trial.bodies == "skins" or any(m.sensor.sees_skins for r in trial.robots for m in r.sensors)
        others = "avatars" if shows_avatars(trial) else "nobody"
        self.around = WorldView(self.world, "everybody" if whole else others)

    def _step(self) -> None:
        """Parts 1 to 5."""
        ids = self.world.ids.copy()
        commands = {robot.agent: robot.commands(self.world) for robot in self.robots}
        self.world, errors = step_environments(self.world, commands)
        if self.around.world is not self.world:
            self._set_around()
        self._fail_all(errors)
        if errors:
            self.broken[list(errors)] = True
        if self.count > len(errors):
            leave_goal_zones(self.world, self._ways_out)
            self.world.pose_people()
            self._evaluate(ids)

    def _observe(self, chosen: Bools) -> RobotReadings:
        """Run part 6 in the environments ``chosen`` ``[E]`` and return the readings that arrive."""
        found, errors = read_sensors(self.robots, self.around, chosen & ~self.failed)
        self._fail_all(errors)
        self._fail_all(let_decide(self.robots, self.around, chosen & ~self.failed))
        return found

    def _fail_all(self, errors: Mapping[int, Exception]) -> None:
        for e, error in errors.items():
            self.fail(e, error)

    def ended_contact_events(self, environment: int, last: bool) -> tuple[BodyContactEvent, ...]:
        """Return the contact events that ended since the previous call, ordered by end."""
        events, now = self.world.contact_events_of(environment), float(self.world.times[environment])
        return new_events(events, self._told, environment, math.inf if last else now - HOLD - INSTANT)

    def ended_falls(self, environment: int, last: bool) -> tuple[Fall, ...]:
        """Return the falls that ended since the previous call, ordered by end."""
        falls, now = self.world.falls_of(environment), float(self.world.times[environment])
        return new_events(falls, self._fallen, environment, math.inf if last else now + INSTANT)

    def _evaluate(self, ids: Ints) -> None:
        """Detect contacts and arrivals; ``ids`` are from before the step, since an index may be reused."""
        self._contacts = robot_contacts(self.world, self.robots, ids)
        note_arrivals(self.world, self.robots)
        note_events(self.event, list(self._contacts), self.robots, COLLISION, SUCCESS)
        agents = {robot.robot.name: robot.agent for robot in self.robots}
        if (met := end_condition_numbers(self.trial, self.world, self.people, agents)) is not None:
            self.ended = np.where(self.ended == 0, met, self.ended)


def let_decide(robots: Sequence[RobotControl], around: WorldView, live: NDArray[np.bool_]) -> dict[int, Exception]:
    """Let the navigators decide that are due, move joints, and return the exceptions by environment.

    Joints follow the targets of the trial first, then those of the navigator.

    Args:
        robots: the robots.
        around: the world as sensors see it.
        live: ``[E]`` environments that decide.
    """
    ticks, common = around.world.ticks, around.world.environment_time.common_tick
    errors: dict[int, Exception] = {}
    live = live.copy()
    for robot in robots:
        if robot.robot.joints:
            failures = follow_joint_targets(robot, around.world, live)
            errors |= failures
            live[list(failures)] = False
        if common is not None and not robot.control.is_due(common):
            continue
        due = (live if common is not None else live & robot.control.is_due(ticks)).nonzero()[0]
        failures = robot.decide(around, due) if len(due) else {}
        if robot.wanted:
            failures |= move_wanted_joints(robot, around.world)
        errors |= failures
        live[list(failures)] = False
    return errors


def read_sensors(
    robots: Sequence[RobotControl], around: WorldView, live: Bools
) -> tuple[RobotReadings, dict[int, Exception]]:
    """Return the readings that arrive now, and the exceptions by environment, whose readings are left out.

    Args:
        robots: the robots.
        around: the world as sensors see it.
        live: ``[E]`` environments that sense.
    """
    ticks, common = around.world.ticks, around.world.environment_time.common_tick
    robot_readings: RobotReadings = []
    errors: dict[int, Exception] = {}
    if not some(live):
        return robot_readings, errors
    live = live.copy()
    for robot in robots:
        for sensor in [sensor for sensor in robot.sensors if common is None or sensor.has_work(common)]:
            able, late = (live, None) if robot.faults is None else robot.faults.measuring(sensor, around.world, live)
            arrived, failures = sensor.work(ticks, able, robot.agent, around, late)
            robot_readings += [(robot, readings) for readings in arrived]
            for e, error in failures:
                errors[e], live[e] = error, False
        if robot.faults is not None:
            robot.faults.clear_blind(robot.sensors, around.world.times)
    if errors:
        failed = ~live
        rest = ((robot, readings.without(failed)) for robot, readings in robot_readings)
        robot_readings = [(robot, readings) for robot, readings in rest if readings is not None]
    return robot_readings, errors


class _Ended(Protocol):
    @property
    def begin(self) -> float: ...
    @property
    def end(self) -> float: ...


Ended = TypeVar("Ended", bound=_Ended)


def robot_contacts(
    world: World, robots: Sequence[RobotControl], ids: NDArray[np.int64]
) -> dict[int, tuple[RobotContact, ...]]:
    """Return the contacts of robots in the last step by environment, with people and robots first, then with walls.

    Args:
        world: the world after the step.
        robots: the robots.
        ids: ``[E, A]`` identities before the step, since an index may be reused.
    """
    found: dict[int, list[RobotContact]] = {}
    for contact in world.contacts:
        robot, other = ids[contact.environment, [contact.robot, contact.other]].tolist()
        found.setdefault(contact.environment, []).append(RobotContact(robot, other, contact.clearance))
    for control in robots:
        gap = world.wall_clearance(control.agent)
        for e in np.flatnonzero(gap < 0.0).tolist() if some(gap < 0.0) else ():
            found.setdefault(e, []).append(RobotContact(int(ids[e, control.agent]), WALL, float(gap[e])))
    return {e: tuple(contacts) for e, contacts in found.items()}


def note_arrivals(world: World, robots: Sequence[RobotControl]) -> None:
    """Note which robots are at their goals."""
    position = world.scene.position
    for control in robots:
        if not every(control.arrived) and may_be_near(position, control.agent, control.goal, control.tolerance):
            control.arrive(position[:, control.agent])


def new_events(events: Sequence[Ended], told: NDArray[np.int64], environment: int, until: float) -> tuple[Ended, ...]:
    """Return the events of an environment that ended before ``until`` [s] and were not returned before, by end.

    Args:
        events: all events so far.
        told: ``[E]`` number of events returned so far; it is updated.
        environment: index of the environment.
        until: time [s].
    """
    if not events:
        return ()
    over = sorted((event for event in events if event.end < until), key=lambda event: (event.end, event.begin))
    new, told[environment] = over[int(told[environment]) :], len(over)
    return tuple(new)


def _simulation_svg(simulation: Simulation, environment: int) -> str:
    """Return an SVG drawing of an environment: stage with ground, doors at their current angle, people and robots."""
    doors, stage = simulation.world.part(environment)[0].doors, simulation.trial.stage
    shares = {}
    if doors is not None:
        shares = {leaf.name: float(share) for leaf, share in zip(doors.leaves, doors.signed_share, strict=True)}
    lines = floor_plan(stage, shares)
    lines += [Path2D(np.concatenate([ring, ring[:1]]), WALL_COLOR, 1.5) for ring in stage.rings]
    scene, discs = simulation.world.environment_scene(environment), list[Disc]()
    robots = {robot.agent: robot.robot.body.outline for robot in simulation.robots}
    for agent in np.flatnonzero(scene.active[0]).tolist():
        color = ROBOT_COLOR if agent in robots else PERSON_COLOR
        x, y = scene.position[0, agent].tolist()
        radius, heading = float(scene.radius[0, agent]), float(scene.heading[0, agent])
        outline = robots.get(agent)
        if outline is None:
            discs.append(Disc(x, y, radius, color))
        else:
            turn = np.array([[np.cos(heading), np.sin(heading)], [-np.sin(heading), np.cos(heading)]])
            lines.append(Path2D(np.concatenate([outline, outline[:1]]) @ turn + (x, y), color, 1.5))
        ahead = radius * np.array([np.cos(heading), np.sin(heading)])
        lines.append(Path2D(np.array([[x, y], [x, y]]) + np.stack([ahead, 1.6 * ahead]), color, 1.5))
    seconds = float(simulation.world.times[environment])
    return draw_svg(lines, discs, f"{simulation.trial.name}, seed {simulation.seeds[environment]}, {seconds:.2f} s")
