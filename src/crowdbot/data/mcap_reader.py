"""McapReader: reads MCAP files from the front, also if the writer was killed.

The readers of the ``mcap`` package need the summary at the end of a file. A killed run has no summary, and its last
record may be incomplete; this reader stops at the first incomplete record. Format: https://mcap.dev/spec
"""

from __future__ import annotations

import struct
import zlib
from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import BinaryIO, NamedTuple

MCAP_MAGIC = b"\x89MCAP0\r\n"
LARGEST = 1 << 30
"""Largest decompressed chunk [bytes]; a damaged header can claim any size."""


class McapOpcode:
    """Opcodes of records."""

    HEADER, FOOTER, SCHEMA, CHANNEL, MESSAGE, CHUNK, MESSAGE_INDEX = 1, 2, 3, 4, 5, 6, 7
    ATTACHMENT, METADATA, DATA_END = 9, 12, 15


class McapError(ValueError):
    """The bytes are not an MCAP file, or are damaged."""


class McapChannel(NamedTuple):
    """A channel: topic, and name and definition of its message type."""

    topic: str
    kind: str
    text: str


class McapMessage(NamedTuple):
    """A message: channel, log time [ns] and content."""

    topic: McapChannel
    stamp: int
    data: bytes


@dataclass
class McapReader:
    """Reads one MCAP stream from its beginning.

    Attributes:
        metadata: content of the metadata records by name; the last one wins.
        topics: channels by their number.
        end: end of the last complete record [bytes].
        ended: whether the data section is complete.

    Raises:
        McapError: the stream is not an MCAP file, or is damaged.
    """

    stream: BinaryIO
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)
    topics: dict[int, McapChannel] = field(default_factory=dict)
    end: int = 0
    ended: bool = False
    crc: int = 0
    schemas: dict[int, tuple[str, str]] = field(default_factory=dict)

    def messages(self) -> Iterator[McapMessage]:
        """Yield the messages in file order."""
        for kind, _, body in self.records():
            if kind == McapOpcode.CHUNK:
                yield from self._inside(body)
            elif kind == McapOpcode.MESSAGE:
                yield self._message(body)

    def records(self) -> Iterator[tuple[int, int, bytes]]:
        """Yield opcode, offset [bytes] and content of every complete record of the data section."""
        head = self.stream.read(len(MCAP_MAGIC))
        if head != MCAP_MAGIC:
            raise McapError(f"it begins with {head!r}")
        self.crc, self.end = zlib.crc32(head), len(MCAP_MAGIC)
        size = self.stream.seek(0, 2)
        self.stream.seek(self.end)
        while self.end + 9 <= size:
            lead = self.stream.read(9)
            kind, length = struct.unpack("<BQ", lead)
            if length > size - self.end - 9:
                break
            body = self.stream.read(length)
            if kind == McapOpcode.DATA_END:
                self._finish(body)
                return
            if kind in (0, McapOpcode.FOOTER):
                raise McapError(f"there is no record at byte {self.end}")
            self.crc = zlib.crc32(body, zlib.crc32(lead, self.crc))
            self._learn(kind, body)
            yield kind, self.end, body
            self.end += 9 + length
        if has_summary(self.stream):
            raise McapError(f"the data end at byte {self.end}, before the end of the file")

    def _finish(self, body: bytes) -> None:
        (crc,) = struct.unpack("<I", body)
        if crc not in (0, self.crc):
            raise McapError("the checksum of the data is wrong")
        self.ended = True

    def _learn(self, kind: int, body: bytes) -> None:
        try:
            if kind == McapOpcode.SCHEMA:
                (number,), place = struct.unpack_from("<H", body), 2
                name, place = _text(body, place)
                _, place = _text(body, place)
                self.schemas[number] = name, _text(body, place)[0]
            elif kind == McapOpcode.CHANNEL:
                number, schema = struct.unpack_from("<HH", body)
                self.topics[number] = McapChannel(_text(body, 4)[0], *self.schemas.get(schema, ("", "")))
            elif kind == McapOpcode.METADATA:
                name, place = _text(body, 0)
                self.metadata[name] = _pairs(body, place)
        except (struct.error, UnicodeDecodeError) as error:
            raise McapError(f"the record at byte {self.end} is broken: {error}") from None

    def _inside(self, body: bytes) -> Iterator[McapMessage]:
        data = _decompress(body)
        place = 0
        while place + 9 <= len(data):
            kind, length = struct.unpack_from("<BQ", data, place)
            record = data[place + 9 : place + 9 + length]
            if len(record) != length:
                raise McapError(f"the chunk at byte {self.end} is broken")
            if kind == McapOpcode.MESSAGE:
                yield self._message(record)
            else:
                self._learn(kind, record)
            place += 9 + length

    def _message(self, body: bytes) -> McapMessage:
        try:
            number, _, stamp, _ = struct.unpack_from("<HIQQ", body)
            return McapMessage(self.topics[number], stamp, body[22:])
        except (struct.error, KeyError):
            raise McapError(f"the message at byte {self.end} is broken") from None


def read_attachment(body: bytes) -> tuple[str, bytes]:
    """Return name and content of an attachment record.

    Raises:
        McapError: the record is damaged.
    """
    try:
        name, place = _text(body, 16)
        _, place = _text(body, place)
        (length,) = struct.unpack_from("<Q", body, place)
        (crc,) = struct.unpack_from("<I", body, place + 8 + length)
    except (struct.error, UnicodeDecodeError, OverflowError) as error:
        raise McapError(f"an attachment is broken: {error}") from None
    if crc not in (0, zlib.crc32(body[:-4])):
        raise McapError(f"the checksum of the attachment {name[:80]!r} is wrong")
    return name, body[place + 8 : place + 8 + length]


def has_summary(stream: BinaryIO) -> bool:
    """Return whether an MCAP file ends with a summary, as complete files do."""
    size = stream.seek(0, 2)
    stream.seek(max(0, size - 37))
    tail = stream.read()
    return len(tail) == 37 and tail.endswith(MCAP_MAGIC) and tail[0] == McapOpcode.FOOTER and tail[9:17] != bytes(8)


def _decompress(body: bytes) -> bytes:
    """Return the decompressed records of a chunk."""
    try:
        _, _, size, crc = struct.unpack_from("<QQQI", body)
        how, place = _text(body, 28)
    except (struct.error, UnicodeDecodeError) as error:
        raise McapError(f"a chunk is broken: {error}") from None
    packed = body[place + 8 :]
    if size > LARGEST:
        raise McapError(f"a chunk pretends to hold {size} bytes")
    if how == "zstd":
        import zstandard

        try:
            packed = zstandard.ZstdDecompressor().decompress(packed, max_output_size=size)
        except zstandard.ZstdError as error:
            raise McapError(f"a chunk is broken: {error}") from None
    elif how == "lz4":
        import lz4.frame

        packed = lz4.frame.LZ4FrameDecompressor().decompress(packed, max_length=size)
    elif how:
        raise McapError(f"a chunk is compressed by {how!r}, which is unknown")
    if len(packed) != size or (crc and zlib.crc32(packed) != crc):
        raise McapError("the checksum of a chunk is wrong")
    return packed


def _text(body: bytes, place: int) -> tuple[str, int]:
    """Return the string at an offset, and the offset after it."""
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
