"""DecisionTimer: deadline and limit of the decisions of a robot, measured, or as recorded."""

from __future__ import annotations

import functools
import math
import time
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Storage, tree
from crowdbot.navigation import (
    Decisions,
    HungNavigatorError,
    Navigator,
    ObservationBatch,
    ProcessNavigator,
    call_within,
    copy_memory,
)
from crowdbot.trials import RobotSpec
from crowdbot.typing import Bools, Ints

from .failure import RunFailure
from .orders.decision_orders import DecisionOrder, HungDecisionOrder, MissedDecisionOrder, RecordedDecisions

NEVER = -1
"""Tick of the latest decision of a kind before there is one."""


@dataclass
class DecisionTimer:
    """Real time of the decisions of one robot in E environments.

    A decision that takes longer than the deadline is missed, one that takes longer than the limit of the robot fails.
    A navigator that declares that it always returns has no limit. A replay measures nothing.

    Fields:
        missed: ``[E]`` tick of the latest decision that took longer than the deadline, -1 for none.
        hung: ``[E]`` tick of the decision that did not return, -1 for none.
        recorded: ``[E]`` recorded decisions of each environment that is replayed, otherwise None.
        clock: clock of the compute times [s], used only with a deadline or for a process.
        spent: ``[E]`` compute times [s] of the measured decisions of each environment.
    """

    missed: Ints
    hung: Ints
    recorded: NDArray[Any]
    clock: Callable[[], float] = time.perf_counter
    spent: NDArray[Any] = field(default_factory=lambda: tree.objects([]))
    _warm: bool = field(default=False, init=False)
    storage = Storage(constants=("recorded", "clock", "spent", "_warm"), environments=("recorded", "spent"))

    @classmethod
    def of(cls, count: int) -> DecisionTimer:
        """Return the state before the first decision."""
        missed, hung = (np.full(count, NEVER, dtype=np.int64) for _ in range(2))
        return cls(missed, hung, tree.objects([None] * count), spent=tree.objects([()] * count))

    def first_memories(
        self, robot: RobotSpec, batch: ObservationBatch, environments: Ints
    ) -> tuple[list[Any], dict[int, Exception]]:
        """Return the memories of the navigator before the first decision, and what failed."""
        return robot.controller.first_memories(batch, robot=robot.name, limit=self._limit(robot, environments))

    def decide(self, robot: RobotSpec, batch: ObservationBatch, memories: list[Any], environments: Ints) -> Decisions:
        """Let the navigator decide, with compute times if they matter."""
        navigator, name = robot.controller, robot.name
        decide = functools.partial(_decide, navigator, batch, name, self._limit(robot, environments))
        if self._is_replay(environments):
            return decide(memories, None)
        if (
            robot.deadline is None
        ):  # the times of a process are only told; it starts at the first one, which is left out
            timed, self._warm = self._warm and isinstance(navigator, ProcessNavigator), True
            return decide(memories, self.clock if timed else None)
        if not self._warm:  # code is compiled and loaded at the first call, which says nothing about the others
            decide([copy_memory(memory, name) for memory in memories], None)
            self._warm = True
        return decide(memories, self.clock)

    def judge(self, robot: RobotSpec, environments: Ints, ticks: Ints, decisions: Decisions) -> Bools:
        """Return ``[N]`` which decisions missed the deadline, and keep these and the ones that did not return."""
        late = np.zeros(len(environments), dtype=np.bool_)
        for k, e in enumerate(environments.tolist() if robot.deadline is not None else ()):
            recorded = self.recorded[e]
            if recorded is not None:
                late[k] = int(ticks[k]) in recorded.missed
            else:
                late[k] = decisions.seconds[k] > (robot.deadline or math.inf)
        if decisions.failures:
            late[list(decisions.failures)] = False
        for k in decisions.seconds.nonzero()[0].tolist():
            if decisions.seconds[k] > 0.0 and k not in decisions.failures:
                self.spent[environments[k]] += (float(decisions.seconds[k]),)
        if robot.deadline is not None:
            self.missed[environments[late]] = ticks[late]
        for k, error in decisions.failures.items():
            if isinstance(error, HungNavigatorError):
                self.hung[environments[k]] = ticks[k]
        return late

    def repeat_misses(self, environments: Ints, ticks: Ints) -> None:
        """Keep the recorded misses of a robot whose commands come from outside, at ticks ``[N]``."""
        for e, tick in zip(environments.tolist(), ticks.tolist(), strict=True):
            recorded = self.recorded[e]
            if recorded is not None and tick in recorded.missed:
                self.missed[e] = tick

    def recorded_hangs(self, robot: RobotSpec, environments: Ints, ticks: Ints) -> dict[int, Exception]:
        """Return the errors of the replayed environments whose decision at their tick ``[N]`` did not return."""
        result: dict[int, Exception] = {}
        if not any(self.recorded):
            return result
        for e, tick in zip(environments.tolist(), ticks.tolist(), strict=True):
            recorded = self.recorded[e]
            order = None if recorded is None else recorded.hung.get(tick)
            if order is not None:
                result[e] = HungNavigatorError(robot.navigator.title(robot.name), order.seconds, order.place)
                self.hung[e] = tick
        return result

    def orders(
        self, robot: RobotSpec, ticks: Ints, failures: Sequence[RunFailure | None]
    ) -> list[tuple[int, DecisionOrder]]:
        """Return environments and what their recordings must keep about the decisions at the current ticks ``[E]``.

        A recording has one environment, so the orders do not name theirs.

        Args:
            robot: the robot.
            ticks: ``[E]`` current ticks.
            failures: failure of each environment.
        """
        result: list[tuple[int, DecisionOrder]] = [
            (e, MissedDecisionOrder(robot=robot.name)) for e in np.flatnonzero(self.missed == ticks).tolist()
        ]
        for e in np.flatnonzero(self.hung == ticks).tolist():
            failure, recorded = failures[e], self.recorded[e]
            known = None if recorded is None else recorded.hung.get(int(ticks[e]))
            seconds = robot.decision_limit if known is None else known.seconds
            place = "" if failure is None else failure.place
            result.append((e, HungDecisionOrder(robot=robot.name, seconds=seconds, place=place)))
        return result

    def replay(self, environment: int, recorded: RecordedDecisions | None) -> None:
        """Let the decisions of an environment be missed and hang as recorded; None: measure again."""
        self.recorded[environment] = recorded

    def _is_replay(self, environments: Ints) -> bool:
        return all(self.recorded[e] is not None for e in environments)

    def _limit(self, robot: RobotSpec, environments: Ints) -> float | None:
        """Return the limit of real time [s]; None for a navigator that always returns and in a replay."""
        if robot.navigator.always_returns and robot.predictor is None:
            return None
        return None if self._is_replay(environments) else robot.decision_limit


