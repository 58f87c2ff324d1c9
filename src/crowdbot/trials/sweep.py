"""Sweeps: one file that stands for many trials, each with other values in the places that are named."""

from __future__ import annotations

import copy
import dataclasses
import itertools
import math
import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from crowdbot.core import Element, InputError, TrialError, did_you_mean, format_xml

from .fields import Mistake, Part, attribute, check, outline, shown
from .partial import readable

if TYPE_CHECKING:
    from .trial import Trial

__all__ = ["Sweep", "changed", "sweep_problems", "variants"]

MOST_VARIANTS = 10_000
CHECKED = 50
"""No more variants than this are checked when a file with sweeps is read."""
STEP = re.compile(r"([A-Za-z][A-Za-z-]*)(?:\[([^\[\]]+)\])?")


@dataclass(frozen=True)
class Sweep:
    """Values that one attribute of a trial takes, one after the other.

    A path leads over elements to an attribute, as in ``duration``, ``crowd/time-horizon``, ``spawner[2]/count`` (the
    second) or ``robot[tim]/navigator/type`` (by name). Values are separated by blanks, or by semicolons where they hold
    blanks themselves; ``1:4`` means 1 2 3. Several sweeps are combined in all ways, the last one changes fastest.

    Raises:
        InputError: there is no value.

    >>> Sweep("spawner[1]/count", "10 20 50").each
    ('10', '20', '50')
    >>> Sweep("seed", "0:3").each, Sweep("spawner/speed", "1.2 normal(1.3, 0.2)").each
    (('0', '1', '2'), ('1.2', 'normal(1.3, 0.2)'))
    """

    path: str = attribute(about="place of the attribute, such as spawner[1]/count")
    values: str = attribute(about="its values")

    def __post_init__(self) -> None:
        check(self)
        _each(self.values)

    @staticmethod
    def mistakes(values: Mapping[str, Any]) -> list[Mistake]:
        """Return what is wrong with the values, whatever else is wrong in its element."""
        try:
            _each(values.get("values", "1"))
        except InputError as error:
            return [(("values",), str(error))]
        return []

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
            raise InputError(f"has {shown(word)}, more than {MOST_VARIANTS} values")
    if not found:
        raise InputError("needs the attribute 'values' with at least one value, such as 10 20 50")
    return tuple(found)


def variants(trial: Trial, trust: bool = True) -> tuple[Trial, ...]:
    """Return a trial without sweeps for every combination of values; the trial itself when it has none.

    Their names tell the values: ``doors [door 1.2, seed 3]``.

    Raises:
        TrialError: a path leads nowhere, a value is not allowed, there are too many combinations.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Trial
    >>> many = Trial(name="t", duration=2.0, crowd=ORCA(), sweeps=[Sweep("crowd/time-horizon", "1 2"),
    ...     Sweep("seed", "0:3")])
    >>> [one.name for one in many.variants()][:2], many.variants()[4].crowd.time_horizon
    (['t [time-horizon 1, seed 0]', 't [time-horizon 1, seed 1]'], 2.0)
    """
    if not trial.sweeps:
        return (trial,)
    rows = _combined(trial)
    return tuple(_variant(trial, row, trust) for row in rows)


def sweep_problems(
    root: Element, sweeps: Sequence[Sweep], others: Callable[[Element], list[str]]
) -> list[tuple[Sweep, str]]:
    """Return what is wrong with sweeps and with the first variants of a trial, each sentence once, with its sweep.

    Args:
        root: the trial as its file has it.
        sweeps: torn where something of them could not be read.
        others: says of a variant what is wrong with it and not with the trial.
    """
    found: list[tuple[Sweep, str]] = []
    there = []
    for sweep in sweeps:
        for _, path in readable([sweep], "path"):
            try:
                _put(copy.deepcopy(root), path, "")
            except InputError as error:
                found.append((sweep, f"{shown(path)} {error}"))
                continue
            there += [sweep for _ in readable([sweep], "each")]
    count = math.prod(len(sweep.each) for sweep in there)
    if count > MOST_VARIANTS:
        return [*found, (there[-1], f"makes {count} variants together with other sweeps, at most {MOST_VARIANTS}")]
    told: dict[str, None] = {}
    for row in itertools.islice(itertools.product(*(sweep.each for sweep in there)), CHECKED if there else 0):
        pairs = [*zip(there, row, strict=True)]
        for sentence in others(_with(root, pairs))[:3]:
            if sentence not in told:
                told[sentence] = None
                found.append(_blamed(root, pairs, sentence, others))
    return found


