"""Recorded motion in files: BVH, CSV (Motive, plain tables) and MVNX."""

from __future__ import annotations

import csv
import io
import math
from collections.abc import Callable
from dataclasses import dataclass, field
from typing import Any, NamedTuple
from xml.parsers import expat

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .pose_stream import MotionSample, PoseStream, StreamStatistics
from .retargeting import MOST_JOINTS, SourceSkeleton, body_axes, normalize, rotate_about, to_matrices
from .xsens import SEGMENTS, xsens_skeleton

MOST_FRAMES = 1_000_000


@dataclass(frozen=True, eq=False)
class RecordedSubject:
    """The samples of one subject of a file.

    Fields:
        time: ascending time stamps ``[T]``; 0 is the begin of the file [s].
        sample: returns the sample with an index; poses are computed when they are needed.
    """

    time: Floats
    sample: Callable[[int], MotionSample]

    def __post_init__(self) -> None:
        if not len(self.time):
            raise InputError("a recording has no frames")
        if not np.all(np.isfinite(self.time)) or not np.all(np.diff(self.time) > 0.0):
            raise InputError("the times of a recording must be finite and increase")


class MotionRecording(PoseStream):
    """Plays the samples of a file in simulated time, from the start of the trial on.

    Args:
        recorded: the subjects by name, the main one first.
        begin: time in the file at which the trial begins [s].
    """

    live = False

    def __init__(self, recorded: dict[str, RecordedSubject], begin: float = 0.0) -> None:
        if not recorded:
            raise InputError("a recording has no subjects")
        self.recorded, self.begin = dict(recorded), begin

    def subjects(self) -> tuple[str, ...]:
        return tuple(self.recorded)

    def read(self, subject: str, now: float, ahead: float) -> list[tuple[float, MotionSample]]:
        # samples before and after ahead; none before the first and after the last sample
        found = self._find(subject)
        if found is None:
            return []
        wanted = ahead + self.begin
        k = int(np.searchsorted(found.time, wanted + 1e-9, side="right")) - 1
        last = len(found.time) - 1
        if k < 0 or (k == last and wanted > found.time[last] + 1e-9):
            return []
        return [(float(found.time[i]) - self.begin, found.sample(i)) for i in range(k, min(k + 1, last) + 1)]

    def statistics(self, subject: str = "") -> StreamStatistics:
        found = self._find(subject)
        if found is None:
            return StreamStatistics()
        span = float(found.time[-1] - found.time[0])
        return StreamStatistics(len(found.time), rate=(len(found.time) - 1) / span if span > 0.0 else 0.0)

    def _find(self, subject: str) -> RecordedSubject | None:
        return self.recorded.get(subject) if subject else next(iter(self.recorded.values()))


LEG = 0.85
UNITS = (1.0, 0.01, 0.001, 0.056444)
"""Metres in one unit of length: m, cm, mm, and that of the CMU library (1/0.45 inch). A BVH file does not name it."""
CHANNELS = {f"{axis}{kind}": (kind, "XYZ".index(axis)) for axis in "XYZ" for kind in ("position", "rotation")}


@dataclass
class _Joint:
    name: str
    parent: int
    offset: list[float] = field(default_factory=lambda: [0.0, 0.0, 0.0])
    channels: list[tuple[str, int]] = field(default_factory=list)


class _Words:
    """The words of a file with their lines."""

    def __init__(self, text: str, name: str) -> None:
        self.name = name
        lines = text.replace("{", " { ").replace("}", " } ").splitlines()
        self.words = [(word, k) for k, line in enumerate(lines, 1) for word in line.split()]
        self.place = 0

    def next(self, expected: str = "") -> str:
        if self.place >= len(self.words):
            raise InputError(f"{self.name} ends where {expected or 'a word'} is expected")
        word = self.words[self.place][0]
        if expected and word.upper() != expected.upper():
            raise self.error(f"{word[:40]!r} stands where {expected} is expected")
        self.place += 1
        return word

    def number(self) -> float:
        word = self.next("")
        try:
            value = float(word)
        except ValueError:
            value = math.nan
        if not math.isfinite(value) or abs(value) > 1e6:
            self.place -= 1
            raise self.error(f"{word[:40]!r} must be a finite number")
        return value

    def error(self, sentence: str) -> InputError:
        line = self.words[min(self.place, len(self.words) - 1)][1] if self.words else 1
        return InputError(f"{self.name}:{line}: {sentence}")


