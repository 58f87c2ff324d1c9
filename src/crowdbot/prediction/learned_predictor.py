"""LearnedPredictor: base class of predictors with weights in a checkpoint file."""

from __future__ import annotations

import hashlib
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError
from crowdbot.data import Windows, fill_gaps
from crowdbot.typing import Floats

from .predictor import Predictor
from .pretrained_weights import AUTO, FOLDS, OPEN, STEP, fold_of, incompatibility, pretrained_file

ELSEWHERE = "eth"
"""Fold of the shipped weights for other places: trained on all places except this one, the smallest."""
TOLERANCE = 0.02
"""Maximum relative difference of the time step."""


@dataclass(frozen=True)
class LearnedPredictor(Predictor):
    """A predictor with weights from a file of ``crowdbot train``.

    Fields:
        checkpoint: file of the weights; or a place (``eth``, ``hotel``, ``univ``, ``zara1``, ``zara2``) for the shipped
            weights trained without it; or ``auto``: without the place of the recording, by its name.
        device: ``cpu``, ``cuda`` or ``cuda:N``.
        digest: hash of the file.

    Raises:
        InputError: the file cannot be read.
    """

    checkpoint: str = AUTO
    device: str = "cpu"
    digest: str = field(init=False, repr=False, default="")

    def __post_init__(self) -> None:
        if self.checkpoint == AUTO:
            return
        try:
            content = self.file("").read_bytes()
        except OSError as error:
            raise InputError(
                f"the checkpoint {self.checkpoint!r} cannot be read ({error.strerror}); give a file of crowdbot train,"
                f" or auto, {', '.join(FOLDS)} for shipped weights"
            ) from None
        object.__setattr__(self, "digest", hashlib.blake2b(content, digest_size=4).hexdigest())

    @property
    @abstractmethod
    def kind(self) -> str:
        """Name on the command line."""

    @property
    def name(self) -> str:
        # name on the command line with its weights: folder, file and hash for own weights
        if self.is_pretrained:
            return self.kind + (f"(checkpoint={self.checkpoint})" if self.checkpoint != AUTO else "")
        file = Path(self.checkpoint)
        return f"{self.kind}({file.parent.name}/{file.name} {self.digest})"

    @property
    def is_pretrained(self) -> bool:
        """Whether shipped weights are used."""
        return self.checkpoint in (AUTO, *FOLDS)

    def file(self, source: str) -> Path:
        """Return the file of the weights for a recording of this name."""
        if not self.is_pretrained:
            return Path(self.checkpoint)
        fold = fold_of(source) if self.checkpoint == AUTO else self.checkpoint
        return pretrained_file(self.kind, ELSEWHERE if fold == OPEN else fold)

    def note(self, past: Windows) -> str:
        why = self.incompatibility(past)
        if why:
            return f"{self.kind}: {why}; a baseline is used instead"
        if self.checkpoint == AUTO and fold_of(past.source) == OPEN:
            return (
                f"{self.kind}: {past.source} is not named after a training place; using the weights trained without"
                f" {ELSEWHERE}"
            )
        return ""

    def incompatibility(self, past: Windows) -> str:
        """Return why shipped weights cannot be used with these windows, or an empty string."""
        if not self.is_pretrained:
            return ""
        if past.units == "m" and abs(past.dt - STEP) > TOLERANCE * STEP:
            return (
                f"{past.source} has time steps of {past.dt:.4g} s; the weights require {STEP} s:"
                f" resample with --step {STEP}"
            )
        return incompatibility(past)

    @staticmethod
    def fits(past: Windows, facts: Mapping[str, Any], what: str) -> None:
        """Raise :class:`InputError` if windows have another time step or other units than the training data."""
        if abs(past.dt - facts["dt"]) > TOLERANCE * facts["dt"]:
            raise InputError(
                f"{what} requires time steps of {facts['dt']:.4g} s, {past.source} has {past.dt:.4g} s;"
                f" resample with --step {facts['dt']:.4g} or Trajectories.resample"
            )
        if past.units != facts["units"]:
            raise InputError(f"{what} requires tracks in {facts['units']}, {past.source} is in {past.units}")


def complete_tracks(past: Windows, rows: int) -> Floats:
    """Return the last ``rows`` rows of all agents ``[W, rows, A, 2]`` [m] without gaps.

    Gaps are interpolated linearly; rows before the first observed row are extrapolated with the first velocity. Agents
    observed once have a constant position.
    """
    known = fill_gaps(past)
    have = known.position.shape[1]
    if have < rows:
        pad = ((0, 0), (rows - have, 0), (0, 0))
        present = np.pad(known.present, pad)
        position = np.pad(known.position, (*pad, (0, 0)))
    else:
        present, position = known.present[:, have - rows :], known.position[:, have - rows :]
    begin = np.argmax(present, axis=1)[:, None, :, None]  # [W, 1, A, 1]
    after = np.minimum(begin + 1, rows - 1)
    first = np.take_along_axis(position, begin, axis=1)
    step = np.take_along_axis(position, after, axis=1) - first
    row = np.arange(rows)[:, None, None]
    filled = np.where(row < begin, first + (row - begin) * step, position)
    return np.where(past.present[:, -1:, :, None], filled, 0.0)
