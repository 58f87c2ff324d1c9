"""Limits of the speed and acceleration of people, applied after the crowd model."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, PerAgent, Scene, per_agent

__all__ = ["CrowdLimits"]

Floats = NDArray[np.float64]


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
        velocity, walking = after.velocity, after.active & ~after.external
        old = np.where(walking[..., None], before.velocity, 0.0)
        if self.max_acceleration is not None:
            most = per_agent(self.max_acceleration, after.shape, "max_acceleration") * dt
            velocity = _clip(velocity - old, most, velocity, old)
        if self.max_speed is not None:
            velocity = _clip(velocity, per_agent(self.max_speed, after.shape, "max_speed"), velocity, 0.0)
        cut = walking & np.any(velocity != after.velocity, axis=-1)
        along = after.heading == np.arctan2(after.velocity[..., 1], after.velocity[..., 0])
        turned = np.where(along, np.arctan2(velocity[..., 1], velocity[..., 0]), after.heading)
        return after.replace(
            velocity=np.where(cut[..., None], velocity, after.velocity),
            position=np.where(cut[..., None], before.position + velocity * dt, after.position),
            heading=np.where(cut, turned, after.heading),
        )


def _clip(change: Floats, most: Floats, whole: Floats, start: Floats | float) -> Floats:
    """Return ``start`` plus the change, shortened to length ``most``; ``whole`` if it is short enough."""
    length = np.sqrt(change[..., 0] ** 2 + change[..., 1] ** 2)
    shorter = start + change * (most / np.maximum(length, 1e-300))[..., None]
    return np.where((length > most)[..., None], shorter, whole)
