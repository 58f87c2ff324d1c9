"""Visual model of a world: shapes and skins, rendered by MuJoCo."""

from __future__ import annotations

import weakref
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import format_xml
from crowdbot.humans import People, region_colors, shapes
from crowdbot.typing import Floats
from crowdbot.world.building import BuildingPart
from crowdbot.world.physics.engine import engine
from crowdbot.world.physics.mjcf_model import MjcfModel
from crowdbot.world.physics.people_motion import PeopleMotion
from crowdbot.world.physics.stage import PhysicsStage

from .camera import LARGEST, NOTHING, WALL, CameraImages, CameraView, geom_code
from .gl_context import close_gl_context, create_gl_context, use_gl_context

SHAPES_MOST = 20_000
HIDDEN = 5
"""Group of shapes that are not drawn."""
SHADED = 10.0
"""Largest distance [m] along the camera axis of the centre of the shadow map."""
EDGE = np.array([0.22, 0.22, 0.24, 1.0], dtype=np.float32)
"""Colour of the strips on the tops of walls."""
CEILINGS = 1
"""Group of ceilings, roofs and lintels, which pictures from above leave out."""
FEWEST = 2
"""Smallest number of triangles of a mesh of the engine."""


class Visuals:
    """Renders a world at one level of detail.

    Args:
        built: the MJCF model of the world.
        walkers: people.
        stage: stage with lights.
        detail: level of detail of the skins, 0 (finest) to 2.

    Attributes:
        model, data: model and state for rendering; the caller sets ``data`` before requesting an image.
        joints: start of each joint in ``data.qpos``, by name.
    """

    def __init__(self, built: MjcfModel, motion: PeopleMotion, stage: PhysicsStage, detail: int) -> None:
        self._mj, self.detail = engine(), detail
        self._walkers, self._sunny, self._stage = motion, not stage.lights, stage
        people = motion.people
        mesh, worn = people.mesh(detail), people.clothing_mask(detail)
        self._span = [mesh.vertex_span(own) for own in people.own_body.tolist()]
        self._faces = [mesh.faces[own] - span.start for own, span in zip(worn, self._span, strict=True)]
        self.model = self._painted(built)
        self.data = self._mj.MjData(self.model)
        self.joints = {self.model.joint(k).name: int(self.model.jnt_qposadr[k]) for k in range(self.model.njnt)}
        self._canvas = create_gl_context(*LARGEST)
        self._context = self._mj.MjrContext(self.model, self._mj.mjtFontScale.mjFONTSCALE_100)
        weakref.finalize(self, close_gl_context, self._canvas, self._context).atexit = False
        self._mj.mjr_setBuffer(self._mj.mjtFramebuffer.mjFB_OFFSCREEN, self._context)
        self._context.readDepthMap = self._mj.mjtDepthMap.mjDEPTH_ZEROFAR
        self._scene = self._mj.MjvScene(self.model, maxgeom=SHAPES_MOST)
        self._option = self._mj.MjvOption()
        self._option.geomgroup[:] = (1, 1, 1, 0, 0, 0)
        self._option.flags[self._mj.mjtVisFlag.mjVIS_STATIC] = 1

    def images(
        self, view: CameraView, active: NDArray[np.bool_], rgb: bool, depth: bool, segmentation: bool, shadows: bool
    ) -> CameraImages:
        """Return images of the current state, with the people in ``active`` ``[A]``."""
        mj = self._mj
        use_gl_context(self._canvas)
        codes = self._arranged(view, active)
        area = mj.MjrRect(0, 0, view.width, view.height)
        colors = np.empty((view.height, view.width, 3), dtype=np.uint8)
        flags = self._scene.flags
        flags[mj.mjtRndFlag.mjRND_SHADOW] = shadows
        flags[mj.mjtRndFlag.mjRND_REFLECTION] = 0
        found: list[Any] = [None, None, None]
        if rgb:
            flags[mj.mjtRndFlag.mjRND_SEGMENT] = flags[mj.mjtRndFlag.mjRND_IDCOLOR] = 0
            mj.mjr_render(area, self._scene, self._context)
            mj.mjr_readPixels(colors, None, area, self._context)
            found[0] = np.flipud(colors).copy()
        if depth or segmentation:
            flags[mj.mjtRndFlag.mjRND_SEGMENT] = flags[mj.mjtRndFlag.mjRND_IDCOLOR] = 1
            raw = np.empty((view.height, view.width), dtype=np.float32)
            mj.mjr_render(area, self._scene, self._context)
            mj.mjr_readPixels(colors, raw, area, self._context)
            number = colors.astype(np.int64) @ np.array([1, 256, 65536])
            if depth:
                found[1] = np.flipud(_metric(raw, view)).copy()
            if segmentation:
                found[2] = np.flipud(codes[np.minimum(number, len(codes) - 1)]).astype(np.int32)
        return CameraImages(*found)

    def _painted(self, built: MjcfModel) -> Any:
        """Return the model with a skin and its colours for each person."""
        mj, motion = self._mj, self._walkers
        spec = mj.MjSpec.from_string(format_xml(built.root), assets=built.files)
        skin = motion.skin(self.detail)
        for k in range(len(motion.people)):
            points, faces = skin[k, self._span[k]], self._faces[k]
            uv, corners, paint = _texture_of(motion.people, k, self.detail)
            spec.add_mesh(
                name=f"skin{k}",
                inertia=mj.mjtMeshInertia.mjMESH_INERTIA_SHELL,
                uservert=points.ravel(),
                usernormal=_normals(points, faces).ravel(),
                userface=faces.ravel().astype(np.int32),
                userfacenormal=faces.ravel().astype(np.int32),
                usertexcoord=uv.ravel(),
                userfacetexcoord=corners.astype(np.int32),
            )
            high, wide = paint.shape[:2]
            cloth = spec.add_texture(name=f"cloth{k}", type=mj.mjtTexture.mjTEXTURE_2D, width=wide, height=high)
            cloth.nchannel = 3
            cloth.data = paint.tobytes()
            material = spec.add_material(name=f"cloth{k}", specular=0.1, shininess=0.1)
            material.textures[mj.mjtTextureRole.mjTEXROLE_RGB] = f"cloth{k}"
        building = self._stage.building
        for k, part in enumerate(() if building is None else building.parts):
            add_building_part(spec, k, part)
        model = spec.compile()
        if building is not None:
            walls = [k for k in range(model.ngeom) if model.geom(k).name.startswith("wall/")]
            model.geom_group[[k for k in walls if "/building" not in model.geom(k).name]] = HIDDEN
        self._meshes = np.array([model.mesh(f"skin{k}").id for k in range(len(motion.people))], dtype=np.int64)
        boards = (model.geom_type == mj.mjtGeom.mjGEOM_BOX) & (model.geom_bodyid == 0)
        self._boards = [int(k) for k in np.flatnonzero(boards) if model.geom(k).name.startswith("wall/")]
        self._cloths = [model.material(f"cloth{k}").id for k in range(len(motion.people))]
        shown = {int(b) for b in model.geom_bodyid[model.geom_group == 2]}
        bare = (model.geom_group == 3) & ~np.isin(model.geom_bodyid, list(shown))
        model.geom_group[bare] = 2  # show the colliders of robots without visuals
        return model

    def _arranged(self, view: CameraView, active: NDArray[np.bool_]) -> NDArray[np.int64]:
        """Update all poses, and return the meaning of the numbers in a segmentation image."""
        mj, model, data, scene = self._mj, self.model, self.data, self._scene
        if self._sunny:  # the shadows of the sun are sharpest where the image centre meets the floor
            fall = -view.forward[2]
            reach = min(SHADED, view.place[2] / fall) if fall > 1e-6 else SHADED
            model.light_pos[0, :2] = (view.place + reach * view.forward)[:2]
        self._option.geomgroup[CEILINGS] = 0 if view.wall_tops else 1
        mj.mj_camlight(model, data)
        mj.mjv_updateScene(model, data, self._option, None, mj.MjvCamera(), mj.mjtCatBit.mjCAT_ALL.value, scene)
        codes = np.full(scene.ngeom + len(self._meshes) + len(self._boards) + 2, NOTHING, dtype=np.int64)
        for geom in scene.geoms[: scene.ngeom]:
            if geom.segid >= 0 and geom.objtype == mj.mjtObj.mjOBJ_GEOM:
                codes[geom.segid + 1] = geom_code(model.geom(geom.objid).name)
        for eye in scene.camera:
            eye.pos, eye.forward, eye.up = view.place, view.forward, view.up
            eye.frustum_center = 0.5 * view.near * (view.left + view.right)
            eye.frustum_width = 0.5 * view.near * (view.right - view.left)
            eye.frustum_bottom, eye.frustum_top = view.near * view.bottom, view.near * view.top
            eye.frustum_near, eye.frustum_far = view.near, view.far
            eye.orthographic = 0
        self._people(codes, view, active)
        if view.wall_tops:
            self._wall_tops(codes, view.wall_tops)
        return codes

    def _wall_tops(self, codes: NDArray[np.int64], width: float) -> None:
        """Add strips of ``width`` [m] on walls of boards."""
        mj, model, data, scene = self._mj, self.model, self.data, self._scene
        for k in self._boards[: scene.maxgeom - scene.ngeom]:
            half, turn = model.geom_size[k], data.geom_xmat[k]
            size = half[0], max(0.5 * width, half[1]), 0.005
            place = data.geom_xpos[k] + (0.0, 0.0, half[2] + 0.005)
            geom = scene.geoms[scene.ngeom]
            mj.mjv_initGeom(geom, mj.mjtGeom.mjGEOM_BOX, np.array(size), place, turn, EDGE)
            geom.segid, geom.category = scene.ngeom, mj.mjtCatBit.mjCAT_STATIC
            scene.ngeom += 1
            codes[geom.segid + 1] = WALL

    def _people(self, codes: NDArray[np.int64], view: CameraView, active: NDArray[np.bool_]) -> None:
        """Add the skins of people who are present and not behind the camera."""
        mj, model, scene, motion = self._mj, self.model, self._scene, self._walkers
        here = active[motion.agents]
        if not np.any(here):
            return
        skin = motion.skin(self.detail)
        for k in np.flatnonzero(here):
            points = skin[k, self._span[k]]
            ahead = (points - view.place) @ view.forward
            if ahead.max() < 0.0 or ahead.min() > view.far:
                continue
            mesh = int(self._meshes[k])
            first, count = int(model.mesh_vertadr[mesh]), int(model.mesh_vertnum[mesh])
            model.mesh_vert[first : first + count] = points
            bent = int(model.mesh_normaladr[mesh])
            model.mesh_normal[bent : bent + count] = _normals(points, self._faces[k])
            mj.mjr_uploadMesh(model, self._context, mesh)
            geom = scene.geoms[scene.ngeom]
            mj.mjv_initGeom(
                geom, mj.mjtGeom.mjGEOM_MESH, np.zeros(3), np.zeros(3), np.eye(3).ravel(), np.ones(4, np.float32)
            )
            geom.dataid, geom.matid, geom.texcoord, geom.segid = 2 * mesh, self._cloths[k], 1, scene.ngeom
            geom.category = mj.mjtCatBit.mjCAT_DYNAMIC
            scene.ngeom += 1
            codes[geom.segid + 1] = int(motion.agents[k])


