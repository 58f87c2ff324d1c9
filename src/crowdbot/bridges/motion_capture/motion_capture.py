"""MotionCapture: people and robots of a trial that move as a motion capture system says."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from types import TracebackType
from typing import Any

import numpy as np

from crowdbot.core import InputError, did_you_mean, wrap_angle
from crowdbot.humans import BodyPose, PoseTrack, RestSkeleton, rest_skeleton
from crowdbot.simulation import AvatarOrder, Order, RobotPoseOrder
from crowdbot.trials import Trial, people_appearance

from .foot_lock import FootLock
from .pose_stream import MotionSample, PoseStream
from .retargeting import Retargeting
from .rotations import rotate_about, yaw_of
from .source_skeleton import SourceSkeleton

AHEAD = 9.0
"""A time stamp that is further ahead [s] is not given: the clocks of sender and simulation are not related yet."""
EARLY = 1e-6
"""Tolerance [s] of time stamps."""


@dataclass(frozen=True)
class MotionBinding:
    """A subject of a stream and the avatar or mirrored robot that it moves.

    Fields:
        target: name of an avatar or robot of the trial.
        subject: name of the subject in the stream; empty: the first one.
        x, y, heading: place of the origin of the motion capture system in the trial [m], [rad].

    Raises:
        InputError: a number is not finite.
    """

    target: str
    subject: str = ""
    x: float = 0.0
    y: float = 0.0
    heading: float = 0.0

    def __post_init__(self) -> None:
        if not all(math.isfinite(one) and abs(one) <= 1e5 for one in (self.x, self.y, self.heading)):
            raise InputError(f"the origin {self.x:g}, {self.y:g}, {self.heading:g} of {self.target!r} must be finite")


class MotionCapture:
    """Moves people and robots of a trial by a stream of poses. It is an :class:`crowdbot.simulation.OrderSource`.

    A skeleton moves the whole body of an avatar, scaled to its proportions; a rigid body moves the avatar, which then
    walks with its gait. A robot is where a rigid body, or the pelvis of a skeleton, is. Every step gives at most one
    order for each binding, which is recorded: the episode replays without the motion capture system.

    Args:
        stream: the motion capture system or recording, open.
        bindings: who moves whom.

    >>> from crowdbot.bridges.motion_capture import MotionBinding, MotionCapture, open_stream
    >>> with open_stream("xsens:0") as stream:
    ...     MotionCapture(stream, [MotionBinding("guide")]).unbound(("guide", "robot"))
    ()
    """

    def __init__(self, stream: PoseStream, bindings: Sequence[MotionBinding]) -> None:
        self.stream, self.bindings = stream, tuple(bindings)
        self.refused, self.reason = 0, ""
        """Number of samples that are no pose of a person, and why the last one is not."""
        self._fits: dict[str, tuple[SourceSkeleton, FootLock]] = {}
        self._bodies: dict[str, RestSkeleton] = {}
        self._ready = False

    def __enter__(self) -> MotionCapture:
        """Start the stream."""
        self.stream.__enter__()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        """Stop the stream."""
        self.stream.__exit__(kind, error, trace)

    def unbound(self, names: Sequence[str]) -> tuple[str, ...]:
        """Return the targets that are not among some names."""
        return tuple(one.target for one in self.bindings if one.target not in names)

    def check(self, trial: Trial) -> None:
        """Raise :class:`InputError` if a target is not an external avatar or mirrored robot of the trial."""
        mirrors = [(one.name, one.mirror) for one in trial.robots]
        robots = [name for name, mirror in mirrors if mirror is not None and mirror.source == "external"]
        avatars = [avatar.name for avatar in trial.avatars if avatar.source == "external"]
        known = [*avatars, *robots]
        for name in self.unbound(known):
            raise InputError(
                f'trial {trial.name!r} has no avatar {name!r} with source="external" and no robot {name!r} with'
                f' <pose source="external"/>{did_you_mean(name, known)}; it has {", ".join(known) or "none"}'
            )

    def remarks(self) -> list[str]:
        """Return a line for each binding: number and rate of its samples, losses, and how old they were when used."""
        found = []
        latency = self.stream.latency()
        for one in self.bindings:
            known = self.stream.statistics(one.subject)
            parts = [f"{known.samples} samples", f"{known.rate:.1f} Hz"]
            if self.stream.live:
                parts += [f"{known.lost} lost", f"{known.refused} datagrams refused"]
            if latency is not None:
                parts.append(f"age median {1e3 * latency[0]:.1f} ms, p99 {1e3 * latency[1]:.1f} ms")
            reason = known.reason or self.reason
            refused = f"; {self.refused} are no pose" if self.refused else ""
            found.append(f"{one.target}: {', '.join(parts)}{refused}{f' ({reason})' if reason else ''}")
        return found

    def orders(self, simulation: Any) -> list[Order]:
        """Return the poses for this step."""
        if not self._ready:
            self.check(simulation.trial)
            self._bodies, self._ready = _avatar_bodies(simulation), True
        now = float(simulation.world.times[0])
        ahead = now + float(simulation.trial.step)
        found: list[Order] = []
        for binding in self.bindings:
            samples = self.stream.read(binding.subject, now, ahead)
            samples = [(time, one) for time, one in samples if time <= now + AHEAD]
            if not samples:
                continue
            try:
                found.append(self._order(binding, samples, ahead))
            except InputError as error:  # for instance an actor far below the floor
                self.refused, self.reason = self.refused + 1, str(error)
        return found

    def _order(self, binding: MotionBinding, samples: list[tuple[float, MotionSample]], ahead: float) -> Order:
        poses = [self._pose(binding, sample) for _, sample in samples]
        time, pose = samples[-1][0], poses[-1]
        if len(samples) > 1 and samples[0][0] <= ahead + EARLY and ahead <= time:
            time, pose = ahead, PoseTrack.of([one for one, _ in samples], poses).at(ahead)
        how: dict[str, Any] = {"time": round(time, 6), "x": pose.x, "y": pose.y, "heading": pose.heading}
        if binding.target in self._bodies:
            return AvatarOrder(avatar=binding.target, skeleton=pose.skeleton, source="mocap", **how)
        return RobotPoseOrder(robot=binding.target, source="mocap", **how)

    def _pose(self, binding: MotionBinding, sample: MotionSample) -> BodyPose:
        """Return the pose of the target in the frame of the trial."""
        turn = rotate_about([0.0, 0.0, 1.0], binding.heading)
        position = sample.position @ turn.T + np.array([binding.x, binding.y, 0.0])
        rotation = turn @ sample.rotation
        if sample.skeleton is not None and binding.target in self._bodies:
            return self._fit(binding.target, sample.skeleton).pose(sample.number, sample.time, position, rotation)
        k = 0 if sample.skeleton is None else sample.skeleton.roles["pelvis"]
        x, y = (round(float(one), 6) for one in position[k, :2])
        return BodyPose(x, y, round(wrap_angle(yaw_of(rotation[k])), 6))

    def _fit(self, target: str, skeleton: SourceSkeleton) -> FootLock:
        known = self._fits.get(target)
        if known is None or known[0] is not skeleton:
            known = self._fits[target] = (skeleton, FootLock(Retargeting(skeleton, self._bodies[target])))
        return known[1]


def _avatar_bodies(simulation: Any) -> dict[str, RestSkeleton]:
    """Return the bones of each avatar of the first environment."""
    trial, people = simulation.trial, simulation.people
    figures = people_appearance(trial, people, simulation.world.scene.shape[1], simulation.seeds[0]).people
    names = [getattr(people.owners[owner], "name", "") for owner in people.owner.tolist()]
    first = len(names) - len(trial.avatars)
    return {avatar.name: rest_skeleton(figures, first + names[first:].index(avatar.name)) for avatar in trial.avatars}
