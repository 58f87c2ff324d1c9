"""Orders of trials (fixed, random, balanced) and seeds of their crowds."""

from __future__ import annotations

from collections.abc import Sequence

from crowdbot.core import InputError, stream

from .experiment import Block, Experiment


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
