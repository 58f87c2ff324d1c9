"""Element edits: add an element to a trial, or remove one, by its path."""

from __future__ import annotations

from crowdbot.core import InputError, TrialError, format_xml
from crowdbot.trials.fields import outline
from crowdbot.trials.parser import parse_trial
from crowdbot.trials.trial import Trial
from crowdbot.trials.value_path import element_at, remove_at

from .trial_text import parse_trial_xml
from .writer import element_of, trial_xml

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
