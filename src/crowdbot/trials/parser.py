"""Parser: from an XML text to a checked trial, and the checks of a trial made in Python."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path
from typing import Any

from crowdbot.core import Element, TrialError

from .crowd import Crowd, Crowds
from .fields import element_word
from .partial_element import kind_of
from .stage import Obstacle
from .sweep import sweep_problems
from .trial import Trial
from .validation.trial_checks import problems_of
from .xml.old_names import update_names
from .xml.reader import ROOT, XmlReader
from .xml.trial_text import parse_trial_xml
from .xml.writer import element_of

__all__ = ["check_trial", "parse_trial"]


def parse_trial(
    text: str | bytes,
    *,
    place: str = "trial",
    folder: Path | None = None,
    trust: bool = False,
    quiet: bool = False,
) -> Trial:
    """Read a trial from XML and check it.

    Args:
        text: the XML.
        place: name of the file for messages.
        folder: of the trial; code that the trial names is looked up here (default: the working folder).
        trust: whether code from outside the folder may be loaded.
        quiet: do not warn about names of earlier versions.

    Raises:
        TrialError: with every problem found, one sentence each, in the order of the lines.

    >>> parse_trial('<trial name="t" duration="-1"><crowd type="orca" time-horizn="2"/></trial>')
    Traceback (most recent call last):
    crowdbot.core.errors.TrialError: trial:1: <trial> duration="-1" must be above 0 s and at most 86400 s
    trial:1: <crowd> has no attribute 'time-horizn', did you mean 'time-horizon'?; it takes neighbor-distance, \
max-neighbors, time-horizon, time-horizon-walls, max-speed, name
    """
    try:
        data = text.encode() if isinstance(text, str) else text
    except UnicodeEncodeError:
        raise TrialError(f"{place}: this is not well-formed XML: it holds half a character") from None
    root = parse_trial_xml(data, place, "utf-8" if isinstance(text, str) else None)
    if root.tag != ROOT:
        raise TrialError(f"{place}:{root.line}: the root element is <{root.tag[:40]}>, it must be <{ROOT}>")
    update_names(root, place, quiet=quiet)
    reader = XmlReader(place, folder or Path.cwd(), trust)
    trial = _read_checked(reader, root)
    for sweep, sentence in sweep_problems(root, Trial, trial.sweeps, _variant_problems(reader)):
        reader.say(reader.lines[id(sweep)], "sweep", sentence)
    reader.finish()
    assert isinstance(trial, Trial)
    return dataclasses.replace(trial, folder=folder)


def check_trial(trial: Trial, seed: int | None = None) -> None:
    """Raise :class:`TrialError` with every problem of a trial.

    Args:
        trial: made in Python or read.
        seed: places people with it; None is the trial's own.
    """
    found = problems_of(trial, Crowds.spread(trial.crowd), seed)
    sentences = [f"trial {trial.name!r}: {_called(thing)} {sentence}" for thing, sentence in found]
    if trial.sweeps and not sentences:
        reader = XmlReader(trial.name, trial.folder or Path.cwd(), True, seed)
        sentences = [
            sentence
            for _, sentence in sweep_problems(element_of(trial), Trial, trial.sweeps, _variant_problems(reader))
        ]
    if sentences:
        raise TrialError(*sentences)


def _read_checked(reader: XmlReader, root: Element) -> Any:
    """Return the trial that an element means, partial when it has a problem, after looking for all of them."""
    trial = reader.element(Trial, root)
    crowds = [one for one in reader.made if isinstance(one, Crowd)]
    for thing, sentence in problems_of(trial, crowds, reader.seed):
        reader.say(reader.lines.get(id(thing), root.line), reader.words.get(id(thing), ROOT), sentence)
    return trial


def _variant_problems(base: XmlReader) -> Callable[[Element], list[str]]:
    """Return a function that lists the problems of a variant that the trial itself does not have."""

    def problems(root: Element) -> list[str]:
        reader = XmlReader(base.place, base.folder, base.trust, base.seed)
        _read_checked(reader, root)
        return [
            f"<{tag}> {sentence}" for line, tag, sentence in reader.found if (line, tag, sentence) not in base.found
        ]

    return problems


def _called(thing: Any) -> str:
    if isinstance(thing, Obstacle):
        return "obstacle"
    name = getattr(thing, "name", "")
    return element_word(kind_of(thing)) + (f" {name!r}" if name else "")
