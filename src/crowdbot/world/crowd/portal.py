"""Portals: who leaves at one end of a place comes in at the other."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene

from .waypoint import Zone

__all__ = ["Portal", "ported"]

Floats = NDArray[np.float64]

GAP = 0.01
"""Bodies come out at least this far from others [m]."""


@dataclass(frozen=True)
class Portal:
    """Whoever is in the zone comes out elsewhere, as soon as there is room; robots do not.

    Who finds no room waits in the zone. Others who wait in a portal take no room where somebody comes out.

    Those who come out are new people, with an identity of their own, so that no track jumps. They keep their velocity
    and go on to where they wanted to go.

    Fields:
        zone: where people go in.
        dx, dy: from there to where they come out [m].

    Raises:
        InputError: the way is not finite, or 0.

    >>> Portal(Zone(((24, -5), (26, -5), (26, 5), (24, 5))), dx=-48.0).dy
    0.0
    """

    zone: Zone
    dx: float = 0.0
    dy: float = 0.0

    def __post_init__(self) -> None:
        if not (math.isfinite(self.dx) and math.isfinite(self.dy)) or (self.dx == 0.0 and self.dy == 0.0):
            raise InputError(f"Portal: dx = {self.dx} m, dy = {self.dy} m must be finite, and not both 0")


def ported(before: Scene, scene: Scene, portals: Sequence[Portal], ids: Any, following: Any) -> Scene:
    """Return the scene in which whoever is in a portal has come out where there is room.

    Args:
        before: a step ago.
        scene: now.
        portals: the first in which somebody is takes that person.
        ids: ``[E, A]`` who is who; is written to.
        following: ``[E]`` the next identities; is written to.
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


def _within(scene: Scene, portal: Portal) -> NDArray[np.bool_]:
    return portal.zone.contains(scene.position.reshape(-1, 2)).reshape(scene.shape)
