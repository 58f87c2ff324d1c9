"""Clearances of people and of other bodies to a robot whose outline is not a disc, at each row of a log."""

from __future__ import annotations

import math
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import kernel, read_only
from crowdbot.core.outlines import Outlines, body_gap, swept_gap, time_to_outline
from crowdbot.typing import Bools, Floats, Ints

from .proximity import JUMP, clearance, swept_clearance, time_to_collision

PARTS, HALVINGS = 64, 30
"""Intervals of a step in which the first contact is searched, and halvings of the interval that has it."""


class OutlineClearance(NamedTuple):
    """Clearances of each agent to a robot, ``[T, A]``; infinite for the robot and for absent agents.

    Fields:
        swept: smallest clearance since the row before [m].
        gap: clearance at the row [m].
        ttc: time to collision at constant velocities and constant heading of the robot [s].
    """

    swept: Floats
    gap: Floats
    ttc: Floats


@kernel
def _measure(
    jump: Floats, place: Floats, velocity: Floats, heading: Floats, radius: Floats, active: Bools, own: int,
    corner: Floats, swept: Floats, gap: Floats, ttc: Floats,
) -> None:  # fmt: skip
    for t in range(len(place)):
        b = max(t - 1, 0)
        x, y, r = place[t, own, 0], place[t, own, 1], radius[t, own]
        bx, by = place[b, own, 0], place[b, own, 1]
        last = len(corner) if math.isfinite(heading[t]) else 0
        turn = heading[t] if last > 0 else 0.0
        before = heading[b] if math.isfinite(heading[b]) else turn
        moves = t > 0 and active[b, own] and math.hypot(x - bx, y - by) <= jump[t]
        for n in range(place.shape[1]):
            swept[t, n] = gap[t, n] = ttc[t, n] = math.inf
            if n == own or not active[t, n] or not active[t, own]:
                continue
            px, py, size = place[t, n, 0], place[t, n, 1], radius[t, n]
            gap[t, n] = body_gap(x, y, turn, r, 0, last, px, py, 0.0, size, 0, 0, corner)
            swept[t, n] = gap[t, n]
            if moves and active[b, n]:
                qx, qy = place[b, n, 0], place[b, n, 1]
                if math.hypot(px - qx, py - qy) <= jump[t]:
                    swept[t, n] = swept_gap(
                        bx, by, before, x, y, turn, r, 0, last, qx, qy, 0.0, px, py, 0.0, size, 0, 0, corner, math.inf
                    )
            wx, wy = velocity[t, n, 0] - velocity[t, own, 0], velocity[t, n, 1] - velocity[t, own, 1]
            ttc[t, n] = time_to_outline(px - x, py - y, wx, wy, size, turn, r, corner, 0, last)


def outline_clearance(
    times: Floats, position: Floats, velocity: Floats, heading: Floats, radius: Floats, active: Bools, robot: int,
    outline: Floats | None,
) -> OutlineClearance:  # fmt: skip
    """Return the clearances of all agents, as discs, to a robot; where its heading is unknown, it is a disc.

    Args:
        times: ``[T]`` [s].
        position, velocity: ``[T, A, 2]`` [m], [m/s].
        heading: ``[T]`` of the robot [rad], NaN if unknown.
        radius: ``[A]`` [m]; that of the robot is its circumscribed disc. With an outline also ``[T, A]``.
        active: ``[T, A]`` who is present.
        robot: index of the robot.
        outline: corners ``[K, 2]`` in the frame of the robot [m]; None for a disc.

    >>> box = np.array([[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]])
    >>> place, still, turned = np.array([[[0.0, 0.0], [0.0, 2.0]]]), np.zeros((1, 2, 2)), np.array([np.pi / 2])
    >>> there = outline_clearance(
    ...     np.zeros(1), place, still, turned, np.array([[0.54, 0.3]]), np.ones((1, 2), bool), 0, box)
    >>> there.gap.round(3).tolist()
    [[inf, 1.2]]
    """
    if outline is None:
        return OutlineClearance(
            swept_clearance(times, position, radius, active, robot),
            np.asarray(clearance(position, radius, active, robot)),
            time_to_collision(position, velocity, radius, active, robot),
        )
    result = OutlineClearance(*(np.empty(active.shape) for _ in range(3)))
    jump = JUMP * np.diff(times, prepend=-math.inf)
    sizes = np.broadcast_to(radius, active.shape)
    arrays = map(read_only, (jump, position, velocity, heading, sizes, active))
    corner = np.array(outline, dtype=np.float64)  # can be written, as where the world measures: compiled once
    everything: Any = (*arrays, robot, corner, *result)
    _measure(*everything)
    return result


