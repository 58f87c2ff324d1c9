"""The learned predictor: what its parts compute, what it promises about joint futures, walls, plans and draws."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot.core import DataError, InputError, stream
from crowdbot.data import Trajectories, Windows
from crowdbot.evaluation import score_predictor
from crowdbot.prediction import AnchorNet, Anchors, ConstantVelocity, SampledConstantVelocity
from crowdbot.prediction.anchor_net.agent_frame import SPEED_CLASSES, agent_histories
from crowdbot.prediction.anchor_net.forward_pass import attend, dense
from crowdbot.prediction.anchor_net.own_weights import NEEDED
from crowdbot.prediction.joint_kernels import assign_futures, first_crossing, separate_paths
from crowdbot.prediction.pretrained_weights import FOLDS, load_pretrained

Maker = Callable[..., Windows]
KINDS = (AnchorNet(), AnchorNet(sample="draws"))
both = pytest.mark.parametrize("net", KINDS, ids=lambda net: net.sample)


def walking(windows: Maker, *people: tuple[float, float, float, float], **more: object) -> Windows:
    """People who walk evenly: x and y now [m], and their velocity [m/s]."""
    back = 0.4 * np.arange(-7, 1)[:, None]
    return windows(np.stack([np.array(p[:2]) + back * np.array(p[2:]) for p in people], axis=1)[None], **more)


def nearest(place: np.ndarray) -> np.ndarray:
    """Return how near two people come in each joint future of one window ``[K, T, 2, 2]``."""
    return np.linalg.norm(place[:, :, 0] - place[:, :, 1], axis=-1).min(axis=1)


def test_layers_are_those_of_the_field() -> None:
    rng = stream(1, "layer")
    x, weight, bias = rng.normal(size=(13, 37)), rng.normal(size=(37, 9)), rng.normal(size=9)
    np.testing.assert_allclose(dense(x, weight, bias, False), x @ weight + bias, atol=1e-12)
    np.testing.assert_allclose(dense(x, weight, bias, True), np.maximum(x @ weight + bias, 0.0), atol=1e-12)
    every = dense(x, weight, bias, True)
    assert all(np.array_equal(dense(x[n : n + 1], weight, bias, True)[0], every[n]) for n in range(13))


def test_attention_is_a_softmax_over_who_is_there() -> None:
    rng = stream(2, "attention")
    query, near, there = rng.normal(size=(6, 4)), rng.normal(size=(6, 3, 4)), rng.random((6, 3)) < 0.5
    nobody, alone = rng.normal(size=4), rng.normal(size=4)
    there[0] = False
    found = attend(query, near, there, nobody, alone)
    for n in range(6):
        keys = np.concatenate([near[n][there[n]], nobody[None]])
        values = np.concatenate([near[n][there[n]], alone[None]])
        weight = np.exp(keys @ query[n] / 2.0)
        np.testing.assert_allclose(found[n], weight @ values / weight.sum(), atol=1e-12)


@settings(max_examples=15, deadline=None)
@given(seed=st.integers(0, 10_000))
def test_arranged_futures_collide_less_and_everyone_keeps_all(seed: int) -> None:
    rng = stream(seed, "arrange")
    path = rng.normal(0.0, 1.5, (5, 1, 1, 2)) + np.cumsum(rng.normal(0.0, 0.3, (5, 8, 12, 2)), axis=2)
    choice = assign_futures(path, np.full(len(path), 0.2), 0.3, 8)
    assert np.array_equal(np.sort(choice, axis=1), np.tile(np.arange(8), (5, 1)))

    def collisions(order: np.ndarray) -> int:
        taken = np.take_along_axis(path, order[:, :, None, None], axis=1)
        away = np.linalg.norm(taken[:, None] - taken[None], axis=-1).min(axis=-1)
        return int((away < 0.4).sum() - 5 * 8) // 2

    assert collisions(choice) <= collisions(np.tile(np.arange(8), (5, 1)))


def test_who_comes_too_near_gives_way_evenly() -> None:
    step = np.arange(1.0, 13.0)[:, None]
    path = np.stack([np.array([0.5, 0.0]) * step, np.array([6.0, 0.1]) - np.array([0.5, 0.0]) * step])
    moved = separate_paths(path, np.ones(2, dtype=np.int64), np.full(2, 0.15), 12)
    assert np.linalg.norm(moved[0] - moved[1], axis=1).min() >= 0.3
    np.testing.assert_allclose(moved[0] - path[0], path[1] - moved[1], atol=1e-12)
    held = separate_paths(path, np.array([0, 1]), np.full(2, 0.15), 12)
    assert np.array_equal(held[0], path[0])
    assert np.linalg.norm(held[0] - held[1], axis=1).min() >= 0.3
    head_on = path * np.array([1.0, 0.0])
    assert (
        np.linalg.norm(
            np.subtract(*separate_paths(head_on, np.ones(2, dtype=np.int64), np.full(2, 0.15), 12)), axis=1
        ).min()
        >= 0.3
    )


def test_neighbors_are_the_12_nearest_in_order_of_distance(windows: Maker) -> None:
    rank = np.arange(1, 15)
    away = 0.5 * rank[:, None] * np.stack([np.cos(2.4 * rank), np.sin(2.4 * rank)], axis=1)
    others = ((x, y, 1.0, 0.0) for x, y in away[stream(3, "order").permutation(14)])
    people, _, slot = agent_histories(walking(windows, (0.0, 0.0, 1.0, 0.0), *others))
    assert slot[0] == 0
    assert people.there[0].all()
    np.testing.assert_allclose(people.near[0], away[:12], atol=1e-12)


def test_paths_through_a_wall_are_found() -> None:
    path = np.array([[[[1.0, 0.0], [2.0, 0.0]], [[0.0, 1.0], [0.0, 2.0]]]])
    found = first_crossing(np.zeros((1, 2)), path, np.array([[1.5, -1.0]]), np.array([[1.5, 1.0]]))
    assert found.tolist() == [[1, 2]]


@both
def test_likely_futures_of_two_who_would_collide_keep_apart(net: AnchorNet, windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.3, 0.0), (4.0, 0.05, -1.3, 0.0))
    assert nearest(ConstantVelocity().predict(past, 12).position[0]) < 0.2
    for samples in (1, 20):
        joint = net.predict(past, 12, samples, stream(1)).position[0]
        assert np.all(nearest(joint) > 0.2)
    loose = dataclasses.replace(net, contact=0.0).predict(past, 12, 20, stream(1)).position[0]
    assert np.any(nearest(loose) < 0.2)


def test_joint_futures_are_everyones_own_in_another_order(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.3, 0.0), (0.0, 30.0, 1.3, 0.2), (4.0, 0.05, -1.3, 0.0))
    own = AnchorNet(contact=0.0).predict(past, 12, 20).position[0]
    joint = AnchorNet().predict(past, 12, 20).position[0]
    far, also_far = (np.array(sorted(item[:, :, 1].reshape(20, -1).tolist())) for item in (own, joint))
    assert np.array_equal(far, also_far)
    away = np.linalg.norm(own[:, None] - joint[None], axis=-1).max(axis=2).min(axis=1)
    assert np.all(away < 0.3)


def test_futures_of_walkers_are_combined_by_anchor_if_all_are_asked_for(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.3, 0.0), (0.0, 30.0, 1.3, 0.0))  # the second one sees nobody near
    net = AnchorNet("zara1", contact=0.0)
    side = net.predict(past, 12, 20).position[0, :, -1] - past.position[0, -1]
    assert np.corrcoef(side[:, 0, 1], side[:, 1, 1])[0, 1] > 0.8  # both turn to the same side in the same future
    few = net.predict(past, 12, 19).position[0, 0, -1] - past.position[0, -1]
    modes = net.modes(past)
    np.testing.assert_allclose(few, modes.path[:, 0, -1], atol=1e-9)  # the most probable ones come first


def test_weights_of_one_person_are_the_own_probabilities(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.0, 0.5))
    found = AnchorNet().predict(past, 12, 20)
    modes = AnchorNet().modes(past)
    np.testing.assert_allclose(found.weight, modes.probability, atol=1e-12)
    np.testing.assert_allclose(found.position[0, :, :, 0], modes.path[0], atol=1e-12)
    assert np.all(np.diff(modes.probability[0]) <= 0.0)
    np.testing.assert_allclose(AnchorNet().predict(past, 12).position[0, 0, :, 0], modes.single[0], atol=1e-12)


def test_the_set_has_twenty_and_draws_as_many_as_asked_for(crowd: Maker) -> None:
    past = crowd()
    assert AnchorNet().predict(past, 12, 50).samples == 20
    many = AnchorNet(sample="draws").predict(past, 12, 50, stream(4))
    few = AnchorNet(sample="draws").predict(past, 12, 3, stream(4))
    assert many.samples == 50
    assert np.array_equal(few.position, many.position[:, :3])
    assert not np.array_equal(many.position[:, 0], many.position[:, 1])
    assert AnchorNet(sample="draws").predict(past, 12, 1, stream(4)).samples == 1


def test_draws_follow_the_mixture(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.0, 0.5))
    modes = AnchorNet().modes(past)
    drawn = AnchorNet(sample="draws").predict(past, 12, 2000, stream(9)).position[0, :, :, 0]
    mean = np.einsum("k,ktc->tc", modes.probability[0], modes.path[0])
    error = drawn.std(axis=0) / np.sqrt(2000)
    assert np.all(np.abs(drawn.mean(axis=0) - mean) < 5.0 * error + 1e-9)


@both
@settings(max_examples=6, deadline=None)
@given(seed=st.integers(0, 1000))
def test_a_window_alone_is_predicted_as_in_a_batch(net: AnchorNet, crowd: Maker, seed: int) -> None:
    past = crowd(seed, W=5, A=23, holes=0.3)
    together = net.predict(past, 12, 20, stream(5))
    rng = stream(5)
    for window in range(len(past)):
        alone = net.predict(past[window : window + 1], 12, 20, rng)
        assert np.array_equal(alone.position[0], together.position[window])
        assert np.array_equal(alone.weight[0], together.weight[window])


@both
def test_futures_through_a_wall_are_improbable_and_end_before_it(net: AnchorNet, windows: Maker) -> None:
    free = walking(windows, (0.0, 0.0, 1.3, 0.0))
    ends = AnchorNet().modes(free).path[0, :, -1]
    before = {x: np.array([[x, -50.0], [x + 0.2, -50.0], [x + 0.2, 50.0], [x, 50.0]]) for x in (1.0, 5.0, 1000.0)}
    assert 0 < (ends[:, 0] > 5.0).sum() < 20
    for x, wall in before.items():
        walled = dataclasses.replace(free, walls=(wall,))
        for samples in (1, 20):
            assert net.predict(walled, 12, samples, stream(1)).position[..., 0].max() < x
    through = ends[:, 0] > 5.0
    plain, known = AnchorNet().modes(free), AnchorNet().modes(dataclasses.replace(free, walls=(before[5.0],)))
    stayed = known.path[0, :, -1, 0] == known.path[0, :, -2, 0]
    share = plain.probability[0][through].sum()
    assert known.probability[0][stayed].sum() == pytest.approx(0.02 * share / (0.02 * share + 1.0 - share))
    assert np.all(np.diff(known.probability[0]) <= 0.0)


def test_the_plan_of_a_robot_is_kept_and_moves_people(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.3, 0.0), (5.0, 0.3, 0.0, 0.0), robot=np.array([[False, True]]))
    coming = np.stack([5.0 - 0.5 * np.arange(1, 13), np.full(12, 0.02)], axis=1)
    staying = np.tile([5.0, 30.0], (12, 1))
    found = {}
    for name, plan in (("coming", coming), ("staying", staying)):
        for samples in (1, 20):
            joint = AnchorNet().predict(past.with_plans({1: plan}), 12, samples).position[0]
            assert np.allclose(joint[:, :, 1], plan)
            found[name, samples] = joint[:, :, 0]
    assert not np.array_equal(found["coming", 1], found["staying", 1])
    assert np.all(np.linalg.norm(found["coming", 20] - coming, axis=-1).min(axis=1) > 0.2)


@both
def test_what_does_not_fit_is_said_and_a_baseline_answers(net: AnchorNet, crowd: Maker) -> None:
    slow = dataclasses.replace(crowd(), dt=1.6)
    with pytest.warns(UserWarning, match="anchor-net: made has time steps of 1.6 s.*constant-velocity is used instead"):
        one = net.predict(slow, 12)
    assert np.array_equal(one.position, ConstantVelocity().predict(slow, 12).position)
    with pytest.warns(UserWarning, match="sampled-constant-velocity is used instead"):
        many = net.predict(slow, 12, 4, stream(1))
    assert np.array_equal(many.position, SampledConstantVelocity().predict(slow, 12, 4, stream(1)).position)
    with pytest.raises(InputError, match="anchor-net: "):
        net.modes(dataclasses.replace(crowd(), units="px"))


def test_the_place_decides_which_weights_are_taken(crowd: Maker) -> None:
    assert "not named after a training place" in AnchorNet().note(crowd())
    assert AnchorNet().note(dataclasses.replace(crowd(), source="biwi_eth.txt")) == ""
    assert AnchorNet("eth").note(crowd()) == ""
    assert "steps of 2 s" in AnchorNet("eth").note(dataclasses.replace(crowd(), dt=2.0))
    assert ConstantVelocity().note(crowd()) == ""


def test_own_weights_are_read_and_wrong_ones_are_one_sentence(crowd: Maker, tmp_path: Path) -> None:
    numbers = load_pretrained("anchor-net", "open")
    np.savez(tmp_path / "own.npz", **numbers)
    own = AnchorNet(file=str(tmp_path / "own.npz"))
    assert np.array_equal(own.predict(crowd(), 12).position, AnchorNet("open").predict(crowd(), 12).position)
    np.savez(tmp_path / "half.npz", **{k: v for k, v in numbers.items() if k != "query_bias"})
    np.savez(tmp_path / "old.npz", **numbers | {"own_1_weight": np.zeros((30, 256))})
    np.savez(tmp_path / "unshared.npz", **{k: v for k, v in numbers.items() if k != "share"})
    np.savez(tmp_path / "share.npz", **numbers | {"share": np.full(3, 1 / 3)})
    wrong = {
        "half": "query_bias is missing", "old": "own_1_weight has shape", "unshared": "share is missing",
        "share": r"share has shape \[3\], it must be \[20\]",
    }  # fmt: skip
    for file, word in wrong.items():
        with pytest.raises(DataError, match=f"{file}.npz is not a file of AnchorNet weights: {word}"):
            AnchorNet(file=str(tmp_path / f"{file}.npz")).predict(crowd(), 12)
    with pytest.raises(DataError, match="does not exist"):
        AnchorNet(file=str(tmp_path / "none.npz")).predict(crowd(), 12)


def test_wrong_wishes_are_one_sentence() -> None:
    with pytest.raises(InputError, match="sample 'draw'.*it is set or draws"):
        AnchorNet(sample="draw")
    with pytest.raises(InputError, match="contact = -1 m must be finite"):
        AnchorNet(contact=-1)
    with pytest.raises(InputError, match="fold 'paris'"):
        AnchorNet("paris")


def test_shipped_weights_are_ahead_where_they_did_not_learn(recorded: Callable[[str], Trajectories]) -> None:
    past, future = recorded("biwi_hotel").windows()
    floor, straight = score_predictor(Anchors(), past, future, 20), score_predictor(ConstantVelocity(), past, future)
    twenty, one = score_predictor(AnchorNet(), past, future, 20), score_predictor(AnchorNet(), past, future)
    assert twenty.ade < 0.85 * floor.ade
    assert twenty.fde < 0.75 * floor.fde
    assert one.ade < 0.85 * straight.ade
    assert one.fde < 0.85 * straight.fde
    assert max(one.collisions, twenty.collisions) < 0.5 * straight.collisions
    assert len(past) > 0
    assert twenty.nll < floor.nll
    assert twenty.energy < floor.energy


@pytest.mark.parametrize("fold", ["open", "all", *FOLDS])
def test_every_fold_is_shipped_whole(fold: str) -> None:
    numbers = load_pretrained("anchor-net", fold)
    assert set(NEEDED) <= set(numbers)
    assert numbers["temperature"].shape == numbers["widening"].shape == (len(SPEED_CLASSES) + 1,)
    assert load_pretrained("anchors", fold)["shapes"].shape == (20, 12, 2)


@both
def test_long_horizons_go_on_as_they_are(net: AnchorNet, windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.3, 0.2))
    long = net.predict(past, 40, 20, stream(2)).position[0, :, :, 0]
    short = net.predict(past, 12, 20, stream(2)).position[0, :, :, 0]
    np.testing.assert_allclose(long[:, :12], short, atol=1e-12)
    np.testing.assert_allclose(np.diff(long[:, 12:], axis=1), np.broadcast_to([0.52, 0.08], (20, 27, 2)), atol=1e-9)
