"""Sensors with the effects of motion: pulsed laser scanners, and cameras with exposure and a rolling shutter."""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass, replace
from typing import Any, ClassVar, NamedTuple

import numpy as np

from crowdbot.core import InputError, Pose, Scene, SpatialPose, Walls, check_number, storable
from crowdbot.typing import Floats, Ints

from .beams import sort_beams, unit_vectors
from .lidar import Lidar2D, Scan, beam_angles
from .noise import Randomness, apply_noise, normals
from .ranging import apply_limits
from .ray_casting import cast_rays
from .ray_shapes import FLOOR, NOTHING, PROP
from .ray_shapes import WALLS as WALL
from .rgb_camera import RGBCamera, RgbImage
from .sensor import planar_pose, spatial_pose
from .view import SensorView

LONGEST = 1.0
"""Time between two measurements [s] above which the sensor counts as at rest."""


@storable
@dataclass(frozen=True)
class SweepState:
    """Time [s] and pose of the last measurement, in E environments."""

    time: float | Floats
    pose: Pose | SpatialPose


def sensor_motion(state: SweepState | None, time: float | Floats, pose: Pose | SpatialPose) -> tuple[Floats, Floats]:
    """Return velocity ``[E, 2]`` [m/s] and turn rate ``[E]`` [rad/s] of a sensor since its last measurement.

    Args:
        state: last measurement; None before the first, which is taken at rest.
        time: time of the measurement [s].
        pose: pose at this time.
    """
    now = planar_pose(pose)
    if state is None:
        return np.zeros_like(now.position), np.zeros_like(now.heading)
    before = planar_pose(state.pose)
    passed = np.broadcast_to(np.asarray(time) - np.asarray(state.time), now.heading.shape)
    moving = (passed > 0.0) & (passed <= LONGEST)
    rate = np.where(moving, 1.0 / np.where(moving, passed, 1.0), 0.0)
    turn = np.angle(np.exp(1j * (now.heading - before.heading)))
    return np.asarray((now.position - before.position) * rate[:, None]), np.asarray(turn * rate)


def move_scene(scene: Scene, ahead: float) -> Scene:
    """Return the scene with agents and their bodies moved by their velocities over ``ahead`` [s].

    >>> move_scene(Scene.of([[1.0, 0.0]], [[2.0, 0.0]]), -0.5).position.tolist()
    [[[0.0, 0.0]]]
    """
    if ahead == 0.0:
        return scene
    shift = np.where(scene.active[..., None], ahead * scene.velocity, 0.0)
    moved = scene.replace(position=scene.position + shift)
    bodies = scene.bodies
    if bodies is None:
        return moved
    changes: dict[str, Any] = {}
    for names, owner in ((("start", "end"), "owner"), (("box_centre",), "box_owner"), (("post_foot",), "post_owner")):
        who = getattr(bodies, owner)
        own = np.where((who >= 0)[None, :, None], shift[:, np.maximum(who, 0)], 0.0)
        for name in names:
            place = getattr(bodies, name)
            if place.shape[1]:
                changes[name] = place + np.concatenate([own, np.zeros((*own.shape[:2], 1))], axis=-1)
    return moved.replace(bodies=dataclasses.replace(bodies, **changes))


BANDS = 8
"""Number of bands of rows of a rolling shutter."""
MOST = 16
"""Largest number of images of an exposure."""