def _texture_of(people: People, row: int, detail: int) -> tuple[Floats, NDArray[np.int64], NDArray[np.uint8]]:
    """Return texture coordinates ``[N, 2]``, their rows for all corners, and the picture of a person.

    The picture of an included body has one pixel for each region.
    """
    own, mesh = int(people.own_body[row]), people.mesh(detail)
    if own >= 0:
        uv = people.own[own].levels[detail].uv.reshape(-1, 2)
        return uv * (1.0, -1.0) + (0.0, 1.0), np.arange(len(uv)), np.ascontiguousarray(people.own[own].picture[::-1])
    names = shapes().regions
    around = np.stack([(np.arange(len(names)) + 0.5) / len(names), np.full(len(names), 0.5)], axis=1)
    worn = people.clothing_mask(detail)[row, mesh.face_span(-1)]
    colors = (255.0 * np.clip(region_colors(people.outfits[row]), 0.0, 1.0)).astype(np.uint8)
    return around, np.repeat(mesh.included.face_region[worn], 3), colors[None]


def _metric(raw: NDArray[np.float32], view: CameraView) -> NDArray[np.float32]:
    """Return distances along the axis [m] from a reversed depth buffer (0 is far)."""
    near, far = view.near, view.far
    value = raw.astype(np.float64)
    with np.errstate(divide="ignore"):
        found = near * far / (near + value * (far - near))
    return np.where(value <= 0.0, np.inf, found).astype(np.float32)


