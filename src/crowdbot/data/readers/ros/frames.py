"""Coordinate frames of a bag: transforms of ``/tf``, ``/tf_static`` and odometry, interpolated in time."""

from __future__ import annotations

import functools
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.typing import Floats

SECOND = 1_000_000_000
WORLD_FRAMES = frozenset(("map", "odom", "odom_combined", "world", "earth"))
"""Names of frames that do not move (REP 105), perhaps after a namespace: ``robot/odom``."""
LONGEST_GAP = 2.0
"""Longest time [s] between two poses that is interpolated."""


def frame_name(name: str) -> str:
    """Return a frame as in tf2, without the slash that tf of ROS 1 puts first."""
    return str(name).strip().lstrip("/")


def stamp_of(header: Any) -> int:
    """Return the stamp of a header of ROS 2 or ROS 1 [ns]."""
    stamp = header.stamp
    if hasattr(stamp, "nanosec"):
        return int(stamp.sec) * SECOND + int(stamp.nanosec)
    return int(stamp.secs) * SECOND + int(stamp.nsecs)  # of rospy


@dataclass
class _Edge:
    """Poses of a frame in its parent: stamps [ns], and x, y, z [m] with a quaternion x, y, z, w.

    Poses of odometry go on with the covariance of x, y [m] and yaw [rad]: xx, xy, xt, yy, yt, tt.
    """

    parent: str
    topic: str
    static: bool
    stamps: list[int] = field(default_factory=list)
    poses: list[tuple[float, ...]] = field(default_factory=list)

    def add(self, stamp: int, pose: tuple[float, ...]) -> None:
        """Add a pose; a static frame keeps the last one only."""
        if self.static:
            self.stamps.clear()
            self.poses.clear()
        self.stamps.append(stamp)
        self.poses.append(pose)
        self.__dict__.pop("table", None)

    def forget(self, stamp: int) -> None:
        """Drop poses before a stamp, but never the last two."""
        if self.stamps[0] < stamp and len(self.stamps) > 2:
            kept = [k for k, own in enumerate(self.stamps) if own >= stamp or k >= len(self.stamps) - 2]
            self.stamps, self.poses = [self.stamps[k] for k in kept], [self.poses[k] for k in kept]
            self.__dict__.pop("table", None)

    @functools.cached_property
    def table(self) -> tuple[NDArray[np.int64], Floats]:
        """Stamps ``[P]`` in ascending order without duplicates, and poses ``[P, 7]`` or, of odometry, ``[P, 13]``."""
        stamps, first = np.unique(np.asarray(self.stamps, dtype=np.int64), return_index=True)
        return stamps, np.asarray(self.poses, dtype=np.float64)[first]


class Placement(NamedTuple):
    """Rotations ``[N, 3, 3]`` and translations ``[N, 3]`` [m] from a frame to another, NaN where they are unknown."""

    turn: Floats
    shift: Floats

    def apply(self, points: Floats) -> Floats:
        """Move points ``[N, 3]``."""
        return np.asarray(np.einsum("nij,nj->ni", self.turn, points) + self.shift)

    def after(self, first: Placement) -> Placement:
        """Return the placement that applies ``first``, then this one."""
        return Placement(self.turn @ first.turn, self.apply(first.shift))

    def inverse(self) -> Placement:
        """Return the opposite placement."""
        turn = np.swapaxes(self.turn, 1, 2)
        return Placement(turn, -np.einsum("nij,nj->ni", turn, self.shift))


