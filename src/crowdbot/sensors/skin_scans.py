"""A workload for benchmarks: the triangles of skins, tested one by one."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from crowdbot.core import Bodies, Scene, Skins, SpatialPose

from .beams import sort_beams, unit_vectors
from .lidar3d import Lidar3D
from .skin_casting import skin_casting


def triangles_one_by_one(lidar: Lidar3D, scene: Scene, pose: SpatialPose) -> Callable[[], int]:
    """Return a benchmark workload: a scan of the skins of ``scene`` without their trees; it counts the hits.

    >>> skins = Skins.of([[2.0, -9.0, 0.0], [2.0, 9.0, 0.0], [2.0, 0.0, 9.0]], [[0, 1, 2]], owner=0)
    >>> scene = Scene.of([[2.0, 0.0]], bodies=Bodies.of(skins=skins))
    >>> triangles_one_by_one(Lidar3D(columns=4), scene, SpatialPose.of((0.0, 0.0, 1.0)))()
    16
    """
    skins = (scene.bodies or Bodies.of()).skins or Skins.of(np.zeros((0, 3)), np.zeros((0, 3)), owner=())
    beams = sort_beams(unit_vectors(lidar.azimuth, np.array(lidar.elevations)[:, None]).reshape(-1, 3))
    active, place, turn = scene.active[0], pose.position[0], np.ascontiguousarray(pose.matrix[0])

    def scan() -> int:
        reach, which = np.full(len(beams.x), np.inf), np.full(len(beams.x), -1)
        casting, points = skin_casting(skins), skins.vertices[0]
        casting.cast(points, active, place, turn, lidar.range_max, beams, reach, which, each=True)
        return int(np.sum(which >= 0))

    return scan
