"""Registered environments: the built-in trials with a robot by their names."""

from __future__ import annotations

from typing import Any

import gymnasium

__all__ = ["TASKS", "register_environments"]

TASKS: dict[str, dict[str, Any]] = {
    "CircleCrossing-v0": {"trial": "circle-crossing"},
    "SquareCrossing-v0": {"trial": "square-crossing"},
    "Frontal-v0": {"trial": "frontal"},
    "Intersection-v0": {"trial": "intersection"},
    "OneWayAgainst-v0": {"trial": "one-way-against"},
    "TwoWay-v0": {"trial": "two-way"},
}
"""Arguments of :class:`crowdbot.gym.CrowdEnv` by id, without the namespace."""


def register_environments() -> list[str]:
    """Register ``crowdbot/CircleCrossing-v0`` and others for ``gymnasium.make`` and ``make_vec``; return their ids.

    >>> register_environments()[0]
    'crowdbot/CircleCrossing-v0'
    >>> gymnasium.make("crowdbot/CircleCrossing-v0").spec.id
    'crowdbot/CircleCrossing-v0'
    """
    ids = [f"crowdbot/{name}" for name in TASKS]
    for full, values in zip(ids, TASKS.values(), strict=True):
        if full not in gymnasium.registry:
            gymnasium.register(
                full,
                entry_point="crowdbot.gym.environment:CrowdEnv",
                vector_entry_point="crowdbot.gym.vector_environment:CrowdVectorEnv",
                kwargs=dict(values),
            )
    return ids
