"""Predictor, the contract of this package: forecasts of the people in a window."""

from __future__ import annotations

import dataclasses
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, kebab_case, reset_undeclared, stream
from crowdbot.data import Forecast, Windows

if TYPE_CHECKING:
    from crowdbot.calibration import TimeLimit


@dataclass(frozen=True)
class Predictor(ABC):
    """Predicts all agents that are present at the last observed row of a window, including robots.

    Requirements:
        Read observed rows only, and never ``past.scored``. Agents may be missing at some observed rows, or be present
        at the last row only. Windows may be padded or empty. The forecast of a window is independent of the batch:
        draw random numbers from :func:`window_streams`. A deterministic predictor returns K = 1 for any number of
        samples.

    >>> from crowdbot.data import Trajectories
    >>> rows = range(20)
    >>> tracks = Trajectories([7] * 20, rows, [0.5 * row for row in rows], [0.0] * 20, row_rate=2.5)
    >>> class StandStill(Predictor):
    ...     def predict(self, past, steps, samples=1, rng=None):
    ...         last = np.repeat(past.position[:, None, -1:], steps, axis=2)
    ...         return Forecast.of(last, past.present[:, -1], past.dt, self.name)
    >>> past, _ = tracks.windows(observe=8, predict=12)
    >>> StandStill().predict(past, steps=12).position[0, 0, -1].tolist()
    [[3.5, 0.0]]
    """

    history: ClassVar[float] = 0.0
    """Observed seconds that the predictor reads; 0: it reads all rows, whatever their time step."""
    batched: ClassVar[bool] = False
    """Whether windows of several robots and environments may be predicted in one call, with the random stream of each
    from :func:`window_streams`. A subclass does not inherit it."""
    draws: ClassVar[bool] = False
    """Whether several samples can differ; a deterministic predictor returns K = 1 for any number of samples."""
    learned: ClassVar[bool] = False
    """Whether the predictor has weights or shapes that were learned from recordings of people."""

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        reset_undeclared(cls, batched=False)

    @property
    def name(self) -> str:
        """Name on the command line, followed by the parameters that differ from their defaults."""
        return _format_value(self)

    @abstractmethod
    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return the forecast.

        Args:
            past: observed rows of W windows; the last row is now.
            steps: number of predicted rows, at least 1.
            samples: number of futures, at least 1.
            rng: random generator; None means ``stream(0, "predict")``.

        Raises:
            InputError: no observed row, or steps or samples below 1.
        """

    def follow(
        self,
        past: Windows,
        steps: int,
        samples: int = 1,
        rng: np.random.Generator | None = None,
        memory: Any = None,
        limit: TimeLimit | None = None,
    ) -> tuple[Forecast, Any]:
        """Return the forecast and a memory for the next frame of the same people.

        Args:
            past, steps, samples, rng: arguments of :meth:`predict`.
            memory: memory returned for the previous frame, or None.
            limit: time at which a predictor that searches stops; others ignore it.
        """
        del limit
        return self.predict(past, steps, samples, rng), memory

    def note(self, past: Windows) -> str:
        """Return a one-sentence remark on forecasts of such windows, or an empty string."""
        del past
        return ""

    def forecast(self, past: Windows, position: NDArray[np.float64]) -> Forecast:
        """Return positions ``[W, K, T, A, 2]`` [m] as a forecast of the agents present at the last row.

        Robots with a plan follow it.
        """
        if past.plan is not None:
            ahead = np.stack([past.plan_at(step) for step in range(1, position.shape[2] + 1)], axis=1)
            position = np.where(np.isnan(ahead[:, None]), position, ahead[:, None])
        return Forecast.of(position, past.present[:, -1], past.dt, self.name)

    @staticmethod
    def check(past: Windows, steps: int, samples: int = 1) -> None:
        """Raise :class:`InputError` if there is no observed row, or if steps or samples are below 1."""
        if past.position.shape[1] < 1:
            raise InputError("a prediction needs at least one observed row")
        if steps < 1 or samples < 1:
            raise InputError(f"a prediction needs at least 1 step and 1 sample, not {steps} and {samples}")


def window_streams(rng: np.random.Generator | None, count: int) -> list[np.random.Generator]:
    """Return one generator for each of ``count`` windows; each consumes one number of ``rng``.

    The random numbers of a window are therefore independent of the chunks in which windows are predicted.

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


def _format_value(value: object) -> str:
    if dataclasses.is_dataclass(value):
        own = [
            f"{field.name}={_format_value(getattr(value, field.name))}"
            for field in dataclasses.fields(value)
            if field.repr and not _same(getattr(value, field.name), _default(field))
        ]
        return kebab_case(type(value).__name__) + (f"({', '.join(own)})" if own else "")
    if isinstance(value, np.ndarray):
        return f"array{list(value.shape)}"
    return f"{value:.4g}" if isinstance(value, float) else str(value)
