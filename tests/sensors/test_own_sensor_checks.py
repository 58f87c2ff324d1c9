"""check_sensor accepts sensors that keep the contract, and names the rule that others break."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.sensors import IMU, Bumper, GroundTruthPeople, Lidar2D, Sensor, SensorView, WheelOdometry, check_sensor
from crowdbot.sensors.noise import normals
from crowdbot.sensors.sensor import Reading

Rule = Callable[[SensorView, Any, np.random.Generator], Any]


@dataclass(frozen=True)
class Count(Reading):
    """Number of people ``[E]``, and what it is called."""

    count: np.ndarray
    name: str = "count"


def count(view: SensorView) -> np.ndarray:
    return np.count_nonzero(view.scene.active, axis=1)


def sensor(rule: Rule) -> Sensor:
    """Return a sensor with this rule; its state is the number of measurements."""

    def measure(self: Sensor, view: SensorView, state: Any, rng: np.random.Generator) -> Any:
        return rule(view, state, rng)

    body = {"measure": measure, "begin": lambda self: 0}
    return dataclass(frozen=True, kw_only=True)(type("Own", (Sensor,), body))()  # type: ignore[no-any-return]


def reading(view: SensorView, more: float = 0.0, late: float = 0.0) -> Count:
    return Count(view.time + late, view.pose, count(view) + more)


def plain(view: SensorView, state: int, rng: np.random.Generator) -> tuple[Count, int]:
    return Count(view.time, view.pose, count(view)), state + 1


def spoil(view: SensorView, state: int, rng: np.random.Generator) -> tuple[Count, int]:
    view.pose.position[0, 0] += 0.5
    return plain(view, state, rng)


class Chance:
    rng = np.random.default_rng(0)


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        (lambda view, state, rng: reading(view), "returned a Count, it must"),
        (lambda view, state, rng: (count(view), state), r"returned a tuple, it must return \(Reading, state\)"),
        (lambda view, state, rng: (reading(view), state, 1), "returned a tuple"),
        (lambda view, state, rng: (reading(view, late=0.1), state), "the time of the reading is 0.1 s"),
        (lambda view, state, rng: (reading(view, Chance.rng.random()), state), "not deterministic"),
        (spoil, "Own.measure (changes the view|is not deterministic)"),
        (lambda view, state, rng: (Count(view.time, view.pose, count(view)[:1] + len(view.scene.active)), state),
         r"count has shape \[1\] in 2 environments; the first axis must be the environments"),
        (lambda view, state, rng: (reading(view, len(view.scene.active)), state), "the same values"),
        (lambda view, state, rng: (reading(view, rng.random()), state), "fails with a list of one random generator"),
        (lambda view, state, rng: (reading(view, float(view.time)), state), "or with a time for each environment"),
        (lambda view, state, rng: (Count(np.max(view.time), view.pose, count(view)), state),
         r"the time of the reading is 5.0 s, it must be \[0. 5.\] s"),
        (lambda view, state, rng: (reading(view, np.max(state)), state + 1), "count of an environment differs"),
        (lambda view, state, rng: (reading(view), {1, 2}), "state of Own is a set, which has no environments"),
    ],
)  # fmt: skip
def test_a_sensor_that_breaks_a_rule_is_told_which(rule: Rule, message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_sensor(sensor(rule))


@pytest.mark.parametrize(
    "own",
    [
        sensor(plain),
        sensor(
            lambda view, state, rng: (
                Count(view.time, view.pose, count(view) + normals((view.environments,), rng), f"{state}"),
                state + 1,
            )
        ),
        sensor(lambda view, state, rng: (Count(view.time, view.pose, np.array(3.0)), state)),
    ],
    ids=["plain", "chance", "constant"],
)
def test_own_sensors_that_keep_the_rules_pass(own: Sensor) -> None:
    assert check_sensor(own) is None


@pytest.mark.parametrize("own", [Lidar2D(rays=8), IMU(), WheelOdometry(), GroundTruthPeople(), Bumper()],
                         ids=lambda own: type(own).__name__)  # fmt: skip
def test_sensors_of_the_package_pass(own: Sensor) -> None:
    assert check_sensor(own) is None


def test_a_sensor_is_asked_at_three_times_with_the_state_it_gave() -> None:
    seen: list[tuple[float, int]] = []

    def rule(view: SensorView, state: int, rng: np.random.Generator) -> tuple[Count, int]:
        seen.append((view.time, state))
        return plain(view, state, rng)

    assert check_sensor(sensor(rule)) is None
    assert seen[:3] == [(0.0, 0), (0.1, 1), (0.2, 2)]
    assert seen[3:6] == seen[:3]


def test_what_is_no_sensor_is_refused() -> None:
    with pytest.raises(InputError, match="str is not a Sensor"):
        check_sensor("lidar2d")  # type: ignore[arg-type]
