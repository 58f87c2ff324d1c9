"""Inverse kinematics: trunk, arms and legs of people whose head and hands are given.

The trunk leans and the pelvis sinks until the head is where it should be; legs keep the feet of the gait on the floor;
arms reach for the wrists with the elbows down and outwards. Bones keep their lengths. What is out of reach is reached
for. Without given parts, the posture of the gait stays.
"""

from __future__ import annotations

import math
from collections.abc import Mapping

import numpy as np

from crowdbot.core import kernel
from crowdbot.typing import Floats, Ints

from .asset import shapes
from .body_pose import PARTS
from .people import People
from .posture import Posture, place_chain
from .vectors import limit_rotation, multiply, to_matrix, transpose_times, twist_angle


@kernel
def cross(a: Floats, b: Floats, out: Floats) -> None:
    """Write ``a x b``."""
    out[0], out[1], out[2] = a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]


@kernel
def unit(a: Floats) -> float:
    """Normalise ``a`` in place and return its length; the zero vector becomes z."""
    length = math.sqrt(a[0] ** 2 + a[1] ** 2 + a[2] ** 2)
    if length < 1e-9:
        a[0], a[1], a[2] = 0.0, 0.0, 1.0
        return 0.0
    a[0], a[1], a[2] = a[0] / length, a[1] / length, a[2] / length
    return length


@kernel
def about(axis: Floats, angle: float, a: Floats, out: Floats) -> None:
    """Write ``a`` rotated by ``angle`` [rad] about the unit vector ``axis``."""
    c, s = math.cos(angle), math.sin(angle)
    dot = (axis[0] * a[0] + axis[1] * a[1] + axis[2] * a[2]) * (1.0 - c)
    x = c * a[0] + s * (axis[1] * a[2] - axis[2] * a[1]) + dot * axis[0]
    y = c * a[1] + s * (axis[2] * a[0] - axis[0] * a[2]) + dot * axis[1]
    z = c * a[2] + s * (axis[0] * a[1] - axis[1] * a[0]) + dot * axis[2]
    out[0], out[1], out[2] = x, y, z


@kernel
def align_frame(frame: Floats, axis: Floats, hinge: Floats, out: Floats) -> None:
    """Write the rotation from the rest frame (rows axis, hinge, cross product) to ``axis`` and ``hinge``."""
    for r in range(3):
        third = axis[(r + 1) % 3] * hinge[(r + 2) % 3] - axis[(r + 2) % 3] * hinge[(r + 1) % 3]
        for c in range(3):
            out[r, c] = axis[r] * frame[0, c] + hinge[r] * frame[1, c] + third * frame[2, c]


ROUNDS = 25
"""Number of corrections of the trunk; 10 reach 1 mm in most postures."""
LEAN = 1.3
"""Largest lean of the trunk [rad]."""
NECK = 1.4
"""Largest rotation of the head relative to the chest [rad]."""
DEEP = 0.3
"""Lowest height of the pelvis [leg lengths]."""
STRETCH = 0.998
"""Largest extension of arms and legs as a fraction of their length."""
FOLDED = math.radians(150.0)
"""Largest flexion of elbow and knee."""
TWIST, BEND = math.radians(160.0), math.radians(80.0)
"""Largest rotation of the hand about the forearm, shoulder included, and bend of the wrist."""
FOREARM = 0.5
"""Share of the rotation of the hand in that of the forearm."""
SHARES = np.array([0.25, 0.55, 0.8, 1.0])
"""Shares of pelvis and spine in the lean of the chest."""


def eye_offsets(people: People) -> Floats:
    """Return the middle between the eyes relative to the head joint of each person at rest ``[N, 3]`` [m].

    >>> eye_offsets(People.of(["man-20"])).round(2).tolist()
    [[0.09, 0.0, 0.04]]
    """
    return np.asarray(people.rows.eyes[people.body] * people.scale[:, None])


