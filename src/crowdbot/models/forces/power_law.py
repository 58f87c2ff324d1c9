"""PowerLaw: avoidance force from the time to collision (Karamouzas, Skinner, Guy 2014)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, prange
from crowdbot.models.model import CrowdModel, begin_step, launch, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import limit_length, parameter_rows
from crowdbot.models.valid_range import JAMS, TWO_WAY, UMANS, ModelRange
from crowdbot.typing import Floats

from .wall_surfaces import WallSurfaces, is_nearest_corner, wall_surfaces

SHRUNK = 0.99
"""Reach of overlapping bodies as a fraction of their distance, which gives them a time to collision."""
STRONGEST = 1e12
"""Upper limit of a single force [m/s^2]; the force of grazing discs is unbounded."""

LAW = ("strength", "exponent", "time_horizon", "relaxation_time", "max_acceleration")


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    walking: NDArray[np.bool_]
    law: Floats
    """``[E * A, 5]`` in the order of :data:`LAW`, or ``[1, 5]`` for all."""


@kernel
def _steepness(time: float, strength: float, exponent: float, horizon: float) -> float:
    """Return ``-dE/dt`` of the energy ``E(t) = strength t^-exponent exp(-t / horizon)`` at ``time``."""
    power = 1.0 / (time * time) if exponent == 2.0 else time**-exponent
    return strength * math.exp(-time / horizon) * power * (exponent / time + 1.0 / horizon)


@kernel
def _disc_force(
    x: float, y: float, vx: float, vy: float, reach: float, strength: float, exponent: float, horizon: float
) -> tuple[float, float, float]:
    """Return the force of a disc on a point at x, y (relative) and the time to contact; 0 and inf without contact."""
    distance2 = x * x + y * y
    gap = distance2 - reach * reach
    if gap <= 0.0:
        gap = (1.0 - SHRUNK * SHRUNK) * distance2
    closing = -(x * vx + y * vy)
    if closing <= 0.0:
        return 0.0, 0.0, math.inf
    speed2 = vx * vx + vy * vy
    root2 = closing * closing - speed2 * gap
    if root2 <= 0.0:
        return 0.0, 0.0, math.inf
    root = math.sqrt(root2)
    time = gap / (closing + root)
    if not 0.0 < time <= horizon:
        return 0.0, 0.0, math.inf
    size = _steepness(time, strength, exponent, horizon) / speed2
    fx = size * ((speed2 * x + closing * vx) / root - vx)
    fy = size * ((speed2 * y + closing * vy) / root - vy)
    if not fx * fx + fy * fy < STRONGEST * STRONGEST:
        distance = math.sqrt(distance2)
        return STRONGEST * x / distance, STRONGEST * y / distance, time
    return fx, fy, time


@kernel
def _face_force(
    face: Floats, k: int, x: float, y: float, vx: float, vy: float,
    radius: float, strength: float, exponent: float, horizon: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the force of face k on an agent that will touch its interior."""
    ux, uy = face[k, 4], face[k, 5]
    height = (x - face[k, 0]) * uy - (y - face[k, 1]) * ux
    closing = vy * ux - vx * uy
    if height <= 0.0 or closing <= 0.0:
        return 0.0, 0.0
    gap = height - radius if height > radius else (1.0 - SHRUNK) * height
    time = gap / closing
    if not 0.0 < time <= horizon:
        return 0.0, 0.0
    tx, ty = x + vx * time, y + vy * time
    if (tx - face[k, 0]) * ux + (ty - face[k, 1]) * uy <= 0.0 or (tx - face[k, 2]) * ux + (ty - face[k, 3]) * uy >= 0.0:
        return 0.0, 0.0
    size = _steepness(time, strength, exponent, horizon) / closing
    if not size < STRONGEST:  # or if it is NaN
        size = STRONGEST
    return size * uy, -size * ux


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, walls: WallSurfaces, dt: float, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, dt, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: WallSurfaces, dt: float, out: Floats
) -> None:
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, desired, radius, top, walking, law = crowd
    agent, number, order = near
    face, corner, arm, first = walls
    A = agent.shape[1]
    for n in range(begin, end):
        row = order[n]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        x, y, vx, vy = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1]
        own = row if len(law) > 1 else 0
        k, m, t, relaxation, most = law[own, 0], law[own, 1], law[own, 2], law[own, 3], law[own, 4]
        ax, ay = (desired[row, 0] - vx) / relaxation, (desired[row, 1] - vy) / relaxation
        for i in range(number[e, a]):
            other = row - a + agent[e, a, i]
            fx, fy, _ = _disc_force(
                x - place[other, 0], y - place[other, 1], vx - velocity[other, 0], vy - velocity[other, 1],
                radius[row] + radius[other], k, m, t,
            )  # fmt: skip
            ax, ay = ax + fx, ay + fy
        for i in range(len(face)):
            fx, fy = _face_force(face, i, x, y, vx, vy, radius[row], k, m, t)
            ax, ay = ax + fx, ay + fy
        for c in range(len(corner)):
            fx, fy, time = _disc_force(x - corner[c, 0], y - corner[c, 1], vx, vy, radius[row], k, m, t)
            if time < math.inf and is_nearest_corner(corner, arm, first, c, x + vx * time, y + vy * time):
                ax, ay = ax + fx, ay + fy
        ax, ay = limit_length(ax, ay, most)
        out[row, 0], out[row, 1] = limit_length(vx + ax * dt, vy + ay * dt, top[row])


