"""Recorded scans with odometry in the folders of the OGM-Turtlebot2 data set."""

from __future__ import annotations

import io
import math
import tokenize
from collections.abc import Iterator
from pathlib import Path

import numpy as np
from numpy.lib import format as npy
from numpy.typing import NDArray

from crowdbot.core import DataError, InputError, Pose, Walls
from crowdbot.evaluation.tracking.reading_log import LoggedReading, ReadingLog
from crowdbot.typing import Floats

from .annotated_scan import planar_scan

LARGEST_POSE = 131_072
"""Largest size of a file [bytes]."""
HEADERS = {(1, 0): npy.read_array_header_1_0, (2, 0): npy.read_array_header_2_0}
"""Readers of the header by version of the format."""
WRONG = (ValueError, TypeError, SyntaxError, RecursionError, MemoryError, OverflowError, tokenize.TokenError)
"""What the readers of the header raise on damaged files."""


def read_npy_row(path: Path) -> Floats:
    """Return the numbers ``[N]`` of a file; its array has at most one axis that is longer than 1.

    Only the header is parsed, so that neither pickled objects nor the memory that a header asks for are created.

    Raises:
        DataError: the file is missing, too large or damaged.
    """
    try:
        if not path.is_file() or path.stat().st_size > LARGEST_POSE:
            raise DataError(f"{path} must be a file of at most {LARGEST_POSE // 1024} KiB")
        data = path.read_bytes()
    except OSError as error:
        raise DataError(f"{path} cannot be read: {error}") from None
    stream = io.BytesIO(data)
    try:
        shape, _, kind = HEADERS[npy.read_magic(stream)](stream)
    except (*WRONG, KeyError):
        raise DataError(f"{path} is not an NPY file of version 1.0 or 2.0") from None
    rest = data[stream.tell() :]
    if kind.kind not in "fiu":
        raise DataError(f"{path} has values of type {str(kind)[:40]}, it must have numbers")
    if max(shape, default=1) != math.prod(shape) or math.prod(shape) * kind.itemsize != len(rest):
        raise DataError(f"{path} has {len(rest)} bytes of shape {str(shape)[:60]}, it must have one row of {kind}")
    return np.frombuffer(rest, kind).astype(np.float64)


OGM_PERIOD = 0.1
"""Time between two scans [s]."""
FIELD_OF_VIEW = math.radians(270.0)
"""Field of view of the scanner, a Hokuyo UTM-30LX; the first beam is at -135 degrees and the last one at 135."""
MAX_RANGE = 30.0
"""Ranges from here on, NaN and infinity are no returns [m]."""
MOST_SCANS, MOST_BEAMS, LARGEST_LIST = 200_000, 10_000, 20_000_000
"""Largest number of scans of a folder, of beams of a scan, and size of a list of files [bytes]."""
JUMP, TURN = 0.5, 0.8
"""A robot that moves farther [m] or turns more [rad] between two scans has been placed anew."""
PIECE = 600
"""Largest number of scans of a piece."""
LARGEST = 1e6
"""Poses with larger values [m], [rad] count as not finite."""
FORBIDDEN = "/\\:\0"
"""Characters that the name of a file must not have."""
SCANS, POSITIONS = "scans", "positions"


def find_ogm_split(folder: Path | str) -> Path | None:
    """Return the folder with ``scans`` and ``positions``: the given one or its ``test``; None if there is none."""
    root = Path(folder)
    for item in (root, root / "test"):
        if (item / SCANS).is_dir() and (item / POSITIONS).is_dir():
            return item
    return None


def read_ogm(folder: Path | str, duration: float = math.inf, min_duration: float = 0.0) -> list[ReadingLog]:
    """Return the scans of a split of OGM-Turtlebot2 with the poses of the odometry, in pieces of at most one minute.

    ``scans/NAME.npy`` has the ranges ``[R]`` over 270 degrees from right to left [m], ``positions/NAME.npy`` x, y [m]
    and heading [rad] of the robot, which is also the place of the scanner; the lists ``scans/SPLIT.txt`` and
    ``positions/SPLIT.txt`` have the names of the files in the order of time, 10 a second (Xie and Dames (2023),
    Stochastic occupancy grid map prediction in dynamic scenes, https://proceedings.mlr.press/v229/xie23a.html; data:
    doi 10.5281/zenodo.7051560). ``velocities`` are not read. A piece ends where the robot jumps or a pose is not
    finite. Nobody has annotated people, and there is no map. The data set is not part of crowdbot.

    Args:
        folder: folder of a split, or of the data set, of which ``test`` is read.
        duration: only this time from the beginning is read [s].
        min_duration: pieces shorter than this are left out [s].

    Raises:
        DataError: a file is missing or damaged, a name in a list is outside its folder, or no piece is long enough.
        InputError: the duration is not above 0.
    """
    if not duration > 0.0:
        raise InputError(f"read_ogm: duration = {duration:g} s must be above 0")
    found = find_ogm_split(folder)
    if found is None:
        raise DataError(f"{folder} must have the folders {SCANS} and {POSITIONS}, or a folder test that has them")
    split = found.resolve()
    scans, positions = (_files(split / part, split) for part in (SCANS, POSITIONS))
    if len(scans) != len(positions):
        raise DataError(f"{split}: {len(scans)} scans and {len(positions)} positions are listed, one each is needed")
    count = min(len(scans), MOST_SCANS if math.isinf(duration) else round(duration / OGM_PERIOD))
    poses = [_pose(path) for path in positions[:count]]
    need = round(min_duration / OGM_PERIOD)
    pieces = [piece for piece in _pieces(np.array(poses).reshape(-1, 3)) if len(piece) > need]
    if not pieces:
        raise DataError(
            f"{split}: {count} scans have no more than {min_duration:g} s in which the position is finite and does not"
            f" jump by {JUMP:g} m or {TURN:g} rad"
        )
    return [ReadingLog(split.name, 0, SCANS, Walls.of(), _rows(piece, scans, poses)) for piece in pieces]


