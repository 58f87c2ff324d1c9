"""Decisions that do not return end their environment as a counted failure."""

from __future__ import annotations

import dataclasses
import os
import threading
import time
from typing import Any

import pytest

from crowdbot.core import Twist
from crowdbot.navigation import HangWatch, HungNavigatorError, Navigator, Observation
from crowdbot.navigation import hang_watch as module
from crowdbot.simulation import RunFailureWarning, simulate, simulate_seeds
from crowdbot.trials import Trial, load_trial


@dataclasses.dataclass(frozen=True)
class Stuck(Navigator):
    """Never returns from some time on."""

    begin_at: float = 0.5
    catches: bool = False

    def act(self, observation: Observation) -> Twist:
        while observation.time >= self.begin_at:
            try:
                sum(range(100))
            except HungNavigatorError:
                if not self.catches:
                    raise
                return Twist(0.1)
        return Twist(0.2)


@pytest.fixture
def short(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "LONGEST", 0.2)


def stuck(**values: Any) -> Trial:
    trial = load_trial("frontal", duration=2.0)
    return dataclasses.replace(trial, robots=[dataclasses.replace(trial.robots[0], navigator=Stuck(**values))])


@pytest.mark.usefixtures("short")
@pytest.mark.parametrize("catches", [False, True])
def test_a_navigator_that_hangs_ends_its_run_as_a_failure(catches: bool) -> None:
    with pytest.warns(RunFailureWarning, match="navigator Stuck of robot 'robot' did not return within 0.2 s"):
        episode = simulate(stuck(catches=catches), 1)
    assert episode.outcome == "error"
    assert episode.failure is not None
    assert episode.times[-1] <= 0.5 + 1e-9


@pytest.mark.usefixtures("short")
def test_environments_that_hang_do_not_end_the_others() -> None:
    with pytest.warns(RunFailureWarning):
        episodes = simulate_seeds(stuck(begin_at=0.3), [1, 2])
    assert [one.outcome for one in episodes] == ["error", "error"]


@pytest.mark.usefixtures("short")
def test_a_run_in_another_thread_is_interrupted_too() -> None:
    found: list[str] = []

    def work() -> None:
        with pytest.warns(RunFailureWarning):
            found.append(simulate(stuck(), 1).outcome)

    runner = threading.Thread(target=work)
    runner.start()
    runner.join(60.0)
    assert found == ["error"]


def test_code_that_returns_is_left_alone() -> None:
    for _ in range(50):
        with HangWatch("this", limit=30.0):
            value = sum(range(1000))
    assert value == 499500
    with pytest.raises(KeyError), HangWatch("this", limit=30.0):
        raise KeyError("other")


def test_code_that_returns_late_is_told() -> None:
    with pytest.raises(HungNavigatorError, match="this did not return within 0.05 s"), HangWatch("this", limit=0.05):
        time.sleep(0.3)


def test_a_forked_process_watches_with_a_thread_of_its_own() -> None:
    with HangWatch("this", limit=30.0):
        pass
    child = os.fork()
    if child == 0:
        try:
            with HangWatch("this", limit=0.1):
                while True:
                    pass
        except HungNavigatorError:
            os._exit(7)
        os._exit(1)
    _, status = os.waitpid(child, 0)
    assert os.waitstatus_to_exitcode(status) == 7
