"""Runs with a robot program in a process of its own, alike for all transports.

    python partner_runs.py loop|kills|deaths|server_deaths|odd|faulty|load|ages TRANSPORT NUMBER FOLDER

It prints one line of JSON; so a run can be in a network of its own.
"""

import contextlib
import dataclasses
import json
import os
import random
import signal
import socket
import subprocess
import sys
import time
from pathlib import Path

import pytest
from bridge_runs import MemoryTransport, Running, endless_trial, wait
from partner import stamped_twist_of
from ros1_master import PYTHON, RosMaster

from crowdbot.benchmark.speed import bridge_viewer
from crowdbot.benchmark.speed.bridge_loads import LOAD_TOPICS, LOADED_BRIDGES, LoadTraffic, bridge_load
from crowdbot.bridges import BridgeClock, Inbox, RobotInterface, open_transport, run_bridge
from crowdbot.bridges.stack_link import lock_domain
from crowdbot.core import CrowdbotError
from crowdbot.recording import read_episode, replay
from crowdbot.trials import load_trial

HERE = Path(__file__).parent
VIEWER = bridge_viewer.__file__
ENDLESS = ("--set", "duration=3600", "--set", "end/collision=false", "--set", "end/goal=false")
OWN = {name: os.environ[name] for name in ("PYTHONPATH",) if name in os.environ}
"""Variables that programs of ROS 1 must not have, and the simulation may need."""
LOCAL = {"ROS_AUTOMATIC_DISCOVERY_RANGE": "LOCALHOST"}


