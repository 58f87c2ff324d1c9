"""MVNX files: recordings of Xsens MVN in XML."""

from __future__ import annotations

import math
from typing import Any
from xml.parsers import expat

import numpy as np

from crowdbot.core import InputError
from crowdbot.typing import Floats

from .motion_recording import MOST_FRAMES, MotionRecording, RecordedSubject
from .pose_stream import MotionSample
from .rotations import normalize, to_matrices
from .xsens_segments import SEGMENTS, xsens_skeleton

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
    return MotionRecording({one.label: one.recorded(name) for one in reader.subjects}, begin)


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
            if len(self.subjects) >= 16 or any(one.label == label for one in self.subjects):
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
