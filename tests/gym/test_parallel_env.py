"""Several robots as agents of PettingZoo: the official check, the bytes of a run, ends of agents, wrong input."""

from __future__ import annotations

import dataclasses
import warnings
from typing import Any

import numpy as np
import pytest
from pettingzoo.test import parallel_api_test, parallel_seed_test

from crowdbot.core import InputError, Twist
from crowdbot.gym import parallel_env
from crowdbot.models import ORCA
from crowdbot.navigation import Navigator, Observation
from crowdbot.simulation import simulate
from crowdbot.trials import RobotGoal, Trial, load_trial


@dataclasses.dataclass(frozen=True)
class Steady(Navigator):
    """Commands half of the maximum speed."""

    def act(self, observation: Observation) -> Twist:
        return Twist(0.5 * observation.limits.max_speed, 0.1 * observation.limits.max_turn_rate)


def two_robots(duration: float = 6.0, **values: Any) -> Trial:
    trial = load_trial("square-crossing", people=4, duration=duration)
    first = trial.robots[0]
    near = RobotGoal(first.x + 2.0, first.y + 0.8, 0.4)
    second = dataclasses.replace(first, name="second", x=first.x + 2.0, goal=near)
    return dataclasses.replace(trial, robots=(first, second), **values)


def test_the_official_checks_pass() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        env = parallel_env(two_robots(3.0))
        parallel_api_test(env, num_cycles=80)
        parallel_seed_test(lambda: parallel_env(two_robots(3.0)), num_cycles=20)
    assert len(env.possible_agents) == 2


def test_an_episode_has_the_bytes_of_a_run() -> None:
    trial = two_robots(1.5)
    robots = tuple(dataclasses.replace(robot, navigator=Steady()) for robot in trial.robots)
    episode = simulate(dataclasses.replace(trial, robots=robots), 7)
    env = parallel_env(trial)
    env.reset(seed=7)
    steps = 0
    while len(env.agents) == 2:
        env.step({name: np.array([0.5, 0.1]) for name in env.agents})
        steps += 1
        now = np.flatnonzero(np.isclose(episode.times, steps * 0.1))
        assert env.simulation is not None
        assert env.simulation.world.scene.position[0].tobytes() == episode.position[now[0]].tobytes()
    assert steps >= 10


def test_an_agent_ends_at_its_goal_and_the_other_goes_on() -> None:
    env = parallel_env(two_robots(4.0))
    env.reset(seed=1)
    infos: dict[str, Any] = {}
    while "second" in env.agents:
        before = env.ports["second"].goal_distance()[0]
        _, rewards, terminations, truncations, infos = env.step({name: np.array([0.5, 0.0]) for name in env.agents})
    assert terminations["second"]
    assert not truncations["second"]
    assert infos["second"]["outcome"] == "success"
    gain = before - env.ports["second"].goal_distance()[0]
    assert gain > 0.0
    assert rewards["second"] == pytest.approx(1.0 + 0.1 * gain)
    assert env.agents == ["robot"]
    place = env.simulation.world.scene.position[0, env.ports["second"].control.agent].copy()
    last: dict[str, Any] = {}
    while env.agents:
        *_, truncations, last = env.step({"robot": np.zeros(2)})
    assert truncations == {"robot": True}
    assert last["robot"]["outcome"] == "timeout"
    now = env.simulation.world.scene.position[0, env.ports["second"].control.agent]
    assert np.hypot(*(now - place)) < 0.5


def test_a_trial_that_ends_as_planned_is_not_called_a_timeout() -> None:
    trial = two_robots(1.0)
    env = parallel_env(dataclasses.replace(trial, end=dataclasses.replace(trial.end, goal=False)))
    env.reset(seed=1)
    infos: dict[str, Any] = {}
    while env.agents:
        *_, infos = env.step({name: np.zeros(2) for name in env.agents})
    assert {name: info["outcome"] for name, info in infos.items()} == {"robot": "finished", "second": "finished"}


def test_robots_in_contact_end_with_a_collision() -> None:
    trial = two_robots(6.0)
    first, second = trial.robots
    second = dataclasses.replace(second, x=first.x + 1.5, y=first.y, heading=np.pi, goal=RobotGoal(-9.0, 9.0, 0.2))
    first = dataclasses.replace(first, heading=0.0)
    env = parallel_env(dataclasses.replace(trial, robots=(first, second)))
    env.reset(seed=3)
    infos: dict[str, Any] = {}
    rewards: dict[str, float] = {}
    while env.agents:
        before = {name: env.ports[name].goal_distance()[0] for name in env.agents}
        _, rewards, _, _, infos = env.step({name: np.array([1.0, 0.0]) for name in env.agents})
    assert {name: info["outcome"] for name, info in infos.items()} == {"robot": "collision", "second": "collision"}
    gains = {name: distance - env.ports[name].goal_distance()[0] for name, distance in before.items()}
    assert rewards == pytest.approx({name: -1.0 + 0.1 * gain for name, gain in gains.items()})


def test_wrong_values_are_refused() -> None:
    trial = two_robots()
    slow = dataclasses.replace(trial.robots[1], control_period=0.2)
    with pytest.raises(InputError, match=r"the same control period; they have robot 0.1 s, second 0.2 s"):
        parallel_env(dataclasses.replace(trial, robots=(trial.robots[0], slow)))
    with pytest.raises(InputError, match="trial 'empty' has no robot"):
        parallel_env(Trial(name="empty", duration=1.0, crowd=ORCA()))
    with pytest.raises(InputError, match="render_mode = 'human'"):
        parallel_env(trial, render_mode="human")
    env = parallel_env(trial)
    with pytest.raises(InputError, match="call reset before anything else"):
        env.step({})
    env.reset(seed=0)
    with pytest.raises(InputError, match="there is no action of second"):
        env.step({"robot": np.zeros(2)})
    with pytest.raises(InputError, match="actions must be finite"):
        env.step({"robot": np.full(2, np.nan), "second": np.zeros(2)})
