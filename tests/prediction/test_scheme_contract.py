"""What every scheme (model x cost x search x goal) must hold to: nothing leaks, the same seed gives the same bytes."""

from __future__ import annotations

import dataclasses
import itertools
from collections.abc import Callable

import numpy as np
import pytest

from crowdbot import calibration
from crowdbot.calibration import Cost, Search
from crowdbot.core import InputError, builtin_classes, stream
from crowdbot.data import Forecast, Trajectories, Windows
from crowdbot.models import CurrentDirection, Goal, GroundTruth
from crowdbot.models.goals import EnvironmentLayout, LearnedDestinations
from crowdbot.prediction import Simulated

Maker = Callable[..., Windows]

COSTS = [name for name in builtin_classes(calibration, Cost) if name != "weighted-sum"]
SEARCHES = list(builtin_classes(calibration, Search))
MODELS = ("orca", "social-force", "power-law", "boids")
SCHEMES = [*itertools.product(("orca",), COSTS, SEARCHES), *((model, COSTS[0], "genetic") for model in MODELS[1:])]
every = pytest.mark.parametrize("scheme", SCHEMES, ids=" ".join)


def crowd_of(scheme: tuple[str, str, str], goal: Goal | None = None) -> Simulated:
    model, cost, search = scheme
    return Simulated(model, goal or CurrentDirection(), cost, search, budget=12, substep=0.4)


def run_job(scheme: tuple[str, str, str], past: Windows, samples: int = 1) -> Forecast:
    return crowd_of(scheme).predict(past, 4, samples, stream(5, "test"))


def test_the_schemes_of_the_field_are_there() -> None:
    assert COSTS == ["absolute", "inter-pedestrian", "progressive"]
    assert {"random-search", "greedy", "annealing", "genetic"} <= set(SEARCHES)
    assert len(SEARCHES) == 5


@every
def test_what_is_scored_and_what_comes_later_is_never_read(
    scheme: tuple[str, str, str], crowd: Maker, recorded: Callable[[str], Trajectories]
) -> None:
    past = crowd(holes=0.2)
    peeked = dataclasses.replace(past, scored=~past.scored)
    assert np.array_equal(run_job(scheme, past).position, run_job(scheme, peeked).position)
    tracks = recorded("biwi_hotel")
    now = int(np.unique(tracks.frame)[300])
    later = tracks.frame > now
    x, y = np.where(later, 1e3, tracks.x), np.where(later, -1e3, tracks.y)
    spoilt = dataclasses.replace(tracks, x=x, y=y)
    one, other = (run_job(scheme, each.past(frame=now)) for each in (tracks, spoilt))
    assert np.array_equal(one.position, other.position)


@every
def test_the_same_stream_gives_the_same_bytes_alone_or_in_a_batch(scheme: tuple[str, str, str], crowd: Maker) -> None:
    past = crowd(2, holes=0.1)
    for array in (past.position, past.present, past.id):
        array.setflags(write=False)
    together = run_job(scheme, past)
    assert np.array_equal(together.position, run_job(scheme, past).position)
    rng = stream(5, "test")
    for window in range(len(past)):
        alone = crowd_of(scheme).predict(past[window : window + 1], 4, 1, rng)
        assert np.array_equal(alone.position[0], together.position[window])


@every
def test_short_tracks_nobody_and_no_window_are_fine(scheme: tuple[str, str, str], windows: Maker) -> None:
    past = windows([[[[1.0, 2.0], [5.0, 5.0], [np.nan, np.nan]]]])
    assert np.allclose(run_job(scheme, past).position, past.position[:, None])
    assert run_job(scheme, windows(np.zeros((2, 8, 0, 2)))).position.shape[3] == 0
    assert run_job(scheme, windows(np.zeros((0, 8, 3, 2)))).position.shape[0] == 0
    assert not run_job(scheme, windows(np.full((2, 8, 3, 2), np.nan))).valid.any()
    alone = windows(0.4 * np.arange(8.0)[None, :, None, None] * np.array([1.0, 0.0]))
    assert np.all(np.isfinite(run_job(scheme, alone).position))


def test_ground_truth_goals_belong_to_their_windows(crowd: Maker) -> None:
    past = crowd(3)
    future = dataclasses.replace(past, position=past.position + 1.0)
    scheme = crowd_of(("orca", "progressive", "genetic"), GroundTruth(past, future))
    assert np.all(np.isfinite(scheme.predict(past, 4).position))
    stranger = dataclasses.replace(past, frame=past.frame + 999, id=past.id + 50)
    with pytest.raises(InputError, match="is not one of the 4 windows with a known future"):
        scheme.predict(stranger, 4)


def several_goals(recorded: Callable[[str], Trajectories]) -> tuple[Goal, Windows]:
    known, rest = recorded("crowds_zara02").split(0.5)
    return LearnedDestinations.learn(known), rest.windows()[0][:12]


def test_several_destinations_give_several_futures_with_weights(recorded: Callable[[str], Trajectories]) -> None:
    goal, past = several_goals(recorded)
    crowd = Simulated("orca", goal, substep=0.4)
    one, many = crowd.predict(past, 12), crowd.predict(past, 12, 20, stream(1, "futures"))
    assert one.samples == 1
    assert many.samples == 20
    np.testing.assert_allclose(many.weight.sum(axis=1), 1.0)
    there = past.present[:, -1]
    ends = np.moveaxis(many.position[:, :, -1], 2, 1)[there]
    assert np.mean(np.std(ends, axis=1)) > 0.05
    again = crowd.predict(past, 12, 20, stream(1, "futures"))
    assert np.array_equal(again.position, many.position)
    rng = stream(1, "futures")
    for window in range(len(past)):
        alone = crowd.predict(past[window : window + 1], 12, 20, rng)
        assert np.array_equal(alone.position[0], many.position[window])
        assert np.array_equal(alone.weight[0], many.weight[window])


def test_destinations_are_drawn_as_often_as_they_are_probable(recorded: Callable[[str], Trajectories]) -> None:
    goal, past = several_goals(recorded)
    choices = goal.choices(past)
    fits = Simulated("orca", goal, radius=0.01, substep=0.4)
    futures = fits.predict(past, 1, 400, stream(2, "futures"))
    assert choices.weight.shape[-1] > 1
    first = futures.position[:, :, 0] - past.position[:, -1][:, None]
    wish = choices.position - past.position[:, -1][:, :, None]
    angle = np.arctan2(wish[..., 1], wish[..., 0])
    mean = np.sum(choices.weight[..., None] * np.stack([np.cos(angle), np.sin(angle)], axis=-1), axis=2)
    went = first / np.maximum(np.linalg.norm(first, axis=-1, keepdims=True), 1e-9)
    found = np.sum(futures.weight[:, :, None, None] * went, axis=1)
    walking = past.present[:, -1] & (np.linalg.norm(first[:, 0], axis=-1) > 0.2)
    off = np.linalg.norm(found - mean, axis=-1)[walking]
    assert np.median(off) < 0.02  # who has to step aside goes elsewhere


def test_a_layout_goal_predicts_too(recorded: Callable[[str], Trajectories]) -> None:
    _, past = several_goals(recorded)
    goal = EnvironmentLayout([[-1.0, 5.0], [16.0, 5.0]])
    scheme = crowd_of(("orca", "progressive", "genetic"), goal)
    assert np.all(np.isfinite(scheme.predict(past, 12, 5).position))
