"""Bags: messages of ROS recordings in their three storages, MCAP and SQLite of ROS 2, and the format of ROS 1."""

from __future__ import annotations

import contextlib
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crowdbot.core import DataError
from crowdbot.data.mcap_reader import McapChannel, McapError, McapReader, has_summary
from crowdbot.data.source import Source, parse_errors

Wanted = Callable[[str, str], bool]
"""Whether the messages of a topic and a type are read."""
Receive = Callable[[str, str, Callable[[], Any]], None]
"""Takes topic, type, and a function that decodes the message."""

METADATA = "crowdbot"
"""Name of the metadata record of recorded trials."""
PEOPLE_DEFINITIONS = {
    "people_msgs/msg/Person": "string name\ngeometry_msgs/Point position\ngeometry_msgs/Point velocity\n"
    "float64 reliability\nstring[] tagnames\nstring[] tags\n",
    "people_msgs/msg/People": "std_msgs/Header header\npeople_msgs/Person[] people\n",
}
"""Types of older SQLite bags, which contain no definitions."""


@dataclass
class Bag:
    """What a bag contains besides its messages: its topics with their types, and its metadata records."""

    topics: dict[str, str] = field(default_factory=dict)
    metadata: dict[str, dict[str, str]] = field(default_factory=dict)


def read_bag(source: Source, wanted: Wanted, receive: Receive) -> Bag:
    """Read the wanted messages of a bag in their order.

    Raises:
        McapError: the MCAP file is damaged.
        DataError: the SQLite file is no bag.
    """
    return STORAGES[source.kind](source, wanted, receive)


def read_bag_messages(path: Path | str, wanted: Wanted, receive: Receive) -> Bag:
    """Read the wanted messages of a bag in their order, see :func:`read_bag`.

    Args:
        path: the file, of MCAP or SQLite (ROS 2), or of ROS 1.
        wanted: whether the messages of a topic and a type are read.
        receive: takes topic, type, and a function that decodes the message.

    Raises:
        DataError: the file is missing, no bag, or damaged.
    """
    source = Source.of(Path(path))
    if source.kind not in STORAGES:
        raise DataError(f"{path} is no bag: it must be MCAP or SQLite of ROS 2, or a bag of ROS 1")
    with parse_errors(source, "a bag"):
        return read_bag(source, wanted, receive)


def _read_mcap(source: Source, wanted: Wanted, receive: Receive) -> Bag:
    """Read an MCAP file, also one without an end."""
    types, bag, chosen = _Types(), Bag(), dict[McapChannel, bool]()
    with source.path.open("rb") as file:
        reader = McapReader(file)
        for channel, _, data, _ in reader.messages():
            if channel not in chosen:
                chosen[channel] = wanted(channel.topic, channel.kind)
                if chosen[channel]:
                    types.learn(channel.text, channel.kind)
            if chosen[channel]:
                receive(channel.topic, channel.kind, types.decoder(data, channel.kind))
        bag.topics = {channel.topic: channel.kind for channel in reader.topics.values()}
        bag.metadata = reader.metadata
        if "format" not in reader.metadata.get(METADATA, {}) and not has_summary(file):
            raise McapError("it has no summary section")
    return bag


def _read_sqlite(source: Source, wanted: Wanted, receive: Receive) -> Bag:
    """Read the SQLite file of a ROS 2 bag; its tables are ``topics`` and ``messages``."""
    import sqlite3

    types = _Types()
    address = f"{source.path.resolve().as_uri()}?mode=ro&immutable=1"
    with contextlib.closing(sqlite3.connect(address, uri=True)) as base:
        tables = {name for (name,) in base.execute("SELECT name FROM sqlite_master WHERE type = 'table'")}
        if "message_definitions" in tables:
            query = "SELECT topic_type, encoded_message_definition FROM message_definitions WHERE encoding = 'ros2msg'"
            for kind, text in base.execute(query).fetchall():
                types.learn(str(text), str(kind))
        rows = base.execute("SELECT id, name, type, serialization_format FROM topics").fetchall()
        topics = {number: (str(name), str(kind)) for number, name, kind, _ in rows}
        foreign = next(
            (f"{name} in {form}" for _, name, kind, form in rows if form != "cdr" and wanted(name, kind)), ""
        )
        if foreign:
            raise DataError(f"{source.name}: the messages of {foreign} are not read; they must be in cdr")
        numbers = [number for number, (name, kind) in topics.items() if wanted(name, kind)]
        marks = ", ".join("?" * len(numbers))
        query = f"SELECT topic_id, data FROM messages WHERE topic_id IN ({marks}) ORDER BY timestamp, id"  # noqa: S608
        for number, data in base.execute(query, numbers):
            name, kind = topics[number]
            receive(name, kind, types.decoder(bytes(data), kind))
    return Bag(dict(topics.values()))


def _read_ros1(source: Source, wanted: Wanted, receive: Receive) -> Bag:
    """Read a bag of ROS 1."""
    from rosbags.rosbag1 import Reader

    types = _Types(ros1=True)
    with Reader(source.path) as reader:
        chosen = [connection for connection in reader.connections if wanted(connection.topic, connection.msgtype)]
        for connection in chosen:
            types.learn(connection.msgdef.data, connection.msgtype)
        for connection, _, data in reader.messages(chosen) if chosen else ():
            receive(connection.topic, connection.msgtype, types.decoder(data, connection.msgtype))
        return Bag({connection.topic: connection.msgtype for connection in reader.connections})


STORAGES = {"mcap": _read_mcap, "sqlite": _read_sqlite, "rosbag": _read_ros1}
"""Readers by kind of the file."""


class _Types:
    """Message types of a bag; the definitions in the bag are added to the usual ones."""

    def __init__(self, ros1: bool = False) -> None:
        from rosbags.typesys import Stores, get_typestore

        self._store = get_typestore(Stores.ROS1_NOETIC if ros1 else Stores.ROS2_HUMBLE)
        self._decode = self._store.deserialize_ros1 if ros1 else self._store.deserialize_cdr
        if not ros1:
            for kind, text in PEOPLE_DEFINITIONS.items():
                self.learn(text, kind)

    def learn(self, text: str, kind: str) -> None:
        from rosbags.typesys import get_types_from_msg

        types = get_types_from_msg(text, kind)
        self._store.register({name: fields for name, fields in types.items() if name not in self._store.types})

    def decoder(self, data: bytes, kind: str) -> Callable[[], Any]:
        return lambda: self._decode(data, kind)
