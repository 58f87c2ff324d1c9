"""A live stream of tracked people, predicted row by row."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.data import Trajectories, Windows
from crowdbot.models import GroundTruth
from crowdbot.prediction import ConstantVelocity, Kalman, Live, Predictor, Simulated

Maker = Callable[..., Windows]

SCHEME = Simulated(cost="progressive", search="random-search", budget=12, substep=0.4)


@pytest.mark.parametrize("predictor", [ConstantVelocity(), Kalman(), Simulated(), SCHEME], ids=lambda p: p.name)
def test_a_stream_is_predicted_as_the_same_window_of_a_recording(
    predictor: Predictor, recorded: Callable[[str], Trajectories]
) -> None:
    tracks = recorded("biwi_hotel")
    frames = np.unique(tracks.frame)[100:130]
    live = Live(predictor, dt=tracks.dt, coast=0.0)
    for frame in frames:
        here = tracks.frame == frame
        live.update(tracks.id[here], tracks.position[here])
        forecast = live.predict(12)
        assert forecast.valid.all()
        assert forecast.position.shape == (1, 1, 12, here.sum(), 2)
        if predictor is not SCHEME and len(live.past().frame[0]) == 8:
            past = tracks.past(frame=int(frame), late="extrapolate")
            assert set(live.ids.tolist()) >= set(past.id[0].tolist())
    assert len(live.past()) == 1
    assert live.past().position.shape[1] == 8


def test_people_come_and_go_and_are_missed_for_a_while() -> None:
    live = Live(ConstantVelocity(), dt=0.5, coast=0.0)
    live.update([1, 2], [[0.0, 0.0], [9.0, 0.0]])
    live.update([2, 3], [[9.0, 0.5], [5.0, 5.0]])
    live.update([3, 1], [[5.0, 5.0], [2.0, 0.0]])
    assert live.ids.tolist() == [1, 3]
    assert live.past().present[0].tolist() == [[True, False], [False, True], [True, True]]
    np.testing.assert_allclose(live.predict(1).position[0, 0, 0], [[3.0, 0.0], [5.0, 5.0]])
    live.update([], [])
    assert live.predict(3).position.shape == (1, 1, 3, 0, 2)


def test_a_calibrated_crowd_begins_with_the_frame_before(recorded: Callable[[str], Trajectories]) -> None:
    tracks = recorded("crowds_zara02")
    frames = np.unique(tracks.frame)[200:215]
    costs: dict[int, list[float]] = {0: [], 1: []}
    for warm in (0, 1):
        live = Live(Simulated(cost="absolute", search="random-search", budget=40, substep=0.4), dt=tracks.dt)
        for frame in frames:
            here = tracks.frame == frame
            live.update(tracks.id[here], tracks.position[here])
            if not warm:
                live._memory = None
            live.predict(1)
            costs[warm].append(float(live._memory.cost[0]) if live._memory is not None else np.nan)
    cold, warmed = (np.nanmean(costs[warm][8:]) for warm in (0, 1))
    assert warmed < cold


def test_the_prediction_answers_for_the_plan_of_the_robot() -> None:
    live = Live(Simulated(substep=0.1), dt=0.4)
    for row in range(4):
        live.update([5, 9], [[0.4 * row, 0.0], [6.0, 0.0]], robots=[9])
    left = [[6.0 - 0.5 * step, 0.25 * step] for step in range(1, 13)]
    right = [[6.0 - 0.5 * step, -0.25 * step] for step in range(1, 13)]
    straight = [[6.0 - 0.5 * step, 0.02] for step in range(1, 13)]
    free = live.predict(12).position[0, 0]
    ahead = live.predict(12, plans={9: straight}).position[0, 0]
    np.testing.assert_allclose(ahead[:, 1], straight)
    assert np.linalg.norm(ahead[:, 0] - ahead[:, 1], axis=-1).min() > 0.4  # the person steps aside
    assert abs(ahead[-1, 0, 1]) > abs(free[-1, 0, 1])
    for plan in (left, right):
        there = live.predict(12, plans={9: plan}).position[0, 0]
        np.testing.assert_allclose(there[:, 1], plan)
        assert np.linalg.norm(there[:, 0] - ahead[:, 0], axis=-1).max() > 0.05


class Counter(ConstantVelocity):
    """Remembers how often it has predicted."""

    def follow(self, past, steps, samples=1, rng=None, memory=None, limit=None):  # type: ignore[no-untyped-def]
        return self.predict(past, steps, samples, rng), (memory or 0) + 1


def test_a_query_with_a_plan_leaves_the_memory_alone() -> None:
    live = Live(Counter(), dt=0.4)
    live.update([5, 9], [[0.0, 0.0], [6.0, 0.0]], robots=[9])
    live.predict(3)
    assert live._memory == 1
    for _ in range(3):
        live.predict(3, plans={9: [[5.0, 0.0]]})
    assert live._memory == 1
    live.predict(3)
    assert live._memory == 2


def test_a_query_with_a_plan_changes_no_later_forecast() -> None:
    def forecasts(ask: bool) -> list[np.ndarray]:
        crowd = Simulated(cost="absolute", search="random-search", budget=20, substep=0.4)
        live = Live(crowd, dt=0.4, observe=4)
        result = []
        for row in range(6):
            live.update([5, 9], [[0.4 * row, 0.1 * row], [6.0 - 0.3 * row, 0.0]], robots=[9])
            if ask:
                live.predict(3, plans={9: [[4.0, 1.0], [3.0, 2.0]]})
            result.append(live.predict(3).position)
        return result

    for plain, asked in zip(forecasts(False), forecasts(True), strict=True):
        np.testing.assert_array_equal(plain, asked)


def test_a_plan_that_ends_leaves_the_robot_standing(windows: Maker) -> None:
    time = np.arange(-7.0, 1.0) * 0.4
    past = windows(np.stack([time, 0.0 * time], axis=-1)[None, :, None], robot=True)
    planned = past.with_plans({0: [[0.2, 0.0], [0.3, 0.1]]})
    for predictor in (ConstantVelocity(), Simulated()):
        found = predictor.predict(planned, 4).position[0, 0, :, 0]
        np.testing.assert_allclose(found, [[0.2, 0.0], [0.3, 0.1], [0.3, 0.1], [0.3, 0.1]], atol=1e-12)


def test_wrong_use_is_said_in_a_sentence(windows: Maker) -> None:
    future = windows(np.zeros((1, 3, 1, 2)))
    with pytest.raises(InputError, match="GroundTruth requires the future"):
        Live(Simulated(goal=GroundTruth(future, future)), dt=0.4)
    with pytest.raises(InputError, match=r"dt = 0\.0 s must be finite and above 0"):
        Live(ConstantVelocity(), dt=0.0)
    with pytest.raises(InputError, match="observe = 0 rows must be at least 1"):
        Live(ConstantVelocity(), dt=0.4, observe=0)
    with pytest.raises(
        InputError, match="live: 'anchor-net' is not a predictor; pass an instance, such as crowdbot.Anchor"
    ):
        Live("anchor-net", dt=0.4)  # type: ignore[arg-type]
    live = Live(ConstantVelocity(), dt=0.4)
    with pytest.raises(InputError, match="no row yet"):
        live.predict(3)
    with pytest.raises(InputError, match="2 identities and 1 positions"):
        live.update([1, 2], [[0.0, 0.0]])
    with pytest.raises(InputError, match="position of 2 is not finite"):
        live.update([1, 2], [[0.0, 0.0], [np.nan, 0.0]])
    with pytest.raises(InputError, match="identity 1 occurs 2 times in a frame of 2; identities must be distinct"):
        live.update([1, 1], [[0.0, 0.0], [1.0, 0.0]])
    live.update([1], [[0.0, 0.0]])
    with pytest.raises(InputError, match="the plan is for robot 4, who is in no window"):
        live.predict(3, plans={4: [[0.0, 0.0]]})
    with pytest.raises(InputError, match=r"the plan of robot 1 has shape \[0, 2\]"):
        live.predict(3, plans={1: np.zeros((0, 2))})
    with pytest.raises(InputError, match=r"all must have as many rows; they have \[1, 2\]"):
        windows(np.zeros((1, 2, 2, 2))).with_plans({0: np.zeros((1, 2)), 1: np.zeros((2, 2))})
