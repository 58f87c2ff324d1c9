"""Hostile frames over real connections into a running simulation: no trace, no hang, no growth of the memory."""

from __future__ import annotations

import contextlib
import json
import random
import re
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from test_rosbridge_protocol import hostile_frame
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

pytestmark = pytest.mark.live

PER_CLIENT = 1000
"""Frames of a client; then another one comes."""
ENDLESS = ("--set", "duration=36000", "--set", "end/collision=false", "--set", "end/goal=false")


def resident(process):
    """Return the memory of a process [kB]."""
    return int(re.search(r"VmRSS:\s+(\d+)", Path(f"/proc/{process.pid}/status").read_text(encoding="utf-8"))[1])


def attack(url, frames, rng):
    """Send frames by clients that do not read, some of which go without a word."""
    for _ in range(frames // PER_CLIENT):
        with contextlib.suppress(ConnectionClosed, UnicodeEncodeError), connect(url, close_timeout=0.1) as ws:
            for _ in range(PER_CLIENT):
                frame = hostile_frame(rng).encode("utf-8", "surrogatepass")
                ws.send(frame.decode("utf-8", "replace") if rng.random() < 0.95 else frame)
            if rng.random() < 0.5:
                ws.socket.close()


def answered(url):
    """Return the state of the simulation, asked by a good client."""
    call = json.dumps({"op": "call_service", "service": "/crowdbot/get_simulation_state", "id": "good"})
    with connect(url) as ws:
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


@pytest.mark.parametrize("frames", [2000, pytest.param(100_000, marks=pytest.mark.sweep)])
def test_hostile_frames_leave_a_running_simulation_as_it_was(frames, tmp_path):
    with socket.socket() as free:
        free.bind(("127.0.0.1", 0))
        port = free.getsockname()[1]
    words = ["run", "frontal", *ENDLESS, "--bridge", f"rosbridge:{port}"]
    errors = tmp_path / "errors.txt"
    with errors.open("w") as log:
        process = subprocess.Popen([sys.executable, "-m", "crowdbot", *words], stdout=subprocess.DEVNULL, stderr=log)
    url, rng = f"ws://127.0.0.1:{port}", random.Random(7)
    try:
        end = time.monotonic() + 120.0
        while time.monotonic() < end:
            with contextlib.suppress(OSError):
                assert answered(url) == 1
                break
            time.sleep(0.1)
        attack(url, frames // 10, rng)  # what is loaded at the first use
        before = resident(process)
        attack(url, frames - frames // 10, rng)
        assert answered(url) in (1, 2)  # a frame may ask for a step, which pauses
        assert resident(process) - before < 40_000
    finally:
        process.kill()
        process.communicate()
    assert "Traceback" not in errors.read_text()
