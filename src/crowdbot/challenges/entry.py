"""ChallengeEntry: the result of one submission in a challenge."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError, explain_write_errors
from crowdbot.evaluation import DECISION_METRICS, Estimate, RunRow, parse_statistic, row_of, row_values

from .challenge import Challenge

SCHEMA = "crowdbot-challenge-entry/1"
MOST_BYTES = 500_000_000


@dataclass(frozen=True)
class ChallengeEntry:
    """The runs of a submission in all trials of a challenge.

    Fields:
        challenge, challenge_hash: name and hash of the challenge.
        submission, submission_hash, authors: name, hash and authors of the submission.
        seeds: ``public`` or ``held back``.
        runs: rows by trial, in the order of the seeds.
        verified: whether these runs were made again from the files of the submission, with the same digests.
        provenance: program and machine that made the runs.
    """

    challenge: str
    challenge_hash: str
    submission: str
    submission_hash: str
    authors: str
    seeds: str
    runs: Mapping[str, tuple[RunRow, ...]]
    verified: bool = False
    provenance: Mapping[str, Any] = field(default_factory=dict)

    def estimate(self, statistic: str, trial: str | None = None) -> Estimate:
        """Return a statistic with its interval, over one trial or all."""
        chosen = self.runs.values() if trial is None else [self.runs[trial]]
        rows = [row for rows in chosen for row in rows if row.valid]
        found = parse_statistic(statistic)
        return found.estimate(np.array([row.metrics.get(found.metric, np.nan) for row in rows], dtype=np.float64))

    def rank_key(self, rank: Sequence[tuple[str, str]]) -> tuple[float, ...]:
        """Return what orders entries, the best first; a statistic without a value comes last."""
        keys = []
        for name, order in rank:
            value = self.estimate(name).value
            keys.append(np.inf if np.isnan(value) else -value if order == "high" else value)
        return tuple(map(float, keys))

    def save(self, path: Path) -> None:
        """Write the entry as JSON."""
        with explain_write_errors(path):
            path.parent.mkdir(parents=True, exist_ok=True)
            path.write_text(self.text(), encoding="utf-8")

    def text(self) -> str:
        """Return the entry as JSON."""
        runs = {trial: [row_values(row) for row in rows] for trial, rows in self.runs.items()}
        fields = (
            "challenge", "challenge_hash", "submission", "submission_hash", "authors", "seeds", "verified",
            "provenance",
        )  # fmt: skip
        content = {"schema": SCHEMA, **{name: getattr(self, name) for name in fields}, "runs": runs}
        return json.dumps(content, allow_nan=False, indent=1, default=dict) + "\n"


def load_entry(source: Path | bytes, challenge: Challenge | None = None) -> ChallengeEntry:
    """Read an entry from a file or its content.

    Args:
        source: file, or bytes.
        challenge: the challenge that the entry must belong to.

    Raises:
        InputError: the entry is damaged, or belongs to another challenge.
    """
    name = str(source) if isinstance(source, Path) else "the entry"
    try:
        data = source.read_bytes() if isinstance(source, Path) else source
        if len(data) > MOST_BYTES:
            raise InputError(f"{name} has {len(data)} bytes, at most {MOST_BYTES} are read")
        values = json.loads(data)
        if values["schema"] != SCHEMA:
            raise InputError(f"{name} has the schema {values['schema']!r}, expected {SCHEMA!r}")
        texts = ("challenge", "challenge_hash", "submission", "submission_hash", "authors", "seeds")
        runs = {str(trial): tuple(map(row_of, rows)) for trial, rows in values["runs"].items()}
        parts = {text: str(values[text]) for text in texts}
        verified, provenance = values["verified"] is True, dict(values["provenance"])
        challenge_entry = ChallengeEntry(**parts, runs=runs, verified=verified, provenance=provenance)
    except OSError as error:
        raise InputError(f"{name}: {error.strerror}") from None
    except (ValueError, KeyError, TypeError, AttributeError, RecursionError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name} is not an entry of a challenge ({type(error).__name__})") from None
    if challenge is not None and challenge_entry.challenge_hash != challenge.hash:
        raise InputError(
            f"{name} was made for another version of {challenge.name}: hash {challenge_entry.challenge_hash[:12]}...,"
            f" the challenge has {challenge.hash[:12]}..."
        )
    return challenge_entry


def entry_differences(claimed: ChallengeEntry, found: ChallengeEntry) -> list[str]:
    """Return how the runs of two entries differ, a sentence for each run; empty if all digests are equal."""
    lines = []
    if claimed.submission_hash != found.submission_hash:
        lines.append(
            f"the files of the submission differ: {claimed.submission_hash[:12]}..., {found.submission_hash[:12]}..."
        )
    for trial, rows in found.runs.items():
        told = {row.seed: row for row in claimed.runs.get(trial, ())}
        for row in rows:
            other = told.get(row.seed)
            if other is None:
                lines.append(f"{trial}, seed {row.seed}: not in the entry")
            elif (other.digest, other.outcome) != (row.digest, row.outcome):
                lines.append(f"{trial}, seed {row.seed}: {other.outcome} {other.digest[:12]} claimed,"
                             f" {row.outcome} {row.digest[:12]} found")  # fmt: skip
            elif _without_times(other) != _without_times(row):
                lines.append(f"{trial}, seed {row.seed}: same digest, other metrics")
    return lines


def _without_times(row: RunRow) -> dict[str, Any]:
    """Return the metrics of a run without those of real time."""
    return {name: value for name, value in row_values(row)["metrics"].items() if name not in DECISION_METRICS}
