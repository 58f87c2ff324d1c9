"""CSV files of rigid bodies: takes that Motive exports, and plain tables."""

from __future__ import annotations

import csv
import io
import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .motion_recording import MOST_FRAMES, MotionRecording, RecordedSubject
from .pose_stream import MotionSample
from .rotations import normalize, rotate_about, to_matrices

UNITS = {"meters": 1.0, "centimeters": 0.01, "millimeters": 0.001}
FROM_Y_UP = np.array([[0.0, 0.0, 1.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]])
"""From the axes of Motive (x left, y up, z forward) to x forward, y left, z up."""
PLAIN = ("time", "x", "y")
OPTIONAL = ("z", "heading", "qw", "qx", "qy", "qz", "subject")
Row = tuple[float, tuple[float, ...], Floats]
"""Time [s], position [m], rotation matrix."""


def read_csv(data: bytes, name: str, begin: float = 0.0) -> MotionRecording:
    r"""Return the rigid bodies in a CSV file.

    A file that Motive has exported begins with ``Format Version``; rotations must be quaternions in the global frame
    with y up. Any other file has a header with ``time`` [s], ``x``, ``y`` [m] and possibly ``z``, ``heading`` [rad] or
    ``qw``, ``qx``, ``qy``, ``qz``, and ``subject``, with z up. Rows of a body that is not tracked have empty cells.

    Args:
        data: content of the file.
        name: name of the file for messages.
        begin: time in the file at which the trial begins [s].

    Raises:
        InputError: the file is not valid; the message names the line.

    >>> recording = read_csv(b"time,x,y,heading\n0,1,2,0\n1,2,2,0\n", "cart.csv")
    >>> recording.read("", 0.0, 0.5)[0][1].position.tolist()
    [[1.0, 2.0, 0.0]]
    """
    try:
        rows = list(csv.reader(io.StringIO(data.decode("utf-8-sig")), strict=True))
    except UnicodeDecodeError:
        raise InputError(f"{name} is not UTF-8 text") from None
    except csv.Error as error:
        raise InputError(f"{name} is not CSV: {error}") from None
    if not rows or not any(cell.strip() for cell in rows[0]):
        raise InputError(f"{name}:1: the header is missing")
    if len(rows) > MOST_FRAMES:
        raise InputError(f"{name} has more than {MOST_FRAMES} rows")
    found = _motive_rows(rows, name) if rows[0][0].strip() == "Format Version" else _plain_rows(rows, name)
    return MotionRecording({subject: _recorded(own, f"{name}: {subject}") for subject, own in found.items()}, begin)


def _recorded(rows: list[Row], where: str) -> RecordedSubject:
    def sample(k: int) -> MotionSample:
        time, position, rotation = rows[k]
        return MotionSample(k, time, np.array([position]), rotation[None])

    try:
        return RecordedSubject(np.array([time for time, _, _ in rows]), sample)
    except InputError as error:
        raise InputError(f"{where}: {error}") from None


def _plain_rows(rows: list[list[str]], name: str) -> dict[str, list[Row]]:
    header = [cell.strip().lower() for cell in rows[0]]
    for cell in header:
        if cell not in (*PLAIN, *OPTIONAL):
            raise InputError(f"{name}:1: {cell[:40]!r} is unknown; known are {', '.join((*PLAIN, *OPTIONAL))}")
    missing = [one for one in PLAIN if one not in header]
    if missing or len(set(header)) < len(header):
        raise InputError(f"{name}:1: {', '.join(missing) + ' is missing' if missing else 'a column is there twice'}")
    found: dict[str, list[Row]] = {}
    for line, cells in enumerate(rows[1:], 2):
        if not any(cell.strip() for cell in cells):
            continue
        if len(cells) != len(header):
            raise InputError(f"{name}:{line}: there are {len(cells)} cells, expected {len(header)} as in the header")
        values = dict(zip(header, cells, strict=True))
        subject = values.pop("subject", "").strip()[:100]
        if not values["x"].strip():
            continue
        numbers = {key: _number(cell, f"{name}:{line}: {key}") for key, cell in values.items() if cell.strip()}
        if "time" not in numbers or "y" not in numbers:
            raise InputError(f"{name}:{line}: time, x and y must be given")
        position = (numbers["x"], numbers["y"], numbers.get("z", 0.0))
        found.setdefault(subject, []).append((numbers["time"], position, _rotation(numbers, f"{name}:{line}")))
    if not found:
        raise InputError(f"{name} has no samples")
    return found


