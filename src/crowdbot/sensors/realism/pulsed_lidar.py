"""PulsedLidar2D: a planar laser scanner with the effects of a real one."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Any, ClassVar, NamedTuple

import numpy as np

from crowdbot.core import InputError, Pose, Scene, SpatialPose, Walls, check_number, storable
from crowdbot.sensors.beams import sort_beams, unit_vectors
from crowdbot.sensors.lidar import Lidar2D, Scan, beam_angles
from crowdbot.sensors.noise import Randomness
from crowdbot.sensors.ranging import apply_limits
from crowdbot.sensors.ray_casting import cast_rays
from crowdbot.sensors.ray_shapes import FLOOR, NOTHING, PROP
from crowdbot.sensors.ray_shapes import WALLS as WALL
from crowdbot.sensors.sensor import spatial_pose
from crowdbot.sensors.view import SensorView
from crowdbot.typing import Floats, Ints

from .moving_scene import SweepState, move_scene, sensor_motion

BLOCKS = 36
"""Number of instants at which the scene is sampled during a scan."""
RAYS, WEIGHTS = np.array([-0.5, 0.0, 0.5]), np.array([0.25, 0.5, 0.25])
"""Rays of a wide beam, as shares of its width, and their shares of its power."""
REFLECTIVITY = {WALL: 0.6, FLOOR: 0.3, PROP: 0.4, NOTHING: 0.0}
GLASS, SPECULAR = 0.5, math.cos(math.radians(10.0))
"""Reflectivity of glass, and the cosine of incidence from which it returns a beam."""
CLOTH, BLACK = 0.5, 0.04
"""Reflectivity of clothes, and of black ones."""
GOLDEN = 0.6180339887498949
REPORTS = ("first", "strongest", "last")


@storable
@dataclass(frozen=True)
class PulsedScan(Scan):
    """A scan with the time and the power of each beam.

    Fields:
        beam_time: ``[R]`` time of the beam after the time of the scan [s], at most 0.
        intensity: ``[E, R]`` received power over that of a white surface across the beam at 1 m; 0 without a return.
        echoes: ``[E, R, N]`` ranges of the first N echoes of the beam [m]; ``+inf`` for none.
    """

    shared_fields: ClassVar[tuple[str, ...]] = ("angles", "beam_time")
    beam_time: Floats
    intensity: Floats
    echoes: Floats


class _Rays(NamedTuple):
    """Rays ``[E, R, S]`` of wide beams: distance [m], cosine of incidence, object, part and received power."""

    distance: Floats
    cosine: Floats
    hit: Ints
    part: Ints
    power: Floats


@dataclass(frozen=True)
class PulsedLidar2D(Lidar2D):
    """A planar laser scanner with the effects of a real one; each is off by default.

    Without effects, the ranges are those of :class:`Lidar2D` with people as upright cylinders. The order is: rays of
    each beam through the scene at the time of the beam, glass, received power, echoes, false returns, then limits,
    noise and resolution as for :class:`Lidar2D`.

    Fields:
        rays, field_of_view, range_min, range_max, max_incidence, resolution, skins: as of :class:`Lidar2D`.
        scan_time: duration of a scan [s]; the last beam is at the time of the reading. People and the sensor move
            meanwhile, so that a scan is sheared.
        beam_width: full divergence of a beam [rad], sampled by three rays.
        pulse_length: surfaces of one beam that are at most this far apart [m] merge to one echo at their mean range by
            power: mixed pixels at edges.
        echoes: number of echoes in the reading.
        report: echo that is the range: ``first``, ``strongest`` or ``last``.
        range_10: largest range at which a surface of 10 % reflectivity returns a beam [m], as in data sheets; 0 for no
            limit by power. Walls have 60 %, floors 30 %, props 40 %, clothes 50 % and black clothes 4 %.
        black_clothes: share of people in black clothes; always the same ones.
        glass: numbers of the edges of walls that are of glass, from 0 in the order of the stage. Glass returns
            beams within 10 degrees of its normal; others pass.
        false_returns: probability that a beam returns from a random range nearer than the surface.

    Raises:
        InputError: a value is not allowed.

    >>> scene = Scene.of([[3.0, 0.0]], [[0.0, 1.0]], radius=0.3)
    >>> lidar = PulsedLidar2D(rays=360, scan_time=0.1)
    >>> scan = lidar.read(scene, Pose.of((0.0, 0.0), 0.0))
    >>> float(scan.ranges[0, 180].round(3)), scan.beam_time[[0, -1]].round(4).tolist()
    (2.704, [-0.0997, 0.0])
    """

    scan_time: float = 0.0
    beam_width: float = 0.0
    pulse_length: float = 0.3
    echoes: int = 1
    report: str = "strongest"
    range_10: float = 0.0
    black_clothes: float = 0.0
    glass: tuple[float, ...] = ()
    false_returns: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "glass", tuple(self.glass))
        if not all(k >= 0 and float(k).is_integer() for k in self.glass):
            raise InputError(f"PulsedLidar2D: glass = {self.glass} must be whole numbers from 0")
        check_number("PulsedLidar2D", "scan_time", self.scan_time, "s", min=0.0, max=1.0)
        check_number("PulsedLidar2D", "beam_width", self.beam_width, "rad", min=0.0, max=0.1)
        check_number("PulsedLidar2D", "pulse_length", self.pulse_length, "m", min=0.0)
        check_number("PulsedLidar2D", "echoes", self.echoes, min=1, max=3, whole=True)
        check_number("PulsedLidar2D", "range_10", self.range_10, "m", min=0.0)
        for name in ("black_clothes", "false_returns"):
            check_number("PulsedLidar2D", name, getattr(self, name), min=0.0, max=1.0)
        if self.report not in REPORTS:
            raise InputError(f"PulsedLidar2D: report = {self.report!r} must be one of {', '.join(REPORTS)}")
        if self.skins and self.scan_time > 0.0:
            raise InputError("PulsedLidar2D: skins need scan_time = 0, their triangles do not move during a scan")

    def measure(  # type: ignore[override]
        self, view: SensorView, state: SweepState | None, rng: Randomness | None = None
    ) -> tuple[PulsedScan, SweepState | None]:
        """Return the scan from the pose of the view; with a scan time, the state is the pose of this scan.

        Raises:
            InputError: the pose does not fit the scene, or noise or false returns lack a generator.
        """
        self.check(view)
        scene, pose = view.scene, view.pose
        angles = beam_angles(self.rays, self.field_of_view)
        beam_time = self.scan_time * (np.arange(1.0, self.rays + 1.0) / self.rays - 1.0)
        rays = self._cast(scene, pose, angles, beam_time, sensor_motion(state, view.time, pose))
        echoes, chosen, power, best = self._detect(rays)
        chosen_ray = best[..., None]
        cosine: Floats = np.take_along_axis(rays.cosine, chosen_ray, axis=-1)[..., 0]
        hit: Ints = np.take_along_axis(rays.hit, chosen_ray, axis=-1)[..., 0]
        part: Ints = np.take_along_axis(rays.part, chosen_ray, axis=-1)[..., 0]
        lost, ranges = ~np.isfinite(chosen), chosen.copy()
        if self.false_returns > 0.0:
            false = self._false_ranges(ranges.shape, rng)
            nearer = false < ranges
            ranges = np.where(nearer, false, ranges)
            lost = lost | nearer
        cosine, hit, part = np.where(lost, 1.0, cosine), np.where(lost, NOTHING, hit), np.where(lost, -1, part)
        true = ranges.copy()
        ranges = apply_limits(self, ranges, cosine, hit, part, rng)
        known = np.isfinite(ranges) & np.isfinite(true)
        error = np.where(known, ranges, 0.0) - np.where(known, true, 0.0)
        echoes = np.where(np.isfinite(echoes), echoes + error[..., None], np.inf)
        power = np.where(np.isfinite(ranges), power, 0.0)
        reading = PulsedScan(scene.time, pose, ranges, angles, hit, cosine, part, beam_time, power, echoes)
        return reading, SweepState(scene.time, pose) if self.scan_time > 0.0 else None

    def _cast(
        self, scene: Scene, pose: Pose | SpatialPose, angles: Floats, beam_time: Floats, motion: tuple[Floats, Floats]
    ) -> _Rays:
        """Return the rays of all beams, each at its time."""
        shares = RAYS if self.beam_width > 0.0 else np.zeros(1)
        blocks = np.array_split(np.arange(self.rays), min(self.rays, BLOCKS) if self.scan_time > 0.0 else 1)
        place = spatial_pose(pose)
        parts = []
        for block in blocks:
            ahead = float(beam_time[block].mean())
            shift = np.concatenate([ahead * motion[0], np.zeros((len(place.position), 1))], axis=1)
            there = SpatialPose(place.position + shift, place.rotation)
            aimed = angles[block][:, None] + self.beam_width * shares
            parts.append(self._cast_block(move_scene(scene, ahead), there, aimed, ahead * motion[1]))
        return _Rays(*(np.concatenate(list(rows), axis=1) for rows in zip(*parts, strict=True)))

    def _cast_block(self, scene: Scene, pose: SpatialPose, aimed: Floats, turn: Floats) -> _Rays:
        """Return the rays ``[E, B, S]`` of some beams from one instant, turned by ``turn`` ``[E]`` [rad]."""
        rows = []
        same = bool((turn == turn[0]).all())
        for e in range(1 if same else len(turn)):
            these = slice(None) if same else slice(e, e + 1)
            part = scene if same else scene.environments([e])
            there = SpatialPose(pose.position[these], pose.rotation[these])
            rows.append(self._through_glass(part, there, aimed + float(turn[e])))
        return _Rays(*(np.concatenate(list(one)) for one in zip(*rows, strict=True)))

    def _through_glass(self, scene: Scene, pose: SpatialPose, aimed: Floats) -> _Rays:
        rays = self._rays(scene, pose, aimed)
        walls = scene.walls
        if not any(k < len(walls) for k in self.glass):
            return rays
        edges = np.stack([walls.start, walls.end], axis=1)
        clear = Walls.of([edge for k, edge in enumerate(edges) if k not in self.glass])
        behind = self._rays(scene.replace(walls=clear), pose, aimed)
        glass = behind.distance > rays.distance + 1e-9
        passes = glass & (rays.cosine < SPECULAR)
        found: list[Any] = [np.where(passes, two, one) for one, two in zip(rays, behind, strict=True)]
        power = np.where(glass & ~passes, rays.power * GLASS / REFLECTIVITY[WALL], found[-1])
        return _Rays(found[0], found[1], found[2], found[3], power)

    def _rays(self, scene: Scene, pose: SpatialPose, aimed: Floats) -> _Rays:
        beams = sort_beams(unit_vectors(aimed.reshape(-1)))
        hits = cast_rays(scene, pose, beams, self.range_max, skins=self.skins, normals=False)
        shape = (len(pose.position), *aimed.shape)
        distance, cosine, hit, part = (
            one.reshape(shape) for one in (hits.distance, hits.cos_incidence, hits.hit, hits.part)
        )
        white = np.full(shape, CLOTH)
        for code, value in REFLECTIVITY.items():
            white[hit == code] = value
        black = (hit >= 0) & (np.modf((hit + 1.0) * GOLDEN)[0] < self.black_clothes)
        white = np.where(black, BLACK, white)
        share = WEIGHTS if aimed.shape[-1] > 1 else np.ones(1)
        power = share * white * np.maximum(cosine, 0.0) / np.maximum(distance, 0.3) ** 2
        return _Rays(distance, cosine, hit, part, np.where(np.isfinite(distance), power, 0.0))

    def _detect(self, rays: _Rays) -> tuple[Floats, Floats, Floats, Ints]:
        """Return echoes ``[E, R, N]``, reported range, its power, and the ray that has most of it, each ``[E, R]``."""
        S = rays.distance.shape[-1]
        group = _group(rays.distance, self.pulse_length)
        found = np.full((S, *rays.distance.shape[:2]), np.inf)
        power, best = np.zeros(found.shape), np.zeros(found.shape, dtype=np.int64)
        least = 0.1 / self.range_10**2 if self.range_10 > 0.0 else 0.0
        for k in range(S):
            inside = group == k
            own = np.where(inside, np.maximum(rays.power, 1e-12), 0.0)
            total = own.sum(axis=-1)
            mean = (own * np.where(inside, rays.distance, 0.0)).sum(axis=-1) / np.where(total > 0.0, total, 1.0)
            there = inside.any(axis=-1) & (total >= least)
            found[k], power[k] = np.where(there, mean, np.inf), np.where(there, total, 0.0)
            best[k] = own.argmax(axis=-1)
        order = np.argsort(found, axis=0, kind="stable")
        found, power, best = (np.take_along_axis(one, order, axis=0) for one in (found, power, best))
        count = np.isfinite(found).sum(axis=0)
        index = {"first": np.zeros_like(count), "strongest": power.argmax(axis=0), "last": np.maximum(count - 1, 0)}
        which = index[self.report][None]
        chosen, strength, ray = (np.take_along_axis(one, which, axis=0)[0] for one in (found, power, best))
        echoes = np.full((*chosen.shape, self.echoes), np.inf)
        kept = min(self.echoes, S)
        echoes[..., :kept] = np.moveaxis(found[:kept], 0, -1)
        return echoes, chosen, strength, ray

    def _false_ranges(self, shape: tuple[int, ...], rng: Randomness | None) -> Floats:
        """Return random ranges ``[E, R]`` of the beams with a false return; inf for the others."""
        if rng is None:
            raise InputError("PulsedLidar2D: false returns need a random generator: pass rng=stream(seed, ...)")
        generators = [rng] * shape[0] if isinstance(rng, np.random.Generator) else list(rng)
        draws = np.stack([one.random((2, *shape[1:])) for one in generators])
        away = self.range_min + (self.range_max - self.range_min) * draws[:, 1]
        return np.asarray(np.where(draws[:, 0] < self.false_returns, away, np.inf))


def _group(distance: Floats, length: float) -> Ints:
    """Return the number of the echo of each ray ``[E, R, S]``, -1 without a surface.

    Neighbours in the order of distance that are at most ``length`` [m] apart are one echo.
    """
    order = np.argsort(distance, axis=-1, kind="stable")
    nearest_first = np.take_along_axis(distance, order, axis=-1)
    there = np.isfinite(nearest_first)
    filled = np.where(there, nearest_first, 0.0)
    apart = np.diff(filled, axis=-1, prepend=filled[..., :1]) > length
    number = np.where(there, np.cumsum(apart, axis=-1), -1)
    group = np.empty_like(number)
    np.put_along_axis(group, order, number, axis=-1)
    return group
