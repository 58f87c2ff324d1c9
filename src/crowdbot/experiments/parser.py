"""Reading of experiments, their trials and the built-in ones."""

from __future__ import annotations

import contextlib
import dataclasses
import importlib.resources
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any
from xml.parsers import expat

from crowdbot.core import InputError, TrialError, did_you_mean, format_xml
from crowdbot.trials import (
    Trial,
    XmlReader,
    builtin_trials,
    element_from,
    load_trial,
    parse_trial,
    parse_trial_xml,
    read_trial_bytes,
)

from .experiment import Block, Experiment, Screen, TrialEntry
from .page import page_of
from .question import Question


def trial_of(source: str, folder: Path | None, trust: bool = False) -> Trial:
    """Return the trial named by ``source``: a file in the folder of the experiment, or a built-in trial.

    Raises:
        TrialError: the trial has errors; the exception lists all of them.
        InputError: the file is outside the folder.
    """
    root = (folder or Path.cwd()).resolve()
    path = (root / source).resolve()
    if path.is_file():
        if not trust and not path.is_relative_to(root):
            raise InputError(f"the trial {source!r} is outside the folder of the experiment; use --trust to allow it")
        return parse_trial(read_trial_bytes(path), place=source, folder=path.parent, trust=trust)
    if source in builtin_trials():
        return load_trial(source)
    raise TrialError(
        f"there is no trial {source!r}{did_you_mean(source, builtin_trials())}: it is neither a file in the "
        f"folder of the"
        f" experiment nor a built-in trial ({', '.join(builtin_trials())})"
    )


ROOT = "experiment"
MOST_TRIALS = 10_000
"""Maximum number of trials in a session."""
Found = Iterator[tuple[Any, str]]


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
    result.raise_problems()
    experiment: Experiment = result.value
    for thing, sentence in problems_of(experiment, folder, trust) if whole else []:
        result.report(thing, sentence)
    result.raise_problems()
    return dataclasses.replace(experiment, folder=folder)


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
    found = problems_of(experiment, experiment.folder, trust)
    if sentences := [f"experiment {experiment.name!r}: {_called(thing)} {sentence}" for thing, sentence in found]:
        raise TrialError(*sentences)


def _called(thing: object) -> str:
    return f"{type(thing).__name__} {getattr(thing, 'name', '')!r}"


def everything(experiment: Experiment) -> list[Any]:
    """Return the named elements of an experiment, outer elements last."""
    screens = [*experiment.instructions, *experiment.endings]
    trials = [entry for block in experiment.blocks for entry in block.trials]
    screens += [screen for block in experiment.blocks for screen in block.screens]
    screens += [screen for entry in trials for screen in (*entry.before, *entry.after)]
    questions = [question for screen in screens for question in screen.questions]
    return [*questions, *screens, *trials, *experiment.blocks, experiment]


def problems_of(experiment: Experiment, folder: Path | None, trust: bool) -> list[tuple[Any, str]]:
    """Return all problems as pairs of an element and the end of a sentence about it.

    Args:
        experiment: the experiment.
        folder: folder of the experiment.
        trust: whether trials outside the folder, and their code, may be loaded.
    """
    things = everything(experiment)
    found = [problem for thing in things for check in _problems(thing) for problem in check]
    found += [problem for thing in things if isinstance(thing, Screen) for problem in _shown(thing, folder)]
    entries = [thing for thing in things if isinstance(thing, TrialEntry)]
    read = {source: _trial(source, folder, trust) for source in dict.fromkeys(entry.source for entry in entries)}
    return found + [(entry, sentence) for entry in entries for sentence in read[entry.source]]


def _problems(thing: Any) -> Iterator[Found]:
    if isinstance(thing, Question):
        yield _asked(thing)
    if isinstance(thing, Screen):
        yield _twice(thing.questions, "question of this screen")
    if isinstance(thing, Block):
        yield _twice(thing.trials, "trial of this block")
        yield from (_twice((*entry.before, *entry.after), "screen of this trial") for entry in thing.trials)
    if isinstance(thing, Experiment):
        yield from _whole(thing)