@kernel
def _highest_pelvis(head: Floats, feet: Floats, reach: float, R: Floats, P: Floats) -> float:
    """Return the largest height of the pelvis [m] at which both legs reach their feet."""
    highest_pelvis = 1e9
    for f in range(2):
        b = 20 + 4 * f
        hip = np.zeros(3)
        for r in range(3):
            for c in range(3):
                hip[r] += R[0, r, c] * (head[b, c] - head[0, c])
        dx, dy = P[0, 0] + hip[0] - feet[f, 0], P[0, 1] + hip[1] - feet[f, 1]
        tall = math.sqrt(max(reach * reach - dx * dx - dy * dy, 0.25 * reach * reach))
        highest_pelvis = min(highest_pelvis, feet[f, 2] + tall - hip[2])
    return highest_pelvis


@kernel
def _lean(goal: Floats, eye: Floats, head: Floats, leg: float, parents: Ints, R: Floats, P: Floats) -> None:
    """Write trunk, neck and head for the pose ``goal [7]`` of the eyes."""
    upright, feet, q = R.copy(), np.empty((2, 3)), np.empty(4)
    feet[0], feet[1] = P[22], P[26]
    look, turn, step = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    wx, wy, height = 0.0, 0.0, P[0, 2]
    for _ in range(ROUNDS):
        for b in range(4):
            q[0], q[1], q[2], q[3] = 1.0, 0.0, 0.0, 0.0
            angle = SHARES[b] * math.sqrt(wx * wx + wy * wy)
            if angle > 1e-12:
                s = math.sin(0.5 * angle) * SHARES[b] / angle
                q[0], q[1], q[2] = math.cos(0.5 * angle), wx * s, wy * s
            to_matrix(q, turn)
            multiply(turn, upright[b], R[b])
        to_matrix(goal[3:7], look)
        transpose_times(R[3], look, turn)
        limit_rotation(turn, 1.0, NECK, q)
        multiply(R[3], turn, R[5])
        limit_rotation(turn, 0.5, math.pi, q)
        multiply(R[3], turn, R[4])
        most = _highest_pelvis(head, feet, leg, R, P)
        height = min(max(height, DEEP * leg), most)
        P[0, 2] = height
        place_chain(1, 6, head, parents, R, P)
        for r in range(3):
            step[0, r] = goal[r] - P[5, r]
            for c in range(3):
                step[0, r] -= R[5, r, c] * eye[c]
        lever = max(P[5, 2] - P[0, 2], 0.25)
        wx, wy = wx - step[0, 1] / lever, wy + step[0, 0] / lever
        size = math.sqrt(wx * wx + wy * wy)
        if size > LEAN:
            wx, wy = wx * LEAN / size, wy * LEAN / size
        height += step[0, 2]
    for k in range(2):
        R[6 + 7 * k] = R[3]


@kernel
def _bend(
    root: Floats, goal: Floats, pole: Floats, other: Floats, upper: float, lower: float, axis: Floats, hinge: Floats
) -> float:
    """Write direction and hinge of the upper bone of a limb whose end is at ``goal``; return the flexion [rad].

    ``pole`` is the direction of elbow or knee, ``other [3, 3]`` has directions for the case that it is along the limb.
    """
    aim = np.empty(3)
    for r in range(3):
        aim[r] = goal[r] - root[r]
    least = math.sqrt(upper**2 + lower**2 + 2.0 * upper * lower * math.cos(FOLDED))
    reach = min(max(unit(aim), least), STRETCH * (upper + lower))
    cross(pole, aim, hinge)
    if math.sqrt(hinge[0] ** 2 + hinge[1] ** 2 + hinge[2] ** 2) < 1e-4:
        cross(other[:, 0], aim, hinge)
        if math.sqrt(hinge[0] ** 2 + hinge[1] ** 2 + hinge[2] ** 2) < 1e-4:
            cross(other[:, 1], aim, hinge)
    unit(hinge)
    at = math.acos(min(max((upper**2 + reach**2 - lower**2) / (2.0 * upper * reach), -1.0), 1.0))
    inner = math.acos(min(max((upper**2 + lower**2 - reach**2) / (2.0 * upper * lower), -1.0), 1.0))
    about(hinge, -at, aim, axis)
    return math.pi - inner


