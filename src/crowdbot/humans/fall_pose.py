"""Postures of people who lose their balance.

A falling person tilts about the feet like an inverted pendulum, and takes protective postures on the way: hands ahead
of a forward fall, bent hips and knees in a backward fall, the near arm out in a sideways fall (Hsiao and Robinovitch
1998, doi:10.1016/S0021-9290(97)00114-0). The joint angles are assumed from the descriptions there.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from typing import NamedTuple

import numpy as np

from crowdbot.core import kernel, storable
from crowdbot.typing import Floats, Ints

from .asset import shapes
from .people import People
from .posture import Posture, place_chain
from .vectors import Vector, from_matrix, multiply, normalize, rotate, to_matrix, write_frame, write_turn

LYING = 0.5 * math.pi
"""Tilt [rad] of a lying person."""
PROTECTED = math.radians(50.0)
"""Tilt [rad] at which the protective posture is complete (assumed)."""
BLEND = math.radians(20.0)
"""Tilt [rad] over which the posture changes from that of the gait to that of the fall (assumed)."""
RAISED = math.radians(12.0)
"""Lean [rad] from which the arms of a standing person are raised completely (assumed)."""
HANGING, STRETCHED = 0.3, 1.2
"""Angle [rad] by which the toes of a falling person point down, and that of a person who lies face down (assumed)."""
UPPER = 20
"""Number of the first bone of the legs; those below are trunk, head and arms."""


@storable
class FallPose(NamedTuple):
    """How a person leans, falls or lies.

    Fields:
        direction: direction of the fall relative to the heading [rad]: 0 forward, pi / 2 to the left.
        tilt: angle [rad] from upright; :data:`LYING` on the floor.
        start: tilt [rad] at which the fall began.
        struck: whether the head reaches the floor; otherwise the neck holds it up.
        down: whether the whole body tilts; otherwise the person stands, and trunk and arms react.
        rising: whether the person gets up, on bent hips and knees.
    """

    direction: float
    tilt: float
    start: float
    struck: bool
    down: bool
    rising: bool = False


def blend_fall_poses(before: FallPose | None, after: FallPose | None, share: float) -> FallPose:
    """Return the pose at a share (0 to 1) between two instants, of which one may be upright (None).

    Raises:
        ValueError: both are None.

    >>> lying = FallPose(1.0, LYING, 0.4, True, True)
    >>> round(blend_fall_poses(None, lying, 0.5).tilt, 4), blend_fall_poses(lying, lying, 0.3) == lying
    (0.7854, True)
    """
    kind = before if after is None or (before is not None and before.down and not after.down) else after
    if kind is None:
        raise ValueError("one of two poses must be of a person out of balance")
    first, last = (0.0 if item is None else item.tilt for item in (before, after))
    direction = kind.direction
    if before is not None and after is not None and before.down == after.down:
        turn = after.direction - before.direction
        direction = before.direction + share * math.atan2(math.sin(turn), math.cos(turn))
    return kind._replace(direction=direction, tilt=first + share * (last - first))


# degrees: spine pitch and roll, neck pitch and roll, hips, knees, shoulder flexion (near, far side), abduction, elbows
FORWARD = (
    (10.0, 0.0, -25.0, 0.0, 15.0, 15.0, 45.0, 45.0, 95.0, 95.0, 15.0, 15.0, 25.0, 25.0),
    (0.0, 0.0, -40.0, 0.0, 0.0, 0.0, 0.0, 0.0, 165.0, 165.0, 30.0, 30.0, 20.0, 20.0),
)
BACKWARD = (
    (30.0, 0.0, 25.0, 0.0, 80.0, 80.0, 105.0, 105.0, -50.0, -50.0, 30.0, 30.0, 10.0, 10.0),
    (0.0, 0.0, 30.0, 0.0, 12.0, 8.0, 24.0, 16.0, 5.0, 5.0, 45.0, 45.0, 15.0, 15.0),
)
SIDEWAYS = (
    (15.0, 0.0, 10.0, 20.0, 50.0, 40.0, 90.0, 80.0, 25.0, 45.0, 75.0, 10.0, 10.0, 50.0),
    (10.0, 0.0, 5.0, 15.0, 40.0, 30.0, 60.0, 55.0, 95.0, 60.0, 0.0, 5.0, 50.0, 60.0),
)
CROUCH = (30.0, 0.0, -20.0, 0.0, 95.0, 95.0, 115.0, 115.0, 45.0, 45.0, 15.0, 15.0, 20.0, 20.0)
"""On the way up from the front and the side; from the back, people get up as they sit down (assumed)."""
STRUCK = {"forward": (0.0, 0.0), "backward": (-35.0, 0.0), "sideways": (0.0, -50.0)}
"""Neck pitch and roll [degrees] of a lying person whose head is on the floor."""


def joint_angles(pose: FallPose) -> Floats:
    """Return the joint angles ``[14]`` [rad] of a pose: spine, neck, hips, knees, shoulders and elbows.

    >>> lying = joint_angles(FallPose(0.0, LYING, 0.5, False, True))
    >>> np.degrees(lying[4:8]).round().tolist()
    [0.0, 0.0, 0.0, 0.0]
    """
    direction = pose.direction - roll_onto(pose)
    ahead, aside = math.cos(direction), math.sin(direction)
    weights = {"forward": max(ahead, 0.0) ** 2, "backward": max(-ahead, 0.0) ** 2, "sideways": aside**2}
    late = min(max((pose.tilt - PROTECTED) / (LYING - PROTECTED), 0.0), 1.0)
    early = min(pose.tilt / PROTECTED, 1.0)
    found = np.zeros(14)
    for (name, weight), (middle, end) in zip(weights.items(), (FORWARD, BACKWARD, SIDEWAYS), strict=True):
        last, middle = np.array(end), CROUCH if pose.rising and name != "backward" else middle  # noqa: PLW2901
        if pose.struck:
            last[2:4] = STRUCK[name]
        angles = early * ((1.0 - late) * np.array(middle) + late * last)
        if name == "sideways" and aside < 0.0:  # the near side is the right one
            angles[4:] = angles[4:].reshape(5, 2)[:, ::-1].ravel()
            angles[[1, 3]] *= -1.0
        found += weight * angles
    return np.radians(found)


def roll_onto(pose: FallPose) -> float:
    """Return the angle [rad] by which a falling person has turned about the own axis, towards the front, side or back.

    A body that falls between two of these directions lands on the nearer one.

    >>> [round(math.degrees(roll_onto(FallPose(math.radians(way), LYING, 0.4, False, True)))) for way in (30, 50, -170)]
    [30, -40, 10]
    """
    if not pose.down or pose.tilt <= PROTECTED:
        return 0.0
    quarter = 0.5 * math.pi
    rest = pose.direction - quarter * round(pose.direction / quarter)
    return rest * min((pose.tilt - PROTECTED) / (LYING - PROTECTED), 1.0)


@kernel(inline=True)
def _arm(q: Floats, side: int, frame: Floats, R: Floats) -> None:
    """Write the rotations of an arm relative to the chest."""
    sign, first = 1.0 - 2.0 * side, 7 + 7 * side
    flexion, abduction, elbow = q[8 + side], q[10 + side], q[12 + side]
    sf, cf, sa, ca = math.sin(flexion), math.cos(flexion), math.sin(abduction), math.cos(abduction)
    axis = (sf * ca, sign * sa, -cf * ca)
    # the elbow hinge of a hanging arm points to the right
    h: Vector = (0.0, -1.0, 0.0)
    dot = h[0] * axis[0] + h[1] * axis[1] + h[2] * axis[2]
    hinge, _ = normalize((h[0] - dot * axis[0], h[1] - dot * axis[1], h[2] - dot * axis[2]))
    write_frame(frame, 4 + side, axis, hinge, R, first)
    lower = rotate(hinge, elbow, axis)
    write_frame(frame, 6 + side, lower, hinge, R, first + 1)
    for bone in range(first + 2, first + 6):
        for r in range(3):
            for c in range(3):
                R[bone, r, c] = R[first + 1, r, c]


@kernel(inline=True)
def _leg(q: Floats, side: int, ankle: float, frame: Floats, R: Floats) -> None:
    """Write the rotations of a leg relative to the pelvis; ``ankle`` points the toes down [rad]."""
    first = UPPER + 4 * side
    hip, knee = q[4 + side], q[6 + side]
    hinge: Vector = (0.0, 1.0, 0.0)
    axis = (math.sin(hip), 0.0, -math.cos(hip))
    write_frame(frame, side, axis, hinge, R, first)
    lower = rotate(hinge, knee, axis)
    write_frame(frame, 2 + side, lower, hinge, R, first + 1)
    write_turn(0.0, 0.0, knee - hip + ankle, R, first + 2)
    write_turn(0.0, 0.0, knee - hip + ankle, R, first + 3)


@kernel
def _write_pose(
    q: Floats, yaw: float, direction: float, tilt: float, shares: Floats, frame: Floats, head: Floats, parents: Ints,
    R: Floats, P: Floats,
) -> None:  # fmt: skip
    """Blend the posture of one person with that of a fall; ``shares`` are those of the upper body and of the legs."""
    count = len(R)
    own, work, whole = np.zeros((count, 3, 3)), np.zeros((3, 3)), np.zeros((3, 3))
    ankle = HANGING + (STRETCHED - HANGING) * max(math.cos(direction), 0.0) * min(tilt / LYING, 1.0)
    write_turn(0.0, 0.0, 0.0, own, 0)
    for b in range(1, 4):
        write_turn(0.0, q[1] * b / 3.0, q[0] * b / 3.0, own, b)
    write_turn(0.0, q[1] + 0.5 * q[3], q[0] + 0.5 * q[2], own, 4)
    write_turn(0.0, q[1] + q[3], q[0] + q[2], own, 5)
    for side in range(2):
        _arm(q, side, frame, own)
        for bone in range(7 + 7 * side, 13 + 7 * side):  # relative to the chest
            multiply(own[3], own[bone], work)
            own[bone] = work
        own[6 + 7 * side] = own[3]
        _leg(q, side, ankle, frame, own)
    c, s, towards = math.cos(tilt), math.sin(tilt), yaw + direction
    x, y = -math.sin(towards), math.cos(towards)
    turn, lean = np.zeros((1, 3, 3)), np.zeros((3, 3))
    write_turn(yaw, 0.0, 0.0, turn, 0)
    lean[0, 0], lean[0, 1], lean[0, 2] = c + x * x * (1.0 - c), x * y * (1.0 - c), y * s
    lean[1, 0], lean[1, 1], lean[1, 2] = x * y * (1.0 - c), c + y * y * (1.0 - c), -x * s
    lean[2, 0], lean[2, 1], lean[2, 2] = -y * s, x * s, c
    multiply(lean, turn[0], whole)
    a, b4 = np.zeros(4), np.zeros(4)
    for bone in range(count):
        share = shares[0] if 0 < bone < UPPER else shares[1]
        if share <= 0.0:
            continue
        multiply(whole, own[bone], work)
        from_matrix(R[bone], a)
        from_matrix(work, b4)
        dot = a[0] * b4[0] + a[1] * b4[1] + a[2] * b4[2] + a[3] * b4[3]
        for k in range(4):
            a[k] = (1.0 - share) * a[k] + (share if dot >= 0.0 else -share) * b4[k]
        to_matrix(a, R[bone])
    place_chain(1, UPPER if shares[1] <= 0.0 else count, head, parents, R, P)


def fall_postures(posture: Posture, people: People, yaw: Floats, poses: Mapping[int, FallPose]) -> Posture:
    """Return the posture of people of whom some lean, fall or lie; their pelvis keeps its place above the floor plan.

    Args:
        posture: posture of N people by their gait.
        people: their bodies.
        yaw: headings ``[N]`` [rad].
        poses: pose by number of the person.

    >>> from crowdbot.humans import Gait
    >>> people = People.of(["man-20"])
    >>> gait = Gait(people)
    >>> upright = gait.posture(gait.start([[0.0, 0.0]], [0.0]))
    >>> lying = fall_postures(upright, people, np.zeros(1), {0: FallPose(0.0, LYING, 0.5, True, True)})
    >>> bool(upright.position[0, 5, 2] > 1.4), bool(lying.position[0, 5, 2] < 0.3), bool(lying.position[0, 5, 0] > 0.4)
    (True, True, True)
    """
    body, parents = people.measures, shapes().parents
    result = Posture(posture.rotation.copy(), posture.position.copy())
    for i, pose in poses.items():
        grown = min(max((pose.tilt - pose.start) / BLEND, 0.0), 1.0)
        share = grown * grown * (3.0 - 2.0 * grown)
        upper = min(1.0, pose.tilt / RAISED)
        shares = np.array([max(share, upper), share if pose.down else 0.0])
        rolled = roll_onto(pose)
        _write_pose(
            joint_angles(pose), float(yaw[i]) + rolled, pose.direction - rolled, pose.tilt, shares, body.frame[i],
            body.head[i], parents, result.rotation[i], result.position[i],
        )  # fmt: skip
    down = [i for i, pose in poses.items() if pose.down]
    if down:
        limbs = people.limbs(result)
        low = np.minimum(limbs.start[down, :, 2], limbs.end[down, :, 2]) - limbs.radius[down]
        result.position[down, :, 2] -= low.min(axis=1)[:, None]
    return result