def read_bvh(data: bytes, name: str, begin: float = 0.0) -> MotionRecording:
    """Return the person in a BVH file.

    The axes are found from the rest pose (all rotations 0), which must stand upright: hips beside each other, the head
    above. The unit of length is m, cm, mm or that of the CMU library, whichever gives legs closest to 0.85 m.

    Args:
        data: content of the file.
        name: name of the file for messages.
        begin: time in the file at which the trial begins [s].

    Raises:
        InputError: the file is not valid; the message names the line.
    """
    try:
        text = data.decode("utf-8-sig")
    except UnicodeDecodeError:
        raise InputError(f"{name} is not UTF-8 text") from None
    head, mark, motion = text.partition("MOTION")
    if not mark:
        raise InputError(f"{name} has no MOTION section")
    joints = _read_hierarchy(_Words(head, name))
    rows, period = _read_motion(motion, head.count("\n") + 1, sum(len(joint.channels) for joint in joints), name)
    return _recording(joints, rows, period, name, begin)


def _read_hierarchy(words: _Words) -> list[_Joint]:
    words.next("HIERARCHY")
    words.next("ROOT")
    joints: list[_Joint] = []
    open_joints = [_begin_joint(words, joints, words.next(), -1)]
    while open_joints:
        word = words.next().upper()
        joint = joints[open_joints[-1]]
        if word == "}":
            open_joints.pop()
        elif word == "OFFSET":
            joint.offset = [words.number() for _ in range(3)]
        elif word == "CHANNELS":
            joint.channels = [_channel(words) for _ in range(_channel_count(words))]
        elif word == "JOINT":
            open_joints.append(_begin_joint(words, joints, words.next(), open_joints[-1]))
        elif word == "END":
            words.next("Site")
            open_joints.append(_begin_joint(words, joints, f"{joint.name}End", open_joints[-1]))
        else:
            words.place -= 1
            raise words.error(f"{word[:40]!r} is unknown; known are OFFSET, CHANNELS, JOINT, End Site and }}")
    if words.place < len(words.words):
        raise words.error("only one ROOT is supported")
    return joints


def _begin_joint(words: _Words, joints: list[_Joint], name: str, parent: int) -> int:
    if len(joints) >= MOST_JOINTS:
        raise words.error(f"there are more than {MOST_JOINTS} joints")
    words.next("{")
    joints.append(_Joint(name, parent))
    return len(joints) - 1


def _channel_count(words: _Words) -> int:
    count = words.number()
    if count not in (0, 1, 2, 3, 4, 5, 6):
        raise words.error(f"a joint has {count:g} channels; at most 6 are possible")
    return int(count)


def _channel(words: _Words) -> tuple[str, int]:
    word = words.next()
    if word not in CHANNELS:
        words.place -= 1
        raise words.error(f"channel {word[:40]!r} is unknown; known are {', '.join(CHANNELS)}")
    return CHANNELS[word]


