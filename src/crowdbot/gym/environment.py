"""CrowdEnv: a trial as an environment of Gymnasium."""

from __future__ import annotations

from typing import Any

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.rendering import SimulationCamera, camera_names
from crowdbot.trials import Trial, load_trial

from .crowd_task import CrowdTask, Reward
from .robot_port import RobotPort
from .spaces import ActionForm, ObservationForm

Observation = dict[str, NDArray[np.float32]]
MOST_SEEDS = 2**31


class CrowdEnv(gymnasium.Env[Observation, NDArray[np.float32]]):
    """One robot of a trial, with the interface of Gymnasium.

    ``reset(seed=s)`` runs the trial with the seed ``s``, as ``crowdbot run --seed s`` does; without a seed, it is
    drawn. An episode terminates at success or collision and is truncated when its time is over. The dictionary
    ``info`` has the ``seed`` and, at the end, the ``outcome`` and ``is_success``.

    Args:
        trial: a trial, a trial file, or a built-in name.
        observation: ``people``, ``scan``, ``both`` or ``occupancy``, or an :class:`ObservationForm`.
        action: ``velocity``, ``acceleration`` or ``holonomic``, or an :class:`ActionForm`.
        reward: terms of the reward (default: those of :class:`Reward`).
        robot: name of the robot (default: the first).
        render_mode: ``rgb_array`` for images of a camera by :meth:`render`, or None.
        camera: name of the camera (default: the first of the trial, or its overview).
        values: values by path for a trial that is loaded, such as ``duration=20``.

    >>> env = CrowdEnv("circle-crossing")
    >>> observation, info = env.reset(seed=3)
    >>> env.observation_space.contains(observation), info
    (True, {'seed': 3})
    >>> _, reward, terminated, truncated, _ = env.step(np.array([1.0, 0.0], dtype=np.float32))
    >>> terminated, truncated
    (False, False)
    """

    metadata = {"render_modes": ["rgb_array"], "render_fps": 10}  # noqa: RUF012 - Gymnasium wants a dictionary here

    def __init__(
        self,
        trial: Trial | str = "circle-crossing",
        observation: ObservationForm | str = "people",
        action: ActionForm | str = "velocity",
        reward: Reward | None = None,
        robot: str = "",
        render_mode: str | None = None,
        camera: str = "",
        **values: Any,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise InputError(f"render_mode = {render_mode!r} must be 'rgb_array' or None")
        self.render_mode = render_mode
        self.task = make_task(trial, observation, action, reward, robot, values, posed=render_mode is not None)
        self.camera = camera or camera_names(self.task.trial)[0]
        self.metadata = {**self.metadata, "render_fps": max(1, round(1.0 / self.task.dt))}
        self._view: SimulationCamera | None = None
        self.observation_space: Any = port_space(self.task.port)
        self.action_space = spaces.Box(-1.0, 1.0, (2,), np.float32)

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Begin an episode with a seed; without one, it is drawn."""
        super().reset(seed=seed)
        own = int(self.np_random.integers(MOST_SEEDS)) if seed is None else int(seed)
        self._view = None
        return first_environment(self.task.reset([own])), {"seed": own}

    def step(self, action: NDArray[np.float32]) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Take an action until the next control step."""
        found = self.task.step(np.asarray(action, dtype=np.float64)[None])
        info: dict[str, Any] = {"seed": self.task.seeds[0]}
        if found.outcomes[0]:
            info |= {"outcome": found.outcomes[0], "is_success": found.outcomes[0] == "success"}
        terminated, truncated = bool(found.terminated[0]), bool(found.truncated[0])
        return first_environment(found.observations), float(found.rewards[0]), terminated, truncated, info

    def render(self) -> Any:
        """Return the image ``[H, W, 3]`` of the camera, uint8; None without a render mode.

        Raises:
            InputError: the camera is unknown, or the environment was not reset.
            MissingExtra: mujoco is not installed.
        """
        if self.render_mode is None:
            return None
        if self.task.simulation is None:
            raise InputError("call reset before render")
        if self._view is None:
            self._view = SimulationCamera(self.task.simulation, self.camera)
        return self._view.shot().rgb


def make_task(
    trial: Trial | str,
    observation: ObservationForm | str,
    action: ActionForm | str,
    reward: Reward | None,
    robot: str,
    values: dict[str, Any],
    posed: bool = False,
) -> CrowdTask:
    """Return the task of an environment from its arguments."""
    chosen = load_trial(trial, values) if isinstance(trial, str) else trial
    return CrowdTask(
        chosen,
        ObservationForm(observation) if isinstance(observation, str) else observation,
        ActionForm(action) if isinstance(action, str) else action,
        Reward() if reward is None else reward,
        robot,
        posed,
    )


def port_space(port: RobotPort, count: int = 0) -> spaces.Dict:
    """Return the space of the observations of a robot: of one environment, or of ``count`` environments."""
    parts: dict[str, spaces.Space[Any]] = {}
    for name, shape in port.observation.shapes(port.beams).items():
        low, high = port.observation.bounds(name, port.longest)
        whole = (count, *shape) if count else shape
        smallest, largest = (np.broadcast_to(np.asarray(value, dtype=np.float32), whole) for value in (low, high))
        parts[name] = spaces.Box(smallest, largest, dtype=np.float32)
    return spaces.Dict(parts)


def first_environment(observations: Observation) -> Observation:
    """Return the observation of the first environment."""
    return {name: value[0] for name, value in observations.items()}
