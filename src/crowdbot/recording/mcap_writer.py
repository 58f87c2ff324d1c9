"""McapWriter: writes MCAP files that are valid after every write, even if the process is killed.

Messages are collected in a chunk. Each write replaces the file footer by the chunk, its index and a new footer without
a summary. The file can therefore always be opened; only the current chunk can be lost. A finished file has the summary
and the indexes for fast access. All messages stand in the order of their times, which rosbags needs in a file without
a summary.
"""

from __future__ import annotations

import os
import struct
import zlib
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from mcap.data_stream import RecordBuilder
from mcap.opcode import Opcode
from mcap.records import (
    Attachment,
    AttachmentIndex,
    Channel,
    ChunkIndex,
    DataEnd,
    Footer,
    Header,
    McapRecord,
    Metadata,
    MetadataIndex,
    Schema,
    Statistics,
    SummaryOffset,
)

from crowdbot.data import MCAP_MAGIC, McapOpcode, McapReader, read_attachment

LARGE = 4 << 20
"""Maximum size of a chunk [bytes]."""


def _bytes(*records: McapRecord) -> bytes:
    builder = RecordBuilder()
    for record in records:
        record.write(builder)
    return bytes(builder.end())  # type: ignore[no-untyped-call]


@dataclass
class _Chunk:
    """Messages that are not yet written, and their times [ns] and offsets [bytes] by channel."""

    data: bytearray = field(default_factory=bytearray)
    index: dict[int, list[tuple[int, int]]] = field(default_factory=dict)

    def take(self) -> bytes:
        """Return the chunk with its index as records, and begin a new one."""
        if not self.data:
            return b""
        import zstandard

        raw = bytes(self.data)
        packed = zstandard.compress(raw)
        stamps = [stamp for rows in self.index.values() for stamp, _ in rows]
        head = struct.pack("<QQQII", min(stamps), max(stamps), len(raw), zlib.crc32(raw), 4)
        body = head + b"zstd" + struct.pack("<Q", len(packed)) + packed
        parts = [struct.pack("<BQ", McapOpcode.CHUNK, len(body)), body]
        parts += [_index_record(channel, rows) for channel, rows in self.index.items()]
        self.data, self.index = bytearray(), {}
        return b"".join(parts)


def _index_record(channel: int, rows: list[tuple[int, int]]) -> bytes:
    index = struct.pack("<HI", channel, 16 * len(rows)) + b"".join(struct.pack("<QQ", *row) for row in rows)
    return struct.pack("<BQ", McapOpcode.MESSAGE_INDEX, len(index)) + index


SHORT_END = _bytes(DataEnd(0), Footer(0, 0, 0)) + MCAP_MAGIC


class McapWriter:
    """Writes an MCAP file, created or replaced at the first :meth:`flush`.

    Args:
        path: the file; its folder must exist.
        profile, library: fields of the header.
    """

    def __init__(self, path: Path, profile: str, library: str) -> None:
        self.path = path
        self.draft = path.with_name(f".{path.name}.{os.getpid()}.part")
        self.stream: BinaryIO | None = None
        self.end = 0
        self._before = MCAP_MAGIC + _bytes(Header(profile, library))
        self._chunk = _Chunk()
        self._schemas: dict[str, int] = {}
        self._channels = 0

    def schema(self, name: str, text: str) -> int:
        """Return the id of a message type."""
        if name not in self._schemas:
            self._schemas[name] = len(self._schemas) + 1
            self._before += _bytes(Schema(self._schemas[name], text.encode(), "ros2msg", name))
        return self._schemas[name]

    def channel(self, topic: str, schema: int, quality: str = "") -> int:
        """Return the id of a new channel; ``quality`` is the quality of service in ROS 2 (YAML, as in rosbag2)."""
        self._channels += 1
        self._before += _bytes(Channel(self._channels, topic, "cdr", {"offered_qos_profiles": quality}, schema))
        return self._channels

    def attachment(self, name: str, data: bytes, media: str = "application/octet-stream", nanoseconds: int = 0) -> None:
        """Add an attachment; its times are simulated time, for reproducible content."""
        self._before += _bytes(Attachment(nanoseconds, nanoseconds, name, media, data))

    def metadata(self, name: str, values: Mapping[str, str]) -> None:
        """Add a metadata record."""
        self._before += _bytes(Metadata(name, dict(values)))

    def message(self, channel: int, nanoseconds: int, data: bytes) -> None:
        """Add a message."""
        chunk = self._chunk
        chunk.index.setdefault(channel, []).append((nanoseconds, len(chunk.data)))
        chunk.data += struct.pack("<BQHIQQ", McapOpcode.MESSAGE, 22 + len(data), channel, 0, nanoseconds, nanoseconds)
        chunk.data += data

    @property
    def large(self) -> bool:
        """Whether the current chunk is large enough to be written early."""
        return len(self._chunk.data) > LARGE

    def flush(self) -> None:
        """Write all pending data."""
        data = self._before + self._chunk.take()
        self._before = b""
        if data:
            self._put(data + SHORT_END)
            self.end += len(data)

    def close(self, finished: bool) -> None:
        """Close the file. If ``finished``, write the summary; otherwise leave it incomplete."""
        stream, self.stream = self.stream, None
        if stream is not None:
            with stream:
                if finished:
                    finish(stream)

    def _put(self, data: bytes) -> None:
        if self.stream is not None:
            self.stream.seek(self.end)
            _write(self.stream, data)
            return
        stream = self.draft.open("w+b", buffering=0)
        try:
            _write(stream, data)
            stream.close()  # Windows cannot rename an open file
            os.replace(self.draft, self.path)
        except BaseException:
            stream.close()
            self.draft.unlink(missing_ok=True)
            raise
        self.stream = self.path.open("r+b", buffering=0)


