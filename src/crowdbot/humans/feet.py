"""Steps and feet of the gait.

Relations of Boulic, Magnenat-Thalmann & Thalmann 1990, doi:10.1007/BF01901021, in leg lengths. Below a relative speed
of 0.25, the stride length is a power of the speed (not in the source).
"""

from __future__ import annotations

import math
from typing import NamedTuple

from crowdbot.core import kernel, storable
from crowdbot.typing import Floats

from .vectors import Vector

Foot = tuple[float, float, float, float, float, float]
"""Ankle x, y, z [m], yaw, pitch and toe pitch [rad]."""
RESTING_CYCLE = 1.15
"""Cycle time of stepping on the spot [s]."""
EASY = 0.3
"""Speed [m/s] below which the cycle time is blended with that of stepping on the spot."""
FASTEST = 0.42
"""Minimum cycle time [s]."""
LONGEST = 2.2
"""Relative speed above which only the cadence increases (real people would run)."""
LEAD = 0.36
"""Distance of the foot ahead of the hip at heel strike, as a fraction of the body motion during stance."""
BACKWARD = 0.3
"""Relative shortening of backward strides."""
ASIDE = 0.5
"""Maximum sideways stride [leg lengths]; feet do not cross."""
STRIKE, PUSH = math.radians(20.0), math.radians(68.0)
"""Toes-up angle at heel strike and heel-up angle at toe-off [rad], at a relative speed of 0.9."""
LANDED, ROLLING, TIPPING = 0.19, 0.50, 0.75
"""Fractions of the support: up to the first, the foot rotates about the heel; from the second, about the ball; from the
third, about the tip of the toes."""
HOP = 0.0355
"""Lift of the ankle in the first half of the swing [leg lengths]; it bends the knee to about 62 degrees."""
TIPPED = math.radians(35.0)
"""Pitch of the toes at toe-off [rad], at a relative speed of 0.9."""


