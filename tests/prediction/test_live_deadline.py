"""Live with a deadline: a calibrated crowd evaluates what fits, and tells what does not."""

from __future__ import annotations

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.prediction import ConstantVelocity, Live, Simulated, live


class Clock:
    """A clock that goes on by the given seconds at each call."""

    def __init__(self) -> None:
        self.now, self.step = 0.0, 0.0

    def perf_counter(self) -> float:
        self.now += self.step
        return self.now


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    made = Clock()
    monkeypatch.setattr(live, "clock", made)
    return made


def crowd(row: int) -> np.ndarray:
    return np.array([[0.5 * row, 0.0], [6.0 - 0.5 * row, 0.3], [0.4 * row, 2.0]])


def follow(stream: Live, rows: range) -> None:
    for row in rows:
        stream.update([1, 2, 3], crowd(row))


def test_the_budget_follows_the_speed_of_the_computer(clock: Clock) -> None:
    scheme = Simulated("orca", cost="progressive", search="genetic", budget=300, substep=0.4)
    stream = Live(scheme, dt=0.4, deadline=0.1)
    follow(stream, range(8))
    clock.step = 0.02  # a call takes 20 ms
    stream.predict(2)
    assert stream.evaluations == live.FIRST_BUDGET
    assert stream.left_out == "20 of 300 evaluations fitted into 0.1 s"
    follow(stream, range(8, 9))
    stream.predict(2)  # 1000 evaluations per second were seen
    assert stream.evaluations == 80
    clock.step = 0.2
    follow(stream, range(9, 10))
    stream.predict(2)
    assert stream.latency > stream.deadline
    assert stream.left_out.startswith("the prediction took 0.2 s, more than 0.1 s; ")
    seen = stream.evaluations
    follow(stream, range(10, 11))
    stream.predict(2)
    assert stream.evaluations < seen


def test_what_fits_is_not_told(clock: Clock) -> None:
    scheme = Simulated("orca", cost="progressive", search="genetic", budget=10, substep=0.4)
    stream = Live(scheme, dt=0.4, deadline=1.0)
    follow(stream, range(8))
    clock.step = 0.001
    stream.predict(2)
    assert (stream.evaluations, stream.left_out) == (10, "")
    plain = Live(ConstantVelocity(), dt=0.4, deadline=1.0)
    follow(plain, range(8))
    plain.predict(2)
    assert (plain.evaluations, plain.left_out) == (0, "")


def test_without_a_deadline_all_evaluations_run() -> None:
    stream = Live(Simulated("orca", cost="progressive", search="genetic", budget=60, substep=0.4), dt=0.4)
    follow(stream, range(8))
    stream.predict(2)
    assert (stream.evaluations, stream.left_out) == (60, "")


def test_a_deadline_is_above_0() -> None:
    with pytest.raises(InputError, match="deadline = 0.0 s must be above 0"):
        Live(ConstantVelocity(), dt=0.4, deadline=0.0)
