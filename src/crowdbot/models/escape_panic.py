"""EscapePanic: people pressed together, with bodies and friction (Helbing, Farkas, Vicsek 2000)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numba import prange
from numpy.typing import NDArray

from ..core.errors import InputError, did_you_mean
from ..core.geometry import nearest_on_segment
from ..core.kernels import kernel
from ..core.neighbors import CHUNK, Neighbors, nearest
from ..core.paper import Paper
from ..core.parameter import PerAgent, parameter, per_agent
from ..core.scene import Scene
from .model import CrowdModel, check_limit, kept, rows, speed_limit, walkers, wishes
from .surfaces import feel, surfaces_of

__all__ = ["EscapePanic"]

Floats = NDArray[np.float64]

VARIANTS = ("textbook", "crowdbot")
WALL_REACH = math.sqrt(2.0)
"""The CrowdBot simulator feels walls nearer than this many radii."""
SIMULATOR_SPEED = 2.5
"""Its limit of speed [m/s]."""
STEEPEST = 300.0
"""Largest exponent of the repulsion, so that it stays a number however deep bodies overlap."""
MOST_STEPS = 1000
"""No more sub-steps than this in one step: a huge time step has longer ones."""


class _Crowd(NamedTuple):
    """What the kernel reads of every agent, by row ``e * A + a``."""

    desired: Floats
    radius: Floats
    max_speed: Floats
    moving: NDArray[np.bool_]
    walking: NDArray[np.bool_]
    law: Floats
    """``[E * A, 6]``: strength, body and friction per mass, the distance of the strength, relaxation time, reach."""


class _Walls(NamedTuple):
    """Walls for both variants: faces and corners (see :mod:`.surfaces`), and every segment ``[N, 4]``."""

    face: Floats
    corner: Floats
    arm: Floats
    first: NDArray[np.int64]
    segment: Floats


@kernel
def _squeeze(overlap: float, strength: float, distance: float, body: float) -> float:
    """Return repulsion and body force [m/s^2] of discs that overlap by ``overlap`` [m], below 0 when they do not."""
    return strength * math.exp(min(overlap / distance, STEEPEST)) + body * max(0.0, overlap)


@kernel
def _next_velocity(
    row: int, a: int, agent: NDArray[np.int32], number: int, place: Floats, velocity: Floats, desired: Floats,
    radius: Floats, law: Floats, face: Floats, corner: Floats, arm: Floats, first: NDArray[np.int64], h: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the velocity after a sub-step of ``h`` [s]; friction is taken at its end, so that it cannot overshoot."""
    x, y, vx, vy, own = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1], radius[row]
    strength, body, friction, distance, relaxation = law[row, 0], law[row, 1], law[row, 2], law[row, 3], law[row, 4]
    ax, ay = (desired[row, 0] - vx) / relaxation, (desired[row, 1] - vy) / relaxation
    xx = xy = yy = 0.0  # sum of rates times t t^T, t the directions along surfaces
    for n in range(number):
        other = row - a + agent[n]
        dx, dy = x - place[other, 0], y - place[other, 1]
        gap = math.sqrt(dx * dx + dy * dy)
        nx, ny = (dx / gap, dy / gap) if gap > 0.0 else (1.0 if row < other else -1.0, 0.0)
        overlap = own + radius[other] - gap
        size = _squeeze(overlap, strength, distance, body)
        ax, ay = ax + size * nx, ay + size * ny
        if overlap > 0.0:
            rate = friction * overlap
            slide = rate * (velocity[other, 1] * nx - velocity[other, 0] * ny)
            ax, ay = ax - slide * ny, ay + slide * nx
            xx, xy, yy = xx + rate * ny * ny, xy - rate * nx * ny, yy + rate * nx * nx
    for k in range(len(face) + len(corner)):
        gap, nx, ny = feel(face, corner, arm, first, k, x, y, own + law[row, 5])
        if gap < math.inf:
            size = _squeeze(own - gap, strength, distance, body)
            rate = friction * max(0.0, own - gap)
            ax, ay = ax + size * nx, ay + size * ny
            xx, xy, yy = xx + rate * ny * ny, xy - rate * nx * ny, yy + rate * nx * nx
    bx, by = vx + h * ax, vy + h * ay
    xx, xy, yy = 1.0 + h * xx, h * xy, 1.0 + h * yy
    area = xx * yy - xy * xy
    return (yy * bx - xy * by) / area, (xx * by - xy * bx) / area


