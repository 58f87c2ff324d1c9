"""Randomized model: a crowd model with parameters that are drawn for each person."""

from __future__ import annotations

import dataclasses
import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from crowdbot.core import InputError, Paper, Scene, did_you_mean, parameters, stream
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats

from .distribution import Distribution

Values = Mapping[int, Mapping[str, float]]


@dataclass(frozen=True)
class RandomizedModel(CrowdModel):
    """A model and the distributions from which some of its parameters are drawn for each person.

    People who enter during a trial get the parameters of their index in the arrays, from the same distributions.

    Fields:
        model: model with the other parameters.
        draws: names of parameters in Python, each with a distribution.

    Raises:
        InputError: the model has no such parameter, or does not allow the whole range of a distribution.

    >>> from crowdbot.models import ORCA
    >>> crowd = RandomizedModel(ORCA(), {"time_horizon": "uniform(1, 3)"})
    >>> crowd.resolve(seed=0, crowd=0, agents=3).time_horizon.round(2).shape
    (3,)
    """

    paper: ClassVar[Paper] = Paper("crowdbot", 2024, "Parameters that differ from person to person", "crowdbot")

    model: CrowdModel
    draws: tuple[tuple[str, Distribution], ...]

    def __post_init__(self) -> None:
        given: Any = self.draws
        rows = given.items() if isinstance(given, Mapping) else given
        object.__setattr__(self, "draws", tuple((str(name), Distribution.of(value)) for name, value in rows))
        for sentence in self.problems(self.model, dict(self.draws)):
            raise InputError(f"{type(self.model).__name__}: {sentence}")

    @staticmethod
    def problems(model: CrowdModel, draws: Mapping[str, Distribution]) -> Iterator[str]:
        """Yield the problems of distributions for parameters of a model, as ends of a sentence."""
        known = [row.name for row in parameters(model)]
        for name, drawn in draws.items():
            word = name.replace("_", "-")
            if name not in known:
                words = [item.replace("_", "-") for item in known]
                choices = f"available parameters: {', '.join(words) or 'none'}"
                yield f"{word} cannot be drawn{did_you_mean(word, words)}; {choices}"
                continue
            for value in drawn.extent:
                try:
                    dataclasses.replace(model, **{name: value})
                except InputError as error:
                    low, high = drawn.extent
                    yield f'{word}="{drawn}" ranges from {low:g} to {high:g}: {error}'
                    break

    @property
    def memory_at_start(self) -> Mapping[str, float]:
        return self.model.memory_at_start

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        return self.resolve(0, 0, scene.shape[1]).velocity(scene, dt, rng)

    def resolve(self, seed: int, crowd: int, agents: int) -> CrowdModel:
        """Return the model with one value per agent, as crowd number ``crowd`` of a trial."""
        drawn = {
            name: dist.draw(stream(seed, "crowd", crowd, name), agents)
            for name, dist in self.draws
        }  # fmt: skip
        return dataclasses.replace(self.model, **drawn)


def is_drawn(text: str) -> bool:
    """Return whether an attribute is a distribution such as ``normal(1, 0.2)``."""
    return re.fullmatch(r"\s*[A-Za-z][A-Za-z-]*\s*\([^()]*\)\s*", text) is not None


def own(model: CrowdModel, seed: int, crowd: int, agents: int, values: Values) -> CrowdModel:
    """Return a model with drawn parameters, its own differences between people, and the given values by agent."""
    whole = model.resolve(seed, crowd, agents) if isinstance(model, RandomizedModel) else model
    whole = whole.individual(agents, stream(seed, "crowd", crowd, "individual"))
    if not values:
        return whole
    changed: dict[str, Floats] = {}
    for agent, row in values.items():
        for name, value in row.items():
            if name not in changed:
                now = np.asarray(getattr(whole, name), dtype=np.float64)
                changed[name] = np.broadcast_to(now, (agents,)).copy()
            changed[name][agent] = value
    return dataclasses.replace(whole, **changed)
