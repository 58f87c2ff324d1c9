"""Social Ways as it comes with the package: places, walls, plans of robots, and what does not fit."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable

import numpy as np
import pytest

from crowdbot.core import InputError, stream
from crowdbot.data import Windows
from crowdbot.prediction import SocialWays
from crowdbot.prediction.joint_futures import separate_people
from crowdbot.prediction.pretrained_weights import FOLDS

Maker = Callable[..., Windows]
ETH = SocialWays("eth")


def walking(windows: Maker, *people: tuple[float, float, float, float], **more: object) -> Windows:
    """Make a window of people given by place now [m] and velocity [m/s]."""
    track = [[(x + 0.4 * t * vx, y + 0.4 * t * vy) for x, y, vx, vy in people] for t in range(-7, 1)]
    return windows([track], **more)


def predicted(social: SocialWays, past: Windows, samples: int = 3) -> np.ndarray:
    return social.predict(past, 12, samples, stream(1)).position


def test_people_see_a_robot_where_its_plan_leads(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.0, 0.0), (3.0, 0.5, 0.0, 0.0), robot=np.array([[False, True]]))
    away, near = np.tile([30.0, 0.5], (12, 1)), np.linspace([2.5, 0.4], [0.5, 0.0], 12)
    one, other = (predicted(ETH, past.with_plans({1: plan})) for plan in (away, near))
    assert np.array_equal(one[0, :, :, 1], np.broadcast_to(away, (3, 12, 2)))
    assert np.abs(one[0, :, :, 0] - other[0, :, :, 0]).max() > 1e-3


def test_draws_through_a_wall_are_passed_over_or_end_before_it(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.2, 0.0), (0.0, 1.0, 1.0, 0.3))
    free = predicted(ETH, past, 12)
    border = float(np.median(free[0, :, -1, 0, 0]))
    wall = np.array([[border, -90.0], [border + 0.2, -90.0], [border + 0.2, 90.0], [border, 90.0]])
    walled = predicted(ETH, dataclasses.replace(past, walls=(wall,)), 12)
    assert walled[..., 0].max() <= border
    stopped = (walled[0, :, -1] == walled[0, :, -2]).all(axis=-1).mean()
    assert stopped < (free[0, :, -1, :, 0] > border).mean()
    beside = predicted(ETH, dataclasses.replace(past, walls=(wall + [200.0, 0.0],)), 4)
    assert np.array_equal(beside, predicted(ETH, past, 12)[:, ::3])
    few = predicted(ETH, dataclasses.replace(past, walls=(wall,)), 5)
    np.testing.assert_allclose(few, walled[:, :5], atol=1e-5)


def test_people_of_one_draw_keep_apart(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.2, 0.0), (9.0, 0.05, -1.2, 0.0))
    alone = dataclasses.replace(ETH, contact=0.0)
    free, apart = predicted(alone, past, 20), predicted(ETH, past, 20)
    between = [np.linalg.norm(place[0, :, :, 0] - place[0, :, :, 1], axis=-1).min() for place in (free, apart)]
    assert between[0] < 0.2 <= between[1] + 1e-6
    assert alone.name == "social-ways(checkpoint=eth)(contact=0)"
    with pytest.raises(InputError, match="contact = -1 m must be finite and at least 0"):
        SocialWays("eth", contact=-1)


def test_nobody_is_moved_aside_through_a_wall(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.2, 0.0), (9.6, 0.02, -1.2, 0.0))
    place = np.stack([np.array([[1.2 * 0.4 * t, 0.0], [9.6 - 1.2 * 0.4 * t, 0.02]]) for t in range(1, 13)])[None, None]
    wall = np.array([[-1.0, -0.05], [12.0, -0.05], [12.0, -0.3], [-1.0, -0.3]])
    free, walled = (
        separate_people(past, place, 0.25),
        separate_people(dataclasses.replace(past, walls=(wall,)), place, 0.25),
    )
    assert free[0, 0, :, 0, 1].min() < -0.05
    assert np.array_equal(walled[..., 0, :], place[..., 0, :])
    assert np.array_equal(walled[..., 1, :], free[..., 1, :])


@pytest.mark.parametrize("fold", FOLDS)
def test_weights_of_every_place_predict_right_after_install(fold: str, windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.0, 0.0), (3.0, 0.5, -1.0, 0.0))
    drawn = SocialWays(fold).predict(past, 12, 20)
    assert (drawn.samples, drawn.predictor) == (20, f"social-ways(checkpoint={fold})")
    ends = drawn.position[0, :, -1, 0] - past.position[0, -1, 0]
    assert 2.0 < np.median(ends[:, 0]) < 8.0
    assert ends.std(axis=0).min() > 0.05
    learned = SocialWays(fold).network().facts["learned"]
    assert not any(name.startswith(FOLDS[fold]) for name in learned)


def test_the_name_of_a_recording_chooses_the_weights(windows: Maker) -> None:
    past = walking(windows, (0.0, 0.0, 1.0, 0.0))
    named, social = dataclasses.replace(past, source="biwi_hotel.txt"), SocialWays()
    assert (social.name, social.note(named)) == ("social-ways", "")
    assert np.array_equal(predicted(social, named), predicted(SocialWays("hotel"), past))
    assert "not named after a training place; using the weights trained without eth" in social.note(past)
    assert np.array_equal(predicted(social, past), predicted(ETH, past))


def test_what_does_not_fit_is_said_and_a_baseline_answers(windows: Maker) -> None:
    past, social = walking(windows, (0.0, 0.0, 1.0, 0.0)), SocialWays()
    pixels, fast = dataclasses.replace(past, units="px"), dataclasses.replace(past, dt=0.2)
    assert "not in metres; a baseline is used instead" in social.note(pixels)
    with pytest.warns(UserWarning, match="not in metres; sampled-constant-velocity is used instead"):
        assert social.predict(pixels, 12, 3).samples == 3
    with pytest.warns(
        UserWarning, match="the weights require 0.4 s: resample with --step 0.4; constant-velocity is used instead"
    ):
        assert social.predict(fast, 12).samples == 1
    with pytest.raises(
        InputError, match="give a file of crowdbot train, or auto, eth, hotel, univ, zara1, zara2 for shipped weights"
    ):
        SocialWays("zara3")
