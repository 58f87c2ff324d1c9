"""Import of experiments of the CrowdBot simulator (2021) from configuration and order files."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path, PurePosixPath

from crowdbot.core import TrialError
from crowdbot.trials import Plan, Trial, plan_of, trials_of

from .experiment import Block, Experiment, TrialEntry
from .session_plan import orders


@dataclass(frozen=True)
class ImportedExperiment:
    """An imported experiment.

    Fields:
        experiment: experiment with one block of all trials.
        trials: trials by file name, the sources in the experiment.
        left_out: one sentence for each item that was not imported.
    """

    experiment: Experiment
    trials: tuple[tuple[str, Trial], ...]
    left_out: tuple[str, ...]


def import_experiment(
    path: str | Path, *, participant: int | None = None, root: str | Path | None = None
) -> ImportedExperiment:
    """Read an experiment of the original simulator.

    Two orders for odd and even participants (``{TWO}``), or orders that form the rows of a Williams square, become a
    Latin square. Of other orders, one is used. A repeated sequence becomes repetitions.

    Args:
        path: a configuration (root element ``Config``) or an order file.
        participant: participant whose order is used; None uses that of the configuration.
        root: folder of the simulator project, see :func:`crowdbot.trials.import_original`.

    Raises:
        TrialError: the file is missing, unsafe or of another format, or none of its trials can be read.
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
        "screens: the original has none; add instructions, questions and an ending",
        "seeds: the original starts every run with the same seed, so crowds are equal for all participants",
    )
    experiment = Experiment(
        name=(plan.path.stem.strip() or "imported")[:80],
        about="Imported from the CrowdBot simulator of 2021.",
        blocks=(block,),
    )
    return ImportedExperiment(experiment, tuple(trials.items()), tuple(dict.fromkeys(notes)))


def _names(entries: Sequence[str]) -> dict[str, str]:
    """Return a unique short name for each trial file."""
    names: dict[str, str] = {}
    for entry in dict.fromkeys(entries):
        short = re.sub("[^A-Za-z0-9_]", "_", PurePosixPath(entry).stem)[:30]
        short = short if short[:1].isascii() and short[:1].isalpha() else f"trial_{short}"
        name, number = short, 2
        while name.lower() in (name.lower() for name in names.values()):
            name, number = f"{short}_{number}", number + 1
        names[entry] = name
    return names


def _times(sequence: Sequence[str]) -> int:
    """Return how often a sequence repeats a shorter one."""
    count = len(sequence)
    lengths = (size for size in range(1, count + 1) if count % size == 0)
    return next(count // size for size in lengths if list(sequence[:size]) * (count // size) == list(sequence))


def _block(
    plan: Plan, user: int, once: Sequence[str], times: int, names: dict[str, str]
) -> tuple[Block, tuple[str, ...]]:
    """Return the block of trials, and the parts of its orders that were not imported."""
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
            return latin, (
                "participants are numbered from 1 here: participant 0 of the original is the one with the last row",
            )
    told = ", ".join(map(str, [who for who, sequence in others.items() if sequence != whole][:20]))
    return fixed, (
        f"orders: the order of participant {user} is used; those of {told} differ (import each with "
        f"--participant, or"
        ' set order="latin-square" in the block)',
    )


def _sequence(plan: Plan, user: int, names: dict[str, str]) -> list[str]:
    try:
        return [names.get(entry, entry) for entry in plan.entries(user)]
    except TrialError:
        return []


def _latin(others: dict[int, list[str]], once: Sequence[str]) -> Block | None:
    """Return a block whose Latin square reproduces the given orders, None if there is none."""
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
    """Return the participant number (from 1) with the order of participant 0: the one after a full cycle of the
    square.
    """
    return rank * (1 + rank % 2) if rank > 1 else 1
