"""BodyRegion: limits of a region of the body, and the two-body model of an impact on it."""

from __future__ import annotations

import math
from typing import NamedTuple


class BodyRegion(NamedTuple):
    """Limits of a region of the body, as of ISO/TS 15066.

    Fields:
        stiffness: [N/m].
        mass: effective mass in an impact [kg].
        limit: quasi-static force limit [N].
        transient: factor on the limit for short impacts; 0: no impact is allowed.
    """

    stiffness: float
    mass: float
    limit: float
    transient: float = 2.0

    def force(self, speed: float, mass: float) -> float:
        """Return the force [N] of an impact at a speed [m/s] by a body of this mass [kg]: ``F = v sqrt(k mu)``.

        >>> round(BodyRegion(25e3, 40.0, 140.0).force(1.0, 60.0))
        775
        """
        return speed * math.sqrt(self.stiffness * self._reduced(mass))

    def severity(self, speed: float, mass: float) -> float:
        """Return the force divided by the limit for short impacts; infinite where no impact is allowed."""
        force, allowed = self.force(speed, mass), self.transient * self.limit
        return force / allowed if allowed > 0.0 else math.inf if force > 0.0 else 0.0

    def energy(self, speed: float, mass: float) -> float:
        """Return the energy [J] of the impact, ``mu v^2 / 2``."""
        return 0.5 * self._reduced(mass) * speed**2

    def _reduced(self, mass: float) -> float:
        return mass * self.mass / (mass + self.mass)
