"""Motion of a captured skeleton on the body of a person: skeletons, rotations, retargeting and feet."""

from __future__ import annotations

import math
import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from crowdbot.core import InputError
from crowdbot.humans import BodyPose, RestSkeleton
from crowdbot.typing import Floats


def to_matrices(quaternions: Floats) -> Floats:
    """Return the rotation matrices ``[..., 3, 3]`` of unit quaternions ``[..., 4]``."""
    w, x, y, z = np.moveaxis(quaternions, -1, 0)
    rows = [
        [1.0 - 2.0 * (y * y + z * z), 2.0 * (x * y - w * z), 2.0 * (x * z + w * y)],
        [2.0 * (x * y + w * z), 1.0 - 2.0 * (x * x + z * z), 2.0 * (y * z - w * x)],
        [2.0 * (x * z - w * y), 2.0 * (y * z + w * x), 1.0 - 2.0 * (x * x + y * y)],
    ]
    return np.moveaxis(np.array(rows), (0, 1), (-2, -1))


def to_quaternions(matrices: Floats) -> Floats:
    """Return unit quaternions ``[..., 4]`` of rotation matrices ``[..., 3, 3]``, with w at least 0.

    Source: Bar-Itzhack 2000, doi:10.2514/2.4654 (the sign-safe form of Shepperd 1978).

    >>> to_quaternions(rotate_about([0.0, 0.0, 1.0], math.pi)).round(6).tolist()
    [0.0, 0.0, 0.0, 1.0]
    """
    m = np.asarray(matrices, dtype=np.float64)
    a, b, c = m[..., 0, 0], m[..., 1, 1], m[..., 2, 2]
    squares = np.stack([1.0 + a + b + c, 1.0 + a - b - c, 1.0 - a + b - c, 1.0 - a - b + c], axis=-1)
    yz, zx, xy = m[..., 2, 1] - m[..., 1, 2], m[..., 0, 2] - m[..., 2, 0], m[..., 1, 0] - m[..., 0, 1]
    p, q, r = m[..., 1, 0] + m[..., 0, 1], m[..., 0, 2] + m[..., 2, 0], m[..., 2, 1] + m[..., 1, 2]
    w2, x2, y2, z2 = np.moveaxis(squares, -1, 0)
    columns = [[w2, yz, zx, xy], [yz, x2, p, q], [zx, p, y2, r], [xy, q, r, z2]]
    table = np.moveaxis(np.array(columns), (0, 1), (-2, -1))
    largest = np.argmax(squares, axis=-1)
    found = np.take_along_axis(table, largest[..., None, None], axis=-2)[..., 0, :]
    found = found / np.linalg.norm(found, axis=-1, keepdims=True)
    return np.asarray(np.where(found[..., :1] < 0.0, -found, found))


def rotate_about(axis: Floats | list[float], angle: float) -> Floats:
    """Return the rotation matrix about a unit vector by an angle [rad]."""
    half = math.sin(0.5 * angle)
    return to_matrices(np.array([math.cos(0.5 * angle), *(half * float(item) for item in axis)]))


def align_vectors(first: Floats, second: Floats) -> Floats:
    """Return the smallest rotation matrix that turns the direction of one vector into that of another.

    >>> align_vectors(np.array([2.0, 0, 0]), np.array([0, 0.5, 0])).round(6).tolist()[0]
    [0.0, -1.0, 0.0]
    """
    a, b = first / np.linalg.norm(first), second / np.linalg.norm(second)
    w = 1.0 + float(a @ b)
    if w < 1e-9:  # opposite: half a turn about any axis across
        across = np.cross(a, np.eye(3)[int(np.argmin(np.abs(a)))])
        return rotate_about(across / np.linalg.norm(across), math.pi)
    quaternion = np.array([w, *np.cross(a, b)])
    return to_matrices(quaternion / np.linalg.norm(quaternion))


def normalize(quaternions: Floats) -> Floats | None:
    """Return quaternions ``[..., 4]`` with unit length, None if one is not finite or its length is not near 1.

    >>> normalize(np.array([2.0, 0, 0, 0])) is None
    True
    """
    size = np.linalg.norm(quaternions, axis=-1, keepdims=True)
    if not np.all(np.abs(size - 1.0) < 0.1):
        return None
    return np.asarray(quaternions / size)


