"""The complete state of a simulation between two steps as a flat mapping of paths to arrays, numbers and texts.

The mapping has no classes of users and no code: a new simulation of the same trial gives all structure, and the mapping
only the values. People whom orders have added are added again before a restore; a simulation with other robots or props
than at its start has no state, since a new simulation of its trial lacks them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import Scene, StateError, tree
from crowdbot.world import show_doors, widen, worlds_of

if TYPE_CHECKING:
    from crowdbot.simulation.simulation import Simulation

MOST_AGENTS = 1_000_000


def state_of(simulation: Simulation) -> dict[str, Any]:
    """Return the complete state of a simulation between two steps.

    Raises:
        StateError: a part of the state is an object of an unknown class, such as the memory of a navigator that is not
            made of plain values; or robots or props were added or removed while the simulation ran.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.simulation import Simulation
    >>> from crowdbot.trials import Trial
    >>> simulation = Simulation(Trial(name="empty", duration=1.0, crowd=ORCA()))
    >>> simulation.advance()
    >>> state_of(simulation)["simulation/world/environment_time/ticks"].tolist()
    [1]
    """
    if problem := _structure_problem(simulation):
        raise StateError(problem)
    return tree.flatten(simulation, "simulation")


def restore_state(simulation: Simulation, state: Mapping[str, Any]) -> None:
    """Continue a simulation from a stored state of the same trial and seeds.

    Random numbers, people, robots, sensors and the physics engine continue exactly. If the state is refused, the
    simulation must not be used any more.

    Args:
        simulation: a new simulation of the trial, with the changes of the trial up to the state.
        state: from :func:`state_of`.

    Raises:
        StateError: the state does not belong to this trial, or is damaged.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.simulation import Simulation, state_of
    >>> from crowdbot.trials import Trial
    >>> trial = Trial(name="empty", duration=1.0, crowd=ORCA())
    >>> first, second = Simulation(trial), Simulation(trial)
    >>> first.advance()
    >>> restore_state(second, state_of(first))
    >>> second.tick
    1
    """
    try:
        _add_people(simulation.world, state)
        tree.unflatten(state, simulation, "simulation")
        for _, world in _part_worlds(simulation.world):
            _update_engine(world)
            if world.doors is not None:
                show_doors(world, new_paths=False)
            _check_scene(world.scene)
            _check_scene(world._previous)
    except StateError:
        raise
    except Exception as error:  # wrong values make their classes fail in many ways
        raise StateError(f"the state is damaged: {type(error).__name__}: {str(error)[:80]}") from error


def _update_engine(world: Any) -> None:
    """Compute the frames of all bodies of a world; the models get the limbs of people as after a step."""
    rigid = getattr(world, "rigid", None)
    if rigid is None:
        return
    with rigid.engine_steps():
        pass
    for ghost in rigid.ghosts.values():
        ghost.step_alone(0)


def _check_scene(scene: Scene) -> None:
    """Raise :class:`StateError` if the arrays of a scene do not fit together."""
    for name, array in scene.memory.items():
        if not isinstance(name, str) or not isinstance(array, np.ndarray) or array.shape[:2] != scene.shape:
            raise StateError(f"the memory {name!r} of people has no row for each person")
    scene.check()


def _part_worlds(world: Any) -> Iterator[tuple[str, Any]]:
    """Yield the path and the object of each world: one, or one for each environment with bodies in the engine."""
    worlds = worlds_of(world)
    if worlds == [world]:
        yield "simulation/world", world
        return
    for e, item in enumerate(worlds):
        yield f"simulation/world/worlds/{e}", item


def _structure_problem(simulation: Simulation) -> str:
    """Return why a new simulation of the trial has another structure, empty if it has the same."""
    first = simulation.trial.people
    agents = [robot.agent for robot in simulation.robots]
    worlds = [world for _, world in _part_worlds(simulation.world)]
    if agents != [first + k for k in range(len(agents))] or any(_has_other_robots(world, agents) for world in worlds):
        return "robots were added or removed while the simulation ran; its state cannot be stored from then on"
    if any(_has_other_props(world, simulation) for world in worlds):
        return "props were added or removed while the simulation ran; its state cannot be stored from then on"
    return ""


def _add_people(world: Any, state: Mapping[str, Any]) -> None:
    """Add the slots and the bodies of people whom orders have added before a state."""
    for path, item in _part_worlds(world):
        stored = state.get(f"{path}/_traffic/ids")
        agents = stored.shape[1] if isinstance(stored, np.ndarray) and stored.ndim == 2 else 0
        if item.scene.shape[1] < agents <= MOST_AGENTS:
            widen(item, agents)
        for e, place, people in _bodies_of_people(path, item):
            afoot = state.get(f"{place}/afoot")
            for agent in afoot[len(people.afoot) :].tolist() if isinstance(afoot, np.ndarray) else ():
                item.embody_person(agent, e)


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
