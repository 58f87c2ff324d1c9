"""Jobs of an evaluation: some seeds of one cell, run as environments of one simulation."""

from __future__ import annotations

import json
import math
import warnings
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

from crowdbot.core import CrowdbotError, InputError, MissingExtra, explain_write_errors
from crowdbot.simulation import Episode, RunFailureWarning, simulate_seeds
from crowdbot.trials import Trial, parse_trial

from .run_metrics import decision_metrics, episode_metrics, paired_variants


@dataclass(frozen=True)
class RunJob:
    """Some seeds of one cell.

    Fields:
        cell: index of the cell.
        xml: text of the trial.
        folder: folder of the trial, or None.
        seeds: seeds to run.
        trust: whether code from outside the folder may be loaded.
        families: families of metrics to compute from the logs.
    """

    cell: int
    xml: str
    folder: Path | None
    seeds: tuple[int, ...]
    trust: bool
    families: tuple[str, ...] = ()


@dataclass(frozen=True)
class RunRow:
    """The result of one run.

    Fields:
        seed: seed of the run.
        outcome: outcome of the episode; ``invalid`` if the trial is impossible with this seed.
        digest: digest of the episode; empty for an invalid run.
        metrics: metrics of the first robot, with ``error`` (1 for a navigator that failed).
        message: why the run is invalid, or what ended it with an error.
    """

    seed: int
    outcome: str
    digest: str = ""
    metrics: Mapping[str, float] = field(default_factory=dict)
    message: str = ""

    @property
    def valid(self) -> bool:
        """Whether the run says something about the navigator."""
        return self.outcome != "invalid"


def run_job(job: RunJob) -> list[RunRow]:
    """Run a job and return a row for each seed.

    A seed with which the trial is impossible gives an invalid row; a navigator that raises, hangs or returns NaN gives
    a failed one.

    Raises:
        KeyboardInterrupt: Ctrl-C has ended the runs.
    """
    trial = parse_trial(job.xml, folder=job.folder, trust=job.trust)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore", RunFailureWarning)
        episodes = _episodes(trial, job.seeds)
        others = {name: _episodes(variant, job.seeds) for name, variant in paired_variants(trial, job.families).items()}
    rows = []
    for k, (seed, episode) in enumerate(zip(job.seeds, episodes, strict=True)):
        runs = {name: run for name, found in others.items() if isinstance(run := found[k], Episode)}
        rows.append(_row(seed, episode, job.families, runs))
    return rows


def _episodes(trial: Trial, seeds: Sequence[int]) -> Sequence[Episode | str]:
    """Return an episode for each seed, or why it is impossible."""
    try:
        episodes: Sequence[Episode | str] = simulate_seeds(trial, seeds)
    except MissingExtra:
        raise
    except CrowdbotError:
        episodes = [_one(trial, seed) for seed in seeds]
    if any(isinstance(episode, Episode) and episode.outcome == "interrupted" for episode in episodes):
        raise KeyboardInterrupt
    return episodes


def _one(trial: Trial, seed: int) -> Episode | str:
    try:
        return simulate_seeds(trial, [seed])[0]
    except MissingExtra:
        raise
    except CrowdbotError as error:
        return " ".join(str(error).split())


def _row(seed: int, episode: Episode | str, families: Sequence[str], paired: dict[str, Episode]) -> RunRow:
    if isinstance(episode, str):
        return RunRow(seed, "invalid", message=episode)
    failed = episode.outcome == "error"
    metrics = {name: float(value) for name, value in episode.metrics.items() if "." not in name}
    if families and len(episode.times):
        metrics |= episode_metrics(episode, families, paired)
    metrics |= decision_metrics(episode)
    if failed:
        metrics |= {"success": 0.0}
    message = "" if episode.failure is None else str(episode.failure)
    return RunRow(seed, episode.outcome, episode.digest, metrics | {"error": float(failed)}, message)


def append_rows(rows: Sequence[RunRow], path: Path) -> None:
    """Append rows to a file, one line of JSON each; NaN and infinite values are texts.

    Raises:
        InputError: the file cannot be written.
    """
    text = "".join(json.dumps(row_values(row), allow_nan=False) + "\n" for row in rows)
    with explain_write_errors(path):
        path.parent.mkdir(parents=True, exist_ok=True)
        with path.open("a", encoding="utf-8") as stream:
            stream.write(text)


def read_rows(path: Path) -> list[RunRow]:
    """Read the rows of a file, an empty list without one; a last line that a kill has cut is removed.

    Raises:
        InputError: a line is damaged.
    """
    if not path.exists():
        return []
    content = path.read_bytes()
    end = content.rfind(b"\n") + 1
    if end < len(content):
        with explain_write_errors(path), path.open("r+b") as stream:
            stream.truncate(end)
    try:
        return [row_of(json.loads(line)) for line in content[:end].splitlines()]
    except (ValueError, KeyError, TypeError, AttributeError) as error:
        raise InputError(f"{path} is damaged ({type(error).__name__}); remove it to run its seeds again") from None


def row_values(row: RunRow) -> dict[str, Any]:
    """Return a row as JSON values; a value that is not finite is a text."""
    metrics = {name: value if math.isfinite(value) else str(value) for name, value in row.metrics.items()}
    return asdict(row) | {"metrics": metrics}


def row_of(values: Mapping[str, Any]) -> RunRow:
    """Return a row from JSON values."""
    metrics = {str(name): float(value) for name, value in values["metrics"].items()}
    return RunRow(int(values["seed"]), str(values["outcome"]), str(values["digest"]), metrics, str(values["message"]))
