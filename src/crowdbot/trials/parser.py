"""Parser: reads and checks a trial from XML, and checks a trial made in Python."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Collection
from pathlib import Path
from typing import Any

from crowdbot.core import Element, TrialError

from .crowd import Crowd, Crowds
from .fields import element_word
from .partial_element import has_kind, kind_of
from .stage import Obstacle
from .sweep import sweep_problems
from .trial import Trial
from .validation.trial_checks import problems_of
from .xml.reader import ROOT, XmlReader
from .xml.reader_result import ReaderResult
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
        TrialError: the trial has errors; one sentence per error, in the order of the lines.

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
    for sweep, sentence in sweep_problems(root, Trial, result.value.sweeps, _variant_problems(reader, result, None)):
        result.report(sweep, sentence)
    result.raise_problems()
    assert isinstance(result.value, Trial)
    return dataclasses.replace(result.value, folder=folder)


def check_trial(trial: Trial, seed: int | None = None) -> None:
    """Raise :class:`TrialError` with every problem of a trial.

    Args:
        trial: made in Python or read.
        seed: seed of the placement of people (default: the seed of the trial).
    """
    found = problems_of(trial, Crowds.spread(trial.crowd), seed)
    sentences = [f"trial {trial.name!r}: {_describe(thing)} {sentence}" for thing, sentence in found]
    if trial.sweeps and not sentences:
        reader, root = XmlReader(trial.name, trial.folder or Path.cwd(), True), element_of(trial)
        problems = _variant_problems(reader, ReaderResult(trial.name, root), seed)
        sentences = [sentence for _, sentence in sweep_problems(root, Trial, trial.sweeps, problems)]
    if sentences:
        raise TrialError(*sentences)


def _read(reader: XmlReader, root: Element, seed: int | None) -> ReaderResult:
    """Return a trial, partial if it has a problem, with every problem; ``seed`` as in :func:`check_trial`."""
    result = reader.read(Trial, root)
    crowds = [one for one in result.elements if has_kind(one, Crowd)]
    for thing, sentence in problems_of(result.value, crowds, seed):
        result.report(thing, sentence)
    return result


def _variant_problems(reader: XmlReader, base: ReaderResult, seed: int | None) -> Callable[[Element], list[str]]:
    """Return a function that lists the problems of a variant that the trial itself does not have."""
    return lambda root: _read(reader, root, seed).new_sentences(base.problems)


def _describe(thing: Any) -> str:
    if has_kind(thing, Obstacle):
        return "obstacle"
    name = getattr(thing, "name", "")
    return element_word(kind_of(thing)) + (f" {name!r}" if name else "")
