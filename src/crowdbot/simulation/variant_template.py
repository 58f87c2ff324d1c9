"""VariantTemplate: the initial worlds of variants of a trial, as environments of one simulation."""

from __future__ import annotations

import copy
import dataclasses
from collections.abc import Collection, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.trials import Crowds, InitialPeople, RandomizedModel, Trial, have_same_kinds
from crowdbot.world import World, join_worlds

from .robot_control import RobotControl
from .world_template import WorldTemplate

OWN = ("name", "about", "seed")
"""Fields of a trial that each variant has for itself."""
FREE = {
    "spawners": ("zone", "speed", "radius"),
    "agents": ("x", "y", "speed", "radius"),
    "robots": ("x", "y", "heading", "goal", "faults"),
}
"""Fields of elements in which variants may differ."""


class VariantTemplate(WorldTemplate):
    """Makes the initial worlds of variants of the same shape, one for each environment.

    Variants can differ in the parameters of the crowd model, in start zones, speeds and radii of people, and in start,
    goal and numbers of faults of robots. Each environment is bit-identical to a simulation of its variant alone.

    Args:
        trials: variant of each environment.
        posed: add bodies of people even if no sensor needs them.

    Raises:
        InputError: there is no variant, or they differ in anything else, such as the stage.

    >>> from crowdbot.simulation import Simulation
    >>> from crowdbot.trials import apply_values, load_trial
    >>> trial = load_trial("frontal", model="orca")
    >>> variants = [apply_values(trial, {"crowd/time-horizon": horizon}) for horizon in (1, 2, 4)]
    >>> simulation = Simulation(VariantTemplate(variants), seeds=[7, 7, 7])
    >>> for _ in range(60):
    ...     simulation.advance()
    >>> len(set(simulation.world.scene.position[:, 0, 1].tolist()))
    3
    """

    def __init__(self, trials: Sequence[Trial], posed: bool = False) -> None:
        self.trials = tuple(trials)
        if not self.trials:
            raise InputError("a simulation of variants needs at least one trial")
        for trial in {id(trial): trial for trial in self.trials[1:]}.values():
            _check_shape(self.trials[0], trial)
        super().__init__(self.trials[0], posed)
        known = {id(trial): WorldTemplate(trial, posed) for trial in self.trials}
        self._each = [known[id(trial)] for trial in self.trials]

    def of_environments(self, environments: Sequence[int] | NDArray[np.int64]) -> VariantTemplate:
        some = copy.copy(self)
        some._each = [self._each[int(e)] for e in environments]
        some.trials = tuple(template.trial for template in some._each)
        some.trial = some.trials[0]
        return some

    def with_environments(self, environments: Sequence[int] | NDArray[np.int64], other: WorldTemplate) -> WorldTemplate:
        trials = list(self.trials)
        for k, e in enumerate(environments):
            trials[int(e)] = other.trial_of(k)
        return VariantTemplate(trials, self.posed)

    def trial_of(self, environment: int) -> Trial:
        return self.trials[environment]

    def set_goals(self, robots: Sequence[RobotControl]) -> None:
        for k, control in enumerate(robots):
            for e, trial in enumerate(self.trials):
                goal = trial.robots[k].goal
                control.goal[e], control.tolerance[e] = goal.position, goal.tolerance
                if control.faults is not None:
                    control.faults.change(e, trial.robots[k])

    def begin(self, seeds: Sequence[int]) -> tuple[World, InitialPeople]:
        """Return the world of one seed for each variant at its start, and the people of the first.

        Raises:
            InputError: there is not one seed for each variant.
            TrialError: people cannot be placed with a seed.
        """
        if len(seeds) != len(self.trials):
            raise InputError(f"{len(seeds)} seeds are given for {len(self.trials)} variants; give one for each")
        rows = [template.begin([seed]) for template, seed in zip(self._each, seeds, strict=True)]
        return join_worlds([world for world, _ in rows]), rows[0][1]


def _check_shape(first: Trial, other: Trial) -> None:
    """Raise :class:`InputError` if two variants cannot be environments of one simulation."""
    for field in dataclasses.fields(Trial):
        name = field.name
        if field.compare and name not in OWN and not _is_alike(getattr(first, name), getattr(other, name), name):
            raise InputError(
                f"the variants {first.name!r} and {other.name!r} differ in {name}; variants in one simulation can"
                " differ in parameters of the crowd model, starts, speeds and radii of people, and in start, goal"
                " and numbers of faults of robots"
            )


def _is_alike(one: Any, two: Any, name: str) -> bool:
    """Return whether two values of a trial are equal, except where variants may differ."""
    if one is two:
        return True
    if name == "crowd" and not isinstance(one, Crowds | RandomizedModel):
        return type(one) is type(two)
    if name not in FREE:
        return bool(one == two)
    return len(one) == len(two) and all(_is_same_but(a, b, FREE[name]) for a, b in zip(one, two, strict=True))


def _is_same_but(one: Any, two: Any, free: Collection[str]) -> bool:
    """Return whether two elements are equal except for some fields; of goals, the tolerance must be equal."""
    if one is two:
        return True
    names = [field.name for field in dataclasses.fields(one) if field.compare and field.name not in free]
    if any(getattr(one, name) != getattr(two, name) for name in names):
        return False
    if "goal" not in free:
        return True
    return bool(one.goal.tolerance == two.goal.tolerance) and have_same_kinds(one.faults, two.faults)
