"""Doors: the state of all doors of a world, its walls and its paths."""

from __future__ import annotations

import copy
from collections.abc import Sequence
from typing import Any

import numpy as np

from crowdbot.core import Scene, Storage, Walls
from crowdbot.typing import Floats
from crowdbot.world.crowd.routing import Router
from crowdbot.world.physics.scenery import add_rings

from .door import Door

SPARE = 0.05
"""Distance [m] that a moving leaf keeps from people and robots; it stops before."""
TOUCH = 0.15
"""Distance [m] from the outline of a body at which a pushed door opens in the plane."""
ROOM = 1.5
"""Distance [m] beyond the swing of a leaf within which somebody makes it open to the other side."""
OPEN = 1.0 - 1e-9
SHUT = 1e-6
"""A sliding leaf that is shorter than this share of its width is no wall."""


class Doors:
    """Doors of one environment.

    Args:
        leaves: the doors.
        pushed: whether doors that open by push are moved by an engine, so that :meth:`read_leaves` sets them.

    Attributes:
        leaves: the doors.
        wanted: whether each door that opens by order is to be open; of a scheduled one, whether it starts open.
        share: ``[D]`` from 0, closed, to 1, open.
        start: ``[D]`` the same before the latest step.
        side: ``[D]`` 1, or -1 for a hinged door that opens to the other side, since somebody is near on its own side.
        blocked: ``[D]`` whether paths avoid each door.

    >>> doors = Doors((Door(name="hall", points="2,-1 2,1", duration=0.5),))
    >>> doors.wanted["hall"] = True
    >>> scene = Scene.of([[0.0, 0.0]])
    >>> for tick in range(3):
    ...     doors.advance(scene, 0.2 * tick, 0.2)
    >>> doors.share.tolist(), doors.blocked
    ([1.0], [False])
    """

    storage = Storage(constants=("leaves", "pushed", "_walls", "_routers", "_base"))

    def __init__(self, leaves: Sequence[Door], pushed: bool = False) -> None:
        self.leaves = tuple(leaves)
        self.wanted = {leaf.name: leaf.open for leaf in self.leaves}
        starts = [self.wanted[leaf.name] and not leaf.lets_pass for leaf in self.leaves]
        self.share = np.array(starts, dtype=np.float64)
        self.start = self.share.copy()
        self.side = np.ones(len(self.leaves))
        self.until = np.full(len(self.leaves), -np.inf)
        self.pushed = pushed
        self.blocked = self._blocked()
        self._walls: tuple[Walls, Walls] | None = None
        self._base: Router | None = None
        self._routers: dict[Any, Router] = {}

    def copy(self) -> Doors:
        """Return independent doors in the same state."""
        other = copy.copy(self)
        other.wanted, other.share, other.start = dict(self.wanted), self.share.copy(), self.start.copy()
        other.side = self.side.copy()
        other.until, other.blocked = self.until.copy(), list(self.blocked)
        return other

    def advance(self, scene: Scene, time: float, dt: float) -> None:
        """Move the doors by a time step; E = 1.

        Args:
            scene: people and robots at the start of the step; absent ones do not count.
            time: time [s] at the start of the step.
            dt: time step [s].
        """
        there, self.start = scene.active[0], self.share.copy()
        place, radius = scene.position[0, there], scene.radius[0, there]
        for k, leaf in enumerate(self.leaves):
            if leaf.opening == "push" and self.pushed:
                continue
            aim = self._aim(k, leaf, place, radius, time)
            self._move(k, leaf, aim, dt / leaf.duration, place, radius)
        self.blocked = self._blocked()

    @property
    def signed_share(self) -> Floats:
        """Share ``[D]`` of each door times its side."""
        return self.side * self.share

    def turn_leaves(self, model: Any, data: Any, fraction: float, dt: float) -> None:
        """Set the joints of all leaves in an engine that people do not push, at a fraction of a step of ``dt`` [s]."""
        for k, leaf in enumerate(self.leaves):
            if leaf.opening == "push":
                continue
            joint = model.joint(f"door{k}")
            share = self.start[k] + fraction * (self.share[k] - self.start[k])
            way = self.side[k] * leaf.range
            data.qpos[joint.qposadr[0]] = share * way
            data.qvel[joint.dofadr[0]] = (self.share[k] - self.start[k]) / dt * way

    def read_leaves(self, model: Any, data: Any) -> None:
        """Set the share of the leaves that people push from an engine."""
        for k, leaf in enumerate(self.leaves):
            if leaf.opening == "push":
                angle = float(data.qpos[model.joint(f"door{k}").qposadr[0]])
                self.share[k] = float(np.clip(angle / leaf.range, -1.0, 1.0))

    def lines(self) -> tuple[Floats, ...]:
        """Return the lines ``[2, 2]`` [m] of all leaves that are walls now; doors that people push are none."""
        return tuple(
            leaf.line(float(self.side[k] * self.share[k]))
            for k, leaf in enumerate(self.leaves)
            if not (self.pushed and leaf.opening == "push") and (leaf.kind == "hinged" or self.share[k] < 1.0 - SHUT)
        )

    def walls(self, base: Walls) -> Walls:
        """Return walls with the leaves."""
        return add_rings(base, self.lines())

    def update_walls(self, walls: Walls) -> Walls:
        """Return walls with the current leaves instead of those of the last call."""
        known = self._walls
        base = known[1] if known is not None and known[0] is walls else walls
        lines = self.lines()
        if known is not None and known[0] is walls and _has_lines(walls, base, lines):
            return walls
        new = add_rings(base, lines) if lines else base
        self._walls = (new, base)
        return new

    def path_lines(self) -> tuple[Floats, ...]:
        """Return the lines ``[2, 2]`` [m] that paths avoid: doors that stay closed, and leaves that are open."""
        found = []
        for k, leaf in enumerate(self.leaves):
            if self.blocked[k]:
                found.append(leaf.line(0.0))
            elif leaf.kind == "hinged" and leaf.opening != "push":
                found.append(leaf.line(float(self.side[k])))
        return tuple(found)

    def router(self, base: Router) -> Router:
        """Return the router of people at the current doors; ``base`` is that without doors.

        Somebody whose goal is behind a closed door walks to the reachable point nearest to it.
        """
        if self._base is not base:
            self._base, self._routers = base, {}
        key = (tuple(self.blocked), tuple(self.side.tolist()))
        if key not in self._routers:
            walls = add_rings(base.walls, self.path_lines())
            self._routers[key] = Router.of(walls, base.radius, "nearest" if any(self.blocked) else base.unreachable)
        return self._routers[key]

    def _move(self, k: int, leaf: Door, aim: float, most: float, place: Floats, radius: Floats) -> None:
        """Move a door by at most a share ``most``; a leaf that somebody blocks while it opens turns back."""
        if self.share[k] == 0.0 and aim > 0.0 and leaf.kind == "hinged":
            self.side[k] = _free_side(leaf, place)
        for end in (aim, 0.0):
            following = float(np.clip(self.share[k] + np.clip(end - self.share[k], -most, most), 0.0, 1.0))
            following = 1.0 if following > OPEN else following
            old, new = float(self.side[k] * self.share[k]), float(self.side[k] * following)
            if new == old:
                return
            if not _is_in_the_way(leaf, old, new, place, radius):
                self.share[k] = following
                return

    def _blocked(self) -> list[bool]:
        return [not leaf.lets_pass and bool(self.share[k] < OPEN) for k, leaf in enumerate(self.leaves)]

    def _aim(self, number: int, leaf: Door, place: Floats, radius: Floats, time: float) -> float:
        """Return 1 if a door is to open, 0 if it is to close."""
        if leaf.opening == "order":
            return float(self.wanted[leaf.name])
        if leaf.opening == "schedule":
            return float(self.wanted[leaf.name] ^ (sum(time >= item - 1e-9 for item in leaf.switches) % 2 == 1))
        away = _distance(leaf.line(0.0), place)
        near = away < (leaf.distance if leaf.opening == "approach" else radius + TOUCH)
        if np.any(near):
            self.until[number] = time + leaf.hold
        return float(time < self.until[number])