def yaw_of(matrix: Floats) -> float:
    """Return the heading of a rotation matrix: the direction of its x axis on the floor [rad].

    For a body whose x axis is within 6 degrees of the vertical, it is a quarter turn less than that of the y axis.
    """
    x, y = float(matrix[0, 0]), float(matrix[1, 0])
    if math.hypot(x, y) < 0.1:
        return math.atan2(-float(matrix[0, 1]), float(matrix[1, 1]))
    return math.atan2(y, x)


MOST_JOINTS = 300
HAND, FOOT = ("hand", "wrist"), ("foot", "ankle")
LEGS = (0.25, 1.6)
"""Shortest and longest leg of a person from hip to ankle [m]."""


@dataclass(frozen=True, eq=False)
class SourceSkeleton:
    """Joints of an actor in the rest pose: x forward, y left, z up, standing upright on the floor.

    Limbs are found from the names of hands, feet and head and from the hierarchy: the parent of a hand is a forearm,
    and so on. Names can have a prefix (``Anna:LeftHand``) and twist or roll bones are skipped.

    Fields:
        names: names of the joints.
        parents: index of the parent of each joint, -1 for the root; parents come first.
        rest: positions of the joints in the rest pose ``[J, 3]`` [m].

    Raises:
        InputError: there are no two hands, two feet and a head, or a leg is not 0.25 m to 1.6 m long.

    >>> from crowdbot.bridges.motion_capture.xsens import xsens_skeleton
    >>> skeleton = xsens_skeleton()
    >>> skeleton.names[skeleton.roles["thigh_l"]], [skeleton.names[k] for k in skeleton.spine]
    ('LeftUpperLeg', ['L5', 'L3', 'T12', 'T8'])
    """

    names: tuple[str, ...]
    parents: tuple[int, ...]
    rest: Floats

    def __post_init__(self) -> None:
        roles: dict[str, int] = {}
        for side, word in (("l", "left"), ("r", "right")):
            roles |= self._limb(side, word, HAND, ("hand", "lowerarm", "upperarm"))
            roles |= self._limb(side, word, FOOT, ("foot", "calf", "thigh"))
        head = [k for k, name in enumerate(self.names) if plain_name(name) == "head"]
        if not head:
            raise InputError(f"a skeleton has no joint named head; it has {', '.join(self.names)[:300]}")
        roles["head"] = head[0]
        pelvis = self._common(roles["thigh_l"], roles["thigh_r"])
        chest = self._common(roles["upperarm_l"], roles["upperarm_r"])
        object.__setattr__(self, "_roles", roles | {"pelvis": pelvis, "chest": chest} | self._extras(roles, chest))
        object.__setattr__(self, "_spine", self._path(chest, pelvis))
        for side in "lr":
            if not LEGS[0] <= self.leg_length(side) <= LEGS[1]:
                raise InputError(
                    f"a leg of a skeleton is {self.leg_length(side):.3g} m long; check the unit and the rest pose"
                )

    @property
    def roles(self) -> dict[str, int]:
        """Index of the joint of ``pelvis``, ``chest``, ``head``, ``hand_l`` and so on."""
        result: dict[str, int] = self._roles  # type: ignore[attr-defined]
        return result

    @property
    def spine(self) -> tuple[int, ...]:
        """Joints above the pelvis up to the chest, from below; empty if arms start at the pelvis."""
        result: tuple[int, ...] = self._spine  # type: ignore[attr-defined]
        return result

    def leg_length(self, side: str) -> float:
        """Return the length of the leg from hip to ankle of a side, ``l`` or ``r`` [m]."""
        hip, knee, ankle = (self.rest[self.roles[f"{name}_{side}"]] for name in ("thigh", "calf", "foot"))
        return float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))

    def child_direction(self, role: str) -> Floats | None:
        """Return the direction from a joint to its children in the rest pose; None without children."""
        k = self.roles[role]
        ends = [self.rest[c] for c, parent in enumerate(self.parents) if parent == k]
        way = np.mean(ends, axis=0) - self.rest[k] if ends else np.zeros(3)
        return way if float(np.linalg.norm(way)) > 1e-3 else None

    def _limb(self, side: str, word: str, ends: tuple[str, ...], roles: Sequence[str]) -> dict[str, int]:
        wanted = {f"{a}{b}" for end in ends for a, b in ((word, end), (side, end), (end, word), (end, side))}
        found = [k for k, name in enumerate(self.names) if plain_name(name) in wanted]
        if not found:
            raise InputError(f"a skeleton has no joint such as {word.title()}{ends[0].title()}; "
                             f"it has {', '.join(self.names)[:300]}")  # fmt: skip
        chain = [found[0]]
        while len(chain) < 3:
            above = self.parents[chain[-1]]
            while above >= 0 and re.search("roll|twist", plain_name(self.names[above])):
                above = self.parents[above]
            if above < 0:
                raise InputError(f"joint {self.names[found[0]]!r} of a skeleton has not two parents")
            chain.append(above)
        return {f"{role}_{side}": k for role, k in zip(roles, chain, strict=True)}

    def _extras(self, roles: dict[str, int], chest: int) -> dict[str, int]:
        """Return the neck, collar bones and toes, where they are."""
        extras: dict[str, int] = {}
        neck = self.parents[roles["head"]]
        if neck not in (-1, chest):
            extras["neck"] = neck
        for side in "lr":
            collar = self.parents[roles[f"upperarm_{side}"]]
            if collar not in (-1, chest):
                extras[f"clavicle_{side}"] = collar
            toes = [c for c, parent in enumerate(self.parents) if parent == roles[f"foot_{side}"]]
            if toes and "end" not in plain_name(self.names[toes[0]]):
                extras[f"ball_{side}"] = toes[0]
        return extras

    def _line(self, k: int) -> list[int]:
        line = [k]
        while self.parents[line[-1]] >= 0:
            line.append(self.parents[line[-1]])
        return line

    def _common(self, a: int, b: int) -> int:
        """Return the lowest joint above both."""
        above = set(self._line(b)[1:])
        for k in self._line(a)[1:]:
            if k in above:
                return k
        raise InputError(f"joints {self.names[a]!r} and {self.names[b]!r} of a skeleton are not connected")

    def _path(self, top: int, bottom: int) -> tuple[int, ...]:
        """Return the joints from above the bottom to the top; none if the top is not above it."""
        line = self._line(top)
        return tuple(reversed(line[: line.index(bottom)])) if bottom in line else ()


