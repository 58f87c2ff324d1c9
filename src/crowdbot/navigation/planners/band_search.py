"""Kernels of the time-elastic band: least squares over the points of a band and its time interval."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel
from crowdbot.navigation import window_search
from crowdbot.typing import Floats

nearest_on_segment = window_search.nearest_on_segment  # type: ignore[attr-defined]

POINTS = 20
"""Number of intervals of a band."""
VARIABLES = 2 * (POINTS - 1) + 1
"""Coordinates of the inner points, and the time interval, which is the last variable."""
SHORTEST = 0.02
"""Smallest time interval [s]."""
TINY = 1e-9
TIME, SPEED, PUSH, PEOPLE, WALLS, CHANGE = range(6)
"""Order of the weights."""


class BandScene(NamedTuple):
    """What a band must respect, in the frame of the robot's position.

    Fields:
        velocity: ``[2]`` of the robot [m/s].
        numbers: largest speed [m/s] and acceleration [m/s2].
        position, moving: ``[A, 2]`` people [m], [m/s].
        reach: ``[A]`` distance of centres below which a person costs [m].
        share: ``[A]`` factor of the residuals of a person, the root of the probability that there is one.
        segments: ``[M, 4]`` walls [m].
        wall_reach: distance to walls below which they cost [m].
        weights: weights in the order of the module.
    """

    velocity: Floats
    numbers: Floats
    position: Floats
    moving: Floats
    reach: Floats
    share: Floats
    segments: Floats
    wall_reach: float
    weights: Floats


class _Equations(NamedTuple):
    """Normal equations: matrix and gradient, with room for one residual."""

    matrix: Floats
    gradient: Floats
    columns: NDArray[np.int64]
    slope: Floats


@kernel
def _add(equations: _Equations, count: int, residual: float) -> float:
    """Add a residual with ``count`` slopes to the normal equations, and return its square."""
    matrix, gradient, index, slope = equations
    for i in range(count):
        a = index[i]
        if a < 0:
            continue
        gradient[a] += slope[i] * residual
        for j in range(count):
            b = index[j]
            if b >= 0:
                matrix[a, b] += slope[i] * slope[j]
    return residual * residual


@kernel
def _point(equations: _Equations, at: int, i: int, sx: float, sy: float) -> None:
    """Set the slopes of point ``i`` of the band; both ends are fixed."""
    inner = 0 < i < POINTS
    equations.columns[at] = 2 * (i - 1) if inner else -1
    equations.columns[at + 1] = 2 * (i - 1) + 1 if inner else -1
    equations.slope[at], equations.slope[at + 1] = sx, sy


@kernel
def _interval(equations: _Equations, at: int, slope: float) -> None:
    equations.columns[at], equations.slope[at] = VARIABLES - 1, slope


@kernel
def _add_motion(scene: BandScene, band: Floats, dt: float, equations: _Equations) -> float:
    """Add time, speed, acceleration and the change of the velocity; return the sum of squares."""
    velocity, numbers, weights = scene.velocity, scene.numbers, scene.weights
    top, push = numbers[0], numbers[1]
    _interval(equations, 0, weights[TIME] * POINTS)
    total = _add(equations, 1, weights[TIME] * POINTS * dt)
    for i in range(POINTS):
        dx, dy = band[i + 1, 0] - band[i, 0], band[i + 1, 1] - band[i, 1]
        length = math.sqrt(dx * dx + dy * dy)
        w = weights[SPEED]
        if length / dt > top:
            sx, sy = w * dx / (length * dt), w * dy / (length * dt)
            _point(equations, 0, i + 1, sx, sy)
            _point(equations, 2, i, -sx, -sy)
            _interval(equations, 4, -w * length / (dt * dt))
            total += _add(equations, 5, w * (length / dt - top))
        if i == 0:
            ax, ay = (dx / dt - velocity[0]) / dt, (dy / dt - velocity[1]) / dt
        else:
            ax = (dx - band[i, 0] + band[i - 1, 0]) / (dt * dt)
            ay = (dy - band[i, 1] + band[i - 1, 1]) / (dt * dt)
        size = math.sqrt(ax * ax + ay * ay)
        if size > push:
            total += _add_push(scene, equations, i, ax / size, ay / size, size, dt, dx, dy)
    w = weights[CHANGE]
    for c in range(2):
        _point(equations, 0, 1, w / dt if c == 0 else 0.0, w / dt if c == 1 else 0.0)
        _interval(equations, 2, -w * (band[1, c] - band[0, c]) / (dt * dt))
        total += _add(equations, 3, w * ((band[1, c] - band[0, c]) / dt - velocity[c]))
    return total


@kernel
def _add_push(
    scene: BandScene, equations: _Equations, i: int, ux: float, uy: float, size: float, dt: float, dx: float, dy: float
) -> float:
    """Add the excess of the acceleration at point ``i``, with its unit vector; return its square."""
    w, push = scene.weights[PUSH], scene.numbers[1]
    scale = w / (dt * dt)
    _point(equations, 0, i + 1, scale * ux, scale * uy)
    if i == 0:
        rate = ux * (scene.velocity[0] - 2.0 * dx / dt) + uy * (scene.velocity[1] - 2.0 * dy / dt)
        _interval(equations, 2, scale * rate)
        return _add(equations, 3, w * (size - push))
    _point(equations, 2, i, -2.0 * scale * ux, -2.0 * scale * uy)
    _point(equations, 4, i - 1, scale * ux, scale * uy)
    _interval(equations, 6, -2.0 * w * size / dt)
    return _add(equations, 7, w * (size - push))


@kernel
def _add_obstacles(scene: BandScene, band: Floats, dt: float, equations: _Equations) -> float:
    """Add the lack of clearance to people, who keep their velocity, and to walls; return the sum of squares."""
    position, moving, reach, segments = scene.position, scene.moving, scene.reach, scene.segments
    total, most, v = 0.0, scene.weights[PEOPLE], scene.weights[WALLS]
    for i in range(1, POINTS):
        x, y, time = band[i, 0], band[i, 1], i * dt
        for a in range(len(reach)):
            dx, dy = x - position[a, 0] - moving[a, 0] * time, y - position[a, 1] - moving[a, 1] * time
            away2 = dx * dx + dy * dy
            if away2 >= reach[a] * reach[a]:
                continue
            away, w = max(math.sqrt(away2), TINY), most * scene.share[a]
            ux, uy = dx / away, dy / away
            _point(equations, 0, i, -w * ux, -w * uy)
            _interval(equations, 2, w * i * (ux * moving[a, 0] + uy * moving[a, 1]))
            total += _add(equations, 3, w * (reach[a] - away))
        for m in range(len(segments)):
            nx, ny = nearest_on_segment(x, y, segments[m, 0], segments[m, 1], segments[m, 2], segments[m, 3])
            away = max(math.sqrt((x - nx) ** 2 + (y - ny) ** 2), TINY)
            if away < scene.wall_reach:
                _point(equations, 0, i, -v * (x - nx) / away, -v * (y - ny) / away)
                total += _add(equations, 2, v * (scene.wall_reach - away))
    return total


@kernel
def _evaluate(scene: BandScene, band: Floats, dt: float, equations: _Equations) -> float:
    equations.matrix[:] = 0.0
    equations.gradient[:] = 0.0
    total = _add_motion(scene, band, dt, equations)
    return total + _add_obstacles(scene, band, dt, equations)


@kernel
def _solve(matrix: Floats, gradient: Floats, damping: float, factor: Floats, step: Floats) -> None:
    """Write the step of damped least squares, by a Cholesky decomposition.

    Both coordinates of a point have the same damping, so that the step does not depend on the axes.
    """
    n = len(gradient)
    for i in range(n):
        for j in range(i + 1):
            value = matrix[i, j]
            if i == j:
                mate = i ^ 1 if i < n - 1 else i
                value += damping * 0.5 * (matrix[i, i] + matrix[mate, mate]) + 1e-6
            for k in range(j):
                value -= factor[i, k] * factor[j, k]
            factor[i, j] = math.sqrt(max(value, 1e-12)) if i == j else value / factor[j, j]
    for i in range(n):
        value = -gradient[i]
        for k in range(i):
            value -= factor[i, k] * step[k]
        step[i] = value / factor[i, i]
    for back in range(n):
        i = n - 1 - back
        value = step[i]
        for k in range(i + 1, n):
            value -= factor[k, i] * step[k]
        step[i] = value / factor[i, i]


@kernel
def optimize_bands(scene: BandScene, bands: Floats, intervals: Floats, iterations: int, cost: Floats) -> None:
    """Improve bands in place by damped least squares (Levenberg-Marquardt).

    Args:
        scene: what the bands must respect.
        bands: ``[K, POINTS + 1, 2]`` points [m].
        intervals: ``[K]`` time between two points [s].
        iterations: number of steps that are tried.
        cost: ``[K]`` filled with the sums of squares.
    """
    n = VARIABLES
    now = _Equations(np.empty((n, n)), np.empty(n), np.empty(8, np.int64), np.empty(8))
    new = _Equations(np.empty((n, n)), np.empty(n), np.empty(8, np.int64), np.empty(8))
    factor, step, trial = np.zeros((n, n)), np.empty(n), np.empty((POINTS + 1, 2))
    for k in range(len(bands)):
        band, dt, damping = bands[k], intervals[k], 0.1
        cost[k] = _evaluate(scene, band, dt, now)
        for _ in range(iterations):
            _solve(now.matrix, now.gradient, damping, factor, step)
            trial[:] = band
            for i in range(1, POINTS):
                trial[i, 0] += step[2 * (i - 1)]
                trial[i, 1] += step[2 * (i - 1) + 1]
            dt_new = max(dt + step[n - 1], SHORTEST)
            value = _evaluate(scene, trial, dt_new, new)
            if value < cost[k]:
                band[:] = trial
                dt, cost[k], damping = dt_new, value, max(0.3 * damping, 1e-4)
                now.matrix[:] = new.matrix
                now.gradient[:] = new.gradient
            else:
                damping = min(5.0 * damping, 1e4)
        intervals[k] = dt
