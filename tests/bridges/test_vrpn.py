"""VRPN: a server that sends what real ones send, read by the product and by the library of VRPN itself."""

from __future__ import annotations

import json
import math
import random
import socket
import struct
import subprocess
import sys

import numpy as np
import pytest
from bridge_runs import wait
from hypothesis import given
from hypothesis import strategies as st
from vrpn_server import VrpnServer, vrpn_message, vrpn_pose

from crowdbot.bridges import open_stream, parse_captures
from crowdbot.bridges.motion_capture.vrpn import LONGEST, VrpnStream
from crowdbot.cli import main
from crowdbot.core import InputError
from crowdbot.recording import read_episode, replay
from crowdbot.trials import parse_trial

TEXT = """<trial name="led" duration="{}"><stage/><crowd type="orca"/>
  <robot name="twin" type="turtlebot2" x="4" y="-1">
    <goal x="-3" y="0"/><pose source="external"/><navigator type="external"/>
  </robot>
  <end collision="false" goal="false"/>
</trial>"""


def described(*parts: bytes) -> bytes:
    """Return the bytes of a server whose sender 1 is the cart and whose type 3 is a pose."""
    names = [(1, -1, b"Cart\0"), (3, -2, b"vrpn_Tracker Pos_Quat\0")]
    rows = [vrpn_message(number, kind, struct.pack(">i", len(name)) + name) for number, kind, name in names]
    return b"".join((*rows, *parts))


def fed(*chunks: bytes) -> VrpnStream:
    stream = VrpnStream()
    for k, chunk in enumerate(chunks):
        stream.take(chunk, "server", 5.0 + 0.01 * k)
    return stream


@pytest.mark.live
def test_the_poses_of_a_tracker_come_with_their_time() -> None:
    with VrpnServer() as server, open_stream(f"vrpn:127.0.0.1:{server.port}") as stream:
        wait(lambda: stream.statistics("Cart").samples > 5)
        ((_, cart),) = stream.read("Cart", 0.0, 0.05)
        assert stream.subjects() == ("Cart",)
        assert stream.latency() is not None
    t = cart.time - 1_700_000_000
    np.testing.assert_allclose(cart.position[0], [0.5 * t, 1.0, 0.3], atol=1e-5)
    assert math.atan2(cart.rotation[0, 1, 0], cart.rotation[0, 0, 0]) == pytest.approx(0.5 * t, abs=1e-5)


READ = """
import json, sys, time, motioncapture
found = motioncapture.connect("vrpn", {"hostname": "tcp://127.0.0.1:" + sys.argv[1]})
end = time.monotonic() + 60.0
while time.monotonic() < end:
    found.waitForNextFrame()
    for name, one in found.rigidBodies.items():
        print(json.dumps([name, [float(x) for x in one.position], one.rotation.z, one.rotation.w]))
        sys.exit()
"""


@pytest.mark.live
def test_the_sender_is_understood_by_the_library_of_vrpn() -> None:
    with VrpnServer() as server:
        words = [sys.executable, "-c", READ, str(server.port)]
        done = subprocess.run(words, capture_output=True, text=True, timeout=120)
    assert done.returncode == 0, done.stderr
    name, (x, y, z), turn_z, turn_w = json.loads(done.stdout)
    assert (name, y, z) == ("Cart", 1.0, pytest.approx(0.3))
    assert 2.0 * math.atan2(turn_z, turn_w) == pytest.approx(x, abs=1e-4)  # it turns by x


@pytest.mark.live
def test_a_lost_connection_is_made_again() -> None:
    with VrpnServer() as server, open_stream(f"vrpn:127.0.0.1:{server.port}") as stream:
        wait(lambda: stream.statistics("Cart").samples > 5)
        server.hang_up.set()
        wait(lambda: server.met == 2)
        before = stream.statistics("Cart").samples
        wait(lambda: stream.statistics("Cart").samples > before + 5)
        assert "closed the connection" in stream.statistics().reason


@pytest.mark.live
def test_a_killed_server_and_another_one_at_its_place() -> None:
    with VrpnServer() as server:
        port = server.port
        stream = open_stream(f"vrpn:127.0.0.1:{port}")
        stream.__enter__()
        wait(lambda: stream.statistics("Cart").samples > 5)
    wait(lambda: "cannot reach the VRPN server" in stream.statistics().reason)
    with VrpnServer(port=port):
        before = stream.statistics("Cart").samples
        wait(lambda: stream.statistics("Cart").samples not in (0, before))
        assert "cannot reach the VRPN server" in stream.statistics().reason  # the latest interruption is still told
        stream.__exit__(None, None, None)


