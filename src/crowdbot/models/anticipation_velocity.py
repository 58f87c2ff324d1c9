"""Anticipation velocity: people turn to the side that will be free and walk as fast as the way ahead allows."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numba import prange
from numpy.typing import NDArray

from crowdbot.core.geometry import nearest_on_segment
from crowdbot.core.kernels import kernel
from crowdbot.core.neighbors import CHUNK, Neighbors, nearest
from crowdbot.core.paper import Paper
from crowdbot.core.parameter import PerAgent, parameter, per_agent
from crowdbot.core.scene import Scene

from .collision_free_speed import is_hidden, way_to, within
from .model import CrowdModel, check_limit, kept, rows, speed_limit, walkers, wishes

__all__ = ["AnticipationVelocity"]

Floats = NDArray[np.float64]

CREEP = 0.01
"""Below this speed [m/s] people shuffle: forward, backward or not at all."""
ALIGNED = 1e-3
"""Who will be so near the line of the own walk [m] may be passed on either side."""


class _Crowd(NamedTuple):
    """What the kernel reads of every agent, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    heading: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    strength: Floats
    range: Floats
    time_gap: Floats
    anticipation: Floats
    reaction: Floats
    wall_buffer: Floats
    pushout: Floats
    reach: Floats
    side: Floats
    """1 or -1: goes to the left or right of who stands exactly ahead."""
    shuffle: Floats
    """1, 0 or -1: goes forward, not at all or backward when there is hardly room; NaN does not."""
    walking: NDArray[np.bool_]