def _read_motion(text: str, first: int, width: int, name: str) -> tuple[Floats, float]:
    """Return the channels of all frames ``[T, C]`` and the time between two [s]."""
    lines = [(k, line.split()) for k, line in enumerate(text.splitlines(), first) if line.strip()]
    if len(lines) < 2 or lines[0][1][0] != "Frames:" or lines[1][1][:2] != ["Frame", "Time:"]:
        raise InputError(f"{name}:{first}: MOTION must begin with Frames: and Frame Time:")
    try:
        count, period = int(lines[0][1][1]), float(lines[1][1][2])
    except (ValueError, IndexError):
        raise InputError(f"{name}:{lines[0][0]}: Frames: and Frame Time: must be numbers") from None
    if not 1 <= count <= MOST_FRAMES or not 1e-5 <= period <= 10.0:
        raise InputError(f"{name}:{lines[0][0]}: {count} frames every {period:g} s are out of range")
    if len(lines) - 2 != count:
        raise InputError(f"{name} has {len(lines) - 2} frames instead of {count}")
    rows = np.empty((count, width))
    for k, (line, words) in enumerate(lines[2:]):
        if len(words) != width:
            raise InputError(f"{name}:{line}: a frame has {len(words)} numbers instead of {width}")
        try:
            rows[k] = [float(word) for word in words]
        except ValueError:
            rows[k] = math.nan
        if not np.all(np.abs(rows[k]) <= 1e6):
            raise InputError(f"{name}:{line}: a value of a frame must be a finite number")
    return rows, period


def _recording(joints: list[_Joint], rows: Floats, period: float, name: str, begin: float) -> MotionRecording:
    rest = np.zeros((len(joints), 3))
    for k, joint in enumerate(joints):
        rest[k] = joint.offset if joint.parent < 0 else rest[joint.parent] + joint.offset
    rest -= rest[0]
    names, parents = tuple(joint.name for joint in joints), tuple(joint.parent for joint in joints)
    try:
        axes = body_axes(names, parents, rest)
        upright = rest @ axes.T
        legs = SourceSkeleton(names, parents, upright * (1.9 / float(np.linalg.norm(np.ptp(rest, axis=0)))))
        length = legs.leg_length("l") / 1.9 * float(np.linalg.norm(np.ptp(rest, axis=0)))
        unit = min(UNITS, key=lambda one: abs(math.log(one * length / LEG)))
        feet = upright[[legs.roles["foot_l"], legs.roles["foot_r"]], 2].mean()
        upright = upright * unit
        upright[:, 2] -= min(float(upright[:, 2].min()), feet * unit - 0.03)
        skeleton = SourceSkeleton(names, parents, upright)
    except InputError as error:
        raise InputError(f"{name}: {error}") from None

    def sample(k: int) -> MotionSample:
        position, rotation = _pose(joints, rows[k])
        turned = axes @ rotation @ axes.T
        return MotionSample(k, k * period, position @ axes.T * unit, turned, skeleton)

    subject = RecordedSubject(np.arange(len(rows), dtype=np.float64) * np.float64(period), sample)
    return MotionRecording({joints[0].name: subject}, begin)


def _pose(joints: list[_Joint], row: Floats) -> tuple[Floats, Floats]:
    """Return positions and rotations of all joints in the axes and unit of the file, by forward kinematics."""
    position, rotation = np.empty((len(joints), 3)), np.empty((len(joints), 3, 3))
    column = 0
    for k, joint in enumerate(joints):
        own, shift = np.eye(3), np.array(joint.offset)
        for kind, axis in joint.channels:
            value = float(row[column])
            column += 1
            if kind == "position":
                shift[axis] = value
            else:
                own = own @ _turn(axis, math.radians(value))
        if joint.parent < 0:
            position[k], rotation[k] = shift, own
        else:
            above = rotation[joint.parent]
            position[k], rotation[k] = position[joint.parent] + above @ shift, above @ own
    return position, rotation


def _turn(axis: int, angle: float) -> Floats:
    i, j = (axis + 1) % 3, (axis + 2) % 3
    turn = np.eye(3)
    turn[i, i] = turn[j, j] = math.cos(angle)
    turn[i, j], turn[j, i] = -math.sin(angle), math.sin(angle)
    return turn


