"""AnnotatedScan: a recorded scan, and the people in it."""

from __future__ import annotations

import math
from pathlib import Path
from typing import NamedTuple

import numpy as np

from crowdbot.core import DataError, Pose
from crowdbot.sensors import Reading, Scan
from crowdbot.typing import Floats


def read_text_lines(path: Path, largest: int, what: str) -> list[str]:
    """Return the lines of a file in UTF-8.

    Args:
        path: the file.
        largest: largest size [bytes].
        what: content of the file with its verb in messages, such as ``a sequence has``.

    Raises:
        DataError: the file cannot be read, or is larger.
    """
    try:
        if path.stat().st_size > largest:
            raise DataError(f"{path}: {what} at most {largest / 1e6:g} MB")
        return path.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{path} cannot be read: {error}") from None


NO_BOXES: Floats = np.zeros((0, 4))
"""Default of the boxes that do not count."""


class AnnotatedScan(NamedTuple):
    """A recorded scan, and the people in it.

    Fields:
        scan: the scan; its pose is that of the scanner at the origin.
        people: ``[N, 2]`` positions in the frame of the scanner [m]; None if nobody has annotated the scan.
        ignored: ``[B, 4]`` boxes x, y, x, y [m] in which detections are neither right nor wrong, such as groups.
        sector: half angle around the x axis [rad] and range [m] outside which nobody has annotated people, and
            detections are neither right nor wrong, too; None for everywhere.
    """

    scan: Reading
    people: Floats | None
    ignored: Floats = NO_BOXES
    sector: tuple[float, float] | None = None


def planar_scan(time: float, ranges: Floats, angles: Floats, max_range: float, pose: Pose | None = None) -> Scan:
    """Return a recorded planar scan; ground truth of a simulation is empty, and its arrays are shared.

    Args:
        time: time [s].
        ranges: ``[R]`` [m]; values that are not above 0 are unknown.
        angles: ``[R]`` [rad].
        max_range: ranges from here on are no returns [m].
        pose: pose of the scanner; default: the origin.
    """
    known = np.isfinite(ranges) & (ranges > 0.0)
    shown = np.where(known, np.where(ranges < max_range, ranges, math.inf), math.nan)[None]
    nothing = np.broadcast_to(np.int64(-1), shown.shape)
    cosine = np.broadcast_to(np.float64(1.0), shown.shape)
    return Scan(time, Pose.of((0.0, 0.0), 0.0) if pose is None else pose, shown, angles, nothing, cosine, nothing)
