"""A navigation node over rosbridge: scan and odometry in, velocity out, as a process of its own.

    crowdbot run circle-crossing --bridge rosbridge --out driven
    python examples/robot_bridge/navigate_rosbridge.py --goal 4,0

As the navigator of a trial, scored by crowdbot evaluate:

    <navigator type="rosbridge" command="python examples/robot_bridge/navigate_rosbridge.py --port {port}"/>

It needs roslibpy (pip install roslibpy) and any rosbridge server: that of crowdbot, or rosbridge_suite of a real robot.
"""

from __future__ import annotations

import argparse
import math
import threading

import roslibpy
from local_planner import LocalPlanner, in_robot_frame


class NavigationNode:
    """Answers every scan with a command until the robot is at the goal, as soon as it knows the pose of that time.

    Args:
        ros: connection.
        robot: name space of the robot.
        goal: x, y in the map [m]; None: as sent on ``/ROBOT/goal``.
        planner: makes the commands.
    """

    def __init__(self, ros, robot, goal, planner):
        self.ros, self.goal, self.planner, self.pose, self.scan = ros, goal, planner, None, None
        self.arrived, self.commands, self.fixed = threading.Event(), 0, goal is not None
        self.out = roslibpy.Topic(ros, f"/{robot}/cmd_vel", "geometry_msgs/Twist", queue_size=1)
        self.out.advertise()
        roslibpy.Topic(ros, f"/{robot}/goal", "geometry_msgs/PoseStamped").subscribe(self.take_goal)
        roslibpy.Topic(ros, f"/{robot}/odom", "nav_msgs/Odometry").subscribe(self.take_odometry)
        roslibpy.Topic(ros, f"/{robot}/scan", "sensor_msgs/LaserScan").subscribe(self.take_scan)

    def take_goal(self, message):
        """Drive to another goal, if none was given at the start."""
        if self.fixed:
            return
        place = message["pose"]["position"]
        self.goal = place["x"], place["y"]
        self.arrived.clear()

    def take_odometry(self, message):
        """Keep the pose; without an odometry sensor, the frame odom is the map."""
        place, turn = message["pose"]["pose"]["position"], message["pose"]["pose"]["orientation"]
        pose = place["x"], place["y"], 2.0 * math.atan2(turn["z"], turn["w"])
        self.pose = stamp(message), pose
        self.answer()

    def take_scan(self, message):
        """Keep the scan until it is answered."""
        self.scan = message
        self.answer()

    def answer(self):
        """Answer the scan with a command."""
        message = self.scan
        if message is None or self.pose is None or self.goal is None or self.pose[0] < stamp(message):
            return
        self.scan = None
        goal = in_robot_frame(self.pose[1], self.goal)
        if math.hypot(*goal) < 0.2:
            self.arrived.set()
        ranges = [math.inf if one is None else one for one in message["ranges"]]  # JSON has no infinity
        speed, turn = self.planner.command(ranges, message["angle_min"], message["angle_increment"], goal)
        if self.arrived.is_set():
            speed, turn = 0.0, 0.0
        self.out.publish(roslibpy.Message({"linear": {"x": speed}, "angular": {"z": turn}}))
        self.commands += 1


def stamp(message):
    """Return the time [ns] of a message."""
    time = message["header"]["stamp"]
    return time["sec"] * 10**9 + time["nanosec"]


def main():
    """Drive until the goal, or until the simulation ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=9090)
    parser.add_argument("--robot", default="robot", help="name space of the robot")
    parser.add_argument("--goal", help="goal x,y in the map [m] (default: as the simulation sends)")
    parser.add_argument("--seconds", type=float, default=3600.0, help="longest real time")
    options = parser.parse_args()
    ros = roslibpy.Ros(options.host, options.port)
    ros.run(timeout=30)
    gone = threading.Event()
    ros.on("close", lambda *_: gone.set())
    goal = tuple(float(one) for one in options.goal.split(",")) if options.goal else None
    node = NavigationNode(ros, options.robot, goal, LocalPlanner())
    for _ in range(round(10 * options.seconds)):
        if gone.wait(0.1) or (node.fixed and node.arrived.is_set()):
            break
    print(f"{'arrived' if node.arrived.is_set() else 'stopped'} after {node.commands} commands")
    ros.terminate()


if __name__ == "__main__":
    main()
