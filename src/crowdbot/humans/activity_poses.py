"""Poses of activities, put over those of the gait."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from crowdbot.typing import Floats

from .activities import ACTIVITIES, FIRST_POSE
from .asset import shapes
from .clip import Clip
from .feet import Gaits
from .people import People
from .posture import Posture

HANDS = {
    "carry": (0.21, 0.085, -0.215), "read": (0.185, 0.045, -0.135), "pram": (0.25, 0.115, -0.235),
    "wheelchair": (0.25, 0.125, -0.245),
}  # fmt: skip
"""Wrists ahead, aside and above the shoulders, in shares of the stature."""
STICK = (0.085, -0.145, -0.315)
WAVE, WAVE_SWING, WAVE_RATE = (0.08, -0.19, 0.135), 0.055, 1.7
"""Wrist of a waving hand, its swing in shares of the stature, and its frequency [Hz]."""
RISE = (0.22, -0.20, -0.10)
"""Point of the same measures that bends the way of the waving hand forward."""
PALM, PALM_BEND = (0.27, -0.11, 0.01), math.radians(80.0)
"""Wrist of the hand that tells a robot to wait, and how far the hand is bent up, so that the palm faces the robot."""
SWEEP, SWEEP_SWING, SWEEP_RATE = (0.17, -0.10, -0.10), 0.12, 0.7
"""Middle of the way of the wrist that tells a robot to proceed, from the right to the left, and its frequency [Hz]."""
NOD = {"read": 0.42}
FARTHEST_LOOK = math.radians(75.0)
KEYS = np.array([0.0, 0.15, 0.36, 0.50, 0.64, 0.80, 0.90, 1.0])
HIP = np.radians([34.0, 20.0, -16.0, 2.0, 32.0, 50.0, 45.0, 34.0])
KNEE = np.radians([18.0, 40.0, 17.0, 68.0, 104.0, 72.0, 38.0, 18.0])
ANKLE = np.radians([4.0, 20.0, -24.0, -12.0, 0.0, 4.0, 5.0, 4.0])
"""Flexion of hip and knee and dorsiflexion of the ankle in running, by the phase from the landing of the foot."""
FLIGHT, HOP = (0.36, 0.50), 0.055
"""Phases of the flight in a half cycle, and its height [m]."""
JOG = (0.5, 1.3)
"""Speeds [m/s] at which a runner still walks or stands, and from which on the legs run."""
LEAN = 0.14


def pose_activities(
    posture: Posture, people: People, state: Gaits, targets: Mapping[int, Floats] | None = None
) -> Posture:
    """Return the posture of all people with the poses of their activities.

    Args:
        posture: posture of the gait.
        people: the people.
        state: their state, with the weight of each activity.
        targets: point ``[3]`` [m] that a person looks at, by row.
    """
    if not np.any(state.blend[:, FIRST_POSE:] > 1e-3):
        return posture
    result = Posture(posture.rotation.copy(), posture.position.copy())
    measures = people.measures
    for i in np.flatnonzero(np.max(state.blend[:, FIRST_POSE:], axis=1) > 1e-3):
        body = Bones(
            result.rotation[i], result.position[i], measures.head[i], measures.frame[i], float(state.yaw[i]),
            float(people.height[i]),
        )  # fmt: skip
        # waving comes last, as it takes the hand along a way from where the others have it
        waving = ACTIVITIES.index("wave")
        for k in sorted(range(FIRST_POSE, state.blend.shape[1]), key=lambda k: k == waving):
            share = float(state.blend[i, k])
            if share <= 1e-3:
                continue
            share = share * share * (3.0 - 2.0 * share)
            if k >= len(ACTIVITIES):
                clip = people.clips[k - len(ACTIVITIES)]
                _play(body, _sole(people, i), clip, float(state.phase[i]), float(state.clock[i]), share)
            elif ACTIVITIES[k] == "run":
                pace = (float(np.hypot(*state.drift[i])) - JOG[0]) / (JOG[1] - JOG[0])
                _run(body, _sole(people, i), float(state.phase[i]), share * min(max(pace, 0.0), 1.0))
            else:
                _pose_one(body, ACTIVITIES[k], share, state, int(i), (targets or {}).get(int(i)))
    return result


def _pose_one(body: Bones, name: str, share: float, state: Gaits, i: int, target: Floats | None) -> None:
    if name == "look":
        _look(body, target, share)
    elif name in HANDS:
        ahead, aside, up = HANDS[name]
        for side, sign in ((0, 1.0), (1, -1.0)):
            body.reach(side, body.from_shoulders(ahead, sign * aside, up), _pole(body, -0.4, sign * 0.5), share)
        if name in NOD:
            _turn_head(body, 0.0, NOD[name], share)
    elif name == "stick":
        swing = 0.03 * math.sin(2.0 * math.pi * float(state.phase[i])) * float(state.moving[i])
        body.reach(1, body.from_shoulders(STICK[0] + swing, *STICK[1:]), _pole(body, -0.8, -0.3), share)
    elif name == "wave":
        _wave(body, float(state.clock[i]), share)
    elif name == "signal-wait":
        body.reach(1, body.from_shoulders(*PALM), _pole(body, -0.5, -0.5), share)
        _bend_hand(body, PALM_BEND, share)
    elif name == "signal-proceed":
        swing = SWEEP_SWING * math.sin(2.0 * math.pi * SWEEP_RATE * float(state.clock[i]))
        place = (SWEEP[0] + 0.3 * (SWEEP_SWING - abs(swing)), SWEEP[1] + swing, SWEEP[2])
        body.reach(1, body.from_shoulders(*place), _pole(body, -0.5, -0.5), share)


def _bend_hand(body: Bones, angle: float, share: float) -> None:
    """Bend the right hand up at the wrist."""
    left = np.array([-math.sin(body.yaw), math.cos(body.yaw), 0.0])
    turn = turn_about(left, -angle * share)
    for name in ("hand", "fingers_01", "fingers_02", "thumb"):
        k = bone(f"{name}_r")
        body.R[k] = turn @ body.R[k]
    body.place("hand_r")


def _wave(body: Bones, clock: float, share: float) -> None:
    """Wave with the right hand; it rises in front of the body, and the elbow bends early on the way."""
    swing = share * share * WAVE_SWING * math.sin(2.0 * math.pi * WAVE_RATE * clock)
    shoulder, elbow, hand = (body.P[bone(f"{name}_r")] for name in ("upperarm", "lowerarm", "hand"))
    upper, lower = float(np.linalg.norm(elbow - shoulder)), float(np.linalg.norm(hand - elbow))
    goals = (hand, body.from_shoulders(*RISE), body.from_shoulders(WAVE[0], WAVE[1] + swing, WAVE[2]))
    start, middle, end = (goal - shoulder for goal in goals)
    rest = 1.0 - share
    way = unit(rest * rest * unit(start) + 2.0 * rest * share * unit(middle) + share * share * unit(end))
    # the angle is mixed, not the distance: near a straight arm, a small change of that is a large one of the elbow
    straight = rest**3
    angle = straight * _elbow(upper, lower, start) + (1.0 - straight) * _elbow(upper, lower, end)
    far = math.sqrt(upper * upper + lower * lower - 2.0 * upper * lower * math.cos(angle))
    # a half turn of an arm has no mean: the arm soon follows the hand, and the rotations are mixed only at the start
    follow = 1.0 - max(0.0, 1.0 - 6.0 * share) ** 2
    body.reach(1, shoulder + far * way, _pole(body, -0.8 + 0.7 * share, -0.2 - 0.4 * share), follow)


def _elbow(upper: float, lower: float, away: Floats) -> float:
    """Return the inner angle of the elbow [rad] that has the wrist at this distance from the shoulder."""
    cosine = (upper * upper + lower * lower - float(away @ away)) / (2.0 * upper * lower)
    return math.acos(min(max(cosine, -1.0), 1.0))


def _pole(body: Bones, ahead: float, left: float) -> Floats:
    cos, sin = math.cos(body.yaw), math.sin(body.yaw)
    return np.array([cos * ahead - sin * left, sin * ahead + cos * left, -0.7])


def _turn_head(body: Bones, aside: float, down: float, share: float) -> None:
    """Turn the head to the side and down [rad]; the neck takes a half."""
    for name, part in (("neck_01", 0.5), ("head", 1.0)):
        k = bone(name)
        goal = yaw_pitch(body.yaw + part * aside, part * down)
        body.R[k] = mix_rotations(body.R[k], goal, share)
    body.place("neck_01")


def _look(body: Bones, target: Floats | None, share: float) -> None:
    """Look at a point, with the head turned by at most 75 degrees."""
    if target is None:
        return
    away = target - body.P[bone("head")]
    aside = math.atan2(away[1], away[0]) - body.yaw
    aside -= 2.0 * math.pi * math.floor((aside + math.pi) / (2.0 * math.pi))
    down = math.atan2(-away[2], math.hypot(away[0], away[1]))
    aside = min(max(aside, -FARTHEST_LOOK), FARTHEST_LOOK)
    _turn_head(body, aside, min(max(down, -0.5), 0.6), share)


def _run(body: Bones, sole: Floats, phase: float, share: float) -> None:
    """Run: legs by joint angles, a flight in each half cycle, bent arms against the legs."""
    lean = yaw_pitch(body.yaw, LEAN)
    for name in ("pelvis", "spine_01", "spine_02", "spine_03", "clavicle_l", "clavicle_r"):
        body.R[bone(name)] = mix_rotations(body.R[bone(name)], lean, share)
    for side, letter in enumerate("lr"):
        at = (phase + 0.5 * side) % 1.0
        hip, knee, ankle = (float(np.interp(at, KEYS, row)) for row in (HIP, KNEE, ANKLE))
        toes = max(0.0, -ankle) * 0.8
        for name, pitch in (
            ("thigh", -hip),
            ("calf", knee - hip),
            ("foot", knee - hip - ankle),
            ("ball", knee - hip - ankle - toes),
        ):
            k = bone(f"{name}_{letter}")
            body.R[k] = mix_rotations(body.R[k], yaw_pitch(body.yaw, pitch), share)
    before = float(body.P[0, 2])
    body.place("pelvis")
    part = ((phase % 0.5) - FLIGHT[0]) / (FLIGHT[1] - FLIGHT[0])
    hop = HOP * math.sin(math.pi * part) if 0.0 < part < 1.0 else 0.0
    ground = min(_lowest(body, sole, letter) for letter in "lr")
    body.P[0, 2] = before + share * (hop - ground)
    body.place("pelvis")
    for side, sign in ((0, 1.0), (1, -1.0)):
        wave = math.cos(2.0 * math.pi * phase) * sign
        goal = body.from_shoulders(0.07 - 0.085 * wave, sign * (0.10 - 0.02 * wave), -0.155 - 0.035 * wave)
        body.reach(side, goal, _pole(body, -1.0, sign * 0.25), share)


def _play(body: Bones, sole: Floats, clip: Clip, phase: float, clock: float, share: float) -> None:
    """Play a clip; the lower foot has the height of the clip above the floor."""
    turns, lift = clip.at(phase, clock)
    heading, own = yaw_pitch(body.yaw, 0.0), {}
    for name, turn in zip(clip.bones, turns, strict=True):
        own[bone(name)] = heading @ turn
    for b, parent in enumerate(shapes().parents.tolist()):
        goal = own.get(b, own.get(parent))
        if goal is not None:
            own[b] = goal
            body.R[b] = mix_rotations(body.R[b], goal, share)
    before = float(body.P[0, 2])
    body.place("pelvis")
    if any(name.startswith(("thigh", "calf", "pelvis")) for name in clip.bones):
        leg = float(body.head[bone("thigh_l"), 2])
        body.P[0, 2] = before + share * (lift * leg - min(_lowest(body, sole, letter) for letter in "lr"))
        body.place("pelvis")


def _lowest(body: Bones, sole: Floats, letter: str) -> float:
    """Return the height [m] of the lowest point of a foot: heel, ball or tip of the toes."""
    foot, ball = bone(f"foot_{letter}"), bone(f"ball_{letter}")
    ankle, ahead, thick, heel, toe = sole.tolist()
    ends = ((foot, heel, ankle), (foot, ahead, ankle), (ball, 0.0, thick), (ball, toe - ahead, thick))
    return min(float((body.P[k] + body.R[k] @ np.array([x, 0.0, -z]))[2]) for k, x, z in ends)


def _sole(people: People, i: int | np.intp) -> Floats:
    """Return the height of the ankle, ball ahead of it, height of the ball, and heel and toe ahead, ``[5]`` [m]."""
    m = people.measures
    return np.array([m.ankle[i], *m.ball[i], m.heel[i], m.toe[i]])


@dataclass(frozen=True, eq=False)
class Bones:
    """Bones of one person, changed in place.

    Fields:
        R, P: rotation ``[B, 3, 3]`` relative to rest and position ``[B, 3]`` [m] of each bone in the world.
        head: start of each bone at rest ``[B, 3]`` [m]; frame: rest frames of arms and legs, see ``Measures``.
        yaw: heading of the trunk [rad]; stature [m].
    """

    R: Floats
    P: Floats
    head: Floats
    frame: Floats
    yaw: float
    stature: float

    @property
    def shoulders(self) -> Floats:
        """Middle between the shoulder joints ``[3]`` [m]."""
        return np.asarray(0.5 * (self.P[bone("upperarm_l")] + self.P[bone("upperarm_r")]))

    def from_shoulders(self, ahead: float, left: float, up: float) -> Floats:
        """Return a point ``[3]`` [m] at this distance from the shoulders, in shares of the stature."""
        cos, sin = math.cos(self.yaw), math.sin(self.yaw)
        away = np.array([cos * ahead - sin * left, sin * ahead + cos * left, up])
        return np.asarray(self.shoulders + self.stature * away)

    def place(self, first: str) -> None:
        """Put all bones below a bone at the ends of their parents."""
        moved = {bone(first)}
        for b, parent in enumerate(shapes().parents.tolist()):
            if parent in moved:
                moved.add(b)
                self.P[b] = self.P[parent] + self.R[parent] @ (self.head[b] - self.head[parent])

    def reach(self, side: int, wrist: Floats, pole: Floats, share: float) -> None:
        """Take a wrist to a point [m], with the elbow towards ``pole``, by a share of the way from its pose.

        The hand continues the forearm. ``side`` is 0 for left, 1 for right.
        """
        letter = "lr"[side]
        upper, lower, hand = (bone(f"{name}_{letter}") for name in ("upperarm", "lowerarm", "hand"))
        a, b = (float(np.linalg.norm(self.head[j] - self.head[i])) for i, j in ((upper, lower), (lower, hand)))
        away = wrist - self.P[upper]
        far = float(np.linalg.norm(away))
        aim = away / max(far, 1e-9)
        far = min(max(far, abs(a - b) + 0.03), 0.995 * (a + b))
        hinge = unit(np.cross(pole, aim))
        inner = math.acos(min(max((a * a + far * far - b * b) / (2.0 * a * far), -1.0), 1.0))
        elbow = math.acos(min(max((a * a + b * b - far * far) / (2.0 * a * b), -1.0), 1.0))
        first = turn_about(hinge, -inner) @ aim
        second = turn_about(hinge, math.pi - elbow) @ first
        for name, k, axis in ((upper, 4 + side, first), (lower, 6 + side, second)):
            goal = np.stack([axis, hinge, np.cross(axis, hinge)], axis=1) @ self.frame[k]
            self.R[name] = mix_rotations(self.R[name], goal, share)
        for outer in ("hand", "fingers_01", "fingers_02", "thumb"):
            k = bone(f"{outer}_{letter}")
            self.R[k] = mix_rotations(self.R[k], self.R[lower], share)
        self.place(f"upperarm_{letter}")


def bone(name: str) -> int:
    """Return the index of a bone."""
    return shapes().bone(name)


def turn_about(axis: Floats, angle: float) -> Floats:
    """Return the rotation ``[3, 3]`` by an angle [rad] about a unit vector."""
    x, y, z = axis
    cross = np.array([[0.0, -z, y], [z, 0.0, -x], [-y, x, 0.0]])
    return np.asarray(np.eye(3) + math.sin(angle) * cross + (1.0 - math.cos(angle)) * cross @ cross)


def yaw_pitch(yaw: float, pitch: float) -> Floats:
    """Return the rotation of a heading [rad], then forward by a pitch [rad]."""
    c, s, cp, sp = math.cos(yaw), math.sin(yaw), math.cos(pitch), math.sin(pitch)
    return np.array([[c * cp, -s, c * sp], [s * cp, c, s * sp], [-sp, 0.0, cp]])


def mix_rotations(a: Floats, b: Floats, share: float) -> Floats:
    """Return the rotation that is nearest to the weighted mean of two."""
    if share >= 1.0:
        return b
    u, _, v = np.linalg.svd((1.0 - share) * a + share * b)
    return np.asarray(u @ np.diag([1.0, 1.0, float(np.sign(np.linalg.det(u @ v)))]) @ v)


def unit(a: Floats) -> Floats:
    """Return the vector of length 1 in this direction."""
    return np.asarray(a / max(float(np.linalg.norm(a)), 1e-9))
