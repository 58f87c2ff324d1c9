"""Labels of people in images: keypoints and boxes in space."""

from __future__ import annotations

import math

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import SpatialPose
from crowdbot.humans import keypoint_places
from crowdbot.sensors import Lens
from crowdbot.world.physics.people_motion import PeopleMotion

__all__ = ["box_labels", "keypoint_labels"]

Floats = NDArray[np.float64]
BODY = 0.20
"""Largest distance [m] of a keypoint from the surface of the body in front of it."""
CLOSEST = 0.02
"""Smallest depth [m] of a keypoint."""


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
    found = np.zeros((len(active), 17, 3))
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
        found[agent] = np.where(inside[:, None], np.stack([column, line, 1.0 + seen], axis=1), 0.0)
    return found


def box_labels(motion: PeopleMotion, active: NDArray[np.bool_]) -> Floats:
    """Return ``[A, 7]`` the box around each person: centre x, y, z [m], length, width, height [m], heading [rad].

    The box encloses skin and clothes and has the heading of the trunk; agents that are no people have NaN.
    """
    found = np.full((len(active), 7), np.nan)
    here = np.flatnonzero(active[motion.agents])
    if not len(here):
        return found
    skins = motion.skin(2, here)
    worn = motion.people.clothing_mask(2)
    for skin, row in zip(skins, here.tolist(), strict=True):
        heading = float(motion.state.yaw[row])
        cos, sin = math.cos(heading), math.sin(heading)
        turn = np.array([[cos, -sin, 0.0], [sin, cos, 0.0], [0.0, 0.0, 1.0]])
        points = skin[np.unique(motion.people.faces(2)[worn[row]])] @ turn
        low, high = points.min(axis=0), points.max(axis=0)
        found[motion.agents[row]] = *(turn @ (0.5 * (low + high))), *(high - low), heading
    return found