def plain_name(name: str) -> str:
    """Return a joint name in lower case without name space and punctuation.

    >>> plain_name("mixamorig:Left_Hand")
    'lefthand'
    """
    return re.sub(r"[^a-z0-9]", "", name.rsplit(":", maxsplit=1)[-1].lower())


def body_axes(names: Sequence[str], parents: Sequence[int], rest: Floats) -> Floats:
    """Return the matrix from the axes of a source to x forward, y left, z up, found from its rest pose.

    Args:
        names, parents: see :class:`SourceSkeleton`.
        rest: positions in the rest pose in any right-handed frame and unit ``[J, 3]``.

    Raises:
        InputError: limbs are not found, or the rest pose does not stand.

    >>> from crowdbot.bridges.motion_capture.xsens import xsens_skeleton
    >>> z_up = xsens_skeleton()
    >>> body_axes(z_up.names, z_up.parents, z_up.rest[:, [1, 2, 0]] * 100.0).round().astype(int).tolist()
    [[0, 0, 1], [1, 0, 0], [0, 1, 0]]
    """
    size = float(np.linalg.norm(np.ptp(rest, axis=0)))
    if not 0.0 < size < float("inf"):
        raise InputError("a skeleton has no extent in the rest pose")
    source_skeleton = SourceSkeleton(tuple(names), tuple(parents), rest * (1.9 / size))
    left = (
        source_skeleton.rest[source_skeleton.roles["thigh_l"]] - source_skeleton.rest[source_skeleton.roles["thigh_r"]]
    )
    up = source_skeleton.rest[source_skeleton.roles["head"]] - source_skeleton.rest[source_skeleton.roles["pelvis"]]
    y, z = (np.sign(item) * (np.arange(3) == int(np.argmax(np.abs(item)))) for item in (left, up))
    if float(y @ z) != 0.0 or not np.any(left) or not np.any(up):
        raise InputError("a skeleton does not stand in the rest pose: its hips are not beside each other")
    return np.stack([np.cross(y, z), y, z])


DIGITS = 6
"""Decimals of positions [m] and quaternions: an order with all bones stays below 1.5 kB."""