def free_port():
    """Return a free port of the loopback interface."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        return probe.getsockname()[1]


class OtherServer(contextlib.AbstractContextManager):
    """A rosbridge server of others, in a process of its own."""

    def __init__(self):
        self.port = 0
        self.process = None
        self.start()

    def start(self):
        """Start it and wait until it listens."""
        words = [sys.executable, str(HERE / "other_server.py"), str(self.port)]
        self.process = subprocess.Popen(words, stdout=subprocess.PIPE, text=True)
        self.port = int(self.process.stdout.readline())  # the same after it was killed

    def stop(self):
        """Kill it."""
        self.process.kill()
        self.process.wait()
        self.process.stdout.close()

    def __exit__(self, *error):
        self.stop()


class Meeting(contextlib.ExitStack):
    """A transport of the simulation, and how programs reach it.

    Args:
        transport: its name on the command line.
        folder: a folder for logs.
    """

    def __init__(self, transport, folder, served=True):
        super().__init__()
        self.port = 0 if served else free_port()
        self.transport, self.words = transport, [sys.executable]
        self.environment = {**os.environ, "ROS_LOG_DIR": str(folder), **LOCAL}
        self.master = self.server = None
        if transport == "ros1":
            self.master = self.enter_context(RosMaster(folder))
            self.words, self.environment = [PYTHON], self.master.environment
        if transport == "rosbridge-client":
            self.server = self.enter_context(OtherServer())
        self.domain, release = lock_domain()
        self.callback(release)
        self.node = open_transport(self.opening) if served else None

    @property
    def opening(self):
        """Text that opens the transport."""
        address = {
            "ros1": self.master and self.master.url,
            "rosbridge-client": f"ws://127.0.0.1:{self.server.port}" if self.server else "",
        }.get(self.transport) or str(self.domain if self.transport == "ros2" else self.port)
        return f"{self.transport}:{address}"

    @property
    def address(self):
        """Where programs find it."""
        if self.transport in ("ros1", "ros2"):
            return str(self.domain)
        return f"127.0.0.1:{self.server.port if self.server else self.port or self.node.port}"

    def open(self, mode, seconds):
        """Start a program."""
        words = [*self.words, str(HERE / "partner.py"), self.transport, self.address, mode, str(seconds)]
        process = subprocess.Popen(
            words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, env=self.environment
        )
        return process

    def watch(self):
        """Start a program that receives the topics of :data:`LOAD_TOPICS`, and wait until it is connected."""
        if not self.server:
            return self.start("view", 600.0)
        words = [sys.executable, VIEWER, "rosbridge", str(self.server.port), *LOAD_TOPICS]
        process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)
        assert process.stdout.readline() == "ready\n"
        return process

    def start(self, mode, seconds):
        """Start a program and wait until it is connected."""
        process = self.open(mode, seconds)
        if process.stdout.readline() != "ready\n":
            process.kill()
            pytest.fail(process.communicate()[1])
        return process


def told(process, seconds):
    """Return what a program has printed at its end."""
    out, errors = process.communicate(timeout=seconds)
    assert process.returncode == 0, errors
    return json.loads(out.splitlines()[-1])


def loop(transport, seconds, folder):
    """Let a program answer each tick at 20 Hz, and return the numbers of commands and their latency [s]."""
    with Meeting(transport, folder) as meeting, Running(endless_trial(seconds + 200.0), [meeting.node]) as running:
        inbox = running.run.port.inbox
        seen = told(meeting.start("drive", seconds), seconds + 60.0)
        with contextlib.suppress(BaseException):
            wait(lambda: inbox.count.received >= seen["sent"], 5.0)
        latency = inbox.latency.summary()
        return {**seen, "received": inbox.count.received, **latency._asdict()}


def kills(transport, count, folder):
    """Kill a driving program some times, and return the stops of the robot [s] and what the recording holds."""
    rng, stops = random.Random(count), []
    memory = OdometryMemory()
    trial, out = endless_trial(3600.0), folder / "out"
    with Meeting(transport, folder) as meeting, Running(trial, [meeting.node, memory], out=out) as running:
        inbox = running.run.port.inbox
        for _ in range(count):
            before = inbox.count.received
            process = meeting.start("drive", 600.0)
            wait(lambda before=before: inbox.count.received > before + 5)
            time.sleep(rng.uniform(0.0, 0.3))
            process.kill()
            process.communicate()
            stops.append(time_until_still(memory))
    return {"stops": stops, **recording_of(folder / "out" / "episode.mcap")}


class OdometryMemory(MemoryTransport):
    """Keeps the latest true odometry of the robot."""

    def __init__(self, topic="/robot/ground_truth/odom"):
        super().__init__((topic,))

    def publish(self, messages):
        self.sent = [message for message in messages if message.topic in self.topics] or self.sent


def time_until_still(memory):
    """Wait until the robot stands, and return the real time [s] until then."""
    begin = time.monotonic()
    wait(lambda: speed(memory) == 0.0, 10.0)
    return time.monotonic() - begin


def recording_of(path):
    """Return what an episode holds, and whether it replays to the byte."""
    episode = read_episode(path)
    moved = float(abs(episode.velocity[:, episode.robots[0]]).max())
    return {"outcome": episode.metadata["outcome"], "speed": moved, "equal": replay(path).equal}


def server_deaths(transport, count, folder):
    """Kill the server that the simulation and the program have joined, and return the same as :func:`kills`."""
    rng, stops = random.Random(count), []
    memory = OdometryMemory()
    trial, out = endless_trial(3600.0), folder / "out"
    with Meeting(transport, folder) as meeting, Running(trial, [meeting.node, memory], out=out) as running:
        inbox = running.run.port.inbox
        program = meeting.start("drive", 3600.0)
        meeting.callback(program.wait)
        meeting.callback(program.kill)
        for _ in range(count):
            before = inbox.count.received
            wait(lambda before=before: inbox.count.received > before + 5)
            time.sleep(rng.uniform(0.0, 0.3))
            meeting.server.stop()
            stops.append(time_until_still(memory))
            meeting.server.start()
        before = inbox.count.received
        wait(lambda: inbox.count.received > before + 5)
        program.send_signal(signal.SIGTERM)
        seen = told(program, 60.0)
    return {**seen, "stops": stops, **recording_of(folder / "out" / "episode.mcap")}


def deaths(transport, count, folder):
    """Kill the simulation some times, and return what the program has noticed and what the recordings hold."""
    rng, orders, complete = random.Random(count), [], []
    with Meeting(transport, folder, served=False) as meeting:
        words = [sys.executable, "-m", "crowdbot", "run", "frontal", *ENDLESS, "--bridge", meeting.opening, "--out"]
        program = meeting.open("drive", 3600.0)
        meeting.callback(program.wait)
        meeting.callback(program.kill)
        for k in range(count):
            out = folder / f"out{k}"
            process = subprocess.Popen(
                [*words, str(out)], env=meeting.environment | OWN, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL
            )
            meeting.callback(process.wait)
            meeting.callback(process.kill)
            wait(lambda out=out: number_of_orders(out) > 5 or program.poll() is not None, 120.0, 0.5)
            if program.poll() is not None:
                pytest.fail(program.communicate()[1])
            time.sleep(rng.uniform(0.0, 1.0))
            process.kill()
            process.wait()
            time.sleep(1.5)  # as long as the program needs to notice silence
            episode = read_episode(out / "episode.mcap")
            orders.append(len(episode.orders))
            complete.append(episode.complete)
        program.send_signal(signal.SIGTERM)
        return {**told(program, 60.0), "orders": orders, "complete": complete}


def number_of_orders(folder):
    """Return the number of orders in a recording that grows."""
    with contextlib.suppress(CrowdbotError, OSError):
        return len(read_episode(folder / "episode.mcap").orders)
    return 0


def speed(memory):
    """Return the latest speed of the robot."""
    return abs(memory.sent[-1].message.twist.twist.linear.x)


def odd(transport, seconds, folder):
    """Follow the time of a program in odd portions, and return the digests of this run and of a free one."""
    trial = load_trial("frontal", duration=float(seconds))
    with Meeting(transport, folder) as meeting, Running(trial, [meeting.node], "follow") as running:
        process = meeting.start("clock", seconds)
        done = running.end(120.0)
        running.run.port.stop()
        seen = told(process, 150.0)
    free = run_bridge(trial, [], 0, None, BridgeClock("free"))
    return {**seen, "steps": done.steps, "digest": done.digest, "free": free.digest}


class Times(MemoryTransport):
    """Keeps when each instant was sent: real and simulated time [ns]."""

    def __init__(self):
        super().__init__(("/clock",))

    def publish(self, messages):
        self.sent += [(time.monotonic_ns(), item.nanoseconds) for item in messages if item.topic == "/clock"]


def ages(transport, count, folder):
    """Return the simulated ages [s] of what a reader gets that takes one message in 0.5 s, after the first second."""
    times = Times()
    with Meeting(transport, folder) as meeting, Running(endless_trial(600.0), [meeting.node, times]):
        rows = told(meeting.start("slow", count), 150.0)["rows"]
    return [(max(now for real, now in times.sent if real <= taken) - stamp) / 1e9 for taken, stamp in rows[2:]]


def faulty(transport, count, folder):
    """Run in step with programs that answer late, several times and out of order; return the digests and a free one."""
    trial, digests, stale, sent = endless_trial(1.5), [], [], []
    for seed in range(count):
        with Meeting(transport, folder) as meeting, Running(trial, [meeting.node], "commands") as running:
            process = meeting.open("faulty", seed)
            meeting.callback(process.kill)
            done = running.end(120.0)
            stale.append(running.run.port.inbox.count.stale)
            running.run.port.stop()
            process.send_signal(signal.SIGTERM)
            sent.append(told(process, 60.0)["sent"])
        digests.append(done.digest)
    free = run_bridge(trial, [Answers()], 0, None, BridgeClock("free"))
    return {"digests": digests, "free": free.digest, "sent": sent, "stale": stale}


class Answers(MemoryTransport):
    """The answers of a program without faults, in memory."""

    def publish(self, messages):
        for item in (message for message in messages if message.topic == "/tf"):
            self.inbox.receive("/robot/cmd_vel", stamped_twist_of(item.nanoseconds), self.name)


def load(transport, seconds, folder):
    """Return the share of a core of a bridge that sends scan, odometry, transforms and image at once, and latencies."""
    if transport in LOADED_BRIDGES:
        return dataclasses.asdict(bridge_load(transport, float(seconds)))
    traffic = LoadTraffic()
    with Meeting(transport, folder) as meeting:
        node, interface = meeting.node, RobotInterface.of(traffic.trial)
        inbox = Inbox(interface)
        node.start(interface, inbox)
        meeting.callback(node.stop)
        viewer = meeting.watch()
        wait(lambda: all(node.wants(topic) for topic in LOAD_TOPICS if (transport, topic) != ("ros2", "/tf")))
        share, took = traffic.measure(node, inbox, float(seconds))
        if meeting.server:
            viewer.stdin.write("\n")
            viewer.stdin.flush()
        else:
            viewer.send_signal(signal.SIGTERM)
        answers = inbox.latency.summary()
        latency = {"p50": 1e3 * answers.median, "p99": 1e3 * answers.p99}
        return {"share": share, "seconds": took, **latency, **told(viewer, 60.0)}


def main():
    """Run one of them."""
    name, transport, number, folder = sys.argv[1:]
    work = {
        "loop": loop,
        "kills": kills,
        "odd": odd,
        "deaths": deaths,
        "server_deaths": server_deaths,
        "faulty": faulty,
        "load": load,
        "ages": ages,
    }[name]
    print(json.dumps(work(transport, int(number), Path(folder))))


if __name__ == "__main__":
    main()
