"""Arrays over the recorded steps of an episode: joints, reactions, and heights and tilts of robots."""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from crowdbot.world import REACTIONS

from .step_records import RecordedStep

__all__ = ["joint_positions", "reaction_arrays", "robot_tilts"]

Floats = NDArray[np.float64]
ODOM = "/odom"
"""Ending of the frame in which the root link of a robot moves."""


def joint_positions(found: Sequence[RecordedStep]) -> dict[str, dict[str, Floats]]:
    """Return the positions of the joints by robot and name."""
    rows: dict[str, dict[str, Floats]] = {}
    for k, moment in enumerate(found):
        for robot, joints in moment.joints.items():
            columns = rows.setdefault(robot, {})
            for name, (position, _) in joints.items():
                columns.setdefault(name, np.full(len(found), np.nan))[k] = position
    return rows


def reaction_arrays(found: Sequence[RecordedStep], count: int) -> NDArray[np.int8] | None:
    """Return the codes of the reactions to robots ``[T, A]``; None if nobody can react."""
    if not found or any(moment.reactions is None for moment in found):
        return None
    codes = np.zeros((len(found), count), dtype=np.int8)
    for k, moment in enumerate(found):
        for kind, people in (moment.reactions or {}).items():
            codes[k, people] = REACTIONS.index(kind)
    return codes


def robot_tilts(found: Sequence[RecordedStep], names: Sequence[str]) -> Floats:
    """Return the height [m], roll and pitch [rad] of the root links of R robots ``[T, R, 3]``, from ``/tf``.

    The root of a robot moves in its odometry frame, which is level. NaN while a robot is absent.

    Args:
        found: the recorded steps.
        names: names of the robots.
    """
    rows = np.full((len(found), len(names), 3), np.nan)
    numbers = {name + ODOM: r for r, name in enumerate(names)}
    for k, moment in enumerate(found):
        for parent, _, values in moment.transforms:
            if parent not in numbers:
                continue
            z, turn = values[2], np.array(values[3:])
            size = float(np.sqrt(turn @ turn))
            if not (0.5 < size < 2.0 and math.isfinite(z)):
                raise ValueError(f"the frame {parent!r} has an impossible transform")
            w, i, j, q = (turn / size).tolist()
            roll = math.atan2(2.0 * (w * i + j * q), 1.0 - 2.0 * (i * i + j * j))
            rows[k, numbers[parent]] = z, roll, math.asin(min(1.0, max(-1.0, 2.0 * (w * j - q * i))))
    return rows
