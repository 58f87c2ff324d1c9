"""check_predictor accepts predictors that keep the contract, and names the rule that others break."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pytest

from crowdbot.core import InputError
from crowdbot.data import Forecast, Windows
from crowdbot.prediction import ConstantVelocity, Kalman, Predictor, SampledConstantVelocity, check_predictor

Rule = Callable[[Windows, int, int, np.random.Generator], object]


def still(past: Windows, steps: int, samples: int, rng: np.random.Generator) -> Forecast:
    """Return a forecast of people who stand."""
    place = np.repeat(past.position[:, -1:], steps, axis=1)[:, None]
    return Forecast.of(place, past.present[:, -1], past.dt, "own")


def predictor(rule: Rule, check: bool = True) -> Predictor:
    """Return a predictor with this rule."""

    def predict(self: Predictor, past: Windows, steps: int, samples: int = 1, rng: object = None) -> object:
        if check:
            self.check(past, steps, samples)
        return rule(past, steps, samples, rng)  # type: ignore[arg-type]

    return dataclass(frozen=True)(type("Own", (Predictor,), {"predict": predict}))()  # type: ignore[no-any-return]


def shift(past: Windows, off: np.ndarray | float) -> Forecast:
    found = still(past, 12, 1, np.random.default_rng(0))
    return Forecast.of(found.position + off, found.valid, past.dt, "own")


def spoil(past: Windows, steps: int, samples: int, rng: np.random.Generator) -> Forecast:
    forecast = still(past, steps, samples, rng)
    past.position[0, 0, 0, 0] += 1.0
    return forecast


class Chance:
    rng = np.random.default_rng(0)


@pytest.mark.parametrize(
    ("rule", "message"),
    [
        (lambda past, steps, samples, rng: still(past, steps, 1, rng).position, "returned a ndarray, not a Forecast"),
        (lambda past, steps, samples, rng: still(past, steps - 1, 1, rng), "position has shape .* it must be"),
        (lambda past, steps, samples, rng: dataclasses.replace(
            still(past, steps, 1, rng), valid=np.ones_like(past.present[:, -1])), "everyone who is present"),
        (lambda past, steps, samples, rng: shift(past, Chance.rng.random()), "is not deterministic"),
        (lambda past, steps, samples, rng: shift(past, past.scored[:, None, None, :, None] * 1.0), "uses past.scored"),
        (lambda past, steps, samples, rng: shift(past, float(len(past))), "of a window differs when it is predicted"),
        (spoil, "changes past.position"),
    ],
)  # fmt: skip
def test_a_predictor_that_breaks_a_rule_is_told_which(rule: Rule, message: str) -> None:
    with pytest.raises(InputError, match=message):
        check_predictor(predictor(rule))


@pytest.mark.parametrize("wrong", ["steps", "samples"])
def test_a_predictor_must_refuse_to_predict_nothing(wrong: str) -> None:
    def rule(past: Windows, steps: int, samples: int, rng: np.random.Generator) -> Forecast:
        if (wrong == "samples" and steps < 1) or (wrong == "steps" and samples < 1):
            raise InputError("nothing to predict")
        return still(past, max(1, steps), samples, rng)

    expected = "steps = 0, samples = 1" if wrong == "steps" else "steps = 1, samples = 0"
    with pytest.raises(InputError, match=f"Own.predict accepts {expected}"):
        check_predictor(predictor(rule, check=False))


@pytest.mark.parametrize(
    "own", [predictor(still), ConstantVelocity(), Kalman(), SampledConstantVelocity()], ids=lambda own: own.name
)
def test_predictors_that_keep_the_rules_pass(own: Predictor) -> None:
    assert check_predictor(own) is None


def test_only_two_rows_are_given_too() -> None:
    seen = set()

    def rule(past: Windows, steps: int, samples: int, rng: np.random.Generator) -> Forecast:
        seen.add((past.position.shape[1], samples))
        return still(past, steps, samples, rng)

    assert check_predictor(predictor(rule)) is None
    assert seen == {(8, 1), (8, 3), (2, 1), (2, 3)}


def test_what_is_no_predictor_is_refused() -> None:
    with pytest.raises(InputError, match="str is not a Predictor"):
        check_predictor("kalman")  # type: ignore[arg-type]
