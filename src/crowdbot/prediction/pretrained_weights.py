"""Places that learned predictors know, and the files of what they learned without each of them.

A fold is a place that was left out of the training, so that the recordings of it can be predicted honestly.
"""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, did_you_mean
from crowdbot.data import Windows

from .weight_files import find_weights

__all__ = [
    "ALL",
    "AUTO",
    "FOLDS",
    "LONGEST_STEP",
    "STEP",
    "Numbers",
    "check_fold",
    "fold_of",
    "kept_out",
    "learned",
    "misfit",
    "read_numbers",
    "shipped",
]

Numbers = dict[str, NDArray[np.float64]]

STEP = 0.4
"""Time step of the training data [s]."""
LONGEST_STEP = 0.7
"""Largest time step [s] at which tracks can be interpolated to 0.4 s."""
ALL = "all"
AUTO = "auto"
FOLDS = {
    "eth": ("biwi_eth", "seq_eth"),
    "hotel": ("biwi_hotel", "seq_hotel"),
    "univ": ("students001", "students003", "students01", "students03"),
    "zara1": ("crowds_zara01", "zara01"),
    "zara2": ("crowds_zara02", "zara02"),
}
"""Place left out, and how the names of its recordings begin."""


def check_fold(fold: str) -> None:
    """Raise :class:`InputError` unless ``fold`` is a place, ``all`` or ``auto``."""
    known = (AUTO, ALL, *FOLDS)
    if fold not in known:
        raise InputError(f"fold {fold!r}{did_you_mean(fold, known)}; it is one of {', '.join(known)}")


def fold_of(source: str) -> str:
    """Return the place that a recording of this name was made at; ``all`` when it is none of the five.

    >>> fold_of("biwi_hotel.txt"), fold_of("crowds_zara03.txt")
    ('hotel', 'all')
    """
    name = Path(source).name
    return next((fold for fold, begins in FOLDS.items() if name.startswith(begins)), ALL)


def kept_out(fold: str, name: str) -> bool:
    """Return whether a recording of this name has no part in the training of a fold."""
    return fold != ALL and Path(name).name.startswith(FOLDS[fold])


@functools.cache
def learned(kind: str, fold: str) -> Numbers:
    """Return the arrays of a shipped file, in float64.

    Raises:
        DataError: the file is missing from the installation.
    """
    return read_numbers(shipped(kind, fold))


def shipped(kind: str, fold: str) -> Path:
    """Return the file of what a predictor learned without a place."""
    return find_weights(kind, fold)


def read_numbers(path: Path) -> Numbers:
    """Return the arrays of a file, in float64; nothing in it is executed.

    Raises:
        DataError: it is missing, damaged, or holds something else than finite numbers.
    """
    try:
        with path.open("rb") as handle, np.load(handle, allow_pickle=False) as file:
            found = {name: file[name].astype(np.float64) for name in file.files}
    except FileNotFoundError:
        raise DataError(f"there is no file {path}; train it first") from None
    except Exception as error:  # numpy raises anything at damaged files: zipfile, zlib, ValueError, KeyError, EOFError
        raise DataError(f"{path} cannot be read as learned numbers, it is damaged or something else: {error}") from None
    bad = [name for name, values in found.items() if not np.all(np.isfinite(values))]
    if bad:
        raise DataError(f"{path}: {bad[0]} holds numbers that are not finite; the file is damaged")
    for values in found.values():
        values.setflags(write=False)
    return found


def misfit(past: Windows) -> str:
    """Return why what was learned at 0.4 s in metres does not fit these windows, or nothing."""
    if past.units != "m":
        return f"{past.source} is in {past.units}, not in metres"
    if past.dt > LONGEST_STEP:
        return (
            f"{past.source} has steps of {past.dt:.4g} s, it was learned at {STEP} s and takes up to {LONGEST_STEP} s"
        )
    return ""
