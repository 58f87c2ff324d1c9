"""The example that trains the navigator: its network is that of the navigator, and its weights are used."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from crowdbot.navigation import PolicyWeights
from crowdbot.recording import run
from crowdbot.trials import load_trial

EXAMPLE = Path(__file__).parents[2] / "examples" / "train_navigator.py"
CHECK = """
import sys
sys.path.insert(0, sys.argv[1])
import numpy as np
import torch
from train_navigator import GoalFrame, make_model, parse_trials, policy_weights
from crowdbot.navigation.planners.policy_kernels import apply_network

envs = GoalFrame(parse_trials("crowdnav-circle-5 people=2, crowdnav-square-5 people=3"), 6)
assert envs.num_envs == 6
model = make_model(envs, 4, 3)
envs.seed(5)
seen = envs.reset()
with torch.no_grad():
    tensors, _ = model.policy.obs_to_tensor(seen)
    wanted = model.policy.get_distribution(tensors).distribution.mean.numpy()
out = np.zeros((6, 2))
inputs = (seen["own"].astype(float), seen["people"].astype(float), seen["present"][:, 0].astype(np.int64))
apply_network(np.ones(6, bool), *inputs, out, *policy_weights(model).layers())
np.testing.assert_allclose(out, wanted, atol=1e-5)
assert seen["present"][:, 0].tolist() == [2, 2, 2, 3, 3, 3]

envs.step_async(np.tile(np.array([[3.0, 4.0]], np.float32), (6, 1)))  # limited to 1, turned into the frame of the robot
observations, rewards, dones, infos = envs.step_wait()
moved = observations["own"] - seen["own"]
assert len(infos) == 6 and rewards.shape == dones.shape == (6,)
assert (np.abs(moved).max(axis=1) > 0).all()
print("equal")
"""


def run_program(*words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *map(str, words)]
    return subprocess.run(
        command, cwd=cwd, capture_output=True, text=True, timeout=600, check=False, env={**os.environ}
    )


@pytest.mark.program
def test_the_navigator_has_the_network_of_the_training(tmp_path: Path) -> None:
    done = run_program("-c", CHECK, EXAMPLE.parent, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "equal\n"


@pytest.mark.program
def test_a_short_training_writes_weights_that_the_navigator_reads(tmp_path: Path) -> None:
    words = ["--trials", "crowdnav-circle-5 people=2", "--steps", 600, "--environments", 8, "--cases", 3]
    done = run_program(EXAMPLE, *words, "--out", "mine", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0].split() == ["steps", "success", "collision", "timeout", "CPU", "[s]"]
    assert "weights in mine" in lines[-2]
    assert lines[-1].startswith("crowdnav-circle-5-0: success ")
    file = tmp_path / "mine" / "policy.npz"
    _, card = PolicyWeights.read(file)
    assert card["command"].startswith("python train_navigator.py --trials 'crowdnav-circle-5 people=2' --steps 600")
    changes = {"robot/navigator/type": "policy", "robot/navigator/file": str(file), "duration": 2.0}
    assert run(load_trial("crowdnav-circle-5", changes), seed=1).steps > 0
    assert (tmp_path / "mine" / "model.zip").is_file()
