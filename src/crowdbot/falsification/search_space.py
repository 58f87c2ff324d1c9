"""SearchSpace: a trial and its factors, values with distributions; a point gives a variant of the trial."""

from __future__ import annotations

import dataclasses
import math
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from scipy import special

from crowdbot.core import InputError, did_you_mean, parse_number
from crowdbot.trials import Distribution, Trial, apply_values
from crowdbot.typing import Floats

CALL = re.compile(r"\s*([A-Za-z][A-Za-z-]*)\s*\((.*)\)\s*", re.DOTALL)
KINDS = ("uniform", "normal", "log-uniform", "integer", "choice")
EDGE = 1e-15
"""Distance of a share from 0 and 1 at least."""


@dataclass(frozen=True)
class Factor:
    """A value of a trial with its distribution, as the image of a standard normal number.

    Kinds: ``uniform`` (low, high), ``normal`` (mean, standard deviation, optionally low and high), ``log-uniform``
    (low, high), ``integer`` (low, high, both included) and ``choice`` (equally likely texts).

    Fields:
        path: path of the value in the trial, as in a sweep.
        kind: kind of the distribution.
        arguments: texts of its numbers, or the choices.

    Raises:
        InputError: the kind is unknown, or the numbers are too few, not finite or in the wrong order.

    >>> speed = parse_factor("agent[1]/speed=uniform(0.8, 1.6)")
    >>> round(speed.value_at(0.0), 12), parse_factor("crowd/type=choice(orca, boids)").value_at(2.0)
    (1.2, 'boids')
    """

    path: str
    kind: str
    arguments: tuple[str, ...]

    def __post_init__(self) -> None:
        if self.kind not in KINDS:
            raise InputError(
                f"factor {self.path}: {self.kind!r} is not a distribution{did_you_mean(self.kind, KINDS)};"
                f" known are {', '.join(KINDS)}"
            )
        if self.kind == "choice":
            if len(set(self.arguments)) < 2 or len(set(self.arguments)) < len(self.arguments):
                raise InputError(f"factor {self.path}: choice needs at least two different values")
            return
        try:
            if self.kind in ("uniform", "normal"):
                Distribution.parse(self.text)
                return
            low, high = self._bounds()
        except InputError as error:
            raise InputError(f"factor {self.path}: {error}") from None
        if self.kind == "log-uniform" and low <= 0.0:
            raise InputError(f"factor {self.path}: {self.text} has a low end {low:g} that is not above 0")
        if self.kind == "integer" and (low != round(low) or high != round(high)):
            raise InputError(f"factor {self.path}: {self.text} must have whole numbers")
        if not low < high:
            raise InputError(f"factor {self.path}: {self.text} has its low end {low:g} not below its high end {high:g}")

    @property
    def text(self) -> str:
        """The distribution as text."""
        return f"{self.kind}({', '.join(self.arguments)})"

    @property
    def continuous(self) -> bool:
        """Whether the value is a real number."""
        return self.kind in ("uniform", "normal", "log-uniform")

    def value_at(self, z: float) -> float | int | str:
        """Return the value for a standard normal number.

        >>> wide, few = parse_factor("x=log-uniform(0.1, 10)"), parse_factor("x=integer(2, 5)")
        >>> [round(wide.value_at(0.0), 12), few.value_at(9.0)]
        [1.0, 5]
        """
        share = min(max(float(special.ndtr(z)), EDGE), 1.0 - EDGE)
        if self.kind == "choice":
            return self.arguments[min(int(share * len(self.arguments)), len(self.arguments) - 1)]
        if self.kind in ("uniform", "normal"):
            return float(Distribution.parse(self.text).values_at(np.array([share]))[0])
        low, high = self._bounds()
        if self.kind == "integer":
            return int(low) + min(int(share * (high - low + 1)), int(high - low))
        return float(np.clip(low * math.exp(share * math.log(high / low)), low, high))

    def _bounds(self) -> tuple[float, float]:
        if len(self.arguments) != 2:
            raise InputError(f"{self.kind} takes 2 numbers, not {len(self.arguments)}")
        low, high = (parse_number(text) for text in self.arguments)
        if not (math.isfinite(low) and math.isfinite(high)):
            raise InputError(f"{self.text} is not finite")
        return low, high


def parse_factor(text: str) -> Factor:
    """Return the factor of a text such as ``agent[1]/speed=uniform(0.8, 1.6)``.

    Raises:
        InputError: the text has another form; see also :class:`Factor`.

    >>> parse_factor("robot/x=normal(0, 0.1)").text
    'normal(0, 0.1)'
    """
    path, equals, distribution = text.partition("=")
    match = CALL.fullmatch(distribution)
    if not (path.strip() and equals and match):
        raise InputError(f"factor {text!r} must be PATH=DISTRIBUTION, such as agent[1]/speed=uniform(0.8, 1.6)")
    if path.strip() == "seed":
        raise InputError(f"factor {text!r}: the seed is always a factor; leave it out")
    words = tuple(word.strip() for word in match[2].split(","))
    if not all(words):
        raise InputError(f"factor {text!r} has an empty value")
    return Factor(path.strip(), match[1].lower(), words)


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
        differences = _differences(rows[0], rows[1])
        if not factor.continuous or len(differences) != 1:
            return None
        try:
            same = all(
                _replace(self.trial, _plant({}, differences[0], factor.value_at(z))) == row
                for z, row in zip(PROBES, rows, strict=True)
            )
        except (InputError, TypeError):
            return None
        return differences[0] if same else None


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
        return tuple(_replace(item, tree[k]) if k in tree else item for k, item in enumerate(thing))
    return dataclasses.replace(thing, **{name: _replace(getattr(thing, name), part) for name, part in tree.items()})
