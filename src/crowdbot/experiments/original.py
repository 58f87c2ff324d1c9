"""Import: experiments of the CrowdBot simulator of 2021, from a configuration or an order file."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from crowdbot.core import TrialError
from crowdbot.trials import Plan, Trial, plan_of, trials_of

from .experiment import Block, Experiment, TrialEntry
from .order import orders

__all__ = ["ImportedExperiment", "import_experiment"]


@dataclass(frozen=True)
class ImportedExperiment:
    """An experiment that was imported.

    Fields:
        experiment: one block of all trials.
        trials: by the names of their files, which the experiment has as sources.
        left_out: a sentence about everything that could not be carried over.
    """

    experiment: Experiment
    trials: tuple[tuple[str, Trial], ...]
    left_out: tuple[str, ...]


def import_experiment(
    path: str | Path, *, participant: int | None = None, root: str | Path | None = None
) -> ImportedExperiment:
    """Read an experiment of the original simulator.

    Two orders for odd and even participants (``{TWO}``), or any that make the rows of a Williams square, become a Latin
    square; of other orders that differ, one is taken. A sequence that is gone through several times becomes
    repetitions.

    Args:
        path: of a configuration (root element ``Config``) or of an order file.
        participant: whose order is taken; None takes the one that the configuration names.
        root: folder of the simulator's project, as in :func:`crowdbot.trials.import_original`.

    Raises:
        TrialError: the file is missing, hostile, neither of these, or not one of its trials can be read.
    """
    plan = plan_of(path, root)
    user = plan.user if participant is None else participant
    rows, notes = trials_of(plan, user)
    names = _names([entry for entry, _ in rows])
    trials = {f"{names[entry]}.xml": trial for entry, trial in rows}
    sequence = [names[entry] for entry, _ in rows]
    times = _times(sequence)
    once = sequence[: len(sequence) // times]
    block, more = _block(plan, user, once, times, names)
    notes = (
        *notes,
        *more,
        "screens: the original shows none, so add instructions, questions and an ending",
        "seeds: the original begins every run with the same one, so crowds are the same for everybody",
    )
    experiment = Experiment(
        name=(plan.path.stem.strip() or "imported")[:80],
        about="Imported from the CrowdBot simulator of 2021.",
        blocks=(block,),
    )
    return ImportedExperiment(experiment, tuple(trials.items()), tuple(dict.fromkeys(notes)))


def _names(entries: Sequence[str]) -> dict[str, str]:
    """Return a short name for each file of a trial, each with its own."""
    found: dict[str, str] = {}
    for entry in dict.fromkeys(entries):
        short = re.sub("[^A-Za-z0-9_]", "_", PurePosixPath(entry).stem)[:30]
        short = short if short[:1].isascii() and short[:1].isalpha() else f"trial_{short}"
        name, number = short, 2
        while name.lower() in (one.lower() for one in found.values()):
            name, number = f"{short}_{number}", number + 1
        found[entry] = name
    return found


def _times(sequence: Sequence[str]) -> int:
    """Return how often a sequence repeats one that is shorter."""
    count = len(sequence)
    lengths = (size for size in range(1, count + 1) if count % size == 0)
    return next(count // size for size in lengths if list(sequence[:size]) * (count // size) == list(sequence))


def _block(
    plan: Plan, user: int, once: Sequence[str], times: int, names: dict[str, str]
) -> tuple[Block, tuple[str, ...]]:
    """Return the block of trials, and what of its orders is left out."""
    entries = []
    for k, name in enumerate(once):
        again = once[:k].count(name)
        entries.append(TrialEntry(name=f"{name}_again{again}" if again else name, source=f"{name}.xml"))
    fixed = Block(name="trials", order="fixed", repetitions=times, seeds="same", trials=tuple(entries))
    users = plan.users()
    others = {who: _sequence(plan, who, names) for who in users}
    whole = list(once) * times
    if all(sequence == whole for sequence in others.values()):
        return fixed, ()
    if len(set(once)) == len(once) and times == 1:
        latin = _latin(others, once)
        if latin is not None:
            return latin, ("participants are counted from 1 here: who was 0 has the order of the last row",)
    told = ", ".join(map(str, [who for who, sequence in others.items() if sequence != whole][:20]))
    return fixed, (
        f"orders: the one of participant {user} is taken; those of {told} differ (import each by --participant, or give"
        ' the block order="latin-square")',
    )


def _sequence(plan: Plan, user: int, names: dict[str, str]) -> list[str]:
    try:
        return [names.get(entry, entry) for entry in plan.entries(user)]
    except TrialError:
        return []


def _latin(others: dict[int, list[str]], once: Sequence[str]) -> Block | None:
    """Return a block whose Latin square gives every participant the order that was written, None when none does."""
    if any(sorted(sequence) != sorted(once) for sequence in others.values()):
        return None
    first = others.get(1, list(once))
    rank = len(first)
    place = [(k + 1) // 2 if k % 2 else (rank - k // 2) % rank for k in range(rank)]
    trials = [TrialEntry(name=first[place.index(k)], source=f"{first[place.index(k)]}.xml") for k in range(rank)]
    block = Block(name="trials", order="latin-square", seeds="same", trials=tuple(trials))
    trial_names = [entry.name for entry in block.trials]
    experiment = Experiment(name="square", blocks=(block,))
    for who, sequence in others.items():
        number = who or _last(others, rank)
        if [trial_names[k] for k in orders(experiment, block, number)[0]] != sequence:
            return None
    return block


def _last(others: dict[int, list[str]], rank: int) -> int:
    """Return the number from 1 that stands for participant 0: the one after a whole round of the square."""
    return rank * (1 + rank % 2) if rank > 1 else 1
