"""EnginePeer: another engine with one of our models."""

from __future__ import annotations

from abc import ABC, abstractmethod
from collections.abc import Callable
from typing import Any, ClassVar

from crowdbot.core import Scene


class EnginePeer(ABC):
    """Another engine, with the settings that make it comparable with one of our models.

    Attributes:
        name: name of the engine.
        packages: packages whose versions the report tells.
        people: numbers of people to measure.
        dt: time step of both [s].
        protocol: what both compute, and how they differ.
    """

    name: ClassVar[str]
    packages: tuple[str, ...] = ()
    people: ClassVar[tuple[int, ...]]
    dt: ClassVar[float]
    protocol: ClassVar[str]

    @property
    @abstractmethod
    def model(self) -> Any:
        """Our model with the settings of the engine."""

    @abstractmethod
    def step(self, scene: Scene, threads: int = 1) -> Callable[[], object]:
        """Return a function that makes one step of the engine from the people of environment 0.

        Args:
            scene: people without walls.
            threads: number of threads, one of :meth:`threads`.

        Raises:
            MissingExtra: the engine is not installed.
        """

    def threads(self) -> tuple[int, ...]:
        """Return the numbers of threads that the engine can use."""
        return (1,)

    def describe(self) -> str:
        """Return which build of the engine runs."""
        return self.name
