"""Results of a calibration, and predictions with them."""

from __future__ import annotations

import dataclasses
from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, parameters, stream
from crowdbot.data import Forecast, Windows
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .parameter_space import PREFERRED_SPEED, ParameterSpace
from .rollout import Rollout


def futures(
    rollout: Rollout, past: Windows, steps: int, samples: int, rngs: Sequence[np.random.Generator]
) -> tuple[Floats, Floats]:
    """Return up to ``samples`` futures ``[W, K, steps, A, 2]`` [m] and their weights ``[W, K]``.

    With one sample, or if nobody has more than one destination, K is 1 and all people go to their most probable
    destination. Otherwise destinations are drawn by their probabilities, independently for each person (systematic
    resampling). Identical futures are merged: the first one has their total weight, the others have weight 0.
    """
    choices = rollout.goal.choices(past) if samples > 1 else None
    if choices is None or choices.weight.shape[-1] < 2 or not np.any(past.present[:, -1:]):
        return rollout.predict_positions(past, steps)[:, None], np.ones((len(past), 1))
    W, A = past.present.shape[0], past.present.shape[2]
    chosen = np.stack(
        [_draw_destinations(weight, samples, rng) for weight, rng in zip(choices.weight, rngs, strict=True)], axis=1
    )
    weight = np.stack([_merge_weights(chosen[:, w]) for w in range(W)])
    goal = np.take_along_axis(choices.position[None], chosen[..., None, None], axis=3)[:, :, :, 0]
    copied = _repeat(rollout, samples)
    start = _base(rollout, past).environments(np.tile(np.arange(W), samples))
    here = start.active & ~start.external
    start = start.replace(goal=np.where(here[..., None], goal.reshape(samples * W, A, 2), start.goal))
    place = copied.run(start, past, steps).reshape(samples, W, steps, A, 2)
    return np.ascontiguousarray(np.swapaxes(place, 0, 1)), weight


def _base(rollout: Rollout, past: Windows) -> Scene:
    return rollout.scene(past, past.position.shape[1] - 1)


def _draw_destinations(weight: Floats, samples: int, rng: np.random.Generator) -> NDArray[np.int64]:
    """Return one destination for every sample and person ``[K, A]``, from their probabilities ``[A, G]``."""
    total = np.cumsum(weight, axis=1)
    place = (np.arange(samples)[:, None] + rng.random(len(weight))) / samples * np.maximum(total[:, -1], 1e-300)
    index = np.sum(place[..., None] >= total[None], axis=2)
    return np.asarray(rng.permuted(np.minimum(index, weight.shape[1] - 1), axis=0), dtype=np.int64)


def _merge_weights(chosen: NDArray[np.int64]) -> Floats:
    """Return the weight of each future ``[K]``; the first of identical futures has their total weight."""
    _, first, count = np.unique(chosen, axis=0, return_index=True, return_counts=True)
    weight = np.zeros(len(chosen))
    weight[first] = count / len(chosen)
    return weight


def _repeat(rollout: Rollout, copies: int) -> Rollout:
    """Return the rollout of ``copies`` of the windows; values ``[W, A]`` are repeated along E."""

    def repeat(value: object) -> object:
        return np.tile(value, (copies, 1)) if isinstance(value, np.ndarray) and value.ndim == 2 else value

    changed = {row.name: repeat(getattr(rollout.model, row.name)) for row in parameters(rollout.model)}
    return dataclasses.replace(rollout, model=dataclasses.replace(rollout.model, **changed))


