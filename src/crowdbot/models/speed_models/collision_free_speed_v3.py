"""CollisionFreeSpeedV3: the collision-free speed model with a bounded turn that follows the nearest neighbour ahead."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.models.model import CrowdModel, begin_step, launch, movable, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import parameter_columns
from crowdbot.models.valid_range import JAMS, JUPEDSIM, TWO_WAY, ModelRange
from crowdbot.typing import Floats

from .collision_free_speed import is_hidden, push_by_walls, way_to, within

MEMORY = "steering_angle"
"""Name in the memory of a scene: angle [rad] of each agent from the direction past the walls to its heading."""
STRAIGHT = 0.05
"""Lateral offset [m] within which the side of a neighbour is blurred."""
GOAL_SHARE = 0.15
"""Share of the space towards the goal in the space that limits the speed; the rest is the space ahead."""
REVERSE = 0.01
"""Maximum speed backwards [m/s], which releases agents who block each other."""
LAW = (
    "max_turn", "range_ahead", "range_aside", "wall_strength", "wall_range", "time_gap", "buffer",
    "reaction_time", "neighbor_distance",
)  # fmt: skip
"""Parameters in the order of the kernel."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    heading: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    max_turn: Floats
    range_ahead: Floats
    range_aside: Floats
    wall_strength: Floats
    wall_range: Floats
    time_gap: Floats
    buffer: Floats
    reaction: Floats
    reach: Floats
    walking: NDArray[np.bool_]


@kernel
def _wanted_turn(
    seen: Floats, held: int, ux: float, uy: float, ahead: float, aside: float, most: float
) -> float:  # fmt: skip
    """Return the turn [rad] away from the neighbour with the largest weight in front, positive to the left."""
    heaviest, influence = 0.0, 0.0
    for n in range(held):
        x = ux * seen[n, 0] + uy * seen[n, 1]
        if x <= 0.0:
            continue
        y = ux * seen[n, 1] - uy * seen[n, 0]
        weight = math.exp(-x / ahead) * math.exp(-abs(y) / aside)
        if weight > heaviest:
            heaviest, influence = weight, -weight * (y / (abs(y) + STRAIGHT))
    return most * math.tanh(influence)


