"""What a robot knows when its navigator decides."""

from __future__ import annotations

import math
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, Twist, Walls, wrap
from crowdbot.sensors import Reading

__all__ = ["Limits", "Observation", "People"]

Floats = NDArray[np.float64]

TURN_GAIN = 3.0
"""Turn rate [rad/s] asked for each rad of error in direction."""
SLOWING_TIME = 0.5
"""Near the goal the speed is at most the distance over this time [s]."""


class Limits(NamedTuple):
    """What a robot's drive can do; an acceleration that nobody knows is ``inf``."""

    max_speed: float
    """[m/s]"""
    max_turn_rate: float
    """[rad/s]"""
    max_acceleration: float = math.inf
    """[m/s2]"""
    max_turn_acceleration: float = math.inf
    """[rad/s2]"""


@dataclass(frozen=True)
class People:
    """The people that a robot sees.

    Fields:
        position: ``[N, 2]`` [m].
        velocity: ``[N, 2]`` [m/s].
        radius: ``[N]`` [m].
    """

    position: Floats
    velocity: Floats
    radius: Floats

    @classmethod
    def none(cls) -> People:
        """Return nobody."""
        return cls(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0))

    def __len__(self) -> int:
        """Return how many there are."""
        return len(self.radius)


@dataclass(frozen=True, kw_only=True)
class Observation:
    """What one robot in one environment knows when it decides.

    Fields:
        pose: x, y [m] and heading [rad] of the robot.
        goal: x, y [m].
        radius: of the robot [m].
        limits: of its drive.
        twist: how it moves now.
        people: those its sensors see, other robots among them.
        walls: of the stage.
        scan: latest reading of its sensor, None when it has none.
        dt: time until it is asked again [s].
        time: simulated time [s].

    Raises:
        InputError: a number is not finite or a radius, limit or ``dt`` is not above 0.

    >>> here = Observation(pose=(0.0, 0.0, 0.0), goal=(4.0, 0.0), radius=0.3, limits=Limits(1.0, 2.0), dt=0.1)
    >>> here.nearest, here.distance, here.towards_goal(0.8)
    (inf, 4.0, Twist(forward=0.8, turn=0.0, left=0.0))
    """

    pose: tuple[float, float, float]
    goal: tuple[float, float]
    radius: float
    limits: Limits
    dt: float
    twist: Twist = field(default_factory=Twist)
    people: People = field(default_factory=People.none)
    walls: Walls = field(default_factory=Walls.of)
    scan: Reading | None = None
    time: float = 0.0

    def __post_init__(self) -> None:
        for name, values in (("pose", self.pose), ("goal", self.goal), ("twist", self.twist)):
            if not all(math.isfinite(value) for value in values):
                raise InputError(f"observation: {name} = {tuple(map(float, values))} is not finite")
        for name, value in (("radius", self.radius), ("dt", self.dt), *zip(Limits._fields, self.limits, strict=True)):
            if not value > 0.0:
                raise InputError(f"observation: {name} = {value} must be above 0")

    @classmethod
    def of(
        cls,
        scene: Scene,
        robot: int,
        limits: Limits,
        *,
        dt: float,
        twist: Twist | None = None,
        seen: NDArray[np.bool_] | None = None,
        sight: float = math.inf,
        scan: Reading | None = None,
        environment: int = 0,
    ) -> Observation:
        """Return what a robot of a scene knows, with the true state of the people it sees.

        Args:
            scene: now; the robot's goal stands in it.
            robot: its index.
            limits: of its drive.
            dt: time until it is asked again [s].
            twist: how it moves; by default from its velocity, not turning.
            seen: ``[A]`` who is seen, for instance ``scan.seen(A)[0]``; by default everyone.
            sight: nobody farther than this is seen, from centre to centre [m].
            scan: handed on.
            environment: which one.
        """
        e = environment
        place, heading = scene.position[e, robot], float(scene.heading[e, robot])
        away = np.hypot(*(scene.position[e] - place).T)
        chosen = scene.active[e] & (away <= sight) & (True if seen is None else seen)
        chosen[robot] = False
        if twist is None:
            vx, vy = scene.velocity[e, robot].tolist()
            cos, sin = math.cos(heading), math.sin(heading)
            twist = Twist(cos * vx + sin * vy, 0.0, cos * vy - sin * vx)
        return cls(
            pose=(float(place[0]), float(place[1]), heading),
            goal=(float(scene.goal[e, robot, 0]), float(scene.goal[e, robot, 1])),
            radius=float(scene.radius[e, robot]),
            limits=limits,
            dt=dt,
            twist=twist,
            people=People(scene.position[e, chosen], scene.velocity[e, chosen], scene.radius[e, chosen]),
            walls=scene.walls,
            scan=scan,
            time=scene.time,
        )

    @property
    def position(self) -> Floats:
        """Where the robot is, ``[2]`` [m]."""
        return np.array(self.pose[:2], dtype=np.float64)

    @property
    def heading(self) -> float:
        """Where it looks [rad]."""
        return self.pose[2]

    @property
    def velocity(self) -> Floats:
        """How it moves in the world, ``[2]`` [m/s]."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        forward, left = self.twist.forward, self.twist.left
        return np.array([cos * forward - sin * left, sin * forward + cos * left])

    @property
    def distance(self) -> float:
        """Distance to the goal [m]."""
        return math.dist(self.pose[:2], self.goal)

    @property
    def bearing(self) -> float:
        """Direction to the goal in the robot's frame, -pi to pi [rad]; 0 when it is there."""
        if self.distance == 0.0:
            return 0.0
        return wrap(math.atan2(self.goal[1] - self.pose[1], self.goal[0] - self.pose[0]) - self.heading)

    @property
    def clearances(self) -> Floats:
        """Clearance to each person, surface to surface, ``[N]`` [m]."""
        away = self.people.position - self.position
        return np.asarray(np.hypot(away[:, 0], away[:, 1]) - self.people.radius - self.radius)

    @property
    def nearest(self) -> float:
        """Clearance to the nearest person [m], ``inf`` when nobody is seen."""
        return float(np.min(self.clearances, initial=math.inf))

    def towards_goal(self, speed: float) -> Twist:
        """Return the twist straight to the goal at up to ``speed`` [m/s].

        It turns on the spot while the goal lies more than 60 degrees aside, and slows near the goal so that the drive
        can stop there.
        """
        ahead = max(0.0, 2.0 * math.cos(self.bearing) - 1.0)
        top = min(speed, self.limits.max_speed, self.distance / SLOWING_TIME, self.braking_speed(self.distance))
        return Twist(top * ahead, self.turn_by(self.bearing))

    def turn_by(self, angle: float) -> float:
        """Return the turn rate [rad/s] that turns the robot by ``angle`` [rad], soon and without overshoot."""
        size = min(TURN_GAIN * abs(angle), self.limits.max_turn_rate)
        if math.isfinite(self.limits.max_turn_acceleration):
            size = min(size, math.sqrt(1.6 * self.limits.max_turn_acceleration * abs(angle)))
        return math.copysign(size, angle)

    def braking_speed(self, distance: float) -> float:
        """Return the speed [m/s] from which the drive can stop within ``distance`` [m], with a fifth in reserve."""
        if math.isinf(self.limits.max_acceleration):
            return math.inf
        return math.sqrt(1.6 * self.limits.max_acceleration * max(0.0, distance))
