"""How far people can lean and step to recover their balance, by age and direction, from published experiments."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import Paper
from crowdbot.humans import People
from crowdbot.typing import Floats

GRAVITY = 9.81
"""Gravity [m/s2]."""
CENTER = 0.56
"""Height of the centre of mass of a standing adult in relation to the stature (Winter 2009)."""
LEG, PENDULUM = 0.53, 1.24
"""Length of the legs in relation to the stature (Winter 2009), and of the pendulum in relation to the legs (Hof
2008)."""
BASE = (0.072, 0.040, 0.065)
"""Distance from the centre of mass of a standing person to the edge of the feet ahead, behind and aside, in relation to
the stature (assumed: feet of 0.152 of the stature, Winter 2009, with the centre of mass 5 cm ahead of the ankles)."""
RESPONSE = 0.4
"""Time [s] from the loss of balance to the landing of the first recovery step (assumed: reaction, weight transfer and
swing; Hof et al. 2010 give at least 0.3 s)."""
FORWARD = 32.5
"""Mean largest lean ahead [degrees] from which young men recover with one step (Thelen et al. 1997; young women 30.7,
Wojcik et al. 1999)."""
SIDEWAYS, BACKWARD = 1.23, 1.22
"""Ratio of the largest lean ahead to that sideways and backward (Carbonneau and Smeesters 2014)."""
YEARS, DECLINE = (25.0, 52.0, 73.0), (1.0, 1.0 / 1.23, 1.0 / 1.48)
"""Mean ages of young, middle-aged and old people (those of the middle-aged assumed), and their largest lean in relation
to that of the young (Carbonneau and Smeesters 2014)."""

SOURCES = (
    Paper(
        "At L. Hof",
        2008,
        "The 'extrapolated center of mass' concept suggests a simple control of balance in walking",
        "Human Movement Science 27(1), 112-125",
        "10.1016/j.humov.2007.08.003",
    ),
    Paper(
        "Darryl G. Thelen, Laura A. Wojcik, Albert B. Schultz, James A. Ashton-Miller, Neil B. Alexander",
        1997,
        "Age differences in using a rapid step to regain balance during a forward fall",
        "Journals of Gerontology A 52(1), M8-M13",
        "10.1093/gerona/52A.1.M8",
    ),
    Paper(
        "Eric Carbonneau, Cecile Smeesters",
        2014,
        "Effects of age and lean direction on the threshold of single-step balance recovery in younger, middle-aged and"
        " older adults",
        "Gait and Posture 39(1), 365-371",
        "",
    ),
)


class BalanceAbility(NamedTuple):
    """Abilities of N people; columns are ahead, behind and aside.

    Fields:
        rate: rate of the pendulum ``w = sqrt(g / length)`` ``[N]`` [1/s].
        center: height of the centre of mass ``[N]`` [m].
        base: distance to the edge of the feet ``[N, 3]`` [m].
        reach: largest recovery step ``[N, 3]`` [m].
    """

    rate: Floats
    center: Floats
    base: Floats
    reach: Floats


def maximum_lean(years: ArrayLike) -> Floats:
    """Return the largest lean ahead, behind and aside ``[N, 3]`` [rad] from which people recover with one step.

    Children, and the mannequin without an age, are as the young; experiments with them are not known to us.

    >>> np.degrees(maximum_lean([25.0, 73.0])).round(1).tolist()
    [[32.5, 26.6, 26.4], [22.0, 18.0, 17.9]]
    """
    ahead = np.radians(FORWARD) * np.interp(np.asarray(years, dtype=np.float64), YEARS, DECLINE)
    return np.asarray(np.stack([ahead, ahead / BACKWARD, ahead / SIDEWAYS], axis=-1))


def balance_ability(people: People) -> BalanceAbility:
    """Return the abilities of people.

    The reach is that which a linear inverted pendulum needs to recover from the largest lean with one step: released at
    the angle ``a``, its extrapolated centre of mass is at ``b + (h sin(a) - b) exp(w T)`` when the step lands after
    :data:`RESPONSE`, and the foot must come so close that the edge of the feet ``b`` reaches it.

    Source: Hof 2008, doi:10.1016/j.humov.2007.08.003.

    >>> balance_ability(People.of(["man-24", "woman-72"])).reach.round(2).tolist()
    [[1.3, 1.2, 1.05], [0.76, 0.73, 0.59]]
    """
    height = np.asarray(people.height, dtype=np.float64)
    rate = np.sqrt(GRAVITY / (PENDULUM * LEG * height))
    center = CENTER * height
    base = height[:, None] * np.array(BASE)
    lean = center[:, None] * np.sin(maximum_lean([person.years for person in people.persons]))
    reach = (lean - base) * np.exp(rate * RESPONSE)[:, None]
    return BalanceAbility(rate, center, base, reach)
