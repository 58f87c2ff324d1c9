"""SensorView, the input of a sensor with scene, pose and renderer, and the wheels of a robot as encoders see them."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, Pose, Scene, SpatialPose, every, tree
from crowdbot.typing import Floats

from .lens import ImageSource

MIDDLE = 1e-6
"""Distance [m] from the middle of the robot below which a wheel is neither left nor right."""


@dataclass(frozen=True, eq=False)
class WheelGeometry:
    """The driven wheels of a robot, as they are.

    Fields:
        joints: names of the joints of the axles.
        steering: joint that steers each wheel, empty without.
        position: ``[W, 2]`` centres in the frame of the robot [m].
        radius: ``[W]`` [m].
        rolling: ``[W, 3]`` rotation of each wheel [rad] for 1 m forward, 1 rad turn and 1 m to the left, without slip
            and with wheels straight ahead.
        center: position x [m] around which a base with plain wheels turns: the axle of the wheels without steering.
        sideways: whether the wheels also measure sideways motion, as omnidirectional wheels do.

    >>> geometry = WheelGeometry.differential(track=0.4, radius=0.1)
    >>> geometry.track, geometry.rolling.tolist()
    (0.4, [[10.0, -2.0, 0.0], [10.0, 2.0, 0.0]])
    """

    joints: tuple[str, ...]
    steering: tuple[str, ...]
    position: Floats
    radius: Floats
    rolling: Floats
    center: float = 0.0
    sideways: bool = False

    def __post_init__(self) -> None:
        count = len(self.joints)
        shapes = (self.position.shape, self.radius.shape, self.rolling.shape)
        if count == 0 or len(self.steering) != count or shapes != ((count, 2), (count,), (count, 3)):
            raise InputError(
                f"WheelGeometry: {count} wheels need a position, a radius and a row of rolling each, but the shapes"
                f" are {', '.join(str(list(shape)) for shape in shapes)}"
            )

    @classmethod
    def differential(cls, track: float, radius: float) -> WheelGeometry:
        """Return two wheels at a distance ``track`` [m]."""
        half = 0.5 * track
        rows = np.array([[1.0, -half, 0.0], [1.0, half, 0.0]]) / radius
        return cls(("left", "right"), ("", ""), np.array([[0.0, half], [0.0, -half]]), np.full(2, radius), rows)

    @property
    def sides(self) -> NDArray[np.int64]:
        """1 for wheels on the left, -1 on the right, 0 in the middle, ``[W]``."""
        across = self.position[:, 1]
        return np.where(np.abs(across) < MIDDLE, 0, np.sign(across)).astype(np.int64)

    @property
    def track(self) -> float:
        """Distance [m] between the wheels that are farthest left and right; 0 for one wheel."""
        return float(np.ptp(self.position[:, 1]))


@dataclass(frozen=True)
class WheelRotation:
    """The wheels of a robot at one instant, in E environments.

    Fields:
        geometry: the wheels.
        angle: ``[E, W]`` rotation of each wheel since the beginning [rad]; None: the wheels roll without slip, their
            rotation follows from the motion of the base.
        steering: ``[E, W]`` angle of each wheel to the left of straight ahead [rad]; None: all are straight ahead.
    """

    geometry: WheelGeometry
    angle: Floats | None = None
    steering: Floats | None = None
    shared_fields: ClassVar[tuple[str, ...]] = ("geometry",)

    @property
    def rolling(self) -> Floats:
        """``[E, W, 3]`` rotation for 1 m forward, 1 rad turn and 1 m to the left, at the steering angles."""
        plain, angle = self.geometry.rolling, self.steering
        if angle is None:
            return np.asarray(plain[None])
        x, y = self.geometry.position.T
        cos, sin = np.cos(angle), np.sin(angle)
        sense = np.where(plain[:, 0] < 0.0, -1.0, 1.0) / self.geometry.radius
        rows = np.stack([cos, x * sin - y * cos, sin], axis=2) * sense[None, :, None]
        steered = np.array([bool(name) for name in self.geometry.steering])
        return np.where(steered[None, :, None], rows, plain[None])

    def constraints(self) -> Floats:
        """Return ``[E, C, 3]`` combinations of forward, turn and left that plain wheels keep at 0.

        A steered wheel does not move across its direction; plain wheels without steering turn around their axle.
        """
        rows = []
        if not self.geometry.sideways:
            rows.append(np.array([[0.0, self.geometry.center, 1.0]]))
        if self.steering is not None:
            for k, name in enumerate(self.geometry.steering):
                if name:
                    x, y = self.geometry.position[k].tolist()
                    cos, sin = np.cos(self.steering[:, k]), np.sin(self.steering[:, k])
                    rows.append(np.stack([-sin, x * cos + y * sin, cos], axis=1))
        count = 1 if self.steering is None else len(self.steering)
        wide = [np.broadcast_to(row, (count, 3)) for row in rows]
        return np.stack(wide, axis=1) if wide else np.zeros((count, 0, 3))


@dataclass(frozen=True)
class SensorView:
    """The input of a sensor at one instant, in E environments.

    Fields:
        scene: the scene without the robot that carries the sensor.
        pose: pose of the sensor, one for each environment; planar or in space.
        renderer: renders camera images; None if there is none.
        wheels: wheels of the robot, for sensors with encoders; None if they are not known.

    >>> view = SensorView(Scene.of([[2.0, 0.0]], time=0.5), Pose.of((0.0, 0.0), 0.0))
    >>> view.time, view.environments
    (0.5, 1)
    """

    scene: Scene
    pose: Pose | SpatialPose
    renderer: ImageSource | None = None
    wheels: WheelRotation | None = None

    @property
    def time(self) -> float | NDArray[np.float64]:
        """Simulated time [s], a number or one for each environment ``[E]``."""
        return self.scene.time

    @property
    def environments(self) -> int:
        """Number of environments E."""
        return self.scene.shape[0]

    def select(self, index: ArrayLike) -> SensorView:
        """Return the view of the environments ``index``, in this order; each occurs at most once.

        Raises:
            InputError: an environment does not exist.
        """
        chosen = tree.environment_index(index, self.environments, "SensorView")
        pose = tree.take(self.pose, chosen)
        images = None if self.renderer is None else _Selection(self.renderer, chosen, self.environments)
        return SensorView(self.scene.environments(chosen), pose, images, tree.take(self.wheels, chosen))

    def check(self, sensor: str) -> None:
        """Raise :class:`InputError` if the pose is not finite or does not have one row for each environment."""
        pose = self.pose
        turn = pose.rotation if isinstance(pose, SpatialPose) else pose.heading
        if len(pose.position) != self.environments or len(turn) != self.environments:
            raise InputError(f"{sensor}: the pose has {len(pose.position)} rows for {self.environments} environments")
        if not (_is_finite(pose.position) and _is_finite(turn)):
            raise InputError(f"{sensor}: the pose of the sensor is not finite")
        if isinstance(self.time, np.ndarray) and self.time.shape != (self.environments,):
            raise InputError(
                f"{sensor}: the time has shape {list(self.time.shape)}, it must be a number or"
                f" [{self.environments}], one for each environment"
            )


def _is_finite(values: NDArray[np.float64]) -> bool:
    return every(np.isfinite(values))


@dataclass(frozen=True)
class _Selection:
    """Images of some environments of a renderer; it renders all, the others from the first pose."""

    renderer: ImageSource
    index: NDArray[np.int64]
    environments: int

    def render(self, camera: Any, pose: SpatialPose) -> Mapping[str, NDArray[Any]]:
        places = np.zeros(self.environments, dtype=np.int64)
        places[self.index] = np.arange(len(self.index))
        images = self.renderer.render(camera, tree.take(pose, places))
        return {name: np.asarray(image)[self.index] for name, image in images.items()}
