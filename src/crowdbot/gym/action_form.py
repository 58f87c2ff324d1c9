"""ActionForm: what an action of a learning robot means."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.navigation import DriveLimits

__all__ = ["ActionForm"]

Floats = NDArray[np.float64]
FORMS = ("velocity", "holonomic")


@dataclass(frozen=True)
class ActionForm:
    """Meaning of the two numbers of an action, each from -1 to 1.

    Fields:
        form: ``velocity``: forward speed and turn rate; ``holonomic``: forward and left speed, whose vector is scaled
            to the maximum speed.

    Raises:
        InputError: the form is unknown.

    >>> ActionForm("velocity").twists(np.array([[1.0, -0.5]]), DriveLimits(0.8, 2.0)).tolist()
    [[0.8, -1.0, 0.0]]
    """

    form: str = "velocity"

    def __post_init__(self) -> None:
        if self.form not in FORMS:
            raise InputError(f"action = {self.form!r} must be one of {', '.join(FORMS)}")

    def check(self, limits: DriveLimits) -> None:
        """Raise an InputError if a drive with these limits cannot do it."""
        if not (math.isfinite(limits.max_speed) and math.isfinite(limits.max_turn_rate)):
            raise InputError("the drive of the robot has no limits; actions are shares of its maximum speeds")

    def twists(self, actions: Floats, limits: DriveLimits) -> Floats:
        """Return the commands ``[N, 3]`` forward, turn, left of actions ``[N, 2]``, which are clipped to -1 to 1."""
        share = np.clip(np.asarray(actions, dtype=np.float64), -1.0, 1.0)
        if self.form == "velocity":
            return np.stack(
                [share[:, 0] * limits.max_speed, share[:, 1] * limits.max_turn_rate, np.zeros(len(share))], axis=1
            )
        size = np.maximum(1.0, np.hypot(share[:, 0], share[:, 1]))
        return np.stack(
            [
                share[:, 0] / size * limits.max_speed,
                np.zeros(len(share)),
                share[:, 1] / size * limits.max_speed,
            ],
            axis=1,
        )
