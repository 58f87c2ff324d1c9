"""Experiment: screens, trials, blocks and experiments as frozen dataclasses that map to XML."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from pathlib import Path

from crowdbot.trials import attribute, check, children

from .question import QUESTIONNAIRES, QUESTIONS, SHORT, Question, questionnaire_questions

ORDERS = ("fixed", "random", "latin-square")
SEEDS = ("same", "by-repetition", "by-participant")
ANALYSES = ("", "leader-follower", "crossing", "encounters")


@dataclass(frozen=True, kw_only=True)
class Screen:
    """A screen with a text and questions.

    A screen with a ``questionnaire`` and no questions gets the questions of the questionnaire; the copy of the
    experiment in a session holds them.

    >>> len(Screen(name="before", questionnaire="sickness").questions)
    16
    """

    name: str = attribute(about="name of the screen in the answers", pattern=SHORT)
    text: str = attribute("", about="short text to show")
    file: str = attribute("", about="text to show: a .txt or .html file in the folder of the experiment")
    questionnaire: str = attribute(
        "", about="built-in questions of a screen without questions", choices=("", *QUESTIONNAIRES)
    )
    questions: tuple[Question, ...] = children(QUESTIONS, about="questions", max=100)

    def __post_init__(self) -> None:
        check(self)
        if self.questionnaire in QUESTIONNAIRES and not self.questions:
            object.__setattr__(self, "questions", questionnaire_questions(self.questionnaire))


@dataclass(frozen=True, kw_only=True)
class TrialEntry:
    """A trial of a block."""

    name: str = attribute(about="name of the trial in this experiment", pattern=SHORT)
    source: str = attribute(about="a trial file in the folder of the experiment, or a built-in trial")
    seed: int | None = attribute(
        None, about="seed of the trial (default: the seed in the trial)", min=-(2**53), max=2**53
    )
    before: tuple[Screen, ...] = children("before", about="screens before this trial", max=100)
    after: tuple[Screen, ...] = children("after", about="screens after this trial", max=100)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, kw_only=True)
class Block:
    """A group of trials with a common order.

    Fields:
        order: ``fixed`` (as written), ``random`` (for each participant and repetition) or ``latin-square``: a row of a
            Williams square, in which each trial occurs equally often at each position and equally often directly after
            each other trial.
        repetitions: number of repetitions of all trials.
        seeds: ``same`` (same crowd every time), ``by-repetition`` (a new crowd in each repetition, equal for all
            participants) or ``by-participant`` (a new crowd for each participant and repetition).
    """

    name: str = attribute(about="name of the block", pattern=SHORT)
    order: str = attribute("fixed", about="order of the trials", choices=ORDERS)
    repetitions: int = attribute(1, about="number of repetitions of all trials", min=1, max=1000)
    seeds: str = attribute("by-repetition", about="when the seeds of crowds change", choices=SEEDS)
    instructions: tuple[Screen, ...] = children("instructions", about="screens before the block", max=100)
    before: tuple[Screen, ...] = children("before", about="screens before each trial", max=100)
    trials: tuple[TrialEntry, ...] = children("trial", about="the trials", min=1, max=1000)
    after: tuple[Screen, ...] = children("after", about="screens after each trial", max=100)
    transitions: tuple[Screen, ...] = children("transition", about="screens between two trials", max=100)

    def __post_init__(self) -> None:
        check(self)

    @property
    def screens(self) -> tuple[Screen, ...]:
        """All screens defined by the block."""
        return (*self.instructions, *self.before, *self.after, *self.transitions)


@dataclass(frozen=True, kw_only=True)
class Experiment:
    """Blocks of trials for participants, with screens before, between and after them.

    An experiment created in Python is checked when a session begins, or by
    :func:`crowdbot.experiments.check_experiment`.

    Raises:
        InputError: a value is not allowed.

    >>> block = Block(name="main", order="latin-square", trials=[TrialEntry(name="meet", source="frontal")])
    >>> experiment = Experiment(name="meeting", blocks=[block])
    >>> [entry.source for entry in experiment.blocks[0].trials]
    ['frontal']
    """

    name: str = attribute(about="name of the experiment", pattern=r"\S.{0,79}")
    about: str = attribute("", about="description, one line")
    seed: int = attribute(0, about="seed of random orders", min=-(2**53), max=2**53)
    participants: int | None = attribute(None, about="number of participants", min=1, max=100_000)
    analysis: str = attribute("", about="kind of the experiment: what is measured in its trials", choices=ANALYSES)
    instructions: tuple[Screen, ...] = children("instructions", about="first screens", max=100)
    blocks: tuple[Block, ...] = children("block", about="groups of trials", min=1, max=100)
    endings: tuple[Screen, ...] = children("ending", about="last screens", max=100)
    folder: Path | None = dataclasses.field(default=None, compare=False, repr=False)
    """Folder of the screens and trials; not part of the XML."""

    def __post_init__(self) -> None:
        check(self)
