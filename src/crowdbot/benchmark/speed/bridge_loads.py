"""Bridges that send a scan, odometry, transforms and an image: processor time, latency and age."""

from __future__ import annotations

import contextlib
import dataclasses
import functools
import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

from crowdbot.bridges import CommandLatency, Inbox, RobotInterface, Transport, is_among, open_transport
from crowdbot.core import InputError, SpatialPose
from crowdbot.recording import StepMessages
from crowdbot.sensors import Lidar2D, RGBCamera
from crowdbot.simulation import Simulation, StepRecord
from crowdbot.trials import Mount, Trial, load_trial

from .measurement import Gauge

BEAMS, WIDTH, HEIGHT, RATE = 1080, 640, 480, 10.0
"""Beams of the scanner, size of the image [pixels], and rate of both [Hz]."""
SECONDS, WARM = 5.0, 1.0
"""Real time that is measured, and before it [s]."""
LOAD_TOPICS = ("/robot/scan", "/robot/odom", "/tf", "/robot/camera/image")
"""Topics that are sent."""
KEPT = 20
"""Number of steps whose records are sent again and again."""
LOADED_BRIDGES = ("rosbridge", "rosbridge-cbor", "foxglove")
"""Connections whose load is measured."""
BOUNDS = {
    "": ("CPU s/s", 0.25, "processor time"),
    "-p50": ("ms", 5.0, "median latency of commands"),
    "-p99": ("ms", 20.0, "99 % latency of commands"),
    "-age": ("s", 0.6, "largest age of the newest scan at a second client, which reads 2 scans/s"),
}
"""Unit, bound and meaning of each row, by the end of its name."""
PATIENCE = 60.0
"""Longest real time [s] until the viewer is connected."""


@dataclasses.dataclass(frozen=True)
class BridgeLoad:
    """What a bridge has done.

    Fields:
        share: processor time of all threads of the bridge over real time.
        p50, p99: real time from the messages of a step to the command that answers it, median and 99 % [ms].
        age: largest age [s] of a scan when a client takes it that reads two in a second.
        messages: messages that have arrived.
        bytes: bytes that have arrived.
        seconds: real time [s].
    """

    share: float
    p50: float
    p99: float
    age: float
    messages: int
    bytes: int
    seconds: float


def bridge_measurements() -> dict[str, Callable[[], Gauge]]:
    """Return functions that measure bridges under load, by name; the rows of a bridge are of one run.

    A bridge sends a scan of 1080 beams and an image of 640 x 480 pixels at 10 Hz, and odometry and transforms at
    20 Hz, to a program that answers each step with a command, and the scan to a slow reader. The simulation itself is
    not counted.

    >>> sorted(bridge_measurements())[:4]
    ['bridge-foxglove', 'bridge-foxglove-age', 'bridge-foxglove-p50', 'bridge-foxglove-p99']
    """
    load = functools.cache(bridge_load)

    def row(name: str, ending: str) -> Gauge:
        unit, bound, about = BOUNDS[ending]
        value = getattr(load(name), ending.removeprefix("-") or "share")
        return Gauge(unit, value, f"{bound:g} {unit}: {about}", bound)

    return {
        f"bridge-{name}{ending}": functools.partial(row, name, ending) for name in LOADED_BRIDGES for ending in BOUNDS
    }


def bridge_load(connection: str = "rosbridge", seconds: float = SECONDS) -> BridgeLoad:
    """Return the load of a bridge: 1080 beams and 640 x 480 pixels at 10 Hz, odometry and transforms at 20 Hz.

    The steps are simulated before. So the processor time of this process is that of the bridge: messages are made from
    the records and sent in real time. A viewer in another process receives them.

    Args:
        connection: ``rosbridge`` (JSON), ``rosbridge-cbor`` or ``foxglove``.
        seconds: real time that is measured [s].

    Raises:
        InputError: there is no such connection, or the viewer does not connect.
        MissingExtra: a package is not installed.
    """
    if connection not in LOADED_BRIDGES:
        raise InputError(f"load of {connection!r} is not measured; measured are {', '.join(LOADED_BRIDGES)}")
    traffic = LoadTraffic()
    interface = RobotInterface.of(traffic.trial)
    transport: Any = open_transport(f"{connection.partition('-')[0]}:0")
    inbox = Inbox(interface)
    transport.start(interface, inbox)
    try:
        with _viewer(connection, transport) as viewer:
            share, took = traffic.measure(transport, inbox, seconds)
            told = json.loads(viewer.communicate("\n", timeout=PATIENCE)[0].splitlines()[-1])
    finally:
        transport.stop()
    answers = inbox.latency.summary()
    if not answers.commands or not told["scans"]:
        raise InputError(f"the viewer of {connection} has sent {answers.commands} commands and read no scan")
    age = max(traffic.age(*row) for row in told["scans"])
    return BridgeLoad(share, 1e3 * answers.median, 1e3 * answers.p99, age, told["messages"], told["bytes"], took)


