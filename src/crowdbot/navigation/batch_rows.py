"""What navigators need for a batch: its rows for kernels, the numbers of the drive, and compute times."""

from __future__ import annotations

import math
from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from .decisions import Decisions
from .goal_motion import regular_rows
from .observation import DriveLimits
from .observation_batch import ObservationBatch


def rows_for_kernels(batch: ObservationBatch, with_people: bool) -> NDArray[np.bool_]:
    """Return the environments ``[N]`` with regular values, which kernels decide.

    In the others, a single decision reports the wrong value.

    Args:
        batch: the observations.
        with_people: whether the values of people count.
    """
    N, people = len(batch), batch.people
    asking = np.zeros(N, dtype=np.bool_)
    if not (all(limit > 0.0 for limit in batch.limits[:4]) and 0.0 < batch.dt < math.inf):
        return asking
    regular_rows(
        batch.pose,
        batch.goal,
        batch.waypoint,
        batch.twist,
        batch.radius,
        people.position,
        people.velocity,
        people.radius,
        people.seen if with_people else np.zeros_like(people.seen),
        asking,
    )
    return asking


def drive_numbers(limits: DriveLimits, speed: float) -> NDArray[np.float64]:
    """Return speed, turn rate and their accelerations for kernels, with the speed limited by a navigator."""
    return np.array(
        [min(speed, limits.max_speed), limits.max_turn_rate, limits.max_acceleration, limits.max_turn_acceleration]
    )


def share_time(
    decisions: Decisions, asking: NDArray[np.bool_], begin: float, timer: Callable[[], float] | None
) -> None:
    """Write the compute time since ``begin``, divided among the environments decided together."""
    if timer is not None:
        decisions.seconds[asking] = (timer() - begin) / max(1, int(asking.sum()))
