"""Gait parameters as functions of speed: cycle time, stride length, duty factor, and the swing path of a foot.

Relations of Boulic, Magnenat-Thalmann & Thalmann 1990, doi:10.1007/BF01901021, in leg lengths. Below a relative speed
of 0.25, the stride length is a power of the speed (not in the source).
"""

from __future__ import annotations

import math

from crowdbot.core import kernel
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
