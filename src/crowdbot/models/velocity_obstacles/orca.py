"""ORCA: optimal reciprocal collision avoidance between discs, and between discs and walls."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, prange
from crowdbot.core.neighbors import CROWD, IN_ORDER, SMALL, compare_rows
from crowdbot.models.agent_rows import (
    COLUMNS,
    LIMIT,
    RADIUS,
    VX,
    VY,
    WISH_X,
    WISH_Y,
    X,
    Y,
    begin_rows,
    fill_rows,
    speed_limit,
)
from crowdbot.models.model import CrowdModel, launch
from crowdbot.models.parameter_rows import parameter_rows
from crowdbot.models.valid_range import FREE, PAGE, ModelRange
from crowdbot.typing import Bools, Floats, Rows

from .linear_program import best_velocity, clip_speed
from .orca_lines import (
    BLOCK,
    BLOCK_ROWS,
    LINE,
    SHARE,
    Edges,
    avoid_agent,
    avoid_agents,
    avoid_edge,
    edges_in_reach,
    edges_of,
)

SHORTEST = 1e-3
"""Minimum time horizon [s]; a horizon of 0 has no line."""


PARAMETERS = ("time_horizon", "time_horizon_walls", "neighbor_distance", "max_neighbors")
"""Columns of the parameters in kernels."""


@kernel(parallel=True)
def _choose(
    agents: Floats, walking: Bools, external: Bools, parameters: Floats, near: Neighbors, edges: Edges, dt: float,
    out: Floats,
) -> None:  # fmt: skip
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(
            part * CHUNK, min((part + 1) * CHUNK, len(out)), agents, walking, external, parameters, near, edges, dt, out
        )


@kernel
def _choose_part(
    begin: int, end: int, agents: Floats, walking: Bools, external: Bools, parameters: Floats, near: Neighbors,
    edges: Edges, dt: float, out: Floats,
) -> None:  # fmt: skip
    # unpack the tuples outside of the loop: each access counts references
    agent, number, order = near
    corner, direction, previous, following, convex = edges
    A = agent.shape[1]
    found = np.empty(len(corner), dtype=np.int64)
    gap2 = np.empty(len(corner))
    lines = np.empty((len(corner) + agent.shape[2], 4))
    spare, block = np.empty_like(lines), np.empty((BLOCK_ROWS, BLOCK))
    for k in range(begin, end):
        row = order[k]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        shared = e % len(agent)  # copies of an environment have the same neighbours
        x, y, vx, vy = agents[row, X], agents[row, Y], agents[row, VX], agents[row, VY]
        radius, top = agents[row, RADIUS], agents[row, LIMIT]
        own = row if len(parameters) > 1 else 0
        horizon, wall_horizon = parameters[own, 0], parameters[own, 1]
        reach = wall_horizon * top + radius
        fixed = int(np.int64(0))  # a literal 0 has its own type, which compiles the callees twice
        for n in range(edges_in_reach(corner, following, x, y, reach, found, gap2)):
            fixed += avoid_edge(
                lines, fixed, found[n], corner, direction, previous, following, convex,
                x, y, vx, vy, radius, wall_horizon,
            )  # fmt: skip
        count = fixed
        best_x, best_y = clip_speed(agents[row, WISH_X], agents[row, WISH_Y], top)
        for first in range(0, number[e, a], BLOCK):
            held = min(BLOCK, number[e, a] - first)
            for n in range(held):
                other = row - a + agent[shared, a, first + n]
                block[X, n], block[Y, n] = agents[other, X] - x, agents[other, Y] - y
                block[VX, n], block[VY, n] = agents[other, VX], agents[other, VY]
                block[RADIUS, n], block[SHARE, n] = radius + agents[other, RADIUS], 1.0 if external[other] else 0.5
            violated = avoid_agents(block, held, vx, vy, horizon, dt, best_x, best_y)
            if violated == 0 and fixed == 0 and number[e, a] <= BLOCK:
                break
            for n in range(held):
                for c in range(4):
                    lines[count, c] = block[LINE + c, n]
                if math.isnan(block[LINE + 2, n]):
                    side = 1.0 if a < agent[shared, a, first + n] else -1.0
                    avoid_agent(
                        lines, count, block[X, n], block[Y, n], vx, vy, block[VX, n], block[VY, n], block[RADIUS, n],
                        horizon, dt, block[SHARE, n], side,
                    )  # fmt: skip
                count += 1
        if count > 0:
            best_x, best_y = best_velocity(lines, fixed, count, top, agents[row, WISH_X], agents[row, WISH_Y], spare)
        out[row, 0], out[row, 1] = best_x, best_y


@kernel
def _choose_few(
    position: Floats, velocity: Floats, radius: Floats, own_limit: Floats, limit: Floats, aim: Floats, speed: Floats,
    active: Bools, visible: Bools, external: Bools, given: bool, dt: float, reciprocal: bool, parameters: Floats,
    edges: Edges, order: Rows, out: Floats,
) -> bool:  # fmt: skip
    """Choose the next velocity of every agent of small crowds in one call; return whether a value is not allowed.

    A call from Python takes longer than the work for some agents, so rows, neighbours and velocities are one kernel.
    """
    E, A = active.shape
    begin, count, widest = int(np.int64(0)), E * A, int(np.int64(0))
    agents, walking, seen = np.empty((count, COLUMNS)), np.empty(count, np.bool_), np.empty(count, np.bool_)
    chosen = out.reshape(count, 2)
    if fill_rows(
        begin, count, position, velocity, radius, own_limit, limit, aim, speed, active, visible, external, given, dt,
        agents, walking, seen, chosen,
    ):  # fmt: skip
        return True
    far, most, others = np.empty(count), np.empty(count, np.int32), external.reshape(count)
    for row in range(count):
        own = row if len(parameters) > 1 else 0
        far[row], most[row] = parameters[own, 2], np.int32(np.rint(parameters[own, 3]))
        widest = max(widest, int(most[row]))
    if reciprocal:
        others = np.zeros(count, np.bool_)
    widest = min(widest, A - 1)
    agent, number = np.empty((count, widest), np.int32), np.empty(count, np.int32)
    compare_rows(begin, count, position.reshape(count, 2), far, most, walking, seen, A, agent, number)
    near: Any = (agent.reshape(E, A, widest), number.reshape(E, A), order)
    _choose_part(begin, count, agents, walking, others, parameters, near, edges, dt, chosen)
    return False


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
    batched = True
    valid_range = ModelRange(0.7, FREE, 0.25, PAGE, "RVO2, time step of its examples")

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

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        E, A = shape = scene.shape
        if 0 < E * A <= SMALL and A < CROWD and 0.0 < dt < math.inf:
            position, velocity, radius, own_limit, *others = scene.step_arrays()
            limit = own_limit if self.max_speed is None else speed_limit(self.max_speed, scene)
            out, parameters = np.empty((E, A, 2)), parameter_rows(self, PARAMETERS, shape)
            given, edges = scene.preferred_velocity is not None, tuple(edges_of(scene.walls))
            values: Any = (
                position, velocity, radius, own_limit, limit, *others, given, float(dt), self.reciprocal,
                parameters, edges, IN_ORDER[: E * A], out,
            )  # fmt: skip
            if not _choose_few(*values):
                return out
        start = begin_rows(scene, dt, self.max_speed)  # raises the error for a wrong value
        near = start.neighbors(self.neighbor_distance, self.max_neighbors)
        external = np.zeros_like(start.external) if self.reciprocal else start.external
        parameters = parameter_rows(self, PARAMETERS, scene.shape)
        rows = start.agents, start.walking, external, parameters, near, edges_of(scene.walls), float(dt)
        launch(_choose, _choose_part, start.out, *rows)
        return start.velocity
