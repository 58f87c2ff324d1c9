"""Wheel odometry: a drifting pose integrated from the rotation of the wheels."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Pose, SpatialPose, check_number

from .imu import elapsed_time
from .noise import Randomness, apply_noise, normals
from .sensor import Reading, Sensor, finite_or_nan, planar_pose
from .view import SensorView

__all__ = ["Odometry", "OdometryState", "WheelOdometry"]

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Odometry(Reading):
    """The pose by wheel odometry in E environments.

    Fields:
        estimate: integrated pose; starts at the true pose.
        twist: ``[E, 3]`` forward [m/s], turn [rad/s], left [m/s], mean since the previous reading.
        travelled: ``[E, 3]`` distance of the left and right wheel and sideways, with errors [m].
        ticks: ``[E, 3]`` counts of the encoders, 0 without encoders.
    """

    estimate: Pose
    twist: Floats
    travelled: Floats
    ticks: NDArray[np.int64]


@dataclass(frozen=True)
class OdometryState:
    """State of wheel odometry after a measurement, in E environments.

    Fields:
        time: time of the measurement [s], a number or ``[E]``.
        pose: true pose of the robot.
        estimate: pose from the wheels.
        travelled: ``[E, 3]`` distance of the left wheel, the right wheel and sideways, with errors [m].
        ticks: ``[E, 3]`` counts of the encoders.
    """

    time: float | Floats
    pose: Pose | SpatialPose
    estimate: Pose
    travelled: Floats
    ticks: NDArray[np.int64]


@dataclass(frozen=True)
class WheelOdometry(Sensor):
    """Encoders on the wheels of a differential drive, integrated along arcs (errors are off by default).

    Systematic errors are wrong wheel radii and a wrong track width (Borenstein & Feng 1996, doi:10.1109/70.544770).
    Random errors grow with the square root of the distance of each wheel. ``noise`` is added to the reported twist,
    not to the pose.

    Fields:
        track: assumed distance between the wheels [m]; wheel_radius: assumed wheel radius [m].
        left_scale, right_scale: true over assumed radius of the wheels.
        track_scale: true over assumed track.
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
    """

    track: float = 0.4
    wheel_radius: float = 0.1
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
            check_number("WheelOdometry", name, getattr(self, name), unit, exclusive_min=0.0)
        check_number("WheelOdometry", "slip", self.slip, "m", min=0.0)
        check_number("WheelOdometry", "ticks_per_turn", self.ticks_per_turn, min=0, whole=True)

    @property
    def tick(self) -> float:
        """Distance of one encoder count [m], 0 without rounding."""
        return 2.0 * math.pi * self.wheel_radius / self.ticks_per_turn if self.ticks_per_turn else 0.0

    def measure(
        self, view: SensorView, state: OdometryState | None, rng: Randomness | None = None
    ) -> tuple[Odometry, OdometryState]:
        """Return the pose from the wheels, which starts at the true pose, and the state for the next measurement.

        Raises:
            InputError: numbers of environments differ, time did not increase, or noise lacks a generator.
        """
        self.check(view)
        here = planar_pose(view.pose)
        count = len(here.heading)
        if state is None:
            still = np.zeros((count, 3))
            shown = finite_or_nan(apply_noise(still, self.noises, rng))
            return _with_state(Odometry(view.time, view.pose, here, shown, still, still.astype(np.int64)))
        dt = elapsed_time(self, view, state)
        forward, left, turn = arc_between(planar_pose(state.pose), here)
        half = 0.5 * self.track * self.track_scale * turn
        way = np.stack([(forward - half) / self.left_scale, (forward + half) / self.right_scale, left], axis=1)
        if self.slip > 0.0:
            way = way + self.slip * np.sqrt(np.abs(way)) * normals(way.shape, rng)
        way[:, 2] *= self.holonomic
        travelled = state.travelled + way
        ticks = np.zeros((count, 3), dtype=np.int64)
        if self.tick:
            ticks = np.floor(travelled / self.tick + 0.5).astype(np.int64)
            way = (ticks - state.ticks) * self.tick
        moved, turned, aside = 0.5 * (way[:, 0] + way[:, 1]), (way[:, 1] - way[:, 0]) / self.track, way[:, 2]
        twist = np.stack([moved, turned, aside], axis=1) / dt
        shown = finite_or_nan(apply_noise(twist, self.noises, rng))
        estimate = along_arc(state.estimate, moved, aside, turned)
        return _with_state(Odometry(view.time, view.pose, estimate, shown, travelled, ticks))


def _with_state(reading: Odometry) -> tuple[Odometry, OdometryState]:
    state = OdometryState(reading.time, reading.pose, reading.estimate, reading.travelled, reading.ticks)
    return reading, state


def arc_between(before: Pose, after: Pose) -> tuple[Floats, Floats, Floats]:
    """Return forward [m], left [m] and turn [rad] of the arcs of constant twist between two poses, ``[E]`` each."""
    turn = math.pi - (math.pi - (after.heading - before.heading)) % (2.0 * math.pi)
    step = after.position - before.position
    middle = before.heading + 0.5 * turn
    cos, sin = np.cos(middle), np.sin(middle)
    bend = 1.0 / np.sinc(turn / (2.0 * math.pi))  # arc over chord
    return bend * (cos * step[:, 0] + sin * step[:, 1]), bend * (cos * step[:, 1] - sin * step[:, 0]), turn


def along_arc(pose: Pose, forward: Floats, left: Floats, turn: Floats) -> Pose:
    """Return the pose at the end of arcs."""
    middle = pose.heading + 0.5 * turn
    cos, sin = np.cos(middle), np.sin(middle)
    chord = np.sinc(turn / (2.0 * math.pi))
    step = np.stack([cos * forward - sin * left, sin * forward + cos * left], axis=1) * chord[:, None]
    return Pose(pose.position + step, pose.heading + turn)
