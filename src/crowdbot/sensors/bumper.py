"""A ring of contact switches around a round robot."""

from __future__ import annotations

import math
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, Pose, Scene, SpatialPose, check_number, storable
from crowdbot.typing import Floats, Ints

from .noise import Randomness, apply_noise
from .ray_shapes import NOTHING, PROP, WALLS
from .sensor import Reading, Sensor, finite_or_nan, planar_pose, spatial_pose
from .view import SensorView

TURN = 2.0 * math.pi
MOST_SECTORS = 100_000


@storable
@dataclass(frozen=True)
class BumperReading(Reading):
    """Pressed sectors of a bumper in E environments, K sectors.

    Fields:
        pressed: ``[E, K]``.
        depth: ``[E, K]`` deepest penetration in the sector [m], 0 without contact.
        hit: ``[E, K]`` object in contact: index of an agent, -1 nothing, -2 a wall, -4 a prop.
    """

    pressed: NDArray[np.bool_]
    depth: Floats
    hit: Ints


@dataclass(frozen=True)
class Bumper(Sensor):
    """A ring of contact switches in equal sectors, counter-clockwise from ``first``.

    A sector is pressed if its arc overlaps the disc of an agent, a limb, a post or a wall; a gap of 0 counts as
    contact.

    Fields:
        radius: radius of the ring [m].
        sectors: number of sectors K.
        first: start angle of sector 0 from the x axis of the sensor [rad].
        low, high: lower and upper edge of the ring above the sensor's origin [m], for limbs.

    Raises:
        InputError: a value is not allowed.

    >>> scene = Scene.of([[0.55, 0.0]], radius=0.3)
    >>> Bumper(radius=0.3, sectors=4, first=-math.pi / 4).read(scene, Pose.of((0.0, 0.0), 0.0)).pressed.tolist()
    [[True, False, False, False]]
    """

    batched = True

    radius: float = 0.3
    sectors: int = 8
    first: float = -math.pi / 8
    low: float = -0.1
    high: float = 0.1

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("Bumper", "radius", self.radius, "m", exclusive_min=0.0)
        check_number("Bumper", "sectors", self.sectors, min=1, max=MOST_SECTORS, whole=True)
        if not -TURN <= self.first <= TURN:
            raise InputError(f"Bumper: first = {self.first} rad must be within -2 pi to 2 pi")
        if not -math.inf < self.low <= self.high < math.inf:
            raise InputError(f"Bumper: low = {self.low} m and high = {self.high} m must be finite and in this order")

    def sector(self, points: ArrayLike, pose: Pose | SpatialPose) -> Ints:
        """Return the sector ``[E, N]`` of points ``[E, N, 2]`` or ``[E, N, 3]`` in the world."""
        place = planar_pose(pose)
        away = np.asarray(points, dtype=np.float64)[..., :2] - place.position[:, None]
        angle = np.arctan2(away[..., 1], away[..., 0]) - place.heading[:, None] - self.first
        return np.asarray(np.minimum((angle % TURN) / TURN * self.sectors, self.sectors - 1).astype(np.int64))

    def measure(self, view: SensorView, state: None, rng: Randomness | None = None) -> tuple[BumperReading, None]:
        """Return the pressed sectors. Noise changes the reported depths, not the contacts.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        scene, pose = view.scene, view.pose
        spatial = spatial_pose(pose)
        plane = planar_pose(pose)
        depth = np.full((scene.shape[0], self.sectors), -np.inf)
        hit = np.full(depth.shape, NOTHING)
        for e in range(scene.shape[0]):
            low, high = spatial.position[e, 2] + self.low, spatial.position[e, 2] + self.high
            arcs = [*_rounds(scene, e, plane.position[e], low, high), _walls(scene, plane.position[e], self.radius)]
            for centre, size, owner in arcs:
                self._press(centre, size, owner, plane.heading[e], depth[e], hit[e])
        pressed = depth >= 0.0
        shown = self._shown(np.where(pressed, depth, 0.0), rng)
        return BumperReading(scene.time, pose, pressed, shown, np.where(pressed, hit, NOTHING)), None

    def _shown(self, depth: Floats, rng: Randomness | None) -> Floats:
        return finite_or_nan(apply_noise(depth, self.noises, rng))

    def _press(self, centre: Floats, size: Floats, owner: Ints, heading: float, depth: Floats, hit: Ints) -> None:
        """Press the sectors that overlap discs at ``centre`` ``[N, 2]``, relative to the centre of the ring."""
        away = np.hypot(centre[:, 0], centre[:, 1])
        deep = self.radius + size - away
        half = _half_arc(away, size, self.radius)
        angle = np.arctan2(centre[:, 1], centre[:, 0]) - heading - self.first
        wide = TURN / self.sectors
        for k in range(self.sectors):
            off = np.abs((angle - (k + 0.5) * wide + math.pi) % TURN - math.pi)
            inside = (deep >= 0.0) & (off <= half + 0.5 * wide + 1e-12)
            if np.any(inside):
                worst = int(np.argmax(np.where(inside, deep, -np.inf)))
                if deep[worst] > depth[k]:
                    depth[k], hit[k] = deep[worst], owner[worst]


def _half_arc(away: Floats, size: Floats, radius: float) -> Floats:
    """Return half the angle of the ring that lies in discs at distance ``away`` from its centre; pi if all of it
    does.
    """
    cosine = (away**2 + radius**2 - size**2) / np.maximum(2.0 * away * radius, 1e-300)
    return np.asarray(np.where(away + radius <= size, math.pi, np.arccos(np.clip(cosine, -1.0, 1.0))))


Arcs = tuple[Floats, Floats, Ints]


def _rounds(scene: Scene, e: int, place: Floats, low: float, high: float) -> list[Arcs]:
    """Return agents without limbs, limbs and posts as discs relative to the centre of the ring."""
    bodies = scene.bodies
    bare = np.ones(scene.shape[1], dtype=np.bool_)
    arcs: list[Arcs] = []
    if bodies is not None:
        for owner in (bodies.owner, bodies.post_owner, bodies.box_owner):
            bare[owner[(owner >= 0) & (owner < len(bare))]] = False
        near, size = _limbs(bodies.start[e], bodies.end[e], bodies.radius[e], place, low, high)
        arcs.append(_kept(near, size, bodies.owner, scene, e))
        foot, tall = bodies.post_foot[e], bodies.post_height[e]
        reach = (foot[:, 2] <= high) & (foot[:, 2] + tall >= low)
        arcs.append(
            _kept(foot[:, :2] - place, np.where(reach, bodies.post_radius[e], np.nan), bodies.post_owner, scene, e)
        )
    agents = np.flatnonzero(bare)
    arcs.append(_kept(scene.position[e, agents] - place, scene.radius[e, agents], agents, scene, e))
    return arcs


def _kept(centre: Floats, size: Floats, owner: Ints, scene: Scene, e: int) -> Arcs:
    agents = scene.shape[1]
    here = np.append(scene.active[e], True)[np.where((owner >= 0) & (owner < agents), owner, agents)]
    here &= (owner < agents) & np.isfinite(centre).all(axis=1) & (size > 0.0)
    return centre[here], size[here], np.where(owner < 0, PROP, owner)[here]


def _limbs(start: Floats, end: Floats, radius: Floats, place: Floats, low: float, high: float) -> tuple[Floats, Floats]:
    """Return the nearest point of each limb to the ring, ``[B, 2]`` relative to its centre, and the radius there."""
    a = start - np.append(place, 0.0)
    e = end - start
    flat = a[:, 0] * e[:, 0] + a[:, 1] * e[:, 1]
    flat2 = e[:, 0] ** 2 + e[:, 1] ** 2
    candidates = [np.zeros(len(a)), np.ones(len(a)), -flat / np.where(flat2 > 0.0, flat2, 1.0)]
    for z in (low, high):
        along = flat + (a[:, 2] - z) * e[:, 2]
        candidates.append(-along / np.where(flat2 + e[:, 2] ** 2 > 0.0, flat2 + e[:, 2] ** 2, 1.0))
        candidates.append((z - a[:, 2]) / np.where(e[:, 2] != 0.0, e[:, 2], np.inf))
    share = np.clip(np.stack(candidates), 0.0, 1.0)
    points = a + share[..., None] * e
    over = np.maximum(np.maximum(low - points[..., 2], points[..., 2] - high), 0.0)
    gap2 = points[..., 0] ** 2 + points[..., 1] ** 2 + over**2
    best = np.argmin(np.where(np.isnan(gap2), np.inf, gap2), axis=0)
    rows = np.arange(len(a))
    size2 = radius**2 - over[best, rows] ** 2
    return points[best, rows, :2], np.where(size2 > 0.0, np.sqrt(np.maximum(size2, 0.0)), np.nan)


def _walls(scene: Scene, place: Floats, radius: float) -> Arcs:
    """Return the parts of walls inside the ring as small discs without gaps."""
    walls = scene.walls.segments()
    a, e = walls[:, :2] - place, walls[:, 2:] - walls[:, :2]
    length2 = np.maximum((e**2).sum(axis=1), 1e-300)
    middle = np.clip(-(a * e).sum(axis=1) / length2, 0.0, 1.0)
    share = np.linspace(-1.0, 1.0, 65)[:, None] * radius / np.sqrt(length2) + middle
    points = a + np.clip(share, 0.0, 1.0)[..., None] * e
    flat = points.reshape(-1, 2)
    return flat, np.zeros(len(flat)), np.full(len(flat), WALLS)
