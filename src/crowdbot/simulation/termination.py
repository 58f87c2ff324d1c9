"""Leaving: who leaves because the goal is reached, and when a trial ends before its duration is over."""

from __future__ import annotations

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.trials import Agent, InitialPeople, Spawner, area

if TYPE_CHECKING:
    from crowdbot.trials import EndCondition

    from .simulation import Simulation

__all__ = ["end_outcome", "goal_zones"]


def goal_zones(people: InitialPeople) -> list[tuple[NDArray[np.int64], Any]]:
    """Return those who leave in a goal zone of theirs, and that zone, prepared; an empty one for a goal alone."""
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


def end_outcome(simulation: Simulation) -> str | None:
    """Return the outcome that the conditions of a trial make now, None while none of them holds."""
    end = simulation.trial.end
    if end.empty and _here(simulation) == 0 and not _coming(simulation):
        return "finished"
    for when in end.conditions:
        value = _value(simulation, when)
        if value is not None and when.holds(value):
            return when.outcome
    return None


def _here(simulation: Simulation) -> int:
    scene = simulation.world.scene
    return int(np.count_nonzero(scene.active[0] & ~scene.external[0]))


def _coming(simulation: Simulation) -> bool:
    """Whether anybody may still come in."""
    time = simulation.world.clock.time
    walks = any(walk.time[0] > time for walk in simulation.people.walks)
    come = (source.expected(simulation.trial.duration) > source.expected(time) for source in simulation.trial.sources)
    return walks or any(come) or bool(simulation.world.waiting[0] > 0)


def _value(simulation: Simulation, when: EndCondition) -> float | None:
    if when.what == "time":
        return simulation.world.clock.time
    if when.what == "people":
        return float(_here(simulation))
    for carrier in simulation.carriers:
        if when.robot in ("", carrier.robot.name):
            return float(simulation.world.scene.position[0, carrier.agent, 0 if when.what == "x" else 1])
    return None
