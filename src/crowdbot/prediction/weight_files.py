"""Files of pretrained weights.

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

from crowdbot.core import DataError, user_data_folder

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
