"""Plan of a session: the screens and trials of one participant, in order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from dataclasses import dataclass

from .experiment import Block, Experiment, Screen, TrialEntry
from .order import check_participant, orders


@dataclass(frozen=True)
class SessionStep:
    """A screen or a trial.

    Fields:
        role: ``instructions``, ``before``, ``trial``, ``after``, ``transition`` or ``ending``.
        screen: the screen; None for a trial.
        block: name of the block; empty outside of blocks.
        entry: the trial, also for screens directly before and after it; otherwise None.
        number: number of that trial in the session, from 1; otherwise 0.
        repetition: repetition of the block, from 0.
        seeds: when the seeds of crowds change, see :class:`crowdbot.experiments.Block`.
    """

    role: str
    screen: Screen | None = None
    block: str = ""
    entry: TrialEntry | None = None
    number: int = 0
    repetition: int = 0
    seeds: str = "same"

    @property
    def name(self) -> str:
        """Name of the screen or the trial."""
        thing = self.screen or self.entry
        return thing.name if thing else ""


def plan(experiment: Experiment, participant: int) -> tuple[SessionStep, ...]:
    """Return the plan of a participant, which depends only on the experiment and the participant.

    Raises:
        InputError: there is no such participant.

    >>> from crowdbot.experiments import load_experiment
    >>> [step.name for step in plan(load_experiment("robot-speed"), 2) if step.role == "trial"]
    ['alone', 'fast', 'slow']
    """
    check_participant(experiment, participant)
    steps = [*_screens("instructions", experiment.instructions)]
    number = 0
    for block in experiment.blocks:
        steps += _screens("instructions", block.instructions, block.name)
        for repetition, order in enumerate(orders(experiment, block, participant)):
            for place, index in enumerate(order):
                number += 1
                if repetition or place:
                    steps += _screens("transition", block.transitions, block.name)
                steps += _around(block, block.trials[index], number, repetition)
    return (*steps, *_screens("ending", experiment.endings))


def _screens(role: str, screens: Iterable[Screen], block: str = "") -> Iterator[SessionStep]:
    return (SessionStep(role, screen, block) for screen in screens)


def _around(block: Block, entry: TrialEntry, number: int, repetition: int) -> Iterator[SessionStep]:
    rows: list[tuple[str, Screen | None]] = [("before", screen) for screen in (*block.before, *entry.before)]
    rows += [("trial", None), *(("after", screen) for screen in (*entry.after, *block.after))]
    return (SessionStep(role, screen, block.name, entry, number, repetition, block.seeds) for role, screen in rows)
