"""Scores of whole recordings: the table that everyone in the field compares with."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Trajectories, Windows
from crowdbot.metrics import Score
from crowdbot.prediction import (
    ConstantAcceleration,
    ConstantVelocity,
    Predictor,
    SampledConstantVelocity,
    evaluate,
)

Recorded = Callable[[str], Trajectories]
Maker = Callable[..., Windows]

SCENES = {
    "eth": ("biwi_eth",),
    "hotel": ("biwi_hotel",),
    "univ": ("students001", "students003"),
    "zara1": ("crowds_zara01",),
    "zara2": ("crowds_zara02",),
}
CONSTANT_VELOCITY = {
    "all": {
        "eth": (1.075, 2.282, 364),
        "hotel": (0.319, 0.614, 1197),
        "univ": (0.524, 1.165, 24334),
        "zara1": (0.427, 0.952, 2356),
        "zara2": (0.324, 0.724, 5910),
    },
    "sgan": {
        "eth": (0.995, 2.234, 181),
        "hotel": (0.323, 0.617, 1053),
        "univ": (0.524, 1.165, 24334),
        "zara1": (0.431, 0.960, 2253),
        "zara2": (0.326, 0.728, 5833),
    },
    "partial": {
        "eth": (0.585, 1.159, 2398),
        "hotel": (0.278, 0.512, 3376),
        "univ": (0.466, 1.026, 32183),
        "zara1": (0.346, 0.764, 3821),
        "zara2": (0.314, 0.695, 7888),
    },
}
OTHERS = {
    ("hotel", ConstantVelocity(2)): (0.270, 0.521),
    ("hotel", ConstantVelocity(7)): (0.243, 0.462),
    ("hotel", ConstantAcceleration()): (1.79, 4.46),
    ("zara1", ConstantVelocity(2)): (0.454, 0.987),
    ("zara1", ConstantVelocity(7)): (0.552, 1.132),
    ("zara1", ConstantAcceleration()): (0.89, 2.21),
}
SAMPLED = {
    "eth": (0.636, 1.152),
    "hotel": (0.197, 0.345),
    "univ": (0.293, 0.545),
    "zara1": (0.340, 0.620),
    "zara2": (0.218, 0.408),
}
COLLISIONS = {"eth": 0.033, "hotel": 0.037, "univ": 0.168, "zara1": 0.042, "zara2": 0.064}


def scored(recorded: Recorded, scene: str, predictor: Predictor, protocol: str = "all", **more: object) -> Score:
    parts = []
    for name in SCENES[scene]:
        past, future = recorded(name).windows(observe=8, predict=12, protocol=protocol)
        parts.append(evaluate(predictor, past, future, **more))  # type: ignore[arg-type]
    return Score.total(parts)


@pytest.mark.parametrize("protocol", CONSTANT_VELOCITY)
@pytest.mark.parametrize("scene", SCENES)
def test_constant_velocity_reproduces_the_table(recorded: Recorded, scene: str, protocol: str) -> None:
    ade, fde, persons = CONSTANT_VELOCITY[protocol][scene]
    score = scored(recorded, scene, ConstantVelocity(), protocol)
    assert score.persons == persons
    assert (score.ade, score.fde) == (pytest.approx(ade, abs=1e-3), pytest.approx(fde, abs=1e-3))
    assert score.protocol == protocol


@pytest.mark.parametrize(("scene", "predictor"), OTHERS, ids=lambda value: getattr(value, "name", value))
def test_the_other_baselines_reproduce_the_table(recorded: Recorded, scene: str, predictor: Predictor) -> None:
    ade, fde = OTHERS[scene, predictor]
    tolerance = 5e-3 if isinstance(predictor, ConstantAcceleration) else 1e-3  # as many decimals as were published
    score = scored(recorded, scene, predictor)
    assert (score.ade, score.fde) == (pytest.approx(ade, abs=tolerance), pytest.approx(fde, abs=tolerance))


def test_sampled_constant_velocity_is_the_known_floor(recorded: Recorded) -> None:
    found = []
    for scene in SCENES:
        # small recordings are averaged over seeds: one seed of eth alone varies by 0.02 m
        seeds = {"eth": 8, "hotel": 3}.get(scene, 1)
        runs = [scored(recorded, scene, SampledConstantVelocity(), samples=20, seed=seed) for seed in range(seeds)]
        found.append((np.mean([run.ade for run in runs]), np.mean([run.fde for run in runs])))
    assert np.mean(found, axis=0) == pytest.approx((0.337, 0.614), abs=0.01)
    np.testing.assert_allclose(found, list(SAMPLED.values()), atol=0.035)


@pytest.mark.parametrize("scene", ["hotel", "zara2"])
def test_share_of_people_that_constant_velocity_lets_collide(recorded: Recorded, scene: str) -> None:
    assert scored(recorded, scene, ConstantVelocity()).collisions == pytest.approx(COLLISIONS[scene], abs=5e-4)


def test_the_first_second_of_hotel(recorded: Recorded) -> None:
    horizon = scored(recorded, "hotel", ConstantVelocity()).horizon
    assert horizon[:3] == pytest.approx((0.053, 0.098, 0.139), abs=1e-3)
    assert len(horizon) == 12


@pytest.mark.parametrize("samples", [1, 5])
def test_chunks_change_nothing(crowd: Maker, samples: int) -> None:
    past = crowd(1, W=9)
    future = crowd(2, W=9)
    scored_ = past.present[:, -1] & future.present.all(axis=1) & ~past.robot
    future = Windows(*[*list(vars(future).values())[:2], scored_, *list(vars(future).values())[3:]])
    scores = [
        evaluate(SampledConstantVelocity(), past, future, samples=samples, best_of="scene", chunk=chunk)
        for chunk in (1, 2, 9, None)
    ]
    plain = [{**score.as_dict(), "seconds_per_window": 0} for score in scores]
    assert plain[0] == plain[1] == plain[2] == plain[3]
    assert all(score.seconds_per_window > 0 for score in scores)


def test_progress_is_told_and_ends_at_one(recorded: Recorded) -> None:
    past, future = recorded("biwi_eth").windows(observe=8, predict=12)
    shares: list[float] = []
    evaluate(ConstantVelocity(), past, future, progress=shares.append, chunk=100)
    assert shares == sorted(shares)
    assert len(shares) == 3
    assert shares[-1] == 1.0


class Nosy(ConstantVelocity):
    """Notes what it is given."""

    def predict(self, past: Windows, steps: int, samples: int = 1, rng: np.random.Generator | None = None) -> Forecast:
        assert not past.scored.any()
        assert past.position.shape[1] == 8
        return super().predict(past, steps, samples, rng)


def test_only_the_past_is_handed_over(recorded: Recorded) -> None:
    past, future = recorded("biwi_eth").windows(observe=8, predict=12)
    garbage = Windows(*[stream(0).normal(size=future.position.shape), *list(vars(future).values())[1:]])
    score = evaluate(Nosy(), past, garbage)
    assert score.predictor == "nosy"
    assert score.ade > 2.0


def test_windows_of_different_people_are_refused(recorded: Recorded) -> None:
    past, future = recorded("biwi_eth").windows(observe=8, predict=12)
    with pytest.raises(InputError, match="past and future are not windows of the same people"):
        evaluate(ConstantVelocity(), past[1:], future)
    with pytest.raises(InputError, match="there is no window to predict in biwi_eth"):
        evaluate(ConstantVelocity(), past[:0], future[:0])
