"""CrowdVectorEnv: many environments of a trial in one simulation, with the vector interface of Gymnasium."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
from gymnasium import spaces
from gymnasium.vector import AutoresetMode, VectorEnv
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.trials import Trial

from .crowd_task import Reward
from .environment import MOST_SEEDS, make_task, port_space
from .spaces import ActionForm, ObservationForm

Observations = dict[str, NDArray[np.float32]]


class CrowdVectorEnv(VectorEnv[Observations, NDArray[np.float32], NDArray[np.float64]]):
    """E environments of a trial that advance together in one simulation.

    ``reset(seed=s)`` gives environment e the seed ``s + e``; a list gives each its own. The episode of a seed has the
    same bytes as in :class:`CrowdEnv`. Environments that end begin again with drawn seeds, in the next step or in the
    same one; the first seed that is given decides which.

    Args:
        trial, observation, action, reward, robot, values: see :class:`CrowdEnv`.
        num_envs: number of environments E.
        autoreset: ``next-step``: the step after the end returns the first observation; ``same-step``: the last step
            does, and ``info["final_obs"]`` has the last observation.

    Raises:
        InputError: a value is not allowed.

    >>> envs = CrowdVectorEnv("circle-crossing", num_envs=4)
    >>> observations, info = envs.reset(seed=10)
    >>> observations["people"].shape, info["seed"].tolist()
    ((4, 10, 7), [10, 11, 12, 13])
    """

    def __init__(
        self,
        trial: Trial | str = "circle-crossing",
        num_envs: int = 16,
        observation: ObservationForm | str = "people",
        action: ActionForm | str = "velocity",
        reward: Reward | None = None,
        robot: str = "",
        autoreset: str = "next-step",
        **values: Any,
    ) -> None:
        modes = {"next-step": AutoresetMode.NEXT_STEP, "same-step": AutoresetMode.SAME_STEP}
        if autoreset not in modes:
            raise InputError(f"autoreset = {autoreset!r} must be one of {', '.join(modes)}")
        if num_envs < 1:
            raise InputError(f"num_envs = {num_envs} must be at least 1")
        self.metadata = {"render_modes": [], "autoreset_mode": modes[autoreset]}
        self.task = make_task(trial, observation, action, reward, robot, values)
        self.num_envs, self.same_step = num_envs, autoreset == "same-step"
        self.single_observation_space = port_space(self.task.port)
        self.observation_space = port_space(self.task.port, num_envs)
        self.single_action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)
        self.action_space = spaces.Box(-1.0, 1.0, (num_envs, 2), np.float32)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observations, dict[str, Any]]:
        """Begin all episodes; without seeds, they are drawn."""
        given: list[int | None]
        if isinstance(seed, int):
            given = [seed + e for e in range(self.num_envs)]
        else:
            given = [None] * self.num_envs if seed is None else list(seed)
        if len(given) != self.num_envs:
            raise InputError(f"there are {len(given)} seeds for {self.num_envs} environments")
        super().reset(seed=next((int(item) for item in given if item is not None), None))  # of seeds that are drawn
        seeds = [self._draw() if item is None else int(item) for item in given]
        return self.task.reset(seeds), {"seed": np.array(seeds)}

    def step(self, actions: NDArray[np.float32]) -> tuple[Observations, NDArray[np.float64], Any, Any, dict[str, Any]]:
        """Take one action in each environment until the next control step; ended environments begin again."""
        before = self.task.ended.copy()
        found = self.task.step(np.asarray(actions, dtype=np.float64))
        observations, info = found.observations, self._info(found.outcomes)
        done = found.terminated | found.truncated
        again = np.flatnonzero(done if self.same_step else before)
        if len(again):
            if self.same_step:
                info["final_obs"] = {name: value.copy() for name, value in observations.items()}
                info["_final_obs"] = done
            observations = self.task.restart(again, [self._draw() for _ in again])
        info["seed"] = np.array(self.task.seeds)
        return observations, found.rewards, found.terminated, found.truncated, info

    def _draw(self) -> int:
        return int(self.np_random.integers(MOST_SEEDS))

    def _info(self, outcomes: Sequence[str]) -> dict[str, Any]:
        ended = np.array([outcome != "" for outcome in outcomes])
        if not ended.any():
            return {}
        success = np.array([outcome == "success" for outcome in outcomes])
        return {"outcome": np.array(outcomes), "_outcome": ended, "is_success": success, "_is_success": ended}