class Retargeting:
    """Transfers rotations of segments to the bones of a person.

    Each bone gets the rotation of its segment, after a constant rotation that brings it from the rest shape of the body
    (arms 45 degrees down) to the rest pose of the source (usually a T-pose with the palms down). The hips follow those
    of the actor on the floor. Their height above the ankles is scaled by the ratio of the lengths of the legs, so that
    feet which stand on the floor stand on it afterwards.

    Args:
        source: joints of the actor.
        body: bones of the person.
    """

    def __init__(self, source: SourceSkeleton, body: RestSkeleton) -> None:
        self.source, self.body = source, body
        self.scale = sum(_leg(body, s) / source.leg_length(s) for s in "lr") / 2.0
        """Ratio of the lengths of the legs, person to actor."""
        self._joint = np.array([self._joint_of(name) for name in body.names])
        self._offset = self._rest_rotations()
        self._hips = [source.roles["thigh_l"], source.roles["thigh_r"]]
        self._soles = float(np.mean([source.rest[source.roles[f"foot_{s}"], 2] for s in "lr"]))
        heads = [body.head[body.bone(f"thigh_{s}")] for s in "lr"]
        self._hip_offset = np.mean(heads, axis=0) - body.head[0]
        self._ankle = float(np.mean([body.head[body.bone(f"foot_{s}"), 2] for s in "lr"]))

    def pose(self, position: Floats, rotation: Floats) -> BodyPose:
        """Return the pose of the person.

        Args:
            position: positions of the joints of the actor ``[J, 3]`` [m]; z is up, the floor at 0.
            rotation: rotations of the segments relative to the rest pose ``[J, 3, 3]``.
        """
        whole, pelvis = self.place(position, rotation)
        return self.whole_pose(whole, pelvis, yaw_of(rotation[self.source.roles["pelvis"]]))

    def place(self, position: Floats, rotation: Floats) -> tuple[Floats, Floats]:
        """Return the rotations of all bones ``[28, 3, 3]`` and the place of the pelvis joint [m]."""
        whole = rotation[self._joint] @ self._offset
        hips = position[self._hips].mean(axis=0)
        hips[2] = self._ankle + self.scale * (hips[2] - self._soles)
        return whole, hips - whole[0] @ self._hip_offset

    def foot_height(self, position: Floats, side: str) -> float:
        """Return the height [m] of an ankle of the actor above its place in standing."""
        return float(position[self.source.roles[f"foot_{side}"], 2]) - self._soles

    def whole_pose(self, whole: Floats, pelvis: Floats, heading: float) -> BodyPose:
        """Return the pose with given rotations of all bones, place of the pelvis joint [m] and heading [rad]."""
        parents = np.array(self.body.parents)
        above = whole[np.maximum(parents, 0)]
        above[0] = rotate_about([0.0, 0.0, 1.0], heading)
        bones = to_quaternions(np.swapaxes(above, -1, -2) @ whole)
        x, y, z = (round(float(item), DIGITS) for item in pelvis)
        numbers = [x, y, z, *(round(item, DIGITS) for item in bones.ravel().tolist())]
        return BodyPose(x, y, round(heading, DIGITS), skeleton=tuple(numbers))

    def _joint_of(self, bone: str) -> int:
        """Return the joint of the source that moves a bone."""
        roles, spine = self.source.roles, self.source.spine
        if bone.startswith("spine"):
            if not spine:
                return roles["pelvis"]
            return spine[max(0, round(int(bone[-1]) * len(spine) / 3.0) - 1)]
        if bone == "neck_01":
            return roles.get("neck", roles["chest"])
        if bone.startswith(("fingers", "thumb")):
            return roles[f"hand_{bone[-1]}"]
        other = {"clavicle": roles["chest"], "ball": roles[f"foot_{bone[-1]}"] if bone[-2] == "_" else 0}
        return roles[bone] if bone in roles else other[bone.split("_", maxsplit=1)[0]]

    def _rest_rotations(self) -> Floats:
        """Return the rotation of each bone from the rest shape of the body to the rest pose of the source."""
        rest_rotations = np.tile(np.eye(3), (len(self.body.names), 1, 1))
        for k, side in enumerate("lr"):
            for upper, lower, end in (("upperarm", "lowerarm", "hand"), ("thigh", "calf", "foot")):
                turn = self._aligned(np.eye(3), f"{upper}_{side}", f"{lower}_{side}")
                rest_rotations[self.body.bone(f"{upper}_{side}")] = turn
                rest_rotations[self.body.bone(f"{lower}_{side}")] = self._aligned(
                    turn, f"{lower}_{side}", f"{end}_{side}"
                )
            self._turn_hand(rest_rotations, k, side)
        return rest_rotations

    def _aligned(self, turn: Floats, bone: str, end: str) -> Floats:
        """Return a rotation, changed as little as possible so that a bone points along its segment."""
        ours = turn @ (self.body.head[self.body.bone(end)] - self.body.head[self.body.bone(bone)])
        theirs = self.source.rest[self.source.roles[end]] - self.source.rest[self.source.roles[bone]]
        return align_vectors(ours, theirs) @ turn if float(np.linalg.norm(theirs)) > 1e-3 else turn

    def _turn_hand(self, found: Floats, k: int, side: str) -> None:
        """Bring the hand to the rest pose: palms down if the arms are raised to the side, inwards if they hang.

        The forearm takes half of the twist, as that of a person does.
        """
        roles, rest = self.source.roles, self.source.rest
        arm = rest[roles[f"hand_{side}"]] - rest[roles[f"lowerarm_{side}"]]
        along = self.source.child_direction(f"hand_{side}")
        along = arm if along is None else along
        out = np.array([0.0, 1.0 if side == "l" else -1.0, 0.0])
        up = np.array([0.0, 0.0, 1.0])
        flat = np.stack([out, np.cross(up, out), up], axis=-1)
        hand = align_vectors(out, along) @ flat @ self.body.hands[k].T
        forearm = found[self.body.bone(f"lowerarm_{side}")]
        axis = arm / np.linalg.norm(arm)
        twist = to_quaternions(hand @ forearm.T)
        angle = 2.0 * math.atan2(float(twist[1:] @ axis), float(twist[0]))
        found[self.body.bone(f"lowerarm_{side}")] = rotate_about(axis, 0.5 * angle) @ forearm
        for name in ("hand", "fingers_01", "fingers_02", "thumb"):
            found[self.body.bone(f"{name}_{side}")] = hand


