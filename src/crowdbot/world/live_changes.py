"""Changes of the people and robots of a running world, between two steps."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, wrap_angle

from .crowd.journey import JOURNEY, STOP
from .crowd.routing import WAY, fresh
from .crowd.source import TOP
from .pushes import PUSH, push_memory
from .world import FARTHEST, World

MOST = 20_000
"""Largest number of people and robots in an environment."""


def slot_of(world: World, person: int, environment: int = 0) -> int:
    """Return the index of a present person or robot in the scene.

    Raises:
        InputError: nobody with this id is present.
    """
    there = world.scene.active[environment] & (world.ids[environment] == person)
    found = np.flatnonzero(there)
    if not len(found):
        known = np.sort(world.ids[environment][world.scene.active[environment]]).tolist()
        some = ", ".join(map(str, known[:10])) + (", ..." if len(known) > 10 else "")
        raise InputError(f"there is nobody with the id {person}; present are {some or 'none'}")
    return int(found[0])


def check_place(x: float, y: float) -> None:
    """Raise :class:`InputError` if a position [m] is not finite, or too far away."""
    if not (math.isfinite(x) and math.isfinite(y) and max(abs(x), abs(y)) <= FARTHEST):
        raise InputError(f"the position x = {x}, y = {y} m must be finite and at most {FARTHEST:g} m away from 0")


def check_goal(world: World, position: tuple[float, float], goal: tuple[float, float], environment: int = 0) -> None:
    """Raise :class:`InputError` if a goal cannot be reached from a position, in a world with routing."""
    check_place(*position)
    check_place(*goal)
    router = getattr(world.part(environment)[0], "router", None)
    if router is not None:
        router.towards(position, goal)


def remove_person(world: World, person: int, environment: int = 0) -> None:
    """Remove a person or robot from the scene.

    >>> from crowdbot.core import Scene
    >>> from crowdbot.models import ORCA
    >>> from crowdbot.world import PlanarWorld
    >>> world = PlanarWorld(Scene.of([[0.0, 0.0], [3.0, 0.0]]), ORCA(), {}, dt=0.1)
    >>> remove_person(world, 1)
    >>> world.scene.active.tolist()
    [[True, False]]
    """
    slot = slot_of(world, person, environment)
    if slot in world.twists:
        world.remove_robot(slot, [environment])
    else:
        _put(world, environment, slot, active=False)


def move_agent(world: World, person: int, x: float, y: float, heading: float | None, environment: int = 0) -> None:
    """Move a person or robot to a position [m] and heading [rad] (default: the old heading), at rest."""
    slot = slot_of(world, person, environment)
    changes: dict[str, Any] = {"position": (x, y), "velocity": 0.0}
    if heading is not None:
        changes["heading"] = wrap_angle(heading)
    _put(world, environment, slot, **changes)
    if slot in world.twists:
        own, row = world.part(environment)
        own.rest_robot(slot, [row])


def redirect_person(world: World, person: int, x: float, y: float, environment: int = 0) -> None:
    """Give a person another goal [m], instead of their journey."""
    slot = slot_of(world, person, environment)
    memory = {JOURNEY: -1.0} if JOURNEY in world.scene.memory else {}
    _put(world, environment, slot, memory, goal=(x, y))


def push_person(
    world: World, person: int, force: tuple[float, float], duration: float, mass: float, height: float,
    environment: int = 0,
) -> None:  # fmt: skip
    """Push a person with a force for a time, from the next step on; a push replaces the rest of an earlier one.

    Args:
        world: the world.
        person: id of the person.
        force: x, y [N].
        duration: time [s].
        mass: mass of the person [kg].
        height: stature [m].
        environment: index of the environment.

    >>> from crowdbot.core import Scene
    >>> from crowdbot.models import ORCA
    >>> from crowdbot.world import PlanarWorld
    >>> standing = Scene.of([[0.0, 0.0]], goal=[[0.0, 0.0]], preferred_speed=[0.0], max_speed=[0.0])
    >>> world = PlanarWorld(standing, ORCA(), {}, dt=0.1)
    >>> push_person(world, 0, (300.0, 0.0), 0.2, 75.0, 1.75)
    >>> [world.step({}).velocity[0, 0, 0].round(2).item() for _ in range(3)]
    [0.39, 0.66, 0.52]
    """
    slot, (own, row) = slot_of(world, person, environment), world.part(environment)
    scene = own.scene
    pushes = push_memory(
        scene.memory.get(PUSH), scene.shape, row, slot, person, np.array(force), duration, mass, height
    )
    own.scene = scene.replace(memory={**scene.memory, PUSH: pushes})


def add_person(
    world: World, position: tuple[float, float], goal: tuple[float, float], speed: float, radius: float,
    environment: int = 0,
) -> int:  # fmt: skip
    """Add a person who walks to a goal, and return the id.

    Args:
        world: the world.
        position, goal: x, y [m].
        speed: preferred speed [m/s].
        radius: [m].
        environment: index of the environment.

    In a world with bodies, a person without a free one gets a random adult body.

    Raises:
        InputError: the environment has :data:`MOST` agents.
    """
    check_room(world, environment)
    slot = _free_slot(world, environment)
    own, row = world.part(environment)
    person: int = own.next_id(row)
    own.assign_ids(slot, [row])
    away = np.array(goal) - np.array(position)
    ahead = away / max(float(np.hypot(*away)), 1e-12)
    memory: dict[str, Any] = dict.fromkeys(world.scene.memory, 0.0)
    start = {JOURNEY: -1.0, STOP: 0.0, WAY: fresh((1, 1))[0, 0], **own.model.memory_at_start}
    memory |= {name: value for name, value in start.items() if name in memory}
    _put(
        world, environment, slot, memory, position=position, velocity=ahead * speed, goal=goal, radius=radius,
        heading=math.atan2(*ahead[::-1].tolist()), preferred_speed=speed, max_speed=TOP * speed, active=True,
        visible=True, external=False, group=-1,
    )  # fmt: skip
    return person


def next_person(world: World, environment: int = 0) -> int:
    """Return the id that the next person or robot gets."""
    own, row = world.part(environment)
    person: int = own.next_id(row)
    return person


def check_room(world: World, environment: int = 0) -> None:
    """Raise :class:`InputError` if an environment has :data:`MOST` agents: nobody can be added."""
    present = int(np.count_nonzero(world.scene.active[environment]))
    if present >= MOST:
        raise InputError(f"nobody can be added: {present} people and robots are present, the limit is {MOST}")


def _free_slot(world: World, environment: int) -> int:
    """Return an index without an agent; arrays and bodies grow if there is none."""
    scene, slots = world.scene, int(world.slots[environment])
    free = np.flatnonzero(~scene.active[environment, :slots] & ~scene.external[environment, :slots])
    if len(free):
        return int(free[0])
    own, row = world.part(environment)
    own.widen(slots + 1)
    own.slots[row] = slots + 1
    own.embody_person(slots, row)
    return slots


def _put(world: World, environment: int, slot: int, memory: Any = None, **values: Any) -> None:
    """Set values of one agent."""
    scene = world.scene

    def changed(array: NDArray[Any], value: Any) -> NDArray[Any]:
        copy = array.copy()
        copy[environment, slot] = value
        return copy

    arrays = {name: changed(getattr(scene, name), value) for name, value in values.items()}
    kept = dict(scene.memory) | {name: changed(scene.memory[name], value) for name, value in (memory or {}).items()}
    world.scene = scene.replace(**arrays, memory=kept)
