"""A robot program for ROS 1 in a process of its own, by rospy: scan in, velocity out, transforms, simulated time.

    /usr/bin/python3 ros1_robot.py SECONDS

It answers each tick of /clock with a command and prints one line of JSON: what it has received. It needs the rospy of
the system, not crowdbot.
"""

import json
import sys
import threading
import time

import rospy
import tf2_ros
from geometry_msgs.msg import Twist, TwistStamped
from nav_msgs.msg import OccupancyGrid, Odometry
from rosgraph_msgs.msg import Clock
from sensor_msgs.msg import LaserScan

STEP = 50_000_000


class Robot:
    """Counts what arrives, and drives a curve."""

    def __init__(self):
        self.seen = {"scans": 0, "beams": 0, "odometry": 0, "ticks": [], "sent": 0, "map": 0, "frame": "", "late": []}
        self.plain = rospy.Publisher("/robot/cmd_vel", Twist, queue_size=10)
        self.ready = False
        self.news = threading.Event()
        self.transforms = tf2_ros.Buffer(cache_time=rospy.Duration(60))
        tf2_ros.TransformListener(self.transforms)
        rospy.Subscriber("/map", OccupancyGrid, self.on_map)
        rospy.Subscriber("/robot/scan", LaserScan, self.on_scan)
        rospy.Subscriber("/robot/ground_truth/odom", Odometry, self.on_odometry)
        self.clock = rospy.Subscriber("/clock", Clock, self.on_clock, queue_size=10, tcp_nodelay=True)

    def drive(self, nanoseconds):
        command = Twist()
        command.linear.x, command.angular.z = 0.4, 0.3 if nanoseconds // STEP % 7 < 4 else -0.3
        self.plain.publish(command)
        self.seen["sent"] += 1

    def on_clock(self, message):
        now = message.clock.to_nsec()
        self.seen["ticks"].append(now)
        if self.ready:
            self.drive(now)

    def on_scan(self, message):
        self.seen["scans"] += 1
        self.seen["beams"], self.seen["frame"] = len(message.ranges), message.header.frame_id
        self.seen["late"].append((rospy.Time.now() - message.header.stamp).to_sec())

    def on_odometry(self, message):
        self.seen["odometry"] += 1

    def on_map(self, message):
        self.seen["map"] = len(message.data)

    def wait(self):
        """Wait until commands and the clock are connected, then send the first command."""
        end = time.monotonic() + 60.0
        while time.monotonic() < end and not (self.plain.get_num_connections() and self.seen["map"]):
            time.sleep(0.02)
        time.sleep(0.5)
        self.ready = True
        print("ready", flush=True)
        self.drive(self.seen["ticks"][-1] if self.seen["ticks"] else 0)  # a tick may have been its last before this

    def look_up(self):
        """Return the pose of the laser scanner in the map."""
        found = self.transforms.lookup_transform("map", "robot/scan", rospy.Time(0))
        place = found.transform.translation
        return [place.x, place.y, place.z]


def main():
    rospy.init_node("robot_program", disable_signals=True)
    robot = Robot()
    robot.wait()
    end, quiet, count = time.monotonic() + float(sys.argv[1]), time.monotonic(), 0
    while time.monotonic() < end and (time.monotonic() - quiet < 1.0 or robot.clock.get_num_connections()):
        time.sleep(0.05)
        if len(robot.seen["ticks"]) > count:
            quiet, count = time.monotonic(), len(robot.seen["ticks"])
    robot.ready = False
    time.sleep(0.2)
    print(json.dumps(robot.seen | {"laser": robot.look_up(), "now": rospy.Time.now().to_sec()}), flush=True)
    rospy.signal_shutdown("done")


def stamped():
    """Publish one stamped command; a node has one type for each topic, so this is another program."""
    rospy.init_node("stamped", disable_signals=True)
    publisher = rospy.Publisher("/robot/cmd_vel", TwistStamped, queue_size=1, latch=True)
    command = TwistStamped()
    command.twist.linear.x = 0.25
    publisher.publish(command)
    time.sleep(float(sys.argv[1]))


if __name__ == "__main__":
    stamped() if "stamped" in sys.argv else main()
