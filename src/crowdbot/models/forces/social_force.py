"""SocialForce: social force model (Helbing and Molnár 1995)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, prange
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.models.model import CrowdModel, begin_step, check_variant, launch, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import limit_length, parameter_rows
from crowdbot.models.valid_range import TWO_WAY, UMANS, ModelRange
from crowdbot.typing import Floats

VARIANTS = ("gradient", "umans2018")
UMANS_LOOK_AHEAD = 0.5
"""Factor of ``look_ahead`` in the 2018 library: 1 s for a parameter of 2 s (fitted to its output)."""
UMANS_CONTACT = 62.5
"""Contact acceleration per overlap in the 2018 library [1/s^2]: 5000 N/m for 80 kg (fitted to its output)."""
LAW = (
    "strength", "distance", "look_ahead", "wall_strength", "wall_distance", "relaxation_time", "view_angle", "behind",
    "neighbor_distance", "max_acceleration",
)  # fmt: skip
"""Parameters in the order of the kernel; for the angle, its cosine."""
VIEW = LAW.index("view_angle")


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
def _ellipse_force(x: float, y: float, yx: float, yy: float, strength: float, distance: float) -> tuple[float, float]:
    """Return the negative gradient of ``strength exp(-b / distance)`` [m/s^2] at x, y for a neighbour with stride y.

    b is the semi-minor axis of the ellipse through x, y with foci at the neighbour's positions before and after its
    stride yx, yy.
    """
    near, far = math.sqrt(x * x + y * y), math.sqrt((x - yx) ** 2 + (y - yy) ** 2)
    b2 = 0.25 * ((near + far) ** 2 - (yx * yx + yy * yy))
    if b2 <= 0.0 or near == 0.0 or far == 0.0:
        return 0.0, 0.0  # on the stride: no direction is preferred
    b = math.sqrt(b2)
    size = strength / distance * math.exp(-b / distance) * (near + far) / (4.0 * b)
    return size * (x / near + (x - yx) / far), size * (y / near + (y - yy) / far)


@kernel
def _ellipse_force_umans(
    x: float, y: float, yx: float, yy: float, stride: float, strength: float, distance: float
) -> tuple[float, float]:
    """Return the force of the 2018 library: the derivative along the line between the agents, times their distance.

    A neighbour at its goal that still moves has a ``stride``, which makes the ellipse thinner, but no direction.
    """
    near, far = math.sqrt(x * x + y * y), math.sqrt((x - yx) ** 2 + (y - yy) ** 2)
    b2 = 0.25 * ((near + far) ** 2 - stride * stride)
    if b2 <= 0.0 or near == 0.0 or far == 0.0:
        return 0.0, 0.0
    b = math.sqrt(b2)
    size = strength / distance * math.exp(-b / distance) * (near + far) / (4.0 * b)
    size *= 1.0 + (near - (x * yx + y * yy) / near) / far
    return size * x, size * y


@kernel
def _view_weight(x: float, y: float, ex: float, ey: float, least: float, behind: float) -> float:
    """Return the weight of a force along x, y on an agent that looks along e: 1 in view, ``behind`` out of view."""
    length = math.sqrt((x * x + y * y) * (ex * ex + ey * ey))
    return behind if length > 0.0 and -(x * ex + y * ey) < least * length else 1.0


@kernel
def _neighbor_force(
    row: int,
    ex: float,
    ey: float,
    position: Floats,
    velocity: Floats,
    desired: Floats,
    radius: Floats,
    law: Floats,
    others: NDArray[np.int32],
    first: int,
    umans: bool,
) -> tuple[float, float, float, float]:
    """Return the acceleration by neighbours and the sum of contact overlaps; ``first`` is the row of neighbour 0."""
    ax = ay = push_x = push_y = 0.0
    for n in range(len(others)):
        j = first + others[n]
        x, y = position[row, 0] - position[j, 0], position[row, 1] - position[j, 1]
        if umans:
            gap = math.sqrt(x * x + y * y)
            overlap = radius[row] + radius[j] - gap
            if overlap > 0.0:
                if gap > 0.0:
                    push_x, push_y = push_x + overlap * x / gap, push_y + overlap * y / gap
                continue
            speed = math.sqrt(velocity[j, 0] ** 2 + velocity[j, 1] ** 2)
            wish = math.sqrt(desired[j, 0] ** 2 + desired[j, 1] ** 2)
            stride = UMANS_LOOK_AHEAD * law[2] * speed
            yx, yy = (stride * desired[j, 0] / wish, stride * desired[j, 1] / wish) if wish > 0.0 else (0.0, 0.0)
            fx, fy = _ellipse_force_umans(x, y, yx, yy, stride, law[0], law[1])
        else:
            fx, fy = _ellipse_force(x, y, law[2] * velocity[j, 0], law[2] * velocity[j, 1], law[0], law[1])
        weight = _view_weight(x, y, ex, ey, law[6], law[7])
        ax, ay = ax + weight * fx, ay + weight * fy
    return ax, ay, push_x, push_y


@kernel
def _wall_force(x: float, y: float, ex: float, ey: float, law: Floats, segments: Floats) -> tuple[float, float]:
    """Return the acceleration by the nearest point of each segment."""
    ax = ay = 0.0
    for k in range(len(segments)):
        nx, ny = nearest_on_segment(x, y, segments[k, 0], segments[k, 1], segments[k, 2], segments[k, 3])
        dx, dy = x - nx, y - ny
        gap = math.sqrt(dx * dx + dy * dy)
        if 0.0 < gap < law[8]:
            weight = _view_weight(dx, dy, ex, ey, law[6], law[7])
            size = weight * law[3] / law[4] * math.exp(-gap / law[4]) / gap
            ax, ay = ax + size * dx, ay + size * dy
    return ax, ay


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, segments: Floats, umans: bool, dt: float, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, segments, umans, dt, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, segments: Floats, umans: bool, dt: float, out: Floats
) -> None:
    # unpack the tuples outside of the loop: each access counts references
    position, velocity, desired, radius, top, walking, laws = crowd
    agent, number, order = near
    A = agent.shape[1]
    for k in range(begin, end):
        row = order[k]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        law = laws[row if len(laws) > 1 else 0]
        vx, vy, px, py = velocity[row, 0], velocity[row, 1], desired[row, 0], desired[row, 1]
        still = px == 0.0 and py == 0.0
        ex, ey = (vx, vy) if umans or still else (px, py)
        others = agent[e, a, : number[e, a]]
        ax, ay, push_x, push_y = _neighbor_force(
            row, ex, ey, position, velocity, desired, radius, law, others, row - a, umans
        )
        wx, wy = _wall_force(position[row, 0], position[row, 1], ex, ey, law, segments)
        ax, ay = ax + wx + (px - vx) / law[5], ay + wy + (py - vy) / law[5]
        if umans and still:  # the library stops agents at their goal
            ax, ay = -vx / dt, -vy / dt
        ax, ay = limit_length(ax, ay, law[9])
        vx, vy = limit_length(vx + ax * dt, vy + ay * dt, top[row])
        out[row, 0] = vx + UMANS_CONTACT * push_x * dt
        out[row, 1] = vy + UMANS_CONTACT * push_y * dt


@dataclass(frozen=True)
class SocialForce(CrowdModel):
    """Social force model: relaxation to the desired velocity, elliptical repulsion by agents, repulsion by walls.

    Args:
        strength: potential at the centre of a neighbour's ellipse [m^2/s^2].
        distance: decay length of the repulsion by neighbours [m].
        look_ahead: duration of a neighbour's stride [s]; the stride is its velocity times this.
        wall_strength: potential at a wall [m^2/s^2].
        wall_distance: decay length of the repulsion by walls [m].
        relaxation_time: time constant to the desired velocity [s].
        view_angle: half field of view around the desired direction [rad].
        behind: weight of neighbours and walls out of view.
        neighbor_distance: maximum distance of neighbours and walls [m].
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_acceleration: limit of the sum of all forces [m/s^2].
        variant: ``gradient``, the published force, or ``umans2018``, the force of the UMANS library of 2018 (derivative
            along the line between two agents; contact force instead of repulsion while two discs overlap).
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    The force does not depend on radii; ``distance`` accounts for them. Adjacent wall segments both repel. If the
    desired velocity is 0, the field of view follows the velocity.

    The default variant is ``gradient``, the force of the paper without its random fluctuations and attractions.
    Differences: limited neighbourhoods and an acceleration limit.

    Source: Helbing, Molnár 1995, doi:10.1103/PhysRevE.51.4282; van Toll et al. 2020, doi:10.1145/3384382.3384532.

    Raises:
        InputError: a parameter is not finite or below its minimum, or the variant is unknown.

    >>> scene = Scene.of([[0.0, 0.0]], preferred_velocity=[[1.0, 0.0]])
    >>> SocialForce().velocity(scene, dt=0.1).round(6).tolist()
    [[[0.2, 0.0]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Dirk Helbing, Péter Molnár",
        1995,
        "Social force model for pedestrian dynamics",
        "Physical Review E",
        "10.1103/PhysRevE.51.4282",
    )
    batched = True
    valid_range = ModelRange(0.5, "lanes do not form and people are pushed through walls", 0.1, TWO_WAY, UMANS)

    strength: PerAgent = parameter(2.1, unit="m^2/s^2", low=0.5, high=8.0, source="paper, V0")
    distance: PerAgent = parameter(0.3, unit="m", low=0.1, high=1.0, source="paper, sigma", min=0.01)
    look_ahead: PerAgent = parameter(2.0, unit="s", low=0.0, high=4.0, source="paper, delta t")
    wall_strength: PerAgent = parameter(10.0, unit="m^2/s^2", low=1.0, high=20.0, source="paper, U0")
    wall_distance: PerAgent = parameter(0.2, unit="m", low=0.05, high=1.0, source="paper, R", min=0.01)
    relaxation_time: PerAgent = parameter(0.5, unit="s", low=0.1, high=1.5, source="paper, tau", min=0.01)
    view_angle: PerAgent = parameter(
        math.radians(100), unit="rad", low=1.0, high=math.pi, source="paper, 2 phi = 200 deg"
    )
    behind: PerAgent = parameter(0.5, unit="1", low=0.0, high=1.0, source="paper, c")
    neighbor_distance: PerAgent = parameter(5.0, unit="m", low=1.0, high=15.0, source="UMANS, example")
    max_neighbors: PerAgent = parameter(
        64.0, unit="1", low=1.0, high=64.0, source="crowdbot: all within 5 m up to 0.8 people/m^2"
    )
    max_acceleration: PerAgent = parameter(5.0, unit="m/s^2", low=1.0, high=20.0, source="UMANS, example")
    variant: str = "gradient"
    max_speed: PerAgent | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        check_variant(self, self.variant, VARIANTS)

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        wish, walking, seen, out = begin_step(scene, dt)
        umans = self.variant == "umans2018"
        if umans and scene.preferred_velocity is None:  # in the library, the goal is reached within the agent's radius
            away = scene.goal - scene.position
            wish[away[..., 0] ** 2 + away[..., 1] ** 2 <= scene.radius**2] = 0.0
        near = neighbors_of(self, scene, seen, walking)
        crowd = _Crowd(
            rows(scene.position),
            rows(scene.velocity),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            rows(walking),
            self._law(scene.shape),
        )
        launch(_choose, _choose_part, rows(out), crowd, near, scene.walls.segments(), umans, float(dt))
        return out

    def _law(self, shape: tuple[int, int]) -> Floats:
        law = parameter_rows(self, LAW, shape)
        law[:, VIEW] = np.cos(np.minimum(np.ascontiguousarray(law[:, VIEW]), math.pi))
        return law
