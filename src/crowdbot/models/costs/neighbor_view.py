"""NeighborView: neighbours and walls of each agent for cost terms, and times to contact of candidate velocities."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Hashable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Neighbors, PerAgent, Scene, per_agent
from crowdbot.models.model import rows
from crowdbot.typing import Floats


@dataclass(frozen=True)
class NeighborView:
    """Neighbours and walls of N moving agents of all environments, with K neighbour slots; empty slots are padded.

    Fields:
        row: ``[N]`` row ``e * A + a`` of each agent in the scene.
        position, velocity, wish, goal: ``[N, 2]`` [m] and [m/s]; ``wish`` is the desired velocity.
        radius, max_speed, preferred_speed: ``[N]`` [m] and [m/s].
        offset: ``[N, K, 2]`` vector from each neighbour to the agent [m].
        motion: ``[N, K, 2]`` velocity of each neighbour [m/s].
        reach: ``[N, K]`` sum of the radii [m].
        there, external, first: ``[N, K]`` whether the slot has a neighbour, whether the neighbour is external, and
            whether the agent precedes it in the scene.
        segments: ``[M, 4]`` walls [m].
        dt: time step [s].
        scene: the whole scene.
        random: random generator, or None.
    """

    row: NDArray[np.int64]
    position: Floats
    velocity: Floats
    wish: Floats
    goal: Floats
    radius: Floats
    max_speed: Floats
    preferred_speed: Floats
    offset: Floats
    motion: Floats
    reach: Floats
    there: NDArray[np.bool_]
    external: NDArray[np.bool_]
    first: NDArray[np.bool_]
    segments: Floats
    dt: float
    scene: Scene
    random: np.random.Generator | None
    cache: dict[Hashable, Any]

    @classmethod
    def of(
        cls,
        scene: Scene,
        wish: Floats,
        limit: Floats,
        walking: NDArray[np.bool_],
        near: Neighbors,
        dt: float,
        random: np.random.Generator | None = None,
    ) -> NeighborView:
        """Return the view of the agents ``walking`` [E, A] in a scene with these neighbours."""
        row = np.flatnonzero(walking)
        A = max(1, scene.shape[1])
        agent = rows(near.agent)[row]
        there = agent >= 0
        other = np.where(there, agent + (row - row % A)[:, None], row[:, None])
        position, velocity, radius = rows(scene.position), rows(scene.velocity), rows(scene.radius)
        return cls(
            row,
            position[row],
            velocity[row],
            rows(wish)[row],
            rows(scene.goal)[row],
            radius[row],
            rows(limit)[row],
            rows(scene.preferred_speed)[row],
            position[row][:, None] - position[other],
            velocity[other],
            radius[row][:, None] + radius[other],
            there,
            rows(scene.external)[other],
            row[:, None] < other,
            scene.walls.segments(),
            dt,
            scene,
            random,
            {},
        )

    def __len__(self) -> int:
        """Return the number of agents."""
        return len(self.row)

    def part(self, begin: int, end: int) -> NeighborView:
        """Return the view of the agents ``begin`` to ``end`` (exclusive)."""
        shared = ("segments", "dt", "scene", "random", "cache")
        names = [field.name for field in dataclasses.fields(self) if field.name not in shared]
        cut: dict[str, Any] = {name: getattr(self, name)[begin:end] for name in names}
        return dataclasses.replace(self, **cut)

    def each(self, value: PerAgent, name: str) -> Floats:
        """Return a parameter of each agent ``[N]`` from a number or an array that broadcasts to ``[E, A]``."""
        if np.ndim(value) == 0:
            return np.full(len(self), value, dtype=np.float64)
        return rows(per_agent(value, self.scene.shape, name))[self.row]

    def compute_once(self, key: Hashable, answer: Callable[[], Any]) -> Any:
        """Return ``answer()``, computed once for all parts of this view."""
        if key not in self.cache:
            self.cache[key] = answer()
        return self.cache[key]

    def direction(self) -> Floats:
        """Return unit directions ``[N, 2]`` of the desired velocity; if it is 0, of the velocity or the heading."""
        heading = rows(self.scene.heading)[self.row]
        ahead = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
        for way in (self.velocity, self.wish):
            length = np.sqrt(way[:, 0] ** 2 + way[:, 1] ** 2)[:, None]
            ahead = np.where(length > 0.0, way / np.where(length > 0.0, length, 1.0), ahead)
        return ahead

    def contact_times(self, candidates: Floats) -> Floats:
        """Return the time to contact of each velocity ``[N, C, 2]`` with each neighbour, ``[N, C, K]`` [s], or inf.

        Neighbours keep their velocities. Existing contacts are ignored.
        """
        x, y = self.offset[:, None, :, 0], self.offset[:, None, :, 1]
        vx = candidates[:, :, None, 0] - self.motion[:, None, :, 0]
        vy = candidates[:, :, None, 1] - self.motion[:, None, :, 1]
        apart = x * x + y * y - self.reach[:, None] ** 2
        meets = self.there[:, None] & (apart > 0.0)
        return _contact_time(x, y, vx, vy, apart, meets)

    def wall_times(self, candidates: Floats) -> Floats:
        """Return the time to contact of each velocity ``[N, C, 2]`` with a wall, ``[N, C]`` [s], or inf.

        Existing contacts are ignored.
        """
        best = np.full(candidates.shape[:2], np.inf)
        vx, vy = candidates[..., 0], candidates[..., 1]
        radius = self.radius[:, None]
        for ax, ay, bx, by in self.segments:
            px, py = self.position[:, :1] - ax, self.position[:, 1:] - ay
            ex, ey = bx - ax, by - ay
            length = np.sqrt(ex * ex + ey * ey)
            s = np.clip((px * ex + py * ey) / length**2, 0.0, 1.0)
            touching = (px - s * ex) ** 2 + (py - s * ey) ** 2 <= radius**2
            height, rate = (px * ey - py * ex) / length, (vx * ey - vy * ex) / length
            height, rate = np.abs(height), np.where(height < 0.0, -rate, rate)
            t = np.where(rate < 0.0, (height - radius) / np.where(rate < 0.0, -rate, 1.0), np.inf)
            foot = (px + vx * np.where(np.isfinite(t), t, 0.0)) * ex + (py + vy * np.where(np.isfinite(t), t, 0.0)) * ey
            t = np.where((t >= 0.0) & (foot >= 0.0) & (foot <= length**2), t, np.inf)
            for qx, qy in ((px, py), (px - ex, py - ey)):
                apart = qx * qx + qy * qy - radius**2
                t = np.minimum(t, _contact_time(qx, qy, vx, vy, apart, apart > 0.0))
            best = np.where(touching, best, np.minimum(best, t))
        return best

    def sum_overlaps(self) -> Floats:
        """Return the sum ``[N, 2]`` [m] of the overlap vectors of each agent with bodies and walls, pointing away."""
        distance = np.sqrt(self.offset[..., 0] ** 2 + self.offset[..., 1] ** 2)
        deep = np.where(self.there, np.maximum(self.reach - distance, 0.0), 0.0)
        away = self.offset / np.maximum(distance, 1e-300)[..., None]
        same = np.where(self.first, -1.0, 1.0)  # at the same position, one moves left and one right
        away[..., 0] = np.where(distance > 0.0, away[..., 0], same)
        total = np.sum(deep[..., None] * away, axis=1)
        for segment in self.segments:
            start, along = segment[:2], segment[2:] - segment[:2]
            s = np.clip((self.position - start) @ along / (along @ along), 0.0, 1.0)
            way = self.position - start - s[:, None] * along
            gap = np.sqrt(way[:, 0] ** 2 + way[:, 1] ** 2)
            total += (np.maximum(self.radius - gap, 0.0) / np.maximum(gap, 1e-300))[:, None] * way
        return np.asarray(total)

    def nearest_on_walls(self, points: Floats) -> Floats:
        """Return the nearest wall point ``[N, 2]`` of each of ``points`` [N, 2]; inf without walls."""
        best, least = np.full(points.shape, np.inf), np.full(len(points), np.inf)
        for segment in self.segments:
            start, along = segment[:2], segment[2:] - segment[:2]
            s = np.clip((points - start) @ along / (along @ along), 0.0, 1.0)
            foot = start + s[:, None] * along
            gap2 = np.sum((points - foot) ** 2, axis=1)
            best = np.where((gap2 < least)[:, None], foot, best)
            least = np.minimum(least, gap2)
        return best

    def first_contact(self, candidates: Floats) -> Floats:
        """Return the time to the first contact of each velocity ``[N, C, 2]``, ``[N, C]`` [s], or inf."""
        return np.asarray(
            np.minimum(np.min(self.contact_times(candidates), -1, initial=np.inf), self.wall_times(candidates))
        )


def _contact_time(x: Floats, y: Floats, vx: Floats, vy: Floats, apart: Floats, meets: Any) -> Floats:
    """Return the time to contact (see :func:`crowdbot.core.geometry.time_to_contact`) where ``meets``, else inf."""
    a, b = vx * vx + vy * vy, x * vx + y * vy
    root = b * b - a * apart
    meets = meets & (b < 0.0) & (root > 0.0)
    return np.where(meets, apart / np.where(meets, np.sqrt(np.maximum(root, 0.0)) - b, 1.0), np.inf)
