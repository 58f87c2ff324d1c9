"""Joint futures: combinations of individual futures without collisions."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Windows
from crowdbot.typing import Floats, Ints

from .joint_kernels import assign_futures, first_crossing, separate_paths

SWEEPS = 8
"""Maximum number of passes over all people when futures are exchanged."""
ORDER = 0.3
"""Cost of a permutation relative to the cost of a collision."""
ROUNDS = 12
"""Maximum number of separation rounds."""


def coordinate_modes(past: Windows, place: Floats, share: Floats, contact: float) -> tuple[Floats, Floats, Ints]:
    """Return joint futures ``[W, K, T, A, 2]`` [m], their weights ``[W, K]``, and their futures ``[W, K, A]``.

    Args:
        past: windows.
        place: ``[W, K, T, A, 2]`` [m], individual futures by decreasing probability.
        share: ``[W, A, K]`` their probabilities.
        contact: minimum distance between people [m].

    Joint futures are sorted by decreasing weight, the mean probability of their individual futures. Each person uses
    each individual future once.
    """
    W, K = place.shape[:2]
    found, weight = place.copy(), np.full((W, K), 1.0 / K)
    order = np.tile(np.arange(K)[:, None], (W, 1, place.shape[3]))
    for window, who in _members(past):
        choice = _choice(past, place, window, who, contact, ORDER)
        found[window][:, :, who] = _reorder(place[window][:, :, who], choice)
        own = np.take_along_axis(share[window, who], choice, axis=1)
        order[window][:, who] = choice.T
        people = [a for a, person in enumerate(who) if not past.robot[window, person]]
        if people:
            total = np.cumsum(own[people], axis=0)[-1]
            weight[window] = total / np.cumsum(total)[-1]
        first = np.argsort(-weight[window], kind="stable")
        found[window], weight[window], order[window] = found[window][first], weight[window][first], order[window][first]
    return found, weight, order


def coordinate_draws(past: Windows, place: Floats, contact: float, block: int) -> Floats:
    """Return draws ``[W, K, T, A, 2]`` [m], permuted within blocks of ``block`` draws to reduce collisions."""
    result = place.copy()
    for window, who in _members(past):
        for first in range(0, place.shape[1], block):
            part = slice(first, first + block)
            choice = _choice(past, place[:, part], window, who, contact, 0.0)
            result[window, part][:, :, who] = _reorder(place[window, part][:, :, who], choice)
    return result


def separate_people(past: Windows, place: Floats, contact: float) -> Floats:
    """Return joint futures ``[W, K, T, A, 2]`` [m] with people at least ``contact`` [m] apart, also between rows.

    Where the windows have radii, people are apart by the sum of radii; half of ``contact`` is the radius of the others.
    Robots with a plan are not moved. Robots without one give way: nothing says where they will drive, and people are
    not predicted to avoid it. Paths that cross a wall stop there; those that would cross one after the separation are
    not moved.
    """
    if contact <= 0.0:
        return place
    place, _ = _stop_at_walls(past, place)
    found = place.copy()
    for window, who in _members(past):
        if len(who) < 2:
            continue
        rank, room = _ranks(past, window, who), _rooms(past, window, who, contact)
        paths = _with_plans(past, place[window][:, :, who].transpose(0, 2, 1, 3), window, who)
        moved = np.stack([separate_paths(path, rank, room, ROUNDS) for path in np.ascontiguousarray(paths)])
        found[window][:, :, who] = moved.transpose(0, 2, 1, 3)
    _, hit = _stop_at_walls(past, found)
    return np.where(hit[:, :, None, :, None], place, found)


def _stop_at_walls(past: Windows, place: Floats) -> tuple[Floats, NDArray[np.bool_]]:
    """Return futures ``[W, K, T, A, 2]`` [m] that stop at walls, and a mask ``[W, K, A]`` of the stopped paths."""
    stopped, mask = place, np.zeros((*place.shape[:2], place.shape[3]), dtype=np.bool_)
    window, slot = np.nonzero(past.present[:, -1])
    if past.walls and len(window):
        now = past.position[window, -1, slot][:, None, None]
        path, hit = stop_at_walls(past, place[window, :, :, slot] - now, window, slot)
        mask[window, :, slot] = hit
        stopped = place.copy()
        stopped[window, :, :, slot] = np.where(hit[:, :, None, None], now + path, place[window, :, :, slot])
    return stopped, mask


def stop_at_walls(
    past: Windows, path: Floats, window: NDArray[np.int64], slot: NDArray[np.int64]
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return displacements ``[N, K, T, 2]`` [m] that stop at walls, and a mask ``[N, K]`` of the stopped paths."""
    rings = [np.asarray(ring, dtype=np.float64) for ring in past.walls if len(ring) > 1]
    if not rings:
        return path, np.zeros(path.shape[:2], dtype=np.bool_)
    one = np.concatenate(rings)
    other = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    start = np.ascontiguousarray(past.position[window, -1, slot])
    free = np.asarray(first_crossing(start, np.ascontiguousarray(path), one, other))
    T = path.shape[2]
    last = np.take_along_axis(path, np.maximum(free - 1, 0)[:, :, None, None], axis=2)
    last = np.where((free > 0)[:, :, None, None], last, 0.0)
    return np.where((np.arange(T) < free[..., None])[..., None], path, last), free < T


