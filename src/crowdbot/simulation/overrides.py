"""Changing: a trial with other values, and a simulation that goes on by it."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Mapping
from typing import Any

import numpy as np

from crowdbot.core import Element, InputError, did_you_mean, format_xml
from crowdbot.models import Mixture
from crowdbot.trials import Crowds, Robot, Trial, crowd_names, parse_trial_xml

from .mounted_sensor import probes_of
from .simulation import Carrier, Simulation
from .world_builder import limits_of

__all__ = ["changed", "turn_to"]

FIXED = ("world", "physics_step", "bodies", "step", "capacity", "spawners", "agents", "recorded", "journeys")
"""What cannot change once people are under way."""
START = ("name", "type", "x", "y", "heading")
"""What cannot change of a robot that is under way."""
WORD = re.compile(r"([A-Za-z0-9_-]+)(?:\[([^\]]+)\])?")


def changed(trial: Trial, changes: Mapping[str, Any]) -> Trial:
    """Return a trial with other values, named as in its XML.

    Args:
        trial: the one to begin with.
        changes: by path: elements and at last an attribute, with dots between; of several elements with one name the
            one is chosen by its name or number (from 0) in brackets, such as ``robot[pepper].navigator.max-speed``.
            With slashes it is a path as of a sweep, whose numbers count from 1: ``robot[1]/navigator/max-speed``.

    Raises:
        InputError: there is no such element.
        TrialError: the new trial is impossible.

    >>> from crowdbot.models import ORCA
    >>> trial = Trial(name="alone", duration=2.0, crowd=ORCA())
    >>> new = changed(trial, {"duration": 3, "crowd.time-horizon": 1.5, "end.goal": False})
    >>> new.duration, new.crowd.time_horizon, new.end.goal
    (3.0, 1.5, False)
    """
    if not changes:
        return trial
    root = parse_trial_xml(trial.xml().encode(), "trial")
    for path, value in changes.items():
        _set(root, path, _text(value))
    return Trial.parse(format_xml(root), place=f"trial {trial.name!r} with changes", folder=trial.folder, trust=True)


def _set(root: Element, path: str, text: str) -> None:
    first, dot = (1, "/") if "/" in path else (0, ".")
    *steps, last = [word.replace("_", "-") for word in path.strip().strip("/").split(dot)]
    element = root
    for step in steps:
        element = _inner(element, step, path, first)
    if re.fullmatch(r"[A-Za-z][A-Za-z0-9-]*", last) is None:
        raise _no_path(path)
    other = last == "type" and element.tag != "robot" and element.attributes.get("type") != text
    if other:  # the values of another type mean nothing to this one
        own = ("name", "link", "x", "y", "z", "roll", "pitch", "heading") if element.tag == "sensor" else ("name",)
        element.attributes = {key: value for key, value in element.attributes.items() if key in own}
    element.attributes[last] = text


def _no_path(path: str) -> InputError:
    return InputError(f"{path!r} is no path; write elements and an attribute, such as robot[NAME]/goal/x")


def _inner(element: Element, step: str, path: str, first: int) -> Element:
    match = WORD.fullmatch(step)
    if match is None:
        raise _no_path(path)
    tag, which = match.groups()
    found = [inner for inner in element.children if inner.tag == tag]
    if which is not None:
        found = [
            one
            for k, one in enumerate(found, first)
            if which in (str(k), one.attributes.get("name", "").replace("_", "-"))
        ]
    if len(found) == 1:
        return found[0]
    if found:
        names = ", ".join(f"{tag}[{one.attributes.get('name', k)}]" for k, one in enumerate(found, first))
        raise InputError(f"{path!r}: <{element.tag}> has {len(found)} <{tag}>; choose one: {names}")
    if (
        which is None
        and tag in ("stage", "routing", "contact", "limits", "end", "recording")
        and element.tag == "trial"
    ):
        element.children.append(Element(tag))  # left out, since everything in it was as usual
        return element.children[-1]
    known = [f"{inner.tag}[{inner.attributes['name']}]" if "name" in inner.attributes else inner.tag
             for inner in element.children]  # fmt: skip
    has = ", ".join(known) or "no elements"
    raise InputError(f"{path!r}: <{element.tag}> has no {step}{did_you_mean(step, known)}; it has {has}")


def _text(value: Any) -> str:
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    if isinstance(value, float):
        return repr(float(value))
    return str(value)


def turn_to(simulation: Simulation, trial: Trial, seed: int | None = None) -> None:
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
    world.turn_to(
        _scene(simulation, trial),
        [source.source(trial.journeys, crowd_names(trial.crowd)) for source in trial.sources],
        seed,
        model=_model(simulation, trial),
        drives={carrier.agent: robot.drive for carrier, robot in zip(simulation.carriers, trial.robots, strict=True)},
        latency={
            carrier.agent: robot.latency for carrier, robot in zip(simulation.carriers, trial.robots, strict=True)
        },
        berth=trial.berth,
        contact=None if trial.contact is None else trial.contact.bodies(),
        limits=None if trial.limits is None else trial.limits.kept(),
        exits=[way.out() for way in trial.exits],
        symmetry=trial.symmetry,
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


def _carrier(simulation: Simulation, old: Carrier, robot: Robot, seed: int | None) -> Carrier:
    """Return a robot that goes on: what it holds and what its sensors said, as far as it still has them."""
    clock, names = simulation.world.clock, {mount.name for mount in robot.sensors}
    probes = probes_of(
        simulation.trial, robot, simulation.world, simulation.seed, {one.mount.name: one for one in old.probes}
    )
    if seed is not None:
        fresh = probes_of(simulation.trial, robot, simulation.world, seed)
        probes = tuple(dataclasses.replace(one, rng=new.rng) for one, new in zip(probes, fresh, strict=True))
    return dataclasses.replace(
        old,
        robot=robot,
        limits=limits_of(robot.drive),
        control_every=clock.every(robot.control_period),
        probes=probes,
        readings={name: reading for name, reading in old.readings.items() if name in names},
        seen={name: ids for name, ids in old.seen.items() if name in names},
        arrived=old.arrived and robot.goal == old.robot.goal,
    )
