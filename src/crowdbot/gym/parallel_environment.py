"""ParallelCrowdEnv: the robots of a trial as agents, with the parallel interface of PettingZoo."""

from __future__ import annotations

from typing import Any

import numpy as np
from gymnasium import spaces
from numpy.typing import NDArray

from crowdbot.core import CrowdbotError, InputError, import_optional
from crowdbot.rendering import SimulationCamera, camera_names
from crowdbot.simulation import Simulation
from crowdbot.trials import Trial, load_trial

from .crowd_task import Reward
from .environment import MOST_SEEDS, first_environment, port_space
from .robot_port import RobotPort, free_robots
from .spaces import ActionForm, ObservationForm

ParallelEnv: Any = import_optional("pettingzoo", "crowdbot.gym.parallel_env", "gym").ParallelEnv


Observation = dict[str, NDArray[np.float32]]
Action = NDArray[np.float32]


class ParallelCrowdEnv(ParallelEnv):  # type: ignore[misc]
    """All robots of a trial as agents that act at the same time, with the parallel interface of PettingZoo.

    ``reset(seed=s)`` runs the trial with the seed ``s``, as ``crowdbot run --seed s`` does. An agent terminates when
    its robot is at its goal, where it then stands, or in contact; when the trial ends, the others are truncated. The
    dictionary ``infos[agent]`` has the ``seed`` and, at its end, ``outcome`` and ``is_success``.

    Args:
        trial: a trial, a trial file, or a built-in name; robots have the same control period.
        observation: ``people``, ``scan``, ``both`` or ``occupancy``, or an :class:`ObservationForm`.
        action: ``velocity``, ``acceleration`` or ``holonomic``, or an :class:`ActionForm`.
        reward: terms of the reward of each agent (default: those of :class:`Reward`).
        render_mode: ``rgb_array`` for images of a camera by :meth:`render`, or None.
        camera: name of the camera (default: the first of the trial, or its overview).
        values: values by path for a trial that is loaded, such as ``duration=20``.

    Raises:
        InputError: a value is not allowed, or the robots have different control periods.

    >>> env = ParallelCrowdEnv("circle-crossing")
    >>> observations, infos = env.reset(seed=3)
    >>> env.agents, infos["robot"]
    (['robot'], {'seed': 3})
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array"], "name": "crowdbot"}  # noqa: RUF012 - as PettingZoo wants

    def __init__(
        self,
        trial: Trial | str,
        observation: ObservationForm | str = "people",
        action: ActionForm | str = "velocity",
        reward: Reward | None = None,
        render_mode: str | None = None,
        camera: str = "",
        **values: Any,
    ) -> None:
        if render_mode not in (None, "rgb_array"):
            raise InputError(f"render_mode = {render_mode!r} must be 'rgb_array' or None")
        chosen = load_trial(trial, values) if isinstance(trial, str) else trial
        if not chosen.robots:
            raise InputError(f"trial {chosen.name!r} has no robot")
        seen = ObservationForm(observation) if isinstance(observation, str) else observation
        acts = ActionForm(action) if isinstance(action, str) else action
        names = [robot.name for robot in chosen.robots]
        self.ports = {name: RobotPort(chosen, name, seen, acts) for name in names}
        if len({port.ticks for port in self.ports.values()}) > 1:
            periods = ", ".join(f"{name} {port.dt:g} s" for name, port in self.ports.items())
            raise InputError(f"the robots must have the same control period; they have {periods}")
        self.trial, self.reward = free_robots(chosen, names), reward or Reward()
        self.render_mode, self.camera = render_mode, camera or camera_names(chosen)[0]
        self.metadata = {**self.metadata, "render_fps": max(1, round(1.0 / self._port.dt))}
        self.possible_agents, self.agents = names, list[str]()
        self.observation_spaces = {name: port_space(port) for name, port in self.ports.items()}
        self.action_spaces = {name: spaces.Box(-1.0, 1.0, (2,), np.float32) for name in names}
        self.simulation: Simulation | None = None
        self._rng, self._distance = np.random.default_rng(), dict[str, float]()
        self._view: SimulationCamera | None = None

    @property
    def _port(self) -> RobotPort:
        return next(iter(self.ports.values()))

    def observation_space(self, agent: str) -> Any:
        """Return the space of the observations of an agent."""
        return self.observation_spaces[agent]

    def action_space(self, agent: str) -> Any:
        """Return the space of the actions of an agent."""
        return self.action_spaces[agent]

    def reset(
        self, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[dict[str, Observation], dict[str, dict[str, Any]]]:
        """Begin an episode with a seed; without one, it is drawn."""
        if seed is not None:
            self._rng = np.random.default_rng(seed)
        own = int(self._rng.integers(MOST_SEEDS)) if seed is None else int(seed)
        self.simulation = Simulation(self.trial, own, posed=self.render_mode is not None)
        self.simulation.begin()
        self._view = None
        for port in self.ports.values():
            port.attach(self.simulation)
        self.agents = list(self.possible_agents)
        self._distance = {name: float(port.goal_distance()[0]) for name, port in self.ports.items()}
        return self._observe(self.agents), {name: {"seed": own} for name in self.agents}

    def step(self, actions: dict[str, Action]) -> tuple[dict[str, Any], ...]:
        """Take the actions of all agents until the next control step.

        Returns:
            observations, rewards, terminations, truncations and infos by agent.

        Raises:
            InputError: an agent has no action, or it is not allowed.
            CrowdbotError: an exception in a model or a sensor.
        """
        running = self._running
        missing = [name for name in self.agents if name not in actions]
        if missing:
            raise InputError(f"there is no action of {', '.join(missing)}")
        twists = {
            name: port.twists(np.asarray(actions[name], dtype=np.float64)[None])
            if name in self.agents
            else np.zeros((1, 3))
            for name, port in self.ports.items()
        }
        touching: set[int] = set()
        for _ in range(self._port.ticks):
            for name, port in self.ports.items():
                port.order(twists[name])
            running.advance()
            touching |= {item for contact in running.contacts() for item in (contact.robot, contact.other)}
            for port in self.ports.values():
                port.keep_scans()
            if running.outcome() is not None:
                break
        if running.failures[0] is not None:
            raise CrowdbotError(f"seed {running.seeds[0]}: {running.failures[0]}")
        return self._judge(touching)

    def _judge(self, touching: set[int]) -> tuple[dict[str, Any], ...]:
        """Return the results of a step and remove the agents that have ended."""
        running, acting = self._running, list(self.agents)
        end = running.outcome()
        over, fall = end is not None, end == "fall"
        rest = "timeout" if end in ("success", "collision") else end  # those are another robot's
        rewards: dict[str, float] = {}
        ended: dict[str, bool] = {}
        cut: dict[str, bool] = {}
        infos: dict[str, dict[str, Any]] = {}
        for name in acting:
            port = self.ports[name]
            collision = int(running.world.ids[0, port.control.agent]) in touching and running.trial.end.collision
            success = bool(port.control.arrived[0]) and not collision
            distance = float(port.goal_distance()[0])
            flags = (np.array([success]), np.array([collision]), np.array([self._distance[name] - distance]))
            rewards[name] = float(self.reward.values(port.clearance(), *flags, port.dt)[0])
            self._distance[name] = distance
            ended[name] = success or collision or fall
            cut[name] = over and not ended[name]
            info: dict[str, Any] = {"seed": running.seeds[0]}
            if ended[name] or cut[name]:
                outcome = "success" if success else "collision" if collision else rest
                info |= {"outcome": outcome, "is_success": success}
            infos[name] = info
        self.agents = [name for name in acting if not (ended[name] or cut[name])]
        return self._observe(acting), rewards, ended, cut, infos

    def render(self) -> Any:
        """Return the image ``[H, W, 3]`` of the camera, uint8; None without a render mode."""
        if self.render_mode is None:
            return None
        if self._view is None:
            self._view = SimulationCamera(self._running, self.camera)
        return self._view.shot().rgb

    def close(self) -> None:
        """End the episode."""
        self.simulation, self._view, self.agents = None, None, []

    @property
    def _running(self) -> Simulation:
        if self.simulation is None:
            raise InputError("call reset before anything else")
        return self.simulation

    def _observe(self, names: list[str]) -> dict[str, Observation]:
        return {name: first_environment(self.ports[name].observe()) for name in names}


def parallel_env(trial: Trial | str, **options: Any) -> ParallelCrowdEnv:
    """Return the robots of a trial as agents of PettingZoo; options are those of :class:`ParallelCrowdEnv`.

    >>> parallel_env("circle-crossing", action="velocity").possible_agents
    ['robot']
    """
    return ParallelCrowdEnv(trial, **options)
