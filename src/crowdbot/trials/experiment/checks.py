"""What makes an experiment impossible although every value is allowed: names, screens, trials."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from crowdbot.core import InputError, TrialError

from .experiment import Block, Experiment, Screen, TrialEntry
from .loading import trial_of
from .page import page_of
from .question import Question

__all__ = ["everything", "problems_of"]

MOST_TRIALS = 10_000
"""No session has more trials than that."""

Found = Iterator[tuple[Any, str]]


def everything(experiment: Experiment) -> list[Any]:
    """Return the elements of an experiment that have a name of their own, outer ones last."""
    screens = [*experiment.instructions, *experiment.endings]
    trials = [entry for block in experiment.blocks for entry in block.trials]
    screens += [screen for block in experiment.blocks for screen in block.screens]
    screens += [screen for entry in trials for screen in (*entry.before, *entry.after)]
    questions = [question for screen in screens for question in screen.questions]
    return [*questions, *screens, *trials, *experiment.blocks, experiment]


def problems_of(things: Iterable[Any], folder: Path | None, trust: bool) -> list[tuple[Any, str]]:
    """Return every problem: the element that has it, and the end of a sentence about it.

    Args:
        things: elements, as :func:`everything` returns them; those that could be read of a wrong file.
        folder: of the experiment.
        trust: whether trials may lie, and load code from, elsewhere.
    """
    things = list(things)
    found = [row for thing in things for row in _problems(thing)]
    found += [row for thing in things if isinstance(thing, Screen) for row in _shown(thing, folder)]
    read: dict[str, list[str]] = {}
    for entry in things:
        if isinstance(entry, TrialEntry):
            if entry.source not in read:
                read[entry.source] = _trial(entry.source, folder, trust)
            found += [(entry, sentence) for sentence in read[entry.source]]
    return found


def _problems(thing: Any) -> Found:
    if isinstance(thing, Question) and (wrong := thing.problem()):
        yield thing, wrong
    if isinstance(thing, Screen):
        yield from _twice(thing.questions, "question of this screen")
    if isinstance(thing, Block):
        yield from _twice(thing.trials, "trial of this block")
        for entry in thing.trials:
            yield from _twice((*entry.before, *entry.after), "screen of this trial")
    if isinstance(thing, Experiment):
        yield from _whole(thing)


def _whole(experiment: Experiment) -> Found:
    yield from _twice(experiment.blocks, "block")
    outer = [*experiment.instructions, *experiment.endings, *(s for block in experiment.blocks for s in block.screens)]
    yield from _twice(outer, "screen")
    taken = {screen.name for screen in outer}
    for entry in (entry for block in experiment.blocks for entry in block.trials):
        for screen in (*entry.before, *entry.after):
            if screen.name in taken:
                yield screen, f"name {screen.name!r} is taken by a screen outside of this trial; give it its own"
    count = sum(len(block.trials) * block.repetitions for block in experiment.blocks)
    if count > MOST_TRIALS:
        yield experiment, f"has {count} trials for a participant, at most {MOST_TRIALS}; take fewer repetitions"


def _twice(things: Iterable[Any], what: str) -> Found:
    count: Counter[str] = Counter()
    for thing in things:
        count[thing.name] += 1
        if count[thing.name] > 1:
            yield thing, f"name {thing.name!r} is taken by another {what}; give each its own"


def _shown(screen: Screen, folder: Path | None) -> Found:
    if screen.text and screen.file:
        yield screen, "has both a text and a file; keep one"
    elif not (screen.text.strip() or screen.file or screen.questions):
        yield screen, "shows and asks nothing; give it a text, a file or a question"
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
