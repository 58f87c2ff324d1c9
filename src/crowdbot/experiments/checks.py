"""Checks of an experiment across elements: names, screens and trials."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import Any

from crowdbot.core import InputError, TrialError
from crowdbot.trials import has_kind, kind_of, readable, skip_unreadable

from .experiment import Block, Experiment, Screen, TrialEntry
from .page import page_of
from .question import Question
from .trial_source import trial_of

__all__ = ["everything", "problems_of"]

MOST_TRIALS = 10_000
"""Maximum number of trials in a session."""

Found = Iterator[tuple[Any, str]]


def everything(experiment: Experiment) -> list[Any]:
    """Return the named elements of an experiment, outer elements last."""
    screens = [*experiment.instructions, *experiment.endings]
    trials = [entry for block in experiment.blocks for entry in block.trials]
    screens += [screen for block in experiment.blocks for screen in block.screens]
    screens += [screen for entry in trials for screen in (*entry.before, *entry.after)]
    questions = [question for screen in screens for question in screen.questions]
    return [*questions, *screens, *trials, *experiment.blocks, experiment]


def problems_of(things: Iterable[Any], folder: Path | None, trust: bool) -> list[tuple[Any, str]]:
    """Return all problems as pairs of an element and the end of a sentence about it.

    Args:
        things: elements from :func:`everything`; for a file with errors, those that could be read.
        folder: folder of the experiment.
        trust: whether trials outside the folder, and their code, may be loaded.
    """
    things = list(things)
    found = [*skip_unreadable(*(check for thing in things for check in _problems(thing)))]
    found += skip_unreadable(*(_shown(thing, folder) for thing in things if has_kind(thing, Screen)))
    entries = [thing for thing in things if has_kind(thing, TrialEntry)]
    sources = readable(entries, "source")
    read = {source: _trial(source, folder, trust) for source in dict.fromkeys(source for _, source in sources)}
    return found + [(entries[k], sentence) for k, source in sources for sentence in read[source]]


def _problems(thing: Any) -> Iterator[Found]:
    if issubclass(kind_of(thing), Question):
        yield _asked(thing)
    if has_kind(thing, Screen):
        yield _twice(thing.questions, "question of this screen")
    if has_kind(thing, Block):
        for _, entries in readable([thing], "trials"):
            yield _twice(entries, "trial of this block")
            yield from (_twice((*entry.before, *entry.after), "screen of this trial") for entry in entries)
    if has_kind(thing, Experiment):
        yield from _whole(thing)


def _asked(question: Question) -> Found:
    if wrong := question.problem():
        yield question, wrong


def _whole(experiment: Experiment) -> Iterator[Found]:
    blocks = [block for _, there in readable([experiment], "blocks") for block in there]
    yield _twice(blocks, "block")
    outer = [*experiment.instructions, *experiment.endings, *(s for block in blocks for s in block.screens)]
    yield _twice(outer, "screen")
    entries = [entry for _, there in readable(blocks, "trials") for entry in there]
    yield from (_taken(screen, outer) for entry in entries for screen in (*entry.before, *entry.after))
    yield _too_many(experiment)


def _taken(screen: Screen, outer: Sequence[Screen]) -> Found:
    if screen.name in [name for _, name in readable(outer, "name")]:
        yield screen, f"name {screen.name!r} is already used by a screen outside this trial; names must differ"


def _too_many(experiment: Experiment) -> Found:
    count = sum(len(block.trials) * block.repetitions for block in experiment.blocks)
    if count > MOST_TRIALS:
        yield experiment, (f"has {count} trials per participant, the maximum is {MOST_TRIALS}; reduce the repetitions")


def _twice(things: Sequence[Any], what: str) -> Found:
    count: Counter[str] = Counter()
    for k, name in readable(things, "name"):
        count[name] += 1
        if count[name] > 1:
            yield things[k], f"name {name!r} is already used by another {what}; names must differ"


def _shown(screen: Screen, folder: Path | None) -> Found:
    if screen.text and screen.file:
        yield screen, "has both a text and a file; give one of them"
    elif not (screen.text.strip() or screen.file or screen.questions):
        yield screen, "is empty; it needs a text, a file or a question"
    elif screen.file:
        try:
            page_of(screen, folder)
        except InputError as error:
            yield screen, str(error)


def _trial(source: str, folder: Path | None, trust: bool) -> list[str]:
    try:
        trial_of(source, folder, trust)
    except TrialError as error:
        return [f"source={source!r}: {problem}" for problem in error.problems]
    except (InputError, OSError, ValueError) as error:
        return [f"source={source!r}: {error}"]
    return []
