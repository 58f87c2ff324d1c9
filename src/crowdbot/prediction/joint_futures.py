"""Joint futures: people of a window take their own futures so that they do not walk through each other."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from crowdbot.data import Windows

from .joint_kernels import arrange, crossing, part_ways

__all__ = ["before_walls", "drawn_together", "kept_apart", "set_together"]

Floats = NDArray[np.float64]

SWEEPS = 8
"""Everyone is asked so often at most to exchange futures."""
ORDER = 0.3
"""Price of leaving the order of probability, in collisions."""
ROUNDS = 12
"""People give way so often at most."""


def set_together(past: Windows, place: Floats, share: Floats, contact: float) -> tuple[Floats, Floats]:
    """Return joint futures ``[W, K, T, A, 2]`` [m] and their weights ``[W, K]``.

    Args:
        past: windows.
        place: ``[W, K, T, A, 2]`` [m], everyone's futures, the likeliest first.
        share: ``[W, A, K]`` their probabilities.
        contact: distance [m] that people keep.

    Everyone takes every own future once. The weight of a joint future is the mean over people of the probabilities of
    what they do in it: for one person that is the own probability.
    """
    W, K = place.shape[:2]
    found, weight = place.copy(), np.full((W, K), 1.0 / K)
    for window, who in _members(past):
        choice = _choice(past, place, window, who, contact, ORDER)
        found[window][:, :, who] = _taken(place[window][:, :, who], choice)
        people = [a for a, person in enumerate(who) if not past.robot[window, person]]
        if people:
            own = np.take_along_axis(share[window, who], choice, axis=1)[people]
            total = np.cumsum(own, axis=0)[-1]
            weight[window] = total / np.cumsum(total)[-1]
    return found, weight


def drawn_together(past: Windows, place: Floats, contact: float, block: int) -> Floats:
    """Return draws ``[W, K, T, A, 2]`` [m] shared out anew within blocks of ``block``, so that people keep apart."""
    found = place.copy()
    for window, who in _members(past):
        for first in range(0, place.shape[1], block):
            part = slice(first, first + block)
            choice = _choice(past, place[:, part], window, who, contact, 0.0)
            found[window, part][:, :, who] = _taken(place[window, part][:, :, who], choice)
    return found


def kept_apart(past: Windows, place: Floats, contact: float) -> Floats:
    """Return joint futures ``[W, K, T, A, 2]`` [m] in which who comes nearer than ``contact`` [m] is moved aside.

    Nobody is moved through a wall: who would be stays on the own path.
    """
    if contact <= 0.0:
        return place
    found = place.copy()
    for window, who in _members(past):
        if len(who) < 2:
            continue
        fixed = past.robot[window, who]
        for k in range(place.shape[1]):
            path = _with_plans(past, np.ascontiguousarray(np.moveaxis(place[window, k][:, who], 1, 0)), window, who)
            moved = part_ways(path, fixed, contact, ROUNDS)
            found[window, k][:, who] = np.moveaxis(moved, 0, 1)
    windows, slots = np.nonzero(past.present[:, -1])
    if past.walls and len(windows):
        now = past.position[windows, -1, slots][:, None, None]
        _, hit = before_walls(past, found[windows, :, :, slots] - now, windows, slots)
        who, draw = np.nonzero(hit)
        found[windows[who], draw, :, slots[who]] = place[windows[who], draw, :, slots[who]]
    return found


def before_walls(
    past: Windows, path: Floats, window: NDArray[np.int64], slot: NDArray[np.int64]
) -> tuple[Floats, NDArray[np.bool_]]:
    """Return displacements ``[N, K, T, 2]`` [m] that end before the walls of the windows, and which did not [N, K]."""
    rings = [np.asarray(ring, dtype=np.float64) for ring in past.walls if len(ring) > 1]
    if not rings:
        return path, np.zeros(path.shape[:2], dtype=np.bool_)
    one = np.concatenate(rings)
    other = np.concatenate([np.roll(ring, -1, axis=0) for ring in rings])
    start = np.ascontiguousarray(past.position[window, -1, slot])
    free = np.asarray(crossing(start, np.ascontiguousarray(path), one, other))
    T = path.shape[2]
    last = np.take_along_axis(path, np.maximum(free - 1, 0)[:, :, None, None], axis=2)
    last = np.where((free > 0)[:, :, None, None], last, 0.0)
    return np.where((np.arange(T) < free[..., None])[..., None], path, last), free < T


def _members(past: Windows) -> list[tuple[int, NDArray[np.int64]]]:
    """Return every window with who is there, by id, so that the order of slots does not matter."""
    found = []
    for window in range(len(past)):
        who = np.flatnonzero(past.present[window, -1])
        found.append((window, who[np.argsort(past.id[window, who], kind="stable")]))
    return found


def _choice(
    past: Windows, place: Floats, window: int, who: NDArray[np.int64], contact: float, order: float
) -> NDArray[np.int64]:
    K = place.shape[1]
    if len(who) < 2 or contact <= 0.0:
        return np.tile(np.arange(K), (len(who), 1))
    path = np.ascontiguousarray(place[window][:, :, who].transpose(2, 0, 1, 3))
    path = np.stack([_with_plans(past, np.ascontiguousarray(path[:, k]), window, who) for k in range(K)], axis=1)
    return np.asarray(arrange(path, contact, order, SWEEPS))


def _with_plans(past: Windows, path: Floats, window: int, who: NDArray[np.int64]) -> Floats:
    """Return paths ``[A, T, 2]`` with robots where their plans say."""
    if past.plan is None:
        return path
    path = path.copy()
    for step in range(path.shape[1]):
        ahead = past.plan_at(step + 1)[window, who]
        path[:, step] = np.where(np.isnan(ahead), path[:, step], ahead)
    return path


def _taken(place: Floats, choice: NDArray[np.int64]) -> Floats:
    """Return ``place [K, T, A, 2]`` with the futures of each person in the order ``choice [A, K]``."""
    return np.take_along_axis(place, choice.T[:, None, :, None], axis=0)
