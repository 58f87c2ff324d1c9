"""EscapePanic: social forces with body force and friction in contact (Helbing, Farkas, Vicsek 2000)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import (
    CHUNK,
    SMALL,
    InputError,
    Neighbors,
    Paper,
    PerAgent,
    Scene,
    check_number,
    kernel,
    parameter,
    prange,
)
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.models.model import CrowdModel, begin_step, check_variant, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import limit_length, parameter_rows
from crowdbot.models.valid_range import FREE, PAGE, ModelRange
from crowdbot.typing import Floats

from .wall_surfaces import surface_distance, wall_surfaces

VARIANTS = ("textbook", "crowdbot")
WALL_REACH = math.sqrt(2.0)
"""Range of walls in the CrowdBot simulator, in radii."""
SIMULATOR_SPEED = 2.5
"""Speed limit of the CrowdBot simulator [m/s]."""
STEEPEST = 300.0
"""Upper limit of the exponent of the repulsion, against overflow for deep overlaps."""
MOST_STEPS = 1000
"""Maximum number of substeps; very long steps have longer substeps."""

MEMORY = "escape-panic"
"""Name in the memory of a scene: difference between the final and the mean velocity of the last step."""
LAW = ("strength", "body", "friction", "mass", "distance", "relaxation_time", "neighbor_distance")


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    desired: Floats
    radius: Floats
    max_speed: Floats
    walking: NDArray[np.bool_]
    law: Floats
    """``[E * A, 7]`` in the order of :data:`LAW`, or ``[1, 7]`` for all."""


class _Walls(NamedTuple):
    """Walls for both variants: faces and corners (see :mod:`.wall_surfaces`), and every segment ``[N, 4]``."""

    face: Floats
    corner: Floats
    arm: Floats
    first: NDArray[np.int64]
    segment: Floats


@kernel
def _repulsion(overlap: float, strength: float, distance: float, body: float) -> float:
    """Return repulsion and body force [m/s^2] of discs with an overlap [m], negative without contact."""
    return strength * math.exp(min(overlap / distance, STEEPEST)) + body * max(0.0, overlap)


@kernel
def _next_velocity(
    row: int, a: int, agent: NDArray[np.int32], number: int, place: Floats, velocity: Floats, desired: Floats,
    radius: Floats, law: Floats, face: Floats, corner: Floats, arm: Floats, first: NDArray[np.int64], h: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the velocity after a substep of ``h`` [s]; friction is implicit, which avoids overshoot."""
    x, y, vx, vy, own = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1], radius[row]
    strength, body, friction, distance, relaxation = law[0] / law[3], law[1] / law[3], law[2] / law[3], law[4], law[5]
    ax, ay = (desired[row, 0] - vx) / relaxation, (desired[row, 1] - vy) / relaxation
    xx = xy = yy = 0.0  # sum of rates times t t^T, t the directions along surfaces
    for n in range(number):
        other = row - a + agent[n]
        dx, dy = x - place[other, 0], y - place[other, 1]
        gap = math.sqrt(dx * dx + dy * dy)
        nx, ny = (dx / gap, dy / gap) if gap > 0.0 else (1.0 if row < other else -1.0, 0.0)
        overlap = own + radius[other] - gap
        size = _repulsion(overlap, strength, distance, body)
        ax, ay = ax + size * nx, ay + size * ny
        if overlap > 0.0:
            rate = friction * overlap
            slide = rate * (velocity[other, 1] * nx - velocity[other, 0] * ny)
            ax, ay = ax - slide * ny, ay + slide * nx
            xx, xy, yy = xx + rate * ny * ny, xy - rate * nx * ny, yy + rate * nx * nx
    for k in range(len(face) + len(corner)):
        gap, nx, ny = surface_distance(face, corner, arm, first, k, x, y, own + law[6])
        if gap < math.inf:
            size = _repulsion(own - gap, strength, distance, body)
            rate = friction * max(0.0, own - gap)
            ax, ay = ax + size * nx, ay + size * ny
            xx, xy, yy = xx + rate * ny * ny, xy - rate * nx * ny, yy + rate * nx * nx
    bx, by = vx + h * ax, vy + h * ay
    xx, xy, yy = 1.0 + h * xx, h * xy, 1.0 + h * yy
    area = xx * yy - xy * xy
    return (yy * bx - xy * by) / area, (xx * by - xy * bx) / area


