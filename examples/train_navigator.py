"""Train the navigator ``policy`` with PPO of stable-baselines3 in crowds of 5 to 20 people.

    pip install 'crowdbot[gym]' stable-baselines3
    python train_navigator.py --out weights
    crowdbot evaluate crowdnav-circle-5 --navigators "orca, policy file=weights/policy.npz" --seeds 0:200

The policy has the layers of the navigator: two for each person, whose outputs are pooled by their maximum, and three
for the action, a velocity in the frame of the goal. ``weights/policy.npz`` has the weights, and ``weights/model.zip``
the model of stable-baselines3 with its value and optimiser. Ctrl-C ends the training early and keeps both.
"""

import argparse
import dataclasses
import shlex
import sys
import time
from pathlib import Path

import numpy as np
import torch
from gymnasium import spaces
from stable_baselines3 import PPO
from stable_baselines3.common.torch_layers import BaseFeaturesExtractor
from stable_baselines3.common.vec_env import VecEnv
from train_with_stable_baselines3 import OUTCOMES, CrowdVecEnv, OutcomeTable

from crowdbot.evaluation import EvaluationPlan, evaluate, parse_methods
from crowdbot.gym import ObservationForm, Reward
from crowdbot.navigation import LAYERS, OWN_VALUES, PERSON_VALUES, PolicyWeights, policy_inputs
from crowdbot.trials import load_trial

MAX_PEOPLE = 20
TRIALS = "crowdnav-circle-5, crowdnav-circle-10, crowdnav-square-10 people=8, crowdnav-circle-20 radius=6"
REWARD = Reward(success=1.0, collision=-1.0, discomfort_distance=0.2, discomfort=1.0, progress=0.1)
FIRST_CASE = 2**31 + 1000
"""Smallest seed of the cases of the test; the seeds that a training draws are below 2**31."""


@dataclasses.dataclass(frozen=True)
class PolicyObservation(ObservationForm):
    """The inputs of the navigator ``policy``, and cosine and sine of the goal frame from the heading (``turn``)."""

    max_people: int = MAX_PEOPLE

    def shapes(self, beams):
        people = (self.max_people, len(PERSON_VALUES))
        return {"own": (len(OWN_VALUES),), "people": people, "present": (1,), "turn": (2,)}

    def bounds(self, name, longest):
        return -np.full(1, np.inf), np.full(1, np.inf)

    def arrays(self, batch, scan):
        found = policy_inputs(batch, self.max_people)
        cos, sin = np.cos(batch.pose[:, 2]), np.sin(batch.pose[:, 2])
        x, y = found.axis.T
        turn = np.stack([cos * x + sin * y, cos * y - sin * x], axis=1)
        parts = {"own": found.own, "people": found.people, "present": found.present[:, None], "turn": turn}
        return {name: value.astype(np.float32) for name, value in parts.items()}


class GoalFrame(VecEnv):
    """Environments of several trials, whose actions are shares of the maximum speed in the frame of the goal."""

    def __init__(self, trials, num_envs):
        each = max(1, num_envs // len(trials))
        options = {"observation": PolicyObservation(), "action": "holonomic", "reward": REWARD}
        self.parts = [CrowdVecEnv(load_trial(name, values), each, **options) for name, values in trials]
        self.turn = None
        super().__init__(each * len(trials), self.parts[0].observation_space, spaces.Box(-1.0, 1.0, (2,), np.float32))

    def _join(self, observations):
        joined = {name: np.concatenate([part[name] for part in observations]) for name in observations[0]}
        self.turn = joined["turn"]
        return joined

    def reset(self):
        return self._join([part.reset() for part in self.parts])

    def step_async(self, actions):
        x, y = (actions / np.maximum(1.0, np.linalg.norm(actions, axis=1, keepdims=True))).T
        cos, sin = self.turn.T
        turned = np.stack([cos * x - sin * y, sin * x + cos * y], axis=1)
        for part, action in zip(self.parts, np.split(turned, len(self.parts)), strict=True):
            part.step_async(action)

    def step_wait(self):
        observations, rewards, dones, infos = zip(*(part.step_wait() for part in self.parts), strict=True)
        return (
            self._join(observations),
            np.concatenate(rewards),
            np.concatenate(dones),
            [one for part in infos for one in part],
        )

    def seed(self, seed=None):
        for k, part in enumerate(self.parts):
            part.seed(None if seed is None else seed + k * part.num_envs)

    def close(self):
        for part in self.parts:
            part.close()

    def get_attr(self, attr_name, indices=None):
        return self.parts[0].get_attr(attr_name) * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name, value, indices=None):
        for part in self.parts:
            part.set_attr(attr_name, value)

    def env_method(self, method_name, *arguments, indices=None, **options):
        raise NotImplementedError("the environments of a trial are one simulation")

    def env_is_wrapped(self, wrapper_class, indices=None):
        return [False] * len(list(self._get_indices(indices)))


