"""Publication: a topic of a ROS 1 node, with a queue for each of its subscribers."""

from __future__ import annotations

import asyncio
from collections import deque

from crowdbot.bridges.interface import OutputTopic
from crowdbot.core import InputError
from crowdbot.messages import Ros1Messages

from .tcpros import pack_header

ANY = "*"
"""Type and checksum of a subscriber that takes everything, such as ``rosbag record`` and ``rostopic hz``."""
FULL = 1 << 18
"""Bytes in the buffer of a connection above which messages wait in the queue, where old ones are dropped."""


def ros1_kind(kind: str) -> str:
    """Return the name of a type in ROS 1.

    >>> ros1_kind("sensor_msgs/msg/LaserScan")
    'sensor_msgs/LaserScan'
    """
    return kind.replace("/msg/", "/").replace("/srv/", "/")


class Publication:
    """A topic that is sent.

    Args:
        output: the topic.
        codec: types of ROS 1.
    """

    def __init__(self, output: OutputTopic, codec: Ros1Messages) -> None:
        self.topic, self.kind, self.quality = output.name, output.kind, output.quality
        self.checksum, self.definition = codec.checksum(output.kind), codec.definition(output.kind)
        self.latest: bytes | None = None
        """Latest frame, of a latched topic."""
        self.count = 0
        """Number of subscribers."""
        self._queues: dict[asyncio.StreamWriter, tuple[deque[bytes], asyncio.Event]] = {}

    def deliver(self, frame: bytes) -> None:
        """Queue a frame for all subscribers; the oldest of a slow one is dropped."""
        if self.quality.latched:
            self.latest = frame
        for queue, news in self._queues.values():
            queue.append(frame)
            news.set()

    async def serve(self, fields: dict[str, str], writer: asyncio.StreamWriter, node: str) -> None:
        """Send messages to a subscriber until the task is cancelled or the connection breaks.

        Raises:
            InputError: the subscriber wants another type.
        """
        wanted = (fields.get("type", ANY), fields.get("md5sum", ""))
        own = (ros1_kind(self.kind), self.checksum)
        if any(given not in (ANY, mine) for given, mine in zip(wanted, own, strict=True)):
            raise InputError(f"{self.topic} is {' '.join(own)}, not {' '.join(wanted)[:120]}")
        header = {"callerid": node, "topic": self.topic, "type": own[0], "md5sum": self.checksum}
        header |= {"message_definition": self.definition, "latching": str(int(self.quality.latched))}
        writer.transport.set_write_buffer_limits(high=FULL)
        writer.write(pack_header(header))
        queue, news = deque[bytes](maxlen=self.quality.depth), asyncio.Event()
        if self.latest is not None:
            queue.append(self.latest)
            news.set()
        self._queues[writer] = queue, news
        self.count = len(self._queues)
        try:
            while True:
                await news.wait()
                news.clear()
                while queue:
                    writer.write(queue.popleft())
                    await writer.drain()
        finally:
            self._queues.pop(writer, None)
            self.count = len(self._queues)
