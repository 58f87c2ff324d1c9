"""The contract of sensors: what a part of a robot at a pose measures in a scene."""

from __future__ import annotations

from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Pose, Scene, SpatialPose, check_number

from .noise import Noise, Randomness

__all__ = ["Reading", "Sensor"]


@dataclass(frozen=True)
class Reading:
    """What a sensor measured at one instant in E environments; each sensor adds its own arrays.

    Fields:
        time: simulated time [s].
        pose: where the sensor was, in the plane or in space, as it was given.
    """

    time: float
    pose: Pose | SpatialPose


@dataclass(frozen=True, kw_only=True)
class Sensor(ABC):
    """Something that looks at a scene from a pose.

    Fields:
        rate: readings per second [Hz]; who owns the time asks for a reading that often.
        noise: what happens to every value, one :class:`Noise` or a tuple of them.
        delay: time from the instant of a measurement until its reading is handed over [s]; who owns the time waits
            that long (:class:`Schedule`). The reading keeps the time of the instant.

    A sensor with ``remembers`` takes its own reading before as ``measure(..., last=...)``.
    """

    rate: float = 10.0
    noise: Noise | tuple[Noise, ...] = ()
    delay: float = 0.0
    remembers: ClassVar[bool] = False

    def __post_init__(self) -> None:
        check_number(type(self).__name__, "rate", self.rate, "Hz", min=1e-6)
        check_number(type(self).__name__, "delay", self.delay, "s", min=0.0, max=3600.0)
        parts = (self.noise,) if isinstance(self.noise, Noise) else tuple(self.noise)
        for part in parts:
            if not isinstance(part, Noise):
                raise InputError(f"{type(self).__name__}: noise holds {part!r}, which is not a Noise")
        object.__setattr__(self, "noise", parts)

    @property
    def noises(self) -> tuple[Noise, ...]:
        """The noise as a tuple, however it was given."""
        return (self.noise,) if isinstance(self.noise, Noise) else self.noise

    @abstractmethod
    def measure(self, scene: Scene, pose: Pose | SpatialPose, rng: Randomness | None = None) -> Reading:
        """Return what is measured from ``pose``; the caller has left the carrier out: ``scene.without(robot)``.

        Raises:
            InputError: scene and pose have different numbers of environments, or noise lacks a generator.
        """

    def check(self, scene: Scene, pose: Pose | SpatialPose) -> None:
        """Raise :class:`InputError` unless ``pose`` is finite and has one place for each environment of ``scene``."""
        count = scene.shape[0]
        turn = pose.rotation if isinstance(pose, SpatialPose) else pose.heading[:, None]
        if len(pose.position) != count or len(turn) != count:
            raise InputError(
                f"{type(self).__name__}: the pose has {len(pose.position)} places for {count} environments"
            )
        if not (np.isfinite(pose.position).all() and np.isfinite(turn).all()):
            raise InputError(f"{type(self).__name__}: the pose of the sensor is not finite")


def in_space(pose: Pose | SpatialPose) -> SpatialPose:
    """Return the pose in space; a planar one is at the height of a usual mount, level."""
    return pose if isinstance(pose, SpatialPose) else pose.to_spatial()


def in_plane(pose: Pose | SpatialPose) -> Pose:
    """Return the pose as it is seen from above."""
    return pose.planar if isinstance(pose, SpatialPose) else pose


def finite_or_nan(values: NDArray[np.float64]) -> NDArray[np.float64]:
    """Return ``values`` with NaN for what noise has made infinite."""
    return np.asarray(np.where(np.isfinite(values), values, np.nan))
