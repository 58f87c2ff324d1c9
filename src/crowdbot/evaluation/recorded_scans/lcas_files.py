"""Recorded 3-D scans with annotated people in the files of the L-CAS data set."""

from __future__ import annotations

import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError, SpatialPose
from crowdbot.sensors import PointCloud
from crowdbot.typing import Floats

from .annotated_scan import AnnotatedScan, read_text_lines

LARGEST = 64_000_000
"""Largest size of a file [bytes]."""
MOST_POINTS, MOST_FIELDS, MOST_COUNT = 1_000_000, 64, 4096
LONGEST_HEADER = 4096
"""Bytes in which the header must end."""
TYPES = {("F", 4): "<f4", ("F", 8): "<f8", ("U", 1): "u1", ("U", 2): "<u2", ("U", 4): "<u4", ("U", 8): "<u8",
         ("I", 1): "i1", ("I", 2): "<i2", ("I", 4): "<i4", ("I", 8): "<i8"}  # fmt: skip
AXES = ("x", "y", "z")


def read_pcd(file: Path) -> NDArray[np.float64]:
    """Return the points ``[N, 3]`` of a PCD file, version 0.7, with ASCII or binary data [m].

    Source: https://pointclouds.org/documentation/tutorials/pcd_file_format.html.

    Args:
        file: the file.

    Raises:
        DataError: the file is missing, damaged, compressed or too large, or lacks x, y and z.
    """
    try:
        if file.stat().st_size > LARGEST:
            raise DataError(f"{file}: a point cloud has at most {LARGEST / 1e6:g} MB")
        raw = file.read_bytes()
    except OSError as error:
        raise DataError(f"{file} cannot be read: {error}") from None
    header, begin = _header(raw, file)
    fields, types, points = _layout(header, file)
    kind = header["DATA"][0]
    if kind == "binary_compressed":
        raise DataError(f"{file}: compressed points are not read; convert them: pcl_convert_pcd_ascii_binary IN OUT 1")
    if kind not in ("ascii", "binary"):
        raise DataError(f"{file}: DATA {kind} must be ascii or binary")
    at = [fields.index(axis) for axis in AXES]
    if kind == "binary":
        dtype = np.dtype([(f"f{k}", *type_) for k, type_ in enumerate(types)])
        if len(raw) - begin < points * dtype.itemsize:
            raise DataError(f"{file} is truncated: {points} points of {dtype.itemsize} bytes are announced")
        rows = np.frombuffer(raw, dtype, points, begin)
        return np.stack([np.asarray(rows[f"f{k}"], dtype=np.float64).reshape(points) for k in at], axis=-1)
    starts = np.cumsum([0, *(count for _, (count,) in types)])
    try:
        table = np.array([line.split() for line in raw[begin:].splitlines()[:points]], dtype=np.float64)
        return np.asarray(table.reshape(points, int(starts[-1]))[:, starts[at]])
    except ValueError:
        raise DataError(f"{file} must have {points} lines of {starts[-1]} numbers after the header") from None


def _header(raw: bytes, file: Path) -> tuple[dict[str, list[str]], int]:
    """Return the words of each line of the header, and where the points begin."""
    header: dict[str, list[str]] = {}
    begin = 0
    while (end := raw.find(b"\n", begin, LONGEST_HEADER)) >= 0:
        words = raw[begin:end].decode("ascii", "replace").split()
        begin = end + 1
        if words and not words[0].startswith("#"):
            header[words[0]] = words[1:]
            if words[0] == "DATA":
                break
    lacking = [name for name in ("FIELDS", "SIZE", "TYPE", "POINTS", "DATA") if not header.get(name)]
    if lacking:
        raise DataError(f"{file} is no PCD file: its header lacks {', '.join(lacking)}")
    return header, begin


def _layout(header: dict[str, list[str]], file: Path) -> tuple[list[str], list[tuple[str, tuple[int]]], int]:
    """Return the names of the fields, type and count of each, and the number of points."""
    fields = header["FIELDS"]
    try:
        sizes, points = [int(word) for word in header["SIZE"]], int(header["POINTS"][0])
        counts = [int(word) for word in header.get("COUNT", ["1"] * len(fields))]
        types = [TYPES[kind, size] for kind, size in zip(header["TYPE"], sizes, strict=True)]
    except (ValueError, KeyError):
        raise DataError(f"{file}: SIZE, TYPE, COUNT and POINTS of its header cannot be read") from None
    if not len(fields) == len(types) == len(counts) or len(fields) > MOST_FIELDS:
        raise DataError(f"{file}: FIELDS, SIZE, TYPE and COUNT must have the same number of words")
    if not all(1 <= count <= MOST_COUNT for count in counts) or not 0 <= points <= MOST_POINTS:
        raise DataError(f"{file} has {points} points, or counts {counts}; at most {MOST_POINTS} points are read")
    if any(counts[fields.index(axis)] != 1 if axis in fields else True for axis in AXES):
        raise DataError(f"{file} must have the fields x, y and z; it has {', '.join(fields)}")
    return fields, [(type_, (count,)) for type_, count in zip(types, counts, strict=True)], points


