"""GroupForce: social forces measured in experiments, with group forces (Moussaïd et al. 2009 and 2010)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.core.neighbors import nearest
from crowdbot.models.model import CrowdModel, begin_step, check_variant, launch, rows, speed_limit
from crowdbot.models.parameter_rows import limit_length, parameter_rows
from crowdbot.models.valid_range import FREE, PAGE, ModelRange
from crowdbot.typing import Floats, Ints

from .wall_surfaces import surface_distance, wall_surfaces


class Groups(NamedTuple):
    """Group members: the group of a row is ``member[begin[row]:end[row]]``, including the row itself."""

    member: Ints
    begin: Ints
    end: Ints


def groups_of(scene: Scene) -> Groups:
    """Return the groups of ``scene``: agents of one environment with the same number, by rows ``e * A + a``.

    >>> pairs = groups_of(Scene.of([[0, 0], [5, 0], [1, 0]], group=[7, -1, 7]))
    >>> pairs.member.tolist(), pairs.begin.tolist(), pairs.end.tolist()
    ([0, 2], [0, 0, 0], [2, 0, 2])
    """
    environment = np.repeat(np.arange(scene.shape[0]), scene.shape[1])
    group = scene.group.reshape(-1)
    begin, end = np.zeros((2, len(group)), dtype=np.int64)
    member = np.flatnonzero((group >= 0) & scene.active.reshape(-1))
    place = scene.position.reshape(-1, 2)[member]
    # sorted by position within a group: sums do not depend on the order of agents
    member = member[np.lexsort((place[:, 1], place[:, 0], group[member], environment[member]))]
    if len(member) > 0:
        first = np.flatnonzero(np.diff(group[member], prepend=-1) | np.diff(environment[member], prepend=-1))
        size = np.diff(first, append=len(member))
        begin[member] = np.repeat(first, size)
        end[member] = np.repeat(first + size, size)
    return Groups(member, begin, end)


@kernel
def group_acceleration(
    row: int, begin: int, end: int, member: Ints, seen: NDArray[np.bool_], place: Floats, velocity: Floats,
    gaze: float, view_angle: float, cohesion: float, repulsion: float, apart: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the acceleration by the group: gaze, cohesion and repulsion (Moussaïd et al. 2010)."""
    x, y = place[row, 0], place[row, 1]
    ax = ay = sx = sy = 0.0
    others = 0
    for k in range(begin, end):
        mate = member[k]
        if mate == row or not seen[mate]:
            continue
        dx, dy = x - place[mate, 0], y - place[mate, 1]
        gap = math.sqrt(dx * dx + dy * dy)
        if 0.0 < gap < apart:
            ax, ay = ax + repulsion * dx / gap, ay + repulsion * dy / gap
        sx, sy = sx - dx, sy - dy
        others += 1
    length = math.sqrt(sx * sx + sy * sy)
    if length == 0.0:
        return ax, ay
    if length / (others + 1) > 0.5 * others:
        ax, ay = ax + cohesion * sx / length, ay + cohesion * sy / length
    vx, vy = velocity[row, 0], velocity[row, 1]
    speed = math.sqrt(vx * vx + vy * vy)
    if speed > 0.0:
        turned = math.acos(min(1.0, max(-1.0, (vx * sx + vy * sy) / (speed * length)))) - view_angle
        if turned > 0.0:
            ax, ay = ax - gaze * turned * vx, ay - gaze * turned * vy
    return ax, ay


