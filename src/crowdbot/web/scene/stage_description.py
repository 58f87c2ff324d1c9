"""Description of the stage of a scene: walls, ground, doors, props and zones."""

from __future__ import annotations

import math
from typing import Any

import numpy as np

from crowdbot.simulation import Simulation
from crowdbot.trials import Trial
from crowdbot.typing import Floats
from crowdbot.world import Chair, Cube, Table, Tree

MARGIN = 1.0
"""Free space [m] around what is shown."""


def stage_description(stage: Any) -> dict[str, Any]:
    """Return height, walls, uneven ground, doors and props of a stage.

    A wall is a line of two points, or a ring of corners with the solid on the left of each edge.

    >>> from crowdbot.trials import Stage, Wall
    >>> stage_description(Stage(walls=[Wall([(0, 0), (4, 0)])]))["walls"]
    [{'points': [[0.0, 0.0], [4.0, 0.0]], 'solid': False, 'inner': False}]
    """
    physical = stage.physical()
    props = len(stage.props)
    rings = stage.rings[: len(stage.rings) - props] if props else stage.rings
    return {
        "height": physical.wall_height,
        "floor": list(physical.floor_color),
        "wall": list(physical.wall_color),
        "walls": [_wall(ring) for ring in rings],
        "walkable": [list(map(list, stage.walkable))] if stage.walkable else [],
        "ground": [_part(item) for item in (physical.ground.parts if physical.ground is not None else ())],
        "doors": [_door(door) for door in physical.doors],
        "props": [_prop(prop) for prop in physical.props],
    }


def _wall(ring: Floats) -> dict[str, Any]:
    x, y = ring.T
    doubled = float(np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))
    return {"points": ring.round(4).tolist(), "solid": len(ring) > 2, "inner": len(ring) > 2 and doubled < 0.0}


def _part(one: Any) -> dict[str, Any]:
    return {"corners": one.corners.round(4).tolist(), "heights": one.heights.tolist(), "stairs": bool(one.stairs)}


def _door(leaf: Any) -> dict[str, Any]:
    return {
        "name": leaf.name, "kind": leaf.kind, "x": leaf.x, "y": leaf.y, "yaw": leaf.yaw, "width": leaf.width,
        "height": leaf.height, "angle": leaf.angle, "opening": leaf.opening,
    }  # fmt: skip


def _prop(one: Any) -> dict[str, Any]:
    found: dict[str, Any] = {"x": one.x, "y": one.y, "heading": one.heading, "movable": one.movable}
    if isinstance(one, Cube):
        return found | {"kind": "cube", "size": one.size, "color": list(one.color)}
    if isinstance(one, Table):
        return found | {"kind": "table", "length": one.length, "width": one.width, "height": one.height}
    if isinstance(one, Chair):
        return found | {"kind": "chair", "length": one.size, "width": one.size, "seat": one.seat, "height": one.height}
    if isinstance(one, Tree):
        return found | {"kind": "tree", "height": one.height, "trunk": one.trunk, "crown": one.crown}
    return found | {"kind": "none"}


def zone_descriptions(trial: Trial) -> list[dict[str, Any]]:
    """Return the zones of a trial: where people start, enter, go to, leave and are moved.

    >>> from crowdbot.trials import load_trial
    >>> sorted({zone["kind"] for zone in zone_descriptions(load_trial("crossing-flows"))})
    ['goal', 'start']
    """
    found = []
    for kind, elements in (("start", trial.spawners), ("source", trial.sources)):
        for element in elements:
            found.append(_zone(kind, element.name, element.zone))
            if element.goal:
                found.append(_zone("goal", element.name, element.goal))
    found += [_zone("exit", item.name, item.zone) for item in trial.exits]
    found += [_zone("portal", portal.name, portal.zone) for portal in trial.portals]
    for journey in trial.journeys:
        found += [_zone("stop", journey.name, stop.points) for stop in journey.stops if hasattr(stop, "points")]
    unique: list[dict[str, Any]] = []
    for zone in found:
        if zone not in unique:
            unique.append(zone)
    return unique


def _zone(kind: str, name: str, points: Any) -> dict[str, Any]:
    return {"kind": kind, "name": name, "points": [[float(x), float(y)] for x, y in points]}


def scene_bounds(simulation: Simulation) -> list[float]:
    """Return x0, y0, x1, y1 [m] around walls, people, robots and their goals; zones count without other limits."""
    trial, scene = simulation.trial, simulation.world.environment_scene(0)
    there = scene.active[0]
    points = [*trial.stage.rings, scene.position[0, there], *(robot.goal for robot in simulation.robots)]
    if not trial.stage.rings:
        points += [np.array(zone["points"]) for zone in zone_descriptions(trial)]
    every = np.concatenate([np.asarray(point, dtype=np.float64).reshape(-1, 2) for point in points])
    every = every[np.isfinite(every).all(axis=1)]
    if not len(every):
        return [-5.0, -5.0, 5.0, 5.0]
    low, high = every.min(axis=0) - MARGIN, every.max(axis=0) + MARGIN
    middle, half = 0.5 * (low + high), np.maximum(0.5 * (high - low), 2.0)
    return [round(value, 3) for value in (*(middle - half).tolist(), *(middle + half).tolist()) if math.isfinite(value)]


def scene_focus(simulation: Simulation) -> list[float]:
    """Return x, y [m] of the first robot, or the middle of all people."""
    scene = simulation.world.environment_scene(0)
    there = scene.active[0].copy()
    for robot in simulation.robots[:1]:
        if there[robot.agent]:
            return [float(value) for value in scene.position[0, robot.agent].round(3)]
    if not there.any():
        return [0.0, 0.0]
    return [float(value) for value in scene.position[0, there].mean(axis=0).round(3)]
