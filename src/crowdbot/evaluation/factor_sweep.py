"""Factorial sweeps: values of several factors, and a trial for each combination."""

from __future__ import annotations

import dataclasses
import itertools
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass

from crowdbot.core import InputError
from crowdbot.trials import Sweep, Trial

MOST_CELLS = 10_000


@dataclass(frozen=True)
class FactorSweep:
    """A factor and its levels.

    Fields:
        name: path of a value, such as ``robot.visible``, or a parameter of a built-in trial.
        levels: texts of its values.

    >>> parse_factors(["robot.visible=true,false"])
    (FactorSweep(name='robot.visible', levels=('true', 'false')),)
    """

    name: str
    levels: tuple[str, ...]


def parse_factors(texts: Sequence[str]) -> tuple[FactorSweep, ...]:
    """Return the factors in texts ``NAME=VALUES``.

    Values are separated by commas or blanks, ``1:4`` means 1 2 3, as in :class:`crowdbot.trials.Sweep`.

    Raises:
        InputError: a text has another form, or a factor is there twice.

    >>> parse_factors(["count=5,10", "spawner/speed=normal(1.3, 0.2),1"])[1].levels
    ('normal(1.3, 0.2)', '1')
    """
    found = []
    for text in texts:
        name, equals, values = text.partition("=")
        if not (name.strip() and equals and values.strip()):
            raise InputError(f"--sweep {text!r} must be NAME=VALUES, such as robot.visible=true,false")
        blanks = values if ";" in values else re.sub(r",(?![^()]*\))", " ", values)
        found.append(FactorSweep(name.strip(), tuple(dict.fromkeys(Sweep(name.strip(), blanks).each))))
    names = [one.name for one in found]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"--sweep {name} is given twice")
    return tuple(found)


def sweep_trials(
    load: Callable[[Mapping[str, str]], Trial], factors: Sequence[FactorSweep]
) -> list[tuple[Trial, dict[str, str]]]:
    """Return a trial for each combination of levels, with its levels.

    Args:
        load: returns the trial with other values.
        factors: the factors; the last one changes fastest.

    Raises:
        InputError: there are too many combinations.
    """
    count = math.prod(len(factor.levels) for factor in factors)
    if count > MOST_CELLS:
        raise InputError(f"the sweep has {count} combinations, at most {MOST_CELLS} are allowed")
    result: list[tuple[Trial, dict[str, str]]] = []
    for row in itertools.product(*(factor.levels for factor in factors)):
        levels = {factor.name: level for factor, level in zip(factors, row, strict=True)}
        trial = load(levels)
        if trial.sweeps:
            raise InputError(f"trial {trial.name!r} has own sweeps; remove them to sweep with --sweep")
        words = ", ".join(f"{re.split('[./]', name)[-1]} {level}" for name, level in levels.items())
        label = f"{trial.name[:30]} [{words}]"
        short = label if len(label) <= 80 else f"{trial.name[:30]} [{len(result) + 1}]"
        result.append((dataclasses.replace(trial, name=short), levels))
    return result
