"""McapReader: reads MCAP files from the front, also if the writer was killed.

The readers of the ``mcap`` package need the summary at the end of a file. A killed run has no summary, and its last
record may be incomplete; this reader stops at the first incomplete record. Format: https://mcap.dev/spec
"""

from __future__ import annotations

import functools
import struct
import zlib
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO, NamedTuple

MCAP_MAGIC = b"\x89MCAP0\r\n"
LARGEST = 1 << 30
"""Largest decompressed chunk [bytes]; a damaged header can claim any size."""
HEAD = 28
"""Bytes at the start of a chunk: its first and last time, size and checksum."""
KEPT = 1 << 26
"""Largest decompressed chunk [bytes] that :func:`read_message` keeps for the next message; it keeps four."""


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


class McapRecord(NamedTuple):
    """Place of a chunk, or of a message outside of chunks: offset and length [bytes], opcode, and its first bytes."""

    start: int
    length: int
    kind: int
    head: bytes

    @property
    def begin(self) -> int:
        """First log time [ns]."""
        return int(struct.unpack_from("<Q", self.head, 0 if self.kind == McapOpcode.CHUNK else 6)[0])


class McapPlace(NamedTuple):
    """Place of a message: its record, offset in the content of that [bytes], number of the channel, log time [ns]."""

    record: McapRecord
    offset: int
    channel: int
    stamp: int


class McapMessage(NamedTuple):
    """A message: channel, log time [ns], content (empty if it is read later, by :func:`read_message`), and place."""

    topic: McapChannel
    stamp: int
    data: bytes
    place: McapPlace


Later = Callable[[McapChannel], bool]
"""Whether the contents of the messages of a channel are read later."""


def _at_once(channel: McapChannel) -> bool:
    return False


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

    def messages(self, later: Later = _at_once) -> Iterator[McapMessage]:
        """Yield the messages in file order.

        A chunk of which all messages are read later is not decompressed: its index tells them. An index counts if
        another record follows it; a killed writer may have left a part of it.

        Args:
            later: whether the messages of a channel have no content here, but are read by :func:`read_message`.
        """
        chunk: tuple[int, bytes] | None = None
        index: list[bytes] = []
        for kind, place, body in self.records():
            if kind == McapOpcode.MESSAGE_INDEX:
                index.append(body)
                continue
            if chunk is not None:
                yield from self._inside(*chunk, index, later)
            chunk, index = None, []
            if kind == McapOpcode.CHUNK:
                chunk = place, body
            elif kind == McapOpcode.MESSAGE:
                yield self._message(McapRecord(place, len(body), kind, body[:HEAD]), 0, body, later)
        if chunk is not None:
            yield from self._inside(*chunk, index if self.ended else [], later)

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

    def _inside(self, start: int, body: bytes, index: list[bytes], later: Later) -> Iterator[McapMessage]:
        record = McapRecord(start, len(body), McapOpcode.CHUNK, body[:HEAD])
        if index and len(record.head) == HEAD and (places := self._indexed(record, index, later)) is not None:
            for place in places:
                yield McapMessage(self.topics[place.channel], place.stamp, b"", place)
            return
        data = _decompress(body)
        offset = 0
        while offset + 9 <= len(data):
            kind, length = struct.unpack_from("<BQ", data, offset)
            if offset + 9 + length > len(data):
                raise McapError(f"the chunk at byte {start} is broken")
            if kind == McapOpcode.MESSAGE:
                yield self._message(record, offset, memoryview(data)[offset + 9 : offset + 9 + length], later)
            else:
                self._learn(kind, data[offset + 9 : offset + 9 + length])
            offset += 9 + length

    def _indexed(self, record: McapRecord, index: list[bytes], later: Later) -> list[McapPlace] | None:
        """Return the messages of a chunk in their order, from its index; None if some are not read later."""
        found: list[tuple[int, int, int]] = []
        for body in index:
            try:
                number, length = struct.unpack_from("<HI", body)
                if number not in self.topics or not later(self.topics[number]) or length != len(body) - 6:
                    return None
                found += [(offset, number, stamp) for stamp, offset in struct.iter_unpack("<QQ", body[6:])]
            except struct.error:
                return None
        return [McapPlace(record, offset, number, stamp) for offset, number, stamp in sorted(found)]

    def _message(self, record: McapRecord, offset: int, body: bytes | memoryview, later: Later) -> McapMessage:
        try:
            number, _, stamp, _ = struct.unpack_from("<HIQQ", body)
            topic = self.topics[number]
        except (struct.error, KeyError):
            raise McapError(f"the message at byte {record.start} is broken") from None
        data = b"" if later(topic) else bytes(body[22:])
        return McapMessage(topic, stamp, data, McapPlace(record, offset, number, stamp))


def read_message(path: Path, place: McapPlace) -> bytes:
    """Return the content of a message.

    Raises:
        McapError: the chunk is damaged, or the file is not the one in which the message was found.
        OSError: the file cannot be read.
    """
    record = place.record
    size = struct.unpack_from("<Q", record.head, 16)[0] if record.kind == McapOpcode.CHUNK else record.length
    data = (_content if size <= KEPT else _content.__wrapped__)(path, record)
    lead = struct.Struct("<BQHIQQ")
    if 0 <= place.offset <= len(data) - lead.size:
        kind, length, number, _, stamp, _ = lead.unpack_from(data, place.offset)
        end = place.offset + 9 + length
        if (kind, number, stamp) == (McapOpcode.MESSAGE, place.channel, place.stamp) and end <= len(data):
            return data[place.offset + lead.size : end]
    raise McapError(f"the index of the chunk at byte {record.start} is wrong")


@functools.lru_cache(maxsize=4)
def _content(path: Path, record: McapRecord) -> bytes:
    """Return the content of a chunk, or the record of a message outside of chunks."""
    with path.open("rb") as stream:
        stream.seek(record.start)
        lead, body = stream.read(9), stream.read(record.length)
    if lead != struct.pack("<BQ", record.kind, record.length) or body[:HEAD] != record.head:
        raise McapError("it has changed since it was opened")
    return _decompress(body) if record.kind == McapOpcode.CHUNK else lead + body


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