@kernel
def _space(seen: Floats, held: int, ux: float, uy: float) -> float:
    """Return the free distance [m] in direction u; inf if nobody is in the way."""
    free = math.inf
    for n in range(held):
        free = min(free, way_to(seen[n, 0], seen[n, 1], ux, uy, seen[n, 2]))
    return free


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, angle: Floats, out: Floats) -> None:
    """Choose the next velocity and steering angle of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, dt, angle, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, angle: Floats, out: Floats
) -> None:
    # unpack the tuples outside of the loop: each access counts references
    place, heading, desired, radius, top, most, ahead, aside = crowd[:8]
    wall_strength, wall_scale, gap, buffer, reaction, reach, walking = crowd[8:]
    agent, number, order = near
    A = agent.shape[1]
    found = np.empty(len(walls), dtype=np.int64)
    seen = np.empty((agent.shape[2], 3))  # relative position of each visible neighbour, and sum of the radii
    for k in range(begin, end):
        row = order[k]
        wish = math.sqrt(desired[row, 0] ** 2 + desired[row, 1] ** 2)
        if not walking[row] or wish == 0.0:
            continue
        e, a = row // A, row % A
        x, y = place[row, 0], place[row, 1]
        gx, gy = desired[row, 0] / wish, desired[row, 1] / wish
        count = within(walls, x, y, reach[row], found)
        held = 0
        for n in range(number[e, a]):
            other = row - a + agent[e, a, n]
            dx, dy = place[other, 0] - x, place[other, 1] - y
            if not is_hidden(walls, found, count, x, y, dx, dy):
                seen[held, 0], seen[held, 1], seen[held, 2] = dx, dy, radius[row] + radius[other]
                held += 1
        ux, uy = push_by_walls(walls, found, count, x, y, radius[row], wall_strength[row], wall_scale[row], gx, gy)
        if ux == 0.0 and uy == 0.0:
            ux, uy = math.cos(heading[row]), math.sin(heading[row])
        turn = _wanted_turn(seen, held, ux, uy, ahead[row], aside[row], most[row])
        turn = angle[row] + min(dt / reaction[row], 1.0) * (turn - angle[row])
        cos, sin = math.cos(turn), math.sin(turn)
        ux, uy = ux * cos - uy * sin, ux * sin + uy * cos
        free = (1.0 - GOAL_SHARE) * _space(seen, held, ux, uy) + GOAL_SHARE * _space(seen, held, gx, gy)
        speed = min(max((free - buffer[row]) / gap[row], -REVERSE), wish, top[row])
        speed = max(speed, -top[row])
        angle[row] = turn
        out[row, 0], out[row, 1] = speed * ux, speed * uy


@dataclass(frozen=True)
class CollisionFreeSpeedV3(CrowdModel):
    """First-order model: agents turn away from the nearest neighbour ahead, and the gap ahead limits the speed.

    Args:
        max_turn: maximum angle [rad] between the direction past the walls and the heading.
        range_ahead: decay length of the influence of a neighbour along the direction [m].
        range_aside: decay length of the influence of a neighbour across the direction [m].
        wall_strength: strength of the repulsion by walls, relative to 1 for the desired direction.
        wall_range: decay length of the repulsion by walls [m].
        time_gap: time gap to the next agent ahead at the chosen speed [s].
        buffer: distance [m] that agents keep at rest.
        reaction_time: time constant of the turn [s]; at least the time step.
        neighbor_distance: maximum distance of neighbours and walls [m]; neighbours behind a wall are ignored.
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    Walls bend the desired direction ``e0`` to ``e``. Of the neighbours in front, at ``x`` along and ``y`` to the left
    of ``e``, the one with the largest weight ``w = exp(-x / range_ahead - |y| / range_aside)`` sets the turn
    ``max_turn tanh(-w y / (|y| + 0.05 m))``, which the angle of the heading approaches with ``reaction_time``. The
    speed is ``(0.85 s + 0.15 s0 - buffer) / time_gap``, with the space ``s`` along the heading and ``s0`` along ``e0``,
    at most the desired speed and at least -0.01 m/s.

    The angle of an agent is stored in the memory ``steering_angle`` of the scene. Use :meth:`step`; :meth:`velocity`
    does not update the memory.

    The default follows version 3 of the model in JuPedSim 1.4.2; its two ranges and its turn are products and limits of
    the parameters there. Neighbourhoods are limited by distance and by number.

    Source: Tordeux, Chraibi, Seyfried 2016, doi:10.1007/978-3-319-33482-0_29, as version 3 of JuPedSim 1.4.2.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> ahead = Scene.of([[0, 0], [1.4, 0.1]], radius=0.2, goal=[[9, 0], [9, 0.1]], preferred_speed=[1.3, 0.5])
    >>> CollisionFreeSpeedV3().step(ahead, dt=0.1).velocity.round(2).tolist()
    [[[0.99, -0.15], [0.5, 0.0]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Antoine Tordeux, Mohcine Chraibi, Armin Seyfried",
        2016,
        "Collision-free speed model for pedestrian dynamics",
        "Traffic and Granular Flow '15",
        "10.1007/978-3-319-33482-0_29",
    )
    batched = True
    valid_range = ModelRange(0.5, JAMS, 0.01, TWO_WAY, JUPEDSIM)

    max_turn: PerAgent = parameter(1.57, unit="rad", low=0.2, high=3.0, source="JuPedSim 1.4.2", max=math.pi)
    range_ahead: PerAgent = parameter(2.0, unit="m", low=0.2, high=5.0, source="JuPedSim 1.4.2, 20 times 0.1", min=1e-3)
    range_aside: PerAgent = parameter(0.8, unit="m", low=0.1, high=3.0, source="JuPedSim 1.4.2, 8 times 0.1", min=1e-3)
    wall_strength: PerAgent = parameter(5.0, unit="1", low=1.0, high=15.0, source="JuPedSim 1.4.2")
    wall_range: PerAgent = parameter(0.02, unit="m", low=0.01, high=0.2, source="JuPedSim 1.4.2", min=1e-3)
    time_gap: PerAgent = parameter(1.0, unit="s", low=0.3, high=2.0, source="JuPedSim 1.4.2", min=1e-2)
    buffer: PerAgent = parameter(0.0, unit="m", low=0.0, high=0.3, source="JuPedSim 1.4.2")
    reaction_time: PerAgent = parameter(0.3, unit="s", low=0.1, high=1.0, source="JuPedSim 1.4.2", min=1e-3)
    neighbor_distance: PerAgent = parameter(3.0, unit="m", low=1.0, high=5.0, source="JuPedSim 1.4.2")
    max_neighbors: PerAgent = parameter(50.0, unit="1", low=5.0, high=100.0, source="crowdbot: more are never needed")
    max_speed: PerAgent | None = None

    @property
    def memory_at_start(self) -> Mapping[str, float]:
        return {MEMORY: 0.0}

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        return self._move(scene, dt)[0]

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        velocity, angle = self._move(scene, dt)
        angle = np.where(movable(scene), angle, 0.0)
        return scene.advance(velocity, dt).replace(memory={**scene.memory, MEMORY: angle})

    def _move(self, scene: Scene, dt: float) -> tuple[Floats, Floats]:
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        values = (
            rows(scene.position),
            rows(scene.heading),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            *parameter_columns(self, scene.shape, *LAW),
            rows(walking),
        )
        crowd = _Crowd._make(values)
        angle = np.array(per_agent(scene.memory.get(MEMORY, 0.0), scene.shape, MEMORY), dtype=np.float64)
        launch(_choose, _choose_part, rows(out), crowd, near, scene.walls.segments(), float(dt), rows(angle))
        return out, angle
