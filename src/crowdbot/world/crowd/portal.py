"""Exits, where people leave, and portals, which transfer people from one zone to another."""

from __future__ import annotations

import functools
import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, kernel
from crowdbot.core.fields import Points, attribute, check
from crowdbot.typing import Bools, Floats

from .agent_arrays import BOOL, FLOAT, dense
from .waypoint import is_inside, polygon_ring

Numbers = NDArray[np.int64]

GAP = 0.01
"""Minimum clearance [m] to other bodies at the exit."""


@dataclass(frozen=True, kw_only=True)
class Exit:
    """A zone in which all people leave, whatever their goal; robots are not affected."""

    name: str = attribute("", about="name for messages")
    zone: Points = attribute(about="corners x,y of the zone", unit="m", points=3)

    def __post_init__(self) -> None:
        check(self)

    @functools.cached_property
    def ring(self) -> Floats:
        """Corners ``[N, 2]`` [m]."""
        return polygon_ring(self.zone)


@dataclass(frozen=True, kw_only=True)
class Portal:
    """A zone that moves people elsewhere, with a new id; robots are not affected.

    People in the zone are moved by (dx, dy) as soon as there is room; until then they wait in the zone. People who
    wait at each other's exits change places. A transferred person keeps velocity and goal, and counts as a new person,
    so tracks have no jumps.

    Raises:
        InputError: the displacement is 0, or a value is not allowed.

    >>> Portal(zone="25,-5 30,-5 30,5 25,5", dx=-50).dy
    0.0
    """

    name: str = attribute("", about="name for messages")
    zone: Points = attribute(about="corners x,y of the zone", unit="m", points=3)
    dx: float = attribute(0.0, about="offset from the zone to the exit of the portal", unit="m")
    dy: float = attribute(0.0, about="offset from the zone to the exit of the portal", unit="m")

    def __post_init__(self) -> None:
        check(self)
        if self.dx == 0.0 and self.dy == 0.0:
            raise InputError("needs dx or dy: the offset of the exit from the zone")

    @functools.cached_property
    def ring(self) -> Floats:
        """Corners ``[N, 2]`` [m] of the entrance."""
        return polygon_ring(self.zone)


def apply_portals(before: Scene, scene: Scene, portals: Sequence[Portal], ids: Any, following: Any) -> Scene:
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
    shape = scene.shape
    pairs = (*shape, 2)
    position, velocity = scene.position.copy(), scene.velocity.copy()
    rings = [portal.ring for portal in portals]
    changed = _transfer(
        np.concatenate(rings),
        np.cumsum([0, *map(len, rings)]),
        np.array([(portal.dx, portal.dy) for portal in portals], dtype=np.float64),
        dense(before.position, pairs, FLOAT),
        dense(before.active, shape, BOOL),
        dense(scene.active, shape, BOOL),
        dense(scene.external, shape, BOOL),
        dense(scene.radius, shape, FLOAT),
        *(position, velocity, ids, following),
    )
    return scene.replace(position=position, velocity=velocity) if changed else scene


