"""AnticipationVelocity: velocity-based model with anticipation (Xu, Chraibi, Seyfried 2021)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.models.model import CrowdModel, begin_step, launch, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import parameter_columns
from crowdbot.models.valid_range import JAMS, JUPEDSIM, TWO_WAY, ModelRange
from crowdbot.typing import Floats

from .collision_free_speed import is_hidden, way_to, within

CREEP = 0.01
"""Below this speed [m/s] agents shuffle: forward, backward or not at all."""
ALIGNED = 1e-3
"""Lateral offset [m] below which a neighbour counts as exactly ahead."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

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
    """1 or -1: passes a neighbour exactly ahead on the left or right."""
    shuffle: Floats
    """1, 0 or -1: moves forward, not at all or backward without free space; NaN: no shuffling."""
    walking: NDArray[np.bool_]


@kernel
def _deflect_from_walls(
    walls: Floats, found: NDArray[np.int64], count: int, x: float, y: float, near: float, push: float,
    ux: float, uy: float,
) -> tuple[float, float]:  # fmt: skip
    """Remove the component of u towards walls: all of it within ``near``, linearly less up to twice that distance.

    Within ``near``, add ``push`` away from the wall. Return a unit vector, or zeros if the result is 0.
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


@kernel
def _influence(
    dx: float, dy: float, gx: float, gy: float, wx: float, wy: float, ox: float, oy: float, facing: float,
    contact: float, strength: float, scale: float, ahead: float, other_ahead: float, side: float,
) -> float:  # fmt: skip
    """Return the influence of a neighbour on the direction, positive to the left of the desired direction g.

    Args:
        dx, dy: position of the neighbour relative to the agent [m].
        gx, gy: desired direction.
        wx, wy: velocity of the agent [m/s].
        ox, oy: velocity of the neighbour [m/s].
        facing: heading of the neighbour [rad].
        contact: sum of the radii [m].
        strength, scale: strength [1] and range [m] of the influence.
        ahead, other_ahead: anticipation time of the agent and of the neighbour [s].
        side: side for a neighbour that will be exactly ahead, 1 left or -1 right.
    """
    distance = math.sqrt(dx * dx + dy * dy)
    closing = ((wx - ox) * dx + (wy - oy) * dy) / distance if distance > 0.0 else 0.0
    left = max(0.0, distance - contact - closing * ahead)
    against = 1.5 - 0.5 * (gx * math.cos(facing) + gy * math.sin(facing))
    aside = gx * (dy + oy * other_ahead) - gy * (dx + ox * other_ahead)
    way = side if abs(aside) < ALIGNED else -math.copysign(1.0, aside)
    return way * strength * against * math.exp(-left / scale)


@kernel
def _turn(ux: float, uy: float, hx: float, hy: float, gx: float, gy: float, share: float) -> tuple[float, float]:
    """Return the heading h turned to u by ``share``, or u if only one of them points towards the goal direction g."""
    if (gx * ux + gy * uy) * (gx * hx + gy * hy) < 0.0:
        return ux, uy
    ux, uy = hx + (ux - hx) * share, hy + (uy - hy) * share
    length = math.sqrt(ux * ux + uy * uy)
    return (ux / length, uy / length) if length > 0.0 else (hx, hy)


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, turned: Floats, out: Floats) -> None:
    """Choose the next velocity and heading of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, dt, turned, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: Floats, dt: float, turned: Floats, out: Floats
) -> None:
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, heading, desired, radius, top, strength, scale = crowd[:8]
    gap, anticipation, reaction, buffer, pushout, reach, side, shuffle, walking = crowd[8:]
    agent, number, order = near
    A = agent.shape[1]
    found = np.empty(len(walls), dtype=np.int64)
    seen = np.empty((agent.shape[2], 3))  # relative position of each visible neighbour, and sum of the radii
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
        aside, held = 0.0, 0
        for n in range(number[e, a]):
            o = row - a + agent[e, a, n]
            dx, dy, contact = place[o, 0] - x, place[o, 1] - y, radius[row] + radius[o]
            if is_hidden(walls, found, count, x, y, dx, dy):
                continue
            seen[held, 0], seen[held, 1], seen[held, 2] = dx, dy, contact
            held += 1
            if gx * dx + gy * dy >= 0.0 or hx * dx + hy * dy >= 0.0:
                aside += _influence(
                    dx, dy, gx, gy, velocity[row, 0], velocity[row, 1], velocity[o, 0], velocity[o, 1], heading[o],
                    contact, strength[row], scale[row], anticipation[row], anticipation[o], side[row],
                )  # fmt: skip
        length = math.sqrt(1.0 + aside * aside)
        ux, uy = _turn((gx - aside * gy) / length, (gy + aside * gx) / length, hx, hy, gx, gy, dt / reaction[row])
        ux, uy = _deflect_from_walls(walls, found, count, x, y, radius[row] + buffer[row], pushout[row], ux, uy)
        speed = min(wish, top[row])
        for n in range(held):
            speed = min(speed, max(0.0, way_to(seen[n, 0], seen[n, 1], ux, uy, seen[n, 2])) / gap[row])
        if speed < min(CREEP, wish) and not math.isnan(shuffle[row]):
            speed = shuffle[row] * min(CREEP, top[row])
        out[row, 0], out[row, 1] = speed * ux, speed * uy
        if ux != 0.0 or uy != 0.0:
            turned[row] = math.atan2(uy, ux)


