"""What the GAN study adds to Social Ways: centred noise, a discriminator that is not steep, and rows that resume."""

from __future__ import annotations

import dataclasses
import json
import math
from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
import torch

from crowdbot.core import InputError, stream
from crowdbot.prediction.social_ways.config import SocialWaysConfig
from crowdbot.prediction.training.torch_backend import torch_threads
from toy_gan import (
    MEASURES,
    METHODS,
    GanComparison,
    GanRun,
    ToyData,
    ToyTraining,
    gan_config,
    main,
    sample_futures,
    with_settings,
)

SMALL = {"hidden": 8, "pooled": 4, "noise": 6, "batch": 32}
TOY = ToyData(tracks=6)


@pytest.fixture(autouse=True, scope="module")
def one_thread() -> Iterator[None]:
    with torch_threads(1):
        yield


def trained(updates: int, **values: object) -> ToyTraining:
    """Return a small network on the toy set after some updates."""
    model = ToyTraining(TOY, gan_config("vanilla", TOY, {**SMALL, **values}))
    parts = model.batches(stream(0, "order"))
    for number in range(updates):
        model.update(parts[number % len(parts)], stream(0, "update", number), number, updates)
    return model


def slope(model: ToyTraining) -> float:
    """Return the mean squared slope of the discriminator at true futures, by its derivative."""
    lesson = model._to_tensors(model.samples.batch(np.arange(len(model.samples))))
    future = lesson.future.clone().requires_grad_(True)
    said, _ = model.discriminator(lesson.observed, future)
    (steep,) = torch.autograd.grad(said.sum(), future)
    return float(steep.square().sum(dim=(1, 2)).mean())


def test_noise_is_centred_and_made_larger() -> None:
    plain, centred = trained(0), trained(0, noise_gain=math.sqrt(12.0))
    lesson = plain._to_tensors(plain.samples.batch(np.arange(3)))
    noise = torch.full((1, 3, 1, plain.config.inputs), 0.75)
    there, _ = centred.generator(lesson.sight, noise, 2)
    same, _ = plain.generator(lesson.sight, 0.25 * math.sqrt(12.0) * torch.ones_like(noise), 2)
    torch.testing.assert_close(there, same)
    few, many = (sample_futures(item, 200, stream(0, "drawn")).std(axis=1).mean() for item in (plain, centred))
    assert many > 3.0 * few  # before anything is learned


def test_codes_of_one_step_are_the_same_and_the_rest_of_the_noise_is_left() -> None:
    model = trained(0, code_levels=3, noise_gain=10.0)
    lesson = model._to_tensors(model.samples.batch(np.arange(1)))

    def drawn(code: float, rest: float = 0.5) -> torch.Tensor:
        noise = torch.full((1, 1, 1, model.config.inputs), rest)
        noise[..., : model.config.latent_codes] = code
        return torch.as_tensor(model.generator(lesson.sight, noise, 2)[0])

    assert torch.equal(drawn(0.05), drawn(0.3))
    assert torch.equal(drawn(0.7), drawn(1.0))  # noise of exactly 1 belongs to the last step
    assert not torch.allclose(drawn(0.3), drawn(0.4))
    assert not torch.allclose(drawn(0.3), drawn(0.3, rest=0.6))


def test_the_penalty_is_the_squared_slope_and_makes_it_smaller() -> None:
    """The small step aside gives the derivative's square on average, and training with it keeps slopes low."""
    model = trained(0)
    lesson = model._to_tensors(model.samples.batch(np.arange(len(model.samples))))
    rng, felt = stream(0, "aside"), []
    with torch.no_grad():
        here, _ = model.discriminator(lesson.observed, lesson.future)
        for _ in range(100):
            aside = torch.as_tensor(rng.standard_normal(lesson.future.shape, dtype=np.float32))
            there, _ = model.discriminator(lesson.observed, lesson.future + 0.01 * aside)
            felt.append(float(((there - here) / 0.01).square().mean()))
    assert np.mean(felt) == pytest.approx(slope(model), rel=0.1)
    values = {"discriminator_rate": 1e-2, "generator_rate": 1e-6}
    assert slope(trained(60, slope_penalty=10.0, **values)) < 0.2 * slope(trained(60, **values))


