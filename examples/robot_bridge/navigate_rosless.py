"""A navigation node of ROS 2 without ROS: scan and odometry in, velocity out, as a process of its own. Experimental.

    crowdbot run examples/robot_bridge/pillar.xml --bridge rosless --out driven
    python examples/robot_bridge/navigate_rosless.py --goal 4,0

It needs rosless (pip install 'crowdbot[rosless]') and a network interface that is not the loopback interface. It drives
a robot of --bridge ros2, too.
"""

from __future__ import annotations

import argparse
import os
import time

import rosless
from scan_driver import ScanDriver, add_options, goal_of, heading_of

SILENT = 5.0
"""Real time [s] without a scan after which the simulation has ended; rosless does not tell."""


class NavigationNode:
    """Connects a driver to the topics of a robot.

    Args:
        node: node of rosless.
        robot: name space of the robot.
        driver: makes the commands.
    """

    def __init__(self, node, robot, driver):
        self.driver = driver
        self.out = node.advertise(f"/{robot}/cmd_vel", "geometry_msgs/msg/Twist", depth=1)
        self.goals = node.subscribe(
            f"/{robot}/goal", "geometry_msgs/msg/PoseStamped", durability="transient_local", depth=1
        )
        self.odometry = node.subscribe(f"/{robot}/odom", "nav_msgs/msg/Odometry", depth=10)
        self.scans = node.subscribe(f"/{robot}/scan", "sensor_msgs/msg/LaserScan", reliability="best_effort", depth=5)

    def take(self):
        """Take a message of each topic; return whether there was a scan."""
        if (goal := self.goals.read(0.0)) is not None:
            self.driver.take_goal(goal.pose.position.x, goal.pose.position.y)
        if (pose := self.odometry.read(0.02)) is not None:
            place, turn = pose.pose.pose.position, pose.pose.pose.orientation
            self.send(self.driver.take_pose(stamp(pose), place.x, place.y, heading_of(turn.z, turn.w)))
        if (scan := self.scans.read(0.0)) is None:
            return False
        self.send(self.driver.take_scan(stamp(scan), scan.ranges, scan.angle_min, scan.angle_increment))
        return True

    def send(self, command):
        """Send a command, if there is one."""
        if command is not None:
            self.out.send({"linear": {"x": command[0]}, "angular": {"z": command[1]}})


def stamp(message):
    """Return the time [ns] of a message."""
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def main():
    """Drive until the goal, or until no scans come any more."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser)
    options = parser.parse_args()
    driver = ScanDriver(goal_of(options))
    node = NavigationNode(rosless.Node(int(os.environ.get("ROS_DOMAIN_ID") or 0)), options.robot, driver)
    latest = None
    while not driver.done and (latest is None or time.monotonic() - latest < SILENT):
        if node.take():
            latest = time.monotonic()
    print(driver.summary())


if __name__ == "__main__":
    main()
