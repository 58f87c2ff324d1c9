"""Social Ways: the network against slow twins, its losses, its training, and what holds of a network in use."""

from __future__ import annotations

import copy
import dataclasses
import math
from collections.abc import Callable, Iterator
from pathlib import Path

import numpy as np
import pytest
import torch

from crowdbot.core import InputError, stream
from crowdbot.data import Windows
from crowdbot.prediction import SocialWays
from crowdbot.prediction.social_ways import predictor as module
from crowdbot.prediction.social_ways.config import SocialWaysConfig, config_of, preset
from crowdbot.prediction.social_ways.inputs import scene_input
from crowdbot.prediction.social_ways.network import Discriminator, Generator, SceneInput, social_features
from crowdbot.prediction.social_ways.predictor import SocialWaysNetwork
from crowdbot.prediction.social_ways.training import SocialWaysTraining, augment, learner, variety_loss
from crowdbot.prediction.training.checkpoint import load_checkpoint, save_checkpoint
from crowdbot.prediction.training.loop import BEST, LAST, TrainingSchedule, train
from crowdbot.prediction.training.samples import Samples
from crowdbot.prediction.training.torch_backend import torch_device, torch_threads
from samples import sample

Maker = Callable[..., Windows]
TINY = SocialWaysConfig(hidden=8, pooled=4, noise=3, batch=8, variety_draws=3)


def walks(seed: int = 0, scenes: int = 12, rows: int = 20) -> Samples:
    """Make scenes of 1 to 4 wandering people."""
    rng = stream(seed, "walks")
    count = rng.integers(1, 5, scenes)
    velocity = rng.normal(0.0, 1.0, (count.sum(), 1, 2)) + rng.normal(0.0, 0.1, (count.sum(), rows, 2))
    return Samples(
        position=rng.uniform(-5.0, 5.0, (count.sum(), 1, 2)) + np.cumsum(0.4 * velocity, axis=1),
        there=np.ones((count.sum(), rows), dtype=bool),
        scored=rng.random(count.sum()) < 0.9,
        first=np.concatenate([[0], np.cumsum(count)]),
        source=np.zeros(scenes, dtype=np.int64),
        names=("walks",),
        observe=8,
        dt=0.4,
    )


@pytest.fixture(autouse=True, scope="module")
def one_thread() -> Iterator[None]:
    with torch_threads(1):
        yield


@pytest.fixture(scope="module")
def checkpoint(one_thread: None, tmp_path_factory: pytest.TempPathFactory) -> str:
    folder = tmp_path_factory.mktemp("trained")
    train(SocialWaysTraining(TINY, walks(), walks(1)), TrainingSchedule(updates=6, check_every=3), folder)
    return str(folder / BEST)


@pytest.fixture(scope="module")
def social(checkpoint: str) -> SocialWays:
    return SocialWays(checkpoint)


# ---- the network


def test_it_has_the_sizes_of_the_report() -> None:
    generator, judge = Generator(SocialWaysConfig(), 0.4, (1.0, 1.0, 1.0)), Discriminator(SocialWaysConfig())
    assert tuple(generator.embed.weight.shape) == (128, 4)
    assert (generator.encoder.hidden_size, generator.decoder.input_size, generator.decoder.hidden_size) == (
        128,
        256,
        128,
    )
    assert [layer.out_features for layer in generator.say if hasattr(layer, "out_features")] == [64, 32, 2]
    assert (judge.observed.hidden_size, judge.future.hidden_size) == (128, 128)
    assert (judge.real.out_features, judge.codes.out_features) == (1, 2)
    slopes = {layer.negative_slope for net in (generator, judge) for layer in net.modules()
              if isinstance(layer, torch.nn.LeakyReLU)}  # fmt: skip
    assert slopes == {0.1}
    c = SocialWaysConfig()
    assert (c.observe, c.predict, c.batch, c.generator_rate, c.discriminator_rate, c.momentum) == (
        8,
        12,
        64,
        1e-3,
        1e-4,
        0.9,
    )
    assert (c.unrolling_steps, c.use_info_loss, c.info_weight, c.latent_codes, c.use_l2_loss, c.l2_weight) == (
        0, True, 0.5, 2, False, 0.5,
    )  # fmt: skip


