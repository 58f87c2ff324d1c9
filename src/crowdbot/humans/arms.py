"""Arm motion: swinging with the gait, talking, phoning, carrying a bottle, looking at a phone, or resting."""

from __future__ import annotations

import math

from crowdbot.core import kernel
from crowdbot.typing import Floats

from .activities import FIRST_POSE
from .feet import Gaits
from .vectors import Vector, cross_product, normalize, rotate, write_frame

Angles = tuple[float, float, float, float, float]
SWING = math.radians(17.0)
"""Amplitude of the upper arm swing at a vigour of 1 [rad]."""
FINGER_CURL = 0.25
"""Bend of each joint of idle fingers [rad]."""
LEFT, RIGHT = 0, 1
CHEST, HEAD = 3, 5
"""Bones."""


@kernel(inline=True)
def _arm_angles(g: Gaits, i: int, side: int, vigour: float, style: Floats) -> Angles:
    """Return shoulder flexion and abduction, elbow flexion, inward turn of the upper arm, and hand twist [rad].

    The angles are the mean over the activities, weighted by the blend. Inverse kinematics handles the phone at the ear.
    """
    wave = math.cos(2.0 * math.pi * g.phase[i]) * (-1.0 if side == LEFT else 1.0)
    swing = SWING * min(vigour, 1.25) * style[2] * wave
    beat = style[6] * g.clock[i] + 6.283 * style[5] + 1.7 * side
    blend = g.blend
    walk = blend[i, 0] + blend[i, 2]
    for k in range(FIRST_POSE, blend.shape[1]):  # an arm without a task of its pose swings
        walk += blend[i, k]
    if side == LEFT:
        walk += blend[i, 3]
    talk_elbow = 1.25 + 0.28 * math.sin(1.9 * beat + 1.0)
    rows = (
        (walk, 0.04 + swing, 0.10, 0.16 + style[8] + 0.55 * max(swing, 0.0), 0.05, 0.0),
        (blend[i, 1], 0.28 + 0.14 * math.sin(beat), 0.14 + 0.05 * math.sin(0.7 * beat), talk_elbow,
         0.35 + 0.15 * math.sin(1.1 * beat), -0.5),
        (blend[i, 3] if side == RIGHT else 0.0, 0.35, 0.12, 1.35, 0.35, 0.0),
        (blend[i, 4], 0.40, 0.10, 1.60, 0.50, -0.6),
        (blend[i, 5], 0.30, 0.10, 0.90, 0.25, 0.9),
    )  # fmt: skip
    flexion, abduction, elbow, inward, twist = 0.0, 0.0, 0.0, 0.0, 0.0
    for row in rows:
        flexion += row[0] * row[1]
        abduction += row[0] * row[2]
        elbow += row[0] * row[3]
        inward += row[0] * row[4]
        twist += row[0] * row[5]
    return flexion, abduction, elbow, inward, twist


@kernel(inline=True)
def _arm_direction(flexion: float, abduction: float, inward: float, side: float, R: Floats) -> tuple[Vector, Vector]:
    """Return upper arm direction and elbow hinge in world coordinates; ``side`` is 1 for left, -1 for right."""
    sf, cf = math.sin(flexion), math.cos(flexion)
    sa, ca = math.sin(abduction), math.cos(abduction)
    ux, uy, uz = sf * ca, side * sa, -cf * ca
    # the elbow hinge of a hanging arm points to the right; turned inward, the forearm moves in front of the body
    hx, hy, hz = 0.0, -1.0, 0.0
    dot = hx * ux + hy * uy + hz * uz
    hx, hy, hz = hx - dot * ux, hy - dot * uy, hz - dot * uz
    axis = _turned(R, CHEST, ux, uy, uz)
    hinge, _ = normalize(_turned(R, CHEST, hx, hy, hz))
    return axis, rotate(axis, side * inward, hinge)


@kernel(inline=True)
def _turned(R: Floats, bone: int, x: float, y: float, z: float) -> Vector:
    """Return a vector of the frame of a bone in world coordinates."""
    return (
        R[bone, 0, 0] * x + R[bone, 0, 1] * y + R[bone, 0, 2] * z,
        R[bone, 1, 0] * x + R[bone, 1, 1] * y + R[bone, 1, 2] * z,
        R[bone, 2, 0] * x + R[bone, 2, 1] * y + R[bone, 2, 2] * z,
    )


@kernel
def _wrist_at_ear(side: float, stature: float, R: Floats, P: Floats) -> tuple[Vector, Vector]:
    """Return the wrist position with the hand at the ear, and the direction of the elbow."""
    ax, ay, az = 0.060 * stature, side * 0.060 * stature, -0.070 * stature
    goal = (
        P[HEAD, 0] + R[HEAD, 0, 0] * ax + R[HEAD, 0, 1] * ay + R[HEAD, 0, 2] * az,
        P[HEAD, 1] + R[HEAD, 1, 0] * ax + R[HEAD, 1, 1] * ay + R[HEAD, 1, 2] * az,
        P[HEAD, 2] + R[HEAD, 2, 0] * ax + R[HEAD, 2, 1] * ay + R[HEAD, 2, 2] * az,
    )
    pole = (
        0.5 * R[HEAD, 0, 0] + side * 0.45 * R[HEAD, 0, 1] - 1.0 * R[HEAD, 0, 2],
        0.5 * R[HEAD, 1, 0] + side * 0.45 * R[HEAD, 1, 1] - 1.0 * R[HEAD, 1, 2],
        0.5 * R[HEAD, 2, 0] + side * 0.45 * R[HEAD, 2, 1] - 1.0 * R[HEAD, 2, 2],
    )
    return goal, pole


