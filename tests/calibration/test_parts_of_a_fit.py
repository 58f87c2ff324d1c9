"""Parts of a calibration one by one: cooling, spread, prior, parameters of people, futures, plans, text of a fit."""

from __future__ import annotations

import dataclasses
import json
import math
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from made_crowds import Shy, resimulate

from crowdbot.calibration import (
    CMAES,
    Absolute,
    Fit,
    Geometric,
    ParameterSpace,
    PopulationPrior,
    Progressive,
    ResimulatedTracks,
    Rollout,
)
from crowdbot.calibration.fit import futures
from crowdbot.calibration.searches import _spread
from crowdbot.core import InputError, Scene
from crowdbot.data import Windows
from crowdbot.models import CurrentDirection, Goal
from crowdbot.models.goals import Choices


def made(position: np.ndarray, present: np.ndarray | None = None, robot: np.ndarray | None = None) -> Windows:
    """Return windows of positions ``[W, T, A, 2]``."""
    W, T, A, _ = position.shape
    here = np.ones((W, T, A), dtype=bool) if present is None else present
    nobody = np.zeros((W, A), dtype=bool)
    return Windows(
        np.where(here[..., None], position, 0.0), here, nobody, nobody if robot is None else robot,
        np.tile(np.arange(A), (W, 1)), np.tile(np.arange(T), (W, 1)), 0.5, "all", "made",
    )  # fmt: skip


def straight(W: int = 1, T: int = 4, A: int = 2) -> Windows:
    """Return people who walk along x at 1 m/s, 3 m beside each other."""
    position = np.zeros((W, T, A, 2))
    position[..., 0] = 0.5 * np.arange(T)[None, :, None]
    position[..., 1] = 3.0 * np.arange(A)
    return made(position)


def test_cooling_by_default_falls_from_a_tenth_to_a_ten_thousandth() -> None:
    assert [Geometric().at(progress) for progress in (0.0, 0.5, 1.0)] == pytest.approx([0.1, 10**-2.5, 1e-4])
    assert Geometric(0.2, 0.2).at(0.7) == pytest.approx(0.2)


def test_the_spread_of_costs_is_that_of_the_middle_half_and_0_when_it_is_infinite() -> None:
    costs = np.array([7.0, 1.0, 3.0, 2.0, 9.0, 5.0, 4.0, 8.0])
    people = np.stack([costs, np.where(costs > 5.0, np.inf, costs), np.full(8, np.inf)], axis=1)[:, None]
    np.testing.assert_array_equal(_spread(people), [[[8.0 - 3.0, 0.0, 0.0]]])


@pytest.mark.parametrize("edge", [0.0, 1.0])
def test_cma_es_draws_solutions_inside_the_box_instead_of_cutting_them_off(edge: float) -> None:
    asked: list[np.ndarray] = []

    def cost(candidates: np.ndarray, which: np.ndarray) -> np.ndarray:
        asked.append(candidates[1:] if len(asked) else candidates[:0])
        return np.sum(np.abs(candidates - edge), axis=-1)

    CMAES(tolerance=-math.inf).minimize(
        cost, np.zeros(2), np.ones(2), [np.random.default_rng(3)], 150, np.full((1, 1, 4, 2), 0.5)
    )
    values = np.concatenate(asked)
    assert np.mean(values == edge) < 0.02
    assert np.mean(np.abs(values - edge) < 0.2) > 0.3


def test_a_cost_over_one_row_is_the_distance_in_this_row() -> None:
    past = straight(T=4)
    present = past.present.copy()
    present[0, 2:, 1] = False  # the second person is seen in row 1 only, after the first row
    past = dataclasses.replace(past, present=present)
    off = past.position[None] + [[[[[0.3, 0.4]]]]]
    tracks = ResimulatedTracks(past, lambda: off[:, :, 1:], lambda: off[:, :, 2:])
    np.testing.assert_allclose(Absolute().measure(tracks), [[[0.5, 0.5]]])
    np.testing.assert_allclose(Progressive().measure(tracks), [[[0.5, np.nan]]])


def test_a_recording_of_two_rows_has_no_row_to_begin_anew() -> None:
    tracks = resimulate(straight(T=2), Shy())
    assert tracks.once.shape == (1, 1, 1, 2, 2)
    assert tracks.stepwise.shape == (1, 1, 0, 2, 2)
    assert np.all(np.isnan(Progressive().measure(tracks)))


