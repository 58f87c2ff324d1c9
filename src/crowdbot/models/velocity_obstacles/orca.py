"""ORCA: optimal reciprocal collision avoidance between discs, and between discs and walls."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.models.model import (
    CrowdModel,
    begin_step,
    check_limit,
    launch,
    neighbors_of,
    rows,
    speed_limit,
)

from .linear_program import best_velocity
from .orca_lines import Edges, avoid_agent, avoid_edge, edges_in_reach, edges_of

__all__ = ["ORCA"]

Floats = NDArray[np.float64]
SHORTEST = 1e-3
"""Minimum time horizon [s]; a horizon of 0 has no line."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    horizon: Floats
    wall_horizon: Floats
    external: NDArray[np.bool_]
    walking: NDArray[np.bool_]


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, edges: Edges, dt: float, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, edges, dt, out)


@kernel
def _choose_part(begin: int, end: int, crowd: _Crowd, near: Neighbors, edges: Edges, dt: float, out: Floats) -> None:
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, desired, radius, top, horizon, wall_horizon, external, walking = crowd
    agent, number, order = near
    corner, direction, previous, following, convex = edges
    A = agent.shape[1]
    found = np.empty(len(corner), dtype=np.int64)
    gap2 = np.empty(len(corner))
    lines = np.empty((len(corner) + agent.shape[2], 4))
    spare = np.empty_like(lines)
    for k in range(begin, end):
        row = order[k]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        x, y, vx, vy = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1]
        reach = wall_horizon[row] * top[row] + radius[row]
        fixed = int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
        for n in range(edges_in_reach(corner, following, x, y, reach, found, gap2)):
            fixed += avoid_edge(
                lines, fixed, found[n], corner, direction, previous, following, convex,
                x, y, vx, vy, radius[row], wall_horizon[row],
            )  # fmt: skip
        count = fixed
        for n in range(number[e, a]):
            other = row - a + agent[e, a, n]
            share = 1.0 if external[other] else 0.5
            avoid_agent(
                lines, count, place[other, 0] - x, place[other, 1] - y, vx, vy, velocity[other, 0], velocity[other, 1],
                radius[row] + radius[other], horizon[row], dt, share, 1.0 if row < other else -1.0,
            )  # fmt: skip
            count += 1
        out[row, 0], out[row, 1] = best_velocity(lines, fixed, count, top[row], desired[row, 0], desired[row, 1], spare)


@dataclass(frozen=True)
class ORCA(CrowdModel):
    """Optimal reciprocal collision avoidance: each pair shares the smallest velocity change that avoids a collision.

    Args:
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        time_horizon: time horizon for agents [s].
        time_horizon_walls: time horizon for walls [s].
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.
        reciprocal: whether external agents, such as robots, are expected to make half of the change.

    External agents do not give way; unless ``reciprocal``, the others make the whole change. The model chooses the
    permitted velocity nearest to the desired one. If none is permitted, it minimises the largest violation (walls are
    never violated). Velocities may be discontinuous: real robots need an acceleration limit.

    The default reproduces the RVO2 library. Differences: external agents take no share of the avoidance, and
    overlapping walls and degenerate scenes give bounded velocities.

    Source: van den Berg, Guy, Lin, Manocha 2011, doi:10.1007/978-3-642-19457-3_1, as in the RVO2 library.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> ahead = Scene.of([[0, 0], [3, 0.1]], [[1, 0], [-1, 0]], preferred_velocity=[[1, 0], [-1, 0]])
    >>> ORCA().velocity(ahead, dt=0.1).round(3).tolist()
    [[[0.982, -0.132], [-0.982, 0.132]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Jur van den Berg, Stephen J. Guy, Ming Lin, Dinesh Manocha",
        2011,
        "Reciprocal n-body collision avoidance",
        "Robotics Research (ISRR)",
        "10.1007/978-3-642-19457-3_1",
    )

    neighbor_distance: PerAgent = parameter(5.0, unit="m", low=1.0, high=15.0, source="RVO2, pedestrian settings")
    max_neighbors: PerAgent = parameter(10.0, unit="1", low=1.0, high=20.0, source="RVO2, examples")
    time_horizon: PerAgent = parameter(
        2.0, unit="s", low=0.2, high=8.0, source="RVO2, pedestrian settings", min=SHORTEST
    )
    time_horizon_walls: PerAgent = parameter(
        2.0, unit="s", low=0.2, high=4.0, source="CrowdBot simulator, horizon of agents", min=SHORTEST
    )
    max_speed: PerAgent | None = None
    reciprocal: bool = False

    def __post_init__(self) -> None:
        super().__post_init__()
        check_limit(self, self.max_speed)

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        """Return the velocities ``[E, A, 2]`` [m/s] for the next ``dt`` [s]; ``rng`` is not used."""
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        crowd = _Crowd(
            rows(scene.position),
            rows(scene.velocity),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            rows(per_agent(self.time_horizon, scene.shape, "time_horizon")),
            rows(per_agent(self.time_horizon_walls, scene.shape, "time_horizon_walls")),
            rows(np.zeros_like(scene.external) if self.reciprocal else scene.external),
            rows(walking),
        )
        launch(_choose, _choose_part, rows(out), crowd, near, edges_of(scene.walls), float(dt))
        return out
