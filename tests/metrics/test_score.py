"""Scores carry their protocol, become JSON and add up by persons."""

import dataclasses
import json
import math

import numpy as np
import pytest
from guesses import case

from crowdbot.core import InputError, stream
from crowdbot.data import Forecast, Windows, slice_rows
from crowdbot.metrics import Intervals, Score, collision_share, kde_nll, score, swept_collisions


def scored(
    errors: list[float], T: int = 3, protocol: str = "all", units: str = "m", samples: int = 1, apart: bool = False
) -> Score:
    """The score of a forecast that is off by ``errors`` [m], one person in each of as many windows: the same or not."""
    W = len(errors)
    here = np.ones((W, T, 1), dtype=bool)
    future = Windows(
        np.zeros((W, T, 1, 2)), here, here[:, 0], ~here[:, 0], np.arange(W)[:, None] * apart, np.zeros((W, T), int),
        0.4, protocol, f"street{W}", units=units,
    )  # fmt: skip
    guess = np.zeros((W, samples, T, 1, 2))
    guess[..., 0] = np.array(errors)[:, None, None, None]
    return score(Forecast.of(guess, here[:, 0], 0.4, "mine"), future)


def test_every_text_of_a_score_carries_its_protocol_and_counts() -> None:
    text = str(scored([0.1, 0.3], protocol="partial", samples=5))
    for part in ("mine on street2", "ADE 0.200 m", "protocol partial", "3 steps of 0.4 s", "2 persons in 2 windows"):
        assert part in text
    assert "best of 5 per person" in text


def test_a_total_weighs_by_persons() -> None:
    few, many = scored([1.0]), scored([0.1, 0.2, 0.3])
    total = Score.total([few, many])
    assert (total.windows, total.persons, total.source) == (4, 4, "street1 + street3")
    assert total.ade == pytest.approx(0.4)
    assert total.horizon == pytest.approx((0.4, 0.4, 0.4))
    assert total.there == (4, 4, 4)
    assert math.isnan(total.seconds_per_window)
    timed = [dataclasses.replace(s, seconds_per_window=t) for s, t in ((few, 4.0), (many, 0.0))]
    assert Score.total(timed).seconds_per_window == pytest.approx(1.0)
    assert Score.total([few]) is few


def test_a_score_becomes_json_and_comes_back() -> None:
    one = dataclasses.replace(
        scored([0.5, 2.5]), collisions=0.25, together=2, seconds_per_window=0.01, true_collisions=0.2, accompanied=5,
        nll=1.5, dense=1, swept_collisions=0.25, swept_contacts=0.5, swept_collisions_truth=0.0,
        swept_contacts_truth=0.5,
        intervals=Intervals(*[(0.0, 1.0)] * 9),
    )  # fmt: skip
    plain = one.as_dict()
    assert "people" not in plain
    again = json.loads(json.dumps(plain, allow_nan=False))
    again["horizon"], again["there"] = tuple(again["horizon"]), tuple(again["there"])
    again["intervals"] = Intervals(**{name: tuple(ends) for name, ends in again["intervals"].items()})
    assert Score(**again) == one
    assert one.miss_rate == 0.5


def test_every_mean_is_that_of_its_metric() -> None:
    forecast, future = case(1, K=8)
    past = slice_rows(future, 0, 1)
    one = score(forecast, future, past=past)
    assert one.collisions == pytest.approx(collision_share(forecast, future))
    assert one.true_collisions == pytest.approx(collision_share(forecast, future, neighbors="true"))
    for limit, name in ((0.2, "swept_collisions"), (None, "swept_contacts")):
        share, true = (np.nanmean(each) for each in swept_collisions(forecast, past, future, limit))
        assert (getattr(one, name), getattr(one, f"{name}_truth")) == pytest.approx((share, true))
    assert f"at 0.2 m {100 * one.swept_collisions:.1f} ({100 * one.swept_collisions_truth:.1f}) %" in str(one)
    assert one.cells()[one.columns.index("radii [%]")] in str(one)
    nll = kde_nll(forecast, future)[future.scored]
    assert one.nll == pytest.approx(nll.mean())
    assert one.dense == len(nll)
    assert 0.0 < one.energy < one.intervals.energy[1]
    for name, (low, high) in dataclasses.asdict(one.intervals).items():
        assert low <= getattr(one, name) <= high


def halves(seed: int) -> tuple[Score, Score, Score]:
    """Scores of two recordings of other people, and the score of both as one recording."""
    forecast, future = case(seed, W=8, K=5)
    future = dataclasses.replace(future, id=future.id + 10 * (np.arange(8)[:, None] >= 4))
    past = slice_rows(future, 0, 1)
    one, other, whole = (score(forecast[k], future[k], past=past[k]) for k in (slice(4), slice(4, 8), slice(8)))
    return one, other, whole


