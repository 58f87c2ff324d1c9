"""Simulated crowds as predictors."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from crowdbot.calibration import Calibrator
from crowdbot.core import InputError, Paper, Scene
from crowdbot.data import Forecast, Windows
from crowdbot.models import ORCA, CrowdModel, CurrentDirection, GroundTruth
from crowdbot.prediction import ConstantVelocity, Simulated
from crowdbot.prediction.joint_futures import separate_people

Maker = Callable[..., Windows]


@dataclass(frozen=True)
class Straight(CrowdModel):
    """Everyone walks to the goal at the preferred speed, through the others."""

    paper: ClassVar[Paper] = Paper("Nobody", 2020, "Walking straight", "Nowhere")

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> np.ndarray:
        return scene.desired_velocity(dt)


def test_without_interaction_it_is_constant_velocity(crowd: Maker) -> None:
    past = crowd(3, holes=0.2)
    for displacements in (1, 3):
        simulated = Simulated(Straight(), CurrentDirection(steps=displacements))
        expected = ConstantVelocity(displacements).predict(past, 12)
        np.testing.assert_allclose(simulated.predict(past, 12).position, expected.position, atol=1e-9)


def test_a_single_person_under_orca_is_constant_velocity(windows: Maker) -> None:
    past = windows(np.arange(8.0)[None, :, None, None] * np.array([0.5, 0.1]))
    expected = ConstantVelocity().predict(past, 12).position
    np.testing.assert_allclose(Simulated().predict(past, 12).position, expected, atol=1e-9)


def head_on(windows: Maker, robot: bool, **more: object) -> Windows:
    """Two who walk towards each other, 6 m apart at the last row; the second one may be a robot."""
    time = np.arange(-7.0, 1.0) * 0.4
    path = np.zeros((1, 8, 2, 2))
    path[0, :, 0, 0], path[0, :, 1, 0] = time - 3.0, 3.0 - time
    path[0, :, 1, 1] = 0.05
    return windows(path, robot=[False, robot], **more)


def gap(position: np.ndarray) -> float:
    return float(np.linalg.norm(position[0, 0, :, 0] - position[0, 0, :, 1], axis=-1).min())


def test_people_avoid_each_other_and_walk_around_a_robot_that_drifts(windows: Maker) -> None:
    forecast = Simulated(substep=0.05).predict(head_on(windows, robot=False), 12)
    assert gap(forecast.position) > 0.45
    assert gap(ConstantVelocity().predict(head_on(windows, robot=False), 12).position) < 0.5
    past = head_on(windows, robot=True)
    beside_robot = Simulated(substep=0.05).predict(past, 12)
    assert gap(beside_robot.position) > 0.45
    drift = ConstantVelocity().predict(past, 12).position[0, 0, :, 1]
    np.testing.assert_allclose(beside_robot.position[0, 0, :, 1], drift, atol=1e-9)


def test_walls_of_the_recording_stop_people(windows: Maker) -> None:
    wall = np.array([[1.0, -5.0], [2.0, -5.0], [2.0, 5.0], [1.0, 5.0]])
    path = (np.arange(-7.0, 1.0) * 0.4)[None, :, None, None] * np.array([1.0, 0.0])
    free = Simulated().predict(windows(path), 12).position
    stopped = Simulated().predict(windows(path, walls=(wall,)), 12).position
    assert free[0, 0, -1, 0, 0] > 4.0
    assert stopped[0, 0, :, 0, 0].max() < 1.0


def test_substeps_divide_a_row_evenly(windows: Maker) -> None:
    past = windows(np.arange(8.0)[None, :, None, None] * np.array([0.5, 0.1]))
    for substep in (0.07, 0.4, 9.0):
        forecast = Simulated(substep=substep).predict(past, 2)
        np.testing.assert_allclose(forecast.position[0, 0, :, 0], [[4.0, 0.8], [4.5, 0.9]], atol=1e-9)


def test_models_and_goals_may_be_names() -> None:
    assert Simulated("orca", "current-direction") == Simulated()
    assert Simulated(ORCA(time_horizon=3.0)).name == "simulated(model=orca(time_horizon=3))"


def test_ground_truth_goals_end_where_people_went(windows: Maker) -> None:
    path = np.arange(20.0)[None, :, None, None] * np.array([0.5, 0.1])
    bent = path.copy()
    bent[:, 8:, :, 0] = path[:, 7:8, :, 0]
    past, future = windows(bent[:, :8]), windows(bent[:, 8:])
    end = Simulated(Straight(), GroundTruth(past, future)).predict(past, 40).position[0, 0, -1, 0]
    np.testing.assert_allclose(end, future.position[0, -1, 0], atol=1e-6)


def test_a_fit_predicts_the_same_as_its_predictor(crowd: Maker) -> None:
    past = crowd(4)
    fit = Calibrator(budget=5, search="random-search", shared=True).fit(past, seed=1)
    predictor = Simulated.of(fit)
    assert predictor.model == fit.model
    assert np.array_equal(predictor.predict(past, 12).position, fit.predict(past, 12).position)


def test_wrong_use_is_said_in_a_sentence(windows: Maker) -> None:
    with pytest.raises(InputError, match=r"unknown crowd model 'orka', did you mean 'orca'\?"):
        Simulated("orka")
    with pytest.raises(InputError, match="ground-truth has no default values"):
        Simulated(goal="ground-truth")
    with pytest.raises(InputError, match="3 is not a CrowdModel or the name of one"):
        Simulated(3)  # type: ignore[arg-type]
    with pytest.raises(InputError, match=r"substep = 0\.0 s must be finite and above 0"):
        Simulated(substep=0.0)
    with pytest.raises(InputError, match=r"radius = -1\.0 m must be finite and above 0"):
        Simulated(radius=-1.0)
    with pytest.raises(InputError, match="crowd models need metres"):
        Simulated().predict(windows(np.zeros((1, 8, 1, 2)), units="px"), 12)


def crossing(windows: Maker, **more: object) -> Windows:
    """Two who walk through each other, side by side by 5 cm, between the rows of the future."""
    time = np.arange(-7.0, 1.0) * 0.4
    path = np.stack([np.stack([1.3 * time - 3.2, 0.0 * time], 1), np.stack([3.2 - 1.3 * time, 0.05 + 0 * time], 1)], 1)
    return windows(path[None], **more)


def swept_gap(forecast: Forecast) -> float:
    """Return the smallest distance of two people, who walk straight between rows."""
    away = forecast.position[0, 0, :, 0] - forecast.position[0, 0, :, 1]
    fine = np.linspace(0.0, len(away) - 1.0, 2001)
    return float(np.hypot(*(np.interp(fine, np.arange(len(away)), away[:, axis]) for axis in (0, 1))).min())


def test_simulated_people_are_kept_apart_between_rows_as_learned_futures_are(windows: Maker) -> None:
    past = crossing(windows)
    alone = Simulated(Straight(), contact=0.0).predict(past, 12)
    assert swept_gap(alone) == pytest.approx(0.05, abs=1e-4)
    apart = Simulated(Straight()).predict(past, 12)
    assert swept_gap(apart) >= 0.25
    np.testing.assert_array_equal(apart.position, separate_people(past, alone.position, 0.25))
    np.testing.assert_allclose(apart.position, alone.position, atol=0.11)
    wide = dataclasses.replace(past, radius=np.array([[0.3, 0.5]]))
    assert swept_gap(Simulated(Straight()).predict(wide, 12)) >= 0.8


def test_simulated_people_stop_at_walls_that_their_model_does_not_see(windows: Maker) -> None:
    past = windows(np.arange(8.0)[None, :, None, None] * np.array([0.5, 0.0]))
    walled = dataclasses.replace(past, walls=(np.array([[5.2, -1.0], [5.2, 1.0]]),))
    assert Simulated(Straight(), contact=0.0).predict(walled, 12).position[0, 0, -1, 0, 0] == pytest.approx(9.5)
    assert Simulated(Straight()).predict(walled, 12).position[0, 0, -1, 0, 0] == pytest.approx(5.0)


@pytest.mark.parametrize("contact", [-0.1, np.inf, np.nan])
def test_a_contact_is_finite_and_not_negative(contact: float) -> None:
    with pytest.raises(InputError, match=r"simulated: contact = .* m must be finite and at least 0"):
        Simulated(contact=contact)
