"""Processor time of bridges that send a scan, odometry, transforms and an image, for ``crowdbot bench``."""

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

from crowdbot.bridges import Inbox, RobotInterface, Transport, open_transport
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
SHARE = 0.25
"""Largest processor time of a bridge over real time."""
PATIENCE = 60.0
"""Longest real time [s] until the viewer is connected."""


@dataclasses.dataclass(frozen=True)
class BridgeLoad:
    """What a bridge has done.

    Fields:
        share: processor time of all threads of the bridge over real time.
        messages: messages that have arrived.
        bytes: bytes that have arrived.
        seconds: real time [s].
    """

    share: float
    messages: int
    bytes: int
    seconds: float


def bridge_measurements() -> dict[str, Callable[[], Gauge]]:
    """Return functions that measure the processor time of bridges, by name.

    A bridge sends a scan of 1080 beams and an image of 640 x 480 pixels at 10 Hz, and odometry and transforms at
    20 Hz, to a viewer in another process. The simulation itself is not counted.

    >>> sorted(bridge_measurements())
    ['bridge-foxglove', 'bridge-rosbridge', 'bridge-rosbridge-cbor']
    """
    return {f"bridge-{name}": functools.partial(_load, name) for name in LOADED_BRIDGES}


def _load(name: str) -> Gauge:
    words = f"{100 * SHARE:g} % of a core: 1080 beams, 640 x 480 pixels at 10 Hz, odometry, tf"
    return Gauge("CPU s/s", bridge_load(name).share, words, SHARE)


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
    transport.start(interface, Inbox(interface))
    try:
        with _viewer(connection, transport) as viewer:
            share, took = traffic.measure(transport, seconds)
            told = json.loads(viewer.communicate("\n", timeout=PATIENCE)[0].splitlines()[-1])
    finally:
        transport.stop()
    return BridgeLoad(share, told["messages"], told["bytes"], took)


class LoadTraffic:
    """Steps with a scan of 1080 beams and an image of 640 x 480 pixels at 10 Hz, odometry and transforms at 20 Hz.

    They are simulated before, so sending them costs what the bridge costs.
    """

    def __init__(self) -> None:
        self.trial = _trial()
        simulation, self._frames = _frames(self.trial)
        self._steps = StepMessages(self.trial, {}, simulation)

    def measure(self, transport: Transport, seconds: float) -> tuple[float, float]:
        """Return the processor time of this process over real time while a transport sends, and the real time [s]."""
        self.send(transport, WARM)
        begin, spent = time.perf_counter(), time.process_time()
        self.send(transport, seconds)
        took = time.perf_counter() - begin
        return (time.process_time() - spent) / took, took

    def send(self, transport: Transport, seconds: float) -> None:
        """Send steps in real time, each with a time of its own, for some seconds."""
        begin = time.perf_counter()
        for k in range(round(seconds / self.trial.step)):
            time.sleep(max(0.0, begin + k * self.trial.step - time.perf_counter()))
            frame = self._frames[k % len(self._frames)]
            transport.publish(list(self._steps.messages(frame, lambda topic: topic in LOAD_TOPICS or _is_part(topic))))
            transport.poll()


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


def _is_part(topic: str) -> bool:
    return topic.endswith("/") and any(item == topic[:-1] or item.startswith(topic) for item in LOAD_TOPICS)


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
