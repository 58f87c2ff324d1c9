"""Structure of a running simulation: which agents are robots, and which bodies there are.

A state holds values only. People whom orders have added are added again before a restore; a simulation with other
robots or props than at its start has no state, since a new simulation of its trial lacks them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.world import widen

if TYPE_CHECKING:
    from crowdbot.simulation.simulation import Simulation

__all__ = ["add_people", "part_worlds", "structure_problem"]

MOST_AGENTS = 1_000_000


def part_worlds(world: Any) -> Iterator[tuple[str, Any]]:
    """Yield the path and the object of each world: one, or one for each environment with bodies in the engine."""
    if not hasattr(world, "worlds"):
        yield "simulation/world", world
        return
    for e, one in enumerate(world.worlds):
        yield f"simulation/world/worlds/{e}", one


def structure_problem(simulation: Simulation) -> str:
    """Return why a new simulation of the trial has another structure, empty if it has the same."""
    first = simulation.trial.people
    agents = [robot.agent for robot in simulation.robots]
    worlds = [world for _, world in part_worlds(simulation.world)]
    if agents != [first + k for k in range(len(agents))] or any(_has_other_robots(one, agents) for one in worlds):
        return "robots were added or removed while the simulation ran; its state cannot be stored from then on"
    if any(_has_other_props(one, simulation) for one in worlds):
        return "props were added or removed while the simulation ran; its state cannot be stored from then on"
    return ""


def add_people(world: Any, state: Mapping[str, Any]) -> None:
    """Add the slots and the bodies of people whom orders have added before a state."""
    for path, one in part_worlds(world):
        stored = state.get(f"{path}/_traffic/ids")
        agents = stored.shape[1] if isinstance(stored, np.ndarray) and stored.ndim == 2 else 0
        if one.scene.shape[1] < agents <= MOST_AGENTS:
            widen(one, agents)
        for e, place, people in _bodies_of_people(path, one):
            afoot = state.get(f"{place}/afoot")
            for agent in afoot[len(people.afoot) :].tolist() if isinstance(afoot, np.ndarray) else ():
                one.embody_person(agent, e)


def _bodies_of_people(path: str, world: Any) -> list[tuple[int, str, Any]]:
    """Return environment, path and object of the bodies of people."""
    if world._bodies is not None:
        return [(e, f"{path}/_bodies/{e}/people", bodies.people) for e, bodies in enumerate(world._bodies)]
    return [] if world.people is None else [(0, f"{path}/people", world.people)]


def _has_other_robots(world: Any, agents: list[int]) -> bool:
    rigid = getattr(world, "rigid", None)
    return bool(world.added_robots) or (rigid is not None and sorted(rigid.starts) != agents)


def _has_other_props(world: Any, simulation: Simulation) -> bool:
    if getattr(world, "rigid", None) is None:
        return hasattr(world, "_prop_outlines")
    now, begin = world.stage.props, simulation._template.trial.stage.physical().props
    if world._prop_names != [f"prop{number}" for number in range(len(begin))] or len(now) != len(begin):
        return True
    try:
        return bool(now != begin)
    except ValueError:  # props of other classes may not be comparable; their names are as at the start
        return False
