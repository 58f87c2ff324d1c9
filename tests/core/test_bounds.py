"""Ranges of numbers: their ends, their text, and the first number outside."""

import math

import numpy as np
import pytest

from crowdbot.core import Bounds, InputError, check_number


@pytest.mark.parametrize(
    ("bounds", "inside", "outside"),
    [
        (Bounds(min=1.0, max=2.0), [1.0, 1.5, 2.0], [0.999, 2.001]),
        (Bounds(exclusive_min=1.0, exclusive_max=2.0), [1.001, 1.999], [1.0, 2.0]),
        (Bounds(), [-1e300, 0, 1e300], []),
        (Bounds(whole=True), [-3, 0.0, 4.0], [0.5]),
    ],
)
def test_ends_are_inside_or_not(bounds, inside, outside):
    assert all(bounds.holds(value) for value in inside)
    assert bounds.holds(np.array(inside, dtype=float))
    for value in [*outside, math.nan, math.inf, -math.inf]:
        assert not bounds.holds(value)
        assert not bounds.holds([*inside, value])
        assert bounds.worst([*inside, value]) == pytest.approx(value, nan_ok=True)
    assert not bounds.holds("three")


@pytest.mark.parametrize(
    ("bounds", "text"),
    [
        (Bounds("m", min=0.25), "finite and at least 0.25 m, without an upper limit"),
        (Bounds("m", max=3), "finite and at most 3 m, without a lower limit"),
        (Bounds(exclusive_min=1e8, exclusive_max=12345678.5), "above 1e+08 and below 1.23457e+07"),
        (Bounds(min=-5.0, max=99_999_999.0), "at least -5 and at most 99999999"),
        (Bounds(), "finite"),
        (Bounds(whole=True), "a whole number"),
    ],
)
def test_the_text_tells_both_ends(bounds, text):
    assert bounds.describe() == text


def test_the_upper_end_comes_first_if_asked_for():
    assert Bounds("s", min=0.0, max=1.0).describe(high_first=True) == "at most 1 s and at least 0 s"


def test_a_wrong_number_is_shown_with_its_owner_and_unit():
    check_number("A", "b", 1.0, "m", min=1.0, max=1.0)
    check_number("A", "b", 2.0, "m", min=1.0, max=2.0)
    with pytest.raises(InputError, match=r"^A: b = 2.0 m must be at least 1 m and at most 1 m$"):
        check_number("A", "b", 2.0, "m", min=1.0, max=1.0)
    with pytest.raises(InputError, match=r"^A: b = 0.5 must be a whole number$"):
        check_number("A", "b", 0.5, whole=True)
