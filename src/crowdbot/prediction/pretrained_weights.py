"""Shipped weights of learned predictors, one file per fold.

A fold is a place that was excluded from the training data, for an unbiased evaluation on its recordings.
"""

from __future__ import annotations

import functools
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, did_you_mean
from crowdbot.data import Windows

from .weight_files import find_weights

Numbers = dict[str, NDArray[np.float64]]

STEP = 0.4
"""Time step of the training data [s]."""
LONGEST_STEP = 0.7
"""Largest time step [s] at which tracks can be interpolated to 0.4 s."""
ALL = "all"
"""Fold of the weights that learned from all ETH/UCY recordings."""
OPEN = "open"
"""Fold of the default weights: only recordings whose terms allow it (UCY, Jülich archive), and simulated crowds."""
AUTO = "auto"
FOLDS = {
    "eth": ("biwi_eth", "seq_eth"),
    "hotel": ("biwi_hotel", "seq_hotel"),
    "univ": ("students001", "students003", "students01", "students03"),
    "zara1": ("crowds_zara01", "zara01"),
    "zara2": ("crowds_zara02", "zara02"),
}
"""Excluded place -> prefixes of the names of its recordings."""


def check_fold(fold: str) -> None:
    """Raise :class:`InputError` unless ``fold`` is a place, ``open``, ``all`` or ``auto``."""
    known = (AUTO, OPEN, ALL, *FOLDS)
    if fold not in known:
        raise InputError(f"fold {fold!r}{did_you_mean(fold, known)}; it is one of {', '.join(known)}")


def fold_of(source: str) -> str:
    """Return the place of a recording by its name; ``open`` if it is none of the five places.

    >>> fold_of("biwi_hotel.txt"), fold_of("crowds_zara03.txt")
    ('hotel', 'open')
    """
    name = Path(source).name
    return next((fold for fold, begins in FOLDS.items() if name.startswith(begins)), OPEN)


def is_held_out(fold: str, name: str) -> bool:
    """Return whether a recording of this name is excluded from the training of a fold."""
    return fold in FOLDS and Path(name).name.startswith(FOLDS[fold])


@functools.cache
def load_pretrained(kind: str, fold: str) -> Numbers:
    """Return the shipped weights of a predictor as float64 arrays.

    Raises:
        DataError: the file is missing from the installation.
    """
    return read_weights(pretrained_file(kind, fold))


def pretrained_file(kind: str, fold: str) -> Path:
    """Return the file of the shipped weights of a predictor."""
    return find_weights(kind, fold)


def read_weights(path: Path) -> Numbers:
    """Return the arrays of a file as float64, without executing any code in it.

    Raises:
        DataError: the file is missing or damaged, or has values that are not finite.
    """
    try:
        with path.open("rb") as handle, np.load(handle, allow_pickle=False) as file:
            found = {name: file[name].astype(np.float64) for name in file.files}
    except FileNotFoundError:
        raise DataError(f"{path} does not exist") from None
    except Exception as error:  # numpy raises anything at damaged files: zipfile, zlib, ValueError, KeyError, EOFError
        raise DataError(f"{path} is not a file of weights, or is damaged: {error}") from None
    bad = [name for name, values in found.items() if not np.all(np.isfinite(values))]
    if bad:
        raise DataError(f"{path}: {bad[0]} has values that are not finite; the file is damaged")
    for values in found.values():
        values.setflags(write=False)
    return found


def incompatibility(past: Windows) -> str:
    """Return why weights for 0.4 s and metres cannot be used with these windows, or an empty string."""
    if past.units != "m":
        return f"{past.source} is in {past.units}, not in metres"
    if past.dt > LONGEST_STEP:
        return (
            f"{past.source} has time steps of {past.dt:.4g} s; the weights require {STEP} s, at most {LONGEST_STEP} s"
        )
    return ""
