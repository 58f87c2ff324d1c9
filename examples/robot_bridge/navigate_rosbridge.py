"""A navigation node over rosbridge: scan and odometry in, velocity out, as a process of its own.

    crowdbot run examples/robot_bridge/pillar.xml --bridge rosbridge --out driven
    python examples/robot_bridge/navigate_rosbridge.py --goal 4,0

As the navigator of a trial, scored by crowdbot evaluate:

    <navigator type="rosbridge" command="python examples/robot_bridge/navigate_rosbridge.py --port {port}"/>

It needs roslibpy (pip install roslibpy) and any rosbridge server: that of crowdbot, or rosbridge_suite of a real robot.
"""

from __future__ import annotations

import argparse
import math
import sys
import threading

import roslibpy
from scan_driver import ScanDriver, add_options, goal_of, heading_of


class NavigationNode:
    """Connects a driver to the topics of a robot.

    Args:
        ros: connection.
        robot: name space of the robot.
        driver: makes the commands.
    """

    def __init__(self, ros, robot, driver):
        self.driver = driver
        self.out = roslibpy.Topic(ros, f"/{robot}/cmd_vel", "geometry_msgs/Twist", queue_size=1)
        self.out.advertise()
        roslibpy.Topic(ros, f"/{robot}/goal", "geometry_msgs/PoseStamped").subscribe(self.take_goal)
        roslibpy.Topic(ros, f"/{robot}/odom", "nav_msgs/Odometry").subscribe(self.take_odometry)
        roslibpy.Topic(ros, f"/{robot}/scan", "sensor_msgs/LaserScan").subscribe(self.take_scan)

    def take_goal(self, message):
        """Drive to another goal."""
        self.driver.take_goal(message["pose"]["position"]["x"], message["pose"]["position"]["y"])

    def take_odometry(self, message):
        """Take the pose; without an odometry sensor, the frame odom is the map."""
        place, turn = message["pose"]["pose"]["position"], message["pose"]["pose"]["orientation"]
        self.send(self.driver.take_pose(stamp(message), place["x"], place["y"], heading_of(turn["z"], turn["w"])))

    def take_scan(self, message):
        """Take a scan."""
        ranges = [math.inf if one is None else one for one in message["ranges"]]  # JSON has no infinity
        self.send(self.driver.take_scan(stamp(message), ranges, message["angle_min"], message["angle_increment"]))

    def send(self, command):
        """Send a command, if there is one."""
        if command is not None:
            self.out.publish(roslibpy.Message({"linear": {"x": command[0]}, "angular": {"z": command[1]}}))


def stamp(message):
    """Return the time [ns] of a message."""
    time = message["header"]["stamp"]
    return time["sec"] * 10**9 + time["nanosec"]


def main():
    """Drive until the goal, or until the simulation ends."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--host", default="127.0.0.1")
    parser.add_argument("--port", type=int, default=9090)
    parser.add_argument("--wait", type=float, default=60.0, help="time to wait for the server [s]")
    add_options(parser)
    options = parser.parse_args()
    ros = roslibpy.Ros(options.host, options.port)
    try:
        ros.run(timeout=options.wait)
    except roslibpy.core.RosTimeoutError:
        ros.terminate()
        sys.exit(
            f"no server at {options.host}:{options.port} within {options.wait:g} s; start one, with --bridge rosbridge"
        )
    gone = threading.Event()
    ros.on("close", lambda *_: gone.set())
    driver = ScanDriver(goal_of(options))
    NavigationNode(ros, options.robot, driver)
    while not gone.wait(0.1) and not driver.done:
        pass
    print(driver.summary())
    ros.terminate()


if __name__ == "__main__":
    main()
