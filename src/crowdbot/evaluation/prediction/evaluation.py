"""Evaluation of predictors on recordings, in jobs that can run in parallel and resume after an interruption."""

from __future__ import annotations

import dataclasses
import hashlib
import itertools
import pickle
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from crowdbot.core import InputError, run_saved_jobs, source_digest
from crowdbot.data import Recording
from crowdbot.metrics import PersonErrors, Score
from crowdbot.prediction import PredictorSpec

from .window_results import FrameResults, predict_windows

if TYPE_CHECKING:
    import pandas as pd


MIN_JOBS = 8
"""Minimum number of jobs per recording."""
JOB_AGENTS = 4_000
"""Approximate number of agents per job, summed over its windows; small jobs lose little when a run is interrupted."""


@dataclass(frozen=True)
class PredictorJob:
    """One predictor on a range of windows of one recording."""

    recording: Recording
    spec: PredictorSpec
    first: int
    last: int
    samples: int
    best_of: str
    seed: int
    live: bool

    @property
    def label(self) -> tuple[str, str]:
        """Names of the recording and the predictor."""
        return self.recording.name, self.spec.name

    @property
    def key(self) -> str:
        """Hash of everything that determines the result, except the content of the recording."""
        return hashlib.blake2b(pickle.dumps((source_digest(), self)), digest_size=12).hexdigest()


@dataclass(frozen=True)
class PredictorJobResult:
    """Result of a job: errors of each person, results by frame, number of samples in the forecasts."""

    errors: PersonErrors
    frames: FrameResults
    samples: int

    def save(self, file: Path) -> None:
        """Write the result to a file."""
        arrays = {f"errors.{name}": value for name, value in vars(self.errors).items()}
        arrays |= {f"frames.{name}": value for name, value in vars(self.frames).items()}
        with file.open("wb") as stream_:
            np.savez_compressed(stream_, samples=np.array(self.samples), **arrays)

    @classmethod
    def load(cls, file: Path) -> PredictorJobResult:
        """Read a result from a file."""
        with file.open("rb") as stream_, np.load(stream_, allow_pickle=False) as kept:
            errors = PersonErrors(**{f.name: kept[f"errors.{f.name}"] for f in dataclasses.fields(PersonErrors)})
            frames = FrameResults(**{f.name: kept[f"frames.{f.name}"] for f in dataclasses.fields(FrameResults)})
            return cls(errors, frames, int(kept["samples"]))


@dataclass(frozen=True)
class PredictorResult:
    """Score and results by frame of one predictor on one recording."""

    recording: Recording
    spec: PredictorSpec
    label: str
    score: Score
    frames: FrameResults


