"""Slide of a skid-steer base: speeds of its sides, and its lateral speed, for a forward speed and a turn rate."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats

GRAVITY = 9.81
"""Gravity [m/s2]."""
SOFT = 0.02
"""Slip speed [m/s] below which the friction of a tyre is proportional to its slip."""
ROUNDS = 30
"""Largest number of Newton steps."""
CLOSE = 1e-9
"""Residual, as a share of the weight, at which the steps end."""
PART = 0.3
"""Largest change of a speed in a Newton step, as a share of the speed of the rims in the turn."""
HALVINGS = 8
"""Largest number of halvings of a Newton step."""
FAILED = 0.02
"""Residual above which the forces have no balance: the base slides out of the curve."""


@kernel
def slide_of(before: Floats, after: Floats, dt: float, tires: Floats, body: Floats, out: Floats) -> bool:
    """Write the speeds [m/s] of the left rims, of the right rims, and of the base to the left; return if they exist.

    Args:
        before: ``[3]`` speed [m/s], turn rate [rad/s] and lateral speed [m/s] of the base before the step.
        after: ``[2]`` speed and turn rate after it.
        dt: time step [s].
        tires: ``[W, 5]`` x, y [m] from the middle, share of the weight, and lever x, y [m] from the centre of mass.
        body: friction coefficient times gravity [m/s2], height of the centre of mass [m], which moves load to the outer
            and rear wheels, and squared radius of gyration [m2].
        out: ``[3]``.
    """
    forward, turn, grip = after[0], after[1], body[0]
    width, long, across, along = 0.0, 0.0, 0.0, 0.0
    for k in range(len(tires)):
        width, long = max(width, 2.0 * abs(tires[k, 1])), max(long, 2.0 * abs(tires[k, 0]))
        across, along = across + tires[k, 1] * tires[k, 1], along + tires[k, 0] * tires[k, 0]
    half = 0.5 * turn * (width + long * long / width)
    out[0], out[1], out[2] = forward - half, forward + half, before[2]
    push, spin = (forward - before[0]) / dt, (turn - before[1]) / dt
    most, size, slow = PART * (abs(half) + SOFT), 0.0, 1.0 / (dt * grip)
    # acceleration of the centre of mass without the lateral speed
    mass_x, mass_y = tires[0, 0] - tires[0, 3], tires[0, 1] - tires[0, 4]
    ahead = push - spin * mass_y - turn * turn * mass_x
    aside_pull = forward * turn + spin * mass_x - turn * turn * mass_y
    lean = body[1] * aside_pull / (GRAVITY * across)  # load that moves to the outer wheels
    dive = body[1] * (ahead - turn * before[2]) / (GRAVITY * along)  # and to the rear ones
    for _ in range(ROUNDS):
        rx, ry = (turn * out[2] - ahead) / grip, -aside_pull / grip - (out[2] - before[2]) * slow
        rz = -body[2] * spin / grip
        a, b, c = 0.0, 0.0, turn / grip  # rows of the Jacobian: left rim, right rim, lateral speed
        d, e, f = 0.0, 0.0, -slow
        g, h, i = 0.0, 0.0, 0.0
        for k in range(len(tires)):
            x, y, px, py = tires[k, 0], tires[k, 1], tires[k, 3], tires[k, 4]
            share = max(0.0, tires[k, 2] - lean * y - dive * x)
            sx, sy = forward - turn * y - (out[0] if y > 0.0 else out[1]), out[2] + turn * x
            slip = math.sqrt(sx * sx + sy * sy + SOFT * SOFT)
            fx, fy = -share * sx / slip, -share * sy / slip
            rx, ry, rz = rx + fx, ry + fy, rz + px * fy - py * fx
            cube = share / (slip * slip * slip)
            xx, xy, yy = (slip * slip - sx * sx) * cube, sx * sy * cube, (slip * slip - sy * sy) * cube
            if y > 0.0:
                a, d, g = a + xx, d - xy, g - px * xy - py * xx
            else:
                b, e, h = b + xx, e - xy, h - px * xy - py * xx
            c, f, i = c + xy, f - yy, i - px * yy - py * xy
        size = abs(rx) + abs(ry) + abs(rz) / width
        if size < CLOSE:
            break
        whole = a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)
        if abs(whole) < 1e-12:
            return False
        left = (rx * (e * i - f * h) - b * (ry * i - f * rz) + c * (ry * h - e * rz)) / whole
        right = (a * (ry * i - f * rz) - rx * (d * i - f * g) + c * (d * rz - ry * g)) / whole
        aside = (a * (e * rz - ry * h) - b * (d * rz - ry * g) + rx * (d * h - e * g)) / whole
        part = min(1.0, most / max(abs(left), abs(right), abs(aside), 1e-300))
        out[0], out[1], out[2] = out[0] - part * left, out[1] - part * right, out[2] - part * aside
    return size < FAILED


@kernel
def _missing(now: Floats, change: Floats, tires: Floats, rims: Floats, out: Floats) -> None:
    """Write residuals ``[2]`` of force and moment, and their derivatives ``[4]`` by the left and the right rims.

    Args:
        now: as in :func:`rims_of`.
        change: acceleration ahead, and moment by mass [m], both by friction coefficient times gravity.
        tires: as in :func:`rims_of`.
        rims: ``[2]`` speeds [m/s].
        out: ``[6]`` the result.
    """
    out[:] = 0.0
    out[0], out[1] = -change[0], -change[1]
    for k in range(len(tires)):
        x, y, share, px, py = tires[k, 0], tires[k, 1], tires[k, 2], tires[k, 3], tires[k, 4]
        sx, sy = now[0] - now[1] * y - (rims[0] if y > 0.0 else rims[1]), now[2] + now[1] * x
        slip = math.sqrt(sx * sx + sy * sy + SOFT * SOFT)
        out[0], out[1] = out[0] - share * sx / slip, out[1] + share * (py * sx - px * sy) / slip
        cube = share / (slip * slip * slip)
        xx, xy = (slip * slip - sx * sx) * cube, sx * sy * cube
        side = 0 if y > 0.0 else 1
        out[2 + side] += xx
        out[4 + side] -= px * xy + py * xx


@kernel
def rims_of(now: Floats, change: Floats, tires: Floats, grip: float, gyration: float, most: float, out: Floats) -> None:
    """Write the speeds [m/s] of the left and of the right rims at which the tyres give a base its acceleration.

    Unlike in :func:`slide_of`, the lateral speed and the loads are those of the moment. Newton steps are halved until
    the residual falls: near rolling, the forces bend sharply, and full steps would end at the limits.

    Args:
        now: ``[3]`` speed [m/s], turn rate [rad/s] and lateral speed [m/s] of the middle of the wheels.
        change: ``[2]`` acceleration [m/s2] and angular acceleration [rad/s2].
        tires: ``[W, 5]`` as in :func:`slide_of`, with the share of the weight that each bears now.
        grip: friction coefficient times gravity [m/s2].
        gyration: squared radius of gyration [m2].
        most: largest difference [m/s] of a rim from the speed; reached if the friction does not suffice.
        out: ``[2]`` the result; at the call, a guess.
    """
    forward, turn, left = now[0], now[1], now[2]
    mass_x, mass_y = tires[0, 0] - tires[0, 3], tires[0, 1] - tires[0, 4]
    wanted = np.empty(2)
    wanted[0] = (change[0] - change[1] * mass_y - turn * turn * mass_x - turn * left) / grip
    wanted[1] = gyration * change[1] / grip
    here, there, trial = np.empty(6), np.empty(6), np.empty(2)
    _missing(now, wanted, tires, out, here)
    scale = 1.0 / max(abs(tires[0, 1]), 1e-9)
    for _ in range(ROUNDS):
        size = abs(here[0]) + scale * abs(here[1])
        whole = here[2] * here[5] - here[3] * here[4]
        if size < CLOSE or abs(whole) < 1e-12:
            break
        first = (here[0] * here[5] - here[3] * here[1]) / whole
        second = (here[2] * here[1] - here[0] * here[4]) / whole
        part = min(1.0, PART * most / max(abs(first), abs(second), 1e-300))
        for _ in range(HALVINGS):
            trial[0] = min(max(out[0] - part * first, forward - most), forward + most)
            trial[1] = min(max(out[1] - part * second, forward - most), forward + most)
            _missing(now, wanted, tires, trial, there)
            if abs(there[0]) + scale * abs(there[1]) < size:
                break
            part *= 0.5
        out[:] = trial
        here[:] = there


@kernel
def side_speeds(before: Floats, after: Floats, dt: float, tires: Floats, body: Floats, out: Floats) -> None:
    """Write :func:`slide_of` for environments: ``before`` ``[E, 3]``, ``after`` ``[E, 2]``, ``out`` ``[E, 3]``.

    Without a balance of forces, the sides have the speeds for equal loads, and the base no lateral speed.
    """
    for e in range(len(after)):
        if not slide_of(before[e], after[e], dt, tires, body, out[e]):
            width, long = 0.0, 0.0
            for k in range(len(tires)):
                width, long = max(width, 2.0 * abs(tires[k, 1])), max(long, 2.0 * abs(tires[k, 0]))
            half = 0.5 * after[e, 1] * (width + long * long / width)
            out[e, 0], out[e, 1], out[e, 2] = after[e, 0] - half, after[e, 0] + half, 0.0