HEIGHT = 0.8
"""Height of the scanner above the floor [m]."""
RINGS, RING_STEP, LOWEST = 16, math.radians(2.0), math.radians(-15.0)
"""Rings of the scanner, a Velodyne VLP-16."""
COLUMNS = 1800
"""Columns of beams of a turn."""
MOST_FILES, LARGEST_LABEL, MOST_LABELS = 100_000, 1_000_000, 1000
WORDS = 11
"""Columns of a line of annotations."""
GROUP_MARGIN = 0.3
"""Margin around the box of a group [m] in which detections do not count."""


def read_lcas(folder: Path | str, annotated_only: bool = False) -> Iterator[AnnotatedScan]:
    """Yield the scans of a folder of the L-CAS data set; the pose is that of the scanner, 0.8 m above the origin.

    Each scan is a file ``TIME.pcd``; its people are in ``TIME.txt`` beside it, if it is annotated. A line has the
    category, the centre, the smallest and the largest x, y and z of the box [m], and whether it is partly hidden.
    Detections in the box of a ``group`` do not count (Yan, Duckett and Bellotto (2017), Online learning for human
    classification in 3D LiDAR-based tracking, doi 10.1109/IROS.2017.8202247). The points are sorted into 16 rings of
    1800 beams. The data set is not part of crowdbot.

    Args:
        folder: folder with the files of scans and annotations.
        annotated_only: leave scans without annotations out.

    Raises:
        DataError: the folder has no scans, or a file is damaged.
    """
    place = Path(folder)
    try:
        files = sorted(place.glob("*.pcd"))
    except OSError as error:
        raise DataError(f"{place} cannot be read: {error}") from None
    if not files:
        raise DataError(f"{place} has no scans: TIME.pcd files are expected")
    if len(files) > MOST_FILES:
        raise DataError(f"{place} has {len(files)} scans, at most {MOST_FILES} are read")
    return _rows(files, annotated_only)


def _rows(files: list[Path], annotated_only: bool) -> Iterator[AnnotatedScan]:
    for file in files:
        labels = file.with_suffix(".txt")
        if annotated_only and not labels.exists():
            continue
        people, groups = _annotations(labels) if labels.exists() else (None, np.zeros((0, 4)))
        yield AnnotatedScan(_cloud(_time(file), read_pcd(file)), people, groups)


def _time(file: Path) -> float:
    try:
        time = float(file.stem)
    except ValueError:
        time = math.nan
    if not math.isfinite(time):
        raise DataError(f"{file}: the name must be the time of the scan [s], such as 1464001237.67.pcd")
    return time


def _cloud(time: float, points: Floats) -> PointCloud:
    """Return points ``[N, 3]`` as the beams of the scanner; of two points in a beam the nearer one stays."""
    ranges = np.full((RINGS, COLUMNS), math.inf)
    size = np.linalg.norm(points, axis=1)
    use = np.isfinite(size) & (size > 0.0)
    x, y, z = points[use].T
    ring = np.rint((np.arctan2(z, np.hypot(x, y)) - LOWEST) / RING_STEP).astype(np.int64)
    column = np.rint((np.arctan2(y, x) + math.pi) / (2.0 * math.pi) * COLUMNS).astype(np.int64) % COLUMNS
    inside = (ring >= 0) & (ring < RINGS)
    np.minimum.at(ranges, (ring[inside], column[inside]), size[use][inside])
    nothing = np.broadcast_to(np.int64(-1), (1, RINGS, COLUMNS))
    azimuth: Floats = -math.pi + 2.0 * math.pi / COLUMNS * np.arange(float(COLUMNS))
    pose = SpatialPose.of((0.0, 0.0, HEIGHT))
    cosine = np.broadcast_to(np.float64(1.0), nothing.shape)
    elevation: Floats = LOWEST + RING_STEP * np.arange(float(RINGS))
    return PointCloud(time, pose, ranges[None], elevation, azimuth, nothing, nothing, cosine)


def _annotations(file: Path) -> tuple[Floats, Floats]:
    """Return the people ``[N, 2]`` and the boxes of groups ``[B, 4]`` [m]."""
    lines = read_text_lines(file, LARGEST_LABEL, "annotations have")
    people, groups = [], []
    for number, line in enumerate(lines[: MOST_LABELS + 1], 1):
        words = line.split()
        if not words:
            continue
        try:
            values = [float(word) for word in words[1:10]]
        except ValueError:
            values = []
        known = len(words) == WORDS and len(values) == WORDS - 2 and words[0] in ("pedestrian", "group")
        if not known or not np.isfinite(values).all():
            raise DataError(f"{file} line {number} must be pedestrian or group, nine numbers and the visibility")
        if number > MOST_LABELS:
            raise DataError(f"{file} has more than {MOST_LABELS} lines")
        if words[0] == "pedestrian":
            people.append(values[:2])
        else:
            low, high = np.array(values[3:5]) - GROUP_MARGIN, np.array(values[6:8]) + GROUP_MARGIN
            groups.append([*low, *high])
    return np.array(people).reshape(-1, 2), np.array(groups).reshape(-1, 4)
