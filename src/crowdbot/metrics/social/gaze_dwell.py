"""Share of time that a person looks at a robot, from the poses of the head or the directions of the gaze."""

from __future__ import annotations

import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike

from crowdbot.core import InputError, check_number
from crowdbot.typing import Bools, Floats

HEAD_HALF_ANGLE = math.radians(15.0)
"""Half angle of the cone about the direction of a head [rad]. Most natural saccades are of 15 degrees or less (Bahill,
Adler, Stark 1975, Investigative Ophthalmology 14, 468-469); the head turns for more."""
GAZE_HALF_ANGLE = math.radians(3.0)
"""Half angle of the cone about the direction of a gaze [rad]: fovea, and error of eye trackers in headsets."""
LONGEST_GAP = 0.5
"""Longest time for which a sample counts [s]; the rest of a longer gap is unknown."""


class GazeDwell(NamedTuple):
    """How long a person looks at a target.

    Fields:
        share: part of the known time with the target in the cone of view, whether hidden or not.
        visible_share: part of the known time with the target in the cone and not hidden.
        glances: number of uninterrupted times with the target in the cone and not hidden.
        mean_glance: mean length of these [s]; NaN without any.
        known: time with a known view [s].
    """

    share: float
    visible_share: float
    glances: int
    mean_glance: float
    known: float


def gaze_dwell(
    time: ArrayLike,
    eye: ArrayLike,
    direction: ArrayLike,
    target: ArrayLike,
    *,
    radius: float,
    height: float,
    half_angle: float = HEAD_HALF_ANGLE,
    walls: Sequence[ArrayLike] = (),
    people: ArrayLike | None = None,
    people_radius: ArrayLike = 0.25,
    people_height: float = 1.7,
) -> GazeDwell:
    """Return how long a person looks at a target, an upright cylinder such as a robot.

    The target is in the cone of view if ``angle(direction, a - eye) - asin(radius / |a - eye|) <= half_angle``, where
    ``a`` is the point of its axis at the height at which the view passes, at least 0 and at most ``height``. It is
    hidden if the line from the eye to ``a`` crosses a wall, or passes through a person below ``people_height``. Each
    sample counts until the next one, for at most 0.5 s; the last one does not count.

    Source: dwell time and its proportion of Holmqvist et al. (2011), Eye Tracking, Oxford University Press, chapter 13.
    The cone, the cylinder and the occlusion are the definitions above.

    Args:
        time: ``[T]`` ascending times [s].
        eye: ``[T, 3]`` positions of the eyes [m]; rows that are not finite are unknown.
        direction: ``[T, 3]`` directions of head or gaze, of any length above 0.
        target: ``[T, 2]`` positions of the axis of the target [m].
        radius, height: of the target [m].
        half_angle: half angle of the cone [rad], at most pi.
        walls: polylines ``[N, 2]`` [m] that nobody sees through, at any height.
        people: ``[T, P, 2]`` positions of other people [m], NaN while absent; None: nobody.
        people_radius: radius of each person, a number or ``[P]`` [m].
        people_height: height of people [m].

    Raises:
        InputError: shapes do not fit, times do not ascend, or a number is out of range.

    >>> time, eye = [0.0, 1.0, 2.0, 3.0, 4.0], [[0.0, 0.0, 1.6]] * 5
    >>> ahead, left = [1.0, 0.0, -0.2], [0.0, 1.0, 0.0]
    >>> found = gaze_dwell(np.array(time) / 4, eye, [ahead, left, ahead, ahead, left], [[3.0, 0.0]] * 5,
    ...                    radius=0.3, height=1.2)
    >>> found.share, found.glances, found.known
    (0.75, 2, 1.0)
    """
    times, eyes, views, places = _samples(time, eye, direction, target)
    check_number("gaze_dwell", "radius", radius, "m", min=0.0)
    check_number("gaze_dwell", "height", height, "m", min=0.0)
    check_number("gaze_dwell", "half_angle", half_angle, "rad", min=0.0, max=math.pi)
    known = np.isfinite(np.concatenate([eyes, views, places], axis=1)).all(axis=1)
    known &= np.linalg.norm(np.nan_to_num(views), axis=1) > 0.0
    span = np.append(np.minimum(np.diff(times), LONGEST_GAP), 0.0) * known
    total = float(span.sum())
    if total == 0.0:
        return GazeDwell(math.nan, math.nan, 0, math.nan, 0.0)
    aim = _aim(eyes, views, places, height)
    inside = known & (_angle(views, aim - eyes, radius) <= half_angle)
    seen = inside & ~_behind_walls(eyes, aim, walls)
    if people is not None:
        seen &= ~_behind_people(eyes, aim, people, people_radius, people_height)
    starts = seen & ~np.concatenate([[False], seen[:-1] & (np.diff(times) <= LONGEST_GAP)])
    visible, glances = float(span[seen].sum()), int((starts & (span > 0.0)).sum())
    return GazeDwell(
        float(span[inside].sum()) / total, visible / total, glances, visible / glances if glances else math.nan, total
    )


