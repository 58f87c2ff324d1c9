"""Shipped weights of learned predictors, one file per fold.

A fold is a place that was excluded from the training data, for an unbiased evaluation on its recordings.

The default weights are part of the package. Other weights, trained with or without one of the five ETH/UCY places, are
part of the source distribution and of the archive ``crowdbot-weights`` of a release, but not of the wheel.
``assets/predictors/SHA256SUMS`` lists the SHA-256 of every file; files from outside the package must match it.
"""

from __future__ import annotations

import functools
import hashlib
import importlib.resources
import os
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, did_you_mean, user_data_folder
from crowdbot.data import Windows

VARIABLE = "CROWDBOT_WEIGHTS"
"""Environment variable with the folder of the leave-one-out weights."""


def weights_folder() -> Path:
    """Return the folder where weights outside the package are looked for."""
    chosen = os.environ.get(VARIABLE)
    if chosen:
        return Path(chosen)
    return user_data_folder() / "weights"


@functools.cache
def weight_hashes() -> dict[str, str]:
    """Return the SHA-256 of every file of pretrained weights by name.

    >>> len(weight_hashes()["anchor-net-open.npz"])
    64
    """
    lines = (_package_folder() / "SHA256SUMS").read_text(encoding="utf-8").splitlines()
    return {name: digest for digest, name in (line.split(maxsplit=1) for line in lines)}


def find_weights(kind: str, fold: str) -> Path:
    """Return the file of the weights that a predictor learned without a place.

    Args:
        kind: name of the predictor.
        fold: name of the place, ``open`` or ``all``.

    Raises:
        DataError: the file is not installed, or is not the one of this version.

    >>> find_weights("anchor-net", "open").name
    'anchor-net-open.npz'
    """
    name = f"{kind}-{fold}.npz"
    shipped, extra = _package_folder() / name, weights_folder() / name
    if shipped.is_file():
        return shipped
    if not extra.is_file():
        raise DataError(
            f"{name} is not installed, since the wheel has the default weights only: unpack crowdbot-weights.zip of the"
            f" release into {extra.parent}, or set {VARIABLE} to a folder that has it"
        )
    _check_hash(extra)
    return extra


@functools.cache
def _check_hash(path: Path) -> None:
    found = hashlib.sha256(path.read_bytes()).hexdigest()
    expected = weight_hashes().get(path.name)
    if found != expected:
        raise DataError(
            f"{path} has SHA-256 {found[:16]}..., not {str(expected)[:16]}...: it is damaged or of another version"
        )


def _package_folder() -> Path:
    return Path(str(importlib.resources.files("crowdbot").joinpath("assets", "predictors")))


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
            numbers = {name: file[name].astype(np.float64) for name in file.files}
    except FileNotFoundError:
        raise DataError(f"{path} does not exist") from None
    except Exception as error:  # numpy raises anything at damaged files: zipfile, zlib, ValueError, KeyError, EOFError
        raise DataError(f"{path} is not a file of weights, or is damaged: {error}") from None
    bad = [name for name, values in numbers.items() if not np.all(np.isfinite(values))]
    if bad:
        raise DataError(f"{path}: {bad[0]} has values that are not finite; the file is damaged")
    for values in numbers.values():
        values.setflags(write=False)
    return numbers


def incompatibility(past: Windows) -> str:
    """Return why weights for 0.4 s and metres cannot be used with these windows, or an empty string."""
    if past.units != "m":
        return f"{past.source} is in {past.units}, not in metres"
    if past.dt > LONGEST_STEP:
        return (
            f"{past.source} has time steps of {past.dt:.4g} s; the weights require {STEP} s, at most {LONGEST_STEP} s"
        )
    return ""
