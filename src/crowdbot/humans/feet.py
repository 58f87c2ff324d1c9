"""Foot placement: one time step of each person's gait. Planted feet are fixed in world coordinates."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel

from .stride import LANDED, STRIKE, TIPPING, ankle_over, cycle, foot_pose, smooth, wrap_angle

__all__ = ["Gaits", "advance", "foot_now"]

Floats = NDArray[np.float64]

CREEP = 0.12
"""Speed [m/s] below which people stand; they step only to correct a misplaced foot."""
FILTER = 0.10
"""Time constant [s] of the smoothed velocity. The body position is exact at every step."""
TURN_LAG, TURN_LIMIT = 0.12, 4.0
"""Time constant [s] and maximum turn rate [rad/s] of the trunk heading."""
BLEND_TIME = 0.8
"""Transition time between activities [s]."""
SITTING = 5
"""Column of ``sit`` in the blend of activities."""
STEP = 0.02
"""Maximum time step of the feet [s]; longer steps are subdivided."""
TWIST = math.radians(80.0)
"""Maximum yaw between foot and trunk [rad]; above it, the foot pivots on its ball or toes."""
LOST = 1.4
"""Distance from the body in leg lengths above which feet are repositioned."""
STEEPEST = math.radians(76.0)
"""Maximum heel raise that extends the reach of a leg [rad]."""
HIP_HEIGHT = 0.945
"""Hip height while walking [leg lengths], used for the heel raise."""
PUSH_SPEED = 0.55
"""Speed of the ankle at toe-off relative to the body speed."""


class Gaits(NamedTuple):
    """Gait state of N people at one instant, as arrays.

    Fields: ``position [N, 2]`` [m]; ``yaw [N]`` of the trunk [rad] and its rate ``turn [N]`` [rad/s]; ``drift [N, 2]``
    smoothed velocity [m/s]; ``phase [N]`` of the gait cycle, 0 at the left heel strike; ``moving [N]`` 1 while
    stepping; ``foot [N, 2, 3]`` x, y, yaw of the planted left and right foot; ``planted [N, 2]`` 1 for planted feet;
    ``lift [N, 2, 6]`` ankle, yaw, pitch, toes at toe-off; ``goal [N, 2, 3]`` x, y, yaw of the next landing;
    ``strike [N, 2]`` toes-up angle of the last landing [rad]; ``clock [N]`` [s]; ``blend [N, K]`` activity weights;
    ``wish [N]`` target activity of the blend.
    """

    position: Floats
    yaw: Floats
    turn: Floats
    drift: Floats
    phase: Floats
    moving: Floats
    foot: Floats
    planted: Floats
    lift: Floats
    goal: Floats
    strike: Floats
    clock: Floats
    blend: Floats
    wish: Floats


@kernel
def _neutral_foot(
    g: Gaits, i: int, f: int, x: float, y: float, yaw: float, style: Floats, leg: float, out: Floats
) -> None:
    """Write the neutral x, y, yaw of foot ``f`` for a body at x, y, yaw: half the stance width aside, toes out."""
    side = 1.0 - 2.0 * f
    pace = math.sqrt(g.drift[i, 0] ** 2 + g.drift[i, 1] ** 2)
    width = leg * (0.1 - 0.045 * min(pace, 1.0)) * style[7]
    out[0] = x - side * width * math.sin(yaw)
    out[1] = y + side * width * math.cos(yaw)
    out[2] = yaw + side * style[3]


@kernel
def _plan_landing(g: Gaits, i: int, f: int, left: float, ahead: float, style: Floats, leg: float) -> None:
    """Set the landing position of foot ``f`` in ``left`` [s]: below the body position ``ahead`` [s] after landing."""
    tau = left + ahead
    half = 0.5 * g.turn[i] * tau
    c, s = math.cos(half), math.sin(half)
    x = g.position[i, 0] + tau * (c * g.drift[i, 0] - s * g.drift[i, 1])
    y = g.position[i, 1] + tau * (s * g.drift[i, 0] + c * g.drift[i, 1])
    yaw = g.yaw[i] + min(max(g.turn[i] * tau, -0.7), 0.7)
    goal = g.goal[i, f]
    _neutral_foot(g, i, f, x, y, yaw, style, leg, goal)
    other = g.foot[i, 1 - f]
    side = 1.0 - 2.0 * f
    aside = side * (-math.sin(yaw) * (goal[0] - other[0]) + math.cos(yaw) * (goal[1] - other[1]))
    more = max(0.08 * leg - aside, 0.0)  # feet do not cross
    goal[0] -= side * more * math.sin(yaw)
    goal[1] += side * more * math.cos(yaw)


@kernel
def _placement_error(g: Gaits, i: int, f: int, style: Floats, leg: float) -> float:
    """Return the placement error of foot ``f`` for a standing body: 1 is 0.12 m or 35 degrees."""
    home = np.empty(3)
    _neutral_foot(g, i, f, g.position[i, 0], g.position[i, 1], g.yaw[i], style, leg, home)
    away = math.sqrt((g.foot[i, f, 0] - home[0]) ** 2 + (g.foot[i, f, 1] - home[1]) ** 2)
    return float(max(away / 0.12, abs(wrap_angle(g.foot[i, f, 2] - home[2])) / 0.61))


@kernel
def foot_now(g: Gaits, i: int, f: int, style: Floats, size: Floats, out: Floats) -> None:
    """Write the current ankle x, y, z [m], yaw, pitch and toe pitch [rad] of foot ``f``."""
    time, support, _, vigour = cycle(g.drift[i, 0], g.drift[i, 1], g.yaw[i], size[5], style[1])
    psi = (g.phase[i] + 0.5 * f) % 1.0
    planted = g.planted[i, f] > 0.0
    u = psi / support if planted else (psi - support) / (1.0 - support)
    swing = PUSH_SPEED * (1.0 - support) * time
    foot = g.foot[i, f]
    foot_pose(
        u, planted, foot, g.lift[i, f], g.goal[i, f], g.strike[i, f], STRIKE * vigour, vigour, swing * g.drift[i, 0],
        swing * g.drift[i, 1], size, out,
    )  # fmt: skip
    if planted:
        _raise_heel(g.position[i, 0] - foot[0], g.position[i, 1] - foot[1], foot, size, out)


@kernel
def _raise_heel(dx: float, dy: float, foot: Floats, size: Floats, out: Floats) -> None:
    """Raise the heel of a planted foot behind the body about its ball until the leg reaches it."""
    c, s = math.cos(foot[2]), math.sin(foot[2])
    ahead, aside = dx * c + dy * s, dy * c - dx * s
    low, high = max(out[4], 0.0), STEEPEST
    if ahead < -0.08 or low >= high or _reach_excess(ahead, aside, low, out[5], size) <= 0.0:
        return
    toes = max(out[5], 0.0)
    for _ in range(10):
        middle = 0.5 * (low + high)
        if _reach_excess(ahead, aside, middle, toes, size) > 0.0:
            low = middle
        else:
            high = middle
    x, z = ankle_over(high, toes, size)
    out[0], out[1], out[2], out[4], out[5] = foot[0] + x * c, foot[1] + x * s, z, high, toes


@kernel
def _reach_excess(ahead: float, aside: float, pitch: float, toes: float, size: Floats) -> float:
    """Return the distance [m] by which the ankle of a pitched foot exceeds the reach of a hip at walking height."""
    x, z = ankle_over(pitch, toes, size)
    far = (ahead - x) ** 2 + 0.8 * aside**2 + (HIP_HEIGHT * size[5] - z) ** 2
    return float(math.sqrt(far) - 0.99 * size[6])


@kernel
def _reset_feet(g: Gaits, i: int, style: Floats, size: Floats) -> None:
    """Place both feet as in steady walking at the current speed, or as in standing."""
    leg = size[5]
    speed = math.sqrt(g.drift[i, 0] ** 2 + g.drift[i, 1] ** 2)
    time, support, lead, vigour = cycle(g.drift[i, 0], g.drift[i, 1], g.yaw[i], leg, style[1])
    walking = speed > CREEP and g.blend[i, SITTING] < 0.5
    g.moving[i] = 1.0 if walking else 0.0
    g.phase[i] = style[0] if walking else 0.3
    for f in range(2):
        psi = (g.phase[i] + 0.5 * f) % 1.0
        ahead = time * (support * lead - min(psi, support)) if walking else 0.0
        gone = time * max(psi - support, 0.0) if walking else 0.0
        x = g.position[i, 0] + g.drift[i, 0] * (ahead - gone)
        y = g.position[i, 1] + g.drift[i, 1] * (ahead - gone)
        _neutral_foot(g, i, f, x, y, g.yaw[i], style, leg, g.foot[i, f])
        g.goal[i, f] = g.foot[i, f]
        g.strike[i, f] = STRIKE * vigour if walking else 0.0
        g.planted[i, f] = 1.0
        foot_pose(1.0, True, g.foot[i, f], g.lift[i, f], g.goal[i, f], 0.0, 0.0, vigour, 0.0, 0.0, size, g.lift[i, f])
        if walking and psi > support:
            g.planted[i, f] = 0.0
    for f in range(2):
        if g.planted[i, f] == 0.0:
            psi = (g.phase[i] + 0.5 * f) % 1.0
            _plan_landing(g, i, f, (1.0 - psi) * time, lead * support * time, style, leg)


@kernel
def _start_stepping(g: Gaits, i: int, support: float, style: Floats, leg: float) -> None:
    """Take the first step with the rearmost foot."""
    best, chosen = -1e9, 0
    for f in range(2):
        home = 0.3 * _placement_error(g, i, f, style, leg) + 1e-6 * f
        behind = (g.position[i, 0] - g.foot[i, f, 0]) * g.drift[i, 0] + (g.position[i, 1] - g.foot[i, f, 1]) * g.drift[
            i, 1
        ]
        aside = (1.0 - 2.0 * f) * (style[0] - 0.5) * 0.05
        if home + 10.0 * behind + aside > best:
            best, chosen = home + 10.0 * behind + aside, f
    g.moving[i] = 1.0
    g.phase[i] = (support - 0.5 * chosen) % 1.0


@kernel
def _pivot(g: Gaits, i: int, f: int, at: float) -> None:
    """Pivot a planted foot about the point ``at`` [m] ahead if the trunk has turned beyond the twist limit."""
    foot = g.foot[i, f]
    wrong = wrap_angle(g.yaw[i] - foot[2])
    turn = wrong - TWIST if wrong > TWIST else min(wrong + TWIST, 0.0)
    if turn == 0.0:
        return
    x, y = foot[0] + at * math.cos(foot[2]), foot[1] + at * math.sin(foot[2])
    foot[2] = wrap_angle(foot[2] + turn)
    foot[0], foot[1] = x - at * math.cos(foot[2]), y - at * math.sin(foot[2])


@kernel
def _cadence_factor(g: Gaits, i: int, leg: float) -> float:
    """Return the cadence factor for feet that lag behind the position or heading of the body."""
    most, sum_, twist = 0.0, 0.0, 0.0
    for f in range(2):
        if g.planted[i, f] > 0.0:
            away = math.sqrt((g.foot[i, f, 0] - g.position[i, 0]) ** 2 + (g.foot[i, f, 1] - g.position[i, 1]) ** 2)
            most, sum_ = max(most, away / leg), sum_ + away / leg
            twist = max(twist, abs(wrap_angle(g.foot[i, f, 2] - g.yaw[i])))
    stretch = max(most, 0.72 * sum_)  # below 0.75 in steady walking
    if stretch > LOST:
        return -1.0
    return 1.0 + 16.0 * min(max(stretch - 0.72, 0.0), 0.25) + 7.0 * min(max(twist - 0.6, 0.0), 0.7)


@kernel
def _move_feet(g: Gaits, i: int, dt: float, style: Floats, size: Floats) -> None:
    leg = size[5]
    speed = math.sqrt(g.drift[i, 0] ** 2 + g.drift[i, 1] ** 2)
    time, support, lead, vigour = cycle(g.drift[i, 0], g.drift[i, 1], g.yaw[i], leg, style[1])
    walking = speed > CREEP
    wrong = max(_placement_error(g, i, 0, style, leg), _placement_error(g, i, 1, style, leg))
    if g.moving[i] == 0.0:
        if not walking and wrong < 1.0:
            return
        _start_stepping(g, i, support, style, leg)
    haste = _cadence_factor(g, i, leg)
    if haste < 0.0:
        _reset_feet(g, i, style, size)
        return
    g.phase[i] = (g.phase[i] + haste * dt / time) % 1.0
    done = 0
    for f in range(2):
        psi = (g.phase[i] + 0.5 * f) % 1.0
        if g.planted[i, f] > 0.0:
            if psi > LANDED * support:
                _pivot(g, i, f, size[4] if psi > TIPPING * support else size[1])
            if psi < support:
                done += 1 if psi > LANDED * support else 0
            elif not walking and speed < 0.5 * CREEP and _placement_error(g, i, f, style, leg) < 0.4:
                g.strike[i, f] = 0.0
                done += 1
            elif g.planted[i, 1 - f] > 0.0 and psi < 0.5 * (1.0 + support):
                foot_now(g, i, f, style, size, g.lift[i, f])
                g.planted[i, f] = 0.0
        elif psi < 0.5:
            g.foot[i, f] = g.goal[i, f]
            g.planted[i, f] = 1.0
            g.strike[i, f] = STRIKE * vigour
            continue
        if g.planted[i, f] == 0.0:
            _plan_landing(g, i, f, (1.0 - psi) * time, lead * support * time, style, leg)
    if not walking and done == 2 and wrong < 0.5:
        g.moving[i] = 0.0


@kernel
def advance(
    g: Gaits, velocity: Floats, position: Floats, heading: Floats, fresh: Floats, dt: float, style: Floats, size: Floats
) -> None:
    """Move all people to ``position [N, 2]`` [m] in ``dt`` [s], in place; ``fresh`` people are repositioned."""
    parts = max(1, math.ceil(dt / STEP - 1e-9))
    h = dt / parts
    for i in range(len(fresh)):
        x0, y0 = g.position[i, 0], g.position[i, 1]
        far = math.sqrt((position[i, 0] - x0) ** 2 + (position[i, 1] - y0) ** 2)
        pace = math.sqrt(velocity[i, 0] ** 2 + velocity[i, 1] ** 2)
        if fresh[i] > 0.0 or far > 0.5 + 2.0 * pace * dt:
            g.position[i], g.drift[i], g.yaw[i], g.turn[i] = position[i], velocity[i], heading[i], 0.0
            g.clock[i] += dt
            _reset_feet(g, i, style[i], size[i])
            continue
        for part in range(parts):
            share = (part + 1) / parts
            g.position[i, 0] = x0 + share * (position[i, 0] - x0)
            g.position[i, 1] = y0 + share * (position[i, 1] - y0)
            _smooth_motion(g, i, velocity[i], heading[i], h)
            if g.blend[i, SITTING] > 0.5:
                g.drift[i, 0], g.drift[i, 1] = 0.0, 0.0
                _reset_feet(g, i, style[i], size[i])
            else:
                _move_feet(g, i, h, style[i], size[i])


@kernel
def _smooth_motion(g: Gaits, i: int, velocity: Floats, heading: float, h: float) -> None:
    """Advance smoothed velocity, trunk heading and activity blend by ``h`` [s]."""
    keep = math.exp(-h / FILTER)
    g.drift[i, 0] = velocity[0] + keep * (g.drift[i, 0] - velocity[0])
    g.drift[i, 1] = velocity[1] + keep * (g.drift[i, 1] - velocity[1])
    free = 1.0 - smooth(g.blend[i, SITTING])  # sitting people turn with the seat
    rate = wrap_angle(heading - g.yaw[i]) * (1.0 - free * math.exp(-h / TURN_LAG)) / h
    limit = TURN_LIMIT / max(free, 1e-6)
    rate = min(max(rate, -limit), limit)
    g.yaw[i] = wrap_angle(g.yaw[i] + rate * h)
    g.turn[i] = rate + keep * (g.turn[i] - rate)
    g.clock[i] += h
    sum_ = 0.0
    for k in range(g.blend.shape[1]):
        aim = 1.0 if g.wish[i] == k else 0.0
        g.blend[i, k] += min(max(aim - g.blend[i, k], -h / BLEND_TIME), h / BLEND_TIME)
        sum_ += g.blend[i, k]
    for k in range(g.blend.shape[1]):
        g.blend[i, k] /= sum_
