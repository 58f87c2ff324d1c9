"""Environments of a batch: own times, subsets, restarts, and readings of one environment."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np
import pytest
from crowds_in_space import crowd, somewhere

from crowdbot import sensors
from crowdbot.core import InputError, Pose, Scene, builtin_classes, stream
from crowdbot.sensors import (
    Reading,
    SensorView,
    StateGroups,
    join_readings,
    measure_rows,
    put_state_rows,
    take_state_rows,
)

SENSORS = builtin_classes(sensors, sensors.Sensor)
every_sensor = pytest.mark.parametrize("kind", SENSORS.values(), ids=list(SENSORS))
COUNT = 4
FEW = {"rays": 24, "columns": 12, "width": 8, "height": 6, "segmentation": True}
DRIFT = {"slip": 0.05, "acceleration_walk": 0.02, "turn_walk": 0.01, "acceleration_offset": 0.3, "turn_noise": 0.1}
NOISE = (sensors.Gaussian(0.01), sensors.Peak(0.2, 0.5, 0.1), sensors.Dropout(0.1))


def small(kind: Any) -> Any:
    """The sensor with few beams and all its errors."""
    fields = {n: v for n, v in (FEW | DRIFT).items() if n in kind.__dataclass_fields__}
    return kind(**fields, noise=NOISE)


def view_at(step: np.ndarray, index: list[int], planar: bool = False) -> SensorView:
    """A view of some of the environments, each at its own step."""
    scene = crowd(3, environments=COUNT).environments(index)
    moved = scene.replace(position=scene.position + 0.05 * step[:, None, None], time=0.1 * step + np.array(index))
    pose = somewhere(3, COUNT)
    here = type(pose)(pose.position[index] + 0.1 * step[:, None] ** 2, pose.rotation[index])
    if not planar:
        return SensorView(moved, here)
    return SensorView(moved.replace(bodies=None), here.planar)


def single(view: SensorView) -> SensorView:
    """The view of one environment with the time as a number."""
    return SensorView(view.scene.replace(time=float(view.time[0])), view.pose)  # type: ignore[index]


def leaves(value: Any) -> list[Any]:
    """All arrays and numbers of a reading or state."""
    if dataclasses.is_dataclass(value):
        return [leaf for field in dataclasses.fields(value) for leaf in leaves(getattr(value, field.name))]
    return [np.asarray(value)]


def assert_same(one: Any, two: Any) -> None:
    assert type(one) is type(two)
    for a, b in zip(leaves(one), leaves(two), strict=True):
        assert a.dtype == b.dtype
        assert a.shape == b.shape
        assert a.tobytes() == b.tobytes()


def rngs(index: list[int] | range, again: int = 0) -> list[np.random.Generator]:
    return [stream(5, "sensor", e, again) for e in index]


@every_sensor
@pytest.mark.parametrize("planar", [False, True])
def test_due_environments_measure_together_as_each_alone(kind: Any, planar: bool) -> None:
    """A subset measures and its rows are put back; an environment that starts again equals a new one."""
    sensor = small(kind)
    steps, state, streams = np.zeros(COUNT), sensor.begin(), rngs(range(COUNT))
    alone = [(sensor.begin(), rng) for rng in rngs(range(COUNT))]
    for turn, (due, restart) in enumerate([([0, 1, 2, 3], []), ([3, 1], []), ([1, 2, 3], [2]), ([2, 0, 1], [0, 1])]):
        for e in restart:
            state = put_state_rows(state, [e], sensor.begin(), COUNT)
            streams[e], steps[e] = stream(5, "sensor", e, turn), 0.0
            alone[e] = (sensor.begin(), stream(5, "sensor", e, turn))
        view = view_at(steps[due], due, planar)
        reading, rows = measure_rows(sensor, view, take_state_rows(state, due), [streams[e] for e in due])
        state = put_state_rows(state, due, rows, COUNT)
        assert np.array_equal(reading.time, view.time)
        for row, e in enumerate(due):
            before, rng = alone[e]
            told, after = sensor.measure(single(view.select([row])), before, rng)
            alone[e] = (after, rng)
            assert_same(reading.environment(row), told)
            kept = take_state_rows(state, [e])
            if kept is not None:
                kept = dataclasses.replace(kept, time=float(np.ravel(kept.time)[0]))
            assert_same(kept, after)
        steps[due] += 1.0


@every_sensor
def test_readings_of_parts_join_to_the_reading_of_all(kind: Any) -> None:
    sensor, everything = small(kind), view_at(np.zeros(COUNT), list(range(COUNT)))
    parts = [[2, 0], [1], [3]]
    whole = sensor.measure(everything, sensor.begin(), rngs(range(COUNT)))[0]
    some = [sensor.measure(everything.select(part), sensor.begin(), rngs(part))[0] for part in parts]
    assert_same(join_readings(some, parts), whole)
    assert_same(whole.select([2, 0]), some[0])
    assert isinstance(whole.environment(1).time, float)
    for name in type(whole).shared_fields:
        assert getattr(whole.environment(1), name) is getattr(whole, name)


@every_sensor
def test_one_time_for_all_environments_equals_an_array_of_it(kind: Any) -> None:
    sensor = small(kind)
    scene, pose = crowd(4, environments=2), somewhere(4, 2)
    one, many, drawn = sensor.begin(), sensor.begin(), (rngs(range(2)), rngs(range(2)))
    for step in range(3):
        place = pose.offset(0.1 * step, 0.0, 0.0, 0.0, 0.0, 0.1 * step)
        time = 0.1 * step
        first, one = sensor.measure(SensorView(scene.replace(time=time), place), one, drawn[0])
        array = scene.replace(time=np.array([time, time]))
        second, many = sensor.measure(SensorView(array, place), many, drawn[1])
        assert_same(dataclasses.replace(second, time=time), first)


@dataclass(frozen=True)
class Table(Reading):
    shared_fields: ClassVar[tuple[str, ...]] = ("angles",)
    values: np.ndarray
    angles: np.ndarray
    name: str = "table"


def test_shared_fields_keep_their_length() -> None:
    reading = Table(0.5, Pose.of(np.zeros((3, 2)), 0.0), np.arange(3.0), np.arange(3.0))
    one = reading.environment(2)
    assert (one.values.tolist(), one.angles.tolist(), one.time, one.name) == ([2.0], [0.0, 1.0, 2.0], 0.5, "table")
    assert one.pose.position.shape == (1, 2)
    assert not np.shares_memory(one.values, reading.values)
    assert one.angles is reading.angles


def test_an_array_without_environments_is_rejected() -> None:
    reading = Table(0.5, Pose.of(np.zeros((3, 2)), 0.0), np.arange(2.0), np.arange(3.0))
    with pytest.raises(InputError, match=r"Table.values has shape \[2\] in 3 environments; .* list .* shared_fields"):
        reading.environment(0)
    sound = dataclasses.replace(reading, values=np.arange(3.0))
    with pytest.raises(InputError, match=r"Table: the environments are \[3\], each must be from 0 to 2"):
        sound.select([3])
    with pytest.raises(InputError, match="Table: the environment is 3, it must be from 0 to 2"):
        sound.environment(3)
    with pytest.raises(InputError, match="must be a list of whole numbers"):
        sound.select([0.5])


def test_readings_that_do_not_fit_are_not_joined() -> None:
    one = Table(0.5, Pose.of((0.0, 0.0), 0.0), np.arange(1.0), np.arange(3.0))
    with pytest.raises(InputError, match=r"Table: the environments are \[0, 2\], they must be 0 to E - 1, each once"):
        join_readings([one, one], [[0], [2]])
    with pytest.raises(InputError, match="different classes, fields or shapes"):
        join_readings([one, Reading(0.5, one.pose)], [[0], [1]])
    with pytest.raises(InputError, match="readings: the environments are"):
        join_readings([], [])
    other = dataclasses.replace(one, time=0.75)
    assert join_readings([one, other], [[1], [0]]).time.tolist() == [0.75, 0.5]  # type: ignore[union-attr]


class Filter(NamedTuple):
    time: float
    weights: dict[str, np.ndarray]
    history: list[np.ndarray]
    label: str = "filter"


def test_states_of_tuples_lists_and_dicts() -> None:
    state = Filter(0.0, {"a": np.arange(3.0)}, [np.arange(6).reshape(3, 2)])
    rows = take_state_rows(state, [2, 0])
    assert (rows.weights["a"].tolist(), rows.history[0].tolist()) == ([2.0, 0.0], [[4, 5], [0, 1]])
    changed = put_state_rows(state, [2, 0], Filter(1.0, {"a": np.array([8.0, 9.0])}, [np.full((2, 2), 7)]))
    assert isinstance(changed, Filter)
    assert changed.time.tolist() == [1.0, 0.0, 1.0]  # type: ignore[attr-defined]
    assert changed.weights["a"].tolist() == [9.0, 1.0, 8.0]
    assert changed.history[0].tolist() == [[7, 7], [2, 3], [7, 7]]
    assert state.weights["a"].tolist() == [0.0, 1.0, 2.0]


def test_numbers_become_arrays_where_environments_differ() -> None:
    assert put_state_rows(3, [1], 3, 4) == 3
    assert put_state_rows(3, [1], 0, 4).tolist() == [3, 0, 3, 3]
    assert take_state_rows(np.array([3, 0, 3, 3]), [1, 0]).tolist() == [0, 3]
    assert math.isnan(put_state_rows(math.nan, [1], math.nan, 4))


def test_groups_of_different_structure() -> None:
    mixed = put_state_rows(np.arange(4.0), [2, 0], None)
    assert isinstance(mixed, StateGroups)
    assert (mixed.count, take_state_rows(mixed, [0, 2])) == (4, None)
    assert take_state_rows(mixed, [3, 1]).tolist() == [3.0, 1.0]
    part = take_state_rows(mixed, [3, 2, 1])
    assert [where.tolist() for where in part.environments] == [[0, 2], [1]]
    whole = put_state_rows(mixed, [0, 2], np.array([10.0, 12.0]))
    assert whole.tolist() == [10.0, 1.0, 12.0, 3.0]
    assert put_state_rows(mixed, [1, 3], None) is None
    started = put_state_rows(None, [1], np.array([5.0]), 2)
    assert take_state_rows(started, [1]).tolist() == [5.0]
    assert put_state_rows(None, [1], None) is None


@pytest.mark.parametrize(
    ("call", "message"),
    [
        (lambda: take_state_rows(np.arange(3.0), [3]), r"state: the environments are \[3\], each must be from 0 to 2"),
        (lambda: take_state_rows(None, [-1]), "each must be at least 0"),
        (lambda: take_state_rows({"a": np.zeros(2), "b": np.zeros(3)}, [0]), "the first axis must be the environments"),
        (lambda: take_state_rows(object(), [0]), "state is a object, which has no environments; use None, numbers"),
        (lambda: put_state_rows(np.zeros(3), [1, 1], np.zeros(2)), "each must occur once"),
        (lambda: put_state_rows(np.zeros(3), [1], np.zeros(2)), "2 rows were given for 1 environments"),
        (lambda: put_state_rows(None, [1], np.zeros(1)), "pass environments=E"),
        (lambda: put_state_rows(np.zeros(3), [1], None, 4), "it has 3 environments, not 4"),
    ],
)
def test_wrong_rows_of_states_are_rejected(call: Any, message: str) -> None:
    with pytest.raises(InputError, match=message):
        call()


def test_a_state_of_another_number_of_environments_is_rejected() -> None:
    scene = Scene.of(np.zeros((3, 1, 2)) + 2.0)
    mixed = put_state_rows(np.zeros(2), [1], None)
    with pytest.raises(InputError, match="IMU: the state has 2 environments, but the view has 3"):
        measure_rows(sensors.IMU(), SensorView(scene, Pose.of(np.zeros((3, 2)), 0.0)), mixed)


@pytest.mark.parametrize("kind", [sensors.IMU, sensors.WheelOdometry])
def test_time_must_increase_in_every_environment(kind: Any) -> None:
    scene, pose = Scene.of(np.ones((2, 1, 2))), Pose.of(np.zeros((2, 2)), 0.0)
    first = SensorView(scene.replace(time=np.array([1.0, 2.0])), pose)
    _, state = kind().measure(first, None)
    with pytest.raises(InputError, match=r"previous measurement is at 2.0 s and this one at 2.0 s; time must increase"):
        kind().measure(SensorView(scene.replace(time=np.array([1.5, 2.0])), pose), state)
    wrong = SensorView(scene.replace(time=np.zeros(3)), pose)
    with pytest.raises(InputError, match=r"time has shape \[3\], it must be a number or \[2\]"):
        kind().measure(wrong, None)


class Images:
    """A renderer of 3 environments that paints the position of the camera."""

    def render(self, camera: Any, pose: Any) -> dict[str, np.ndarray]:
        assert len(pose.position) == 3
        shade = (pose.position[:, 0] * 10).astype(np.uint8)
        number = np.arange(3, dtype=np.uint8)
        return {"rgb": np.stack([shade, number, number], axis=-1)[:, None, None] * np.ones((1, 6, 8, 1), np.uint8)}


def test_a_view_of_some_environments_selects_their_images() -> None:
    scene = Scene.of(np.full((3, 1, 2), 9.0)).replace(time=np.array([0.0, 1.0, 2.0]))
    pose = Pose.of([[1.0, 0.0], [2.0, 0.0], [3.0, 0.0]], 0.0)
    view = SensorView(scene, pose, Images()).select([2, 1])
    image, _ = sensors.RGBCamera(width=8, height=6).measure(view, None)
    assert image.rgb[:, 0, 0].tolist() == [[30, 2, 2], [20, 1, 1]]
    assert image.time.tolist() == [2.0, 1.0]  # type: ignore[union-attr]
