"""Renderer: offscreen images of a scene with walls, props, robots and people."""

from __future__ import annotations

import math
from collections.abc import Mapping, Sequence
from typing import Any, Protocol

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, SpatialPose, did_you_mean
from crowdbot.humans import keypoint_places
from crowdbot.sensors import Lens
from crowdbot.typing import Floats
from crowdbot.world.physics.engine import engine
from crowdbot.world.physics.mjcf_model import MjcfModel, build_mjcf_model
from crowdbot.world.physics.people_motion import PeopleMotion
from crowdbot.world.physics.stage import PhysicsStage
from crowdbot.world.robots.robot import Robot

from .camera import CameraImages, CameraView, SceneCamera
from .software_visuals import SoftwareVisuals
from .visuals import Visuals

BODY = 0.20
"""Largest distance [m] of a keypoint from the surface of the body in front of it."""
CLOSEST = 0.02
"""Smallest depth [m] of a keypoint."""


class LensCamera(Protocol):
    """Camera model of :mod:`crowdbot.sensors`: a lens and clipping distances [m]."""

    @property
    def lens(self) -> Lens:
        """Intrinsics of the camera."""

    @property
    def near(self) -> float:
        """Near clipping distance [m]."""

    @property
    def far(self) -> float:
        """Far clipping distance [m]."""


