"""Plan of a session: the screens and trials of one participant, in fixed, random or balanced order."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass

from crowdbot.core import InputError, stream

from .experiment import Block, Experiment, Screen, TrialEntry


def williams(count: int) -> list[list[int]]:
    """Return the rows of a Williams square: ``count`` rows, or twice as many for an odd count.

    Each condition occurs equally often at each position, and equally often directly after each other condition.
    Williams 1949, Experimental designs balanced for the estimation of residual effects of treatments,
    https://doi.org/10.1071/CH9490149.

    Raises:
        InputError: the count is not positive.

    >>> williams(4)
    [[0, 1, 3, 2], [1, 2, 0, 3], [2, 3, 1, 0], [3, 0, 2, 1]]
    """
    if count < 1:
        raise InputError(f"a Latin square of {count} conditions is not possible; it needs at least one")
    first = [(k + 1) // 2 if k % 2 else (count - k // 2) % count for k in range(count)]
    rows = [[(place + shift) % count for place in first] for shift in range(count)]
    return rows if count % 2 == 0 or count == 1 else rows + [row[::-1] for row in rows]


def rows_of(block: Block) -> int:
    """Return after how many participants the orders of a block repeat; 0 for random orders, 1 for fixed ones."""
    count = len(block.trials)
    return {"random": 0, "fixed": 1}.get(block.order, count * (1 + (count % 2 and count > 1)))


def orders(experiment: Experiment, block: Block, participant: int) -> list[list[int]]:
    """Return the order of the trials of a block as indices, for each repetition.

    In a Latin square, participant k takes row k, and each repetition takes the next row. Each repetition is therefore
    balanced over the participants.

    Args:
        experiment: experiment with the seed of random orders.
        block: a block of the experiment.
        participant: number, from 1.

    Raises:
        InputError: there is no such participant.
    """
    check_participant(experiment, participant)
    count, every = len(block.trials), range(block.repetitions)
    if block.order == "fixed":
        return [[*range(count)] for _ in every]
    if block.order == "random":
        return [_drawn(experiment.seed, block.name, participant, repetition, count) for repetition in every]
    rows = williams(count)
    return [rows[(participant - 1 + repetition) % len(rows)] for repetition in every]


def check_participant(experiment: Experiment, participant: int) -> None:
    """Raise :class:`InputError` if there is no such participant."""
    most = experiment.participants or 100_000
    if not 1 <= participant <= most:
        raise InputError(
            f"there is no participant {participant} in the experiment {experiment.name!r}; participants are 1 to {most}"
        )


def _drawn(seed: int, block: str, participant: int, repetition: int, count: int) -> list[int]:
    draw = stream(seed, "order", block, participant, repetition)
    order: Sequence[int] = draw.permutation(count).tolist()
    return [*order]


def seed_of(base: int, seeds: str, participant: int, repetition: int) -> int:
    """Return the seed of a trial; the first repetition uses the base seed unless seeds depend on the participant.

    Args:
        base: seed of the trial.
        seeds: ``same``, ``by-repetition`` or ``by-participant``.
        participant: number, from 1.
        repetition: number, from 0.
    """
    if seeds == "by-participant":
        return int(stream(base, "participant", participant, repetition).integers(2**31))
    if seeds == "by-repetition" and repetition:
        return int(stream(base, "repetition", repetition).integers(2**31))
    return base


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
