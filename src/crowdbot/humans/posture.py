"""Posture: position and rotation of each bone from the gait state."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel

from .arms import pose_arm
from .asset import shapes
from .feet import Gaits, foot_now
from .measures import Measures
from .stride import STRIKE, ankle_over, cycle, smooth
from .turns import about, align_frame, cross, turn_zxy, unit

__all__ = ["Posture", "bend_leg", "place_chain", "posture"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]

PELVIS_TURN, PELVIS_ROLL, CHEST_TURN = math.radians(5.0), math.radians(3.0), math.radians(4.0)
SWAY = 0.022
"""Lateral motion of the pelvis over the stance leg [leg lengths]."""
STRAIGHT = 0.998
"""Maximum extension of a leg as a fraction of its length."""
BOB = 0.035
"""Vertical motion of the pelvis in a step per speed [m per m/s]."""
HIGHEST = 0.235
"""Phase of the maximum pelvis height over the left leg; the minimum is a quarter of a cycle later."""
SOFT = 0.004
"""Width [m] of the smooth minimum of the height limits of the pelvis."""
SEAT_FLESH = 0.055
"""Height of the hip joints above the seat, as a fraction of stature."""
SITTING = 5


class Posture(NamedTuple):
    """Bones of N people: ``rotation [N, B, 3, 3]`` relative to rest, and ``position [N, B, 3]`` of the heads [m]."""

    rotation: Floats
    position: Floats


@kernel
def _pose_trunk(g: Gaits, i: int, vigour: float, style: Floats, sit: float, recline: float, R: Floats) -> None:
    """Write the rotations of pelvis, spine, neck, head and collar bones (bones 0 to 6 and 13)."""
    wave = 2.0 * math.pi * g.phase[i]
    strong = min(vigour, 1.2) * (1.0 - sit)
    yaw = -PELVIS_TURN * strong * math.cos(wave)
    roll = PELVIS_ROLL * strong * math.sin(wave - 0.3)
    chest = CHEST_TURN * strong * math.cos(wave)
    lean = style[4] * (0.3 + 0.7 * min(strong, 1.0))
    talk, phone, text = g.blend[i, 1], g.blend[i, 2], g.blend[i, 4]
    beat = style[6] * g.clock[i] + 6.283 * style[5]
    for b in range(4):
        share = b / 3.0
        pitch = lean * (0.4 + 0.6 * share) - sit * max(0.12 * (1.0 - share), recline)
        turn_zxy(g.yaw[i] + yaw + share * (chest - yaw), roll * (1.0 - share), pitch, R[b])
    R[6], R[13] = R[3], R[3]
    look = 0.14 * talk * math.sin(1.3 * beat) + 0.05 * math.sin(0.31 * beat) - 0.12 * phone
    nod = 0.06 * talk * math.sin(2.9 * beat) + 0.42 * text + 0.3 * lean
    turn_zxy(g.yaw[i] + 0.5 * (look + chest), -0.06 * phone, 0.5 * lean + 0.4 * nod, R[4])
    turn_zxy(g.yaw[i] + look, -0.15 * phone, nod, R[5])


@kernel
def _hip_offset(head: Floats, b: int, R: Floats, out: Floats) -> None:
    """Write the hip joint relative to the pelvis joint."""
    for r in range(3):
        out[r] = 0.0
        for c in range(3):
            out[r] += R[0, r, c] * (head[b, c] - head[0, c])


@kernel
def _seated_ankle(
    g: Gaits, i: int, f: int, hip: float, lengths: Floats, size: Floats, seat: Floats, out: Floats
) -> None:
    """Write ankle x, y, z [m] and pitch [rad] of foot ``f`` of a sitting person, on the foot rest or the floor."""
    side, thigh, shank = 1.0 - 2.0 * f, lengths[0], lengths[1]
    ahead, aside, pitch = seat[1] + thigh + 0.02, side * 0.11 * size[5], 0.0
    height = max(size[0], hip - shank * 0.995)
    if seat[4] > 0.0:
        x, z = ankle_over(-seat[3], -seat[3], size)
        x, z = seat[5] - size[3] + x, seat[7] + z
        if math.sqrt((x - seat[1]) ** 2 + (z - hip) ** 2) < 0.995 * (thigh + shank):
            ahead, aside, height, pitch = x, side * seat[6], z, -seat[3]
    c, s = math.cos(g.yaw[i]), math.sin(g.yaw[i])
    out[0] = g.position[i, 0] + c * ahead - s * aside
    out[1] = g.position[i, 1] + s * ahead + c * aside
    out[2], out[3] = height, pitch


@kernel
def _blend_ankles(
    g: Gaits, i: int, sit: float, hip: float, lengths: Floats, style: Floats, size: Floats, seat: Floats, out: Floats
) -> None:
    """Write both feet as :func:`foot_now` does, blended with their sitting positions by ``sit``."""
    rest = np.empty(4)
    for f in range(2):
        foot_now(g, i, f, style, size, out[f])
        if sit > 0.0:
            _seated_ankle(g, i, f, hip, lengths, size, seat, rest)
            for k in range(3):
                out[f, k] += sit * (rest[k] - out[f, k])
            out[f, 4] += sit * (rest[3] - out[f, 4])
            out[f, 5] += sit * (rest[3] - out[f, 5])


@kernel
def _leg_limit(hip: Floats, foot: Floats, x: float, y: float, longest: float) -> float:
    """Return the height [m] of the pelvis joint at which this leg has the length ``longest`` [m]."""
    dx, dy = foot[0] - x - hip[0], foot[1] - y - hip[1]
    return float(foot[2] + math.sqrt(max(longest**2 - dx * dx - dy * dy, (0.5 * longest) ** 2)) - hip[2])


@kernel
def _walking_height(phase: float, speed: float, way: float, vigour: float, length: float, size: Floats) -> float:
    """Return the height [m] of the hips in walking: a wave above the height that the leading leg permits.

    ``way`` is the distance [m] of the foot ahead of the hip at landing.
    """
    ahead, above = ankle_over(-STRIKE * vigour, -STRIKE * vigour, size)
    far = way + ahead
    bottom = above - 0.004 + math.sqrt(max((STRAIGHT * length) ** 2 - far * far, (0.5 * length) ** 2))
    bob = min(BOB * speed, 0.1 * size[5])
    top = size[0] + STRAIGHT * length - 2.0 * SOFT
    return float(min(bottom + bob, top) - bob * (0.5 - 0.5 * math.cos(4.0 * math.pi * (phase - HIGHEST))))


@kernel
def _pelvis_height(hips: Floats, feet: Floats, x: float, y: float, longest: float, tallest: float) -> float:
    """Return the height of the pelvis joint [m]: a smooth minimum of the reach of both legs and ``tallest`` [m]."""
    left, right = _leg_limit(hips[0], feet[0], x, y, longest), _leg_limit(hips[1], feet[1], x, y, longest)
    low = min(left, right, tallest)
    far = math.exp((low - left) / SOFT) + math.exp((low - right) / SOFT) + math.exp((low - tallest) / SOFT)
    return low - SOFT * math.log(far)


@kernel
def bend_leg(
    hip: Floats, ankle: Floats, thigh: float, shank: float, yaw: float, frame: Floats, f: int, R: Floats, bone: int,
    work: Floats,
) -> None:  # fmt: skip
    """Write the rotations of thigh and shank that take the ankle to its place; the knee bends forward."""
    axis, hinge, ahead, turned = work[0], work[1], work[2], work[3]
    for k in range(3):
        axis[k] = ankle[k] - hip[k]
    reach = min(max(unit(axis), abs(thigh - shank) + 0.05), 0.9999 * (thigh + shank))
    ahead[0], ahead[1], ahead[2] = math.cos(yaw), math.sin(yaw), 0.2
    cross(ahead, axis, hinge)
    unit(hinge)
    at_hip = math.acos(min(max((thigh**2 + reach**2 - shank**2) / (2.0 * thigh * reach), -1.0), 1.0))
    at_ankle = math.acos(min(max((shank**2 + reach**2 - thigh**2) / (2.0 * shank * reach), -1.0), 1.0))
    about(hinge, -at_hip, axis, turned)
    align_frame(frame[f], turned, hinge, R[bone])
    about(hinge, at_ankle, axis, turned)
    align_frame(frame[2 + f], turned, hinge, R[bone + 1])


@kernel
def _pose_leg(
    hip: Floats, foot: Floats, thigh: float, shank: float, yaw: float, frame: Floats, f: int, R: Floats, bone: int,
    work: Floats,
) -> None:  # fmt: skip
    """Write the rotations of thigh, shank, foot and toes for an ankle at ``foot``; the knee bends forward."""
    bend_leg(hip, foot, thigh, shank, yaw, frame, f, R, bone, work)
    turn_zxy(foot[3], 0.0, foot[4], R[bone + 2])
    turn_zxy(foot[3], 0.0, foot[5], R[bone + 3])


@kernel
def place_chain(first: int, last: int, head: Floats, parents: Ints, R: Floats, P: Floats) -> None:
    """Place bones ``first`` to ``last`` at the ends of their parents."""
    for b in range(first, last):
        p = parents[b]
        for r in range(3):
            P[b, r] = P[p, r]
            for c in range(3):
                P[b, r] += R[p, r, c] * (head[b, c] - head[p, c])


@kernel
def _pose_one(
    g: Gaits, i: int, lengths: Floats, head: Floats, frame: Floats, style: Floats, size: Floats, seat: Floats,
    parents: Ints, R: Floats, P: Floats,
) -> None:  # fmt: skip
    thigh, shank, stature = lengths[0], lengths[1], lengths[4]
    sit = smooth(g.blend[i, SITTING])
    time, support, lead, vigour = cycle(g.drift[i, 0], g.drift[i, 1], g.yaw[i], size[5], style[1])
    speed = math.sqrt(g.drift[i, 0] ** 2 + g.drift[i, 1] ** 2)
    _pose_trunk(g, i, vigour, style, sit, seat[2], R)
    work, hips, feet = np.empty((8, 3)), np.empty((2, 3)), np.empty((2, 6))
    _hip_offset(head, 20, R, hips[0])
    _hip_offset(head, 24, R, hips[1])
    sat = seat[0] + SEAT_FLESH * stature
    _blend_ankles(g, i, sit, sat, lengths, style, size, seat, feet)
    sway = SWAY * size[5] * min(speed / 0.6, 1.0) * math.sin(2.0 * math.pi * g.phase[i] - 0.3)
    x = g.position[i, 0] - sway * math.sin(g.yaw[i]) + sit * seat[1] * math.cos(g.yaw[i])
    y = g.position[i, 1] + sway * math.cos(g.yaw[i]) + sit * seat[1] * math.sin(g.yaw[i])
    rest = 0.5 * (hips[0, 2] + hips[1, 2])
    tallest = _walking_height(g.phase[i], speed, lead * support * time * speed, vigour, thigh + shank, size) - rest
    height = _pelvis_height(hips, feet, x, y, STRAIGHT * (thigh + shank), tallest)
    height += sit * (sat - rest - height)
    P[0, 0], P[0, 1], P[0, 2] = x, y, height
    for f in range(2):
        for k in range(3):
            hips[f, k] += P[0, k]
        ahead = g.yaw[i] + 0.5 * math.atan2(math.sin(feet[f, 3] - g.yaw[i]), math.cos(feet[f, 3] - g.yaw[i]))
        _pose_leg(hips[f], feet[f], thigh, shank, ahead, frame, f, R, 20 + 4 * f, work)
    place_chain(1, 8, head, parents, R, P)
    place_chain(13, 15, head, parents, R, P)
    for f in range(2):
        pose_arm(g, i, f, vigour, sit, lengths, frame, style, seat, R, P, work)
    place_chain(8, 13, head, parents, R, P)
    place_chain(15, 28, head, parents, R, P)


@kernel
def _pose(
    g: Gaits, lengths: Floats, heads: Floats, frames: Floats, style: Floats, size: Floats, seats: Floats,
    parents: Ints, R: Floats, P: Floats,
) -> None:  # fmt: skip
    """Pose all people."""
    for i in range(len(lengths)):
        _pose_one(g, i, lengths[i], heads[i], frames[i], style[i], size[i], seats[i], parents, R[i], P[i])


def posture(state: Gaits, body: Measures, style: Floats, size: Floats, seats: Floats) -> Posture:
    """Return the posture of all people in ``state``."""
    lengths = np.stack([body.thigh, body.shank, body.arm[:, 0], body.arm[:, 1], body.height], axis=1)
    count, bones = body.head.shape[:2]
    out = Posture(np.empty((count, bones, 3, 3)), np.empty((count, bones, 3)))
    _pose(state, lengths, body.head, body.frame, style, size, seats, shapes().parents, out.rotation, out.position)
    return out
