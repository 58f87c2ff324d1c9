"""The measured task: people on a circle and a robot go to the opposite side."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

from crowdbot.sensors import GroundTruthPeople, Lidar2D
from crowdbot.simulation import Simulation, simulate_seeds
from crowdbot.trials import Mount, Trial, load_trial
from crowdbot.typing import Floats

from .work_rate import TimedWork

BEAMS, RANGE = 180, 10.0
"""Beams of the scanner, and the range of the robot's sensors [m]."""
CIRCLES = {10: (4.0, 0.35), 50: (10.0, 0.2)}
"""Radius of the circle and half width of the start squares [m], by number of people."""


@dataclass(frozen=True)
class CrossingTask:
    """Starts and goals of all agents in W worlds, for other simulators; the robot is the last of A agents.

    Fields:
        position, goal: ``[W, A, 2]`` [m].
        dt: time step [s].
        control_period: time between decisions of the robot, and between its scans [s].
        duration: longest time of an episode [s].
        beams: beams of the scanner, 0 without one.
        radius, speed, tolerance: radius [m] and maximum speed [m/s] of all agents; distance at which a goal counts as
            reached [m].
        horizon, neighbor_distance, max_neighbors: settings of ORCA: time horizon [s], distance [m] and number.
    """

    position: Floats
    goal: Floats
    dt: float
    control_period: float
    duration: float
    beams: int
    radius: float = 0.3
    speed: float = 1.0
    tolerance: float = 0.3
    horizon: float = 5.0
    neighbor_distance: float = 10.0
    max_neighbors: int = 10

    @classmethod
    def of(cls, trial: Trial, worlds: int) -> CrossingTask:
        """Return the task of a trial with the seeds 0 to ``worlds`` - 1."""
        scene, robot = Simulation(trial, range(worlds)).world.scene, trial.robots[0]
        goal = scene.goal.copy()
        goal[:, -1] = robot.goal.position
        beams = [mount.sensor.rays for mount in robot.sensors if isinstance(mount.sensor, Lidar2D)]
        return cls(scene.position.copy(), goal, trial.step, robot.control_period, trial.duration, sum(beams))


def crossing_trial(people: int, beams: int) -> Trial:
    """Return the trial of the rows: the robot is visible, and observes and decides in every step of 0.05 s.

    Without beams, the robot has a perfect tracker, since its navigator needs the people nearby.
    """
    circle, noise = CIRCLES[people]
    trial = load_trial("circle-crossing", people=people, radius=circle, noise=noise)
    rate = 1.0 / trial.step
    sensor: Any = GroundTruthPeople(rate=rate, range_max=RANGE, visible_only=False)
    if beams:
        sensor = Lidar2D(rate=rate, rays=beams, range_min=0.05, range_max=RANGE)
    mount = Mount(name="people", sensor=sensor, z=0.4)
    robot = dataclasses.replace(trial.robots[0], visible=True, control_period=trial.step, sensors=(mount,))
    return dataclasses.replace(trial, robots=(robot,))


def advance_work(trial: Trial, environments: int, steps: int) -> TimedWork:
    """Return the work of the first steps of E environments, without resets and records."""
    simulation = Simulation(trial, range(environments))

    def prepare() -> Simulation:
        simulation.restart(range(environments), range(environments))
        return simulation

    return TimedWork(environments * steps, prepare, repeat_step(steps))


def repeat_step(steps: int) -> Callable[[Simulation], None]:
    """Return a function that makes steps of a simulation."""

    def work(simulation: Simulation) -> None:
        for _ in range(steps):
            simulation.advance()

    return work


def reset_work(trial: Trial, environments: int, together: int) -> TimedWork:
    """Return the work to restart environments with new seeds, ``together`` in each call; at most 32 calls."""
    simulation = Simulation(trial, range(environments))
    simulation.advance()
    calls = max(1, min(32, environments // together))

    def work(state: Simulation) -> None:
        for k in range(calls):
            index = range(k * together, (k + 1) * together)
            state.restart(index, [environments + e for e in index])

    return TimedWork(calls * together, lambda: simulation, work)


def episode_work(trial: Trial, episodes: int, block: int) -> TimedWork:
    """Return the work of episodes from the check of the trial to the end, with all records in memory."""

    def work(state: object) -> None:
        for first in range(0, episodes, block):
            simulate_seeds(trial, range(first, min(first + block, episodes)))

    return TimedWork(episodes, lambda: None, work)
