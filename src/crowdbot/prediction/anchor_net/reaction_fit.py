"""Fit of the reaction of people to the plan of a robot: least absolute residuals of predicted paths."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, Self

import numpy as np

from crowdbot.core import InputError
from crowdbot.data import Windows
from crowdbot.prediction.predictor import Predictor
from crowdbot.prediction.pretrained_weights import STEP
from crowdbot.typing import Floats

from .agent_frame import PREDICTED_ROWS, agent_histories, heading_vectors, rotate
from .plan_reaction import SHAPES, PlanReaction, Walks, encounters, time_shapes

ROUNDS = 20
"""Rounds of iteratively reweighted least squares."""
SMALLEST = 0.05
"""Residual [m] below which the loss is quadratic."""
STIFFNESS = 1e-3
"""Weight of the squared coefficients, relative to the mean square of the shapes."""


class ReactionSamples(NamedTuple):
    """People who a robot with a plan comes near, in their frames."""

    across: Floats
    """``[N, T, 3]`` [m] shapes of the displacement across the walk."""
    ahead: Floats
    """``[N, T, 6]`` [m] shapes of the displacement along it."""
    missed: Floats
    """``[N, T, 2]`` [m] residuals of the prediction without reaction; NaN at rows without truth."""

    @classmethod
    def of(cls, predictor: Predictor, past: Windows, future: Windows, room: float) -> Self:
        """Return the scored people whose predicted paths come closer to a plan than radii and ``room`` [m].

        Args:
            predictor: predictor without reaction; its single trajectory counts.
            past: windows with plans.
            future: true future rows, at steps of 0.4 s.
            room: distance to the surface of the robot [m].

        Raises:
            InputError: the rows are not 0.4 s apart, or more than 12.
        """
        rows = future.position.shape[1]
        if abs(past.dt - STEP) > 1e-6 or rows > PREDICTED_ROWS:
            raise InputError(f"a reaction is fitted to at most 12 rows of {STEP} s, not {rows} of {past.dt:.4g} s")
        people, window, slot = agent_histories(past)
        heading, now = heading_vectors(people.past), past.position[window, -1, slot]
        base = predictor.predict(past, PREDICTED_ROWS).position[window, 0, :, slot] - now[:, None]
        step, time = people.past[:, -1] - people.past[:, -2], STEP * np.arange(1.0, rows + 1.0)
        across, ahead = np.zeros((len(now), rows, SHAPES)), np.zeros((len(now), rows, 2 * SHAPES))
        near = np.zeros(len(now), np.bool_)
        for encounter in encounters(past, Walks(window, slot, heading, step, base[:, None]), room):
            shapes = time_shapes(encounter, time)[:, 0]
            across += shapes * encounter.away[:, 0, None, None, 1]
            ahead += np.concatenate([shapes * encounter.away[:, 0, None, None, 0], shapes], axis=2)
            near |= encounter.missing[:, 0] > 0.0
        true = future.position[window, :, slot] - now[:, None]
        missed = rotate(true - base[:, :rows], heading)
        missed = np.where(future.present[window, :, slot][..., None], missed, np.nan)
        kept = near & future.scored[window, slot]
        return cls(across[kept], ahead[kept], missed[kept])

    def displacements(self, reaction: PlanReaction) -> Floats:
        """Return the displacements ``[N, T, 2]`` [m] of a reaction."""
        forward = self.ahead @ np.concatenate([reaction.along, reaction.caution])
        return np.stack([forward, self.across @ reaction.lateral], axis=2)


def fit_reaction(groups: Sequence[ReactionSamples], room: float) -> PlanReaction:
    """Return the coefficients with the smallest mean distance to the true paths; every group has the same weight.

    Raises:
        InputError: nobody comes near a plan.
    """
    groups = [group for group in groups if len(group.missed)]
    if not groups:
        raise InputError(f"nobody comes closer than {room} m to the plan of a robot; there is nothing to fit")
    parts = []
    for group in groups:
        known = ~np.isnan(group.missed[..., 0])
        parts.append((*(values[known] for values in group), np.full(known.sum(), 1.0 / known.sum())))
    across, ahead, missed, share = (np.concatenate(values) for values in zip(*parts, strict=True))
    weight, left, forward = share, np.zeros(SHAPES), np.zeros(2 * SHAPES)
    for _ in range(ROUNDS):
        left, forward = _solve(across, missed[:, 1], weight), _solve(ahead, missed[:, 0], weight)
        rest = np.hypot(missed[:, 0] - ahead @ forward, missed[:, 1] - across @ left)
        weight = share / np.maximum(rest, SMALLEST)
    return PlanReaction(left, forward[:SHAPES], forward[SHAPES:], room)


def _solve(shapes: Floats, wanted: Floats, weight: Floats) -> Floats:
    matrix = (shapes * weight[:, None]).T @ shapes
    stiff = STIFFNESS * np.trace(matrix) / len(matrix) * np.eye(len(matrix))
    return np.asarray(np.linalg.solve(matrix + stiff + 1e-12 * np.eye(len(matrix)), shapes.T @ (weight * wanted)))
