"""Termination: departure of people at their goals, and end conditions of a trial."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.trials import Agent, EndCondition, InitialPeople, Spawner, Trial, area
from crowdbot.world import PlanarWorld

__all__ = ["end_outcome", "goal_zones"]


def goal_zones(people: InitialPeople) -> list[tuple[NDArray[np.int64], Any]]:
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


def end_outcome(trial: Trial, world: PlanarWorld, people: InitialPeople, robots: Mapping[str, int]) -> str | None:
    """Return the outcome of the end conditions of a trial, or None if none of them holds.

    Args:
        trial: trial with end conditions.
        world: current world.
        people: initial and recorded people.
        robots: agent index of each robot by name, in the order of the trial.
    """
    if trial.end.empty and _count_people(world) == 0 and not _expects_people(trial, world, people):
        return "finished"
    for condition in trial.end.conditions:
        value = _value(condition, world, robots)
        if value is not None and condition.holds(value):
            return condition.outcome
    return None


def _count_people(world: PlanarWorld) -> int:
    scene = world.scene
    return int(np.count_nonzero(scene.active[0] & ~scene.external[0]))


def _expects_people(trial: Trial, world: PlanarWorld, people: InitialPeople) -> bool:
    """Return whether more people can enter."""
    time = world.clock.time
    walks = any(walk.time[0] > time for walk in people.walks)
    come = (source.arrival_count(trial.duration) > source.arrival_count(time) for source in trial.sources)
    return walks or any(come) or bool(world.waiting_count[0] > 0)


def _value(condition: EndCondition, world: PlanarWorld, robots: Mapping[str, int]) -> float | None:
    if condition.what == "time":
        return world.clock.time
    if condition.what == "people":
        return float(_count_people(world))
    agent = robots.get(condition.robot) if condition.robot else next(iter(robots.values()), None)
    return None if agent is None else float(world.scene.position[0, agent, 0 if condition.what == "x" else 1])
