"""LearnedScene: tracked people leave their straight paths as a network has learned, and the scene is scanned again."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.perception.network_layers import read_layers, run_layers
from crowdbot.sensors import Scan
from crowdbot.typing import Floats

from .track_features import FEATURES, LAGS, EarlierTracks, person_frames, track_features
from .tracked_scene import SceneState, TrackedScene

AHEAD = (0.5, 1.0, 2.0, 3.0)
"""Times [s] for which the network predicts; between them the correction is interpolated, after them it stays."""
WALKING = 0.5
"""Speed [m/s] from which the whole correction holds; for slower people, whom no run has taught, it fades."""


@dataclass(frozen=True)
class LearnedState(SceneState):
    """State of a :class:`LearnedScene`.

    Fields:
        earlier: tracks of the last scans.
    """

    earlier: tuple[EarlierTracks, ...] = ()


@dataclass(frozen=True, kw_only=True)
class LearnedScene(TrackedScene):
    """As :class:`TrackedScene`, with a learned correction of the path of each person.

    A perceptron reads the motion of a person in the last second, the nearest people and the surfaces around, all from
    scans, and gives the distance from the straight path at four times. The built-in weights are trained on runs of
    built-in trials by ``crowdbot train learned-scene``.

    Fields:
        weights: file of weights; default: the built-in ones.
        share: share of the correction that is used, 0 to 1. Below 1 the predicted bodies blur less towards the mean.

    Raises:
        InputError: a value is not allowed.
        DataError: the weights cannot be read.

    >>> LearnedScene().begin().earlier
    ()
    """

    weights: str = ""
    share: float = 0.5

    def __post_init__(self) -> None:
        super().__post_init__()
        if not 0.0 <= self.share <= 1.0:
            raise InputError(f"LearnedScene: share = {self.share} must be from 0 to 1")
        self._layers()

    def begin(self) -> LearnedState:
        """Return the state without scans."""
        start = super().begin()
        return LearnedState(start.scans, start.tracker, start.tracks)

    def update(self, scan: Scan, state: SceneState) -> LearnedState:
        """Return the state after a scan."""
        after = super().update(scan, state)
        before = state.earlier if isinstance(state, LearnedState) else ()
        now = EarlierTracks(after.tracks.time, after.tracks.ids, after.tracks.velocity)
        kept = tuple(one for one in before if now.time - one.time <= max(LAGS) + 0.1)
        return LearnedState(after.scans, after.tracker, after.tracks, (*kept, now))

    def correct(self, state: SceneState, ahead: Floats) -> Floats:
        """Return the learned correction ``[T, A, 2]`` of the straight paths [m]."""
        if not len(state.tracks) or not isinstance(state, LearnedState):
            return super().correct(state, ahead)
        features = track_features(state.tracks, state.earlier, state.scans)
        own = run_layers(self._layers(), features).reshape(-1, len(AHEAD), 2)
        turn = person_frames(state.tracks.velocity)
        world = np.einsum("nij,nki->nkj", turn, own)
        knots = np.concatenate([np.zeros((len(world), 1, 2)), world], axis=1)
        times = (0.0, *AHEAD)
        place = np.clip(np.searchsorted(times, ahead, side="right") - 1, 0, len(AHEAD) - 1)
        begin, end = (np.asarray(times)[place + k] for k in (0, 1))
        part = np.minimum((ahead - begin) / (end - begin), 1.0)[None, :, None]
        found = knots[:, place] + part * (knots[:, place + 1] - knots[:, place])
        pace = np.minimum(np.hypot(*state.tracks.velocity.T) / WALKING, 1.0)
        return np.asarray(self.share * np.swapaxes(pace[:, None, None] * found, 0, 1))

    def _layers(self) -> tuple[NDArray[np.float32], ...]:
        return read_layers(self.weights, "learned-scene.npz", "LearnedScene", FEATURES, 2 * len(AHEAD))
