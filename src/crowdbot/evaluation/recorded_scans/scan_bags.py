"""Recorded scans in bags of ROS: those of leg_tracker with labelled legs, and any others without people."""

from __future__ import annotations

import math
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import DataError, InputError
from crowdbot.data import read_bag_messages, stamp_of
from crowdbot.sensors import Scan
from crowdbot.typing import Floats

from .annotated_scan import AnnotatedScan, planar_scan

SCAN, POSES = "sensor_msgs/msg/LaserScan", "geometry_msgs/msg/PoseArray"
LEGS = "/leg_cluster_positions"
"""Topic of the labels, one message for each scan."""
SECTOR = (math.radians(15.0), 5.0)
"""Half angle [rad] and range [m] in which the authors of leg_tracker labelled all legs of the published bags."""
STRIDE = 0.8
"""Largest distance of the two legs of a person [m], as in leg_tracker."""
NOBODY: Floats = np.zeros((0, 2))
SECOND = 1e-9
MOST_BEAMS, MOST_VALUES = 10_000, 200_000_000
"""Largest number of ranges of a scan, and of all scans."""


def read_scan_bag(
    file: Path | str, topic: str = "", nobody: bool = False, labelled: bool = True
) -> list[AnnotatedScan]:
    """Return the scans of a bag; the pose is that of the scanner at the origin.

    The bags of leg_tracker (``positive_*_extracted.bag`` of https://github.com/angusleigh/leg_tracker) have one message
    of ``/leg_cluster_positions``, ``geometry_msgs/PoseArray`` in the frame of the scanner, for each ``LaserScan``. Legs
    are labelled within 15 degrees of the x axis and 5 m only (Leigh, Pineau, Olmedo and Zhang (2015), Person tracking
    and following with 2D laser scanners, doi 10.1109/ICRA.2015.7139259). The nearest legs, at most 0.8 m apart, are one
    person, and a leg without another one is a person, too. Ranges below ``range_min`` are unknown, those from
    ``range_max`` on are no returns. The data set is not part of crowdbot.

    Args:
        file: the bag, of ROS 1 or ROS 2.
        topic: topic of the scans; default: the first one by name.
        nobody: whether nobody is in the scans of a bag without labels.
        labelled: whether a bag without labels is refused; otherwise its people are unknown.

    Raises:
        DataError: the file is missing or damaged, or it has no such scans or no labels.
        InputError: nobody is said to be in scans with labelled people.
    """
    scans: dict[str, list[Scan]] = {}
    labels: list[Floats] = []
    values = 0

    def receive(name: str, kind: str, decode: Callable[[], Any]) -> None:
        nonlocal values
        message = decode()
        if kind == SCAN:
            values += len(message.ranges)
            if values > MOST_VALUES:
                raise DataError(f"{file} has scans of more than {MOST_VALUES} ranges; split it in time")
            scans.setdefault(name, []).append(_scan(message, f"{file}, {name}, scan {len(scans.get(name, ())) + 1}"))
        else:
            place = np.array([(pose.position.x, pose.position.y) for pose in message.poses]).reshape(-1, 2)
            if not np.isfinite(place).all():
                raise DataError(f"{file}, {name}, message {len(labels) + 1} has a number that is not finite")
            labels.append(place)

    read_bag_messages(file, lambda name, kind: kind == SCAN or (kind == POSES and name == LEGS), receive)
    if not scans:
        raise DataError(f"{file} has no messages of the type sensor_msgs/LaserScan")
    chosen = topic or min(scans)
    if chosen not in scans:
        raise DataError(f"{file} has no scans in {chosen}; it has {', '.join(sorted(scans))}")
    rows = scans[chosen]
    if nobody and labels:
        raise InputError(f"{file} has labelled legs in {LEGS}, so there are people in its scans")
    if nobody:
        return [AnnotatedScan(scan, NOBODY) for scan in rows]
    if not labels and not labelled:
        return [AnnotatedScan(scan, None) for scan in rows]
    if not labels:
        raise DataError(
            f"{file} has no labelled legs in {LEGS}; if nobody is in its scans, give --nobody; for tracks without"
            " scores, --out DIR"
        )
    if len(labels) != len(rows):
        raise DataError(
            f"{file} has {len(rows)} scans in {chosen} and {len(labels)} labels in {LEGS}, one each is needed"
        )
    return [AnnotatedScan(scan, pair_legs(legs), sector=SECTOR) for scan, legs in zip(rows, labels, strict=True)]


def pair_legs(legs: Floats) -> Floats:
    """Return the people ``[N, 2]`` of legs ``[L, 2]``: the nearest ones in pairs, and the others alone [m].

    >>> pair_legs(np.array([[1.0, 0.0], [1.4, 0.0], [5.0, 0.0]])).round(1).tolist()
    [[1.2, 0.0], [5.0, 0.0]]
    """
    away = np.linalg.norm(legs[:, None] - legs[None], axis=-1)
    away[np.tril_indices(len(legs))] = math.inf
    free, people = np.ones(len(legs), dtype=np.bool_), []
    for index in np.argsort(away, axis=None):
        one, other = divmod(int(index), len(legs))
        if away[one, other] <= STRIDE and free[one] and free[other]:
            free[[one, other]] = False
            people.append(0.5 * (legs[one] + legs[other]))
    return np.array([*people, *legs[free]]).reshape(-1, 2)


def _scan(message: Any, where: str) -> Scan:
    """Return a message as a scan with angles from right to left."""
    ranges = np.asarray(message.ranges, dtype=np.float64)
    first, step = float(message.angle_min), float(message.angle_increment)
    near, far = float(message.range_min), float(message.range_max)
    if not 2 <= len(ranges) <= MOST_BEAMS:
        raise DataError(f"{where} has {len(ranges)} ranges, 2 to {MOST_BEAMS} are read")
    if not (math.isfinite(first) and 0.0 < abs(step) * (len(ranges) - 1) <= 2.0 * math.pi + 1e-3):
        raise DataError(f"{where}: angle_min = {first} and angle_increment = {step} rad must give at most a full turn")
    if not 0.0 <= near < far < math.inf:
        raise DataError(
            f"{where}: range_min = {near} and range_max = {far} m must be finite, and the first the smaller one"
        )
    angles = first + step * np.arange(float(len(ranges)))
    shown = np.where(ranges < near, np.nan, np.where(np.isposinf(ranges), far, ranges))
    if step < 0.0:  # a scanner that is mounted upside down
        shown, angles = shown[::-1], angles[::-1]
    return planar_scan(SECOND * stamp_of(message.header), shown, angles, far)
