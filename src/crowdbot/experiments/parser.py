"""Parser and writer of experiment files; reports all errors, each with its line."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from crowdbot.core import TrialError, format_xml
from crowdbot.trials import XmlReader, element_from, parse_trial_xml

from .checks import everything, problems_of
from .experiment import Experiment

__all__ = ["check_experiment", "experiment_xml", "parse_experiment"]

ROOT = "experiment"


def parse_experiment(
    text: str | bytes, *, place: str = ROOT, folder: Path | None = None, trust: bool = False, whole: bool = True
) -> Experiment:
    """Read an experiment from XML and check it.

    Args:
        text: XML text.
        place: file name for messages.
        folder: folder of screens and trials (default: the working directory).
        trust: whether trials outside the folder, and their code, may be loaded.
        whole: whether screens and trials are checked, too; the copy in a recorded session has none.

    Raises:
        TrialError: the experiment has errors; the exception lists all of them in line order.

    >>> parse_experiment('<experiment name="e"><block name="b" ordr="random"/></experiment>')  # doctest: +ELLIPSIS
    Traceback (most recent call last):
    crowdbot.core.errors.TrialError: experiment:1: <block> has no attribute 'ordr', did you mean 'order'?; ...
    experiment:1: <block> needs the element <trial>: the trials
    """
    try:
        data = text.encode() if isinstance(text, str) else text
    except UnicodeEncodeError:
        raise TrialError(f"{place}: not well-formed XML: the text contains an unpaired surrogate") from None
    root = parse_trial_xml(data, place, "utf-8" if isinstance(text, str) else None)
    if root.tag != ROOT:
        raise TrialError(f"{place}:{root.line}: the root element is <{root.tag[:40]}>, expected <{ROOT}>")
    result = XmlReader(place, folder or Path.cwd(), trust).read(Experiment, root)
    for thing, sentence in problems_of(result.elements, folder, trust) if whole else []:
        result.report(thing, sentence)
    result.raise_problems()
    assert isinstance(result.value, Experiment)
    return dataclasses.replace(result.value, folder=folder)


def experiment_xml(experiment: Experiment) -> str:
    """Return the XML text of an experiment."""
    return format_xml(element_from(ROOT, experiment, None))


def check_experiment(experiment: Experiment, *, trust: bool = False) -> None:
    """Check an experiment created in Python: names, files and trials.

    Args:
        experiment: the experiment.
        trust: whether trials may load code from outside their folders.

    Raises:
        TrialError: the experiment has errors; the exception lists all of them.
    """
    found = problems_of(everything(experiment), experiment.folder, trust)
    if sentences := [f"experiment {experiment.name!r}: {_called(thing)} {sentence}" for thing, sentence in found]:
        raise TrialError(*sentences)


def _called(thing: object) -> str:
    return f"{type(thing).__name__} {getattr(thing, 'name', '')!r}"
