"""Stiffness, mass and force limits of body regions, and the two-body impact model of ISO/TS 15066.

Contact with a rigid, immovable body would give unrealistic forces. The peak force of an impact is therefore computed
from its speed, with a spring of the stiffness of the region between the moving mass of the robot and the effective mass
of the region: ``F = v sqrt(k mu)``. Solver forces during an impact are not reported as injury forces.
"""

from __future__ import annotations

import functools
import math
from typing import NamedTuple

from crowdbot.core import InputError, Paper

SOURCE = Paper(
    "ISO",
    2016,
    "Robots and robotic devices: Collaborative robots",
    "ISO/TS 15066:2016, annex A, tables A.2 and A.3",
    "",
)


class BodyRegionLimits(NamedTuple):
    """A region of the body.

    Fields:
        stiffness: stiffness [N/m].
        mass: effective mass of the region in an impact [kg].
        limit: quasi-static force at the onset of pain of adults [N].
        transient: factor on the limit for short impacts; 0: no impact is allowed.
    """

    stiffness: float
    mass: float
    limit: float
    transient: float = 2.0


BODY_REGION_LIMITS: dict[str, BodyRegionLimits] = {
    "skull": BodyRegionLimits(150e3, 4.4, 130.0, 0.0),
    "face": BodyRegionLimits(75e3, 4.4, 65.0, 0.0),
    "neck": BodyRegionLimits(50e3, 1.2, 150.0),
    "back": BodyRegionLimits(35e3, 40.0, 210.0),
    "chest": BodyRegionLimits(25e3, 40.0, 140.0),
    "belly": BodyRegionLimits(10e3, 40.0, 110.0),
    "pelvis": BodyRegionLimits(25e3, 40.0, 180.0),
    "upper arm": BodyRegionLimits(30e3, 3.0, 150.0),
    "forearm": BodyRegionLimits(40e3, 2.0, 160.0),
    "hand": BodyRegionLimits(75e3, 0.6, 140.0),
    "thigh": BodyRegionLimits(50e3, 75.0, 220.0),
    "lower leg": BodyRegionLimits(60e3, 75.0, 130.0),
}
"""Regions of :data:`SOURCE`; for certification, use the standard itself. Limits are for adults; limits for children are
lower.
"""

DAMPING = 0.3
"""Damping ratio of a contact: bodies separate at 37 % of the impact speed (assumed)."""
SHORTEST = 6.0
"""Minimum duration of a contact in engine steps, for a stable solution."""

LIMB_REGIONS = {
    "pelvis": "pelvis",
    "abdomen": "belly",
    "chest": "chest",
    "neck": "neck",
    "head": "skull",
    "upperarm": "upper arm",
    "forearm": "forearm",
    "hand": "hand",
    "thigh": "thigh",
    "shank": "lower leg",
    "foot": "lower leg",
}
BEHIND = {"chest": "back", "belly": "back"}
AHEAD = {"skull": "face"}


def region_of(limb: str, ahead: bool = True) -> str:
    """Return the region of :data:`BODY_REGION_LIMITS` of a limb, for contact from ahead or from behind.

    Raises:
        InputError: the limb is unknown.

    >>> region_of("chest"), region_of("chest", ahead=False), region_of("shank_l"), region_of("head")
    ('chest', 'back', 'lower leg', 'face')
    """
    stem = limb.removesuffix("_l").removesuffix("_r")
    if stem not in LIMB_REGIONS:
        raise InputError(f"unknown limb {limb!r}; use one of {', '.join(LIMB_REGIONS)}")
    region = LIMB_REGIONS[stem]
    return (AHEAD if ahead else BEHIND).get(region, region)


def reduced_mass(one: float, other: float) -> float:
    """Return the reduced mass [kg] of two masses [kg]; either may be infinite.

    >>> reduced_mass(60.0, 40.0), reduced_mass(math.inf, 40.0)
    (24.0, 40.0)
    """
    if math.isinf(one) or math.isinf(other):
        return min(one, other)
    return one * other / (one + other)


def two_body_force(speed: float, mass: float, region: str, person_mass: float = math.inf) -> float:
    """Return the peak force [N] of an impact on a region of the body (ISO/TS 15066, annex A).

    Args:
        speed: closing speed along the normal [m/s].
        mass: mass of the moving object [kg]; for a mobile robot, its total moving mass.
        region: one of :data:`BODY_REGION_LIMITS`.
        person_mass: mass of the person [kg], an upper limit of the mass of a region.

    >>> round(two_body_force(1.0, 60.0, "chest"), 1)
    774.6
    """
    tissue = BODY_REGION_LIMITS[region]
    return max(0.0, speed) * math.sqrt(tissue.stiffness * reduced_mass(mass, min(tissue.mass, person_mass)))


def permitted_speed(mass: float, region: str) -> float:
    """Return the largest closing speed [m/s] within the limit of the region; 0 if no impact is allowed.

    >>> round(permitted_speed(60.0, "chest"), 2)
    0.36
    """
    tissue = BODY_REGION_LIMITS[region]
    return tissue.transient * tissue.limit / two_body_force(1.0, mass, region)


@functools.lru_cache(maxsize=4096)
def softness(region: str, person: float, mass: float, dt: float, moved: float | None = None) -> tuple[float, float]:
    """Return stiffness and damping of a contact per reduced mass [1/s2, 1/s], for the solver.

    In the solver, each limb has the mass of the whole person (``person`` [kg]). The contact is therefore softened to
    give the peak force of :func:`two_body_force` at any ratio of the masses. It lasts long enough to be resolved by
    steps of ``dt`` [s]. If only one of the bodies can be moved by contacts, ``moved`` [kg] is its mass in the solver.

    >>> stiffness, _ = softness("chest", 40.0, 60.0, 0.005)
    >>> round(math.sqrt(stiffness / (25e3 / 24.0)), 3)  # stiffer, since damping lowers the peak
    1.229
    """
    tissue = BODY_REGION_LIMITS[region]
    whole = reduced_mass(person, mass)
    moved = whole if moved is None else moved
    wanted = tissue.stiffness * reduced_mass(mass, min(tissue.mass, person)) / moved**2
    frequency = min(math.sqrt(wanted) / peak_share(DAMPING), math.pi / (SHORTEST * dt))
    share = moved / whole  # the solver takes the reduced mass of both bodies
    return frequency**2 * share, 2.0 * DAMPING * frequency * share


def peak_share(damping: float) -> float:
    """Return the ratio of peak forces of a damped to an undamped spring in an impact."""
    root = math.sqrt(1.0 - damping**2)
    angle = math.atan2(root * (1.0 - 4.0 * damping**2), damping * (3.0 - 4.0 * damping**2))
    return math.exp(-damping / root * angle)
