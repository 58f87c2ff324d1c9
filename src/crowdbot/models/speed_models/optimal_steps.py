"""OptimalSteps: people put one foot before the other, each time where the potential is lowest (Seitz, Köster 2012)."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.core.geometry import nearest_on_segment
from crowdbot.models.model import CrowdModel, begin_step, launch, movable, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import parameter_rows
from crowdbot.models.valid_range import PAGE, ModelRange
from crowdbot.typing import Bools, Floats

from .collision_free_speed import is_hidden, within

MEMORY = "step_time"
"""Name in the memory of a scene: time [s] until the current step of each person ends."""
RINGS, POINTS = 4, 24
"""Circles of the step disc, and places on the outermost one."""
CONTACT, WALL_CONTACT = 1e3, 1e5
"""Potential of contact with people and with walls [m]."""
FAR = 1e3
"""Distance of the goal [m] if only a desired velocity is given."""
LONGEST = 2.0
"""Maximum time of a step [s]; slow people take shorter steps."""
EQUAL = 1e-9
"""Least advantage [m] of a place over those before it: rounding does not decide."""
LAW = (
    "personal_space", "intimate_space", "strength", "intimate_factor", "wall_distance", "wall_strength",
    "step_length", "step_per_speed",
)  # fmt: skip
"""Parameters in the order of the kernel."""


class _Crowd(NamedTuple):
    """Data of every person for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    goal: Floats  # from the person
    desired: Floats
    radius: Floats
    max_speed: Floats
    walking: Bools
    remaining: Floats
    laws: Floats


@kernel
def person_potential(distance: float, reach: float, personal: float, intimate: float, law: Floats) -> float:
    """Return the potential [m] at a distance [m] from a person, with the sum of the radii ``reach`` [m]."""
    potential = 0.0
    if distance < personal + reach:
        potential += law[2] * math.exp(4.0 / ((distance / (personal + reach)) ** 2 - 1.0))
    if distance < intimate + reach:
        potential += law[2] / law[3] * math.exp(4.0 / ((distance / (intimate + reach)) ** 2 - 1.0))
    if distance < reach:
        potential += CONTACT * math.exp(1.0 / ((distance / reach) ** 4 - 1.0))
    return potential


@kernel
def wall_potential(distance: float, radius: float, law: Floats) -> float:
    """Return the potential [m] at a distance [m] from the nearest wall."""
    potential = 0.0
    if distance < law[4]:
        potential += law[5] * math.exp(2.0 / ((distance / law[4]) ** 2 - 1.0))
    if distance < radius:
        potential += WALL_CONTACT * math.exp(1.0 / ((distance / radius) ** 2 - 1.0))
    return potential


@kernel
def _potential(
    px: float, py: float, gx: float, gy: float, seen: Floats, held: int, walls: Floats, near: NDArray[np.int64],
    count: int, x: float, y: float, radius: float, law: Floats,
) -> float:  # fmt: skip
    """Return the potential [m] at p from the person: distance to the goal g, and people and the nearest wall."""
    total = math.sqrt((gx - px) ** 2 + (gy - py) ** 2)
    for n in range(held):
        distance = math.sqrt((seen[n, 0] - px) ** 2 + (seen[n, 1] - py) ** 2)
        total += person_potential(distance, seen[n, 2], law[0], law[1], law)
    least = math.inf
    for n in range(count):
        m = near[n]
        nx, ny = nearest_on_segment(x + px, y + py, walls[m, 0], walls[m, 1], walls[m, 2], walls[m, 3])
        least = min(least, (nx - x - px) ** 2 + (ny - y - py) ** 2)
    return total + wall_potential(math.sqrt(least), radius, law) if count else total


