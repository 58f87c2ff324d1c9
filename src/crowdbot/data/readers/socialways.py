"""Social Ways arrays, ``data_8_12.npz``: obsvs [N, T, 2], preds [N, T, 2], times [N, 1] (amiryanj/socialways).

Every row of the arrays is a part of a track and gets its own id. Frames number the rows, so ``fps`` is rows per second.
The file has neither a frame rate nor units.
"""

from __future__ import annotations

import zipfile

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.source import MAX_BYTES, Source, parse_errors
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

NAMES = ("obsvs", "preds", "times")


def sniff(source: Source) -> bool:
    """Return whether the file is a zip archive whose first entry is an array."""
    return source.kind == "zip" and b".npy" in source.head[:200]


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read observed and future rows as one track each; frames count rows from the time of the first."""
    arrays = _arrays(source)
    missing = [name for name in NAMES if name not in arrays]
    if missing:
        held = ", ".join(arrays) or "nothing"
        raise DataError(f"{source.name} lacks the arrays {', '.join(missing)} of Social Ways; it holds {held}")
    wrong = next((name for name in NAMES if arrays[name].dtype.kind not in "fiub"), None)
    if wrong is not None:
        raise DataError(f"{source.name}: the array {wrong} must hold numbers, it holds {arrays[wrong].dtype}")
    past, future, times = (arrays[name] for name in NAMES)
    count = len(past)
    fits = (
        past.ndim == future.ndim == 3 and past.shape[2] == future.shape[2] == 2 and len(future) == times.size == count
    )
    if not fits:
        shapes = ", ".join(f"{name} {list(arrays[name].shape)}" for name in NAMES)
        raise DataError(f"{source.name}: the arrays {shapes} must be [N, T, 2], [N, T, 2] and [N, 1]")
    place = np.concatenate([past, future], axis=1).astype(np.float64)
    rows = place.shape[1]
    frame = times.reshape(count, 1).astype(np.float64) + np.arange(rows)
    return assemble(
        source,
        options,
        id=np.repeat(np.arange(1, count + 1), rows),
        frame=frame.ravel(),
        x=place[:, :, 0].ravel(),
        y=place[:, :, 1].ravel(),
        note="" if options.units else "no unit in the file: m is assumed; units overrides this",
    )


def _arrays(source: Source) -> dict[str, NDArray[np.generic]]:
    with parse_errors(source, "arrays"):
        with zipfile.ZipFile(source.path) as packed:
            size = sum(part.file_size for part in packed.infolist())
        if size > MAX_BYTES:
            raise DataError(f"{source.name} unpacks to {size} bytes, more than the limit of {MAX_BYTES}")
        with source.path.open("rb") as stream, np.load(stream, allow_pickle=False) as unpacked:
            return {name: np.asarray(unpacked[name]) for name in unpacked.files}


READER = Reader("social-ways", "npz arrays of Social Ways: obsvs, preds, times", sniff, read)
