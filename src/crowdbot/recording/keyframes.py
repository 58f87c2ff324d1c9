"""Keyframes: the complete state of a run every 5 s in its episode file, so that branches need not begin at 0 s.

A keyframe is an attachment of the file with the media type :data:`MEDIA`: the state of the simulation after the record
of its step, and the state of the digest. Keyframes do not change the digest of an episode.
"""

from __future__ import annotations

import struct
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, BinaryIO

from crowdbot.core import EpisodeError, InputError
from crowdbot.data import MCAP_MAGIC, McapError, McapOpcode, read_attachment
from crowdbot.simulation import (
    KEYFRAMES,
    EpisodeDigest,
    Simulation,
    StateError,
    StepRecord,
    decode_state,
    encode_state,
    restore_state,
    state_of,
)

from .metadata import versions

MEDIA = "application/x-crowdbot-keyframe"
"""Media type of the attachments."""
LARGEST = 1 << 27
"""Largest keyframe in a file [bytes]."""
HEAD = 256
"""Bytes at the begin of an attachment that contain its name and its media type."""


class KeyframeWarning(UserWarning):
    """A keyframe cannot be used; the episode is simulated from its beginning."""


class KeyframeTrack:
    """Makes the keyframes of a run that is recorded.

    Args:
        simulation: the simulation of the run; None: no keyframes.
        digest: digest of the run, which contains each step before its keyframe.

    Attributes:
        reason: why there are no keyframes, empty if there are.
    """

    def __init__(self, simulation: Simulation | None, digest: EpisodeDigest) -> None:
        self.simulation, self.digest, self.reason = simulation, digest, ""
        begin = 0 if simulation is None else simulation.world.clock.step_ns * simulation.tick
        self._next = begin - begin % _PERIOD + _PERIOD

    def take(self, frame: StepRecord) -> bytes | None:
        """Return the keyframe after this record, None if none is due."""
        simulation = self.simulation
        if simulation is None or self.reason or not frame.due or frame.nanoseconds < self._next:
            return None
        if simulation.count > 1 or simulation.outcome() is not None:
            return None
        self._next = frame.nanoseconds - frame.nanoseconds % _PERIOD + _PERIOD
        try:
            state = state_of(simulation)
            return encode_state(state | {f"digest/{name}": value for name, value in self.digest.state.items()})
        except (StateError, RecursionError, ValueError) as error:  # memories of users can be anything
            self.reason = str(error)
            return None


_PERIOD = round(KEYFRAMES * 1e9)


@dataclass(frozen=True)
class Keyframe:
    """A keyframe of an episode.

    Fields:
        tick: step of the run.
        state: the state by path.
    """

    tick: int
    state: Mapping[str, Any]

    @property
    def digest(self) -> EpisodeDigest:
        """The digest up to this step.

        Raises:
            InputError: the stored state is damaged.
        """
        parts = {path.removeprefix("digest/"): value for path, value in self.state.items() if _is_digest(path)}
        return EpisodeDigest(parts)

    def restore(self, simulation: Simulation) -> None:
        """Continue a new simulation of the trial from this step.

        Raises:
            InputError: the state does not belong to the trial, or is damaged.
        """
        restore_state(simulation, {path: value for path, value in self.state.items() if not _is_digest(path)})
        if simulation.tick != self.tick:
            raise InputError(f"the keyframe of step {self.tick} holds step {simulation.tick}")


def latest_keyframe(
    path: Path,
    known: Mapping[str, str],
    tick: int,
    wanted: Mapping[int, str],
    places: Mapping[int, tuple[int, int]] | None = None,
) -> Keyframe | None:
    """Return the latest keyframe up to a step; None without one, or if the episode was made with other versions.

    Args:
        path: the episode.
        known: its metadata.
        tick: the step.
        wanted: the recorded digests by time [ns].
        places: from :func:`keyframe_ticks`, if known.

    Raises:
        EpisodeError: the file cannot be read.
        InputError: the keyframe is damaged.
    """
    if any(known.get(name) != now for name, now in versions().items()):
        return None
    places = keyframe_ticks(path) if places is None else places
    ticks = [place for place in places if place <= tick]
    if not ticks:
        return None
    keyframe = Keyframe(max(ticks), decode_state(_read(path, *places[max(ticks)])))
    recorded = wanted.get(keyframe.tick * int(known["step_ns"]), "")
    if recorded != keyframe.digest.hexdigest("interrupted"):
        raise InputError(f"the keyframe of step {keyframe.tick} differs from the digest of its step")
    return keyframe


def keyframe_ticks(path: Path) -> dict[int, tuple[int, int]]:
    """Return offset and length [bytes] of each keyframe of an episode file by its step.

    Raises:
        EpisodeError: the file cannot be read.
    """
    try:
        with path.open("rb") as stream:
            return _places(stream)
    except OSError as error:
        raise EpisodeError(f"cannot read {path}: {error.strerror}") from None


def _places(stream: BinaryIO) -> dict[int, tuple[int, int]]:
    """Return the places of keyframes, without reading other records."""
    places: dict[int, tuple[int, int]] = {}
    place, size = len(MCAP_MAGIC), stream.seek(0, 2)
    while place + 9 <= size:
        stream.seek(place)
        kind, length = struct.unpack("<BQ", stream.read(9))
        if kind in (0, McapOpcode.DATA_END, McapOpcode.FOOTER) or length > size - place - 9:
            break
        if kind == McapOpcode.ATTACHMENT:
            tick = _tick(stream.read(min(length, HEAD)))
            if tick is not None:
                places[tick] = (place + 9, length)
        place += 9 + length
    return places


def _tick(head: bytes) -> int | None:
    """Return the step of a keyframe from the begin of its attachment, None for another attachment."""
    try:
        (length,) = struct.unpack_from("<I", head, 16)
        name = head[20 : 20 + length].decode()
        (size,) = struct.unpack_from("<I", head, 20 + length)
        media = head[24 + length : 24 + length + size].decode()
    except (struct.error, UnicodeDecodeError):
        return None
    number = name.removeprefix("keyframe/")
    return int(number) if media == MEDIA and number.isascii() and number.isdigit() and len(number) < 19 else None


def _read(path: Path, place: int, length: int) -> bytes:
    if length > LARGEST:
        raise StateError(f"a keyframe has {length} bytes; at most {LARGEST} are read")
    with path.open("rb") as stream:
        stream.seek(place)
        try:
            return read_attachment(stream.read(length))[1]
        except McapError as error:
            raise StateError(str(error)) from None


def _is_digest(path: str) -> bool:
    return path.startswith("digest/")
