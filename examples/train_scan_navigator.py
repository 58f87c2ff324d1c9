"""Train the navigator ``scan-policy`` with PPO of stable-baselines3: crowds, walls and drives, seen by a laser scanner.

    pip install 'crowdbot[gym]' stable-baselines3
    python train_scan_navigator.py --out weights
    crowdbot evaluate intersection --navigators "scan-map, scan-policy file=weights/scan-policy.npz" --seeds 0:200

The network is that of the navigator. Its inputs are scans, the waypoint and the twist of the robot, and its output is a
velocity in the frame of the waypoint, which the drive follows. ``weights/scan-policy.npz`` has the weights, and
``weights/model.zip`` the model of stable-baselines3. Ctrl-C ends the training early and keeps both.
"""

import argparse
import dataclasses
import math

import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.vec_env import VecEnv
from train_navigator import GoalFrame, add_options, environments_of, make_ppo, parse_trials, train, trainings
from train_with_stable_baselines3 import CrowdVecEnv, OutcomeTable

from crowdbot.gym import ActionForm, ObservationForm, Reward
from crowdbot.navigation import (
    SCAN_CHANNELS,
    SCAN_LAGS,
    SCAN_LAYERS,
    SCAN_SECTORS,
    SCAN_STRIDES,
    SCAN_VALUES,
    ScanPolicyWeights,
    drive_twist,
    remember_scan,
    scan_inputs,
)
from crowdbot.sensors import Lidar2D
from crowdbot.trials import load_trial

TRIALS = ", ".join(
    [
        "circle-crossing robot/holonomic=true",
        "circle-crossing people=10",
        "circle-crossing people=8 crowd/type=people robot/holonomic=true robot/visible=true",
        "circle-crossing people=6 crowd/type=social-force",
        "square-crossing robot/visible=false",
        "random-goals robot/visible=false",
        "crossing-flows",
        "down-path",
        "frontal robot/visible=false",
        "doorway",
        "bottleneck",
        "static-crowd",
    ]
)
REWARD = Reward(success=1.0, collision=-1.0, discomfort_distance=0.2, discomfort=0.5, progress=0.1)


@dataclasses.dataclass(frozen=True)
class ScanObservation(ObservationForm):
    """The inputs of the navigator ``scan-policy``; the scanner is in the middle of the robot and looks all around.

    ``memories`` has the remembered scans of each environment, and ``turns`` the heading of each robot in the goal frame.
    """

    form: str = "scan"
    memories: dict = dataclasses.field(default_factory=dict)
    turns: dict = dataclasses.field(default_factory=dict)

    def shapes(self, beams):
        return {"own": (len(SCAN_VALUES),), "sectors": (len(SCAN_LAGS), SCAN_SECTORS)}

    def bounds(self, name, longest):
        return -np.full(1, np.inf), np.full(1, np.inf)

    def arrays(self, batch, scan):
        angles = Lidar2D(rays=scan.shape[1]).angles
        bearing = batch.pose[:, 2:] + angles
        rays = np.stack([np.cos(bearing), np.sin(bearing), np.full_like(bearing, 0.5 * (angles[1] - angles[0]))], 2)
        points = rays * np.where(np.isfinite(scan), scan, 0.0)[..., None]
        points[..., :2] += batch.pose[:, None, :2]
        parts = {name: np.zeros((len(batch), *shape), np.float32) for name, shape in self.shapes(0).items()}
        for e, now in enumerate(batch.time.tolist()):
            memory = self.memories.get(e, ())
            if memory and (now < memory[-1][0] or now == 0.0):  # a new episode
                memory = ()
            if not memory or now > memory[-1][0]:
                memory = self.memories[e] = remember_scan(memory, now, points[e][scan[e] > 0.0])
            state = batch.pose[e], batch.goal[e], batch.waypoint[e], batch.twist[e], batch.radius[e]
            found = scan_inputs(*state, batch.limits, memory, now)
            parts["own"][e], parts["sectors"][e] = found.own, found.sectors
            self.turns[e] = math.atan2(found.own[5], found.own[4])
        return parts


