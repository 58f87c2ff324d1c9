"""Calibration finds the parameters of a crowd that was made with known ones."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from made_crowds import Shy, shy_crowd

from crowdbot.calibration import Calibrator, ParameterSpace, PopulationPrior
from crowdbot.calibration import calibrator as module
from crowdbot.core import InputError
from crowdbot.data import Windows
from crowdbot.models import ORCA

TRUTH = Shy(strength=1.5, space=1.2)
FREE = ("strength", "space", "radius")


@pytest.fixture(scope="module")
def past() -> Windows:
    return shy_crowd(TRUTH)


def shared(budget: int, **more: object) -> Calibrator:
    return Calibrator(Shy(), "absolute", "random-search", budget=budget, shared=True, **more)  # type: ignore[arg-type]


def each(budget: int, **more: object) -> Calibrator:
    return Calibrator(Shy(), "absolute", "random-search", budget=budget, free=FREE, **more)  # type: ignore[arg-type]


def test_the_shared_truth_is_nearly_found_and_predicts_better(past: Windows) -> None:
    fit = shared(400).fit(past, seed=1)
    assert fit.cost[0] < 0.2 * fit.given_cost[0]
    assert fit.evaluations.tolist() == [400]
    assert (fit.windows, fit.persons) == (8, 48)
    values = {name: median for name, (median, _) in fit.table().items()}
    assert values["space"] + 2.0 * values["radius"] == pytest.approx(1.2 + 0.6, abs=0.3)  # only their sum acts
    assert fit.model == Shy(values["strength"], values["space"])
    assert np.all(np.diff(fit.history[0]) <= 0.0)
    assert fit.history[0, -1] == fit.cost[0]


def test_everyone_s_own_parameters_fit_better_than_the_given_ones(past: Windows) -> None:
    fit = each(300).fit(past, seed=1)
    assert fit.values.shape == (8, 6, 3)
    assert np.all(fit.cost < 0.75 * fit.given_cost)
    assert fit.cost.shape == fit.evaluations.shape == (8,)
    again = Calibrator(Shy(), "absolute", "random-search", budget=1, free=FREE)
    kept = again.fit_each(past, [np.random.default_rng(0)] * 8, start=None)
    np.testing.assert_array_equal(kept.cost, fit.given_cost)


def test_what_is_found_costs_what_was_said(past: Windows) -> None:
    fit = each(50).fit(past, seed=3)
    content = each(2).fit(past, start=fit)
    np.testing.assert_allclose(content.cost, fit.cost, rtol=1e-12)
    assert np.array_equal(content.values, fit.values)


def test_the_same_seed_gives_the_same_fit_and_another_another(past: Windows) -> None:
    for scheme in (shared(20), each(20)):
        one, same, other = (scheme.fit(past, seed=seed) for seed in (1, 1, 2))
        assert np.array_equal(one.values, same.values)
        assert not np.array_equal(one.values, other.values)


def test_a_window_alone_is_fitted_as_among_others(past: Windows) -> None:
    whole = each(30).fit(past, seed=5)
    for w in (0, 3):
        rngs = [np.random.Generator(rng.bit_generator) for rng in _streams(8)]
        alone = each(30).fit_each(past[w : w + 1], [rngs[w]])
        among = each(30).fit_each(past, _streams(8))
        assert np.array_equal(alone.values[0], among.values[w])
    assert whole.values.shape[0] == 8


def _streams(count: int) -> list[np.random.Generator]:
    return [np.random.default_rng(number) for number in range(count)]


def test_a_fit_is_never_worse_than_what_was_given(past: Windows) -> None:
    fit = Calibrator(TRUTH, "absolute", "random-search", radius=0.3, budget=1, shared=True).fit(past)
    assert {name: median for name, (median, _) in fit.table().items()} == {
        "strength": 1.5, "space": 1.2, "radius": 0.3,
    }  # fmt: skip
    assert fit.cost == fit.given_cost


def test_pieces_that_fit_the_memory_change_nothing(past: Windows, monkeypatch: pytest.MonkeyPatch) -> None:
    whole = [scheme.fit(past) for scheme in (shared(20), each(20))]
    for agents in (1, 6 * 8 * 3):
        monkeypatch.setattr(module, "AGENTS_AT_ONCE", agents)
        chunks = [scheme.fit(past) for scheme in (shared(20), each(20))]
        for chunk, item in zip(chunks, whole, strict=True):
            np.testing.assert_allclose(chunk.history, item.history, rtol=1e-12)
            assert np.array_equal(chunk.values, item.values)


def test_several_recordings_are_fitted_together(past: Windows) -> None:
    whole = shared(20).fit(past)
    parts = shared(20).fit([past[:3], past[3:]])
    np.testing.assert_allclose(parts.history, whole.history, rtol=1e-12)
    assert (parts.windows, parts.persons) == (whole.windows, whole.persons)
    with pytest.raises(InputError, match="2 recordings can only be fitted together with shared parameters"):
        each(20).fit([past[:3], past[3:]])


def test_progress_is_told_and_ends_at_one(past: Windows, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "AGENTS_AT_ONCE", 6 * 4 * 100)
    for scheme in (shared(10), each(10)):
        shares: list[float] = []
        scheme.fit(past, progress=shares.append)
        assert shares == sorted(shares)
        assert shares[-1] == 1.0


def test_fixed_parameters_stay_and_free_ones_move(past: Windows) -> None:
    fit = Calibrator(Shy(space=0.7), "absolute", "random-search", budget=50, free=("strength",)).fit(past)
    assert fit.space.names == ("strength",)
    assert fit.model.space == 0.7  # type: ignore[attr-defined]
    assert fit.model.strength.shape == (8, 6)  # type: ignore[attr-defined]
    assert fit.rollout.radius == 0.25
    assert fit.rollout.preferred_speed is None


def test_everyone_s_preferred_speed_is_one_of_the_parameters(past: Windows) -> None:
    fit = Calibrator(TRUTH, "absolute", "random-search", budget=200, radius=0.3, free=("preferred-speed",)).fit(past)
    assert fit.space.names == ("preferred_speed",)
    begun = np.linalg.norm(past.position[:, 1] - past.position[:, 0], axis=-1) / past.dt
    assert np.median(np.abs(fit.values[..., 0] - begun)) < 0.1


def test_orca_is_calibrated_by_name(past: Windows) -> None:
    fit = Calibrator(budget=6, search="random-search", shared=True).fit(past[:3])
    assert fit.scheme == "orca, progressive, random-search, current-direction"
    assert set(fit.space.names) == {
        "neighbor_distance", "max_neighbors", "time_horizon", "time_horizon_walls", "radius",
    }  # fmt: skip
    assert isinstance(fit.model, ORCA)
    forecast = fit.predict(past, 12, samples=3)
    assert forecast.position.shape == (8, 1, 12, 6, 2)
    assert forecast.predictor == f"calibrated {fit.scheme}"
    assert "6 evaluations" in str(fit)


def test_people_are_known_again_in_other_windows(past: Windows) -> None:
    fit = each(40).fit(past, seed=2)
    moved = replace(past, id=past.id[:, ::-1], position=past.position[:, :, ::-1])
    values = fit.values_of(moved)
    np.testing.assert_array_equal(values[0, ::-1], fit.values[-1])  # the latest window with them
    stranger = replace(past, id=past.id + 100)
    medians = [median for median, _ in fit.table().values()]
    np.testing.assert_allclose(fit.values_of(stranger), np.broadcast_to(medians, fit.values.shape))


def test_only_the_past_decides(past: Windows) -> None:
    peeked = replace(past, scored=~past.scored)
    for scheme in (shared(5), each(5)):
        assert np.array_equal(scheme.fit(past).values, scheme.fit(peeked).values)


def test_a_prior_draws_people_towards_the_population(past: Windows, tmp_path: Path) -> None:
    fit = each(200).fit(past, seed=1)
    prior = PopulationPrior.from_fits(fit, strength=0.5)
    drawn = each(200, prior=prior).fit(past, seed=1)
    spread = [np.std(item.values.reshape(-1, 3), axis=0) for item in (drawn, fit)]
    assert np.all(spread[0] < spread[1])
    prior.save(tmp_path / "prior.json")
    again = PopulationPrior.load(tmp_path / "prior.json")
    assert again.names == prior.names
    np.testing.assert_allclose(again.covariance, prior.covariance)
    space = ParameterSpace(Shy(), FREE)
    typical = prior.typical(space, fit.given)
    assert np.all(prior.penalty(space, typical, fit.given) < 1e-6)
    assert np.all(prior.penalty(space, fit.values, fit.given) >= 0.0)


def test_a_prior_of_other_parameters_or_of_nobody_is_refused(past: Windows, tmp_path: Path) -> None:
    prior = PopulationPrior.from_fits(each(5).fit(past))
    with pytest.raises(InputError, match="it is of strength, space, radius, and strength are calibrated"):
        Calibrator(Shy(), "absolute", "random-search", budget=5, free=("strength",), prior=prior).fit(past)
    with pytest.raises(InputError, match="the fits must have individual parameters"):
        PopulationPrior.from_fits(shared(5).fit(past))
    with pytest.raises(InputError, match="a population prior requires individual parameters"):
        shared(5, prior=prior)
    (tmp_path / "wrong.json").write_text('{"names": ["a"], "mean": [1.0]}')
    with pytest.raises(InputError, match=r"wrong\.json is not a population prior"):
        PopulationPrior.load(tmp_path / "wrong.json")
    with pytest.raises(InputError, match=r"absent\.json: cannot be read"):
        PopulationPrior.load(tmp_path / "absent.json")


def test_wrong_use_is_said_in_a_sentence(past: Windows) -> None:
    with pytest.raises(InputError, match="budget = 0 evaluations must be at least 1"):
        each(0)
    with pytest.raises(InputError, match=r"unknown cost 'absolut', did you mean 'absolute'\?"):
        Calibrator(Shy(), cost="absolut")
    with pytest.raises(InputError, match="unknown search 'greed'"):
        Calibrator(Shy(), search="greed")
    with pytest.raises(InputError, match=r"shy has no parameter 'strenght' to calibrate, did you mean 'strength'\?"):
        Calibrator(Shy(), free=("strenght",))
    for scheme in (shared(5), each(5)):
        with pytest.raises(InputError, match="needs at least 2 observed rows, made has 1"):
            scheme.fit(replace(past, position=past.position[:, :1], present=past.present[:, :1]))
        with pytest.raises(InputError, match="nobody in 8 windows of made can be compared by absolute"):
            scheme.fit(replace(past, present=np.zeros_like(past.present)))
    with pytest.raises(InputError, match="nobody in 0 windows of no recording can be compared"):
        shared(5).fit([])
    with pytest.raises(InputError, match="strength must be one number before a calibration, not one for each agent"):
        Calibrator(Shy(strength=np.ones((8, 6))), search="random-search").fit(past)
    one = replace(past, present=past.present & (np.arange(6) == 0))
    with pytest.raises(InputError, match="can be compared by inter-pedestrian; people must be .* with others"):
        Calibrator(Shy(), "inter-pedestrian", "random-search", budget=5).fit(one)
