"""Cameras of a scene and their images."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, SpatialPose
from crowdbot.sensors import Lens, check_renderer
from crowdbot.typing import Floats

LARGEST = (1920, 1200)
PointWaypoint = tuple[float, float, float]


class CameraImages(NamedTuple):
    """Images of a camera; images that were not requested are None.

    Fields:
        rgb: ``[H, W, 3]`` red, green, blue from 0 to 255.
        depth: ``[H, W]`` [m] along the camera's axis, infinite without a surface.
        segmentation: ``[H, W]`` index of the agent; -1 background, -2 wall, -3 floor, -4 prop.
    """

    rgb: NDArray[np.uint8] | None
    depth: NDArray[np.float32] | None
    segmentation: NDArray[np.int32] | None


class CameraView(NamedTuple):
    """Pose and view frustum of an ideal camera.

    Fields:
        place, forward, up: position and axes ``[3]`` in the world.
        left, right, bottom, top: edges of the image at distance 1 along the axis.
        near, far: clipping distances [m].
        width, height: size of the image [pixels].
        wall_tops: width of the dark strips drawn along the tops of walls [m]; 0: none.
    """

    place: Floats
    forward: Floats
    up: Floats
    left: float
    right: float
    bottom: float
    top: float
    near: float
    far: float
    width: int
    height: int
    wall_tops: float = 0.0

    @classmethod
    def through(cls, lens: Lens, pose: SpatialPose, near: float, far: float) -> CameraView:
        """Return the view of a lens without distortion along the x axis of a pose, E = 1; z is up in the image.

        Raises:
            InputError: the image is too large, or there are several poses.

        >>> CameraView.through(Lens.of(4, 2, math.pi / 2.0), SpatialPose.of((0.0, 0.0, 1.0)), 0.1, 9.0)[3:7]
        (-1.0, 1.0, -0.5, 0.5)
        """
        if len(pose.position) != 1:
            raise InputError(f"camera: the pose has {len(pose.position)} environments; one can be rendered at a time")
        _checked_size("camera", lens.width, lens.height)
        matrix = pose.matrix[0]
        left, right = (round(edge / lens.fx, 12) for edge in (-0.5 - lens.cx, lens.width - 0.5 - lens.cx))
        bottom, top = (round(edge / lens.fy, 12) for edge in (lens.cy + 0.5 - lens.height, lens.cy + 0.5))
        axes = pose.position[0], matrix[:, 0], matrix[:, 2]
        return cls(*axes, left, right, bottom, top, near, far, lens.width, lens.height)


@dataclass(frozen=True)
class SceneCamera:
    """A camera without distortion.

    Fields:
        position, target: position of the camera and the point it looks at [m], in the world or in the frame of a robot
            link.
        width, height: size of the image [pixels].
        view: vertical angle of view [rad].
        robot: agent that carries the camera; None: fixed in the world.
        link: link of the robot (default: its root).
        near, far: clipping distances [m].
        detail: level of detail of people's skins, 0 (finest) to 2.
        shadows: whether shadows are rendered, which is slow without a GPU.
        wall_tops: width of the dark strips drawn along the tops of walls [m], so that thin walls and the doors between
            them show from above; 0: none.
        renderer: one of :data:`crowdbot.sensors.RENDERERS`.
        antialiasing: samples per pixel, 1, 2, 4 or 8; ``opengl`` has 1.

    Raises:
        InputError: a value is not allowed, or position and target are equal.

    >>> SceneCamera((0.0, -5.0, 2.0), (0.0, 0.0, 1.0)).height
    480
    """

    position: PointWaypoint
    target: PointWaypoint
    width: int = 640
    height: int = 480
    view: float = math.radians(60.0)
    robot: int | None = None
    link: str = ""
    near: float = 0.05
    far: float = 200.0
    detail: int = 1
    shadows: bool = False
    wall_tops: float = 0.0
    renderer: str = "opengl"
    antialiasing: int = 1

    def __post_init__(self) -> None:
        _checked_size("Camera", self.width, self.height)
        if not 0.0 < self.view < math.pi:
            raise InputError(f"SceneCamera: view = {self.view} rad must be above 0 and below pi")
        if not 0.0 < self.near < self.far < math.inf:
            raise InputError(f"SceneCamera: near = {self.near} m must be above 0 and below far = {self.far} m")
        if self.detail not in (0, 1, 2):
            raise InputError(f"SceneCamera: detail = {self.detail} must be 0, 1 or 2")
        if not 0.0 <= self.wall_tops < math.inf:
            raise InputError(f"SceneCamera: wall_tops = {self.wall_tops} m must be finite and at least 0")
        check_renderer("SceneCamera", self.renderer, self.antialiasing)
        away = np.subtract(self.target, self.position)
        if away.shape != (3,) or not np.all(np.isfinite(away)) or not np.any(away):
            raise InputError(
                f"SceneCamera: position {self.position} and target {self.target} must be two different points"
            )

    def axes(self, robot_body: Floats) -> tuple[Floats, Floats, Floats]:
        """Return position, forward and up axis ``[3]`` in the world, for a robot link with the frame ``[4, 4]``."""
        place, aim = (
            robot_body[:3, :3] @ np.asarray(point) + robot_body[:3, 3] for point in (self.position, self.target)
        )
        forward = (aim - place) / np.linalg.norm(aim - place)
        up = robot_body[:3, 2] - (robot_body[:3, 2] @ forward) * forward
        if np.linalg.norm(up) < 1e-6:  # looking straight up or down: the top of the image is ahead
            up = robot_body[:3, 0] - (robot_body[:3, 0] @ forward) * forward
        return place, forward, up / np.linalg.norm(up)

    def on(self, robot_body: Floats) -> CameraView:
        """Return the view for a robot link with the frame ``[4, 4]``."""
        high = math.tan(0.5 * self.view)
        wide = high * self.width / self.height
        edges = -wide, wide, -high, high, self.near, self.far
        return CameraView(*self.axes(robot_body), *edges, self.width, self.height, self.wall_tops)


def _checked_size(what: str, width: int, height: int) -> None:
    for name, value, most in (("width", width, LARGEST[0]), ("height", height, LARGEST[1])):
        if not 1 <= value <= most:
            raise InputError(f"{what}: {name} = {value} pixels must be from 1 to {most}")


NOTHING, WALL, FLOOR, PROP = -1, -2, -3, -4


def geom_code(name: str) -> int:
    """Return the label of a shape by its name in the model of the engine: the agent of a robot, or what it is.

    >>> geom_code("robot3/base"), geom_code("wall/0"), geom_code("floor")
    (3, -2, -3)
    """
    if name.startswith("robot"):
        return int(name.removeprefix("robot").split("/")[0])
    return FLOOR if name.startswith("floor") else WALL if name.startswith("wall/") else PROP