class LoadTraffic:
    """Steps with a scan of 1080 beams and an image of 640 x 480 pixels at 10 Hz, odometry and transforms at 20 Hz.

    They are simulated before, so sending them costs what the bridge costs.
    """

    def __init__(self) -> None:
        self.trial = _trial()
        simulation, self._frames = _frames(self.trial)
        self._steps = StepMessages(self.trial, {}, simulation)
        self._sent: list[tuple[int, int]] = []
        """Real and simulated time [ns] of the steps."""

    def age(self, taken: int, stamp: int) -> float:
        """Return the age [s] of a message with a stamp [ns] that a client took at a real time [ns]."""
        return (max(sent for real, sent in self._sent if real <= taken) - stamp) / 1e9

    def measure(self, transport: Transport, inbox: Inbox, seconds: float) -> tuple[float, float]:
        """Return the processor time of this process over real time while a transport sends, and the real time [s]."""
        self.send(transport, inbox, WARM)
        inbox.latency = CommandLatency()
        begin, spent = time.perf_counter(), time.process_time()
        self.send(transport, inbox, seconds)
        took = time.perf_counter() - begin
        return (time.process_time() - spent) / took, took

    def send(self, transport: Transport, inbox: Inbox, seconds: float) -> None:
        """Send steps in real time, each with a time of its own, for some seconds."""
        begin, wanted = time.perf_counter(), (*LOAD_TOPICS, "/clock")
        for k in range(round(seconds / self.trial.step)):
            time.sleep(max(0.0, begin + k * self.trial.step - time.perf_counter()))
            nanoseconds = round(len(self._sent) * self.trial.step * 1e9)
            frame = self._frames[len(self._sent) % KEPT]
            readings = tuple(
                (robot, mount, dataclasses.replace(reading, time=nanoseconds * 1e-9))
                for robot, mount, reading in frame.readings
            )
            frame = dataclasses.replace(frame, nanoseconds=nanoseconds, readings=readings)
            messages = list(self._steps.messages(frame, lambda topic: is_among(topic, wanted)))
            self._sent.append((time.monotonic_ns(), nanoseconds))
            inbox.latency.note_step()
            transport.publish(messages)
            transport.poll()
            inbox.take_orders()


def _trial() -> Trial:
    trial = load_trial("crossing-flows", duration=60.0)
    camera = RGBCamera(width=WIDTH, height=HEIGHT, rate=RATE)
    mounts = (Mount(sensor=Lidar2D(rays=BEAMS, rate=RATE), name="scan"), Mount(sensor=camera, name="camera", z=1.0))
    robot = dataclasses.replace(trial.robots[0], name="robot", sensors=mounts)
    return dataclasses.replace(trial, robots=(robot,))


def _frames(trial: Trial) -> tuple[Simulation, list[StepRecord]]:
    """Return a simulation without a camera, and records of its steps with images."""
    robot, camera = trial.robots[0], trial.robots[0].sensors[1]
    blind = dataclasses.replace(robot, sensors=robot.sensors[:1])
    simulation = Simulation(dataclasses.replace(trial, robots=(blind,)), 0)
    simulation.begin()
    frames = [simulation.record(0, due=True, collisions=False)]
    image = camera.sensor.read(frames[0].scene, SpatialPose.of((robot.x, robot.y, 1.0), robot.heading))
    for _ in range(KEPT - 1):
        simulation.advance()
        frames.append(simulation.record(0, due=True, collisions=False))
    return simulation, [
        dataclasses.replace(frame, readings=(*frame.readings, (robot, camera, image)) if frame.readings else ())
        for frame in frames
    ]


@contextlib.contextmanager
def _viewer(connection: str, transport: Any) -> Iterator[subprocess.Popen[str]]:
    """Start the viewer and wait until it receives all topics."""
    words = [
        sys.executable,
        str(Path(__file__).with_name("bridge_viewer.py")),
        connection,
        str(transport.port),
        *LOAD_TOPICS,
    ]
    viewer = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True)  # noqa: S603 (own file)
    try:
        assert viewer.stdout is not None
        if viewer.stdout.readline() != "ready\n":
            raise InputError(f"the viewer of {connection} has not connected")
        end = time.monotonic() + PATIENCE
        while not all(transport.wants(topic) for topic in LOAD_TOPICS):
            if time.monotonic() > end:
                raise InputError(f"the viewer of {connection} has not subscribed")
            transport.poll()
            time.sleep(0.01)
        yield viewer
    finally:
        viewer.kill()
        viewer.communicate()
