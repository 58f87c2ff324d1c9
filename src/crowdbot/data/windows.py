"""Windows: a stretch of time cut out of a recording, batched over windows and padded over people."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

__all__ = ["Windows"]


@dataclass(frozen=True)
class Windows:
    """The same stretch of W windows: W windows, T times, A people (padded).

    Fields:
        position: ``[W, T, A, 2]`` [m]; 0 where a person is not present.
        present: ``[W, T, A]`` bool.
        scored: ``[W, A]`` bool, the people that the protocol counts; a predictor must not look at it.
        robot: ``[W, A]`` bool, tracks that are robots: seen by predictors, never scored.
        id: ``[W, A]`` int64, identity in the recording, -1 for padding.
        frame: ``[W, T]`` int64, frame counter of the recording.
        dt: time step [s].
        protocol: name of the protocol that cut the windows.
        source: name of the recording.
        walls: rings ``[N, 2]`` [m] of what cannot be walked on, empty when unknown.
        units: ``m``, or ``px`` when the recording was not turned into metres: then every [m] above is pixels.
    """

    position: NDArray[np.float64]
    present: NDArray[np.bool_]
    scored: NDArray[np.bool_]
    robot: NDArray[np.bool_]
    id: NDArray[np.int64]
    frame: NDArray[np.int64]
    dt: float
    protocol: str
    source: str
    walls: tuple[NDArray[np.float64], ...] = ()
    units: str = "m"

    def __len__(self) -> int:
        """Return the number of windows."""
        return len(self.position)

    def __getitem__(self, chosen: slice | NDArray[np.int64] | NDArray[np.bool_]) -> Windows:
        """Return some of the windows."""
        arrays = {n: getattr(self, n)[chosen] for n in ("position", "present", "scored", "robot", "id", "frame")}
        return dataclasses.replace(self, **arrays)
