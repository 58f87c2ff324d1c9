"""How people react to the plan of a robot: a displacement with fitted coefficients, added to predicted paths.

The displacement depends on the closest approach of a predicted path and a plan. It is exactly 0 if they never come
closer than the sum of radii and :attr:`PlanReaction.room`.
"""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any, NamedTuple, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Windows
from crowdbot.prediction.pretrained_weights import STEP
from crowdbot.typing import Floats

from .agent_frame import PREDICTED_ROWS, planned_positions, rotate

RADIUS = 0.25
"""Radius of people and robots without one [m]."""
BLUNT = 0.1
"""Distance of the closest approach [m] below which its direction is uncertain, and the displacement smaller."""
SOON = 1.6
"""Time to the closest approach [s] below which the displacement is smaller: nobody steps aside in no time."""
WALKING = 0.5
"""Speed [m/s] below which the displacement is smaller: the heading of people who stand is unknown."""
HORIZON = PREDICTED_ROWS * STEP
"""Horizon of the fit [s]; the displacement is constant beyond."""
SHAPES = 3
"""Number of shapes over time of the displacement in each direction."""


class PlanReaction(NamedTuple):
    """Coefficients of the displacement.

    Fields:
        lateral: ``[3]`` of the shapes over time, for the part of the direction away from the robot across the walk.
        along: ``[3]``, for the part along it: people who pass in front hurry, people who pass behind wait.
        caution: ``[3]``, along the walk, for every approach.
        room: distance to the surface of the robot that people keep [m].
    """

    lateral: Floats
    along: Floats
    caution: Floats
    room: float

    @classmethod
    def of(cls, numbers: Mapping[str, NDArray[Any]]) -> Self | None:
        """Return the coefficients in weights; None if they have none."""
        if "reaction_room" not in numbers:
            return None
        lateral, along, caution, room = (numbers[f"reaction_{name}"] for name in cls._fields)
        return cls(lateral, along, caution, float(room))

    def numbers(self) -> dict[str, Floats]:
        """Return the coefficients as arrays of weights, the inverse of :meth:`of`."""
        return {f"reaction_{name}": np.asarray(values, dtype=np.float64) for name, values in self._asdict().items()}


class Walks(NamedTuple):
    """Predicted paths of N people, K each."""

    window: NDArray[np.int64]
    slot: NDArray[np.int64]
    heading: Floats
    """``[N, 2]`` directions of their frames."""
    step: Floats
    """``[N, 2]`` [m] last displacements in 0.4 s."""
    path: Floats
    """``[N, K, 12, 2]`` [m] predicted displacements at steps of 0.4 s."""


class ClosestApproach(NamedTuple):
    """Approaches of N people with K paths each and one robot."""

    missing: Floats
    """``[N, K]`` [m] by how much the robot comes closer than radii and room, scaled by size; 0 if it does not."""
    away: Floats
    """``[N, K, 2]`` direction from the robot to the person at the closest approach, in the frame of the person."""
    time: Floats
    """``[N, K]`` [s] until the closest approach."""


