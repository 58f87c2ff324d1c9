"""Overrides: continue a running simulation with changed values of its trial, and orders to doors."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.models import Mixture
from crowdbot.trials import Crowds, Door, RobotSpec, Trial, crowd_names, own
from crowdbot.world import environment_seeds, worlds_of

from .fault_state import FaultState
from .mounted_sensor import mounted_sensors
from .orders.order import Order
from .robot_control import RobotControl, decision_schedule
from .robot_joints import restore_joints
from .simulation import NONE, SUCCESS, Simulation
from .world_builder import limits_of, own_walls


@dataclass(frozen=True, kw_only=True)
class DoorOrder(Order):
    """Open or close a door in one environment. The door needs ``opening="order"``.

    Fields:
        door: name of the door.
        open: whether it is to be open.

    >>> DoorOrder(door="hall", environment=3).open
    True
    """

    door: str
    open: bool = True

    def check(self, simulation: Any) -> None:
        super().check(simulation)
        doors = {door.name: door for door in simulation.trial.stage.doors}
        if self.door not in doors:
            hint = did_you_mean(self.door, doors)
            raise InputError(f"DoorOrder: there is no door {self.door!r}{hint}; doors are {', '.join(doors) or 'none'}")
        if (opening := doors[self.door].opening) != "order":
            raise InputError(f'DoorOrder: door {self.door!r} opens by {opening}; take opening="order"')

    def apply(self, simulation: Any) -> None:
        doors = worlds_of(simulation.world)[self.environment].doors
        doors.wanted = {**doors.wanted, self.door: bool(self.open)}


def check_doors(old: Sequence[Door], new: Sequence[Door]) -> None:
    """Raise :class:`InputError` if something else changes than whether a door is open."""
    same = len(old) == len(new) and all(
        dataclasses.replace(two, open=item.open) == item for item, two in zip(old, new, strict=True)
    )
    if not same:
        raise InputError("of the doors, only open can change while a simulation runs")
    for item, two in zip(old, new, strict=True):
        if item.open != two.open and item.opening != "order":
            raise InputError(
                f'open of door {item.name!r} cannot change: it opens by {item.opening}; take opening="order"'
            )


def order_doors(world: Any, old: Sequence[Door], new: Sequence[Door]) -> None:
    """Open and close the doors whose value in the trial changes."""
    changed = {two.name: two.open for item, two in zip(old, new, strict=True) if item.open != two.open}
    for part in worlds_of(world) if changed else ():
        part.doors.wanted = {**part.doors.wanted, **changed}


FIXED = ("world", "physics_step", "bodies", "step", "capacity", "spawners", "agents", "recorded", "avatars", "journeys")
"""Values of a trial that cannot change during a run."""
START = ("name", "type", "x", "y", "heading", "pose")
"""Values of a robot that cannot change during a run."""


class _Robots(NamedTuple):
    """Robots before and after a change of the trial."""

    kept: list[tuple[RobotControl, RobotSpec]]
    """Robots that stay, with their new specification."""
    removed: list[RobotControl]
    added: list[RobotSpec]


def apply_overrides(simulation: Simulation, trial: Trial, seed: int | None = None) -> None:
    """Continue a simulation with another trial, and with new random numbers if a seed is given.

    Positions, internal states and current commands are kept. Values that only affect the start cannot change: time
    step, capacity, spawners, journeys, and the number of sources. Robots that are new in the trial start at rest;
    robots that it lacks are removed, and so are props.

    Raises:
        InputError: a value changes that only affects the start.
    """
    old, world = simulation.trial, simulation.world
    if trial == old and seed is None:
        return
    check_overrides(simulation, trial)
    robots = _match_robots(simulation.robots, trial)
    _change_robots(simulation, robots, trial)
    _change_stage(simulation, trial)
    pairs = list(zip(simulation.robots, trial.robots, strict=True))
    drives = {control.agent: control.robot.drive for control in simulation.former_robots}
    world.reconfigure(
        _scene(simulation, trial),
        [source.source(trial.journeys, crowd_names(trial.crowd)) for source in trial.sources],
        seed,
        drives=drives | {control.agent: robot.drive for control, robot in pairs},
        latency={control.agent: robot.latency for control, robot in pairs},
        robot_margin=trial.robot_margin,
        contact=trial.contact,
        limits=None if trial.limits is None else trial.limits.limits(),
        exits=trial.exits,
        heading_jitter=trial.heading_jitter,
        substeps=trial.substeps,
        ghosts=[control.agent for control, robot in pairs if robot.ghost],
        **_model(simulation, trial),
        **_router(old, trial),
    )
    order_doors(world, old.stage.doors, trial.stage.doors)
    simulation.trial = trial
    if seed is not None:
        simulation.seeds = environment_seeds(seed, simulation.count)
    world.change_bodies(
        {control.agent: robot.body for control, robot in pairs}, trial.stage.physical(), own_walls(trial)
    )
    simulation.robots = [_robot_control(simulation, control, robot, seed) for control, robot in pairs]
    for control in simulation.robots:
        restore_joints(control, world)
    if [robot.goal for robot in old.robots] != [robot.goal for robot in trial.robots]:
        simulation.event[simulation.event == SUCCESS] = NONE


def check_overrides(simulation: Any, new: Trial, added: bool = False) -> None:
    """Raise :class:`InputError` if a value of the new trial cannot change while a simulation runs.

    Args:
        simulation: the simulation.
        new: the new trial.
        added: check that there is room for new robots, too.
    """
    old, time = simulation.trial, float(simulation.world.times.max())
    if simulation.world.walls_fixed:
        parts = {name: getattr(old.stage, name) for name in ("walls", "obstacles", "props", "doors")}
        if dataclasses.replace(new.stage, **parts) != old.stage:
            raise InputError(
                "of the stage of the physics world, only walls, obstacles and props can change while it runs"
            )
        _prop_changes(old, new)
    check_doors(old.stage.doors, new.stage.doors)
    for name in FIXED:
        if getattr(old, name) != getattr(new, name):
            raise InputError(f"{name} cannot change in a branch: it only affects the start; run another trial instead")
    before, after = len(old.sources), len(new.sources)
    if before != after:
        raise InputError(f"the number of sources cannot change in a branch: {before} before, {after} after")
    robots = _match_robots(simulation.robots, new)
    for control, two in robots.kept:
        for name in START:
            if getattr(control.robot, name) != getattr(two, name):
                raise InputError(f"{name} of robot {two.name!r} cannot change in a branch: it only affects the start")
    if added:
        _check_added_robots(simulation, robots)
    for first, second in zip(old.sources, new.sources, strict=True):
        if (first.goal, first.journey, first.arrival) != (second.goal, second.journey, second.arrival):
            raise InputError(f"the goal of source {first.name!r} cannot change in a branch")
        if first.reactions != second.reactions:
            raise InputError(f"the reactions of source {first.name!r} cannot change in a branch")
        if first.behaviors != second.behaviors:
            raise InputError(f"the behaviours of source {first.name!r} cannot change in a branch")
    if crowd_names(old.crowd) != crowd_names(new.crowd):
        raise InputError("the names of crowds cannot change in a branch")
    if new.duration < time:
        raise InputError(f"a duration of {new.duration:g} s ends before the branch begins at {time:g} s")


def _match_robots(controls: Sequence[RobotControl], trial: Trial) -> _Robots:
    """Return which robots stay, go and come, by name."""
    now = {control.robot.name: control for control in controls}
    names = {robot.name for robot in trial.robots}
    return _Robots(
        [(now[robot.name], robot) for robot in trial.robots if robot.name in now],
        [control for control in controls if control.robot.name not in names],
        [robot for robot in trial.robots if robot.name not in now],
    )


def _check_added_robots(simulation: Any, robots: _Robots) -> None:
    """Raise :class:`InputError` unless robots can be added where they start, with names that no robot had before."""
    former = {control.robot.name for control in simulation.former_robots}
    scene = simulation.world.scene
    for robot in robots.added:
        if robot.mirror is not None:
            raise InputError(f"robot {robot.name!r} has <pose>; only robots of the start can be moved from outside")
        if robot.name in former or any(robot.name == control.robot.name for control in robots.removed):
            raise InputError(f"a robot {robot.name!r} was removed from this run; give the new one another name")
        away = np.hypot(*(scene.position - np.array(robot.position)).transpose(2, 0, 1))
        near = scene.active & (away < scene.radius + robot.radius)
        if not robot.ghost and near.any():
            raise InputError(
                f"robot {robot.name!r} cannot be added at x = {robot.x:g}, y = {robot.y:g} m: somebody is there"
            )


def _change_robots(simulation: Simulation, robots: _Robots, trial: Trial) -> None:
    """Remove and add robots; those that stay keep their state."""
    world = simulation.world
    for control in robots.removed:
        world.remove_robot(control.agent)
    simulation.former_robots += robots.removed
    controls = {robot.name: control for control, robot in robots.kept}
    for robot in robots.added:
        agent = world.add_robot(robot.body, robot.x, robot.y, robot.heading, ghost=robot.ghost)
        controls[robot.name] = RobotControl.of(trial, robot, agent, world, simulation.seeds)
    simulation.robots = [controls[robot.name] for robot in trial.robots]


def _prop_changes(old: Trial, new: Trial) -> tuple[list[int], list[Any]]:
    """Return the numbers of the props that are removed, and the new props, which come last.

    Raises:
        InputError: a prop is changed.
    """
    rest, removed = list(new.stage.props), []
    for number, prop in enumerate(old.stage.props):
        if rest and rest[0] == prop:
            rest.pop(0)
        else:
            removed.append(number)
    kept = [prop for number, prop in enumerate(old.stage.props) if number not in removed]
    if [*kept, *rest] != list(new.stage.props) or (removed and rest):
        raise InputError("a prop cannot change in a branch of the physics world; remove it, then add another")
    return removed, rest


def _change_stage(simulation: Simulation, trial: Trial) -> None:
    """Change walls and props of the physics world; the walls of a planar world are replaced as a whole."""
    world: Any = simulation.world
    if not world.walls_fixed or trial.stage == simulation.trial.stage:
        return
    if (trial.stage.walls, trial.stage.obstacles) != (simulation.trial.stage.walls, simulation.trial.stage.obstacles):
        world.change_walls(trial.stage.as_walls(props=False))
    removed, added = _prop_changes(simulation.trial, trial)
    names = world.prop_names
    for number in removed:
        world.remove_prop(names[number])
    for prop in added:
        world.add_prop(prop)


def _scene(simulation: Simulation, trial: Trial) -> Any:
    scene = simulation.world.scene
    if trial.stage != simulation.trial.stage and not simulation.world.walls_fixed:
        scene = scene.replace(walls=trial.stage.as_walls())
    columns = {
        name: getattr(scene, name).copy() for name in ("radius", "goal", "visible", "max_speed", "preferred_speed")
    }
    for control, robot in zip(simulation.robots, trial.robots, strict=True):
        top = limits_of(robot.drive).max_speed
        goal = control.goal if robot.goal == control.robot.goal else robot.goal.position
        values = (robot.radius, goal, robot.visible and not robot.ghost, top, top)
        for name, value in zip(columns, values, strict=True):
            columns[name][:, control.agent] = value
    return scene.replace(**columns)


def _model(simulation: Simulation, trial: Trial) -> dict[str, Any]:
    """Return the crowd model if it changes.

    With several crowds, each person keeps theirs. Differences between people are drawn again as for the first seed.
    """
    if trial.crowd == simulation.trial.crowd:
        return {}
    world: Any = simulation.world
    if not isinstance(trial.crowd, Crowds):
        return {"model": own(trial.crowd, simulation.seeds[0], 0, world.scene.shape[1], {})}
    assert isinstance(world.model, Mixture)
    return {"model": Mixture(trial.crowd.models, world.model.which)}


def _router(old: Trial, new: Trial) -> dict[str, Any]:
    stage = dataclasses.replace(new.stage, doors=old.stage.doors)
    if (old.stage, old.routing) == (stage, new.routing):
        return {}
    return {"router": None if new.routing is None else new.routing.router(new.stage.walking_walls())}


def _robot_control(simulation: Simulation, old: RobotControl, robot: RobotSpec, seed: int | None) -> RobotControl:
    """Return the state of a robot that continues with its current command and the readings of its remaining sensors."""
    known = {sensor.name: sensor for sensor in old.sensors}
    sensors = mounted_sensors(simulation.trial, robot, simulation.world, simulation.seeds, known)
    if seed is not None:
        fresh = mounted_sensors(simulation.trial, robot, simulation.world, simulation.seeds)
        for sensor, new in zip(sensors, fresh, strict=True):
            sensor.rngs = new.rngs
    goal = robot.goal
    same_goal, count = goal == old.robot.goal, simulation.count
    same = type(old.robot.navigator) is type(robot.navigator)
    same = same and (old.robot.safety is None) == (robot.safety is None)
    return dataclasses.replace(
        old.change_memory(simulation.trial, robot),
        robot=robot,
        memories=old.memories if same else [None] * count,
        begun=old.begun if same else np.zeros_like(old.begun),
        limits=limits_of(robot.drive, robot.holonomic),
        control=decision_schedule(robot, simulation.world.clock),
        sensors=sensors,
        arrived=old.arrived if same_goal else np.zeros_like(old.arrived),
        faults=_faults(simulation, old, robot),
        goal=old.goal if same_goal else np.tile(np.array(goal.position, dtype=np.float64), (count, 1)),
        tolerance=old.tolerance if same_goal else np.full(count, goal.tolerance),
    )


def _faults(simulation: Simulation, old: RobotControl, robot: RobotSpec) -> FaultState | None:
    """Return the faults of a robot that continues; random numbers go on where the kinds of faults are the same."""
    new = FaultState.of(robot, simulation.seeds)
    kinds = [[type(spec.fault) for spec in item.faults] for item in (old.robot, robot)]
    if new is not None and old.faults is not None and kinds[0] == kinds[1]:
        new.draws, new.rngs = old.faults.draws, old.faults.rngs
    return new
