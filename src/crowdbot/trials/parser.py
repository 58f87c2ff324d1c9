"""Parser: reads and checks a trial from XML, and checks a trial made in Python."""

from __future__ import annotations

import dataclasses
import functools
from collections.abc import Collection
from pathlib import Path
from typing import Any

from crowdbot.core import Element, TrialError

from .stage import Obstacle
from .sweep import sweep_problems
from .trial import Trial
from .validation.trial_checks import problems_of
from .xml.reader import ROOT, ReaderResult, XmlReader
from .xml.trial_text import parse_trial_xml
from .xml.writer import element_of


def parse_trial(
    text: str | bytes,
    *,
    place: str = "trial",
    folder: Path | None = None,
    trust: bool | Collection[str] = False,
) -> Trial:
    """Read a trial from XML and check it.

    Args:
        text: the XML.
        place: name of the file for messages.
        folder: folder of the trial and of the code that it names (default: the working folder).
        trust: whether code and files from outside the folder may be named, or the only values of ``type`` that may
            name them.

    Raises:
        TrialError: the trial has errors; one sentence per error, in the order of the lines. Names, sizes and places are
            checked once all values are allowed.

    >>> parse_trial('<trial name="t" duration="-1"><crowd type="orca" time-horizn="2"/></trial>')
    Traceback (most recent call last):
    crowdbot.core.errors.TrialError: trial:1: <trial> duration="-1" must be above 0 s and at most 86400 s
    trial:1: <crowd> has no attribute 'time-horizn', did you mean 'time-horizon'?; it takes neighbor-distance, \
max-neighbors, time-horizon, time-horizon-walls, max-speed, reciprocal, name
    """
    try:
        data = text.encode() if isinstance(text, str) else text
    except UnicodeEncodeError:
        raise TrialError(f"{place}: this is not well-formed XML: it holds half a character") from None
    root = parse_trial_xml(data, place, "utf-8" if isinstance(text, str) else None)
    if root.tag != ROOT:
        raise TrialError(f"{place}:{root.line}: the root element is <{root.tag[:40]}>, it must be <{ROOT}>")
    reader = XmlReader(place, folder or Path.cwd(), trust)
    result = _read(reader, root, None)
    result.raise_problems()
    trial: Trial = result.value
    variant_problems = functools.partial(_variant_problems, reader, None)
    for sweep, sentence in sweep_problems(root, Trial, trial.sweeps, variant_problems):
        result.report(sweep, sentence)
    result.raise_problems()
    return dataclasses.replace(trial, folder=folder)


def check_trial(trial: Trial, seed: int | None = None) -> None:
    """Raise :class:`TrialError` with every problem of a trial.

    Args:
        trial: made in Python or read.
        seed: seed of the placement of people (default: the seed of the trial).
    """
    found = problems_of(trial, seed)
    sentences = [f"trial {trial.name!r}: {_describe(thing)} {sentence}" for thing, sentence in found]
    if trial.sweeps and not sentences:
        reader, root = XmlReader(trial.name, trial.folder or Path.cwd(), True), element_of(trial)
        variant_problems = functools.partial(_variant_problems, reader, seed)
        sentences = [sentence for _, sentence in sweep_problems(root, Trial, trial.sweeps, variant_problems)]
    if sentences:
        raise TrialError(*sentences)


def _read(reader: XmlReader, root: Element, seed: int | None) -> ReaderResult:
    """Return a trial, or its problems; ``seed`` as in :func:`check_trial`."""
    result = reader.read(Trial, root)
    for thing, sentence in problems_of(result.value, seed) if result.value else ():
        result.report(thing, sentence)
    return result


def _variant_problems(reader: XmlReader, seed: int | None, root: Element) -> list[str]:
    return _read(reader, root, seed).sentences


def _describe(thing: Any) -> str:
    if isinstance(thing, Obstacle):
        return "obstacle"
    name = getattr(thing, "name", "")
    return element_word(type(thing)) + (f" {name!r}" if name else "")


def element_word(cls: type) -> str:
    """Return the word for the elements of a class in messages.

    >>> from crowdbot.trials import RobotSpec, Spawner
    >>> element_word(RobotSpec), element_word(Spawner)
    ('robot', 'spawner')
    """
    name = cls.__name__.removesuffix("Spec")
    return {"RobotGoal": "goal", "AgentParameter": "parameter", "ContactModel": "contact"}.get(name, name).lower()
