"""Limits of the speed and acceleration of people, applied after the crowd model."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError, PerAgent, Scene, kernel, per_agent
from crowdbot.typing import Bools, Floats

from .agent_arrays import BOOL, FLOAT, dense


@dataclass(frozen=True)
class CrowdLimits:
    """Maximum speed and acceleration of people, applied after the step of a crowd model.

    The velocity change is clipped to the acceleration times the step, then the velocity to the speed. A person whose
    velocity is clipped moves straight at the new velocity for the whole step.

    Fields:
        max_speed: [m/s], for all or ``[E, A]``; None: the limit of the model.
        max_acceleration: limit of the velocity change [m/s2], for all or ``[E, A]``; None: no limit.

    Raises:
        InputError: a limit is not above 0, or not finite.

    >>> start = Scene.of([[0.0, 0.0]], goal=[[9.0, 0.0]])
    >>> fast = start.advance(start.desired_velocity(0.1), 0.1)
    >>> CrowdLimits(max_acceleration=2.0).apply(start, fast, dt=0.1).velocity.round(9).tolist()
    [[[0.2, 0.0]]]
    """

    max_speed: PerAgent | None = None
    max_acceleration: PerAgent | None = None

    def __post_init__(self) -> None:
        for name, unit in (("max_speed", "m/s"), ("max_acceleration", "m/s2")):
            value = getattr(self, name)
            if value is None:
                continue
            numbers = np.asarray(value, dtype=np.float64)
            wrong = numbers[~((numbers > 0.0) & np.isfinite(numbers))]
            if wrong.size:
                raise InputError(f"CrowdLimits: {name} = {wrong.flat[0]} {unit} must be finite and above 0, or None")

    def apply(self, before: Scene, after: Scene, dt: float) -> Scene:
        """Return the scene ``after`` a step of ``dt`` [s] from ``before``, with velocities clipped to the limits."""
        shape = after.shape
        pairs = (*shape, 2)
        most = math.inf if self.max_acceleration is None else self.max_acceleration
        top = math.inf if self.max_speed is None else self.max_speed
        chosen = dense(after.velocity, pairs, FLOAT)
        velocity, position = np.empty(pairs), np.empty(pairs)
        cut = np.empty(shape, dtype=np.bool_)
        some = _clip(
            dense(before.position, pairs, FLOAT),
            dense(before.velocity, pairs, FLOAT),
            dense(after.position, pairs, FLOAT),
            chosen,
            dense(after.active, shape, BOOL),
            dense(after.external, shape, BOOL),
            per_agent(most, shape, "max_acceleration"),
            per_agent(top, shape, "max_speed"),
            float(dt),
            velocity,
            position,
            cut,
        )
        if not some:
            return after
        along = after.heading == np.arctan2(chosen[..., 1], chosen[..., 0])
        turned = np.where(along, np.arctan2(velocity[..., 1], velocity[..., 0]), after.heading)
        return after.replace(velocity=velocity, position=position, heading=np.where(cut, turned, after.heading))


@kernel
def _clip(
    start: Floats, old: Floats, place: Floats, chosen: Floats, active: Bools, external: Bools, most: Floats,
    top: Floats, dt: float, velocity: Floats, position: Floats, cut: Bools,
) -> bool:  # fmt: skip
    """Write the clipped velocities, their positions and who is cut; return whether somebody is."""
    some = False
    for e in range(len(active)):
        for a in range(active.shape[1]):
            x, y = chosen[e, a, 0], chosen[e, a, 1]
            velocity[e, a, 0], velocity[e, a, 1] = x, y
            position[e, a, 0], position[e, a, 1] = place[e, a, 0], place[e, a, 1]
            cut[e, a] = False
            if not active[e, a] or external[e, a]:
                continue
            dx, dy = x - old[e, a, 0], y - old[e, a, 1]
            length, limit = math.sqrt(dx * dx + dy * dy), most[e, a] * dt
            if length > limit:
                share = limit / max(length, 1e-300)
                x, y = old[e, a, 0] + dx * share, old[e, a, 1] + dy * share
            length, limit = math.sqrt(x * x + y * y), top[e, a]
            if length > limit:
                share = limit / max(length, 1e-300)
                x, y = 0.0 + x * share, 0.0 + y * share
            if x != chosen[e, a, 0] or y != chosen[e, a, 1]:
                velocity[e, a, 0], velocity[e, a, 1] = x, y
                position[e, a, 0], position[e, a, 1] = start[e, a, 0] + x * dt, start[e, a, 1] + y * dt
                cut[e, a], some = True, True
    return some
