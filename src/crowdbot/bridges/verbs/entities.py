"""Entities of a simulation as ``simulation_interfaces`` sees them: robots by name, people as ``person_ID``."""

from __future__ import annotations

import math
import re
from collections.abc import Mapping
from typing import Any, NamedTuple

import numpy as np

from crowdbot.bridges.commands import read_number
from crowdbot.core import InputError, did_you_mean
from crowdbot.simulation import Simulation

from .results import UnsupportedFeature

ROBOT, HUMAN = 2, 3
"""Categories of ``simulation_interfaces/EntityCategory``."""
BOX, SPHERE = 1, 3
"""Types of ``simulation_interfaces/Bounds`` that are supported, besides none."""
LONGEST, MOST_REPEATS = 200, 4
"""Largest length of a name filter, and of the number of its repetitions, which bounds the time of a search."""


class Entity(NamedTuple):
    """A robot or person.

    Fields:
        name: name of the robot, or ``person_`` and the id.
        category: :data:`ROBOT` or :data:`HUMAN`.
        number: id in the simulation.
        slot: index in the scene.
    """

    name: str
    category: int
    number: int
    slot: int


def entities(simulation: Simulation) -> list[Entity]:
    """Return robots, then people by id.

    >>> from crowdbot.trials import load_trial
    >>> [one.name for one in entities(Simulation(load_trial("frontal"), 0))]
    ['robot', 'person_0']
    """
    world = simulation.world
    ids, active = world.ids[0], world.scene.active[0]
    found = [
        Entity(one.robot.name, ROBOT, int(ids[one.agent]), one.agent) for one in simulation.robots if active[one.agent]
    ]
    robots = {one.slot for one in found} | {one.agent for one in simulation.robots}
    slots = sorted((int(slot) for slot in np.flatnonzero(active[: world.slots[0]])), key=lambda slot: int(ids[slot]))
    return found + [Entity(f"person_{ids[slot]}", HUMAN, int(ids[slot]), slot) for slot in slots if slot not in robots]


def entity_of(simulation: Simulation, name: Any) -> Entity:
    """Return the entity of a name.

    Raises:
        LookupError: there is none.
    """
    known = {one.name: one for one in entities(simulation)}
    if name not in known:
        raise LookupError(f"there is no entity {str(name)[:80]!r}{did_you_mean(str(name)[:80], known)}")
    return known[name]


def filter_entities(simulation: Simulation, filters: Mapping[str, Any]) -> list[Entity]:
    """Return the entities that match ``simulation_interfaces/EntityFilters``.

    Raises:
        UnsupportedFeature: the filter has tags, or bounds that are neither a box nor a sphere.
        InputError: the name filter or a value is not allowed.
    """
    tags, bounds = filters.get("tags") or {}, filters.get("bounds") or {}
    if tags.get("tags"):
        raise UnsupportedFeature("entities have no tags")
    points = bounds.get("points") or []
    if points and (bounds.get("type") not in (BOX, SPHERE) or len(points) != 2):
        raise UnsupportedFeature("bounds must be a box (1) or a sphere (3) with two points")
    found = entities(simulation)
    if filters.get("filter"):
        wanted = _compile(filters["filter"])
        found = [one for one in found if wanted.search(one.name)]
    if filters.get("categories"):
        kinds = {one.get("category") if isinstance(one, Mapping) else one for one in filters["categories"]}
        found = [one for one in found if one.category in kinds]
    if points:
        found = [one for one in found if _distance(simulation, one, bounds["type"], points) <= 0.0]
    return found


def _distance(simulation: Simulation, entity: Entity, kind: int, points: Any) -> float:
    """Return the distance of an entity from a box or sphere in the plane [m], not above 0 if they overlap."""
    x, y = simulation.world.scene.position[0, entity.slot].tolist()
    first, second = ((read_number(one, "x"), read_number(one, "y")) for one in points)
    if kind == SPHERE:
        gap = math.dist((x, y), first) - second[0]
    else:
        edges = [sorted(pair) for pair in zip(first, second, strict=True)]
        gap = math.hypot(
            *(max(low - value, 0.0, value - high) for value, (low, high) in zip((x, y), edges, strict=True))
        )
    return gap - float(simulation.world.scene.radius[0, entity.slot])


def _compile(text: Any) -> re.Pattern[str]:
    """Return a regular expression that cannot take long on a name."""
    if not isinstance(text, str) or len(text) > LONGEST:
        raise InputError(f"a name filter must be a text of at most {LONGEST} characters")
    if re.search(r"\)[*+?{]|\\\d|\(\?", text) or len(re.findall(r"[*+{]", text)) > MOST_REPEATS:
        raise InputError(f"a name filter can repeat single characters only, at most {MOST_REPEATS} times")
    try:
        return re.compile(text)
    except (re.error, RecursionError, OverflowError) as error:
        raise InputError(f"the name filter is no regular expression: {error}") from None


def state_of_entity(simulation: Simulation, entity: Entity) -> dict[str, Any]:
    """Return ``simulation_interfaces/EntityState`` in the frame of the map."""
    world, slot = simulation.world, entity.slot
    scene, now = world.scene, int(simulation.ticks[0]) * world.clock.step_ns
    (x, y), (vx, vy) = scene.position[0, slot].tolist(), scene.velocity[0, slot].tolist()
    half = 0.5 * float(scene.heading[0, slot])
    turn = float(world.twists[slot].turn[0]) if slot in world.twists else 0.0
    return {
        "header": {"stamp": {"sec": now // 10**9, "nanosec": now % 10**9}, "frame_id": "map"},
        "pose": {
            "position": {"x": x, "y": y, "z": 0.0},
            "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)},
        },
        "twist": {"linear": {"x": vx, "y": vy, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": turn}},
        "acceleration": {},
    }