METRES = {"meters": 1.0, "centimeters": 0.01, "millimeters": 0.001}
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
    missing = [item for item in PLAIN if item not in header]
    if missing or len(set(header)) < len(header):
        raise InputError(f"{name}:1: {', '.join(missing) + ' is missing' if missing else 'a column is there twice'}")
    plain_rows: dict[str, list[Row]] = {}
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
        plain_rows.setdefault(subject, []).append((numbers["time"], position, _rotation(numbers, f"{name}:{line}")))
    if not plain_rows:
        raise InputError(f"{name} has no samples")
    return plain_rows


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
    unit = METRES.get(facts.get("Length Units", "").lower())
    if unit is None:
        raise InputError(f"{name}:1: Length Units must be one of {', '.join(METRES)}")
    first, bodies = _motive_columns(rows, name)
    found: dict[str, list[Row]] = {body.name: [] for body in bodies}
    for line, cells in enumerate(rows[first:], first + 1):
        if not any(cell.strip() for cell in cells):
            continue
        time = _number(cells[1] if len(cells) > 1 else "", f"{name}:{line}: time")
        for body in bodies:
            own = [cells[k].strip() if k < len(cells) else "" for k in body.columns]
            if not all(own):
                continue  # not tracked in this frame
            numbers = [_number(cell, f"{name}:{line}: {body.name}") for cell in own]
            unit_length = normalize(np.array([numbers[3], *numbers[:3]]))
            if unit_length is None:
                raise InputError(f"{name}:{line}: {body.name}: the length of a quaternion must be 1")
            rotation = FROM_Y_UP @ to_matrices(unit_length) @ FROM_Y_UP.T
            position = FROM_Y_UP @ np.array(numbers[4:]) * unit
            found[body.name].append((time, tuple(position.tolist()), rotation))
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
            columns = [
                _Columns(body, [own[key] for key in wanted]) for body, own in bodies.items() if set(wanted) <= set(own)
            ]
            if not columns:
                raise InputError(f"{name}:{k + 1}: there is no rigid body; export skeletons as BVH")
            return k + 1, columns
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


MOST_TEXT = 100_000
"""Longest text of an element that is read [characters]."""
COUNT = len(SEGMENTS)


def read_mvnx(data: bytes, name: str, begin: float = 0.0) -> MotionRecording:
    """Return the people in an MVNX file, called by the labels of their subjects.

    Positions and orientations of the 23 body segments are read. The frame of type ``identity`` gives the proportions.

    Args:
        data: content of the file.
        name: name of the file for messages.
        begin: time in the file at which the trial begins [s].

    Raises:
        InputError: the file is not valid; the message names the line.
    """
    reader = _Reader(name)
    try:
        reader.parser.Parse(data, True)
    except expat.ExpatError as error:
        reason = expat.errors.messages.get(error.code, "not well-formed")
        raise InputError(f"{name}:{error.lineno}: this is not well-formed XML: {reason}") from None
    except (ValueError, LookupError) as error:
        if isinstance(error, InputError):
            raise
        raise InputError(f"{name}: this is not well-formed XML: {error}") from None
    if not reader.subjects:
        raise InputError(f"{name} has no <subject> with frames")
    return MotionRecording({subject.label: subject.recorded(name) for subject in reader.subjects}, begin)


class _Subject:
    """The frames of one subject while the file is read."""

    def __init__(self, label: str) -> None:
        self.label = label
        self.times: list[float] = []
        self.positions: list[Floats] = []
        self.quaternions: list[Floats] = []
        self.identity: Floats | None = None

    def recorded(self, name: str) -> RecordedSubject:
        if not self.times:
            raise InputError(f"{name}: subject {self.label!r} has no frames of type normal")
        origins = None
        if self.identity is not None:
            origins = self.identity - np.array([*self.identity[0, :2], 0.0])
        try:
            leg = float(np.linalg.norm(np.diff(self.positions[0][[19, 20, 21]], axis=0), axis=1).sum())
            skeleton = xsens_skeleton(leg=leg) if origins is None else xsens_skeleton(origins)
        except InputError as error:
            raise InputError(f"{name}: subject {self.label!r}: {error}") from None

        def sample(k: int) -> MotionSample:
            return MotionSample(k, self.times[k], self.positions[k], to_matrices(self.quaternions[k]), skeleton)

        try:
            return RecordedSubject(np.array(self.times) - self.times[0], sample)
        except InputError as error:
            raise InputError(f"{name}: subject {self.label!r}: {error}") from None


