"""DepthClusters: people in the images of a depth camera, as clusters of points on the ground."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from crowdbot.core import Walls, check_number
from crowdbot.sensors import DepthImage, Reading, planar_pose
from crowdbot.typing import Floats

from .cloud_clusters import CloudClusters
from .cluster_kernels import hide_walls
from .detections import Coverage, Detections


@dataclass(frozen=True, kw_only=True)
class DepthClusters(CloudClusters):
    """Geometric detector of people in depth images, as :class:`CloudClusters` in point clouds.

    Fields:
        stride: rows and columns of pixels of which one is used.
        min_points: smallest number of used pixels of a person.

    >>> from crowdbot.core import Pose, Scene
    >>> from crowdbot.sensors import DepthCamera
    >>> pose = Pose.of((0.0, 0.0), 0.0).to_spatial(1.0)
    >>> found = DepthClusters().detect(DepthCamera().read(Scene.of([[3.0, 0.5]], radius=0.25), pose))
    >>> found.position.round(1).tolist()
    [[3.0, 0.5]]
    """

    reads: ClassVar[tuple[type[Reading], ...]] = (DepthImage,)
    stride: int = 2
    min_points: int = 12
    max_range: float = 8.0

    def __post_init__(self) -> None:
        super().__post_init__()
        check_number("DepthClusters", "stride", self.stride, min=1, whole=True)

    def detect(self, reading: Reading, walls: Walls | None = None) -> Detections:
        """Return the people in a depth image."""
        self.check(reading)
        assert isinstance(reading, DepthImage)
        pose = planar_pose(reading.pose)
        origin, heading = np.ascontiguousarray(pose.position[0]), float(pose.heading[0])
        image = reading.points(in_world=True)[0, :: self.stride, :: self.stride]
        ends = image.reshape(-1, 3)
        away = np.hypot(ends[:, 0] - origin[0], ends[:, 1] - origin[1])
        use = np.isfinite(away) & (away <= self.max_range) & (ends[:, 2] >= self.low) & (ends[:, 2] <= self.high)
        points = np.ascontiguousarray(ends[use])
        if walls is not None and len(walls):
            kept = np.ones(len(points), dtype=np.bool_)
            hide_walls(np.ascontiguousarray(points[:, :2]), np.ascontiguousarray(walls.segments()), self.margin, kept)
            points = points[kept]
        place, count = self._people(points, origin)
        covariance = np.tile(self.deviation**2 * np.eye(2), (len(place), 1, 1))
        view = self._view(reading, origin, heading)
        return Detections(float(np.max(reading.time)), place, covariance, count, view)

    def _view(self, reading: DepthImage, origin: Floats, heading: float) -> Coverage:
        """Return what the camera could see: in each direction, the farthest pixel of the middle rows."""
        lens, depth = reading.lens, reading.depth[0]
        half = max(1, lens.height // 8)
        middle = depth[lens.height // 2 - half : lens.height // 2 + half + 1]
        far = np.where(np.isposinf(middle), self.max_range, np.where(np.isneginf(middle), 0.0, middle)).max(axis=0)
        right = (np.arange(lens.width) - lens.cx) / lens.fx
        bearing, distance = -np.arctan(right)[::-1], (far * np.hypot(1.0, right))[::-1]
        even = np.linspace(bearing[0], bearing[-1], lens.width)
        reach = np.minimum(np.interp(even, bearing, distance), self.max_range)
        step = float(even[1] - even[0]) if len(even) > 1 else 2.0 * math.pi
        return Coverage(origin, heading + float(even[0]), step, reach)
