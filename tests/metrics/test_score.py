"""Scores carry their protocol, become JSON and add up by persons."""

import dataclasses
import json
import math

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.data import Forecast, Windows
from crowdbot.metrics import Score, score


def scored(errors: list[float], T: int = 3, protocol: str = "all", units: str = "m", samples: int = 1) -> Score:
    """The score of a forecast that is off by ``errors`` [m], one person in each of as many windows."""
    W = len(errors)
    here = np.ones((W, T, 1), dtype=bool)
    future = Windows(
        np.zeros((W, T, 1, 2)), here, here[:, 0], ~here[:, 0], np.zeros((W, 1), int), np.zeros((W, T), int), 0.4,
        protocol, f"street{W}", units=units,
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
    one = dataclasses.replace(scored([0.5, 2.5]), collisions=0.25, together=2, seconds_per_window=0.01)
    again = json.loads(json.dumps(one.as_dict(), allow_nan=False))
    again["horizon"], again["there"] = tuple(again["horizon"]), tuple(again["there"])
    assert Score(**again) == one
    assert one.miss_rate == 0.5


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
