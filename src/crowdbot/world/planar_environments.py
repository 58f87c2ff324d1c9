"""Environments of planar worlds: join worlds, select environments, and replace some by new ones."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Callable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, MissingExtra, Scene, Twist, tree
from crowdbot.models import CrowdModel
from crowdbot.world.robots.drives.drive import Twists
from crowdbot.world.robots.drives.servo import Pending

from .crowd.environment_rows import (
    pad_ids,
    put_scene,
    set_models,
    stack_scenes,
    works_in_batches,
)
from .crowd.people_flow import PeopleFlow
from .doors.motion import ONE_ENVIRONMENT
from .planar import PlanarWorld

__all__ = [
    "join_worlds",
    "planar_world",
    "put_environments",
    "select_environments",
    "step_one_by_one",
    "undo_point",
]

Ints = NDArray[np.int64]
Delayed = Mapping[int, tuple[tuple[Pending, ...], Twist | Twists]]


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
    whole.scene = stack_scenes([world.scene for world in worlds])
    whole._previous = stack_scenes([world._previous for world in worlds]).replace(walls=whole.scene.walls)
    whole.environment_time = first.environment_time.join([world.environment_time for world in worlds[1:]])
    whole._rngs = first._rngs.join([world._rngs for world in worlds[1:]])
    set_models(whole, [model for world in worlds for model in _models(world)])
    _set_flow(whole, _join_flows([world._traffic for world in worlds], whole.scene.shape[1]))
    whole.twists = {robot: tree.join([world.twists[robot] for world in worlds]) for robot in first.twists}
    whole._delayed = _join_delays(worlds)
    whole.slots = np.concatenate([world.slots for world in worlds])
    whole.contacts, begin = (), 0
    for world in worlds:
        whole.contacts += tuple(one._replace(environment=begin + one.environment) for one in world.contacts)
        begin += len(world.slots)
    if first.avatars is not None:
        whole.avatars = first.avatars.join([world.avatars for world in worlds[1:] if world.avatars is not None])
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
    some.scene = world.scene.environments(index)
    some._previous = world._previous.environments(index)
    some.environment_time = world.environment_time.select(index)
    some._rngs = world._rngs.select(index.tolist())
    set_models(some, [_models(world)[e] for e in index])
    flow = world._traffic
    arrivals = None if flow.arrivals is None else flow.arrivals.select(index.tolist())
    changed: dict[str, Any] = {name: getattr(flow, name)[index] for name in ("seeds", "ids", "following")}
    _set_flow(some, dataclasses.replace(flow, arrivals=arrivals, **changed))
    some.twists = {robot: tree.take(twists, index) for robot, twists in world.twists.items()}
    some._delayed = {robot: _take_delay(delay, index, world) for robot, delay in world._delayed.items()}
    some.slots = world.slots[index]
    some.avatars = None if world.avatars is None else world.avatars.select(index)
    some.doors = None if world.doors is None else world.doors.copy()
    rows: dict[int, list[int]] = {}
    for k, e in enumerate(index.tolist()):
        rows.setdefault(e, []).append(k)
    contacts = (one._replace(environment=k) for one in world.contacts for k in rows.get(one.environment, ()))
    some.contacts = tuple(sorted(contacts))
    if world._bodies is not None:
        some._bodies = [world._bodies[e].copy() for e in index]
        for bodies in some._bodies:
            bodies.doors = some.doors
    return some


def put_environments(world: PlanarWorld, environments: Sequence[int] | Ints, other: PlanarWorld) -> None:
    """Replace some environments of a running world by those of another world of the same trial."""
    index = np.asarray(environments, dtype=np.int64)
    agents = max(world.scene.shape[1], other.scene.shape[1])
    walls = world.scene.walls if world.doors is None else other.scene.walls
    world.doors, world.router = other.doors, world.router if other.doors is None else other.router
    world.scene = put_scene(world.scene, index, other.scene).replace(walls=walls)
    world._previous = put_scene(world._previous, index, other._previous).replace(walls=walls)
    world.environment_time.put(index, other.environment_time)
    models = list(_models(world))
    flow, new = world._traffic, other._traffic
    flow.ids = pad_ids(flow.ids, agents)
    flow.ids[index] = pad_ids(new.ids, agents)
    flow.seeds[index], flow.following[index] = new.seeds, new.following
    if flow.arrivals is not None and new.arrivals is not None:
        flow.arrivals.put(index.tolist(), new.arrivals)
    _set_flow(world, flow)
    world._rngs.put(index.tolist(), other._rngs)
    for k, e in enumerate(index.tolist()):
        models[e] = _models(other)[k]
        if world._bodies is not None and other._bodies is not None:
            world._bodies[e] = other._bodies[k]
    if any(model is not world.model for model in models):
        set_models(world, models)
    world.slots[index] = other.slots
    if world.avatars is not None and other.avatars is not None:
        world.avatars.put(index, other.avatars)
    world.twists = {robot: _put_twists(twists, index, other.twists[robot]) for robot, twists in world.twists.items()}
    world._delayed = {robot: _reset_delay(delay, index, world) for robot, delay in world._delayed.items()}
    fresh = set(index.tolist())
    world.contacts = tuple(one for one in world.contacts if one.environment not in fresh)


def undo_point(world: PlanarWorld) -> Callable[[], None]:
    """Return a function that takes back the next step."""
    kept = {name: getattr(world, name) for name in ("scene", "_previous", "contacts")}
    twists, delayed, tick = dict(world.twists), dict(world._delayed), world.clock.tick
    ids, following = world._traffic.ids.copy(), world._traffic.following.copy()
    rngs = None if works_in_batches(world.model) else world._rngs.select(range(len(world._rngs)))

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


def _set_flow(world: PlanarWorld, flow: PeopleFlow) -> None:
    world._traffic = flow
    world.ids = flow.ids


def _join_flows(flows: Sequence[PeopleFlow], agents: int) -> PeopleFlow:
    first = flows[0]
    return dataclasses.replace(
        first,
        seeds=np.concatenate([flow.seeds for flow in flows]),
        ids=np.concatenate([pad_ids(flow.ids, agents) for flow in flows]),
        following=np.concatenate([flow.following for flow in flows]),
        arrivals=None if first.arrivals is None else first.arrivals.join([f.arrivals for f in flows[1:] if f.arrivals]),
    )


def _put_twists(twists: Twists, index: Ints, rows: Twists) -> Twists:
    """Replace the twists of some environments; those of a car have a steering angle after its first step, 0 before."""
    kind = type(twists) if isinstance(twists, type(rows)) else type(rows)
    names = [field.name for field in dataclasses.fields(kind) if field.init]
    whole, part = (kind(*(getattr(one, name, np.zeros_like(one.forward)) for name in names)) for one in (twists, rows))
    return tree.put(whole, index, part)


def _join_delays(worlds: Sequence[PlanarWorld]) -> dict[int, tuple[tuple[Pending, ...], Twist | Twists]]:
    """Return the delayed commands of all worlds; worlds without pending commands have stopped robots."""
    found: dict[int, tuple[tuple[Pending, ...], Twist | Twists]] = {}
    for robot in {robot for world in worlds for robot in world._delayed}:
        rows = [world._delayed.get(robot, ((), Twist())) for world in worlds]
        counts = [len(world.slots) for world in worlds]
        most = max((pending for pending, _ in rows), key=len)
        pending = []
        for k in range(1, len(most) + 1):  # from the latest command backwards
            parts = [
                Twists.of(row[-k].command if k <= len(row) else Twist(), n)
                for (row, _), n in zip(rows, counts, strict=True)
            ]
            pending.append(Pending(most[-k].wait, tree.join(parts)))
        now = tree.join([Twists.of(command, n) for (_, command), n in zip(rows, counts, strict=True)])
        found[robot] = (tuple(reversed(pending)), now)
    return found


def _take_delay(delay: Any, index: Ints, world: PlanarWorld) -> Any:
    pending, now = delay
    count = len(world.slots)
    rows = tuple(Pending(one.wait, tree.take(Twists.of(one.command, count), index)) for one in pending)
    return rows, tree.take(Twists.of(now, count), index)


def _reset_delay(delay: Any, index: Ints, world: PlanarWorld) -> Any:
    """Return delayed commands in which restarted robots stand still until their first command arrives."""
    pending, now = delay
    count, still = len(world.slots), Twists.of(Twist(), len(index))
    rows = tuple(Pending(one.wait, tree.put(Twists.of(one.command, count), index, still)) for one in pending)
    return rows, tree.put(Twists.of(now, count), index, still)
