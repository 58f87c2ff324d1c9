"""A robot program that receives topics and answers each step: ``python bridge_viewer.py NAME PORT TOPIC...``.

A second client reads the first topic slowly. The program prints ``ready``, and at its end, when a line comes in or the
connection ends, the number of messages and bytes, and when it took each slow message and the time that this one says.
"""

from __future__ import annotations

import asyncio
import json
import struct
import sys
import time
from collections.abc import Sequence
from typing import Any

import aiohttp

FOXGLOVE = "foxglove.sdk.v1"
MESSAGE, TIME = 1, 2
"""First byte of a message of a channel, and of the time, in the protocol of Foxglove."""
CLOCK, COMMAND, TWIST = "/clock", "/robot/cmd_vel", "geometry_msgs/Twist"
ANSWER = {"linear": {"x": 0.5}, "angular": {"z": 0.1}}
SHORT = 1000
"""Largest frame of the clock [characters]."""
PERIOD = 0.5
"""Real time [s] between two messages of the slow client."""


class Rosbridge:
    """The protocol of rosbridge; the topics may come as CBOR.

    Args:
        socket: the connection.
        compression: of the topics.
    """

    def __init__(self, socket: Any, compression: str = "none") -> None:
        self.socket, self.compression = socket, compression

    async def subscribe(self, topics: Sequence[str]) -> None:
        """Subscribe topics."""
        for topic in topics:
            await self.socket.send_json({"op": "subscribe", "topic": topic, "compression": self.compression})

    async def begin_answers(self) -> None:
        """Subscribe the clock, and announce the commands."""
        await self.socket.send_json({"op": "subscribe", "topic": CLOCK})
        await self.socket.send_json({"op": "advertise", "topic": COMMAND, "type": TWIST})

    async def answer(self) -> None:
        """Send a command."""
        await self.socket.send_json({"op": "publish", "topic": COMMAND, "msg": ANSWER})

    def is_clock(self, data: str | bytes) -> bool:
        """Return whether a frame is a tick of the clock."""
        return isinstance(data, str) and len(data) < SHORT and json.loads(data).get("topic") == CLOCK

    def is_message(self, data: str | bytes) -> bool:
        """Return whether a frame is a message."""
        return True

    def stamp(self, data: str | bytes) -> int:
        """Return the time [ns] in the header of a message."""
        stamp = json.loads(data)["msg"]["header"]["stamp"]
        return int(stamp["sec"] * 10**9 + stamp["nanosec"])


class Foxglove:
    """The protocol of Foxglove.

    Args:
        socket: the connection.
    """

    def __init__(self, socket: Any) -> None:
        self.socket = socket

    async def subscribe(self, topics: Sequence[str]) -> None:
        """Subscribe topics."""
        channels: dict[str, int] = {}
        while set(topics) - set(channels):
            message = await self.socket.receive()
            if message.type == aiohttp.WSMsgType.TEXT:
                channels |= {row["topic"]: row["id"] for row in json.loads(message.data).get("channels", ())}
        rows = [{"id": k, "channelId": channels[topic]} for k, topic in enumerate(topics)]
        await self.socket.send_json({"op": "subscribe", "subscriptions": rows})

    async def begin_answers(self) -> None:
        """Announce the commands; the clock comes by itself."""
        row = {"id": 0, "topic": COMMAND, "encoding": "json", "schemaName": TWIST}
        await self.socket.send_json({"op": "advertise", "channels": [row]})

    async def answer(self) -> None:
        """Send a command."""
        await self.socket.send_bytes(struct.pack("<BI", MESSAGE, 0) + json.dumps(ANSWER).encode())

    def is_clock(self, data: str | bytes) -> bool:
        """Return whether a frame is a tick of the clock."""
        return isinstance(data, bytes) and data[0] == TIME

    def is_message(self, data: str | bytes) -> bool:
        """Return whether a frame is a message."""
        return isinstance(data, bytes) and data[0] == MESSAGE

    def stamp(self, data: str | bytes) -> int:
        """Return the time [ns] of a message."""
        assert isinstance(data, bytes)
        return int(struct.unpack_from("<Q", data, 5)[0])


async def _receive(name: str, port: str, topics: Sequence[str]) -> dict[str, Any]:
    messages = size = 0
    address, protocols = f"ws://127.0.0.1:{port}/", (FOXGLOVE,) * (name == "foxglove")
    async with (
        aiohttp.ClientSession() as http,
        http.ws_connect(address, protocols=protocols, max_msg_size=0) as socket,
        http.ws_connect(address, protocols=protocols, max_msg_size=0) as other,
    ):
        bridge: Rosbridge | Foxglove
        slow: Rosbridge | Foxglove
        if name == "foxglove":
            bridge, slow = Foxglove(socket), Foxglove(other)
        else:
            bridge, slow = Rosbridge(socket, "cbor" if name.endswith("cbor") else "none"), Rosbridge(other)
        await bridge.subscribe(topics)
        await bridge.begin_answers()
        await slow.subscribe(topics[:1])
        _tell("ready")
        rows: list[tuple[int, int]] = []
        reading = asyncio.create_task(_read_slowly(slow, rows))
        ending = asyncio.create_task(asyncio.to_thread(sys.stdin.readline))
        ending.add_done_callback(lambda _: asyncio.ensure_future(socket.close()))
        async for message in socket:
            if bridge.is_clock(message.data):
                await bridge.answer()
            elif bridge.is_message(message.data):
                messages, size = messages + 1, size + len(message.data)
        reading.cancel()
    return {"messages": messages, "bytes": size, "scans": rows[2:]}


async def _read_slowly(bridge: Rosbridge | Foxglove, rows: list[tuple[int, int]]) -> None:
    """Note when messages are taken [ns], and the times that they say [ns]; the first two may be older."""
    async for message in bridge.socket:
        if bridge.is_message(message.data):
            rows.append((time.monotonic_ns(), bridge.stamp(message.data)))
            await asyncio.sleep(PERIOD)


def _tell(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main() -> None:
    """Receive the topics that the arguments name."""
    name, port, *topics = sys.argv[1:]
    _tell(json.dumps(asyncio.run(_receive(name, port, topics))))


if __name__ == "__main__":
    main()