@dataclass
class Frames:
    """The tree of frames. A transform of ``/tf`` wins over odometry with the same child."""

    edges: dict[str, _Edge] = field(default_factory=dict)
    odometry: dict[str, _Edge] = field(default_factory=dict)

    def add_transforms(self, topic: str, message: Any) -> None:
        """Add a message of type TFMessage."""
        static = topic.endswith("tf_static")
        for row in message.transforms:
            parent, child = frame_name(row.header.frame_id), frame_name(row.child_frame_id)
            edge = self.edges.setdefault(child, _Edge(parent, topic, static))
            if edge.parent == parent:
                place, turn = row.transform.translation, row.transform.rotation
                edge.add(stamp_of(row.header), (place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w))

    def add_odometry(self, topic: str, message: Any) -> None:
        """Add a message of type Odometry; the first topic of a child counts."""
        parent, child = frame_name(message.header.frame_id), frame_name(message.child_frame_id)
        edge = self.odometry.setdefault(child, _Edge(parent, topic, False))
        if edge.topic == topic and edge.parent == parent:
            place, turn = message.pose.pose.position, message.pose.pose.orientation
            spread = _planar_covariance(message.pose.covariance)
            edge.add(stamp_of(message.header), (place.x, place.y, place.z, turn.x, turn.y, turn.z, turn.w, *spread))

    def forget(self, stamp: int) -> None:
        """Drop the poses before a stamp [ns] in a stream of messages."""
        for edge in (*self.edges.values(), *self.odometry.values()):
            edge.forget(stamp)

    def may_come(self, frame: str, target: str, stamp: int) -> bool:
        """Whether the placement of joined frames is known at a stamp [ns], or may be after more messages."""
        edges = [edge for part in self._paths(frame, target) for name in part if (edge := self._edge(name)) is not None]
        moving = [edge.table[0] for edge in edges if not edge.static]
        if any(times[0] > stamp for times in moving):
            return False
        known = not np.isnan(self.placement(frame, target, np.array([stamp], dtype=np.int64)).turn).any()
        return known or any(times[-1] < stamp for times in moving)

    def above(self, frame: str) -> list[str]:
        """Return a frame and those above it, up to the root."""
        chain = [frame]
        while (edge := self._edge(chain[-1])) is not None and edge.parent not in chain:
            chain.append(edge.parent)
        return chain

    def is_fixed(self, frame: str) -> bool:
        """Whether a frame has the name of a fixed frame, or odometry is relative to it."""
        return frame.rpartition("/")[2] in WORLD_FRAMES or any(edge.parent == frame for edge in self.odometry.values())

    def topics(self, frame: str, target: str) -> list[str]:
        """Return the topics whose transforms join two frames."""
        up, down = self._paths(frame, target)
        edges = [edge for name in (*up, *down) if (edge := self._edge(name)) is not None]
        return list(dict.fromkeys(edge.topic for edge in edges))

    def describe(self) -> str:
        """Return the transforms in words."""
        edges = {**self.odometry, **self.edges}
        return ", ".join(f"{edge.parent} -> {child}" for child, edge in list(edges.items())[:12]) or "none"

    def connects(self, frame: str, target: str) -> bool:
        """Whether transforms join two frames."""
        return bool(set(self.above(frame)) & set(self.above(target)))

    def placement(self, frame: str, target: str, stamps: NDArray[np.int64]) -> Placement:
        """Return the placement ``[N]`` of a frame in a target frame that it is joined with, at stamps ``[N]`` [ns]."""
        up, down = self._paths(frame, target)
        placement = self._chain(up, stamps)
        return self._chain(down, stamps).inverse().after(placement) if down else placement

    def pose_covariance(self, frame: str, target: str, stamp: int) -> Floats:
        """Return how uncertain odometry makes the placement of a frame in a target frame that it is joined with.

        The covariance ``[3, 3]`` is that of a small motion of the plane of the target frame: x, y [m] of the point at
        its origin, and yaw [rad]. A point at x, y then has the covariance ``J P J^T`` with
        ``J = [[1, 0, -y], [0, 1, x]]``: far from the robot, the error of its heading counts more. Several odometries on
        the way add up; 0 where there is none. Transforms of ``/tf`` have no covariance; that of odometry between the
        same frames counts.

        Args:
            frame, target: the frames.
            stamp: time [ns] at which the placement is known.

        Raises:
            InputError: a covariance is not finite and positive semidefinite.
        """
        total, at = np.zeros((3, 3)), np.array([stamp], dtype=np.int64)
        for name in (item for part in self._paths(frame, target) for item in part):
            edge, tree = self.odometry.get(name), self._edge(name)
            if edge is None or tree is None or edge.parent != tree.parent:
                continue
            first, last, share = _around(edge, at)
            xx, xy, xt, yy, yt, tt = (first + share[:, None] * (last - first))[0, 7:]
            spread = np.array([[xx, xy, xt], [xy, yy, yt], [xt, yt, tt]])
            size = np.abs(spread).max()
            if not np.isfinite(size) or np.linalg.eigvalsh(spread)[0] < -1e-6 * size:
                raise InputError(
                    f"the odometry on {edge.topic} has the covariance {spread.tolist()} of x, y and yaw, which must be"
                    " finite and positive semidefinite; send zeros if it is unknown"
                )
            base = self.placement(edge.parent, target, at)
            x, y = self.placement(name, target, at).shift[0, :2]
            motion = np.eye(3)
            motion[:2, :2] = base.turn[0, :2, :2]
            motion[:2, 2] = y, -x  # from the robot to the origin of the target frame
            total += motion @ spread @ motion.T
        return total

    def _edge(self, frame: str) -> _Edge | None:
        return self.edges.get(frame) or self.odometry.get(frame)

    def _paths(self, frame: str, target: str) -> tuple[list[str], list[str]]:
        """Return the frames below the lowest shared one, on the way up from both."""
        up, down = self.above(frame), self.above(target)
        shared = next(name for name in up if name in down)
        return up[: up.index(shared)], down[: down.index(shared)]

    def _chain(self, names: list[str], stamps: NDArray[np.int64]) -> Placement:
        placement = Placement(np.tile(np.eye(3), (len(stamps), 1, 1)), np.zeros((len(stamps), 3)))
        for name in names:
            edge = self._edge(name)
            if edge is not None:  # always: a frame below another one has a parent
                placement = _interpolate(edge, stamps).after(placement)
        return placement


