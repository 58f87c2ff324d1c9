"""Falls: the motion of a falling body, and the speeds at which its regions hit the floor."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from crowdbot.core import Paper, storable
from crowdbot.humans import LIMBS, LYING, FallPose, People, Posture, fall_postures
from crowdbot.metrics import HIC15_LIMIT
from crowdbot.typing import Floats

from .ability import GRAVITY

ABSORBED = 0.7
"""Share of gravity that legs and arms absorb during a fall. Chosen so that hips and heads hit the floor as fast as in
falls on video (Choi et al. 2015: 2.14 and 2.91 m/s on average)."""
ANGLES = 31
"""Number of angles at which a fall is computed."""
SLOWEST = 0.6
"""Smallest initial rate of a fall [rad/s] (assumed)."""
TOUCHING, NEAR = 0.04, {"hand": 0.12, "pelvis": 0.15}
"""Heights [m] of a limb above the floor at which it hits (assumed): capsules approximate the skin, wrists bend, and
arms that hold the body up yield before the hips hit."""
HEADS = {"forward": 0.54, "backward": 0.30, "sideways": 0.29}
"""Share of falls of old people in which the head hits the floor: 37 % of all, with odds ratios of 2.7 and 2.8 for falls
ahead (Schonnop et al. 2013); the shares are the solution of these three numbers for equally frequent directions."""
YOUNG, OLD, ODDS = 21.0, 62.0, 0.24
"""Odds of a head impact of young people in relation to those of the old: 11.4 % and 34.5 % of sideways falls at mean
ages of 21 and 62 years (doi:10.1155/2019/6804614)."""
REGIONS = {
    "hand": ("hand_l", "hand_r"),
    "lower leg": ("shank_l", "shank_r"),
    "pelvis": ("pelvis", "thigh_l", "thigh_r"),
    "chest": ("chest",),
    "head": ("head",),
}
"""Limbs of each region that can hit the floor; the pelvis includes the hips, at the upper end of the thighs."""
SOURCES = (
    Paper(
        "W. J. Choi, J. M. Wakeling, S. N. Robinovitch",
        2015,
        "Kinematic analysis of video-captured falls experienced by older adults in long-term care",
        "Journal of Biomechanics 48(6), 911-920",
        "10.1016/j.jbiomech.2015.02.025",
    ),
    Paper(
        "Rebecca Schonnop, Yijian Yang, Fabio Feldman, Erin Robinson, Marie Loughin, Stephen N. Robinovitch",
        2013,
        "Prevalence of and factors associated with head impact during falls in older adults in long-term care",
        "Canadian Medical Association Journal 185(17), E803-E810",
        "10.1503/cmaj.130498",
    ),
)


@storable
@dataclass(frozen=True)
class Fall:
    """The fall of a person.

    Fields:
        person: the agent.
        begin, end: times [s] of the loss of balance beyond recovery, and of the body at rest on the floor.
        direction: ``forward``, ``backward``, ``left`` or ``right``, seen from the person.
        cause, causer: kind of the body that pushed last (``robot``, ``person``, ``prop``, ``wall``; empty for none),
            and its number. A push that was passed on by other people counts for the body that pushed first.
        steps: recovery steps before the fall.
        hand, leg, pelvis, chest, head: speeds [m/s] at which these regions hit the floor, 0 if they do not.
        hic15: head injury criterion of a hard floor, 0 without a head impact; see :func:`crowdbot.metrics.fall_hic15`.
    """

    person: int
    begin: float
    end: float
    direction: str
    cause: str
    causer: int
    steps: int
    hand: float
    leg: float
    pelvis: float
    chest: float
    head: float
    hic15: float

    @property
    def severity(self) -> float:
        """HIC15 in relation to its limit 700 (49 CFR 571.208)."""
        return self.hic15 / HIC15_LIMIT


@dataclass(frozen=True)
class FallMotion:
    """Tilt of a falling body over time: an inverted pendulum under a part of gravity.

    Fields:
        start: tilt [rad] at the beginning.
        speed: its rate [rad/s].
        rate: rate of the pendulum ``sqrt(g / length)`` [1/s].

    >>> motion = FallMotion(0.5, 1.0, 2.9)
    >>> round(motion.tilt(0.0), 2), round(motion.tilt(9.0), 2), 0.4 < motion.duration < 0.9
    (0.5, 1.57, True)
    """

    start: float
    speed: float
    rate: float

    @property
    def angles(self) -> Floats:
        """Tilts ``[K]`` [rad] from the beginning to the floor."""
        return np.linspace(self.start, LYING, ANGLES)

    @property
    def rates(self) -> Floats:
        """Rates ``[K]`` [rad/s] at :attr:`angles`."""
        gained = 2.0 * (1.0 - ABSORBED) * self.rate**2 * (math.cos(self.start) - np.cos(self.angles))
        return np.asarray(np.sqrt(max(self.speed, SLOWEST) ** 2 + gained))

    @property
    def times(self) -> Floats:
        """Times ``[K]`` [s] at :attr:`angles`."""
        rates = self.rates
        steps = np.diff(self.angles) * 2.0 / (rates[1:] + rates[:-1])
        return np.concatenate([[0.0], np.cumsum(steps)])

    @property
    def duration(self) -> float:
        """Time [s] until the body lies."""
        return float(self.times[-1])

    def tilt(self, time: float) -> float:
        """Return the tilt [rad] at a time [s] after the beginning."""
        return float(np.interp(time, self.times, self.angles))


def direction_name(direction: float) -> str:
    """Return the word of a direction relative to the heading [rad].

    >>> [direction_name(angle) for angle in (0.1, 3.1, 1.5, -1.5)]
    ['forward', 'backward', 'left', 'right']
    """
    ahead, aside = math.cos(direction), math.sin(direction)
    if abs(ahead) >= abs(aside):
        return "forward" if ahead > 0.0 else "backward"
    return "left" if aside > 0.0 else "right"


def head_probability(direction: str, years: float) -> float:
    """Return the probability that the head hits the floor.

    >>> round(head_probability("left", 21.0), 2), round(head_probability("forward", 80.0), 2)
    (0.09, 0.54)
    """
    share = HEADS.get(direction, HEADS["sideways"])
    odds = share / (1.0 - share) * float(np.interp(years, (YOUNG, OLD), (ODDS, 1.0)))
    return odds / (1.0 + odds)


def impact_speeds(
    upright: Posture, person: People, yaw: float, direction: float, struck: bool, motion: FallMotion
) -> tuple[Mapping[str, float], Floats]:
    """Return the speeds [m/s] at which the regions of a falling body hit the floor, and the path of its pelvis.

    After a hard push the posture would change faster than gravity allows. No region is faster than in free fall from
    its height at the beginning, with the vertical speed that the tilt gives it there.

    Args:
        upright: posture of this person at the beginning of the fall, N = 1.
        person: the body, N = 1.
        yaw: heading [rad].
        direction: direction of the fall relative to the heading [rad].
        struck: whether the head hits the floor.
        motion: tilt over time.

    Returns:
        Speeds by region, 0 if it does not hit; places ``[K, 2]`` [m] of the pelvis relative to the feet at
        ``motion.angles``.
    """
    heights, places = [], []
    for tilt in motion.angles.tolist():
        pose = FallPose(direction, tilt, motion.start, struck, True)
        posture = fall_postures(upright, person, np.array([yaw]), {0: pose})
        limbs = person.limbs(posture)
        heights.append(np.minimum(limbs.start[0, :, 2], limbs.end[0, :, 2]) - limbs.radius[0])
        places.append(posture.position[0, 0, :2] - 0.5 * (posture.position[0, 22, :2] + posture.position[0, 26, :2]))
    low, names, rates = np.array(heights), [limb.name for limb in LIMBS], motion.rates
    found = {}
    for region, limbs_of in REGIONS.items():
        if region == "head" and not struck:
            found[region] = 0.0
            continue
        height = low[:, [names.index(name) for name in limbs_of]].min(axis=1)
        fall = -np.gradient(height, motion.angles) * rates
        most = NEAR.get(region, TOUCHING)
        rows = np.flatnonzero(height <= most)
        first = int(rows[0]) if len(rows) else int(np.argmin(height))
        reached = height[first] <= most or region == "head"  # the neck bends the last centimetres
        speed = float(max(fall[max(first - 3, 0) : first + 1].max(), 0.0)) if reached else 0.0
        begin = float(height[0]) * float(rates[0]) * math.sin(motion.start)
        found[region] = min(speed, math.sqrt(begin**2 + 2.0 * GRAVITY * max(float(height[0] - height[first]), 0.0)))
    return found, np.array(places)