@kernel
def _measure_points(
    place: Floats, heading: Floats, radius: float, points: Floats, size: Floats, corner: Floats, gap: Floats
) -> None:
    for t in range(len(place)):
        last = len(corner) if math.isfinite(heading[t]) else 0
        turn = heading[t] if last > 0 else 0.0
        for n in range(points.shape[1]):
            px, py = points[t, n, 0], points[t, n, 1]
            gap[t, n] = body_gap(place[t, 0], place[t, 1], turn, radius, 0, last, px, py, 0.0, size[n], 0, 0, corner)


def body_clearance(
    position: Floats, heading: Floats, radius: float, outline: Floats | None, points: Floats, size: Floats
) -> Floats:
    """Return the clearances of discs to a robot, row by row ``[T, N]`` [m]; where its heading is unknown, it is a disc.

    Args:
        position: ``[T, 2]`` of the robot [m].
        heading: ``[T]`` of the robot [rad], NaN if unknown.
        radius: of the circumscribed disc of the robot [m].
        outline: corners ``[K, 2]`` in the frame of the robot [m]; None for a disc.
        points: centres of the discs ``[T, N, 2]`` [m].
        size: radii of the discs ``[N]`` [m].

    >>> box = np.array([[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]])
    >>> beside = np.array([[[0.0, 1.0]]])
    >>> body_clearance(np.zeros((1, 2)), np.zeros(1), 0.54, box, beside, np.array([0.3])).round(3).tolist()
    [[0.5]]
    """
    gap = np.empty(points.shape[:2])
    corner = np.zeros((0, 2)) if outline is None else outline
    place, turn, other, sizes, corners = map(np.ascontiguousarray, (position, heading, points, size, corner))
    arrays: Any = (place, turn, float(radius), other, sizes, corners, gap)
    _measure_points(*arrays)
    return gap


@kernel
def _measure_pair(
    place: Floats, heading: Floats, radius: float, other: Floats, turned: Floats, size: float, there: Bools,
    corner: Floats, first: Ints, swept: Floats, gap: Floats,
) -> None:  # fmt: skip
    for t in range(len(place)):
        swept[t] = gap[t] = math.inf
        if not there[t]:
            continue
        b = t - 1 if t > 0 and there[t - 1] else t
        # a body whose heading is unknown is a disc
        last = first[1] if math.isfinite(heading[t]) and math.isfinite(heading[b]) else first[0]
        end = first[2] if math.isfinite(turned[t]) and math.isfinite(turned[b]) else first[1]
        turn, begin = (heading[t], heading[b]) if last > first[0] else (0.0, 0.0)
        face, faced = (turned[t], turned[b]) if end > first[1] else (0.0, 0.0)
        x, y, px, py = place[t, 0], place[t, 1], other[t, 0], other[t, 1]
        gap[t] = body_gap(x, y, turn, radius, first[0], last, px, py, face, size, first[1], end, corner)
        swept[t] = min(
            gap[t],
            swept_gap(
                place[b, 0], place[b, 1], begin, x, y, turn, radius, first[0], last,
                other[b, 0], other[b, 1], faced, px, py, face, size, first[1], end, corner, math.inf,
            ),
        )  # fmt: skip


