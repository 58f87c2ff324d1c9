"""What every built-in predictor must hold to."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from crowdbot import prediction
from crowdbot.core import InputError, builtin_classes, stream
from crowdbot.data import Forecast, Trajectories, Windows
from crowdbot.prediction import Predictor
from crowdbot.prediction.learned_predictor import LearnedPredictor

Maker = Callable[..., Windows]

KINDS = {
    name: kind
    for name, kind in builtin_classes(prediction, Predictor).items()
    if not issubclass(kind, LearnedPredictor)  # those need weights, and have a contract test of their own
}
every = pytest.mark.parametrize("name", KINDS)


def predicted(name: str, past: Windows, steps: int = 12, samples: int = 3) -> Forecast:
    return KINDS[name]().predict(past, steps, samples, stream(5, "test"))


def assert_mostly_equal(name: str, one: np.ndarray, other: np.ndarray) -> None:
    """Compare places; a crowd may amplify the last bit of a few of them, nothing else may."""
    off = np.abs(one - other) > 1e-6
    assert off.mean() <= (0.1 if name == "simulated" else 0.0)


def test_built_in_names_are_those_of_the_field() -> None:
    names = [
        "anchor-net", "anchors", "constant-acceleration", "constant-velocity", "kalman", "kalman-acceleration",
        "least-squares", "sampled-constant-velocity", "simulated",
    ]  # fmt: skip
    assert list(KINDS) == names
    assert [KINDS[name]().name for name in names] == names


@every
def test_shapes_weights_and_validity(name: str, crowd: Maker) -> None:
    past = crowd(holes=0.2)
    forecast = predicted(name, past)
    samples = 3 if KINDS[name].draws and name != "simulated" else 1  # people of a simulation have one goal by default
    assert forecast.position.shape == (4, samples, 12, 7, 2)
    assert np.array_equal(forecast.valid, past.present[:, -1])
    assert np.allclose(forecast.weight.sum(axis=1), 1.0)
    assert np.all(np.isfinite(forecast.position))
    assert np.all(np.moveaxis(forecast.position, 3, 1)[~forecast.valid] == 0.0)
    assert (forecast.dt, forecast.predictor) == (0.4, name)


@every
def test_one_row_is_enough_and_means_standing(name: str, windows: Maker) -> None:
    past = windows([[[[1.0, 2.0], [5.0, 5.0], [np.nan, np.nan]]]])
    forecast = predicted(name, past)
    there = np.broadcast_to(past.position[:, None], forecast.position.shape)
    np.testing.assert_allclose(forecast.position, there, atol=1e-9)
    assert forecast.valid.tolist() == [[True, True, False]]


@every
def test_nobody_and_no_window_are_fine(name: str, windows: Maker) -> None:
    assert predicted(name, windows(np.zeros((2, 8, 0, 2)))).position.shape[3] == 0
    assert predicted(name, windows(np.zeros((0, 8, 3, 2)))).position.shape[0] == 0
    absent = predicted(name, windows(np.full((2, 8, 3, 2), np.nan)))
    assert not absent.valid.any()


@every
def test_the_mask_of_who_is_scored_is_never_read(name: str, crowd: Maker) -> None:
    past = crowd(holes=0.2)
    peeked = dataclasses.replace(past, scored=~past.scored)
    assert np.array_equal(predicted(name, past).position, predicted(name, peeked).position)


@every
def test_nothing_is_written_to_the_past(name: str, crowd: Maker) -> None:
    past = crowd(holes=0.2)
    for array in (past.position, past.present, past.robot, past.scored, past.id, past.frame):
        array.setflags(write=False)
    before = past.position.copy()
    predicted(name, past)
    assert np.array_equal(past.position, before)


@every
def test_what_happens_later_changes_no_prediction(name: str, recorded: Callable[[str], Trajectories]) -> None:
    tracks = recorded("biwi_hotel")
    past, future = tracks.windows(observe=8, predict=12, protocol="all")
    now = int(past.frame[len(past) // 2, -1])
    later = tracks.frame > now
    noise = stream(1, "garbage").normal(0.0, 1e3, (2, int(later.sum())))
    x, y = tracks.x.copy(), tracks.y.copy()
    x[later], y[later] = noise
    spoilt, nonsense = dataclasses.replace(tracks, x=x, y=y).windows(observe=8, predict=12, protocol="all")
    known = past.frame[:, -1] <= now
    assert 0 < known.sum() < len(known)
    assert not np.array_equal(nonsense[known].position, future[known].position)
    one, other = predicted(name, past[known]), predicted(name, spoilt[known])
    assert np.array_equal(one.position, other.position)
    assert np.array_equal(one.valid, other.valid)


@every
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 1000))
def test_a_window_alone_is_predicted_as_in_a_batch_bit_for_bit(name: str, crowd: Maker, seed: int) -> None:
    past = crowd(seed, holes=0.2)
    together = predicted(name, past)
    rng = stream(5, "test")
    for window in range(len(past)):
        alone = KINDS[name]().predict(past[window : window + 1], 12, 3, rng)
        assert np.array_equal(alone.position[0], together.position[window])


@every
@settings(max_examples=8, deadline=None)
@given(seed=st.integers(0, 1000), rows=st.integers(1, 4))
def test_padding_changes_nothing(name: str, crowd: Maker, seed: int, rows: int) -> None:
    past = crowd(seed, holes=0.2)
    grown = {
        key: np.concatenate([value, np.repeat(np.zeros_like(value[..., :1, :] if key == "position" else value[..., :1]),
                                              rows, axis=2 if key in ("position", "present") else 1)],
                            axis=2 if key in ("position", "present") else 1)
        for key, value in ((key, getattr(past, key)) for key in ("position", "present", "scored", "robot", "id"))
    }  # fmt: skip
    padded = predicted(name, dataclasses.replace(past, **grown))
    assert np.array_equal(padded.position[..., :7, :], predicted(name, past).position)


@every
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 1000), angle=st.floats(-3, 3), shift=st.floats(-50, 50))
def test_turning_and_shifting_the_world_turns_and_shifts_the_forecast(
    name: str, crowd: Maker, seed: int, angle: float, shift: float
) -> None:
    past = crowd(seed, holes=0.1)
    turn = np.array([[math.cos(angle), math.sin(angle)], [-math.sin(angle), math.cos(angle)]])

    def moved(position: np.ndarray) -> np.ndarray:
        return position @ turn + np.array([shift, -shift])

    there = np.where(past.present[..., None], moved(past.position), 0.0)
    forecast, other = predicted(name, past), predicted(name, dataclasses.replace(past, position=there))
    who = np.broadcast_to(past.present[:, None, None, -1], forecast.position.shape[:-1])
    assert_mostly_equal(name, other.position[who], moved(forecast.position[who]))


@every
@settings(max_examples=10, deadline=None)
@given(seed=st.integers(0, 1000))
def test_renumbering_people_renumbers_the_forecast(name: str, crowd: Maker, seed: int) -> None:
    past = crowd(seed, holes=0.1)
    order = stream(seed, "order").permutation(7)
    mixed = dataclasses.replace(
        past, position=past.position[:, :, order], present=past.present[..., order], scored=past.scored[:, order],
        robot=past.robot[:, order], id=past.id[:, order],
    )  # fmt: skip
    if name.startswith("sampled"):  # who comes first draws first: compare without the chance in it
        still = prediction.SampledConstantVelocity(heading_sd=0.0, speed_sd=0.0)
        one, other = still.predict(past, 12, 2), still.predict(mixed, 12, 2)
    else:
        one, other = predicted(name, past), predicted(name, mixed)
    assert_mostly_equal(name, other.position, one.position[..., order, :])


@pytest.mark.parametrize(
    "name", sorted(set(KINDS) - {"simulated", "kalman", "kalman-acceleration", "anchors", "anchor-net"})
)
def test_a_slower_clock_changes_no_place(name: str, crowd: Maker) -> None:
    past = crowd(3)
    slow = dataclasses.replace(past, dt=4.0 * past.dt)
    np.testing.assert_allclose(predicted(name, slow).position, predicted(name, past).position, atol=1e-9)


@every
def test_samples_are_drawn_or_not_faked(name: str, crowd: Maker) -> None:
    past = crowd()
    few, many = predicted(name, past, samples=2), predicted(name, past, samples=5)
    if few.samples == 1:
        assert np.array_equal(few.position, many.position)
    else:
        assert np.array_equal(few.position, many.position[:, :2])
        assert not np.array_equal(many.position[:, 0], many.position[:, 1])


@every
def test_without_a_stream_the_default_one_is_taken(name: str, crowd: Maker) -> None:
    past = crowd()
    kind = KINDS[name]()
    given_ = kind.predict(past, 3, 2, stream(0, "predict"))
    assert np.array_equal(kind.predict(past, 3, 2).position, given_.position)


@every
def test_nothing_to_predict_is_an_error(name: str, crowd: Maker) -> None:
    for steps, samples in ((0, 1), (12, 0)):
        with pytest.raises(InputError, match="needs at least 1 step and 1 sample"):
            KINDS[name]().predict(crowd(), steps, samples)
    empty = crowd()
    empty = dataclasses.replace(empty, position=empty.position[:, :0], present=empty.present[:, :0])
    with pytest.raises(InputError, match="at least one observed row"):
        KINDS[name]().predict(empty, 12)
