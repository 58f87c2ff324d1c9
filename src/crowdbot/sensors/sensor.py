"""The contract of sensors: what a part of a robot at a pose measures in a scene."""

from __future__ import annotations

import math
from abc import ABC, abstractmethod
from dataclasses import dataclass

from crowdbot.core import InputError, Pose, Scene

from .noise import Noise, Randomness

__all__ = ["Reading", "Sensor"]


@dataclass(frozen=True)
class Reading:
    """What a sensor measured at one instant in E environments; each sensor adds its own arrays.

    Fields:
        time: simulated time [s].
        pose: where the sensor was, positions ``[E, 2]`` [m] and headings ``[E]`` [rad].
    """

    time: float
    pose: Pose


@dataclass(frozen=True, kw_only=True)
class Sensor(ABC):
    """Something that looks at a scene from a pose.

    Fields:
        rate: readings per second [Hz]; who owns the time asks for a reading that often.
        noise: what is added to every value, one :class:`Noise` or a tuple of them.
    """

    rate: float = 10.0
    noise: Noise | tuple[Noise, ...] = ()

    def __post_init__(self) -> None:
        if not 0.0 < self.rate < math.inf:
            raise InputError(f"{type(self).__name__}: rate = {self.rate} Hz must be finite and above 0")
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
    def measure(self, scene: Scene, pose: Pose, rng: Randomness | None = None) -> Reading:
        """Return what is measured from ``pose``; the caller has left the carrier out: ``scene.without(robot)``.

        Raises:
            InputError: scene and pose have different numbers of environments, or noise lacks a generator.
        """

    def check(self, scene: Scene, pose: Pose) -> None:
        """Raise :class:`InputError` unless ``pose`` has one place for each environment of ``scene``."""
        if pose.position.shape != (scene.shape[0], 2) or pose.heading.shape != (scene.shape[0],):
            raise InputError(
                f"{type(self).__name__}: the pose has {len(pose.position)} places for {scene.shape[0]} environments"
            )
