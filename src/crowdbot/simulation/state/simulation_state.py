"""The complete state of a simulation between two steps as a flat mapping of paths to arrays, numbers and texts.

The mapping has no classes of users and no code: a new simulation of the same trial gives all structure, and the mapping
only the values. People whom orders have added are added again before a restore; a simulation with other robots or props
than at its start has no state, since a new simulation of its trial lacks them.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from typing import TYPE_CHECKING, Any

from crowdbot.core import StateError, tree
from crowdbot.world import worlds_of

if TYPE_CHECKING:
    from crowdbot.simulation.simulation import Simulation


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
        for path, world in _part_worlds(simulation.world):
            world.add_stored_people(state, path)
        tree.unflatten(state, simulation, "simulation")
        for _, world in _part_worlds(simulation.world):
            world.finish_restore()
    except StateError:
        raise
    except Exception as error:  # wrong values make their classes fail in many ways
        raise StateError(f"the state is damaged: {type(error).__name__}: {str(error)[:80]}") from error


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
    if agents != [first + k for k in range(len(agents))] or any(world.has_other_robots(agents) for world in worlds):
        return "robots were added or removed while the simulation ran; its state cannot be stored from then on"
    if any(world.has_other_props(simulation.template.trial.stage.physical().props) for world in worlds):
        return "props were added or removed while the simulation ran; its state cannot be stored from then on"
    return ""
