"""BodyPose: where a person is, and where head and hands are, at one instant."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import InputError, storable
from crowdbot.typing import Floats

from .quaternions import slerp

SKELETON = 3 + 28 * 4
PARTS = {"head": (3, 10), "left_hand": (10, 17), "right_hand": (17, 24), "skeleton": (24, 24 + SKELETON)}
"""Columns of each part in a row."""
ROW = 24 + SKELETON
"""Length of a row: x, y, heading, head, left hand, right hand, skeleton; NaN for a part that is not given."""
FARTHEST = 1e6
"""Largest coordinate [m]."""
REACH = 3.0
"""Largest horizontal distance [m] of head, hands and pelvis from x, y."""
LOWEST, HIGHEST = -1.0, 4.0
"""Heights [m] of head, hands and pelvis."""
_SEVEN = "x, y, z [m] and a quaternion w, x, y, z"


@storable
@dataclass(frozen=True)
class BodyPose:
    """The pose of a person at one instant, in the world frame (x forward, y left, z up).

    Fields:
        x, y: position on the floor [m].
        heading: direction of the trunk, counter-clockwise from +x [rad].
        head: pose of the middle between the eyes: x, y, z [m] and a quaternion w, x, y, z; x looks ahead. None: the
            head moves with the gait.
        left_hand, right_hand: pose of the wrist in the same form. x points along the hand to the fingers, z out of the
            back of the hand: a hand that reaches ahead with the palm down has the axes of the person.
        skeleton: position of the pelvis joint x, y, z [m], then a quaternion w, x, y, z of each of the 28 bones
            relative to its parent, in the order of the asset; the pelvis relative to ``heading``. No rotation is the
            rest shape. It replaces head and hands.

    Raises:
        InputError: a value is not finite or out of range, or a part has the wrong number of values.

    >>> BodyPose(1.0, 2.0, 0.0, right_hand=(1.1, 1.7, 1.9, 1, 0, 0, 0)).head is None
    True
    """

    x: float
    y: float
    heading: float = 0.0
    head: tuple[float, ...] | None = None
    left_hand: tuple[float, ...] | None = None
    right_hand: tuple[float, ...] | None = None
    skeleton: tuple[float, ...] | None = None

    def __post_init__(self) -> None:
        for name in ("x", "y", "heading"):
            value = getattr(self, name)
            if not _is_number(value) or not abs(value) <= FARTHEST:
                raise InputError(f"BodyPose: {name} = {value!r} must be a finite number, at most {FARTHEST:g}")
            object.__setattr__(self, name, float(value))
        for name, (first, last) in PARTS.items():
            value = getattr(self, name)
            if value is not None:
                object.__setattr__(self, name, self._part(name, value, last - first))

    def _part(self, name: str, value: Any, count: int) -> tuple[float, ...]:
        what = _SEVEN if count == 7 else "3 numbers of the pelvis and a quaternion for each of 28 bones"
        if not isinstance(value, list | tuple | np.ndarray) or len(value) != count:
            raise InputError(f"BodyPose: {name} must be {count} numbers: {what}")
        if not all(_is_number(one) for one in value):
            raise InputError(f"BodyPose: {name} has a value that is not a finite number; it must be {what}")
        numbers = tuple(float(one) for one in value)
        x, y, z = numbers[:3]
        if math.hypot(x - self.x, y - self.y) > REACH or not LOWEST <= z <= HIGHEST:
            raise InputError(
                f"BodyPose: {name} at {x:g}, {y:g}, {z:g} m must be at most {REACH:g} m from x, y and {LOWEST:g} to"
                f" {HIGHEST:g} m high"
            )
        for k in range(3, count, 4):
            if not 1e-3 <= math.hypot(*numbers[k : k + 4]) <= 1e3:
                raise InputError(f"BodyPose: {name} has a quaternion {list(numbers[k : k + 4])} that is no rotation")
        return numbers

    def row(self) -> Floats:
        """Return the pose as ``[139]`` numbers, NaN for parts that are not given."""
        found = np.full(ROW, np.nan)
        found[:3] = self.x, self.y, self.heading
        for name, (first, last) in PARTS.items():
            value = getattr(self, name)
            if value is not None:
                found[first:last] = value
        return found

    @classmethod
    def of_row(cls, row: Floats) -> BodyPose:
        """Return the pose of a row."""
        parts = {
            name: None if np.isnan(row[first]) else tuple(row[first:last].tolist())
            for name, (first, last) in PARTS.items()
        }
        x, y, heading = row[:3].tolist()
        return cls(x, y, heading, **parts)


def _is_number(value: Any) -> bool:
    if isinstance(value, bool | np.bool_) or not isinstance(value, int | float | np.floating | np.integer):
        return False
    return bool(-1e300 <= value <= 1e300)


def shift_row(row: Floats, dx: float, dy: float) -> Floats:
    """Return the row of the same pose moved by dx, dy [m]."""
    found = row.copy()
    for column in (0, 3, 10, 17, 24):
        found[column] += dx
        found[column + 1] += dy
    return found


def blend_rows(a: Floats, b: Floats, share: float) -> Floats:
    """Return the row between two rows: positions linearly, rotations by :func:`slerp`, headings on the shorter arc.

    A part that ``b`` lacks moves with the person; one that ``a`` lacks is not there.

    >>> blend_rows(BodyPose(0, 0, 3.0).row(), BodyPose(2, 4, -3.0).row(), 0.5)[:3].round(6).tolist()
    [1.0, 2.0, 3.141593]
    """
    found = shift_row(a, share * (b[0] - a[0]), share * (b[1] - a[1]))
    turn = b[2] - a[2]
    found[2] = a[2] + share * (turn - 2.0 * math.pi * math.floor((turn + math.pi) / (2.0 * math.pi)))
    for first, last in PARTS.values():
        if np.isnan(a[first]) or np.isnan(b[first]):
            continue
        place = slice(first, first + 3)
        found[place] = a[place] + share * (b[place] - a[place])
        turns = slice(first + 3, last)
        found[turns] = slerp(a[turns].reshape(-1, 4), b[turns].reshape(-1, 4), share).ravel()
    return found
