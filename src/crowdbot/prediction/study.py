"""Study: predictors on recordings, piece by piece on several workers; what is done is kept and never done again."""

from __future__ import annotations

import dataclasses
import hashlib
import itertools
import pickle
import time
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from crowdbot.calibration import Fit
from crowdbot.core import InputError, run_saved_jobs, source_digest, stream
from crowdbot.data import Recording
from crowdbot.metrics import PersonErrors, Score, person_errors

from .recipe import Recipe

if TYPE_CHECKING:
    import pandas as pd

__all__ = ["Frames", "Part", "Piece", "Result", "Study"]

PIECES = 8
"""A recording is cut into at least so many pieces when they are kept or shared among workers ..."""
AGENTS = 4_000
"""... and into pieces of about so many people of all windows together, so that an interrupted run loses little."""


@dataclass(frozen=True)
class Piece:
    """One job: some windows of a recording, by one predictor."""

    recording: Recording
    recipe: Recipe
    first: int
    last: int
    samples: int
    best_of: str
    seed: int
    live: bool

    @property
    def label(self) -> tuple[str, str]:
        """Names of recording and predictor."""
        return self.recording.name, self.recipe.name

    @property
    def key(self) -> str:
        """Hash of everything that decides about the result but the content of the recording."""
        return hashlib.blake2b(pickle.dumps((source_digest(), self)), digest_size=12).hexdigest()


@dataclass(frozen=True)
class Frames:
    """What happened at each predicted frame (the last observed row of a window), one row each.

    Fields:
        frame: counter of the recording.
        people: how many were present.
        cost: of the calibrated crowd [m]; NaN without calibration.
        evaluations: how many crowds were tried.
        seconds: time to predict the frame; an even share when windows were predicted together.
        ade, fde: mean over the scored people of the window [m].
    """

    frame: NDArray[np.int64]
    people: NDArray[np.int64]
    cost: NDArray[np.float64]
    evaluations: NDArray[np.int64]
    seconds: NDArray[np.float64]
    ade: NDArray[np.float64]
    fde: NDArray[np.float64]

    @property
    def calibrated(self) -> bool:
        """Whether crowds were calibrated for these frames."""
        return bool(np.any(self.evaluations > 0))

    @classmethod
    def joined(cls, parts: Sequence[Frames]) -> Frames:
        """Return the frames of several parts, in order."""
        names = [field.name for field in dataclasses.fields(cls)]
        return cls(*(np.concatenate([getattr(part, name) for part in parts]) for name in names))


@dataclass(frozen=True)
class Part:
    """The result of a piece: errors of people, frames, and how many samples the forecast had."""

    errors: PersonErrors
    frames: Frames
    samples: int

    def save(self, file: Path) -> None:
        """Write it to a file."""
        arrays = {f"errors.{name}": value for name, value in vars(self.errors).items()}
        arrays |= {f"frames.{name}": value for name, value in vars(self.frames).items()}
        with file.open("wb") as stream_:
            np.savez_compressed(stream_, samples=np.array(self.samples), **arrays)

    @classmethod
    def load(cls, file: Path) -> Part:
        """Read a part that was kept."""
        with np.load(file, allow_pickle=False) as kept:
            errors = PersonErrors(**{f.name: kept[f"errors.{f.name}"] for f in dataclasses.fields(PersonErrors)})
            frames = Frames(**{f.name: kept[f"frames.{f.name}"] for f in dataclasses.fields(Frames)})
            return cls(errors, frames, int(kept["samples"]))


@dataclass(frozen=True)
class Result:
    """One predictor on one recording: its short label, its score, and what happened at each frame."""

    recording: Recording
    recipe: Recipe
    label: str
    score: Score
    frames: Frames


