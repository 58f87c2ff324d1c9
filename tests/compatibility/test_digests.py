"""Built-in trials run to the digests of earlier versions."""

from __future__ import annotations

import dataclasses
import json
from pathlib import Path

import pytest

from crowdbot.recording import run
from crowdbot.trials import builtin_trials, load_trial
from samples import sample

DIGESTS: dict[str, str] = json.loads((Path(__file__).parent / "digests.json").read_text(encoding="utf-8"))
DURATION = 20.0
"""Maximum simulated time [s]."""
KEEP = ["crossing-flows/planar/1", "doorway/planar/0"]


def test_every_built_in_trial_has_digests() -> None:
    assert {key.partition("/")[0] for key in DIGESTS} == set(builtin_trials())


@pytest.mark.parametrize("key", sample(DIGESTS, KEEP))
def test_a_built_in_trial_has_the_same_digest(key: str) -> None:
    name, world, seed = key.split("/")
    trial = load_trial(name)
    trial = dataclasses.replace(trial, duration=min(trial.duration, DURATION), world=world)
    assert run(trial, seed=int(seed)).digest == DIGESTS[key]