@kernel
def _away_from_walls(
    walls: Floats, found: NDArray[np.int64], count: int, x: float, y: float, near: float, push: float,
    ux: float, uy: float,
) -> tuple[float, float]:  # fmt: skip
    """Take out of u what leads into walls, all of it nearer than ``near``, less and less up to twice that distance.

    Nearer than ``near``, ``push`` away from the wall is added. Return a unit vector, or zeros when nothing is left.
    """
    for n in range(count):
        m = found[n]
        nx, ny = nearest_on_segment(x, y, walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3])
        nx, ny = x - nx, y - ny
        distance = math.sqrt(nx * nx + ny * ny)
        if distance >= 2.0 * near or distance == 0.0:
            continue
        nx, ny = nx / distance, ny / distance
        inward = ux * nx + uy * ny
        if inward < 0.0:
            change = push - inward if distance <= near else -inward * (2.0 - distance / near)
            ux, uy = ux + change * nx, uy + change * ny
    length = math.sqrt(ux * ux + uy * uy)
    return (ux / length, uy / length) if length > 0.0 else (0.0, 0.0)


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, out: Floats, turned: Floats) -> None:
    """Choose the next velocity and heading of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, dt, out, turned)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, out: Floats, turned: Floats
) -> None:
    # fields are taken out of the tuples here: inside the loop each access would count references
    place, velocity, heading, desired, radius, top, strength, scale = crowd[:8]
    gap, anticipation, reaction, buffer, pushout, reach, side, shuffle, walking = crowd[8:]
    agent, number, order = near
    A = agent.shape[1]
    found = np.empty(len(walls), dtype=np.int64)
    seen = np.empty((agent.shape[2], 3))  # where a neighbour is from here, and the least distance from it
    for k in range(begin, end):
        row = order[k]
        wish = math.sqrt(desired[row, 0] ** 2 + desired[row, 1] ** 2)
        if not walking[row] or wish == 0.0:
            continue
        e, a = row // A, row % A
        x, y = place[row, 0], place[row, 1]
        gx, gy = desired[row, 0] / wish, desired[row, 1] / wish
        hx, hy = math.cos(heading[row]), math.sin(heading[row])
        count = within(walls, x, y, reach[row], found)
        aside = 0.0  # the sum of all influences: they point across the desired direction, to its left
        held = 0
        for n in range(number[e, a]):
            other = row - a + agent[e, a, n]
            dx, dy = place[other, 0] - x, place[other, 1] - y
            if is_hidden(walls, found, count, x, y, dx, dy):
                continue
            contact = radius[row] + radius[other]
            seen[held, 0], seen[held, 1], seen[held, 2] = dx, dy, contact
            held += 1
            if gx * dx + gy * dy < 0.0 and hx * dx + hy * dy < 0.0:
                continue
            distance = math.sqrt(dx * dx + dy * dy)
            closing = 0.0
            if distance > 0.0:
                closing = ((velocity[row, 0] - velocity[other, 0]) * dx + (velocity[row, 1] - velocity[other, 1]) * dy)
                closing /= distance
            left = max(0.0, distance - contact - closing * anticipation[row])
            against = 1.5 - 0.5 * (gx * math.cos(heading[other]) + gy * math.sin(heading[other]))
            ahead = anticipation[other]
            place_left = gx * (dy + velocity[other, 1] * ahead) - gy * (dx + velocity[other, 0] * ahead)
            if abs(place_left) < ALIGNED:
                way = side[row]
            else:
                way = -1.0 if place_left > 0.0 else 1.0
            aside += way * strength[row] * against * math.exp(-left / scale[row])
        length = math.sqrt(1.0 + aside * aside)
        ux, uy = (gx - aside * gy) / length, (gy + aside * gx) / length
        if (gx * ux + gy * uy) * (gx * hx + gy * hy) >= 0.0:
            share = dt / reaction[row]
            ux, uy = hx + (ux - hx) * share, hy + (uy - hy) * share
            length = math.sqrt(ux * ux + uy * uy)
            ux, uy = (ux / length, uy / length) if length > 0.0 else (hx, hy)
        ux, uy = _away_from_walls(walls, found, count, x, y, radius[row] + buffer[row], pushout[row], ux, uy)
        free = math.inf
        for n in range(held):
            free = min(free, way_to(seen[n, 0], seen[n, 1], ux, uy, seen[n, 2]))
        speed = min(max(0.0, free / gap[row]), wish, top[row])
        if speed < CREEP and not math.isnan(shuffle[row]):
            speed = shuffle[row] * min(CREEP, top[row])
        out[row, 0], out[row, 1] = speed * ux, speed * uy
        if ux != 0.0 or uy != 0.0:
            turned[row] = math.atan2(uy, ux)


@dataclass(frozen=True)
class AnticipationVelocity(CrowdModel):
    """People foresee where others will be, turn gradually to the side that will be free, and keep a time gap ahead.

    Args:
        strength: of the influence of a neighbour, against 1 for the desired direction.
        range: over which it falls to 1/e [m].
        time_gap: time to the next one ahead at the chosen speed [s].
        anticipation_time: how far people foresee the way of the others [s].
        reaction_time: in which the heading follows the chosen direction [s]; no less than the time step counts.
        wall_buffer: from this distance between body and wall on [m] nobody walks towards the wall.
        pushout: there, how much of the direction leads away from the wall.
        neighbor_distance: neighbours and walls are no farther than this [m], and not hidden by a wall.
        max_neighbors: only so many of them count, the nearest; a fraction is rounded to the nearest whole number.
        max_speed: ``[E, A]`` [m/s]; None takes the maximum speed of the scene.

    The heading is a state of its own (``Scene.heading``) and turns even in those who stand; :meth:`step` writes it.
    With ``rng``, who would be slower than 0.01 m/s shuffles forward, backward or not at all, and who meets somebody
    exactly head on takes a random side; without, nobody shuffles, and all pass on the right.

    Source: Xu, Chraibi, Seyfried 2021, doi:10.1016/j.trc.2021.103464, as in JuPedSim 1.4.2.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> meeting = Scene.of([[0, 0], [4, 0.1]], [[1, 0], [-1, 0]], radius=0.2, goal=[[9, 0], [-9, 0.1]])
    >>> AnticipationVelocity().velocity(meeting, dt=0.1).round(3).tolist()
    [[[1.3, 0.0], [-1.3, 0.0]]]
    >>> nearer = meeting.replace(position=meeting.position * [0.5, 1.0])
    >>> AnticipationVelocity().velocity(nearer, dt=0.1).round(3).tolist()
    [[[1.173, -0.56], [-1.173, 0.56]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Qiancheng Xu, Mohcine Chraibi, Armin Seyfried",
        2021,
        "Anticipation in a velocity-based model for pedestrian dynamics",
        "Transportation Research Part C",
        "10.1016/j.trc.2021.103464",
    )

    strength: PerAgent = parameter(8.0, unit="1", low=1.0, high=15.0, source="JuPedSim 1.4.2")
    range: PerAgent = parameter(0.1, unit="m", low=0.02, high=0.5, source="JuPedSim 1.4.2", minimum=1e-3)
    time_gap: PerAgent = parameter(1.06, unit="s", low=0.3, high=2.0, source="JuPedSim 1.4.2", minimum=1e-2)
    anticipation_time: PerAgent = parameter(1.0, unit="s", low=0.0, high=3.0, source="JuPedSim 1.4.2")
    reaction_time: PerAgent = parameter(0.3, unit="s", low=0.1, high=1.0, source="JuPedSim 1.4.2")
    wall_buffer: PerAgent = parameter(0.1, unit="m", low=0.0, high=0.5, source="JuPedSim 1.4.2")
    pushout: PerAgent = parameter(0.3, unit="1", low=0.0, high=1.0, source="JuPedSim 1.4.2")
    neighbor_distance: PerAgent = parameter(3.0, unit="m", low=1.0, high=5.0, source="JuPedSim 1.4.2")
    max_neighbors: PerAgent = parameter(50.0, unit="1", low=5.0, high=100.0, source="chosen here: more are never needed")
    max_speed: PerAgent | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_limit(self, self.max_speed)

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        """Return the velocities ``[E, A, 2]`` [m/s] for the next ``dt`` [s]."""
        return self._move(scene, dt, rng)[0]

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        """Return the scene ``dt`` [s] later, with the headings of the model."""
        velocity, heading = self._move(scene, dt, rng)
        return scene.advanced(velocity, dt).replace(heading=heading)

    def _move(self, scene: Scene, dt: float, rng: np.random.Generator | None) -> tuple[Floats, Floats]:
        wish, walking = wishes(scene, dt), walkers(scene)
        reach = per_agent(self.neighbor_distance, scene.shape, "neighbor_distance")
        most = np.rint(per_agent(self.max_neighbors, scene.shape, "max_neighbors"))
        near = nearest(scene.position, reach, most, scene.active & scene.visible, walking)
        names = ("strength", "range", "time_gap", "anticipation_time", "reaction_time", "wall_buffer", "pushout")
        values = {name: per_agent(getattr(self, name), scene.shape, name) for name in names}
        values["reaction_time"] = np.maximum(values["reaction_time"], dt)
        side, shuffle = np.full(scene.shape, -1.0), np.full(scene.shape, np.nan)
        if rng is not None:
            side = 2.0 * rng.integers(0, 2, scene.shape) - 1.0
            shuffle = rng.integers(-1, 2, scene.shape).astype(np.float64)
        crowd = _Crowd(
            rows(scene.position),
            rows(np.where(scene.active[..., None], scene.velocity, 0.0)),
            rows(scene.heading),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            *(rows(value) for value in values.values()),
            rows(reach),
            rows(side),
            rows(shuffle),
            rows(walking),
        )
        out, heading = kept(scene), scene.heading.copy()
        _choose(crowd, near, np.require(scene.walls.segments(), requirements="CW"), float(dt), rows(out), rows(heading))
        return out, heading
