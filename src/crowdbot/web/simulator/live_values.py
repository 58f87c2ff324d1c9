"""Values of a simulation at one instant, for live plots."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import Scene
from crowdbot.metrics import clearance, local_density, time_to_collision, wall_clearance
from crowdbot.simulation import Simulation


class LiveValue(NamedTuple):
    """Name, title and unit of a value."""

    name: str
    title: str
    unit: str


LIVE_VALUES = (
    LiveValue("clearance", "Clearance to the nearest person", "m"),
    LiveValue("speed", "Speed of the robot", "m/s"),
    LiveValue("wall", "Clearance to walls", "m"),
    LiveValue("goal", "Distance to the goal", "m"),
    LiveValue("ttc", "Time to collision", "s"),
    LiveValue("density", "Density within 2.5 m of the robot", "1/m2"),
    LiveValue("people", "People", ""),
    LiveValue("walking", "Mean speed of people", "m/s"),
)
"""Values of the first robot and of the crowd."""


def live_values(simulation: Simulation, recorded: Scene | None = None) -> dict[str, float | None]:
    """Return the values now; None where there is no robot, person or wall.

    Args:
        simulation: the simulation.
        recorded: people and robots of a recorded instant, instead of those of the simulation.

    >>> from crowdbot.trials import load_trial
    >>> values = live_values(Simulation(load_trial("frontal")))
    >>> values["people"], values["speed"]
    (1.0, 0.0)
    """
    scene = simulation.world.environment_scene(0) if recorded is None else recorded
    robots = [one.agent for one in simulation.robots]
    people = scene.active[0].copy()
    people[robots] = False
    pace = np.hypot(*scene.velocity[0, people].T)
    found: dict[str, float] = {"people": float(people.sum())}
    found["walking"] = float(pace.mean()) if len(pace) else math.nan
    if robots and scene.active[0, robots[0]]:
        robot = robots[0]
        args = scene.position, scene.radius[0], scene.active, robot
        here = scene.position[0, robot]
        closing = time_to_collision(scene.position, scene.velocity, scene.radius[0], scene.active, robot)
        found |= {
            "clearance": float(clearance(*args).min()),
            "speed": float(np.hypot(*scene.velocity[0, robot])),
            "wall": float(wall_clearance(here[None], float(scene.radius[0, robot]), scene.walls.segments())[0]),
            "goal": float(math.dist(here, simulation.robots[0].goal[0])),
            "ttc": float(closing.min()),
            "density": float(local_density(scene.position, scene.active, robot)[0]),
        }
    return {one.name: _finite(found.get(one.name, math.nan)) for one in LIVE_VALUES}


def _finite(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None
