"""EpisodeDigest: hash of an episode, record by record or for many environments at once."""

from __future__ import annotations

import dataclasses
import hashlib
import math
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import HASH_BLOCK, InputError, Pose, SpatialPose, StateError, hash_blocks, hash_start
from crowdbot.sensors import Reading, TrackedPeople
from crowdbot.typing import Bytes

from .mounted_sensor import SensorReadings
from .orders.order import Order, write_order
from .step_batch import BatchReadings, StepBatch
from .step_record import StepRecord

if TYPE_CHECKING:
    from crowdbot.world import BodyContactEvent, ContactForce, Fall

WAITING = 1 << 16
"""Bytes that wait for the next call of the kernel at most."""
SIZE = 16
"""Length of the digest [bytes]."""


class ResumableHash:
    """BLAKE2b with a digest of 16 bytes, as ``hashlib.blake2b(digest_size=16)``, that can be stored.

    >>> whole, half = ResumableHash(), ResumableHash()
    >>> whole.update(b"crowd and robot")
    >>> half.update(b"crowd and")
    >>> half = ResumableHash.of(half.state)
    >>> half.update(b" robot")
    >>> half.hexdigest() == whole.hexdigest()
    True
    """

    def __init__(self) -> None:
        self._words, self._length, self._rest = hash_start(SIZE), 0, bytearray()

    @classmethod
    def of(cls, state: Mapping[str, Any]) -> ResumableHash:
        """Continue from a stored state.

        Raises:
            InputError: the state is not that of a hash.
        """
        words, length, rest = (state.get(name) for name in ("words", "length", "rest"))
        fits = isinstance(words, np.ndarray) and words.dtype == np.uint64 and words.shape == (8,)
        fits = fits and isinstance(rest, np.ndarray) and rest.dtype == np.uint8 and rest.ndim == 1
        if not fits or not isinstance(length, int) or not 0 <= length < 2**62 or length % HASH_BLOCK:
            raise InputError("the state of a hash needs words [8], a length in whole blocks and the rest")
        resumable_hash = cls()
        assert words is not None
        assert rest is not None
        resumable_hash._words, resumable_hash._length, resumable_hash._rest = (
            words.copy(),
            length,
            bytearray(rest.tobytes()),
        )
        return resumable_hash

    @property
    def state(self) -> dict[str, Any]:
        """The state as arrays and numbers."""
        self._absorb()
        return {
            "words": self._words.copy(),
            "length": self._length,
            "rest": np.frombuffer(bytes(self._rest), dtype=np.uint8),
        }

    def update(self, data: bytes) -> None:
        """Add bytes."""
        self._rest += data
        if len(self._rest) > WAITING:
            self._absorb()

    def copy(self) -> ResumableHash:
        """Return an independent hash in the same state."""
        self._absorb()
        other = ResumableHash()
        other._words, other._length, other._rest = self._words.copy(), self._length, bytearray(self._rest)
        return other

    def hexdigest(self) -> str:
        """Return the hash of all bytes so far."""
        self._absorb()
        state, size = self._words.copy(), len(self._rest)
        block = np.frombuffer(bytes(self._rest).ljust(HASH_BLOCK, b"\0"), dtype="<u8").astype(np.uint64)
        hash_blocks(state, block, np.array([self._length + size], dtype=np.uint64), True)
        return state.astype("<u8").tobytes()[:SIZE].hex()

    def _absorb(self) -> None:
        """Add whole blocks to the state, without the last one, which may end the message."""
        count = max(0, (len(self._rest) - 1) // HASH_BLOCK)
        if count:
            words = np.frombuffer(bytes(self._rest[: count * HASH_BLOCK]), dtype="<u8").astype(np.uint64)
            length = self._length + HASH_BLOCK * np.arange(1, count + 1)
            hash_blocks(self._words, words, length.astype(np.uint64), False)
            del self._rest[: count * HASH_BLOCK]
            self._length += count * HASH_BLOCK


class EpisodeDigest:
    """Hash of an episode, updated while it runs.

    Args:
        state: a stored state to continue from, or empty for a new hash whose state can be stored; None: neither.

    Raises:
        InputError: the state is not that of a hash.
    """

    def __init__(self, state: Mapping[str, Any] | None = None) -> None:
        self._sum: Any = hashlib.blake2b(digest_size=16)
        if state is not None:
            self._sum = ResumableHash.of(state) if state else ResumableHash()

    @property
    def state(self) -> dict[str, Any]:
        """The state to continue from, as arrays and numbers.

        Raises:
            StateError: the hash was made without a state.
        """
        if not isinstance(self._sum, ResumableHash):
            raise StateError("the digest of this run cannot be stored")
        return self._sum.state

    def take(self, frame: StepRecord) -> None:
        """Add a record: all arrays of its readings, then of its scene if due, then forces."""
        for robot, mount, reading in frame.readings:
            self._sum.update(_reading_head(frame.nanoseconds, robot.name, mount.name))
            for name in _digested(type(reading)):
                self._sum.update(_bytes(getattr(reading, name)))
        if frame.due:
            self._sum.update(_frame_head(frame.nanoseconds))
            who = [] if np.array_equal(frame.ids, np.arange(len(frame.ids))) else [frame.ids]
            for array in (*who, *present(frame), frame.twists, frame.commands):
                self._sum.update(_bytes(array))
        self.add_rare(frame.nanoseconds, frame.forces, frame.orders, frame.collisions, frame.falls)

    def add(self, *parts: Any) -> None:
        """Add bytes."""
        for part in parts:
            self._sum.update(part)

    def add_rare(
        self,
        nanoseconds: int,
        forces: Sequence[ContactForce],
        orders: Sequence[Order],
        collisions: Sequence[BodyContactEvent],
        falls: Sequence[Fall],
    ) -> None:
        """Add forces, orders, contact events and falls of a record, after its scene; not who asked for an order."""
        for force in forces:
            self._sum.update(f"force {_contact_text(*force)}\n".encode())
        for order in orders:
            self._sum.update(f"order {nanoseconds} {write_order(dataclasses.replace(order, source=''))}\n".encode())
        for collision in collisions:
            self._sum.update(f"collision {_contact_text(*dataclasses.astuple(collision))}\n".encode())
        for fall in falls:
            self._sum.update(f"fall {dataclasses.astuple(fall)!r}\n".encode())

    def hexdigest(self, outcome: str) -> str:
        """Return the hash of all records so far and the outcome."""
        whole = self._sum.copy()
        whole.update(f"outcome {outcome}\n".encode())
        return str(whole.hexdigest())


def add_batch(digests: Sequence[EpisodeDigest], batch: StepBatch) -> None:
    """Add one time step of many environments to their digests, with the same bytes as :meth:`EpisodeDigest.take`.

    Args:
        digests: digest of each environment, by its number.
        batch: the records.
    """
    own = [digests[e] for e in batch.environments.tolist()]
    times = batch.nanoseconds.tolist()
    for readings in batch.readings:
        _add_readings(own, times, readings)
    _add_scenes(own, times, batch)
    for n in sorted({*batch.forces, *batch.orders, *batch.collisions, *batch.falls}):
        rare = (batch.forces, batch.orders, batch.collisions, batch.falls)
        parts: list[Any] = [part.get(n, ()) for part in rare]
        own[n].add_rare(times[n], *parts)


def _add_readings(own: Sequence[EpisodeDigest], times: Sequence[int], readings: BatchReadings) -> None:
    robot, mount, told, rows = readings
    whole = _rows_of_reading(told)
    head, before = b"", -1
    for k, n in enumerate(rows.tolist()):
        if n < 0:
            continue
        if times[n] != before:
            before = times[n]
            head = _reading_head(before, robot.name, mount.name)
        if whole is None:
            row = told.row(k)
            own[n].add(head, *(_bytes(getattr(row, field.name)) for field in dataclasses.fields(row)))
        else:
            own[n].add(head, *(part if isinstance(part, bytes) else part[k] for part in whole))


def _add_scenes(own: Sequence[EpisodeDigest], times: Sequence[int], batch: StepBatch) -> None:
    """Add the scenes that are due, together for environments with the same number of agents."""
    due = np.flatnonzero(batch.due)
    plain, slots = batch.plain_ids(), batch.slots[due]
    for count in np.unique(slots).tolist():
        rows = due[slots == count]
        here = batch.active[rows, :count]
        parts = (
            np.where(here[..., None], batch.position[rows, :count], 0.0),
            np.where(here[..., None], batch.velocity[rows, :count], 0.0),
            np.where(here, batch.heading[rows, :count], 0.0),
            here,
            batch.twists[rows],
            batch.commands[rows],
        )
        whole = np.concatenate([_byte_rows(part) for part in parts], axis=1)
        for k, n in enumerate(rows.tolist()):
            who = () if plain[n] else (np.ascontiguousarray(batch.ids[n, :count]),)
            own[n].add(_frame_head(times[n]), *who, whole[k])


def _rows_of_reading(told: SensorReadings) -> list[bytes | Bytes] | None:
    """Return the bytes of each field of readings: common to all rows, or ``[N, B]``; None if they need single rows."""
    reading, count = told.reading, len(told.environments)
    if count < 2 or type(reading).environment is not Reading.environment:
        return None
    if isinstance(reading, TrackedPeople) and not _in_order(told, reading.present.shape[1]):
        return None
    if isinstance(reading.time, np.ndarray) and reading.time.dtype != np.float64:
        return None
    rows_of_reading: list[bytes | Bytes] = []
    for name in _digested(type(reading)):
        value = getattr(reading, name)
        if name == "hit":
            value = _named_hits(value, told.ids)
        part = _bytes(value) if name in type(reading).shared_fields else _field_rows(value, count)
        if part is None:
            return None
        rows_of_reading.append(part)
    return rows_of_reading


def _in_order(told: SensorReadings, agents: int) -> bool:
    """Return whether all rows have the same number of agents, and their ids are their indices."""
    plain = bool(np.all(told.slots == agents))
    return plain and bool(np.all(told.ids[:, :agents] == np.arange(agents)))


def _named_hits(hit: Any, ids: NDArray[np.int64]) -> NDArray[np.int64] | None:
    """Return hits ``[N, ...]`` with ids instead of agent indices; None for others than whole numbers."""
    if not isinstance(hit, np.ndarray) or hit.dtype != np.int64 or hit.ndim < 2:
        return None
    rows = np.arange(len(hit)).reshape(-1, *[1] * (hit.ndim - 1))
    return np.where(hit >= 0, ids[rows, np.maximum(hit, 0)], hit)


def _field_rows(value: Any, count: int) -> bytes | Bytes | None:
    """Return the bytes of a field for all rows, ``[N, B]`` for each, or None if its rows are not known."""
    if isinstance(value, Pose):
        return np.concatenate([_byte_rows(value.position), _byte_rows(value.heading)], axis=1)
    if isinstance(value, SpatialPose):
        return np.concatenate([_byte_rows(value.position), _byte_rows(value.rotation)], axis=1)
    if isinstance(value, np.ndarray) and value.ndim and len(value) == count and not value.dtype.hasobject:
        return _byte_rows(value)
    return _bytes(value) if isinstance(value, float) else None


def _byte_rows(array: NDArray[Any]) -> Bytes:
    """Return the bytes of each row ``[N, B]``."""
    whole = np.ascontiguousarray(array)
    return whole.reshape(len(whole), math.prod(whole.shape[1:])).view(np.uint8)


def _digested(kind: type[Reading]) -> tuple[str, ...]:
    """Return the fields of a class of readings, but those that follow from others."""
    return tuple(field.name for field in dataclasses.fields(kind) if field.name not in kind.derived_fields)


def _reading_head(nanoseconds: int, robot: str, mount: str) -> bytes:
    return f"reading {nanoseconds} {robot}/{mount}\n".encode()


def _frame_head(nanoseconds: int) -> bytes:
    return f"frame {nanoseconds}\n".encode()


def present(frame: StepRecord) -> tuple[NDArray[Any], ...]:
    """Return position, velocity, heading and active of a record, E = 1; 0 for absent agents."""
    scene = frame.scene
    here = scene.active[0]
    return (
        np.where(here[:, None], scene.position[0], 0.0),
        np.where(here[:, None], scene.velocity[0], 0.0),
        np.where(here, scene.heading[0], 0.0),
        here.copy(),
    )


def _contact_text(first: tuple[str, int], second: tuple[str, int], *values: object) -> str:
    """Return what the digest takes of a contact: text without the names of classes, which may change."""
    bodies = [f"Party(kind={kind!r}, number={number!r})" for kind, number in (first, second)]
    return f"({', '.join([*bodies, *map(repr, values)])})"


def _bytes(value: Any) -> bytes:
    if isinstance(value, Pose):
        value = np.column_stack([value.position, value.heading])
    elif isinstance(value, SpatialPose):
        value = np.column_stack([value.position, value.rotation])
    elif dataclasses.is_dataclass(value):
        return b"".join(_bytes(getattr(value, field.name)) for field in dataclasses.fields(value))
    array = np.ascontiguousarray(value)
    return repr(value).encode() if array.dtype.hasobject else array.tobytes()