@kernel
def pysocialforce_group_acceleration(
    row: int, begin: int, end: int, member: Ints, seen: NDArray[np.bool_], place: Floats, heading: Floats,
    repulsion: float, apart: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the acceleration by the group as PySocialForce 1.1.2 computes it.

    ``heading`` contains the unit direction to the goal and its distance [m]. Cohesion assumes that the distance to the
    centre is 0; the factors of gaze and cohesion are always 1.
    """
    x, y = place[row, 0], place[row, 1]
    ax = ay = sx = sy = 0.0
    others = 0
    for k in range(begin, end):
        mate = member[k]
        if mate == row or not seen[mate]:
            continue
        dx, dy = x - place[mate, 0], y - place[mate, 1]
        if dx * dx + dy * dy <= apart * apart:
            ax, ay = ax + repulsion * dx, ay + repulsion * dy
        sx, sy = sx - dx, sy - dy
        others += 1
    if others == 0:
        return 0.0, 0.0
    soft = 0.5 * (math.tanh(-0.5 * others) + 1.0) / (others + 1)
    ax, ay = ax + soft * sx, ay + soft * sy
    ex, ey, distance = heading[row, 0], heading[row, 1], heading[row, 2]
    if distance > 0.0:
        size = (sx * ex + sy * ey) / (others * distance)
        ax, ay = ax + size * ex, ay + size * ey
    return ax, ay


VARIANTS = ("moussaid", "pysocialforce")
ARRIVED = 0.5
"""Distance to the goal [m] below which PySocialForce stops an agent."""
BODY = 0.35
"""Radius of all bodies for wall forces in PySocialForce [m]."""
SIGHT = 3.35
"""Range of wall points in PySocialForce [m], measured from the body."""
POINTS = 10.0
"""Number of points per metre of wall in PySocialForce."""
NOTHING = 20.0
"""Forces with a larger decay exponent (a factor below 2e-9) are ignored."""
STEEPEST = 300.0
"""Upper limit of the exponent of the wall force, against overflow for deep overlaps."""
LAW = (
    "strength",
    "anticipation",
    "distance",
    "turn_width",
    "brake_width",
    "wall_strength",
    "wall_distance",
    "relaxation_time",
    "gaze",
    "view_angle",
    "cohesion",
    "repulsion",
    "group_distance",
    "neighbor_distance",
)


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    desired: Floats
    heading: Floats
    """``[E * A, 3]``: unit direction to the goal and its distance [m]."""
    radius: Floats
    max_speed: Floats
    walking: NDArray[np.bool_]
    seen: NDArray[np.bool_]
    law: Floats
    """``[E * A, 14]`` in the order of :data:`LAW`, or ``[1, 14]`` for all."""


class _Walls(NamedTuple):
    """Walls for both variants: faces and corners (see :mod:`.wall_surfaces`), and every segment ``[N, 4]``."""

    face: Floats
    corner: Floats
    arm: Floats
    first: Ints
    segment: Floats


@kernel
def _pair_force(
    x: float, y: float, wx: float, wy: float, anticipation: float, distance: float, turn: float, brake: float,
    wrapped: bool,
) -> tuple[float, float]:  # fmt: skip
    """Return the force in units of ``strength`` by a neighbour at -x, -y with relative velocity w.

    The force brakes along the interaction direction t and turns across it, away from the side of the neighbour.
    """
    gap = math.sqrt(x * x + y * y)
    if gap == 0.0:
        return 0.0, 0.0
    nx, ny = x / gap, y / gap
    tx, ty = anticipation * wx + nx, anticipation * wy + ny
    length = math.sqrt(tx * tx + ty * ty)
    reach = distance * length
    if reach <= 0.0 or gap > NOTHING * reach:
        return 0.0, 0.0
    tx, ty, far = tx / length, ty / length, gap / reach
    ahead, aside = nx * tx + ny * ty, nx * ty - ny * tx
    least = reach * min(turn, brake) * (abs(aside) if ahead > 0.0 else 1.0)  # an angle is at least its sine
    if far + least * least > NOTHING:
        return 0.0, 0.0
    angle = math.atan2(aside, ahead)
    if not wrapped:
        angle = math.atan2(ty, tx) - math.atan2(ny, nx)
    along, across = far + (brake * reach * angle) ** 2, far + (turn * reach * angle) ** 2
    along = math.exp(-along) if along < NOTHING else 0.0
    across = math.exp(-across) if across < NOTHING and angle != 0.0 else 0.0
    across = -across if angle > 0.0 else across
    return along * tx - across * ty, along * ty + across * tx


@kernel
def _wall_point_force(x: float, y: float, strength: float, distance: float, segment: Floats) -> tuple[float, float]:
    """Return the acceleration by walls as in PySocialForce, which represents walls as ten points per metre."""
    ax = ay = 0.0
    for k in range(len(segment)):
        sx, sy = segment[k, 0], segment[k, 1]
        ex, ey = segment[k, 2] - sx, segment[k, 3] - sy
        length = math.sqrt(ex * ex + ey * ey)
        count = math.floor(length * POINTS)
        if count < 1.0:
            continue
        step = 1.0 / max(1.0, count - 1.0)
        foot = ((x - sx) * ex + (y - sy) * ey) / (length * length)
        span = (SIGHT + BODY) / length
        low = math.floor(min(max((foot - span) / step, 0.0), count))
        high = math.ceil(min(max((foot + span) / step + 1.0, 0.0), count))
        for n in range(int(low), int(high)):
            dx, dy = x - sx - ex * (n * step), y - sy - ey * (n * step)
            gap = math.sqrt(dx * dx + dy * dy)
            if 0.0 < gap < BODY + SIGHT:
                size = strength * math.exp((BODY - gap) / distance) / gap
                ax, ay = ax + size * dx, ay + size * dy
    return ax, ay


@kernel(parallel=True)
def _choose(
    crowd: _Crowd, near: Neighbors, groups: Groups, walls: _Walls, package: bool, dt: float, out: Floats
) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, groups, walls, package, dt, out)


@kernel
def _choose_part(
    start: int, stop: int, crowd: _Crowd, near: Neighbors, groups: Groups, walls: _Walls, package: bool, dt: float,
    out: Floats,
) -> None:  # fmt: skip
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, desired, heading, radius, top, walking, seen, laws = crowd
    agent, number, order = near
    member, begin, end = groups
    face, corner, arm, first, segment = walls
    A = number.shape[1]
    for m in range(start, stop):
        row = order[m]
        if not walking[row] or (package and heading[row, 2] < ARRIVED):
            continue
        e, a, law = row // A, row % A, laws[row if len(laws) > 1 else 0]
        x, y, vx, vy = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1]
        fx = fy = 0.0
        for n in range(A if package else number[e, a]):
            other = row - a + (n if package else agent[e, a, n])
            if other != row and seen[other]:
                px, py = _pair_force(
                    x - place[other, 0], y - place[other, 1], velocity[other, 0] - vx, velocity[other, 1] - vy,
                    law[1], law[2], law[3], law[4], not package,
                )  # fmt: skip
                fx, fy = fx + px, fy + py
        ax = (desired[row, 0] - vx) / law[7] + law[0] * fx
        ay = (desired[row, 1] - vy) / law[7] + law[0] * fy
        if package:
            px, py = _wall_point_force(x, y, law[5], law[6], segment)
            qx, qy = pysocialforce_group_acceleration(
                row, begin[row], end[row], member, seen, place, heading, law[11], law[12]
            )  # fmt: skip
        else:
            px, py = _wall_surface_force(x, y, radius[row], law[5], law[6], law[13], face, corner, arm, first)
            qx, qy = group_acceleration(
                row, begin[row], end[row], member, seen, place, velocity, law[8], law[9], law[10], law[11], law[12]
            )
        ax, ay = ax + px + qx, ay + py + qy
        out[row, 0], out[row, 1] = limit_length(vx + dt * ax, vy + dt * ay, top[row])


@kernel
def _wall_surface_force(
    x: float, y: float, radius: float, strength: float, distance: float, sight: float,
    face: Floats, corner: Floats, arm: Floats, first: Ints,
) -> tuple[float, float]:  # fmt: skip
    """Return the acceleration by walls, which decays with the clearance of the body."""
    ax = ay = 0.0
    for k in range(len(face) + len(corner)):
        gap, nx, ny = surface_distance(face, corner, arm, first, k, x, y, radius + sight)
        if gap < math.inf:
            size = strength * math.exp(min((radius - gap) / distance, STEEPEST))
            ax, ay = ax + size * nx, ay + size * ny
    return ax, ay


@dataclass(frozen=True)
class GroupForce(CrowdModel):
    """Measured pair interactions (braking and turning) with group forces: gaze, cohesion and repulsion.

    Args:
        strength: strength of the force between two agents [m/s^2].
        anticipation: weight of the relative velocity in the interaction direction [s/m].
        distance: range of the force per length of the interaction vector [m].
        turn_width: angular decay of the turning force [1/(m rad)].
        brake_width: angular decay of the braking force [1/(m rad)].
        wall_strength: acceleration by a wall at contact [m/s^2].
        wall_distance: decay length of the wall force [m].
        relaxation_time: time constant to the desired velocity [s].
        gaze: braking if the group is out of view, per angle and speed [1/(s rad)].
        view_angle: half field of view [rad].
        cohesion: acceleration to the group centre if it is farther than ``(N - 1) / 2`` m in a group of N [m/s^2].
        repulsion: acceleration between group members nearer than ``group_distance`` [m/s^2].
        group_distance: maximum distance of the repulsion in a group [m].
        neighbor_distance: maximum distance of neighbours and walls [m], for walls measured from the body.
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.
        variant: ``moussaid``, or ``pysocialforce``, which reproduces version 1.1.2 of that package. It has no limits of
            neighbours and does not wrap the angle between neighbour and interaction direction to -pi..pi. The desired
            speed is the maximum speed. Agents stop within 0.5 m of the goal. Walls are rows of points, and bodies have
            a radius of 0.35 m for wall forces. Gaze acts along the direction to the goal, and repulsion grows with
            distance. ``gaze``, ``view_angle``, ``cohesion``, ``neighbor_distance`` and ``max_neighbors`` are ignored.

    Groups are the agents of one environment with the same number in ``scene.group``. There is no contact force: bodies
    overlap in very dense crowds.

    The default variant is ``moussaid``, the model of the papers. Strength, wall force and group distance are those of
    PySocialForce 1.1.2.

    Source: Moussaïd et al. 2010 (groups), Moussaïd et al. 2009, doi:10.1098/rspb.2009.0405 (pairs); strength, walls and
    group distance as in PySocialForce 1.1.2.

    Raises:
        InputError: a parameter is not finite or below its minimum, or the variant is unknown.

    >>> ahead = Scene.of([[0, 0], [3, 0.1]], [[1, 0], [-1, 0]], preferred_velocity=[[1, 0], [-1, 0]])
    >>> GroupForce().velocity(ahead, dt=0.1).round(3).tolist()
    [[[0.911, -0.092], [-0.911, 0.092]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Mehdi Moussaïd, Niriaska Perozo, Simon Garnier, Dirk Helbing, Guy Theraulaz",
        2010,
        "The walking behaviour of pedestrian social groups and its impact on crowd dynamics",
        "PLoS ONE 5(4), e10047",
        "10.1371/journal.pone.0010047",
    )
    batched = True
    valid_range = ModelRange(0.7, FREE, 0.1, PAGE, "PySocialForce tests")

    strength: PerAgent = parameter(5.1, unit="m/s^2", low=1.0, high=10.0, source="PySocialForce 1.1.2")
    anticipation: PerAgent = parameter(2.0, unit="s/m", low=0.5, high=4.0, source="Moussaïd et al. 2009")
    distance: PerAgent = parameter(0.35, unit="m", low=0.1, high=1.0, source="Moussaïd et al. 2009")
    turn_width: PerAgent = parameter(2.0, unit="1/(m rad)", low=0.5, high=5.0, source="Moussaïd et al. 2009")
    brake_width: PerAgent = parameter(3.0, unit="1/(m rad)", low=0.5, high=6.0, source="Moussaïd et al. 2009")
    wall_strength: PerAgent = parameter(10.0, unit="m/s^2", low=1.0, high=20.0, source="PySocialForce 1.1.2")
    wall_distance: PerAgent = parameter(0.2, unit="m", low=0.05, high=0.5, source="PySocialForce 1.1.2", min=1e-3)
    relaxation_time: PerAgent = parameter(0.5, unit="s", low=0.2, high=1.5, source="PySocialForce 1.1.2", min=1e-3)
    gaze: PerAgent = parameter(4.0, unit="1/(s rad)", low=0.0, high=8.0, source="Moussaïd et al. 2010")
    view_angle: PerAgent = parameter(0.5 * math.pi, unit="rad", low=0.5, high=math.pi, source="Moussaïd et al. 2010")
    cohesion: PerAgent = parameter(3.0, unit="m/s^2", low=0.0, high=6.0, source="Moussaïd et al. 2010")
    repulsion: PerAgent = parameter(1.0, unit="m/s^2", low=0.0, high=4.0, source="Moussaïd et al. 2010")
    group_distance: PerAgent = parameter(0.55, unit="m", low=0.3, high=1.2, source="PySocialForce 1.1.2")
    neighbor_distance: PerAgent = parameter(10.0, unit="m", low=1.0, high=15.0, source="own choice")
    max_neighbors: PerAgent = parameter(50.0, unit="1", low=1.0, high=100.0, source="own choice")
    max_speed: PerAgent | None = None
    variant: str = "moussaid"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_variant(self, self.variant, VARIANTS)

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        wish, walking, seen, out = begin_step(scene, dt)
        package = self.variant == "pysocialforce"
        top = speed_limit(self.max_speed, scene)
        heading = _heading(scene, wish)
        crowd = _Crowd(
            rows(scene.position),
            rows(scene.velocity),
            rows(heading[..., :2] * top[..., None] if package else wish),
            rows(heading),
            rows(scene.radius),
            rows(top),
            rows(walking),
            rows(seen),
            parameter_rows(self, LAW, scene.shape),
        )
        most = np.rint(per_agent(0.0 if package else self.max_neighbors, scene.shape, "max_neighbors"))
        near = nearest(
            scene.position, per_agent(self.neighbor_distance, scene.shape, "neighbor_distance"), most, seen, walking
        )
        walls = _Walls(*wall_surfaces(scene.walls), np.ascontiguousarray(scene.walls.segments()))
        launch(_choose, _choose_part, rows(out), crowd, near, groups_of(scene), walls, package, float(dt))
        return out


def _heading(scene: Scene, wish: Floats) -> Floats:
    """Return ``[E, A, 3]``: unit direction to the goal and its distance, inf if only a desired velocity is given."""
    away = wish if scene.preferred_velocity is not None else scene.goal - scene.position
    away = np.where(scene.active[..., None], away, 0.0)
    distance = np.sqrt(away[..., 0] ** 2 + away[..., 1] ** 2)
    direction = away / np.where(distance > 0.0, distance, 1.0)[..., None]
    if scene.preferred_velocity is not None:
        distance = np.full(scene.shape, np.inf)
    return np.concatenate([direction, distance[..., None]], axis=-1)
