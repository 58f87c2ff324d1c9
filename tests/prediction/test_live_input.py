"""Frames that no tracker should send are refused in a sentence, and change nothing."""

from __future__ import annotations

import datetime
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.prediction import ConstantVelocity, Live

TWO = [[0.0, 0.0], [3.0, 1.0]]


@pytest.mark.parametrize(
    ("ids", "position", "words"),
    [
        ([1, 2], [[0.0, 0.0, 1.7], [3.0, 1.0, 1.7]],
         r"position has shape \[2, 3\], it must be \[2, 2\], x and y \[m\]; pass position\[:, :2\]"),
        ([1], [0.0, 0.0], r"position has shape \[2\], it must be \[1, 2\].*one row for each identity"),
        ([1, 2], [[0.0], [1.0]], r"position has shape \[2, 1\]"),
        ([1, 2], np.zeros((2, 2, 1)), r"position has shape \[2, 2, 1\]"),
        ([1, 2], [[0.0, 0.0], [1.0]], r"position must be numbers \[N, 2\].*rows differ in length"),
        ([1], [["left", "right"]], r"position must be numbers \[N, 2\]"),
        ([1], None, r"position has shape \[\], it must be \[1, 2\]"),
        ([], [[0.0, 0.0]], "0 identities and 1 positions"),
        ([1, 2], [[0.0, 0.0]], "2 identities and 1 positions; the numbers must be equal"),
        (["a", "b"], [[0.0, 0.0], [np.inf, 1.0]], r"position of 'b' is not finite: \[inf, 1.0\]; leave people"),
        ([1.5, 2], TWO, "1.5 in ids is no identity; an identity is a whole number, a text"),
        ([np.nan, 2], TWO, "nan in ids is no identity"),
        (np.array([0.0, 0.5]), TWO, "0.5 in ids is no identity"),
        ([None, 2], TWO, "None in ids is no identity.*leave people without one out"),
        ([True, False], TWO, "True in ids is no identity"),
        ([[1], [2]], TWO, r"\[1\] in ids is no identity: a list is not hashable"),
        (np.array([[1], [2]]), TWO, r"ids have shape \[2, 1\], they must be \[N\]"),
        (np.array(7), TWO, r"ids have shape \[\]"),
        (7, [[0.0, 0.0]], r"ids = 7 must be a list of identities.*write \[7\]"),
        ("ab", TWO, r"ids = 'ab' must be a list"),
        (None, TWO, "ids = None must be a list"),
        ([4, 4.0], TWO, "identity 4 occurs 2 times in a frame of 2"),
        ([np.int32(4), 4], TWO, "identity 4 occurs 2 times"),
    ],
)  # fmt: skip
def test_a_wrong_frame_is_refused(ids: Any, position: Any, words: str) -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    live.update([3], [[1.0, 1.0]], time=2.0)
    before = live.predict(2).position
    with pytest.raises(InputError, match=f"^live: .*{words}"):
        live.update(ids, position, time=2.4)
    assert live.ids.tolist() == [3]
    np.testing.assert_array_equal(live.predict(2).position, before)


@pytest.mark.parametrize(
    ("time", "words"),
    [
        (np.nan, "time stamp nan s must be finite; leave it out"),
        (np.inf, "time stamp inf s must be finite"),
        ("0.4", "time = '0.4' must be a number of seconds"),
        (datetime.datetime(2026, 1, 1, tzinfo=datetime.UTC), r"of a datetime its timestamp\(\)"),
        ([0.4], "must be a number of seconds; of a ROS stamp"),
    ],
)
def test_a_wrong_stamp_is_refused(time: Any, words: str) -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    with pytest.raises(InputError, match=f"^live: .*{words}"):
        live.update([3], [[1.0, 1.0]], time=time)
    assert live.ids.tolist() == []


def test_robots_are_identities_too() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    with pytest.raises(InputError, match=r"live: robots = 'nao' must be a list of identities.*write \['nao'\]"):
        live.update(["nao"], [[0.0, 0.0]], robots="nao")
    with pytest.raises(InputError, match="live: 0.5 in robots is no identity"):
        live.update(["nao"], [[0.0, 0.0]], robots=[0.5])


def test_wrong_plans_and_walls_are_refused() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    live.update([1], [[0.0, 0.0]])
    for plan in ("left", [[0.0, 0.0], [1.0]], None):
        with pytest.raises(InputError, match="the plan of (a )?robot"):
            live.predict(2, plans={1: plan})  # type: ignore[dict-item]
    for walls in ([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0]], [[[0.0, np.nan]]], ["wall"]):
        with pytest.raises(InputError, match="live: a ring of walls"):
            Live(ConstantVelocity(), dt=0.4, walls=walls)


class Scalar:
    """A number in a tensor: equal numbers have different hashes."""

    shape = ()

    def __init__(self, value: float) -> None:
        self.value = value

    def item(self) -> float:
        return self.value


def test_whole_numbers_of_any_type_are_the_same_identity() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    for row, who in enumerate([7, 7.0, np.float32(7.0), np.uint8(7), np.array(7), Scalar(7.0)]):
        live.update([who], [[0.4 * row, 0.0]])
    live.update(np.array([7.0]), [[2.4, 0.0]])
    assert live.ids.tolist() == [7]
    assert live.past().present.sum() == 7


def test_a_buffer_that_the_tracker_writes_again_is_copied() -> None:
    live, buffer = Live(ConstantVelocity(), dt=0.4), np.zeros((1, 2))
    for row in range(3):
        buffer[0, 0] = 0.4 * row
        live.update([1], buffer)
    np.testing.assert_allclose(live.predict(1).position[0, 0, 0, 0], [1.2, 0.0])


def test_an_empty_frame_has_any_empty_shape() -> None:
    live = Live(ConstantVelocity(), dt=0.4)
    for position in ([], np.zeros((0, 2)), np.zeros((0, 3))):
        live.update([], position)
    assert live.predict(2).position.shape == (1, 1, 2, 0, 2)
