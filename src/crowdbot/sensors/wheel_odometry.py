"""Wheel odometry: the pose that a robot integrates from the rotation of its wheels."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Pose, SpatialPose, check_number, storable, wrap_angle
from crowdbot.typing import Floats

from .imu import elapsed_time
from .noise import Gaussian, Randomness, apply_noise, normals
from .sensor import Reading, Sensor, finite_or_nan, planar_pose
from .view import SensorView, WheelGeometry, WheelRotation


def arc_between(before: Pose, after: Pose) -> tuple[Floats, Floats, Floats]:
    """Return forward [m], left [m] and turn [rad] of the arcs of constant twist between two poses, ``[E]`` each.

    >>> [part.round(3).tolist() for part in arc_between(Pose.of((0.0, 0.0), 0.0), Pose.of((1.0, 1.0), math.pi / 2))]
    [[1.571], [0.0], [1.571]]
    """
    turn = wrap_angle(after.heading - before.heading)
    step = after.position - before.position
    middle = before.heading + 0.5 * turn
    cos, sin = np.cos(middle), np.sin(middle)
    bend = 1.0 / np.sinc(turn / (2.0 * math.pi))  # arc over chord
    return bend * (cos * step[:, 0] + sin * step[:, 1]), bend * (cos * step[:, 1] - sin * step[:, 0]), turn


def along_arc(pose: Pose, forward: Floats, left: Floats, turn: Floats) -> Pose:
    """Return the pose at the end of arcs, ``[E]``; the inverse of :func:`arc_between`."""
    middle = pose.heading + 0.5 * turn
    cos, sin = np.cos(middle), np.sin(middle)
    chord = np.sinc(turn / (2.0 * math.pi))
    step = np.stack([cos * forward - sin * left, sin * forward + cos * left], axis=1) * chord[:, None]
    return Pose(pose.position + step, pose.heading + turn)


def covariance_along_arc(covariance: Floats, pose: Pose, motion: Floats, spread: Floats) -> Floats:
    """Return the covariance ``[E, 3, 3]`` of x, y, heading at the end of arcs (first order).

    Args:
        covariance: ``[E, 3, 3]`` covariance at the begin.
        pose: pose at the begin.
        motion: ``[E, 3]`` forward [m], turn [rad] and left [m] of the arcs.
        spread: ``[E, 3, 3]`` covariance of the motion.

    >>> spread = np.diag([0.01, 0.0, 0.04])[None]
    >>> here, ahead = Pose.of((0.0, 0.0), 0.0), np.array([[1.0, 0.0, 0.0]])
    >>> covariance_along_arc(np.zeros((1, 3, 3)), here, ahead, spread)[0].diagonal().tolist()
    [0.01, 0.04, 0.0]
    """
    forward, turn, left = motion.T
    middle = pose.heading + 0.5 * turn
    chord = np.sinc(turn / (2.0 * math.pi))
    cos, sin = chord * np.cos(middle), chord * np.sin(middle)
    dx, dy = cos * forward - sin * left, sin * forward + cos * left
    none, one = np.zeros_like(dx), np.ones_like(dx)
    by_pose = np.array([[one, none, -dy], [none, one, dx], [none, none, one]]).transpose(2, 0, 1)
    by_motion = np.array([[cos, -0.5 * dy, -sin], [sin, 0.5 * dx, cos], [none, one, none]]).transpose(2, 0, 1)
    both = by_pose @ covariance @ by_pose.transpose(0, 2, 1), by_motion @ spread @ by_motion.transpose(0, 2, 1)
    return np.asarray(both[0] + both[1])


TRACK, RADIUS = 0.4, 0.1
"""Track and radius of wheels [m] of robots whose wheels are not known."""
SAME = 1e-9
"""Relative difference below which two lengths are the same."""


@storable
@dataclass(frozen=True)
class Odometry(Reading):
    """The pose by wheel odometry in E environments.

    Fields:
        estimate: integrated pose; starts at the true pose.
        twist: ``[E, 3]`` forward [m/s], turn [rad/s], left [m/s], mean since the previous reading.
        travelled: ``[E, 3]`` distance of the left and right wheels and sideways, with errors [m].
        ticks: ``[E, 3]`` counts of the encoders, 0 without encoders; the mean of several wheels on a side.
        covariance: ``[E, 3, 3]`` covariance of x, y [m] and heading [rad] of the estimate since the start, from slip.
        twist_covariance: ``[E, 3, 3]`` covariance of the twist, from slip and Gaussian noise.
    """

    estimate: Pose
    twist: Floats
    travelled: Floats
    ticks: NDArray[np.int64]
    covariance: Floats | None = None
    twist_covariance: Floats | None = None
    derived_fields: ClassVar[tuple[str, ...]] = ("covariance", "twist_covariance")

    def covariances(self, environment: int) -> tuple[Floats | None, Floats | None]:
        """Covariances ``[3, 3]`` of the estimate and of the twist in an environment; None: not known."""
        pose, twist = self.covariance, self.twist_covariance
        return None if pose is None else pose[environment], None if twist is None else twist[environment]


@storable
@dataclass(frozen=True)
class OdometryState:
    """State of wheel odometry after a measurement, in E environments.

    Fields:
        time: time of the measurement [s], a number or ``[E]``.
        pose: true pose of the robot.
        estimate: pose from the wheels.
        travelled: ``[E, 3]`` distance of the left wheels, the right wheels and sideways, with errors [m].
        ticks: ``[E, 3]`` counts of the encoders.
        angle: ``[E, W]`` angles of the encoders [rad]; None where wheels are not simulated.
        distance: ``[E, W]`` distance of each wheel, with errors [m].
        covariance: ``[E, 3, 3]`` covariance of x, y, heading of the estimate.
    """

    time: float | Floats
    pose: Pose | SpatialPose
    estimate: Pose
    travelled: Floats
    ticks: NDArray[np.int64]
    angle: Floats | None = None
    distance: Floats | None = None
    covariance: Floats | None = None


@dataclass(frozen=True)
class WheelOdometry(Sensor):
    """Encoders on the wheels of a robot; the pose is integrated along arcs (errors are off by default).

    In the physics world, the reading comes from the simulated angles of the wheels: slip and pushes show. Elsewhere
    (the plane, and bases that are pulled, such as those of legged robots) there is no slip: the wheels turn as the
    base moves. Steered wheels add the angle of their steering.

    The robot multiplies angles with the radius that it believes, and divides by the track that it believes:
    ``wheel_radius / left_scale``, ``wheel_radius / right_scale`` and ``track / track_scale``. If these are not those of
    the wheels, the pose drifts (Borenstein & Feng 1996, doi:10.1109/70.544770). Random errors grow with the square root
    of the distance of each wheel. ``noise`` is added to the reported twist, not to the pose.

    Fields:
        track: distance between the wheels [m] (default: that of the wheels; 0.4 for a robot without wheels).
        wheel_radius: radius of the wheels [m] (default: that of the wheels; 0.1 for a robot without wheels).
        left_scale, right_scale: true over believed radius of the wheels.
        track_scale: true over believed track.
        slip: standard deviation of the distance of a wheel after one metre [m].
        ticks_per_turn: encoder counts per revolution, 0 for no rounding.
        holonomic: whether sideways motion is measured too, as with omnidirectional wheels.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> scene, wheels = Scene.of([[9.0, 9.0]]), WheelOdometry()
    >>> first, state = wheels.measure(SensorView(scene, Pose.of((0.0, 0.0), 0.0)), wheels.begin())
    >>> view = SensorView(scene.replace(time=1.0), Pose.of((0.5, 0.0), 0.0))
    >>> later, state = wheels.measure(view, state)
    >>> later.estimate.position.round(12).tolist(), later.twist.round(12).tolist()
    ([[0.5, 0.0]], [[0.5, 0.0, 0.0]])

    The wheels of 0.06 m have turned by 10 rad, so they have slipped:

    >>> geometry = WheelGeometry.differential(track=0.3, radius=0.06)
    >>> angles = [WheelRotation(geometry, np.full((1, 2), angle)) for angle in (0.0, 10.0)]
    >>> _, state = wheels.measure(SensorView(scene, Pose.of((0.0, 0.0), 0.0), wheels=angles[0]), wheels.begin())
    >>> view = SensorView(scene.replace(time=1.0), Pose.of((0.5, 0.0), 0.0), wheels=angles[1])
    >>> wheels.measure(view, state)[0].estimate.position.round(12).tolist()
    [[0.6, 0.0]]
    """

    encoders: ClassVar[bool] = True
    batched = True

    track: float | None = None
    wheel_radius: float | None = None
    left_scale: float = 1.0
    right_scale: float = 1.0
    track_scale: float = 1.0
    slip: float = 0.0
    ticks_per_turn: int = 0
    holonomic: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("track", "wheel_radius", "left_scale", "right_scale", "track_scale"):
            unit = "m" if name in ("track", "wheel_radius") else ""
            if getattr(self, name) is not None:
                check_number("WheelOdometry", name, getattr(self, name), unit, exclusive_min=0.0)
        check_number("WheelOdometry", "slip", self.slip, "m", min=0.0)
        check_number("WheelOdometry", "ticks_per_turn", self.ticks_per_turn, min=0, whole=True)

    @property
    def tick(self) -> float:
        """Distance of one encoder count [m] of a robot without known wheels, 0 without rounding."""
        return self._tick(self.wheel_radius or RADIUS)

    def measure(
        self, view: SensorView, state: OdometryState | None, rng: Randomness | None = None
    ) -> tuple[Odometry, OdometryState]:
        """Return the pose from the wheels, which starts at the true pose, and the state for the next measurement.

        Raises:
            InputError: numbers of environments differ, time did not increase, or noise lacks a generator.
        """
        self.check(view)
        here = planar_pose(view.pose)
        if state is None:
            still = np.zeros((len(here.heading), 3))
            shown = finite_or_nan(apply_noise(still, self.noises, rng))
            nothing = np.zeros((len(still), 3, 3))
            counts, noise = still.astype(np.int64), nothing + self._noise
            reading = Odometry(view.time, view.pose, here, shown, still, counts, nothing, noise)
            return reading, _state(reading, *_first_encoders(view.wheels))
        dt = elapsed_time(self, view, state)
        wheels = view.wheels
        if wheels is None or wheels.angle is None:
            motion, spread, travelled, ticks = self._rolled(view, state, here, rng)
            encoders: tuple[Floats | None, Floats | None] = (None, None)
        else:
            motion, spread, travelled, ticks, encoders = self._encoded(wheels, state, rng)
        moved, turning, aside = motion.T
        shown = finite_or_nan(apply_noise(motion / dt, self.noises, rng))
        estimate = along_arc(state.estimate, moved, aside, turning)
        covariance = np.zeros_like(spread) if state.covariance is None else state.covariance
        if self.slip > 0.0:
            covariance = covariance_along_arc(covariance, state.estimate, motion, spread)
        twist_covariance = spread / np.square(np.reshape(dt, (-1, 1, 1))) + self._noise
        reading = Odometry(view.time, view.pose, estimate, shown, travelled, ticks, covariance, twist_covariance)
        return reading, _state(reading, *encoders)

    @property
    def _noise(self) -> Floats:
        """Covariance ``[3, 3]`` of the Gaussian noise of the twist."""
        return np.eye(3) * sum(noise.sd**2 for noise in self.noises if isinstance(noise, Gaussian))

    def _rolled(
        self, view: SensorView, state: OdometryState, here: Pose, rng: Randomness | None
    ) -> tuple[Floats, Floats, Floats, NDArray[np.int64]]:
        """Motion ``[E, 3]``, its covariance, and distances and counts of two wheels that roll with the base."""
        geometry = None if view.wheels is None else view.wheels.geometry
        true_track, true_radius = (0.0, 0.0) if geometry is None else (geometry.track, float(np.mean(geometry.radius)))
        track, true_track = _lengths(self.track, TRACK, true_track, self.track_scale)
        radius, true_radius = _lengths(self.wheel_radius, RADIUS, true_radius)
        forward, left, turn = arc_between(planar_pose(state.pose), here)
        half = 0.5 * true_track * turn
        way = np.stack([(forward - half) / self.left_scale, (forward + half) / self.right_scale, left], axis=1)
        way[:, :2] *= radius / true_radius
        if self.slip > 0.0:
            way = way + self.slip * np.sqrt(np.abs(way)) * normals(way.shape, rng)
        way[:, 2] *= self.holonomic
        travelled = state.travelled + way
        ticks = np.zeros(way.shape, dtype=np.int64)
        if tick := self._tick(radius):
            ticks = np.floor(travelled / tick + 0.5).astype(np.int64)
            way = (ticks - state.ticks) * tick
        motion = np.stack([0.5 * (way[:, 0] + way[:, 1]), (way[:, 1] - way[:, 0]) / track, way[:, 2]], axis=1)
        solution = np.array([[0.5, 0.5, 0.0], [-1.0 / track, 1.0 / track, 0.0], [0.0, 0.0, 1.0]])
        return motion, self._spread(solution, way), travelled, ticks

    def _encoded(
        self, wheels: WheelRotation, state: OdometryState, rng: Randomness | None
    ) -> tuple[Floats, Floats, Floats, NDArray[np.int64], tuple[Floats, Floats]]:
        """Motion ``[E, 3]``, its covariance, distances and counts from the angles of wheels; angles and distances."""
        geometry, angle = wheels.geometry, np.asarray(wheels.angle)
        before, distance = angle, np.zeros_like(angle)
        if state.angle is not None and state.distance is not None and state.angle.shape == angle.shape:
            before, distance = state.angle, state.distance
        radius = self._radii(geometry)
        way = (angle - before) * radius
        if self.slip > 0.0:
            way = way + self.slip * np.sqrt(np.abs(way)) * normals(way.shape, rng)
        after = distance + way
        counts = np.zeros(way.shape, dtype=np.int64)
        if self.ticks_per_turn:
            tick = 2.0 * math.pi * radius / self.ticks_per_turn
            counts = np.floor(after / tick + 0.5).astype(np.int64)
            way = (counts - np.floor(distance / tick + 0.5)) * tick
        motion, solution = self._solve(wheels, way)
        travelled = state.travelled + np.stack([*_mean_of_sides(way, geometry), motion[:, 2]], axis=1)
        sides = [np.rint(part).astype(np.int64) for part in _mean_of_sides(counts, geometry)]
        ticks = np.stack([*sides, np.zeros(len(way), dtype=np.int64)], axis=1)
        return motion, self._spread(solution, way), travelled, ticks, (angle, after)

    def _spread(self, solution: Floats, way: Floats) -> Floats:
        """Covariance ``[E, 3, 3]`` of a motion that is ``solution`` times the distances ``[E, W]`` of wheels."""
        scaled = solution * (self.slip**2 * np.abs(way))[:, None, :]
        return np.asarray(scaled @ np.swapaxes(solution, -1, -2))

    def _solve(self, wheels: WheelRotation, way: Floats) -> tuple[Floats, Floats]:
        """Forward, turn and left ``[E, 3]`` that fit the distances ``[E, W]`` best, and the matrix ``[E, 3, W]``."""
        geometry = wheels.geometry
        rows = wheels.rolling * geometry.radius[None, :, None]
        rows = np.broadcast_to(rows, (len(way), *rows.shape[1:])).copy()
        if geometry.track > 0.0:
            rows[:, :, 1] *= (self.track or geometry.track) / self.track_scale / geometry.track
        fixed = np.broadcast_to(wheels.constraints(), (len(way), *wheels.constraints().shape[1:]))
        whole = np.concatenate([rows, fixed], axis=1)
        values = np.concatenate([way, np.zeros(fixed.shape[:2])], axis=1)
        inverse = np.linalg.pinv(whole)
        motion = (inverse @ values[:, :, None])[:, :, 0]
        aside = self.holonomic or not geometry.sideways
        motion[:, 2] *= aside
        return np.asarray(motion), inverse[:, :, : way.shape[1]] * np.array([1.0, 1.0, aside])[:, None]

    def _radii(self, geometry: WheelGeometry) -> Floats:
        """Return the radius ``[W]`` that the robot believes of each wheel [m]."""
        mean = float(np.mean(geometry.radius))
        scales = {1: self.left_scale, -1: self.right_scale, 0: 0.5 * (self.left_scale + self.right_scale)}
        errors = np.array([scales[side] for side in geometry.sides.tolist()])
        return np.asarray(geometry.radius * ((self.wheel_radius or mean) / mean) / errors)

    def _tick(self, radius: float) -> float:
        """Return the distance of one encoder count of a wheel [m], 0 without rounding."""
        return 2.0 * math.pi * radius / self.ticks_per_turn if self.ticks_per_turn else 0.0


def _lengths(given: float | None, default: float, true: float, scale: float = 1.0) -> tuple[float, float]:
    """Return the length that a robot believes, and the true one; ``true`` is 0 if it is not known."""
    if true <= 0.0:
        believed = default if given is None else given
        return believed, believed * scale
    if given is None:
        return true / scale, true
    return given / scale, given if math.isclose(given, true, rel_tol=SAME) else true


def _mean_of_sides(values: NDArray[Any], geometry: WheelGeometry) -> list[Floats]:
    """Return the mean ``[E]`` of the wheels on the left, and on the right; of all if a side has none."""
    mean_of_sides = []
    for side in (1, -1):
        chosen = geometry.sides == side
        mean_of_sides.append(np.mean(values[:, chosen] if chosen.any() else values, axis=1))
    return mean_of_sides


def _first_encoders(wheels: WheelRotation | None) -> tuple[Floats | None, Floats | None]:
    if wheels is None or wheels.angle is None:
        return None, None
    return wheels.angle, np.zeros_like(wheels.angle)


def _state(reading: Odometry, angle: Floats | None, distance: Floats | None) -> OdometryState:
    return OdometryState(
        reading.time,
        reading.pose,
        reading.estimate,
        reading.travelled,
        reading.ticks,
        angle,
        distance,
        reading.covariance,
    )
