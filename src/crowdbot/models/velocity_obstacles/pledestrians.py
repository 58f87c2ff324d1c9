"""PLEdestrians: least-effort velocities among those permitted by ORCA (Guy et al. 2010)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, prange
from crowdbot.models.model import CrowdModel, begin_step, launch, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import parameter_columns
from crowdbot.models.valid_range import FREE, PAGE, UMANS, ModelRange
from crowdbot.typing import Floats

from .linear_program import best_velocity
from .orca_lines import Edges, avoid_agent, avoid_edge, edges_in_reach, edges_of

SHORTEST = 1e-3
"""Minimum time horizon [s]; a horizon of 0 has no line."""
ROUNDS = 30
"""Maximum number of iterations of the search for the least effort; rarely reached."""
SETTLED = 1e-9
"""Relative change of the remaining distance to the goal at which the search stops."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    desired: Floats
    distance: Floats
    """Distance to the goal [m]; inf if only a desired velocity is given."""
    radius: Floats
    max_speed: Floats
    planning: Floats
    horizon: Floats
    wall_horizon: Floats
    external: NDArray[np.bool_]
    walking: NDArray[np.bool_]


@kernel
def _least_effort(
    lines: Floats, fixed: int, count: int, top: float, wish_x: float, wish_y: float, distance: float, planning: float,
    dt: float, spare: Floats,
) -> tuple[float, float]:  # fmt: skip
    """Return the velocity on the left of all lines that minimises t |v|^2 + 2 s |g - t v|.

    ``s`` is the desired speed, ``g`` the vector to the goal, ``t`` the planning time. Each iteration replaces
    |g - t v| by |g - t v|^2 / L, L the remaining distance of the previous iteration. The minimum is then the permitted
    velocity nearest to s g / (L + s t). The effort decreases in each iteration.
    """
    x, y = best_velocity(lines, fixed, count, top, wish_x, wish_y, spare)
    speed = math.sqrt(wish_x * wish_x + wish_y * wish_y)
    if speed == 0.0 or distance == math.inf or (x == wish_x and y == wish_y):
        return x, y
    t = max(dt, min(planning, distance / speed))
    gx, gy = distance * wish_x / speed, distance * wish_y / speed
    length = math.inf
    for _ in range(ROUNDS):
        before, length = length, math.sqrt((gx - t * x) ** 2 + (gy - t * y) ** 2)
        if abs(length - before) <= SETTLED * length:
            break
        share = distance / (length + speed * t)
        x, y = best_velocity(lines, fixed, count, top, share * wish_x, share * wish_y, spare)
    return x, y


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, edges: Edges, dt: float, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, edges, dt, out)


@kernel
def _choose_part(begin: int, end: int, crowd: _Crowd, near: Neighbors, edges: Edges, dt: float, out: Floats) -> None:
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, desired, distance, radius, top, planning, horizon, wall_horizon, external, walking = crowd
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
        out[row, 0], out[row, 1] = _least_effort(
            lines, fixed, count, top[row], desired[row, 0], desired[row, 1], distance[row], planning[row], dt, spare
        )


@dataclass(frozen=True)
class PLEdestrians(CrowdModel):
    """Least-effort model: agents minimise the energy to the goal among the velocities that ORCA permits.

    Args:
        planning_time: time at the new velocity [s]; the remaining straight path is walked at the preferred speed. The
            plan ends at the goal at the latest.
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        time_horizon: time horizon for agents [s].
        time_horizon_walls: time horizon for walls [s].
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    Walking at speed v costs e_s + e_w v^2 per second and kilogram; over a planning time t that is
    E(v) = t (e_s + e_w |v|^2) + 2 |g - t v| sqrt(e_s e_w) to a goal at g. The best velocity depends only on sqrt(e_s /
    e_w), the free walking speed, which is replaced by the preferred speed of the scene (the paper's 2.23 J/(kg s) and
    1.26 J s/(kg m^2) give 1.33 m/s). E and the set of permitted velocities are convex; the result is the global
    minimum. Compared with ORCA, agents hindered near the goal slow down rather than turn. Scenes with preferred
    velocities instead of goals have goals at infinity; both models then agree.

    The default follows the paper. Differences: the minimum is exact, and the preferred speed of the scene
    replaces the ratio of the energy coefficients.

    Source: Guy, Chhugani, Curtis, Dubey, Lin, Manocha 2010, doi:10.2312/SCA/SCA10/119-128.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> ahead = Scene.of([[0, 0], [3, 0.1]], [[1.3, 0], [-1.3, 0]], goal=[[6, 0], [-6, 0.1]])
    >>> PLEdestrians().velocity(ahead, dt=0.1).round(3).tolist()
    [[[1.215, -0.164], [-1.254, 0.169]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Stephen J. Guy, Jatin Chhugani, Sean Curtis, Pradeep Dubey, Ming Lin, Dinesh Manocha",
        2010,
        "PLEdestrians: a least-effort approach to crowd simulation",
        "Eurographics/ACM SIGGRAPH Symposium on Computer Animation",
        "10.2312/SCA/SCA10/119-128",
    )
    batched = True
    valid_range = ModelRange(0.7, FREE, 0.1, PAGE, UMANS)

    planning_time: PerAgent = parameter(3.0, unit="s", low=0.2, high=8.0, source="UMANS", min=SHORTEST)
    neighbor_distance: PerAgent = parameter(5.0, unit="m", low=1.0, high=15.0, source="RVO2, pedestrian settings")
    max_neighbors: PerAgent = parameter(10.0, unit="1", low=1.0, high=20.0, source="RVO2, examples")
    time_horizon: PerAgent = parameter(
        2.0, unit="s", low=0.2, high=8.0, source="RVO2, pedestrian settings", min=SHORTEST
    )
    time_horizon_walls: PerAgent = parameter(
        2.0, unit="s", low=0.2, high=4.0, source="CrowdBot simulator, horizon of agents", min=SHORTEST
    )
    max_speed: PerAgent | None = None

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        if scene.preferred_velocity is None:
            away = np.where(scene.active[..., None], scene.goal - scene.position, 0.0)
            distance = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
        else:
            distance = np.full(scene.shape, np.inf)
        values = (
            rows(scene.position),
            rows(scene.velocity),
            rows(wish),
            rows(distance),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            *parameter_columns(self, scene.shape, "planning_time", "time_horizon", "time_horizon_walls"),
            rows(scene.external),
            rows(walking),
        )
        crowd = _Crowd._make(values)
        launch(_choose, _choose_part, rows(out), crowd, near, edges_of(scene.walls), float(dt))
        return out