class Renderer:
    """Renders a scene, E = 1: floor, walls, props, robots, and people with skins.

    In the plane, robots have the poses of the scene and their default posture, and people the poses of ``motion``. The
    renderer of a physics world shows the state of the engine: :attr:`PhysicsWorld.renderer`.

    Args:
        scene: initial scene with walls; :meth:`show` replaces it.
        robots: robots by agent index. :meth:`Robot.disc` creates a robot of given size.
        stage: wall height, props and lights.
        motion: people; None: all agents except robots, with sampled bodies. The caller advances it
            (:meth:`PeopleMotion.walk`).
        detail: level of detail of people's skins in :meth:`render`, 0 (finest) to 2.

    Raises:
        InputError: the scene has several environments, or a robot is not an agent of the scene.
        MissingExtra: mujoco is not installed.

    >>> scene = Scene.of([[0.0, 0.0], [3.0, 0.0]], external=[True, False])
    >>> renderer = Renderer(scene, {0: Robot.load("turtlebot2")})
    >>> camera = SceneCamera((0.0, 0.0, 1.0), (1.0, 0.0, 0.9), width=64, height=48, robot=0, detail=2)
    >>> images = renderer.images(camera, rgb=False, segmentation=True)
    >>> sorted(set(images.segmentation.ravel().tolist()))  # background, floor, person
    [-3, -1, 1]
    """

    def __init__(
        self,
        scene: Scene,
        robots: Mapping[int, Robot],
        stage: PhysicsStage | None = None,
        motion: PeopleMotion | None = None,
        *,
        detail: int = 1,
    ) -> None:
        _checked(scene)
        for agent in robots:
            if not 0 <= agent < scene.shape[1]:
                raise InputError(f"robots: agent {agent} is not in the scene, which has {scene.shape[1]} agents")
        stage = stage or PhysicsStage()
        if motion is None:
            motion = PeopleMotion(
                scene, np.array([a for a in range(scene.shape[1]) if a not in robots], dtype=np.int64)
            )
        self._made(build_mjcf_model(scene, stage, robots, 0, posed=True), robots, stage, motion, detail)
        self.show(scene)

    @classmethod
    def of_physics(
        cls, whole: MjcfModel, robots: Mapping[int, Robot], stage: PhysicsStage, motion: PeopleMotion, scene: Scene
    ) -> Renderer:
        """Return the renderer of a physics world."""
        renderer = cls.__new__(cls)
        renderer._made(whole, robots, stage, motion, 1)
        renderer._scene = scene
        return renderer

    def _made(
        self, whole: MjcfModel, robots: Mapping[int, Robot], stage: PhysicsStage, motion: PeopleMotion, detail: int
    ) -> None:
        self._whole, self.robots, self.stage, self.people, self.detail = whole, dict(robots), stage, motion, detail
        self._joints: Mapping[int, Mapping[str, float]] = {}
        self._coordinates: Floats | None = None
        self._doors: Sequence[float] = ()
        self._scene: Scene
        self._lifts = {agent: robot.lift for agent, robot in robots.items()}
        self._postures: dict[int, tuple[Mapping[str, float], Mapping[str, Any]]] = {}
        self._visuals: dict[str, Visuals | SoftwareVisuals] = {}

    def show(
        self,
        scene: Scene,
        joints: Mapping[int, Mapping[str, float]] | None = None,
        doors: Sequence[float] | None = None,
    ) -> None:
        """Set the scene for the following images.

        Args:
            scene: E = 1, with the agents and walls of the initial scene.
            joints: joint positions of robots by agent and name [rad, m] (default: the posture).
            doors: how far each door is open, 0 to 1 (default: closed).

        Raises:
            InputError: the scene has several environments or other agents.
        """
        _checked(scene)
        if scene.shape[1] != len(self.people.row):
            raise InputError(f"renderer: the scene has {scene.shape[1]} agents, expected {len(self.people.row)}")
        self._scene, self._joints, self._coordinates, self._doors = scene, joints or {}, None, doors or ()

    def show_engine(self, scene: Scene, coordinates: Floats) -> None:
        """Set the scene and the coordinates of the engine."""
        self._scene, self._coordinates = scene, coordinates.copy()

    def images(
        self, camera: SceneCamera, *, rgb: bool = True, depth: bool = False, segmentation: bool = False
    ) -> CameraImages:
        """Return images of a camera, without distortion.

        Raises:
            InputError: no OpenGL backend works, or the robot or link of the camera is unknown.
        """
        looks = self._arranged(camera.detail, camera.renderer)
        view = camera.on(self._carrier(camera, looks))
        kinds = rgb, depth, segmentation, camera.shadows
        if isinstance(looks, SoftwareVisuals):
            return looks.images(view, self._scene.active[0], *kinds, camera.antialiasing)
        return looks.images(view, self._scene.active[0], *kinds)

    def render(self, camera: LensCamera, pose: SpatialPose) -> Mapping[str, NDArray[Any]]:
        """Return images of a camera of :mod:`crowdbot.sensors`, without distortion; implements ``ImageSource``.

        Args:
            camera: camera model with lens and clipping distances.
            pose: E = 1; the camera looks along x, z is up in the image. The robot that carries it is visible.

        Raises:
            InputError: no OpenGL backend works, the image is too large, or there are several poses.
        """
        view = CameraView.through(camera.lens, pose, camera.near, camera.far)
        looks = self._arranged(self.detail, getattr(camera, "renderer", "opengl"))
        if isinstance(looks, SoftwareVisuals):
            labels = getattr(camera, "segmentation", True) or getattr(camera, "labels", False)
            kinds = True, labels, labels, getattr(camera, "shadows", False)
            seen = looks.images(view, self._scene.active[0], *kinds, getattr(camera, "antialiasing", 1))
            assert seen.rgb is not None
            if not labels:
                return {"rgb": seen.rgb[None]}
        else:
            seen = looks.images(view, self._scene.active[0], True, True, True, False)
        assert seen.rgb is not None
        assert seen.depth is not None
        assert seen.segmentation is not None
        who = seen.segmentation.astype(np.int64)[None]
        found: dict[str, NDArray[Any]]
        found = {"rgb": seen.rgb[None], "depth": seen.depth[None].astype(np.float64), "hit": who, "part": 0 * who - 1}
        if getattr(camera, "labels", False):
            active = self._scene.active[0]
            points = keypoint_labels(self.people, active, camera.lens, pose, found["depth"][0], who[0])
            found |= {"keypoints": points[None], "solid_boxes": box_labels(self.people, active)[None]}
        return found

    def _arranged(self, detail: int, kind: str) -> Visuals | SoftwareVisuals:
        """Return the visuals of a renderer with current poses."""
        looks = self._visuals.get(kind)
        if looks is None or looks.detail != detail:
            looks = None
            self._visuals.pop(kind, None)  # free the old context before creating a new one
            make = SoftwareVisuals if kind == "software" else Visuals
            looks = self._visuals[kind] = make(self._whole, self.people, self.stage, detail)
        model, data = looks.model, looks.data
        if self._coordinates is not None:
            data.qpos[:] = self._coordinates
        else:
            for agent, robot in self.robots.items():
                self._put(looks, agent, robot)
            for k, share in enumerate(self._doors):
                data.qpos[looks.joints[f"door{k}"]] = share * self.stage.doors[k].range
        mj = engine()
        mj.mj_kinematics(model, data)
        mj.mj_comPos(model, data)
        return looks

    def _put(self, looks: Visuals | SoftwareVisuals, agent: int, robot: Robot) -> None:
        model, data, prefix = looks.model, looks.data, self._whole.prefixes[agent]
        body = model.body_mocapid[model.body(prefix + robot.model.root).id]
        heading = float(self._scene.heading[0, agent])
        data.mocap_pos[body] = (*self._scene.position[0, agent].tolist(), self._lifts[agent])
        data.mocap_quat[body] = math.cos(0.5 * heading), 0.0, 0.0, math.sin(0.5 * heading)
        for name, place in self._positions(agent, robot).items():
            joint = looks.joints.get(prefix + name)
            if joint is not None and robot.model.joints[name].size == 1:
                data.qpos[joint] = place[0]

    def _positions(self, agent: int, robot: Robot) -> Mapping[str, Any]:
        """Return the positions of all joints of a robot; those of the latest image while its posture is the same."""
        given = {**robot.posture, **self._joints.get(agent, {})}
        known = self._postures.get(agent)
        if known is None or known[0] != given:
            known = self._postures[agent] = given, robot.model.positions(given)
        return known[1]

    def _carrier(self, camera: SceneCamera, looks: Visuals | SoftwareVisuals) -> Floats:
        carrier = np.eye(4)
        if camera.robot is None:
            return carrier
        if camera.robot not in self.robots:
            raise InputError(f"agent {camera.robot} is not a robot; robots are {sorted(self.robots) or 'none'}")
        robot = self.robots[camera.robot]
        link = camera.link or robot.model.root
        if link not in robot.model.links:
            raise InputError(f"{robot.name} has no link {link!r}{did_you_mean(link, robot.model.links)}")
        site = looks.data.site(self._whole.prefixes[camera.robot] + link)
        carrier[:3, :3], carrier[:3, 3] = site.xmat.reshape(3, 3), site.xpos
        return carrier