def _leg(body: RestSkeleton, side: str) -> float:
    hip, knee, ankle = (body.head[body.bone(f"{name}_{side}")] for name in ("thigh", "calf", "foot"))
    return float(np.linalg.norm(knee - hip) + np.linalg.norm(ankle - knee))


LIFTED = 0.05
"""Height of the ankle of the actor [m] above its place in standing from which on the foot is in the air."""
MOVING = 0.3
"""Horizontal speed of the ankle of the actor [m/s] from which on the foot is moving."""
RELEASE = 0.08
"""Time constant [s] with which a foot that is lifted returns to its place in the pose of the actor."""
PAUSE = 0.5
"""Interval [s] between two samples above which the feet start anew."""
REACH = 0.999
"""Largest part of the length of the leg between hip and ankle."""
KEPT = 4
"""Number of samples whose poses are kept, since a recording gives samples twice."""


class FootLock:
    """Retargets samples of a person one after the other, and holds each planted foot where it was put down.

    A foot of the actor that is low and slow is planted. As long as it is, the ankle of the person stays at its place on
    the floor; the knee bends or the hips come down for that. Afterwards the foot returns to the pose of the actor.

    Args:
        retargeting: actor and person.
    """

    def __init__(self, retargeting: Retargeting) -> None:
        self.retargeting = retargeting
        self._held: dict[str, Floats | None] = {"l": None, "r": None}
        self._shift = {side: np.zeros(2) for side in "lr"}
        self._before: tuple[float, Floats] | None = None
        self._poses: dict[int, BodyPose] = {}
        body = retargeting.body
        self._legs = {s: [body.bone(f"{name}_{s}") for name in ("thigh", "calf", "foot")] for s in "lr"}

    def pose(self, number: int, time: float, position: Floats, rotation: Floats) -> BodyPose:
        """Return the pose of the person.

        Args:
            number: number of the sample; numbers increase.
            time: time stamp of the sample [s].
            position, rotation: as for :meth:`Retargeting.pose`.
        """
        known = self._poses.get(number)
        if known is not None:
            return known
        whole, pelvis = self.retargeting.place(position, rotation)
        whole = whole.copy()
        targets = self._targets(time, position, whole, pelvis)
        pelvis = pelvis - [0.0, 0.0, max(self._drop(side, whole, pelvis, targets[side]) for side in "lr")]
        for side, target in targets.items():
            self._reach(side, whole, pelvis, target)
        body_pose = self.retargeting.whole_pose(
            whole, pelvis, yaw_of(rotation[self.retargeting.source.roles["pelvis"]])
        )
        self._poses[number] = body_pose
        while len(self._poses) > KEPT:
            del self._poses[next(iter(self._poses))]
        return body_pose

    def _targets(self, time: float, position: Floats, whole: Floats, pelvis: Floats) -> dict[str, Floats]:
        """Return where the ankles are to be [m]."""
        roles, targets = self.retargeting.source.roles, {}
        feet = np.array([position[roles[f"foot_{side}"], :2] for side in "lr"])
        step = math.inf if self._before is None else time - self._before[0]
        fresh = not 0.0 < step <= PAUSE
        speeds = np.zeros(2) if fresh or self._before is None else np.hypot(*(feet - self._before[1]).T) / step
        for k, side in enumerate("lr"):
            ankle = self._ankle(side, whole, pelvis)
            if fresh:
                self._held[side], self._shift[side] = None, np.zeros(2)
            planted = self.retargeting.foot_height(position, side) < LIFTED and speeds[k] < MOVING
            held = self._held[side]
            if planted and held is None:
                held = self._held[side] = ankle[:2] + self._shift[side]
            elif not planted:
                held = self._held[side] = None
                self._shift[side] = self._shift[side] * math.exp(-(0.0 if fresh else step) / RELEASE)
            if held is not None:
                self._shift[side] = held - ankle[:2]
            targets[side] = ankle + [*self._shift[side], 0.0]
        self._before = (time, feet)
        return targets

    def _vectors(self, side: str) -> tuple[Floats, Floats, Floats]:
        """Return pelvis to hip, hip to knee, knee to ankle in the rest shape."""
        head, (hip, knee, ankle) = self.retargeting.body.head, self._legs[side]
        return head[hip] - head[0], head[knee] - head[hip], head[ankle] - head[knee]

    def _ankle(self, side: str, whole: Floats, pelvis: Floats) -> Floats:
        thigh, calf, _ = self._legs[side]
        hip, upper, lower = self._vectors(side)
        return np.asarray(pelvis + whole[0] @ hip + whole[thigh] @ upper + whole[calf] @ lower)

    def _drop(self, side: str, whole: Floats, pelvis: Floats, target: Floats) -> float:
        """Return how far the hips must come down [m] so that an ankle is in reach."""
        hip, upper, lower = self._vectors(side)
        reach = REACH * float(np.linalg.norm(upper) + np.linalg.norm(lower))
        away = pelvis + whole[0] @ hip - target
        flat = min(float(np.hypot(*away[:2])), reach)
        return max(0.0, float(away[2]) - math.sqrt(reach**2 - flat**2)) if np.any(self._shift[side]) else 0.0

    def _reach(self, side: str, whole: Floats, pelvis: Floats, target: Floats) -> None:
        """Turn thigh and calf so that the ankle is at a place, with the knee in its plane; the foot keeps its turn."""
        thigh, calf, _ = self._legs[side]
        hip, upper, lower = self._vectors(side)
        knee, shank = whole[thigh] @ upper, whole[calf] @ lower
        want = target - pelvis - whole[0] @ hip
        long, short = float(np.linalg.norm(upper)), float(np.linalg.norm(lower))
        if np.linalg.norm(want - knee - shank) < 1e-9 or np.linalg.norm(want) < 1e-3:
            return
        distance = min(float(np.linalg.norm(want)), REACH * (long + short))
        along = (knee + shank) / np.linalg.norm(knee + shank)
        aside = knee - (knee @ along) * along
        if np.linalg.norm(aside) < 1e-6:
            aside = whole[thigh][:, 0] - (whole[thigh][:, 0] @ along) * along  # a straight leg bends forward
        turn = align_vectors(along, want)
        along, aside = turn @ along, turn @ aside / np.linalg.norm(aside)
        cos = min(1.0, max(-1.0, (long**2 + distance**2 - short**2) / (2.0 * long * distance)))
        bent = long * (cos * along + math.sqrt(1.0 - cos * cos) * aside)
        whole[thigh] = align_vectors(knee, bent) @ whole[thigh]
        whole[calf] = align_vectors(shank, distance * along - bent) @ whole[calf]
