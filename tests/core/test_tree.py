"""Trees of arrays: every function keeps the structure, and the environments are those of the arrays."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import InputError, tree


@dataclass(frozen=True)
class Beams:
    """Plain fields, one of them without environments."""

    ranges: np.ndarray
    angles: np.ndarray
    time: float = 0.0
    shared_fields: ClassVar[tuple[str, ...]] = ("angles",)


@dataclass(frozen=True)
class Checked:
    """A class that computes a field of its own."""

    speed: np.ndarray
    total: float = field(init=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "total", float(self.speed.sum()))


class Pair(NamedTuple):
    first: Any
    second: Any


def whole(count: int, agents: int = 3) -> dict[str, Any]:
    """A tree of all kinds of containers, with the number of the environment in every value."""
    rows = np.arange(float(count))
    return {
        "beams": Beams(np.repeat(rows[:, None], agents, axis=1), np.arange(5.0), 0.5),
        "pair": Pair([rows.astype(np.int64), None], (rows > 0, "name")),
        "checked": Checked(rows),
    }


def numbers(value: dict[str, Any]) -> list[float]:
    """Numbers of the environments, which all parts must agree on."""
    rows: list[float] = value["beams"].ranges[:, 0].tolist()
    assert value["pair"].first[0].tolist() == rows
    assert value["checked"].speed.tolist() == rows
    assert value["checked"].total == sum(rows)
    assert value["pair"].second[0].tolist() == [row > 0 for row in rows]
    assert value["beams"].angles.tolist() == [0.0, 1.0, 2.0, 3.0, 4.0]
    return rows


@given(st.lists(st.integers(0, 3), min_size=1, max_size=6))
def test_taken_environments_are_copies_in_the_given_order(index: list[int]) -> None:
    value = whole(4)
    rows = tree.take(value, np.array(index))
    assert numbers(rows) == index
    rows["beams"].ranges[:] = -1.0
    assert numbers(value) == [0, 1, 2, 3]
    assert tree.count(rows, "rows") == len(index)


@given(st.permutations(range(4)), st.integers(0, 4))
def test_parts_join_to_the_whole(order: list[int], cut: int) -> None:
    value, places = whole(4), [np.array(order[:cut], dtype=np.int64), np.array(order[cut:], dtype=np.int64)]
    parts = [tree.take(value, place) for place in places]
    assert numbers(tree.join(parts, places, 4)) == [0, 1, 2, 3]
    assert numbers(tree.join(parts)) == order


def test_replaced_environments_leave_the_others_and_the_argument() -> None:
    value = whole(3)
    changed = tree.put(value, np.array([2, 0]), tree.take(whole(9), np.array([8, 7])))
    assert numbers(changed) == [7, 1, 8]
    assert numbers(value) == [0, 1, 2]


def test_numbers_that_differ_become_an_array() -> None:
    joined = tree.join([Beams(np.zeros((1, 2)), np.zeros(5), 0.5), Beams(np.zeros((2, 2)), np.zeros(5), 0.75)])
    assert joined.time.tolist() == [0.5, 0.75, 0.75]  # type: ignore[attr-defined]


@pytest.mark.parametrize(
    ("parts", "problem"),
    [
        ([np.zeros(1), None], "ndarray and another class"),
        ([{"a": np.zeros(1)}, {"b": np.zeros(1)}], "different parts of dict"),
        ([np.zeros((1, 2)), np.zeros((1, 3))], r"shapes \[\(2,\), \(3,\)\]"),
        ([("a", np.zeros(1)), ("b", np.zeros(1))], "different values of str"),
    ],
)
def test_other_structures_do_not_join(parts: list[Any], problem: str) -> None:
    with pytest.raises(TypeError, match=problem):
        tree.join(parts)


def test_the_second_axis_gets_another_length() -> None:
    value = {"group": np.array([[1, 2], [3, 4]]), "time": np.zeros(2)}
    wide = tree.resize(value, 3, {"group": -1})
    assert (wide["group"].tolist(), wide["group"].dtype) == ([[1, 2, -1], [3, 4, -1]], value["group"].dtype)
    assert tree.resize(wide, 1, {})["group"].tolist() == [[1], [3]]
    assert wide["time"] is value["time"]


def test_errors_name_the_path_of_the_array() -> None:
    value = {"beams": [Beams(np.zeros((2, 3)), np.zeros(5))], "more": np.zeros(3)}
    with pytest.raises(InputError, match=r"state\['more'\] has shape \[3\] but state\['beams'\]\[0\].ranges has 2"):
        tree.count(value, "state")
    with pytest.raises(InputError, match=r"state\['beams'\]\[0\].ranges has shape \[2, 3\] in 3 environments"):
        tree.check(value, 3, "state")
    with pytest.raises(InputError, match=r"state\['beams'\] is a object, which has no environments"):
        tree.count({"beams": object()}, "state")