def _checked(scene: Scene) -> None:
    if scene.shape[0] != 1:
        raise InputError(f"renderer: the scene has {scene.shape[0]} environments; give one: scene.environments([0])")


def keypoint_labels(
    motion: PeopleMotion,
    active: NDArray[np.bool_],
    lens: Lens,
    pose: SpatialPose,
    depth: Floats,
    hit: NDArray[np.int64],
) -> Floats:
    """Return ``[A, 17, 3]`` column and row [pixels] of keypoints and 2 (visible), 1 (hidden) or 0 (not in the image).

    Args:
        motion: people.
        active: ``[A]`` which agents are present.
        lens, pose: camera, E = 1, looking along x.
        depth, hit: images without distortion ``[H, W]``.
    """
    result = np.zeros((len(active), 17, 3))
    places = keypoint_places(motion.people, motion.posture())
    for row, agent in enumerate(motion.agents.tolist()):
        if not active[agent]:
            continue
        ahead, left, up = ((places[row] - pose.position[0]) @ pose.matrix[0]).T
        away = np.maximum(ahead, CLOSEST)
        x, y = -left / away, -up / away
        column, line = x * lens.fx + lens.cx, y * lens.fy + lens.cy
        inside = (ahead > CLOSEST) & (np.abs(column - lens.cx) < 1e5) & (np.abs(line - lens.cy) < 1e5)
        i, j = (np.round(np.where(inside, value, -1.0)).astype(np.int64) for value in (column, line))
        inside &= (i >= 0) & (j >= 0) & (i < lens.width) & (j < lens.height)
        i, j = np.where(inside, i, 0), np.where(inside, j, 0)
        seen = inside & (hit[j, i] == agent) & (depth[j, i] > ahead - BODY)
        bent_x, bent_y = lens.distort(x, y)
        column, line = bent_x * lens.fx + lens.cx, bent_y * lens.fy + lens.cy
        inside &= (column >= -0.5) & (line >= -0.5) & (column < lens.width - 0.5) & (line < lens.height - 0.5)
        result[agent] = np.where(inside[:, None], np.stack([column, line, 1.0 + seen], axis=1), 0.0)
    return result


def box_labels(motion: PeopleMotion, active: NDArray[np.bool_]) -> Floats:
    """Return ``[A, 7]`` the box around each person: centre x, y, z [m], length, width, height [m], heading [rad].

    The box encloses skin and clothes and has the heading of the trunk; agents that are no people have NaN.
    """
    result = np.full((len(active), 7), np.nan)
    here = np.flatnonzero(active[motion.agents])
    if not len(here):
        return result
    skins = motion.skin(2, here)
    worn = motion.people.clothing_mask(2)
    for skin, row in zip(skins, here.tolist(), strict=True):
        heading = float(motion.state.yaw[row])
        cos, sin = math.cos(heading), math.sin(heading)
        turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        points = skin[np.unique(motion.people.faces(2)[worn[row]])] @ turn
        low, high = points.min(axis=0), points.max(axis=0)
        result[motion.agents[row]] = *(turn @ (0.5 * (low + high))), *(high - low), heading
    return result
