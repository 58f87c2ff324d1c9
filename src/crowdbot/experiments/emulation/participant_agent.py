"""The avatar of the participant of a trial, and its agent."""

from __future__ import annotations

from crowdbot.core import InputError
from crowdbot.trials import Avatar, Trial


def participant_agent(trial: Trial) -> tuple[Avatar, int]:
    """Return the avatar of the participant, the first ``external`` one, and the index of its agent.

    Agents come in the order of agents, spawners, avatars, recorded people, robots.

    Raises:
        InputError: the trial has no such avatar, or no robot.
    """
    chosen = [k for k, one in enumerate(trial.avatars) if one.source == "external"]
    if not chosen or not trial.robots:
        raise InputError(
            f"trial {trial.name!r} has {len(chosen)} avatars with the source 'external' and {len(trial.robots)} "
            "robots; at least one of each is needed"
        )
    first = len(trial.agents) + sum(spawner.count for spawner in trial.spawners)
    return trial.avatars[chosen[0]], first + chosen[0]
