"""Simulation of the observed rows of windows with many candidates at once."""

from __future__ import annotations

import functools
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene, tree
from crowdbot.data import Windows, fill_gaps, slice_rows
from crowdbot.typing import Floats, Ints

from .rollout import Rollout

Candidate = Callable[[Rollout, Scene, int], tuple[Rollout, Scene]]
"""Assigns the parameters of candidates to copies of a scene, in which each window is repeated ``copies`` times."""


class ResimulatedTracks:
    """Tracks of P candidates over the observed rows of W windows; simulated on first access.

    Fields:
        past: the simulated windows.
    """

    def __init__(self, past: Windows, once: Callable[[], Floats], stepwise: Callable[[], Floats]) -> None:
        self.past = past
        self._once = once
        self._stepwise = stepwise

    @functools.cached_property
    def once(self) -> Floats:
        """Rows 1 to T - 1, simulated from the first row: ``[P, W, T - 1, A, 2]`` [m]."""
        return self._once()

    @functools.cached_property
    def stepwise(self) -> Floats:
        """Rows 2 to T - 1, each simulated from the previous recorded row: ``[P, W, T - 2, A, 2]`` [m]."""
        return self._stepwise()


class Resimulation:
    """Repeated simulation of observed windows with different parameters.

    People who are present at the first row of a simulation are simulated until their last observed row. Robots and
    people who appear later follow their recorded tracks. Scenes are created once and then copied.
    """

    def __init__(self, rollout: Rollout, past: Windows) -> None:
        self.rollout = rollout
        self.past = past
        self.whole = fill_gaps(past)
        self._repeated: tuple[object, Scene] | None = None

    def resimulate(self, candidate: Candidate, copies: int, which: Ints) -> ResimulatedTracks:
        """Return the tracks of ``copies`` candidates in the windows ``which``."""
        return ResimulatedTracks(
            self.past[which],
            lambda: self._from_first_row(candidate, copies, which),
            lambda: self._row_by_row(candidate, copies, which),
        )

    @functools.cached_property
    def _first(self) -> Scene:
        scene = self.rollout.scene(self.past, 0)
        return scene.replace(external=scene.external | ~scene.active)

    @functools.cached_property
    def _each(self) -> Scene:
        """Scenes at rows 1 to T - 2, ordered by window: ``E = W * (T - 2)``."""
        rows = range(1, self.past.position.shape[1] - 1)
        scenes = [self.rollout.scene(slice_rows(self.past, 0, row + 1), row) for row in rows]
        order = np.arange(len(rows) * len(self.past)).reshape(len(rows), -1).T.ravel()
        return tree.join(scenes).environments(order)

    @functools.cached_property
    def _tracks(self) -> _RecordedTracks:
        return _recorded_tracks(self.whole)

    def _from_first_row(self, candidate: Candidate, copies: int, which: Ints) -> Floats:
        T, A = self.past.position.shape[1:3]
        index = np.tile(which, copies)
        place = np.zeros((len(index), T - 1, A, 2))
        rollout, scene = candidate(self.rollout, self._first.environments(index), 1)
        for row in range(T - 1):
            scene = self._tracks.apply(scene, row, index)
            scene = rollout.advance(scene, self.past.dt)
            place[:, row] = scene.position
        return place.reshape(copies, len(which), T - 1, A, 2)

    def _row_by_row(self, candidate: Candidate, copies: int, which: Ints) -> Floats:
        T, A = self.past.position.shape[1:3]
        if T < 3:
            return np.zeros((copies, len(which), 0, A, 2))
        rollout, scene = candidate(self.rollout, self._copies(copies, which), T - 2)
        place = rollout.next_positions(scene, self.past.dt)
        return place.reshape(copies, len(which), T - 2, A, 2)

    def _copies(self, copies: int, which: Ints) -> Scene:
        """Return the scenes of all rows of some windows, repeated; they are kept, because most calls use them again."""
        key = copies, which.tobytes()
        if self._repeated is None or self._repeated[0] != key:
            rows = self.past.position.shape[1] - 2
            index = np.tile((which[:, None] * rows + np.arange(rows)).ravel(), copies)
            self._repeated = key, self._each.environments(index)
        return self._repeated[1]


@dataclass(frozen=True)
class _RecordedTracks:
    """Recorded positions and velocities, presence ``[W, T, A]``, and last observed row ``[W, A]``.

    ``changes``: whether any agent appears, disappears or follows a recorded track.
    """

    position: Floats
    velocity: Floats
    present: NDArray[np.bool_]
    last: Ints
    changes: bool

    def apply(self, scene: Scene, row: int, index: Ints) -> Scene:
        """Return the scene with external agents at their recorded states of ``row``, without people who have left."""
        if not self.changes:
            return scene
        here, stays = self.present[index, row], self.last[index] >= row
        moved = scene.external & here
        place = np.where(moved[..., None], self.position[index, row], scene.position)
        velocity = np.where(moved[..., None], self.velocity[index, row], scene.velocity)
        heading = np.where(moved, np.arctan2(velocity[..., 1], velocity[..., 0]), scene.heading)
        active = np.where(scene.external, here, scene.active & stays)
        return scene.replace(position=place, velocity=velocity, heading=heading, active=active)


def _recorded_tracks(past: Windows) -> _RecordedTracks:
    T = past.position.shape[1]
    both = past.present[:, :-1] & past.present[:, 1:]
    velocity = np.zeros_like(past.position)
    velocity[:, :-1] = np.where(both[..., None], np.diff(past.position, axis=1) / past.dt, 0.0)
    last = T - 1 - np.argmax(past.present[:, ::-1], axis=1)
    changes = bool(np.any(past.robot) or np.any(past.present != past.present[:, :1]))
    return _RecordedTracks(past.position, velocity, past.present, last, changes)
