"""Tracks in the frame of each agent, and the transformation back to the world."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.typing import Bools, Floats

MOVED = 0.1
"""Minimum displacement for a heading [m]; below it, more rows are used."""
SPANS = (2, 4)
"""Numbers of displacements for the heading, tried in this order before all rows."""


@dataclass(frozen=True)
class AgentFrames:
    """Tracks of S scenes in agent frames.

    Fields:
        local: ``[S, T, A, 2]`` [m] positions in the frame of each person.
        origin: ``[S, A, 2]`` [m] origins of the frames, relative to ``centre``.
        turn: ``[S, A, 2]`` cosine and sine of their headings.
        centre: ``[S, 1, 2]`` [m] mean position of the people, for precision.
    """

    local: Floats
    origin: Floats
    turn: Floats
    centre: Floats

    def world(self, local: Floats) -> Floats:
        """Return positions ``[..., S, T, A, 2]`` [m] of these frames in the world."""
        cos, sin = self.turn[:, None, :, 0], self.turn[:, None, :, 1]
        x, y = local[..., 0], local[..., 1]
        turned = np.stack([cos * x - sin * y, sin * x + cos * y], axis=-1)
        return turned + (self.origin + self.centre)[:, None]

    def own(self, world: Floats) -> Floats:
        """Return positions ``[S, T, A, 2]`` [m] of the world in these frames."""
        away = world - self.centre[:, None] - self.origin[:, None]
        cos, sin = self.turn[:, None, :, 0], self.turn[:, None, :, 1]
        x, y = away[..., 0], away[..., 1]
        return np.stack([cos * x + sin * y, cos * y - sin * x], axis=-1)


def agent_frames(past: Floats, here: Bools, frame: str, offset: Floats) -> AgentFrames:
    """Transform tracks ``[S, T, A, 2]`` [m] to agent frames; absent agents stay at 0.

    Args:
        past: complete observed tracks.
        here: mask of present agents ``[S, A]``.
        frame: ``person``: origin at the last position and x axis along the heading of each person; ``world``: origin at
            ``offset`` for all.
        offset: origin of the frame ``world``, ``[2]`` [m].
    """
    now = past[:, -1]
    if frame == "world":
        centre = np.broadcast_to(offset, (len(past), 1, 2))
        origin, turn = np.zeros_like(now), np.broadcast_to(np.array([1.0, 0.0]), now.shape)
    else:
        count = np.maximum(here.sum(axis=1), 1)[:, None, None]
        centre = np.sum(np.where(here[..., None], now, 0.0), axis=1, keepdims=True) / count
        origin, turn = np.where(here[..., None], now - centre, 0.0), headings(past)
    made = AgentFrames(past, origin, turn, centre)
    return AgentFrames(np.where(here[:, None, :, None], made.own(past), 0.0), origin, turn, centre)


def headings(past: Floats) -> Floats:
    """Return heading vectors ``[S, A, 2]`` of the last rows, or of more rows if a person hardly moved.

    The heading of people who did not move is +x.
    """
    rows = past.shape[1]
    found = np.zeros_like(past[:, -1])
    length = np.zeros(found.shape[:2])
    for span in (*SPANS, rows - 1):
        way = past[:, -1] - past[:, max(0, rows - 1 - span)]
        wanted = length < MOVED
        found = np.where(wanted[..., None], way, found)
        length = np.where(wanted, np.hypot(way[..., 0], way[..., 1]), length)
    still = length < 1e-9
    unit = found / np.where(still, 1.0, length)[..., None]
    return np.where(still[..., None], np.array([1.0, 0.0]), unit)
