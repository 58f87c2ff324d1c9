"""Own models, sensors, predictors and navigators have what built-in ones have, if their class declares it."""

from __future__ import annotations

import dataclasses
import threading
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
import pytest

from crowdbot.core import InputError, Paper, Twist
from crowdbot.models import CrowdModel, Mixture, ModelRange, check_model, with_headway
from crowdbot.navigation import DriveLimits, Navigator, Observation, ObservationBatch, TrackHistory
from crowdbot.prediction import ConstantVelocity
from crowdbot.recording import run
from crowdbot.sensors import Reading, Sensor
from crowdbot.simulation import simulate_seeds
from crowdbot.trials import Trial, parse_trial, trial_remarks

CALLS: list[int] = []
"""Number of environments of each call since the last :func:`calls_of`."""

TEXT = """<trial name="hall" duration="1">
  <stage walkable="0,0 12,0 12,6 0,6"/>
  <crowd type="orca"/>
  <spawner count="5" zone="6,1 11,1 11,5 6,5" goal="1,1 2,1 2,5 1,5"/>
  <robot name="robot" x="1" y="3">
    <goal x="11" y="3"/>
    <drive type="differential-drive"/>
    <navigator type="straight"/>
    <sensor name="eyes" type="ground-truth-people" rate="10"/>
  </robot>
</trial>"""
SEEDS = range(3)


@dataclass(frozen=True)
class Desired(CrowdModel):
    """Everyone walks as desired, plus a random part."""

    paper: ClassVar[Paper] = Paper("Nobody", 2026, "Walking straight", "Nowhere")
    shake: float = 0.0

    def velocity(self, scene: Any, dt: float, rng: Any = None) -> Any:
        CALLS.append(scene.shape[0])
        wanted = scene.desired_velocity(dt)
        moved = wanted + (self.shake * rng.normal(size=wanted.shape) if self.shake else 0.0)
        moved = np.where(scene.external[..., None], scene.velocity, moved)
        return np.where(scene.active[..., None], moved, 0.0)


@dataclass(frozen=True)
class Together(Desired):
    """The same, which draws nothing."""

    batched = True
    valid_range = ModelRange(0.01, "people do not see each other", 0.02, "this test", "this test")


@dataclass(frozen=True)
class Heir(Together):
    """A subclass, which may do something else."""


@dataclass(frozen=True)
class Count(Reading):
    """Number of people, ``[E]``."""

    people: Any


@dataclass(frozen=True, kw_only=True)
class Counter(Sensor):
    """Counts people."""

    batched = True

    def measure(self, view: Any, state: Any, rng: Any = None) -> tuple[Count, Any]:
        CALLS.append(view.scene.shape[0])
        return Count(view.time, view.pose, view.scene.active.sum(axis=-1)), state


@dataclass(frozen=True, kw_only=True)
class LoneCounter(Counter):
    """Counts people in one environment after the other."""


@dataclass(frozen=True)
class Ahead(ConstantVelocity):
    """Constant velocity."""

    batched = True

    def predict(self, past: Any, *words: Any, **named: Any) -> Any:
        CALLS.append(len(past))
        return super().predict(past, *words, **named)


@dataclass(frozen=True)
class LoneAhead(Ahead):
    """Constant velocity, for one window after the other."""


THREADS: list[bool] = []
"""Whether each decision was made in the main thread."""


@dataclass(frozen=True)
class Watched(Navigator):
    """Drives on."""

    def act(self, observation: Observation) -> Twist:  # type: ignore[override]
        THREADS.append(threading.current_thread() is threading.main_thread())
        return Twist(0.3)


@dataclass(frozen=True)
class Sure(Watched):
    """Drives on, and says that it always does."""

    always_returns = True


@dataclass(frozen=True)
class SureHeir(Sure):
    """A subclass, which may do something else."""


def trial(**changes: Any) -> Trial:
    return dataclasses.replace(parse_trial(TEXT), **changes)


