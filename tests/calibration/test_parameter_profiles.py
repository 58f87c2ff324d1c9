"""Profiles of shared parameters: data that identify one of two parameters, and bad input."""

import dataclasses

import numpy as np
import pytest
from made_crowds import Drifting

from crowdbot.calibration import Calibrator, plot_profiles, profile_parameters
from crowdbot.cli import calibrate as command
from crowdbot.cli.parser import CommandParser
from crowdbot.core import InputError, stream
from crowdbot.data import Windows


def walkers(share, people=12, rows=6):
    """People far from each other who walk to the right at a share of their speed; ``push`` has no effect on them."""
    rng = stream(1, "profiles")
    speed = rng.uniform(0.8, 1.6, people)
    time = 0.4 * np.arange(rows)
    position = np.zeros((2, rows, people, 2))
    position[..., 0] = time[:, None] * speed
    position[..., 1] = 20.0 * np.arange(people)
    position[:, 1:, :, 0] = position[:, :1, :, 0] + share * position[:, 1:, :, 0]
    position += rng.normal(0.0, 0.005, position.shape)
    everyone, nobody = np.ones(position.shape[:3], dtype=bool), np.zeros((2, people), dtype=bool)
    id, frame = np.tile(np.arange(people), (2, 1)), np.tile(np.arange(rows), (2, 1))
    return Windows(position, everyone, nobody, nobody, id, frame, 0.4, "all", "made")


@pytest.fixture(scope="module")
def profiled():
    past = walkers(1.0)
    calibrator = Calibrator(
        Drifting(), "absolute", "random-search", "current-direction", budget=40, shared=True, free=("share", "push")
    )
    fit = calibrator.fit(past)
    return calibrator, fit, past, profile_parameters(calibrator, fit, past, points=7, budget=10)


def test_data_identify_what_has_an_effect(profiled):
    share, push = profiled[3]
    assert (share.name, push.name) == ("share", "push")
    assert share.identified == "yes"
    assert share.interval[0] <= share.best <= share.interval[1]
    assert share.interval[1] - share.interval[0] < 1.0
    assert push.identified == "no"
    assert push.interval == (0.0, 1.0)
    assert np.ptp(push.cost) < 0.1 * np.ptp(share.cost)


def test_the_calibrated_value_is_on_the_grid_and_the_bounds_too(profiled):
    _, fit, _, profiles = profiled
    for d, profile in enumerate(profiles):
        assert profile.best == fit.values[0, 0, d]
        assert profile.best in profile.values
        assert np.all(np.diff(profile.values) > 0.0)
        assert (profile.values[0], profile.values[-1]) == (fit.space.low[d], fit.space.high[d])
        assert profile.cost[profile.values == profile.best][0] == pytest.approx(float(fit.cost[0]))
        assert np.all(profile.low <= profile.high)
        assert profile.bootstrap[0] <= profile.bootstrap[1]
        assert profile.as_dict()["identified"] == profile.identified


def test_costs_of_people_have_the_mean_of_the_fit(profiled):
    calibrator, fit, past, _ = profiled
    cost = calibrator.person_costs(past, fit.values[0])
    assert cost.shape == (1, *past.id.shape)
    assert np.nanmean(cost) == pytest.approx(float(fit.cost[0]))


def test_a_profile_is_drawn(profiled, tmp_path):
    file = plot_profiles(profiled[3], tmp_path / "profiles.png")
    assert file.read_bytes().startswith(b"\x89PNG")


def test_individual_parameters_and_few_points_are_refused(profiled):
    calibrator, fit, past, _ = profiled
    own = dataclasses.replace(calibrator, shared=False, budget=5)
    with pytest.raises(InputError, match="profiles need a fit with shared parameters"):
        profile_parameters(own, own.fit(past), past)
    with pytest.raises(InputError, match="at least 3 points and a budget of 1, not 2 and 50"):
        profile_parameters(calibrator, fit, past, points=2)
    parser = CommandParser()
    command.arguments(parser)
    with pytest.raises(InputError, match="--profile requires --shared"):
        command.main(parser.parse_args(["--data", "nowhere.txt", "--profile", "5"]))
