"""Selection of people near robots and movable props, for whom bodies are simulated."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Scene
from crowdbot.world.physics.robots.robot_body import RobotBody

from .stage import PhysicsStage

__all__ = ["add_unsteady", "movers", "people_near"]

Floats = NDArray[np.float64]
Mover = tuple[float, float, float, float, bool]


def people_near(
    scene: Scene, persons: NDArray[np.int64], movers: Sequence[Mover], reach: float
) -> tuple[NDArray[np.int64], Floats, NDArray[np.bool_], NDArray[np.bool_]]:
    """Return the people near a robot or a movable prop, the nearest first; E = 1.

    Args:
        scene: with positions and headings.
        persons: ``[P]`` agents that are people.
        movers: x, y, radius [m], mass [kg] of each robot and movable prop, and whether contacts cannot move it.
        reach: largest distance between a person and the outline of a mover [m].

    Returns:
        ``[N]`` indices into ``persons``; ``[P]`` mass of the nearest mover [kg]; ``[P]`` whether it is ahead; ``[P]``
        whether contacts cannot move it.
    """
    nearest = np.full(len(persons), np.inf)
    mass = np.ones(len(persons))
    ahead, firm = np.ones(len(persons), dtype=np.bool_), np.zeros(len(persons), dtype=np.bool_)
    looks = np.stack([np.cos(scene.heading[0, persons]), np.sin(scene.heading[0, persons])], axis=-1)
    for x, y, radius, weight, led in movers:
        away = np.array([x, y]) - scene.position[0, persons]
        gap = np.sqrt(np.sum(away * away, axis=1)) - radius
        closer = gap < nearest
        nearest[closer], mass[closer], firm[closer] = gap[closer], weight, led
        ahead[closer] = np.sum(away * looks, axis=1)[closer] >= 0.0
    near = np.flatnonzero(nearest < reach)
    near = near[np.lexsort((persons[near], nearest[near]))]
    return near, mass, ahead, firm


def add_unsteady(
    scene: Scene, persons: NDArray[np.int64], near: NDArray[np.int64], unsteady: NDArray[np.int64], reach: float
) -> NDArray[np.int64]:
    """Return who needs a body: people out of balance first, then those near movers, then those near the former.

    Args:
        scene: with positions.
        persons: ``[P]`` agents that are people.
        near: indices into ``persons`` of those near movers, by decreasing priority.
        unsteady: agents out of balance.
        reach: largest distance [m] of people whom they may touch.
    """
    own = np.flatnonzero(np.isin(persons, unsteady))
    if not len(own):
        return near
    away = scene.position[0, persons[:, None]] - scene.position[0, persons[own]][None]
    gap = np.sqrt(np.sum(away * away, axis=-1)).min(axis=1)
    close = np.flatnonzero(gap < reach)
    close = close[np.lexsort((persons[close], gap[close]))]
    wanted = np.concatenate([own, near, close])
    return wanted[np.sort(np.unique(wanted, return_index=True)[1])]


def movers(
    robots: Mapping[int, RobotBody], stage: PhysicsStage, movable: Sequence[int], data: Any, led: Sequence[int] = ()
) -> list[Mover]:
    """Return x, y, radius [m] and mass [kg] of robots, movable props and pushed doors, and whether they are firm.

    Contacts cannot move what is firm.

    Args:
        robots: bodies of the robots by agent.
        stage: stage with the props.
        movable: numbers of the movable props.
        data: data of the engine.
        led: agents of robots whose pose comes from outside.
    """
    found = []
    for agent, body in robots.items():
        ((x, y),) = body.pose.position.tolist()
        found.append((x, y, body.robot.radius, body.mass, agent in led))
    for number in movable:
        x, y, _ = data.body(f"prop{number}").xpos.tolist()
        prop = stage.props[number]
        found.append((x, y, math.sqrt(0.5) * getattr(prop, "size", 1.0), prop.weight, False))
    for k, leaf in enumerate(stage.doors):
        if leaf.opening == "push":  # the leaf, and the place where it is when closed
            x, y, _ = data.body(f"door{k}").xipos.tolist()
            closed = leaf.line(0.0).mean(axis=0).tolist()
            found += [(a, b, 0.5 * leaf.width, leaf.mass, False) for a, b in ((x, y), closed)]
    return found