@dataclass(frozen=True)
class Study:
    """Which predictors are scored on which recordings, and how.

    Fields:
        recordings, recipes: every predictor predicts every recording.
        samples: futures per person; ``best_of`` is the rule that chooses among them.
        seed: of the randomness.
        live: frames come one after the other, and calibrations begin with the fit of the frame before.

    Raises:
        InputError: there is no recording or no predictor, one is named twice, or one cannot work on a recording.
    """

    recordings: tuple[Recording, ...]
    recipes: tuple[Recipe, ...]
    samples: int = 1
    best_of: str = "person"
    seed: int = 0
    live: bool = False

    def __post_init__(self) -> None:
        if not self.recordings or not self.recipes:
            raise InputError("a study needs at least one recording and one predictor")
        names = [recipe.name for recipe in self.recipes]
        for recording, recipe in itertools.product(self.recordings, self.recipes):
            recipe.check(recording, self.live)
        twice = next((name for name in names if names.count(name) > 1), None)
        if twice is not None:
            raise InputError(f"the predictor {twice} is named twice")

    def labels(self) -> dict[str, str]:
        """Return name -> short label of every predictor; the name itself where two would be called the same."""
        short = [recipe.label for recipe in self.recipes]
        return {one.name: one.label if short.count(one.label) == 1 else one.name for one in self.recipes}

    def window_at(self, frame: int) -> tuple[Recording, int]:
        """Return the first recording with a window whose last observed frame is this one, and which window it is.

        Raises:
            InputError: there is none.
        """
        for recording in self.recordings:
            found = np.flatnonzero(recording.windows[0].frame[:, -1] == frame)
            if len(found):
                return recording, int(found[0])
        first = self.recordings[0]
        ends = first.windows[0].frame[:, -1]
        near = ends[np.argmin(np.abs(ends - frame))]
        raise InputError(f"no window of {first.path} ends at frame {frame}; the nearest one ends at {near}")

    def pieces(self) -> list[Piece]:
        """Return the jobs, recording by recording and predictor by predictor."""
        found = []
        for recording in self.recordings:
            past, _ = recording.windows
            people = int(past.present[:, -1].sum())
            size = len(past) if self.live else max(1, min(len(past) // PIECES, AGENTS * len(past) // max(1, people)))
            for recipe in self.recipes:
                for first in range(0, len(past), size):
                    last = min(first + size, len(past))
                    found.append(
                        Piece(recording, recipe, first, last, self.samples, self.best_of, self.seed, self.live)
                    )
        return found

    def run(
        self, workers: int = 1, cluster: str | None = None, keep: Path | None = None
    ) -> Iterator[tuple[Piece, Part]]:
        """Yield the pieces and their results as they are done; those kept in the folder ``keep`` come first."""
        pieces = self.pieces()
        content = {recording: recording.digest for recording in self.recordings} if keep is not None else {}
        files = [] if keep is None else [keep / f"{piece.key}-{content[piece.recording]}.npz" for piece in pieces]
        for number, part in run_saved_jobs(predicted, pieces, files, Part.save, Part.load, workers, cluster):
            yield pieces[number], part

    def results(self, done: Sequence[tuple[Piece, Part]]) -> list[Result]:
        """Return score and frames of every recording and predictor, from the results of all pieces."""
        found, labels = [], self.labels()
        for recording in self.recordings:
            _, future = recording.windows
            for recipe in self.recipes:
                own = [(piece, part) for piece, part in done if piece.recording == recording]
                mine = [(piece.first, part) for piece, part in own if piece.recipe.name == recipe.name]
                parts = [part for _, part in sorted(mine, key=lambda pair: pair[0])]
                frames = Frames.joined([part.frames for part in parts])
                errors = PersonErrors.joined([part.errors for part in parts])
                score = Score.of(errors, recipe.name, max(part.samples for part in parts), future, self.best_of)
                score = dataclasses.replace(score, seconds_per_window=float(frames.seconds.mean()))
                found.append(Result(recording, recipe, labels[recipe.name], score, frames))
        return found

    @staticmethod
    def table(results: Sequence[Result]) -> pd.DataFrame:
        """Return every frame of every result as one table with the columns recording, predictor and those of Frames."""
        import pandas as pd

        tables = [
            pd.DataFrame({"recording": one.recording.path, "predictor": one.recipe.name, **vars(one.frames)})
            for one in results
        ]
        return pd.concat(tables, ignore_index=True)


def predicted(piece: Piece) -> Part:
    """Do one piece of work."""
    past, future = piece.recording.windows
    predictor = piece.recipe.prepared(piece.recording)
    rng = stream(piece.seed, "predict")
    rng.integers(0, 2**63, size=piece.first)  # each window takes one number, so that pieces draw what the whole draws
    predictor.follow(past[:1], future.position.shape[1], piece.samples, stream(piece.seed, "warm"))
    step = 1 if piece.live else piece.last - piece.first
    errors, frames, samples, memory = [], [], 1, None
    for first in range(piece.first, piece.last, step):
        part = slice(first, min(first + step, piece.last))
        begin = time.perf_counter()
        forecast, memory = predictor.follow(
            past[part], future.position.shape[1], piece.samples, rng, memory if piece.live else None
        )
        seconds = (time.perf_counter() - begin) / len(past[part])
        errors.append(person_errors(forecast, future[part], piece.best_of))
        frames.append(_frames(piece, part, errors[-1], memory, seconds))
        samples = max(samples, forecast.samples)
    return Part(PersonErrors.joined(errors), Frames.joined(frames), samples)


def _frames(piece: Piece, part: slice, errors: PersonErrors, fit: object, seconds: float) -> Frames:
    past, future = (windows[part] for windows in piece.recording.windows)
    W = len(past)
    window = np.repeat(np.arange(W), future.scored.sum(axis=1))
    count = np.bincount(window, minlength=W)

    def mean(values: NDArray[np.float64]) -> NDArray[np.float64]:
        return np.where(count > 0, np.bincount(window, values, W) / np.maximum(count, 1), np.nan)

    return Frames(
        frame=past.frame[:, -1],
        people=past.present[:, -1].sum(axis=1),
        cost=fit.cost if isinstance(fit, Fit) else np.full(W, np.nan),
        evaluations=fit.evaluations if isinstance(fit, Fit) else np.zeros(W, dtype=np.int64),
        seconds=np.full(W, seconds),
        ade=mean(errors.ade),
        fde=mean(errors.fde),
    )
