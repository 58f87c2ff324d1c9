"""Trees of arrays: every function keeps the structure, and the environments are those of the arrays."""

from __future__ import annotations

from collections import deque
from dataclasses import dataclass, field
from typing import Any, ClassVar, NamedTuple

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from crowdbot.core import InputError, RandomStreams, StateError, StateMark, Storage, storable, tree


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


@storable
@dataclass(frozen=True)
class StoredBeams:
    """A value with a field of its own, and one that belongs to the trial."""

    ranges: np.ndarray
    walls: Any
    largest: float = field(init=False)
    storage = Storage(constants=("walls",))

    def __post_init__(self) -> None:
        object.__setattr__(self, "largest", float(self.ranges.max()))


class Motor:
    """An object that exists in every run."""

    storage = Storage(constants=("limit",), properties=("turns",))

    def __init__(self, limit: float) -> None:
        self.limit, self.angle, self.load = limit, 0.0, np.zeros(2)

    @property
    def turns(self) -> int:
        return int(self.angle // 6.28)

    @turns.setter
    def turns(self, turns: int) -> None:
        if turns > self.limit:
            raise InputError(f"{turns} turns are more than {self.limit}")


class Geared(Motor):
    """A subclass with constants of its own and an array whose length changes."""

    storage = Storage(constants=("ratio",), resized=("teeth",))

    def __init__(self, limit: float) -> None:
        super().__init__(limit)
        self.ratio, self.teeth = 3.0, np.zeros(0)


def machine(angle: float, ratio: float = 3.0) -> dict[str, Any]:
    motor = Geared(9.0)
    motor.angle, motor.ratio, motor.teeth, motor.load = angle, ratio, np.arange(angle), np.full(2, angle)
    values = StoredBeams(np.full((1, 2), angle), object())
    history: deque[Any] = deque([motor.load, None, np.float64(angle)], maxlen=4)
    return {"motor": motor, "beams": values, "history": history, "rngs": RandomStreams([int(angle)], "tree")}


def test_a_stored_tree_restores_the_objects_that_exist() -> None:
    first, second = machine(7.0), machine(2.0, ratio=5.0)
    first["rngs"][0].random(3)
    motor, walls = second["motor"], second["beams"].walls
    restored = tree.unflatten(tree.flatten(first), second)
    assert restored["motor"] is motor
    assert (motor.angle, motor.ratio, motor.teeth.tolist()) == (7.0, 5.0, [0, 1, 2, 3, 4, 5, 6])
    assert (restored["beams"].largest, restored["beams"].walls) == (7.0, walls)
    assert restored["history"][0] is motor.load
    assert (restored["history"].maxlen, type(restored["history"][2])) == (4, np.float64)
    assert restored["rngs"][0].random() == first["rngs"][0].random()
    assert tree.flatten(restored).keys() == tree.flatten(first).keys()


@pytest.mark.parametrize(
    ("change", "problem"),
    [
        ({"tree/0/value/turns": 12}, "tree/0/value/turns: 12 turns are more than 9.0"),
        ({"tree/0/value/load": np.zeros(3)}, r"has the shape \[3\], but the trial has \[2\]"),
        ({"tree/0/value/load": np.zeros((1, 2))}, "has 2 axes of float64, but the trial has 1"),
        ({"tree/0/value": StateMark("value", "Popen")}, "is a 'Popen', which is unknown"),
        ({"tree/3/value": StateMark("plain", [])}, "is a 'plain', which is unknown"),
        ({"tree/9": 1}, "has a value 'tree/9', which this trial does not have"),
    ],
)
def test_leaves_that_do_not_fit_are_refused(change: dict[str, Any], problem: str) -> None:
    with pytest.raises(StateError, match=problem):
        tree.unflatten(tree.flatten(machine(7.0)) | change, machine(2.0))


class Wagons:
    """An object with state, a constant, and a constant by environment."""

    storage = Storage(constants=("length", "owners"), environments=("owners",), shared=("built",))

    def __init__(self, loads: list[list[int]]) -> None:
        self.loads, self.speed = tree.objects(loads), np.arange(float(len(loads)))
        self.owners, self.length, self.built = tree.objects(loads), np.zeros(7), np.zeros(5)


def test_environments_of_objects_are_copied_and_constants_shared() -> None:
    train = Wagons([[1], [2], [3]])
    some = tree.take(train, np.array([2, 0, 2]))
    some.loads[0].append(9)
    assert (some.loads.tolist(), some.speed.tolist()) == ([[3, 9], [1], [3]], [2.0, 0.0, 2.0])
    assert (train.loads.tolist(), train.speed.tolist()) == ([[1], [2], [3]], [0.0, 1.0, 2.0])
    assert some.owners[0] is train.owners[2]
    assert some.length is train.length
    assert some.built is train.built
    whole = tree.put(train, np.array([1]), Wagons([[8]]))
    assert (whole.loads.tolist(), whole.speed.tolist(), tree.count(whole)) == ([[1], [8], [3]], [0.0, 0.0, 2.0], 3)
    assert tree.join([train, some]).owners.tolist() == [[1], [2], [3], [3], [1], [3]]


def test_an_object_of_an_unknown_class_is_not_stored() -> None:
    with pytest.raises(StateError, match="tree/0 is a Pair, which cannot be stored"):
        tree.flatten([Pair(1, 2)])
