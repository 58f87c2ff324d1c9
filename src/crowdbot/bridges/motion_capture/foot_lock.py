"""FootLock: feet that the actor has on the floor do not slide on a body with other proportions."""

from __future__ import annotations

import math

import numpy as np

from crowdbot.humans import BodyPose
from crowdbot.typing import Floats

from .retargeting import Retargeting
from .rotations import align_vectors, yaw_of

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
        found = self.retargeting.whole_pose(whole, pelvis, yaw_of(rotation[self.retargeting.source.roles["pelvis"]]))
        self._poses[number] = found
        while len(self._poses) > KEPT:
            del self._poses[next(iter(self._poses))]
        return found

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
