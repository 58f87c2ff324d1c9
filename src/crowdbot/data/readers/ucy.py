"""UCY's own annotation, ``annotation.vsp``: one spline of control points per person, in pixels.

First line: number of splines. Then per spline its number of control points and a line "x y frame gaze" for each.
Comments run from " - " to the end of the line. The origin is the middle of the image, y goes up, 25 Hz.
Positions between control points are interpolated linearly: they agree with the published text files
within 2 mm in the median (zara01, zara02, students003).
"""

from __future__ import annotations

import re

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.data.source import Source
from crowdbot.data.trajectories import Trajectories

from .assemble import assemble
from .reader import Reader, ReadOptions

VIDEO_FPS = 25.0
MAX_INTERPOLATED = 2_000_000
"""Most rows after interpolation, ten times those of the longest UCY recording: two lines can span any time."""

UCY_TO_METRES = np.array([[0.02104, 0.0, 7.577], [0.0, 0.02386, 6.873], [0.0, 0.0, 1.0]])
"""From vsp pixels to the metres of the leave-one-out text files, fitted to zara01, zara02 and students003.

For students01 and uni_examples it is likely (same camera as students03) but not checked. The obsmat files of the same
people use other maps: turned by 90 degrees, shifted, and scaled 3 % and 9 % differently."""
UCY_TO_METRES.setflags(write=False)

KNOWN = {(148, 279.0, -123.0), (204, 358.0, -66.0), (434, 70.0, -35.0)}
"""Splines and first control point of the recordings that the map was fitted to."""


def sniff(source: Source) -> bool:
    """Return whether the first line counts splines and the second control points."""
    lines = [_bare(line) for line in source.lines[:3]]
    return len(lines) == 3 and lines[0].isdecimal() and lines[1].isdecimal() and len(lines[2].split()) == 4


def read(source: Source, options: ReadOptions) -> Trajectories:
    """Read the splines; the id of a person is the number of the spline, from 1, as in the published text files."""
    splines = _splines(source)
    spans = sum(float(np.ptp(points[:, 2])) for points in splines if len(points))
    if spans > MAX_INTERPOLATED:
        raise DataError(
            f"{source.name}: its splines span {spans:.0f} frames, at most {MAX_INTERPOLATED} are read;"
            " a frame of a control point may be damaged"
        )
    parts = [_interpolate(points, number) for number, points in enumerate(splines, 1) if len(points)]
    if not parts:
        raise DataError(f"{source.name} has no control points")
    id, frame, x, y = (np.concatenate(column) for column in zip(*parts, strict=True))
    fitted = bool(len(splines[0])) and (len(splines), splines[0][0, 0], splines[0][0, 1]) in KNOWN
    homography = UCY_TO_METRES if fitted and options.units is None else None
    note = "pixels, interpolated between control points"
    return assemble(
        source,
        options,
        id=id,
        frame=frame,
        x=x,
        y=y,
        fps=VIDEO_FPS,
        units="px",
        note=f"{note}; metres() converts them to the metres of the text files" if fitted else note,
        homography=homography,
    )


def _bare(line: str) -> str:
    return re.split(r"\s-\s", line, maxsplit=1)[0].strip()


def _splines(source: Source) -> list[NDArray[np.float64]]:
    lines = [(number, _bare(line)) for number, line in enumerate(source.text().splitlines(), 1) if line.strip()]
    at = 0

    def whole(what: str) -> int:
        nonlocal at
        if at >= len(lines):
            raise DataError(f"{source.name} ends before {what}; the file is truncated")
        number, words = lines[at]
        if not words.isdecimal() or len(words) > 9:
            raise DataError(f"{source.name} line {number}: {words[:40]!r} is not {what}")
        at += 1
        return int(words)

    splines = []
    for spline in range(1, whole("the number of splines") + 1):
        count = whole(f"the number of control points of spline {spline}")
        points = [_point(source.name, number, words) for number, words in lines[at : at + count]]
        if len(points) < count:
            raise DataError(f"{source.name} ends inside spline {spline}; the file is truncated")
        at += count
        splines.append(np.asarray(points, dtype=np.float64).reshape(-1, 3))
    return splines


def _point(name: str, number: int, words: str) -> list[float]:
    try:
        x, y, frame, _gaze = (float(word) for word in words.split())
    except ValueError:
        raise DataError(f"{name} line {number}: {words[:40]!r} is not a control point x y frame gaze") from None
    if not (np.isfinite(x) and np.isfinite(y) and abs(frame) < 1e9):
        raise DataError(f"{name} line {number}: control point {words[:40]!r} is not finite")
    return [x, y, frame]


def _interpolate(points: NDArray[np.float64], number: int) -> tuple[NDArray[np.float64], ...]:
    """Return id, frame, x, y at every whole frame between the first and the last control point."""
    points = points[np.argsort(points[:, 2], kind="stable")]
    frame = np.arange(np.ceil(points[0, 2]), np.floor(points[-1, 2]) + 1)
    x, y = (np.interp(frame, points[:, 2], points[:, axis]) for axis in (0, 1))
    return np.full(len(frame), float(number)), frame, x, y


READER = Reader("ucy-vsp", "UCY annotation.vsp: splines of control points, pixels, 25 Hz", sniff, read)