def _rotation(numbers: dict[str, float], where: str) -> Floats:
    if "qw" not in numbers:
        return rotate_about([0.0, 0.0, 1.0], numbers.get("heading", 0.0))
    quaternion = normalize(np.array([numbers.get(key, 0.0) for key in ("qw", "qx", "qy", "qz")]))
    if quaternion is None:
        raise InputError(f"{where}: the length of a quaternion must be 1")
    return to_matrices(quaternion)


class _Columns(NamedTuple):
    """Columns of a rigid body: qx, qy, qz, qw, x, y, z."""

    name: str
    columns: list[int]


def _motive_rows(rows: list[list[str]], name: str) -> dict[str, list[Row]]:
    values = [cell.strip() for cell in rows[0]]
    facts = dict(zip(values[::2], values[1::2], strict=False))
    if facts.get("Rotation Type") != "Quaternion":
        raise InputError(f"{name}:1: Rotation Type must be Quaternion; export the take again")
    if facts.get("Coordinate Space", "Global") != "Global":
        raise InputError(f"{name}:1: Coordinate Space must be Global; export the take again")
    unit = UNITS.get(facts.get("Length Units", "").lower())
    if unit is None:
        raise InputError(f"{name}:1: Length Units must be one of {', '.join(UNITS)}")
    first, bodies = _motive_columns(rows, name)
    found: dict[str, list[Row]] = {one.name: [] for one in bodies}
    for line, cells in enumerate(rows[first:], first + 1):
        if not any(cell.strip() for cell in cells):
            continue
        time = _number(cells[1] if len(cells) > 1 else "", f"{name}:{line}: time")
        for one in bodies:
            own = [cells[k].strip() if k < len(cells) else "" for k in one.columns]
            if not all(own):
                continue  # not tracked in this frame
            numbers = [_number(cell, f"{name}:{line}: {one.name}") for cell in own]
            unit_length = normalize(np.array([numbers[3], *numbers[:3]]))
            if unit_length is None:
                raise InputError(f"{name}:{line}: {one.name}: the length of a quaternion must be 1")
            rotation = FROM_Y_UP @ to_matrices(unit_length) @ FROM_Y_UP.T
            position = FROM_Y_UP @ np.array(numbers[4:]) * unit
            found[one.name].append((time, tuple(position.tolist()), rotation))
    seen = {subject: own for subject, own in found.items() if own}
    if not seen:
        raise InputError(f"{name} has no frame in which a rigid body is tracked")
    return seen


def _motive_columns(rows: list[list[str]], name: str) -> tuple[int, list[_Columns]]:
    """Return the index of the first frame and the columns of the rigid bodies."""
    labels: dict[str, list[str]] = {}
    for k, cells in enumerate(rows[1:20], 1):
        plain = [cell.strip() for cell in cells]
        if plain[:1] == ["Frame"]:
            kinds, names, parts = (labels.get(key, []) for key in ("Type", "Name", "Part"))
            bodies: dict[str, dict[str, int]] = {}
            for c in range(2, len(plain)):
                if c < min(len(kinds), len(names), len(parts)) and kinds[c] == "Rigid Body":
                    bodies.setdefault(names[c][:100], {})[f"{parts[c]} {plain[c]}"] = c
            wanted = [*(f"Rotation {axis}" for axis in "XYZW"), *(f"Position {axis}" for axis in "XYZ")]
            found = [
                _Columns(body, [own[key] for key in wanted]) for body, own in bodies.items() if set(wanted) <= set(own)
            ]
            if not found:
                raise InputError(f"{name}:{k + 1}: there is no rigid body; export skeletons as BVH")
            return k + 1, found
        if len(plain) > 2:
            labels["Part" if plain[2] in ("Rotation", "Position") else plain[1]] = plain
    raise InputError(f"{name} has no row that begins with Frame")


def _number(cell: str, where: str) -> float:
    try:
        value = float(cell)
    except ValueError:
        value = math.nan
    if not math.isfinite(value) or abs(value) > 1e6:
        raise InputError(f"{where} = {cell.strip()[:40]!r} must be a finite number")
    return value
