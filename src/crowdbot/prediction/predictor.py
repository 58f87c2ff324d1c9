"""The contract of the room: a predictor says where the people of a window will be."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, kebab_case, stream
from crowdbot.data import Forecast, Windows

__all__ = ["Predictor", "window_streams"]


@dataclass(frozen=True)
class Predictor(ABC):
    """Predicts everyone who is present at the last observed step of a window, robots too.

    What a predictor must hold to:
        It never reads ``past.scored``, nor anything but the observed rows. People may be missing at some observed rows,
        or be seen at the last one only; windows may be padded, or empty. A window alone is predicted exactly as in a
        batch, so what is random is drawn from :func:`window_streams`. A deterministic predictor returns K = 1 however
        many samples are asked for: copies of one future are no samples.
    """

    @property
    def name(self) -> str:
        """Name as on the command line, followed by the parameters that differ from their defaults."""
        return _spoken(self)

    @abstractmethod
    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return where people will be.

        Args:
            past: observed rows of W windows; the last row is now.
            steps: how many rows to look ahead, at least 1.
            samples: how many futures to draw, at least 1.
            rng: source of randomness; None means ``stream(0, "predict")``.

        Raises:
            InputError: there is no observed row, or steps or samples are below 1.
        """

    def follow(
        self,
        past: Windows,
        steps: int,
        samples: int = 1,
        rng: np.random.Generator | None = None,
        memory: Any = None,
    ) -> tuple[Forecast, Any]:
        """Return the forecast, and what helps with the next frame of the same people.

        Args:
            past, steps, samples, rng: as of :meth:`predict`.
            memory: what this returned with the frame before, or None.
        """
        return self.predict(past, steps, samples, rng), memory

    def note(self, past: Windows) -> str:
        """Return what a user should know of forecasts of such windows in one sentence, or nothing."""
        del past
        return ""

    def forecast(self, past: Windows, position: NDArray[np.float64]) -> Forecast:
        """Return positions ``[W, K, T, A, 2]`` [m] as this predictor's forecast, valid for who is present now.

        Robots whose plan is known are where it says.
        """
        if past.plan is not None:
            ahead = np.stack([past.plan_at(step) for step in range(1, position.shape[2] + 1)], axis=1)
            position = np.where(np.isnan(ahead[:, None]), position, ahead[:, None])
        return Forecast.of(position, past.present[:, -1], past.dt, self.name)

    @staticmethod
    def check(past: Windows, steps: int, samples: int = 1) -> None:
        """Raise :class:`InputError` unless there is something observed and something to predict."""
        if past.position.shape[1] < 1:
            raise InputError("a prediction needs at least one observed row")
        if steps < 1 or samples < 1:
            raise InputError(f"a prediction needs at least 1 step and 1 sample, not {steps} and {samples}")


def window_streams(rng: np.random.Generator | None, count: int) -> list[np.random.Generator]:
    """Return one generator for each of ``count`` windows, taking one number of ``rng`` for each.

    Hence windows predicted in two chunks with the same ``rng`` draw what they would have drawn in one.

    >>> whole = [g.random() for g in window_streams(stream(1), 3)]
    >>> rng = stream(1)
    >>> whole == [g.random() for part in (1, 2) for g in window_streams(rng, part)]
    True
    """
    source = stream(0, "predict") if rng is None else rng
    seeds = source.integers(0, 2**63, size=count)
    return [np.random.Generator(np.random.PCG64(int(seed))) for seed in seeds]


def _default(field: dataclasses.Field[object]) -> object:
    if field.default_factory is not dataclasses.MISSING:
        return field.default_factory()
    return field.default


def _same(one: object, other: object) -> bool:
    """Return whether two values are equal, also when dataclasses hold arrays."""
    if type(one) is not type(other):
        return False
    if dataclasses.is_dataclass(one):
        return all(_same(getattr(one, f.name), getattr(other, f.name)) for f in dataclasses.fields(one))
    if isinstance(one, np.ndarray):
        return bool(np.array_equal(one, np.asarray(other)))
    return one == other


def _spoken(value: object) -> str:
    if dataclasses.is_dataclass(value):
        own = [
            f"{field.name}={_spoken(getattr(value, field.name))}"
            for field in dataclasses.fields(value)
            if field.repr and not _same(getattr(value, field.name), _default(field))
        ]
        return kebab_case(type(value).__name__) + (f"({', '.join(own)})" if own else "")
    if isinstance(value, np.ndarray):
        return f"array{list(value.shape)}"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
