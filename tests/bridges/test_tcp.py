"""The TCP protocol of the challenge, with a client of its own that is written from the description."""

from __future__ import annotations

import base64
import contextlib
import io
import math
import os
import socket
import sys

import numpy as np
import pytest
from bridge_runs import MemoryTransport, Running, endless_trial
from hypothesis import given
from hypothesis import strategies as st
from page_runs import begin, follow_page
from PIL import Image
from test_hidden_labels import sent

from crowdbot.bridges import BridgeClock, open_transport, run_bridge
from crowdbot.bridges.challenge_server import ChallengeServer, encode_scan, format_reply, read_request
from crowdbot.core import InputError
from crowdbot.recording import replay
from crowdbot.trials import load_trial, parse_trial


class Client:
    """A client of the challenge: one request, one reply that ends with @."""

    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=60.0)

    def ask(self, text):
        self.socket.sendall(text.encode())
        return self.receive()

    def receive(self):
        found = b""
        while not found.endswith(b"@"):
            part = self.socket.recv(4096)
            if not part:
                return None
            found += part
        parts = found.decode().split(";")
        assert parts.pop() == "@"
        rows = [part.split("=", 1) for part in parts]
        numbers = {value.split("#", 1)[0] for _, value in rows}
        assert len(numbers) == 1
        return {topic: value.split("#", 1)[1] for topic, value in rows}


def run_server(trial, out=None):
    server = ChallengeServer(0)
    return Running(trial, [server], "follow", out=out), server


def numbers(text):
    return [float(word) for word in text.replace("(", "").replace(")", "").split()]


@pytest.mark.live
def test_a_client_drives_in_lock_step(tmp_path):
    trial = load_trial("frontal", duration=2.5)
    running, server = run_server(trial, tmp_path)
    with running:
        client, clock, seen = Client(server.port), 0.0, []
        while clock < 2.35:
            answer = client.ask(f"clock={clock};vel_cmd=0.5 20.0;sim_control=i;")
            assert float(answer["clock"]) == pytest.approx(clock)
            seen.append(numbers(answer["odom"]))
            clock = round(clock + 0.1, 3)
        crowd = numbers(answer["crowd"])
        assert (crowd[1], len(crowd)) == (trial.people, 2 + 3 * trial.people)
        client.socket.close()
        start = trial.robots[0]
        assert seen[0][1:3] == [start.x, start.y]
        x, y, theta, dx, dy, turn = seen[-1][1:]
        assert turn == pytest.approx(20.0, abs=0.5)
        assert math.hypot(dx, dy) == pytest.approx(0.5, abs=0.02)
        assert abs(theta - math.degrees(start.heading)) > 25.0
        assert (x, y) != (start.x, start.y)
        again = Client(server.port)
        assert again.ask("stop") is not None
        again.socket.close()
        running.end()
    assert replay(tmp_path / "episode.mcap").equal


def speed_at(nanoseconds):
    return 0.1 + nanoseconds % 7 / 10


class Answers(MemoryTransport):
    """The command for each instant, in memory."""

    def publish(self, messages):
        for now in {message.nanoseconds for message in messages if message.topic == "/tf"}:
            fields = {"linear": {"x": speed_at(now)}, "angular": {"z": 0.0}}
            self.inbox.receive("/robot/cmd_vel", fields, self.name)


@pytest.mark.live
def test_in_step_with_its_commands_a_command_counts_for_the_instant_of_the_latest_reply():
    trial, server, asked = endless_trial(4.0), ChallengeServer(0), 0
    with Running(trial, [server], "commands") as running:
        client = Client(server.port)
        answer = client.ask("sim_control=i;")
        with contextlib.suppress(OSError):  # the run has ended
            while answer is not None:  # several times for each instant: the next one takes longer than a reply
                answer = client.ask(f"vel_cmd={speed_at(round(float(answer['clock']) * 1e9))} 0;")
                asked += 1
        done = running.end(120.0)
        client.socket.close()
    assert asked > done.steps == 80
    assert running.run.port.inbox.count.stale > 0
    assert done.digest == run_bridge(trial, [Answers()], 0, None, BridgeClock("free")).digest


@pytest.mark.live
def test_a_reset_begins_again_and_robots_are_named():
    running, server = run_server(load_trial("frontal", duration=4.0))
    with running:
        client = Client(server.port)
        assert float(client.ask("clock=1.0;vel_cmd_robot=0.5 0;vel_cmd_pepper=1 0;sim_control=i;")["clock"]) == 1.0
        assert float(client.ask("clock=0;sim_control=n;")["clock"]) == 0.0
        assert float(client.ask("clock=0.2;vel_cmd=0 0;")["clock"]) == pytest.approx(0.2)
        assert client.ask("clock=0.3;nonsense;") is None
        client.socket.close()


SEEING = """<trial name="seeing" duration="3"><stage><wall points="6,-4 6,4" /></stage><crowd type="orca"/>
  <robot name="robot" x="0" y="0"><drive type="differential-drive" max-speed="1"/><goal x="5" y="0"/>
    <navigator type="external"/><sensor name="depth" type="depth-camera" width="8" height="6"/>
    <sensor name="eye" type="rgb-camera" width="32" height="24" rate="10"/>
    <sensor name="scan" type="lidar2d" rays="5" field-of-view="1.6" range-min="0.1" range-max="9"/>
    <sensor name="pulses" type="pulsed-lidar2d" rays="3" field-of-view="0.2"/>
  </robot>
</trial>"""


