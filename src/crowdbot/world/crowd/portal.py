"""Portals, which transfer people from one zone to another."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene

from .waypoint import PolygonZone

__all__ = ["PortalTransfer", "apply_portals"]

Floats = NDArray[np.float64]

GAP = 0.01
"""Minimum clearance [m] to other bodies at the exit."""


@dataclass(frozen=True)
class PortalTransfer:
    """A portal: people in the zone are moved by (dx, dy) as soon as there is room. Robots are not moved.

    A person without room at the exit waits in the zone. People who wait in a portal do not block an exit.

    A transferred person counts as a new person with a new identity, so tracks have no jumps. The person keeps velocity
    and goal.

    Fields:
        zone: entrance of the portal.
        dx, dy: displacement [m].

    Raises:
        InputError: the displacement is not finite, or 0.

    >>> PortalTransfer(PolygonZone(((24, -5), (26, -5), (26, 5), (24, 5))), dx=-48.0).dy
    0.0
    """

    zone: PolygonZone
    dx: float = 0.0
    dy: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.dx) and math.isfinite(self.dy)) or (self.dx == 0.0 and self.dy == 0.0):
            raise InputError(f"PortalTransfer: dx = {self.dx} m, dy = {self.dy} m must be finite, and not both 0")


def apply_portals(before: Scene, scene: Scene, portals: Sequence[PortalTransfer], ids: Any, following: Any) -> Scene:
    """Return the scene after people in portals have been transferred where there is room.

    Args:
        before: scene one step ago.
        scene: current scene.
        portals: portals; if zones overlap, the first one applies.
        ids: ``[E, A]`` identities; modified in place.
        following: ``[E]`` next identities; modified in place.
    """
    if not portals:
        return scene
    moving = scene.active & ~scene.external
    position: Floats = scene.position.copy()
    inside = [_within(scene, portal) for portal in portals]
    waiting = moving & np.any(inside, axis=0)
    done = np.zeros(scene.shape, dtype=np.bool_)
    for portal, zone in zip(portals, inside, strict=True):
        there = moving & ~done & zone
        shift = np.array([portal.dx, portal.dy])
        for e, a in np.argwhere(there):
            place = position[e, a] + shift
            away = np.hypot(*(position[e] - place).T)
            near = scene.active[e] & ~waiting[e] & (away < scene.radius[e] + scene.radius[e, a] + GAP)
            near[a] = False
            if not np.any(near):
                position[e, a] = place
                ids[e, a] = following[e]
                following[e] += 1
                done[e, a], waiting[e, a] = True, False
    held = waiting & before.active & np.any([_within(before, portal) for portal in portals], axis=0)
    velocity = np.where(held[..., None], 0.0, scene.velocity)
    return scene.replace(position=np.where(held[..., None], before.position, position), velocity=velocity)


def _within(scene: Scene, portal: PortalTransfer) -> NDArray[np.bool_]:
    return portal.zone.contains(scene.position.reshape(-1, 2)).reshape(scene.shape)