@dataclasses.dataclass(frozen=True)
class DriveAction(ActionForm):
    """An action is a velocity in the goal frame, as a share of the maximum speed, which the drive follows."""

    turns: dict = dataclasses.field(default_factory=dict)

    def twists(self, actions, limits, twist=None, dt=0.0):
        velocities = limits.max_speed * actions / np.maximum(1.0, np.linalg.norm(actions, axis=1, keepdims=True))
        return np.array([drive_twist(row, self.turns[e], limits, dt) for e, row in enumerate(velocities)])


class ScanEnvs(GoalFrame):
    """Environments of several trials with the inputs and the output of the navigator ``scan-policy``."""

    def __init__(self, trials, num_envs):
        each = environments_of(trials, num_envs) // len(trials)
        self.parts = []
        for name, values in trials:
            seen = ScanObservation()
            options = {"observation": seen, "action": DriveAction(turns=seen.turns), "reward": REWARD}
            self.parts.append(CrowdVecEnv(load_trial(name, values), each, **options))
        box = spaces.Box(-1.0, 1.0, (2,), np.float32)
        VecEnv.__init__(self, each * len(trials), self.parts[0].observation_space, box)


class Sectors(BaseFeaturesExtractor):
    """Two circular convolutions of the sectors, then the values of the robot."""

    def __init__(self, observation_space):
        first, second = SCAN_CHANNELS
        super().__init__(
            observation_space, SCAN_SECTORS // SCAN_STRIDES[0] // SCAN_STRIDES[1] * second + len(SCAN_VALUES)
        )
        circular = {"kernel_size": 5, "padding": 2, "padding_mode": "circular"}
        self.scan1 = torch.nn.Conv1d(len(SCAN_LAGS), first, stride=SCAN_STRIDES[0], **circular)
        self.scan2 = torch.nn.Conv1d(first, second, stride=SCAN_STRIDES[1], **circular)

    def forward(self, observations):
        values = torch.relu(self.scan2(torch.relu(self.scan1(observations["sectors"]))))
        return torch.cat([values.transpose(1, 2).flatten(1), observations["own"]], dim=1)


def make_model(envs, length, seed):
    """Return PPO with the network of the navigator; ``length`` is the number of steps between two updates."""
    return make_ppo(envs, length, seed, Sectors, list(SCAN_LAYERS))


def network_weights(model):
    """Return the weights of the navigator."""
    policy = model.policy
    dense = [layer for layer in policy.mlp_extractor.policy_net if isinstance(layer, torch.nn.Linear)]
    layers = {"scan1": policy.features_extractor.scan1, "scan2": policy.features_extractor.scan2}
    layers |= {f"action{k}": layer for k, layer in enumerate([*dense, policy.action_net], start=1)}
    rows = {}
    for name, layer in layers.items():
        weight = layer.weight.detach().numpy()
        weight = weight.transpose(2, 1, 0).reshape(-1, len(weight)) if weight.ndim == 3 else weight.T
        rows[name] = (weight.copy(), layer.bias.detach().numpy().copy())
    return ScanPolicyWeights.of_layers(rows)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", default=TRIALS, help=f"trials with values, separated by commas (default: {TRIALS})")
    add_options(parser, environments=192, cases=100)
    options = parser.parse_args()
    torch.set_num_threads(1)  # small networks: more threads only wait for each other
    trials = parse_trials(options.trials, options.crowd)
    for one in trainings(options, trials, ScanPolicyWeights):
        envs = ScanEnvs(trials, one.environments)
        model = make_model(envs, max(2, min(64, one.steps // envs.num_envs)), one.seed)
        train(model, one, trials, OutcomeTable(updates=5 if model.n_steps == 64 else 1), network_weights)
        envs.close()


if __name__ == "__main__":
    main()
