"""Visuals without a graphics library: shapes of a model and skins of people, drawn by the rasteriser."""

from __future__ import annotations

import functools
import math
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import format_xml, stream
from crowdbot.humans import LEVELS, People, RiggedBody, body_uv, paint_body, shapes, worn_parts
from crowdbot.typing import Bytes, Floats, Ints
from crowdbot.world.physics.engine import engine
from crowdbot.world.physics.mjcf_model import MjcfModel
from crowdbot.world.physics.people_motion import PeopleMotion
from crowdbot.world.physics.stage import Light, PhysicsStage
from crowdbot.world.stage_appearance import Appearance

from .camera import FLOOR, WALL, CameraImages, CameraView, geom_code
from .carried_objects import carried_parts, holds
from .raster_kernels import place_shapes, vertex_normals
from .rasterizer import DrawList, Illumination, Rasterizer, TexturePool, pack_textures
from .shape_meshes import ShapeMesh, box_mesh, flat_mesh, geom_mesh

SIZE = 512
FLOOR_SIZE = 2.4
"""Width [m] of floor and that of wall that a texture covers."""
Color = tuple[float, float, float]


def periodic_noise(name: str, cells: int, octaves: int = 4, size: int = SIZE) -> Floats:
    """Return value noise ``[size, size]`` from 0 to 1 that repeats at its edges.

    Args:
        name: what it is for; each name has its own pattern.
        cells: grid cells of the first octave along a side; the next ones have twice as many, at half the strength.
        octaves: number of octaves.
        size: side [pixels].
    """
    rng, total, weight = stream(0, "surface", name), np.zeros((size, size)), 0.0
    for octave in range(octaves):
        rows = min(size, cells << octave)
        grid = rng.uniform(0.0, 1.0, (rows, rows))
        total += 0.5**octave * _interpolated(grid, size)
        weight += 0.5**octave
    return total / weight


def _interpolated(grid: Floats, size: int) -> Floats:
    """Return a periodic grid, smoothly interpolated to ``[size, size]``."""
    result = grid
    for axis in (0, 1):
        place = np.arange(size) * (grid.shape[axis] / size)
        first = np.floor(place).astype(np.int64)
        share = place - first
        share = share * share * (3.0 - 2.0 * share)
        a, b = (np.take(result, (first + k) % grid.shape[axis], axis=axis) for k in (0, 1))
        share = share[:, None] if axis == 0 else share
        result = a + share * (b - a)
    return result


def _painted(light: Floats, color: Color = (1.0, 1.0, 1.0), other: Floats | None = None) -> Bytes:
    base = light[..., None] * np.array(color) if other is None else light[..., None] * other
    return np.asarray(np.clip(np.floor(255.0 * base + 0.5), 0.0, 255.0), dtype=np.uint8)