@kernel
def _next_simulator_velocity(
    row: int, a: int, agent: NDArray[np.int32], number: int, place: Floats, velocity: Floats, desired: Floats,
    radius: Floats, law: Floats, segment: Floats, h: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the velocity after a step of the CrowdBot simulator: pushes grow with distance, walls end at 1.4 radii."""
    x, y, vx, vy, own = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1], radius[row]
    strength, body, friction, distance, relaxation = law[0] / law[3], law[1] / law[3], law[2] / law[3], law[4], law[5]
    ax, ay = (desired[row, 0] - vx) / relaxation, (desired[row, 1] - vy) / relaxation
    pressed = False
    for n in range(number):
        other = row - a + agent[n]
        dx, dy = x - place[other, 0], y - place[other, 1]
        gap = math.sqrt(dx * dx + dy * dy)
        overlap = own + radius[other] - gap
        if pressed and overlap <= 0.0:
            continue  # neighbours are sorted by the distance of centres, not of bodies
        if overlap > 0.0 and not pressed:  # ignore all agents without contact
            pressed = True
            ax, ay = (desired[row, 0] - vx) / relaxation, (desired[row, 1] - vy) / relaxation
        size = _repulsion(overlap, strength, distance, body)
        ax, ay = ax + size * dx, ay + size * dy
        if overlap > 0.0 and gap > 0.0:
            slide = friction * overlap * ((velocity[other, 1] - vy) * dx - (velocity[other, 0] - vx) * dy) / gap
            ax, ay = ax - slide * dy, ay + slide * dx
    for k in range(len(segment)):
        fx, fy = nearest_on_segment(x, y, segment[k, 0], segment[k, 1], segment[k, 2], segment[k, 3])
        dx, dy = x - fx, y - fy
        gap = math.sqrt(dx * dx + dy * dy)
        if not 0.0 < gap < WALL_REACH * own:
            continue
        nx, ny = dx / gap, dy / gap
        size = _repulsion(own - gap, strength, distance, body)
        slide = friction * max(0.0, own - gap) * (vx * ny - vy * nx)
        ax, ay = ax + size * nx - slide * ny, ay + size * ny + slide * nx
    return vx + h * ax, vy + h * ay


@kernel(parallel=True)
def _walk(
    place: Floats, velocity: Floats, after: Floats, total: Floats, crowd: _Crowd, near: Neighbors, walls: _Walls,
    simulator: bool, steps: int, h: float,
) -> None:  # fmt: skip
    """Move all agents by substeps of ``h`` [s], in place; ``total`` is the sum of the velocities."""
    parts = (len(place) + CHUNK - 1) // CHUNK
    for _ in range(steps):
        if len(place) <= SMALL:  # faster in one thread
            _walk_part(0, len(place), place, velocity, after, crowd, near, walls, simulator, h)
        else:
            for part in prange(parts):
                end = min((part + 1) * CHUNK, len(place))
                _walk_part(part * CHUNK, end, place, velocity, after, crowd, near, walls, simulator, h)
        for row in range(len(place)):
            for i in range(2):
                velocity[row, i] = after[row, i]
                total[row, i] += velocity[row, i]
                place[row, i] += h * velocity[row, i]


@kernel
def _walk_part(
    begin: int, end: int, place: Floats, velocity: Floats, after: Floats, crowd: _Crowd, near: Neighbors,
    walls: _Walls, simulator: bool, h: float,
) -> None:  # fmt: skip
    # unpack the tuples outside of the loop: each access counts references
    desired, radius, top, walking, laws = crowd
    agent, number, order = near
    face, corner, arm, first, segment = walls
    A = agent.shape[1]
    for n in range(begin, end):
        row = order[n]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        mates, count, law = agent[e, a], number[e, a], laws[row if len(laws) > 1 else 0]
        if simulator:
            x, y = _next_simulator_velocity(row, a, mates, count, place, velocity, desired, radius, law, segment, h)
        else:
            x, y = _next_velocity(
                row, a, mates, count, place, velocity, desired, radius, law, face, corner, arm, first, h
            )  # fmt: skip
        after[row, 0], after[row, 1] = limit_length(x, y, top[row])


@dataclass(frozen=True)
class EscapePanic(CrowdModel):
    """Social force model for panic: repulsion at a distance, body force and sliding friction in contact.

    Args:
        strength: repulsion at contact [N].
        distance: range of the repulsion [m].
        body: force per overlap [kg/s^2].
        friction: force per overlap and sliding speed [kg/(m s)].
        mass: mass [kg].
        relaxation_time: time constant to the desired velocity [s].
        neighbor_distance: maximum distance of neighbours and walls [m], for walls measured from the body.
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene, in ``crowdbot`` 2.5 m/s.
        longest_step: maximum substep [s]; a longer time step is divided into equal substeps, at most 1000.
        variant: ``textbook``, or ``crowdbot``, the law of the CrowdBot simulator: forces between agents grow
            with the distance of their centres, agents in contact ignore all others, every wall segment nearer than 1.4
            radii pushes, and there are no substeps.

    All people move in each substep, external agents at constant velocity; neighbours are searched once. The velocity of
    a step is the mean of its substeps, consistent with the displacement. Its difference from the final velocity is
    stored in ``scene.memory["escape-panic"]`` [m/s] for the next step, initially 0. Friction is implicit in the
    velocity, which avoids overshoot in long steps. A wall of many segments acts like one wall; agents inside a solid
    wall do not interact with it.

    The default variant is ``textbook``, the force of the paper. Differences: substeps, implicit friction, limited
    neighbourhoods, and walls of several segments that act like one wall.

    Source: Helbing, Farkas, Vicsek 2000, doi:10.1038/35035023.

    Raises:
        InputError: a parameter is not finite or below its minimum, or the variant is unknown.

    >>> beside = Scene.of([[0, 0], [0.7, 0]], [[1, 0], [1, 0]], preferred_velocity=[[1, 0], [1, 0]])
    >>> EscapePanic().velocity(beside, dt=0.01).round(3).tolist()
    [[[0.979, 0.0], [1.021, 0.0]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Dirk Helbing, Illes Farkas, Tamas Vicsek",
        2000,
        "Simulating dynamical features of escape panic",
        "Nature 407, 487-490",
        "10.1038/35035023",
    )
    batched = True
    valid_range = ModelRange(0.7, FREE, 0.1, PAGE, "the model divides longer steps into substeps of 0.01 s")

    strength: PerAgent = parameter(2000.0, unit="N", low=100.0, high=4000.0, source="Helbing et al. 2000")
    distance: PerAgent = parameter(0.08, unit="m", low=0.03, high=0.4, source="Helbing et al. 2000", min=1e-3)
    body: PerAgent = parameter(1.2e5, unit="kg/s^2", low=1e4, high=1.2e5, source="Helbing et al. 2000")
    friction: PerAgent = parameter(2.4e5, unit="kg/(m s)", low=0.0, high=2.4e5, source="Helbing et al. 2000")
    mass: PerAgent = parameter(80.0, unit="kg", low=40.0, high=120.0, source="Helbing et al. 2000", min=1e-3)
    relaxation_time: PerAgent = parameter(0.5, unit="s", low=0.1, high=1.5, source="Helbing et al. 2000", min=1e-3)
    neighbor_distance: PerAgent = parameter(3.0, unit="m", low=1.0, high=10.0, source="negligible repulsion beyond")
    max_neighbors: PerAgent = parameter(
        40.0, unit="1", low=1.0, high=60.0, source="crowdbot: all relevant agents up to 1 person/m^2"
    )
    max_speed: PerAgent | None = None
    longest_step: float = 0.01
    variant: str = "textbook"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("EscapePanic", "longest_step", self.longest_step, "s", min=1e-6)
        check_variant(self, self.variant, VARIANTS)

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        # mean velocities [E, A, 2] [m/s] over the next dt [s]; rng is not used
        return self._move_agents(scene, dt)[0]

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        mean, last = self._move_agents(scene, dt)
        return scene.advance(mean, dt).replace(memory={**scene.memory, MEMORY: last - mean})

    def _move_agents(self, scene: Scene, dt: float) -> tuple[Floats, Floats]:
        """Return the mean and the final velocities ``[E, A, 2]`` [m/s]."""
        wish, walking, seen, out = begin_step(scene, dt)
        simulator = self.variant == "crowdbot"
        steps = 1 if simulator else min(MOST_STEPS, max(1, math.ceil(dt / self.longest_step - 1e-9)))
        top = speed_limit(SIMULATOR_SPEED if simulator and self.max_speed is None else self.max_speed, scene)
        crowd = _Crowd(
            rows(wish),
            rows(scene.radius),
            rows(top),
            rows(walking),
            parameter_rows(self, LAW, scene.shape),
        )
        near = neighbors_of(self, scene, seen, walking)
        walls = _Walls(*wall_surfaces(scene.walls), np.ascontiguousarray(scene.walls.segments()))
        velocity = np.where(walking[..., None], scene.velocity + _memory(scene), out)
        place, after, total = scene.position.copy(), out.copy(), np.zeros_like(out)
        _walk(rows(place), rows(velocity), rows(after), rows(total), crowd, near, walls, simulator, steps, dt / steps)
        return np.where(walking[..., None], total / steps, out), velocity


def _memory(scene: Scene) -> Floats:
    """Return the velocity difference ``[E, A, 2]`` [m/s] in the memory of the scene."""
    excess = np.asarray(scene.memory.get(MEMORY, np.zeros_like(scene.velocity)), dtype=np.float64)
    if excess.shape != scene.velocity.shape or not np.all(np.isfinite(excess[scene.active])):
        raise InputError(
            f"scene: memory {MEMORY!r} has shape {list(excess.shape)} or is not finite, it must be finite and"
            f" {list(scene.velocity.shape)}; omit it to start without memory"
        )
    return excess
