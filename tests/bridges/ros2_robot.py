"""A robot program for ROS 2 in a process of its own: it answers each tick of /clock with one command and counts.

    python ros2_robot.py DOMAIN SECONDS [LAST]

It ends after some seconds, or when the clock has come to LAST [s]; DDS tells the end of a participant late. It prints
one line of JSON: what it has received. It uses rclpy only.
"""

import json
import sys
import time

import rclpy
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rclpy.parameter import Parameter
from rclpy.qos import DurabilityPolicy, QoSProfile, qos_profile_sensor_data
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan
from std_msgs.msg import String

STEP = 50_000_000


def main():
    domain, seconds = int(sys.argv[1]), float(sys.argv[2])
    rclpy.init(domain_id=domain)
    node = rclpy.create_node("robot_program", parameter_overrides=[Parameter("use_sim_time", value=True)])
    seen = {"scans": 0, "beams": 0, "odometry": 0, "ticks": [], "sent": 0, "map": 0, "urdf": 0, "frame": "", "x": 0.0}
    seen |= {"late": [], "ready": False}
    plain = node.create_publisher(Twist, "/robot/cmd_vel", 10)
    other = rclpy.Context()
    rclpy.init(domain_id=domain, context=other)
    second = rclpy.create_node("robot_program_stamped", context=other)  # a topic has one type in a participant
    stamped = second.create_publisher(TwistStamped, "/robot/cmd_vel", 10)

    def drive(nanoseconds):
        tick = nanoseconds // STEP
        turn = 0.3 if tick % 7 < 4 else -0.3
        if tick % 2:
            command = TwistStamped()
            command.twist.linear.x, command.twist.angular.z = 0.4, turn
            stamped.publish(command)
        else:
            command = Twist()
            command.linear.x, command.angular.z = 0.4, turn
            plain.publish(command)
        seen["sent"] += 1

    def on_clock(message):
        now = message.clock.sec * 10**9 + message.clock.nanosec
        seen["ticks"].append(now)
        if seen["ready"]:
            drive(now)

    def on_scan(message):
        seen["scans"] += 1
        seen["beams"], seen["frame"] = len(message.ranges), message.header.frame_id
        stamp = message.header.stamp.sec * 10**9 + message.header.stamp.nanosec
        seen["late"].append(node.get_clock().now().nanoseconds - stamp)

    def on_odometry(message):
        seen["odometry"] += 1
        seen["x"] = message.pose.pose.position.x

    def note(name):
        def take(message):
            seen[name] = len(message.data)

        return take

    latched = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)
    clock = node.create_subscription(Clock, "/clock", on_clock, 10)
    node.create_subscription(LaserScan, "/robot/scan", on_scan, qos_profile_sensor_data)
    node.create_subscription(Odometry, "/robot/ground_truth/odom", on_odometry, 10)
    node.create_subscription(OccupancyGrid, "/map", note("map"), latched)
    node.create_subscription(String, "/robot/robot_description", note("urdf"), latched)
    end = time.monotonic() + 60.0
    # Both publishers and the clock are matched, and the first command can go. Odometry is reliable and its reader is
    # announced after that of the scans, which are best effort: once it comes, scans come, too.
    while time.monotonic() < end:
        rclpy.spin_once(node, timeout_sec=0.02)
        counts = (plain.get_subscription_count(), stamped.get_subscription_count(), node.count_publishers("/clock"))
        if all(counts) and seen["map"] and seen["odometry"]:
            break
    seen["ready"] = True  # from now on, one command answers each tick; a tick without an answer is sent again
    end, last = time.monotonic() + seconds, 1e9 * float(sys.argv[3]) if len(sys.argv) > 3 else float("inf")
    while time.monotonic() < end and not (seen["ticks"] and node.count_publishers("/clock") == 0):
        rclpy.spin_once(node, timeout_sec=0.05)
        if seen["ticks"] and seen["ticks"][-1] >= last:
            end = min(end, time.monotonic() + 1.0)  # other topics of the last instant
    seen["late"] = sorted(seen["late"])
    print(json.dumps(seen))
    node.destroy_subscription(clock)
    node.destroy_node()
    second.destroy_node()
    rclpy.shutdown()
    other.try_shutdown()


if __name__ == "__main__":
    main()
