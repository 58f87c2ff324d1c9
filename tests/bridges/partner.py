"""A robot program in a process of its own, over one of the transports; it needs nothing of crowdbot.

    python partner.py TRANSPORT ADDRESS drive SECONDS
    python partner.py TRANSPORT ADDRESS faulty SEED
    python partner.py TRANSPORT ADDRESS clock SECONDS
    python partner.py TRANSPORT ADDRESS view SECONDS
    python partner.py TRANSPORT ADDRESS slow COUNT

``drive`` answers each tick of the clock with a velocity command, connects again when the simulation has gone, and at
its end prints one line of JSON. ``faulty`` answers each tick with a stamped command, and at random late, several times,
and again what it has answered before. ``clock`` is the time of a simulation that follows: it goes on in odd portions.
``view`` receives scan, odometry, transforms and image, answers each tick, and prints the numbers of messages and bytes.
``slow`` takes one scan in 0.5 s (over the protocol of requests, one reply), and prints when it took it and the time
that the scan says.
For rospy, ADDRESS is not used and the interpreter is that of the system.
"""

import contextlib
import itertools
import json
import os
import queue
import random
import signal
import socket
import struct
import sys
import time

STEP = 50_000_000
PORTIONS = (13_000_000, 131_000_000, 50_000_000, 207_000_000, 7_000_000, 99_000_000, 1)
"""Portions of time [ns], none a multiple of the step but one."""
LOOK = 0.002
"""Real time [s] between two requests for the time, over the protocol that has requests only."""
SILENT = 1.0
"""Real time [s] without a tick after which the simulation is silent."""


class GoneError(Exception):
    """The simulation has gone."""


def command_of(nanoseconds):
    """Return forward and turn of the command that answers a tick."""
    return 0.4, 0.3 if nanoseconds // STEP % 7 < 4 else -0.3


def twist_of(nanoseconds):
    forward, turn = command_of(nanoseconds)
    return {"linear": {"x": forward}, "angular": {"z": turn}}


def twist_message(kind, nanoseconds):
    """Return a Twist of rospy or rclpy."""
    command = kind()
    command.linear.x, command.angular.z = command_of(nanoseconds)
    return command


def stamped_twist_of(nanoseconds):
    return {"header": {"stamp": stamp_of(nanoseconds)}, "twist": twist_of(nanoseconds)}