def decision_times(controls: Iterable[Any], environment: int = 0) -> dict[str, tuple[float, ...]]:
    """Return the compute times [s] of the measured decisions of an environment by robot; others have no entry.

    Args:
        controls: the robots, each with its ``timer``.
        environment: index of the environment.
    """
    found = {control.robot.name: tuple(control.timer.spent[environment]) for control in controls}
    return {name: times for name, times in found.items() if times}


@functools.cache
def _keeps_limit(kind: type[Navigator]) -> bool:
    """Return whether the ``decide_batch`` of a navigator keeps the limit itself, or always returns."""
    owner = next(base for base in kind.__mro__ if "decide_batch" in vars(base))
    return owner is Navigator or (issubclass(owner, Navigator) and owner.always_returns)


def _decide(
    navigator: Navigator,
    batch: ObservationBatch,
    name: str,
    limit: float | None,
    memories: Sequence[Any],
    clock: Callable[[], float] | None,
) -> Decisions:
    """Return the decisions of a navigator; one with a ``decide_batch`` of its own has the limit for all of them."""
    if _keeps_limit(type(navigator)):
        return navigator.decide_batch(batch, memories, name, clock, limit)
    try:
        decide = functools.partial(navigator.decide_batch, batch, memories, name, clock)
        return call_within(limit, decide, navigator.title(name))
    except HungNavigatorError as error:
        decisions = Decisions.still(memories)
        decisions.failures.update(dict.fromkeys(range(len(batch)), error))
        return decisions
