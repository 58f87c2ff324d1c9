"""The part of a navigation node that is the same over every transport: scan, pose and goal in, velocity out.

The programs ``navigate_*.py`` translate the messages of a transport, and nothing else. It needs the standard library
only.
"""

from __future__ import annotations

import math

from local_planner import LocalPlanner, in_robot_frame

NEAR = 0.2
"""Distance [m] at which the robot is at its goal."""


def add_options(parser):
    """Add the options of all navigation nodes to a parser of the command line."""
    parser.add_argument("--robot", default="robot", help="name space of the robot")
    parser.add_argument("--goal", help="goal x,y in the map [m] (default: as the simulation sends)")


def goal_of(options):
    """Return the goal of the options, None if there is none."""
    return tuple(float(one) for one in options.goal.split(",")) if options.goal else None


def heading_of(z, w):
    """Return the heading [rad] of a quaternion that turns about the vertical axis."""
    return 2.0 * math.atan2(z, w)


class ScanDriver:
    """Answers every scan with one command, as soon as the pose of its time is known.

    Args:
        goal: x, y in the map [m]; None: as :meth:`take_goal` says.
        planner: makes the commands.

    Attributes:
        commands: number of commands.
        arrived: whether the robot was at its goal at the latest command.
    """

    def __init__(self, goal=None, planner=None):
        self.planner, self.goal, self.fixed = planner or LocalPlanner(), goal, goal is not None
        self.pose, self.scan, self.commands, self.arrived = None, None, 0, False

    @property
    def done(self):
        """Whether the robot is at the goal of the command line; goals that the simulation sends can change."""
        return self.fixed and self.arrived

    def take_goal(self, x, y):
        """Drive to another goal, if none was given at the start."""
        if not self.fixed:
            self.goal, self.arrived = (x, y), False

    def take_pose(self, stamp, x, y, heading):
        """Take the pose [m], [rad] at a time [ns]; return the command that it completes, or None."""
        self.pose = stamp, (x, y, heading)
        return self._answer()

    def take_scan(self, stamp, ranges, angle_min, increment):
        """Take a scan of a time [ns], ranges [m] and angles [rad]; return the command that it completes, or None."""
        self.scan = stamp, ranges, angle_min, increment
        return self._answer()

    def _answer(self):
        """Return speed [m/s] and turn rate [rad/s], None if something is missing."""
        if self.scan is None or self.pose is None or self.goal is None or self.pose[0] < self.scan[0]:
            return None
        (_, ranges, angle_min, increment), self.scan = self.scan, None
        goal = in_robot_frame(self.pose[1], self.goal)
        self.arrived = self.arrived or math.hypot(*goal) < NEAR
        self.commands += 1
        if self.arrived:
            return 0.0, 0.0
        return self.planner.command(ranges, angle_min, increment, goal)

    def summary(self):
        """Return a line about the end."""
        return f"{'arrived' if self.arrived else 'stopped'} after {self.commands} commands"
