"""Environments of planar worlds: join worlds, select environments, and replace some by new ones."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np

from crowdbot.core import InputError, MissingExtra, Scene, Twist, tree
from crowdbot.models import CrowdModel
from crowdbot.typing import Ints
from crowdbot.world.robots.drives.drive import Twists
from crowdbot.world.robots.drives.servo import Pending

from .crowd.environment_rows import (
    align_scenes,
    pad_ids,
    set_models,
    with_common_time,
    works_in_batches,
)
from .doors.motion import ONE_ENVIRONMENT
from .planar import PlanarWorld


def join_worlds(worlds: Sequence[PlanarWorld]) -> PlanarWorld:
    """Return one world with the environments of several worlds of the same trial, on the clock of the first.

    Worlds with fewer agents are padded with absent ones. The worlds must not be used any more.

    >>> from crowdbot.core import Scene
    >>> from crowdbot.models import ORCA
    >>> parts = [PlanarWorld(Scene.of([[float(k), 0.0]]), ORCA(), {}, dt=0.1, seed=k) for k in range(3)]
    >>> join_worlds(parts).step({}).position[:, 0].tolist()
    [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0]]
    """
    first = worlds[0]
    if len(worlds) == 1:
        return first
    if first.doors is not None:
        raise InputError(ONE_ENVIRONMENT)
    whole = copy.copy(first)
    for world in worlds[1:]:
        world.environment_time.follow(first.clock)
    _set_state(whole, tree.join(_states(worlds)), [model for world in worlds for model in _models(world)])
    if first._bodies is not None:
        whole._bodies = [bodies for world in worlds for bodies in world._bodies or ()]
    return whole


def planar_world(scene: Scene, models: Sequence[CrowdModel], slots: Ints, **how: Any) -> PlanarWorld:
    """Return a world of E environments that can have different crowd models and numbers of agents.

    Args:
        scene: initial scene of E environments.
        models: crowd model of each environment.
        slots: ``[E]`` number of agents of each environment; further ones are absent and external.
        how: other arguments of :class:`PlanarWorld`.

    >>> from crowdbot.models import ORCA
    >>> scene = Scene.of([[[0.0, 0.0]], [[1.0, 0.0]]])
    >>> planar_world(scene, [ORCA(), ORCA(time_horizon=1.0)], np.array([1, 1]), drives={}, dt=0.1).slots.tolist()
    [1, 1]
    """
    world = PlanarWorld(scene, models[0], **how)
    world.slots = slots
    if len(models) > 1:
        set_models(world, list(models))
    return world


def select_environments(world: PlanarWorld, environments: Sequence[int] | Ints) -> PlanarWorld:
    """Return an independent world with some environments; an environment may be selected more than once."""
    index = np.asarray(environments, dtype=np.int64)
    some = copy.copy(world)
    _set_state(some, tree.take(_states([world])[0], index), [_models(world)[e] for e in index])
    some.environment_time.follow()
    some.doors = None if world.doors is None else world.doors.copy()
    if world._bodies is not None:
        some._bodies = [world._bodies[e].copy() for e in index]
        for bodies in some._bodies:
            bodies.doors = some.doors
        some.people = some._bodies[0].people if len(index) else None
    return some


def put_environments(world: PlanarWorld, environments: Sequence[int] | Ints, other: PlanarWorld) -> None:
    """Replace some environments of a running world by those of another world of the same trial."""
    index = np.asarray(environments, dtype=np.int64)
    if world.doors is not None:
        world.scene = world.scene.replace(walls=other.scene.walls)
        world.doors, world.router = other.doors, other.router
    other.environment_time.follow(world.clock)
    models = list(_models(world))
    for k, e in enumerate(index.tolist()):
        models[e] = _models(other)[k]
        if world._bodies is not None and other._bodies is not None:
            world._bodies[e] = other._bodies[k]
    if world._bodies is not None:
        world.people = world._bodies[0].people
    changed = any(model is not world.model for model in models)
    whole, rows = _states([world, other])
    _set_state(world, tree.put(whole, index, rows, len(world.slots)), models if changed else None)


def undo_point(world: PlanarWorld) -> Callable[[], None]:
    """Return a function that takes back the next step."""
    kept = {name: getattr(world, name) for name in ("scene", "_previous", "contacts")}
    twists, delayed, tick = dict(world.twists), dict(world._delayed), world.clock.tick
    ids, following = world._traffic.ids.copy(), world._traffic.following.copy()
    rngs = None if works_in_batches(world.model) else tree.take(world._rngs, slice(None))

    def undo() -> None:
        world._rngs = rngs or world._rngs
        for name, value in kept.items():
            setattr(world, name, value)
        world.twists, world._delayed, world.clock.tick = twists, delayed, tick
        world._traffic.ids[:], world._traffic.following[:] = ids, following

    return undo


def step_one_by_one(
    world: PlanarWorld, commands: Mapping[int, Twist | Twists]
) -> tuple[PlanarWorld, dict[int, Exception]]:
    """Advance each environment alone; return the world, and the exceptions of environments, which lose their agents."""
    parts, errors, count = [], {}, len(world.slots)
    wide = {robot: Twists.of(command, count) for robot, command in commands.items()}
    for e in range(count):
        index = np.array([e])
        part = select_environments(world, index)
        try:
            part.step({robot: tree.take(command, index) for robot, command in wide.items()})
        except MissingExtra:
            raise
        except Exception as error:  # told to the caller
            errors[e] = error
            part.scene = part.scene.replace(active=np.zeros_like(part.scene.active))
        parts.append(part)
    clock = world.clock
    clock.advance()
    whole = join_worlds(parts)
    whole.clock = clock
    return whole, errors


def _models(world: PlanarWorld) -> list[Any]:
    return world._models if world._models is not None else [world.model] * len(world.slots)


def _states(worlds: Sequence[PlanarWorld]) -> list[dict[str, Any]]:
    """Fields with environments of worlds, as trees of one structure: padded, with equally many pending commands."""
    scenes, before = [[getattr(world, name) for world in worlds] for name in ("scene", "_previous")]
    if len(worlds) > 1:
        scenes, before = align_scenes(scenes), align_scenes(before)
    delays, states = _aligned_delays(worlds), []
    for k, world in enumerate(worlds):
        contacts = tree.objects([()] * len(world.slots))
        for contact in world.contacts:
            contacts[contact.environment] += (contact,)
        ids = pad_ids(world._traffic.ids, scenes[k].shape[1])
        states.append(
            {
                "scene": scenes[k], "_previous": before[k], "_traffic": dataclasses.replace(world._traffic, ids=ids),
                "twists": {robot: _aligned_twists(worlds, robot)[k] for robot in world.twists},
                "_delayed": delays[k], "contacts": contacts, "slots": world.slots, "avatars": world.avatars,
                "environment_time": world.environment_time, "_rngs": world._rngs,
            }
        )  # fmt: skip
    return states


def _set_state(world: PlanarWorld, state: dict[str, Any], models: list[Any] | None) -> None:
    """Set the fields with environments, and the model of each environment if it changes."""
    scene = world.scene
    for name, value in state.items():
        setattr(world, name, value)
    world.ids = world._traffic.ids
    world.contacts = tuple(item._replace(environment=e) for e, row in enumerate(state["contacts"]) for item in row)
    world.scene = with_common_time(world.scene, scene)
    world._previous = with_common_time(world._previous, scene).replace(walls=world.scene.walls)
    if models is not None:
        set_models(world, models)


def _aligned_twists(worlds: Sequence[PlanarWorld], robot: int) -> list[Twists]:
    """Twists of a robot in worlds; those of a car have a steering angle after its first step, 0 before."""
    twists = [world.twists[robot] for world in worlds]
    kind = max(map(type, twists), key=lambda one: len(dataclasses.fields(one)))
    names = [field.name for field in dataclasses.fields(kind) if field.init]
    return [
        twist if type(twist) is kind else kind(*(getattr(twist, name, np.zeros_like(twist.forward)) for name in names))
        for twist in twists
    ]


def _aligned_delays(worlds: Sequence[PlanarWorld]) -> list[dict[int, tuple[tuple[Pending, ...], Twists]]]:
    """Delayed commands of worlds, equally many; robots without pending commands stand still until their first one."""
    rows: list[dict[int, tuple[tuple[Pending, ...], Twists]]] = [{} for _ in worlds]
    for robot in {robot for world in worlds for robot in world._delayed}:
        delays = [world._delayed.get(robot, ((), Twist())) for world in worlds]
        longest = max((pending for pending, _ in delays), key=len)
        for row, world, (pending, now) in zip(rows, worlds, delays, strict=True):
            count = len(world.slots)
            commands = [Twist()] * (len(longest) - len(pending)) + [item.command for item in pending]
            both = zip(longest, commands, strict=True)
            row[robot] = (
                tuple(Pending(item.wait, Twists.of(command, count)) for item, command in both),
                Twists.of(now, count),
            )
    return rows
