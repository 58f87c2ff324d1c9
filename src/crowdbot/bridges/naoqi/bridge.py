"""NaoqiBridge: the transport ``naoqi``, virtual sensors for a real robot with NAOqi.

Readings become values of ``ALMemory`` under the keys of the real sensors, from the NAOqi documentation 2.5. The
horizontal lasers have 15 points each, x forward and y left in the frame of the device [m], from the leftmost
(``Seg01``) to the rightmost. The virtual robot follows the odometry of the real one.
"""

from __future__ import annotations

import contextlib
import importlib.util
import json
import math
import subprocess
import sys
import threading
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.join.join_run import StartAlignment
from crowdbot.bridges.transport import is_among
from crowdbot.core import InputError, import_optional, refuse_system, wrap_angle
from crowdbot.messages import points_in
from crowdbot.recording import StepMessage

from .robot_link import UNREAD

PLATFORM = "Device/SubDeviceList/Platform"
SEGMENTS = 15
BUMPERS = ("FrontLeft", "Back", "FrontRight")
"""Bumpers counter-clockwise from straight ahead, as the sectors of the virtual bumper."""


def _laser(side: str, message: Any) -> dict[str, float]:
    """Return the points of a laser; where it sees nothing, they are at its largest range."""
    angles = message.angle_min + message.angle_increment * np.arange(len(message.ranges))
    ranges = np.clip(np.nan_to_num(message.ranges, nan=message.range_max), 0.0, message.range_max)
    wanted = np.linspace(angles[-1], angles[0], SEGMENTS)
    distance = np.interp(wanted, angles, ranges)
    laser = {}
    for k, (x, y) in enumerate(zip(distance * np.cos(wanted), distance * np.sin(wanted), strict=True), 1):
        for axis, value in (("X", x), ("Y", y)):
            laser[f"{PLATFORM}/LaserSensor/{side}/Horizontal/Seg{k:02}/{axis}/Sensor/Value"] = float(value)
    return laser


def _sonar(side: str, message: Any) -> dict[str, float]:
    """Return the distance of an ultrasound [m]; where it hears nothing, its largest range."""
    distance = min(max(float(message.range), 0.0), float(message.max_range))
    return {f"{PLATFORM}/{side}/Sonar/Sensor/Value": distance}


def _bumper(message: Any) -> dict[str, float]:
    """Return the switches of the bumper: 1 pressed, 0 not."""
    pressed = {int(item) for item in points_in(message)["sector"].ravel()}
    return {f"{PLATFORM}/{name}/Bumper/Sensor/Value": float(k in pressed) for k, name in enumerate(BUMPERS)}


SENSORS: dict[str, tuple[str, Callable[[Any], dict[str, float]]]] = {
    "base_laser_front": ("sensor_msgs/msg/LaserScan", lambda message: _laser("Front", message)),
    "base_laser_left": ("sensor_msgs/msg/LaserScan", lambda message: _laser("Left", message)),
    "base_laser_right": ("sensor_msgs/msg/LaserScan", lambda message: _laser("Right", message)),
    "sonar_front": ("sensor_msgs/msg/Range", lambda message: _sonar("Front", message)),
    "sonar_back": ("sensor_msgs/msg/Range", lambda message: _sonar("Back", message)),
    "bumper": ("sensor_msgs/msg/PointCloud2", _bumper),
}
"""Sensors of a virtual Pepper that the memory knows, with their message type."""


def memory_values(sensor: str, message: Any) -> dict[str, float]:
    """Return the values of a reading by their key.

    Args:
        sensor: name of the sensor, one of :data:`SENSORS`.
        message: its message.

    >>> from crowdbot.messages import Messages
    >>> make = Messages()
    >>> header = make.header(0)
    >>> echo = make.make("sensor_msgs/msg/Range", header=header, radiation_type=0, field_of_view=0.5, min_range=0.2,
    ...                  max_range=5.0, range=float("inf"))
    >>> memory_values("sonar_front", echo)
    {'Device/SubDeviceList/Platform/Front/Sonar/Sensor/Value': 5.0}
    """
    return SENSORS[sensor][1](message)


GAIN = 2.0
"""Velocity that corrects an error of the pose [1/s]."""
LARGEST = 2.0
"""Error of the position [m] above which a robot was moved by hand, and the poses are aligned anew."""

Pose = tuple[float, float, float]


