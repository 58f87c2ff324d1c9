"""Dynamic window: from a desired velocity to a collision-free twist within the limits of a drive.

Twists within the acceleration limits are simulated for a short time, people at constant velocity. The cost combines
the distance to the desired velocity and the clearance to people and walls.

Source of the idea: Fox, Burgard, Thrun 1997, doi:10.1109/100.580977.
"""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Twist, read_only
from crowdbot.typing import Floats

from .observation import DriveLimits, Observation
from .observation_batch import ObservationBatch
from .wall_arrays import wall_arrays
from .window_search import MATCH, STEP, choose_twists

EAGER = 100.0
"""Value for unknown accelerations [m/s2], [rad/s2]."""


class WindowCosts(NamedTuple):
    """Weights of the cost of a twist, which is its difference from the desired velocity [m/s] plus penalties [m/s]."""

    look: float = 1.5
    """Simulated time [s]."""
    margin: float = 0.3
    """Clearance to people below which a penalty applies [m]."""
    near: float = 1.0
    """Penalty at clearance 0; it fades with time."""
    skin: float = 0.05
    """Clearance to people that counts as contact [m]."""
    contact: float = 10.0
    """Penalty of an immediate contact; it fades with time."""
    wall_margin: float = 0.1
    """Clearance to walls below which a penalty applies [m]."""
    wall: float = 20.0
    """Penalty of wall contact."""
    facing: float = 0.5
    """Penalty of not facing the desired velocity, relative to its speed."""


STANDARD = WindowCosts()


def dynamic_window_twist(
    observation: Observation, wish: tuple[float, float], speed: float, caution: WindowCosts | None = None
) -> Twist:
    """Return the reachable twist with the smallest cost.

    Args:
        observation: what the robot knows.
        wish: desired velocity x, y in the world [m/s].
        speed: largest speed [m/s].
        caution: weights of the cost.

    >>> from crowdbot.navigation import DriveLimits
    >>> limits = DriveLimits(max_speed=1.0, max_turn_rate=2.0, max_acceleration=1.0, max_turn_acceleration=3.0)
    >>> still = Observation(pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=limits, dt=0.1)
    >>> dynamic_window_twist(still, (1.0, 0.0), speed=1.0)
    Twist(forward=0.5, turn=0.0, left=0.0)
    """
    people, out = observation.people, np.zeros((1, 3))
    choose_twists(
        np.ones(1, np.bool_),
        np.array([observation.pose], dtype=np.float64),
        np.array([observation.twist], dtype=np.float64),
        np.array([observation.radius], dtype=np.float64),
        np.array([wish], dtype=np.float64),
        _row(people.position),
        _row(people.velocity),
        _row(people.radius),
        np.ones((1, len(people)), np.bool_),
        wall_arrays(observation.walls).segments,
        _limits(observation.limits, speed),
        *_weights(caution or STANDARD),
        read_only(observation.outline),
        out,
    )
    return Twist(*out[0].tolist())


def dynamic_window_twists(
    batch: ObservationBatch,
    asking: NDArray[np.bool_],
    wish: Floats,
    speed: float,
    out: Floats,
    caution: WindowCosts | None = None,
) -> None:
    """Write the reachable twists with the smallest cost, the same as :func:`dynamic_window_twist` for each row.

    Args:
        batch: what the robot knows in N environments; its arrays are C-contiguous and writeable.
        asking: ``[N]`` rows to fill.
        wish: ``[N, 2]`` desired velocities in the world [m/s].
        speed: largest speed [m/s].
        out: ``[N, 3]`` twists.
        caution: weights of the cost.
    """
    people = batch.people
    choose_twists(
        asking, batch.pose, batch.twist, batch.radius, wish,
        people.position, people.velocity, people.radius, people.seen, wall_arrays(batch.walls).segments,
        _limits(batch.limits, speed), *_weights(caution or STANDARD), read_only(batch.outline), out,
    )  # fmt: skip


def _row(values: Floats) -> Floats:
    return np.require(values, np.float64, ["C", "W"])[None]


def _limits(limits: DriveLimits, speed: float) -> Floats:
    return np.array(
        [
            min(speed, limits.max_speed),
            limits.max_turn_rate,
            min(limits.max_acceleration, EAGER),
            min(limits.max_turn_acceleration, EAGER),
        ]
    )


@functools.lru_cache(maxsize=64)
def _weights(caution: WindowCosts) -> tuple[Floats, int, bool]:
    """Return the weights for kernels, the number of steps, and whether no weight is negative."""
    weights = np.array(caution[1:], dtype=np.float64)
    steps = max(MATCH, round(caution.look / STEP))
    return weights, steps, min(caution.near, caution.contact, caution.wall) >= 0.0 < caution.wall_margin