@dataclass(frozen=True)
class AnticipationVelocity(CrowdModel):
    """Velocity-based model with anticipation: agents turn towards the side that will be free and keep a time gap ahead.

    Args:
        strength: strength of the influence of a neighbour, relative to 1 for the desired direction.
        range: decay length of the influence [m].
        time_gap: time gap to the next agent ahead at the chosen speed [s].
        anticipation_time: prediction time for the motion of neighbours [s].
        reaction_time: time constant of the heading [s]; at least the time step.
        wall_buffer: clearance between body and wall [m] below which agents do not walk towards the wall; up to twice
            the distance of the centre, the direction is deflected.
        pushout: component of the direction away from the wall within the clearance.
        neighbor_distance: maximum distance of neighbours and walls [m]; neighbours behind a wall are ignored.
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    The heading is a separate state (``Scene.heading``), which also changes at rest; :meth:`step` updates it.
    With ``rng``, agents slower than 0.01 m/s shuffle forward, backward or not at all, and agents that meet
    exactly head on choose a random side. Without it, agents do not shuffle and pass on the right.

    The default follows the implementation in JuPedSim 1.4.2, including its parameters and its wall buffer. Difference:
    the ends of a wall deflect, too. Without ``rng`` the model is deterministic.

    Source: Xu, Chraibi, Seyfried 2021, doi:10.1016/j.trc.2021.103464, as in JuPedSim 1.4.2.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> meeting = Scene.of([[0, 0], [4, 0.1]], [[1, 0], [-1, 0]], radius=0.2, goal=[[9, 0], [-9, 0.1]])
    >>> AnticipationVelocity().velocity(meeting, dt=0.1).round(3).tolist()
    [[[1.3, 0.0], [-1.3, 0.0]]]
    >>> nearer = meeting.replace(position=meeting.position * [0.5, 1.0])
    >>> AnticipationVelocity().velocity(nearer, dt=0.1).round(3).tolist()
    [[[1.17, -0.566], [-1.17, 0.566]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Qiancheng Xu, Mohcine Chraibi, Armin Seyfried",
        2021,
        "Anticipation in a velocity-based model for pedestrian dynamics",
        "Transportation Research Part C",
        "10.1016/j.trc.2021.103464",
    )
    batched = True
    valid_range = ModelRange(0.5, JAMS, 0.01, TWO_WAY, JUPEDSIM)

    strength: PerAgent = parameter(8.0, unit="1", low=1.0, high=15.0, source="JuPedSim 1.4.2")
    range: PerAgent = parameter(0.1, unit="m", low=0.02, high=0.5, source="JuPedSim 1.4.2", min=1e-3)
    time_gap: PerAgent = parameter(1.06, unit="s", low=0.3, high=2.0, source="JuPedSim 1.4.2", min=1e-2)
    anticipation_time: PerAgent = parameter(1.0, unit="s", low=0.0, high=3.0, source="JuPedSim 1.4.2")
    reaction_time: PerAgent = parameter(0.3, unit="s", low=0.1, high=1.0, source="JuPedSim 1.4.2")
    wall_buffer: PerAgent = parameter(0.1, unit="m", low=0.0, high=0.5, source="JuPedSim 1.4.2")
    pushout: PerAgent = parameter(0.3, unit="1", low=0.0, high=1.0, source="JuPedSim 1.4.2")
    neighbor_distance: PerAgent = parameter(3.0, unit="m", low=1.0, high=5.0, source="JuPedSim 1.4.2")
    max_neighbors: PerAgent = parameter(50.0, unit="1", low=5.0, high=100.0, source="crowdbot: more are never needed")
    max_speed: PerAgent | None = None

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        return self._move(scene, dt, rng)[0]

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        velocity, heading = self._move(scene, dt, rng)
        return scene.advance(velocity, dt).replace(heading=heading)

    def _move(self, scene: Scene, dt: float, rng: np.random.Generator | None) -> tuple[Floats, Floats]:
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        side, shuffle = np.full(scene.shape, -1.0), np.full(scene.shape, np.nan)
        if rng is not None:
            side = 2.0 * rng.integers(0, 2, scene.shape) - 1.0
            shuffle = rng.integers(-1, 2, scene.shape).astype(np.float64)
        values = (
            rows(scene.position),
            rows(np.where(scene.active[..., None], scene.velocity, 0.0)),
            rows(scene.heading),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            *parameter_columns(self, scene.shape, "strength", "range", "time_gap", "anticipation_time"),
            rows(np.maximum(per_agent(self.reaction_time, scene.shape, "reaction_time"), dt)),
            *parameter_columns(self, scene.shape, "wall_buffer", "pushout", "neighbor_distance"),
            rows(side),
            rows(shuffle),
            rows(walking),
        )
        crowd = _Crowd._make(values)
        heading = scene.heading.copy()
        launch(_choose, _choose_part, rows(out), crowd, near, scene.walls.segments(), float(dt), rows(heading))
        return out, heading
