"""Experiment: trials for participants, with screens around them, as one tree of frozen dataclasses that is the XML."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from crowdbot.trials import attribute, check, children

from .question import QUESTIONS, SHORT, Question

__all__ = ["ORDERS", "SEEDS", "Block", "Experiment", "Screen", "TrialEntry"]

ORDERS = ("fixed", "random", "latin-square")
SEEDS = ("same", "by-repetition", "by-participant")


@dataclass(frozen=True, kw_only=True)
class Screen:
    """What a participant reads, and is asked, before going on."""

    name: str = attribute(about="name of the screen in the answers", pattern=SHORT)
    text: str = attribute("", about="what is shown, for a line or two")
    file: str = attribute("", about="what is shown: a .txt or .html file in the folder of the experiment")
    questions: tuple[Question, ...] = children(QUESTIONS, about="what is asked", max=100)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, kw_only=True)
class TrialEntry:
    """A trial that participants go through."""

    name: str = attribute(about="name of the trial in this experiment", pattern=SHORT)
    source: str = attribute(about="a trial file in the folder of the experiment, or a built-in trial")
    seed: int | None = attribute(None, about="seed of the trial; its own when left out", min=-(2**53), max=2**53)
    before: tuple[Screen, ...] = children("before", about="screens before this trial", max=100)
    after: tuple[Screen, ...] = children("after", about="screens after this trial", max=100)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, kw_only=True)
class Block:
    """Trials that are ordered among themselves.

    Fields:
        order: ``fixed``, as they are written; ``random``, drawn for each participant and repetition; ``latin-square``,
            a row of a Williams square, in which every trial stands equally often at every place and equally often
            right after every other one.
        repetitions: how often all trials are gone through.
        seeds: ``same`` crowd every time, ``by-repetition`` another one in each repetition, the same for everybody, or
            ``by-participant`` another one for each participant and repetition.
    """

    name: str = attribute(about="name of the block", pattern=SHORT)
    order: str = attribute("fixed", about="order of the trials", choices=ORDERS)
    repetitions: int = attribute(1, about="how often all trials are gone through", min=1, max=1000)
    seeds: str = attribute("by-repetition", about="when crowds are drawn anew", choices=SEEDS)
    instructions: tuple[Screen, ...] = children("instructions", about="screens before the block", max=100)
    before: tuple[Screen, ...] = children("before", about="screens before every trial", max=100)
    trials: tuple[TrialEntry, ...] = children("trial", about="the trials", min=1, max=1000)
    after: tuple[Screen, ...] = children("after", about="screens after every trial", max=100)
    transitions: tuple[Screen, ...] = children("transition", about="screens between two trials", max=100)

    def __post_init__(self) -> None:
        check(self)

    @property
    def screens(self) -> tuple[Screen, ...]:
        """Every screen that the block itself names."""
        return (*self.instructions, *self.before, *self.after, *self.transitions)


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """Trials for participants, with screens around them.

    An experiment made in Python is checked like one from a file when a session begins, or by
    :func:`crowdbot.experiments.check_experiment`.

    Raises:
        InputError: a value is not allowed.

    >>> block = Block(name="main", order="latin-square", trials=[TrialEntry(name="meet", source="frontal")])
    >>> experiment = Experiment(name="meeting", blocks=[block])
    >>> [entry.source for entry in experiment.blocks[0].trials]
    ['frontal']
    """

    name: str = attribute(about="name of the experiment", pattern=r"\S.{0,79}")
    about: str = attribute("", about="one line for people")
    seed: int = attribute(0, about="seed of random orders", min=-(2**53), max=2**53)
    participants: int | None = attribute(None, about="how many participants there will be", min=1, max=100_000)
    instructions: tuple[Screen, ...] = children("instructions", about="first screens", max=100)
    blocks: tuple[Block, ...] = children("block", about="trials that are ordered together", min=1, max=100)
    endings: tuple[Screen, ...] = children("ending", about="last screens", max=100)
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    """Where screens and trials lie; not part of the tree."""

    def __post_init__(self) -> None:
        check(self)
