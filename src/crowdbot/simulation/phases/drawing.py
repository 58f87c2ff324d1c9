"""SVG drawing of the current step of a simulation, seen from above."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.core import PERSON_COLOR, ROBOT_COLOR, WALL_COLOR, Disc, Path2D, draw_svg
from crowdbot.trials import floor_plan
from crowdbot.world import worlds_of

__all__ = ["simulation_svg"]


def simulation_svg(simulation: Any, environment: int = 0) -> str:
    """Return an SVG drawing of an environment: stage with ground, doors at their current angle, people and robots."""
    worlds, stage = worlds_of(simulation.world), simulation.trial.stage
    doors = worlds[environment if len(worlds) > 1 else 0].doors
    shares = {}
    if doors is not None:
        shares = {leaf.name: float(share) for leaf, share in zip(doors.leaves, doors.signed_share, strict=True)}
    lines = floor_plan(stage, shares)
    lines += [Path2D(np.concatenate([ring, ring[:1]]), WALL_COLOR, 1.5) for ring in stage.rings]
    scene, discs = simulation.world.environment_scene(environment), list[Disc]()
    robots = {robot.agent for robot in simulation.robots}
    for agent in np.flatnonzero(scene.active[0]).tolist():
        color = ROBOT_COLOR if agent in robots else PERSON_COLOR
        x, y = scene.position[0, agent].tolist()
        radius, heading = float(scene.radius[0, agent]), float(scene.heading[0, agent])
        discs.append(Disc(x, y, radius, color))
        ahead = radius * np.array([np.cos(heading), np.sin(heading)])
        lines.append(Path2D(np.array([[x, y], [x, y]]) + np.stack([ahead, 1.6 * ahead]), color, 1.5))
    seconds = float(simulation.world.times[environment])
    return draw_svg(lines, discs, f"{simulation.trial.name}, seed {simulation.seeds[environment]}, {seconds:.2f} s")
