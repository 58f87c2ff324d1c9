"""Contract check for custom sensors."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, Pose, Scene, stream, tree

from .lens import ImageSource
from .noise import Randomness
from .sensor import Reading, Sensor
from .state_rows import measure_rows, put_state_rows, take_state_rows
from .view import SensorView

STEPS = (((0, 1), ()), ((1,), ()), ((0, 1), ()), ((0, 1), (0,)), ((0,), ()))
"""Environments that measure in each step of a batch, and those that start again before it."""
STARTS = (0.0, 5.0)
"""Time [s] of the first step of each environment in a batch."""


def check_sensor(sensor: Sensor, renderer: ImageSource | None = None) -> None:
    """Check that a sensor keeps its contract in a small scene.

    Without a renderer, 2 environments with own times and own random generators also measure together: only one of them
    is due, one starts again. The values must be those of each environment alone.

    Args:
        sensor: the sensor.
        renderer: renderer of 2 environments, for cameras.

    Raises:
        InputError: the first violated rule.

    >>> from crowdbot.sensors import Lidar2D
    >>> check_sensor(Lidar2D(rays=36))
    """
    name = type(sensor).__name__
    if not isinstance(sensor, Sensor):
        raise InputError(f"{name} is not a Sensor")
    parameters = getattr(sensor, "__dataclass_params__", None)
    if parameters is None or not parameters.frozen:
        raise InputError(f"{name} is not frozen; decorate the class with @dataclass(frozen=True, kw_only=True)")
    views = [SensorView(_scene(time), _pose(time), renderer) for time in (0.0, 0.1, 0.2)]
    readings = _sequence(sensor, views)
    if not all(_same(reading, other) for reading, other in zip(readings, _sequence(sensor, views), strict=True)):
        raise InputError(f"{name}.measure is not deterministic: the same input gave another reading")
    for view, time in zip(views, (0.0, 0.1, 0.2), strict=True):
        if not _same(view.scene.position, _scene(time).position) or not _same(view.pose.position, _pose(time).position):
            raise InputError(f"{name}.measure changes the view; it must only read it")
    if renderer is None:
        quiet = dataclasses.replace(sensor, noise=())
        alone = [SensorView(view.scene.environments([0]), Pose.of((0.0, 0.0), view.time)) for view in views]
        own = [stream(1, "contract", e) for e in range(2)], [stream(1, "contract", 0)]
        for both, item in zip(_sequence(quiet, views, own[0]), _sequence(quiet, alone, own[1]), strict=True):
            _check_alone(name, item, both)
        _check_batch(sensor)


def _sequence(sensor: Sensor, views: list[SensorView], rng: Randomness | None = None) -> list[Reading]:
    """Return the readings of a sequence of views, with one random generator or with that of each environment."""
    state, readings, one = sensor.begin(), [], stream(1, "contract")
    name = type(sensor).__name__
    for view in views:
        answer: Any = sensor.measure(view, state, one) if rng is None else _measure_batch(sensor, view, state, rng)
        if not (isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[0], Reading)):
            raise InputError(f"{name}.measure returned a {type(answer).__name__}, it must return (Reading, state)")
        reading, state = answer
        if not np.array_equal(reading.time, view.time):
            raise InputError(f"{name}: the time of the reading is {reading.time} s, it must be {view.time} s")
        readings.append(reading)
    return readings


def _check_alone(name: str, alone: Reading, both: Reading) -> None:
    """Check the arrays that have environments first."""
    for field in dataclasses.fields(both):
        one, two = getattr(alone, field.name), getattr(both, field.name)
        if not isinstance(two, np.ndarray) or two.ndim == 0 or _same(one, two):  # equal: not an array by environment
            continue
        if two.shape[0] != 2 or not _same(np.asarray(one)[:1], two[:1]):
            raise InputError(
                f"{name}: {field.name} has shape {list(two.shape)} in 2 environments; the first axis must be the"
                " environments, and each environment must give the same values alone"
            )


def _check_batch(sensor: Sensor) -> None:
    """Compare environments that measure together, with own times and generators, with the same environments alone."""
    alone = [_readings_alone(sensor, e) for e in range(2)]
    name = type(sensor).__name__
    rngs = [stream(1, "contract", e) for e in range(2)]
    begun, state, counts = sensor.begin(), sensor.begin(), [0, 0]
    for due, restarts in STEPS:
        for e in restarts:
            state, counts[e], rngs[e] = put_state_rows(state, [e], begun, 2), 0, stream(1, "contract", e)
        time = np.array([STARTS[e] + 0.1 * counts[e] for e in due])
        view = SensorView(_scene(time, due), _pose(time, due))
        reading, rows = _measure_batch(sensor, view, take_state_rows(state, due), [rngs[e] for e in due])
        tree.count(rows, f"state of {name}")
        state = rows if len(due) == 2 else put_state_rows(state, due, rows, 2)
        if not np.array_equal(reading.time, time):
            raise InputError(f"{name}: the time of the reading is {reading.time} s, it must be {time} s")
        for row, e in enumerate(due):
            _check_row(name, alone[e][counts[e]], reading.environment(row))
            counts[e] += 1


def _readings_alone(sensor: Sensor, e: int) -> list[Reading]:
    state, readings, rng = sensor.begin(), [], [stream(1, "contract", e)]
    for step in range(len(STEPS)):
        time = STARTS[e] + 0.1 * step
        reading, state = _measure_batch(sensor, SensorView(_scene(time, (e,)), _pose(time, (e,))), state, rng)
        readings.append(reading)
    return readings


def _measure_batch(sensor: Sensor, view: SensorView, state: Any, rng: Randomness) -> tuple[Reading, Any]:
    try:
        return measure_rows(sensor, view, state, rng)
    except (AttributeError, TypeError) as error:
        raise InputError(
            f"{type(sensor).__name__}.measure fails with a list of one random generator for each environment, or with"
            f" a time for each environment: {error}; draw with apply_noise or from rng[e] for environment e"
        ) from error


def _check_row(name: str, alone: Reading, row: Reading) -> None:
    for field in dataclasses.fields(row):
        one, two = getattr(alone, field.name), getattr(row, field.name)
        if isinstance(two, np.ndarray) and not _same(one, two):
            raise InputError(
                f"{name}: {field.name} of an environment differs between a measurement alone and one together with"
                " others, which have another time, are not due or start again"
            )


def _same(one: Any, other: Any) -> bool:
    if dataclasses.is_dataclass(one):
        return type(one) is type(other) and all(
            _same(getattr(one, field.name), getattr(other, field.name)) for field in dataclasses.fields(one)
        )
    if isinstance(one, tuple | list):
        return len(one) == len(other) and all(map(_same, one, other))
    if isinstance(one, np.ndarray):
        return np.array_equal(one, other, equal_nan=one.dtype.kind == "f")
    return np.array_equal(np.asarray(one), np.asarray(other), equal_nan=isinstance(one, float))


def _pose(time: ArrayLike, environments: tuple[int, ...] = (0, 1)) -> Pose:
    """Return poses of the environments; the first turns with time."""
    heading = np.where(np.array(environments) == 0, time, 0.5)
    return Pose(np.array([[0.5 * e, 0.0] for e in environments]), heading)


def _scene(time: ArrayLike, environments: tuple[int, ...] = (0, 1)) -> Scene:
    """Return environments with 4 people, one of them absent in the first, at one time or at one each."""
    count = len(environments)
    position = np.array([[[1.0, 0.0], [2.0, 1.0], [-1.0, 0.5], [9.0, 0.0]]] * count)
    position[..., 0] += np.reshape(time, (-1, 1))
    active = np.array([[True, True, True, False], [True, True, True, True]])[list(environments)]
    walls = [[(-4.0, -2.0), (12.0, -2.0)]]
    scene = Scene.of(position, np.tile([1.0, 0.0], (count, 4, 1)), active=active, walls=walls)
    return scene.replace(time=time)
