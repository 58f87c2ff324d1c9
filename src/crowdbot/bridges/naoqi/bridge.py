"""NaoqiBridge: the transport ``naoqi``, virtual sensors for a real robot with NAOqi."""

from __future__ import annotations

import contextlib
import importlib.util
import json
import math
import subprocess
import sys
import threading
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.core import InputError, import_optional, refuse_system
from crowdbot.recording import StepMessage

from .memory_keys import SENSORS, memory_values
from .odometry_follower import OdometryFollower

PORT = 9559
STARTUP, ENDING = 10.0, 5.0
"""Longest real time [s] of the first connection, and of the end."""


class NaoqiBridge:
    """Overwrites the sensor values in the memory of a Pepper with those of the first virtual robot.

    Programs on the robot, and its own collision avoidance where it reads the memory, then see virtual people. The
    virtual robot follows the odometry of the real one, which its motion service tells. Nothing is ever commanded to the
    robot.

    The robot rewrites its memory in each cycle, so that some reads still see the real values; :attr:`share` tells how
    many do not.

    Args:
        url: address of the robot, such as ``tcp://192.168.0.5:9559``.

    Raises:
        MissingExtra: qi is not installed.
        InputError: the address is none, or there is no qi for this system.
    """

    name = "naoqi"

    def __init__(self, url: str) -> None:
        if sys.platform != "linux" and importlib.util.find_spec("qi") is None:
            refuse_system("the bridge naoqi", "Linux on x86-64, for the package qi", "run crowdbot on such a computer")
        import_optional("qi", "the bridge naoqi", "naoqi")
        scheme, sign, rest = url.partition("://")
        if not sign or scheme not in ("tcp", "tcps") or not rest:
            raise InputError(f"naoqi:{url[:60]} must be naoqi:HOST or naoqi:tcp://HOST:PORT")
        self.url = url
        self.reads = self.seen = 0
        """Reads of the memory at random moments, and those that saw the virtual values."""
        self.cycle = 0.0
        """Real time [s] between two rewrites of the robot, 0 if there were none."""
        self.connections = 0
        """Number of connections until now."""
        self._robot, self._truth, self._topics = "", "", dict[str, str]()
        self._follower: OdometryFollower | None = None
        self._inbox: Inbox | None = None
        self._process: subprocess.Popen[str] | None = None
        self._thread: threading.Thread | None = None
        self._connected, self._problem = threading.Event(), ""
        self._stopped = False

    @classmethod
    def of(cls, address: str) -> NaoqiBridge:
        """Return the bridge of an address on the command line: ``HOST``, ``HOST:PORT`` or ``tcp://HOST:PORT``.

        Raises:
            InputError: the address is none.
        """
        if address and "://" not in address:
            address = f"tcp://{address}" if ":" in address else f"tcp://{address}:{PORT}"
        return cls(address)

    @property
    def share(self) -> float:
        """Share of the reads that saw the virtual values, NaN without reads."""
        return self.seen / self.reads if self.reads else float("nan")

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Connect to the robot, or take the sensors of another trial.

        Raises:
            InputError: the robot does not answer, or no robot of the trial has sensors that NAOqi knows.
        """
        self._inbox = inbox
        self._topics = {}
        known = {one.name: one.kind for one in interface.outputs}
        for robot in interface.trial.robots:
            topics = {f"/{robot.name}/{sensor}": sensor for sensor in SENSORS}
            self._topics = {topic: one for topic, one in topics.items() if known.get(topic) == SENSORS[one][0]}
            if self._topics:
                self._robot, self._truth = robot.name, f"/{robot.name}/ground_truth/odom"
                self._follower = OdometryFollower(robot.x, robot.y, robot.heading)
                break
        else:
            raise InputError(f'naoqi needs a robot with sensors such as {", ".join(SENSORS)}: <robot type="pepper">')
        if self._process is None:
            self._open()

    def _open(self) -> None:
        self._begin()
        if not self._connected.wait(STARTUP):
            self.stop()
            raise InputError(f"naoqi cannot connect to {self.url}: {self._problem or 'no answer'}")

    def _begin(self) -> None:
        """Start the process that writes the memory."""
        self._process = subprocess.Popen(  # noqa: S603, fixed words
            [sys.executable, str(Path(__file__).with_name("robot_link.py")), self.url],
            stdin=subprocess.PIPE,
            stdout=subprocess.PIPE,
            stderr=subprocess.DEVNULL,
            text=True,
        )
        self._thread = threading.Thread(target=self._read, args=(self._process,), name="naoqi", daemon=True)
        self._thread.start()

    def _read(self, process: subprocess.Popen[str]) -> None:
        """Take the lines of the process."""
        assert process.stdout is not None
        for line in process.stdout:
            self._take(json.loads(line))

    def _take(self, fields: dict[str, Any]) -> None:
        if "velocity" in fields and self._inbox is not None and self._follower is not None:
            forward, left, turn = self._follower.command(fields["velocity"], fields["pose"])
            twist = {"linear": {"x": forward, "y": left}, "angular": {"z": turn}}
            with contextlib.suppress(InputError):  # the robot is not driven from outside
                self._inbox.receive(f"/{self._robot}/cmd_vel", twist, self.name)
        elif "connected" in fields:
            self.connections += 1
            if self._follower is not None:
                self._follower.align()
            self._connected.set()
        elif "lost" in fields:
            self._problem = fields["lost"]
        elif "reads" in fields:
            self.reads, self.seen, self.cycle = fields["reads"], fields["virtual"], fields["cycle"]

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Write the readings of a step into the memory."""
        values: dict[str, float] = {}
        for one in messages:
            if one.topic == self._truth and self._follower is not None:
                place, turn = one.message.pose.pose.position, one.message.pose.pose.orientation
                self._follower.note_virtual(place.x, place.y, 2.0 * math.atan2(turn.z, turn.w))
            elif one.topic in self._topics:
                values |= memory_values(self._topics[one.topic], one.message)
        if values:
            self._send(values)

    def _send(self, values: dict[str, float]) -> None:
        process = self._process
        if process is None or process.stdin is None or self._stopped:
            return
        try:
            process.stdin.write(json.dumps({"values": values}) + "\n")
            process.stdin.flush()
        except OSError:  # the process was killed
            self._close()
            self._begin()

    def poll(self) -> None:
        """Do nothing: a thread gives what arrives to the inbox."""

    def report(self, level: str, text: str) -> None:
        """Do nothing: the memory of a robot has no place for remarks."""

    def wants(self, topic: str) -> bool:
        """Return whether a topic is written into the memory, or tells where the virtual robot is."""
        needed = (*self._topics, self._truth)
        if not topic.endswith("/"):
            return topic in needed
        return any(one == topic[:-1] or one.startswith(topic) for one in needed)

    def stop(self) -> None:
        """Disconnect; the robot rewrites all values within a cycle."""
        self._stopped = True
        self._close()

    def remark(self) -> str:
        """Return how many reads saw the virtual values."""
        if not self.reads:
            return ""
        cycle = f", which rewrites them every {1e3 * self.cycle:.1f} ms" if self.cycle else ""
        return f"naoqi: {100 * self.share:.0f} % of {self.reads} reads saw the virtual values of the robot{cycle}"

    def _close(self) -> None:
        process, thread = self._process, self._thread
        if process is None or thread is None:
            return
        with contextlib.suppress(OSError, ValueError):
            assert process.stdin is not None
            process.stdin.close()
        try:
            process.wait(ENDING)
        except subprocess.TimeoutExpired:
            process.kill()
            process.wait()
        thread.join(ENDING)
        assert process.stdout is not None
        process.stdout.close()
