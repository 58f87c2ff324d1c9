"""Input of navigators: the state of the robot, the visible people and the stage."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, Twist, Walls, wrap_angle
from crowdbot.data import Forecast
from crowdbot.prediction import Predictor
from crowdbot.sensors import Odometry, Reading, main_scan
from crowdbot.typing import Floats

from .goal_motion import SLOWING_TIME, TURN_GAIN
from .track_history import HORIZON, TrackHistory, choose_predictor

BY_INDEX: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
"""Default of ids: people are numbered by their index."""
CERTAIN: Floats = np.ones(0)
"""Default of existence: everybody is there."""
NO_GESTURE: NDArray[np.int64] = np.zeros(0, dtype=np.int64)
"""Default of gestures: nobody makes one, or nobody knows."""
DISC: Floats = np.zeros((0, 2))
"""Outline of a disc: no corners."""
AT_GOAL = (math.nan, math.nan)
"""Default of the waypoint: the goal."""
LIMITS = ("max_speed", "max_turn_rate", "max_acceleration", "max_turn_acceleration")
"""Limits of a drive that must be above 0."""


class DriveLimits(NamedTuple):
    """Limits of a drive; unknown accelerations are ``inf``."""

    max_speed: float
    """Maximum speed [m/s]."""
    max_turn_rate: float
    """Maximum turn rate [rad/s]."""
    max_acceleration: float = math.inf
    """Maximum acceleration [m/s2]."""
    max_turn_acceleration: float = math.inf
    """Maximum angular acceleration [rad/s2]."""
    holonomic: bool = False
    """Whether the drive moves in every direction without turning; the limits then apply to the velocity vector."""


@dataclass(frozen=True)
class VisiblePeople:
    """The people visible to a robot.

    Fields:
        position: ``[N, 2]`` [m].
        velocity: ``[N, 2]`` [m/s].
        radius: ``[N]`` [m].
        ids: ``[N]`` identities; default: the indices.
        existence: ``[N]`` probability that there is a person, as a tracker says; default 1. MPC and time-elastic band
            weigh the cost of a contact by it.
        gesture: ``[N]`` code of the gesture that each person makes to the robot, an index in
            :data:`crowdbot.core.GESTURES`; default 0, none. A tracker of laser scans knows no gestures.
    """

    position: Floats
    velocity: Floats
    radius: Floats
    ids: NDArray[np.int64] = field(default_factory=lambda: BY_INDEX)
    existence: Floats = field(default_factory=lambda: CERTAIN)
    gesture: NDArray[np.int64] = field(default_factory=lambda: NO_GESTURE)

    def __post_init__(self) -> None:
        if self.ids is BY_INDEX:
            object.__setattr__(self, "ids", np.arange(len(self.radius)))
        if self.existence is CERTAIN:
            object.__setattr__(self, "existence", np.ones(len(self.radius)))
        if self.gesture is NO_GESTURE:
            object.__setattr__(self, "gesture", np.zeros(len(self.radius), dtype=np.int64))

    @classmethod
    def none(cls) -> VisiblePeople:
        """Return no people."""
        return cls(np.zeros((0, 2)), np.zeros((0, 2)), np.zeros(0))

    def __len__(self) -> int:
        """Return the number of people."""
        return len(self.radius)


@dataclass(frozen=True, kw_only=True)
class Observation:
    """Input of a decision of one robot in one environment.

    Fields:
        pose: x, y [m] and heading [rad] of the robot.
        goal: x, y [m].
        radius: radius of the robot [m].
        limits: limits of the drive.
        twist: current velocity.
        people: visible people and other robots.
        walls: walls of the stage.
        scan: latest scan of its main laser scanner, or None; default: of ``readings``, the scan with the widest field
            of view whose plane is within 45 degrees of the horizontal; then the one with the most beams, then the
            first (:func:`crowdbot.sensors.main_scan`).
        dt: time until the next decision [s].
        time: simulated time [s].
        readings: latest reading of each sensor by its name; sensors without a reading yet are missing.
        waypoint: next point x, y [m] of the planned path, in sight of the robot; default: the goal.
        tracks: past positions of the visible people, or None.
        predictor: default predictor of :meth:`forecast`, or None.
        predictor_step: time between rows of a forecast [s]; default: of the tracks.
        outline: corners ``[K, 2]`` of the convex outline of the robot in its frame, counter-clockwise [m]; without
            corners (default) the robot is a disc. ``radius`` is that of the circumscribed disc.

    Raises:
        InputError: a number is not finite or a radius, limit or ``dt`` is not above 0.

    >>> here = Observation(pose=(0.0, 0.0, 0.0), goal=(4.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1)
    >>> here.nearest, here.distance, here.towards_goal(0.8)
    (inf, 4.0, Twist(forward=0.8, turn=0.0, left=0.0))
    """

    pose: tuple[float, float, float]
    goal: tuple[float, float]
    radius: float
    limits: DriveLimits
    dt: float
    twist: Twist = field(default_factory=Twist)
    people: VisiblePeople = field(default_factory=VisiblePeople.none)
    walls: Walls = field(default_factory=Walls.of)
    scan: Reading | None = None
    time: float = 0.0
    readings: Mapping[str, Reading] = field(default_factory=dict)
    waypoint: tuple[float, float] = AT_GOAL
    tracks: TrackHistory | None = None
    predictor: Predictor | None = None
    predictor_step: float | None = None
    outline: Floats = field(default_factory=lambda: DISC)

    def __post_init__(self) -> None:
        if self.waypoint is AT_GOAL:
            object.__setattr__(self, "waypoint", self.goal)
        if self.scan is None and self.readings:
            object.__setattr__(self, "scan", main_scan(self.readings.values()))
        vectors = (("pose", self.pose), ("goal", self.goal), ("twist", self.twist), ("waypoint", self.waypoint))
        for name, values in vectors:
            if not all(math.isfinite(value) for value in values):
                raise InputError(f"observation: {name} = {tuple(map(float, values))} is not finite")
        for name, value in (
            ("radius", self.radius),
            ("dt", self.dt),
            *zip(LIMITS, self.limits[:4], strict=True),
        ):
            if not value > 0.0:
                raise InputError(f"observation: {name} = {value} must be above 0")

    @classmethod
    def of(
        cls,
        scene: Scene,
        robot: int,
        limits: DriveLimits,
        *,
        dt: float,
        twist: Twist | None = None,
        seen: NDArray[np.bool_] | None = None,
        sight: float = math.inf,
        scan: Reading | None = None,
        outline: Floats | None = None,
        environment: int = 0,
        ids: NDArray[np.int64] | None = None,
        gesture: NDArray[np.int64] | None = None,
        readings: Mapping[str, Reading] | None = None,
        waypoint: tuple[float, float] | None = None,
        tracks: TrackHistory | None = None,
    ) -> Observation:
        """Return the observation of a robot in a scene, with the true state of the visible people.

        Args:
            scene: current scene with the goal of the robot.
            robot: index of the robot.
            limits: limits of its drive.
            dt: time until the next decision [s].
            twist: current twist; by default from its velocity, without rotation.
            seen: ``[A]`` visible agents, such as ``scan.visible_agents(A)[0]``; default all.
            sight: largest distance of visible agents, centre to centre [m].
            scan: latest scan.
            outline: convex outline of the robot ``[K, 2]`` [m]; None for a disc.
            environment: index of the environment.
            ids: ``[A]`` identities of the agents; default: their indices in the scene.
            gesture: ``[A]`` codes of their gestures; default: none.
            readings: latest reading of each sensor.
            waypoint: next point of the planned path [m]; default: the goal.
            tracks: past positions of the visible people.
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
            people=VisiblePeople(
                scene.position[e, chosen],
                scene.velocity[e, chosen],
                scene.radius[e, chosen],
                np.flatnonzero(chosen) if ids is None else ids[chosen],
                gesture=NO_GESTURE if gesture is None else gesture[chosen],
            ),
            walls=scene.walls,
            scan=scan,
            time=float(np.broadcast_to(scene.time, (scene.shape[0],))[e]),
            readings={} if readings is None else readings,
            waypoint=AT_GOAL if waypoint is None else waypoint,
            tracks=tracks,
            outline=DISC if outline is None else outline,
        )

    @property
    def wall_radius(self) -> float:
        """Distance [m] from a straight path to a wall that the robot touches: half of its width, or its radius."""
        return wall_radius(self.radius, self.outline)

    @property
    def position(self) -> Floats:
        """Position of the robot, ``[2]`` [m]."""
        return np.array(self.pose[:2], dtype=np.float64)

    @property
    def heading(self) -> float:
        """Heading of the robot [rad]."""
        return self.pose[2]

    @property
    def velocity(self) -> Floats:
        """Velocity in the world, ``[2]`` [m/s]."""
        cos, sin = math.cos(self.heading), math.sin(self.heading)
        forward, left = self.twist.forward, self.twist.left
        return np.array([cos * forward - sin * left, sin * forward + cos * left])

    @property
    def distance(self) -> float:
        """Distance to the goal [m]."""
        return math.dist(self.pose[:2], self.goal)

    @property
    def bearing(self) -> float:
        """Direction to the goal in the robot frame, -pi to pi [rad]; 0 at the goal."""
        return self.direction_to(self.goal)

    @property
    def remaining(self) -> float:
        """Shortest possible length of the remaining path, through the waypoint [m]."""
        return math.dist(self.pose[:2], self.waypoint) + math.dist(self.waypoint, self.goal)

    @property
    def odometry(self) -> Odometry | None:
        """Latest reading of the first odometry, or None."""
        return next((reading for reading in self.readings.values() if isinstance(reading, Odometry)), None)

    def direction_to(self, point: tuple[float, float]) -> float:
        """Return the direction to a point x, y [m] in the robot frame, -pi to pi [rad]; 0 at the point."""
        if math.dist(self.pose[:2], point) == 0.0:
            return 0.0
        return wrap_angle(math.atan2(point[1] - self.pose[1], point[0] - self.pose[0]) - self.heading)

    @property
    def clearances(self) -> Floats:
        """Clearance to each person, surface to surface, ``[N]`` [m]."""
        away = self.people.position - self.position
        return np.asarray(np.hypot(away[:, 0], away[:, 1]) - self.people.radius - self.radius)

    @property
    def nearest(self) -> float:
        """Clearance to the nearest person [m], ``inf`` without people."""
        return float(np.min(self.clearances, initial=math.inf))

    def towards_goal(self, speed: float) -> Twist:
        """Return the twist along the path to the goal, straight to the waypoint, at up to ``speed`` [m/s].

        It turns on the spot if the bearing of the waypoint is above 60 degrees, and slows down to stop at the goal.
        """
        bearing, remaining = self.direction_to(self.waypoint), self.remaining
        ahead = max(0.0, 2.0 * math.cos(bearing) - 1.0)
        top = min(speed, self.limits.max_speed, remaining / SLOWING_TIME, self.braking_speed(remaining))
        return Twist(top * ahead, self.turn_by(bearing))

    def forecast(
        self,
        predictor: Predictor | None = None,
        seconds: float = HORIZON,
        *,
        samples: int = 1,
        seed: int = 0,
        dt: float | None = None,
    ) -> Forecast:
        """Return where a predictor expects the people of the newest row of ``tracks``.

        Args:
            predictor: any predictor whose goal does not require the future; default: that of the robot in the trial.
            seconds: time to predict [s], rounded up to rows of the forecast.
            samples: number of futures.
            seed: random seed; the stream also depends on the time.
            dt: time between rows of the past and of the forecast [s]; default: of the predictor in the trial, or of
                the tracks.

        Raises:
            InputError: there are no tracks or no predictor, or the predictor cannot use the tracks.
        """
        if self.tracks is None:
            raise InputError("observation: forecast needs tracks, but they are None")
        known, step = choose_predictor(predictor, self.predictor, dt, self.predictor_step)
        if step is None and len(self.tracks.times) < 2:
            step = self.dt
        return self.tracks.forecast(known, seconds, dt=step, walls=self.walls, samples=samples, seed=seed)

    def turn_by(self, angle: float) -> float:
        """Return the turn rate [rad/s] that turns the robot by ``angle`` [rad] quickly and without overshoot."""
        size = min(TURN_GAIN * abs(angle), self.limits.max_turn_rate)
        if math.isfinite(self.limits.max_turn_acceleration):
            size = min(size, math.sqrt(1.6 * self.limits.max_turn_acceleration * abs(angle)))
        return math.copysign(size, angle)

    def braking_speed(self, distance: float) -> float:
        """Return the speed [m/s] from which the drive stops within ``distance`` [m], with 20 % reserve."""
        if math.isinf(self.limits.max_acceleration):
            return math.inf
        return math.sqrt(1.6 * self.limits.max_acceleration * max(0.0, distance))


def wall_radius(radius: float, outline: Floats) -> float:
    """Return half of the width of an outline ``[K, 2]`` across its forward axis [m], or the radius of a disc."""
    return float(np.abs(outline[:, 1]).max()) if len(outline) else radius
