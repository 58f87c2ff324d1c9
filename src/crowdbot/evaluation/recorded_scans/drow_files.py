"""Recorded scans with annotated people in the files of the DROW data set."""

from __future__ import annotations

import json
import math
from pathlib import Path

import numpy as np

from crowdbot.core import DataError
from crowdbot.typing import Floats

from .annotated_scan import AnnotatedScan, planar_scan, read_text_lines

FIELD_OF_VIEW = math.radians(225.0)
"""Field of view of the scanner, a SICK S300."""
MOST_SCANS, MOST_BEAMS = 1_000_000, 10_000
LARGEST = 1_000_000_000
"""Largest size of a file [bytes]."""
SUFFIX = ".wp"
"""Suffix of the annotations of people on foot."""


def read_drow(file: Path | str, max_range: float = 15.0) -> list[AnnotatedScan]:
    """Return the scans of a sequence of the DROW data set; the pose is that of the scanner at the origin.

    A line of ``NAME.csv`` has the number of the scan, the time [s] and the ranges over 225 degrees, from right to left.
    A line of ``NAME.wp`` has the number of a scan and the list of its people as range and angle, 0 ahead and positive
    to the left (Beyer, Hermans and Leibe (2017), DROW, doi 10.1109/LRA.2016.2645131). Scans without a line there are
    not annotated. The data set is not part of crowdbot.

    Args:
        file: ``NAME.csv``, with ``NAME.wp`` beside it.
        max_range: ranges from here on are no returns [m].

    Raises:
        DataError: a file is missing or damaged.
    """
    path = Path(file)
    people = _annotations(path.with_suffix(SUFFIX))
    annotated_scans: list[AnnotatedScan] = []
    width, angles = 0, np.zeros(0)
    for number, line in enumerate(_lines(path), 1):
        head, _, rest = line.partition(",")
        if not head.strip().isdigit():
            raise DataError(f"{path} line {number} has no scan: it must begin with the number of the scan")
        try:
            row = np.array([float(word) for word in rest.strip().rstrip(",").split(",")])
        except ValueError:
            row = np.zeros(0)
        width = width or len(row)
        if not 3 <= len(row) <= MOST_BEAMS or len(row) != width or not math.isfinite(row[0]):
            raise DataError(
                f"{path} line {number} has no scan: it must have a number, a time and {max(2, width - 1)} ranges"
            )
        angles = angles if len(angles) else np.linspace(-0.5 * FIELD_OF_VIEW, 0.5 * FIELD_OF_VIEW, len(row) - 1)
        scan = planar_scan(float(row[0]), row[1:], angles, max_range)
        annotated_scans.append(AnnotatedScan(scan, people.get(int(head))))
    if not any(one.people is not None for one in annotated_scans):
        raise DataError(f"{path} has no scan with a line in {path.with_suffix(SUFFIX).name}")
    return annotated_scans


def _annotations(path: Path) -> dict[int, Floats]:
    """Return the people ``[N, 2]`` [m] of each annotated scan by its number."""
    result = {}
    for number, line in enumerate(_lines(path), 1):
        head, _, rest = line.partition(",")
        try:
            rows = np.array(json.loads(rest), dtype=np.float64).reshape(-1, 2)
            scan = int(head)
        except (ValueError, TypeError, RecursionError):
            raise DataError(f"{path} line {number} must be the number of a scan and a list of [range, angle]") from None
        if not np.isfinite(rows).all():
            raise DataError(f"{path} line {number} has a number that is not finite")
        result[scan] = rows[:, :1] * np.stack([np.cos(rows[:, 1]), np.sin(rows[:, 1])], axis=-1)
    return result


def _lines(path: Path) -> list[str]:
    lines = read_text_lines(path, LARGEST, "a sequence has")
    if len(lines) > MOST_SCANS:
        raise DataError(f"{path} has {len(lines)} lines, at most {MOST_SCANS} are read")
    return [line for line in lines if line.strip()]