@kernel
def _transfer(
    ring: Floats, first: Numbers, shift: Floats, old: Floats, present: Bools, active: Bools, external: Bools,
    radius: Floats, position: Floats, velocity: Floats, ids: Numbers, following: Numbers,
) -> bool:  # fmt: skip
    """Transfer people, and stop those who wait; return whether anything changed.

    Args:
        ring, first: corners of all portals, and the first corner of each.
        shift: ``[P, 2]`` displacements.
        old, present: positions and activity one step ago.
        active, external, radius: current agents ``[E, A]``.
        position, velocity, ids, following: modified in place.
    """
    E, A = active.shape
    P = len(shift)
    inside, waiting = np.empty((P, A), dtype=np.bool_), np.empty(A, dtype=np.bool_)
    chosen, stay = np.empty(A, dtype=np.int64), np.empty((A, 2))
    changed = False
    for e in range(E):
        some = False
        for a in range(A):
            waiting[a] = False
            chosen[a] = -1
            stay[a, 0], stay[a, 1] = position[e, a, 0], position[e, a, 1]
            for p in range(P):
                part = ring[first[p] : first[p + 1]]
                inside[p, a] = (
                    active[e, a] and not external[e, a] and is_inside(part, position[e, a, 0], position[e, a, 1])
                )
                waiting[a] = waiting[a] or inside[p, a]
            some = some or waiting[a]
            if waiting[a] and present[e, a] and _is_in_any(ring, first, old[e, a, 0], old[e, a, 1]):
                stay[a, 0], stay[a, 1] = old[e, a, 0], old[e, a, 1]
        if not some:
            continue
        _choose_portals(inside, waiting, shift, active[e], position[e], stay, radius[e], chosen)
        for p in range(P):
            for a in range(A):
                if chosen[a] == p:
                    position[e, a, 0] += shift[p, 0]
                    position[e, a, 1] += shift[p, 1]
                    ids[e, a] = following[e]
                    following[e] += 1
                    changed = True
        for a in range(A):
            if waiting[a] and chosen[a] < 0 and present[e, a] and _is_in_any(ring, first, old[e, a, 0], old[e, a, 1]):
                position[e, a, 0], position[e, a, 1] = stay[a, 0], stay[a, 1]
                velocity[e, a, 0], velocity[e, a, 1] = 0.0, 0.0
                changed = True
    return changed


@kernel
def _is_in_any(ring: Floats, first: Numbers, x: float, y: float) -> bool:
    """Return whether x, y is in one of the portals."""
    for p in range(len(first) - 1):  # noqa: SIM110 - kernels take no generators
        if is_inside(ring[first[p] : first[p + 1]], x, y):
            return True
    return False


@kernel
def _choose_portals(
    inside: Bools, waiting: Bools, shift: Floats, active: Bools, position: Floats, stay: Floats, radius: Floats,
    chosen: Numbers,
) -> None:  # fmt: skip
    """Write the portal of each person who is transferred to ``chosen``; all others keep -1.

    People who wait at each other's exits are transferred together. Those who stay block their place, so the set is
    reduced until nobody is placed on anybody.
    """
    P, A = inside.shape
    for p in range(P):
        for a in range(A):
            if inside[p, a] and chosen[a] < 0:
                x, y = position[a, 0] + shift[p, 0], position[a, 1] + shift[p, 1]
                if _is_free(x, y, a, active, waiting, position, radius):
                    chosen[a] = p
    again = True
    while again:
        again = False
        for a in range(A):
            if chosen[a] >= 0 and _is_blocked(a, chosen, waiting, shift, position, stay, radius):
                chosen[a] = -1
                again = True


@kernel
def _is_blocked(
    agent: int, chosen: Numbers, waiting: Bools, shift: Floats, position: Floats, stay: Floats, radius: Floats
) -> bool:
    """Return whether the exit of an agent is taken by somebody who stays, or who is transferred there before."""
    p = chosen[agent]
    x, y = position[agent, 0] + shift[p, 0], position[agent, 1] + shift[p, 1]
    for b in range(len(chosen)):
        if b == agent or not waiting[b]:
            continue
        bx, by = stay[b, 0], stay[b, 1]
        q = chosen[b]
        if q >= 0:
            if q > p or (q == p and b > agent):
                continue
            bx, by = position[b, 0] + shift[q, 0], position[b, 1] + shift[q, 1]
        if math.hypot(bx - x, by - y) < radius[b] + radius[agent] + GAP:
            return True
    return False


@kernel
def _is_free(x: float, y: float, agent: int, active: Bools, waiting: Bools, position: Floats, radius: Floats) -> bool:
    """Return whether an agent has room at x, y; those in portals do not count."""
    for b in range(len(active)):
        if b == agent or not active[b] or waiting[b]:
            continue
        if math.hypot(position[b, 0] - x, position[b, 1] - y) < radius[b] + radius[agent] + GAP:
            return False
    return True
