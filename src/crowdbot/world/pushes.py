"""Pushes: forces on people from outside, for a time.

In the plane, a push changes the velocity of a person by ``F dt / m``. The person drifts with this velocity, on top of
the motion by the crowd model, and recovers as a pushed person of the physics world without balance does. In the physics
world the force acts on the body in the engine, see :mod:`crowdbot.world.physics.balance.force_pushes`.
"""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import Scene
from crowdbot.metrics import step_wall_clearance
from crowdbot.typing import Floats, Ints
from crowdbot.world.physics.balance.recovery import CENTER, recovery_force

PUSH = "push"
"""Name in the memory of a scene ``[E, A, 9]``; see the columns below. It is there from the first push on."""
FORCE, LEFT, DRIFT, SINCE, WHO, MASS, CENTER_HEIGHT = slice(0, 2), 2, slice(3, 5), 5, 6, 7, 8
"""Columns: acceleration by the force [m/s2], time [s] for which it still acts, drift [m/s], time [s] since the push
began, 1 + id of the person (0: nobody is pushed), mass [kg] and height of the centre of mass [m]."""
STEADY = 1e-4
"""A drift below this [m/s] is over."""
STEP = 0.005
"""Largest time step [s] of a drift, that of the engine."""


def push_memory(
    memory: Floats | None, shape: tuple[int, int], environment: int, slot: int, person: int, force: Floats,
    duration: float, mass: float, height: float,
) -> Floats:  # fmt: skip
    """Return the memory of pushes ``[E, A, 9]`` with one more. A push replaces the rest of an earlier one.

    Args:
        memory: the memory before, None for the first push.
        shape: number of environments and agents.
        environment, slot, person: environment, index and id of the person.
        force: force ``[2]`` [N].
        duration: time for which it acts [s].
        mass: mass of the person [kg].
        height: stature [m].
    """
    result = np.zeros((*shape, 9)) if memory is None else memory.copy()
    row = result[environment, slot]
    if row[WHO] != person + 1:
        row[:] = 0.0
    row[FORCE], row[LEFT], row[SINCE] = force / mass, duration, 0.0
    row[WHO], row[MASS], row[CENTER_HEIGHT] = person + 1, mass, CENTER * height
    return result


def acting_pushes(scene: Scene, ids: Ints, environment: int = 0) -> Ints:
    """Return the people who are present and pushed, or not yet over a push.

    Args:
        scene: the scene.
        ids: identities ``[E, A]``.
        environment: index of the environment.
    """
    if PUSH not in scene.memory:
        return np.zeros(0, dtype=np.int64)
    rows = scene.memory[PUSH][environment]
    same = rows[:, WHO] == ids[environment, : len(rows)] + 1
    return np.flatnonzero(same & scene.active[environment])


def without_drift(scene: Scene) -> Scene:
    """Return the scene with the velocities that the crowd model has chosen, without those of pushes."""
    if PUSH not in scene.memory or not scene.memory[PUSH][..., DRIFT].any():
        return scene
    return scene.replace(velocity=scene.velocity - scene.memory[PUSH][..., DRIFT])


def drift_people(scene: Scene, ids: Ints, dt: float) -> Scene:
    """Return the scene after a step of the crowd of ``dt`` [s] with the motion by pushes; walls stop it.

    Args:
        scene: people where the crowd model has moved them; some are pushed, or were.
        ids: identities ``[E, A]``.
        dt: time step [s].
    """
    memory, position, velocity = scene.memory[PUSH].copy(), scene.position.copy(), scene.velocity.copy()
    segments = scene.walls.segments()
    for e in range(len(memory)):
        pushed = acting_pushes(scene, ids, e)
        gone = np.setdiff1d(np.flatnonzero(memory[e, :, WHO]), pushed)
        memory[e, gone] = 0.0
        for slot in pushed.tolist():
            row, here = memory[e, slot], position[e, slot].copy()
            way = _drift(row, dt)
            if not _is_free(here, here + way, float(scene.radius[e, slot]), segments):
                row[DRIFT], way = 0.0, np.zeros(2)
            position[e, slot] += way
            velocity[e, slot] += row[DRIFT]
            if row[LEFT] <= 0.0 and not row[DRIFT].any():
                row[:] = 0.0
    return scene.replace(position=position, velocity=velocity, memory={**scene.memory, PUSH: memory})


def keep_pushes(scene: Scene, ids: Ints, dt: float, unsettled: Ints) -> Scene:
    """Return the scene after a step of the engine of ``dt`` [s], with the pushes that are not over; E = 1.

    Args:
        scene: the scene.
        ids: identities ``[1, A]``.
        dt: time step [s].
        unsettled: people who are not yet on the path of the crowd model.
    """
    if PUSH not in scene.memory:
        return scene
    memory = scene.memory[PUSH].copy()
    memory[0, :, LEFT] = np.maximum(memory[0, :, LEFT] - dt, 0.0)
    kept = np.zeros(len(memory[0]), dtype=np.bool_)
    kept[acting_pushes(scene, ids)] = True
    lasting = memory[0, :, LEFT] > 1e-12
    lasting[unsettled] = True
    memory[0, ~(kept & lasting)] = 0.0
    return scene.replace(memory={**scene.memory, PUSH: memory})


def _drift(row: Floats, dt: float) -> Floats:
    """Advance the drift of one person by ``dt`` [s], the force and the recovery, and return the way ``[2]`` [m]."""
    count = max(1, math.ceil(dt / STEP - 1e-9))
    h, way = dt / count, np.zeros(2)
    mass, height = row[MASS : MASS + 1], row[CENTER_HEIGHT : CENTER_HEIGHT + 1]
    for _ in range(count):
        acts = min(row[LEFT], h)
        row[LEFT] = row[LEFT] - h if row[LEFT] - h > 1e-12 else 0.0
        row[SINCE] += h
        drift, over = row[DRIFT] + acts * row[FORCE], row[LEFT] == 0.0
        back = recovery_force(-drift[None], mass, height, row[SINCE : SINCE + 1], np.array([over]))[0] / mass
        size, less = float(np.sqrt(drift @ drift)), float(np.sqrt(back @ back)) * h
        ended = over and (less >= size or size < STEADY)
        row[DRIFT] = 0.0 if ended else drift * max(0.0, 1.0 - less / max(size, 1e-12))
        way += h * row[DRIFT]
    return way


def _is_free(start: Floats, end: Floats, radius: float, segments: Floats) -> bool:
    """Return whether a disc does not come closer to a wall than its radius, or not closer than it is."""
    size = np.array([radius])
    now = step_wall_clearance(start[None], start[None], size, segments)[0]
    return bool(step_wall_clearance(start[None], end[None], size, segments)[0] >= min(now, 0.0) - 1e-9)
