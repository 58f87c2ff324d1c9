"""Motion of doors in a world, before the crowd moves."""

from __future__ import annotations

from typing import Any

import numpy as np

from crowdbot.typing import Floats
from crowdbot.world.crowd.routing import WAY, Router, fresh

from .doors import Doors

ONE_ENVIRONMENT = (
    "a planar world with doors has one environment, since its walls are those of all; join several worlds with"
    " join_worlds"
)


def move_doors(world: Any, elapsed: float | Floats) -> None:
    """Move the doors of a world with one environment by a step that begins at a time [s]."""
    doors: Doors = world.doors
    before = [*doors.blocked, *doors.side.tolist()]
    doors.advance(world.scene, float(np.ravel(elapsed)[0]), world.dt)
    show_doors(world, before != [*doors.blocked, *doors.side.tolist()])


def show_doors(world: Any, new_paths: bool = True) -> None:
    """Set the walls and the paths of a world by its doors; ``new_paths`` forgets the paths that people follow."""
    doors: Doors = world.doors
    if world.walls_fixed:
        world._outlined = doors.update_walls(world._outlined)
        world._plane = None
    else:
        walls = doors.update_walls(world.scene.walls)
        if walls is not world.scene.walls:
            world.scene, world._previous = world.scene.replace(walls=walls), world._previous.replace(walls=walls)
    base: Router | None = world._plain_router
    if base is None:
        return
    world.router = world._traffic.router = doors.router(base)
    if new_paths and WAY in world.scene.memory:
        memory = {**world.scene.memory, WAY: fresh(world.scene.shape)}
        world.scene = world.scene.replace(memory=memory)


def turn_leaves(doors: Doors, model: Any, data: Any, fraction: float, dt: float) -> None:
    """Set the joints of all leaves that people do not push, at a fraction of a step of ``dt`` [s]."""
    for k, leaf in enumerate(doors.leaves):
        if leaf.opening == "push":
            continue
        joint = model.joint(f"door{k}")
        share = doors.start[k] + fraction * (doors.share[k] - doors.start[k])
        way = doors.side[k] * leaf.range
        data.qpos[joint.qposadr[0]] = share * way
        data.qvel[joint.dofadr[0]] = (doors.share[k] - doors.start[k]) / dt * way


def read_leaves(doors: Doors, model: Any, data: Any) -> None:
    """Set the share of the leaves that people push from the engine."""
    for k, leaf in enumerate(doors.leaves):
        if leaf.opening == "push":
            angle = float(data.qpos[model.joint(f"door{k}").qposadr[0]])
            doors.set_share(k, float(np.clip(angle / leaf.range, -1.0, 1.0)))
