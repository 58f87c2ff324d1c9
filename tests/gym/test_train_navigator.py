"""The example that trains the navigator: its network is that of the navigator, and its weights are used."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from crowdbot.navigation import AttentionWeights, PolicyWeights, RecurrentWeights
from crowdbot.recording import run
from crowdbot.trials import load_trial

EXAMPLE = Path(__file__).parents[2] / "examples" / "train_navigator.py"
CHECK = """
import sys
sys.path.insert(0, sys.argv[1])
import numpy as np
import torch
from train_navigator import GoalFrame, make_model, network_weights, parse_trials
from crowdbot.navigation.planners.attention_policy import apply_attention
from crowdbot.navigation.planners.policy_kernels import apply_network
from crowdbot.navigation.planners.recurrent_policy import apply_recurrent

network, trials = sys.argv[2:]
envs = GoalFrame(parse_trials(trials), 6, network)
assert envs.num_envs == 6
model = make_model(envs, 4, 3, network)
envs.seed(5)
seen = envs.reset()
if network == "recurrent":
    for _ in range(7):  # windows of several steps
        envs.step_async(np.full((6, 2), 0.2, np.float32))
        seen = envs.step_wait()[0]
    assert (seen["steps"][:, 0] == [6, 6, 6, 3, 3, 3]).all()
with torch.no_grad():
    model.policy.action_net.weight *= 100.0  # the first actions are nearly equal
    tensors, _ = model.policy.obs_to_tensor(seen)
    wanted = model.policy.get_distribution(tensors).distribution.mean.numpy()
out = np.zeros((6, 2))
names = {
    "pooled": ["own", "people", "present"],
    "attention": ["own", "people", "present", "walls"],
    "recurrent": ["own", "windows", "steps", "bodies", "present", "walls"],
}[network]
inputs = [seen[name].astype(np.int64 if name in ("steps", "present") else float) for name in names]
inputs[names.index("present")] = inputs[names.index("present")][:, 0]
if network != "pooled":
    assert (seen["walls"][3:].max(axis=1) > 0.0).all()  # of the second trial
apply = {"pooled": apply_network, "attention": apply_attention, "recurrent": apply_recurrent}[network]
apply(np.ones(6, bool), *inputs, out, *network_weights(model).layers())
np.testing.assert_allclose(out, wanted, atol=1e-5)
assert seen["present"][:, 0].tolist() == [2, 2, 2, 1, 1, 1]

envs.step_async(np.tile(np.array([[3.0, 4.0]], np.float32), (6, 1)))  # limited to 1, in the frame of the goal
observations, rewards, dones, infos = envs.step_wait()
if network == "pooled":
    np.testing.assert_allclose(observations["own"][:3, 2:4], [[0.6, 0.8]] * 3, atol=0.2)  # the frame has turned
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
@pytest.mark.parametrize(
    ("network", "trials"),
    [
        ("pooled", "crowdnav-circle-5 people=2, crowdnav-square-5 people=1"),
        ("attention", "crowdnav-circle-5 people=2, frontal"),
        ("recurrent", "crowdnav-circle-5 people=2, frontal"),
    ],
)
def test_the_navigator_has_the_network_of_the_training(tmp_path: Path, network: str, trials: str) -> None:
    done = run_program("-c", CHECK, EXAMPLE.parent, network, trials, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "equal\n"


@pytest.mark.program
@pytest.mark.parametrize(
    ("network", "kind"),
    [("pooled", PolicyWeights), ("attention", AttentionWeights), ("recurrent", RecurrentWeights)],
    ids=["pooled", "attention", "recurrent"],
)
def test_a_short_training_writes_weights_that_the_navigator_reads(
    tmp_path: Path, network: str, kind: type[PolicyWeights | AttentionWeights | RecurrentWeights]
) -> None:
    words = ["--network", network, "--trials", "crowdnav-circle-5 people=2", "--steps", 600, "--environments", 8]
    done = run_program(EXAMPLE, *words, "--cases", 3, "--out", "mine", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert lines[0].split() == ["steps", "success", "collision", "timeout", "CPU", "[s]"]
    assert "weights in mine" in lines[-2]
    assert lines[-1].startswith("crowdnav-circle-5-0: success ")
    file = tmp_path / "mine" / f"{kind.navigator}.npz"
    _, card = kind.read(file)
    assert card["command"].startswith(f"python train_navigator.py --network {network} --trials 'crowdnav-circle-5")
    assert (card["trials"], card["environments"], card["seed"]) == (["crowdnav-circle-5 people=2"], 8, 0)
    assert (card["planned_steps"], card["steps"]) == (600, 600)
    assert card["processor_time"] > 0
    changes = {"robot/navigator/type": kind.navigator, "robot/navigator/file": str(file), "duration": 2.0}
    assert run(load_trial("crowdnav-circle-5", changes, trust=True), seed=1).steps > 0
    assert (tmp_path / "mine" / "model.zip").is_file()


@pytest.mark.program
def test_trainings_with_several_seeds_continue_where_they_ended(tmp_path: Path) -> None:
    words = ["--trials", "crowdnav-circle-5 people=2", "--crowd", "social-force", "--environments", 8, "--cases", 0]
    first = run_program(EXAMPLE, *words, "--steps", 64, "--seed", "0:2", "--out", "mine", cwd=tmp_path)
    assert first.returncode == 0, first.stderr
    files = [tmp_path / "mine" / f"seed-{seed}" / "policy.npz" for seed in (0, 1)]
    cards = [PolicyWeights.read(file)[1] for file in files]
    assert [(card["seed"], card["trials"]) for card in cards] == [
        (seed, ["crowdnav-circle-5 people=2 crowd/type=social-force"]) for seed in (0, 1)
    ]
    weights, card = PolicyWeights.read(files[1])
    weights.save(files[1], card | {"steps": 8})  # as after Ctrl-C
    kept = files[0].read_bytes()
    again = run_program(EXAMPLE, *words, "--steps", 64, "--seed", "0:2", "--out", "mine", cwd=tmp_path)
    assert again.returncode == 0, again.stderr
    assert again.stdout.splitlines()[0] == f"{Path('mine', 'seed-0', 'policy.npz')} is there with all its steps"
    assert files[0].read_bytes() == kept
    assert PolicyWeights.read(files[1])[1]["steps"] == 64
    wrong = run_program(EXAMPLE, "--seed", "3-1", cwd=tmp_path)
    assert wrong.returncode == 2
    assert "must be a seed such as 7" in wrong.stderr
