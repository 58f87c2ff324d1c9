"""StoredForecasts: forecasts made elsewhere, read from a file and scored as a predictor."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
import re
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crowdbot.core import DataError, InputError
from crowdbot.data import FORECAST_SUFFIXES, Forecast, Windows, read_forecasts
from crowdbot.typing import Floats

from .predictor import Predictor


@dataclass(frozen=True)
class StoredForecasts(Predictor):
    """Returns the forecasts of a file, by the last observed frame and the identities of the recording.

    People who are not in the file are not predicted. Fewer samples than in the file are the first ones.

    Fields:
        file: file of forecasts, see :func:`~crowdbot.data.read_forecasts`, or what names one file for each recording.
        digest: hash of its content.
        recordings: name of each recording, file with its forecasts and hash of the content; empty if ``file`` has the
            forecasts of every recording.
    """

    batched = True

    file: str
    digest: str = dataclasses.field(default="", repr=False)
    recordings: tuple[tuple[str, str, str], ...] = dataclasses.field(default=(), repr=False)

    @property
    def name(self) -> str:
        return Path(self.file).name

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return the forecasts of the file, see :meth:`Predictor.predict`.

        Raises:
            InputError: there is no file of this recording, or the file has nobody of these windows or fewer rows than
                ``steps``.
        """
        self.check(past, steps, samples)
        file, digest = self._of(past.source)
        paths, weights = _table(file, digest)
        K, T, _ = next(iter(paths.values())).shape
        if steps > T:
            raise InputError(f"{file} has {T} predicted rows per person, {steps} are asked for")
        K = min(K, samples)
        W, _, A = past.present.shape
        position, valid = np.zeros((W, K, steps, A, 2)), np.zeros((W, A), dtype=np.bool_)
        weight = np.full((W, K), 1.0 / K)
        for window, frame in enumerate(past.frame[:, -1].tolist()):
            for slot in np.flatnonzero(past.present[window, -1]).tolist():
                path = paths.get((frame, int(past.id[window, slot])))
                if path is not None:
                    position[window, :, :, slot], valid[window, slot] = path[:K, :steps], True
            if frame in weights and weights[frame][:K].sum() > 0.0:
                weight[window] = weights[frame][:K] / weights[frame][:K].sum()
        if W and not valid.any():
            raise InputError(
                f"{file} has no forecast of the people of {past.source} at frames"
                f" {past.frame[0, -1]} to {past.frame[-1, -1]}"
            )
        return Forecast(position, weight, valid, past.dt, self.name)

    def _of(self, recording: str) -> tuple[str, str]:
        """Return the file with the forecasts of a recording, and its hash."""
        if not self.recordings:
            return self.file, self.digest
        for name, file, digest in self.recordings:
            if name == recording:
                return file, digest
        names = ", ".join(name for name, _, _ in self.recordings)
        raise InputError(f"{self.file} has no forecasts of the recording {recording}, only of {names}")


def forecasts_of(path: str | Path, recordings: Sequence[str] = ()) -> StoredForecasts:
    """Return the forecasts of a file, or of one file for each recording, as a predictor.

    Args:
        path: a file. A folder holds one file for each recording, named like the recording. With several recordings, a
            file name stands for one file for each, as :func:`forecast_file` names them.
        recordings: names of the recordings; required for a folder.

    Raises:
        InputError: the suffix is unknown, or a folder has no file or several files of a recording.
        DataError: a file is missing or damaged, see :func:`~crowdbot.data.read_forecasts`; people have different
            numbers of samples or rows, or a frame has different weights of one sample.
    """
    path = Path(path)
    if path.is_dir() and not recordings:
        raise InputError(f"{path} is a folder: the names of the recordings are required")
    if not path.is_dir() and len(recordings) < 2:
        return StoredForecasts(str(path), _checked_digest(path))
    rows = []
    for name in recordings:
        file = _in_folder(path, name) if path.is_dir() else forecast_file(path, [Path(name).stem])
        rows.append((name, str(file), _checked_digest(file)))
    whole = hashlib.blake2b("".join(digest for _, _, digest in rows).encode(), digest_size=8).hexdigest()
    return StoredForecasts(str(path), whole, tuple(rows))


def forecast_file(file: Path, words: Sequence[str]) -> Path:
    """Return the name of a file of forecasts with the names of a predictor or a recording before its suffix.

    >>> forecast_file(Path("a.npz"), ["simulated(orca)", "zara01"]).name
    'a.simulated-orca-.zara01.npz'
    """
    return file.with_name(".".join([file.stem, *(re.sub(r"[^\w.+-]+", "-", word) for word in words)]) + file.suffix)


def _in_folder(folder: Path, recording: str) -> Path:
    """Return the file of a recording in a folder."""
    stem = Path(recording).stem
    files = [folder / f"{stem}{suffix}" for suffix in FORECAST_SUFFIXES if (folder / f"{stem}{suffix}").is_file()]
    if len(files) != 1:
        allowed = f"{stem}{', '.join(FORECAST_SUFFIXES[:-1])} or {FORECAST_SUFFIXES[-1]}"
        count = "no file" if not files else f"{len(files)} files"
        raise InputError(f"{folder} has {count} of forecasts of {recording}; it needs one of {allowed}")
    return files[0]


def _checked_digest(file: Path) -> str:
    """Return the hash of a file of forecasts that can be used."""
    read_forecasts(file)
    digest = hashlib.blake2b(file.read_bytes(), digest_size=8).hexdigest()
    _table(str(file), digest)
    return digest


@functools.lru_cache(maxsize=16)
def _table(file: str, digest: str) -> tuple[dict[tuple[int, int], Floats], dict[int, Floats]]:
    """Return the paths ``[K, T, 2]`` [m] by frame and id, and the weights ``[K]`` by frame."""
    rows = read_forecasts(file)
    K, T = int(rows.sample.max()) + 1, int(rows.step.max())
    if rows.sample.min() < 0 or rows.step.min() < 1:
        raise DataError(f"{file}: samples count from 0 and steps from 1")
    who, count = np.unique(np.stack([rows.frame, rows.id]), axis=1, return_counts=True)
    if np.any(count != K * T):
        bad = int(np.flatnonzero(count != K * T)[0])
        raise DataError(
            f"{file}: person {who[1, bad]} has {count[bad]} rows after frame {who[0, bad]}, not {K} samples of {T} rows"
        )
    place = np.stack([rows.x, rows.y], axis=1).reshape(-1, K, T, 2)
    share = rows.weight.reshape(-1, K, T)
    paths = {(int(f), int(i)): place[n] for n, (f, i) in enumerate(who.T.tolist())}
    weights: dict[int, Floats] = {}
    for n, frame in enumerate(who[0].tolist()):
        own = share[n, :, 0]
        if np.any(np.abs(share[n] - own[:, None]) > 1e-6) or np.any(np.abs(weights.get(frame, own) - own) > 1e-6):
            raise DataError(f"{file}: frame {frame} has different weights of one sample")
        weights[frame] = own
    del digest
    return paths, weights
