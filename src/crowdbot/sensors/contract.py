"""Contract check for custom sensors."""

from __future__ import annotations

import dataclasses
from typing import Any

import numpy as np

from crowdbot.core import InputError, Pose, Scene, stream

from .lens import ImageSource
from .sensor import Reading, Sensor
from .view import SensorView

__all__ = ["check_sensor"]


def check_sensor(sensor: Sensor, renderer: ImageSource | None = None) -> None:
    """Check that a sensor keeps its contract in a small scene.

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
    if not all(_same(one, other) for one, other in zip(readings, _sequence(sensor, views), strict=True)):
        raise InputError(f"{name}.measure is not deterministic: the same input gave another reading")
    for view, time in zip(views, (0.0, 0.1, 0.2), strict=True):
        if not _same(view.scene.position, _scene(time).position) or not _same(view.pose.position, _pose(time).position):
            raise InputError(f"{name}.measure changes the view; it must only read it")
    if renderer is None:
        quiet = dataclasses.replace(sensor, noise=())
        alone = [SensorView(view.scene.environments([0]), Pose.of((0.0, 0.0), view.time)) for view in views]
        for one, both in zip(_sequence(quiet, alone), _sequence(quiet, views), strict=True):
            _check_alone(name, one, both)


def _sequence(sensor: Sensor, views: list[SensorView]) -> list[Reading]:
    """Return the readings of a sequence of views."""
    state, readings, rng = sensor.begin(), [], stream(1, "contract")
    name = type(sensor).__name__
    for view in views:
        answer: Any = sensor.measure(view, state, rng)
        if not (isinstance(answer, tuple) and len(answer) == 2 and isinstance(answer[0], Reading)):
            raise InputError(f"{name}.measure returned a {type(answer).__name__}, it must return (Reading, state)")
        reading, state = answer
        if reading.time != view.time:
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


def _pose(time: float) -> Pose:
    return Pose(np.array([[0.0, 0.0], [0.5, 0.0]]), np.array([time, 0.5]))


def _scene(time: float) -> Scene:
    """Return 2 environments with 4 people, one of them absent in the first."""
    position = np.array([[[1.0, 0.0], [2.0, 1.0], [-1.0, 0.5], [9.0, 0.0]]] * 2)
    position[..., 0] += time
    active = np.array([[True, True, True, False], [True, True, True, True]])
    walls = [[(-4.0, -2.0), (12.0, -2.0)]]
    return Scene.of(position, np.tile([1.0, 0.0], (2, 4, 1)), active=active, walls=walls, time=time)