def test_social_features_equal_a_slow_twin() -> None:
    rng = stream(2, "features")
    place, velocity = rng.normal(0.0, 3.0, (2, 5, 2)), rng.normal(0.0, 1.0, (2, 5, 2))
    found = social_features(torch.tensor(place), torch.tensor(velocity)).numpy()
    for scene in range(2):
        for i in range(5):
            for j in range(5):
                if i == j:
                    continue
                way = place[scene, j] - place[scene, i]
                turn = math.atan2(way[1], way[0]) - math.atan2(velocity[scene, i, 1], velocity[scene, i, 0])
                steps = np.linspace(0.0, 60.0, 60_001)[:, None]
                closest = np.linalg.norm(way + steps * (velocity[scene, j] - velocity[scene, i]), axis=1).min()
                distance, bearing, approach = found[scene, i, j]
                assert distance == pytest.approx(np.linalg.norm(way))
                assert math.cos(bearing - turn) == pytest.approx(1.0)
                assert approach == pytest.approx(closest, abs=2e-3)


def test_those_who_part_are_closest_now() -> None:
    place, velocity = torch.tensor([[[0.0, 0.0], [2.0, 0.0]]]), torch.tensor([[[-1.0, 0.0], [1.0, 0.0]]])
    assert social_features(place, velocity)[0, 0, 1, 2].item() == pytest.approx(2.0)


def sight(samples: Samples, model: SocialWaysTraining, scenes: list[int]) -> SceneInput:
    batch = samples.batch(np.array(scenes))
    return scene_input(batch.position[:, :8], batch.here, model.config, model.scales)[0]


def test_padding_and_company_of_other_scenes_change_nothing() -> None:
    samples = walks()
    model = SocialWaysTraining(TINY, samples, samples)
    together = samples.batch(np.arange(6))
    noise = torch.as_tensor(stream(0, "n").random((2, 6, together.here.shape[1], TINY.inputs)), dtype=torch.float32)
    with torch.no_grad():
        whole, _ = model.generator(sight(samples, model, [*range(6)]), noise, 12)
        for scene in range(6):
            people = int(together.here[scene].sum())
            alone, _ = model.generator(sight(samples, model, [scene]), noise[:, scene : scene + 1, :people], 12)
            torch.testing.assert_close(alone[:, 0], whole[:, scene, :, :people], rtol=1e-4, atol=1e-5)


def test_neighbours_matter_and_are_seen_where_they_are_predicted() -> None:
    samples = walks()
    model = SocialWaysTraining(dataclasses.replace(TINY, hidden=16), samples, samples)
    scene = int(np.argmax(np.diff(samples.first)))
    seen = sight(samples, model, [scene])
    people = seen.here.shape[1]
    noise = torch.full((1, 1, people, TINY.inputs), 0.5)
    plan = torch.full((1, 12, people, 2), math.nan)
    plan[0, :, 1] = torch.tensor([3.0, 0.0]) * torch.arange(1, 13)[:, None]
    with torch.no_grad():
        free, _ = model.generator(seen, noise, 12)
        bound, _ = model.generator(seen, noise, 12, plan)
        other, _ = model.generator(seen, torch.cat([noise[:, :, :1], noise[:, :, 1:] * 2.0], dim=2), 12)
    torch.testing.assert_close(bound[0, 0, :, 1], plan[0, :, 1])
    torch.testing.assert_close(free[0, 0, 0, 0], bound[0, 0, 0, 0])  # the first step is taken at once by all
    assert not torch.equal(free[0, 0, -1, 0], bound[0, 0, -1, 0])
    assert not torch.equal(free[0, 0, -1, 0], other[0, 0, -1, 0])


# ---- losses and updates


def test_the_variety_loss_takes_the_best_draw_of_each_person() -> None:
    true = torch.zeros(2, 3, 2)
    drawn = torch.stack([torch.full((2, 3, 2), 5.0), torch.full((2, 3, 2), 7.0)])
    drawn[1, 0] = 1.0  # the second draw is the best of the first person, the first of the second
    assert variety_loss(drawn, true).item() == pytest.approx((2.0 + 50.0) / 2.0)


@pytest.mark.parametrize("values", sample([
    {}, {"unrolling_steps": 2}, {"use_l2_loss": True}, {"use_variety_loss": True}, {"adversarial": "least-squares"},
    {"use_info_loss": False}, {"social": False}, {"frame": "world", "residual": False}, {"clip": 1.0, "decay": True},
    {"mixed": True, "use_variety_loss": True}, {"average": 0.9, "mirror": True, "reverse": True, "scale_sd": 0.3},
], 3))  # fmt: skip
def test_every_setting_trains(values: dict[str, object]) -> None:
    done = train(
        SocialWaysTraining(dataclasses.replace(TINY, **values), walks(), walks(1)),
        TrainingSchedule(updates=3, check_every=3),
    )
    losses = set(done.rows[-1]) - {"update", "epoch", "seconds", "ade", "fde"}
    wanted = {"discriminator", "adversarial", "info", "l2", "variety"}
    for name, field in (("info", "use_info_loss"), ("l2", "use_l2_loss"), ("variety", "use_variety_loss")):
        if not getattr(dataclasses.replace(TINY, **values), field):
            wanted.discard(name)
    assert losses == wanted


