"""Points of a PCD file of the Point Cloud Library."""

from __future__ import annotations

from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError

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
        dtype = np.dtype([(f"f{k}", *one) for k, one in enumerate(types)])
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
    return fields, [(one, (count,)) for one, count in zip(types, counts, strict=True)], points
