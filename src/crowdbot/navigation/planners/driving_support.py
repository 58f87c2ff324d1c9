"""Reactive Driving Support as a navigator, for robots whose shape is a capsule."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import Paper, Twist, check_number, kernel
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.orca_search import avoid_agent, best_velocity
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Floats

from .clearance import move_with

EAGER = 100.0
"""Value for unknown accelerations [m/s2], [rad/s2]."""
WEAK = 0.05
"""A half-plane whose normal is shorter after the change to the reference point cannot be met by driving."""
OVERLAP_TIME = 0.3
"""Time in which an overlap is resolved [s]."""
UNITS = {"speed": "m/s", "horizon": "s", "wall_horizon": "s", "lead": "m"}
"""Fields that must be positive."""


@dataclass(frozen=True)
class RDSNavigator(Navigator):
    """Corrects the motion to the waypoint as little as needed so that no part of a capsule hits anybody.

    The robot is a capsule along its x axis, from ``rear`` behind its centre to ``front`` ahead. For each person and
    wall, the disc of the capsule that is nearest gets a half-plane of velocities that avoid a contact for ``horizon``;
    the robot makes the whole change. A drive that only goes ahead has two degrees of freedom, forward speed and turn
    rate, as its reference point at ``lead`` ahead has two components of its velocity. Each half-plane becomes one of
    the velocity of this point, the limits of the drive are further half-planes, and the point takes the permitted
    velocity nearest to the one towards the waypoint. If there is none, the largest violation is minimised. A
    holonomic drive moves with the permitted velocity of its centre without turning.

    Fields:
        speed: largest speed [m/s], limited by the drive.
        horizon: time without contact with people [s].
        wall_horizon: the same for walls [s].
        margin: clearance that is kept [m].
        front, rear: ends of the axis of the capsule, ahead of and behind the centre [m].
        width: diameter of the capsule [m]; 0 takes the capsule, or the disc, of the robot's own shape.
        lead: distance of the reference point ahead of the centre [m].

    Source: Gonon, Paez-Granados, Billard 2021, doi:10.1109/LRA.2021.3068660. There the bounding shape is any convex
    one, and the half-planes are those of the velocity obstacle without its rounded tip.

    Raises:
        InputError: a number is out of its range.

    >>> from crowdbot.navigation import DriveLimits, VisiblePeople
    >>> person = VisiblePeople(np.array([[2.0, 0.3]]), np.array([[-1.0, 0.0]]), np.array([0.25]))
    >>> meeting = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(9.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> RDSNavigator(front=0.18, rear=0.5).act(meeting).turn < 0.0
    True
    """

    paper: ClassVar[Paper] = Paper(
        "Gonon, Paez-Granados, Billard",
        2021,
        "Reactive navigation in crowds for non-holonomic robots with convex bounding shape",
        "IEEE Robotics and Automation Letters 6",
        "10.1109/LRA.2021.3068660",
    )
    always_returns = True

    speed: float = 1.0
    horizon: float = 3.0
    wall_horizon: float = 1.0
    margin: float = 0.2
    front: float = 0.0
    rear: float = 0.0
    width: float = 0.0
    lead: float = 0.3

    def __post_init__(self) -> None:
        for name, unit in UNITS.items():
            check_number("RDSNavigator", name, getattr(self, name), unit, exclusive_min=0.0)
        for name in ("margin", "front", "rear", "width"):
            check_number("RDSNavigator", name, getattr(self, name), "m", min=0.0)

    def act(self, observation: Observation) -> Twist:
        # permitted twist nearest to that towards the waypoint
        limits = observation.limits
        top, x, y = min(self.speed, limits.max_speed), *observation.pose[:2]
        cos, sin = math.cos(observation.heading), math.sin(observation.heading)
        frame = np.array([[cos, sin], [-sin, cos]])
        people, segments = observation.people, wall_arrays(observation.walls).segments
        place = (people.position - (x, y)) @ frame.T
        moving = people.velocity @ frame.T
        walls = ((segments.reshape(-1, 2) - (x, y)) @ frame.T).reshape(-1, 4)
        twist, lead = observation.twist, 0.0 if limits.holonomic else self.lead
        rear, front, radius = self.rear, self.front, 0.5 * self.width or observation.wall_radius
        if not self.width and len(observation.outline):
            rear = max(0.0, -float(observation.outline[:, 0].min()) - radius)
            front = max(0.0, float(observation.outline[:, 0].max()) - radius)
        radius += self.margin
        shape = np.array([-rear, front, radius, lead])
        times = np.array([self.horizon, self.wall_horizon, max(observation.dt, OVERLAP_TIME)])
        now = np.array([twist.forward, twist.turn, twist.left])
        wish = self._wish(observation, top, lead)
        fixed = np.zeros((0, 4)) if limits.holonomic else _drive_lines(observation, top, lead)
        near = np.hypot(*place.T) < (2.0 * top + np.hypot(*moving.T)) * self.horizon + 2.0 * radius + 2.0
        place, moving, size = (np.ascontiguousarray(row[near]) for row in (place, moving, people.radius))
        out = np.zeros(2)
        fastest = top if limits.holonomic else math.hypot(top, lead * limits.max_turn_rate)
        _choose(shape, now, place, moving, size, np.ascontiguousarray(walls), times, fixed, fastest, wish, out)
        if limits.holonomic:
            return move_with(observation, np.asarray(frame.T @ out), self.speed)
        forward = min(max(float(out[0]), 0.0), top)
        return Twist(forward, float(np.clip(out[1] / lead, -limits.max_turn_rate, limits.max_turn_rate)))

    def _wish(self, observation: Observation, top: float, lead: float) -> Floats:
        """Return the velocity ``[2]`` of the reference point in the frame of the robot that leads to the waypoint."""
        if not observation.limits.holonomic:
            twist = observation.towards_goal(top)
            return np.array([twist.forward, lead * twist.turn])
        bearing = observation.direction_to(observation.waypoint)
        size = min(top, 2.0 * observation.remaining, observation.braking_speed(observation.remaining))
        return size * np.array([math.cos(bearing), math.sin(bearing)])


def _drive_lines(observation: Observation, top: float, lead: float) -> Floats:
    """Return the half-planes ``[4, 4]`` of the forward speed, from 0, and of the turn rate of a drive."""
    most = lead * observation.limits.max_turn_rate
    return np.array([[0.0, 0.0, 0.0, -1.0], [top, 0.0, 0.0, 1.0], [0.0, -most, 1.0, 0.0], [0.0, most, -1.0, 0.0]])


@kernel
def _add_disc(
    lines: Floats, at: int, x: float, y: float, vx: float, vy: float, reach: float, shape: Floats, now: Floats,
    horizon: float, overlap: float,
) -> int:  # fmt: skip
    """Add the half-plane of a moving disc in the frame of the robot, and return the number of lines."""
    lead, holonomic = shape[3], shape[3] == 0.0
    centre = min(max(x, shape[0]), shape[1])
    # the nearest disc of the capsule, and its velocity
    px, py = now[0], now[2] + now[1] * centre
    avoid_agent(lines, at, x - centre, y, px, py, vx, vy, reach, horizon, overlap, 1.0, 1.0)
    if holonomic:
        return at + 1
    # permitted: n . (forward, turn * arm) >= c; a disc at the axle gets the arm of the reference point
    arm = centre if abs(centre) > 0.5 * lead else lead
    nx, ny = -lines[at, 3], lines[at, 2]
    c = nx * lines[at, 0] + ny * lines[at, 1]
    ny *= arm / lead
    size = math.sqrt(nx * nx + ny * ny)
    if size < WEAK:
        return at
    nx, ny, c = nx / size, ny / size, c / size
    lines[at, 0], lines[at, 1], lines[at, 2], lines[at, 3] = c * nx, c * ny, ny, -nx
    return at + 1


@kernel
def _choose(
    shape: Floats, now: Floats, place: Floats, moving: Floats, size: Floats, walls: Floats, times: Floats,
    fixed: Floats, fastest: float, wish: Floats, out: Floats,
) -> None:  # fmt: skip
    """Write the permitted velocity of the reference point nearest to the wish, in the frame of the robot."""
    hard = len(fixed)
    lines = np.empty((hard + len(size) + len(walls), 4))
    lines[:hard] = fixed
    count, reach = int(np.int64(hard)), shape[2]
    for m in range(len(walls)):
        x, y = _nearest_to_axis(walls[m], shape[0], shape[1])
        centre = min(max(x, shape[0]), shape[1])
        if math.sqrt((x - centre) ** 2 + y * y) < reach + 2.0 * fastest * times[1]:
            count = _add_disc(lines, count, x, y, 0.0, 0.0, reach, shape, now, times[1], times[2])
    for a in range(len(size)):
        count = _add_disc(
            lines, count, place[a, 0], place[a, 1], moving[a, 0], moving[a, 1], reach + size[a], shape, now,
            times[0], times[2],
        )  # fmt: skip
    spare = np.empty_like(lines)
    out[0], out[1] = best_velocity(lines[:count], hard, count, fastest, wish[0], wish[1], spare)


@kernel
def _nearest_to_axis(wall: Floats, rear: float, front: float) -> tuple[float, float]:
    """Return the point of a wall that is nearest to the axis of the capsule."""
    best, bx, by = math.inf, wall[0], wall[1]
    ex, ey = wall[2] - wall[0], wall[3] - wall[1]
    length2 = max(ex * ex + ey * ey, 1e-18)
    for k in range(9):
        at = rear + (front - rear) * k / 8.0
        share = min(1.0, max(0.0, ((at - wall[0]) * ex - wall[1] * ey) / length2))
        x, y = wall[0] + share * ex, wall[1] + share * ey
        away = (x - at) ** 2 + y * y
        if away < best:
            best, bx, by = away, x, y
    return bx, by
