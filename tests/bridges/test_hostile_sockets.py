"""Hostile frames over real connections into running servers: no trace, no hang, no growth of the memory."""

from __future__ import annotations

import contextlib
import functools
import json
import random
import re
import socket
import struct
import subprocess
import sys
import time
from collections.abc import Callable
from pathlib import Path
from typing import NamedTuple

import pytest
import test_foxglove_protocol
import test_rosbridge_protocol
from partner_runs import ENDLESS, free_port
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from crowdbot.bridges.challenge_server import read_request
from crowdbot.core import InputError
from vr.headset_messages import message

pytestmark = pytest.mark.live

PER_CLIENT = 1000
"""Frames of a client; then another one comes."""
LARGEST = 50_000
"""Largest growth of the memory [kB]."""
BEGUN = 2.0
"""Simulated time [s] at which a simulation has loaded its kernels."""
MEETING = """<trial name="meeting" duration="3600"><stage/><crowd type="orca"/>
<avatar name="guest" source="external" x="1" y="0.5"/><agent x="4" y="1.2" goal="-5,1.2"/><end collision="false"/>
</trial>"""


def resident(process):
    """Return the memory of a process [kB]."""
    return int(re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8"))[1])


def sockets(path, make, protocols, port, frames, rng, reads=False):
    """Send frames by clients that do not read, or read an answer to each; some of them go without a word."""
    sent = 0
    while sent < frames:
        address = f"ws://127.0.0.1:{port}/{path}"
        with (
            contextlib.suppress(ConnectionClosed, EOFError),
            connect(address, subprotocols=protocols, close_timeout=0.1) as ws,
        ):
            sent += 1
            for _ in range(PER_CLIENT):
                ws.send(make(rng))
                sent += 1
                with contextlib.suppress(TimeoutError):
                    _ = reads and ws.recv(timeout=1.0)
            if rng.random() < 0.5:
                ws.socket.close()


def rosbridge_frame(rng):
    frame = test_rosbridge_protocol.hostile_frame(rng).encode("utf-8", "surrogatepass")
    return frame.decode("utf-8", "replace") if rng.random() < 0.95 else frame


def torn(data, rng):
    """Return bytes that were changed or cut, most of the time."""
    data = bytearray(data)
    for _ in range(rng.choice((0, 0, 0, 1, 3))):
        data[rng.randrange(len(data))] = rng.randrange(256)
    return bytes(data[: rng.randrange(len(data) + 1)] if rng.random() < 0.05 else data)


def headset_frame(rng):
    """Return a pose of a headset that was changed or cut, or a text."""
    pose = torn(message(rng.uniform(0.0, 100.0), number=rng.randrange(1, 10**6)), rng)
    return pose if rng.random() < 0.98 else pose.decode("latin-1")


REQUESTS = (b"clock=0.1;vel_cmd=0.1 10;sim_control=i;", b"vel_cmd_robot=0 0;", b"clock=" + b"9" * 5000 + b";", b";")


def request(rng):
    """Return a request of the challenge that was changed or cut; it does not end the simulation."""
    while True:
        good = rng.choice(
            ("clock=0.1;vel_cmd=0.1 10;sim_control=i;", "vel_cmd_robot=0 0;", f"clock={'9' * 5000};", ";")
        )
        text = torn(good.encode(), rng)
        with contextlib.suppress(InputError):
            if read_request(text.decode("utf-8", "replace")).control in "srnpfl":  # an end, or another beginning
                continue
        return text


def requests(port, frames, rng):
    """Send requests by clients of which some do not wait for the reply."""
    sent = 0
    while sent < frames:
        with contextlib.suppress(OSError), socket.create_connection(("127.0.0.1", port), timeout=60.0) as client:
            client.settimeout(0.005)
            for _ in range(PER_CLIENT):
                client.sendall(request(rng))
                sent += 1
                with contextlib.suppress(TimeoutError):
                    if rng.random() < 0.5 and not client.recv(65536):
                        break


def state_of_run(port):
    """Return the state of a simulation, asked by a good client of rosbridge."""
    call = json.dumps({"op": "call_service", "service": "/crowdbot/get_simulation_state", "id": "good"})
    with connect(f"ws://127.0.0.1:{port}") as ws:
        ws.send(call)
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            frame = json.loads(ws.recv(timeout=60.0))
            if frame.get("id") != "good":
                continue
            if frame["result"]:
                return frame["values"]["state"]["state"]
            assert "calls wait for the simulation" in frame["values"]  # those of the others are answered first
            time.sleep(0.2)
            ws.send(call)
    return None


def stop_of_join(port):
    """Return 1 if the run of a real robot takes a stop of a good client and a scan of the trial comes."""
    with connect(f"ws://127.0.0.1:{port}") as ws:
        ws.send(json.dumps({"op": "publish", "topic": "/robot/stop", "msg": {"data": True}}))
        ws.send(json.dumps({"op": "subscribe", "topic": "/robot/scan"}))
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            if json.loads(ws.recv(timeout=60.0)).get("topic") == "/robot/scan":
                return 1
    return None


def time_of_run(port):
    """Return whether the time of a simulation comes to a good client of Foxglove, or it is told that it is paused."""
    with connect(f"ws://127.0.0.1:{port}", subprotocols=["foxglove.sdk.v1"], max_size=None) as ws:
        ws.send(json.dumps({"op": "advertise", "channels": [{"id": 1, "topic": "/robot/cmd_vel", "encoding": "json",
                                                             "schemaName": "geometry_msgs/Twist"}]}))  # fmt: skip
        ws.send(b"\x03\x00" + bytes(4) + b"\x00" + bytes(8) + b"\x04\x00\x00\x00good")
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            frame = ws.recv(timeout=60.0)
            if isinstance(frame, bytes) and frame[0] in (2, 5):
                return 1
    return None


def reply_of_run(port):
    """Return 1 if a good client of the challenge gets a reply."""
    with socket.create_connection(("127.0.0.1", port), timeout=60.0) as client:
        client.sendall(b"sim_control=i;")
        return int(client.recv(65536).startswith(b"clock="))


def state_of_app(port):
    """Return 1 if a good window of another session gets its state, and a headset a picture of its link."""
    with connect(f"ws://127.0.0.1:{port}/api/main/socket", max_size=None) as ws:
        ws.send(json.dumps({"id": 7, "call": "vr.state", "args": {}}))
        end = time.monotonic() + 60.0
        while time.monotonic() < end:
            frame = ws.recv(timeout=60.0)
            if isinstance(frame, str) and json.loads(frame).get("id") == 7:
                return int("result" in json.loads(frame))
    return None


def wait_for_scans(port):
    """Wait until the scans of a robot over rosbridge are late enough."""
    with connect(f"ws://127.0.0.1:{port}") as ws:
        ws.send(json.dumps({"op": "subscribe", "topic": "/robot/scan"}))
        while True:
            frame = json.loads(ws.recv(timeout=60.0))
            if frame.get("topic") == "/robot/scan" and frame["msg"]["header"]["stamp"]["sec"] >= BEGUN:
                return


def wait_for_time(port):
    """Wait until the time over Foxglove is late enough."""
    with connect(f"ws://127.0.0.1:{port}", subprotocols=["foxglove.sdk.v1"], max_size=None) as ws:
        ws.send(json.dumps({"op": "advertise", "channels": [{"id": 1, "topic": "/robot/cmd_vel", "encoding": "json",
                                                             "schemaName": "geometry_msgs/Twist"}]}))  # fmt: skip
        while True:
            frame = ws.recv(timeout=60.0)
            if isinstance(frame, bytes) and frame[0] == 2 and struct.unpack_from("<BQ", frame)[1] >= BEGUN * 1e9:
                return


def ask_for_time(port):
    """Ask the challenge until its time is late enough."""
    with socket.create_connection(("127.0.0.1", port), timeout=60.0) as client:
        while True:
            client.sendall(b"vel_cmd=0.1 10;")
            reply = b""
            while not reply.endswith(b"@"):
                reply += client.recv(65536)
            if float(re.match(rb"clock=\d+#([\d.]+);", reply)[1]) >= BEGUN:
                return


def wait_for_status(port):
    """Wait until the time of the simulator of the app is late enough."""
    with connect(f"ws://127.0.0.1:{port}/api/main/socket", max_size=None) as ws:
        while True:
            frame = ws.recv(timeout=60.0)
            told = json.loads(frame) if isinstance(frame, str) else {}
            if told.get("event") == "simulator.status" and (told["data"].get("time") or 0.0) >= BEGUN:
                return


class Server(NamedTuple):
    """A program with a server, an attack, what a good client sees, and the wait for a simulation that has begun."""

    words: Callable[[int, Path], list[str]]
    attack: Callable[[int, int, random.Random], None]
    answer: Callable[[int], int | None]
    begin: Callable[[int], None]


def run(kind):
    return lambda port, folder: ["run", "frontal", *ENDLESS, "--bridge", f"{kind}:{port}"]


SERVERS = {
    "rosbridge": Server(run("rosbridge"), functools.partial(sockets, "", rosbridge_frame, None), state_of_run,
                        wait_for_scans),
    "join": Server(
        lambda port, folder: ["join", "frontal", *ENDLESS, "--area=-9,-9,9,9", "--bridge", f"rosbridge:{port}"],
        functools.partial(sockets, "", rosbridge_frame, None),
        stop_of_join,
        wait_for_scans,
    ),
    "foxglove": Server(
        run("foxglove"),
        functools.partial(sockets, "", test_foxglove_protocol.hostile_frame, ["foxglove.sdk.v1"]),
        time_of_run,
        wait_for_time,
    ),
    "tcp": Server(run("tcp"), requests, reply_of_run, ask_for_time),
    "headset": Server(
        lambda port, folder: [
            "app", "--no-browser", "--port", str(port), "--folder", str(folder), "--open", str(folder / "meeting.xml")
        ],
        functools.partial(sockets, "api/main/headset", headset_frame, None, reads=True),
        state_of_app,
        wait_for_status,
    ),
}  # fmt: skip
"""The app has a test of its own, with torn frames: tests/web/server/test_hostile_frames.py."""


@pytest.mark.parametrize("frames", [2000, pytest.param(100_000, marks=pytest.mark.sweep)])
@pytest.mark.parametrize("kind", SERVERS)
def test_hostile_frames_leave_a_running_server_as_it_was(kind, frames, tmp_path):
    (tmp_path / "meeting.xml").write_text(MEETING)
    server, port, rng, errors = SERVERS[kind], free_port(), random.Random(7), tmp_path / "errors.txt"
    with errors.open("w") as log:
        process = subprocess.Popen(
            [sys.executable, "-m", "crowdbot", *server.words(port, tmp_path)], stdout=subprocess.DEVNULL, stderr=log
        )
    try:
        end = time.monotonic() + 120.0
        while time.monotonic() < end:
            with contextlib.suppress(OSError):
                assert server.answer(port) == 1
                break
            assert process.poll() is None, errors.read_text()
            time.sleep(0.1)
        server.begin(port)  # the first steps of a simulation load its kernels, tens of MB
        before = resident(process)
        server.attack(port, frames, rng)
        assert server.answer(port) in (1, 2)  # a frame may ask for a step, which pauses
        grown = resident(process) - before
        print(f"{kind}: {frames} frames, {grown / 1e3:.1f} MB")
        assert grown < LARGEST
    finally:
        process.kill()
        process.communicate()
    assert "Traceback" not in errors.read_text()
