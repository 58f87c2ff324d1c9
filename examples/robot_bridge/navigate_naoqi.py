"""A navigation program for a Pepper: lasers of its memory in, motion out, as a process of its own, by qi.

    crowdbot run examples/robot_bridge/pepper.xml --bridge naoqi:192.168.0.5 --out driven
    python examples/robot_bridge/navigate_naoqi.py tcp://192.168.0.5:9559 --goal 3,0

The bridge writes the virtual lasers into the memory of the robot, and moves the virtual robot as the real one moves. The
robot rewrites its memory in each cycle, so a part of the reads has the real values: points of several reads count, the
nearest in each direction. It needs qi only (pip install qi).
"""

from __future__ import annotations

import argparse
import math
import sys
import time
from collections import deque

import qi
from scan_driver import ScanDriver

LASERS = {"Front": (0.056, 0.0, 0.0), "Left": (-0.018, 0.09, 0.5 * math.pi), "Right": (-0.018, -0.09, -0.5 * math.pi)}
"""Places of the lasers on the robot: x, y [m], heading [rad]."""
KEY = "Device/SubDeviceList/Platform/LaserSensor/{}/Horizontal/Seg{:02}/{}/Sensor/Value"
POINTS, BEAMS, RANGE = 15, 120, 2.95
"""Points of a laser, directions of the scan that is made from all, and distance [m] from which a laser sees nothing."""
PERIOD, READS = 0.05, 8
"""Real time [s] between two reads of the memory, and number of reads whose points count."""


class NavigationNode:
    """Connects a driver to the memory and the motion of a robot.

    Args:
        session: connection.
        start: pose of the robot in the map at the start: x, y [m], heading [rad].
        driver: makes the commands.
    """

    def __init__(self, session, start, driver):
        self.driver, self.reads = driver, deque(maxlen=READS)
        self.memory, self.motion = session.service("ALMemory"), session.service("ALMotion")
        self.keys = [KEY.format(side, k, axis) for side in LASERS for k in range(1, POINTS + 1) for axis in "XY"]
        self.start, self.origin = start, self.motion.getRobotPosition(True)

    def step(self):
        """Read the memory and move."""
        stamp = time.monotonic_ns()
        self.driver.take_pose(stamp, *self.pose())
        self.reads.append(self.points())
        command = self.driver.take_scan(stamp, self.scan(), -math.pi, 2.0 * math.pi / BEAMS)
        self.motion.move(command[0], 0.0, command[1])

    def pose(self):
        """Return the pose of the robot in the map: its odometry since the start."""
        x, y, heading = self.motion.getRobotPosition(True)
        moved = _turned(x - self.origin[0], y - self.origin[1], self.start[2] - self.origin[2])
        return self.start[0] + moved[0], self.start[1] + moved[1], self.start[2] + heading - self.origin[2]

    def points(self):
        """Return the points x, y [m] of all lasers in the frame of the robot."""
        values = self.memory.getListData(self.keys)
        found = []
        for k, (x, y, heading) in enumerate(LASERS.values()):
            part = values[2 * POINTS * k : 2 * POINTS * (k + 1)]
            for forward, left in zip(part[::2], part[1::2], strict=True):
                if forward is not None and left is not None and math.hypot(forward, left) < RANGE:
                    dx, dy = _turned(forward, left, heading)
                    found.append((x + dx, y + dy))
        return found

    def scan(self):
        """Return the nearest distance [m] of the latest reads in each direction, infinite where nothing is seen."""
        ranges = [math.inf] * BEAMS
        for x, y in (point for points in self.reads for point in points):
            beam = round((math.atan2(y, x) + math.pi) / (2.0 * math.pi) * BEAMS) % BEAMS
            ranges[beam] = min(ranges[beam], math.hypot(x, y))
        return ranges


def _turned(x, y, angle):
    return math.cos(angle) * x - math.sin(angle) * y, math.sin(angle) * x + math.cos(angle) * y


def main():
    """Drive to the goal."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("url", help="address of the robot, tcp://HOST:9559")
    parser.add_argument("--goal", required=True, help="goal x,y in the map [m]")
    parser.add_argument(
        "--start", default="0,0,0", help="pose x,y [m],heading [rad] of the robot in the map at the start"
    )
    options = parser.parse_args()
    goal, start = ([float(one) for one in text.split(",")] for text in (options.goal, options.start))
    session = qi.Session()
    try:
        session.connect(options.url)
    except RuntimeError as error:
        sys.exit(f"no robot at {options.url}: {error}")
    driver = ScanDriver(goal)
    driver.planner.max_speed, driver.planner.max_turn = 0.35, 0.7
    node = NavigationNode(session, start, driver)
    try:
        while not driver.done:
            node.step()
            time.sleep(PERIOD)
    finally:
        node.motion.stopMove()
    print(driver.summary())
    session.close()


if __name__ == "__main__":
    main()
