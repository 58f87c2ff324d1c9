"""What learned predictors share: a checkpoint that says what it fits, and tracks made whole for it."""

from __future__ import annotations

import hashlib
from abc import abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Windows, bridged

from .predictor import Predictor
from .pretrained_weights import ALL, AUTO, FOLDS, STEP, fold_of, misfit, shipped

__all__ = ["LearnedPredictor", "whole_tracks"]

Floats = NDArray[np.float64]

ELSEWHERE = "eth"
"""Shipped weights for places that are none of the five: those that saw all but this one, the smallest."""
TOLERANCE = 0.02
"""Windows whose time step is off by more than this share do not fit."""


@dataclass(frozen=True)
class LearnedPredictor(Predictor):
    """A predictor whose weights come from a file that ``crowdbot train`` made.

    Fields:
        checkpoint: the file; or a place (``eth``, ``hotel``, ``univ``, ``zara1``, ``zara2``) for the shipped weights
            that were learned without it; or ``auto``: without the place that the recording is named after.
        device: ``cpu``, ``cuda`` or ``cuda:N``.
        digest: hash of the file, so that results which are kept belong to its content.

    Raises:
        InputError: there is no such file.
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
                f"the checkpoint {self.checkpoint!r} cannot be read ({error.strerror}); crowdbot train makes one, and"
                f" shipped are {', '.join(FOLDS)}"
            ) from None
        object.__setattr__(self, "digest", hashlib.blake2b(content, digest_size=4).hexdigest())

    @property
    @abstractmethod
    def kind(self) -> str:
        """Name on the command line."""

    @property
    def name(self) -> str:
        """Name on the command line, followed by what weights it has: folder, file and hash when they are own ones."""
        if self.shipped:
            return self.kind + (f"(checkpoint={self.checkpoint})" if self.checkpoint != AUTO else "")
        file = Path(self.checkpoint)
        return f"{self.kind}({file.parent.name}/{file.name} {self.digest})"

    @property
    def shipped(self) -> bool:
        """Whether weights of the package are used."""
        return self.checkpoint in (AUTO, *FOLDS)

    def file(self, source: str) -> Path:
        """Return the file of the weights for a recording of this name."""
        if not self.shipped:
            return Path(self.checkpoint)
        fold = fold_of(source) if self.checkpoint == AUTO else self.checkpoint
        return shipped(self.kind, ELSEWHERE if fold == ALL else fold)

    def note(self, past: Windows) -> str:
        """Return what a user should know of forecasts of such windows in one sentence, or nothing."""
        why = self.misfit(past)
        if why:
            return f"{self.kind}: {why}; a baseline answers instead"
        if self.checkpoint == AUTO and fold_of(past.source) == ALL:
            return (
                f"{self.kind}: {past.source} is none of the five places it knows, so the weights learned at all of them"
                f" but {ELSEWHERE} are used"
            )
        return ""

    def misfit(self, past: Windows) -> str:
        """Return why shipped weights do not fit these windows, or nothing; own weights speak for themselves."""
        if not self.shipped:
            return ""
        if past.units == "m" and abs(past.dt - STEP) > TOLERANCE * STEP:
            return (
                f"{past.source} has steps of {past.dt:.4g} s, it was learned at {STEP} s:"
                f" bring it there with --step {STEP}"
            )
        return misfit(past)

    @staticmethod
    def fits(past: Windows, facts: Mapping[str, Any], what: str) -> None:
        """Raise :class:`InputError` unless windows have the time step and units that were learned."""
        if abs(past.dt - facts["dt"]) > TOLERANCE * facts["dt"]:
            raise InputError(
                f"{what} has learned steps of {facts['dt']:.4g} s, {past.source} has steps of {past.dt:.4g} s;"
                f" bring it there with --step {facts['dt']:.4g} or Trajectories.resample"
            )
        if past.units != facts["units"]:
            raise InputError(f"{what} has learned tracks in {facts['units']}, {past.source} is in {past.units}")


def whole_tracks(past: Windows, rows: int) -> Floats:
    """Return the last ``rows`` rows of everyone ``[W, rows, A, 2]`` [m], with what was not seen filled in.

    Holes are bridged by an even walk; before the first row that was seen, people walk backwards with their first
    velocity; who was seen once stood there all the time.
    """
    known = bridged(past)
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
