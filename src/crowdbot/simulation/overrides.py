"""Overrides: continue a running simulation with changed values of its trial."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from crowdbot.core import InputError
from crowdbot.models import Mixture
from crowdbot.trials import Crowds, RobotSpec, Trial, crowd_names
from crowdbot.world import environment_seeds

from .mounted_sensor import mounted_sensors
from .robot_control import RobotControl, decision_schedule
from .robot_joints import restore_joints
from .simulation import NONE, SUCCESS, Simulation
from .world_builder import limits_of, own_walls

__all__ = ["apply_overrides", "check_overrides"]

FIXED = ("world", "physics_step", "bodies", "step", "capacity", "spawners", "agents", "recorded", "avatars", "journeys")
"""Values of a trial that cannot change during a run."""
START = ("name", "type", "x", "y", "heading")
"""Values of a robot that cannot change during a run."""


def apply_overrides(simulation: Simulation, trial: Trial, seed: int | None = None) -> None:
    """Continue a simulation with another trial, and with new random numbers if a seed is given.

    Positions, internal states and current commands are kept. Values that only affect the start cannot change: time
    step, capacity, spawners, journeys, and the number of robots and sources.

    Raises:
        InputError: a value changes that only affects the start.
    """
    old, world = simulation.trial, simulation.world
    if trial == old and seed is None:
        return
    check_overrides(simulation, trial)
    world.reconfigure(
        _scene(simulation, trial),
        [source.source(trial.journeys, crowd_names(trial.crowd)) for source in trial.sources],
        seed,
        model=_model(simulation, trial),
        drives={control.agent: robot.drive for control, robot in zip(simulation.robots, trial.robots, strict=True)},
        latency={control.agent: robot.latency for control, robot in zip(simulation.robots, trial.robots, strict=True)},
        robot_margin=trial.robot_margin,
        contact=None if trial.contact is None else trial.contact.bodies(),
        limits=None if trial.limits is None else trial.limits.limits(),
        exits=[way.out() for way in trial.exits],
        heading_jitter=trial.heading_jitter,
        substeps=trial.substeps,
        ghosts=[control.agent for control, robot in zip(simulation.robots, trial.robots, strict=True) if robot.ghost],
        **_router(old, trial),
    )
    simulation.trial = trial
    if seed is not None:
        simulation.seeds = environment_seeds(seed, simulation.count)
    bodies = {robot.agent: spec.body for robot, spec in zip(simulation.robots, trial.robots, strict=True)}
    world.change_bodies(bodies, trial.stage.physical(), own_walls(trial))
    simulation.robots = [
        _robot_control(simulation, control, robot, seed)
        for control, robot in zip(simulation.robots, trial.robots, strict=True)
    ]
    for control in simulation.robots:
        restore_joints(control, world)
    if [robot.goal for robot in old.robots] != [robot.goal for robot in trial.robots]:
        simulation.event[simulation.event == SUCCESS] = NONE


def check_overrides(simulation: Any, new: Trial) -> None:
    """Raise :class:`InputError` if a value of the new trial cannot change while a simulation runs."""
    old, time = simulation.trial, float(simulation.world.times.max())
    if new.stage != old.stage and simulation.world.walls_fixed:
        raise InputError("the stage cannot change in a branch of the physics world")
    for name in FIXED:
        if getattr(old, name) != getattr(new, name):
            raise InputError(f"{name} cannot change in a branch: it only affects the start; run another trial instead")
    for name in ("robots", "sources"):
        before, after = len(getattr(old, name)), len(getattr(new, name))
        if before != after:
            raise InputError(f"the number of {name} cannot change in a branch: {before} before, {after} after")
    for one, two in zip(old.robots, new.robots, strict=True):
        for name in START:
            if getattr(one, name) != getattr(two, name):
                raise InputError(f"{name} of robot {one.name!r} cannot change in a branch: it only affects the start")
    for first, second in zip(old.sources, new.sources, strict=True):
        if (first.goal, first.journey, first.arrival) != (second.goal, second.journey, second.arrival):
            raise InputError(f"the goal of source {first.name!r} cannot change in a branch")
    if crowd_names(old.crowd) != crowd_names(new.crowd):
        raise InputError("the names of crowds cannot change in a branch")
    if new.duration < time:
        raise InputError(f"a duration of {new.duration:g} s ends before the branch begins at {time:g} s")


def _scene(simulation: Simulation, trial: Trial) -> Any:
    scene = simulation.world.scene
    if trial.stage != simulation.trial.stage:
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


def _model(simulation: Simulation, trial: Trial) -> Any:
    """Return the crowd model; with several crowds, each person keeps theirs."""
    if not isinstance(trial.crowd, Crowds):
        return trial.crowd
    known: Any = simulation.world
    known = known.model
    assert isinstance(known, Mixture)
    return Mixture(trial.crowd.models, known.which)


def _router(old: Trial, new: Trial) -> dict[str, Any]:
    if (old.stage, old.routing) == (new.stage, new.routing):
        return {}
    return {"router": None if new.routing is None else new.routing.router(new.stage.as_walls())}


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
    return dataclasses.replace(
        old.change_memory(simulation.trial, robot),
        robot=robot,
        memories=old.memories if same else [None] * count,
        begun=old.begun if same else np.zeros_like(old.begun),
        limits=limits_of(robot.drive, robot.holonomic),
        control=decision_schedule(robot, simulation.world.clock),
        sensors=sensors,
        arrived=old.arrived if same_goal else np.zeros_like(old.arrived),
        goal=old.goal if same_goal else np.tile(np.array(goal.position, dtype=np.float64), (count, 1)),
        tolerance=old.tolerance if same_goal else np.full(count, goal.tolerance),
    )
