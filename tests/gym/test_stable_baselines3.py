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


def run(*words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    return subprocess.run(
        [sys.executable, *map(str, words)], cwd=cwd, capture_output=True, text=True, timeout=600, check=False
    )


@pytest.mark.program
def test_the_first_2000_steps(tmp_path: Path) -> None:
    done = run(EXAMPLE, "--steps", 2000, "--environments", 16, "--out", "model.zip", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert (tmp_path / "model.zip").is_file()
    assert done.stdout.splitlines()[-1] == "2000 steps, model in model.zip"
    assert done.stdout.startswith("2000 steps  success")


@pytest.mark.program
def test_its_environments_are_those_of_crowdbot(tmp_path: Path) -> None:
    done = run("-c", CHECK, EXAMPLE.parent, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "ends 1\n"
