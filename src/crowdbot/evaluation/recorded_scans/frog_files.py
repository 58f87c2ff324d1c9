"""Recorded scans with annotated people in the HDF5 files of the FROG data set."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data import read_hdf5_arrays
from crowdbot.typing import Floats

from .annotated_scan import AnnotatedScan, planar_scan

FIELD_OF_VIEW = math.radians(180.0)
"""Field of view of the scanner."""
MAX_RANGE = 10.0
"""Ranges from here on are no returns, and people beyond are not annotated [m]."""
ARRAYS = ("timestamps", "scans", "circles", "circle_idx", "circle_num")
MOST_VALUES = 200_000_000
"""Largest number of values of a file."""


def read_frog(file: Path | str, max_range: float = MAX_RANGE) -> Iterator[AnnotatedScan]:
    """Yield the scans of a file of the FROG data set; the pose is that of the scanner at the origin.

    ``scans`` ``[N, R]`` has ranges over 180 degrees from right to left [m], ``timestamps`` ``[N]`` their times [s], and
    ``circles`` ``[M, 2 or more]`` the x and y of people [m]; those of scan k are the ``circle_num[k]`` rows from
    ``circle_idx[k]`` (Amodeo, Perez-Higueras, Merino and Caballero (2025), FROG, doi 10.3389/frobt.2025.1671673). The
    data set is not part of crowdbot.

    Args:
        file: ``NAME.h5``.
        max_range: ranges from here on are no returns [m].

    Raises:
        DataError: the file is missing or damaged.
    """
    path = Path(file)
    arrays = read_hdf5_arrays(path, ARRAYS, MOST_VALUES)
    times, scans, circles = (np.asarray(arrays[name]) for name in ARRAYS[:3])
    first, number = (np.asarray(arrays[name]).astype(np.int64) for name in ARRAYS[3:])
    if scans.ndim != 2 or scans.shape[1] < 2 or circles.ndim != 2 or circles.shape[1] < 2:
        raise DataError(f"{path.name}: scans {list(scans.shape)} and circles {list(circles.shape)} must be tables")
    if not times.shape == first.shape == number.shape == (len(scans),):
        raise DataError(f"{path.name}: timestamps, circle_idx and circle_num must have one value for each scan")
    if ((first < 0) | (number < 0) | (number > len(circles)) | (first > len(circles) - number)).any():
        raise DataError(f"{path.name}: circle_idx and circle_num point outside the {len(circles)} circles")
    if not (np.isfinite(times).all() and np.isfinite(circles[:, :2]).all()):
        raise DataError(f"{path.name} has a time or a circle that is not finite")
    return _rows(times, scans, circles, first, number, max_range)


def _rows(
    times: Floats, scans: Floats, circles: Floats, first: NDArray[np.int64], number: NDArray[np.int64],
    max_range: float,
) -> Iterator[AnnotatedScan]:  # fmt: skip
    angles = np.linspace(-0.5 * FIELD_OF_VIEW, 0.5 * FIELD_OF_VIEW, scans.shape[1], endpoint=False)
    for k in range(len(scans)):
        people = circles[first[k] : first[k] + number[k], :2].astype(np.float64)
        yield AnnotatedScan(planar_scan(float(times[k]), scans[k].astype(np.float64), angles, max_range), people)