def _around(edge: _Edge, stamps: NDArray[np.int64]) -> tuple[Floats, Floats, Floats]:
    """Return the poses before and after stamps ``[N]``, and the shares ``[N]`` of the time between them.

    The poses are NaN at stamps outside the poses, and in gaps.
    """
    times, poses = edge.table
    after = np.clip(np.searchsorted(times, stamps), 1, max(1, len(times) - 1))
    before = np.where(np.isin(stamps, times), np.minimum(np.searchsorted(times, stamps), len(times) - 1), after - 1)
    after = np.minimum(np.where(np.isin(stamps, times), before, after), len(times) - 1)
    gap = (times[after] - times[before]) / SECOND
    share = np.where(gap > 0.0, (stamps - times[before]) / SECOND / np.where(gap > 0.0, gap, 1.0), 0.0)
    unknown = (stamps < times[0]) | (stamps > times[-1]) | (gap > LONGEST_GAP)
    return np.where(unknown[:, None], np.nan, poses[before]), poses[after], share


def _interpolate(edge: _Edge, stamps: NDArray[np.int64]) -> Placement:
    """Return the poses at stamps: places are interpolated linearly, quaternions too, then normalized."""
    if edge.static:
        pose = np.repeat(edge.table[1][-1:], len(stamps), axis=0)
        return Placement(_matrices(pose[:, 3:]), pose[:, :3])
    first, last, share = _around(edge, stamps)
    opposite = np.sum(first[:, 3:7] * last[:, 3:7], axis=1) < 0.0
    last[opposite, 3:7] *= -1.0  # both signs are the same rotation
    pose = first + share[:, None] * (last - first)
    return Placement(_matrices(pose[:, 3:7]), pose[:, :3])


def _planar_covariance(covariance: Any) -> tuple[float, ...]:
    """Return the covariance of x, y and yaw of a pose: xx, xy, xt, yy, yt, tt; 0 if its first number is -1, unknown."""
    whole = np.asarray(covariance, dtype=np.float64).reshape(6, 6)
    return (0.0,) * 6 if whole[0, 0] == -1.0 else tuple(whole[[0, 0, 0, 1, 1, 5], [0, 1, 5, 1, 5, 5]].tolist())


def _matrices(quaternions: Floats) -> Floats:
    """Return rotation matrices ``[N, 3, 3]`` of quaternions x, y, z, w ``[N, 4]``; NaN for those of no length."""
    with np.errstate(divide="ignore", invalid="ignore"):
        x, y, z, w = (quaternions / np.linalg.norm(quaternions, axis=1, keepdims=True)).T
    rows = [
        [1 - 2 * (y * y + z * z), 2 * (x * y - z * w), 2 * (x * z + y * w)],
        [2 * (x * y + z * w), 1 - 2 * (x * x + z * z), 2 * (y * z - x * w)],
        [2 * (x * z - y * w), 2 * (y * z + x * w), 1 - 2 * (x * x + y * y)],
    ]
    return np.moveaxis(np.asarray(rows, dtype=np.float64), 2, 0)