def with_robot(**changes: Any) -> Trial:
    whole = trial()
    return dataclasses.replace(whole, robots=[dataclasses.replace(whole.robots[0], **changes)])


def calls_of(of: Trial) -> tuple[set[int], Sequence[str], Sequence[str]]:
    """Return how many environments the calls of a batch had, and the digests of the batch and of single runs."""
    CALLS.clear()
    batch = [item.digest for item in simulate_seeds(of, SEEDS)]
    sizes = set(CALLS)
    return sizes, batch, [run(of, seed).digest for seed in SEEDS]


@pytest.mark.parametrize(("kind", "sizes"), [(Together, {3}), (Heir, {1}), (Desired, {1})])
def test_an_own_model_steps_all_environments_in_one_call_if_it_says_so(kind: type, sizes: set[int]) -> None:
    found, batch, single = calls_of(trial(crowd=kind()))
    assert found == sizes
    assert batch == single
    assert len(set(batch)) == 3


def test_a_mixture_and_the_headway_layer_ask_their_models() -> None:
    assert Mixture((Together(), Together())).is_batched
    assert not Mixture((Together(), Desired())).is_batched
    assert with_headway(Together)().is_batched
    assert not with_headway(Desired)().is_batched


def test_a_batched_model_that_draws_is_refused_by_its_contract() -> None:
    @dataclass(frozen=True)
    class Drunk(Desired):
        batched = True

    check_model(Together())
    check_model(Desired(shake=0.1))
    with pytest.raises(InputError, match=r"Drunk declares batched = True, but draws random numbers"):
        check_model(Drunk(shake=0.1))


def test_a_trial_beyond_the_range_that_an_own_model_declares_is_named() -> None:
    step, density = "with a time step of 0.05 s, beyond its range of 0.02 s (this test)", "beyond its range of 0.01:"
    named = [item for item in trial_remarks(trial(crowd=Together())) if "crowd model" in item]
    assert len(named) == 2
    assert density in named[0]
    assert "people do not see each other" in named[0]
    assert step in named[1]
    assert not [item for item in trial_remarks(trial(crowd=Heir())) if "crowd model" in item]


@pytest.mark.parametrize(("kind", "sizes"), [(Counter, {3}), (LoneCounter, {1})])
def test_an_own_sensor_measures_all_environments_in_one_call_if_it_says_so(kind: type, sizes: set[int]) -> None:
    mount = dataclasses.replace(trial().robots[0].sensors[0], sensor=kind())
    found, batch, single = calls_of(with_robot(sensors=[mount]))
    assert found == sizes
    assert batch == single


@pytest.mark.parametrize(("kind", "sizes"), [(Ahead, [3]), (LoneAhead, [1, 1, 1])])
def test_an_own_predictor_takes_the_windows_of_all_environments_if_it_says_so(kind: type, sizes: list[int]) -> None:
    tracks = []
    for e in SEEDS:
        history = TrackHistory.empty(8)
        for k in range(8):
            history = history.update(0.4 * k, np.arange(2), np.array([[0.1 * k * e, 0.0], [1.0, 0.2 * k]]))
        tracks.append(history)
    limits, ones = DriveLimits(1.0, 1.0), np.ones((len(SEEDS), 2))
    batch = ObservationBatch(
        pose=np.zeros((len(SEEDS), 3)), goal=ones, radius=0.3 * ones[:, 0], limits=limits, dt=0.4, tracks=tracks
    )
    CALLS.clear()
    forecast = batch.forecast(kind(), 1.2)
    assert sizes == CALLS
    for e in SEEDS:
        np.testing.assert_array_equal(forecast.position[e], tracks[e].forecast(ConstantVelocity(), 1.2).position[0])


@pytest.mark.parametrize(("kind", "main"), [(Sure, {True}), (Watched, {False}), (SureHeir, {False})])
def test_an_own_navigator_that_always_returns_needs_no_thread(kind: type[Navigator], main: set[bool]) -> None:
    THREADS.clear()
    run(with_robot(navigator=kind()), 0)
    assert set(THREADS) == main
