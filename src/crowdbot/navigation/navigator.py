"""The contract of navigators: ``begin(observation) -> memory``, ``act(observation, memory) -> (action, memory)``."""

from __future__ import annotations

import inspect
from abc import ABC, abstractmethod
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError, Twist

from .action import Action
from .observation import Observation

__all__ = ["Navigator"]


@dataclass(frozen=True)
class Navigator(ABC):
    """Steers a robot: a frozen specification and two pure functions.

    A navigator with memory defines ``begin(observation)``, which returns the memory before the first decision, and
    ``act(observation, memory)``, which returns an :class:`Action` and the next memory. The memory is part of the
    running robot, never of the navigator. A navigator without memory defines only ``act(observation)`` and returns a
    :class:`crowdbot.core.Twist`. :meth:`decide` calls either form.

    >>> @dataclass(frozen=True)
    ... class Shy(Navigator):
    ...     space: float = 1.0
    ...     def act(self, observation):
    ...         return Twist() if observation.nearest < self.space else observation.towards_goal(0.8)
    >>> @dataclass(frozen=True)
    ... class Patient(Navigator):
    ...     wait: float = 3.0
    ...     def begin(self, observation):
    ...         return observation.time
    ...     def act(self, observation, memory):
    ...         go = observation.time - memory >= self.wait
    ...         return Action(observation.towards_goal(0.8) if go else Twist()), memory
    """

    def begin(self, observation: Observation) -> Any:
        """Return the memory before the first decision; None without memory."""
        return None

    @abstractmethod
    def act(self, observation: Observation, *args: Any, **kwargs: Any) -> Any:
        """Return ``(Action, memory)`` if the second argument is the memory, otherwise the twist."""

    def decide(self, observation: Observation, memory: Any, *, robot: str = "") -> tuple[Action, Any]:
        """Return the action until the next decision and the next memory, for either form of :meth:`act`.

        Args:
            observation: what the robot knows now.
            memory: from :meth:`begin` or from the previous call.
            robot: name of the robot, for error messages.

        Raises:
            InputError: :meth:`act` returned something else, or asks for joints.
        """
        name = type(self).__name__ + (f" of robot {robot!r}" if robot else "")
        plain = not _takes_memory(type(self))
        answer: Any = self.act(observation) if plain else self.act(observation, memory)
        if plain and isinstance(answer, Twist):
            answer = (Action(answer), memory)
        if not (isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[0], Action)):
            wanted = "a Twist" if plain else "(Action, memory)"
            raise InputError(f"navigator {name} returned a {type(answer).__name__}, it must return {wanted}")
        action = Action(Twist(*map(float, answer[0].twist)), answer[0].joints)
        if action.joints:
            raise InputError(
                f"navigator {name}: joints = {dict(action.joints)} cannot be commanded yet; leave them empty"
            )
        return action, answer[1]


def _takes_memory(kind: type[Navigator]) -> bool:
    """Return whether ``act`` has a second argument for the memory."""
    own = list(inspect.signature(kind.act).parameters.values())[2:]
    return any(p.kind is not p.KEYWORD_ONLY and p.kind is not p.VAR_KEYWORD for p in own)