def test_mixed_precision_draws_nearly_the_same_in_full_numbers() -> None:
    model = SocialWaysTraining(TINY, walks(), walks(1))
    lesson = model._to_tensors(walks().batch(np.arange(4)))
    noise = torch.rand(3, *lesson.scored.shape, TINY.inputs)
    plain, _ = model._draw(lesson, noise)
    model.config = dataclasses.replace(TINY, mixed=True)
    mixed, states = model._draw(lesson, noise)
    assert mixed.dtype == states.dtype == torch.float32
    assert 0.0 < (mixed - plain).abs().max() < 0.05


def test_looking_ahead_leaves_no_trace_in_the_discriminator() -> None:
    """One update with 4 steps ahead leaves the discriminator and its optimiser as one with none does."""
    ends = []
    for steps in (0, 4):
        model = SocialWaysTraining(dataclasses.replace(TINY, unrolling_steps=steps), walks(), walks(1))
        model.update(model.batches(stream(0, "o"))[0], stream(0, "u"), 0, 1)
        ends.append(copy.deepcopy(model.state()))
    for name in ("discriminator", "of_discriminator"):
        assert str(ends[0][name]) == str(ends[1][name])
    assert str(ends[0]["generator"]) != str(ends[1]["generator"])


def test_a_killed_training_ends_with_the_same_bytes(tmp_path: Path) -> None:
    config = dataclasses.replace(TINY, unrolling_steps=1, average=0.5, use_variety_loss=True, mirror=True)
    plan = TrainingSchedule(updates=7, check_every=3, keep_every=1, seed=5)
    train(SocialWaysTraining(config, walks(), walks(1), 5), plan, tmp_path / "whole")

    def stop(done: int, total: int) -> None:
        if done == 4:
            raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        train(SocialWaysTraining(config, walks(), walks(1), 5), plan, tmp_path / "killed", tick=stop)
    train(SocialWaysTraining(config, walks(), walks(1), 5), plan, tmp_path / "killed", resume=True)
    assert (tmp_path / "whole" / BEST).read_bytes() == (tmp_path / "killed" / BEST).read_bytes()
    one, other = (load_checkpoint(tmp_path / name / LAST)["state"] for name in ("whole", "killed"))
    assert str(one) == str(other)


def test_it_learns_straight_walks() -> None:
    config = dataclasses.replace(
        TINY, use_variety_loss=True, variety_weight=5.0, residual=False, generator_rate=1e-2, social=False, batch=32
    )
    done = train(SocialWaysTraining(config, walks(0, 30), walks(1, 10)), TrainingSchedule(updates=40, check_every=10))
    assert min(row["ade"] for row in done.rows) < 0.7 * done.rows[0]["ade"]


def test_scales_come_from_training_data_alone_and_rows_must_fit() -> None:
    one, other = SocialWaysTraining(TINY, walks(), walks(1)), SocialWaysTraining(TINY, walks(), walks(2))
    assert one.scales == other.scales != SocialWaysTraining(TINY, walks(2), walks(1)).scales
    with pytest.raises(InputError, match=r"requires 8 \+ 12 rows, walks has 8 \+ 10"):
        SocialWaysTraining(TINY, walks(0, 12, 18), walks())


def test_scenes_run_backwards_keep_who_is_known() -> None:
    samples = walks()
    scenes = samples.batch(np.arange(5))
    config = dataclasses.replace(TINY, reverse=True, mirror=True, scale_sd=0.2)
    turned = [augment(scenes, 8, config, stream(seed, "a")) for seed in range(8)]
    ratios = [float(np.ptp(item.position[0, :, 0, 0]) / np.ptp(scenes.position[0, :, 0, 0])) for item in turned]
    assert len(set(np.round(ratios, 6))) == 8
    assert all(0.4 <= ratio <= 2.5 for ratio in ratios)
    assert all(np.array_equal(item.scored, scenes.scored) for item in turned)


