"""Calibration finds the parameters of a crowd that was made with known ones."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
import pytest

from crowdbot.calibration import Calibrator, Rollout
from crowdbot.calibration import calibrator as module
from crowdbot.core import InputError, Paper, PerAgent, Scene, per_agent, stream
from crowdbot.core.parameter import parameter
from crowdbot.data import Windows
from crowdbot.models import ORCA, CrowdModel, CurrentDirection


@dataclass(frozen=True)
class Shy(CrowdModel):
    """Everyone walks to the goal and is pushed away by who is nearer than ``space`` and their radii."""

    paper: ClassVar[Paper] = Paper("Nobody", 2020, "Shyness", "Nowhere")
    strength: PerAgent = parameter(0.0, unit="1/s", low=0.0, high=4.0, source="test")
    space: PerAgent = parameter(1.0, unit="m", low=0.2, high=3.0, source="test")

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> np.ndarray:
        away = scene.position[:, :, None] - scene.position[:, None, :]
        distance = np.sqrt(np.sum(away**2, axis=-1))
        both = scene.active[:, None, :] & scene.active[:, :, None] & ~np.eye(scene.shape[1], dtype=bool)
        space = per_agent(self.space, scene.shape)[..., None] + scene.radius[:, None, :] + scene.radius[..., None]
        near = np.where(both, np.maximum(0.0, space - distance), 0.0) / np.maximum(distance, 1e-9)
        push = np.sum(away * near[..., None], axis=2) * per_agent(self.strength, scene.shape)[..., None]
        return scene.desired_velocity(dt) + push


TRUTH = Shy(strength=1.5, space=1.2)


@pytest.fixture(scope="module")
def past() -> Windows:
    """Eight windows of six people who meet in the middle of a circle, as ``TRUTH`` says, with radius 0.3 m."""
    rng = stream(4, "shy")
    W, T, A = 8, 8, 6
    angle = np.arange(A) * 2.0 * np.pi / A + rng.normal(0.0, 0.1, (W, A))
    out = np.stack([np.cos(angle), np.sin(angle)], axis=-1)
    aim = -(out + rng.normal(0.0, 0.1, out.shape)) * rng.uniform(1.0, 1.4, (W, A, 1))
    position = np.zeros((W, T, A, 2))
    position[:, 0], position[:, 1] = 4.0 * out, 4.0 * out + 0.4 * aim  # nobody is near anybody in the first step
    everyone, nobody = np.ones((W, T, A), dtype=bool), np.zeros((W, A), dtype=bool)
    frame, id = np.tile(np.arange(T), (W, 1)), np.tile(np.arange(A), (W, 1))
    begun = Windows(position, everyone, nobody, nobody, id, frame, 0.4, "all", "made")
    position[:, 1:] = Rollout(TRUTH, CurrentDirection(), radius=0.3).again(begun)[0]
    return begun


def test_the_truth_is_nearly_found_and_predicts_better(past: Windows) -> None:
    fit = Calibrator(Shy(), budget=400).fit(past, seed=1)
    assert fit.cost < 0.2 * fit.default_cost
    assert fit.evaluations == 400
    assert (fit.windows, fit.persons) == (8, 48)
    reach = fit.values["space"] + 2.0 * fit.values["radius"]
    assert reach == pytest.approx(1.2 + 0.6, abs=0.3)  # only their sum acts in this model
    assert fit.model == Shy(fit.values["strength"], fit.values["space"])
    assert np.all(np.diff(fit.history) <= 0.0)
    assert fit.history[-1] == fit.cost


def test_the_same_seed_gives_the_same_fit_and_another_another(past: Windows) -> None:
    one, same, other = (Calibrator(Shy(), budget=20).fit(past, seed=seed) for seed in (1, 1, 2))
    assert one.values == same.values
    assert one.values != other.values


def test_a_fit_is_never_worse_than_what_was_given(past: Windows) -> None:
    fit = Calibrator(TRUTH, radius=0.3, budget=1).fit(past)
    assert fit.values == {"strength": 1.5, "space": 1.2, "radius": 0.3}
    assert fit.cost == fit.default_cost


def test_pieces_that_fit_the_memory_change_nothing(past: Windows, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = Calibrator(Shy(), budget=20).fit(past)
    for agents in (1, 6 * 8 * 3):
        monkeypatch.setattr(module, "AGENTS_AT_ONCE", agents)
        pieces = Calibrator(Shy(), budget=20).fit(past)
        np.testing.assert_allclose(pieces.history, whole.history, rtol=1e-12)
        assert pieces.values == whole.values


def test_several_recordings_are_fitted_together(past: Windows) -> None:
    whole = Calibrator(Shy(), budget=20).fit(past)
    parts = Calibrator(Shy(), budget=20).fit([past[:3], past[3:]])
    np.testing.assert_allclose(parts.history, whole.history, rtol=1e-12)
    assert (parts.windows, parts.persons) == (whole.windows, whole.persons)


def test_progress_is_told_and_ends_at_one(past: Windows, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "AGENTS_AT_ONCE", 6 * 8 * 4)
    shares: list[float] = []
    Calibrator(Shy(), budget=10).fit(past, progress=shares.append)
    assert shares == sorted(shares)
    assert len(shares) == 4
    assert shares[-1] == 1.0


def test_orca_is_calibrated_by_name(past: Windows) -> None:
    fit = Calibrator(budget=6).fit(past[:3])
    assert fit.scheme == "orca, absolute-difference, random-search, current-direction"
    assert set(fit.values) == {
        "neighbor_distance", "max_neighbors", "time_horizon", "time_horizon_walls", "radius",
    }  # fmt: skip
    assert isinstance(fit.model, ORCA)
    forecast = fit.predict(past, 12, samples=3)
    assert forecast.position.shape == (8, 1, 12, 6, 2)
    assert forecast.predictor == f"calibrated {fit.scheme}"
    assert "6 evaluations" in str(fit)


def test_only_the_past_decides(past: Windows) -> None:
    peeked = Windows(*[*list(vars(past).values())[:2], ~past.scored, *list(vars(past).values())[3:]])
    assert Calibrator(Shy(), budget=5).fit(past).values == Calibrator(Shy(), budget=5).fit(peeked).values


def test_wrong_use_is_said_in_a_sentence(past: Windows) -> None:
    with pytest.raises(InputError, match="budget = 0 evaluations must be at least 1"):
        Calibrator(Shy(), budget=0)
    with pytest.raises(InputError, match=r"unknown cost 'absolute-distance', did you mean 'absolute-difference'\?"):
        Calibrator(Shy(), cost="absolute-distance")
    with pytest.raises(InputError, match="unknown search 'greed'"):
        Calibrator(Shy(), search="greed")
    with pytest.raises(InputError, match="needs at least 2 observed rows, made has 1"):
        Calibrator(Shy(), budget=5).fit(
            Windows(past.position[:, :1], past.present[:, :1], *list(vars(past).values())[2:])
        )
    with pytest.raises(InputError, match="nobody in 0 windows of no recording can be compared"):
        Calibrator(Shy(), budget=5).fit([])
    with pytest.raises(InputError, match="nobody in 8 windows of made can be compared"):
        Calibrator(Shy(), budget=5).fit(
            Windows(past.position, np.zeros_like(past.present), *list(vars(past).values())[2:])
        )
    with pytest.raises(InputError, match="strength .* must be one number, not one for each agent"):
        Calibrator(Shy(strength=np.ones((8, 6)))).fit(past)
