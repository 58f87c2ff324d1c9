"""The age of what a client reads that takes one message in 0.5 s, over each transport; small messages go at once."""

from __future__ import annotations

import asyncio
import gc
import socket

import aiohttp
import pytest
from bridge_runs import MemoryTransport, Running, endless_trial, wait
from partner_runs import LOCAL, ages

from crowdbot.benchmark.speed.bridge_viewer import FOXGLOVE, Foxglove, Rosbridge
from crowdbot.bridges.challenge_server import ChallengeServer
from crowdbot.bridges.foxglove import FoxgloveServer
from crowdbot.bridges.rosbridge.server import RosbridgeServer

pytestmark = pytest.mark.live
PERIOD, OLDEST = 0.5, 600_000_000
"""Time between two readings [s], and largest age [ns]."""


async def socket_ages(port, client, protocols, now):
    """Return the simulated ages [ns] of 16 scans that are read one in 0.5 s, after those of the first second."""
    found = []
    async with aiohttp.ClientSession() as http:
        address = f"ws://127.0.0.1:{port}/"
        async with http.ws_connect(address, protocols=protocols, max_msg_size=0) as socket:
            reader = client(socket)
            await reader.subscribe(["/robot/scan"])
            while len(found) < 18:
                data = (await socket.receive()).data
                if reader.is_message(data):
                    found.append(now() - reader.stamp(data))
                    await asyncio.sleep(PERIOD)
    return found[2:]


@pytest.mark.parametrize(
    ("kind", "client", "protocols"), [(RosbridgeServer, Rosbridge, ()), (FoxgloveServer, Foxglove, (FOXGLOVE,))]
)
def test_a_reader_of_two_scans_a_second_gets_the_newest(kind, client, protocols):
    server, clock = kind(port=0), MemoryTransport(topics=("/clock",))
    with Running(endless_trial(600.0), [server, clock]):

        def now():
            return max(item.nanoseconds for item in clock.sent[-20:])

        found = asyncio.run(socket_ages(server.port, client, protocols, now))
    assert max(found) < OLDEST, found


@pytest.mark.parametrize("kind", [RosbridgeServer, FoxgloveServer, ChallengeServer])
def test_a_small_message_does_not_wait_for_the_receipt_of_the_one_before(kind):
    """Nagle's algorithm keeps it back for up to 40 ms, until the client has confirmed the last one."""
    server = kind(port=0)
    with (
        Running(endless_trial(600.0), [server]),
        socket.create_connection(("127.0.0.1", server.port), timeout=60.0) as client,
    ):
        wait(lambda: accepted(client))
        (connection,) = accepted(client)
        wait(lambda: connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY))  # set after the connection
        assert connection.getsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY)


def accepted(client):
    """Return the sockets of this process at the other end of a connection."""
    here = client.getsockname()
    sockets = [item for item in gc.get_objects() if isinstance(item, socket.socket) and item.fileno() >= 0]
    return [item for item in sockets if item.family == client.family and peer_of(item) == here]


def peer_of(connection):
    """Return the address at the other end of a socket, or None."""
    try:
        return connection.getpeername()
    except OSError:
        return None


@pytest.mark.parametrize("transport", ["ros2", "tcp"])
def test_a_slow_reader_in_a_process_of_its_own_gets_the_newest(transport, tmp_path, monkeypatch):
    monkeypatch.setenv(*next(iter(LOCAL.items())))
    check(transport, ages(transport, 14, tmp_path))


def test_a_slow_reader_of_ros1_gets_the_newest(ros1, tmp_path):
    check("ros1", ages("ros1", 14, tmp_path))


def check(transport, found):
    print(f"{transport}: oldest of {len(found)} {max(found):.3f} s")
    assert len(found) == 12
    assert max(found) < OLDEST / 1e9, found
