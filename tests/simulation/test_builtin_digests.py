"""Every built-in trial gives the recorded digest at its level of processor, and the same early state on any other."""

from __future__ import annotations

import json
import subprocess
import sys
from typing import Any

import pytest

from builtin_digests import FILE, FORMS, differences, entry, level, level_environment
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
    if not differences(RECORDED["machine"]):
        assert (found["outcome"], found["steps"]) == (old["outcome"], old["steps"])
        if level() in old["digest"]:  # runs that were recorded without AVX-512 have no other digest, see below
            assert found["digest"] == old["digest"][level()]


@pytest.mark.program
@pytest.mark.usefixtures("digests")
def test_the_digests_of_processors_without_avx512_are_those_of_this_code() -> None:
    program = """
import json, sys
from builtin_digests import entry, level
print(json.dumps({key: [level(), entry(key)["digest"]] for key in sys.argv[1:]}))
"""
    words, place = [sys.executable, "-c", program, *SHORT], level_environment("x86-64-v3")
    done = subprocess.run(words, env=place, cwd=FILE.parents[1], capture_output=True, text=True, check=True)
    document = json.loads(done.stdout.splitlines()[-1])
    assert document == {key: ["x86-64-v3", RUNS[key]["digest"]["x86-64-v3"]] for key in SHORT}
