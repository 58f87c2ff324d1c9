"""Variants: a trial with other values or elements at some paths, and the variants of a trial with sweeps."""

from __future__ import annotations

import dataclasses
import itertools
import math
from collections.abc import Collection, Mapping
from typing import Any

from crowdbot.core import InputError, TrialError, format_xml
from crowdbot.core.fields import outline
from crowdbot.trials.value_path import element_at, remove_at

from .parser import parse_trial
from .robots.robot_parts import remarks_at_end
from .sweep import MOST_VARIANTS
from .trial import Trial
from .value_path import set_values, text_of
from .xml.trial_text import parse_trial_xml
from .xml.writer import element_of, trial_xml

MOST_TEXT = 1_000_000
"""Largest XML text of an element [characters]."""


def add_element(trial: Trial, xml: str, path: str = "", *, place: str = "element", trust: bool = True) -> Trial:
    """Return a trial with one more element, checked like a file.

    Args:
        trial: the original trial.
        xml: the element, such as ``<cube x="1" y="2"/>``.
        path: path of the element that gets it, such as ``stage``; empty for the trial itself.
        place: name for messages.
        trust: whether code and files from outside the folder of the trial may be loaded.

    Raises:
        TrialError: the text is not an XML element, the path does not exist, or the new trial has an error.

    >>> from crowdbot.models import ORCA
    >>> trial = Trial(name="t", duration=2.0, crowd=ORCA())
    >>> add_element(trial, '<cube x="1" y="2"/>', "stage").stage.props[0].x
    1.0
    """
    if len(xml) > MOST_TEXT:
        raise TrialError(f"{place}: the XML has {len(xml)} characters, at most {MOST_TEXT}")
    element = parse_trial_xml(xml.encode("utf-8", "replace"), place, "utf-8")
    root = element_of(trial)
    try:
        parent, kind = element_at(root, Trial, path)
    except InputError as error:
        raise TrialError(f"{place}: {path!r} {error}") from None
    words = [word for part in (outline(kind) if kind else ()) for word in part.words]
    if element.tag not in words:
        takes = ", ".join(words) or "no elements"
        raise TrialError(f"{place}: <{parent.tag}> takes no <{element.tag[:40]}>; it takes {takes}")
    parent.children.append(element)
    return parse_trial(format_xml(root), place=place, folder=trial.folder, trust=trust)


def remove_element(trial: Trial, path: str, *, place: str = "element", trust: bool = True) -> Trial:
    """Return a trial without the element at a path, checked like a file.

    Args:
        trial: the original trial.
        path: path of the element, such as ``stage/cube[box]`` or ``robot[pepper]``.
        place, trust: as in :func:`add_element`.

    Raises:
        TrialError: the path does not exist, or the new trial has an error.

    >>> from crowdbot.models import ORCA
    >>> trial = Trial(name="t", duration=2.0, crowd=ORCA())
    >>> wider = add_element(trial, '<wall points="0,0 5,0"/>', "stage")
    >>> remove_element(wider, "stage/wall") == trial
    True
    """
    root = element_of(trial)
    try:
        remove_at(root, Trial, path)
    except InputError as error:
        raise TrialError(f"{place}: {path!r} {error}") from None
    return parse_trial(format_xml(root), place=place, folder=trial.folder, trust=trust)


def needs_trust(trial: Trial) -> bool:
    """Return whether a trial names code or files outside its folder."""
    try:
        parse_trial(trial_xml(trial), folder=trial.folder, trust=False)
    except TrialError:
        return True
    return False


@remarks_at_end()
def apply_values(
    trial: Trial, values: Mapping[str, Any], *, place: str = "variant", trust: bool | Collection[str] | None = None
) -> Trial:
    """Return a trial with other values at some paths, checked like a file.

    Args:
        trial: the original trial.
        values: texts, numbers or booleans by path, as in :class:`Sweep`.
        place: name for messages.
        trust: whether code and files outside the folder of the trial may be named, as in
            :func:`crowdbot.trials.parse_trial` (default: if the trial does so already).

    Raises:
        TrialError: a path does not exist, or a value is not allowed.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Trial
    >>> trial = Trial(name="t", duration=2.0, crowd=ORCA())
    >>> apply_values(trial, {"crowd/time-horizon": 3, "end/goal": False}).crowd.time_horizon
    3.0
    """
    if not values:
        return trial
    trust = needs_trust(trial) if trust is None else trust
    root = element_of(trial)
    try:
        set_values(root, Trial, {path: text_of(value) for path, value in values.items()})
    except InputError as error:
        raise TrialError(f"{trial.name}: {error}") from None
    return parse_trial(format_xml(root), place=place, folder=trial.folder, trust=trust)


def expand_sweeps(trial: Trial, trust: bool | None = None) -> tuple[Trial, ...]:
    """Return a trial without sweeps for every combination of values; the trial itself if it has none.

    The names contain the values: ``doors [door 1.2, seed 3]``; ``trust`` is that of :func:`apply_values`.

    Raises:
        TrialError: a path does not exist, a value is not allowed, or there are too many combinations.

    >>> from crowdbot.models import ORCA
    >>> from crowdbot.trials import Sweep, Trial
    >>> many = Trial(name="t", duration=2.0, crowd=ORCA(), sweeps=[Sweep("crowd/time-horizon", "1 2"),
    ...     Sweep("seed", "0:3")])
    >>> variants = expand_sweeps(many)
    >>> [one.name for one in variants][:2], variants[4].crowd.time_horizon
    (['t [time-horizon 1, seed 0]', 't [time-horizon 1, seed 1]'], 2.0)
    """
    if not trial.sweeps:
        return (trial,)
    trust = needs_trust(trial) if trust is None else trust
    rows = _combinations(trial)
    return tuple(_variant(trial, row, trust) for row in rows)


def _combinations(trial: Trial) -> list[tuple[str, ...]]:
    count = math.prod(len(sweep.each) for sweep in trial.sweeps)
    if count > MOST_VARIANTS:
        raise TrialError(f"trial {trial.name!r}: its sweeps make {count} variants, at most {MOST_VARIANTS}")
    return list(itertools.product(*(sweep.each for sweep in trial.sweeps)))


def _variant(trial: Trial, values: tuple[str, ...], trust: bool) -> Trial:
    plain = dataclasses.replace(trial, sweeps=())
    pairs = {sweep.path: value for sweep, value in zip(trial.sweeps, values, strict=True)}
    words = ", ".join(f"{path.rpartition('/')[2]} {value}" for path, value in pairs.items())
    one = apply_values(plain, pairs, trust=trust)
    return dataclasses.replace(one, name=f"{trial.name[:30]} [{words[:46]}]")
