"""SearchSpace: a trial and its factors; a point gives a variant of the trial."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from crowdbot.core import InputError
from crowdbot.trials import Trial, apply_values
from crowdbot.typing import Floats

from .factor import Factor

Chain = tuple[str | int, ...]
PROBES = (-0.5, 0.5, 1.25)
"""Points at which the place of a factor in the trial is found and checked."""


@dataclass(frozen=True)
class SearchSpace:
    """A trial with D factors. The seed of the trial is varied, too, and is no coordinate.

    A point is a vector ``[D]`` of standard normal numbers: its density is the likelihood of the variant.

    Fields:
        trial: the trial, without sweeps.
        factors: what is varied.
        trust: whether code from outside the folder of the trial may be loaded.

    Raises:
        InputError: the trial has sweeps or no robot, or two factors have the same path.
        TrialError: a path does not exist, or a value is not allowed.

    >>> from crowdbot.falsification import SearchSpace, parse_factor
    >>> from crowdbot.trials import load_trial
    >>> space = SearchSpace(load_trial("frontal"), (parse_factor("robot/y=uniform(-0.4, 0.4)"),))
    >>> round(space.variant(np.array([3.0])).robots[0].y, 3)
    0.399
    """

    trial: Trial
    factors: tuple[Factor, ...]
    trust: bool = True
    _chains: tuple[Chain | None, ...] = field(init=False, repr=False, compare=False)

    def __post_init__(self) -> None:
        if self.trial.sweeps:
            raise InputError(f"trial {self.trial.name!r} has sweeps; choose one variant, or write them as factors")
        if not self.trial.robots:
            raise InputError(f"trial {self.trial.name!r} has no robot that could fail")
        paths = [factor.path for factor in self.factors]
        for path in paths:
            if paths.count(path) > 1:
                raise InputError(f"factor {path} is there twice")
        object.__setattr__(self, "_chains", tuple(map(self._find_chain, self.factors)))

    def values(self, point: Floats) -> dict[str, float | int | str]:
        """Return the values by path at a point ``[D]``."""
        return {factor.path: factor.value_at(float(z)) for factor, z in zip(self.factors, point, strict=True)}

    def variant_of(self, point: Sequence[float]) -> Trial:
        """Return the variant at the point of a sample."""
        return self.variant(np.array(point, dtype=np.float64))

    def variant(self, point: Floats) -> Trial:
        """Return the variant at a point ``[D]``.

        Raises:
            TrialError: the values are impossible together.
        """
        values = self.values(point)
        slow = {path: value for (path, value), chain in zip(values.items(), self._chains, strict=True) if chain is None}
        trial = apply_values(self.trial, slow, trust=self.trust)
        tree: dict[Any, Any] = {}
        for chain, value in zip(self._chains, values.values(), strict=True):
            if chain is not None:
                _plant(tree, chain, value)
        changed: Trial = _replace(trial, tree) if tree else trial
        return changed

    def _find_chain(self, factor: Factor) -> Chain | None:
        """Return the fields that lead to the value of a factor, None if it is not one number of the trial.

        Setting the number is much faster than reading the whole trial anew; both are compared here.
        """
        rows = [
            apply_values(self.trial, {factor.path: factor.value_at(z)}, place=f"factor {factor.path}", trust=self.trust)
            for z in PROBES
        ]
        found = _differences(rows[0], rows[1])
        if not factor.continuous or len(found) != 1:
            return None
        try:
            same = all(
                _replace(self.trial, _plant({}, found[0], factor.value_at(z))) == row
                for z, row in zip(PROBES, rows, strict=True)
            )
        except (InputError, TypeError):
            return None
        return found[0] if same else None


def _differences(one: Any, two: Any, place: Chain = ()) -> list[Chain]:
    if type(one) is type(two) and dataclasses.is_dataclass(one) and not isinstance(one, type):
        parts = [part.name for part in dataclasses.fields(one) if part.compare and part.init]
        return [row for name in parts for row in _differences(getattr(one, name), getattr(two, name), (*place, name))]
    if type(one) is tuple and type(two) is tuple and len(one) == len(two):
        return [row for k in range(len(one)) for row in _differences(one[k], two[k], (*place, k))]
    return [] if one is two or one == two else [place]


def _plant(tree: dict[Any, Any], chain: Chain, value: Any) -> dict[Any, Any]:
    """Add a value to a tree of values by field or index, and return the tree."""
    here = tree
    for step in chain[:-1]:
        here = here.setdefault(step, {})
    here[chain[-1]] = value
    return tree


def _replace(thing: Any, tree: Any) -> Any:
    """Return an element, or a tuple of elements, with the values of a tree; a value that is no tree replaces it."""
    if not isinstance(tree, dict):
        return tree
    if isinstance(thing, tuple):
        return tuple(_replace(one, tree[k]) if k in tree else one for k, one in enumerate(thing))
    return dataclasses.replace(thing, **{name: _replace(getattr(thing, name), part) for name, part in tree.items()})