def test_wrong_settings_are_said(monkeypatch: pytest.MonkeyPatch) -> None:
    with pytest.raises(InputError, match="unknown adversarial 'cross_entropy', did you mean 'cross-entropy'"):
        SocialWaysConfig(adversarial="cross_entropy")
    with pytest.raises(InputError, match="momentum = 1.0 must be below 1"):
        SocialWaysConfig(momentum=1.0)
    with pytest.raises(InputError, match="no setting 'hiden', did you mean 'hidden'"):
        config_of({"hiden": 3})
    with pytest.raises(InputError, match="unknown preset 'reprt', did you mean 'report'"):
        preset("reprt")
    with pytest.raises(InputError, match="has no attribute 'unroling-steps', did you mean 'unrolling-steps'"):
        learner("report", {"unroling-steps": "5"}, walks(), walks(), 0, "cpu")
    assert (
        learner("report", {"unrolling-steps": "5", "hidden": "8"}, walks(), walks(), 0, "cpu").config.unrolling_steps
        == 5
    )
    with pytest.raises(InputError, match="unknown device 'gpu'; known are cpu, cuda"):
        torch_device("gpu")
    monkeypatch.setattr(torch.cuda, "is_available", lambda: False)
    with pytest.raises(InputError, match="'cuda' does not exist: torch finds 0 CUDA devices; use cpu"):
        torch_device("cuda")


# ---- in use


def test_predict_has_the_meaning_of_the_report(checkpoint: str) -> None:
    network = SocialWaysNetwork.load(checkpoint)
    seen = walks().position[:3, :8]
    noise = stream(0, "noise").random((3, TINY.inputs))
    ahead = network.predict(seen, noise, 30)
    assert ahead.shape == (3, 30, 2)
    assert np.array_equal(network.predict(seen, noise, 12), ahead[:, :12])
    same = network.predict(seen, noise[0], 5)
    assert np.array_equal(same, network.predict(seen, np.repeat(noise[:1], 3, axis=0), 5))
    assert not np.array_equal(network.predict(seen, 1.0 - noise, 12), ahead[:, :12])
    assert network.predict(seen[:1], noise[0], 4).shape == (1, 4, 2)
    assert network.predict(seen[:0], noise[0], 4).shape == (0, 4, 2)
    assert network.predict(seen[:, -2:], noise, 4).shape == (3, 4, 2)
    for wrong, why in (((seen[0], noise[0], 4), "finite"), ((seen, noise[:, :2], 4), "noise has shape"),
                       ((seen, noise + 1.0, 4), "from 0 to 1"), ((seen, noise, 0), "at least 1")):  # fmt: skip
        with pytest.raises(InputError, match=why):
            network.predict(*wrong)


def predicted(social: SocialWays, past: Windows, steps: int = 12, samples: int = 3) -> np.ndarray:
    return social.predict(past, steps, samples, stream(5, "test")).position


def test_it_predicts_any_number_of_people(social: SocialWays, crowd: Maker, windows: Maker) -> None:
    past = crowd(holes=0.2)
    forecast = social.predict(past, 25, 3)
    assert forecast.position.shape == (4, 3, 25, 7, 2)
    assert np.array_equal(forecast.valid, past.present[:, -1])
    assert np.all(np.moveaxis(forecast.position, 3, 1)[~forecast.valid] == 0.0)
    assert forecast.predictor.startswith("social-ways(")
    for made in (np.zeros((2, 8, 0, 2)), np.zeros((0, 8, 3, 2)), np.full((2, 8, 3, 2), np.nan), np.zeros((1, 1, 1, 2))):
        assert social.predict(windows(made), 4, 2).position.shape == (len(made), 2, 4, made.shape[2], 2)


def test_nothing_but_what_was_observed_is_read(social: SocialWays, crowd: Maker) -> None:
    past = crowd(holes=0.2)
    for array in (past.position, past.present, past.robot, past.scored, past.id, past.frame):
        array.setflags(write=False)
    hidden = np.where(past.present[..., None], past.position, 1e9)
    other = dataclasses.replace(past, scored=~past.scored, position=hidden)
    assert np.array_equal(predicted(social, past), predicted(social, other))


