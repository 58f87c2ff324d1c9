"""Posture of a walking person: pelvis, legs and arms from the gait and the measures of the body."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats, Ints

from .arms import pose_arm
from .asset import shapes
from .feet import STRIKE, Foot, Gaits, ankle_over, cycle, foot_now, smooth
from .vectors import Vector, cross_product, normalize, rotate, write_frame, write_turn

CHAINS = ("thigh_l", "thigh_r", "calf_l", "calf_r", "upperarm_l", "upperarm_r", "lowerarm_l", "lowerarm_r")
"""Bones whose rotation is computed from the directions of axis and hinge, in the order of ``frame``."""
ENDS = ("calf_l", "calf_r", "foot_l", "foot_r", "lowerarm_l", "lowerarm_r", "hand_l", "hand_r")


class Measures(NamedTuple):
    """Lengths of N bodies [m]; both legs are assumed equal.

    Fields: ``leg [N]`` height of the hip joint; ``thigh``, ``shank [N]``; ``ankle [N]`` height of the ankle;
    ``ball [N, 2]`` distance ahead of the ankle and height; ``heel``, ``toe [N]`` distance ahead of the ankle;
    ``arm [N, 2]`` upper and lower arm; ``head [N, B, 3]`` start of each bone at rest; ``frame [N, 8, 3, 3]`` axis,
    hinge and their cross product (rows) of each of :data:`CHAINS` at rest; ``height [N]`` stature.
    """

    leg: Floats
    thigh: Floats
    shank: Floats
    ankle: Floats
    ball: Floats
    heel: Floats
    toe: Floats
    arm: Floats
    head: Floats
    frame: Floats
    height: Floats


def measures(heads: Floats, sole: Floats, scale: Floats, height: Floats) -> Measures:
    """Return the measures of N bodies with ``scale [N]`` and ``height [N]`` [m].

    Args:
        heads: start of each bone at rest ``[N, B, 3]`` [m], before scaling.
        sole: rear and front end of the sole ``[N, 2]`` [m], before scaling.
        scale: ratio of stature to that at rest ``[N]``.
        height: stature ``[N]`` [m].
    """
    every = shapes()
    head = heads * scale[:, None, None]

    def length(a: str, b: str) -> Floats:
        return np.asarray(np.linalg.norm(head[:, every.bone(b)] - head[:, every.bone(a)], axis=-1))

    ankle = head[:, every.bone("foot_l")]
    ball = head[:, every.bone("ball_l")]
    heel, toe = (sole * scale[:, None]).T
    return Measures(
        leg=head[:, every.bone("thigh_l"), 2].copy(),
        thigh=length("thigh_l", "calf_l"),
        shank=length("calf_l", "foot_l"),
        ankle=ankle[:, 2].copy(),
        ball=np.stack([ball[:, 0] - ankle[:, 0], ball[:, 2]], axis=1),
        heel=heel - ankle[:, 0],
        toe=toe - ankle[:, 0],
        arm=np.stack([length("upperarm_l", "lowerarm_l"), length("lowerarm_l", "hand_l")], axis=1),
        head=head,
        frame=_frames(head),
        height=np.asarray(height, dtype=np.float64),
    )


def _frames(head: Floats) -> Floats:
    """Return the rest frames of :data:`CHAINS`: knees bend about the left axis of the body, elbows as at rest."""
    every = shapes()
    axis = np.stack([head[:, every.bone(e)] - head[:, every.bone(c)] for c, e in zip(CHAINS, ENDS, strict=True)], 1)
    axis = axis / np.linalg.norm(axis, axis=-1, keepdims=True)
    hinge = np.zeros_like(axis)
    hinge[:, :4, 1] = 1.0
    elbow = np.cross(axis[:, 4:6], axis[:, 6:8])
    hinge[:, 4:6], hinge[:, 6:8] = elbow, elbow
    hinge = hinge - axis * (hinge * axis).sum(-1, keepdims=True)
    hinge = hinge / np.linalg.norm(hinge, axis=-1, keepdims=True)
    return np.stack([axis, hinge, np.cross(axis, hinge)], axis=2)


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


@kernel(inline=True)
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
        write_turn(g.yaw[i] + yaw + share * (chest - yaw), roll * (1.0 - share), pitch, R, b)
    for r in range(3):
        for c in range(3):
            R[6, r, c] = R[13, r, c] = R[3, r, c]
    look = 0.14 * talk * math.sin(1.3 * beat) + 0.05 * math.sin(0.31 * beat) - 0.12 * phone
    nod = 0.06 * talk * math.sin(2.9 * beat) + 0.42 * text + 0.3 * lean
    write_turn(g.yaw[i] + 0.5 * (look + chest), -0.06 * phone, 0.5 * lean + 0.4 * nod, R, 4)
    write_turn(g.yaw[i] + look, -0.15 * phone, nod, R, 5)


@kernel(inline=True)
def _hip_offset(head: Floats, b: int, R: Floats) -> Vector:
    """Return the hip joint relative to the pelvis joint."""
    x, y, z = head[b, 0] - head[0, 0], head[b, 1] - head[0, 1], head[b, 2] - head[0, 2]
    return (
        R[0, 0, 0] * x + R[0, 0, 1] * y + R[0, 0, 2] * z,
        R[0, 1, 0] * x + R[0, 1, 1] * y + R[0, 1, 2] * z,
        R[0, 2, 0] * x + R[0, 2, 1] * y + R[0, 2, 2] * z,
    )


@kernel
def _seated_ankle(
    g: Gaits, i: int, f: int, hip: float, lengths: Floats, size: Floats, seat: Floats
) -> tuple[float, float, float, float]:
    """Return ankle x, y, z [m] and pitch [rad] of foot ``f`` of a sitting person, on the foot rest or the floor."""
    side, thigh, shank = 1.0 - 2.0 * f, lengths[0], lengths[1]
    ahead, aside, pitch = seat[1] + thigh + 0.02, side * 0.11 * size[5], 0.0
    height = max(size[0], hip - shank * 0.995)
    if seat[4] > 0.0:
        x, z = ankle_over(-seat[3], -seat[3], size)
        x, z = seat[5] - size[3] + x, seat[7] + z
        if math.sqrt((x - seat[1]) ** 2 + (z - hip) ** 2) < 0.995 * (thigh + shank):
            ahead, aside, height, pitch = x, side * seat[6], z, -seat[3]
    c, s = math.cos(g.yaw[i]), math.sin(g.yaw[i])
    return g.position[i, 0] + c * ahead - s * aside, g.position[i, 1] + s * ahead + c * aside, height, pitch


@kernel
def _sit_down(foot: Foot, rest: tuple[float, float, float, float], sit: float) -> Foot:
    """Return a foot between its place in walking and that in sitting."""
    x, y, z = (
        foot[0] + sit * (rest[0] - foot[0]),
        foot[1] + sit * (rest[1] - foot[1]),
        foot[2] + sit * (rest[2] - foot[2]),
    )
    return x, y, z, foot[3], foot[4] + sit * (rest[3] - foot[4]), foot[5] + sit * (rest[3] - foot[5])


@kernel(inline=True)
def _leg_limit(hip: Vector, foot: Foot, x: float, y: float, longest: float) -> float:
    """Return the height [m] of the pelvis joint at which this leg has the length ``longest`` [m]."""
    dx, dy = foot[0] - x - hip[0], foot[1] - y - hip[1]
    return float(foot[2] + math.sqrt(max(longest**2 - dx * dx - dy * dy, (0.5 * longest) ** 2)) - hip[2])


@kernel(inline=True)
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


@kernel(inline=True)
def _lowest_height(left: float, right: float, tallest: float) -> float:
    """Return the height of the pelvis joint [m]: a smooth minimum of the reach of both legs and ``tallest`` [m]."""
    low = min(left, right, tallest)
    far = math.exp((low - left) / SOFT) + math.exp((low - right) / SOFT) + math.exp((low - tallest) / SOFT)
    return low - SOFT * math.log(far)


@kernel
def bend_leg(
    hip: Vector, ankle: Vector, thigh: float, shank: float, yaw: float, frame: Floats, f: int, R: Floats, bone: int
) -> None:
    """Write the rotations of thigh and shank that take the ankle to its place; the knee bends forward."""
    axis, far = normalize((ankle[0] - hip[0], ankle[1] - hip[1], ankle[2] - hip[2]))
    reach = min(max(far, abs(thigh - shank) + 0.05), 0.9999 * (thigh + shank))
    hinge, _ = normalize(cross_product((math.cos(yaw), math.sin(yaw), 0.2), axis))
    at_hip = math.acos(min(max((thigh**2 + reach**2 - shank**2) / (2.0 * thigh * reach), -1.0), 1.0))
    at_ankle = math.acos(min(max((shank**2 + reach**2 - thigh**2) / (2.0 * shank * reach), -1.0), 1.0))
    write_frame(frame, f, rotate(hinge, -at_hip, axis), hinge, R, bone)
    write_frame(frame, 2 + f, rotate(hinge, at_ankle, axis), hinge, R, bone + 1)


@kernel(inline=True)
def _pose_leg(
    hip: Vector, foot: Foot, thigh: float, shank: float, trunk: float, frame: Floats, f: int, R: Floats, P: Floats
) -> None:
    """Write the rotations of thigh, shank, foot and toes; ``hip`` is relative to the pelvis with yaw ``trunk``."""
    bone = 20 + 4 * f
    ahead = trunk + 0.5 * math.atan2(math.sin(foot[3] - trunk), math.cos(foot[3] - trunk))
    joint = hip[0] + P[0, 0], hip[1] + P[0, 1], hip[2] + P[0, 2]
    bend_leg(joint, (foot[0], foot[1], foot[2]), thigh, shank, ahead, frame, f, R, bone)
    write_turn(foot[3], 0.0, foot[4], R, bone + 2)
    write_turn(foot[3], 0.0, foot[5], R, bone + 3)


@kernel
def place_chain(first: int, last: int, head: Floats, parents: Ints, R: Floats, P: Floats) -> None:
    """Place bones ``first`` to ``last`` at the ends of their parents."""
    for b in range(first, last):
        p = parents[b]
        x, y, z = head[b, 0] - head[p, 0], head[b, 1] - head[p, 1], head[b, 2] - head[p, 2]
        for r in range(3):
            P[b, r] = P[p, r] + R[p, r, 0] * x + R[p, r, 1] * y + R[p, r, 2] * z


@kernel(inline=True)
def _pose_one(
    g: Gaits, i: int, lengths: Floats, head: Floats, frame: Floats, style: Floats, size: Floats, seat: Floats,
    parents: Ints, R: Floats, P: Floats,
) -> None:  # fmt: skip
    thigh, shank, stature = lengths[0], lengths[1], lengths[4]
    sit = smooth(g.blend[i, SITTING])
    time, support, lead, vigour = cycle(g.drift[i, 0], g.drift[i, 1], g.yaw[i], size[5], style[1])
    speed = math.sqrt(g.drift[i, 0] ** 2 + g.drift[i, 1] ** 2)
    _pose_trunk(g, i, vigour, style, sit, seat[2], R)
    hip_l, hip_r = _hip_offset(head, 20, R), _hip_offset(head, 24, R)
    sat = seat[0] + SEAT_FLESH * stature
    foot_l, foot_r = foot_now(g, i, 0, time, support, vigour, size), foot_now(g, i, 1, time, support, vigour, size)
    if sit > 0.0:
        foot_l = _sit_down(foot_l, _seated_ankle(g, i, 0, sat, lengths, size, seat), sit)
        foot_r = _sit_down(foot_r, _seated_ankle(g, i, 1, sat, lengths, size, seat), sit)
    sway = SWAY * size[5] * min(speed / 0.6, 1.0) * math.sin(2.0 * math.pi * g.phase[i] - 0.3)
    x = g.position[i, 0] - sway * math.sin(g.yaw[i]) + sit * seat[1] * math.cos(g.yaw[i])
    y = g.position[i, 1] + sway * math.cos(g.yaw[i]) + sit * seat[1] * math.sin(g.yaw[i])
    rest = 0.5 * (hip_l[2] + hip_r[2])
    tallest = _walking_height(g.phase[i], speed, lead * support * time * speed, vigour, thigh + shank, size) - rest
    longest = STRAIGHT * (thigh + shank)
    height = _lowest_height(_leg_limit(hip_l, foot_l, x, y, longest), _leg_limit(hip_r, foot_r, x, y, longest), tallest)
    P[0, 0], P[0, 1], P[0, 2] = x, y, height + sit * (sat - rest - height)
    _pose_leg(hip_l, foot_l, thigh, shank, g.yaw[i], frame, 0, R, P)
    _pose_leg(hip_r, foot_r, thigh, shank, g.yaw[i], frame, 1, R, P)
    place_chain(1, 8, head, parents, R, P)
    place_chain(13, 15, head, parents, R, P)
    for f in range(2):
        pose_arm(g, i, f, vigour, lengths, frame, style, seat, R, P)
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
