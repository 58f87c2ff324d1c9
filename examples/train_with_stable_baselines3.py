"""Train a robot with PPO of stable-baselines3 in many environments of one simulation.

    pip install 'crowdbot[gym]' stable-baselines3
    python train_with_stable_baselines3.py

The environment is that of the defaults of ``crowdbot.gym``: observation, action and reward. At the end, the robot is
tested without random actions in cases that the training has not seen. Ctrl-C ends the training early and keeps what it
has learned.

Stable-baselines3 has an interface of its own for several environments; ``CrowdVecEnv`` gives it those of
``crowdbot.gym.CrowdVectorEnv``, which advance together and are many times faster than one after another.
"""

import argparse
import time
from collections import deque

import numpy as np
import torch
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv

from crowdbot.evaluation import proportion_interval
from crowdbot.gym import CrowdVectorEnv

OUTCOMES = ("success", "collision", "timeout")
FIRST_CASE = 2**31 + 1000
"""Smallest seed of the cases of the test. The seeds that a training draws are below 2**31; the settings of PPO were
chosen by the first 200 cases from there, which the test leaves out.
"""


class CrowdVecEnv(VecEnv):
    """The environments of a ``CrowdVectorEnv`` with the interface of stable-baselines3."""

    def __init__(self, trial, num_envs, **options):
        self.inside = CrowdVectorEnv(trial, num_envs, autoreset="same-step", **options)
        super().__init__(num_envs, self.inside.single_observation_space, self.inside.single_action_space)
        self.actions = None

    def reset(self):
        seeds = [seed for seed in self._seeds if seed is not None]
        observations, _ = self.inside.reset(seed=seeds if len(seeds) == self.num_envs else None)
        self._reset_seeds()
        return observations

    def step_async(self, actions):
        self.actions = actions

    def step_wait(self):
        observations, rewards, terminated, truncated, info = self.inside.step(self.actions)
        infos = [{} for _ in range(self.num_envs)]
        for e in np.flatnonzero(terminated | truncated):
            infos[e] = {
                "is_success": bool(info["is_success"][e]),
                "outcome": str(info["outcome"][e]),
                "terminal_observation": {name: value[e] for name, value in info["final_obs"].items()},
                "TimeLimit.truncated": bool(truncated[e] and not terminated[e]),
            }
        return observations, rewards.astype(np.float32), terminated | truncated, infos

    def close(self):
        self.inside.close()

    def get_attr(self, attr_name, indices=None):
        return [getattr(self.inside, attr_name)] * len(list(self._get_indices(indices)))

    def set_attr(self, attr_name, value, indices=None):
        setattr(self.inside, attr_name, value)

    def env_method(self, method_name, *arguments, indices=None, **options):
        return [getattr(self.inside, method_name)(*arguments, **options)] * len(list(self._get_indices(indices)))

    def env_is_wrapped(self, wrapper_class, indices=None):
        return [False] * len(list(self._get_indices(indices)))


class OutcomeTable(BaseCallback):
    """Print a row with the outcomes of the last 200 episodes, whose actions are random, after some updates."""

    def __init__(self, updates):
        super().__init__()
        self.updates, self.done = updates, 0
        self.last = deque(maxlen=200)

    def _on_training_start(self):
        print("  ".join(f"{name:>10}" for name in ("steps", *OUTCOMES, "CPU [s]")), flush=True)

    def _on_step(self):
        self.last.extend(info["outcome"] for info in self.locals["infos"] if "outcome" in info)
        return True

    def _on_rollout_end(self):
        self.done += 1
        if self.done % self.updates == 0:
            shares = [self.last.count(name) / max(1, len(self.last)) for name in OUTCOMES]
            texts = [f"{self.num_timesteps}", *(f"{share:.3f}" for share in shares), f"{time.process_time():.0f}"]
            print("  ".join(f"{text:>10}" for text in texts), flush=True)


def test_policy(model, trial, action, cases):
    """Return the outcome of each case, with the most probable actions."""
    envs = CrowdVectorEnv(trial, cases, action=action)
    observations, _ = envs.reset(seed=FIRST_CASE)
    outcomes = np.full(cases, "", dtype="U16")
    while (outcomes == "").any():
        actions, _ = model.predict(observations, deterministic=True)
        observations, _, _, _, info = envs.step(actions)
        if "outcome" in info:  # an environment that has ended begins another case, which does not count
            outcomes = np.where(outcomes == "", info["outcome"], outcomes)
    return outcomes.tolist()


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trial", default="circle-crossing")
    parser.add_argument("--action", default="velocity", help="holonomic for a robot that moves in every direction")
    parser.add_argument("--steps", type=int, default=1_500_000)
    parser.add_argument("--environments", type=int, default=64)
    parser.add_argument("--cases", type=int, default=200, help="number of unseen cases of the test")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--out", default="crowd-ppo.zip", help="file of the trained model")
    options = parser.parse_args()
    torch.set_num_threads(1)  # small networks: more threads only wait for each other
    envs = CrowdVecEnv(options.trial, options.environments, action=options.action)
    length = max(8, min(256, options.steps // options.environments))
    model = PPO(
        "MultiInputPolicy",
        envs,
        n_steps=length,
        batch_size=min(1024, length * options.environments),
        learning_rate=lambda left: 3e-4 * left,  # falls to 0: the last policies differ little
        seed=options.seed,
        device="cpu",
    )
    try:
        model.learn(options.steps, callback=OutcomeTable(updates=10 if length == 256 else 1))
    except KeyboardInterrupt:
        print("the training ends early")
    model.save(options.out)
    print(f"{model.num_timesteps} steps, {time.process_time():.0f} s of processor time, model in {options.out}")
    outcomes = test_policy(model, options.trial, options.action, options.cases)
    for name in OUTCOMES:
        count = outcomes.count(name)
        share, low, high = proportion_interval(count, len(outcomes), method="wilson")[:3]
        print(f"{name:>10}  {count} of {len(outcomes)} unseen cases: {share:.3f} [{low:.3f}, {high:.3f}]")
    envs.close()


if __name__ == "__main__":
    main()
