"""Run a submission in a challenge: its code runs in a sandbox, the simulation does not leave this process."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from pathlib import Path

from crowdbot.evaluation import EvaluationPlan, EvaluationResult, Method, evaluate

from .challenge import Challenge
from .entry import ChallengeEntry
from .submission import Submission


def enter(
    challenge: Challenge,
    submission: Submission,
    seeds: Sequence[int] | None = None,
    *,
    folder: Path | None = None,
    workers: int = 1,
    sandbox: bool = True,
    progress: Callable[[float], None] | None = None,
) -> tuple[ChallengeEntry, EvaluationPlan, EvaluationResult]:
    """Run a submission in all trials of a challenge; return its entry, and the evaluation for a report.

    Args:
        challenge: the challenge.
        submission: the submission.
        seeds: seeds that are held back (default: the public seeds).
        folder: folder of partial results, from which an interrupted run continues.
        workers: number of processes.
        sandbox: whether the code of the submission runs in a sandbox.
        progress: called with the completed share, 0 to 1.

    Raises:
        InputError: this system has no sandbox.
    """
    plan = EvaluationPlan(
        challenge.trials,
        [method_of(challenge, submission, sandbox)],
        seeds=challenge.public_seeds if seeds is None else seeds,
    )
    result = evaluate(plan, folder, workers=workers, progress=progress)
    entry = ChallengeEntry(
        challenge.name,
        challenge.hash,
        submission.name,
        submission.hash,
        submission.authors,
        "public" if seeds is None else "held back",
        {cell.trial: cell.runs for cell in result.cells},
        provenance=result.provenance,
    )
    return entry, plan, result


def method_of(challenge: Challenge, submission: Submission, sandbox: bool) -> Method:
    """Return the process navigator of a submission with the limits of the challenge."""
    place = submission.folder.resolve()
    limits = challenge.limits
    code = (
        {"address": str(place / submission.navigator), "parameters": submission.parameters}
        if submission.navigator
        else {"command": str(place / submission.command)}
    )
    settings = {
        **{name: text for name, text in code.items() if text},
        "sandbox": str(sandbox).lower(),
        "timeout": repr(limits["answer"]),
        "memory": repr(limits["memory"]),
        "cpu": repr(limits["cpu"]),
    }
    return Method(submission.name, "process", tuple(settings.items()))