@kernel
def _wrist_on_rest(g: Gaits, i: int, side: float, seat: Floats) -> tuple[Vector, Vector]:
    """Return the wrist position on the arm rest of a seat, and the direction of the elbow."""
    c, s = math.cos(g.yaw[i]), math.sin(g.yaw[i])
    x = g.position[i, 0] + c * seat[9] - s * side * seat[10]
    y = g.position[i, 1] + s * seat[9] + c * side * seat[10]
    return (x, y, seat[11]), (-0.7 * c - s * side * 0.35, -0.7 * s + c * side * 0.35, -0.7)


@kernel
def _reach_wrist(
    shoulder: Vector, goal: Vector, pole: Vector, upper: float, lower: float
) -> tuple[Vector, Vector, float]:
    """Return axis and hinge of the arm for a wrist at ``goal`` (inverse kinematics), and the elbow flexion [rad]."""
    aim, far = normalize((goal[0] - shoulder[0], goal[1] - shoulder[1], goal[2] - shoulder[2]))
    reach = min(max(far, abs(upper - lower) + 0.03), 0.995 * (upper + lower))
    hinge, _ = normalize(cross_product(pole, aim))
    at = math.acos(min(max((upper**2 + reach**2 - lower**2) / (2.0 * upper * reach), -1.0), 1.0))
    inner = math.acos(min(max((upper**2 + lower**2 - reach**2) / (2.0 * upper * lower), -1.0), 1.0))
    return rotate(hinge, -at, aim), hinge, math.pi - inner


@kernel(inline=True)
def _mix(a: Vector, b: Vector, share: float) -> Vector:
    """Return the vector between ``a`` (share 0) and ``b`` (share 1)."""
    return a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2])


@kernel(inline=True)
def pose_arm(
    g: Gaits, i: int, side: int, vigour: float, lengths: Floats, frame: Floats, style: Floats, seat: Floats,
    R: Floats, P: Floats,
) -> None:  # fmt: skip
    """Write the rotations of upper arm, forearm, hand and fingers of one side; requires trunk and shoulder joints."""
    sign = 1.0 - 2.0 * side
    first = 7 + 7 * side
    flexion, abduction, elbow, inward, twist = _arm_angles(g, i, side, vigour, style)
    axis, hinge = _arm_direction(flexion, abduction, inward, sign, R)
    phone = g.blend[i, 2] if side == RIGHT else 0.0
    resting = g.blend[i, 5] if seat[8] > 0.0 else 0.0
    most = max(phone, resting)
    if most > 1e-3:
        share = most * most * (3.0 - 2.0 * most)
        at_ear = phone >= resting
        goal, pole = _wrist_at_ear(sign, lengths[4], R, P) if at_ear else _wrist_on_rest(g, i, sign, seat)
        shoulder = P[first, 0], P[first, 1], P[first, 2]
        axis2, hinge2, bend = _reach_wrist(shoulder, goal, pole, lengths[2], lengths[3])
        axis, _ = normalize(_mix(axis, axis2, share))
        hinge = _mix(hinge, hinge2, share)
        dot = axis[0] * hinge[0] + axis[1] * hinge[1] + axis[2] * hinge[2]
        hinge, _ = normalize((hinge[0] - dot * axis[0], hinge[1] - dot * axis[1], hinge[2] - dot * axis[2]))
        elbow += share * (bend - elbow)
        twist += share * ((0.3 if at_ear else 1.3) - twist)
    write_frame(frame, 4 + side, axis, hinge, R, first)
    lower = rotate(hinge, elbow, axis)
    write_frame(frame, 6 + side, lower, rotate(lower, sign * 0.5 * twist, hinge), R, first + 1)
    hinge = rotate(lower, sign * twist, hinge)
    write_frame(frame, 6 + side, lower, hinge, R, first + 2)
    _pose_fingers(g, i, side, lower, hinge, frame, R)


@kernel(inline=True)
def _pose_fingers(g: Gaits, i: int, side: int, lower: Vector, hinge: Vector, frame: Floats, R: Floats) -> None:
    """Write the rotations of fingers and thumb for a hand with these directions."""
    sign = 1.0 - 2.0 * side
    first = 7 + 7 * side
    axis, _ = normalize(cross_product(lower, hinge))
    busy = g.blend[i, 4] + (g.blend[i, 2] + g.blend[i, 3] if side == RIGHT else 0.0)
    curl = sign * (FINGER_CURL + 0.55 * busy)
    for r in range(3):
        for c in range(3):
            R[first + 5, r, c] = R[first + 2, r, c]
    for joint in range(2):
        lower = rotate(axis, curl, lower)
        hinge = rotate(axis, curl, hinge)
        write_frame(frame, 6 + side, lower, hinge, R, first + 3 + joint)