def _joints(count: int, wide: int, shift: bool = False, rows: int = 0) -> tuple[Floats, NDArray[np.int64]]:
    """Return how deep a pixel lies in the joint between tiles (0 to 1), and the number of its tile."""
    rows = rows or count
    y, x = np.mgrid[0:SIZE, 0:SIZE]
    row = y * rows // SIZE
    x = (x + (row % 2) * (SIZE // count // 2)) % SIZE if shift else x
    column = x * count // SIZE
    inside_x, inside_y = x - column * SIZE // count, y - row * SIZE // rows
    near = np.minimum(np.minimum(inside_x, SIZE // count - 1 - inside_x), np.minimum(
        inside_y, SIZE // rows - 1 - inside_y))  # fmt: skip
    return np.clip(1.0 - near / wide, 0.0, 1.0), row * count + column


@functools.cache
def floor_texture(kind: str) -> Bytes:
    """Return the texture of a floor; it covers :data:`FLOOR_SIZE` and is multiplied with the colour of the floor."""
    fine, coarse = periodic_noise("fine", 64, 3), periodic_noise("coarse", 4, 5)
    if kind == "checker":
        y, x = np.mgrid[0:SIZE, 0:SIZE]
        return _painted(np.where((x < SIZE // 2) == (y < SIZE // 2), 1.0, 0.93))
    if kind == "tiles":
        deep, tile = _joints(4, 3)
        tone = stream(0, "surface", "tiles").uniform(0.94, 1.0, 16)[tile]
        return _painted((tone * (0.95 + 0.05 * fine) + 0.03 * (coarse - 0.5)) * (1.0 - 0.35 * deep))
    if kind == "paving":
        deep, stone = _joints(8, 4, shift=True)
        tone = stream(0, "surface", "paving").uniform(0.62, 0.92, 64)[stone]
        return _painted(tone * (0.8 + 0.3 * fine) * (1.0 - 0.55 * deep), (1.0, 0.96, 0.9))
    if kind == "wood":
        deep, board = _joints(2, 2, shift=True, rows=16)
        tone = stream(0, "surface", "wood").uniform(0.72, 1.0, 64)[board]
        streak = _interpolated(stream(0, "surface", "fibre").uniform(0, 1, (256, 8)), SIZE)
        return _painted(tone * (0.78 + 0.22 * streak) * (1.0 - 0.5 * deep), (0.95, 0.70, 0.46))
    if kind == "grass":
        blade = periodic_noise("blade", 128, 2)
        green = np.stack([0.36 + 0.22 * coarse, 0.52 + 0.12 * coarse, 0.20 + 0.08 * coarse], axis=-1)
        return _painted(0.55 + 0.6 * blade, other=green)
    if kind == "carpet":
        return _painted(0.75 + 0.25 * periodic_noise("loops", 256, 1), (0.62, 0.68, 0.82))
    if kind == "asphalt":
        return _painted(0.42 + 0.22 * periodic_noise("gravel", 128, 2) + 0.10 * (coarse - 0.5), (1.0, 1.0, 1.02))
    if kind == "concrete":
        return _painted(0.78 + 0.14 * (coarse - 0.5) + 0.08 * (fine - 0.5))
    return _painted(np.ones((SIZE, SIZE)))


@functools.cache
def wall_texture(kind: str) -> Bytes:
    """Return the texture of a wall; it covers :data:`FLOOR_SIZE` and is multiplied with the colour of the wall."""
    fine, coarse = periodic_noise("wall", 64, 3), periodic_noise("stain", 4, 4)
    if kind == "plaster":
        return _painted(0.94 + 0.06 * (fine - 0.5) + 0.06 * (coarse - 0.5))
    if kind == "brick":
        deep, stone = _joints(10, 3, shift=True, rows=32)
        tone = stream(0, "surface", "brick").uniform(0.65, 1.0, 320)[stone]
        red = np.stack([tone * 0.78, tone * 0.40, tone * 0.31], axis=-1)
        mortar = np.array([0.74, 0.71, 0.66])
        return _painted(0.85 + 0.25 * (fine - 0.5), other=red + (deep > 0.3)[..., None] * (mortar - red))
    if kind == "concrete":
        deep, _ = _joints(2, 2)
        return _painted((0.74 + 0.14 * (coarse - 0.5) + 0.06 * (fine - 0.5)) * (1.0 - 0.3 * deep))
    if kind == "panels":
        deep, board = _joints(4, 3, rows=1)
        streak = _interpolated(stream(0, "surface", "panel").uniform(0, 1, (8, 256)), SIZE)
        tone = stream(0, "surface", "panels").uniform(0.85, 1.0, 4)[board]
        return _painted(tone * (0.80 + 0.20 * streak) * (1.0 - 0.6 * deep), (0.80, 0.58, 0.38))
    return _painted(np.ones((SIZE, SIZE)))


@functools.cache
def grain() -> Bytes:
    """Return the texture of props and doors."""
    streak = _interpolated(stream(0, "surface", "grain").uniform(0, 1, (96, 6)), SIZE)
    return _painted(0.86 + 0.14 * streak + 0.06 * (periodic_noise("pores", 128, 2) - 0.5))


@functools.cache
def clouds() -> Bytes:
    """Return the texture of clouds."""
    return _painted(periodic_noise("clouds", 5, 6))


PICTURES = (512, 256, 128)
"""Side [pixels] of the picture of a person, by level of detail."""
EDGE = (0.22, 0.22, 0.24)
WALLS, GRAIN, FLOOR_TEXTURE = 2, 3, 1
STEP = float(1 << 20)
"""Positions are multiples of 2^-20 m, so that the last digits of a sine do not matter."""
SMALL = (240.0, 110.0)
"""Heights [pixels] of a person below which level 1 and level 2 is fine enough."""
FACE_SOFT = 0.25
"""Softness of the light on skin and cloth."""
GRID = 1e-9
"""Step of directions: libraries differ in the last digit of a sine."""
SKIES = {
    "clear": ((1.05, 0.97, 0.84), (0.36, 0.42, 0.52), (0.62, 0.74, 0.88), (0.16, 0.36, 0.72), (0.35, 0.30, 0.20),
              (0.9, 0.56, 3.4), (1.0, 1.0, 1.0), 0.0),
    "cloudy": ((0.80, 0.77, 0.72), (0.46, 0.50, 0.56), (0.70, 0.77, 0.85), (0.28, 0.45, 0.70), (0.20, 0.18, 0.14),
               (1.0, 0.40, 3.0), (0.93, 0.94, 0.96), 0.04),
    "overcast": ((0.38, 0.38, 0.38), (0.62, 0.64, 0.67), (0.76, 0.78, 0.80), (0.58, 0.61, 0.65), (0.0, 0.0, 0.0),
                 (0.8, 0.30, 1.6), (0.72, 0.74, 0.77), 0.30),
    "dusk": ((0.85, 0.52, 0.28), (0.26, 0.26, 0.36), (0.90, 0.56, 0.36), (0.13, 0.17, 0.34), (0.55, 0.30, 0.12),
             (0.8, 0.45, 3.0), (0.62, 0.38, 0.36), 0.02),
}  # fmt: skip
"""Colour of the light, light from above, horizon, zenith, glow, clouds (share, lower limit, slope), their colour, and
the radius [m] of the edge of shadows."""


class _FixedRows(NamedTuple):
    """Faces, texture coordinates, materials, closed and codes of all triangles, and the number of vertices."""

    faces: Ints
    uv: Floats
    material: Ints
    closed: NDArray[np.bool_]
    code: Ints
    points: int


class _Skin(NamedTuple):
    """Triangles that a person wears, and the vertices of the group to which they belong."""

    span: slice

    faces: Ints
    uv: Floats
    material: Ints
    closed: NDArray[np.bool_]


class _Part(NamedTuple):
    """A shape at its place, with its paint and its label."""

    mesh: ShapeMesh
    turn: Floats
    place: Floats
    paint: int
    code: int


class SoftwareVisuals:
    """Renders a world at one level of detail, with textures, shadows and antialiasing.

    Args:
        built: the MJCF model of the world.
        motion: people.
        stage: stage with lights and surfaces.
        detail: finest level of detail of the skins, 0 to 2; small people in an image have coarser ones.

    Attributes:
        model, data: model and state for rendering; the caller sets ``data`` before requesting an image.
        joints: start of each joint in ``data.qpos``, by name.
    """

    def __init__(self, built: MjcfModel, motion: PeopleMotion, stage: PhysicsStage, detail: int) -> None:
        mj = engine()
        self.detail, self._motion, self._stage = detail, motion, stage
        self.model = mj.MjModel.from_xml_string(format_xml(built.root), built.files)
        self.data = mj.MjData(self.model)
        self.joints = {self.model.joint(k).name: int(self.model.jnt_qposadr[k]) for k in range(self.model.njnt)}
        self._raster = Rasterizer()
        looks = stage.appearance.draw(stream(motion.gait.seed, "appearance"))
        self._light = illumination(looks, stage.lights)
        self._images = [clouds(), floor_texture(looks.floor), wall_texture(looks.walls), grain()]
        self._paints: list[tuple[float, ...]] = []
        self._present: Any = None
        self._fixed: _FixedRows | None = None
        self._static_shapes()
        self._people_looks()
        self._building = self._building_parts()
        self._pool: TexturePool = pack_textures(self._images)
        floor = _linear(stage.floor_color)
        self._ground = np.array([*(floor / _linear((0.80, 0.80, 0.78))), 1.0 / FLOOR_SIZE])
        self._ground[:3] *= 0.72

    def images(
        self, view: CameraView, active: NDArray[np.bool_], rgb: bool, depth: bool, segmentation: bool, shadows: bool,
        samples: int = 1,
    ) -> CameraImages:  # fmt: skip
        """Return images of the current state, with the people in ``active`` ``[A]``."""
        drawn = self._drawn(view, active)
        view = view._replace(place=_on_grid(view.place), forward=_on_grid(view.forward), up=_on_grid(view.up))
        color, far, who = None, None, None
        if rgb:
            color = self._raster.image(drawn, view, self._light, self._pool, self._ground, samples, shadows)
        if depth or segmentation:
            far, who = self._raster.labels(drawn, view, FLOOR)
        return CameraImages(color, far if depth else None, who if segmentation else None)

    def _paint(self, color: Any, texture: int = -1, gloss: float = 0.0, soft: float = 0.0) -> int:
        row = (*_linear(color), float(texture), gloss, soft)
        if row not in self._paints:
            self._paints.append(row)
        return self._paints.index(row)

    def _static_shapes(self) -> None:
        """Make the triangles of all shapes of the model, in the frames of their shapes."""
        model = self.model
        shown = {int(b) for b in model.geom_bodyid[model.geom_group == 2]}
        geoms, counts, meshes, materials, codes, uvs = [], [0], [], [], [], []
        for geom in range(model.ngeom):
            group, body = int(model.geom_group[geom]), int(model.geom_bodyid[geom])
            bare = group == 3 and body not in shown
            mesh = geom_mesh(model, geom) if group <= 2 or bare else None
            name = model.geom(geom).name
            hidden = self._stage.building is not None and name.startswith("wall/")
            if mesh is None or not len(mesh.corner) or name == "floor" or hidden:
                continue
            if name.startswith(("wall/", "ground/")):
                mesh = flat_mesh(mesh)
            count = len(mesh.corner)
            material, uv = self._material(geom, name, mesh)
            geoms.append(geom)
            counts.append(count)
            meshes.append(mesh)
            materials.append(np.full(count, material))
            codes.append(np.full(count, geom_code(name)))
            uvs.append(uv)
        none = np.zeros((0, 3, 3))
        self._geoms, self._starts = np.array(geoms, dtype=np.int64), np.cumsum(counts)
        self._static_count = int(self._starts[-1])
        self._corner = np.concatenate([none, *(mesh.corner for mesh in meshes)]).reshape(-1, 3)
        self._slope = np.concatenate([none, *(mesh.normal for mesh in meshes)]).reshape(-1, 3)
        self._uv = np.concatenate([*uvs, none[..., :2]])
        self._material_rows = np.concatenate([*materials, np.zeros(0)]).astype(np.int64)
        self._codes = np.concatenate([*codes, np.zeros(0)]).astype(np.int64)
        self._closed = np.repeat(np.array([mesh.closed for mesh in meshes], dtype=np.bool_), counts[1:])

    def _material(self, geom: int, name: str, mesh: ShapeMesh) -> tuple[int, Floats]:
        """Return the paint of a shape and its texture coordinates."""
        model = self.model
        if name.startswith("wall/"):
            return self._paint(self._stage.wall_color, WALLS), mesh.uv / FLOOR_SIZE
        color = model.geom_rgba[geom][:3]
        if name.startswith("ground/"):
            return self._paint(color, FLOOR_TEXTURE), mesh.uv / FLOOR_SIZE
        if not name.startswith("robot"):
            return self._paint(color, GRAIN, 0.05), mesh.uv / 1.2
        material = int(model.geom_matid[geom])
        if material >= 0:
            color = model.mat_rgba[material][:3]
            texture = int(model.mat_texid[material, engine().mjtTextureRole.mjTEXROLE_RGB])
            if texture >= 0:
                self._images.append(_stored_texture(model, texture))
                return self._paint(color, len(self._images) - 1, 0.15), mesh.uv * (1.0, -1.0) + (0.0, 1.0)
        return self._paint(color, -1, 0.25), mesh.uv

    def _people_looks(self) -> None:
        """Paint all people, and select the triangles that they wear at each level of detail."""
        people, wet = self._motion.people, list[int]()
        paints, own_paints = list[int](), [self._own_picture(body) for body in people.own]
        for k, (person, outfit) in enumerate(zip(people.persons, people.outfits, strict=True)):
            own = int(people.own_body[k])
            if own < 0:
                self._images.append(paint_body(person, outfit, int(people.variation[k]), PICTURES[self.detail]))
                paints.append(self._paint((1.0, 1.0, 1.0), len(self._images) - 1, 0.02, FACE_SOFT))
                wet.append(self._paint((1.0, 1.0, 1.0), len(self._images) - 1, 0.4, FACE_SOFT))
            else:
                paints.append(own_paints[own])
                wet.append(own_paints[own])
        self._skins = {
            level: [_skin_of(people, k, level, paints[k], wet[k]) for k in range(len(people))]
            for level in range(self.detail, LEVELS)
        }

    def _building_parts(self) -> tuple[list[_Part], list[_Part]]:
        """Return the triangles of a building below ceilings, and its ceilings and roofs."""
        building_parts: tuple[list[_Part], list[_Part]] = [], []
        for part in () if self._stage.building is None else self._stage.building.parts:
            color: tuple[float, ...] = part.color
            texture = -1
            if part.picture is not None:
                self._images.append(part.picture)
                color, texture = (1.0, 1.0, 1.0), len(self._images) - 1
            mesh = flat_mesh(ShapeMesh(part.corner, part.corner, part.uv, part.closed))._replace(
                uv=part.uv, closed=part.closed
            )
            code = FLOOR if part.kind == "floor" else WALL
            own = _Part(mesh, np.eye(3), np.zeros(3), self._paint(color, texture), code)
            building_parts[part.kind == "ceiling"].append(own)
        return building_parts

    def _own_picture(self, body: RiggedBody) -> int:
        """Add the picture of an imported body, and return its paint."""
        picture = body.picture
        for _ in range(self.detail):
            wide = picture.astype(np.uint16)
            total = wide[::2, ::2] + wide[1::2, ::2] + wide[::2, 1::2] + wide[1::2, 1::2]
            picture = ((total + 2) // 4).astype(np.uint8)
        self._images.append(picture)
        return self._paint((1.0, 1.0, 1.0), len(self._images) - 1, 0.02, FACE_SOFT)

    def _drawn(self, view: CameraView, active: NDArray[np.bool_]) -> DrawList:
        """Return all triangles at their current places."""
        here = tuple(np.flatnonzero(active[self._motion.agents]).tolist())
        levels = self._levels(view, np.array(here, dtype=np.int64))
        parts = self._building[0] + ([] if view.wall_tops else self._building[1]) + self._carried(here)
        parts += self._wall_tops(view.wall_tops) if view.wall_tops else []
        key = here, tuple(levels.tolist()), tuple((part.paint, part.code, len(part.mesh.corner)) for part in parts)
        if self._fixed is None or key != self._present:
            self._present, self._fixed = key, self._fixed_rows(here, levels, parts)
        fixed = self._fixed
        vertex, normal = np.empty((fixed.points, 3)), np.empty((fixed.points, 3))
        self._place_shapes(vertex, normal)
        first = 3 * self._static_count
        posture = self._motion.posture() if here else None
        for level in np.unique(levels).tolist():
            assert posture is not None
            rows = np.array(here, dtype=np.int64)[levels == level]
            skins = _on_grid(self._motion.people.skin(posture, level, rows))
            for row, k in enumerate(rows.tolist()):
                skin = self._skins[level][k]
                own = skins[row, skin.span]
                last = first + len(own)
                vertex_normals(own, skin.faces, normal[first:last])
                vertex[first:last] = own
                first = last
        begin = first
        for part in parts:
            last = first + 3 * len(part.mesh.corner)
            np.matmul(part.mesh.corner.reshape(-1, 3), part.turn.T, out=vertex[first:last])
            vertex[first:last] += part.place
            np.matmul(part.mesh.normal.reshape(-1, 3), part.turn.T, out=normal[first:last])
            first = last
        vertex[begin:], normal[begin:] = _on_grid(vertex[begin:]), _on_grid(normal[begin:])
        return DrawList(vertex, normal, *fixed[:5], np.array(self._paints).reshape(-1, 6))

    def _levels(self, view: CameraView, rows: Ints) -> Ints:
        """Return the level of detail of people, by their height in the image."""
        motion = self._motion
        away = np.sqrt(np.sum((motion.state.position[rows] - view.place[:2]) ** 2, axis=1))
        tall = motion.people.height[rows] * view.height / (view.top - view.bottom) / np.maximum(away, 0.1)
        return np.asarray(np.maximum(self.detail, np.select([tall > SMALL[0], tall > SMALL[1]], [0, 1], 2)))

    def _carried(self, here: tuple[int, ...]) -> list[_Part]:
        """Return what people hold, push and wear."""
        motion, found = self._motion, []
        holders = [k for k in here if holds(motion.people, motion.state.blend, k)]
        posture = motion.posture() if holders else None
        for k in holders:
            assert posture is not None
            for part in carried_parts(
                motion.people, posture, motion.state.yaw, motion.state.blend, k, k < len(motion.afoot)
            ):
                paint = self._paint(part.color, -1, 0.08)
                found.append(_Part(part.mesh, part.turn, part.place, paint, int(motion.agents[k])))
        return found

    def _fixed_rows(self, here: tuple[int, ...], levels: Ints, parts: list[_Part]) -> _FixedRows:
        """Return what does not change while the same people are there with the same things."""
        points = 3 * self._static_count
        rows = [(np.arange(points).reshape(-1, 3), self._uv, self._material_rows, self._closed, self._codes)]
        for n in np.argsort(levels, kind="stable").tolist():
            k, skin = here[n], self._skins[int(levels[n])][here[n]]
            code = np.full(len(skin.faces), int(self._motion.agents[k]))
            rows.append((skin.faces + points, skin.uv, skin.material, skin.closed, code))
            points += skin.span.stop - skin.span.start
        for part in parts:
            count = len(part.mesh.corner)
            faces = points + np.arange(3 * count).reshape(-1, 3)
            closed = np.full(count, part.mesh.closed)
            rows.append((faces, part.mesh.uv, np.full(count, part.paint), closed, np.full(count, part.code)))
            points += 3 * count
        faces, uv, material, closed, code = (np.concatenate(columns) for columns in zip(*rows, strict=True))
        return _FixedRows(faces, uv, material, closed, code, points)

    def _place_shapes(self, vertex: Floats, normal: Floats) -> None:
        geoms = self._geoms
        turn = _on_grid(self.data.geom_xmat[geoms]).reshape(-1, 3, 3)
        place_shapes(
            self._corner, self._slope, self._starts, turn, _on_grid(self.data.geom_xpos[geoms]), vertex, normal
        )

    def _wall_tops(self, width: float) -> list[_Part]:
        """Return strips of ``width`` [m] on walls of boards, so that thin walls show from above."""
        paint, found = self._paint(EDGE), []
        for geom in self._geoms.tolist():
            board = self.model.geom_type[geom] == engine().mjtGeom.mjGEOM_BOX
            if board and self.model.geom(geom).name.startswith("wall/"):
                half = self.model.geom_size[geom]
                strip = box_mesh(np.array([half[0], max(0.5 * width, half[1]), 0.005]))
                place = self.data.geom_xpos[geom] + (0.0, 0.0, half[2] + 0.005)
                found.append(_Part(strip, self.data.geom_xmat[geom].reshape(3, 3), place, paint, WALL))
        return found


def _skin_of(people: People, row: int, detail: int, paint: int, wet: int) -> _Skin:
    """Return the triangles of a person at a level of detail; ``wet`` is the paint of eyes."""
    own, mesh = int(people.own_body[row]), people.mesh(detail)
    if own >= 0:
        whole = people.own[own].levels[detail]
        return _Skin(mesh.vertex_span(own), whole.faces, whole.uv, np.full(len(whole.faces), paint), whole.closed)
    level, every = mesh.included, shapes()
    worn = np.flatnonzero(np.isin(level.face_part, worn_parts(people.outfits[row])))
    hair = [every.parts.index(part) for part in ("hair_short", "hair_long", "skirt")]
    material = np.where(level.face_region[worn] == every.regions.index("eyes"), wet, paint)
    closed = ~np.isin(level.face_part[worn], hair)
    return _Skin(mesh.vertex_span(-1), level.faces[worn], body_uv(detail)[worn], material, closed)


def _on_grid(values: Floats) -> Floats:
    return np.asarray(np.rint(values * STEP) / STEP)


def _linear(color: Any) -> Floats:
    """Return the linear colour of one from 0 to 1."""
    return np.asarray(color, dtype=np.float64)[:3] ** 2


def _stored_texture(model: Any, texture: int) -> NDArray[np.uint8]:
    """Return a texture of a robot with sides that are powers of two, at most 1024."""
    from PIL import Image

    first, channels = int(model.tex_adr[texture]), int(model.tex_nchannel[texture])
    high, wide = int(model.tex_height[texture]), int(model.tex_width[texture])
    data = np.asarray(model.tex_data[first : first + high * wide * channels], dtype=np.uint8)
    image = data.reshape(high, wide, channels)[..., :3]
    image = np.repeat(image[..., :1], 3, axis=-1) if channels < 3 else image
    across, down = (1 << min(10, max(0, (side - 1).bit_length())) for side in (wide, high))
    return np.asarray(Image.fromarray(np.ascontiguousarray(image)).resize((across, down), Image.Resampling.BILINEAR))


def illumination(appearance: Appearance, lights: tuple[Light, ...]) -> Illumination:
    """Return the light of a stage: daylight, or lamps with soft shadows straight below.

    >>> illumination(Appearance(), ()).sun.shape
    (4, 3)
    """
    light, above, horizon, zenith, glow, cloud, white, soft = SKIES[appearance.sky]
    flat = math.cos(appearance.sun_elevation)
    direction = (
        flat * math.cos(appearance.sun_heading),
        flat * math.sin(appearance.sun_heading),
        -math.sin(appearance.sun_elevation),
    )
    lamps = np.zeros((0, 4))
    if lights:
        lamps = np.array([(lamp.x, lamp.y, lamp.z, 0.9 * lamp.brightness) for lamp in lights])
        light, above, direction, soft = (0.22, 0.22, 0.21), (0.30, 0.30, 0.29), (0.02, 0.03, -1.0), 0.15
    elif appearance.sky == "overcast":
        direction = (0.12, 0.16, -1.0)
    rounded = np.round(np.array(direction) / GRID) * GRID
    rounded = rounded / math.sqrt(float(np.sum(rounded * rounded)))
    ground = 0.45 * np.array(above) * (1.0, 0.96, 0.9)
    return Illumination(
        np.array([rounded, light, above, ground]),
        np.array([horizon, zenith, glow, cloud, rounded, white]),
        lamps,
        soft,
        haze=140.0,
    )
