"""Boids: steering rules with predictive separation (Reynolds 1987)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.core.neighbors import nearest
from crowdbot.models.model import CrowdModel, begin_step, check_variant, launch, rows, speed_limit
from crowdbot.models.parameter_rows import limit_length, parameter_rows
from crowdbot.models.valid_range import FREE, PAGE, ModelRange
from crowdbot.typing import Floats

from .wall_surfaces import WallSurfaces, is_nearest_corner, wall_surfaces

VARIANTS = ("predictive", "crowdbot")
WALL_REACH = math.sqrt(2.0)
"""Range of walls in the CrowdBot simulator, in radii."""
WALL_SHARE = 7.6
"""Ratio of wall push to agent push in the CrowdBot simulator."""
SIMULATOR_SPEED = 2.5
"""Speed limit of the CrowdBot simulator [m/s]."""
TOUCH = 1e-6
"""Below this fraction of the reach, the predicted offset has no direction."""
CANDIDATES = 32
"""Number of near agents searched for the nearest body."""

LAW = (
    "goal_gain",
    "zone_factor",
    "zone_gain",
    "look_ahead",
    "margin",
    "separation",
    "alignment",
    "cohesion",
    "flock_distance",
    "max_acceleration",
)


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    walking: NDArray[np.bool_]
    law: Floats
    """``[E * A, 10]`` in the order of :data:`LAW`, or ``[1, 10]`` for all."""


@kernel
def _separation(x: float, y: float, vx: float, vy: float, time: float, reach: float) -> tuple[float, float]:
    """Return the push away from the origin: 0 if x, y is at distance ``reach`` after ``time``, 1 at distance 0."""
    now = math.sqrt(x * x + y * y)
    tx, ty = x + vx * time, y + vy * time
    then = math.sqrt(tx * tx + ty * ty)
    if then >= reach:
        return 0.0, 0.0
    if then > TOUCH * reach:
        return (1.0 / then - 1.0 / reach) * tx, (1.0 / then - 1.0 / reach) * ty
    if now == 0.0:
        return 0.0, 0.0
    size = 1.0 - then / reach  # predicted at the origin: use the current direction
    return size * x / now, size * y / now


@kernel
def _closest_approach_time(x: float, y: float, vx: float, vy: float, ahead: float) -> float:
    """Return the time at which x, y is nearest to the origin, from now to ``ahead``."""
    closing, speed2 = -(x * vx + y * vy), vx * vx + vy * vy
    if closing <= 0.0:
        return 0.0
    return ahead if closing >= ahead * speed2 else closing / speed2


@kernel
def _neighbor_acceleration(
    row: int,
    a: int,
    place: Floats,
    velocity: Floats,
    radius: Floats,
    agent: NDArray[np.int32],
    number: int,
    law: Floats,
) -> tuple[float, float]:
    """Return the acceleration by neighbours: separation from predicted positions, alignment and cohesion."""
    ahead, margin, separation, alignment, cohesion, flock = law[3], law[4], law[5], law[6], law[7], law[8]
    x, y, vx, vy = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1]
    ax = ay = 0.0
    dx = dy = dvx = dvy = 0.0
    mates = 0
    for n in range(number):
        other = row - a + agent[n]
        ox, oy = x - place[other, 0], y - place[other, 1]
        wx, wy = vx - velocity[other, 0], vy - velocity[other, 1]
        reach = radius[row] + radius[other] + margin
        px, py = _separation(ox, oy, wx, wy, _closest_approach_time(ox, oy, wx, wy, ahead), reach)
        ax, ay = ax + separation * px, ay + separation * py
        if ox * ox + oy * oy < flock * flock:
            dx, dy, dvx, dvy = dx - ox, dy - oy, dvx - wx, dvy - wy
            mates += 1
    if mates > 0:
        ax += (alignment * dvx + cohesion * dx) / mates
        ay += (alignment * dvy + cohesion * dy) / mates
    return ax, ay


@kernel
def _wall_acceleration(
    x: float, y: float, vx: float, vy: float, radius: float, ahead: float, margin: float, separation: float,
    face: Floats, corner: Floats, arm: Floats, first: NDArray[np.int64],
) -> tuple[float, float]:  # fmt: skip
    """Return the acceleration by walls, away from predicted positions near them."""
    ax = ay = 0.0
    reach = radius + margin
    for k in range(len(face)):
        ux, uy = face[k, 4], face[k, 5]
        height = (x - face[k, 0]) * uy - (y - face[k, 1]) * ux
        closing = vy * ux - vx * uy
        if height <= 0.0 or (height >= reach and height - closing * ahead >= reach):
            continue
        time = 0.0 if closing <= 0.0 else ahead if height >= closing * ahead else height / closing
        tx, ty = x + vx * time, y + vy * time
        if (tx - face[k, 0]) * ux + (ty - face[k, 1]) * uy <= 0.0:
            continue
        if (tx - face[k, 2]) * ux + (ty - face[k, 3]) * uy >= 0.0:
            continue
        size = separation * (1.0 - max(0.0, height - closing * time) / reach)
        ax, ay = ax + size * uy, ay - size * ux
    for c in range(len(corner)):
        ox, oy = x - corner[c, 0], y - corner[c, 1]
        time = _closest_approach_time(ox, oy, vx, vy, ahead)
        px, py = _separation(ox, oy, vx, vy, time, reach)
        if (px != 0.0 or py != 0.0) and is_nearest_corner(corner, arm, first, c, x + vx * time, y + vy * time):
            ax, ay = ax + separation * px, ay + separation * py
    return ax, ay


@kernel
def _simulator_acceleration(
    row: int, a: int, place: Floats, radius: Floats, agent: NDArray[np.int32], number: int, zone: float, gain: float,
    segment: Floats,
) -> tuple[float, float]:  # fmt: skip
    """Return the push in the CrowdBot simulator: by the nearest agent and the nearest wall."""
    x, y, own = place[row, 0], place[row, 1], radius[row]
    ax = ay = ox = oy = 0.0
    nearest_body = distance = math.inf
    for n in range(number):
        other = row - a + agent[n]
        dx, dy = x - place[other, 0], y - place[other, 1]
        length = math.sqrt(dx * dx + dy * dy)
        if length - radius[other] < nearest_body:
            nearest_body, distance, ox, oy = length - radius[other], length, dx, dy
    to_wall, wx, wy = math.inf, 0.0, 0.0
    for k in range(len(segment)):
        fx, fy = nearest_on_segment(x, y, segment[k, 0], segment[k, 1], segment[k, 2], segment[k, 3])
        length = math.sqrt((x - fx) ** 2 + (y - fy) ** 2)
        if length < to_wall:
            to_wall, wx, wy = length, x - fx, y - fy
    gap = distance
    if to_wall < WALL_REACH * own:
        gap = to_wall  # as in the simulator: the wall distance replaces the neighbour distance
        size = WALL_SHARE * gain * (1.0 - to_wall / zone) ** 2
        ax, ay = size * wx, size * wy
    if distance < zone:
        size = gain * (1.0 - gap / zone) ** 2
        ax, ay = ax + size * ox, ay + size * oy
    return ax, ay


@kernel(parallel=True)
def _choose(
    crowd: _Crowd, near: Neighbors, walls: WallSurfaces, segment: Floats, simulator: bool, dt: float, out: Floats
) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, walls, segment, simulator, dt, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: WallSurfaces, segment: Floats, simulator: bool,
    dt: float, out: Floats,
) -> None:  # fmt: skip
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, desired, radius, top, walking, laws = crowd
    agent, number, order = near
    face, corner, arm, first = walls
    A = agent.shape[1]
    for n in range(begin, end):
        row = order[n]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        vx, vy = velocity[row, 0], velocity[row, 1]
        law = laws[row if len(laws) > 1 else 0]
        ax, ay = law[0] * (desired[row, 0] - vx), law[0] * (desired[row, 1] - vy)
        if simulator:
            px, py = _simulator_acceleration(
                row, a, place, radius, agent[e, a], number[e, a], law[1] * radius[row], law[2], segment
            )
            ax, ay = ax + px, ay + py
        else:
            px, py = _neighbor_acceleration(row, a, place, velocity, radius, agent[e, a], number[e, a], law)
            qx, qy = _wall_acceleration(
                place[row, 0], place[row, 1], vx, vy, radius[row], law[3], law[4], law[5], face, corner, arm, first
            )
            ax, ay = limit_length(ax + px + qx, ay + py + qy, law[9])
        out[row, 0], out[row, 1] = limit_length(vx + ax * dt, vy + ay * dt, top[row])


@dataclass(frozen=True)
class Boids(CrowdModel):
    """Boids with a goal: agents separate from the predicted positions of others; alignment and cohesion are optional.

    Args:
        goal_gain: inverse of the relaxation time to the desired velocity [1/s].
        look_ahead: prediction time at constant velocity [s]; 0 uses current positions only.
        margin: clearance between bodies [m] below which they push apart.
        separation: push [m/s^2] at a predicted distance of 0, falling linearly to 0 at a clearance of ``margin``; the
            smallest distance within ``look_ahead`` is used. Above twice ``goal_gain`` times the speed, an agent stops
            before bodies of equal size and margin overlap.
        alignment: pull to the mean velocity of the flock [1/s].
        cohesion: pull to the mean position of the flock [1/s^2].
        flock_distance: maximum distance of the flock [m].
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_acceleration: limit of the sum of all rules [m/s^2].
        zone_factor: radius of the separation zone of the ``crowdbot`` variant, in radii of the agent [1].
        zone_gain: push per distance in the separation zone [1/s^2].
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene, in ``crowdbot`` 2.5 m/s.
        variant: ``predictive``, or ``crowdbot``, the law of the CrowdBot simulator: one push by the nearest body and
            one by the nearest wall, no prediction. ``crowdbot`` uses only ``goal_gain``, ``zone_factor``, ``zone_gain``
            and ``max_speed``; ``predictive`` uses all parameters except the zone.

    The default variant is ``predictive``. Unlike the original, separation acts on predicted positions and an attraction
    to the goal is added; alignment and cohesion are off.

    Source: Reynolds 1987, doi:10.1145/37401.37406; goal and prediction as in Wolinski et al. 2014,
    doi:10.1111/cgf.12328, whose constants are not published; the defaults separate 20 people who exchange positions on
    a circle.

    Raises:
        InputError: a parameter is not finite or below its minimum, or the variant is unknown.

    >>> ahead = Scene.of([[0, 0], [3, 0.1]], [[1, 0], [-1, 0]], preferred_velocity=[[1, 0], [-1, 0]])
    >>> Boids().velocity(ahead, dt=0.1).round(3).tolist()
    [[[1.0, -0.5], [-1.0, 0.5]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Craig W. Reynolds", 1987, "Flocks, herds and schools: a distributed behavioral model", "SIGGRAPH",
        "10.1145/37401.37406",
    )  # fmt: skip
    batched = True
    valid_range = ModelRange(0.7, FREE, 0.1, PAGE, "CrowdBot simulator")

    goal_gain: PerAgent = parameter(3.5, unit="1/s", low=1.0, high=8.0, source="CrowdBot simulator, measured")
    look_ahead: PerAgent = parameter(
        1.5, unit="s", low=0.0, high=4.0, source="20 people exchange positions on a circle"
    )
    margin: PerAgent = parameter(0.5, unit="m", low=0.1, high=1.5, source="own choice, personal space", min=1e-3)
    separation: PerAgent = parameter(
        12.0, unit="m/s^2", low=1.0, high=30.0, source="20 people exchange positions on a circle"
    )
    alignment: PerAgent = parameter(0.0, unit="1/s", low=0.0, high=2.0, source="off by default")
    cohesion: PerAgent = parameter(0.0, unit="1/s^2", low=0.0, high=2.0, source="off by default")
    flock_distance: PerAgent = parameter(3.0, unit="m", low=1.0, high=10.0, source="own choice")
    neighbor_distance: PerAgent = parameter(6.0, unit="m", low=1.0, high=15.0, source="look_ahead at walking speed")
    max_neighbors: PerAgent = parameter(
        30.0, unit="1", low=1.0, high=60.0, source="crowdbot: all relevant agents up to 1 person/m^2"
    )
    max_acceleration: PerAgent = parameter(5.0, unit="m/s^2", low=1.0, high=20.0, source="UMANS, default of agents")
    zone_factor: PerAgent = parameter(5.4, unit="1", low=2.0, high=8.0, source="CrowdBot simulator, measured", min=1e-3)
    zone_gain: PerAgent = parameter(65.0, unit="1/s^2", low=10.0, high=150.0, source="CrowdBot simulator, measured")
    max_speed: PerAgent | None = None
    variant: str = "predictive"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_variant(self, self.variant, VARIANTS)

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        wish, walking, seen, out = begin_step(scene, dt)
        simulator = self.variant == "crowdbot"
        reach = per_agent(self.neighbor_distance, scene.shape, "neighbor_distance")
        most = np.rint(per_agent(self.max_neighbors, scene.shape, "max_neighbors"))
        top = self.max_speed
        if simulator:  # agents in the zone, and those whose body is nearer than that of an agent in the zone
            zone = per_agent(self.zone_factor, scene.shape, "zone_factor") * np.where(scene.active, scene.radius, 0.0)
            reach, most = zone + np.max(scene.radius, where=seen, initial=0.0), np.full(scene.shape, CANDIDATES)
            top = SIMULATOR_SPEED if top is None else top
        crowd = _Crowd(
            rows(scene.position),
            rows(scene.velocity),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(top, scene)),
            rows(walking),
            parameter_rows(self, LAW, scene.shape),
        )
        near = nearest(scene.position, reach, most, seen, walking)
        walls = wall_surfaces(scene.walls), np.ascontiguousarray(scene.walls.segments())
        launch(_choose, _choose_part, rows(out), crowd, near, *walls, simulator, float(dt))
        return out
