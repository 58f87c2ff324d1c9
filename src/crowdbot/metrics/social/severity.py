"""Severity of contacts by body region: a bound from bodies in the plane, and the regions hit in the physics world."""

from __future__ import annotations

import math
from collections.abc import Iterable, Mapping
from typing import Protocol

from .body_region import BodyRegion
from .robot_log import RobotLog

STATURE = 1.75
"""Stature of the person [m] for the heights of body regions."""
HEIGHTS = {
    "lower leg": (0.0, 0.285),
    "thigh": (0.285, 0.53),
    "hand": (0.377, 0.485),
    "forearm": (0.485, 0.63),
    "pelvis": (0.47, 0.56),
    "belly": (0.56, 0.68),
    "back": (0.53, 0.818),
    "chest": (0.68, 0.818),
    "upper arm": (0.63, 0.818),
    "neck": (0.818, 0.87),
    "face": (0.87, 0.95),
    "skull": (0.93, 1.0),
}
"""Lower and upper end of each region of a standing person, as shares of the stature (Drillis and Contini 1966)."""
HEAD = ("skull", "face")
GRAVITY = 9.81


class RegionImpact(Protocol):
    """What the metrics of regions read of a contact event; :class:`crowdbot.world.BodyContactEvent` has it."""

    @property
    def region(self) -> str:
        """Region of the hardest impact."""

    @property
    def peak_force(self) -> float:
        """Force of the hardest impact [N]."""

    @property
    def severity(self) -> float:
        """Ratio of force to limit."""


def severity_metrics(log: RobotLog) -> dict[str, float]:
    """Return the metrics of the family ``severity``: bounds from the closing speeds of outlines in the plane.

    A log of the plane does not say which region is hit. The robot reaches the regions below its height; the smallest
    severity of these is a lower bound, and the largest one an upper bound for this speed. Limbs that move faster than
    the person (a swinging foot) are not included.
    """
    regions = {name: region for name, region in log.regions.items() if _reaches(log.height, name)}
    if not regions or math.isnan(log.mass):
        names = (
            "severity_lower_bound",
            "severity_upper_bound",
            "severity_ratio_above_1",
            "contact_force",
            "contact_energy",
        )
        return dict.fromkeys(names, math.nan)
    speeds = [event.impact_speed for event in log.contacts]
    least = [min(region.severity(speed, log.mass) for region in regions.values()) for speed in speeds]
    return {
        "severity_lower_bound": max(least, default=0.0),
        "severity_upper_bound": max(
            (region.severity(v, log.mass) for region in regions.values() for v in speeds), default=0.0
        ),
        "severity_ratio_above_1": sum(value > 1.0 for value in least) / len(least) if least else 0.0,
        "contact_force": max(
            (min(region.force(v, log.mass) for region in regions.values()) for v in speeds), default=0.0
        ),
        "contact_energy": max(
            (max(region.energy(v, log.mass) for region in regions.values()) for v in speeds), default=0.0
        ),
        **{
            f"severity_{name.replace(' ', '_')}": max((region.severity(v, log.mass) for v in speeds), default=0.0)
            for name, region in regions.items()
        },
    }


def _reaches(height: float, region: str) -> bool:
    return region in HEIGHTS and HEIGHTS[region][0] * STATURE < height


def impact_region_metrics(
    impacts: Iterable[RegionImpact], regions: Mapping[str, BodyRegion], mass: float
) -> dict[str, float]:
    """Return the metrics of the family ``impacts``: largest severity of the regions that were hit in the physics world.

    Args:
        impacts: contacts of one robot with people.
        regions: limits by name of the region.
        mass: mass of the robot [kg].

    >>> impact_region_metrics([], {}, 40.0)
    {'head_impacts': 0.0, 'hic15': 0.0}
    """
    found: dict[str, float] = {}
    injury, heads = 0.0, 0
    for impact in impacts:
        if not impact.region or math.isnan(impact.peak_force):
            continue
        key = f"impact_severity_{impact.region.replace(' ', '_')}"
        found[key] = max(found.get(key, 0.0), impact.severity)
        if impact.region in HEAD and impact.peak_force > 0.0:
            heads += 1
            injury = max(injury, head_injury_criterion(impact.peak_force, regions[impact.region], mass))
    return {"head_impacts": float(heads), "hic15": injury} | dict(sorted(found.items()))


def head_injury_criterion(force: float, region: BodyRegion, mass: float) -> float:
    """Return the head injury criterion HIC15 of an impact on the head with this largest force [N].

    The force of the two-body model is half a sine of the duration ``T = pi sqrt(mu / k)``, so the acceleration of the
    head is ``a(t) = F / m sin(pi t / T)``. The criterion is the largest ``(t2 - t1) (mean of a / g)^2.5`` over windows
    of at most 15 ms; for a half sine the best window lies around its middle. Versace 1971,
    https://doi.org/10.4271/710881.

    >>> round(head_injury_criterion(2000.0, BodyRegion(150e3, 4.4, 130.0, 0.0), 1e9), 1)
    103.1
    """
    reduced = mass * region.mass / (mass + region.mass)
    duration = math.pi * math.sqrt(reduced / region.stiffness)
    peak = force / region.mass / GRAVITY
    best = 0.0
    for step in range(1, 201):
        width = min(duration, 0.015) * step / 200.0
        mean = peak * (2.0 * duration / (math.pi * width)) * math.sin(math.pi * width / (2.0 * duration))
        best = max(best, width * mean**2.5)
    return best
