"""check_navigator accepts navigators that keep the contract, and names the rule that others break."""

from __future__ import annotations

import math
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from crowdbot import navigation
from crowdbot.core import InputError, Twist, builtin_classes
from crowdbot.navigation import Navigator, Observation, check_navigator


def navigator(rule: Callable[[Observation], Twist]) -> Navigator:
    """Return a navigator with this rule."""
    return dataclass(frozen=True)(type("Own", (Navigator,), {"act": lambda self, seen: rule(seen)}))()  # type: ignore[no-any-return]


class Chance:
    rng = np.random.default_rng(0)


def spoil(observation: Observation) -> Twist:
    observation.people.position.flags.writeable = True
    observation.people.position[...] += 1.0
    return Twist(0.5)


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        (lambda seen: Twist(math.inf), "Own returned .*; its values must be finite"),
        (lambda seen: Twist(0.0, math.nan), "Own returned .*; its values must be finite"),
        (lambda seen: Twist(float(Chance.rng.random())), "Own is not deterministic"),
        (spoil, "Own.act changes the observation; it must only read it"),
    ],
)
def test_a_navigator_that_breaks_a_rule_is_told_which(rule: Callable[[Observation], Twist], message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_navigator(navigator(rule))


@pytest.mark.parametrize("name", sorted({*builtin_classes(navigation, Navigator)} - {"process"}))
def test_navigators_of_the_package_pass(name: str) -> None:
    assert check_navigator(builtin_classes(navigation, Navigator)[name]()) is None


def test_a_navigator_sees_nobody_one_and_three_people_at_times_that_go_on() -> None:
    seen: list[tuple[int, float]] = []

    def rule(observation: Observation) -> Twist:
        seen.append((len(observation.people.position), observation.time))
        assert np.all(np.isfinite(observation.people.position))
        return observation.towards_goal(1.0)

    assert check_navigator(navigator(rule)) is None
    assert {count for count, _ in seen} == {0, 1, 3}
    times = [time for count, time in seen if count == 1][:20]
    np.testing.assert_allclose(np.diff(times), 0.1)


def test_what_is_no_navigator_is_refused() -> None:
    with pytest.raises(InputError, match="str is not a Navigator"):
        check_navigator("straight")  # type: ignore[arg-type]