@kernel(parallel=True)
def _choose(
    crowd: _Crowd, near: Neighbors, walls: Floats, disc: Floats, dt: float, timer: Floats, place: Floats, out: Floats
) -> None:
    """Choose velocity and remaining time of every person, row by row; of new steps, also the end and the gain."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        end = min((part + 1) * CHUNK, len(out))
        _choose_part(part * CHUNK, end, crowd, near, walls, disc, dt, timer, place, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, walls: Floats, disc: Floats, dt: float, timer: Floats,
    place: Floats, out: Floats,
) -> None:  # fmt: skip
    # unpack the tuples outside of the loop: each access counts references
    position, velocity, goal, desired, radius, top, walking, remaining, laws = crowd
    agent, number, order = near
    A = agent.shape[1]
    found = np.empty(len(walls), dtype=np.int64)
    seen = np.empty((agent.shape[2], 3))  # of each neighbour: where its step ends, from here, and sum of the radii
    for k in range(begin, end):
        row = order[k]
        if not walking[row]:
            continue
        wish = math.sqrt(desired[row, 0] ** 2 + desired[row, 1] ** 2)
        speed = min(wish, top[row])
        if speed == 0.0:
            timer[row], out[row, 0], out[row, 1] = 0.0, 0.0, 0.0
            continue
        left = remaining[row]
        if left >= 0.5 * dt:  # in a step
            timer[row] = left - dt
            pace = math.sqrt(velocity[row, 0] ** 2 + velocity[row, 1] ** 2)
            share = min(1.0, top[row] / pace) if pace > 0.0 else 0.0
            out[row, 0], out[row, 1] = share * velocity[row, 0], share * velocity[row, 1]
            continue
        law = laws[row if len(laws) > 1 else 0]
        e, a = row // A, row % A
        x, y, gx, gy = position[row, 0], position[row, 1], goal[row, 0], goal[row, 1]
        stride = min(law[6] + law[7] * speed, LONGEST * speed, math.sqrt(gx * gx + gy * gy))
        held = number[e, a]
        for n in range(held):
            other = row - a + agent[e, a, n]
            rest = max(remaining[other], 0.0)
            seen[n, 0] = position[other, 0] + rest * velocity[other, 0] - x
            seen[n, 1] = position[other, 1] + rest * velocity[other, 1] - y
            seen[n, 2] = radius[row] + radius[other]
        count = within(walls, x, y, stride + max(law[4], radius[row]), found)
        best_x = best_y = 0.0
        start = _potential(0.0, 0.0, gx, gy, seen, held, walls, found, count, x, y, radius[row], law)
        least = start
        ux, uy = stride * desired[row, 0] / wish, stride * desired[row, 1] / wish
        for n in range(len(disc)):
            px, py = disc[n, 0] * ux - disc[n, 1] * uy, disc[n, 0] * uy + disc[n, 1] * ux
            if is_hidden(walls, found, count, x, y, px, py):
                continue
            total = _potential(px, py, gx, gy, seen, held, walls, found, count, x, y, radius[row], law)
            if total < least - EQUAL:
                best_x, best_y, least = px, py, total
        time = max(stride / speed, dt)
        timer[row] = max(left + time, dt) - dt
        place[row, 0], place[row, 1], place[row, 2] = x + best_x, y + best_y, start - least
        out[row, 0], out[row, 1] = best_x / time, best_y / time


@kernel
def _steps_first(row: int, other: int, remaining: Floats, place: Floats, position: Floats) -> bool:
    """Return whether another person steps first: whose step ended earlier, then who gains more, then from the west."""
    if remaining[other] != remaining[row]:
        return bool(remaining[other] < remaining[row])
    if place[other, 2] != place[row, 2]:
        return bool(place[other, 2] > place[row, 2])
    if position[other, 0] != position[row, 0]:
        return bool(position[other, 0] < position[row, 0])
    return bool(position[other, 1] < position[row, 1])


@kernel(parallel=True)
def _wait(crowd: _Crowd, near: Neighbors, place: Floats, timer: Floats, out: Floats) -> None:
    """Let people wait who would step to the place of someone who steps first, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _wait_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, place, timer, out)


