"""Variants of a trial for paired runs: without people, with a ghost as robot, with the robot 1 mm aside."""

from __future__ import annotations

import dataclasses
import math

from crowdbot.trials import Trial

__all__ = ["empty_variant", "ghost_variant", "shifted_variant"]

SHIFT = 0.001
"""Shift of the start [m] for the chaos floor."""


def empty_variant(trial: Trial) -> Trial:
    """Return the trial without people.

    >>> from crowdbot.trials import load_trial
    >>> empty_variant(load_trial("circle-crossing")).people
    0
    """
    return dataclasses.replace(trial, agents=(), spawners=(), sources=(), recorded=(), avatars=())


def ghost_variant(trial: Trial) -> Trial:
    """Return the trial with the first robot as a ghost: placed as before, but unseen and untouchable.

    >>> from crowdbot.trials import load_trial
    >>> ghost_variant(load_trial("frontal")).robots[0].ghost
    True
    """
    first, *rest = trial.robots
    return dataclasses.replace(trial, robots=(dataclasses.replace(first, ghost=True), *rest))


def shifted_variant(trial: Trial) -> Trial:
    """Return the trial with the first robot 1 mm to the left of its start.

    >>> from crowdbot.trials import load_trial
    >>> shifted_variant(load_trial("frontal")).robots[0].y
    0.001
    """
    first, *rest = trial.robots
    x, y = first.x - SHIFT * math.sin(first.heading), first.y + SHIFT * math.cos(first.heading)
    return dataclasses.replace(trial, robots=(dataclasses.replace(first, x=x, y=y), *rest))
