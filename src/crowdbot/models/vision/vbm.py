"""VBM: gradient-based steering for vision-based crowd simulation (Dutra et al. 2017)."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import CHUNK, InputError, Neighbors, Paper, PerAgent, Scene, kernel, parameter, prange
from crowdbot.models.model import CrowdModel, begin_step, check_variant, movable, neighbors_of, rows, speed_limit
from crowdbot.models.parameter_rows import parameter_columns
from crowdbot.models.valid_range import JAMS, TWO_WAY, ModelRange
from crowdbot.typing import Floats

from .vbm_slopes import FAN, FIELD, STEEP, STILL, desire_slopes, look_at_walls, mean_slopes, sum_slopes

VARIANTS = ("agents", "crowdbot")
MOST_RAYS = 4096
FAST = 1e6
"""Upper limit of the turn in a step [rad]."""
LAW = (
    "time_scale", "distance_scale", "speed_scale", "angle_scale", "wall_distance", "max_acceleration",
    "max_turn", "ridge", "gain",
)  # fmt: skip
"""Parameters in the order of the kernel."""


class _Crowd(NamedTuple):
    """Data of every agent for the kernel, by row ``e * A + a``."""

    position: Floats
    velocity: Floats
    heading: Floats
    desired: Floats
    radius: Floats
    max_speed: Floats
    walking: NDArray[np.bool_]
    time_scale: Floats
    distance_scale: Floats
    speed_scale: Floats
    angle_scale: Floats
    wall_distance: Floats
    max_acceleration: Floats
    max_turn: Floats
    ridge: Floats
    gain: Floats


@kernel(parallel=True)
def _choose(
    crowd: _Crowd, seen: Neighbors, walls: Floats, rays: Floats, field: bool, luck: Floats, dt: float, out: Floats
) -> None:
    """Choose velocity and direction of every agent, row by row."""
    for part in prange((len(out) + CHUNK - 1) // CHUNK):
        begin, end = part * CHUNK, min((part + 1) * CHUNK, len(out))
        _choose_part(begin, end, crowd, seen, walls, rays, field, luck, dt, out)


@kernel
def _choose_part(
    begin: int, end: int, crowd: _Crowd, seen: Neighbors, walls: Floats, rays: Floats, field: bool, luck: Floats,
    dt: float, out: Floats,
) -> None:  # fmt: skip
    # unpack the tuples outside of the loop: each access counts references
    place, velocity, heading, desired, radius, top, walking, late, near, slow, wide, far, most, sharp, ridge, gain = (
        crowd
    )
    agent, number, order = seen
    A = agent.shape[1]
    others = np.empty(agent.shape[2], dtype=np.int32)
    depth = np.empty(rays.shape[1])
    taken = np.empty(rays.shape[1], dtype=np.bool_)
    sums = np.empty(4)
    for k in range(begin, end):
        row = order[k]
        if not walking[row]:
            continue
        e, a = row // A, row % A
        for n in range(number[e, a]):
            others[n] = row - a + agent[e, a, n]
        vx, vy = velocity[row, 0], velocity[row, 1]
        speed = math.sqrt(vx * vx + vy * vy)
        hx, hy = math.cos(heading[row]), math.sin(heading[row])
        if speed > STILL:
            hx, hy = vx / speed, vy / speed
        chance = 0.75 + 0.5 * luck[row]
        look_at_walls(walls, place[row, 0], place[row, 1], hx, hy, far[row], rays, depth)
        sum_slopes(
            row, others[: number[e, a]], place, velocity, radius, hx, hy, speed, late[row], near[row], rays, depth,
            taken, field, chance * ridge[row], sums,
        )  # fmt: skip
        turn, change = mean_slopes(sums, STEEP * chance if field else 0.0)
        pull = gain[row] * dt
        steepest = math.inf if field or pull == 0.0 else 1.0 / pull
        turn0, change0 = desire_slopes(
            hx, hy, speed, desired[row, 0], desired[row, 1], slow[row], wide[row], steepest
        )  # fmt: skip
        sharpest = min(sharp[row] * dt / max(STILL, speed), FAST)
        angle = -min(sharpest, max(-sharpest, pull * (turn + turn0)))
        speed = min(top[row], max(0.0, speed - max(pull * (change + change0), -most[row] * dt)))
        cos, sin = math.cos(angle), math.sin(angle)
        out[row, 2], out[row, 3] = hx * cos - hy * sin, hy * cos + hx * sin
        out[row, 0], out[row, 1] = speed * out[row, 2], speed * out[row, 3]


@dataclass(frozen=True)
class VBM(CrowdModel):
    """Vision-based model: agents follow the gradient of a cost over time and distance of closest approach.

    The cost of a visible object with closest approach in t [s] at distance c [m] is exp(-((t / time_scale)^2 +
    (c / distance_scale)^2) / 2). Direction and speed follow the gradient of its mean over the field of view (150
    degrees), plus a weak cost of deviations from the desired velocity: agents need several seconds to regain speed, as
    published. Acceleration is limited, braking is not. A standing agent looks along its heading. The model has no
    contacts: bodies may overlap in a dense crowd.

    Args:
        neighbor_distance: maximum distance of visible agents [m].
        max_neighbors: maximum number of visible agents, the nearest first.
        wall_distance: maximum distance of visible walls [m].
        time_scale: spread of the cost over the time of closest approach [s].
        distance_scale: spread of the cost over the distance of closest approach [m].
        speed_scale: spread of the cost over the deviation from the desired speed [m/s].
        angle_scale: spread of the cost over the deviation from the desired direction [rad].
        max_acceleration: maximum forward acceleration [m/s^2].
        max_turn: maximum lateral acceleration [m/s^2]; agents at rest turn immediately.
        gain: gain of the gradient step; larger values return to the desired path sooner.
        ridge: minimum distance of closest approach [m] for sideways pushes; exact hits push to the right.
        max_speed: ``[E, A]`` [m/s]; None uses the maximum speed of the scene.
        variant: ``agents``: each agent is weighted by its visual angle, distances are between bodies, and walls are
            seen along 15 rays. ``crowdbot``: the field of view is an array of rays with occlusion, distances are
            between centres, and ``ridge`` has no effect (agents exactly head on do not turn).
        rays: number of rays of the ``crowdbot`` variant.

    With ``rng``, the sideways push varies by a quarter; otherwise it is the mean.

    The default variant ``agents`` replaces the image of the paper by the visual angle of each agent, without occlusion.

    Source: Dutra, Marques, Cavalcante-Neto, Vidal, Pettré 2017, doi:10.1111/cgf.13130; ``crowdbot`` is the version of
    the CrowdBot simulator.

    Raises:
        InputError: a parameter is not finite or below its minimum, the variant is unknown or ``rays`` not in 2..4096.

    >>> ahead = Scene.of([[0, 0], [4, 0.2]], [[1, 0], [-1, 0]], preferred_velocity=[[1, 0], [-1, 0]])
    >>> VBM().velocity(ahead, dt=0.1).round(3).tolist()
    [[[0.972, -0.077], [-0.972, 0.077]]]
    """

    paper: ClassVar[Paper] = Paper(
        "Teofilo B. Dutra, Ricardo Marques, Joaquim B. Cavalcante-Neto, Creto A. Vidal, Julien Pettré",
        2017,
        "Gradient-based steering for vision-based crowd simulation algorithms",
        "Computer Graphics Forum 36(2)",
        "10.1111/cgf.13130",
    )
    batched = True
    valid_range = ModelRange(0.25, JAMS, 0.1, TWO_WAY, "CrowdBot simulator")

    neighbor_distance: PerAgent = parameter(5.0, unit="m", low=1.0, high=15.0, source="CrowdBot simulator")
    max_neighbors: PerAgent = parameter(32.0, unit="1", low=4.0, high=64.0, source="half of 5 m at 0.8 people/m2")
    wall_distance: PerAgent = parameter(10.0, unit="m", low=1.0, high=15.0, source="CrowdBot simulator")
    time_scale: PerAgent = parameter(1.8, unit="s", low=0.5, high=4.0, source="CrowdBot simulator", min=0.01)
    distance_scale: PerAgent = parameter(0.3, unit="m", low=0.1, high=1.0, source="CrowdBot simulator", min=0.01)
    speed_scale: PerAgent = parameter(3.3, unit="m/s", low=0.5, high=4.0, source="CrowdBot simulator", min=0.01)
    angle_scale: PerAgent = parameter(2.0, unit="rad", low=0.5, high=3.0, source="CrowdBot simulator", min=0.01)
    max_acceleration: PerAgent = parameter(0.8, unit="m/s^2", low=0.3, high=5.0, source="CrowdBot simulator")
    max_turn: PerAgent = parameter(math.pi / 4.0, unit="m/s^2", low=0.3, high=5.0, source="CrowdBot simulator")
    gain: PerAgent = parameter(1.0, unit="1", low=0.5, high=20.0, source="Dutra et al. 2017; examples of UMANS use 20")
    ridge: PerAgent = parameter(0.1, unit="m", low=0.0, high=0.3, source="chosen so that exact hits are avoided")
    max_speed: PerAgent | None = None
    variant: str = "agents"
    rays: int = 256

    def __post_init__(self) -> None:
        super().__post_init__()
        check_variant(self, self.variant, VARIANTS)
        if isinstance(self.rays, bool) or not isinstance(self.rays, int) or not 2 <= self.rays <= MOST_RAYS:
            raise InputError(f"VBM: rays = {self.rays!r} is not allowed, it must be a whole number, 2 to {MOST_RAYS}")

    def velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Floats:
        # rng varies the sideways push
        return self._choose_velocity(scene, dt, rng)[..., :2]

    def step(self, scene: Scene, dt: float, rng: np.random.Generator | None = None) -> Scene:
        # standing agents turn, too
        out = self._choose_velocity(scene, dt, rng)
        after = scene.advance(out[..., :2], dt)
        turned = np.where(movable(scene), np.arctan2(out[..., 3], out[..., 2]), after.heading)
        return after.replace(heading=turned)

    def _choose_velocity(self, scene: Scene, dt: float, rng: np.random.Generator | None) -> Floats:
        wish, walking, visible, velocity = begin_step(scene, dt)
        seen = neighbors_of(self, scene, visible, walking)
        values = (
            rows(scene.position),
            rows(scene.velocity),
            rows(scene.heading),
            rows(wish),
            rows(scene.radius),
            rows(speed_limit(self.max_speed, scene)),
            rows(walking),
            *parameter_columns(self, scene.shape, *LAW),
        )
        crowd = _Crowd._make(values)
        field = self.variant == "crowdbot"
        angle = np.linspace(-0.5 * FIELD, 0.5 * FIELD, self.rays if field else FAN)
        luck = np.full(scene.shape, 0.5) if rng is None else rng.random(scene.shape)
        out = np.zeros((*scene.shape, 4))
        out[..., :2] = velocity
        walls = scene.walls.segments()
        _choose(crowd, seen, walls, np.stack([np.sin(angle), np.cos(angle)]), field, rows(luck), float(dt), rows(out))
        return out
