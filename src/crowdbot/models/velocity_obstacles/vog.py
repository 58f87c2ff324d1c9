"""VOG: velocity obstacles with groups (Ren et al. 2017)."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, Neighbors, Paper, PerAgent, Scene, kernel, parameter, per_agent, prange
from crowdbot.models.model import CrowdModel, begin_step, movable, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import parameter_columns
from crowdbot.models.valid_range import FREE, PAGE, ModelRange
from crowdbot.typing import Floats, Ints

from .vog_cost import CONE, DIRECTED, FELLOW, collision, companion, cone, fellowship, own_way, walls_near

MOST_FELLOWS = 16
"""Maximum number of group members considered."""
ALIKE = 0.7
"""Group members are ignored if the cosine of the angle between the desired directions is lower."""
PURPOSE = 0.5
"""Minimum desired speed [m/s] that defines a direction in the selection of group members."""
POINTED = 0.1
"""Minimum desired speed [m/s] that defines the walking direction."""


@kernel
def pick_fellows(
    row: int, mates: Ints, place: Floats, velocity: Floats, desired: Floats, reach: float, most: int,
    found: Ints, key: Floats,
) -> int:  # fmt: skip
    """Find the group members to stay with: near, ahead and in the same direction; return their number."""
    held = 0
    px, py = desired[row, 0], desired[row, 1]
    own = math.sqrt(px * px + py * py)
    lx, ly = (px, py) if own > PURPOSE else (velocity[row, 0], velocity[row, 1])
    look = math.sqrt(lx * lx + ly * ly)
    for other in mates:
        x, y = place[other, 0] - place[row, 0], place[other, 1] - place[row, 1]
        d2 = x * x + y * y
        if other == row or not d2 < reach * reach:
            continue
        qx, qy = desired[other, 0], desired[other, 1]
        its = math.sqrt(qx * qx + qy * qy)
        value = 1.5 * d2
        if look > DIRECTED and d2 > 0.0:
            value -= 0.5 * math.sqrt(d2) * (x * lx + y * ly) / look
        if own > PURPOSE and its > PURPOSE:
            cosine = (px * qx + py * qy) / (own * its)
            if cosine <= ALIKE:
                continue
            value *= 2.0 - cosine
        if held == most and not (most > 0 and value < key[held - 1]):
            continue
        n = min(held, most - 1)
        held = n + 1
        while n > 0 and value < key[n - 1]:
            key[n], found[n] = key[n - 1], found[n - 1]
            n -= 1
        key[n], found[n] = value, other
    return held


@kernel
def unit(x: float, y: float) -> tuple[float, float]:
    """Return the direction of a velocity, or 0 if it is too slow."""
    length = math.sqrt(x * x + y * y)
    return (x / length, y / length) if length > DIRECTED else (0.0, 0.0)


@kernel
def walking_direction(px: float, py: float, qx: float, qy: float, vx: float, vy: float) -> tuple[float, float]:
    """Return the common walking direction of two agents: desired direction of either, otherwise current direction."""
    if px * px + py * py > POINTED * POINTED:
        return unit(px, py)
    if qx * qx + qy * qy > POINTED * POINTED:
        return unit(qx, qy)
    return unit(vx, vy)


SAMPLES = 48
"""Maximum number of samples per level."""
SLOW = 0.1
"""Below this speed [m/s] an agent samples all directions, and a chosen velocity counts as standing."""


def _turns(count: int, shift: float, round_: float) -> Floats:
    """Return sines and cosines in single precision, whose rounding decides if samples at right angles go backwards."""
    angle = (np.arange(count, dtype=np.float32) + np.float32(shift)) * np.float32(np.pi) * np.float32(2.0)
    angle = angle / np.float32(round_)
    return np.stack([np.sin(angle), np.cos(angle)]).astype(np.float64)


EIGHT, SIX, SIXTEEN = _turns(8, 0.0, 8.0), _turns(6, 0.5, 6.0), _turns(16, 0.0, 16.0)


@kernel
def sample_first(samples: Floats, vx: float, vy: float, px: float, py: float, radius: float) -> int:
    """Write the first samples (x, y, size); return their number."""
    speed = math.sqrt(vx * vx + vy * vy)
    scale = max(math.sqrt(px * px + py * py), speed)
    scale = 4.0 * radius if scale <= radius else scale
    _write_sample(samples, 0, px, py, 0.3 * scale)
    _write_sample(samples, 1, vx, vy, 0.3 * scale)
    for k in range(8):  # on the circle from 0 to v
        along, across = 0.5 * (1.0 + EIGHT[1, k]), 0.5 * EIGHT[0, k]
        size = (1.0 - abs(k - 4.0) / 8.0) * 0.5 * scale
        _write_sample(samples, 2 + k, vx * along + vy * across, vy * along - vx * across, size)
    for k in range(6):
        along, across = 0.5 + 0.3 * SIX[0, k], 0.3 * SIX[1, k]
        _write_sample(samples, 10 + k, vx * along + vy * across, vy * along - vx * across, 0.3 * scale)
        _write_sample(samples, 16 + k, vx + 0.2 * scale * SIX[1, k], vy + 0.2 * scale * SIX[0, k], 0.4 * scale)
    _write_sample(samples, 22, 0.5 * vx, 0.5 * vy, 0.4 * scale)
    if speed >= SLOW:
        return 23
    for k in range(16):
        _write_sample(samples, 23 + k, scale * SIXTEEN[0, k], scale * SIXTEEN[1, k], 0.5 * scale)
    for k in range(8):
        _write_sample(samples, 39 + k, 0.5 * scale * SIXTEEN[0, k], 0.5 * scale * SIXTEEN[1, k], 0.25 * scale)
    return 47


@kernel
def _write_sample(samples: Floats, at: int, x: float, y: float, size: float) -> None:
    samples[at, 0], samples[at, 1], samples[at, 2] = x, y, size


@kernel
def sample_around(samples: Floats, best: Floats) -> int:
    """Write four samples around each of the two best; return their number."""
    for k in range(2):
        x, y, size = best[k, 0], best[k, 1], best[k, 2]
        step, finer = 0.3 * size, 0.6 * size * size
        _write_sample(samples, 4 * k, x + step, y + step, finer)
        _write_sample(samples, 4 * k + 1, x - step, y + step, finer)
        _write_sample(samples, 4 * k + 2, x - step, y - step, finer)
        _write_sample(samples, 4 * k + 3, x + step, y - step, finer)
    return 8


@kernel
def keep_best(best: Floats, samples: Floats, k: int, score: float) -> None:
    """Update the two best samples with sample k; as in the original, a replaced best does not become second best."""
    if score > best[0, 3]:
        return
    at = 0 if score > best[1, 3] else 1
    best[at, 0], best[at, 1], best[at, 2], best[at, 3] = samples[k, 0], samples[k, 1], samples[k, 2], score


MEMORY = "vog_calm"
"""Name in the memory of a scene: calm of each agent, which grows with the time since its last large velocity change."""
CALM = 1.0
"""Initial calm."""
CHANGED2 = 0.01
"""Squared change of velocity [m2/s2] above which the calm is reset."""
BRIEF = 0.02
"""Weight of the desired velocity when choosing the samples to refine."""
SHORTEST = 1e-3
"""Minimum time horizon [s]."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    calm: Floats
    external: NDArray[np.bool_]
    walking: NDArray[np.bool_]
    horizon: Floats
    wall_horizon: Floats
    preference: Floats
    group_weight: Floats
    group_neighbors: Ints
    group_radius: Floats
    group_distance: Floats
    group_horizon: Floats
    formation: Floats
    closeness: Floats


