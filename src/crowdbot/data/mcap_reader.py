"""Tape: MCAP files read from the front, so that a recording whose writer was killed opens too.

The readers of the ``mcap`` package begin with the summary at the end of a file. A run that is killed never gets to
write one, and its last record may be torn; here reading stops where whole records stop. The format: https://mcap.dev/spec
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import BinaryIO, NamedTuple

__all__ = ["MAGIC", "Heard", "Kind", "Tape", "TapeError", "Topic", "attachment", "is_whole"]

MAGIC = b"\x89MCAP0\r\n"
LARGEST = 1 << 30
"""No chunk may become larger than this [bytes]: a few bytes can pretend to hold any amount."""


class Kind:
    """Opcodes of records."""

    HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX = 1, 2, 3, 4, 5, 6, 7
    ATTACHMENT, METADATA, DATA_END = 9, 12, 15


class TapeError(ValueError):
    """The bytes are no MCAP file, or not those that were written."""


class Topic(NamedTuple):
    """A channel: its topic and the name and text of its message type."""

    topic: str
    kind: str
    text: str


class Heard(NamedTuple):
    """A message: its topic, when it was written [ns] and its bytes."""

    topic: Topic
    stamp: int
    data: bytes


@dataclass
class Tape:
    """Reads one stream from its beginning.

    Attributes:
        metadata: what the metadata records say, by their names; of two with one name the later.
        topics: by channel.
        end: where the whole records of the data end [bytes].
        ended: whether the end of the data was marked, so that nothing is torn.

    Raises:
        TapeError: this is no MCAP file, or it is damaged.
    """

    stream: BinaryIO
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    topics: dict[int, Topic] = field(default_factory=dict)
    end: int = 0
    ended: bool = False
    crc: int = 0
    schemas: dict[int, tuple[str, str]] = field(default_factory=dict)

    def messages(self) -> Iterator[Heard]:
        """Yield the messages in the order in which they were written."""
        for kind, _, body in self.records():
            if kind == Kind.CHUNK:
                yield from self._inside(body)
            elif kind == Kind.MESSAGE:
                yield self._message(body)

    def records(self) -> Iterator[tuple[int, int, bytes]]:
        """Yield opcode, place in the file [bytes] and content of every whole record of the data."""
        head = self.stream.read(len(MAGIC))
        if head != MAGIC:
            raise TapeError(f"it begins with {head!r}")
        self.crc, self.end = zlib.crc32(head), len(MAGIC)
        size = self.stream.seek(0, 2)
        self.stream.seek(self.end)
        while self.end + 9 <= size:
            lead = self.stream.read(9)
            kind, length = struct.unpack("<BQ", lead)
            if length > size - self.end - 9:
                break
            body = self.stream.read(length)
            if kind == Kind.DATA_END:
                self._finish(body)
                return
            if kind in (0, Kind.FOOTER):
                raise TapeError(f"there is no record at byte {self.end}")
            self.crc = zlib.crc32(body, zlib.crc32(lead, self.crc))
            self._learn(kind, body)
            yield kind, self.end, body
            self.end += 9 + length
        if is_whole(self.stream):
            raise TapeError(f"the data end at byte {self.end}, before the end of the file")

    def _finish(self, body: bytes) -> None:
        (crc,) = struct.unpack("<I", body)
        if crc not in (0, self.crc):
            raise TapeError("the checksum of the data is wrong")
        self.ended = True

    def _learn(self, kind: int, body: bytes) -> None:
        try:
            if kind == Kind.SCHEMA:
                (number,), place = struct.unpack_from("<H", body), 2
                name, place = _text(body, place)
                _, place = _text(body, place)
                self.schemas[number] = name, _text(body, place)[0]
            elif kind == Kind.CHANNEL:
                number, schema = struct.unpack_from("<HH", body)
                self.topics[number] = Topic(_text(body, 4)[0], *self.schemas.get(schema, ("", "")))
            elif kind == Kind.METADATA:
                name, place = _text(body, 0)
                self.metadata[name] = _pairs(body, place)
        except (struct.error, UnicodeDecodeError) as error:
            raise TapeError(f"the record at byte {self.end} is broken: {error}") from None

    def _inside(self, body: bytes) -> Iterator[Heard]:
        data = _unpacked(body)
        place = 0
        while place + 9 <= len(data):
            kind, length = struct.unpack_from("<BQ", data, place)
            record = data[place + 9 : place + 9 + length]
            if len(record) != length:
                raise TapeError(f"the chunk at byte {self.end} is broken")
            if kind == Kind.MESSAGE:
                yield self._message(record)
            else:
                self._learn(kind, record)
            place += 9 + length

    def _message(self, body: bytes) -> Heard:
        try:
            number, _, stamp, _ = struct.unpack_from("<HIQQ", body)
            return Heard(self.topics[number], stamp, body[22:])
        except (struct.error, KeyError):
            raise TapeError(f"the message at byte {self.end} is broken") from None


def attachment(body: bytes) -> tuple[str, bytes]:
    """Return name and content of an attachment record.

    Raises:
        TapeError: it is broken.
    """
    try:
        name, place = _text(body, 16)
        _, place = _text(body, place)
        (length,) = struct.unpack_from("<Q", body, place)
        (crc,) = struct.unpack_from("<I", body, place + 8 + length)
    except (struct.error, UnicodeDecodeError, OverflowError) as error:
        raise TapeError(f"an attachment is broken: {error}") from None
    if crc not in (0, zlib.crc32(body[:-4])):
        raise TapeError(f"the checksum of the attachment {name[:80]!r} is wrong")
    return name, body[place + 8 : place + 8 + length]


def is_whole(stream: BinaryIO) -> bool:
    """Return whether an MCAP file has its summary, as files have that were written to the end."""
    size = stream.seek(0, 2)
    stream.seek(max(0, size - 37))
    tail = stream.read()
    return len(tail) == 37 and tail.endswith(MAGIC) and tail[0] == Kind.FOOTER and tail[9:17] != bytes(8)


def _unpacked(body: bytes) -> bytes:
    """Return the records of a chunk."""
    try:
        _, _, size, crc = struct.unpack_from("<QQQI", body)
        how, place = _text(body, 28)
    except (struct.error, UnicodeDecodeError) as error:
        raise TapeError(f"a chunk is broken: {error}") from None
    packed = body[place + 8 :]
    if size > LARGEST:
        raise TapeError(f"a chunk pretends to hold {size} bytes")
    if how == "zstd":
        import zstandard

        try:
            packed = zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
        except zstandard.ZstdError as error:
            raise TapeError(f"a chunk is broken: {error}") from None
    elif how == "lz4":
        import lz4.frame

        packed = lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size)
    elif how:
        raise TapeError(f"a chunk is compressed by {how!r}, which is unknown")
    if len(packed) != size or (crc and zlib.crc32(packed) != crc):
        raise TapeError("the checksum of a chunk is wrong")
    return packed


def _text(body: bytes, place: int) -> tuple[str, int]:
    """Return the text at a place and where it ends."""
    (length,) = struct.unpack_from("<I", body, place)
    if place + 4 + length > len(body):
        raise struct.error("a text ends outside")
    return body[place + 4 : place + 4 + length].decode(), place + 4 + length


def _pairs(body: bytes, place: int) -> dict[str, str]:
    (length,) = struct.unpack_from("<I", body, place)
    place, pairs = place + 4, {}
    end = place + length
    while place < end:
        key, place = _text(body, place)
        pairs[key], place = _text(body, place)
    return pairs
