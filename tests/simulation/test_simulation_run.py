"""A run can be held, copied, taken back and sought, and its result stays the same."""

from __future__ import annotations

import threading
import time
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import ExternalClock, InputError, PacedClock
from crowdbot.recording import open_run
from crowdbot.simulation import EpisodeLog, Order, RemoveOrder, Simulation, SimulationRun, VelocityOrder
from crowdbot.trials import Trial, parse_trial
from space_trials import LEAN, room
from trial_texts import FLOW

TRIALS = {
    "flow": parse_trial(FLOW),
    "planar": parse_trial(room("planar", LEAN)),
    "physics": parse_trial(room("physics", LEAN)),
}


def digest(simulation: Simulation) -> str:
    """Return the digest of the state of all environments."""
    log = EpisodeLog(TRIALS["flow"], 0)
    for e in range(simulation.count):
        log.digest.take(simulation.record(e))
    return log.digest.hexdigest("")


def path(trial: Trial, seeds: Any, steps: int) -> list[str]:
    """Return the digests of the first instants of a run."""
    run = SimulationRun(Simulation(trial, seeds))
    result = [digest(run.simulation)]
    for _ in range(steps):
        run.step()
        result.append(digest(run.simulation))
    return result


@pytest.mark.parametrize(("name", "count"), [("flow", 1), ("flow", 3), ("planar", 2), ("physics", 1), ("physics", 2)])
@given(jumps=st.lists(st.tuples(st.integers(0, 19), st.integers(0, 6)), min_size=2, max_size=6))
@settings(max_examples=3, deadline=None)
def test_snapshots_are_restored_at_any_tick(name: str, count: int, jumps: list[tuple[int, int]]) -> None:
    trial, seeds = TRIALS[name], list(range(3, 3 + count))
    expected = path(trial, seeds, 22)
    run = SimulationRun(Simulation(trial, seeds))
    kept = [run.snapshot()]
    for _ in range(16):
        run.step()
        kept.append(run.snapshot())
    for tick, steps in jumps:
        back = min(tick, 16)
        run.restore(kept[back])
        for k in range(steps):
            assert digest(run.simulation) == expected[back + k]
            run.step()


@pytest.mark.parametrize("name", ["flow", "physics"])
def test_seeking_back_and_forth_is_the_same_as_running(name: str) -> None:
    trial = TRIALS[name]
    robot = trial.robots[0].name
    orders: dict[int, list[Order]] = {3: [VelocityOrder(robot=robot, turn=0.6)], 9: [RemoveOrder(person=0)]}

    def begin() -> SimulationRun:
        run = SimulationRun(Simulation(trial, 3), keyframes=True)
        for k in range(20):
            run.step(orders.get(k, ()))
        return run

    run, step = begin(), trial.step
    last = digest(run.simulation)
    for tick in (4, 12, 1, 20):
        run.seek(tick * step + 1e-9)
        assert run.simulation.tick == tick
    again = begin()
    again.seek(8 * step)
    for k in range(8, 20):
        again.step(orders.get(k, ()))
    assert digest(again.simulation) == last


def test_going_back_needs_keyframes_and_no_recorder(tmp_path: Path) -> None:
    run = SimulationRun(Simulation(TRIALS["flow"], 3))
    run.advance(4)
    with pytest.raises(InputError, match=r"the run is at 0.2 s; to go back it needs keyframes"):
        run.seek(0.1)
    with open_run(TRIALS["flow"], 3, out=tmp_path) as recorded:
        recorded.step()
        with pytest.raises(InputError, match="a run that is recorded cannot go back; branch its episode instead"):
            recorded.restore(recorded.snapshot())


def test_a_pause_changes_nothing_and_lasts() -> None:
    run = SimulationRun(Simulation(TRIALS["flow"], 3))
    run.advance(2)
    run.hold()
    thread = threading.Thread(target=run.advance, args=(10,), daemon=True)
    thread.start()
    time.sleep(0.05)
    assert run.simulation.tick == 2
    run.go()
    thread.join(20.0)
    assert run.simulation.tick == 12
    assert digest(run.simulation) == path(TRIALS["flow"], 3, 12)[-1]


def test_a_pause_of_a_paced_run_is_not_caught_up() -> None:
    now = [0.0]

    def sleep(seconds: float) -> None:
        now[0] += seconds

    clock = PacedClock(0.05, monotonic=lambda: now[0], sleep=sleep)
    run = SimulationRun(Simulation(TRIALS["flow"], 3, clock))
    run.advance(10)
    run.hold()
    now[0] += 100.0
    run.go()
    begin = now[0]
    run.advance(20)
    assert now[0] - begin == pytest.approx(1.0, abs=0.06)
    run.speed = 2.0
    run.advance(20)
    assert now[0] - begin == pytest.approx(1.5, abs=0.1)
    assert digest(run.simulation) == path(TRIALS["flow"], 3, 50)[-1]


def test_only_a_paced_clock_has_a_speed() -> None:
    run = SimulationRun(Simulation(TRIALS["flow"], 3, ExternalClock(0.05)))
    with pytest.raises(InputError, match="a ExternalClock has no speed; run with a PacedClock"):
        run.speed = 2.0


def test_orders_for_an_environment_that_has_ended_are_refused() -> None:
    trial = TRIALS["flow"]
    run = SimulationRun(Simulation(trial, [3, 4]))
    run.simulation.fail(1, ValueError("ended for this test"))
    run.step()
    with pytest.raises(InputError, match="VelocityOrder: environment 1 has ended"):
        run.step([VelocityOrder(robot=trial.robots[0].name, environment=1)])
    assert np.array_equal(run.simulation.ticks, [1, 1])
