"""Recovery of pushed people: bracing on the spot, then recovery steps."""

from __future__ import annotations

import numpy as np

from crowdbot.core import Paper
from crowdbot.typing import Bools, Floats

SOURCE = Paper(
    "At L. Hof, Sjoerd M. Vermerris, Welmoed A. Gjaltema",
    2010,
    "Balance responses to lateral perturbations in human treadmill walking",
    "Journal of Experimental Biology 213(15), 2655-2664",
    "10.1242/jeb.042572",
)
BRACE = 100.0
"""Largest force [N] with which a person resists a push without a step (assumed: one eighth of the weight of an adult,
with the centre of pressure 0.12 m from the centre of mass)."""
REACTION = 0.1
"""Delay [s] between the first contact and resistance, and time constant of the velocity correction, which
:data:`BRACE` limits (assumed)."""
STEPPING = 0.3
"""Time [s] between the first contact and the first recovery step (:data:`SOURCE`)."""
GRIP = 0.5
"""Friction of shoes on the floor, which limits the deceleration by steps (assumed: the usual lower bound of safe
floors)."""
CENTER = 0.56
"""Height of the centre of mass of a standing adult in relation to the stature (Winter 2009)."""
GRAVITY = 9.81


def recovery_force(error: Floats, mass: Floats, length: Floats, since: Floats, free: Bools) -> Floats:
    """Return the horizontal forces ``[P, 2]`` [N] with which pushed people return to their own velocity.

    From :data:`REACTION` after the first contact, they brace with up to :data:`BRACE`. From :data:`STEPPING`, people
    who are no longer pushed step into the direction in which they move: each step is placed at the extrapolated centre
    of mass ``x + v / w`` of an inverted pendulum with ``w = sqrt(g / length)``, which therefore slows down by
    ``a = w v``, at most by :data:`GRIP` times gravity.

    Args:
        error: velocity that is missing ``[P, 2]`` [m/s].
        mass, length: mass ``[P]`` [kg] and height of the centre of mass ``[P]`` [m].
        since: time since the first contact ``[P]`` [s].
        free: whether nothing pushes them any more ``[P]``.

    Source: Hof et al. 2010, doi:10.1242/jeb.042572.

    >>> error, one = np.array([[-1.0, 0.0]]), np.ones(1)
    >>> for time in (0.2, 0.4):
    ...     print(recovery_force(error, 70.0 * one, one, time * one, one > 0.0).round(1).tolist())
    [[-100.0, 0.0]]
    [[-219.2, 0.0]]
    """
    size = np.sqrt(np.sum(error * error, axis=1))
    brace = np.minimum(BRACE, mass * size / REACTION)
    steps = mass * np.minimum(np.sqrt(GRAVITY / length) * size, GRIP * GRAVITY)
    steps = np.where(free & (since >= STEPPING), steps, 0.0)
    force = np.where(since >= REACTION, np.maximum(brace, steps), 0.0)
    return np.asarray(error * (force / np.maximum(size, 1e-12))[:, None])
