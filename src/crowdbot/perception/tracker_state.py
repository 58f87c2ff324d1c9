"""TrackerState: the tracks of trackers with Kalman filters."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core import storable
from crowdbot.typing import Bools, Floats, Ints

from .motion_filter import FilterState
from .tracks import Tracks


@storable
@dataclass(frozen=True)
class TrackerState:
    """State of a :class:`GlobalNearestNeighbor` with N tracks and M motion models.

    Fields:
        time: time of the last update [s]; NaN before the first.
        next_id: identity of the next track.
        ids: ``[N]`` identities.
        mean, covariance: ``[N, M, 4]``, ``[N, M, 4, 4]`` of x, y, vx, vy by each motion model.
        weight: ``[N, M]`` probability of each motion model.
        existence: ``[N]`` probability that there is a person.
        confirmed: ``[N]`` whether the track is reported.
        last: ``[N]`` time of the last detection [s].
        times: ``[H]`` times of the last updates [s], if a predictor moves the people.
        places: ``[N, H, 2]`` positions after these updates [m]; NaN before the first detection.
    """

    time: float
    next_id: int
    ids: Ints
    mean: Floats
    covariance: Floats
    weight: Floats
    existence: Floats
    confirmed: Bools
    last: Floats
    times: Floats
    places: Floats

    @property
    def filters(self) -> FilterState:
        """Means, covariances and weights of the motion models."""
        return FilterState(self.mean, self.covariance, self.weight)

    def confirmed_tracks(self) -> Tracks:
        """Return the tracks that are reported."""
        kept = self.confirmed
        mean, covariance = self.filters.moments()
        mean, covariance = mean[kept], covariance[kept]
        return Tracks(
            self.time, self.ids[kept], mean[:, :2].copy(), mean[:, 2:].copy(), covariance, self.existence[kept],
            self.last[kept] == self.time,
        )  # fmt: skip
