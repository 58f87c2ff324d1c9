"""Training of the anchor network: it learns, it repeats itself, it goes on after a stop, and it sees what it should."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
import torch

from crowdbot.core import InputError, stream
from crowdbot.data import Trajectories
from crowdbot.prediction.anchor_net.agent_frame import AGENT_FEATURES, NEAR, NEIGHBOR_FEATURES, PREDICTED_ROWS
from crowdbot.prediction.anchor_net.forward_pass import network_output
from crowdbot.prediction.anchor_net.own_weights import NEEDED
from crowdbot.prediction.anchor_net.training import (
    PRESETS,
    AnchorNetTraining,
    AnchorTraining,
    learner,
    network,
    outputs,
    shapes_of,
)
from crowdbot.prediction.anchor_net.training_data import (
    NO_AUGMENTATION,
    Augmentation,
    TrainingSet,
    make_batch,
    reverse_time,
    training_set,
    training_set_of,
)
from crowdbot.prediction.training.loop import TrainingSchedule, train
from crowdbot.prediction.training.samples import Samples
from crowdbot.prediction.training.torch_backend import torch_threads
from training_crowds import robot_encounters, simulated_crowds

TINY = AnchorTraining(people=32, width=16, social=8, warm=5)


@pytest.fixture(scope="module")
def material(recorded: Callable[[str], Trajectories]) -> TrainingSet:
    return training_set([recorded("biwi_hotel")])


def test_everyone_of_the_protocol_is_learned_from_twice(
    material: TrainingSet, recorded: Callable[[str], Trajectories]
) -> None:
    assert len(material) == 2 * 1197
    again = reverse_time(reverse_time(recorded("biwi_hotel")))
    assert np.array_equal(again.x, recorded("biwi_hotel").x)


def test_without_variation_a_batch_is_what_happened(material: TrainingSet) -> None:
    rows = np.arange(50)
    plain = make_batch(material, rows, NO_AUGMENTATION, stream(0))
    assert plain.own.shape == (50, AGENT_FEATURES)
    assert plain.company.shape == (50, NEAR, NEIGHBOR_FEATURES)
    assert np.array_equal(plain.there, material.people.there[:50])
    past = material.people.past[:50]
    step = past[:, -1] - past[:, -2]
    straight = material.ahead[:50] - step[:, None] * np.arange(1, PREDICTED_ROWS + 1)[:, None]
    np.testing.assert_allclose(np.linalg.norm(plain.missed, axis=2), np.linalg.norm(straight, axis=2), atol=1e-12)


def test_every_variation_changes_what_is_seen(material: TrainingSet) -> None:
    rows = np.arange(200)
    plain = make_batch(material, rows, NO_AUGMENTATION, stream(0))
    for name in ("mirror", "scale", "turn", "jitter", "late", "switched", "unseen"):
        seen = make_batch(material, rows, dataclasses.replace(NO_AUGMENTATION, **{name: 0.9}), stream(0))
        assert not np.array_equal(seen.own, plain.own) or not np.array_equal(seen.company, plain.company), name
        assert np.isfinite(seen.own).all()
        assert np.isfinite(seen.company).all()
    drifting = make_batch(material, rows, dataclasses.replace(NO_AUGMENTATION, correlated=1.0, noise=0.1), stream(0))
    assert not np.array_equal(drifting.own, plain.own)
    holes = make_batch(material, rows, dataclasses.replace(NO_AUGMENTATION, holes=1.0, hole=0.5), stream(0))
    assert 0.4 < holes.own[:, -7:].mean() < 0.75
    planned = make_batch(material, rows, dataclasses.replace(NO_AUGMENTATION, planned=1.0), stream(0))
    assert planned.company[..., 9].sum() > 0.0
    assert plain.company[..., 9].sum() == 0.0


def test_bends_are_made_of_six_numbers(material: TrainingSet) -> None:
    shapes = shapes_of(material)
    assert shapes["basis"].shape == (6, 24)
    np.testing.assert_allclose(shapes["basis"] @ shapes["basis"].T, np.eye(6), atol=1e-9)
    missed = make_batch(material, np.arange(len(material)), NO_AUGMENTATION, stream(0)).missed.reshape(-1, 24)
    rest = missed - missed @ shapes["basis"].T @ shapes["basis"]
    assert np.linalg.norm(rest.reshape(-1, 12, 2), axis=2).mean() < 0.04


def test_predicting_without_torch_gives_what_was_trained(material: TrainingSet) -> None:
    layers = network(TINY)
    shown = make_batch(material, np.arange(40), Augmentation(), stream(1))
    with torch.no_grad():
        inside = outputs(
            layers, torch.tensor(shown.own).float(), torch.tensor(shown.company).float(), torch.tensor(shown.there)
        ).numpy()
    numbers = {}
    for name, value in layers.state_dict().items():
        array = value.numpy().astype(np.float64)
        numbers[name.replace(".", "_")] = array.T.copy() if name.endswith(".weight") else array
    np.testing.assert_allclose(network_output(numbers, shown.own, shown.company, shown.there), inside, atol=1e-5)


def best_of_twenty(numbers: dict[str, np.ndarray], material: TrainingSet) -> float:
    """Return the mean error [m] of the best future of everyone."""
    own, company, there, missed = make_batch(material, np.arange(len(material)), NO_AUGMENTATION, stream(0))
    found = network_output(numbers, own, company, there)[:, :120].reshape(-1, 20, 6)
    bend = (numbers["centres"] + found * numbers["spread"]) @ numbers["basis"]
    away = bend.reshape(-1, 20, 12, 2) - missed[:, None]
    return float(np.linalg.norm(away, axis=3).mean(axis=2).min(axis=1).mean())


def trained(material: TrainingSet, how: AnchorTraining, updates: int, folder: Path | None = None) -> AnchorNetTraining:
    model = AnchorNetTraining(how, material, material)
    with torch_threads():
        train(model, TrainingSchedule(updates, check_every=updates, keep_every=100, seed=how.seed), folder, resume=True)
    return model


def test_training_learns_repeats_itself_and_goes_on_after_a_stop(material: TrainingSet, tmp_path: Path) -> None:
    how = dataclasses.replace(TINY, average=0.9, variation=NO_AUGMENTATION)
    model = trained(material, how, 200)
    whole = model.numbers()
    still = whole | {name: 0.0 * whole[name] for name in ("out_weight", "out_bias")}
    assert best_of_twenty(whole, material) < 0.99 * best_of_twenty(still, material)
    assert model.check()["ade"] == pytest.approx(best_of_twenty(whole, material))

    class Stopped(Exception):
        pass

    def stop(update: int, total: int) -> None:
        if update == 150:
            raise Stopped

    schedule = TrainingSchedule(200, check_every=200, keep_every=100)
    with pytest.raises(Stopped), torch_threads():
        train(AnchorNetTraining(how, material, material), schedule, tmp_path, tick=stop)
    again = trained(material, how, 200, tmp_path).numbers()
    assert whole.keys() == again.keys()
    assert all(np.array_equal(whole[name], again[name]) for name in whole)
    with pytest.raises(InputError, match="contains a training with other settings"):
        trained(material, dataclasses.replace(how, choice=0.2), 200, tmp_path)


def test_a_training_on_a_balanced_mixture_repeats_itself() -> None:
    crowds = Samples.concatenate([Samples.from_windows(*t.windows(), t.name) for t in simulated_crowds(2)[:4]])
    met = Samples.concatenate([Samples.from_windows(*pair, name) for name, pair in robot_encounters(5).items()])
    parts = [crowds.limit(150), met.limit(100)]
    assert [part.people for part in parts] == [pytest.approx(150, rel=0.3), pytest.approx(100, rel=0.1)]
    assert crowds.limit(10**6) is crowds
    mixed = training_set_of(Samples.concatenate(parts))
    how = dataclasses.replace(PRESETS["general"], people=32, width=16, social=8, warm=5)
    one, other = (trained(mixed, how, 20).weights() for _ in range(2))
    assert one.keys() == other.keys()
    assert {"reach", "line_share", "share"} <= set(one)
    assert all(np.array_equal(one[name], other[name]) for name in one)


def test_the_learning_rate_rises_linearly_and_falls_along_a_cosine(material: TrainingSet) -> None:
    model, shares = AnchorNetTraining(TINY, material, material), []
    for number in (0, 1, 4, 5, 10, 15, 20):
        model.update(None, stream(0), number, 25)
        shares.append(model.optimiser.param_groups[0]["lr"] / TINY.rate)
    # 5 warm-up updates, then 0, 1/4, 1/2 and 3/4 of the other 20
    slow = math.sqrt(2.0) / 4.0
    assert shares == pytest.approx([0.2, 0.4, 1.0, 1.0, 0.5 + slow, 0.5, 0.5 - slow])


def test_torch_uses_the_given_number_of_threads_inside_the_context_only() -> None:
    before = torch.get_num_threads()
    with torch_threads(2):
        assert torch.get_num_threads() == 2
        with torch_threads():
            assert torch.get_num_threads() == 1
        assert torch.get_num_threads() == 2
    assert torch.get_num_threads() == before


def test_calibrated_numbers_are_complete(material: TrainingSet) -> None:
    numbers = AnchorNetTraining(TINY, material, material).weights()
    assert set(NEEDED) <= set(numbers)
    for name in ("temperature", "widening"):
        assert numbers[name].shape == (6,)
        assert np.all((numbers[name] > 0.04) & (numbers[name] < 5.0))


def test_windows_of_any_recording_give_the_same_people(
    material: TrainingSet, recorded: Callable[[str], Trajectories]
) -> None:
    samples = Samples.from_windows(*recorded("biwi_hotel").windows(), "hotel")
    plain, both = training_set_of(samples, reverse=False), training_set_of(samples)
    forward = training_set([recorded("biwi_hotel")], reverse=False)
    assert (len(plain), len(both)) == (1197, 2 * 1197)
    for item, other in ((plain.ahead, forward.ahead), (plain.people.past, forward.people.past)):
        rows = [np.unique(array.reshape(len(array), -1).round(6), axis=0) for array in (item, other)]
        assert np.array_equal(*rows)
    assert plain.people.there.sum() == forward.people.there.sum()


def test_what_the_command_line_says_is_read(recorded: Callable[[str], Trajectories]) -> None:
    samples = Samples.from_windows(*recorded("biwi_hotel").windows(), "hotel")
    model = learner(None, {"width": "16", "social": "8", "scale": "0.1"}, samples, samples, 3, "cpu")
    assert (model.config.width, model.config.variation.scale, model.config.seed) == (16, 0.1, 3)
    with pytest.raises(InputError, match="unknown settings 'shiped', did you mean"):
        learner("shiped", {}, samples, samples, 0, "cpu")
    pixels = dataclasses.replace(samples, units="px")
    with pytest.raises(InputError, match="anchor-net requires 8 [+] 12 rows of 0.4 s in metres, hotel has"):
        learner(None, {}, pixels, samples, 0, "cpu")


def test_what_cannot_be_learned_from_is_one_sentence(recorded: Callable[[str], Trajectories]) -> None:
    with pytest.raises(InputError, match="there is no training recording"):
        training_set([])
    fast = recorded("biwi_hotel").resample(0.2)
    with pytest.raises(InputError, match="steps of 0.2 s in m; training requires 0.4 s and metres"):
        training_set([fast])
