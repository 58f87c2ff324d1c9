"""HeadedSocialForce: social forces on people with a heading, who hardly walk sideways (Farina et al. 2017)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.models.model import (
    CrowdModel,
    begin_step,
    check_variant,
    launch,
    movable,
    neighbors_of,
    rows,
    speed_limit,
)
from crowdbot.models.parameter_rows import limit_length, parameter_rows
from crowdbot.models.valid_range import FREE, PAGE, ModelRange
from crowdbot.typing import Floats

from .wall_surfaces import WallSurfaces, surface_distance, wall_surfaces

VARIANTS = ("farina2017", "jhsfm")
MEMORY = "angular_velocity"
"""Name in the memory of a scene: angular velocity of an agent [rad/s]."""
STEEPEST = 300.0
"""Upper limit of exponents, against overflow for deep overlaps."""
LARGEST_GUIDE = 100.0
"""Upper limit of the guiding force per mass [m/s^2], as in JHSFM."""
FASTEST_TURN = 100.0
"""Upper limit of angular velocities [rad/s], against overflow."""
MOST_FRICTION = 0.5
"""Upper limit of the share of a sliding velocity that a contact removes in one step, against overshoot."""
LAW = (
    "strength", "distance", "body", "friction", "mass", "relaxation_time", "side_weight", "side_damping", "turn_gain",
    "turn_ratio", "sliding", "sliding_distance", "neighbor_distance",
)  # fmt: skip
"""Parameters in the order of the kernel."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    walking: NDArray[np.bool_]
    law: Floats
    """``[E * A, 13]`` in the order of :data:`LAW`, or ``[1, 13]`` for all."""


@kernel
def _contact_force(
    overlap: float, nx: float, ny: float, slide: float, sliding: float, law: Floats, dt: float
) -> tuple[float, float]:
    """Return the force [N] of a neighbour or wall in direction n, whose velocity along the tangent is ``slide``."""
    size = law[0] * math.exp(min(overlap / law[1], STEEPEST))
    along = sliding * math.exp(min(overlap / law[11], STEEPEST)) if sliding != 0.0 else 0.0
    if overlap > 0.0:
        size += law[2] * overlap
        along += min(law[3] * overlap, MOST_FRICTION * law[4] / dt) * slide
    return size * nx - along * ny, size * ny + along * nx