class PooledPeople(BaseFeaturesExtractor):
    """Two layers for each person, pooled by their maximum, then the values of the robot."""

    def __init__(self, observation_space):
        person, pooled, _ = LAYERS
        own = len(OWN_VALUES)
        super().__init__(observation_space, pooled + own)
        self.person1 = torch.nn.Linear(own + len(PERSON_VALUES), person)
        self.person2 = torch.nn.Linear(person, pooled)

    def forward(self, observations):
        own, people, present = (observations[name] for name in ("own", "people", "present"))
        count = people.shape[1]
        both = torch.cat([people, own[:, None].expand(-1, count, -1)], dim=2)
        found = torch.relu(self.person2(torch.relu(self.person1(both))))
        there = torch.arange(count)[None, :, None] < present[:, None]
        return torch.cat([(found * there).amax(dim=1), own], dim=1)


def make_model(envs, length, seed):
    """Return PPO with the network of the navigator; ``length`` is the number of steps between two updates."""
    _, pooled, wide = LAYERS
    model = PPO(
        "MultiInputPolicy",
        envs,
        n_steps=length,
        batch_size=min(1024, length * envs.num_envs),
        n_epochs=4,
        learning_rate=lambda left: 1e-3 * left,  # falls to 0: the last policies differ little
        seed=seed,
        device="cpu",
        policy_kwargs={
            "features_extractor_class": PooledPeople,
            "net_arch": {"pi": [wide, wide], "vf": [pooled]},
            "activation_fn": torch.nn.ReLU,
            "log_std_init": float(np.log(0.6)),
        },
    )
    with torch.no_grad():
        model.policy.action_net.bias[0] = 0.5  # towards the goal
    return model


def policy_weights(model):
    """Return the weights of the navigator."""
    policy = model.policy
    layers = [policy.features_extractor.person1, policy.features_extractor.person2]
    layers += [layer for layer in policy.mlp_extractor.policy_net if isinstance(layer, torch.nn.Linear)]
    arrays = []
    for layer in [*layers, policy.action_net]:
        arrays += [layer.weight.detach().numpy().T.copy(), layer.bias.detach().numpy().copy()]
    return PolicyWeights(*arrays)


def parse_trials(text):
    """Return names and values of trials, such as ``"crowdnav-circle-5, crowdnav-circle-10 people=8"``."""
    parts = [part.split() for part in text.split(",")]
    return [(name, dict(word.split("=", 1) for word in words)) for name, *words in parts]


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trials", default=TRIALS, help=f"trials with values, separated by commas (default: {TRIALS})")
    parser.add_argument("--steps", type=int, default=1_500_000)
    parser.add_argument("--environments", type=int, default=256)
    parser.add_argument("--cases", type=int, default=200, help="number of unseen cases of each trial")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", type=Path, default=Path("weights"), help="folder of policy.npz and model.zip")
    options = parser.parse_args()
    torch.set_num_threads(1)  # small networks: more threads only wait for each other
    trials = parse_trials(options.trials)
    envs = GoalFrame(trials, options.environments)
    model = make_model(envs, max(2, min(32, options.steps // envs.num_envs)), options.seed)
    try:
        model.learn(options.steps, callback=OutcomeTable(updates=20 if model.n_steps == 32 else 1))
    except KeyboardInterrupt:
        print("the training ends early")
    options.out.mkdir(parents=True, exist_ok=True)
    model.save(options.out / "model.zip")
    file = options.out / "policy.npz"
    command = shlex.join(["python", Path(sys.argv[0]).name, *sys.argv[1:]])
    policy_weights(model).save(file, {"command": command, "steps": model.num_timesteps})
    print(f"{model.num_timesteps} steps, {time.process_time():.0f} s of processor time, weights in {file}")
    plan = EvaluationPlan(
        [dataclasses.replace(load_trial(name, values), name=f"{name}-{k}") for k, (name, values) in enumerate(trials)],
        parse_methods(f"policy file={file}"),
        seeds=range(FIRST_CASE, FIRST_CASE + options.cases),
    )
    for cell in evaluate(plan).cells:
        shares = [f"{name} {cell.estimate(f'{name}-rate')}" for name in OUTCOMES]
        print(f"{cell.trial}: {', '.join(shares)}")
    envs.close()


if __name__ == "__main__":
    main()
