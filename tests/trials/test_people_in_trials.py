"""The crowd model of the built-in trials: people, the model of the reproduced benchmark, or one by name."""

from __future__ import annotations

import dataclasses

import numpy as np
import pytest

from crowdbot.core import TrialError
from crowdbot.models import ORCA, People
from crowdbot.recording import run
from crowdbot.trials import PRESETS, Crowds, builtin_trials, load_trial

KEPT = {
    "circle-crossing",
    "dense-circle",
    "square-crossing",
    "delayed-circle",
    "circle-with-standing",
    "pedestrian-obstruction",
    "static-crowd",
    "attention-ladder",
    *(name for name in builtin_trials() if name.startswith(("challenge-", "crowdnav-"))),
}
"""Trials that reproduce a benchmark or the CrowdBot challenge, and two with people who step aside while they stand."""
BUSY = ("two-way", "crossing-flows", "random-goals", "perpendicular-flow", "crowd-against-crowd")


@pytest.mark.parametrize("name", builtin_trials())
def test_people_walk_by_the_preset_unless_a_benchmark_is_reproduced(name: str) -> None:
    crowd = load_trial(name).crowd
    if name == "two-crowds":
        assert isinstance(crowd, Crowds)
        assert isinstance(crowd.models[0], People)
        return
    assert type(crowd) is (ORCA if name in KEPT else People)
    if name in PRESETS:
        assert PRESETS[name].options["model"].default == ("orca" if name in KEPT else "people")


@pytest.mark.parametrize("name", sorted({*builtin_trials()} - KEPT - {"two-crowds"}))
def test_the_previous_crowd_has_a_name(name: str) -> None:
    crowd = load_trial(name, model="orca").crowd
    assert isinstance(crowd, ORCA)
    if name in PRESETS:
        assert crowd == ORCA(time_horizon_walls=0.5 if name == "bottleneck" else 1.0)
    else:
        walls = {"crowd/time-horizon-walls": 1}
        assert load_trial(name, model="orca", **walls).crowd == ORCA(time_horizon_walls=1.0)


def test_an_unknown_model_of_a_trial_file_is_named() -> None:
    with pytest.raises(TrialError, match="unknown crowd model 'orka', did you mean 'orca'"):
        load_trial("crossing-flows", model="orka")
    with pytest.raises(TrialError, match="'model' names no attribute|names no attribute"):
        load_trial("two-crowds", model="orca")


@pytest.mark.parametrize("name", BUSY)
def test_people_touch_nobody_and_keep_walking(name: str) -> None:
    trial = load_trial(name)
    episode = run(dataclasses.replace(trial, duration=8.0), seed=3)
    kept = np.ones(episode.active.shape[1], dtype=np.bool_)
    kept[list(episode.robots)] = False
    here, place, radius = episode.active, episode.position, np.broadcast_to(episode.radius, episode.active.shape)
    pair = here[..., None] & here[:, None] & ~np.eye(here.shape[1], dtype=np.bool_)
    pair &= kept | kept[:, None]
    away = place[:, :, None] - place[:, None]
    gap = np.hypot(away[..., 0], away[..., 1]) - radius[..., None] - radius[:, None]
    assert gap[pair].min() > -0.02
    speed = np.hypot(episode.velocity[..., 0], episode.velocity[..., 1])[:, kept][here[:, kept]]
    assert speed.mean() > 0.8