@kernel
def _wait_part(begin: int, end: int, crowd: _Crowd, near: Neighbors, place: Floats, timer: Floats, out: Floats) -> None:
    position, radius, remaining = crowd[0], crowd[4], crowd[7]
    agent, number, order = near
    A = agent.shape[1]
    for k in range(begin, end):
        row = order[k]
        if math.isnan(place[row, 0]):
            continue
        e, a = row // A, row % A
        for n in range(number[e, a]):
            other = row - a + agent[e, a, n]
            if math.isnan(place[other, 0]) or not _steps_first(row, other, remaining, place, position):
                continue
            dx, dy = place[other, 0] - place[row, 0], place[other, 1] - place[row, 1]
            if math.sqrt(dx * dx + dy * dy) < radius[row] + radius[other]:
                timer[row], out[row, 0], out[row, 1] = 0.0, 0.0, 0.0


def _step_disc() -> Floats:
    """Return the places ``[N, 2]`` of a step of length 1 straight ahead: circles from the inside, each from ahead."""
    places = []
    for ring in range(1, RINGS + 1):
        angle = np.arange(ring * POINTS // RINGS) * (2.0 * math.pi * RINGS / (ring * POINTS))
        places.append(ring / RINGS * np.stack([np.cos(angle), np.sin(angle)], axis=-1))
    return np.concatenate(places)


@dataclass(frozen=True)
class OptimalSteps(CrowdModel):
    """Optimal steps model: people step to the place within reach with the lowest potential of goal, people and walls.

    Args:
        personal_space: width of the personal space around the bodies [m].
        intimate_space: width of the intimate space around the bodies [m].
        strength: potential of a person [m], the detour that a person takes to avoid another.
        intimate_factor: ratio of the potentials of personal and intimate space.
        wall_distance: width of the space in front of walls [m].
        wall_strength: potential of a wall [m].
        step_length: step length at rest [m].
        step_per_speed: increase of the step length with the desired speed [s].
        step_deviation: standard deviation of ``step_length`` between people [m], drawn by :meth:`individual`.
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours (the nearest ones); rounded to a whole number.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    A step of length ``L = step_length + step_per_speed v`` with desired speed ``v`` takes ``L / v``. It ends on one of
    60 places on 4 circles around the person, or where it began if no place has a lower potential::

        distance to the goal + sum of persons P(d) + W(distance to the nearest wall)
        P(d) = strength exp(4 / (d^2 / (personal_space + R)^2 - 1))
               + strength / intimate_factor exp(4 / (d^2 / (intimate_space + R)^2 - 1)) + 1000 exp(1 / (d^4 / R^4 - 1))
        W(d) = wall_strength exp(2 / (d^2 / wall_distance^2 - 1)) + 1e5 exp(1 / (d^2 / r^2 - 1))

    with the sum ``R`` of the radii and the radius ``r``, and each term 0 beyond its width. Steps do not cross walls.

    **Time.** The original is driven by events: a person appears at the end of a step when the step begins. Here people
    move evenly during a step, and see where the steps of others end. A step begins at the tick nearest to the end of
    the one before it; the difference counts for the next. All whose steps begin at a tick choose at the same time, not
    one after the other; of those who would touch where their steps end, the one whose last step ended first goes, or
    who gains more, and the others wait for a tick. Paths may cross: bodies can overlap within a step. The time until a
    step ends is stored in the memory ``step_time`` of the scene. Use :meth:`step`; :meth:`velocity` does not update it.

    The default follows Vadere with its discrete optimiser, without its random rotation of the places. Its floor field
    is the distance to the goal here, or a slope along the desired velocity if the scene has one. The last step ends at
    the goal; no step takes more than 2 s.

    Source: Seitz, Köster 2012, doi:10.1103/PhysRevE.86.046108; disc of steps: von Sivers, Köster 2015,
    doi:10.1016/j.trb.2015.01.009; potentials: Vadere, ``CompactSoftshell``.

    Raises:
        InputError: a parameter is not finite or below its minimum.

    >>> ahead = Scene.of([[0, 0], [1.5, 0.1]], goal=[[9, 0], [1.5, 0.1]], preferred_speed=1.3)
    >>> after = OptimalSteps().step(ahead, dt=0.1)
    >>> after.velocity.round(2).tolist(), after.memory["step_time"].round(2).tolist()
    ([[[1.13, -0.65], [0.0, 0.0]]], [[0.49, 0.0]])
    """

    paper: ClassVar[Paper] = Paper(
        "Michael J. Seitz, Gerta Köster",
        2012,
        "Natural discretization of pedestrian movement in continuous space",
        "Physical Review E 86, 046108",
        "10.1103/PhysRevE.86.046108",
    )
    batched = True
    valid_range = ModelRange(2.0, "bodies overlap within steps", 0.1, PAGE, "about a sixth of the time of a step")

    personal_space: PerAgent = parameter(1.2, unit="m", low=0.4, high=2.0, source="Vadere", min=1e-3)
    intimate_space: PerAgent = parameter(0.45, unit="m", low=0.1, high=0.8, source="Vadere", min=1e-3)
    strength: PerAgent = parameter(50.0, unit="m", low=5.0, high=100.0, source="Vadere")
    intimate_factor: PerAgent = parameter(1.2, unit="1", low=0.5, high=5.0, source="Vadere", min=1e-3)
    wall_distance: PerAgent = parameter(0.8, unit="m", low=0.2, high=1.5, source="Vadere", min=1e-3)
    wall_strength: PerAgent = parameter(6.0, unit="m", low=0.5, high=20.0, source="Vadere")
    step_length: PerAgent = parameter(0.4625, unit="m", low=0.2, high=0.6, source="Vadere", min=1e-3)
    step_per_speed: PerAgent = parameter(0.2345, unit="s", low=0.1, high=0.4, source="Vadere")
    step_deviation: PerAgent = parameter(0.036, unit="m", low=0.0, high=0.08, source="Vadere")
    neighbor_distance: PerAgent = parameter(3.5, unit="m", low=2.0, high=6.0, source="two steps and a personal space")
    max_neighbors: PerAgent = parameter(50.0, unit="1", low=5.0, high=100.0, source="crowdbot: more are never needed")
    max_speed: PerAgent | None = None

    @property
    def memory_at_start(self) -> Mapping[str, float]:
        return {MEMORY: 0.0}

    @property
    def is_individual(self) -> bool:
        return bool(np.any(np.asarray(self.step_deviation) > 0.0))

    def individual(self, agents: int, rng: np.random.Generator) -> CrowdModel:
        # steps of different lengths also keep people from stepping at the same time
        length = self.step_length + self.step_deviation * np.clip(rng.standard_normal(agents), -3.0, 3.0)
        return dataclasses.replace(self, step_length=np.maximum(length, 0.1), step_deviation=0.0)

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        return self._move(scene, dt)[0]

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        velocity, timer = self._move(scene, dt)
        return scene.advance(velocity, dt).replace(
            memory={**scene.memory, MEMORY: np.where(movable(scene), timer, 0.0)}
        )

    def _move(self, scene: Scene, dt: float) -> tuple[Floats, Floats]:
        """Return the velocities ``[E, A, 2]`` [m/s] and the remaining times of steps ``[E, A]`` [s]."""
        wish, walking, seen, out = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        per_agent(self.step_deviation, scene.shape, "step_deviation")  # refuses a wrong shape, as of all parameters
        goal = scene.goal - scene.position if scene.preferred_velocity is None else FAR * wish
        remaining = np.array(per_agent(scene.memory.get(MEMORY, 0.0), scene.shape, MEMORY), dtype=np.float64)
        crowd = _Crowd(
            rows(scene.position),
            rows(scene.velocity),
            rows(goal),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            rows(walking),
            rows(remaining),
            parameter_rows(self, LAW, scene.shape),
        )
        timer, walls, place = np.zeros(scene.shape), scene.walls.segments(), np.full((*scene.shape, 3), np.nan)
        launch(_choose, _choose_part, rows(out), crowd, near, walls, _step_disc(), float(dt), rows(timer), rows(place))
        launch(_wait, _wait_part, rows(out), crowd, near, rows(place), rows(timer))
        return out, timer
