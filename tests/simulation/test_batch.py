"""A batch of seeds is its single runs, to the last bit."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from crowdbot.core import InputError, Scene
from crowdbot.models import ORCA, CrowdModel, Mixture, SocialForce
from crowdbot.recording import run
from crowdbot.simulation import run_batch
from crowdbot.trials import Trial, expand_sweeps, load_trial, parse_trial
from crowdbot.world import CrowdStepRequest, compute_together, run_step
from samples import sample
from space_trials import LEAN, room
from trial_texts import FLOW

SEEDS = range(4)


def short(name: str) -> Trial:
    trial = load_trial(name)
    first = expand_sweeps(trial)[0] if trial.sweeps else trial
    return dataclasses.replace(first, duration=1.5)


@pytest.mark.parametrize(
    "name",
    sample(
        ["frontal", "crossing-flows", "bottleneck", "two-crowds", "random-goals", "challenge-both-50", "two-way"],
        ["frontal", "two-crowds"],
    ),
)
def test_a_batch_is_its_single_runs(name: str) -> None:
    trial = short(name)
    many = run_batch(trial, SEEDS)
    assert [one.digest for one in many] == [run(trial, seed).digest for seed in SEEDS]
    assert [one.seed for one in many] == list(SEEDS)
    assert len({one.digest for one in many}) > 1 or name == "frontal"


@pytest.mark.parametrize("text", [FLOW, room("physics", LEAN)], ids=["flow", "physics"])
def test_runs_of_different_lengths_and_worlds(text: str) -> None:
    trial = parse_trial(text)
    short_one = dataclasses.replace(trial, duration=min(trial.duration, 2.0))
    assert [one.digest for one in run_batch(short_one, SEEDS)] == [run(short_one, seed).digest for seed in SEEDS]


def test_who_ends_early_leaves_the_others_alone() -> None:
    trial = load_trial("circle-crossing", navigator="straight", reactive=False)
    singles = [run(trial, seed) for seed in SEEDS]
    assert len({one.steps for one in singles}) > 1
    assert [one.digest for one in run_batch(trial, SEEDS)] == [one.digest for one in singles]


@dataclasses.dataclass(frozen=True)
class Asked(ORCA):
    """A model that counts environments."""

    seen = []  # noqa: RUF012

    def step(self, scene, dt, rng=None):  # type: ignore[no-untyped-def]
        self.seen.append(scene.shape[0])
        return super().step(scene, dt, rng)


def walks(count: int, models: list[CrowdModel], agents: list[int]) -> list[CrowdStepRequest]:
    rng = np.random.default_rng(0)
    return [
        CrowdStepRequest(
            models[k],
            Scene.of(rng.uniform(-3, 3, (agents[k], 2)), goal=rng.uniform(-3, 3, (agents[k], 2)), radius=0.2),
            0.1,
            rng,
        )
        for k in range(count)
    ]


def test_built_in_models_are_asked_once_and_others_one_by_one(monkeypatch: pytest.MonkeyPatch) -> None:
    Asked.seen.clear()
    compute_together(walks(3, [Asked()] * 3, [4, 4, 4]))
    assert Asked.seen == [1, 1, 1]
    Asked.seen.clear()
    monkeypatch.setattr(Asked, "__module__", "crowdbot.models.velocity_obstacles.orca")
    compute_together(walks(3, [Asked()] * 3, [4, 4, 4]))
    assert Asked.seen == [3]


@pytest.mark.parametrize("agents", [[5, 5, 5], [2, 6, 1]])
def test_parameters_of_each_and_mixtures_stay_with_their_people(agents: list[int]) -> None:
    rng = np.random.default_rng(1)
    own = [ORCA(time_horizon=rng.uniform(1.0, 3.0, count)) for count in agents]
    mixed = [Mixture((ORCA(), SocialForce()), rng.integers(2, size=count)) for count in agents]
    for models in (own, mixed):
        questions = walks(3, models, agents)
        found = compute_together(questions)
        for walk, scene in zip(questions, found, strict=True):
            assert scene.digest() == walk.compute().digest()
            assert scene.shape == walk.scene.shape


def test_a_question_is_answered_alone() -> None:
    (walk,) = walks(1, [ORCA()], [3])

    def step():  # type: ignore[no-untyped-def]
        first = yield walk
        second = yield walk
        return first.digest() == second.digest()

    assert run_step(step()) is True


def test_wrong_batches_are_refused() -> None:
    with pytest.raises(InputError, match="seeds is empty"):
        run_batch(load_trial("frontal"), [])
    told: list[float] = []
    run_batch(short("frontal"), [1, 2], progress=told.append)
    assert told[-1] == 1.0
