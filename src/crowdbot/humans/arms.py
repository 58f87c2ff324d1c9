"""Arm motion: swinging with the gait, talking, phoning, carrying a bottle, looking at a phone, or resting."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel

from .feet import Gaits
from .turns import about, align_frame, cross, unit

__all__ = ["pose_arm"]

Floats = NDArray[np.float64]
SWING = math.radians(17.0)
"""Amplitude of the upper arm swing at a vigour of 1 [rad]."""
FINGER_CURL = 0.25
"""Bend of each joint of idle fingers [rad]."""
LEFT, RIGHT = 0, 1


@kernel
def _arm_angles(g: Gaits, i: int, side: int, vigour: float, sit: float, style: Floats, out: Floats) -> None:
    """Write shoulder flexion and abduction, elbow flexion, inward turn of the upper arm, and hand twist [rad].

    The angles are the mean over the activities, weighted by the blend. Inverse kinematics handles the phone at the ear.
    """
    wave = math.cos(2.0 * math.pi * g.phase[i]) * (-1.0 if side == LEFT else 1.0)
    swing = SWING * min(vigour, 1.25) * style[2] * wave
    beat = style[6] * g.clock[i] + 6.283 * style[5] + 1.7 * side
    weight = g.blend[i]
    walk = weight[0] + weight[2]
    if side == LEFT:
        walk += weight[3]
    talk_elbow = 1.25 + 0.28 * math.sin(1.9 * beat + 1.0)
    rows = (
        (walk, 0.04 + swing, 0.10, 0.16 + style[8] + 0.55 * max(swing, 0.0), 0.05, 0.0),
        (weight[1], 0.28 + 0.14 * math.sin(beat), 0.14 + 0.05 * math.sin(0.7 * beat), talk_elbow,
         0.35 + 0.15 * math.sin(1.1 * beat), -0.5),
        (weight[3] if side == RIGHT else 0.0, 0.35, 0.12, 1.35, 0.35, 0.0),
        (weight[4], 0.40, 0.10, 1.60, 0.50, -0.6),
        (weight[5], 0.30, 0.10, 0.90, 0.25, 0.9),
    )  # fmt: skip
    for k in range(5):
        out[k] = 0.0
    for row in rows:
        for k in range(5):
            out[k] += row[0] * row[k + 1]


@kernel
def _arm_direction(angles: Floats, side: float, R: Floats, axis: Floats, hinge: Floats) -> None:
    """Write upper arm direction and elbow hinge in world coordinates; ``side`` is 1 for left, -1 for right."""
    sf, cf = math.sin(angles[0]), math.cos(angles[0])
    sa, ca = math.sin(angles[1]), math.cos(angles[1])
    ux, uy, uz = sf * ca, side * sa, -cf * ca
    # the elbow hinge of a hanging arm points to the right; turned inward, the forearm moves in front of the body
    hx, hy, hz = 0.0, -1.0, 0.0
    dot = hx * ux + hy * uy + hz * uz
    hx, hy, hz = hx - dot * ux, hy - dot * uy, hz - dot * uz
    for r in range(3):
        axis[r] = R[r, 0] * ux + R[r, 1] * uy + R[r, 2] * uz
        hinge[r] = R[r, 0] * hx + R[r, 1] * hy + R[r, 2] * hz
    unit(hinge)
    about(axis, side * angles[3], hinge, hinge)


@kernel
def _wrist_at_ear(head: Floats, turned: Floats, side: float, stature: float, goal: Floats, pole: Floats) -> None:
    """Write the wrist position with the hand at the ear, and the direction of the elbow."""
    ax, ay, az = 0.060 * stature, side * 0.060 * stature, -0.070 * stature
    for r in range(3):
        goal[r] = head[r] + turned[r, 0] * ax + turned[r, 1] * ay + turned[r, 2] * az
        pole[r] = 0.5 * turned[r, 0] + side * 0.45 * turned[r, 1] - 1.0 * turned[r, 2]


@kernel
def _wrist_on_rest(g: Gaits, i: int, side: float, seat: Floats, goal: Floats, pole: Floats) -> None:
    """Write the wrist position on the arm rest of a seat, and the direction of the elbow."""
    c, s = math.cos(g.yaw[i]), math.sin(g.yaw[i])
    goal[0] = g.position[i, 0] + c * seat[9] - s * side * seat[10]
    goal[1] = g.position[i, 1] + s * seat[9] + c * side * seat[10]
    goal[2] = seat[11]
    pole[0], pole[1], pole[2] = -0.7 * c - s * side * 0.35, -0.7 * s + c * side * 0.35, -0.7


@kernel
def _reach_wrist(
    shoulder: Floats, goal: Floats, pole: Floats, upper: float, lower: float, axis: Floats, hinge: Floats, aim: Floats
) -> float:
    """Write the arm directions for a wrist at ``goal`` (inverse kinematics); return the elbow flexion [rad]."""
    for r in range(3):
        aim[r] = goal[r] - shoulder[r]
    reach = min(max(unit(aim), abs(upper - lower) + 0.03), 0.995 * (upper + lower))
    cross(pole, aim, hinge)
    unit(hinge)
    at = math.acos(min(max((upper**2 + reach**2 - lower**2) / (2.0 * upper * reach), -1.0), 1.0))
    inner = math.acos(min(max((upper**2 + lower**2 - reach**2) / (2.0 * upper * lower), -1.0), 1.0))
    about(hinge, -at, aim, axis)
    return math.pi - inner


@kernel
def pose_arm(
    g: Gaits, i: int, side: int, vigour: float, sit: float, lengths: Floats, frame: Floats, style: Floats, seat: Floats,
    R: Floats, P: Floats, work: Floats,
) -> None:  # fmt: skip
    """Write the rotations of upper arm, forearm, hand and fingers of one side; requires trunk and shoulder joints."""
    sign = 1.0 - 2.0 * side
    first = 7 + 7 * side
    axis, hinge, axis2, hinge2, lower = work[2], work[3], work[4], work[5], work[6]
    angles = np.empty(5)
    _arm_angles(g, i, side, vigour, sit, style, angles)
    _arm_direction(angles, sign, R[3], axis, hinge)
    elbow, twist = angles[2], angles[4]
    phone = g.blend[i, 2] if side == RIGHT else 0.0
    resting = g.blend[i, 5] if seat[8] > 0.0 else 0.0
    most = max(phone, resting)
    if most > 1e-3:
        share = most * most * (3.0 - 2.0 * most)
        if phone >= resting:
            _wrist_at_ear(P[5], R[5], sign, lengths[4], work[0], work[1])
        else:
            _wrist_on_rest(g, i, sign, seat, work[0], work[1])
        bend = _reach_wrist(P[first], work[0], work[1], lengths[2], lengths[3], axis2, hinge2, work[7])
        for k in range(3):
            axis[k] += share * (axis2[k] - axis[k])
            hinge[k] += share * (hinge2[k] - hinge[k])
        unit(axis)
        dot = axis[0] * hinge[0] + axis[1] * hinge[1] + axis[2] * hinge[2]
        for k in range(3):
            hinge[k] -= dot * axis[k]
        unit(hinge)
        elbow += share * (bend - elbow)
        twist += share * ((0.3 if phone >= resting else 1.3) - twist)
    align_frame(frame[4 + side], axis, hinge, R[first])
    about(hinge, elbow, axis, lower)
    align_frame(frame[6 + side], lower, hinge, R[first + 1])
    about(lower, sign * 0.5 * twist, hinge, hinge2)
    align_frame(frame[6 + side], lower, hinge2, R[first + 1])
    about(lower, sign * twist, hinge, hinge2)
    align_frame(frame[6 + side], lower, hinge2, R[first + 2])
    cross(lower, hinge2, axis)
    unit(axis)
    busy = g.blend[i, 4] + (g.blend[i, 2] + g.blend[i, 3] if side == RIGHT else 0.0)
    curl = sign * (FINGER_CURL + 0.55 * busy)
    R[first + 5] = R[first + 2]
    for joint in range(2):
        about(axis, curl, lower, lower)
        about(axis, curl, hinge2, hinge2)
        align_frame(frame[6 + side], lower, hinge2, R[first + 3 + joint])
