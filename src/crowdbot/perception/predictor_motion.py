"""PredictorMotion: a predictor or a crowd model as the motion model of a tracker."""

from __future__ import annotations

import math
from dataclasses import dataclass, field

import numpy as np

from crowdbot.core import check_number
from crowdbot.data import Windows
from crowdbot.prediction import Predictor, Simulated
from crowdbot.typing import Floats

from .motion_filter import FilterState
from .tracker_state import TrackerState

ROWS = 8
"""Number of rows of predictors without a history in seconds."""
STRONGEST = 3.0
"""Largest acceleration that a forecast gives [m/s^2]."""


@dataclass(frozen=True, kw_only=True)
class PredictorMotion:
    """A predictor, or a crowd model by :class:`crowdbot.prediction.Simulated`, as the motion model of a tracker.

    All confirmed people are predicted one ``step`` ahead, together, from their tracks. The distance d of the forecast
    from constant velocity gives each the acceleration 2 d / step^2 until the next detections; the covariances grow as
    with constant velocity. Constant velocity as the predictor changes nothing. Hidden people are moved in the same way:
    they avoid others who are tracked.

    Fields:
        predictor: the predictor; default: simulated people of ORCA who keep their direction.
        step: time of the forecast, and between the rows that the predictor reads [s].

    Raises:
        InputError: the step is not above 0.

    >>> from crowdbot.perception import Detections, GlobalNearestNeighbor
    >>> tracker = GlobalNearestNeighbor(motion=PredictorMotion())
    >>> state = tracker.begin()
    >>> for k in range(10):
    ...     found = Detections.of(0.1 * k, [[0.12 * k, 0.0], [4.0 - 0.12 * k, 0.1]], 0.05)
    ...     tracks, state = tracker.update(found, 0.1 * k, state)
    >>> tracks.ids.tolist()
    [0, 1]
    """

    predictor: Predictor = field(default_factory=Simulated)
    step: float = 0.4

    def __post_init__(self) -> None:
        check_number("PredictorMotion", "step", self.step, "s", exclusive_min=0.0)

    @property
    def rows(self) -> int:
        """Number of rows that the predictor reads."""
        return max(ROWS, math.ceil(self.predictor.history / self.step - 1e-9) + 1)

    @property
    def span(self) -> float:
        """Time of the rows before the last one [s]."""
        return (self.rows - 1) * self.step

    def apply(self, state: TrackerState, dt: float) -> FilterState:
        """Return the filters with half the shift and the whole change of velocity of an acceleration over ``dt`` [s].

        A prediction with constant velocity over ``dt`` then adds the other half of the shift.
        """
        past = self.windows(state)
        forecast = self.predictor.predict(past, 1)
        ahead = np.einsum("k,kai->ai", forecast.weight[0], forecast.position[0, :, 0])
        here = past.position[0, -1]
        steady = 2.0 * here - past.position[0, -2]
        acceleration = 2.0 * (ahead - steady) / self.step**2
        size = np.linalg.norm(acceleration, axis=-1, keepdims=True)
        acceleration *= np.minimum(1.0, STRONGEST / np.maximum(size, 1e-12))
        mean = state.mean.copy()
        mean[state.confirmed, :, 2:] += dt * acceleration[:, None]
        mean[state.confirmed, :, :2] -= 0.5 * dt**2 * acceleration[:, None]
        return FilterState(mean, state.covariance, state.weight)

    def windows(self, state: TrackerState) -> Windows:
        """Return the confirmed tracks as one window; the row before the last one has the velocity of the filter."""
        kept = state.confirmed
        mean = state.filters.moments()[0][kept]
        wanted = state.time - self.step * np.arange(self.rows - 1, -1, -1.0)
        place = _interpolate(state.times, state.places[kept], wanted)
        place[:, -1] = mean[:, :2]
        place[:, -2] = mean[:, :2] - self.step * mean[:, 2:]
        place = np.swapaxes(place, 0, 1)[None]
        present = ~np.isnan(place[..., 0])
        nobody = np.zeros((1, place.shape[2]), dtype=np.bool_)
        frame = np.arange(self.rows, dtype=np.int64)[None]
        return Windows(
            np.where(present[..., None], place, 0.0), present, nobody, nobody, state.ids[kept][None], frame, self.step,
            "tracks", "tracker",
        )  # fmt: skip


def _interpolate(times: Floats, places: Floats, wanted: Floats) -> Floats:
    """Return positions ``[N, T, 2]`` at times ``[T]`` of tracks ``[N, H, 2]``; NaN before their first position."""
    after = np.clip(np.searchsorted(times, wanted - 1e-9), 0, len(times) - 1)
    before = np.maximum(after - 1, 0)
    gap = np.where(after > before, times[after] - times[before], 1.0)
    share = np.clip((wanted - times[before]) / gap, 0.0, 1.0)[:, None]
    found = places[:, before] * (1.0 - share) + places[:, after] * share
    return np.where((wanted >= times[0] - 1e-9)[:, None], found, np.nan)