def encounters(past: Windows, walks: Walks, room: float) -> list[ClosestApproach]:
    """Return the closest approaches of people to each robot with a plan; ``room`` is the distance that they keep [m].

    The missing distance is scaled by the sum of radii, relative to two people: people give way to large robots more.
    """
    planned = [past.position[:, -1], *(planned_positions(past, row) for row in range(1, PREDICTED_ROWS + 1))]
    plan = np.stack(planned, axis=1)
    known = past.robot & past.present[:, -1] & ~np.isnan(plan).any(axis=(1, 3))
    order = np.argsort(np.where(known, past.id, np.iinfo(np.int64).max), axis=1, kind="stable")
    window, slot = walks.window, walks.slot
    counts = ~past.robot[window, slot] & (past.present[window, :, slot].sum(axis=1) > 1)
    own = np.concatenate([np.zeros_like(walks.path[:, :, :1]), walks.path], axis=2)
    pace = np.sqrt(walks.step[:, 0] * walks.step[:, 0] + walks.step[:, 1] * walks.step[:, 1]) / STEP
    radius, found = _radii(past), []
    for rank in range(int(known.sum(axis=1).max(initial=0))):
        robot = order[window, rank]
        meets = counts & known[window, robot]
        way = plan[window, :, robot] - past.position[window, -1, slot][:, None]
        time, away = _closest_approach(own - np.where(meets[:, None, None], way, 0.0)[:, None])
        gap = np.sqrt(away[..., 0] * away[..., 0] + away[..., 1] * away[..., 1])
        reach = radius[window, robot] + radius[window, slot]
        scale = np.where(meets, np.minimum(pace / WALKING, 1.0) * reach / (2.0 * RADIUS), 0.0)[:, None]
        missing = np.maximum((reach + room)[:, None] - gap, 0.0) * np.minimum(time / SOON, 1.0) * scale
        direction = away / np.sqrt(gap * gap + BLUNT * BLUNT)[..., None]
        found.append(ClosestApproach(missing, rotate(direction, walks.heading), time))
    return found


def time_shapes(encounter: ClosestApproach, time: Floats) -> Floats:
    """Return the shapes ``[N, K, T, 3]`` [m] of displacements at ``time [T]`` [s].

    They grow with the second and the fourth power of time up to the closest approach and are constant afterwards; the
    third one begins there. All are in proportion to the missing distance.
    """
    now = np.minimum(time, HORIZON)
    rise = np.minimum(now / np.maximum(encounter.time, STEP)[..., None], 1.0)
    after = np.maximum(now - encounter.time[..., None], 0.0) / HORIZON
    square = rise * rise
    return np.stack([square, square * square, after], axis=-1) * encounter.missing[..., None, None]


def reaction_displacements(reaction: PlanReaction, past: Windows, walks: Walks, time: Floats) -> Floats:
    """Return displacements ``[N, K, T, 2]`` [m] in world axes at ``time [T]`` [s] after the last observed row."""
    found = np.zeros((*walks.path.shape[:2], len(time), 2))
    for encounter in encounters(past, walks, reaction.room):
        shapes = time_shapes(encounter, time)
        forward, left = encounter.away[..., 0, None], encounter.away[..., 1, None]
        for number in range(SHAPES):  # summation order independent of the batch
            found[..., 0] += shapes[..., number] * (reaction.along[number] * forward + reaction.caution[number])
            found[..., 1] += shapes[..., number] * (reaction.lateral[number] * left)
    return rotate(found, walks.heading, back=True)


def _radii(past: Windows) -> Floats:
    """Return radii ``[W, A]`` [m]; :data:`RADIUS` where they are unknown."""
    if past.radius is None:
        return np.full(past.robot.shape, RADIUS)
    return np.where(np.isnan(past.radius), RADIUS, past.radius)


def _closest_approach(away: Floats) -> tuple[Floats, Floats]:
    """Return when paths ``[N, K, 13, 2]`` [m], straight between rows, are nearest to 0 [s], and where ``[N, K, 2]``."""
    start, step = away[:, :, :-1], away[:, :, 1:] - away[:, :, :-1]
    length = step[..., 0] * step[..., 0] + step[..., 1] * step[..., 1]
    inward = start[..., 0] * step[..., 0] + start[..., 1] * step[..., 1]
    share = np.clip(-inward / np.maximum(length, 1e-12), 0.0, 1.0)
    point = start + share[..., None] * step
    square = point[..., 0] * point[..., 0] + point[..., 1] * point[..., 1]
    row = np.argmin(square, axis=2)[..., None]
    time = STEP * (row[..., 0] + np.take_along_axis(share, row, axis=2)[..., 0])
    return time, np.take_along_axis(point, row[..., None], axis=2)[:, :, 0]
