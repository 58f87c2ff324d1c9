"""The kernel cache: keyed by sources, placed where asked, warm in the next process."""

import os
import subprocess
import sys

import pytest

PROGRAM = """
import sys
from crowdbot.core import kernels
from crowdbot.core.geometry import ray_to_disc
before = kernels.is_cold()
assert ray_to_disc(0.0, 0.0, 1.0, 0.0, 5.0, 0.0, 1.0) == 4.0
print(before, kernels.is_cold(), sum(ray_to_disc.dispatcher.stats.cache_hits.values()))
"""


TOLD = """
import sys
import numba
from crowdbot.cli.output import progress
from crowdbot.core.geometry import ray_to_disc
own = numba.njit(lambda x: x + 1)
with progress(sys.argv[1] == "quiet") as report:
    assert own(1) == 2
    print("a", end=" ", file=sys.stderr, flush=True)
    assert ray_to_disc(0.0, 0.0, 1.0, 0.0, 5.0, 0.0, 1.0) == 4.0
    assert ray_to_disc(0, 0, 1.0, 0.0, 5.0, 0.0, 1.0) == 4.0
"""


def _run(folder, program=PROGRAM, *words):
    done = subprocess.run(
        [sys.executable, "-c", program, *words],
        env={**os.environ, "CROWDBOT_CACHE": str(folder)},
        capture_output=True,
        text=True,
    )
    assert done.returncode == 0, done.stderr
    return done.stdout.split() if program == PROGRAM else done.stderr


@pytest.mark.program
def test_cold_then_warm(tmp_path):
    assert _run(tmp_path) == ["True", "False", "0"]
    assert _run(tmp_path) == ["False", "False", "1"]


@pytest.mark.program
def test_who_waits_for_kernels_of_ours_is_told_once_and_why(tmp_path):
    told = _run(tmp_path, TOLD, "plain")
    assert told.startswith("a first run: compiling kernels once, into " + str(tmp_path))
    assert told.count("\n") == told.count("compiling") == 1
    assert _run(tmp_path, TOLD, "plain") == "a "
    assert _run(tmp_path / "other", TOLD, "quiet") == "a "


def test_the_key_changes_with_any_kernel_source(tmp_path, monkeypatch):
    from crowdbot.core import kernels

    package = tmp_path / "crowdbot"
    (package / "core").mkdir(parents=True)
    (package / "models").mkdir()
    (package / "core" / "kernels.py").write_text("")
    model = package / "models" / "model.py"
    model.write_text("@kernel\ndef f(x): return x\n")
    monkeypatch.setattr(kernels, "__file__", str(package / "core" / "kernels.py"))
    first = kernels._source_key()
    model.write_text("@kernel\ndef f(x): return 2 * x\n")
    second = kernels._source_key()
    (package / "models" / "words.py").write_text("no kernel here")
    assert first != second == kernels._source_key()