def _is_in_the_way(leaf: Door, old: float, new: float, place: Floats, radius: Floats) -> bool:
    """Return whether a leaf would come closer to somebody who is near."""
    if not len(place):
        return False
    after = _distance(leaf.line(new), place)
    return bool(np.any((after < radius + SPARE) & (after < _distance(leaf.line(old), place))))


def _free_side(leaf: Door, place: Floats) -> float:
    """Return 1 if a leaf can turn to its own side, -1 if somebody near is there and the other side has more room."""
    away = _distance(leaf.line(0.0), place)
    near = away < leaf.width + ROOM
    start, end = np.array(leaf.points)
    along, off = end - start, place - start
    left = (along[0] * off[:, 1] - along[1] * off[:, 0]) * leaf.angle > 0.0
    own, other = away[near & left].min(initial=np.inf), away[near & ~left].min(initial=np.inf)
    return -1.0 if own < other else 1.0


def _distance(line: Floats, points: Floats) -> Floats:
    """Return the distances ``[N]`` [m] of points to a line ``[2, 2]``."""
    start, along = line[0], line[1] - line[0]
    length2 = max(float(along @ along), 1e-18)
    share = np.clip(((points - start) @ along) / length2, 0.0, 1.0)
    away = points - start - share[:, None] * along
    return np.asarray(np.sqrt(np.sum(away * away, axis=1)))


def _has_lines(walls: Walls, base: Walls, lines: Sequence[Floats]) -> bool:
    """Return whether walls are the base and these lines."""
    starts = walls.start[len(base) :]
    wanted = np.concatenate(lines) if lines else np.zeros((0, 2))
    return bool(len(starts) == len(wanted) and np.array_equal(starts, wanted))
