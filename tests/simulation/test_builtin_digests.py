"""Every built-in trial gives the recorded digest on the same kind of machine, and the same early state on any other."""

from __future__ import annotations

import json
from typing import Any

import pytest

from builtin_digests import FILE, FORMS, entry, machine
from crowdbot.trials import builtin_trials
from samples import sample

RECORDED: dict[str, Any] = json.loads(FILE.read_text(encoding="utf-8"))
RUNS: dict[str, dict[str, Any]] = RECORDED["runs"]
SHORT = [key for key in RUNS if key.endswith(f"/{FORMS[0]}")]


def test_every_built_in_trial_is_recorded_in_every_form() -> None:
    assert set(RUNS) == {f"{name}/{form}" for name in builtin_trials() for form in FORMS}


@pytest.mark.parametrize("key", sample(RUNS, SHORT))
def test_a_built_in_trial_gives_the_recorded_run(key: str) -> None:
    found, old = entry(key), RUNS[key]
    assert found.pop("state") == pytest.approx(old["state"], abs=1e-6)
    if machine() == RECORDED["machine"]:
        assert found == {name: old[name] for name in ("digest", "outcome", "steps")}