@pytest.mark.parametrize("away", ["late", "early", "robot"])
def test_who_comes_late_leaves_early_or_is_a_robot_moves_as_recorded(away: str) -> None:
    past = straight(T=5)
    present, robot = past.present.copy(), past.robot.copy()
    position = past.position.copy()
    position[0, :, 1, 1] = 0.5  # so near that the first person is pushed by the second
    if away == "late":
        present[0, :2, 1] = False
    elif away == "early":
        present[0, 3:, 1] = False
    else:
        robot[0, 1] = True
        position[0, 2:, 1, 0] = 1.0  # and stops
    past = dataclasses.replace(past, position=np.where(present[..., None], position, 0.0), present=present, robot=robot)
    once = resimulate(past, Shy(strength=2.0, space=1.0)).once[0, 0]
    lonely = resimulate(straight(T=5, A=1), Shy(strength=2.0, space=1.0)).once[0, 0, :, 0]
    pushed = np.abs(once[:, 0, 1] - lonely[:, 1]) > 1e-9
    if away == "late":
        assert pushed.tolist() == [False, False, True, True]
    elif away == "early":
        steps = np.diff(once[:, 0, 1], prepend=0.0)
        assert np.all(pushed)
        assert (steps < 0.0).tolist() == [True, True, True, False]  # who has left pushes nobody any more
    else:
        assert once[-1, 1] == pytest.approx([1.0, 0.5])


def test_velocities_are_known_only_between_two_observed_rows() -> None:
    from crowdbot.calibration.rollout import _recorded_tracks

    position = np.arange(8.0).reshape(1, 4, 1, 2) ** 2
    present = np.array([True, True, False, True]).reshape(1, 4, 1)
    recorded = _recorded_tracks(made(position, present))
    np.testing.assert_array_equal(recorded.velocity[0, :, 0], [[8.0, 16.0], [0.0, 0.0], [0.0, 0.0], [0.0, 0.0]])
    assert recorded.last.tolist() == [[3]]
    assert recorded.changes
    assert not _recorded_tracks(made(position)).changes
    assert _recorded_tracks(made(position, robot=np.array([[True]]))).changes


def test_windows_with_and_without_people_are_predicted_together() -> None:
    past = straight(W=2)
    present = past.present.copy()
    present[1] = False
    past = dataclasses.replace(past, present=present, position=np.where(present[..., None], past.position, 0.0))
    predict_positions = Rollout(Shy(), CurrentDirection()).predict_positions(past, 3)
    assert predict_positions.shape == (2, 3, 2, 2)
    np.testing.assert_allclose(predict_positions[0, :, 0], [[2.0, 0.0], [2.5, 0.0], [3.0, 0.0]], atol=1e-9)
    assert np.all(predict_positions[1] == 0.0)
    nobody = dataclasses.replace(past, present=np.zeros_like(present))
    assert Rollout(Shy(), CurrentDirection()).predict_positions(nobody, 3).shape == (2, 3, 2, 2)


def test_a_robot_follows_its_plan_and_others_do_not() -> None:
    past = dataclasses.replace(straight(), robot=np.array([[False, True]]))
    rollout = Rollout(Shy(), CurrentDirection())
    free = rollout.predict_positions(past, 2)[0]
    np.testing.assert_allclose(free[:, 1], [[2.0, 3.0], [2.5, 3.0]])
    planned = rollout.predict_positions(past.with_plans({1: [[1.5, 4.0], [1.0, 5.0]]}), 2)[0]
    np.testing.assert_allclose(planned[:, 1], [[1.5, 4.0], [1.0, 5.0]])
    np.testing.assert_allclose(planned[:, 0], free[:, 0])


class Steps(Shy):
    """Writes down its time steps."""

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        taken.append(dt)
        return super().step(scene, dt, rng)


taken: list[float] = []


@pytest.mark.parametrize(("substep", "count"), [(0.1, 5), (0.12, 5), (0.125, 4), (0.3, 2), (0.5, 1), (9.0, 1)])
def test_a_row_is_cut_into_equal_steps(substep: float, count: int) -> None:
    taken.clear()
    Rollout(Steps(), CurrentDirection(), substep=substep).predict_positions(straight(), 1)
    assert taken == pytest.approx([0.5 / count] * count)


