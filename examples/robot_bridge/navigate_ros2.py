"""A navigation node of ROS 2: scan and odometry in, velocity out, as a process of its own.

    crowdbot run circle-crossing --bridge ros2 --out driven
    python examples/robot_bridge/navigate_ros2.py --goal 4,0

As the navigator of a trial, scored by crowdbot evaluate:

    <navigator type="ros2" command="python examples/robot_bridge/navigate_ros2.py"/>

It needs rclpy only, of your own ROS 2 or of the wheels: pip install 'crowdbot[ros2-wheels]'.
"""

from __future__ import annotations

import argparse
import math

import rclpy
from geometry_msgs.msg import PoseStamped, Twist
from local_planner import LocalPlanner, in_robot_frame
from nav_msgs.msg import Odometry
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from sensor_msgs.msg import LaserScan


class NavigationNode:
    """Answers every scan with a command, as soon as it knows the pose of that time.

    Args:
        node: node of rclpy.
        robot: name space of the robot.
        goal: x, y in the map [m]; None: as sent on ``/ROBOT/goal``.
        planner: makes the commands.
    """

    def __init__(self, node, robot, goal, planner):
        self.planner, self.pose, self.goal, self.scan, self.commands = planner, None, goal, None, 0
        latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.out = node.create_publisher(Twist, f"/{robot}/cmd_vel", 1)
        if goal is None:
            node.create_subscription(PoseStamped, f"/{robot}/goal", self.take_goal, latched)
        node.create_subscription(Odometry, f"/{robot}/odom", self.take_odometry, 10)
        node.create_subscription(LaserScan, f"/{robot}/scan", self.take_scan, qos_profile_sensor_data)

    def take_goal(self, message):
        """Drive to another goal."""
        self.goal = message.pose.position.x, message.pose.position.y

    def take_odometry(self, message):
        """Keep the pose; without an odometry sensor, the frame odom is the map."""
        place, turn = message.pose.pose.position, message.pose.pose.orientation
        self.pose = stamp(message), (place.x, place.y, 2.0 * math.atan2(turn.z, turn.w))
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
        speed, turn = 0.0, 0.0
        if math.hypot(*goal) >= 0.2:
            speed, turn = self.planner.command(message.ranges, message.angle_min, message.angle_increment, goal)
        command = Twist()
        command.linear.x, command.angular.z = float(speed), float(turn)
        self.out.publish(command)
        self.commands += 1


def stamp(message):
    """Return the time [ns] of a message."""
    return message.header.stamp.sec * 10**9 + message.header.stamp.nanosec


def main():
    """Drive until the simulation ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--robot", default="robot", help="name space of the robot")
    parser.add_argument("--goal", help="goal x,y in the map [m] (default: as the simulation sends)")
    options = parser.parse_args()
    rclpy.init()
    node = rclpy.create_node("navigate")
    goal = tuple(float(one) for one in options.goal.split(",")) if options.goal else None
    driver = NavigationNode(node, options.robot, goal, LocalPlanner())
    seen = False
    while not seen or node.count_publishers("/clock"):  # until the simulation has ended
        rclpy.spin_once(node, timeout_sec=0.1)
        seen = seen or node.count_publishers("/clock") > 0
    print(f"stopped after {driver.commands} commands")
    node.destroy_node()
    rclpy.shutdown()


if __name__ == "__main__":
    main()
