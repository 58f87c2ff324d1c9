"""Radii of people and robots, and probabilities of single people, in joint futures."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.data import Forecast, Windows
from crowdbot.prediction import AnchorNet, ConstantVelocity, Kalman, Live, Simulated

Maker = Callable[..., Windows]
TIME = 0.4 * np.arange(-7.0, 1.0)


def meeting(windows: Maker, *aside: float) -> Windows:
    """People who walk towards the first one, beside each other."""
    sway = 0.03 * np.sin(np.arange(8.0))
    tracks = [np.stack([-4.0 + 1.2 * TIME, sway], axis=1)]
    tracks += [np.stack([4.0 - 1.2 * TIME, y + sway], axis=1) for y in aside]
    return windows(np.stack(tracks, axis=1)[None])


def nearest(forecast: Forecast, one: int, other: int) -> float:
    """Return the smallest distance of two people in any future, straight between rows."""
    away = forecast.position[0, :, :, one] - forecast.position[0, :, :, other]
    fine = np.linspace(0.0, away.shape[1] - 1.0, 600)
    low = np.minimum(fine.astype(int), away.shape[1] - 2)
    share = (fine - low)[:, None]
    return float(np.linalg.norm((1.0 - share) * away[:, low] + share * away[:, low + 1], axis=2).min())


@pytest.mark.parametrize("samples", [1, 20])
def test_futures_keep_apart_by_the_sum_of_radii(samples: int, windows: Maker) -> None:
    past = meeting(windows, 0.1)
    net = AnchorNet("open")
    assert nearest(net.predict(past, 12, samples), 0, 1) < 0.5
    wide = dataclasses.replace(past, radius=np.array([[0.3, 0.6]]))
    assert nearest(net.predict(wide, 12, samples), 0, 1) > 0.88
    half = dataclasses.replace(past, radius=np.array([[np.nan, 0.125]]))
    np.testing.assert_array_equal(net.predict(half, 12, samples).position, net.predict(past, 12, samples).position)


def test_windows_keep_their_radii(windows: Maker) -> None:
    past = windows(np.zeros((3, 2, 2, 2)))
    past = dataclasses.replace(past, radius=np.arange(6.0).reshape(3, 2))
    assert past.radius is not None
    assert past[1:].radius is not None
    assert past[np.array([2, 0])].radius.tolist() == [[4.0, 5.0], [0.0, 1.0]]


def test_live_knows_the_last_radius(windows: Maker) -> None:
    live = Live(AnchorNet("open"), dt=0.4)
    past = meeting(windows, 0.1)
    for row, place in enumerate(past.position[0]):
        live.update(["a", "robot"], place, robots=["robot"], radii=[0.3, 0.6] if row == 2 else None)
    seen = live.past()
    assert seen.radius is not None
    assert seen.radius.tolist() == [[0.3, 0.6]]
    assert nearest(live.predict(12, 20), 0, 1) > 0.88
    live.update(["a"], [[0.0, 0.0]], radii=[np.nan])
    assert live.past().radius.tolist() == [[0.3, 0.6]]  # the robot is hidden
    assert Live(Kalman(), 0.4).past().radius is None


@pytest.mark.parametrize(
    ("radii", "words"),
    [([0.3], r"radii have shape \[1\], they must be \[2\]"), ([0.3, 0.0], "radius 0.0 m of 'b' must be above 0"),
     ([0.3, np.inf], "radius inf m of 'b'"), (["wide", 1.0], "radii must be numbers")],
)  # fmt: skip
def test_impossible_radii_are_refused(radii: list[object], words: str) -> None:
    with pytest.raises(InputError, match=words):
        Live(Kalman(), 0.4).update(["a", "b"], [[0.0, 0.0], [3.0, 0.0]], radii=radii)  # type: ignore[arg-type]


def test_each_person_has_own_probabilities(windows: Maker) -> None:
    past = meeting(windows, 0.1, 2.0)
    forecast = AnchorNet("open").predict(past, 12, 20)
    own = forecast.person_weight
    assert own is not None
    np.testing.assert_allclose(own.sum(axis=1), 1.0)
    modes = AnchorNet("open").modes(past)
    for person in range(3):
        np.testing.assert_allclose(np.sort(own[0, :, person])[::-1], modes.probability[person], atol=1e-12)
    np.testing.assert_allclose(own.mean(axis=2), forecast.weight, atol=1e-12)
    some = AnchorNet("open").predict(past, 12, 5).person_weight
    assert some is not None
    np.testing.assert_allclose(some.sum(axis=1), 1.0)
    assert AnchorNet("open").predict(past, 12).person_weight is None


def test_crowd_models_simulate_people_of_the_given_radii() -> None:
    gaps = {}
    for radius in (None, 0.2, 0.6):
        live = Live(Simulated("orca"), dt=0.4)
        for row in range(4):
            place = [[0.5 * row - 4.0, 0.0], [4.0 - 0.5 * row, 0.1]]
            live.update([1, 2], place, radii=None if radius is None else [radius, radius])
        gaps[radius] = nearest(live.predict(12), 0, 1)
    assert gaps[0.2] < gaps[None] < gaps[0.6]
    assert gaps[0.6] > 1.1


def test_a_calibrated_radius_starts_at_the_given_one(windows: Maker) -> None:
    past = dataclasses.replace(meeting(windows, 0.3), radius=np.array([[0.4, np.nan]]))
    crowd = Simulated("orca", cost="absolute", search="greedy", budget=1, free=("radius",))
    _, fit = crowd.follow(past, 1)
    assert fit.given[0, :, 0].tolist() == [0.4, 0.25]


def test_the_existence_of_a_tracker_is_in_the_forecast() -> None:
    live = Live(ConstantVelocity(), dt=0.4, coast=0.8)
    live.update(["a", "b"], [[0.0, 0.0], [4.0, 0.0]], existence=[0.5, 0.9])
    live.update(["a", "b"], [[0.4, 0.0], [4.0, 0.0]], existence=[0.8, np.nan])
    existence = live.predict(2).existence
    assert existence is not None
    assert existence.tolist() == [[0.8, 1.0]]
    live.update(["b"], [[4.0, 0.0]], existence=[0.7])
    existence = live.predict(2).existence  # hidden for half of coast
    assert existence is not None
    np.testing.assert_allclose(existence, [[0.4, 0.7]])


def test_the_last_frame_of_a_stamp_says_how_probable_a_person_is() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    live.update([1, 2], [[0.0, 0.0], [4.0, 0.0]], time=1.0, existence=[0.5, 0.6])
    live.update([2, 3], [[4.0, 0.0], [8.0, 0.0]], time=1.0, existence=[0.7, 0.8])
    existence = live.predict(1).existence
    assert existence is not None
    assert existence.tolist() == [[0.5, 0.7, 0.8]]


@pytest.mark.parametrize(
    ("existence", "words"),
    [([0.3], r"existence have shape \[1\], they must be \[2\]"), ([0.3, 0.0], "existence 0.0 of 'b' must be above 0"),
     ([1.2, 1.0], "existence 1.2 of 'a' must be above 0 and at most 1"), (["no", 1.0], "existence must be numbers")],
)  # fmt: skip
def test_impossible_probabilities_are_refused(existence: list[object], words: str) -> None:
    live = Live(Kalman(), 0.4)
    with pytest.raises(InputError, match=words):
        live.update(["a", "b"], [[0.0, 0.0], [3.0, 0.0]], existence=existence)  # type: ignore[arg-type]
    assert live.ids.tolist() == []
