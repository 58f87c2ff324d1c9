"""A navigation node of ROS 1: scan and odometry in, velocity out, as a process of its own.

    crowdbot run examples/robot_bridge/pillar.xml --bridge ros1 --out driven
    python3 examples/robot_bridge/navigate_ros1.py --goal 4,0

It needs rospy only, so run it with the Python of your ROS (/usr/bin/python3 in Debian and Ubuntu).
"""

from __future__ import annotations

import argparse
import threading

import rospy
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry
from scan_driver import ScanDriver, add_options, goal_of, heading_of
from sensor_msgs.msg import LaserScan


class NavigationNode:
    """Connects a driver to the topics of a robot.

    Args:
        robot: name space of the robot.
        driver: makes the commands.
    """

    def __init__(self, robot, driver):
        self.driver, self.lock = driver, threading.Lock()  # rospy has a thread for each topic
        self.out = rospy.Publisher(f"/{robot}/cmd_vel", Twist, queue_size=1)
        rospy.Subscriber(f"/{robot}/goal", PoseStamped, self.take_goal)
        rospy.Subscriber(f"/{robot}/odom", Odometry, self.take_odometry)
        self.scans = rospy.Subscriber(f"/{robot}/scan", LaserScan, self.take_scan)

    def take_goal(self, message):
        """Drive to another goal."""
        with self.lock:
            self.driver.take_goal(message.pose.position.x, message.pose.position.y)

    def take_odometry(self, message):
        """Take the pose; without an odometry sensor, the frame odom is the map."""
        place, turn, stamp = message.pose.pose.position, message.pose.pose.orientation, message.header.stamp.to_nsec()
        with self.lock:
            self.send(self.driver.take_pose(stamp, place.x, place.y, heading_of(turn.z, turn.w)))

    def take_scan(self, message):
        """Take a scan."""
        stamp = message.header.stamp.to_nsec()
        with self.lock:
            self.send(self.driver.take_scan(stamp, message.ranges, message.angle_min, message.angle_increment))

    def send(self, command):
        """Send a command, if there is one."""
        if command is not None:
            message = Twist()
            message.linear.x, message.angular.z = command
            self.out.publish(message)


def main():
    """Drive until the goal, or until the simulation ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser)
    options = parser.parse_args(rospy.myargv()[1:])
    rospy.init_node("navigate")
    driver = ScanDriver(goal_of(options))
    node = NavigationNode(options.robot, driver)
    seen = False
    while not rospy.is_shutdown() and not driver.done and (not seen or node.scans.get_num_connections()):
        rospy.rostime.wallsleep(0.1)
        seen = seen or node.scans.get_num_connections() > 0
    print(driver.summary())


if __name__ == "__main__":
    main()
