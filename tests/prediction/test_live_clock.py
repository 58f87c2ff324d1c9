"""Streams of real trackers: any rate, jittered stamps, hidden people, identities of any type."""

from __future__ import annotations

import threading
import uuid
from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories, Windows
from crowdbot.models.goals import LearnedDestinations
from crowdbot.prediction import AnchorNet, Anchors, ConstantVelocity, Live, Predictor, Simulated

Maker = Callable[..., Windows]
SPEED = 1.3

LEARNED = pytest.mark.parametrize("predictor", [AnchorNet(), Anchors()], ids=["anchor-net", "anchors"])


def walk(live: Live, rate: float, seconds: float, jitter: float = 0.0, stamped: bool = True) -> float:
    """Send one person who walks along x at ``rate`` [Hz]; return the last time."""
    rng = stream(3, "stamps")
    now = 0.0
    for row in range(round(seconds * rate) + 1):
        now = row / rate + float(rng.uniform(-jitter, jitter))
        live.update([1], [[SPEED * now, 0.0]], time=now if stamped else None)
    return now


@LEARNED
@pytest.mark.parametrize("rate", [5.0, 10.0, 20.0, 30.0])
def test_a_walker_walks_on_at_every_rate(predictor: Predictor, rate: float) -> None:
    live = Live(predictor, dt=1.0 / rate)
    walk(live, rate, 3.5, stamped=False)
    steps = round(4.8 * rate)
    reached = live.predict(steps, 20).position[0, :, -1, 0, 0].max() - live.past().position[0, -1, 0, 0]
    assert reached > 0.8 * 4.8 * SPEED
    assert live.past().position.shape[1] >= 2.8 * rate
    if isinstance(predictor, AnchorNet):
        single = live.predict(steps).position[0, 0, -1, 0, 0] - live.past().position[0, -1, 0, 0]
        assert 0.7 * 4.8 * SPEED < single < 1.3 * 4.8 * SPEED


@LEARNED
def test_the_rate_of_the_tracker_hardly_changes_the_forecast(predictor: Predictor) -> None:
    ends = []
    for rate in (5.0, 12.5, 30.0):
        live = Live(predictor, dt=0.4)
        now = walk(live, rate, 4.0)
        ends.append(live.predict(12, 20).position[0, :, -1, 0, 0] - SPEED * now)
    np.testing.assert_allclose(ends[1:], [ends[0], ends[0]], atol=0.02)


def test_eight_rows_of_20_hz_are_enough_for_a_velocity(windows: Maker) -> None:
    track = SPEED * 0.05 * np.arange(8.0)
    past = windows(np.stack([track, 0.0 * track], axis=-1)[None, :, None], dt=0.05)
    found = AnchorNet("all").predict(past, 96).position[0, 0, -1, 0, 0] - track[-1]
    assert 0.6 * 4.8 * SPEED < found < 1.4 * 4.8 * SPEED


def test_stamps_may_jitter() -> None:
    live = Live(ConstantVelocity(displacements=7), dt=0.1)
    now = walk(live, 10.0, 3.0, jitter=0.004)
    past = live.past()
    np.testing.assert_allclose(past.position[0, :, 0, 0], SPEED * (now - 0.1 * np.arange(7, -1, -1)), atol=1e-9)
    np.testing.assert_allclose(live.predict(1).position[0, 0, 0, 0], [SPEED * (now + 0.1), 0.0], atol=1e-9)


def test_a_lost_row_is_interpolated_and_a_long_gap_is_not() -> None:
    live = Live(ConstantVelocity(), dt=0.2)
    for now in (0.0, 0.2, 0.6, 0.8):
        live.update([1], [[now, 0.0]], time=now)
    np.testing.assert_allclose(live.past().position[0, :, 0, 0], [0.0, 0.2, 0.4, 0.6, 0.8], atol=1e-9)
    live.update([2], [[0.0, 0.0]], time=1.0)
    live.update([1, 2], [[2.2, 0.0], [0.0, 0.0]], time=2.2)
    here = live.past().present[0, :, live.ids.tolist().index(1)]
    assert here[-1]
    assert not here[-6:-1].any()


