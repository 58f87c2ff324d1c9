"""A navigation node over rosbridge: scan and odometry in, velocity out, as a process of its own.

    crowdbot run circle-crossing --bridge rosbridge --out driven
    python examples/robot_bridge/navigate_rosbridge.py --goal 4,0

It needs roslibpy (pip install roslibpy) and any rosbridge server: that of crowdbot, or rosbridge_suite of a real robot.
"""

from __future__ import annotations

import argparse
import math
import threading

import roslibpy
from local_planner import LocalPlanner


class NavigationNode:
    """Answers every scan with a command until the robot is at the goal.

    Args:
        ros: connection.
        robot: name space of the robot.
        goal: x, y in the map [m].
        planner: makes the commands.
    """

    def __init__(self, ros, robot, goal, planner):
        self.ros, self.goal, self.planner, self.pose = ros, goal, planner, None
        self.arrived, self.commands = threading.Event(), 0
        self.out = roslibpy.Topic(ros, f"/{robot}/cmd_vel", "geometry_msgs/Twist", queue_size=1)
        self.out.advertise()
        roslibpy.Topic(ros, f"/{robot}/odom", "nav_msgs/Odometry").subscribe(self.take_odometry)
        roslibpy.Topic(ros, f"/{robot}/scan", "sensor_msgs/LaserScan").subscribe(self.take_scan)

    def take_odometry(self, message):
        """Keep the pose; without an odometry sensor, the frame odom is the map."""
        place, turn = message["pose"]["pose"]["position"], message["pose"]["pose"]["orientation"]
        self.pose = place["x"], place["y"], 2.0 * math.atan2(turn["z"], turn["w"])

    def take_scan(self, message):
        """Answer a scan with a command."""
        if self.pose is None:
            return
        x, y, heading = self.pose
        dx, dy = self.goal[0] - x, self.goal[1] - y
        if math.hypot(dx, dy) < 0.2:
            self.arrived.set()
        goal = (
            math.cos(heading) * dx + math.sin(heading) * dy,
            -math.sin(heading) * dx + math.cos(heading) * dy,
        )
        ranges = [math.inf if one is None else one for one in message["ranges"]]  # JSON has no infinity
        speed, turn = self.planner.command(ranges, message["angle_min"], message["angle_increment"], goal)
        if self.arrived.is_set():
            speed, turn = 0.0, 0.0
        self.out.publish(roslibpy.Message({"linear": {"x": speed}, "angular": {"z": turn}}))
        self.commands += 1


def main():
    """Drive until the goal, or until the simulation ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=9090)
    parser.add_argument("--robot", default="robot", help="name space of the robot")
    parser.add_argument("--goal", default="4,0", help="goal x,y in the map [m]")
    parser.add_argument("--seconds", type=float, default=120.0, help="longest real time")
    options = parser.parse_args()
    ros = roslibpy.Ros(options.host, options.port)
    ros.run(timeout=30)
    gone = threading.Event()
    ros.on("close", lambda *_: gone.set())
    goal = tuple(float(one) for one in options.goal.split(","))
    node = NavigationNode(ros, options.robot, goal, LocalPlanner())
    for _ in range(round(10 * options.seconds)):
        if gone.is_set() or node.arrived.wait(0.1):
            break
    print(f"{'arrived' if node.arrived.is_set() else 'stopped'} after {node.commands} commands")
    ros.terminate()


if __name__ == "__main__":
    main()
