"""CrowdEnv: a trial as an environment of Gymnasium."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from crowdbot.trials import Trial, load_trial

from .action_form import ActionForm
from .crowd_task import CrowdTask
from .observation_form import ObservationForm, bounds_of
from .reward import Reward

__all__ = ["CrowdEnv", "make_task", "observation_space"]

Observation = dict[str, NDArray[np.float32]]
MOST_SEEDS = 2**31


class CrowdEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """One robot of a trial, with the interface of Gymnasium.

    ``reset(seed=s)`` runs the trial with the seed ``s``, as ``crowdbot run --seed s`` does; without a seed, it is
    drawn. An episode terminates at success or collision and is truncated when its time is over. The dictionary
    ``info`` has the ``seed`` and, at the end, the ``outcome`` and ``is_success``.

    Args:
        trial: a trial, a trial file, or a built-in name.
        observation: ``people``, ``scan`` or ``both``, or an :class:`ObservationForm`.
        action: ``velocity`` or ``holonomic``, or an :class:`ActionForm`.
        reward: terms of the reward (default: those of CrowdNav).
        robot: name of the robot (default: the first).
        values: values by path for a trial that is loaded, such as ``duration=20``.

    >>> env = CrowdEnv("circle-crossing")
    >>> observation, info = env.reset(seed=3)
    >>> env.observation_space.contains(observation), info
    (True, {'seed': 3})
    >>> _, reward, terminated, truncated, _ = env.step(np.array([1.0, 0.0], dtype=np.float32))
    >>> terminated, truncated
    (False, False)
    """

    metadata = {"render_modes": []}  # noqa: RUF012 - Gymnasium wants a dictionary here

    def __init__(
        self,
        trial: Trial | str = "circle-crossing",
        observation: ObservationForm | str = "people",
        action: ActionForm | str = "velocity",
        reward: Reward | None = None,
        robot: str = "",
        **values: Any,
    ) -> None:
        self.task = make_task(trial, observation, action, reward, robot, values)
        self.observation_space: Any = observation_space(self.task)
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode with a seed; without one, it is drawn."""
        super().reset(seed=seed)
        own = int(self.np_random.integers(MOST_SEEDS)) if seed is None else int(seed)
        return _first(self.task.reset([own])), {"seed": own}

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Take an action until the next control step."""
        found = self.task.step(np.asarray(action, dtype=np.float64)[None])
        info: dict[str, Any] = {"seed": self.task.seeds[0]}
        if found.outcomes[0]:
            info |= {"outcome": found.outcomes[0], "is_success": found.outcomes[0] == "success"}
        terminated, truncated = bool(found.terminated[0]), bool(found.truncated[0])
        return _first(found.observations), float(found.rewards[0]), terminated, truncated, info


def make_task(
    trial: Trial | str,
    observation: ObservationForm | str,
    action: ActionForm | str,
    reward: Reward | None,
    robot: str,
    values: dict[str, Any],
) -> CrowdTask:
    """Return the task of an environment from its arguments."""
    chosen = load_trial(trial, **values) if isinstance(trial, str) else trial
    return CrowdTask(
        chosen,
        ObservationForm(observation) if isinstance(observation, str) else observation,
        ActionForm(action) if isinstance(action, str) else action,
        Reward() if reward is None else reward,
        robot,
    )


def observation_space(task: CrowdTask, count: int = 0) -> spaces.Dict:
    """Return the space of the observations of a task: of one environment, or of ``count`` environments."""
    parts: dict[str, spaces.Space[Any]] = {}
    for name, shape in task.observation.shapes(task.beams).items():
        low, high = bounds_of(name, task.longest)
        whole = (count, *shape) if count else shape
        smallest, largest = (np.broadcast_to(np.asarray(value, dtype=np.float32), whole) for value in (low, high))
        parts[name] = spaces.Box(smallest, largest, dtype=np.float32)
    return spaces.Dict(parts)


def _first(observations: Observation) -> Observation:
    return {name: value[0] for name, value in observations.items()}
