"""The floor of learned predictors: shapes come out of recordings, and are bent as asked."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import DataError, InputError, stream
from crowdbot.data import Trajectories, Windows
from crowdbot.evaluation import score_predictor
from crowdbot.prediction import Anchors, ConstantVelocity, SampledConstantVelocity
from crowdbot.prediction.anchor_net.anchors import cluster_centers, resample_paths, residuals
from crowdbot.prediction.pretrained_weights import FOLDS, fold_of, is_held_out, read_weights

Maker = Callable[..., Windows]


def turners(count: int = 60) -> tuple[Windows, Windows]:
    """People who walk evenly for 8 rows, then turn left or right, or go on."""
    rng = stream(3, "turners")
    angle, heading = rng.choice([-0.5, 0.0, 0.5], count), rng.uniform(-3, 3, count)
    row = np.arange(1, 13)
    own = np.stack([np.cos(angle)[:, None] * row, np.sin(angle)[:, None] * row], axis=2) * 0.5
    c, s = np.cos(heading)[:, None], np.sin(heading)[:, None]
    ahead = np.stack([c * own[..., 0] - s * own[..., 1], s * own[..., 0] + c * own[..., 1]], axis=2)
    back = np.arange(-7, 1)[:, None] * 0.5 * np.concatenate([c, s], axis=1)[:, None]
    tracks = np.concatenate([back, ahead], axis=1)
    frame = np.tile(np.arange(20), count) + np.repeat(np.arange(count) * 30, 20)
    x, y = tracks.reshape(-1, 2).T
    return Trajectories(np.repeat(np.arange(count), 20), frame, x, y, row_rate=2.5).windows()


def test_shapes_are_the_ways_people_bend() -> None:
    past, future = turners()
    fitted = Anchors.fit((past, future), count=3)
    found = score_predictor(fitted, past, future, 20)
    assert found.ade < 1e-6
    assert score_predictor(ConstantVelocity(), past, future).ade > 0.5
    assert fitted.share is not None
    assert np.all(np.diff(fitted.share) <= 0.0)
    assert math.isclose(float(fitted.share.sum()), 1.0)


def test_fewer_samples_are_the_likeliest_and_more_are_not_made_up() -> None:
    past, _ = turners()
    every = Anchors().predict(past, 12, 50)
    assert every.samples == 20
    few = Anchors().predict(past, 12, 4)
    assert np.array_equal(few.position, every.position[:, :4])
    assert np.all(np.diff(few.weight[0]) <= 0.0)


def test_what_is_missed_is_seen_from_the_person() -> None:
    missed = residuals(*turners())
    assert missed.shape == (60, 12, 2)
    ends = {tuple(np.round(item, 3)) for item in missed[:, -1]}
    back, aside = round(6 * math.cos(0.5) - 6, 3), round(6 * math.sin(0.5), 3)
    assert ends == {(0.0, 0.0), (back, aside), (back, -aside)}


def test_other_steps_of_time_end_at_the_same_places(windows: Maker) -> None:
    slow = np.cumsum(np.full((1, 16, 1, 2), 0.3), axis=1)
    fine = windows(slow, dt=0.2)
    coarse = windows(slow[:, 1::2])
    fast = Anchors().predict(fine, 24, 20).position[0, :, 1::2, 0]
    np.testing.assert_allclose(fast, Anchors().predict(coarse, 12, 20).position[0, :, :, 0], atol=1e-9)


def test_beyond_what_was_learned_the_bend_stays() -> None:
    bend = np.cumsum(np.ones((1, 1, 12, 2)), axis=2)
    away = resample_paths(bend, np.zeros((1, 2)), 30, 0.4)
    assert away[0, 0, :, 0].tolist() == [*range(1, 13), *[12.0] * 18]


@pytest.mark.parametrize(("change", "word"), [({"dt": 1.0}, "steps of 1 s"), ({"units": "px"}, "in px")])
def test_what_does_not_fit_is_said_and_a_baseline_answers(crowd: Maker, change: dict[str, object], word: str) -> None:
    past = dataclasses.replace(crowd(), **change)  # type: ignore[arg-type]
    with pytest.warns(UserWarning, match=f"anchors: made .*{word}.*is used instead"):
        found = Anchors().predict(past, 5, 3, stream(1))
    assert np.array_equal(found.position, SampledConstantVelocity().predict(past, 5, 3, stream(1)).position)


def test_the_place_decides_which_set_is_taken(crowd: Maker) -> None:
    here = crowd()
    there = dataclasses.replace(here, source="crowds_zara02.txt")
    assert np.array_equal(Anchors().predict(there, 12, 20).position, Anchors("zara2").predict(here, 12, 20).position)
    assert np.array_equal(Anchors().predict(here, 12, 20).position, Anchors("open").predict(here, 12, 20).position)
    assert "made is not named after a training place" in Anchors().note(here)
    assert Anchors().note(there) == ""


def test_places_are_told_by_the_names_of_recordings() -> None:
    assert [fold_of(f"{begins[0]}.txt") for begins in FOLDS.values()] == list(FOLDS)
    assert fold_of("uni_examples.txt") == "open"
    assert is_held_out("univ", "students003_train.txt")
    assert not is_held_out("univ", "crowds_zara01_train.txt")
    assert not is_held_out("all", "students003_train.txt")


def test_floor_on_a_recording(recorded: Callable[[str], Trajectories]) -> None:
    past, future = recorded("biwi_hotel").windows()
    found = score_predictor(Anchors(), past, future, 20)
    assert found.ade == pytest.approx(0.154, abs=0.002)
    assert found.fde == pytest.approx(0.268, abs=0.003)


def test_centres_are_those_of_heaps() -> None:
    heaps = np.repeat(np.array([[0.0, 0.0], [5.0, 0.0], [0.0, 5.0]]), [50, 30, 20], axis=0)
    found, share = cluster_centers(heaps + stream(0, "heaps").normal(0.0, 0.01, heaps.shape), 3)
    np.testing.assert_allclose(found, [[0, 0], [5, 0], [0, 5]], atol=0.02)
    np.testing.assert_allclose(share, [0.5, 0.3, 0.2])


def test_wrong_wishes_are_one_sentence(crowd: Maker, tmp_path) -> None:
    with pytest.raises(InputError, match=r"fold 'zara'; did you mean|fold 'zara'.*it is one of auto, open, all, eth"):
        Anchors("zara")
    with pytest.raises(InputError, match="belong together"):
        Anchors(shapes=np.zeros((3, 12, 2)))
    with pytest.raises(InputError, match=r"must be \[K, 12, 2\]"):
        Anchors(shapes=np.zeros((3, 8, 2)), share=np.ones(3) / 3)
    with pytest.raises(InputError, match="too few for 20 shapes"):
        Anchors.fit()
    with pytest.raises(InputError, match="training requires 12 future rows"):
        Anchors.fit((crowd(), crowd()))
    (tmp_path / "bad.npz").write_bytes(b"PK\x03\x04 not an archive")
    with pytest.raises(DataError, match=r"bad\.npz is not a file of weights"):
        read_weights(tmp_path / "bad.npz")
    with pytest.raises(DataError, match="does not exist"):
        read_weights(tmp_path / "none.npz")
    np.savez(tmp_path / "nan.npz", shapes=np.full(3, np.nan))
    with pytest.raises(DataError, match="shapes has values that are not finite"):
        read_weights(tmp_path / "nan.npz")