def test_the_penalty_falls_between_30_and_90_percent() -> None:
    model = trained(0, slope_penalty=2.0, slope_penalty_left=0.01)
    assert [model._penalty(done) for done in (0.0, 0.3, 0.6, 0.9, 1.0)] == pytest.approx([2.0, 2.0, 0.2, 0.02, 0.02])
    assert trained(0)._penalty(0.5) == 0.0


def test_variety_grows_between_30_and_80_percent() -> None:
    model = trained(0, use_variety_loss=True, variety_weight=10.0, variety_growth=100.0)
    weights = [model._variety_weight(done) for done in (0.0, 0.3, 0.55, 0.8, 1.0)]
    assert weights == pytest.approx([10.0, 10.0, 100.0, 1000.0, 1000.0])
    first, last = model._to_tensors(model.samples.batch(np.arange(4))), {}
    for weight in (weights[0], weights[-1]):
        noise = model._noise(first, stream(1, "noise"), 20)
        losses = model._generator_step(first, model._draw(first, noise)[1], noise[0][first.scored][:, :2], weight)
        last[weight] = losses["variety"]
    assert 50.0 < last[weights[-1]] / last[weights[0]] < 150.0


def test_without_them_nothing_random_is_drawn_for_them() -> None:
    """Rows of the report draw the same numbers as before these settings were there."""
    one, other = trained(3), trained(3, slope_penalty_left=0.5)
    assert all(torch.equal(one.mean[name], other.mean[name]) for name in one.mean)


def test_wrong_settings_are_said() -> None:
    with pytest.raises(InputError, match="slope_penalty_left = 0.0 must be above 0 and at most 1"):
        SocialWaysConfig(slope_penalty_left=0.0)
    with pytest.raises(InputError, match="variety_growth = 0.0 must be above 0 and at most 1000000"):
        SocialWaysConfig(variety_growth=0.0)
    with pytest.raises(InputError, match="slope_penalty = -1.0 must be at least 0"):
        SocialWaysConfig(slope_penalty=-1.0)
    with pytest.raises(InputError, match="code_levels = -1 must be at least 0"):
        SocialWaysConfig(code_levels=-1)
    with pytest.raises(InputError, match="noise_gain = -1.0 must be at least 0"):
        SocialWaysConfig(noise_gain=-1.0)


def test_rows_of_the_report_keep_its_settings_and_ours_say_what_differs() -> None:
    report = SocialWaysConfig()
    for method in tuple(METHODS)[:7]:
        config = gan_config(method, ToyData())
        for name in ("generator_rate", "discriminator_rate", "momentum", "adversarial", "batch", "hidden", "noise"):
            assert getattr(config, name) == getattr(report, name)
        assert (config.noise_gain, config.slope_penalty, config.average) == (0.0, 0.0, 0.0)
    code = gan_config("info+rates-of-code", ToyData())
    assert (code.generator_rate, code.discriminator_rate, code.adversarial) == (1e-4, 1e-3, "least-squares")
    steady = gan_config("info+slope-penalty", ToyData())
    assert dataclasses.replace(steady, use_info_loss=False) == gan_config("vanilla+slope-penalty", ToyData())


def test_a_study_goes_seed_by_seed_and_resumes_to_the_same_runs(tmp_path: Path) -> None:
    study = GanComparison(("info+slope-penalty", "vanilla"), (0, 1), updates=4, check_every=2, toy=TOY)
    study = with_settings(study, {"hidden": "4", "noise": "2"})
    runs: list[GanRun] = []
    for run in study.run(tmp_path):
        runs.append(run)
        if len(runs) == 2:
            break
    assert [(run.method, run.seed) for run in runs] == [("info+slope-penalty", 0), ("vanilla", 0)]
    again = list(study.run(tmp_path))
    fresh = list(study.run())
    assert [(run.method, run.seed) for run in again[2:]] == [("info+slope-penalty", 1), ("vanilla", 1)]
    for item, other in zip(again, fresh, strict=True):
        np.testing.assert_array_equal(item.drawn, other.drawn)
        assert list(item.update) == [2, 4]
    assert [row["seeds"] for row in GanComparison.rows(again)] == [2, 2]


