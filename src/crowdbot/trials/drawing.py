"""SVG drawing of a trial: stage, zones of people, robots."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.core import PERSON_COLOR, ROBOT_COLOR, WALL_COLOR, Disc, Path2D, draw_svg

from .ground.plan import floor_plan


def trial_svg(trial: Any) -> str:
    """Return an SVG drawing: walls grey, ground brown, doors, zones of people blue, robots and their goals red."""
    rings = [np.concatenate([ring, ring[:1]]) for ring in trial.stage.rings]
    lines = floor_plan(trial.stage) + [Path2D(ring, WALL_COLOR, 1.5) for ring in rings]
    for area in [spawner.zone for spawner in trial.spawners] + [source.zone for source in trial.sources]:
        zone = np.asarray(area, dtype=np.float64)
        lines.append(Path2D(np.concatenate([zone, zone[:1]]), PERSON_COLOR, 1.0, 0.6))
    discs = [Disc(agent.x, agent.y, 0.25, PERSON_COLOR) for agent in trial.agents]
    for robot in trial.robots:
        start = np.array([robot.x, robot.y], dtype=np.float64)
        lines.append(Path2D(np.stack([start, np.asarray(robot.goal.position)]), ROBOT_COLOR, 1.2, 0.6))
        discs.append(Disc(robot.x, robot.y, 0.3, ROBOT_COLOR))
    people = sum(spawner.count for spawner in trial.spawners) + len(trial.agents)
    who = f"{people} {'person' if people == 1 else 'people'} at the start"
    which = f"{len(trial.robots)} robot{'' if len(trial.robots) == 1 else 's'}"
    return draw_svg(lines, discs, f"{trial.name}: {who}, {which}, {trial.duration:g} s")