def test_garbage_in_the_future_changes_nothing(social: SocialWays, recorded: Callable[[str], object]) -> None:
    tracks = recorded("biwi_hotel")
    past, _ = tracks.windows(observe=8, predict=12, protocol="all")  # type: ignore[attr-defined]
    now = int(past.frame[40, -1])
    later = tracks.frame > now  # type: ignore[attr-defined]
    noise = stream(1, "garbage").normal(0.0, 1e3, (2, int(later.sum())))
    x, y = tracks.x.copy(), tracks.y.copy()  # type: ignore[attr-defined]
    x[later], y[later] = noise
    spoilt, _ = dataclasses.replace(tracks, x=x, y=y).windows(observe=8, predict=12, protocol="all")  # type: ignore[type-var]
    known = past.frame[:, -1] <= now
    assert np.array_equal(predicted(social, past[known]), predicted(social, spoilt[known]))


def test_a_window_alone_or_padded_is_predicted_as_in_a_batch_bit_for_bit(social: SocialWays, crowd: Maker) -> None:
    past = crowd(3, holes=0.2)
    together = predicted(social, past)
    rng = stream(5, "test")
    for window in range(len(past)):
        alone = social.predict(past[window : window + 1], 12, 3, rng)
        assert np.array_equal(alone.position[0], together[window])
    grown = {name: np.pad(getattr(past, name), [(0, 0), (0, 0), (0, 2), (0, 0)][: getattr(past, name).ndim])
             for name in ("position", "present")}  # fmt: skip
    grown |= {name: np.pad(getattr(past, name), [(0, 0), (0, 2)]) for name in ("scored", "robot", "id")}
    padded = predicted(social, dataclasses.replace(past, **grown))
    assert np.array_equal(padded[..., :7, :], together)


def test_more_samples_begin_with_the_same_ones(social: SocialWays, crowd: Maker) -> None:
    few, many = predicted(social, crowd(), samples=2), predicted(social, crowd(), samples=5)
    np.testing.assert_allclose(few, many[:, :2], atol=1e-5)
    assert not np.array_equal(many[:, 0], many[:, 1])


def test_forecasts_shift_and_turn_with_the_world(social: SocialWays, crowd: Maker) -> None:
    past = crowd(2, holes=0.1)
    turn = np.array([[math.cos(2.1), math.sin(2.1)], [-math.sin(2.1), math.cos(2.1)]])
    there = np.where(past.present[..., None], past.position @ turn + np.array([300.0, -50.0]), 0.0)
    one, other = predicted(social, past), predicted(social, dataclasses.replace(past, position=there))
    who = np.broadcast_to(past.present[:, None, None, -1], one.shape[:-1])
    np.testing.assert_allclose(other[who], one[who] @ turn + np.array([300.0, -50.0]), atol=2e-4)


def test_a_robot_with_a_plan_walks_it(social: SocialWays, crowd: Maker) -> None:
    past = crowd(1)
    plan = np.stack([np.linspace(0.0, 3.0, 6), np.zeros(6)], axis=1)
    ahead = social.predict(past.with_plans({1: plan}), 6, 2).position
    np.testing.assert_allclose(ahead[0, :, :, 1], np.broadcast_to(plan, (2, 6, 2)))


def test_what_does_not_fit_is_said(social: SocialWays, checkpoint: str, crowd: Maker, tmp_path: Path) -> None:
    with pytest.raises(InputError, match="requires time steps of 0.4 s, made has 0.1 s; resample with --step 0.4"):
        social.predict(dataclasses.replace(crowd(), dt=0.1), 3)
    with pytest.raises(InputError, match="requires tracks in m, made is in px"):
        social.predict(dataclasses.replace(crowd(), units="px"), 3)
    with pytest.raises(InputError, match="cannot be read .No such file or directory.; give a file of crowdbot train"):
        SocialWays(str(tmp_path / "none.npz"))
    other = tmp_path / "other.npz"
    kept = load_checkpoint(checkpoint)
    save_checkpoint(other, "social-ways", {**kept, "config": {**kept["config"], "hidden": 9}})
    with pytest.raises(InputError, match="do not fit this crowdbot .*train again"):
        SocialWays(str(other)).predict(crowd(), 3)
    save_checkpoint(other, "anchors", kept)
    with pytest.raises(InputError, match="is a checkpoint of anchors, not of social-ways"):
        SocialWays(str(other)).predict(crowd(), 3)


def test_without_torch_it_says_what_to_install(checkpoint: str, crowd: Maker, monkeypatch: pytest.MonkeyPatch) -> None:
    import sys

    from crowdbot.core import MissingExtra

    module._network.cache_clear()
    monkeypatch.setitem(sys.modules, "torch", None)
    with pytest.raises(MissingExtra, match=r"pip install 'crowdbot\[learn\]'"):
        SocialWays(checkpoint).predict(crowd(), 3)