def stamp_of(nanoseconds):
    return {"sec": nanoseconds // 10**9, "nanosec": nanoseconds % 10**9}


class SocketLink:
    """A connection over WebSocket."""

    protocols = None

    def __init__(self, address):
        from websockets.exceptions import ConnectionClosed, InvalidHandshake
        from websockets.sync.client import connect

        self._closed = ConnectionClosed
        try:
            self._socket = connect(f"ws://{address}", subprotocols=self.protocols, max_size=None, close_timeout=2.0)
            self.begin()
        except (InvalidHandshake, ConnectionClosed, EOFError, GoneError):  # killed in between
            raise ConnectionError from None

    def tick(self, seconds):
        """Return the next time of the clock [ns], None after some seconds."""
        try:
            return self.time_of(self._socket.recv(timeout=seconds))
        except TimeoutError:
            return None
        except self._closed:
            raise GoneError from None

    def send(self, data):
        try:
            self._socket.send(data)
        except self._closed:
            raise GoneError from None

    def close(self):
        self._socket.close()


class RosbridgeLink(SocketLink):
    def begin(self):
        self.send(json.dumps({"op": "advertise", "topic": "/robot/cmd_vel", "type": "geometry_msgs/Twist"}))
        self.send(
            json.dumps({"op": "subscribe", "topic": "/clock", "type": "rosgraph_msgs/Clock", "queue_length": 100})
        )
        self.send(json.dumps({"op": "subscribe", "topic": "/robot/scan"}))

    def time_of(self, data):
        frame = json.loads(data)
        if frame.get("topic") != "/clock":
            return None
        return frame["msg"]["clock"]["sec"] * 10**9 + frame["msg"]["clock"]["nanosec"]

    def drive(self, nanoseconds):
        self.send(json.dumps({"op": "publish", "topic": "/robot/cmd_vel", "msg": twist_of(nanoseconds)}))

    def answer(self, nanoseconds):
        self.send(json.dumps({"op": "publish", "topic": "/robot/cmd_vel", "msg": stamped_twist_of(nanoseconds)}))

    def set_time(self, nanoseconds):
        self.send(json.dumps({"op": "publish", "topic": "/clock", "msg": {"clock": stamp_of(nanoseconds)}}))


class FoxgloveLink(SocketLink):
    protocols = ("foxglove.sdk.v1",)

    def begin(self):
        kinds = (
            ("/robot/cmd_vel", "geometry_msgs/Twist"),
            ("/clock", "rosgraph_msgs/Clock"),
            ("/robot/cmd_vel", "geometry_msgs/TwistStamped"),
        )
        rows = [
            {"id": k, "topic": item, "encoding": "json", "schemaName": kind} for k, (item, kind) in enumerate(kinds)
        ]
        self.send(json.dumps({"op": "advertise", "channels": rows}))

    def time_of(self, data):
        return struct.unpack_from("<Q", data, 1)[0] if isinstance(data, bytes) and data[0] == 2 else None

    def drive(self, nanoseconds):
        self.send(struct.pack("<BI", 1, 0) + json.dumps(twist_of(nanoseconds)).encode())

    def answer(self, nanoseconds):
        self.send(struct.pack("<BI", 1, 2) + json.dumps(stamped_twist_of(nanoseconds)).encode())

    def set_time(self, nanoseconds):
        self.send(struct.pack("<BI", 1, 1) + json.dumps({"clock": stamp_of(nanoseconds)}).encode())


class TcpLink:
    """The protocol of the challenge: a command is a request, and the time is in its reply."""

    def __init__(self, address):
        host, _, port = address.partition(":")
        self._socket = socket.create_connection((host, int(port)), timeout=30.0)
        self._now = self._ticked = -1

    def ask(self, text):
        try:
            self._socket.sendall(text.encode())
            found = b""
            while not found.endswith(b"@"):
                part = self._socket.recv(65536)
                if not part:
                    raise GoneError
                found += part
        except OSError:
            raise GoneError from None
        self._now = round(float(found.partition(b"#")[2].partition(b";")[0]) * 1e9)

    def tick(self, seconds):
        end = time.monotonic() + seconds
        while self._now == self._ticked:  # replies come to requests only, so it asks for the time
            if time.monotonic() > end:
                return None
            time.sleep(LOOK)
            self.ask("sim_control=i;")
        self._ticked = self._now
        return self._now

    def drive(self, nanoseconds):
        forward, turn = command_of(nanoseconds)
        self.ask(f"vel_cmd={forward} {57.29577951308232 * turn};sim_control=i;")

    def answer(self, nanoseconds):
        if nanoseconds == self._now:  # a request answers the latest reply, so it cannot be older
            self.drive(nanoseconds)

    def set_time(self, nanoseconds):
        self.ask(f"clock={nanoseconds / 1e9:.9f};sim_control=i;")

    def close(self):
        self._socket.close()


class Ros2Link:
    def __init__(self, address):
        import rclpy
        from geometry_msgs.msg import Twist, TwistStamped
        from rclpy.signals import SignalHandlerOptions
        from rosgraph_msgs.msg import Clock

        rclpy.init(domain_id=int(address), signal_handler_options=SignalHandlerOptions.NO)  # drive() has a handler
        self._ros, self._twist, self._time, self._ticks = rclpy, Twist, Clock, queue.SimpleQueue()
        self._node = rclpy.create_node("partner")
        self._stamped = TwistStamped
        self._out = self._node.create_publisher(TwistStamped if "faulty" in sys.argv else Twist, "/robot/cmd_vel", 100)
        if "clock" in sys.argv:
            self._clock = self._node.create_publisher(Clock, "/clock", 100)
        else:
            self._node.create_subscription(Clock, "/clock", self._on_clock, 100)
        end = time.monotonic() + 60.0
        while time.monotonic() < end and not self._is_matched():
            rclpy.spin_once(self._node, timeout_sec=0.05)
        end = time.monotonic() + 0.5  # the other side may find this one later
        while time.monotonic() < end:
            rclpy.spin_once(self._node, timeout_sec=0.05)
        self._ticks = queue.SimpleQueue()  # commands in answer to all of them would come at once

    def _is_matched(self):
        if "clock" in sys.argv:
            return self._clock.get_subscription_count() > 0
        return self._out.get_subscription_count() > 0 and not self._ticks.empty()

    def _on_clock(self, message):
        self._ticks.put(message.clock.sec * 10**9 + message.clock.nanosec)

    def tick(self, seconds):
        if self._ticks.empty():
            self._ros.spin_once(self._node, timeout_sec=seconds)
        with contextlib.suppress(queue.Empty):
            return self._ticks.get_nowait()

    def drive(self, nanoseconds):
        self._out.publish(twist_message(self._twist, nanoseconds))

    def answer(self, nanoseconds):
        command = self._stamped()
        command.header.stamp.sec, command.header.stamp.nanosec = nanoseconds // 10**9, nanoseconds % 10**9
        command.twist.linear.x, command.twist.angular.z = command_of(nanoseconds)
        self._out.publish(command)

    def set_time(self, nanoseconds):
        now = self._time()
        now.clock.sec, now.clock.nanosec = nanoseconds // 10**9, nanoseconds % 10**9
        self._clock.publish(now)
        if self._clock.get_subscription_count() == 0:
            raise GoneError

    def close(self):
        time.sleep(0.5)  # the last commands are on their way
        self._node.destroy_node()
        self._ros.shutdown()


class Ros1Link:
    def __init__(self, address):
        import rospy
        from geometry_msgs.msg import Twist, TwistStamped
        from rosgraph_msgs.msg import Clock

        rospy.init_node("partner", anonymous=True, disable_signals=True)
        self._ros, self._twist, self._time, self._ticks = rospy, Twist, Clock, queue.Queue()
        self._stamped = TwistStamped
        self._out = rospy.Publisher("/robot/cmd_vel", TwistStamped if "faulty" in sys.argv else Twist, queue_size=100)
        if "clock" in sys.argv:
            self._clock = rospy.Publisher("/clock", Clock, queue_size=100)
        else:
            rospy.Subscriber("/clock", Clock, self._on_clock, queue_size=100, tcp_nodelay=True)
        end = time.monotonic() + 60.0
        while time.monotonic() < end and not self._is_matched():
            time.sleep(0.02)

    def _is_matched(self):
        if "clock" in sys.argv:
            return self._clock.get_num_connections() > 0
        return self._out.get_num_connections() > 0 and not self._ticks.empty()

    def _on_clock(self, message):
        self._ticks.put(message.clock.to_nsec())

    def tick(self, seconds):
        with contextlib.suppress(queue.Empty):
            return self._ticks.get(timeout=seconds)

    def drive(self, nanoseconds):
        self._out.publish(twist_message(self._twist, nanoseconds))

    def answer(self, nanoseconds):
        command = self._stamped()
        command.header.stamp = self._ros.Time(nanoseconds // 10**9, nanoseconds % 10**9)
        command.twist.linear.x, command.twist.angular.z = command_of(nanoseconds)
        self._out.publish(command)

    def set_time(self, nanoseconds):
        self._clock.publish(self._time(self._ros.Time(nanoseconds // 10**9, nanoseconds % 10**9)))
        if self._clock.get_num_connections() == 0:
            raise GoneError

    def close(self):
        time.sleep(0.5)
        self._ros.signal_shutdown("done")


KINDS = {
    "/robot/scan": ("sensor_msgs", "LaserScan"), "/robot/odom": ("nav_msgs", "Odometry"),
    "/tf": ("tf2_msgs", "TFMessage"), "/robot/camera/image": ("sensor_msgs", "Image"),
}  # fmt: skip


def view_ros1(address, take):
    """Subscribe all topics with rospy, and answer the clock."""
    import rospy
    from geometry_msgs.msg import Twist
    from rosgraph_msgs.msg import Clock

    rospy.init_node("viewer", anonymous=True, disable_signals=True)
    for topic in KINDS:
        rospy.Subscriber(topic, rospy.AnyMsg, lambda message: take(len(message._buff)), queue_size=5)
    out = rospy.Publisher("/robot/cmd_vel", Twist, queue_size=1, tcp_nodelay=True)
    answer = lambda time: out.publish(twist_message(Twist, time.clock.to_nsec()))  # noqa: E731
    rospy.Subscriber("/clock", Clock, answer, queue_size=1, tcp_nodelay=True)


def view_ros2(address, take):
    """Subscribe the topics whose types are installed with rclpy, and answer the clock."""
    import importlib
    import threading

    import rclpy
    from geometry_msgs.msg import Twist
    from rclpy.qos import qos_profile_sensor_data
    from rclpy.signals import SignalHandlerOptions
    from rosgraph_msgs.msg import Clock

    rclpy.init(domain_id=int(address), signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node("viewer")
    for topic, (package, name) in KINDS.items():
        with contextlib.suppress(ImportError):
            kind = getattr(importlib.import_module(f"{package}.msg"), name)
            node.create_subscription(kind, topic, lambda data: take(len(data)), qos_profile_sensor_data, raw=True)
    out = node.create_publisher(Twist, "/robot/cmd_vel", 1)
    answer = lambda time: out.publish(twist_message(Twist, time.clock.sec * 10**9 + time.clock.nanosec))  # noqa: E731
    node.create_subscription(Clock, "/clock", answer, 1)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()


VIEWS = {"ros1": view_ros1, "ros2": view_ros2}


def view(start, address, seconds):
    """Receive the topics, at most for some seconds, and count."""
    seen, stop = {"messages": 0, "bytes": 0}, []
    signal.signal(signal.SIGTERM, lambda *_: stop.append(1))

    def take(size):
        seen["messages"] += 1
        seen["bytes"] += size

    start(address, take)
    print("ready", flush=True)
    end = time.monotonic() + seconds
    while time.monotonic() < end and not stop:
        time.sleep(0.05)
    return dict(seen)


PERIOD = 0.5
"""Real time [s] between two scans of a slow reader."""


def slow_ros1(address, take):
    """Subscribe the scan with rospy; a callback holds up the thread that receives."""
    import rospy
    from sensor_msgs.msg import LaserScan

    rospy.init_node("slow", anonymous=True, disable_signals=True)
    rospy.Subscriber("/robot/scan", LaserScan, lambda scan: take(scan.header.stamp.to_nsec()), queue_size=1)


def slow_ros2(address, take):
    """Subscribe the scan with rclpy."""
    import threading

    import rclpy
    from rclpy.qos import QoSProfile, ReliabilityPolicy
    from rclpy.signals import SignalHandlerOptions
    from sensor_msgs.msg import LaserScan

    rclpy.init(domain_id=int(address), signal_handler_options=SignalHandlerOptions.NO)
    node, quality = rclpy.create_node("slow"), QoSProfile(depth=1, reliability=ReliabilityPolicy.BEST_EFFORT)
    on_scan = lambda scan: take(scan.header.stamp.sec * 10**9 + scan.header.stamp.nanosec)  # noqa: E731
    node.create_subscription(LaserScan, "/robot/scan", on_scan, quality)
    threading.Thread(target=rclpy.spin, args=(node,), daemon=True).start()


def slow_tcp(address, take):
    """Ask the server of the challenge."""
    import threading

    link = TcpLink(address)

    def ask():
        while True:
            link.ask("sim_control=i;")
            take(link._now)

    threading.Thread(target=ask, daemon=True).start()


SLOW = {"ros1": slow_ros1, "ros2": slow_ros2, "tcp": slow_tcp}


def read_slowly(start, address, count):
    """Take some scans, with a pause after each."""
    rows = []

    def take(nanoseconds):
        rows.append((time.monotonic_ns(), nanoseconds))
        time.sleep(PERIOD)

    start(address, take)
    print("ready", flush=True)
    end = time.monotonic() + 120.0
    while len(rows) < count and time.monotonic() < end:
        time.sleep(0.05)
    return {"rows": rows[:count]}


LINKS = {
    "rosbridge": RosbridgeLink, "rosbridge-client": RosbridgeLink, "foxglove": FoxgloveLink, "tcp": TcpLink,
    "ros1": Ros1Link, "ros2": Ros2Link,
}  # fmt: skip


def drive(kind, address, seconds):
    """Answer ticks, and count them, the times of silence and the connections."""
    seen, stop = {"sent": 0, "links": 0, "silences": 0}, []
    signal.signal(signal.SIGTERM, lambda *_: stop.append(1))
    end = time.monotonic() + seconds
    while time.monotonic() < end and not stop:
        try:
            link = kind(address)
        except OSError:  # the simulation is not there
            time.sleep(0.05)
            continue
        seen["links"] += 1
        print("ready", flush=True)
        end = max(end, time.monotonic() + seconds) if seen["links"] == 1 else end
        latest, silent = time.monotonic(), False
        with contextlib.suppress(GoneError):
            while time.monotonic() < end and not stop:
                now = link.tick(0.1)
                if now is not None:
                    latest, silent = time.monotonic(), False
                    link.drive(now)
                    seen["sent"] += 1
                elif not silent and time.monotonic() - latest > SILENT:
                    silent = True
                    seen["silences"] += 1
        link.close()
    return seen


def answer_badly(kind, address, seed):
    """Answer each tick late, several times, and with old answers between, until SIGTERM, or the simulation has gone."""
    rng, link, answered, sent, stop = random.Random(seed), kind(address), [], 0, []
    signal.signal(signal.SIGTERM, lambda *_: stop.append(1))
    print("ready", flush=True)
    with contextlib.suppress(GoneError):
        while not stop:
            now = link.tick(0.1)
            if now is None:
                continue
            time.sleep(rng.choice((0.0, 0.0, 0.002, 0.02)))
            answers = [now] * (rng.randint(1, 3) if now else 1)  # without a stamp, a copy cannot be told apart
            answers += rng.sample(answered, min(len(answered), rng.randint(0, 3)))
            rng.shuffle(answers)
            for nanoseconds in answers:
                link.answer(nanoseconds)
            sent += len(answers)
            answered += [now] * (now > 0)
    link.close()
    return {"sent": sent, "answered": len(set(answered))}


def give_time(kind, address, seconds):
    """Send the time in odd portions until the simulation has gone."""
    link, now, sent = kind(address), 0, 0
    print("ready", flush=True)
    end = time.monotonic() + 120.0
    with contextlib.suppress(GoneError):
        for portion in itertools.cycle(PORTIONS):
            now += portion if now < seconds * 10**9 else 0  # the last time again until it has come
            link.set_time(now)
            sent += 1
            time.sleep(0.005)
            if time.monotonic() > end:
                break
    link.close()
    return {"sent": sent, "now": now}


if __name__ == "__main__":
    _, name, place, mode, length = sys.argv
    if mode == "view":
        found = view(VIEWS[name], place, float(length))
    elif mode == "slow":
        found = read_slowly(SLOW[name], place, int(length))
    else:
        found = {"drive": drive, "clock": give_time, "faulty": answer_badly}[mode](LINKS[name], place, float(length))
    print(json.dumps(found), flush=True)
    os._exit(0)  # threads of libraries may wait forever
