"""Termination: departure of people at their goals, and end conditions of a trial, in all environments at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.trials import Agent, EndCondition, InitialPeople, Spawner, Trial, area
from crowdbot.world import World

__all__ = ["FINISHED", "end_condition_numbers", "goal_zones", "leave_goal_zones"]

Ints = NDArray[np.int64]

ARRIVED = 0.3
"""Distance [m] to the own goal point within which people in a goal zone leave."""
FINISHED = "finished"
"""Outcome of a trial that ends when nobody is left."""


def goal_zones(people: InitialPeople) -> list[tuple[Ints, Any]]:
    """Return the people who leave at their goal, with the prepared goal zones; empty for a point goal."""
    import shapely

    members: dict[Any, list[int]] = {}
    for a, k in enumerate(people.owner.tolist()):
        owner = people.owners[k]
        if isinstance(owner, Spawner | Agent) and owner.goal and owner.arrival == "leave":
            zone = owner.goal_zone if isinstance(owner, Agent) else owner.goal
            members.setdefault(zone, []).append(a)
    zones = [area(points) if points else shapely.Polygon() for points in members]
    shapely.prepare(zones)
    return [(np.array(who, dtype=np.int64), zone) for who, zone in zip(members.values(), zones, strict=True)]


def leave_goal_zones(world: World, zones: Sequence[tuple[Ints, Any]]) -> None:
    """Remove the people who are in the zone of their goal, or at their own goal point in it."""
    if not zones:
        return
    import shapely

    scene, ids = world.scene, world.ids
    gone = np.zeros(scene.shape, dtype=np.bool_)
    for members, zone in zones:
        there = scene.active[:, members] & (ids[:, members] == members)
        if there.any():
            position = scene.position[:, members][there]
            away = np.hypot(*(scene.goal[:, members][there] - position).T)
            leaves = shapely.contains_xy(zone, position[:, 0], position[:, 1]) | (away < ARRIVED)
            rows, columns = np.nonzero(there)
            gone[rows, members[columns]] = leaves
    if gone.any():
        world.scene = scene.replace(active=scene.active & ~gone)


def end_condition_numbers(trial: Trial, world: World, people: InitialPeople, robots: Mapping[str, int]) -> Ints | None:
    """Return the number of the end condition that holds in each environment ``[E]``.

    It is 0 for none, 1 if nobody is left, and 2 + k for condition k of the trial. None if the trial has no conditions.

    Args:
        trial: trial with end conditions.
        world: current world.
        people: initial and recorded people.
        robots: agent index of each robot by name, in the order of the trial.
    """
    if not trial.end.empty and not trial.end.conditions:
        return None
    met = np.zeros(len(world.slots), dtype=np.int64)
    if trial.end.empty:
        met[(_people_count(world) == 0) & ~_expects_people(trial, world, people)] = 1
    for number, condition in enumerate(trial.end.conditions):
        value = _value(condition, world, robots)
        if value is not None:
            below = condition.below
            holds = value < below if below is not None else value > (condition.above or 0.0)
            met[(met == 0) & holds] = 2 + number
    return met


def _people_count(world: World) -> Ints:
    scene = world.scene
    return np.asarray(np.count_nonzero(scene.active & ~scene.external, axis=1))


def _expects_people(trial: Trial, world: World, people: InitialPeople) -> NDArray[np.bool_]:
    """Return ``[E]`` whether more people can enter."""
    found = world.waiting_count > 0
    for e, time in enumerate(world.times.tolist()):
        walks = any(walk.time[0] > time for walk in people.walks)
        come = (source.arrival_count(trial.duration) > source.arrival_count(time) for source in trial.sources)
        found[e] |= walks or any(come)
    return np.asarray(found)


def _value(condition: EndCondition, world: World, robots: Mapping[str, int]) -> NDArray[Any] | None:
    if condition.what == "time":
        return world.times
    if condition.what == "people":
        return _people_count(world)
    agent = robots.get(condition.robot) if condition.robot else next(iter(robots.values()), None)
    return None if agent is None else world.scene.position[:, agent, 0 if condition.what == "x" else 1]