@dataclass
class _Layout:
    """Positions of records in a file."""

    records: dict[int, dict[int, bytes]] = field(
        default_factory=lambda: {McapOpcode.SCHEMA: {}, McapOpcode.CHANNEL: {}}
    )
    chunks: list[ChunkIndex] = field(default_factory=list)
    metadata: list[MetadataIndex] = field(default_factory=list)
    attachments: list[AttachmentIndex] = field(default_factory=list)
    counts: dict[int, int] = field(default_factory=dict)

    def take(self, kind: int, place: int, body: bytes) -> None:
        """Add a record."""
        if kind in self.records:
            (number,) = struct.unpack_from("<H", body)
            self.records[kind][number] = struct.pack("<BQ", kind, len(body)) + body
        elif kind == McapOpcode.METADATA:
            length = int.from_bytes(body[:4], "little")
            self.metadata.append(MetadataIndex(place, 9 + len(body), body[4 : 4 + length].decode()))
        elif kind == McapOpcode.ATTACHMENT:
            name, data = read_attachment(body)
            media = len(body) - len(data) - len(name.encode()) - 36
            how = body[24 + len(name.encode()) :][:media].decode()
            log, create = struct.unpack_from("<QQ", body)
            self.attachments.append(AttachmentIndex(place, 9 + len(body), create, log, len(data), name, how))
        elif kind == McapOpcode.CHUNK:
            start, end, size, _, word = struct.unpack_from("<QQQII", body)
            how = body[32 : 32 + word].decode()
            self.chunks.append(ChunkIndex(9 + len(body), place, how, len(body) - 40 - word, end, 0, {}, start, size))
        elif kind == McapOpcode.MESSAGE_INDEX and self.chunks:
            channel, length = struct.unpack_from("<HI", body)
            self.counts[channel] = self.counts.get(channel, 0) + length // 16
            self.chunks[-1].message_index_offsets[channel] = place
            self.chunks[-1].message_index_length += 9 + len(body)

    @property
    def statistics(self) -> Statistics:
        """Statistics of the file."""
        return Statistics(
            attachment_count=len(self.attachments),
            channel_count=len(self.records[McapOpcode.CHANNEL]),
            channel_message_counts=dict(sorted(self.counts.items())),
            chunk_count=len(self.chunks),
            message_count=sum(self.counts.values()),
            message_end_time=max((chunk.message_end_time for chunk in self.chunks), default=0),
            message_start_time=min((chunk.message_start_time for chunk in self.chunks), default=0),
            metadata_count=len(self.metadata),
            schema_count=len(self.records[McapOpcode.SCHEMA]),
        )


def finish(stream: BinaryIO, more: Mapping[str, Mapping[str, str]] | None = None) -> None:
    """Write the summary of a file of :class:`McapWriter`, replacing an incomplete or missing end.

    Args:
        stream: open for reading and writing.
        more: metadata records to add, by name.

    Raises:
        McapError: the file is damaged.
    """
    tape, layout = McapReader(stream), _Layout()
    stream.seek(0)
    for kind, place, body in tape.records():
        layout.take(kind, place, body)
    end, crc = tape.end, tape.crc
    added = b"" if tape.ended else _missing_index(stream, layout, end)
    for name, values in (more or {}).items():
        record = _bytes(Metadata(name, dict(values)))
        layout.take(McapOpcode.METADATA, end + len(added), record[9:])
        added += record
    added += _bytes(DataEnd(zlib.crc32(added, crc)))
    stream.seek(end)
    _write(stream, added + _summary(layout, end + len(added)))
    stream.truncate()
    stream.flush()
    os.fsync(stream.fileno())


def _missing_index(stream: BinaryIO, layout: _Layout, end: int) -> bytes:
    """Return the index records of the last chunk that a killed writer has not written, to be put at ``end``."""
    rows: dict[int, list[tuple[int, int]]] = {}
    stream.seek(0)
    for message in McapReader(stream).messages():
        if layout.chunks and message.place.record.start == layout.chunks[-1].chunk_start_offset:
            rows.setdefault(message.place.channel, []).append((message.stamp, message.place.offset))
    added = b""
    for channel in [row for row in rows if row not in layout.chunks[-1].message_index_offsets]:
        record = _index_record(channel, rows[channel])
        layout.take(McapOpcode.MESSAGE_INDEX, end + len(added), record[9:])
        added += record
    return added


def _summary(layout: _Layout, start: int) -> bytes:
    """Return the content after the data, which end at ``start``."""
    groups = {
        Opcode.SCHEMA: b"".join(layout.records[McapOpcode.SCHEMA].values()),
        Opcode.CHANNEL: b"".join(layout.records[McapOpcode.CHANNEL].values()),
        Opcode.STATISTICS: _bytes(layout.statistics),
        Opcode.CHUNK_INDEX: _bytes(*layout.chunks),
        Opcode.ATTACHMENT_INDEX: _bytes(*layout.attachments),
        Opcode.METADATA_INDEX: _bytes(*layout.metadata),
    }
    summary, offsets = b"", b""
    for kind, records in groups.items():
        if records:
            offsets += _bytes(SummaryOffset(kind, start + len(summary), len(records)))
            summary += records
    footer = struct.pack("<BQQQ", McapOpcode.FOOTER, 20, start, start + len(summary))
    crc = zlib.crc32(summary + offsets + footer)
    return summary + offsets + footer + struct.pack("<I", crc) + MCAP_MAGIC


def _write(stream: BinaryIO, data: bytes) -> None:
    """Write all data; an unbuffered stream may write only a part."""
    rest = memoryview(data)
    while rest:
        rest = rest[stream.write(rest) :]
