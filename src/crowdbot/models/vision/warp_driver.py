"""WarpDriver: anticipation by collision probabilities along the planned path (Wolinski, Lin, Pettré 2016)."""

from __future__ import annotations

import functools
import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, InputError, Neighbors, Paper, PerAgent, Scene, kernel, parameter, prange
from crowdbot.models.model import CrowdModel, begin_step, launch, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import parameter_columns
from crowdbot.models.speed_models.collision_free_speed import nearest_on_segment
from crowdbot.models.valid_range import FREE, JUPEDSIM, PAGE, ModelRange
from crowdbot.typing import Floats

SAMPLES = 20
"""Number of points of the planned path."""
HALF, CELL = 3.0, 0.1
"""Half width and cell of the field of a disc of radius 1."""
FINE = 0.05
"""Step of the integral over this disc."""
SPREAD = 0.05
"""Maximum random shift [m] of the points of the planned path across its direction."""
CLOSE = 3.0
"""Distance in sums of radii, or in radii from a wall, below which agents are pushed apart."""
INERTIA = 0.5
"""Share of the earlier direction in the velocity."""
APART = 1e-6
"""Distance [m] below which two agents have no direction."""
UNLIKELY, RARE = 1e-12, 1e-9
"""Probability of one neighbour at a point, and of all along the path [s], that are ignored."""
LAW = ("time_horizon", "step_size", "time_uncertainty", "uncertainty_ahead", "uncertainty_aside")
"""Parameters in the order of the kernel."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    motion: Floats
    """Expected velocity [m/s]."""
    heading: Floats
    """``[E * A, 2]`` unit direction."""
    desired: Floats
    radius: Floats
    max_speed: Floats
    horizon: Floats
    step: Floats
    time_uncertainty: Floats
    ahead: Floats
    aside: Floats
    walking: NDArray[np.bool_]


@functools.cache
def _intrinsic_field(sigma: float) -> Floats:
    """Return the probability of a collision with a disc of radius 1, and its gradient: ``[N, N, 3]`` on a grid.

    The disc is blurred by a normal distribution with the standard deviation ``sigma``; the maximum is 1.
    """
    node = -HALF + CELL * np.arange(round(2.0 * HALF / CELL) + 1)
    # summed as in the original: rounding decides which points of the rim belong to the disc
    part = np.cumsum(np.concatenate([[-1.0], np.full(round(2.0 / FINE), FINE)]))
    part = part[part <= 1.0]
    disc = (part[:, None] ** 2 + part**2 <= 1.0).astype(np.float64)
    near = np.exp(-((node[:, None] - part) ** 2) / (2.0 * sigma * sigma))
    value = near @ disc @ near.T
    value /= value.max()
    field = np.zeros((*value.shape, 3))
    field[..., 0] = value
    field[1:-1, :, 1] = (value[2:] - value[:-2]) / (2.0 * CELL)
    field[:, 1:-1, 2] = (value[:, 2:] - value[:, :-2]) / (2.0 * CELL)
    return field


@kernel
def _look_up(field: Floats, x: float, y: float) -> tuple[float, float, float]:
    """Return probability and gradient at x, y, linear between the nodes; 0 outside of the field."""
    if not (-HALF <= x <= HALF and -HALF <= y <= HALF):
        return 0.0, 0.0, 0.0
    most = len(field) - 2
    u, v = (x + HALF) / CELL, (y + HALF) / CELL
    i, j = min(int(u), most), min(int(v), most)
    u, v = u - i, v - j
    a, b, c, d = (1.0 - u) * (1.0 - v), u * (1.0 - v), (1.0 - u) * v, u * v
    p = a * field[i, j, 0] + b * field[i + 1, j, 0] + c * field[i, j + 1, 0] + d * field[i + 1, j + 1, 0]
    gx = a * field[i, j, 1] + b * field[i + 1, j, 1] + c * field[i, j + 1, 1] + d * field[i + 1, j + 1, 1]
    gy = a * field[i, j, 2] + b * field[i + 1, j, 2] + c * field[i, j + 1, 2] + d * field[i + 1, j + 1, 2]
    return p, gx, gy


@kernel
def _add_neighbor(
    risk: Floats, shift: Floats, field: Floats, dx: float, dy: float, gx: float, gy: float, speed: float,
    ox: float, oy: float, reach: float, horizon: float, blur: float, ahead: float, aside: float,
) -> None:  # fmt: skip
    """Add a neighbour to the probability and its gradient in x, y, t at every point of the path, ``risk [SAMPLES, 4]``.

    Args:
        dx, dy: position of the neighbour relative to the agent [m].
        gx, gy, speed: direction and speed of the path [m/s].
        ox, oy: velocity of the neighbour [m/s].
        reach: sum of the radii [m].
        blur: growth of the uncertainty with time [1/s].
        ahead, aside: factors of the coordinates along and across the motion of the neighbour.
    """
    other = math.sqrt(ox * ox + oy * oy)
    fx, fy = (ox / other, oy / other) if other > 0.0 else (gx, gy)
    cos, sin = gx * fx + gy * fy, gy * fx - gx * fy  # the direction of the path as the neighbour sees it
    x0, y0 = -(fx * dx + fy * dy), -(fx * dy - fy * dx)
    for n in range(SAMPLES):
        t = n * (horizon / (SAMPLES - 1))
        along = speed * t
        x = (x0 + cos * along - sin * shift[n] - other * t) / reach
        y = (y0 + sin * along + cos * shift[n]) / reach
        wider = 1.0 / (1.0 + blur * t)
        p, px, py = _look_up(field, x * wider * ahead, y * wider * aside)
        p *= wider * wider * ahead * aside
        if p < UNLIKELY:
            continue
        px, py = px * ahead, py * aside
        pt = -blur * wider * wider * (x * px + y * py)
        px, py = px * wider, py * wider
        pt -= other * px
        px, py = cos * px + sin * py, -sin * px + cos * py
        before = risk[n, 0]
        risk[n, 0] = before + p - before * p
        risk[n, 1] += px - before * px - p * risk[n, 1]
        risk[n, 2] += py - before * py - p * risk[n, 2]
        risk[n, 3] += pt - before * pt - p * risk[n, 3]


@kernel
def _best_motion(risk: Floats, shift: Floats, speed: float, horizon: float, step: float) -> tuple[float, float]:
    """Return the velocity [m/s] along and across the path after one step down the mean gradient."""
    total = p = x = y = t = gx = gy = gt = 0.0
    for n in range(SAMPLES):
        each, time = risk[n, 0], n * (horizon / (SAMPLES - 1))
        total += each
        p += each * each
        gx, gy, gt = gx + each * risk[n, 1], gy + each * risk[n, 2], gt + each * risk[n, 3]
        x, y, t = x + each * speed * time, y + each * shift[n], t + each * time
    if total * horizon / (SAMPLES - 1) < RARE:
        return speed, 0.0
    share = step * p / total
    x, y, t = (x - share * gx) / total, (y - share * gy) / total, (t - share * gt) / total
    return (x / t, y / t) if t > RARE else (speed, 0.0)


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, walls: Floats, field: Floats, shift: Floats, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, field, shift, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: Floats, field: Floats, shift: Floats, out: Floats
) -> None:
    # unpack the tuples outside of the loop: each access counts references
    place, motion, heading, desired, radius, top, horizon, step, blur, ahead, aside, walking = crowd
    agent, number, order = near
    A = agent.shape[1]
    risk = np.empty((SAMPLES, 4))
    for k in range(begin, end):
        row = order[k]
        wish = math.sqrt(desired[row, 0] ** 2 + desired[row, 1] ** 2)
        speed = min(wish, top[row])
        if not walking[row] or speed == 0.0:
            continue
        e, a = row // A, row % A
        gx, gy = desired[row, 0] / wish, desired[row, 1] / wish
        risk[:] = 0.0
        ax, ay = 0.0, 0.0
        own = shift[row % len(shift)]
        for n in range(number[e, a]):
            o = row - a + agent[e, a, n]
            dx, dy, contact = place[o, 0] - place[row, 0], place[o, 1] - place[row, 1], radius[row] + radius[o]
            distance = math.sqrt(dx * dx + dy * dy)
            if distance <= APART:
                side = 1.0 if row < o else -1.0
                ax, ay = ax - side * gy * speed, ay + side * gx * speed
            elif distance < CLOSE * contact:
                push = speed * (CLOSE * contact - distance) / (distance * distance)
                ax, ay = ax - push * dx, ay - push * dy
            _add_neighbor(
                risk, own, field, dx, dy, gx, gy, speed, motion[o, 0], motion[o, 1], contact,
                horizon[row], blur[row], 1.0 / (1.0 + ahead[row]), 1.0 + aside[row],
            )  # fmt: skip
        vx, vy = _best_motion(risk, own, speed, horizon[row], step[row])
        vx, vy = gx * vx - gy * vy, gy * vx + gx * vy
        vx, vy = _limit(vx, vy, speed)
        if vx * vx + vy * vy <= RARE * RARE:
            vx, vy = 0.01 * speed * gx, 0.01 * speed * gy
        wx, wy = _wall_push(walls, place[row, 0], place[row, 1], radius[row], speed)
        vx, vy = _limit(vx + ax + wx, vy + ay + wy, speed)
        size = math.sqrt(vx * vx + vy * vy)
        vx = (1.0 - INERTIA) * vx + INERTIA * size * heading[row, 0]
        vy = (1.0 - INERTIA) * vy + INERTIA * size * heading[row, 1]
        out[row, 0], out[row, 1] = _limit(vx, vy, speed)


@kernel
def _limit(x: float, y: float, most: float) -> tuple[float, float]:
    """Return a vector of at most this length."""
    length = math.sqrt(x * x + y * y)
    return (x * (most / length), y * (most / length)) if length > most else (x, y)


@kernel
def _wall_push(walls: Floats, x: float, y: float, radius: float, speed: float) -> tuple[float, float]:
    """Return the velocity [m/s] away from walls within :data:`CLOSE` radii."""
    px, py = 0.0, 0.0
    for m in range(len(walls)):
        nx, ny = nearest_on_segment(x, y, walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3])
        distance = math.sqrt((x - nx) ** 2 + (y - ny) ** 2)
        if APART < distance < CLOSE * radius:
            push = speed * (CLOSE * radius - distance) / (distance * distance)
            px, py = px + push * (x - nx), py + push * (y - ny)
    return px, py


@dataclass(frozen=True)
class WarpDriver(CrowdModel):
    """Anticipation: agents lower the probability of a collision along their path by one step down its gradient.

    Args:
        time_horizon: length of the planned path [s].
        step_size: length of the step along the gradient [m^2].
        blur: standard deviation of the uncertainty about position, in sums of radii; one number for all agents.
        time_uncertainty: growth of the uncertainty with time [1/s].
        uncertainty_ahead: uncertainty along the motion of a neighbour.
        uncertainty_aside: certainty about the motion of a neighbour across its direction.
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    The path ``r(t)`` leads straight along the desired velocity for ``time_horizon``. A neighbour has a field of
    collision probabilities, a blurred disc, which warps carry into space and time: by the motion of the neighbour, by
    the sum of the radii and by the uncertainties. The probabilities ``p`` of all neighbours are united along the path.
    With the means weighted by ``p``, the new velocity is the one that leads to ``<r> - step_size <p> <grad p>``.

    Neighbours are expected to walk with their preferred speed along their heading, external agents with their velocity.
    Bodies nearer than 3 sums of radii, and walls within 3 radii, push agents away; half of the direction is kept. With
    ``rng``, the points of the path are shifted by up to 0.05 m, which breaks symmetries.

    The default follows JuPedSim 1.4.2, which adds these pushes to the paper. Differences: agents that are stuck make no
    detours, and the maximum speed limits the path.

    Source: Wolinski, Lin, Pettré 2016, doi:10.1145/2980179.2982442, as in JuPedSim 1.4.2.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> meeting = Scene.of([[0, 0], [1.5, 0.3]], [[1.3, 0], [-1.3, 0]], goal=[[9, 0], [-9, 0.3]])
    >>> WarpDriver().velocity(meeting, dt=0.1).round(2).tolist()
    [[[1.29, -0.11], [-1.29, 0.11]]]
    """

    paper: ClassVar[Paper] = Paper(
        "David Wolinski, Ming C. Lin, Julien Pettré",
        2016,
        "WarpDriver: context-aware probabilistic motion prediction for crowd simulation",
        "ACM Transactions on Graphics 35(6)",
        "10.1145/2980179.2982442",
    )
    batched = True
    valid_range = ModelRange(0.7, FREE, 0.01, PAGE, JUPEDSIM)

    time_horizon: PerAgent = parameter(2.0, unit="s", low=0.5, high=8.0, source="JuPedSim 1.4.2", min=1e-2)
    step_size: PerAgent = parameter(0.5, unit="m^2", low=0.05, high=2.0, source="JuPedSim 1.4.2")
    blur: float = 0.3
    time_uncertainty: PerAgent = parameter(0.5, unit="1/s", low=0.0, high=2.0, source="JuPedSim 1.4.2")
    uncertainty_ahead: PerAgent = parameter(0.2, unit="1", low=0.0, high=1.0, source="JuPedSim 1.4.2")
    uncertainty_aside: PerAgent = parameter(0.2, unit="1", low=0.0, high=1.0, source="JuPedSim 1.4.2")
    neighbor_distance: PerAgent = parameter(7.1, unit="m", low=1.0, high=15.0, source="JuPedSim 1.4.2")
    max_neighbors: PerAgent = parameter(64.0, unit="1", low=1.0, high=100.0, source="crowdbot: all at 0.4 people/m^2")
    max_speed: PerAgent | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (isinstance(self.blur, float | int) and 0.05 <= self.blur <= 1.0):
            raise InputError(f"WarpDriver: blur = {self.blur} is not allowed, it must be a number from 0.05 to 1")

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        # rng breaks symmetries
        if rng is None:
            return self.plan(scene, dt, np.zeros((1, SAMPLES)))
        return self.plan(scene, dt, rng.uniform(-SPREAD, SPREAD, (scene.position[..., 0].size, SAMPLES)))

    def plan(self, scene: Scene, dt: float, shift: Floats) -> Floats:
        """Return the velocities ``[E, A, 2]`` [m/s] for paths whose points are shifted to the left.

        Args:
            scene, dt: as for :meth:`velocity`.
            shift: ``[E * A, 20]`` shift of each point of the path [m], or one row for all agents.
        """
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        heading = np.stack([np.cos(scene.heading), np.sin(scene.heading)], axis=-1)
        speed = np.sqrt(wish[..., :1] ** 2 + wish[..., 1:] ** 2)
        expected = np.where(scene.external[..., None], scene.velocity, speed * heading)
        values = (
            rows(scene.position),
            rows(np.where(scene.active[..., None], expected, 0.0)),
            rows(heading),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            *parameter_columns(self, scene.shape, *LAW),
            rows(walking),
        )
        crowd = _Crowd._make(values)
        field = _intrinsic_field(float(self.blur))
        launch(_choose, _choose_part, rows(out), crowd, near, scene.walls.segments(), field, shift)
        return out
