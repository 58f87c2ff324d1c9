"""Copies of episode files without some of their topics or with other metadata."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from pathlib import Path

from mcap.reader import make_reader
from mcap.writer import Writer

__all__ = ["copy_episode"]


def copy_episode(
    source: Path,
    target: Path,
    changes: Mapping[str, str | None] | None = None,
    without: Sequence[str] = (),
    bytes_of: Callable[[str, bytes], bytes] = lambda topic, data: data,
) -> Path:
    """Copy an episode.

    Args:
        source, target: files.
        changes: new values of metadata; None removes an entry.
        without: topics to leave out.
        bytes_of: new content of a message, from its topic and its content.
    """
    with source.open("rb") as old, target.open("wb") as new:
        reader, writer = make_reader(old), Writer(new)
        writer.start(profile="ros2")
        channels: dict[int, int] = {}
        for schema, channel, message in reader.iter_messages(log_time_order=False):
            assert schema is not None
            if channel.topic in without:
                continue
            if channel.id not in channels:
                number = writer.register_schema(schema.name, schema.encoding, schema.data)
                channels[channel.id] = writer.register_channel(channel.topic, "cdr", number)
            data = bytes_of(channel.topic, message.data)
            writer.add_message(channels[channel.id], message.log_time, data, message.publish_time)
        for record in reader.iter_metadata():
            known = record.metadata | {key: value for key, value in (changes or {}).items() if key in record.metadata}
            writer.add_metadata(record.name, {key: value for key, value in known.items() if value is not None})
        writer.finish()
    return target
