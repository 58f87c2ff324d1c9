"""Overrides: a running simulation continues with other values of its trial."""

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
"""What cannot change once people are under way."""
START = ("name", "type", "x", "y", "heading")
"""What cannot change of a robot that is under way."""


def apply_overrides(simulation: Simulation, trial: Trial, seed: int | None = None) -> None:
    """Let a simulation go on by another trial from where it is, with new chance when a seed is given.

    Everybody stays where they are and keeps what they remember, robots the commands they hold. What only the beginning
    decides cannot change: step, capacity, spawners, journeys, and how many robots and sources there are.

    Raises:
        InputError: something else than values that count from now on is changed.
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
        drives={carrier.agent: robot.drive for carrier, robot in zip(simulation.carriers, trial.robots, strict=True)},
        latency={
            carrier.agent: robot.latency for carrier, robot in zip(simulation.carriers, trial.robots, strict=True)
        },
        robot_margin=trial.robot_margin,
        contact=None if trial.contact is None else trial.contact.bodies(),
        limits=None if trial.limits is None else trial.limits.limits(),
        exits=[way.out() for way in trial.exits],
        heading_jitter=trial.heading_jitter,
        substeps=trial.substeps,
        **_router(old, trial),
    )
    simulation.turn_to(trial, simulation.seed if seed is None else seed)
    simulation.carriers = [
        _carrier(simulation, carrier, robot, seed)
        for carrier, robot in zip(simulation.carriers, trial.robots, strict=True)
    ]
    if [robot.goal for robot in old.robots] != [robot.goal for robot in trial.robots] and simulation.event == "success":
        simulation.event = None


def _check(old: Trial, new: Trial, time: float) -> None:
    for name in FIXED:
        if getattr(old, name) != getattr(new, name):
            raise InputError(f"{name} cannot change in a branch: it counts at the beginning; run another trial instead")
    for name in ("robots", "sources"):
        before, after = len(getattr(old, name)), len(getattr(new, name))
        if before != after:
            raise InputError(f"{name} cannot be added or removed in a branch: {before} before, {after} after")
    for one, two in zip(old.robots, new.robots, strict=True):
        for name in START:
            if getattr(one, name) != getattr(two, name):
                raise InputError(f"{name} of robot {one.name!r} cannot change in a branch: it is where the robot began")
    for first, second in zip(old.sources, new.sources, strict=True):
        if (first.goal, first.journey, first.arrival) != (second.goal, second.journey, second.arrival):
            raise InputError(f"the goal of source {first.name!r} cannot change in a branch")
    if crowd_names(old.crowd) != crowd_names(new.crowd):
        raise InputError("the names of crowds cannot change in a branch: people are in them already")
    if new.duration < time:
        raise InputError(f"a duration of {new.duration:g} s is over at {time:g} s, where the branch begins")


def _scene(simulation: Simulation, trial: Trial) -> Any:
    scene = simulation.world.scene
    if trial.stage != simulation.trial.stage:
        if simulation.world.walls_fixed:
            raise InputError(
                "the stage cannot change in a branch of the physics world: its walls and props have bodies"
            )
        scene = scene.replace(walls=trial.stage.as_walls())
    columns = {
        name: getattr(scene, name).copy() for name in ("radius", "goal", "visible", "max_speed", "preferred_speed")
    }
    for carrier, robot in zip(simulation.carriers, trial.robots, strict=True):
        top = limits_of(robot.drive).max_speed
        values = (robot.radius, robot.goal.position, robot.visible, top, top)
        for name, value in zip(columns, values, strict=True):
            columns[name][:, carrier.agent] = value
    return scene.replace(**columns)


def _model(simulation: Simulation, trial: Trial) -> Any:
    """Return by what everybody walks; with several crowds everybody stays in the own."""
    if not isinstance(trial.crowd, Crowds):
        return trial.crowd
    known = simulation.world.model
    assert isinstance(known, Mixture)
    return Mixture(trial.crowd.models, known.which)


def _router(old: Trial, new: Trial) -> dict[str, Any]:
    if (old.stage, old.routing) == (new.stage, new.routing):
        return {}
    return {"router": None if new.routing is None else new.routing.router(new.stage.as_walls())}


def _carrier(simulation: Simulation, old: RobotRuntime, robot: RobotSpec, seed: int | None) -> RobotRuntime:
    """Return a robot that goes on: what it holds and what its sensors said, as far as it still has them."""
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