def _samples(time: ArrayLike, eye: ArrayLike, direction: ArrayLike, target: ArrayLike) -> tuple[Floats, ...]:
    times, eyes, views, places = (np.asarray(item, dtype=np.float64) for item in (time, eye, direction, target))
    count = times.shape[0] if times.ndim == 1 else -1
    if (eyes.shape, views.shape, places.shape) != ((count, 3), (count, 3), (count, 2)):
        raise InputError(
            f"times, eyes, directions and targets have the shapes {times.shape}, {eyes.shape}, {views.shape} and "
            f"{places.shape}; they must be [T], [T, 3], [T, 3] and [T, 2]"
        )
    if not np.isfinite(times).all() or (np.diff(times) <= 0.0).any():
        raise InputError("times must be finite and ascend")
    return times, eyes, views, places


def _aim(eye: Floats, view: Floats, target: Floats, height: float) -> Floats:
    """Return ``[T, 3]`` the point of the axis of the target at the height of the view, within the target."""
    level = np.hypot(view[:, 0], view[:, 1])
    far = np.hypot(*(target - eye[:, :2]).T)
    with np.errstate(divide="ignore", invalid="ignore"):
        rise = np.where(level > 0.0, far * view[:, 2] / level, np.sign(view[:, 2]) * np.inf)
    z = np.clip(np.nan_to_num(eye[:, 2] + rise, nan=0.0, posinf=height, neginf=0.0), 0.0, height)
    return np.column_stack([target, z])


def _angle(view: Floats, away: Floats, radius: float) -> Floats:
    """Return ``[T]`` the angle from the view to the surface of the target [rad], negative inside."""
    distance = np.linalg.norm(away, axis=1)
    with np.errstate(divide="ignore", invalid="ignore"):
        cosine = np.einsum("ij,ij->i", view, away) / (np.linalg.norm(view, axis=1) * distance)
        size = np.arcsin(np.minimum(radius / distance, 1.0))
    angle = np.arccos(np.clip(cosine, -1.0, 1.0)) - size
    return np.where(distance > radius, angle, -math.pi)


def _behind_walls(eye: Floats, aim: Floats, walls: Sequence[ArrayLike]) -> Bools:
    """Return ``[T]`` whether the line of sight crosses a wall, seen from above."""
    hidden = np.zeros(len(eye), dtype=np.bool_)
    start, end = eye[:, None, :2], aim[:, None, :2]
    for line in walls:
        ring = np.asarray(line, dtype=np.float64)
        if ring.ndim != 2 or ring.shape[1] != 2:
            raise InputError(f"a wall has the shape {ring.shape}; it must be [N, 2]")
        a, b = ring[None, :-1], ring[None, 1:]
        apart = _side(start, end, a) * _side(start, end, b) < 0.0
        hidden |= (apart & (_side(a, b, start) * _side(a, b, end) < 0.0)).any(axis=1)
    return hidden


def _side(a: Floats, b: Floats, point: Floats) -> Floats:
    """Return on which side of the line from a to b a point is, above 0 for left."""
    way, away = b - a, point - a
    return np.asarray(way[..., 0] * away[..., 1] - way[..., 1] * away[..., 0])


def _behind_people(eye: Floats, aim: Floats, people: ArrayLike, radius: ArrayLike, height: float) -> Bools:
    """Return ``[T]`` whether the line of sight passes through a person below that height."""
    places = np.asarray(people, dtype=np.float64)
    if places.ndim != 3 or places.shape[0] != len(eye) or places.shape[2] != 2:
        raise InputError(f"people have the shape {places.shape}; it must be [{len(eye)}, P, 2]")
    way = (aim - eye)[:, None]
    away = places - eye[:, None, :2]
    length = np.maximum(np.sum(way[..., :2] ** 2, axis=-1), 1e-12)
    share = np.clip(np.sum(away * way[..., :2], axis=-1) / length, 0.0, 1.0)
    gap = np.hypot(*np.moveaxis(away - share[..., None] * way[..., :2], -1, 0))
    low = eye[:, None, 2] + share * way[..., 2] < height
    between = (share > 0.0) & (share < 1.0)
    return np.asarray(((gap < np.asarray(radius)) & low & between).any(axis=1))