@pytest.mark.live
def test_a_server_that_is_not_there_or_no_vrpn_is_an_error() -> None:
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    with pytest.raises(InputError, match=f"cannot reach the VRPN server 127.0.0.1:{port}: Connection refused"):
        open_stream(f"vrpn:127.0.0.1:{port}").__enter__()
    with (
        VrpnServer(cookie=b"HTTP/1.1 400 Bad Request") as server,
        pytest.raises(InputError, match="says 'HTTP/1.1 400"),
    ):
        open_stream(f"vrpn:127.0.0.1:{server.port}").__enter__()
    with VrpnServer(cookie=b"vrpn: ver. 06.04  0") as server, pytest.raises(InputError, match="not 'vrpn: ver. 07.35'"):
        open_stream(f"vrpn:127.0.0.1:{server.port}").__enter__()
    with socket.create_server(("127.0.0.1", 0)) as silent, pytest.raises(InputError, match="says nothing"):
        VrpnStream("127.0.0.1", silent.getsockname()[1], timeout=0.2).__enter__()


@given(st.integers(1, 60), st.integers(1, 5))
def test_messages_may_come_in_any_parts(size: int, count: int) -> None:
    data = described(*(vrpn_message(1, 3, vrpn_pose(0.1 * k), 0.1 * k) for k in range(count)))
    stream = fed(*(data[k : k + size] for k in range(0, len(data), size)))
    assert (stream.statistics("Cart").samples, stream.statistics().refused) == (count, 0)


def test_a_second_sensor_is_a_subject_of_its_own() -> None:
    second = struct.pack(">i", 1) + vrpn_pose(0.0)[4:]
    assert fed(described(vrpn_message(1, 3, vrpn_pose(0.0)), vrpn_message(1, 3, second))).subjects() == (
        "Cart",
        "Cart/1",
    )


BAD = {
    "a message of 3 bytes": struct.pack(">6i", 3, 0, 0, 0, 0, 0),
    f"a message of {LONGEST + 1} bytes": struct.pack(">6i", LONGEST + 1, 0, 0, 0, 0, 0),
    "a pose of 8 bytes": vrpn_message(1, 3, bytes(8)),
    "a pose has values that are not finite or out of range": vrpn_message(
        1, 3, struct.pack(">ii7d", 0, 0, 1e300, 0, 0, 0, 0, 0, 1)
    ),
    "a name of 900 bytes": vrpn_message(4, -1, struct.pack(">i", 900) + bytes(900)),
    "a name without a length": vrpn_message(4, -2, b"ab"),
}


@pytest.mark.parametrize("reason", BAD)
def test_bad_messages_are_refused_with_their_reason(reason: str) -> None:
    stream = fed(described(), BAD[reason])
    assert stream.statistics().refused == 1
    assert reason in stream.statistics().reason


def test_mutated_bytes_leave_the_stream_working_and_its_memory_bounded() -> None:
    rng, seed, refused = random.Random(5), described(vrpn_message(1, 3, vrpn_pose(0.0))), 0
    for _ in range(600):
        stream = VrpnStream()
        data = bytearray(seed * 3)
        for _ in range(rng.randint(1, 12)):
            data[rng.randrange(len(data))] = rng.choice((0, 1, 127, 128, 255, rng.randrange(256)))
        stream.take(bytes(data), "server", 1.0)
        stream.take(rng.randbytes(400), "server", 2.0)
        refused += stream.statistics().refused
        assert len(stream.subjects()) <= 32
        assert len(stream._buffer) <= LONGEST
    assert refused > 300


@pytest.mark.live
def test_the_command_moves_a_robot_by_a_vrpn_server_and_the_episode_replays(tmp_path, capsys, monkeypatch) -> None:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "led.xml").write_text(TEXT.format(1.0))
    with VrpnServer() as server:
        texts = [f"vrpn:127.0.0.1:{server.port}#Cart=twin@0,1"]
        (capture,) = parse_captures(texts, parse_trial(TEXT.format(1.0)))
        assert capture.stream.live
        assert main(["run", "led.xml", "--mocap", texts[0], "--out", "led"]) == 0
    assert "motion capture twin: " in capsys.readouterr().err
    episode = read_episode(tmp_path / "led" / "episode.mcap")
    path = episode.position[:, episode.robots[0]]
    assert path[-1, 1] == pytest.approx(2.0, abs=0.05)  # 1 m in the hall, whose origin is at y = 1 m
    assert path[-1, 0] > path[len(path) // 2, 0]
    assert len(episode.orders) >= 5
    assert replay(tmp_path / "led" / "episode.mcap").equal
