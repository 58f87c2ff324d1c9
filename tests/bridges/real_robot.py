"""A simulated robot that takes the place of a real one: it integrates velocity commands and sends its odometry.

    python real_robot.py rosbridge            a rosbridge server on a free port, which it prints
    python real_robot.py ros2 DOMAIN

It also plays the navigation stack: it sends a command for each odometry message, until --seconds are over.
"""

import asyncio
import json
import math
import sys
import time

START = (7.0, -2.0, 1.0)
"""Pose in the frame of its odometry, which has nothing to do with the trial."""


class Base:
    """A differential drive that stops 0.5 s after the latest command."""

    def __init__(self):
        self.pose, self.twist, self.heard, self.fastest = START, (0.0, 0.0), 0.0, 0.0
        self.stopped = 0
        self.zero_at = None

    def take(self, speed, turn):
        self.twist, self.heard = (speed, turn), time.monotonic()
        self.fastest = max(self.fastest, speed)
        if speed == turn == 0.0:
            self.stopped += 1

    def step(self, dt):
        x, y, heading = self.pose
        speed, turn = self.twist if time.monotonic() - self.heard < 0.5 else (0.0, 0.0)
        self.pose = (x + dt * speed * math.cos(heading), y + dt * speed * math.sin(heading), heading + dt * turn)

    @property
    def driven(self):
        return math.dist(self.pose[:2], START[:2])

    def odometry(self):
        x, y, heading = self.pose
        turn = {"x": 0.0, "y": 0.0, "z": math.sin(heading / 2), "w": math.cos(heading / 2)}
        return {
            "header": {"frame_id": "odom"},
            "pose": {"pose": {"position": {"x": x, "y": y, "z": 0.0}, "orientation": turn}},
        }

    def report(self):
        print(json.dumps({"driven": self.driven, "fastest": self.fastest, "stopped": self.stopped}), flush=True)


async def serve_rosbridge(silent_after):
    from aiohttp import web

    base, sockets = Base(), []

    async def connect(request):
        socket = web.WebSocketResponse()
        await socket.prepare(request)
        sockets.append(socket)
        async for message in socket:
            frame = json.loads(message.data)
            if frame.get("op") == "publish" and frame["topic"] == "/cmd_vel":
                base.take(frame["msg"]["linear"]["x"], frame["msg"]["angular"]["z"])
        sockets.remove(socket)
        return socket

    app = web.Application()
    app.router.add_get("/", connect)
    runner = web.AppRunner(app)
    await runner.setup()
    site = web.TCPSite(runner, "127.0.0.1", 0)
    await site.start()
    print(runner.addresses[0][1], flush=True)
    begin, seen = time.monotonic(), False
    while not seen or sockets:
        await asyncio.sleep(0.02)
        base.step(0.02)
        if sockets and not seen:
            seen, begin = True, time.monotonic()
        for socket in list(sockets):
            if time.monotonic() - begin < silent_after:
                await socket.send_json({"op": "publish", "topic": "/odom", "msg": base.odometry()})
            twist = {"linear": {"x": 0.9}, "angular": {"z": 0.0}}
            await socket.send_json({"op": "publish", "topic": "/robot/cmd_vel", "msg": twist})
        if time.monotonic() - begin > 60.0:
            break
    base.report()
    await runner.cleanup()


def run_ros2(domain):
    import rclpy
    from geometry_msgs.msg import Twist
    from nav_msgs.msg import Odometry
    from rclpy.qos import qos_profile_sensor_data
    from sensor_msgs.msg import LaserScan

    rclpy.init(domain_id=domain)
    node, base, scans = rclpy.create_node("real_robot"), Base(), []
    out = node.create_publisher(Odometry, "/odom", qos_profile_sensor_data)
    wish = node.create_publisher(Twist, "/robot/cmd_vel", 1)
    node.create_subscription(Twist, "/cmd_vel", lambda one: base.take(one.linear.x, one.angular.z), 1)
    node.create_subscription(LaserScan, "/robot/scan", scans.append, qos_profile_sensor_data)

    def step():
        base.step(0.02)
        message, twist = Odometry(), Twist()
        x, y, heading = base.pose
        message.pose.pose.position.x, message.pose.pose.position.y = x, y
        message.pose.pose.orientation.z, message.pose.pose.orientation.w = math.sin(heading / 2), math.cos(heading / 2)
        out.publish(message)
        twist.linear.x = 0.9
        wish.publish(twist)

    node.create_timer(0.02, step)
    seen, end = False, time.monotonic() + 60.0
    while (not seen or node.count_publishers("/cmd_vel")) and time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.1)
        seen = seen or node.count_publishers("/cmd_vel") > 0
    base.stopped = len(scans)
    base.report()
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    if sys.argv[1] == "ros2":
        run_ros2(int(sys.argv[2]))
    else:
        asyncio.run(serve_rosbridge(float(sys.argv[2]) if len(sys.argv) > 2 else 1e9))
