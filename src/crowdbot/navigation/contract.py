"""Contract check for custom navigators."""

from __future__ import annotations

import numpy as np

from crowdbot.core import InputError, Walls

from .action import Action
from .navigator import Navigator, copy_memory
from .observation import DriveLimits, Observation, VisiblePeople


def check_navigator(navigator: Navigator) -> None:
    """Check that a navigator keeps its contract in a small scene with and without people.

    Raises:
        InputError: the first violated rule.

    >>> from crowdbot.navigation import Straight
    >>> check_navigator(Straight())
    """
    name = type(navigator).__name__
    if not isinstance(navigator, Navigator):
        raise InputError(f"{name} is not a Navigator")
    parameters = getattr(navigator, "__dataclass_params__", None)
    if parameters is None or not parameters.frozen:
        raise InputError(f"{name} is not frozen; decorate the class with @dataclass(frozen=True)")
    for count in (0, 1, 3):
        observations = [_observation(count, k) for k in range(20)]
        actions = _decisions(navigator, observations)
        if _decisions(navigator, observations) != actions:
            raise InputError(f"{name} is not deterministic: the same observations gave other actions")
        for k, observation in enumerate(observations):
            if not np.array_equal(observation.people.position, _observation(count, k).people.position):
                raise InputError(f"{name}.act changes the observation; it must only read it")


def _decisions(navigator: Navigator, observations: list[Observation]) -> list[Action]:
    memory, actions = navigator.first_memory(observations[0]), []
    for observation in observations:
        action, memory = navigator.decide(observation, memory)
        actions.append(action)
    copy_memory(memory, type(navigator).__name__)
    return actions


def _observation(people: int, k: int) -> Observation:
    """Return decision ``k`` of a robot that drives past ``people`` people to its goal."""
    position = np.array([[2.0, 0.1], [3.0, -1.5], [1.0, 2.0]])[:people] - [0.05 * k, 0.0]
    return Observation(
        pose=(0.2 * k, 0.0, 0.02 * k),
        goal=(4.0, 0.0),
        radius=0.3,
        limits=DriveLimits(1.0, 1.5, 1.0, 3.0),
        dt=0.1,
        people=VisiblePeople(position, np.tile([-0.5, 0.0], (people, 1)), np.full(people, 0.25)),
        walls=Walls.of([[(-1.0, -3.0), (6.0, -3.0)]]),
        time=0.1 * k,
    )