@dataclass(frozen=True)
class PowerLaw(CrowdModel):
    """Power law model: the force is the gradient of an interaction energy that depends only on the time to collision.

    Each pair has the energy ``strength t^-exponent exp(-t / time_horizon)``, t its time to collision at constant
    velocities; collisions after ``time_horizon`` are ignored. Walls have the same energy, as capsules with the radius
    of the agent. Overlapping bodies are treated as nearly touching (the reach is 1 % below their distance).

    Args:
        strength: factor of the energy, per mass [m^2 s^(exponent - 2)].
        exponent: exponent of the time to collision [1].
        time_horizon: decay time of the energy [s]; later collisions are ignored.
        relaxation_time: time constant to the desired velocity [s].
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_acceleration: limit of the sum of all forces [m/s^2]; forces just before a grazing collision are unbounded.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    Use time steps of at most 0.05 s if exact paths matter; with larger steps, velocities stay finite and bounded.
    Agents that walk exactly head on slow down and do not pass each other: add a small offset to goals or starts.

    The default uses the exponent of the paper. Differences: an acceleration limit, a wall force from the same energy,
    and a contact rule for overlapping bodies.

    Source: Karamouzas, Skinner, Guy 2014, doi:10.1103/PhysRevLett.113.238701; the wall force is derived from the same
    energy. The UMANS library uses ``relaxation_time=0.5, neighbor_distance=5, max_acceleration=5``.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> ahead = Scene.of([[0, 0], [3, 0.1]], [[1, 0], [-1, 0]], preferred_velocity=[[1, 0], [-1, 0]])
    >>> PowerLaw().velocity(ahead, dt=0.1).round(3).tolist()
    [[[0.94, -0.012], [-0.94, 0.012]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Ioannis Karamouzas, Brian Skinner, Stephen J. Guy",
        2014,
        "Universal power law governing pedestrian interactions",
        "Physical Review Letters 113, 238701",
        "10.1103/PhysRevLett.113.238701",
    )
    batched = True
    valid_range = ModelRange(0.5, JAMS, 0.1, TWO_WAY, UMANS)

    strength: PerAgent = parameter(1.5, unit="m^2 s^(m-2)", low=0.3, high=5.0, source="Karamouzas et al. 2014")
    exponent: PerAgent = parameter(2.0, unit="1", low=1.0, high=4.0, source="Karamouzas et al. 2014")
    time_horizon: PerAgent = parameter(3.0, unit="s", low=0.5, high=8.0, source="Karamouzas et al. 2014", min=1e-3)
    relaxation_time: PerAgent = parameter(
        0.54, unit="s", low=0.2, high=1.5, source="Karamouzas et al. 2014, not verified", min=1e-3
    )
    neighbor_distance: PerAgent = parameter(
        10.0, unit="m", low=1.0, high=15.0, source="Karamouzas et al. 2014, not verified"
    )
    max_neighbors: PerAgent = parameter(
        64.0, unit="1", low=1.0, high=64.0, source="crowdbot: all within 5 m up to 0.8 people/m^2"
    )
    max_acceleration: PerAgent = parameter(
        20.0, unit="m/s^2", low=1.0, high=20.0, source="Karamouzas et al. 2014, not verified"
    )
    max_speed: PerAgent | None = None

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        crowd = _Crowd(
            rows(scene.position),
            rows(scene.velocity),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            rows(walking),
            parameter_rows(self, LAW, scene.shape),
        )
        launch(_choose, _choose_part, rows(out), crowd, near, wall_surfaces(scene.walls), float(dt))
        return out
