"""StoredForecasts: forecasts made elsewhere, read from a file and scored as a predictor."""

from __future__ import annotations

import dataclasses
import functools
import hashlib
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from crowdbot.core import DataError, InputError
from crowdbot.data import Forecast, Windows, read_forecasts
from crowdbot.typing import Floats

from .predictor import Predictor


@dataclass(frozen=True)
class StoredForecasts(Predictor):
    """Returns the forecasts of a file, by the last observed frame and the identities of the recording.

    People who are not in the file are not predicted. Fewer samples than in the file are the first ones.

    Fields:
        file: file of forecasts, see :func:`~crowdbot.data.read_forecasts`.
        digest: hash of its content.
    """

    file: str
    digest: str = dataclasses.field(default="", repr=False)

    @property
    def name(self) -> str:
        """Name of the file."""
        return Path(self.file).name

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return the forecasts of the file, see :meth:`Predictor.predict`.

        Raises:
            InputError: the file has nobody of these windows, or fewer rows than ``steps``.
        """
        self.check(past, steps, samples)
        paths, weights = _table(self.file, self.digest)
        K, T, _ = next(iter(paths.values())).shape
        if steps > T:
            raise InputError(f"{self.file} has {T} predicted rows per person, {steps} are asked for")
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
                f"{self.file} has no forecast of the people of {past.source} at frames"
                f" {past.frame[0, -1]} to {past.frame[-1, -1]}"
            )
        return Forecast(position, weight, valid, past.dt, self.name)


def forecasts_of(path: str | Path) -> StoredForecasts:
    """Return the forecasts of a file as a predictor.

    Raises:
        InputError: the suffix is unknown.
        DataError: the file is missing or damaged, see :func:`~crowdbot.data.read_forecasts`; people have different
            numbers of samples or rows, or a frame has different weights of one sample.
    """
    read_forecasts(path)
    digest = hashlib.blake2b(Path(path).read_bytes(), digest_size=8).hexdigest()
    _table(str(path), digest)
    return StoredForecasts(str(path), digest)


@functools.lru_cache(maxsize=4)
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
