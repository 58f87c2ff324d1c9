"""An inertial measurement unit (IMU): specific force and turn rate from successive poses, with drifting biases."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from crowdbot.core import InputError, Pose, SpatialPose, check_number, product, storable
from crowdbot.typing import Floats

from .noise import Randomness, apply_noise, normals
from .sensor import Reading, Sensor, finite_or_nan, spatial_pose
from .view import SensorView

GRAVITY = 9.80665
"""Standard gravity [m/s^2]."""


@storable
@dataclass(frozen=True)
class ImuReading(Reading):
    """The reading of an IMU in E environments, in its own frame.

    Fields:
        acceleration: ``[E, 3]`` specific force [m/s^2]; at rest and level it is (0, 0, 9.80665).
        turn_rate: ``[E, 3]`` [rad/s].
        velocity: ``[E, 3]`` mean velocity in the world since the previous reading [m/s], NaN at the first. Ground
            truth.
        acceleration_bias, turn_bias: ``[E, 3]`` current biases. Ground truth.
    """

    acceleration: Floats
    turn_rate: Floats
    velocity: Floats
    acceleration_bias: Floats
    turn_bias: Floats


@storable
@dataclass(frozen=True)
class ImuState:
    """State of an IMU after a measurement, in E environments.

    Fields:
        time: time of the measurement [s], a number or ``[E]``.
        pose: pose of the unit.
        velocity: ``[E, 3]`` mean velocity since the previous measurement [m/s], NaN after the first.
        acceleration_bias: ``[E, 3]`` [m/s^2].
        turn_bias: ``[E, 3]`` [rad/s].
    """

    time: float | Floats
    pose: Pose | SpatialPose
    velocity: Floats
    acceleration_bias: Floats
    turn_bias: Floats


@dataclass(frozen=True)
class IMU(Sensor):
    """An inertial unit with white noise and random-walk biases (IEEE Std 952-1997; off by default).

    The motion is the finite difference of the poses of this and the two previous readings; the first two readings have
    no acceleration. ``noise`` is added to all six values after that.

    Fields:
        acceleration_noise: white noise density [m/s^2/sqrt(Hz)].
        turn_noise: white noise density [rad/s/sqrt(Hz)].
        acceleration_walk: random walk of the bias [m/s^2/sqrt(s)]; turn_walk: [rad/s/sqrt(s)].
        acceleration_offset: standard deviation of the initial bias [m/s^2]; turn_offset: [rad/s].
        max_acceleration: saturation [m/s^2], 0 for none; max_turn_rate: [rad/s].

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Pose, Scene
    >>> still, unit = Scene.of([[9.0, 9.0]]), IMU(rate=100.0)
    >>> unit.read(still, Pose.of((0.0, 0.0), 0.0)).acceleration.tolist()
    [[0.0, 0.0, 9.80665]]
    """

    batched = True

    acceleration_noise: float = 0.0
    turn_noise: float = 0.0
    acceleration_walk: float = 0.0
    turn_walk: float = 0.0
    acceleration_offset: float = 0.0
    turn_offset: float = 0.0
    max_acceleration: float = 0.0
    max_turn_rate: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in FIELDS:
            check_number("IMU", name, getattr(self, name), min=0.0)

    def measure(
        self, view: SensorView, state: ImuState | None, rng: Randomness | None = None
    ) -> tuple[ImuReading, ImuState]:
        """Return specific force and turn rate, and the state for the next measurement.

        Raises:
            InputError: numbers of environments differ, time did not increase, or noise lacks a generator.
        """
        self.check(view)
        here = spatial_pose(view.pose)
        shape = here.position.shape
        if state is None:
            dt: float | Floats = 1.0 / self.rate
            velocity = np.full(shape, np.nan)
            change, turn = np.zeros(shape), np.zeros(shape)
        else:
            dt, before = elapsed_time(self, view, state), spatial_pose(state.pose)
            velocity = (here.position - before.position) / dt
            change = np.where(np.isfinite(state.velocity), (velocity - state.velocity) / dt, 0.0)
            turn = rotation_vector(before.rotation, here.rotation) / dt
        change = change + np.array([0.0, 0.0, GRAVITY])
        force = np.einsum("eji,ej->ei", here.matrix, change)
        biases = self._biases(shape, dt, rng, state)
        force = force + biases[0] + self._white(self.acceleration_noise, shape, dt, rng)
        turn = turn + biases[1] + self._white(self.turn_noise, shape, dt, rng)
        six = finite_or_nan(apply_noise(np.concatenate([force, turn], axis=1), self.noises, rng))
        force, turn = _limited(six[:, :3], self.max_acceleration), _limited(six[:, 3:], self.max_turn_rate)
        reading = ImuReading(view.time, view.pose, force, turn, velocity, *biases)
        return reading, ImuState(view.time, view.pose, velocity, *biases)

    def _biases(
        self, shape: tuple[int, ...], dt: float | Floats, rng: Randomness | None, state: ImuState | None
    ) -> tuple[Floats, Floats]:
        if state is None:
            start = (self.acceleration_offset, self.turn_offset)
            return _scaled(start[0], shape, rng), _scaled(start[1], shape, rng)
        root = np.sqrt(dt)
        return (
            state.acceleration_bias + _scaled(self.acceleration_walk * root, shape, rng),
            state.turn_bias + _scaled(self.turn_walk * root, shape, rng),
        )

    def _white(self, density: float, shape: tuple[int, ...], dt: float | Floats, rng: Randomness | None) -> Floats:
        return _scaled(density / np.sqrt(dt), shape, rng)


FIELDS = (
    "acceleration_noise",
    "turn_noise",
    "acceleration_walk",
    "turn_walk",
    "acceleration_offset",
    "turn_offset",
    "max_acceleration",
    "max_turn_rate",
)


def _scaled(sd: float | Floats, shape: tuple[int, ...], rng: Randomness | None) -> Floats:
    """Return normal draws with standard deviation ``sd``, a number or ``[E, 1]``; zeros without a draw if it is 0."""
    return np.asarray(np.zeros(shape) if not np.any(sd) else sd * normals(shape, rng))


def _limited(values: Floats, limit: float) -> Floats:
    return values if limit == 0.0 else np.clip(values, -limit, limit)


class TimedState(Protocol):
    """A state with the time [s] and the pose of the previous measurement."""

    @property
    def time(self) -> float | Floats:
        """Time of the previous measurement [s], a number or one for each environment ``[E]``."""

    @property
    def pose(self) -> Pose | SpatialPose:
        """Pose of the sensor at the previous measurement."""


def elapsed_time(sensor: Sensor, view: SensorView, state: TimedState) -> float | Floats:
    """Return the time since the previous measurement [s]: a number, or ``[E, 1]`` if environments have own times.

    Raises:
        InputError: time did not increase, or the numbers of environments differ.
    """
    if len(state.pose.position) != view.environments:
        raise InputError(
            f"{type(sensor).__name__}: the state has {len(state.pose.position)} environments,"
            f" but the view has {view.environments}"
        )
    dt = view.time - state.time
    if not np.all(dt > 0.0):
        before, now = np.broadcast_arrays(state.time, view.time)
        worst = int(np.argmin(np.ravel(now > before)))
        raise InputError(
            f"{type(sensor).__name__}: the previous measurement is at {np.ravel(before)[worst]} s and this one at"
            f" {np.ravel(now)[worst]} s; time must increase"
        )
    return dt[:, None] if isinstance(dt, np.ndarray) else dt


def rotation_vector(before: Floats, after: Floats) -> Floats:
    """Return the rotation from one quaternion ``[E, 4]`` to another as axis times angle [rad], in the first frame."""
    turn = product(before * np.array([1.0, -1.0, -1.0, -1.0]), after)
    turn = turn * np.where(turn[:, :1] < 0.0, -1.0, 1.0)
    size = np.sqrt((turn[:, 1:] ** 2).sum(axis=1, keepdims=True))
    angle = 2.0 * np.arctan2(size, turn[:, :1])
    return np.asarray(turn[:, 1:] * np.where(size > 1e-12, angle / np.maximum(size, 1e-300), 2.0))
