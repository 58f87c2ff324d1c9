"""A navigation node over the Foxglove WebSocket protocol: scan and odometry in, velocity out, as a process of its own.

    crowdbot run examples/robot_bridge/pillar.xml --bridge foxglove --out driven
    python examples/robot_bridge/navigate_foxglove.py --goal 4,0

It needs websockets and rosbags, which come with crowdbot. Messages arrive as CDR, commands leave as JSON.
"""

from __future__ import annotations

import argparse
import json
import struct
import sys

from rosbags.typesys import Stores, get_typestore
from scan_driver import ScanDriver, add_options, goal_of, heading_of
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

MESSAGE, PUBLISH = 1, 1
"""Operation codes of binary frames: a message of the server, and a message of a client."""
COMMAND = 1
"""Number of the channel of the commands."""


class NavigationNode:
    """Connects a driver to the topics of a robot.

    Args:
        socket: connection.
        robot: name space of the robot.
        driver: makes the commands.
    """

    def __init__(self, socket, robot, driver):
        self.socket, self.driver, self.store = socket, driver, get_typestore(Stores.ROS2_HUMBLE)
        self.takers = {
            f"/{robot}/scan": self.take_scan, f"/{robot}/odom": self.take_odometry, f"/{robot}/goal": self.take_goal
        }  # fmt: skip
        self.wanted = {}
        row = {"id": COMMAND, "topic": f"/{robot}/cmd_vel", "encoding": "json", "schemaName": "geometry_msgs/Twist"}
        self.socket.send(json.dumps({"op": "advertise", "channels": [row]}))

    def take(self, data):
        """Take a frame of the server: text announces topics, bytes are messages."""
        if isinstance(data, str):
            frame = json.loads(data)
            if frame["op"] == "advertise":
                self.subscribe([one for one in frame["channels"] if one["topic"] in self.takers])
        elif data[0] == MESSAGE:
            taker, kind = self.wanted[struct.unpack_from("<I", data, 1)[0]]
            taker(self.store.deserialize_cdr(data[13:], kind))

    def subscribe(self, channels):
        """Subscribe channels under their own numbers."""
        self.wanted |= {one["id"]: (self.takers[one["topic"]], one["schemaName"]) for one in channels}
        rows = [{"id": one["id"], "channelId": one["id"]} for one in channels]
        self.socket.send(json.dumps({"op": "subscribe", "subscriptions": rows}))

    def take_goal(self, message):
        """Drive to another goal."""
        self.driver.take_goal(message.pose.position.x, message.pose.position.y)

    def take_odometry(self, message):
        """Take the pose; without an odometry sensor, the frame odom is the map."""
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        self.send(self.driver.take_pose(stamp(message), place.x, place.y, heading_of(turn.z, turn.w)))

    def take_scan(self, message):
        """Take a scan."""
        ranges = message.ranges.tolist()
        self.send(self.driver.take_scan(stamp(message), ranges, message.angle_min, message.angle_increment))

    def send(self, command):
        """Send a command, if there is one."""
        if command is not None:
            twist = {"linear": {"x": command[0]}, "angular": {"z": command[1]}}
            self.socket.send(struct.pack("<BI", PUBLISH, COMMAND) + json.dumps(twist).encode())


def stamp(message):
    """Return the time [ns] of a message."""
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def main():
    """Drive until the goal, or until the simulation ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=8765)
    add_options(parser)
    options = parser.parse_args()
    driver = ScanDriver(goal_of(options))
    address = f"ws://{options.host}:{options.port}"
    try:
        socket = connect(address, subprotocols=["foxglove.sdk.v1"], max_size=None, close_timeout=1.0)
    except OSError as error:
        sys.exit(f"no simulation at {address} ({error}); start it first, with --bridge foxglove")
    with socket:
        node = NavigationNode(socket, options.robot, driver)
        try:
            while not driver.done:
                node.take(socket.recv())
        except ConnectionClosed:
            pass  # the simulation has ended
    print(driver.summary())


if __name__ == "__main__":
    main()
