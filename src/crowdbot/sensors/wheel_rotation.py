"""WheelGeometry and WheelRotation: the wheels of a robot as encoders see them."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError
from crowdbot.typing import Floats

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
