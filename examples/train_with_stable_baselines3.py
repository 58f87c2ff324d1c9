"""Train a robot with PPO of stable-baselines3 in many environments of one simulation.

    pip install 'crowdbot[gym]' stable-baselines3
    python train_with_stable_baselines3.py --steps 1000000

Stable-baselines3 has an interface of its own for several environments; ``CrowdVecEnv`` gives it those of
``crowdbot.gym.CrowdVectorEnv``, which advance together and are many times faster than one after another.
"""

import argparse
from collections import deque

import numpy as np
from stable_baselines3 import PPO
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.vec_env import VecEnv

from crowdbot.gym import CrowdVectorEnv


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


class Outcomes(BaseCallback):
    """Print the outcomes of the last 200 episodes after each update."""

    def __init__(self):
        super().__init__()
        self.last = deque(maxlen=200)

    def _on_step(self):
        self.last.extend(info["outcome"] for info in self.locals["infos"] if "outcome" in info)
        return True

    def _on_rollout_end(self):
        count = max(1, len(self.last))
        shares = "  ".join(
            f"{name} {self.last.count(name) / count:.2f}" for name in ("success", "collision", "timeout")
        )
        print(f"{self.num_timesteps} steps  {shares}", flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--trial", default="crowdnav-circle-5")
    parser.add_argument("--steps", type=int, default=1_000_000)
    parser.add_argument("--environments", type=int, default=64)
    parser.add_argument("--out", default="crowdnav-ppo.zip", help="file of the trained model")
    options = parser.parse_args()
    envs = CrowdVecEnv(options.trial, options.environments, action="holonomic")
    length = max(8, min(256, options.steps // options.environments))
    model = PPO("MultiInputPolicy", envs, n_steps=length, batch_size=1024, gamma=0.99, seed=0, device="cpu")
    model.learn(options.steps, callback=Outcomes())
    model.save(options.out)
    envs.close()
    print(f"{model.num_timesteps} steps, model in {options.out}")


if __name__ == "__main__":
    main()