@kernel
def _external_force(
    row: int, a: int, agent: NDArray[np.int32], number: int, position: Floats, velocity: Floats, radius: Floats,
    law: Floats, face: Floats, corner: Floats, arm: Floats, first: NDArray[np.int64], dt: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the force [N] of neighbours and walls."""
    x, y, vx, vy, own = position[row, 0], position[row, 1], velocity[row, 0], velocity[row, 1], radius[row]
    fx = fy = 0.0
    for n in range(number):
        other = row - a + agent[n]
        dx, dy = x - position[other, 0], y - position[other, 1]
        gap = math.sqrt(dx * dx + dy * dy)
        nx, ny = (dx / gap, dy / gap) if gap > 0.0 else (1.0 if row < other else -1.0, 0.0)
        slide = (velocity[other, 1] - vy) * nx - (velocity[other, 0] - vx) * ny
        px, py = _contact_force(own + radius[other] - gap, nx, ny, slide, law[10], law, dt)
        fx, fy = fx + px, fy + py
    for k in range(len(face) + len(corner)):
        gap, nx, ny = surface_distance(face, corner, arm, first, k, x, y, own + law[12])
        if gap < math.inf:
            px, py = _contact_force(own - gap, nx, ny, vx * ny - vy * nx, 0.0, law, dt)
            fx, fy = fx + px, fy + py
    return fx, fy


@kernel(parallel=True)
def _choose(
    crowd: _Crowd, near: Neighbors, walls: WallSurfaces, total: bool, dt: float, heading: Floats, turn: Floats,
    out: Floats,
) -> None:  # fmt: skip
    """Advance heading, angular velocity and velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        end = min((part + 1) * CHUNK, len(out))
        _choose_part(part * CHUNK, end, crowd, near, walls, total, dt, heading, turn, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: WallSurfaces, total: bool, dt: float,
    heading: Floats, turn: Floats, out: Floats,
) -> None:  # fmt: skip
    # unpack the tuples outside of the loop: each access counts references
    position, velocity, desired, radius, top, walking, laws = crowd
    agent, number, order = near
    face, corner, arm, first = walls
    A = agent.shape[1]
    for k in range(begin, end):
        row = order[k]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        law = laws[row if len(laws) > 1 else 0]
        mass, relaxation = law[4], law[5]
        px, py = desired[row, 0], desired[row, 1]
        gx, gy = mass * (px - velocity[row, 0]) / relaxation, mass * (py - velocity[row, 1]) / relaxation
        fx, fy = _external_force(
            row, a, agent[e, a], number[e, a], position, velocity, radius, law, face, corner, arm, first, dt
        )  # fmt: skip
        angle, spin = heading[row], turn[row]
        cos, sin = math.cos(angle), math.sin(angle)
        forward, left = cos * velocity[row, 0] + sin * velocity[row, 1], cos * velocity[row, 1] - sin * velocity[row, 0]
        if px == 0.0 and py == 0.0 and not total:
            torque = -spin / relaxation
        else:
            tx, ty = (gx + fx, gy + fy) if total else (gx, gy)
            guide = law[8] * min(math.sqrt(tx * tx + ty * ty), LARGEST_GUIDE * mass)
            error = angle - math.atan2(ty, tx)
            error -= 2.0 * math.pi * math.floor(error / (2.0 * math.pi) + 0.5)
            torque = -guide * error - (1.0 + law[9]) * math.sqrt(guide / law[9]) * spin
        forward += dt * (cos * (gx + fx) + sin * (gy + fy)) / mass
        left += dt * (law[6] * (cos * fy - sin * fx) - law[7] * left) / mass
        forward, left = limit_length(forward, left, top[row])
        spin = min(max(spin + dt * torque, -FASTEST_TURN), FASTEST_TURN)
        angle += dt * spin
        angle -= 2.0 * math.pi * math.floor(angle / (2.0 * math.pi) + 0.5)
        cos, sin = math.cos(angle), math.sin(angle)
        heading[row], turn[row] = angle, spin
        out[row, 0], out[row, 1] = limit_length(cos * forward - sin * left, sin * forward + cos * left, top[row])


@dataclass(frozen=True)
class HeadedSocialForce(CrowdModel):
    """Headed social force model: social forces move people along their heading, which turns to the desired velocity.

    Args:
        strength: repulsion at contact [N].
        distance: range of the repulsion [m].
        body: force per overlap [kg/s^2].
        friction: force per overlap and sliding speed [kg/(m s)].
        mass: mass [kg].
        relaxation_time: time constant to the desired velocity [s].
        side_weight: share of the forces of neighbours and walls that acts sideways.
        side_damping: damping of the sideways velocity [kg/s].
        turn_gain: angular acceleration per angle and guiding force [1/(kg m)].
        turn_ratio: ratio of the two rates with which an angle decays.
        sliding: tangential force of a neighbour at contact [N], to the left of its direction.
        sliding_distance: range of the tangential force [m].
        neighbor_distance: maximum distance of neighbours and walls [m], for walls measured from the body.
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.
        variant: ``farina2017``, where the force to the desired velocity guides the heading, or ``jhsfm``, where the sum
            of all forces does, as in JHSFM and social-jym; these also have ``sliding`` 120 N and ``turn_gain`` 0.1.

    With forces ``f0 = mass (desired - v) / relaxation_time`` and ``fe`` of neighbours and walls (those of
    :class:`EscapePanic`), velocity ``(vf, vo)`` along heading ``theta`` and left of it, and guiding force ``g``::

        mass vf' = (f0 + fe) forward
        mass vo' = side_weight fe left - side_damping vo
        theta''  = -turn_gain |g| (theta - angle of g) - (1 + turn_ratio) sqrt(turn_gain |g| / turn_ratio) theta'

    The heading is that of the scene and differs from the direction of the velocity; the angular velocity is stored in
    ``scene.memory["angular_velocity"]`` [rad/s], initially 0. Use :meth:`step`; :meth:`velocity` does not update both.

    The default variant is ``farina2017``, the model of the paper without the cohesion of groups. Differences: limited
    neighbourhoods; walls of several segments act like one wall; a step removes at most half of a sliding velocity; the
    speed is limited; a person without desired velocity keeps its heading. Steps are explicit: contact forces are stable
    up to 0.03 s.

    Source: Farina, Fontanelli, Garulli, Giannitrapani, Prattichizzo 2017, doi:10.1371/journal.pone.0169734; its
    repulsion: Helbing, Farkas, Vicsek 2000, doi:10.1038/35035023.

    Raises:
        InputError: a parameter is not finite or below its minimum, or the variant is unknown.

    >>> aside = Scene.of([[0.0, 0.0]], heading=[0.0], preferred_velocity=[[0.0, 1.0]])
    >>> after = HeadedSocialForce().step(aside, dt=0.02)
    >>> after.heading.round(4).tolist(), after.velocity.round(4).tolist()  # turns first, and does not walk sideways
    ([[0.0283]], [[[0.0, 0.0]]])
    """

    paper: ClassVar[Paper] = Paper(
        "Francesco Farina, Daniele Fontanelli, Andrea Garulli, Antonio Giannitrapani, Domenico Prattichizzo",
        2017,
        "Walking ahead: The headed social force model",
        "PLoS ONE 12(1), e0169734",
        "10.1371/journal.pone.0169734",
    )
    batched = True
    valid_range = ModelRange(0.7, FREE, 0.02, PAGE, "contact forces of an explicit step")

    strength: PerAgent = parameter(2000.0, unit="N", low=100.0, high=4000.0, source="Helbing et al. 2000")
    distance: PerAgent = parameter(0.08, unit="m", low=0.03, high=0.4, source="Helbing et al. 2000", min=1e-3)
    body: PerAgent = parameter(1.2e5, unit="kg/s^2", low=1e4, high=1.2e5, source="Helbing et al. 2000")
    friction: PerAgent = parameter(2.4e5, unit="kg/(m s)", low=0.0, high=2.4e5, source="Helbing et al. 2000")
    mass: PerAgent = parameter(75.0, unit="kg", low=60.0, high=90.0, source="JHSFM; paper: 60 to 90 kg", min=1e-3)
    relaxation_time: PerAgent = parameter(0.5, unit="s", low=0.1, high=1.5, source="Helbing et al. 2000", min=1e-3)
    side_weight: PerAgent = parameter(1.0, unit="1", low=0.0, high=2.0, source="paper, k^o")
    side_damping: PerAgent = parameter(500.0, unit="kg/s", low=100.0, high=1000.0, source="paper, k^d")
    turn_gain: PerAgent = parameter(0.3, unit="1/(kg m)", low=0.05, high=0.5, source="paper, k^lambda")
    turn_ratio: PerAgent = parameter(3.0, unit="1", low=1.0, high=6.0, source="paper, alpha", min=1e-3)
    sliding: PerAgent = parameter(0.0, unit="N", low=0.0, high=200.0, source="none in the paper")
    sliding_distance: PerAgent = parameter(0.6, unit="m", low=0.1, high=1.0, source="JHSFM, D", min=1e-3)
    neighbor_distance: PerAgent = parameter(3.0, unit="m", low=1.0, high=10.0, source="negligible repulsion beyond")
    max_neighbors: PerAgent = parameter(
        40.0, unit="1", low=1.0, high=60.0, source="crowdbot: all relevant agents up to 1 person/m^2"
    )
    max_speed: PerAgent | None = None
    variant: str = "farina2017"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_variant(self, self.variant, VARIANTS)

    @property
    def memory_at_start(self) -> Mapping[str, float]:
        return {MEMORY: 0.0}

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        return self._move(scene, dt)[0]

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        velocity, heading, turn = self._move(scene, dt)
        after, own = scene.advance(velocity, dt), movable(scene)
        memory = {**scene.memory, MEMORY: np.where(own, turn, 0.0)}
        return after.replace(heading=np.where(own, heading, after.heading), memory=memory)

    def _move(self, scene: Scene, dt: float) -> tuple[Floats, Floats, Floats]:
        """Return velocities ``[E, A, 2]`` [m/s], headings [rad] and angular velocities [rad/s] ``[E, A]``."""
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        crowd = _Crowd(
            rows(scene.position),
            rows(scene.velocity),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            rows(walking),
            parameter_rows(self, LAW, scene.shape),
        )
        heading = np.array(scene.heading, dtype=np.float64)
        turn = np.array(per_agent(scene.memory.get(MEMORY, 0.0), scene.shape, MEMORY), dtype=np.float64)
        walls, total = wall_surfaces(scene.walls), self.variant == "jhsfm"
        launch(_choose, _choose_part, rows(out), crowd, near, walls, total, float(dt), rows(heading), rows(turn))
        return out, heading, turn