class OdometryFollower:
    """Makes velocity commands that keep a virtual robot at the odometry of a real one.

    A command is the velocity of the real robot, plus a correction of the distance between both. Velocities alone would
    part them: each one counts until the next arrives, and the virtual robot accelerates in its own way. The origin of
    odometry is anywhere, so the first pose after :meth:`align` is that of the virtual robot at this moment.

    Args:
        x, y: position of the virtual robot at the start [m].
        heading: its heading [rad].

    >>> follower = OdometryFollower(1.0, 2.0, math.pi / 2)
    >>> follower.command((0.5, 0.0, 0.0), (7.0, 7.0, 0.0))
    (0.5, 0.0, 0.0)
    >>> [round(one, 3) for one in follower.command((0.0, 0.0, 0.0), (7.1, 7.0, 0.0))]  # the virtual robot is behind
    [0.2, 0.0, 0.0]
    """

    def __init__(self, x: float, y: float, heading: float) -> None:
        self._virtual: Pose = (x, y, heading)
        self._frame: StartAlignment | None = None
        self._lock = threading.Lock()

    def align(self) -> None:
        """Take the next pose of the real robot as that of the virtual one, after a new connection."""
        with self._lock:
            self._frame = None

    def note_virtual(self, x: float, y: float, heading: float) -> None:
        """Note the pose of the virtual robot."""
        with self._lock:
            self._virtual = x, y, heading

    def command(self, velocity: Sequence[float], pose: Sequence[float]) -> tuple[float, float, float]:
        """Return the command for the virtual robot: forward, left [m/s], turn [rad/s].

        Args:
            velocity: the same of the real robot.
            pose: x, y [m], heading [rad] of its odometry.
        """
        with self._lock:
            dx, dy, turn = self._error(pose)
            if math.hypot(dx, dy) > LARGEST:
                self._frame = None
                dx, dy, turn = self._error(pose)
            cos, sin = math.cos(self._virtual[2]), math.sin(self._virtual[2])
        ahead, aside = math.cos(turn), math.sin(turn)
        forward = ahead * velocity[0] - aside * velocity[1] + GAIN * (cos * dx + sin * dy)
        left = aside * velocity[0] + ahead * velocity[1] + GAIN * (cos * dy - sin * dx)
        return forward, left, velocity[2] + GAIN * turn

    def _error(self, pose: Sequence[float]) -> Pose:
        """Return how far the real robot is from the virtual one: x, y [m] in the trial, heading [rad]."""
        if self._frame is None:
            self._frame = StartAlignment(*self._virtual)
        x, y, heading = self._frame.pose(pose[0], pose[1], pose[2])
        return x - self._virtual[0], y - self._virtual[1], wrap_angle(heading - self._virtual[2])


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
        self.unread: list[float] = []
        """Times [s] for which the velocity of the robot was not read: a shorter command counts in its odometry only."""
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
        known = {output.name: output.kind for output in interface.outputs}
        for robot in interface.trial.robots:
            topics = {f"/{robot.name}/{sensor}": sensor for sensor in SENSORS}
            self._topics = {topic: item for topic, item in topics.items() if known.get(topic) == SENSORS[item][0]}
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
        elif "unread" in fields:
            self.unread.append(fields["unread"][1] - fields["unread"][0])
        elif "lost" in fields:
            self._problem = fields["lost"]
        elif "reads" in fields:
            self.reads, self.seen, self.cycle = fields["reads"], fields["virtual"], fields["cycle"]

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Write the readings of a step into the memory."""
        values: dict[str, float] = {}
        for message in messages:
            if message.topic == self._truth and self._follower is not None:
                place, turn = message.message.pose.pose.position, message.message.pose.pose.orientation
                self._follower.note_virtual(place.x, place.y, 2.0 * math.atan2(turn.z, turn.w))
            elif message.topic in self._topics:
                values |= memory_values(self._topics[message.topic], message.message)
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
        return is_among(topic, (*self._topics, self._truth))

    def stop(self) -> None:
        """Disconnect; the robot rewrites all values within a cycle."""
        self._stopped = True
        self._close()

    def remark(self) -> str:
        """Return how many reads saw the virtual values, and for how long the velocity of the robot was not read."""
        remarks = []
        if self.reads:
            cycle = f", which rewrites them every {1e3 * self.cycle:.1f} ms" if self.cycle else ""
            share = 100 * self.share
            remarks.append(f"{share:.0f} % of {self.reads} reads saw the virtual values of the robot{cycle}")
        if self.unread:
            remarks.append(
                f"{len(self.unread)} times, the velocity of the robot was not read for more than {1e3 * UNREAD:.0f} ms"
                f" (at most {1e3 * max(self.unread):.0f} ms), and the virtual robot followed its odometry alone"
            )
        return f"naoqi: {'; '.join(remarks)}" if remarks else ""

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