@dataclass(frozen=True, kw_only=True)
class ExposedCamera(RGBCamera):
    """A colour camera with the effects of a real one; each is off by default.

    The image is the mean of images during the exposure, band of rows by band with a rolling shutter; the last row ends
    at the time of the reading. Without a renderer, people and the camera move meanwhile; with a renderer only the
    camera does, since it draws one instant. Noise is added to the mean.

    Fields:
        width, height, field_of_view, distortion, near, far, segmentation, labels, renderer, shadows, antialiasing: as
            of :class:`RGBCamera`.
        exposure: exposure time [s]: motion blur.
        blur_images: number of images of an exposure.
        readout: time from the first to the last row [s]: rolling shutter.
        full_well: electrons of the brightest value; the noise of light is the root of the number of electrons. 0 for
            none.
        read_noise: standard deviation of the noise of the electronics, in values from 0 to 255.

    Raises:
        InputError: a value is not allowed.

    >>> from crowdbot.core import Scene
    >>> camera = ExposedCamera(width=40, height=30, exposure=0.05)
    >>> image = camera.read(Scene.of([[3.0, 0.0]], [[0.0, 1.5]]), SpatialPose.of((0.0, 0.0, 1.0)))
    >>> image.rgb.shape
    (1, 30, 40, 3)
    """

    batched = True

    exposure: float = 0.0
    blur_images: int = 4
    readout: float = 0.0
    full_well: float = 0.0
    read_noise: float = 0.0

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("exposure", "readout"):
            check_number("ExposedCamera", name, getattr(self, name), "s", min=0.0, max=1.0)
        check_number("ExposedCamera", "blur_images", self.blur_images, min=2, max=MOST, whole=True)
        for name in ("full_well", "read_noise"):
            check_number("ExposedCamera", name, getattr(self, name), min=0.0)

    def measure(self, view: SensorView, state: Any, rng: Randomness | None = None) -> tuple[RgbImage, Any]:
        """Return the image; with an exposure or a readout, the state is the pose of the camera.

        Raises:
            InputError: the pose does not fit the scene, or noise lacks a generator.
        """
        self.check(view)
        motion = sensor_motion(state, view.time, view.pose)
        bands = min(BANDS, self.height) if self.readout > 0.0 else 1
        count = self.blur_images if self.exposure > 0.0 else 1
        last: RgbImage | None = None
        total = np.zeros((view.environments, self.height, self.width, 3))
        for band, rows in enumerate(np.array_split(np.arange(self.height), bands)):
            end = -self.readout * (1.0 - (band + 1) / bands)
            for k in range(count):
                ahead = end - self.exposure * (1.0 - (k + 1) / count)
                last = self._image(view, motion, ahead)
                total[:, rows] += last.rgb[:, rows] / count
        assert last is not None
        values = apply_noise(self._with_noise(total, rng), self.noises, rng)
        values = np.where(np.isfinite(values), values, 0.0)
        rgb = np.round(np.clip(values, 0.0, 255.0)).astype(np.uint8)
        moving = self.exposure > 0.0 or self.readout > 0.0
        after = SweepState(view.time, view.pose) if moving else None
        return replace(last, time=view.time, pose=view.pose, rgb=rgb), after

    @property
    def _plain(self) -> RGBCamera:
        """The camera without noise and effects."""
        names = (
            "width", "height", "field_of_view", "distortion", "near", "far", "segmentation", "labels", "renderer",
            "shadows", "antialiasing",
        )  # fmt: skip
        return RGBCamera(**{name: getattr(self, name) for name in names})

    def _image(self, view: SensorView, motion: tuple[Floats, Floats], ahead: float) -> RgbImage:
        """Return the image some time after the view, without the noise of this class."""
        pose = spatial_pose(view.pose)
        if ahead != 0.0:
            velocity, turn = motion
            here = planar_pose(pose)
            flat = Pose(here.position + ahead * velocity, here.heading)
            place = np.concatenate([flat.position, pose.position[:, 2:]], axis=1)
            pose = _turn(SpatialPose(place, pose.rotation), ahead * turn)
        scene = move_scene(view.scene, ahead)
        return self._plain.measure(SensorView(scene, pose, view.renderer), None)[0]

    def _with_noise(self, values: Floats, rng: Randomness | None) -> Floats:
        if self.full_well == 0.0 and self.read_noise == 0.0:
            return values
        if rng is None:
            raise InputError("ExposedCamera: noise needs a random generator: pass rng=stream(seed, ...)")
        light = 255.0 * values / self.full_well if self.full_well > 0.0 else np.zeros_like(values)
        return np.asarray(values + np.sqrt(light + self.read_noise**2) * normals(values.shape, rng))


def _turn(pose: SpatialPose, angle: Floats) -> SpatialPose:
    """Return the pose turned about the vertical by ``angle`` ``[E]`` [rad]."""
    cos, sin = np.cos(0.5 * angle)[:, None], np.sin(0.5 * angle)[:, None]
    w, x, y, z = (pose.rotation[:, k : k + 1] for k in range(4))
    rotation = np.concatenate([cos * w - sin * z, cos * x - sin * y, cos * y + sin * x, cos * z + sin * w], axis=1)
    return SpatialPose(pose.position, rotation)


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

    batched = True

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
        return _Rays(*(np.concatenate(list(item)) for item in zip(*rows, strict=True)))

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
        found: list[Any] = [np.where(passes, two, ray) for ray, two in zip(rays, behind, strict=True)]
        power = np.where(glass & ~passes, rays.power * GLASS / REFLECTIVITY[WALL], found[-1])
        return _Rays(found[0], found[1], found[2], found[3], power)

    def _rays(self, scene: Scene, pose: SpatialPose, aimed: Floats) -> _Rays:
        beams = sort_beams(unit_vectors(aimed.reshape(-1)))
        hits = cast_rays(scene, pose, beams, self.range_max, skins=self.skins, normals=False)
        shape = (len(pose.position), *aimed.shape)
        distance, cosine, hit, part = (
            item.reshape(shape) for item in (hits.distance, hits.cos_incidence, hits.hit, hits.part)
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
        draws = np.stack([generator.random((2, *shape[1:])) for generator in generators])
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