@dataclass(frozen=True)
class PredictorEvaluation:
    """Evaluation of every predictor on every recording.

    Fields:
        recordings: recordings, cut into windows.
        specs: predictors.
        samples: number of futures per person.
        best_of: rule that selects the best future, see :func:`~crowdbot.metrics.best_of`.
        seed: seed of all random draws.
        live: predict frame by frame; each calibration starts from the fit of the previous frame.

    Raises:
        InputError: no recording or no predictor, a duplicate predictor, or a predictor that cannot be used with a
            recording.
    """

    recordings: tuple[Recording, ...]
    specs: tuple[PredictorSpec, ...]
    samples: int = 1
    best_of: str = "person"
    seed: int = 0
    live: bool = False

    def __post_init__(self) -> None:
        if not self.recordings or not self.specs:
            raise InputError("an evaluation needs at least one recording and one predictor")
        names = [spec.name for spec in self.specs]
        for recording, spec in itertools.product(self.recordings, self.specs):
            spec.check(recording, self.live)
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise InputError(f"duplicate predictor {twice}")

    def labels(self) -> dict[str, str]:
        """Return predictor name -> short label; the full name where labels would be ambiguous."""
        short = [spec.label for spec in self.specs]
        return {spec.name: spec.label if short.count(spec.label) == 1 else spec.name for spec in self.specs}

    def window_at(self, frame: int) -> tuple[Recording, int]:
        """Return the first recording with a window that ends at this frame, and the index of the window.

        Raises:
            InputError: no window ends at this frame.
        """
        for recording in self.recordings:
            found = np.flatnonzero(recording.windows[0].frame[:, -1] == frame)
            if len(found):
                return recording, int(found[0])
        first = self.recordings[0]
        ends = first.windows[0].frame[:, -1]
        near = ends[np.argmin(np.abs(ends - frame))]
        raise InputError(f"no window of {first.path} ends at frame {frame}; the nearest one ends at {near}")

    def jobs(self) -> list[PredictorJob]:
        """Return the jobs, ordered by recording, then predictor."""
        predictor_jobs = []
        for recording in self.recordings:
            past, _ = recording.windows
            people = int(past.present[:, -1].sum())
            size = (
                len(past) if self.live else max(1, min(len(past) // MIN_JOBS, JOB_AGENTS * len(past) // max(1, people)))
            )
            for spec in self.specs:
                for first in range(0, len(past), size):
                    last = min(first + size, len(past))
                    predictor_jobs.append(
                        PredictorJob(recording, spec, first, last, self.samples, self.best_of, self.seed, self.live)
                    )
        return predictor_jobs

    def run(
        self, workers: int = 1, cluster: str | None = None, keep: Path | None = None
    ) -> Iterator[tuple[PredictorJob, PredictorJobResult]]:
        """Yield each job with its result when it is done; results stored in the folder ``keep`` come first."""
        jobs = self.jobs()
        files = [] if keep is None else self._files(keep)
        for number, part in run_saved_jobs(
            run_job, jobs, files, PredictorJobResult.save, PredictorJobResult.load, workers, cluster
        ):
            yield jobs[number], part

    def progress(self, keep: Path) -> int:
        """Return the number of jobs whose results are stored in a folder."""
        return sum(file.exists() for file in self._files(keep))

    def _files(self, keep: Path) -> list[Path]:
        content = {recording: recording.digest for recording in self.recordings}
        return [keep / f"{job.key}-{content[job.recording]}.npz" for job in self.jobs()]

    def results(self, done: Sequence[tuple[PredictorJob, PredictorJobResult]]) -> list[PredictorResult]:
        """Return one result per recording and predictor from the results of all jobs."""
        found, labels = [], self.labels()
        for recording in self.recordings:
            _, future = recording.windows
            for spec in self.specs:
                own = [(job, part) for job, part in done if job.recording == recording]
                mine = [(job.first, part) for job, part in own if job.spec.name == spec.name]
                parts = [part for _, part in sorted(mine, key=lambda pair: pair[0])]
                frames = FrameResults.concatenate([part.frames for part in parts])
                errors = PersonErrors.concatenate([part.errors for part in parts])
                score = Score.of(errors, spec.name, max(part.samples for part in parts), future, self.best_of)
                score = dataclasses.replace(score, seconds_per_window=float(frames.seconds.mean()))
                found.append(PredictorResult(recording, spec, labels[spec.name], score, frames))
        return found

    @staticmethod
    def table(results: Sequence[PredictorResult]) -> pd.DataFrame:
        """Return one row per frame, with the columns recording, predictor and the fields of :class:`FrameResults`."""
        import pandas as pd

        tables = [
            pd.DataFrame({"recording": result.recording.path, "predictor": result.spec.name, **vars(result.frames)})
            for result in results
        ]
        return pd.concat(tables, ignore_index=True)


def run_job(job: PredictorJob) -> PredictorJobResult:
    """Run one job."""
    predictor = job.spec.build(job.recording)
    size = 1 if job.live else job.last - job.first
    parts = list(
        predict_windows(
            predictor, *job.recording.windows, job.samples, job.best_of, job.seed, job.live, size, job.first, job.last
        )
    )
    return PredictorJobResult(
        PersonErrors.concatenate([part.errors for part in parts]),
        FrameResults.concatenate([part.frames for part in parts]),
        max(1, *(part.forecast.samples for part in parts)),
    )