def _blamed(
    root: Element, pairs: Sequence[tuple[Sweep, str]], sentence: str, others: Callable[[Element], list[str]]
) -> tuple[Sweep, str]:
    """Return the sweep without which a variant is right, and the sentence with its value; with all if it is not one."""
    for k, (sweep, value) in enumerate(pairs):
        if len(pairs) > 1 and sentence not in others(_with(root, [*pairs[:k], *pairs[k + 1 :]])):
            return sweep, f"with {sweep.path}={value}: {sentence}"
    where = ", ".join(f"{sweep.path}={value}" for sweep, value in pairs)
    return pairs[0][0], f"with {where}: {sentence}"


def _with(root: Element, pairs: Sequence[tuple[Sweep, str]]) -> Element:
    """Return the tree of a variant."""
    variant = copy.deepcopy(root)
    variant.children = [inner for inner in variant.children if inner.tag != "sweep"]
    for sweep, value in pairs:
        _put(variant, sweep.path, value)
    return variant


def _combined(trial: Trial) -> list[tuple[str, ...]]:
    count = math.prod(len(sweep.each) for sweep in trial.sweeps)
    if count > MOST_VARIANTS:
        raise TrialError(f"trial {trial.name!r}: its sweeps make {count} variants, at most {MOST_VARIANTS}")
    return list(itertools.product(*(sweep.each for sweep in trial.sweeps)))


def _variant(trial: Trial, values: tuple[str, ...], trust: bool) -> Trial:
    plain = dataclasses.replace(trial, sweeps=())
    pairs = {sweep.path: value for sweep, value in zip(trial.sweeps, values, strict=True)}
    words = ", ".join(f"{path.rpartition('/')[2]} {value}" for path, value in pairs.items())
    one = changed(plain, pairs, trust=trust)
    return dataclasses.replace(one, name=f"{trial.name[:30]} [{words[:46]}]")


def changed(trial: Trial, values: dict[str, str], *, place: str = "variant", trust: bool = True) -> Trial:
    """Return the trial with other values at some paths, read and checked like a file.

    Raises:
        TrialError: a path leads nowhere, or a value is not allowed.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Trial
    >>> changed(Trial(name="t", duration=2.0, crowd=ORCA()), {"crowd/time-horizon": "3"}).crowd.time_horizon
    3.0
    """
    from .xml.reader import read_trial
    from .xml.writer import element_of

    root = element_of(trial)
    for path, value in values.items():
        try:
            _put(root, path, value)
        except InputError as error:
            raise TrialError(f"{trial.name}: {path[:60]!r} {error}") from None
    return read_trial(format_xml(root), place=place, folder=trial.folder, trust=trust)


def _put(root: Element, path: str, value: str) -> None:
    """Set the attribute at a path of the tree of a trial."""
    from .trial import Trial

    *steps, last = path.strip("/").split("/")
    here: Element = root
    kind: Any = Trial
    for step in steps:
        here, kind = _inside(here, kind, step)
    if kind is not None:
        words = [part.word for part in outline(kind) if part.role == "attribute"]
        free = any(part.role == "mounted" for part in outline(kind))
        if last not in words and not free:
            near = did_you_mean(last, words)
            raise InputError(f"names no attribute: <{here.tag}> has no {last!r}{near}; it takes {', '.join(words)}")
    here.attributes[last] = value


def _inside(here: Element, kind: Any, step: str) -> tuple[Element, Any]:
    match = STEP.fullmatch(step)
    parts = {word: part for part in (outline(kind) if kind else ()) for word in part.words}
    if match is None or match[1] not in parts:
        near = did_you_mean(step, parts)
        raise InputError(f"leads nowhere: <{here.tag}> has no element {step[:40]!r}{near}; it has {', '.join(parts)}")
    part: Part = parts[match[1]]
    inner = None if part.role == "plugged" else part.elements[match[1]]
    there = [child for child in here.children if child.tag == match[1]]
    if not there and part.role == "child":
        there = [Element(match[1])]
        here.children.append(there[0])
    which = match[2] or "1"
    if match[2] is None and len(there) > 1:
        raise InputError(f"is not clear: there are {len(there)} <{match[1]}>; say which, as in {match[1]}[1]")
    if which.isdecimal():
        if not 1 <= int(which) <= len(there):
            raise InputError(f"leads nowhere: there are {len(there)} <{match[1]}>")
        return there[int(which) - 1], inner
    named = [child for child in there if child.attributes.get("name") == which]
    if not named:
        names = [child.attributes.get("name", "") for child in there]
        raise InputError(f"leads nowhere: no <{match[1]}> has the name {which!r}{did_you_mean(which, names)}")
    return named[0], inner
