"""Decisions that do not return end their environment as a counted failure, and a replay measures no time."""

from __future__ import annotations

import dataclasses
import os
import threading
import time
import warnings
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError, Twist
from crowdbot.navigation import HungNavigatorError, Navigator, Observation, ORCANavigator, call_within
from crowdbot.navigation.decisions import Decisions
from crowdbot.recording import replay, run
from crowdbot.simulation import HungDecisionOrder, RunFailureWarning, Simulation, simulate, simulate_seeds
from crowdbot.trials import Trial, load_trial

LIMIT = 1.0
HANGS = [True]
"""Whether the navigators of this file hang."""


def stay(way: str) -> None:
    """Do not return for longer than the limit."""
    if way == "sleep":
        time.sleep(4 * LIMIT)
    end = time.monotonic() + 100.0
    while time.monotonic() < end:
        if way == "catch":
            try:
                sum(range(1000))
            except Exception:
                continue


@dataclasses.dataclass(frozen=True)
class Stuck(Navigator):
    """Does not return from some time on."""

    begin_at: float = 0.5
    way: str = "loop"

    def act(self, observation: Observation) -> Twist:
        if HANGS[0] and observation.time >= self.begin_at:
            stay(self.way)
        return Twist(0.2)


@dataclasses.dataclass(frozen=True)
class Quick(Navigator):
    """Returns at once."""

    def act(self, observation: Observation) -> Twist:
        return Twist(0.2)


@dataclasses.dataclass(frozen=True)
class StuckAtBegin(Navigator):
    """Does not return at its first call."""

    def begin(self, observation: Observation) -> Any:
        stay("loop")

    def act(self, observation: Observation, memory: Any) -> Any:
        raise AssertionError("begin has failed")


@dataclasses.dataclass(frozen=True)
class StuckORCA(ORCANavigator):
    """Replaces one method of a navigator of crowdbot."""

    def velocity(self, observation: Observation) -> Any:
        stay("loop")


@dataclasses.dataclass(frozen=True)
class StuckBatch(Navigator):
    """Decides in all environments by itself."""

    def act(self, observation: Observation) -> Twist:
        raise AssertionError("decide_batch replaces it")

    def decide_batch(self, batch: Any, memories: Any, robot: str = "", timer: Any = None) -> Decisions:
        stay("sleep")
        return Decisions.still(memories)


def with_navigator(navigator: Navigator, **values: Any) -> Trial:
    trial = load_trial("frontal", duration=1.0)
    values = {"navigator": navigator, "decision_limit": LIMIT} | values
    return dataclasses.replace(trial, robots=[dataclasses.replace(trial.robots[0], **values)])


@pytest.mark.live
@pytest.mark.parametrize("way", ["loop", "sleep", "catch"])
def test_a_navigator_that_hangs_ends_its_run_as_a_failure(way: str) -> None:
    with pytest.warns(RunFailureWarning, match="navigator Stuck of robot 'robot' did not return within 1 s"):
        episode = simulate(with_navigator(Stuck(way=way)), 1)
    assert episode.outcome == "error"
    assert episode.failure is not None
    assert episode.failure.place.startswith("test_hung_navigators.py:")
    assert ", in stay" in episode.failure.trace
    assert episode.times[-1] == pytest.approx(0.5)


@pytest.mark.live
@pytest.mark.parametrize(
    ("navigator", "name"),
    [(StuckAtBegin(), "StuckAtBegin"), (StuckORCA(), "StuckORCA"), (StuckBatch(), "StuckBatch")],
    ids=["begin", "velocity", "decide_batch"],
)
def test_every_form_of_a_navigator_has_a_limit(navigator: Navigator, name: str) -> None:
    with pytest.warns(RunFailureWarning, match=f"navigator {name} of robot 'robot' did not return"):
        episodes = simulate_seeds(with_navigator(navigator), [1, 2])
    assert [episode.outcome for episode in episodes] == ["error", "error"]


@dataclasses.dataclass(frozen=True)
class StuckNear(Navigator):
    """Does not return where somebody is near at the start."""

    distance: float

    def act(self, observation: Observation) -> Twist:
        if observation.nearest <= self.distance:
            stay("sleep")
        return Twist(0.2)


