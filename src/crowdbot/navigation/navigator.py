"""The contract of navigators: ``begin(observation) -> memory``, ``act(observation, memory) -> (action, memory)``."""

from __future__ import annotations

import copy
import functools
import inspect
import math
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar

import numpy as np

from crowdbot.core import InputError, Twist, reset_undeclared
from crowdbot.typing import Bools, Floats

from .action import Action
from .batch_rows import share_time
from .decision_thread import call_within
from .decisions import Decisions, checked_joints
from .observation import Observation
from .observation_batch import ObservationBatch

BatchKernels = Callable[[ObservationBatch, Floats], Bools]
"""Writes the twists ``[N, 3]`` of the environments that it decides, and returns which they are."""


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

    needs_scan: ClassVar[bool] = False
    """Whether the navigator knows its surroundings from scans only; a robot without a planar scanner is refused."""
    always_returns: ClassVar[bool] = False
    """Whether every decision returns soon, so that no limit of real time watches it. A subclass does not inherit it."""

    file_parameters: ClassVar[tuple[str, ...]] = ()
    """Parameters that name files: in a trial, paths start from its folder, and a recording keeps the files."""

    def __init_subclass__(cls, **kwargs: Any) -> None:
        super().__init_subclass__(**kwargs)
        reset_undeclared(cls, always_returns=False)

    def begin(self, observation: Observation) -> Any:
        """Return the memory before the first decision; None without memory."""
        return None

    def check_files(self) -> None:
        """Read the files of :attr:`file_parameters`, so that a wrong one is told before a run; here, they must exist.

        Raises:
            InputError: a file is missing, or is not what the navigator needs.
        """
        for name in self.file_parameters:
            file = getattr(self, name)
            if file and not Path(file).is_file():
                raise InputError(f"{self._name('')} {name}: there is no file {file}")

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
            InputError: :meth:`act` returned something else or a value that is not finite.
        """
        name = self._name(robot)
        plain = not _takes_memory(type(self))
        answer: Any = self.act(observation) if plain else self.act(observation, memory)
        if plain and isinstance(answer, Twist):
            answer = (Action(answer), memory)
        if not (isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[0], Action)):
            wanted = "a Twist" if plain else "(Action, memory)"
            raise InputError(f"navigator {name} returned a {type(answer).__name__}, it must return {wanted}")
        action = Action(Twist(*map(float, answer[0].twist)), checked_joints(answer[0].joints, name))
        if not all(math.isfinite(value) for value in action.twist):
            raise InputError(
                f"navigator {name} returned {action.twist} at {observation.time:g} s; its values must be finite"
            )
        return action, answer[1]

    def first_memory(self, observation: Observation, *, robot: str = "") -> Any:
        """Return the memory before the first decision, from :meth:`begin`.

        Raises:
            InputError: the memory cannot be copied.
        """
        memory = self.begin(observation)
        copy_memory(memory, self._name(robot))
        return memory

    def first_memories(
        self, batch: ObservationBatch, *, robot: str = "", limit: float | None = None
    ) -> tuple[list[Any], dict[int, Exception]]:
        """Return the memories before the first decision in each environment, and what failed there.

        The arguments are those of :meth:`decide_batch`.
        """
        memories: list[Any] = [None] * len(batch)
        failures: dict[int, Exception] = {}
        if type(self).begin is not Navigator.begin:
            for k in range(len(batch)):
                try:
                    first = functools.partial(self.first_memory, batch.environment(k), robot=robot)
                    memories[k] = call_within(limit, first, self.title(robot))
                except Exception as error:  # the other environments go on
                    failures[k] = error
        return memories, failures

    def decide_batch(
        self,
        batch: ObservationBatch,
        memories: Sequence[Any],
        robot: str = "",
        timer: Callable[[], float] | None = None,
        limit: float | None = None,
    ) -> Decisions:
        """Return the decisions in N environments, the same as :meth:`decide` for each.

        The default calls :meth:`decide` for each environment that the kernels of the navigator do not decide. An
        exception is stored as the failure of its environment; the other environments are not affected.

        Args:
            batch: what the robot knows in each environment.
            memories: N memories from :meth:`first_memories` or from the previous decisions.
            robot: name of the robot, for error messages.
            timer: clock such as ``time.perf_counter``, which measures the compute time of each decision; a navigator
                reads no clock otherwise.
            limit: real time [s] after which a decision that has not returned is a failure, by :func:`call_within`;
                None: no limit.
        """
        decisions, rows = Decisions.still(memories), list(range(len(batch)))
        if kernels := self._kernels():
            begin = timer() if timer else 0.0
            try:
                decided = kernels(batch, decisions.twist)
            except Exception as error:  # such as weights that have gone; the world goes on
                decisions.failures.update(dict.fromkeys(rows, error))
                return decisions
            share_time(decisions, decided, begin, timer)
            rows = np.flatnonzero(~decided).tolist()
        self._decide_rows(rows, batch, decisions, robot, timer, limit)
        return decisions

    def _kernels(self) -> BatchKernels | None:
        """Return the kernels that decide in many environments at once, with the bits of :meth:`act`."""
        return None

    def _decide_rows(
        self,
        rows: Iterable[int],
        batch: ObservationBatch,
        decisions: Decisions,
        robot: str,
        timer: Callable[[], float] | None,
        limit: float | None = None,
    ) -> None:
        """Decide in some environments, one by one."""
        for k in rows:
            begin = timer() if timer else 0.0
            try:
                next_one = functools.partial(self.decide, batch.environment(k), decisions.memories[k], robot=robot)
                action, memory = call_within(limit, next_one, self.title(robot))
                decisions.twist[k], decisions.memories[k] = action.twist, memory
                decisions.joints[k] = action.joints
            except Exception as error:  # the other environments go on
                decisions.failures[k] = error
            decisions.seconds[k] = timer() - begin if timer else 0.0

    def title(self, robot: str = "") -> str:
        """Return how messages name the navigator: ``navigator Straight of robot 'pepper'``."""
        return f"navigator {self._name(robot)}"

    def _name(self, robot: str) -> str:
        return type(self).__name__ + (f" of robot {robot!r}" if robot else "")

    def _keeps(self, kind: type, *names: str) -> bool:
        """Return whether no subclass of ``kind`` overrides these methods, which its batch form replaces."""
        return _has_own(type(self), kind, ("decide", *names))


@functools.cache
def _has_own(kind: type[Navigator], base: type, names: tuple[str, ...]) -> bool:
    """Return whether a class has the methods of a base."""
    return all(getattr(kind, name) is getattr(base, name) for name in names)


@functools.cache
def _takes_memory(kind: type[Navigator]) -> bool:
    """Return whether ``act`` has a second argument for the memory."""
    own = list(inspect.signature(kind.act).parameters.values())[2:]
    return any(p.kind is not p.KEYWORD_ONLY and p.kind is not p.VAR_KEYWORD for p in own)


DEEPEST = 20
"""Largest depth at which the part that cannot be copied is searched."""


def copy_memory(memory: Any, navigator: str = "") -> Any:
    """Return a deep copy of the memory of a navigator.

    Args:
        memory: the memory.
        navigator: name of the navigator, for error messages.

    Raises:
        InputError: a part of the memory cannot be copied, such as an open file, a lock or a generator.

    >>> copy_memory({"seen": [1, 2]})
    {'seen': [1, 2]}
    >>> copy_memory({"rows": iter(row for row in "ab")}, "Reader")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: navigator Reader: memory['rows'] is a generator, which cannot be copied (cannot \
pickle 'generator' object); store plain values
    """
    try:
        return copy.deepcopy(memory)
    except Exception as error:
        path, part, reason = _culprit(memory, "memory", error, 0)
        name = f"navigator {navigator}: " if navigator else ""
        raise InputError(
            f"{name}{path} is a {type(part).__name__}, which cannot be copied ({reason}); store plain values"
        ) from error


def _culprit(value: Any, path: str, error: Exception, depth: int) -> tuple[str, Any, Exception]:
    """Return path, value and error of the smallest part that cannot be copied."""
    for part_path, part in _parts(value, path) if depth < DEEPEST else ():
        try:
            copy.deepcopy(part)
        except Exception as reason:
            return _culprit(part, part_path, reason, depth + 1)
    return path, value, error


def _parts(value: Any, path: str) -> Iterator[tuple[str, Any]]:
    """Yield path and value of each part of a container or object."""
    if isinstance(value, Mapping):
        yield from ((f"{path}[{key!r}]", part) for key, part in value.items())
    elif isinstance(value, list | tuple):
        yield from ((f"{path}[{k}]", part) for k, part in enumerate(value))
    else:
        yield from ((f"{path}.{name}", part) for name, part in getattr(value, "__dict__", {}).items())