def _normals(points: Floats, faces: NDArray[np.int64]) -> Floats:
    """Return unit normals ``[V, 3]`` of vertices; up for vertices without faces."""
    a, b, c = (points[faces[:, k]] for k in range(3))
    flat = np.cross(b - a, c - a)
    found = np.zeros_like(points)
    for k in range(3):
        for axis in range(3):
            found[:, axis] += np.bincount(faces[:, k], flat[:, axis], minlength=len(points))
    size = np.sqrt(np.sum(found * found, axis=1, keepdims=True))
    return np.where(size > 1e-12, found / np.maximum(size, 1e-12), (0.0, 0.0, 1.0))


def add_building_part(spec: Any, number: int, part: BuildingPart) -> None:
    """Add triangles of a building with their material to a model of the engine, for pictures only."""
    if len(part.corner) < FEWEST:
        return
    mj, name = engine(), f"building{number}"
    corners = part.corner if part.closed else np.concatenate([part.corner, part.corner[:, ::-1]])
    uv = part.uv if part.closed else np.concatenate([part.uv, part.uv[:, ::-1]])
    normal = np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0])
    size = np.linalg.norm(normal, axis=1, keepdims=True)
    normal = np.where(size > 1e-12, normal / np.maximum(size, 1e-12), (0.0, 0.0, 1.0))
    index = np.arange(3 * len(corners), dtype=np.int32)
    spec.add_mesh(
        name=name,
        inertia=mj.mjtMeshInertia.mjMESH_INERTIA_SHELL,
        uservert=corners.ravel(),
        usernormal=np.repeat(normal, 3, axis=0).ravel(),
        userface=index,
        userfacenormal=index,
        usertexcoord=(uv.reshape(-1, 2) * (1.0, -1.0) + (0.0, 1.0)).ravel(),
        userfacetexcoord=index,
    )
    material = spec.add_material(name=name, specular=0.05, shininess=0.1)
    if part.picture is None:
        material.rgba = (*part.color, 1.0)
    else:
        high, wide = part.picture.shape[:2]
        texture = spec.add_texture(name=name, type=mj.mjtTexture.mjTEXTURE_2D, width=wide, height=high)
        texture.nchannel = 3
        texture.data = np.ascontiguousarray(part.picture[::-1]).tobytes()
        material.textures[mj.mjtTextureRole.mjTEXROLE_RGB] = name
    kind = "floor" if part.kind == "floor" else "wall"
    spec.worldbody.add_geom(
        name=f"{kind}/{name}", type=mj.mjtGeom.mjGEOM_MESH, meshname=name, material=name, contype=0, conaffinity=0,
        group=CEILINGS if part.kind == "ceiling" else 0, mass=0.0,
    )  # fmt: skip
