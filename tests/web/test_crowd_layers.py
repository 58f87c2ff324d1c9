"""Density, time to collision and predicted paths against the metrics and predictors of the command line."""

import numpy as np
import pytest
from simulator_session import ready, simulator

from crowdbot.core import InputError, Scene
from crowdbot.metrics import time_to_collision
from crowdbot.prediction import ConstantVelocity, Kalman, Live
from crowdbot.web.scene import crowd_layers
from crowdbot.web.scene.crowd_layers import (
    CELL,
    DENSITY_UNIT,
    OBSERVED,
    ROW,
    STEPS,
    PredictedPaths,
    collision_lines,
    density_field,
)


def test_the_density_field_holds_all_people_and_has_the_value_of_the_formula():
    place = np.random.default_rng(1).uniform(-5.0, 9.0, (40, 2))
    field, (x0, y0, cell) = density_field(place)
    assert cell == CELL
    assert field.sum() * DENSITY_UNIT * CELL**2 == pytest.approx(40.0, rel=0.03)
    row, column = 17, 11
    point = np.array([x0 + CELL * (column + 0.5), y0 + CELL * (row + 0.5)])
    expected = np.exp(-((place - point) ** 2).sum(axis=1)).sum() / np.pi
    assert field[row, column] * DENSITY_UNIT == pytest.approx(expected, abs=0.5 * DENSITY_UNIT)


def test_far_and_empty_crowds_have_a_small_field():
    assert density_field(np.zeros((0, 2)))[0].shape == (1, 1)
    assert max(density_field(np.array([[-1e6, 0.0], [1e6, 0.0]]))[0].shape) <= 160


@pytest.mark.parametrize("seed", range(4))
def test_lines_are_the_pairs_of_the_metric(seed):
    draw = np.random.default_rng(seed)
    position, velocity = draw.uniform(-4.0, 4.0, (40, 2)), draw.normal(0.0, 1.2, (40, 2))
    scene = Scene.of(position, velocity, radius=0.25, active=draw.uniform(size=40) < 0.8)
    args = scene.position, scene.velocity, scene.radius[0], scene.active
    expected = set()
    for item in np.flatnonzero(scene.active[0]):
        for other, seconds in enumerate(time_to_collision(*args, item)[0]):
            near = np.abs(position[other] - position[item]).max() < 8.0
            if other > item and near and 0.0 < seconds < 3.0:
                expected.add((*np.round(position[item], 4), *np.round(position[other], 4), round(float(seconds), 4)))
    found = collision_lines(scene).astype(np.float64)
    assert len(found) == len(expected) > 0
    rows = np.array(sorted(expected))
    assert np.allclose(found[np.lexsort(found.T[::-1])], rows, atol=2e-4)


def test_paths_are_those_of_the_predictor(monkeypatch):
    monkeypatch.setattr(crowd_layers, "SHARE", 1e9)  # ask it for every row, however slow the computer is
    track = np.cumsum(np.random.default_rng(3).normal(0.3, 0.1, (OBSERVED, 3, 2)), axis=0)
    ids, paths = np.array([4, 7, 9]), PredictedPaths(Kalman())
    for k in range(OBSERVED):
        scene = Scene.of(track[k], np.zeros((3, 2)))
        found = paths.update(k * ROW, scene, ids, lambda seconds: None)
    live = Live(Kalman(), ROW)
    for row in track:
        live.update(ids, row)
    expected = live.predict(STEPS).position[0, 0].transpose(1, 0, 2)
    assert np.allclose(found[:3].reshape(3, STEPS + 1, 2)[:, 1:], expected, atol=1e-5)
    assert np.allclose(found[:3, :2], track[-1])
    moved = Scene.of(track[-1] + 0.1, np.zeros((3, 2)), active=[True, False, True])
    between = paths.update((OBSERVED - 1) * ROW + 0.1, moved, ids, lambda seconds: None)
    assert len(between) == len(found) * 2 // 3  # somebody has left
    assert np.allclose(between[0, :2], track[-1, 0] + 0.1)  # from where they are now


def test_another_predictor_sees_the_rows_observed_so_far(monkeypatch):
    monkeypatch.setattr(crowd_layers, "SHARE", 1e9)
    one, other = PredictedPaths(ConstantVelocity()), PredictedPaths(Kalman())
    for k in range(4):
        scene = Scene.of([[0.3 * k * k, 0.0]], [[1.0, 0.0]])
        one.update(k * ROW, scene, np.array([3]), lambda seconds: None)
        expected = other.update(k * ROW, scene, np.array([3]), lambda seconds: None)
    one.exchange(Kalman())
    found = one.update(3 * ROW, scene, np.array([3]), lambda seconds: None)
    assert np.array_equal(found[:1], expected[:1])


def test_a_jump_asks_for_the_time_before():
    asked = []

    def before(seconds):
        asked.append(round(seconds, 6))
        return Scene.of([[seconds, 0.0]], [[1.0, 0.0]])

    paths = PredictedPaths(ConstantVelocity())
    found = paths.update(10.0, Scene.of([[10.0, 0.0]], [[1.0, 0.0]]), np.array([1]), before)
    assert asked == [round(10.0 - ROW * k, 6) for k in range(OBSERVED - 1, 0, -1)]
    assert found[0].tolist() == pytest.approx([x for k in range(STEPS + 1) for x in (10.0 + ROW * k, 0.0)], abs=1e-5)


def test_a_window_chooses_layers_and_predictor(tmp_path):
    with simulator(tmp_path) as desk:
        desk.open("circle-crossing", paused=True)
        ready(desk)
        desk.layers(["paths", "density", "ttc"])
        desk.step(20)
        desk.predictor("sampled-constant-velocity")
        arrays = desk._player.do(lambda: desk.session.frames[-1].arrays)
        assert arrays["paths"].shape[1] == 2 * (STEPS + 1)
        assert len(arrays["paths"]) > len(arrays["ids"]) + 1  # several futures of each
        assert arrays["density"].dtype == np.uint8
        assert arrays["ttc"].shape[1] == 5
        assert desk.greet()["predictor"] == "sampled-constant-velocity"
        assert desk.session.latest("simulator.predictor") == "sampled-constant-velocity"
        with pytest.raises(InputError, match="there is no predictor 'kalmann', did you mean 'kalman'"):
            desk.predictor("kalmann")
