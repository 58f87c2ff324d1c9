"""Sweeps: one file describes many trials with different values of some attributes."""

from __future__ import annotations

import copy
import itertools
import math
import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from crowdbot.core import Element, InputError
from crowdbot.core.fields import attribute, check, quote_value

from .value_path import set_value, set_values

MOST_VARIANTS = 10_000
CHECKED = 50
"""Number of variants that are checked when a file with sweeps is read."""


@dataclass(frozen=True)
class Sweep:
    """Values of one attribute of a trial; each value makes a variant of the trial.

    A path names elements and an attribute, as in ``duration``, ``crowd/time-horizon``, ``spawner[2]/count`` (the
    second) or ``robot[tim]/navigator/type`` (by name). Values are separated by blanks, or by semicolons if they contain
    blanks; ``1:4`` means 1 2 3. Several sweeps make all combinations; the last one changes fastest.

    Raises:
        InputError: there is no value.

    >>> Sweep("spawner[1]/count", "10 20 50").each
    ('10', '20', '50')
    >>> Sweep("seed", "0:3").each, Sweep("spawner/speed", "1.2 normal(1.3, 0.2)").each
    (('0', '1', '2'), ('1.2', 'normal(1.3, 0.2)'))
    """

    path: str = attribute(about="path of the attribute, such as spawner[1]/count")
    values: str = attribute(about="values, separated by blanks")

    def __post_init__(self) -> None:
        check(self)
        _each(self.values)

    @property
    def each(self) -> tuple[str, ...]:
        """The values."""
        return _each(self.values)


def _each(values: str) -> tuple[str, ...]:
    found: list[str] = []
    for word in values.split(";") if ";" in values else re.findall(r"[^\s(]+\([^()]*\)|\S+", values):
        span = None if ";" in values else re.fullmatch(r"(-?\d{1,9}):(-?\d{1,9})", word)
        if span is None:
            found += [word.strip()] if word.strip() else []
        elif int(span[2]) - int(span[1]) <= MOST_VARIANTS:
            found += [str(k) for k in range(int(span[1]), int(span[2]))]
        else:
            raise InputError(f"has {quote_value(word)}, more than {MOST_VARIANTS} values")
    if not found:
        raise InputError("needs the attribute 'values' with at least one value, such as 10 20 50")
    return tuple(found)


def sweep_problems(
    root: Element, kind: type, sweeps: Sequence[Sweep], others: Callable[[Element], list[str]]
) -> list[tuple[Sweep, str]]:
    """Return the problems of sweeps and of the first variants of a trial, each once, with its sweep.

    Args:
        root: XML tree of the trial.
        kind: class of the trial.
        sweeps: the sweeps of the trial, which itself has no problem.
        others: function that returns the problems of a variant.
    """
    result: list[tuple[Sweep, str]] = []
    there = []
    for sweep in sweeps:
        try:
            set_value(copy.deepcopy(root), kind, sweep.path, "")
        except InputError as error:
            result.append((sweep, f"{quote_value(sweep.path)} {error}"))
        else:
            there.append(sweep)
    count = math.prod(len(sweep.each) for sweep in there)
    if count > MOST_VARIANTS:
        return [*result, (there[-1], f"makes {count} variants together with other sweeps, at most {MOST_VARIANTS}")]
    known: dict[str, None] = {}
    for row in itertools.islice(itertools.product(*(sweep.each for sweep in there)), CHECKED if there else 0):
        pairs = [*zip(there, row, strict=True)]
        for sentence in others(_with(root, kind, pairs))[:3]:
            if sentence not in known:
                known[sentence] = None
                result.append(_find_cause(root, kind, pairs, sentence, others))
    return result


def _find_cause(
    root: Element, kind: type, pairs: Sequence[tuple[Sweep, str]], sentence: str, others: Callable[[Element], list[str]]
) -> tuple[Sweep, str]:
    """Return the sweep that causes a problem, and the sentence with its value; with all values if several do."""
    for k, (sweep, value) in enumerate(pairs):
        if len(pairs) > 1 and sentence not in others(_with(root, kind, [*pairs[:k], *pairs[k + 1 :]])):
            return sweep, f"with {sweep.path}={value}: {sentence}"
    where = ", ".join(f"{sweep.path}={value}" for sweep, value in pairs)
    return pairs[0][0], f"with {where}: {sentence}"


def _with(root: Element, kind: type, pairs: Sequence[tuple[Sweep, str]]) -> Element:
    """Return the tree of a variant."""
    variant = copy.deepcopy(root)
    variant.children = [inner for inner in variant.children if inner.tag != "sweep"]
    set_values(variant, kind, {sweep.path: value for sweep, value in pairs})
    return variant
