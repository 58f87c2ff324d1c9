"""Overrides: continue a running simulation with changed values of its trial."""

from __future__ import annotations

import dataclasses
from typing import Any

from crowdbot.core import InputError
from crowdbot.models import Mixture
from crowdbot.trials import Crowds, RobotSpec, Trial, crowd_names

from .mounted_sensor import mounted_sensors
from .simulation import RobotRuntime, Simulation
from .world_builder import limits_of

__all__ = ["apply_overrides"]

FIXED = ("world", "physics_step", "bodies", "step", "capacity", "spawners", "agents", "recorded", "journeys")
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
    _check(old, trial, simulation.world.clock.time)
    world.reconfigure(
        _scene(simulation, trial),
        [source.source(trial.journeys, crowd_names(trial.crowd)) for source in trial.sources],
        seed,
        model=_model(simulation, trial),
        drives={runtime.agent: robot.drive for runtime, robot in zip(simulation.robots, trial.robots, strict=True)},
        latency={runtime.agent: robot.latency for runtime, robot in zip(simulation.robots, trial.robots, strict=True)},
        robot_margin=trial.robot_margin,
        contact=None if trial.contact is None else trial.contact.bodies(),
        limits=None if trial.limits is None else trial.limits.limits(),
        exits=[way.out() for way in trial.exits],
        heading_jitter=trial.heading_jitter,
        substeps=trial.substeps,
        **_router(old, trial),
    )
    simulation.replace_trial(trial, simulation.seed if seed is None else seed)
    simulation.robots = [
        _robot_runtime(simulation, runtime, robot, seed)
        for runtime, robot in zip(simulation.robots, trial.robots, strict=True)
    ]
    if [robot.goal for robot in old.robots] != [robot.goal for robot in trial.robots] and simulation.event == "success":
        simulation.event = None


def _check(old: Trial, new: Trial, time: float) -> None:
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
        if simulation.world.walls_fixed:
            raise InputError("the stage cannot change in a branch of the physics world")
        scene = scene.replace(walls=trial.stage.as_walls())
    columns = {
        name: getattr(scene, name).copy() for name in ("radius", "goal", "visible", "max_speed", "preferred_speed")
    }
    for runtime, robot in zip(simulation.robots, trial.robots, strict=True):
        top = limits_of(robot.drive).max_speed
        values = (robot.radius, robot.goal.position, robot.visible, top, top)
        for name, value in zip(columns, values, strict=True):
            columns[name][:, runtime.agent] = value
    return scene.replace(**columns)


def _model(simulation: Simulation, trial: Trial) -> Any:
    """Return the crowd model; with several crowds, each person keeps theirs."""
    if not isinstance(trial.crowd, Crowds):
        return trial.crowd
    known = simulation.world.model
    assert isinstance(known, Mixture)
    return Mixture(trial.crowd.models, known.which)


def _router(old: Trial, new: Trial) -> dict[str, Any]:
    if (old.stage, old.routing) == (new.stage, new.routing):
        return {}
    return {"router": None if new.routing is None else new.routing.router(new.stage.as_walls())}


def _robot_runtime(simulation: Simulation, old: RobotRuntime, robot: RobotSpec, seed: int | None) -> RobotRuntime:
    """Return the state of a robot that continues with its current command and the readings of its remaining sensors."""
    clock, names = simulation.world.clock, {mount.name for mount in robot.sensors}
    probes = mounted_sensors(
        simulation.trial, robot, simulation.world, simulation.seed, {one.mount.name: one for one in old.probes}
    )
    if seed is not None:
        fresh = mounted_sensors(simulation.trial, robot, simulation.world, seed)
        probes = tuple(dataclasses.replace(one, rng=new.rng) for one, new in zip(probes, fresh, strict=True))
    same = type(old.robot.navigator) is type(robot.navigator)
    return dataclasses.replace(
        old,
        robot=robot,
        memory=old.memory if same else None,
        begun=old.begun and same,
        limits=limits_of(robot.drive),
        control_every=clock.every(robot.control_period),
        probes=probes,
        readings={name: reading for name, reading in old.readings.items() if name in names},
        seen={name: ids for name, ids in old.seen.items() if name in names},
        arrived=old.arrived and robot.goal == old.robot.goal,
    )