def pair_clearance(
    position: tuple[Floats, Floats], heading: tuple[Floats, Floats], radius: tuple[float, float],
    outline: tuple[Floats | None, Floats | None], there: Bools,
) -> tuple[Floats, Floats]:  # fmt: skip
    """Return the clearances of two bodies ``[T]`` [m]: the smallest since the row before, and that at the row.

    Args:
        position: of both bodies, ``[T, 2]`` [m].
        heading: of both ``[T]`` [rad]; a body is a disc where it is NaN.
        radius: of their circumscribed discs [m].
        outline: corners ``[K, 2]`` in the frames of the bodies [m]; None for a disc.
        there: ``[T]`` whether both are present; the clearances are infinite where not.

    >>> box = np.array([[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]])
    >>> here, beside, still = np.zeros((1, 2)), np.array([[0.0, 0.5]]), np.zeros(1)
    >>> pair_clearance((here, beside), (still, still), (0.54, 0.54), (box, box), np.ones(1, bool))[1].round(3).tolist()
    [0.1]
    """
    table = Outlines.of({k: item for k, item in enumerate(outline) if item is not None}, 2)
    swept, gap = np.empty(len(there)), np.empty(len(there))
    (place, other), (turn, face) = (tuple(map(np.ascontiguousarray, pair)) for pair in (position, heading))
    sizes = (float(radius[0]), float(radius[1]))
    arrays: Any = (place, turn, sizes[0], other, face, sizes[1], np.ascontiguousarray(there), *table, swept, gap)
    _measure_pair(*arrays)
    return swept, gap


def outline_touch(
    position: Floats, heading: tuple[float, float], radius: tuple[float, float], outline: Floats
) -> tuple[float, Floats]:
    """Return the share of a step at which a person first touches a robot, and the normal from the robot to them.

    Without contact, it is the share with the smallest clearance.

    Args:
        position: positions ``[2, 2, 2]`` of the robot and the person at the start and the end of the step [m].
        heading: headings of the robot at these times [rad].
        radius: of the circumscribed disc of the robot and of the person [m].
        outline: corners ``[K, 2]`` in the frame of the robot [m].

    >>> box = np.array([[-0.5, -0.2], [0.5, -0.2], [0.5, 0.2], [-0.5, 0.2]])
    >>> path = np.array([[[0.0, 0.0], [0.0, 0.9]], [[0.0, 0.0], [0.0, 0.1]]])
    >>> share, normal = outline_touch(path, (0.0, 0.0), (0.54, 0.3), box)
    >>> round(share, 6), normal.round(6).tolist()
    (0.5, [0.0, 1.0])
    """
    corner = np.ascontiguousarray(outline)
    spin = math.remainder(heading[1] - heading[0], 2.0 * math.pi)

    def gap(share: float, dx: float = 0.0, dy: float = 0.0) -> float:
        (x, y), (px, py) = ((1.0 - share) * position[0] + share * position[1]).tolist()
        turn = heading[0] + share * spin
        return float(body_gap(x, y, turn, radius[0], 0, len(corner), px + dx, py + dy, 0.0, radius[1], 0, 0, corner))

    gaps = [gap(k / PARTS) for k in range(PARTS + 1)]
    k = next((k for k, value in enumerate(gaps) if value < 0.0), -1)
    share = k / PARTS if k >= 0 else int(np.argmin(gaps)) / PARTS
    if k > 0:
        low, high = (k - 1) / PARTS, share
        for _ in range(HALVINGS):
            share = 0.5 * (low + high)
            low, high = (low, share) if gap(share) < 0.0 else (share, high)
    # the gradient of the clearance is the unit vector from the nearest point of the outline
    h = 1e-6
    slope = np.array([gap(share, h) - gap(share, -h), gap(share, 0.0, h) - gap(share, 0.0, -h)])
    length = math.hypot(slope[0], slope[1])
    return share, slope / length if length > 0.0 else np.array([1.0, 0.0])