@pytest.mark.live
def test_the_picture_of_a_camera_is_a_jpeg_file_as_the_clients_read_it():
    running, server = run_server(parse_trial(SEEING, place="seeing"))
    with running:
        client = Client(server.port)
        client.ask("clock=0;vel_cmd=0.5 0;sim_control=i;")
        first = client.ask("clock=0.2;vel_cmd=0.5 0;sim_control=i;")
        later = client.ask("clock=1.0;vel_cmd=0.5 0;sim_control=i;")
        client.socket.close()
    pictures = [Image.open(io.BytesIO(base64.b64decode(item["camera"]))) for item in (first, later)]
    assert [(picture.format, picture.size) for picture in pictures] == [("JPEG", (32, 24))] * 2
    assert pictures[0].tobytes() != pictures[1].tobytes(), "the robot has moved"


@pytest.mark.live
def test_the_scans_of_the_lasers_are_numbers_of_the_latest_measurement():
    running, server = run_server(parse_trial(SEEING, place="seeing"))
    with running:
        client = Client(server.port)
        first = client.ask("clock=0.2;vel_cmd=0 0;sim_control=i;")
        later = client.ask("clock=2.0;vel_cmd=1 0;sim_control=i;")
        client.socket.close()
    assert [topic for topic in first if topic.startswith("lidar")] == ["lidar", "lidar_pulses"]
    stamp, begin, step, *ranges = numbers(first["lidar"])
    assert 0.0 <= stamp <= 0.2
    angles = [math.radians(begin + k * step) for k in range(5)]
    assert angles[2] == pytest.approx(0.0, abs=1e-6)
    assert angles[-1] - angles[0] == pytest.approx(4 * math.radians(step))
    assert ranges[2] == pytest.approx(6.0, abs=0.01)  # the wall
    assert ranges[1] == ranges[3] == pytest.approx(6.0 / math.cos(angles[1]), abs=0.01)
    assert (ranges[0], ranges[4]) == (math.inf, math.inf)
    moved = numbers(later["lidar"])
    assert (1.8 < moved[0] <= 2.0, moved[5] < 5.9) == (True, True)
    assert len(numbers(first["lidar_pulses"])) == 3 + 3


def test_a_scan_has_twelve_bytes_a_beam_at_most_and_says_whom_it_met_to_nobody():
    labelled, hidden = sent(True)["/robot/scan"], sent(False)["/robot/scan"]
    assert len(labelled.intensities) == len(labelled.ranges) == 60  # the people of the beams
    text = encode_scan(labelled)
    assert text == encode_scan(hidden)
    assert len(text.split()) == 3 + 60
    labelled.ranges = np.float32([-1.234567e-38, math.nan, -math.inf] * 20)
    assert len(encode_scan(labelled)) <= 60 + 12 * 60


@pytest.mark.live
def test_the_client_of_the_page_stops_before_a_wall_and_keeps_a_picture(tmp_path):
    follow_page("challenge-tcp", tmp_path)
    running, server = run_server(load_trial(tmp_path / "corridor.xml"))
    with running:
        program = begin([sys.executable, "see.py", str(server.port)], tmp_path, os.environ)
        out, errors = program.communicate(timeout=120)
        running.end()
    assert (program.returncode, errors) == (0, "")
    assert out.startswith("180 beams, the nearest ahead 1.")
    with Image.open(tmp_path / "last.jpg") as picture:
        assert (picture.format, picture.size) == ("JPEG", (160, 120))


@pytest.mark.live
def test_a_robot_without_a_camera_sends_what_the_challenge_sent_before_the_first_picture():
    running, server = run_server(load_trial("frontal", duration=1.0))
    with running:
        client = Client(server.port)
        assert client.ask("clock=0.1;vel_cmd=0 0;")["camera"] == "JPG"
        client.socket.close()


@given(st.text(max_size=60))
def test_a_request_is_read_or_refused_with_a_sentence(text):
    try:
        request = read_request(text)
    except InputError as error:
        problem = str(error)
    else:
        problem = "" if request.control in "inprfls" else request.control
    assert problem == "" or len(problem) > 10


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("clock=-1;", "clock=-1 must be from 0 to 1e6 s"),
        ("vel_cmd=1;", "must have 2 finite numbers"),
        ("vel_cmd=nan 0;", "must have 2 finite numbers"),
        ("sim_control=x;", "must be one of i, n, p, r, f, l, s"),
        ("speed=1;", "there is no key 'speed'; keys are clock"),
    ],
)
def test_bad_requests(text, message):
    with pytest.raises(InputError, match=message):
        read_request(text)


def test_addresses():
    assert open_transport("tcp:26000").port == 26000
    assert read_request("vel_cmd=1 180;").commands[""] == (1.0, math.pi)
    assert format_reply(1, {}) == b"@"
    with pytest.raises(InputError, match="tcp:here must be tcp or tcp:PORT, such as tcp:25001"):
        open_transport("tcp:here")