def test_a_row_is_the_mean_of_the_last_quarter() -> None:
    measures = {name: np.arange(8.0) for name in MEASURES}
    runs = [GanRun("vanilla", seed, np.arange(8) + 1, measures, np.zeros((1, 1, 2, 2))) for seed in (0, 1)]
    (row,) = GanComparison.rows(runs)
    assert (row["emd"], row["emd_sd"], row["updates"], row["seeds"]) == (6.5, 0.0, 8, 2)
    short = [dataclasses.replace(runs[0], update=np.array([1]), measures={name: np.ones(1) for name in MEASURES})]
    assert GanComparison.rows(short)[0]["emd"] == 1.0


def test_tracks_lie_on_circles_and_turn_off_to_three_sides() -> None:
    toy = ToyData()
    paths = toy.paths(stream(0, "toy"), 200)
    assert paths.shape == (6, 3, 200, 4, 2)
    np.testing.assert_allclose(np.linalg.norm(paths, axis=-1), np.broadcast_to(toy.radii, (6, 3, 200, 4)))
    assert np.ptp(paths[:, :, :, :2], axis=(1, 2)).max() == 0.0  # what is seen does not say the mode
    angle = np.degrees(np.arctan2(paths[0, ..., 1], paths[0, ..., 0]))
    for row, jitter in ((2, 2.0), (3, 3.0)):
        off = angle[..., row] - np.array([[-16.0], [0.0], [16.0]])
        assert np.abs(off).max() <= jitter + 1e-9
        assert np.abs(off).max() > 0.95 * jitter
    np.testing.assert_allclose(toy.middles()[0, 1], np.array(toy.radii)[:, None] * [1.0, 0.0], atol=1e-12)


def test_it_is_a_set_of_samples_with_one_person_each() -> None:
    samples = ToyData(tracks=5).samples(stream(0, "toy"))
    assert (len(samples), samples.people, samples.observe, samples.predict) == (90, 90, 2, 2)
    assert sum(len(batch) for batch in samples.batches(stream(0, "order"), 64)) == 90


def test_wrong_numbers_and_methods_are_said() -> None:
    with pytest.raises(InputError, match="1 of 4 rows are observed"):
        ToyData(observe=1)
    with pytest.raises(InputError, match="must be at least 1"):
        ToyData(groups=0)
    with pytest.raises(InputError, match="unknown method 'vanila', did you mean 'vanilla'"):
        gan_config("vanila", ToyData())
    assert gan_config("s-gan-v20", ToyData()).variety_draws == 20


@pytest.mark.sweep
def test_the_study_trains_measures_and_draws(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    words = ["--methods", "vanilla", "info+unrolled5", "--seeds", "1", "--updates", "2",
             "--check-every", "1", "--set", "hidden=4", "--out", str(tmp_path)]  # fmt: skip
    assert main(words) == 0
    assert "info+unrolled5" in capsys.readouterr().out
    result = json.loads((tmp_path / "study.json").read_text(encoding="utf-8"))
    assert [row["method"] for row in result["methods"]] == ["vanilla", "info+unrolled5"]
    assert result["runs"][0]["update"] == [1, 2]
    assert 0.45 < result["ideal"]["nearest_neighbor"] < 0.55
    assert result["ideal"]["emd"] < 0.015
    assert result["ideal"]["whole"] == 1.0
    assert all((tmp_path / name).stat().st_size > 1000 for name in ("samples.png", "measures.png"))
    main(words)
    assert json.loads((tmp_path / "study.json").read_text(encoding="utf-8")) == result
    with pytest.raises(SystemExit):
        main(["--methods", "infoo", "--out", str(tmp_path / "other")])
    assert "unknown method 'infoo', did you mean 'info'" in capsys.readouterr().err
