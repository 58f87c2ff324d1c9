"""RoomLimits: the part of a real room in which a person or robot can move."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError


@dataclass(frozen=True)
class RoomLimits:
    """Free floor of a room.

    Fields:
        corners: corners of a polygon without crossings, x, y [m], in the frame of the room.

    Raises:
        InputError: there are fewer than 3 or more than 100 corners, or a coordinate is not a finite number.

    >>> limits = RoomLimits(((0.0, 0.0), (4.0, 0.0), (4.0, 3.0), (0.0, 3.0)))
    >>> limits.margin(1.0, 1.5), limits.margin(5.0, 1.0)
    (1.0, -1.0)
    """

    corners: tuple[tuple[float, float], ...]

    def __post_init__(self) -> None:
        rows = [tuple(one) if isinstance(one, list | tuple) else () for one in self.corners]
        if not 3 <= len(rows) <= 100 or any(len(one) != 2 for one in rows):
            raise InputError("limits of a room: expected 3 to 100 corners x, y")
        if not all(isinstance(one, int | float) and abs(one) <= 1e3 for row in rows for one in row):
            raise InputError("limits of a room: each coordinate must be a number of at most 1000 m")
        object.__setattr__(self, "corners", tuple((float(x), float(y)) for x, y in rows))

    def margin(self, x: float, y: float) -> float:
        """Return the distance [m] to the nearest side; negative outside."""
        a = np.array(self.corners)
        b = np.roll(a, -1, axis=0)
        along, point = b - a, np.array([x, y]) - a
        square = np.maximum(np.sum(along * along, axis=1), 1e-12)
        share = np.clip(np.sum(point * along, axis=1) / square, 0.0, 1.0)
        gap = float(np.min(np.linalg.norm(point - share[:, None] * along, axis=1)))
        above, next_above = a[:, 1] > y, b[:, 1] > y
        with np.errstate(divide="ignore", invalid="ignore"):
            crossing = a[:, 0] + (y - a[:, 1]) / (b[:, 1] - a[:, 1]) * (b[:, 0] - a[:, 0])
        inside = bool(np.sum((above != next_above) & (x < crossing)) % 2)
        return gap if inside else -gap
