"""Board of a challenge: one static HTML page with all entries in their order."""

from __future__ import annotations

import html
import importlib.resources
from collections.abc import Sequence
from pathlib import Path

from crowdbot.core import InputError, explain_write_errors

from .challenge import Challenge
from .entry import ChallengeEntry


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
    tables = "".join(_table(challenge, [one for one in entries if one.seeds == kind], kind) for kind in kinds)
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
