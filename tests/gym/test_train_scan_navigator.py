"""The example that trains the navigator on scans: its network is that of the navigator, and its weights are used."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

from crowdbot.navigation import ScanPolicyWeights
from crowdbot.recording import run
from crowdbot.trials import load_trial

EXAMPLE = Path(__file__).parents[2] / "examples" / "train_scan_navigator.py"
CHECK = """
import sys
from pathlib import Path
sys.path.insert(0, sys.argv[1])
import numpy as np
import torch
from train_scan_navigator import ScanEnvs, make_model, parse_trials, network_weights
from crowdbot.evaluation import parse_methods
from crowdbot.navigation.planners.scan_policy import _apply_network
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial

trials = parse_trials("circle-crossing people=2 robot/holonomic=true, doorway")
envs = ScanEnvs(trials, 4)
model = make_model(envs, 4, 3)
envs.seed(5)
seen = envs.reset()
weights = network_weights(model)
weights.save(Path("own.npz"), {})
method = parse_methods("scan-policy horizon=0 file=own.npz")[0]
names = [method.put_into(load_trial(name, values)) for name, values in trials]
runs = [Simulation(trial, [5 + 2 * k, 6 + 2 * k]) for k, trial in enumerate(names)]
for simulation in runs:
    simulation.begin()
for _ in range(12):
    with torch.no_grad():
        tensors, _ = model.policy.obs_to_tensor(seen)
        wanted = model.policy.get_distribution(tensors).distribution.mean.numpy()
    out = np.zeros((4, 2))
    for e in range(4):
        inputs = seen["own"][e].astype(float), seen["sectors"][e].astype(float)
        _apply_network(*inputs, out[e], *weights.layers())
    np.testing.assert_allclose(out, wanted, atol=1e-5)
    envs.step_async(wanted)
    seen, *_ = envs.step_wait()
for simulation, part in zip(runs, envs.parts):
    for _ in range(12 * part.inside.task.port.ticks):
        simulation.advance()
    port = part.inside.task.port
    there, here = (s.world.scene.position[:, port.control.agent] for s in (port.simulation, simulation))
    np.testing.assert_allclose(there, here, atol=2e-3)
print("equal")
"""


def run_program(*words: object, cwd: Path) -> subprocess.CompletedProcess[str]:
    command = [sys.executable, *map(str, words)]
    return subprocess.run(command, cwd=cwd, capture_output=True, text=True, timeout=600, check=False)


@pytest.mark.program
def test_the_navigator_drives_as_in_the_training(tmp_path: Path) -> None:
    done = run_program("-c", CHECK, EXAMPLE.parent, cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    assert done.stdout == "equal\n"


@pytest.mark.program
def test_a_short_training_writes_weights_that_the_navigator_reads(tmp_path: Path) -> None:
    words = ["--trials", "circle-crossing people=2", "--steps", 200, "--environments", 4, "--cases", 2]
    done = run_program(EXAMPLE, *words, "--out", "mine", cwd=tmp_path)
    assert done.returncode == 0, done.stderr
    lines = done.stdout.splitlines()
    assert "weights in mine" in lines[-2]
    assert lines[-1].startswith("circle-crossing-0: success ")
    file = tmp_path / "mine" / "scan-policy.npz"
    _, card = ScanPolicyWeights.read(file)
    assert card["command"].startswith("python train_scan_navigator.py --trials 'circle-crossing people=2' --steps 200")
    changes = {"robot/navigator/type": "scan-policy", "robot/navigator/file": str(file), "duration": 2.0}
    assert run(load_trial("circle-crossing", changes, trust=True), seed=1).steps > 0
    assert (tmp_path / "mine" / "model.zip").is_file()