def _ranks(past: Windows, window: int, who: NDArray[np.int64]) -> NDArray[np.int64]:
    """Return who gives way to whom ``[A]``: 0 for robots with a plan, 1 for people, 2 for robots without one."""
    robot = past.robot[window, who]
    planned = np.zeros(len(who), dtype=np.bool_) if past.plan is None else ~np.isnan(past.plan_at(1)[window, who, 0])
    return np.where(robot, np.where(planned, 0, 2), 1)


def _rooms(past: Windows, window: int, who: NDArray[np.int64], contact: float) -> Floats:
    """Return the radii ``[A]`` [m] of agents of a window; half of ``contact`` where they are unknown."""
    if past.radius is None:
        return np.full(len(who), 0.5 * contact)
    known = past.radius[window, who]
    return np.where(np.isnan(known), 0.5 * contact, known)


def _members(past: Windows) -> list[tuple[int, NDArray[np.int64]]]:
    """Return the slots of the agents in each window, sorted by id: results do not depend on the order of slots."""
    members = []
    for window in range(len(past)):
        who = np.flatnonzero(past.present[window, -1])
        members.append((window, who[np.argsort(past.id[window, who], kind="stable")]))
    return members


def _choice(
    past: Windows, place: Floats, window: int, who: NDArray[np.int64], contact: float, order: float
) -> NDArray[np.int64]:
    K = place.shape[1]
    if len(who) < 2 or contact <= 0.0:
        return np.tile(np.arange(K), (len(who), 1))
    path = _with_plans(past, place[window][:, :, who].transpose(0, 2, 1, 3), window, who)
    path = np.ascontiguousarray(np.swapaxes(path, 0, 1))
    return np.asarray(assign_futures(path, _rooms(past, window, who, contact), order, SWEEPS))


def _with_plans(past: Windows, path: Floats, window: int, who: NDArray[np.int64]) -> Floats:
    """Return paths ``[K, A, T, 2]`` in which robots follow their plans."""
    if past.plan is None:
        return path
    ahead = np.stack([past.plan_at(step + 1)[window, who] for step in range(path.shape[2])], axis=1)
    return np.where(np.isnan(ahead), path, ahead)


def _reorder(place: Floats, choice: NDArray[np.int64]) -> Floats:
    """Return ``place [K, T, A, 2]`` with the futures of each person permuted by ``choice [A, K]``."""
    return place.transpose(2, 0, 1, 3)[np.arange(len(choice))[:, None], choice].transpose(1, 2, 0, 3)
