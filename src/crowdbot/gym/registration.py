"""Registered environments: standard tasks of the field and built-in trials by their names.

``CrowdNavCircle5-v0`` and others are the crossings of CrowdNav (Chen et al. 2019, doi:10.1109/ICRA.2019.8794134) with
holonomic actions; ``ChallengeBoth100-v0`` and others are the scenarios of the CrowdBot challenge.
"""

from __future__ import annotations

from typing import Any

import gymnasium

from crowdbot.trials import builtin_trials

TASKS: dict[str, dict[str, Any]] = {
    "CircleCrossing-v0": {"trial": "circle-crossing"},
    "SquareCrossing-v0": {"trial": "square-crossing"},
    "Frontal-v0": {"trial": "frontal"},
    "Intersection-v0": {"trial": "intersection"},
    "OneWayAgainst-v0": {"trial": "one-way-against"},
    "TwoWay-v0": {"trial": "two-way"},
    **{
        f"CrowdNav{kind.title()}{people}-v0": {"trial": f"crowdnav-{kind}-{people}", "action": "holonomic"}
        for kind in ("circle", "square")
        for people in (5, 10, 20)
    },
    **{
        "".join(word.title() for word in name.split("-")) + "-v0": {"trial": name}
        for name in builtin_trials()
        if name.startswith("challenge-")
    },
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
