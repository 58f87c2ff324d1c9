"""Seats: a chair and the built-in wheelchair."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

Point = tuple[float, float, float]


@dataclass(frozen=True)
class Seat:
    """A seat, in a frame on the floor at the position of the person, x forward.

    Args:
        height: height of the seat [m].
        ahead: distance of the hips ahead of the position [m].
        recline: backward inclination of the trunk [rad]; 0 is upright.
        feet: position of the left heel [m], mirrored for the right one; None puts the feet on the floor. The feet of
            short people do not touch the floor.
        slope: inclination of the foot rests, toes up [rad].
        hands: position of the left wrist [m], mirrored for the right one; None puts the hands on the thighs.

    Raises:
        InputError: a number is not finite, or ``height`` is not from 0.2 to 1.2 m.

    >>> WHEELCHAIR.height, CHAIR.feet
    (0.555, None)
    """

    height: float = 0.46
    ahead: float = 0.0
    recline: float = 0.0
    feet: Point | None = None
    slope: float = 0.0
    hands: Point | None = None

    def __post_init__(self) -> None:
        """Raise :class:`InputError` for invalid values."""
        if not np.all(np.isfinite(self.row)):
            raise InputError(f"Seat: {self} has a value that is not finite")
        if not 0.2 <= self.height <= 1.2:
            raise InputError(f"Seat: height = {self.height} m must be from 0.2 to 1.2 m")

    @property
    def row(self) -> list[float]:
        """Values for the kernels: height, ahead, recline, slope, has feet, x, y, z, has hands, x, y, z."""
        feet, hands = self.feet or (0.0, 0.0, 0.0), self.hands or (0.0, 0.0, 0.0)
        there = [float(self.feet is not None), float(self.hands is not None)]
        return [self.height, self.ahead, self.recline, self.slope, there[0], *feet, there[1], *hands]


CHAIR = Seat()
"""A chair: seat at 0.46 m, feet on the floor, hips at the position."""
WHEELCHAIR = Seat(
    height=0.555, ahead=-0.075, recline=0.17, feet=(0.39, 0.1, 0.1446), slope=0.1, hands=(0.09, 0.262, 0.79)
)
"""Seat of the built-in robot ``wheelchair``: the position is that of its ``base_link``."""


def seat_rows(seat: Seat | Sequence[Seat], count: int) -> Floats:
    """Return the kernel values ``[N, 12]`` of one seat for all or of one for each.

    Raises:
        InputError: the number of seats is not ``count``.

    >>> seat_rows(CHAIR, 2).shape
    (2, 12)
    """
    seats = [seat] * count if isinstance(seat, Seat) else list(seat)
    if len(seats) != count:
        raise InputError(f"Gait: {len(seats)} seats are given for {count} people; give one, or one for each")
    return np.array([one.row for one in seats], dtype=np.float64).reshape(count, 12)
