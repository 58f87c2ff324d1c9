"""ActionForm: what an action of a learning robot means."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.navigation import DriveLimits
from crowdbot.typing import Floats

FORMS = ("velocity", "acceleration", "holonomic")


@dataclass(frozen=True)
class ActionForm:
    """Meaning of the two numbers of an action, each from -1 to 1.

    Fields:
        form: ``velocity``: forward speed and turn rate; ``acceleration``: their changes, as shares of the maximum
            accelerations; ``holonomic``: forward and left speed, whose vector is scaled to the maximum speed.

    Raises:
        InputError: the form is unknown.

    >>> ActionForm("velocity").twists(np.array([[1.0, -0.5]]), DriveLimits(0.8, 2.0)).tolist()
    [[0.8, -1.0, 0.0]]
    >>> limits, now = DriveLimits(0.8, 2.0, 1.0, 3.0), np.array([[0.5, 0.0, 0.0]])
    >>> ActionForm("acceleration").twists(np.array([[-1.0, 0.5]]), limits, now, dt=0.1).round(3).tolist()
    [[0.4, 0.15, 0.0]]
    """

    form: str = "velocity"

    def __post_init__(self) -> None:
        if self.form not in FORMS:
            raise InputError(f"action = {self.form!r} must be one of {', '.join(FORMS)}")

    def check(self, limits: DriveLimits) -> None:
        """Raise an InputError if a drive with these limits cannot do it."""
        if not (math.isfinite(limits.max_speed) and math.isfinite(limits.max_turn_rate)):
            raise InputError("the drive of the robot has no limits; actions are shares of its maximum speeds")
        bounded = math.isfinite(limits.max_acceleration) and math.isfinite(limits.max_turn_acceleration)
        if self.form == "acceleration" and not bounded:
            raise InputError(
                "the drive of the robot has no limits of its accelerations, of which actions are shares; give it"
                " max-acceleration and max-turn-acceleration, or take action = 'velocity'"
            )

    def twists(self, actions: Floats, limits: DriveLimits, twist: Floats | None = None, dt: float = 0.0) -> Floats:
        """Return the commands ``[N, 3]`` forward, turn, left of actions ``[N, 2]``, which are clipped to -1 to 1.

        Args:
            actions: ``[N, 2]``.
            limits: limits of the drive.
            twist: ``[N, 3]`` current twist, to which accelerations are added (default 0).
            dt: time until the next action [s], for accelerations.
        """
        share = np.clip(np.asarray(actions, dtype=np.float64), -1.0, 1.0)
        left = np.zeros(len(share))
        top, turn = limits.max_speed, limits.max_turn_rate
        if self.form == "velocity":
            return np.stack([share[:, 0] * top, share[:, 1] * turn, left], axis=1)
        if self.form == "acceleration":
            now = np.zeros((len(share), 3)) if twist is None else twist
            speed = now[:, 0] + share[:, 0] * (limits.max_acceleration * dt)
            rate = now[:, 1] + share[:, 1] * (limits.max_turn_acceleration * dt)
            return np.stack([np.clip(speed, -top, top), np.clip(rate, -turn, turn), left], axis=1)
        size = np.maximum(1.0, np.hypot(share[:, 0], share[:, 1]))
        return np.stack([share[:, 0] / size * top, left, share[:, 1] / size * top], axis=1)
