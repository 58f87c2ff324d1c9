"""ModelRange: the density and the time step up to which a crowd model walks like people, and the common reasons."""

from __future__ import annotations

from typing import NamedTuple

FREE = "no fundamental diagram: its speed is within 10 % of Weidmann's curve up to 0.7 people/m2 only"
JAMS = "two-way crowds jam or hardly move at higher densities"

PAGE = "crowdbot validate, corridor"
TWO_WAY = "crowdbot validate, lanes and narrow two-way"
JUPEDSIM = "JuPedSim 1.4.2, default time step"
UMANS = "UMANS, time step of its examples"


class ModelRange(NamedTuple):
    """Range of a crowd model at its defaults, as its class declares it in ``valid_range``.

    Fields:
        max_density: largest density [1/m2].
        why: what happens beyond it.
        max_step: largest time step of the crowd [s].
        density_source, step_source: where the limits come from.

    >>> from crowdbot.models import ORCA
    >>> ORCA.valid_range.max_density, ORCA.valid_range.max_step
    (0.7, 0.25)
    """

    max_density: float
    why: str
    max_step: float
    density_source: str
    step_source: str
