"""RecordingCalibration: calibration of a whole recording, in chunks on several workers; finished chunks are stored."""

from __future__ import annotations

import dataclasses
import hashlib
import pickle
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import run_saved_jobs, source_digest, stream
from crowdbot.data import Recording, Windows

from .calibrator import Calibrator
from .fit import Fit
from .scheme_parts import goal_for

PIECES = 8
"""Minimum number of chunks of a recording."""
AGENTS = 2_000
"""Approximate number of people in a chunk, summed over its windows; an interrupted run loses at most a chunk."""


@dataclass(frozen=True)
class CalibrationChunk:
    """Calibration of the windows ``first`` to ``last`` (not included) of a recording.

    Fields:
        frame, people: ``[W]``, last observed frame of each window, and number of people present.
        arrays: arrays of :class:`Fit` by name.
    """

    first: int
    last: int
    frame: NDArray[np.int64]
    people: NDArray[np.int64]
    arrays: dict[str, NDArray[Any]]


@dataclass(frozen=True)
class RecordingCalibration:
    """The calibration of a recording with a scheme.

    Fields:
        recording: the recording; only observed rows are used, unless the goal requires the future.
        calibrator: calibrator with individual parameters; ``goal`` replaces its goal, if given.
        goal: name of a goal that depends on the recording, see :func:`goal_for`.
        seed: seed of the search; each window has its own random stream.
    """

    recording: Recording
    calibrator: Calibrator
    goal: str | None = None
    seed: int = 0

    @property
    def goal_calibrator(self) -> Calibrator:
        """The calibrator with the goal of this recording."""
        if self.goal is None:
            return self.calibrator
        return dataclasses.replace(self.calibrator, goal=goal_for(self.goal, self.recording))

    @property
    def key(self) -> str:
        """Hash of all inputs that determine the result."""
        content = pickle.dumps((source_digest(), self, self.recording.digest))
        return hashlib.blake2b(content, digest_size=12).hexdigest()

    @property
    def past(self) -> Windows:
        """The windows used for the calibration."""
        return self.recording.windows[0]

    def run(self, workers: int = 1, cluster: str | None = None, keep: Path | None = None) -> Iterator[CalibrationChunk]:
        """Yield finished chunks; chunks stored in the folder ``keep`` come first."""
        past = self.past
        people = int(past.present[:, -1].sum())
        size = max(1, min(len(past) // PIECES, AGENTS * len(past) // max(1, people)))
        jobs = [(self, first, min(first + size, len(past))) for first in range(0, len(past), size)]
        files = [] if keep is None else [keep / f"{self.key}-{first}.npz" for _, first, _ in jobs]
        for _, chunk in run_saved_jobs(_calibrate_chunk, jobs, files, _save, _load, workers, cluster):
            yield chunk

    def merge(self, chunks: Sequence[CalibrationChunk]) -> Fit:
        """Return the fit of the whole recording from all its chunks."""
        ordered = sorted(chunks, key=lambda chunk: chunk.first)
        calibrator = self.goal_calibrator
        whole = {name: np.concatenate([chunk.arrays[name] for chunk in ordered]) for name in ordered[0].arrays}
        seconds = float(whole.pop("seconds").sum())
        return Fit(
            calibrator.scheme, calibrator.space, calibrator.rollout, **whole, seconds=seconds, windows=len(self.past)
        )


ARRAYS = ("values", "given", "id", "counted", "cost", "given_cost", "evaluations", "history")


def _calibrate_chunk(job: tuple[RecordingCalibration, int, int]) -> CalibrationChunk:
    campaign, first, last = job
    past = campaign.past[first:last]
    rngs = [stream(campaign.seed, "calibrate", window) for window in range(first, last)]
    fit = campaign.goal_calibrator.fit_each(past, rngs)
    arrays = {name: getattr(fit, name) for name in ARRAYS}
    arrays["seconds"] = np.array([fit.seconds])
    return CalibrationChunk(first, last, past.frame[:, -1], past.present[:, -1].sum(axis=1), arrays)


def _save(chunk: CalibrationChunk, file: Path) -> None:
    with file.open("wb") as stream_:
        bounds = np.array([chunk.first, chunk.last])
        arrays: dict[str, Any] = {"bounds": bounds, "frame": chunk.frame, "people": chunk.people, **chunk.arrays}
        np.savez_compressed(stream_, **arrays)


def _load(file: Path) -> CalibrationChunk:
    with file.open("rb") as stream_, np.load(stream_, allow_pickle=False) as kept:
        first, last = kept["bounds"].tolist()
        arrays = {name: kept[name] for name in (*ARRAYS, "seconds")}
        return CalibrationChunk(first, last, kept["frame"], kept["people"], arrays)
