"""A navigation node of ROS 2: scan and odometry in, velocity out, as a process of its own.

    crowdbot run examples/robot_bridge/pillar.xml --bridge ros2 --out driven
    python examples/robot_bridge/navigate_ros2.py --goal 4,0

As the navigator of a trial, scored by crowdbot evaluate:

    <navigator type="ros2" command="python examples/robot_bridge/navigate_ros2.py"/>

It needs rclpy only, of your own ROS 2 or of the wheels: pip install 'crowdbot[ros2-wheels]'.
"""

from __future__ import annotations

import argparse

import rclpy
from geometry_msgs.msg import PoseStamped, Twist
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from scan_driver import ScanDriver, add_options, goal_of, heading_of
from sensor_msgs.msg import LaserScan


class NavigationNode:
    """Connects a driver to the topics of a robot.

    Args:
        node: node of rclpy.
        robot: name space of the robot.
        driver: makes the commands.
    """

    def __init__(self, node, robot, driver):
        self.driver = driver
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.out = node.create_publisher(Twist, f"/{robot}/cmd_vel", 1)
        node.create_subscription(PoseStamped, f"/{robot}/goal", self.take_goal, latched)
        node.create_subscription(Odometry, f"/{robot}/odom", self.take_odometry, 10)
        node.create_subscription(LaserScan, f"/{robot}/scan", self.take_scan, qos_profile_sensor_data)

    def take_goal(self, message):
        """Drive to another goal."""
        self.driver.take_goal(message.pose.position.x, message.pose.position.y)

    def take_odometry(self, message):
        """Take the pose; without an odometry sensor, the frame odom is the map."""
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        self.send(self.driver.take_pose(stamp(message), place.x, place.y, heading_of(turn.z, turn.w)))

    def take_scan(self, message):
        """Take a scan."""
        self.send(self.driver.take_scan(stamp(message), message.ranges, message.angle_min, message.angle_increment))

    def send(self, command):
        """Send a command, if there is one."""
        if command is not None:
            message = Twist()
            message.linear.x, message.angular.z = map(float, command)
            self.out.publish(message)


def stamp(message):
    """Return the time [ns] of a message."""
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def main():
    """Drive until the goal, or until the simulation ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    add_options(parser)
    options = parser.parse_args()
    rclpy.init()
    node = rclpy.create_node("navigate")
    driver = ScanDriver(goal_of(options))
    NavigationNode(node, options.robot, driver)
    seen = False
    while not driver.done and (not seen or node.count_publishers("/clock")):  # until the simulation has ended
        rclpy.spin_once(node, timeout_sec=0.1)
        seen = seen or node.count_publishers("/clock") > 0
    print(driver.summary())
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