def test_people_walk_at_the_observed_or_the_given_speed() -> None:
    past = straight()
    scene = Rollout(Shy(), CurrentDirection(), radius=0.3).scene(past, 3)
    np.testing.assert_allclose(scene.preferred_speed, 1.0)
    np.testing.assert_allclose(scene.max_speed, 2.0)
    np.testing.assert_allclose(scene.radius, 0.3)
    given_speed = np.array([[0.5, 3.0]])
    scene = Rollout(Shy(), CurrentDirection(), preferred_speed=given_speed).scene(past, 3)
    np.testing.assert_allclose(scene.preferred_speed, given_speed)
    np.testing.assert_allclose(scene.max_speed, [[2.0, 3.9]])


class Crossroads(Goal):
    """Everyone goes left with the probability 0.75, right with 0.25."""

    def resolve(self, past: Windows) -> np.ndarray:
        return self.choices(past).position[:, :, 0]

    def choices(self, past: Windows) -> Choices:
        here = past.present[:, -1]
        place = past.position[:, -1, :, None] + np.array([[1.0, 40.0], [1.0, -40.0]])
        return Choices(place, here[..., None] * np.array([0.75, 0.25]))


def test_destinations_are_drawn_in_proportion_to_their_probabilities() -> None:
    past = straight(W=2, A=1)
    rollout = Rollout(Shy(), Crossroads())
    place, weight = futures(rollout, past, 2, 4, np.random.default_rng(1).spawn(2))
    assert place.shape == (2, 4, 2, 1, 2)
    for w in range(2):
        kept = weight[w] > 0.0
        side = np.sign(place[w, kept, -1, 0, 1])
        assert dict(zip(side.tolist(), weight[w, kept].tolist(), strict=True)) == {1.0: 0.75, -1.0: 0.25}
    one, only = futures(rollout, past, 2, 1, np.random.default_rng(1).spawn(2))
    assert one.shape == (2, 1, 2, 1, 2)
    assert np.all(one[..., 1] > 0.0)
    assert only.tolist() == [[1.0], [1.0]]


SPACE = ParameterSpace(Shy(), ("strength", "preferred_speed"))


def fit_of(values: np.ndarray, shared: bool = False, counted: np.ndarray | None = None) -> Fit:
    """Return a fit of two windows of three people, or a shared one."""
    space = ParameterSpace(Shy(), ("strength", "radius"), shared=True) if shared else SPACE
    cost = np.array([0.25]) if shared else np.array([0.25, 0.75])
    past = straight(W=2, A=3)
    return Fit(
        "shy", space, Rollout(Shy(), CurrentDirection()), values, np.ones_like(values), past.id,
        np.ones((2, 3), bool) if counted is None else counted, cost, 2.0 * cost, np.array([7] * len(cost)),
        np.ones((len(cost), 7)), 1.25, 2,
    )  # fmt: skip


VALUES = np.array([[[1.0, 1.1], [2.0, 1.2], [3.0, 1.3]], [[1.5, 0.9], [2.5, 0.8], [3.5, 0.7]]])


def test_a_fit_of_each_person_tells_medians_and_spreads() -> None:
    text = str(fit_of(VALUES))
    assert "cost 0.5000 m, 1.0000 m before" in text
    assert "(6 persons in 2 windows, 14 evaluations, 1.2 s); each person's own: " in text
    assert f"strength 2.25 (sd {np.std(VALUES[..., 0]):.2g}), preferred_speed 1 (sd" in text


def test_a_shared_fit_tells_its_numbers() -> None:
    fit = fit_of(np.array([[[2.0, 0.3]]]), shared=True)
    assert str(fit).endswith("one set for everyone: strength 2, radius 0.3")
    assert fit.table() == {"strength": (2.0, 0.0), "radius": (0.3, 0.0)}
    assert fit.model == Shy(strength=2.0)
    assert fit.shared_rollout.radius == 0.3
    np.testing.assert_array_equal(fit.values_of(straight(W=3)), np.broadcast_to([2.0, 0.3], (3, 2, 2)))
    with pytest.raises(InputError, match="individual parameters"):
        _ = fit_of(VALUES).shared_rollout


def test_a_fit_predicts_with_the_parameters_that_it_found() -> None:
    past = straight(W=2, A=3)
    near = past.position.copy()
    near[..., 1] /= 4.0  # 0.75 m beside each other: they are pushed
    past = dataclasses.replace(past, position=near)
    fit = fit_of(np.array([[[2.0, 0.3]]]), shared=True)
    same = Rollout(Shy(strength=2.0), CurrentDirection(), 0.3).predict_positions(past, 3)
    np.testing.assert_array_equal(fit.predict(past, 3).position[:, 0], same)
    own = fit_of(VALUES)
    model, speed = Shy(strength=VALUES[..., 0]), VALUES[..., 1]
    each = Rollout(model, CurrentDirection(), preferred_speed=speed).predict_positions(past, 3)
    np.testing.assert_array_equal(own.predict(past, 3).position[:, 0], each)
    assert not np.array_equal(each, same)
    assert own.predict(past, 3).predictor == "calibrated shy"