@pytest.mark.live
def test_the_other_environments_go_on() -> None:
    def trial_with(distance: float) -> Trial:
        trial = load_trial("circle-crossing", duration=0.3)
        robot = dataclasses.replace(trial.robots[0], navigator=StuckNear(distance), decision_limit=LIMIT)
        return dataclasses.replace(trial, robots=[robot])

    free = simulate_seeds(trial_with(0.0), range(4))
    nearest = [min(np.hypot(*(item.position[:, 1:] - item.position[:, :1])[0].T)) for item in free]
    order = np.argsort(nearest)
    between = float(np.mean(np.sort(nearest)[1:3])) - 0.6  # the observation knows the gap between bodies
    with pytest.warns(RunFailureWarning):
        some = simulate_seeds(trial_with(between), range(4))
    hung = {k for k, item in enumerate(some) if item.outcome == "error"}
    assert hung
    assert hung <= set(order[:3].tolist())
    assert [some[k].digest for k in range(4) if k not in hung] == [free[k].digest for k in range(4) if k not in hung]


@pytest.mark.live
def test_a_replay_does_not_wait_for_a_decision_that_hung(tmp_path: Path) -> None:
    with pytest.warns(RunFailureWarning):
        episode = run(with_navigator(Stuck()), seed=1, out=tmp_path)
    ((tick, order),) = [row for row in episode.orders if isinstance(row[1], HungDecisionOrder)]
    assert (order.robot, order.seconds) == ("robot", LIMIT)
    assert order.place.startswith("test_hung_navigators.py:")
    assert tick == episode.steps
    HANGS[0] = False  # the recording says that it hung, and a replay believes it
    try:
        done = replay(tmp_path / "episode.mcap", trust=True)
    finally:
        HANGS[0] = True
    assert done.equal, str(done)
    assert done.outcomes == ("error", "error")
    assert done.failures[0] == done.failures[1]


@pytest.mark.live
def test_a_failed_run_has_the_same_digest_alone_and_among_others() -> None:
    trial = with_navigator(Stuck(way="sleep"))
    with pytest.warns(RunFailureWarning):
        together = simulate_seeds(trial, [1, 2])
    with pytest.warns(RunFailureWarning):
        alone = [simulate(trial, seed) for seed in (1, 2)]
    assert [item.digest for item in together] == [item.digest for item in alone]
    assert [order for _, order in together[1].orders] == [order for _, order in alone[1].orders]


def test_a_decision_within_the_limit_changes_nothing() -> None:
    some, other = (with_navigator(Quick(), decision_limit=limit) for limit in (1e4, 1e5))
    assert simulate(some, 1).digest == simulate(other, 1).digest


def test_nobody_can_give_a_hung_decision() -> None:
    with pytest.raises(InputError, match="a hung-decision order is written by a run and cannot be given to one"):
        HungDecisionOrder(robot="robot", seconds=1.0).check(Simulation(load_trial("frontal"), 1))


@pytest.mark.live
def test_a_run_in_another_thread_ends_too() -> None:
    found: list[str] = []

    def work() -> None:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore", RunFailureWarning)
            found.append(simulate(with_navigator(Stuck()), 1).outcome)

    runner = threading.Thread(target=work)
    runner.start()
    runner.join(100.0)
    assert found == ["error"]


@pytest.mark.live
def test_threads_end_with_their_callers() -> None:
    def threads() -> int:
        return sum(item.name == "crowdbot-decisions" for item in threading.enumerate())

    assert call_within(30.0, lambda: 1, "this") == 1
    before = threads()
    for _ in range(20):
        caller = threading.Thread(target=lambda: call_within(30.0, lambda: 1, "this"))
        caller.start()
        caller.join()
    for _ in range(20):
        with pytest.raises(HungNavigatorError, match=r"this did not return within 0\.01 s"):
            call_within(0.01, lambda: time.sleep(0.05), "this")
    end = time.monotonic() + 30.0
    while threads() > before and time.monotonic() < end:
        time.sleep(0.02)
    assert threads() <= before


def test_errors_and_values_of_the_context_pass() -> None:
    with np.errstate(all="raise"), pytest.raises(FloatingPointError):
        call_within(30.0, lambda: np.ones(1) / np.zeros(1), "this")
    with pytest.raises(KeyboardInterrupt):
        call_within(30.0, _interrupt, "this")
    assert call_within(30.0, lambda: call_within(30.0, lambda: 7, "inner"), "outer") == 7


def _interrupt() -> None:
    raise KeyboardInterrupt


@pytest.mark.live
def test_a_forked_process_has_a_thread_of_its_own() -> None:
    assert call_within(30.0, lambda: 1, "this") == 1
    child = os.fork()
    if child == 0:
        try:
            call_within(0.1, lambda: stay("loop"), "this")
        except HungNavigatorError:
            os._exit(7)
        os._exit(1)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 7
