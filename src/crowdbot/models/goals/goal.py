"""Goal: contract of methods that estimate the destinations of people."""

from __future__ import annotations

import abc
from dataclasses import dataclass
from typing import Any, ClassVar, Self

import numpy as np

from crowdbot.core import InputError, kebab_case
from crowdbot.data import PlaceLayout, Trajectories, Windows, steady_velocity
from crowdbot.typing import Floats


@dataclass(frozen=True)
class Choices:
    """Possible destinations: G slots for each person, in an order defined by the goal.

    Fields:
        position: destinations ``[W, A, G, 2]`` [m].
        weight: probabilities ``[W, A, G]``, which sum to 1 for people present at the last observed row, otherwise 0.
            Unused slots have weight 0.

    Raises:
        InputError: the shapes do not match.
    """

    position: Floats
    weight: Floats

    def __post_init__(self) -> None:
        if self.position.ndim != 4 or self.position.shape != (*self.weight.shape, 2):
            raise InputError(
                f"choices: position has shape {list(self.position.shape)} and weight {list(self.weight.shape)};"
                " they must be [W, A, G, 2] and [W, A, G]"
            )

    def likeliest(self, count: int) -> Choices:
        """Return the ``count`` slots with the largest weights, scaled to sum to 1; padded if there are fewer.

        >>> import numpy as np
        >>> choices = Choices(np.arange(6.0).reshape(1, 1, 3, 2), np.array([[[0.25, 0.5, 0.25]]]))
        >>> choices.likeliest(2).position[0, 0].tolist(), choices.likeliest(2).weight[0, 0].round(2).tolist()
        ([[2.0, 3.0], [0.0, 1.0]], [0.67, 0.33])
        """
        order = np.argsort(-self.weight, axis=-1, kind="stable")[..., :count]
        weight = np.take_along_axis(self.weight, order, axis=-1)
        place = np.take_along_axis(self.position, order[..., None], axis=-2)
        missing = count - weight.shape[-1]
        if missing > 0:
            weight = np.concatenate([weight, np.zeros((*weight.shape[:2], missing))], axis=-1)
            place = np.concatenate([place, np.repeat(place[:, :, :1], missing, axis=2)], axis=2)
        total = np.sum(weight, axis=-1, keepdims=True)
        return Choices(place, weight / np.where(total > 0.0, total, 1.0))


@dataclass(frozen=True)
class Goal(abc.ABC):
    """Contract: estimate the goals of people from observed windows.

    A new estimator is a class with :meth:`resolve`. It may use only ``past``: for each person, the past of all people
    in the same window. Absent people get 0.
    """

    knows_future: ClassVar[bool] = False
    """Whether the goal uses the future (for evaluation only)."""
    learns: ClassVar[bool] = False
    """Whether the goal is specific to a place: created with :meth:`learn` or with values, not by name."""

    @property
    def history(self) -> float:
        """Observed time that the goal reads [s]; 0: all rows, whatever their time step."""
        return 0.0

    @abc.abstractmethod
    def resolve(self, past: Windows) -> Floats:
        """Return the most probable goal of each person ``[W, A, 2]`` [m]; 0 for people absent at the last row."""

    def choices(self, past: Windows) -> Choices:
        """Return possible destinations and their probabilities; by default the goal of :meth:`resolve`."""
        here = past.present[:, -1]
        return Choices(self.resolve(past)[:, :, None], here[:, :, None].astype(np.float64))

    def velocity(self, past: Windows) -> Floats:
        """Return the velocity ``[W, A, 2]`` [m/s] on which the goals are based; 0 for absent people.

        Its length is an estimate of the future speed.
        """
        return steady_velocity(past)

    @classmethod
    def learn(cls, *recordings: Trajectories, **values: Any) -> Self:
        """Return the goal learned from recordings of one place; ``values`` are fields.

        Raises:
            InputError: the estimator does not learn, or the recordings do not match.
            DataError: a recording is too short to learn from.
        """
        name = kebab_case(cls.__name__)
        raise InputError(f"{name} does not learn from recordings; use {cls.__name__}(...)")

    @classmethod
    def at(cls, layout: PlaceLayout) -> Self:
        """Return the goal for a place that is known by its walls and exits only.

        Raises:
            InputError: the estimator needs recordings of the place.
        """
        name = kebab_case(cls.__name__)
        raise InputError(f"{name} learns from recorded tracks of {layout.name}; reserve a part of them, as --learn 0.5")