def _asked(question: Question) -> Found:
    if wrong := question.problem():
        yield question, wrong


def _whole(experiment: Experiment) -> Iterator[Found]:
    blocks = experiment.blocks
    yield _twice(blocks, "block")
    outer = [*experiment.instructions, *experiment.endings, *(s for block in blocks for s in block.screens)]
    yield _twice(outer, "screen")
    entries = [entry for block in blocks for entry in block.trials]
    yield from (_taken(screen, outer) for entry in entries for screen in (*entry.before, *entry.after))
    yield _too_many(experiment)


def _taken(screen: Screen, outer: Sequence[Screen]) -> Found:
    if screen.name in [other.name for other in outer]:
        yield screen, f"name {screen.name!r} is already used by a screen outside this trial; names must differ"


def _too_many(experiment: Experiment) -> Found:
    count = sum(len(block.trials) * block.repetitions for block in experiment.blocks)
    if count > MOST_TRIALS:
        yield experiment, (f"has {count} trials per participant, the maximum is {MOST_TRIALS}; reduce the repetitions")


def _twice(things: Sequence[Any], what: str) -> Found:
    count: Counter[str] = Counter()
    for thing in things:
        count[thing.name] += 1
        if count[thing.name] > 1:
            yield thing, f"name {thing.name!r} is already used by another {what}; names must differ"


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


FILE = "experiment.xml"


def _shipped() -> Path:
    return Path(str(importlib.resources.files("crowdbot").joinpath("assets", "experiments")))


def builtin_experiments() -> dict[str, Path]:
    """Return the folders of the built-in experiments by name.

    >>> "robot-speed" in builtin_experiments()
    True
    """
    return {folder.name: folder for folder in sorted(_shipped().iterdir()) if (folder / FILE).is_file()}


def load_experiment(source: str | Path, *, trust: bool = False) -> Experiment:
    """Read and check an experiment with its screens and trials.

    Args:
        source: an experiment file, a folder with an ``experiment.xml``, or a built-in name; a file or folder in the
            working directory takes precedence over a built-in name.
        trust: whether trials outside the folder of the experiment may be used, and trials may load code from outside
            their folders.

    Raises:
        TrialError: the experiment does not exist or has errors; the exception lists all of them.

    >>> load_experiment("robot-speed").blocks[-1].order
    'latin-square'
    """
    path, known = _file(source), builtin_experiments()
    if path is None:
        raise TrialError(
            f"there is no experiment {str(source)!r}{did_you_mean(str(source), known)}: it is neither a file"
            f" nor a built-in experiment ({', '.join(known)})"
        )
    data = read_trial_bytes(path)
    if not data.strip():
        raise TrialError(f"{path} is empty; an experiment is an XML file with the root element <experiment>")
    return parse_experiment(data, place=str(path), folder=path.parent, trust=trust)


def is_experiment(source: str | Path) -> bool:
    """Return whether a name or file is an experiment instead of a trial.

    >>> is_experiment("robot-speed"), is_experiment("frontal")
    (True, False)
    """
    path = _file(source)
    if path is None:
        return False
    return _root(read_trial_bytes(path)) == "experiment"


def _root(data: bytes) -> str:
    """Return the name of the root element; empty if there is none near the start of the file."""
    found: list[str] = []
    parser = expat.ParserCreate()

    def stop(tag: str, *_: object) -> None:
        found.append(tag)
        raise StopIteration

    parser.StartElementHandler = stop
    parser.StartDoctypeDeclHandler = lambda *_: stop("")
    with contextlib.suppress(StopIteration, expat.ExpatError, LookupError, ValueError):
        parser.Parse(data, True)
    return found[0] if found else ""


def _file(source: str | Path) -> Path | None:
    path = Path(source)
    for file in (path, path / FILE, builtin_experiments().get(str(source), path) / FILE):
        if file.is_file():
            return file
    return None
