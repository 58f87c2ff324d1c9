"""A program that receives topics of a bridge and only counts them: ``python bridge_viewer.py NAME PORT TOPIC...``.

It prints ``ready``, and at its end, when a line comes in or the connection ends, the number of messages and bytes.
"""

from __future__ import annotations

import asyncio
import json
import sys
from collections.abc import Sequence
from typing import Any

import aiohttp

FOXGLOVE = "foxglove.sdk.v1"
MESSAGE = 1
"""First byte of a message of a channel in the protocol of Foxglove."""


async def _rosbridge(socket: Any, topics: Sequence[str], compression: str) -> None:
    for topic in topics:
        await socket.send_json({"op": "subscribe", "topic": topic, "compression": compression})


async def _foxglove(socket: Any, topics: Sequence[str]) -> None:
    found: dict[str, int] = {}
    while set(topics) - set(found):
        message = await socket.receive()
        if message.type == aiohttp.WSMsgType.TEXT:
            frame = json.loads(message.data)
            found |= {item["topic"]: item["id"] for item in frame.get("channels", ())}
    rows = [{"id": k, "channelId": found[topic]} for k, topic in enumerate(topics)]
    await socket.send_json({"op": "subscribe", "subscriptions": rows})


async def _receive(transport: str, port: str, topics: Sequence[str]) -> dict[str, int]:
    messages = size = 0
    address, protocols = f"ws://127.0.0.1:{port}/", (FOXGLOVE,) * (transport == "foxglove")
    async with (
        aiohttp.ClientSession() as http,
        http.ws_connect(address, protocols=protocols, max_msg_size=0) as socket,
    ):
        if transport == "foxglove":
            await _foxglove(socket, topics)
        else:
            await _rosbridge(socket, topics, "cbor" if transport.endswith("cbor") else "none")
        _tell("ready")
        ending = asyncio.create_task(asyncio.to_thread(sys.stdin.readline))
        ending.add_done_callback(lambda _: asyncio.ensure_future(socket.close()))
        async for message in socket:
            counts = transport != "foxglove" or (
                message.type == aiohttp.WSMsgType.BINARY and message.data[0] == MESSAGE
            )
            messages, size = messages + counts, size + len(message.data) * counts
    return {"messages": messages, "bytes": size}


def _tell(line: str) -> None:
    sys.stdout.write(f"{line}\n")
    sys.stdout.flush()


def main() -> None:
    """Receive the topics that the arguments name."""
    transport, port, *topics = sys.argv[1:]
    _tell(json.dumps(asyncio.run(_receive(transport, port, topics))))


if __name__ == "__main__":
    main()