@kernel
def _stand(gait: Floats, feet: Floats, lengths: Floats, frame: Floats, R: Floats, P: Floats) -> None:
    """Write thighs and shanks for the feet of the gait; the knees bend forward."""
    axis, hinge, shank, pole = np.empty(3), np.empty(3), np.empty(3), np.empty(3)
    for f in range(2):
        b = 20 + 4 * f
        for r in range(3):
            pole[r] = gait[0, r, 0] + gait[b + 2, r, 0]
        pole[2] = 0.2
        unit(pole)
        knee = _bend(P[b], feet[f], pole, gait[0], lengths[0], lengths[1], axis, hinge)
        align_frame(frame[f], axis, hinge, R[b])
        about(hinge, knee, axis, shank)
        align_frame(frame[2 + f], shank, hinge, R[b + 1])


@kernel
def _reach_hand(
    side: int, goal: Floats, rest: Floats, lengths: Floats, frame: Floats, gait: Floats, R: Floats, P: Floats
) -> None:
    """Write upper arm, forearm, hand and fingers of one side for the pose ``goal [7]`` of the wrist."""
    first, out = 7 + 7 * side, 1.0 - 2.0 * side
    axis, hinge, lower, pole, q = np.empty(3), np.empty(3), np.empty(3), np.empty(3), np.empty(4)
    chest = R[3]
    up, far = 0.0, 0.0
    for r in range(3):
        up += chest[r, 2] * (goal[r] - P[first, r])
        far += (goal[r] - P[first, r]) ** 2
    raised = min(max(up / max(math.sqrt(far), 1e-6), 0.0), 1.0)
    for r in range(3):
        pole[r] = (0.9 * raised - 0.4) * chest[r, 0] + out * (0.45 + 0.4 * raised) * chest[r, 1] - chest[r, 2]
    elbow = _bend(P[first], goal, pole, chest, lengths[2], lengths[3], axis, hinge)
    align_frame(frame[4 + side], axis, hinge, R[first])
    about(hinge, elbow, axis, lower)
    align_frame(frame[6 + side], lower, hinge, R[first + 1])
    turn, bend, wish = np.empty((3, 3)), np.empty((3, 3)), np.empty((3, 3))
    to_matrix(goal[3:7], turn)
    for r in range(3):
        for c in range(3):
            wish[r, c] = turn[r, 0] * rest[c, 0] + turn[r, 1] * rest[c, 1] + turn[r, 2] * rest[c, 2]
    transpose_times(R[first + 1], wish, turn)
    along = frame[6 + side, 0]
    twist = min(max(twist_angle(turn, along, q), -TWIST), TWIST)
    full = twist_angle(turn, along, q)
    _rotation(along, -full, wish)
    multiply(turn, wish, bend)  # the rotation is first the twist, then the bend
    limit_rotation(bend, 1.0, BEND, q)
    _rotation(along, twist, wish)
    multiply(bend, wish, turn)
    multiply(R[first + 1], turn, R[first + 2])
    _rotation(along, FOREARM * twist, wish)
    multiply(R[first + 1], wish, bend)
    R[first + 1] = bend
    for b in range(first + 3, first + 6):
        transpose_times(gait[first + 2], gait[b], turn)
        multiply(R[first + 2], turn, R[b])


@kernel
def _rotation(axis: Floats, angle: float, out: Floats) -> None:
    """Write the rotation matrix about a unit vector."""
    q, s = np.empty(4), math.sin(0.5 * angle)
    q[0], q[1], q[2], q[3] = math.cos(0.5 * angle), s * axis[0], s * axis[1], s * axis[2]
    to_matrix(q, out)