@kernel
def _next_as_simulator(
    row: int, a: int, agent: NDArray[np.int32], number: int, place: Floats, velocity: Floats, desired: Floats,
    radius: Floats, law: Floats, segment: Floats, h: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the velocity after a step of the CrowdBot simulator: pushes grow with distance, walls end at 1.4 radii."""
    x, y, vx, vy, own = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1], radius[row]
    strength, body, friction, distance, relaxation = law[row, 0], law[row, 1], law[row, 2], law[row, 3], law[row, 4]
    ax, ay = (desired[row, 0] - vx) / relaxation, (desired[row, 1] - vy) / relaxation
    pressed = False
    for n in range(number):
        other = row - a + agent[n]
        dx, dy = x - place[other, 0], y - place[other, 1]
        gap = math.sqrt(dx * dx + dy * dy)
        overlap = own + radius[other] - gap
        if pressed and overlap <= 0.0:
            continue  # neighbours come nearest first, but not bodies
        if overlap > 0.0 and not pressed:  # forget all who do not touch
            pressed = True
            ax, ay = (desired[row, 0] - vx) / relaxation, (desired[row, 1] - vy) / relaxation
        size = _squeeze(overlap, strength, distance, body)
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
        size = _squeeze(own - gap, strength, distance, body)
        slide = friction * max(0.0, own - gap) * (vx * ny - vy * nx)
        ax, ay = ax + size * nx - slide * ny, ay + size * ny + slide * nx
    return vx + h * ax, vy + h * ay


@kernel(parallel=True)
def _walk(
    place: Floats, velocity: Floats, after: Floats, crowd: _Crowd, near: Neighbors, walls: _Walls,
    simulator: bool, steps: int, h: float,
) -> None:  # fmt: skip
    """Move everyone by ``steps`` sub-steps of ``h`` [s]; place and velocity are overwritten."""
    parts = (len(place) + CHUNK - 1) // CHUNK
    for _ in range(steps):
        if parts == 1:  # starting threads would take longer
            _walk_part(0, len(place), place, velocity, after, crowd, near, walls, simulator, h)
        else:
            for part in prange(parts):
                end = min((part + 1) * CHUNK, len(place))
                _walk_part(part * CHUNK, end, place, velocity, after, crowd, near, walls, simulator, h)
        for row in range(len(place)):
            if crowd.moving[row]:
                for i in range(2):
                    velocity[row, i] = after[row, i]
                    place[row, i] += h * velocity[row, i]


@kernel
def _walk_part(
    begin: int, end: int, place: Floats, velocity: Floats, after: Floats, crowd: _Crowd, near: Neighbors,
    walls: _Walls, simulator: bool, h: float,
) -> None:  # fmt: skip
    # fields are taken out of the tuples here: inside the loop each access would count references
    desired, radius, top, _, walking, law = crowd
    agent, number, order = near
    face, corner, arm, first, segment = walls
    A = agent.shape[1]
    for n in range(begin, end):
        row = order[n]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        mates, count = agent[e, a], number[e, a]
        if simulator:
            x, y = _next_as_simulator(row, a, mates, count, place, velocity, desired, radius, law, segment, h)
        else:
            x, y = _next_velocity(
                row, a, mates, count, place, velocity, desired, radius, law, face, corner, arm, first, h
            )  # fmt: skip
        speed = math.sqrt(x * x + y * y)
        if speed > top[row]:
            x, y = x / speed * top[row], y / speed * top[row]
        after[row, 0], after[row, 1] = x, y


@dataclass(frozen=True)
class EscapePanic(CrowdModel):
    """Agents are bodies that repel each other from afar, and press and rub when they touch, each other and walls.

    Args:
        strength: of the repulsion at contact [N].
        distance: over which the repulsion falls off [m].
        body: force per overlap [kg/s^2].
        friction: force per overlap and sliding speed [kg/(m s)].
        mass: [kg].
        relaxation_time: time [s] in which the desired velocity is taken up again.
        neighbor_distance: neighbours and walls are nearer than this [m], walls measured from the body.
        max_neighbors: only so many neighbours count, the nearest; a fraction is rounded to the nearest whole number.
        max_speed: ``[E, A]`` [m/s]; None takes the maximum speed of the scene, in ``crowdbot`` 2.5 m/s.
        longest_step: bodies are stiff, so that a longer time step is cut into equal parts [s], at most 1000.
        variant: ``textbook``, or ``crowdbot``, the law of the CrowdBot simulator's library: forces between agents grow
            with the distance of their centres, agents in contact feel nobody else, every wall segment nearer than 1.4
            radii pushes, and a time step is never cut.

    All people move in every part of a step, external agents go straight on; neighbours are searched once. ``velocity``
    returns the velocities at the end, ``step`` also takes the places from there. Friction uses the velocity at the end
    of each part, which is the same law for short steps and cannot overshoot in long ones. A wall made of many segments
    pushes like one wall; who stands inside of a solid wall does not feel it.

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

    strength: PerAgent = parameter(2000.0, unit="N", low=100.0, high=4000.0, source="Helbing et al. 2000")
    distance: PerAgent = parameter(0.08, unit="m", low=0.03, high=0.4, source="Helbing et al. 2000", minimum=1e-3)
    body: PerAgent = parameter(1.2e5, unit="kg/s^2", low=1e4, high=1.2e5, source="Helbing et al. 2000")
    friction: PerAgent = parameter(2.4e5, unit="kg/(m s)", low=0.0, high=2.4e5, source="Helbing et al. 2000")
    mass: PerAgent = parameter(80.0, unit="kg", low=40.0, high=120.0, source="Helbing et al. 2000", minimum=1e-3)
    relaxation_time: PerAgent = parameter(0.5, unit="s", low=0.1, high=1.5, source="Helbing et al. 2000", minimum=1e-3)
    neighbor_distance: PerAgent = parameter(3.0, unit="m", low=1.0, high=10.0, source="the repulsion is nothing beyond")
    max_neighbors: PerAgent = parameter(
        40.0, unit="1", low=1.0, high=60.0, source="so many that leaving out the others does not show"
    )
    max_speed: PerAgent | None = None
    longest_step: float = 0.01
    variant: str = "textbook"

    def __post_init__(self) -> None:
        super().__post_init__()
        check_limit(self, self.max_speed)
        if not 1e-6 <= self.longest_step < math.inf:
            raise InputError(
                f"EscapePanic: longest_step = {self.longest_step} [s] is not allowed, it must be finite and at least 1e-6"
            )
        if self.variant not in VARIANTS:
            near = did_you_mean(self.variant, VARIANTS)
            raise InputError(f"EscapePanic: variant {self.variant!r} is unknown{near}; choose {' or '.join(VARIANTS)}")

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        """Return the velocities ``[E, A, 2]`` [m/s] after ``dt`` [s]; ``rng`` is not used."""
        return self._moved(scene, dt)[1]

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        """Return the scene ``dt`` [s] later; ``rng`` is not used."""
        place, velocity = self._moved(scene, dt)
        after = scene.advanced(velocity, dt)
        return after.replace(position=np.where(walkers(scene)[..., None], place, after.position))

    def _moved(self, scene: Scene, dt: float) -> tuple[Floats, Floats]:
        wish, walking = wishes(scene, dt), walkers(scene)
        simulator = self.variant == "crowdbot"

        def value(name: str) -> Floats:
            return per_agent(getattr(self, name), scene.shape, name)

        steps = 1 if simulator else min(MOST_STEPS, max(1, math.ceil(dt / self.longest_step - 1e-9)))
        mass, reach = value("mass"), value("neighbor_distance")
        law = [value("strength") / mass, value("body") / mass, value("friction") / mass]
        law += [value("distance"), value("relaxation_time"), reach]
        top = speed_limit(SIMULATOR_SPEED if simulator and self.max_speed is None else self.max_speed, scene)
        crowd = _Crowd(
            rows(wish),
            rows(scene.radius),
            rows(top),
            rows(scene.active),
            rows(walking),
            rows(np.stack(law, axis=-1)),
        )
        near = nearest(scene.position, reach, np.rint(value("max_neighbors")), scene.active & scene.visible, walking)
        walls = _Walls(*surfaces_of(scene.walls), np.ascontiguousarray(scene.walls.segments()))
        place, velocity = scene.position.copy(), scene.velocity.copy()
        after = np.where(walking[..., None], 0.0, velocity)
        _walk(rows(place), rows(velocity), rows(after), crowd, near, walls, simulator, steps, dt / steps)
        return place, np.where(walking[..., None], velocity, kept(scene))
