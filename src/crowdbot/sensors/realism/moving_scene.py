"""The scene and the sensor some time before or after an instant, at constant velocities."""

from __future__ import annotations

import dataclasses
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import Pose, Scene, SpatialPose, storable
from crowdbot.sensors.sensor import planar_pose
from crowdbot.typing import Floats

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