@kernel
def _pose_skeleton(heading: float, bones: Floats, parents: Ints, R: Floats) -> None:
    """Write the rotations of all bones from those relative to their parents ``[28, 4]``."""
    base, own, up = np.empty((3, 3)), np.empty((3, 3)), np.zeros(3)
    up[2] = 1.0
    _rotation(up, heading, base)
    for b in range(len(bones)):
        to_matrix(bones[b], own)
        multiply(base if b == 0 else R[parents[b]], own, R[b])


@kernel
def _reach(
    row: Floats, eye: Floats, hands: Floats, lengths: Floats, head: Floats, frame: Floats, parents: Ints, R: Floats,
    P: Floats,
) -> None:  # fmt: skip
    """Change the posture of one person to the pose in a row, see :meth:`BodyPose.row`."""
    if not math.isnan(row[24]):
        _pose_skeleton(row[2], row[27:139].copy().reshape((28, 4)), parents, R)
        P[0] = row[24:27]
        place_chain(1, 28, head, parents, R, P)
        return
    gait, feet = R.copy(), np.empty((2, 3))
    feet[0], feet[1] = P[22], P[26]
    if not math.isnan(row[3]):
        _lean(row[3:10], eye, head, STRETCH * (lengths[0] + lengths[1]), parents, R, P)
        place_chain(1, 28, head, parents, R, P)
        _stand(gait, feet, lengths, frame, R, P)
        for side in range(2):  # hands that are not given hang from the leaning chest
            _follow_chest(7 + 7 * side, gait, R)
    for side in range(2):
        if not math.isnan(row[10 + 7 * side]):
            _reach_hand(side, row[10 + 7 * side : 17 + 7 * side], hands[side], lengths, frame, gait, R, P)
    place_chain(1, 28, head, parents, R, P)


@kernel
def _follow_chest(first: int, gait: Floats, R: Floats) -> None:
    """Keep the arm of the gait as seen from the pelvis, which leans less than the chest."""
    turn, arm = np.empty((3, 3)), np.empty((3, 3))
    for b in range(first, first + 6):
        transpose_times(gait[0], gait[b], turn)
        multiply(R[0], turn, arm)
        R[b] = arm


def reach_poses(posture: Posture, people: People, poses: Mapping[int, Floats]) -> Posture:
    """Return the posture in which some people have given poses of head, hands or the whole skeleton.

    Args:
        posture: posture of all people, from the gait.
        people: their bodies.
        poses: poses ``[139]`` by the index of the person, see :meth:`BodyPose.row`.

    >>> from crowdbot.humans import BodyPose, Gait
    >>> people = People.of(["man-20"])
    >>> gait = Gait(people)
    >>> standing = gait.posture(gait.start([[0.0, 0.0]], [0.0]))
    >>> pose = BodyPose(0.0, 0.0, 0.0, right_hand=(0.35, -0.2, 1.6, 1, 0, 0, 0))
    >>> reach_poses(standing, people, {0: pose.row()}).position[0, 16].round(3).tolist()
    [0.35, -0.2, 1.6]
    """
    body, parents, eyes = people.measures, shapes().parents, eye_offsets(people)
    result = Posture(posture.rotation.copy(), posture.position.copy())
    for k, row in poses.items():
        if all(np.isnan(row[first]) for first, _ in PARTS.values()):
            continue
        lengths = np.array([body.thigh[k], body.shank[k], body.arm[k, 0], body.arm[k, 1], body.height[k]])
        eye, hands = eyes[k], people.rows.hands[people.body[k]]
        _reach(
            row, eye, hands, lengths, body.head[k], body.frame[k], parents, result.rotation[k], result.position[k]
        )  # fmt: skip
    return result