def test_a_hidden_person_coasts_and_fades() -> None:
    live = Live(ConstantVelocity(), dt=0.4, coast=1.2)
    for row in range(4):
        live.update([1, 2], [[0.4 * row, 0.0], [5.0, 0.0]])
    shares = []
    for hidden in (1, 2, 3):
        live.update([2], [[5.0, 0.0]])
        forecast = live.predict(2)
        assert live.ids.tolist() == [1, 2]
        assert forecast.existence is not None
        assert forecast.existence[0, 1] == 1.0
        shares.append(forecast.existence[0, 0])
        start = 0.4 * (3 + hidden)
        np.testing.assert_allclose(forecast.position[0, 0, :, 0, 0], [start + 0.4, start + 0.8], atol=1e-9)
    np.testing.assert_allclose(shares, 0.5 ** (2.0 * np.array([0.4, 0.8, 1.2]) / 1.2))
    live.update([2], [[5.0, 0.0]])
    assert live.ids.tolist() == [2]
    live.update([1, 2], [[3.2, 0.0], [5.0, 0.0]])
    forecast = live.predict(1)
    assert live.ids.tolist() == [1, 2]
    assert forecast.existence is not None
    assert forecast.existence.tolist() == [[1, 1]]


def test_identities_have_any_type() -> None:
    one, other = uuid.uuid5(uuid.NAMESPACE_DNS, "one"), ("camera 2", 7)
    live = Live(ConstantVelocity(), dt=0.4)
    for row in range(3):
        live.update(["a", one, other, 4], [[0.4 * row, k] for k in range(4)], robots=["a"])
    assert set(live.ids.tolist()) == {"a", one, other, 4}
    at = live.ids.tolist().index("a")
    plan = [[9.0, 9.0], [9.0, 8.0]]
    np.testing.assert_allclose(live.predict(2, plans={"a": plan}).position[0, 0, :, at], plan)
    assert live.past().robot[0].tolist() == [k == at for k in range(4)]
    with pytest.raises(InputError, match="the plan is for 'b', who is not tracked"):
        live.predict(2, plans={"b": plan})
    plain = Live(ConstantVelocity(), dt=0.4)
    plain.update(np.array([3, 5]), np.zeros((2, 2)))
    assert plain.ids.dtype == np.int64


def test_a_negative_coast_is_rejected() -> None:
    with pytest.raises(InputError, match=r"coast = -1 s must be finite and at least 0"):
        Live(ConstantVelocity(), dt=0.4, coast=-1)


def test_memory_is_bounded() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    for row in range(3000):
        live.update([f"person {row}"], [[0.0, 0.0]])
    assert len(live._history._rows) < 30
    assert len(live._history._labels) < 60


def test_threads_share_a_stream() -> None:
    live = Live(ConstantVelocity(), dt=0.1)
    live.update([0], [[0.0, 0.0]])
    found: list[int] = []

    def ask() -> None:
        found.extend(live.predict(3).steps for _ in range(40))

    threads = [threading.Thread(target=ask) for _ in range(3)]
    for thread in threads:
        thread.start()
    for row in range(200):
        live.update([row % 7, 9], [[0.1 * row, 0.0], [1.0, 1.0]])
    for thread in threads:
        thread.join()
    assert found == [3] * 120
    assert live.report.latency >= 0.0


def test_a_goal_learned_at_another_time_step_follows_a_fast_stream() -> None:
    row = np.arange(20)
    tracks = Trajectories(np.full(20, 7), row, 0.48 * row, np.zeros(20), row_rate=2.5)
    goal = LearnedDestinations.learn(tracks)
    live = Live(Simulated("orca", goal), dt=0.1)
    assert live.observe == 29
    walk(live, 10.0, 3.0)
    forecast = live.predict(24)
    moved = forecast.position[0, 0, -1, 0] - live.past().position[0, -1, 0]
    np.testing.assert_allclose(moved, [2.4 * SPEED, 0.0], atol=0.05)
