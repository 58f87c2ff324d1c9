"""The example with stable-baselines3 runs, and its environments give the bytes of CrowdVectorEnv."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

EXAMPLE = Path(__file__).parents[2] / "examples" / "train_with_stable_baselines3.py"
CHECK = """
import sys
sys.path.insert(0, sys.argv[1])
import numpy as np
from train_with_stable_baselines3 import CrowdVecEnv
from crowdbot.gym import CrowdVectorEnv

mine = CrowdVecEnv("crowdnav-circle-5", 3, action="holonomic", people=2)
plain = CrowdVectorEnv("crowdnav-circle-5", 3, action="holonomic", autoreset="same-step", people=2)
mine.seed(5)
one, other = mine.reset(), plain.reset(seed=[5, 6, 7])[0]
ends = 0
for k in range(60):
    for name in other:
        assert one[name].tobytes() == other[name].tobytes(), (k, name)
    actions = np.tile(np.array([[1.0, 0.0]], dtype=np.float32), (3, 1))
    one, rewards, done, infos = mine.step(actions)
    other, wanted, terminated, truncated, info = plain.step(actions)
    assert np.array_equal(rewards, wanted.astype(np.float32))
    assert np.array_equal(done, terminated | truncated)
    if done.any():
        ends += 1
        break
    assert infos == [{}, {}, {}]
e = int(np.flatnonzero(done)[0])
assert infos[e]["terminal_observation"]["robot"].tobytes() == info["final_obs"]["robot"][e].tobytes()
assert infos[e]["outcome"] in ("success", "collision", "timeout")
print("ends", ends)
"""
STOP = """
import train_with_stable_baselines3 as example

def stop(self):
    raise KeyboardInterrupt

example.OutcomeTable._on_rollout_end = stop
sys.argv = [example.__file__, *sys.argv[2:]]
example.main()
"""


def run(*words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *map(str, words)], cwd=cwd, capture_output=True, text=True, timeout=600, check=False
    )


@pytest.fixture(scope="module")
def checked_and_stopped(tmp_path_factory: pytest.TempPathFactory) -> tuple[subprocess.CompletedProcess[str], Path]:
    """Return the end of one process, whose import of stable-baselines3 takes most of its time, and its folder.

    It compares the environments, then begins a training that is stopped.
    """
    folder = tmp_path_factory.mktemp("stopped")
    words = ["--steps", 4000, "--environments", 2, "--cases", 2, "--out", "model.zip"]
    return run("-c", CHECK + STOP, EXAMPLE.parent, *words, cwd=folder), folder


@pytest.mark.program
def test_the_first_2000_steps(tmp_path: Path) -> None:
    words = ["--steps", 2000, "--environments", 16, "--cases", 4, "--out", "model.zip"]
    done = run(EXAMPLE, *words, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "model.zip").is_file()
    lines = done.stdout.splitlines()
    assert lines[0].split() == ["steps", "success", "collision", "timeout", "CPU", "[s]"]
    assert lines[1].split()[0] == "2000"
    assert lines[2].startswith("2000 steps, ")
    assert [line.split()[0] for line in lines[3:]] == ["success", "collision", "timeout"]
    assert sum(int(line.split()[1]) for line in lines[3:]) == 4
    assert all(" of 4 unseen cases: " in line for line in lines[3:])


@pytest.mark.program
def test_a_training_that_is_stopped_keeps_its_weights(
    checked_and_stopped: tuple[subprocess.CompletedProcess[str], Path],
) -> None:
    done, folder = checked_and_stopped
    assert done.returncode == 0, done.stderr
    assert (folder / "model.zip").is_file()
    assert "the training ends early\n512 steps, " in done.stdout
    assert " of 2 unseen cases: " in done.stdout


@pytest.mark.program
def test_its_environments_are_those_of_crowdbot(
    checked_and_stopped: tuple[subprocess.CompletedProcess[str], Path],
) -> None:
    done, _ = checked_and_stopped
    assert done.stdout.splitlines()[:1] == ["ends 1"], done.stderr
