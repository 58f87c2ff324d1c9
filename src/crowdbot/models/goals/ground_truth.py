"""GroundTruth: the recorded destinations, for evaluation only."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.data import Windows, observed_velocity
from crowdbot.typing import Floats

from .goal import Goal


@dataclass(frozen=True, eq=False)
class GroundTruth(Goal):
    """Last recorded future position of each person, for evaluation only.

    It measures which part of an error is caused by unknown goals. The goal of people without a future is their
    position.

    Args:
        past, future: windows from one call; :meth:`resolve` accepts these windows or their first observed rows.

    Raises:
        InputError: past and future have different people, or :meth:`resolve` gets an unknown window.
    """

    knows_future: ClassVar[bool] = True
    past: Windows = field(repr=False)
    future: Windows = field(repr=False)

    def __post_init__(self) -> None:
        if not np.array_equal(self.past.id, self.future.id):
            raise InputError(
                f"ground-truth: the past has people {list(self.past.id.shape)} and the future"
                f" {list(self.future.id.shape)}; both must come from one call"
            )

    def resolve(self, past: Windows) -> Floats:
        future = self.future[self._window_indices(past)]
        goal = np.where(past.present[:, -1, :, None], past.position[:, -1], 0.0)
        for step in range(future.present.shape[1]):
            seen = future.present[:, step] & past.present[:, -1]
            goal[seen] = future.position[:, step][seen]
        return goal

    def velocity(self, past: Windows) -> Floats:
        return observed_velocity(past)

    def _window_indices(self, past: Windows) -> NDArray[np.int64]:
        """Return the indices of the windows, identified by first frame and people."""
        if past.id.shape == self.past.id.shape and np.array_equal(past.id, self.past.id):
            return np.arange(len(past))
        names = [(int(frame), id.tobytes()) for frame, id in zip(past.frame[:, 0], past.id, strict=True)]
        missing = next((number for number, name in enumerate(names) if name not in self._known), None)
        if missing is not None:
            raise InputError(
                f"ground-truth: window {missing} of {past.source}, from frame {past.frame[missing, 0]}, is not one"
                f" of the {len(self.past)} windows with a known future"
            )
        return np.array([self._known[name] for name in names], dtype=np.int64)

    @functools.cached_property
    def _known(self) -> dict[tuple[int, bytes], int]:
        frames = zip(self.past.frame[:, 0], self.past.id, strict=True)
        return {(int(frame), id.tobytes()): number for number, (frame, id) in enumerate(frames)}