def test_people_keep_their_latest_values_and_strangers_take_the_median() -> None:
    counted = np.array([[True, True, True], [True, False, True]])
    fit = fit_of(VALUES, counted=counted)
    past = dataclasses.replace(straight(A=4), id=np.array([[2, 9, 1, 0]]))
    found = fit.values_of(past)[0]
    median = np.median([1.0, 2.0, 3.0, 1.5, 3.5])
    np.testing.assert_allclose(found, [[3.5, 0.7], [median, 1.0], [2.0, 1.2], [1.5, 0.9]])
    assert fit.persons == 5
    empty = fit_of(VALUES, counted=np.zeros((2, 3), bool))
    assert empty.table() == {}
    np.testing.assert_allclose(empty.values_of(past)[0], [[0.0, 1.0]] * 4)


@pytest.mark.parametrize(("steps", "samples"), [(0, 1), (1, 0)])
def test_a_prediction_of_nothing_is_refused(steps: int, samples: int) -> None:
    with pytest.raises(InputError, match="at least 1 step and 1 sample"):
        fit_of(VALUES).predict(straight(W=2, A=3), steps, samples)


def test_a_prior_of_few_people_is_refused_and_of_enough_is_their_distribution() -> None:
    rng = np.random.default_rng(0)
    values = np.stack([rng.uniform(0.5, 3.5, (2, 3)), rng.uniform(0.5, 2.0, (2, 3))], axis=-1)
    given_values = np.full_like(values, 1.0)
    fit = dataclasses.replace(fit_of(values), given=given_values)
    prior = PopulationPrior.from_fits(fit)
    share = values[..., 0].ravel() / 4.0
    rows = np.stack([np.log(share / (1.0 - share)), values[..., 1].ravel() - 1.0], axis=1)
    np.testing.assert_allclose(prior.mean, rows.mean(axis=0))
    covariance = np.cov(rows, rowvar=False)
    np.testing.assert_allclose(np.diag(prior.covariance), np.diag(covariance))
    assert prior.covariance[0, 1] == pytest.approx(0.9 * covariance[0, 1])
    four = np.array([[True, True, True], [True, False, False]])
    assert PopulationPrior.from_fits(dataclasses.replace(fit, counted=four)).names == SPACE.names
    three = np.array([[True, True, True], [False, False, False]])
    with pytest.raises(InputError, match="3 people are too few for 2 parameters, it needs at least 4"):
        PopulationPrior.from_fits(dataclasses.replace(fit, counted=three))
    with pytest.raises(InputError, match="the fits must have individual parameters"):
        PopulationPrior.from_fits([])


@settings(max_examples=40)
@given(share=st.floats(-0.2, 1.2), speed=st.floats(0.0, 2.5), mean=st.floats(-2.0, 2.0), strength=st.floats(0.0, 3.0))
def test_the_penalty_of_a_prior_is_half_its_strength_times_the_squared_distance(
    share: float, speed: float, mean: float, strength: float
) -> None:
    prior = PopulationPrior(SPACE.names, np.array([mean, 0.1]), np.diag([4.0, 0.25]), strength)
    place = min(max(share, 0.01), 0.99)
    away = math.log(place / (1.0 - place)) - mean, (speed - 1.5) - 0.1
    values = np.array([[[4.0 * share, speed]]])
    expected = 0.5 * strength * (away[0] ** 2 / 4.0 + away[1] ** 2 / 0.25)
    found = prior.penalty(SPACE, values, np.array([[[9.0, 1.5]]]))
    assert found.tolist() == [[pytest.approx(expected, rel=1e-9, abs=1e-12)]]


