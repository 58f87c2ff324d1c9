"""From XML to an experiment and back, by the same outline as trials: every problem at once, with its line."""

from __future__ import annotations

import dataclasses
from pathlib import Path

from crowdbot.core import TrialError, format_xml
from crowdbot.trials import XmlReader, element_from, parse_trial_xml, update_names

from .checks import everything, problems_of
from .experiment import Experiment

__all__ = ["check_experiment", "experiment_xml", "parse_experiment"]

ROOT = "experiment"


def parse_experiment(
    text: str | bytes, *, place: str = ROOT, folder: Path | None = None, trust: bool = False, whole: bool = True
) -> Experiment:
    """Read an experiment from XML and check it.

    Args:
        text: the XML.
        place: name of the file for messages.
        folder: where its screens and trials lie (default: the working folder).
        trust: whether trials may lie, and load code from, elsewhere.
        whole: whether screens and trials are looked at, too; a copy beside recorded sessions has none.

    Raises:
        TrialError: with every problem found, one sentence each, in the order of the lines.

    >>> parse_experiment('<experiment name="e"><block name="b" ordr="random"/></experiment>')
    Traceback (most recent call last):
    crowdbot.core.errors.TrialError: experiment:1: <block> has no attribute 'ordr', did you mean 'order'?; it takes \
name, order, repetitions, seeds
    experiment:1: <block> needs the element <trial>: the trials
    """
    try:
        data = text.encode() if isinstance(text, str) else text
    except UnicodeEncodeError:
        raise TrialError(f"{place}: this is not well-formed XML: it holds half a character") from None
    root = parse_trial_xml(data, place, "utf-8" if isinstance(text, str) else None)
    if root.tag != ROOT:
        raise TrialError(f"{place}:{root.line}: the root element is <{root.tag[:40]}>, it must be <{ROOT}>")
    update_names(root, place)
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
    """Check an experiment made in Python: names, files, trials.

    Args:
        experiment: the experiment.
        trust: whether trials may load code from outside their folders.

    Raises:
        TrialError: with every problem found, a sentence each.
    """
    found = problems_of(everything(experiment), experiment.folder, trust)
    if sentences := [f"experiment {experiment.name!r}: {_called(thing)} {sentence}" for thing, sentence in found]:
        raise TrialError(*sentences)


def _called(thing: object) -> str:
    return f"{type(thing).__name__} {getattr(thing, 'name', '')!r}"