@kernel(inline=True)
def smooth(x: float) -> float:
    """Return the smooth step from 0 to 1."""
    x = min(max(x, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)


@kernel(inline=True)
def wrap_angle(angle: float) -> float:
    """Return the angle [rad] in -pi to pi."""
    return angle - 2.0 * math.pi * math.floor((angle + math.pi) / (2.0 * math.pi))


@kernel
def cycle(vx: float, vy: float, yaw: float, leg: float, longer: float) -> tuple[float, float, float, float]:
    """Return cycle time [s], duty factor, lead of the foot and vigour of the walk (1 near 1.1 m/s forward).

    The lead is the distance of the foot ahead of the hip at landing, as a fraction of the body motion during stance.

    Args:
        vx, vy: velocity [m/s].
        yaw: heading of the trunk [rad]; sideways and backward steps are shorter.
        leg: length of the leg [m].
        longer: stride of the person relative to the mean.
    """
    speed = math.sqrt(vx * vx + vy * vy)
    ahead, aside = vx * math.cos(yaw) + vy * math.sin(yaw), vy * math.cos(yaw) - vx * math.sin(yaw)
    v = max(speed, EASY)
    rv = min(v / leg, LONGEST)
    length = longer * leg * (1.346 * math.sqrt(rv) if rv > 0.25 else 0.673 * (rv / 0.25) ** 0.6)
    time = length / v
    if speed < EASY:
        time = RESTING_CYCLE + (time - RESTING_CYCLE) * speed / EASY
    away = 0.5 - 0.5 * ahead / max(speed, 1e-6) if speed > 1e-6 else 0.0
    time *= 1.0 - BACKWARD * away
    time = max(min(time, ASIDE * leg / max(abs(aside), 1e-6)), FASTEST)
    support = min(max(0.752 - 0.143 / time, 0.52), 0.80)
    strong = min(max(ahead / leg / 0.9, 0.0), 1.3)
    return time, support, LEAD + (0.5 - LEAD) * away, strong * strong / (strong + 0.05)


@kernel(inline=True)
def ankle_over(pitch: float, toes: float, size: Floats) -> tuple[float, float]:
    """Return the distance [m] of the ankle of a pitched foot ahead of and above the ankle's point on the floor.

    With toes up, the foot rotates about the fixed heel; with heel up, about the ball; pitched toes, about their tip.
    """
    ankle, ball_x, ball_z, heel, tip = size[0], size[1], size[2], size[3], size[4]
    s, c = math.sin(pitch), math.cos(pitch)
    if pitch <= 0.0:
        return heel - heel * c + ankle * s, heel * s + ankle * c
    x, z = -ball_x * c + (ankle - ball_z) * s, ball_x * s + (ankle - ball_z) * c
    s, c = math.sin(toes), math.cos(toes)
    return x + tip + (ball_x - tip) * c + ball_z * s, z + (tip - ball_x) * s + ball_z * c


@kernel(inline=True)
def lowest(pitch: float, toes: float, size: Floats) -> float:
    """Return the height [m] of the lowest point of the sole above the ankle (negative) for these pitches [rad]."""
    sn, c = math.sin(pitch), math.cos(pitch)
    heel = -size[3] * sn - size[0] * c
    ball = -size[1] * sn - (size[0] - size[2]) * c
    tip = ball - (size[4] - size[1]) * math.sin(toes) - size[2] * math.cos(toes)
    return float(min(heel, ball - size[2], tip))


@kernel(inline=True)
def planted_foot(u: float, flat: Vector, strike: float, vigour: float, size: Floats) -> Foot:
    """Return ankle x, y, z [m], yaw, pitch and toe pitch [rad] of a planted foot.

    Args:
        u: progress of the support, from 0 to 1.
        flat: x, y, yaw of the planted foot.
        strike: toes-up angle of the last landing [rad].
        vigour: vigour of the walk, 0 when standing.
        size: ankle height, ball (ahead, above), heel ahead, toe ahead, leg, thigh plus shank [m].
    """
    pitch = -strike * max(1.0 - u / LANDED, 0.0)
    toes = pitch
    if u > ROLLING:
        pitch = PUSH * min(vigour, 1.1) * ((min(u, 1.0) - ROLLING) / (1.0 - ROLLING)) ** 1.35
        toes = TIPPED * min(vigour, 1.1) * (max(min(u, 1.0) - TIPPING, 0.0) / (1.0 - TIPPING)) ** 1.5
    ahead, above = ankle_over(pitch, toes, size)
    return flat[0] + ahead * math.cos(flat[2]), flat[1] + ahead * math.sin(flat[2]), above, flat[2], pitch, toes


@kernel(inline=True)
def swinging_foot(
    u: float, lift: Foot, goal: Vector, strike: float, push_x: float, push_y: float, size: Floats
) -> Foot:
    """Return ankle x, y, z [m], yaw, pitch and toe pitch [rad] of a foot in the air.

    Args:
        u: progress of the swing.
        lift: the foot at toe-off.
        goal: x, y, yaw of the next landing.
        strike: toes-up angle of the next landing [rad].
        push_x, push_y: velocity of the ankle at toe-off times the swing time [m].
        size: as for :func:`planted_foot`.
    """
    s = min(max(u, 0.0), 1.0)
    ahead, above = ankle_over(-strike, -strike, size)
    over, start = s * s * (3.0 - 2.0 * s), s * (1.0 - s) * (1.0 - s)
    pushed = start - 0.7 * s * s * (1.0 - s)
    x = lift[0] + over * (goal[0] + ahead * math.cos(goal[2]) - lift[0]) + pushed * push_x
    y = lift[1] + over * (goal[1] + ahead * math.sin(goal[2]) - lift[1]) + pushed * push_y
    yaw = lift[3] + over * wrap_angle(goal[2] - lift[3])
    pitch = lift[4] * (1.0 - smooth(s / 0.75)) - strike * smooth((s - 0.45) / 0.5)
    toes = lift[5] + (pitch - lift[5]) * smooth(s / 0.4)
    hop = HOP * size[5] * start * 6.75
    z = lift[2] + over * (above - lift[2]) + hop
    z = max(z, 0.012 * math.sin(math.pi * s) - lowest(pitch, toes, size))
    return x, y, z, yaw, pitch, toes


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


@storable
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


@kernel(inline=True)
def _neutral_foot(g: Gaits, i: int, f: int, x: float, y: float, yaw: float, style: Floats, leg: float) -> Vector:
    """Return the neutral x, y, yaw of foot ``f`` for a body at x, y, yaw: half the stance width aside, toes out."""
    side = 1.0 - 2.0 * f
    pace = math.sqrt(g.drift[i, 0] ** 2 + g.drift[i, 1] ** 2)
    width = leg * (0.1 - 0.045 * min(pace, 1.0)) * style[7]
    return x - side * width * math.sin(yaw), y + side * width * math.cos(yaw), yaw + side * style[3]


@kernel(inline=True)
def _plan_landing(g: Gaits, i: int, f: int, left: float, ahead: float, style: Floats, leg: float) -> None:
    """Set the landing position of foot ``f`` in ``left`` [s]: below the body position ``ahead`` [s] after landing."""
    tau = left + ahead
    half = 0.5 * g.turn[i] * tau
    c, s = math.cos(half), math.sin(half)
    x = g.position[i, 0] + tau * (c * g.drift[i, 0] - s * g.drift[i, 1])
    y = g.position[i, 1] + tau * (s * g.drift[i, 0] + c * g.drift[i, 1])
    yaw = g.yaw[i] + min(max(g.turn[i] * tau, -0.7), 0.7)
    x, y, toward = _neutral_foot(g, i, f, x, y, yaw, style, leg)
    side = 1.0 - 2.0 * f
    aside = side * (-math.sin(yaw) * (x - g.foot[i, 1 - f, 0]) + math.cos(yaw) * (y - g.foot[i, 1 - f, 1]))
    more = max(0.08 * leg - aside, 0.0)  # feet do not cross
    g.goal[i, f, 0] = x - side * more * math.sin(yaw)
    g.goal[i, f, 1] = y + side * more * math.cos(yaw)
    g.goal[i, f, 2] = toward


@kernel(inline=True)
def _placement_error(g: Gaits, i: int, f: int, style: Floats, leg: float) -> float:
    """Return the placement error of foot ``f`` for a standing body: 1 is 0.12 m or 35 degrees."""
    x, y, yaw = _neutral_foot(g, i, f, g.position[i, 0], g.position[i, 1], g.yaw[i], style, leg)
    away = math.sqrt((g.foot[i, f, 0] - x) ** 2 + (g.foot[i, f, 1] - y) ** 2)
    return float(max(away / 0.12, abs(wrap_angle(g.foot[i, f, 2] - yaw)) / 0.61))


@kernel(inline=True)
def _row(table: Floats, i: int, f: int) -> Vector:
    """Return x, y and yaw of foot ``f`` in a table ``[N, 2, 3]``."""
    return table[i, f, 0], table[i, f, 1], table[i, f, 2]


@kernel(inline=True)
def foot_now(g: Gaits, i: int, f: int, time: float, support: float, vigour: float, size: Floats) -> Foot:
    """Return the current foot ``f``; cycle time [s], duty factor and vigour are those of :func:`cycle`."""
    psi = (g.phase[i] + 0.5 * f) % 1.0
    if g.planted[i, f] > 0.0:
        flat = _row(g.foot, i, f)
        found = planted_foot(psi / support, flat, g.strike[i, f], vigour, size)
        return _raise_heel(g.position[i, 0] - flat[0], g.position[i, 1] - flat[1], flat, found, size)
    lift = g.lift
    at = lift[i, f, 0], lift[i, f, 1], lift[i, f, 2], lift[i, f, 3], lift[i, f, 4], lift[i, f, 5]
    swing = PUSH_SPEED * (1.0 - support) * time
    return swinging_foot(
        (psi - support) / (1.0 - support), at, _row(g.goal, i, f), STRIKE * vigour, swing * g.drift[i, 0],
        swing * g.drift[i, 1], size,
    )  # fmt: skip


@kernel(inline=True)
def _raise_heel(dx: float, dy: float, foot: Vector, found: Foot, size: Floats) -> Foot:
    """Return a planted foot behind the body with its heel raised about its ball until the leg reaches it."""
    c, s = math.cos(foot[2]), math.sin(foot[2])
    ahead, aside = dx * c + dy * s, dy * c - dx * s
    low, high = max(found[4], 0.0), STEEPEST
    if ahead < -0.08 or low >= high or _reach_excess(ahead, aside, low, found[5], size) <= 0.0:
        return found
    toes = max(found[5], 0.0)
    for _ in range(10):
        middle = 0.5 * (low + high)
        if _reach_excess(ahead, aside, middle, toes, size) > 0.0:
            low = middle
        else:
            high = middle
    x, z = ankle_over(high, toes, size)
    return foot[0] + x * c, foot[1] + x * s, z, found[3], high, toes


@kernel(inline=True)
def _reach_excess(ahead: float, aside: float, pitch: float, toes: float, size: Floats) -> float:
    """Return the distance [m] by which the ankle of a pitched foot exceeds the reach of a hip at walking height."""
    x, z = ankle_over(pitch, toes, size)
    far = (ahead - x) ** 2 + 0.8 * aside**2 + (HIP_HEIGHT * size[5] - z) ** 2
    return float(math.sqrt(far) - 0.99 * size[6])


@kernel(inline=True)
def _write(values: Vector, table: Floats, i: int, f: int) -> None:
    """Write x, y and yaw of foot ``f`` to a table ``[N, 2, 3]``."""
    table[i, f, 0], table[i, f, 1], table[i, f, 2] = values


@kernel(inline=True)
def _lift_off(values: Foot, lift: Floats, i: int, f: int) -> None:
    """Write the foot at toe-off."""
    for k in range(6):
        lift[i, f, k] = values[k]


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
        flat = _neutral_foot(g, i, f, x, y, g.yaw[i], style, leg)
        _write(flat, g.foot, i, f)
        _write(flat, g.goal, i, f)
        g.strike[i, f] = STRIKE * vigour if walking else 0.0
        g.planted[i, f] = 1.0
        _lift_off(planted_foot(1.0, flat, 0.0, vigour, size), g.lift, i, f)
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
    x, y, yaw = _row(g.foot, i, f)
    wrong = wrap_angle(g.yaw[i] - yaw)
    turn = wrong - TWIST if wrong > TWIST else min(wrong + TWIST, 0.0)
    if turn == 0.0:
        return
    x, y = x + at * math.cos(yaw), y + at * math.sin(yaw)
    yaw = wrap_angle(yaw + turn)
    _write((x - at * math.cos(yaw), y - at * math.sin(yaw), yaw), g.foot, i, f)


@kernel(inline=True)
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


@kernel(inline=True)
def _move_feet(g: Gaits, i: int, dt: float, style: Floats, size: Floats) -> None:
    leg = size[5]
    speed = math.sqrt(g.drift[i, 0] ** 2 + g.drift[i, 1] ** 2)
    time, support, lead, vigour = cycle(g.drift[i, 0], g.drift[i, 1], g.yaw[i], leg, style[1])
    walking = speed > CREEP
    wrong = 0.0
    if not walking or g.moving[i] == 0.0:  # nothing else needs it
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
                _lift_off(foot_now(g, i, f, time, support, vigour, size), g.lift, i, f)
                g.planted[i, f] = 0.0
        elif psi < 0.5:
            _write(_row(g.goal, i, f), g.foot, i, f)
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
    keep, lag = math.exp(-h / FILTER), math.exp(-h / TURN_LAG)
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
            _smooth_motion(g, i, velocity[i, 0], velocity[i, 1], heading[i], h, keep, lag)
            if g.blend[i, SITTING] > 0.5:
                g.drift[i, 0], g.drift[i, 1] = 0.0, 0.0
                _reset_feet(g, i, style[i], size[i])
            else:
                _move_feet(g, i, h, style[i], size[i])


@kernel(inline=True)
def _smooth_motion(g: Gaits, i: int, vx: float, vy: float, heading: float, h: float, keep: float, lag: float) -> None:
    """Advance smoothed velocity, trunk heading and activity blend by ``h`` [s]; ``keep`` and ``lag`` are the factors
    of the filters in this time."""
    g.drift[i, 0] = vx + keep * (g.drift[i, 0] - vx)
    g.drift[i, 1] = vy + keep * (g.drift[i, 1] - vy)
    free = 1.0 - smooth(g.blend[i, SITTING])  # sitting people turn with the seat
    rate = wrap_angle(heading - g.yaw[i]) * (1.0 - free * lag) / h
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