def test_the_typical_person_has_the_mean_of_the_prior_and_the_own_speed() -> None:
    prior = PopulationPrior(SPACE.names, np.array([math.log(3.0), 0.4]), np.eye(2))
    assert prior.typical(SPACE, np.array([[0.0, 1.0], [0.0, 2.4]])).tolist() == [
        [pytest.approx(3.0), pytest.approx(1.4)], [pytest.approx(3.0), 2.5],
    ]  # fmt: skip
    slow = PopulationPrior(SPACE.names, np.array([0.0, -4.0]), np.eye(2))
    assert slow.typical(SPACE, np.array([0.0, 1.0])).tolist() == [pytest.approx(2.0), 0.0]


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"mean": np.zeros(3)}, r"mean \[3\] and covariance \[2, 2\] must be \[2\] and \[2, 2\]"),
        ({"covariance": np.eye(3)}, r"covariance \[3, 3\]"),
        ({"mean": np.array([0.0, np.inf])}, "mean must be finite"),
        ({"covariance": np.diag([1.0, 0.0])}, "positive definite"),
        ({"strength": -0.1}, "strength = -0.1 must be finite and not below 0"),
        ({"strength": math.inf}, "strength = inf"),
    ],
)
def test_a_wrong_prior_is_refused(changes: dict[str, object], message: str) -> None:
    prior = PopulationPrior(SPACE.names, np.zeros(2), np.eye(2), 0.0)
    with pytest.raises(InputError, match=message):
        dataclasses.replace(prior, **changes)


def test_a_prior_is_read_as_it_was_written(tmp_path: Path) -> None:
    prior = PopulationPrior(SPACE.names, np.array([0.25, -1.5]), np.array([[2.0, 0.5], [0.5, 1.0]]), 0.75)
    prior.save(tmp_path / "prior.json")
    again = PopulationPrior.load(tmp_path / "prior.json")
    assert (again.names, again.strength) == (prior.names, 0.75)
    np.testing.assert_array_equal(again.mean, prior.mean)
    np.testing.assert_array_equal(again.covariance, prior.covariance)
    assert json.loads((tmp_path / "prior.json").read_text())["strength"] == 0.75


def test_the_mean_speed_of_all_rows_replaces_the_last_one() -> None:
    position = np.zeros((1, 4, 1, 2))
    position[0, :, 0, 0] = [0.0, 0.3, 0.6, 1.5]
    past = made(position)
    space = ParameterSpace(Shy(strength=1.5), SPACE.names)
    values = space.initial_values(past, Rollout(Shy(), CurrentDirection()))
    assert values[0, 0, 0] == 1.5
    steady = space.with_mean_speed(past, values)
    assert steady[0, 0].tolist() == [1.5, pytest.approx(1.0)]
    assert values[0, 0, 1] != pytest.approx(1.0)


def test_parameters_are_those_of_the_model_then_radius_and_speed() -> None:
    space = ParameterSpace(Shy())
    assert space.names == ("strength", "space", "radius", "preferred_speed")
    assert space.low.tolist() == [0.0, 0.2, 0.1, 0.0]
    assert space.high.tolist() == [4.0, 3.0, 0.4, 2.5]
    assert ParameterSpace(Shy(), shared=True).names == ("strength", "space", "radius")
    assert ParameterSpace(Shy(), ("preferred-speed",)).names == ("preferred_speed",)
    with pytest.raises(InputError, match="shy has no parameter 'preferred_speed' to calibrate"):
        ParameterSpace(Shy(), ("preferred_speed",), shared=True)


def test_a_scene_takes_the_radius_and_speed_of_its_people() -> None:
    model = Shy(strength=2.0)
    space = ParameterSpace(model, ("space", "radius", "preferred_speed"))
    rollout = Rollout(model, CurrentDirection())
    past = straight(W=2)
    scene = rollout.scene(past, 3)
    values = np.stack([np.full((2, 2), 0.7), np.full((2, 2), 0.2), np.array([[1.0, 2.0], [0.5, 1.5]])], axis=-1)
    taken_rollout, taken_scene = space.apply_to_scene(rollout, scene, values)
    np.testing.assert_array_equal(taken_scene.radius, values[..., 1])
    np.testing.assert_array_equal(taken_scene.preferred_speed, values[..., 2])
    np.testing.assert_allclose(taken_scene.max_speed, [[2.0, 2.6], [2.0, 2.0]])
    assert taken_rollout.model.strength == 2.0
    np.testing.assert_array_equal(taken_rollout.model.space, values[..., 0])
    plain = ParameterSpace(Shy(), ("space",)).apply_to_scene(rollout, scene, values[..., :1])[1]
    np.testing.assert_array_equal(plain.radius, scene.radius)
    np.testing.assert_array_equal(plain.preferred_speed, scene.preferred_speed)
