"""Values of a simulation at one instant, for live plots."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import Scene
from crowdbot.metrics import AgentStates, record_clearance
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
    robots = [robot.agent for robot in simulation.robots]
    people = scene.active[0].copy()
    people[robots] = False
    pace = np.hypot(*scene.velocity[0, people].T)
    found: dict[str, float] = {"people": float(people.sum())}
    found["walking"] = float(pace.mean()) if len(pace) else math.nan
    if robots and scene.active[0, robots[0]]:
        robot = robots[0]
        agents = np.flatnonzero(scene.active[0])
        rows = (getattr(scene, name)[0, agents] for name in ("position", "velocity", "heading", "radius"))
        radius, outline = float(scene.radius[0, robot]), simulation.robots[0].robot.body.outline
        now = record_clearance(
            None,
            AgentStates(0.0, agents, *rows),
            int(np.searchsorted(agents, robot)),
            radius,
            scene.walls.segments(),
            0.0,
            outline,
        )
        found |= {
            "clearance": now.nearest,
            "speed": float(np.hypot(*scene.velocity[0, robot])),
            "wall": now.wall,
            "goal": float(math.dist(scene.position[0, robot], simulation.robots[0].goal[0])),
            "ttc": now.ttc,
            "density": now.density,
        }
    return {item.name: _finite(found.get(item.name, math.nan)) for item in LIVE_VALUES}


def _finite(value: float) -> float | None:
    return round(value, 4) if math.isfinite(value) else None
