"""Departure of people at their goals and in exits."""

from __future__ import annotations

from crowdbot.core import Scene

from .waypoint import PolygonZone

__all__ = ["leave_at_goals", "leave_in_zone"]


def leave_at_goals(scene: Scene, radius: float) -> Scene:
    """Return the scene without the people within a radius [m] of their goal; robots stay.

    >>> leave_at_goals(Scene.of([[0.0, 0.0], [1.0, 0.0]], goal=[[0.1, 0.0], [9.0, 0.0]]), 0.3).active.tolist()
    [[False, True]]
    """
    away = scene.goal - scene.position
    arrived = (away[..., 0] ** 2 + away[..., 1] ** 2 < radius * radius) & scene.active & ~scene.external
    return scene.replace(active=scene.active & ~arrived) if arrived.any() else scene


def leave_in_zone(scene: Scene, zone: PolygonZone) -> Scene:
    """Return the scene without the people in a zone; robots stay.

    >>> corner = PolygonZone(((0, 0), (2, 0), (2, 2), (0, 2)))
    >>> leave_in_zone(Scene.of([[1.0, 1.0], [3.0, 1.0]]), corner).active.tolist()
    [[False, True]]
    """
    there = zone.contains(scene.position.reshape(-1, 2)).reshape(scene.shape) & scene.active & ~scene.external
    return scene.replace(active=scene.active & ~there) if there.any() else scene