@pytest.mark.parametrize("seed", range(4))
def test_a_total_is_the_score_of_all_people_together_with_their_intervals(seed: int) -> None:
    one, other, whole = halves(seed)
    total = Score.total([one, other])
    for name, value in dataclasses.asdict(whole).items():
        if isinstance(value, float):
            assert getattr(total, name) == pytest.approx(value, abs=1e-12, nan_ok=True), name
    for name, ends in dataclasses.asdict(whole.intervals).items():
        assert getattr(total.intervals, name) == pytest.approx(ends, abs=1e-12), name
    assert (total.accompanied, total.dense, total.there) == (whole.accompanied, whole.dense, whole.there)
    three = Score.total([total, one])
    assert three.people is not None
    assert one.people is not None
    assert len(three.people.id) == len(total.people.id) + len(one.people.id)


def test_a_total_of_scores_from_json_has_no_intervals() -> None:
    one, other, _ = halves(0)
    lost = dataclasses.replace(one, people=None)
    total = Score.total([lost, other])
    assert math.isnan(total.intervals.ade[0])
    assert total.people is None
    with pytest.raises(InputError, match="no longer knows its people: score the forecast again"):
        lost.difference(one)


def test_predictors_are_compared_person_by_person() -> None:
    errors = stream(1, "errors").uniform(0.0, 1.0, 60)
    one = scored(list(errors), apart=True)
    other = scored(list(errors + 0.02), apart=True)
    assert one.intervals.ade[1] - one.intervals.ade[0] > 0.1  # apart, the two cannot be told from each other
    mean, (low, high) = one.difference(other)
    assert (mean, low, high) == pytest.approx((-0.02, -0.02, -0.02))
    assert other.difference(one, "fde")[0] == pytest.approx(0.02)
    with pytest.raises(InputError, match="there is no mean of 'persons', there are ade, fde, miss_rate"):
        one.difference(other, "persons")
    with pytest.raises(InputError, match="cannot be compared person by person"):
        one.difference(scored([0.1], apart=True))
    with pytest.raises(InputError, match="scores of ade of different people"):
        one.difference(scored(list(errors)))


def test_a_table_has_the_columns_that_have_something_to_say() -> None:
    plain, alone = scored([0.5, 0.7], apart=True), scored([0.5])
    sampled = score(*case(1, K=8))
    assert plain.columns == ("windows", "persons", "ADE [m]", "95 %", "FDE [m]", "collisions", "ms/window")
    assert "95 %" not in alone.columns
    assert sampled.columns == (*plain.columns[:5], "NLL", "energy", *plain.columns[5:])
    assert Score.heads([alone, sampled]) == sampled.columns
    for item in (plain, alone, sampled):
        assert len(item.cells()) == len(item.columns)
        assert len(item.cells(sampled.columns)) == len(sampled.columns)
    assert alone.cells(sampled.columns) == ("1", "1", "0.500", "-", "0.500", "-", "0.500", "-", "-")
    assert scored([0.5], units="px").columns[2:4] == ("ADE [px]", "FDE [px]")


def test_the_likelihood_says_of_how_many_people_it_is() -> None:
    half = dataclasses.replace(scored([0.5, 0.7], samples=2), nll=1.234, dense=1)
    assert "NLL 1.23 nat (50 %)" in str(half)
    assert "1.23 (50 %)" in half.cells()
    assert "1.23" in dataclasses.replace(half, dense=2).cells()


def test_scores_that_cannot_be_compared_are_not_added_up() -> None:
    with pytest.raises(InputError, match="scores with different protocol cannot be added up: 'all', 'sgan'"):
        Score.total([scored([1.0]), scored([1.0], protocol="sgan")])
    with pytest.raises(InputError, match="scores of different horizons cannot be added up: 3, 4 steps"):
        Score.total([scored([1.0]), scored([1.0], T=4)])
    with pytest.raises(InputError, match="a total needs at least one score"):
        Score.total([])


def test_recordings_in_pixels_are_scored_in_pixels_without_metric_limits() -> None:
    pixels = scored([50.0], units="px")
    assert "ADE 50.000 px" in str(pixels)
    assert math.isnan(pixels.miss_rate)


def test_nobody_to_score_is_an_error() -> None:
    here = np.ones((1, 2, 1), dtype=bool)
    future = Windows(
        np.zeros((1, 2, 1, 2)), here, ~here[:, 0], ~here[:, 0], np.array([[7]]), np.array([[0, 1]]), 0.4, "all", "empty"
    )
    with pytest.raises(InputError, match="protocol 'all' scores nobody in 1 windows of empty"):
        score(Forecast.of(np.zeros((1, 1, 2, 1, 2)), here[:, 0], 0.4, "mine"), future)
