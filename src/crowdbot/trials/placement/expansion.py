"""Expansion of spawners: every person at the beginning of a trial becomes an agent that can be edited."""

from __future__ import annotations

import dataclasses
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import TrialError
from crowdbot.core.fields import Points
from crowdbot.trials.agent import Agent, AgentParameter, Avatar
from crowdbot.trials.crowd import Crowds, crowd_names
from crowdbot.trials.people import Spawner
from crowdbot.trials.randomized_model import RandomizedModel

from .appearance import PersonAppearance, draw_appearances
from .population import place

if TYPE_CHECKING:
    from crowdbot.models import CrowdModel
    from crowdbot.trials.trial import Trial


def expand_spawners(trial: Trial, seed: int | None = None) -> Trial:
    """Return a trial whose spawners are replaced by agents at the places drawn with a seed.

    The result has this seed and runs exactly like the trial with it. Sources and recorded people are kept.

    Args:
        trial: a trial without sweeps.
        seed: seed of the placement (default: the seed of the trial).

    Raises:
        TrialError: people do not fit with this seed, or the trial has sweeps.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Spawner, Trial, parse_trial, trial_xml
    >>> square = [(0, 0), (2, 0), (2, 2), (0, 2)]
    >>> trial = Trial(name="t", duration=1.0, crowd=ORCA(), spawners=[Spawner(count=2, zone=square, goal=square)])
    >>> one = expand_spawners(trial, seed=3)
    >>> len(one.agents), len(one.spawners), one.seed, parse_trial(trial_xml(one)) == one
    (2, 0, 3, True)
    """
    if trial.sweeps:
        raise TrialError(f"trial {trial.name!r} has sweeps; take one of its variants")
    chosen = trial.seed if seed is None else int(seed)
    people, problems = place(trial.stage, trial.spawners, trial.robots, chosen, trial.agents, avatars=trial.avatars)
    if problems:
        raise TrialError(*(f"trial {trial.name!r}: {sentence}" for _, sentence in problems))
    agents = []
    for a, figure in enumerate(draw_appearances(people, chosen)):
        owner = people.owners[int(people.owner[a])]
        if isinstance(owner, Avatar):
            continue
        agent = _with_appearance(owner if isinstance(owner, Agent) else _agent(people, a, owner), figure)
        agents.append(_with_parameters(trial, agent, a, chosen))
    return dataclasses.replace(trial, agents=tuple(agents), spawners=(), seed=chosen)


def _agent(people: Any, a: int, spawner: Any) -> Agent:
    assert isinstance(spawner, Spawner)
    heading = float(people.heading[a])
    x, y = people.position[a].tolist()
    return Agent(
        name=f"{spawner.name}{a + 1}" if spawner.name else "",
        x=x,
        y=y,
        heading=None if np.isnan(heading) else heading,
        goal=Points.of([people.goal[a].tolist()] if spawner.goal else []),
        goal_zone=spawner.goal if spawner.arrival == "leave" else Points(),
        journey=spawner.journey,
        speed=float(people.speed[a]),
        radius=float(people.radius[a]),
        arrival=spawner.arrival,
        crowd=spawner.crowd,
        group=int(people.group[a]),
        reactions=spawner.reactions,
        behaviors=spawner.behaviors,
    )


def _with_appearance(agent: Agent, figure: PersonAppearance) -> Agent:
    outfit = figure.outfit if figure.outfit >= 0 else None
    return dataclasses.replace(agent, body=figure.body, outfit=outfit, activity=figure.activity)


def _with_parameters(trial: Trial, agent: Agent, a: int, seed: int) -> Agent:
    """Return the agent with the parameters that are drawn for it from the distributions of its crowd."""
    names = crowd_names(trial.crowd)
    k = names.index(agent.crowd) if agent.crowd else 0
    model: CrowdModel = trial.crowd.models[k] if isinstance(trial.crowd, Crowds) else trial.crowd
    if not isinstance(model, RandomizedModel):
        return agent
    given = {parameter.name.replace("-", "_") for parameter in agent.parameters}
    whole = model.resolve(seed, k, a + 1)
    new = [
        AgentParameter(name.replace("_", "-"), float(getattr(whole, name)[a]))
        for name, _ in model.draws
        if name not in given
    ]
    return dataclasses.replace(agent, parameters=(*agent.parameters, *new))
