"""Runs of submissions, and the board of their scores."""

from __future__ import annotations

import html
import importlib.resources
from collections.abc import Callable, Sequence
from pathlib import Path

from crowdbot.core import InputError, explain_write_errors
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


def sort_entries(challenge: Challenge, entries: Sequence[ChallengeEntry]) -> list[ChallengeEntry]:
    """Return the entries in the order of the board, the best first."""
    return sorted(entries, key=lambda entry: (*entry.rank_key(challenge.rank), entry.submission))


def write_board(challenge: Challenge, entries: Sequence[ChallengeEntry], path: Path) -> None:
    """Write the board of a challenge; it needs no other file and asks nothing from the network.

    Raises:
        InputError: there is no entry, a name is there twice, or the page cannot be written.
    """
    if not entries:
        raise InputError("a board needs at least one entry")
    names = [(entry.submission, entry.seeds) for entry in entries]
    for name in names:
        if names.count(name) > 1:
            raise InputError(f"entries: {name[0]!r} with {name[1]} seeds is there twice")
    style = importlib.resources.files("crowdbot").joinpath("assets", "evaluation", "report.css")
    kinds = [kind for kind in ("held back", "public") if any(entry.seeds == kind for entry in entries)]
    tables = "".join(_table(challenge, [entry for entry in entries if entry.seeds == kind], kind) for kind in kinds)
    page = (
        "<!doctype html><html lang='en'><head><meta charset='utf-8'>"
        "<meta name='viewport' content='width=device-width, initial-scale=1'>"
        f"<title>{html.escape(challenge.title)}</title><style>{style.read_text(encoding='utf-8')}</style></head><body>"
        f"<h1>{html.escape(challenge.title)}</h1><p>{html.escape(challenge.about)}</p>{tables}"
        f"<p>{len(challenge.trials)} trials. Intervals are 95 %. Order: {html.escape(_order(challenge))}."
        f" Source: {html.escape(challenge.source or 'none')}.</p>"
        f"<p>Hash of the challenge: <code>{challenge.hash}</code></p></body></html>\n"
    )
    with explain_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(page, encoding="utf-8")


def _order(challenge: Challenge) -> str:
    return ", then ".join(f"{name} ({order} is better)" for name, order in challenge.rank)


def _table(challenge: Challenge, entries: Sequence[ChallengeEntry], kind: str) -> str:
    head = ["", "submission", "authors", "verified", "runs", "failed", *challenge.statistics]
    rows = []
    for place, entry in enumerate(sort_entries(challenge, entries), start=1):
        runs = [row for rows in entry.runs.values() for row in rows]
        failed = sum(row.outcome == "error" for row in runs)
        statistics = [str(entry.estimate(name)) for name in challenge.statistics]
        words = ["yes" if entry.verified else "no", str(len(runs)), str(failed)]
        rows.append([str(place), entry.submission, entry.authors, *words, *statistics])
    cells = "".join("<tr>" + "".join(f"<td>{html.escape(cell)}</td>" for cell in row) + "</tr>" for row in rows)
    names = "".join(f"<th>{html.escape(name)}</th>" for name in head)
    title = "Seeds that were held back" if kind == "held back" else "Public seeds"
    return (
        f"<h2>{title}</h2><div class='wide'><table><thead><tr>{names}</tr></thead><tbody>{cells}</tbody></table></div>"
    )