class _Groups(NamedTuple):
    """Group members by row: the group of row k is ``member[first[k]:last[k]]``, including the row itself."""

    member: Ints
    first: Ints
    last: Ints


@kernel(parallel=True)
def _choose(crowd: _Crowd, near: Neighbors, groups: _Groups, walls: Floats, out: Floats) -> None:
    """Choose the next velocity of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        _choose_part(part * CHUNK, min((part + 1) * CHUNK, len(out)), crowd, near, groups, walls, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, near: Neighbors, groups: _Groups, walls: Floats, out: Floats
) -> None:
    # unpack the tuples outside of the loop: each access counts references
    (
        place, velocity, desired, radius, top, calm, external, walking, horizon, wall_horizon, preference, weight, most,
        keep, reach, group_horizon, formation, closeness,
    ) = crowd  # fmt: skip
    agent, number, order = near
    member, first, last = groups
    A = agent.shape[1]
    cones, fellows = np.empty((agent.shape[2], CONE)), np.empty((MOST_FELLOWS, FELLOW))
    close, found, key = np.empty((len(walls), 6)), np.empty(MOST_FELLOWS, dtype=np.int64), np.empty(MOST_FELLOWS)
    samples, best = np.empty((SAMPLES, 3)), np.empty((2, 4))
    for k in range(begin, end):
        row = order[k]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        x, y, vx, vy = place[row, 0], place[row, 1], velocity[row, 0], velocity[row, 1]
        px, py, r = desired[row, 0], desired[row, 1], radius[row]
        cone_count = number[e, a]
        for n in range(cone_count):
            other = row - a + agent[e, a, n]
            cone(
                cones, n, place[other, 0] - x, place[other, 1] - y, vx, vy, velocity[other, 0], velocity[other, 1],
                r + radius[other], horizon[row], not external[other], 1.0 if row < other else -1.0,
            )  # fmt: skip
        wall_count = walls_near(walls, x, y, top[row] * wall_horizon[row] + r, close)
        mates = member[first[row] : last[row]]
        fellow_count = pick_fellows(row, mates, place, velocity, desired, reach[row], most[row], found, key)
        for n in range(fellow_count):
            other = found[n]
            wx, wy = walking_direction(px, py, desired[other, 0], desired[other, 1], vx, vy)
            companion(
                fellows, n, place[other, 0] - x, place[other, 1] - y, velocity[other, 0], velocity[other, 1], wx, wy,
                keep[row], group_horizon[row],
            )  # fmt: skip
        bx, by = _search(
            samples, best, vx, vy, px, py, r, cones[:cone_count], close[:wall_count], wall_horizon[row],
            fellows[:fellow_count], weight[row], keep[row], formation[row], closeness[row], preference[row], calm[row],
        )  # fmt: skip
        out[row, 0], out[row, 1], out[row, 2] = _limit_speed(bx, by, vx, vy, top[row], calm[row])


@kernel
def _search(
    samples: Floats, best: Floats, vx: float, vy: float, px: float, py: float, radius: float, cones: Floats,
    walls: Floats, wall_horizon: float, fellows: Floats, weight: float, keep: float, formation: float,
    closeness: float, preference: float, calm: float,
) -> tuple[float, float]:  # fmt: skip
    """Return the sampled velocity with the lowest cost; ``samples`` and ``best`` are working memory."""
    wish, now = (px, py, *unit(px, py)), unit(vx, vy)
    count = sample_first(samples, vx, vy, px, py, radius)
    best[:, :3] = 0.0
    lowest, bx, by = math.inf, vx, vy
    for _ in range(3):
        best[:, 3] = math.inf
        for n in range(count):
            sx, sy = samples[n, 0], samples[n, 1]
            score = collision(sx, sy, cones, len(cones), walls, len(walls), radius, wall_horizon)
            score += weight * fellowship(sx, sy, fellows, len(fellows), keep, formation, closeness)
            off, penalty = own_way(sx, sy, wish, now, calm)
            keep_best(best, samples, n, score + BRIEF * off)
            score += preference * off + penalty
            if score < lowest:
                lowest, bx, by = score, sx, sy
        if lowest == 0.0:
            break
        count = sample_around(samples, best)
    return bx, by


@kernel
def _limit_speed(x: float, y: float, vx: float, vy: float, top: float, calm: float) -> tuple[float, float, float]:
    """Return the velocity, set to 0 if slow and limited to ``top``, and the calm after the step."""
    speed = math.sqrt(x * x + y * y)
    if speed < SLOW:
        x = y = speed = 0.0
    change2 = (x - vx) ** 2 + (y - vy) ** 2
    if change2 > CHANGED2:
        calm = 1.0 / (25.0 * change2)
    if speed > top:
        x, y = x * top / speed, y * top / speed
    return x, y, calm


@dataclass(frozen=True)
class VOG(CrowdModel):
    """Velocity obstacles with groups: agents choose the best sampled velocity for avoidance, group and goal.

    The cost of a velocity is its depth in the worst velocity obstacle of neighbours and walls, plus the mean violation
    of the constraints to stay with (and abreast of) the members of the group, plus the deviation from the desired
    velocity, plus a penalty on turning that decreases with calm. The calm of an agent is stored in the memory
    ``vog_calm`` of the scene: it is reset by large velocity changes and then grows with time. Groups are those of the
    scene; -1 is no group.

    Args:
        neighbor_distance: maximum distance of neighbours [m].
        max_neighbors: maximum number of neighbours, the nearest first.
        time_horizon: time horizon for neighbours [s].
        wall_horizon: time horizon for walls [s].
        preference_weight: weight of the desired velocity.
        group_weight: weight of the group.
        group_neighbors: maximum number of group members considered, at most 16; members that are near, ahead and walk
            in the same direction are preferred.
        group_radius: target distance of group members after one second [m].
        group_distance: group members farther than this [m] are ignored.
        group_horizon: time to return into the range of the group [s].
        formation: maximum offset ahead or behind when walking abreast [m]; 0 for no formation.
        closeness: importance of the group for an agent, 0 to 1.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.

    External agents do not give way. The cost of walls is specific to crowdbot: the excess speed of a velocity that
    touches a wall within the horizon. Use :meth:`step`; :meth:`velocity` does not update the memory.

    The default follows the implementation in the CrowdBot simulator, except for the cost of walls.

    Source: Ren, Charalambous, Bruneau, Peng, Pettré 2017, doi:10.1111/cgf.12993, as in the CrowdBot simulator.

    Raises:
        InputError: a parameter is not finite or below its minimum, or ``group_neighbors`` is above 16.

    >>> pair = Scene.of([[0, 0], [0, 3]], [[1, 0], [1, 0]], preferred_velocity=[[1, 0], [1, 0]], group=[5, 5])
    >>> for _ in range(60):
    ...     pair = VOG().step(pair, dt=0.1)
    >>> float(pair.position[0, 1, 1] - pair.position[0, 0, 1]) < 1.2
    True
    """

    paper: ClassVar[Paper] = Paper(
        "Zhiguo Ren, Panayiotis Charalambous, Julien Bruneau, Qunsheng Peng, Julien Pettré",
        2017,
        "Group modeling: a unified velocity-based approach",
        "Computer Graphics Forum 36(8)",
        "10.1111/cgf.12993",
    )
    batched = True
    valid_range = ModelRange(0.7, FREE, 0.1, PAGE, "CrowdBot simulator")

    neighbor_distance: PerAgent = parameter(5.0, unit="m", low=1.0, high=15.0, source="CrowdBot simulator")
    max_neighbors: PerAgent = parameter(10.0, unit="1", low=1.0, high=20.0, source="RVO2, examples")
    time_horizon: PerAgent = parameter(2.0, unit="s", low=0.2, high=8.0, source="CrowdBot simulator", min=SHORTEST)
    wall_horizon: PerAgent = parameter(1.0, unit="s", low=0.2, high=4.0, source="CrowdBot simulator", min=SHORTEST)
    preference_weight: PerAgent = parameter(0.15, unit="1", low=0.02, high=0.6, source="CrowdBot simulator")
    group_weight: PerAgent = parameter(0.2, unit="1", low=0.0, high=0.8, source="CrowdBot simulator")
    group_neighbors: PerAgent = parameter(
        2.0, unit="1", low=1.0, high=4.0, source="CrowdBot simulator", max=MOST_FELLOWS
    )
    group_radius: PerAgent = parameter(1.0, unit="m", low=0.5, high=3.0, source="CrowdBot simulator")
    group_distance: PerAgent = parameter(80.0, unit="m", low=5.0, high=80.0, source="CrowdBot simulator")
    group_horizon: PerAgent = parameter(2.0, unit="s", low=0.5, high=4.0, source="CrowdBot simulator", min=SHORTEST)
    formation: PerAgent = parameter(0.2, unit="m", low=0.0, high=0.5, source="CrowdBot simulator")
    closeness: PerAgent = parameter(1.0, unit="1", low=0.1, high=1.0, source="CrowdBot simulator")
    max_speed: PerAgent | None = None

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        return self._choose_velocity(scene, dt)[..., :2]

    @property
    def memory_at_start(self) -> Mapping[str, float]:
        return {MEMORY: CALM}

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        out = self._choose_velocity(scene, dt)
        calm = np.where(movable(scene), out[..., 2] + 10.0 * dt, CALM)
        return scene.advance(out[..., :2], dt).replace(memory={**scene.memory, MEMORY: calm})

    def _choose_velocity(self, scene: Scene, dt: float) -> Floats:
        wish, walking, seen, velocity = begin_step(scene, dt)
        near = neighbors_of(self, scene, seen, walking)
        values = (
            rows(scene.position),
            rows(scene.velocity),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            rows(per_agent(scene.memory.get(MEMORY, CALM), scene.shape, MEMORY)),
            rows(scene.external),
            rows(walking),
            *parameter_columns(self, scene.shape, "time_horizon", "wall_horizon", "preference_weight", "group_weight"),
            rows(np.rint(per_agent(self.group_neighbors, scene.shape, "group_neighbors")).astype(np.int64)),
            *parameter_columns(
                self, scene.shape, "group_radius", "group_distance", "group_horizon", "formation", "closeness"
            ),
        )
        crowd = _Crowd._make(values)
        out = np.zeros((*scene.shape, 3))
        out[..., :2] = velocity
        _choose(crowd, near, _groups(scene.group, seen), scene.walls.segments(), rows(out))
        return out


def _groups(group: Ints, seen: NDArray[np.bool_]) -> _Groups:
    """Return the members of each group, by environment; negative numbers are no group."""
    E, A = group.shape
    first, last = np.zeros(E * A, dtype=np.int64), np.zeros(E * A, dtype=np.int64)
    flat = rows(group)
    grouped = np.flatnonzero(flat >= 0)
    if grouped.size == 0:
        return _Groups(np.zeros(0, dtype=np.int64), first, last)
    _, name = np.unique(flat[grouped], return_inverse=True)
    key = (grouped // A) * (name.max() + 1) + name
    there = rows(seen)[grouped]
    order = np.argsort(key[there], kind="stable")
    held = key[there][order]
    first[grouped] = np.searchsorted(held, key, side="left")
    last[grouped] = np.searchsorted(held, key, side="right")
    return _Groups(grouped[there][order], first, last)