class _Reader:
    """Reads elements as they come; only frames are kept."""

    def __init__(self, name: str) -> None:
        self.name = name
        self.subjects: list[_Subject] = []
        self.parser: Any = expat.ParserCreate()
        self.parser.StartElementHandler = self._start
        self.parser.EndElementHandler = self._end
        self.parser.CharacterDataHandler = self._take_text
        self.parser.StartDoctypeDeclHandler = self._reject
        self.parser.EntityDeclHandler = self._reject
        self._text: list[str] | None = None
        self._size = 0
        self._frame: dict[str, str] | None = None
        self._rows: dict[str, Floats] = {}

    def _error(self, sentence: str) -> InputError:
        return InputError(f"{self.name}:{self.parser.CurrentLineNumber}: {sentence}")

    def _reject(self, *_: Any) -> None:
        raise self._error("an MVNX file must not have a DOCTYPE or entities")

    def _start(self, tag: str, attributes: dict[str, str]) -> None:
        if tag == "subject":
            label = attributes.get("label", "")[:100] or str(len(self.subjects))
            if len(self.subjects) >= 16 or any(subject.label == label for subject in self.subjects):
                raise self._error(f"subject {label!r} is there twice, or there are more than 16")
            self.subjects.append(_Subject(label))
        elif tag == "frame" and self.subjects:
            self._frame, self._rows = attributes, {}
        elif tag in ("position", "orientation") and self._frame is not None:
            self._text, self._size = [], 0

    def _take_text(self, text: str) -> None:
        if self._text is not None:
            self._size += len(text)
            if self._size > MOST_TEXT:
                raise self._error(f"a text has more than {MOST_TEXT} characters")
            self._text.append(text)

    def _end(self, tag: str) -> None:
        if tag in ("position", "orientation") and self._text is not None:
            self._rows[tag] = self._numbers("".join(self._text), 3 if tag == "position" else 4)
            self._text = None
        elif tag == "frame" and self._frame is not None:
            self._take_frame(self._frame)
            self._frame = None

    def _numbers(self, text: str, width: int) -> Floats:
        try:
            values = np.array([float(word) for word in text.split()], dtype=np.float64)
        except ValueError:
            raise self._error("a frame has a word that is not a number") from None
        if len(values) < COUNT * width or len(values) % width:
            raise self._error(f"a frame has {len(values)} numbers instead of {COUNT * width}")
        if not np.all(np.abs(values) <= 1e4):
            raise self._error("a frame has a number that is not finite or out of range")
        return values.reshape(-1, width)[:COUNT]

    def _take_frame(self, attributes: dict[str, str]) -> None:
        kind, subject = attributes.get("type", "normal"), self.subjects[-1]
        if kind not in ("identity", "normal"):
            return
        if set(self._rows) != {"position", "orientation"}:
            raise self._error("a frame has no <position> and <orientation>; export both in MVN")
        if kind == "identity":
            subject.identity = self._rows["position"]
            return
        try:
            time = float(attributes.get("time", "nan")) / 1000.0
        except ValueError:
            time = math.nan
        if not math.isfinite(time):
            raise self._error("a frame has no time in milliseconds")
        unit = normalize(self._rows["orientation"])
        if unit is None:
            raise self._error("a frame has a quaternion whose length is not 1")
        if len(subject.times) >= MOST_FRAMES:
            raise self._error(f"there are more than {MOST_FRAMES} frames")
        subject.times.append(time)
        subject.positions.append(self._rows["position"])
        subject.quaternions.append(unit)
