"""The frame of the scene: people, observed, true and predicted paths of one window."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Trajectories, Windows
from crowdbot.web.state_frame import StateFrame

from .prediction_results import PredictorResults


def window_frame(
    index: int,
    windows: tuple[Windows, Windows],
    dt: float,
    shown: Sequence[tuple[int, PredictorResults]],
    near: Windows | None,
) -> StateFrame:
    """Return people and paths of a window.

    Arrays: ``ids`` ``[n]``, ``kind`` ``[n]`` (bit 1 robot, bit 2 scored), ``past`` ``[n * observe, 2]`` and ``truth``
    ``[n * predict, 2]`` (NaN where unknown); for the result in slot s ``ids.s``, ``path.s`` ``[K * T * n, 2]`` and
    ``mass.s`` ``[K]``; and ``seen`` ``[m * observe, 2]``, the degraded rows.

    Args:
        index: the window.
        windows: past and future of the recording.
        dt: time between rows [s].
        shown: slot and results of the predictors that are drawn.
        near: past of the degraded recording, or None.
    """
    past, future = windows
    who = np.flatnonzero(past.present[index, -1])
    arrays: dict[str, NDArray[Any]] = {
        "ids": past.id[index, who].astype(np.int32),
        "kind": (past.robot[index, who] + 2 * future.scored[index, who]).astype(np.uint8),
        "past": _rows(past, index, who),
        "truth": _rows(future, index, who),
    }
    for slot, results in shown:
        found = results.forecast(index)
        if found is not None:
            ids, paths, weight = found
            arrays[f"ids.{slot}"] = ids.astype(np.int32)
            arrays[f"path.{slot}"] = paths.reshape(-1, 2)
            arrays[f"mass.{slot}"] = weight
    if near is not None:
        arrays["seen"] = _rows(near, index, np.flatnonzero(near.present[index, -1]))
    time = float(past.frame[index, -1] - past.frame[0, -1])
    return StateFrame("window", time * dt, arrays)


def _rows(windows: Windows, index: int, who: NDArray[np.intp]) -> NDArray[np.float32]:
    """Return positions ``[n * rows, 2]`` person by person, NaN where a person is absent."""
    place = np.where(windows.present[index, :, who, None], windows.position[index][:, who].swapaxes(0, 1), np.nan)
    return place.reshape(-1, 2).astype(np.float32)


def recording_bounds(tracks: Trajectories, background: Mapping[str, Any] | None) -> list[float]:
    """Return left, bottom, right and top of everything that is drawn."""
    points = [tracks.position, *tracks.walls]
    if background is not None:
        points.append(np.array(background["bounds"]).reshape(2, 2))
    every = np.concatenate(points)
    low, high = every.min(axis=0) - 0.5, every.max(axis=0) + 0.5
    return [float(low[0]), float(low[1]), float(high[0]), float(high[1])]
