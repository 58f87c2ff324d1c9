"""check_cost accepts costs that keep the contract, and names the rule that others break."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from crowdbot import calibration
from crowdbot.calibration import Cost, ResimulatedTracks, check_cost
from crowdbot.core import InputError, builtin_classes

Rule = Callable[[ResimulatedTracks], np.ndarray]


def cost(rule: Rule) -> Cost:
    """Return a cost with this rule."""
    return dataclass(frozen=True)(type("Own", (Cost,), {"measure": lambda self, tracks: rule(tracks)}))()  # type: ignore[no-any-return]


def last(tracks: ResimulatedTracks) -> np.ndarray:
    """Return the distance in the last row, NaN for robots and absent people."""
    away = np.linalg.norm(tracks.once[:, :, -1] - tracks.past.position[:, -1], axis=-1)
    return np.where(tracks.past.present[:, -1] & ~tracks.past.robot, away, np.nan)


def stepwise(tracks: ResimulatedTracks) -> np.ndarray:
    """Return the distance one row ahead in the last row."""
    away = np.linalg.norm(tracks.stepwise[:, :, -1] - tracks.past.position[:, -1], axis=-1)
    return np.where(tracks.past.present[:, -1] & ~tracks.past.robot, away, np.nan)


@pytest.mark.parametrize("name", sorted(builtin_classes(calibration, Cost)))
def test_costs_of_the_package_pass(name: str) -> None:
    kind = builtin_classes(calibration, Cost)[name]
    made = kind((calibration.Absolute(),), (2.0,)) if name == "weighted-sum" else kind()
    assert check_cost(made) is None


@pytest.mark.parametrize("rule", [last, stepwise])
def test_an_own_cost_passes(rule: Rule) -> None:
    assert check_cost(cost(rule)) is None


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        (lambda tracks: last(tracks)[0], r"Own.measure returned shape .* it must be \[P, W, A\]"),
        (lambda tracks: np.where(last(tracks) > 0.3, np.nan, last(tracks)), "must depend on the recording only"),
        (lambda tracks: np.where(tracks.past.robot, 1.0, last(tracks)), "counts robots; their cost must be NaN"),
        (lambda tracks: last(tracks) * np.nan, "counts nobody"),
        (lambda tracks: last(tracks) - 0.2, "must be finite and at least 0"),
        (lambda tracks: np.where(np.isnan(last(tracks)), np.nan, np.inf), "must be finite and at least 0"),
        (lambda tracks: 1.0 / (1.0 + last(tracks)), "reproduces the recording must not be the worst"),
        (lambda tracks: last(tracks) * len(tracks.past), "of window 0 differs when it is computed alone"),
    ],
)
def test_a_cost_that_breaks_a_rule_is_told_which(rule: Rule, message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_cost(cost(rule))


def test_what_is_no_frozen_cost_is_refused() -> None:
    with pytest.raises(InputError, match="str is not a Cost"):
        check_cost("absolute")  # type: ignore[arg-type]