@dataclass(frozen=True)
class Fit:
    """Calibrated parameters: one set for each person in W windows, or one shared set.

    Fields:
        scheme: names of model, cost, search and goal.
        space: the D calibrated parameters.
        base: the crowd before the calibration.
        values: calibrated values ``[W, A, D]``, or ``[1, 1, D]`` for a shared fit.
        given: initial values, with the same shape.
        id: ``[W, A]`` identities of the people, -1 for padding.
        counted: ``[W, A]`` mask of people with a cost.
        cost, given_cost: mean cost over people [m] with the calibrated and the initial values: ``[W]``, NaN if nobody
            counts, or ``[1]`` for a shared fit.
        evaluations: ``[W]``, number of whole-crowd evaluations.
        history: ``[W, evaluations]``, lowest cost after each evaluation.
        seconds: duration of the search [s].
        windows: number of windows.
    """

    scheme: str
    space: ParameterSpace
    base: Rollout = field(repr=False)
    values: Floats = field(repr=False)
    given: Floats = field(repr=False)
    id: NDArray[np.int64] = field(repr=False)
    counted: NDArray[np.bool_] = field(repr=False)
    cost: Floats
    given_cost: Floats
    evaluations: NDArray[np.int64]
    history: Floats = field(repr=False)
    seconds: float
    windows: int

    @property
    def shared(self) -> bool:
        """Whether all people have the same parameters."""
        return self.space.shared

    @property
    def persons(self) -> int:
        """Number of people with a cost, summed over windows."""
        return int(self.counted.sum())

    @property
    def model(self) -> CrowdModel:
        """The crowd model with the calibrated parameters: scalars for a shared fit, otherwise ``[W, A]``."""
        return self.rollout.model

    @property
    def rollout(self) -> Rollout:
        """The calibrated crowd for the windows of the calibration."""
        return self.space.apply(self.base, self.values[0, 0] if self.shared else self.values)

    @property
    def shared_rollout(self) -> Rollout:
        """The calibrated crowd for any windows.

        Raises:
            InputError: the parameters are individual.
        """
        if not self.shared:
            raise InputError("this fit has individual parameters; it can predict only windows with the same people")
        return self.rollout

    def table(self) -> dict[str, tuple[float, float]]:
        """Return median and standard deviation of each calibrated parameter over people; 0 for a shared fit."""
        people = self.values[0] if self.shared else self.values[self.counted]
        if len(people) == 0:
            return {}
        return {
            name: (float(np.median(people[:, k])), float(np.std(people[:, k])))
            for k, name in enumerate(self.space.names)
        }

    def values_of(self, past: Windows) -> Floats:
        """Return the parameters ``[W, A, D]`` of the people in windows.

        Calibrated people have the values of their latest window. Other people have the median values and their observed
        preferred speed.
        """
        given = self.space.initial_values(past, self.base)
        if self.shared:
            return np.broadcast_to(self.values, given.shape)
        if np.array_equal(past.id, self.id):
            return self.values
        for column, (name, (median, _)) in enumerate(self.table().items()):
            if name != PREFERRED_SPEED.name:
                given[..., column] = median
        known, place = self._people()
        found = np.searchsorted(known, past.id)
        found = np.minimum(found, max(0, len(known) - 1))
        if len(known):
            same = known[found] == past.id
            given[same] = self.values.reshape(-1, given.shape[-1])[place[found[same]]]
        return given

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        """Return the forecast of the calibrated crowd after the last observed row.

        Args:
            past: windows of the calibration or others, see :meth:`values_of`.
            steps: number of predicted rows.
            samples: number of futures if the goal has several destinations per person; otherwise there is one.
            rng: random generator.

        Raises:
            InputError: steps or samples are below 1.
        """
        if steps < 1 or samples < 1:
            raise InputError(f"a prediction needs at least 1 step and 1 sample, not {steps} and {samples}")
        rng = stream(0, "predict") if rng is None else rng
        return self.forecast(past, steps, samples, rng.spawn(len(past)), f"calibrated {self.scheme}")

    def forecast(
        self, past: Windows, steps: int, samples: int, rngs: Sequence[np.random.Generator], name: str
    ) -> Forecast:
        """Return the forecast with a predictor name; ``rngs`` has one generator for each window."""
        rollout = self.space.apply(self.base, self.values[0, 0] if self.shared else self.values_of(past))
        place, weight = futures(rollout, past, steps, samples, rngs)
        made = Forecast.of(place, past.present[:, -1], past.dt, name)
        return Forecast(made.position, weight, made.valid, past.dt, name)

    def __str__(self) -> str:
        """Return one paragraph: scheme, costs, parameters."""
        values = ", ".join(
            f"{name} {median:.3g}" + ("" if self.shared else f" (sd {spread:.2g})")
            for name, (median, spread) in self.table().items()
        )
        who = "one set for everyone" if self.shared else "each person's own"
        return (
            f"{self.scheme}: cost {np.nanmean(self.cost):.4f} m, {np.nanmean(self.given_cost):.4f} m before"
            f" ({self.persons} persons in {self.windows} windows, {int(self.evaluations.sum())} evaluations,"
            f" {self.seconds:.1f} s); {who}: {values}"
        )

    def _people(self) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
        """Return the sorted ids of calibrated people, and the indices of their latest values among ``W * A``."""
        place = np.flatnonzero(self.counted.ravel())[::-1]
        known, first = np.unique(self.id.ravel()[place], return_index=True)
        return known, place[first]