def _files(folder: Path, split: Path) -> list[Path]:
    """Return the files of the list in a folder of a split."""
    lists = sorted(folder.glob("*.txt"))
    named = [list_ for list_ in lists if list_.stem == split.name]
    if not named and len(lists) != 1:
        raise DataError(f"{folder} has {len(lists)} lists *.txt, it must have one or {split.name}.txt")
    file = _inside((named or lists)[0], split)
    try:
        if not file.is_file() or file.stat().st_size > LARGEST_LIST:
            raise DataError(f"{file} must be a file of at most {LARGEST_LIST / 1e6:g} MB")
        lines = file.read_text(encoding="utf-8").splitlines()
    except (OSError, UnicodeDecodeError) as error:
        raise DataError(f"{file} cannot be read: {error}") from None
    names = [(number, line.strip()) for number, line in enumerate(lines, 1) if line.strip()]
    if not 1 <= len(names) <= MOST_SCANS:
        raise DataError(f"{file} has {len(names)} names, 1 to {MOST_SCANS} are read")
    for number, name in names:
        if set(name) & set(FORBIDDEN) or not name.endswith(".npy"):
            raise DataError(f"{file} line {number} is {name[:80]!r}, it must be the name of a file *.npy in {folder}")
    return [_inside(folder / name, split) for _, name in names]


def _inside(path: Path, split: Path) -> Path:
    """Return a path that no link leads out of the split."""
    try:
        there = path.resolve()
    except (OSError, RuntimeError) as error:  # a link to itself
        raise DataError(f"{path} cannot be read: {error}") from None
    if not there.is_relative_to(split):
        raise DataError(f"{path} is a link out of {split}")
    return path


def _pose(path: Path) -> Floats:
    row = read_npy_row(path)
    if len(row) != 3:
        raise DataError(f"{path} has {len(row)} numbers, a position has 3: x, y and heading")
    return row


def _pieces(poses: Floats) -> Iterator[NDArray[np.int64]]:
    """Yield the numbers of the scans of each piece."""
    fine = (np.abs(poses) <= LARGEST).all(axis=-1)
    use = np.flatnonzero(fine)
    step = np.diff(poses[use], axis=0)
    apart = np.hypot(step[:, 0], step[:, 1]) > JUMP
    turned = np.abs(np.angle(np.exp(1j * step[:, 2]))) > TURN
    ends = np.flatnonzero(apart | turned | (np.diff(use) > 1)) + 1
    for run in np.split(use, ends):
        if len(run):
            yield from np.array_split(run, math.ceil(len(run) / PIECE))


def _rows(piece: NDArray[np.int64], files: list[Path], poses: list[Floats]) -> tuple[LoggedReading, ...]:
    """Return the readings of a piece; all scans have the same number of beams."""
    rows: list[LoggedReading] = []
    angles = np.zeros(0)
    for k in piece.tolist():
        ranges = read_npy_row(files[k])
        angles = angles if len(angles) else np.linspace(-0.5 * FIELD_OF_VIEW, 0.5 * FIELD_OF_VIEW, len(ranges))
        if not 3 <= len(ranges) <= MOST_BEAMS or len(ranges) != len(angles):
            wanted = f"3 to {MOST_BEAMS}" if not rows else f"{len(angles)} as the scans before"
            raise DataError(f"{files[k]} has {len(ranges)} ranges, a scan must have {wanted}")
        shown = np.where(np.isnan(ranges) | (ranges == np.inf), MAX_RANGE, ranges)
        x, y, heading = (float(item) for item in poses[k])
        scan = planar_scan(OGM_PERIOD * k, shown, angles, MAX_RANGE, Pose.of((x, y), heading))
        rows.append(LoggedReading(scan, {}, {}, {}, (x, y)))
    return tuple(rows)
