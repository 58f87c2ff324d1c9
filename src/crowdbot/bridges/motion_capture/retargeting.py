"""Retargeting: the pose of an actor becomes that of a person of a trial, whose body has other proportions."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.humans import BodyPose, RestSkeleton
from crowdbot.typing import Floats

from .rotations import align_vectors, rotate_about, to_quaternions, yaw_of
from .source_skeleton import SourceSkeleton

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
        x, y, z = (round(float(one), DIGITS) for one in pelvis)
        numbers = [x, y, z, *(round(one, DIGITS) for one in bones.ravel().tolist())]
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
        found = np.tile(np.eye(3), (len(self.body.names), 1, 1))
        for k, side in enumerate("lr"):
            for upper, lower, end in (("upperarm", "lowerarm", "hand"), ("thigh", "calf", "foot")):
                turn = self._aligned(np.eye(3), f"{upper}_{side}", f"{lower}_{side}")
                found[self.body.bone(f"{upper}_{side}")] = turn
                found[self.body.bone(f"{lower}_{side}")] = self._aligned(turn, f"{lower}_{side}", f"{end}_{side}")
            self._turn_hand(found, k, side)
        return found

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
