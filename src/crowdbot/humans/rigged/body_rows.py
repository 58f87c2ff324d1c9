"""BodyRows: what poses and contacts need to know of each body at rest, included and imported ones."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from crowdbot.humans.asset import Shapes, shapes
from crowdbot.humans.limbs import LIMBS, fit_capsules, main_bones, rest_capsules
from crowdbot.typing import Floats, Ints

from .rigged_body import RiggedBody

SOLE = 0.015
"""Height [m] of the points of the foot that belong to the sole."""
FEWEST = 12
"""Smallest number of points to which the capsule of a limb is fitted."""


class BodyRows(NamedTuple):
    """Bodies at rest, one row for each: P bodies, 28 bones, 17 limbs.

    Fields:
        head: start of each bone ``[P, 28, 3]`` [m].
        capsules: start, end, radius of each limb ``[P, 17, 7]`` [m].
        sole: rear and front end of the sole, ahead of the pelvis ``[P, 2]`` [m].
        eyes: middle between the eyes relative to the head joint ``[P, 3]`` [m].
        hands: axes of both hands ``[P, 2, 3, 3]``: columns to the fingers, left, out of the back of the hand.
        face: nose, left and right eye, left and right ear ``[P, 5, 3]`` [m].
    """

    head: Floats
    capsules: Floats
    sole: Floats
    eyes: Floats
    hands: Floats
    face: Floats


@functools.cache
def included_rows() -> BodyRows:
    """Return the rows of the included bodies, in the order of the asset."""
    every = shapes()
    level = every.levels[0]
    eyes = level.rest[:, level.vertex_region == every.regions.index("eyes")]
    middle = 0.5 * (eyes.min(axis=1) + eyes.max(axis=1))
    face = np.stack([level.rest[:, rows].mean(axis=1) for rows in _face_vertices(every)], axis=1)
    return BodyRows(
        every.head, rest_capsules(), sole_ends(level.rest, main_bones(level.bones, level.weights)),
        middle - every.head[:, every.bone("head")], hand_axes(every.head, every.tail), face,
    )  # fmt: skip


def body_rows(own: tuple[RiggedBody, ...]) -> BodyRows:
    """Return the rows of the included bodies, followed by imported ones.

    The face of an imported body has the place and, in relation to the head, the size of that of the mean adult.
    """
    included = included_rows()
    rows = [_row(body, included) for body in own]
    return BodyRows(
        *(np.concatenate([whole, *(row[k] for row in rows)]) for k, whole in enumerate(included))
    ) if rows else included  # fmt: skip


def _row(body: RiggedBody, included: BodyRows) -> BodyRows:
    every = shapes()
    level, skull = body.levels[0], every.bone("head")
    main = main_bones(level.bones, level.weights)
    head, tail = body.head[None], body.tail[None]
    crown = float(level.rest[:, 2].max()) - float(body.head[skull, 2])
    size = crown / float(every.levels[0].rest[-1][:, 2].max() - every.head[-1, skull, 2])
    tall = body.height / float(every.levels[0].rest[-1][:, 2].max())
    capsules = np.empty((1, len(LIMBS), 7))
    for k, limb in enumerate(LIMBS):
        points = level.rest[np.isin(main, [every.bone(name) for name in limb.skin])]
        if len(points) >= FEWEST:
            capsules[:, k] = fit_capsules(limb, head, tail, points[None])
        else:
            bone = every.bone(limb.bone)
            place = tall * (included.capsules[-1, k, :6].reshape(2, 3) - every.head[-1, bone]) + body.head[bone]
            capsules[:, k] = *place.ravel(), tall * included.capsules[-1, k, 6]
    face = body.head[skull] + size * (included.face[-1] - every.head[-1, skull])
    sole = sole_ends(level.rest[None], main)
    if not np.all(np.isfinite(sole)):
        foot = every.bone("foot_l")
        sole = body.head[foot, 0] + tall * (included.sole[-1:] - every.head[-1, foot, 0])
    return BodyRows(head, capsules, sole, size * included.eyes[-1:], hand_axes(head, tail), face[None])


def sole_ends(rest: Floats, main: Ints) -> Floats:
    """Return the rear and front ends ``[P, 2]`` of the sole: the outermost points within 15 mm of the floor."""
    every = shapes()
    foot = rest[:, np.isin(main, [every.bone("foot_l"), every.bone("ball_l")])]
    low = foot[..., 2] < SOLE
    behind = np.where(low, foot[..., 0], np.inf).min(axis=1, initial=np.inf)
    front = np.where(low, foot[..., 0], -np.inf).max(axis=1, initial=-np.inf)
    return np.stack([behind, front], axis=1)


def hand_axes(head: Floats, tail: Floats) -> Floats:
    """Return the axes of both hands ``[P, 2, 3, 3]``: columns to the fingers, left, up."""
    every = shapes()
    result = np.empty((len(head), 2, 3, 3))
    for k, side in enumerate("lr"):
        wrist = head[:, every.bone(f"hand_{side}")]
        x = head[:, every.bone(f"fingers_01_{side}")] - wrist
        thumb = tail[:, every.bone(f"thumb_{side}")] - wrist
        x = x / np.linalg.norm(x, axis=-1, keepdims=True)
        y = thumb - x * np.sum(x * thumb, axis=-1, keepdims=True)
        y = y / np.linalg.norm(y, axis=-1, keepdims=True) * (-1.0 if side == "l" else 1.0)
        result[:, k] = np.stack([x, y, np.cross(x, y)], axis=-1)
    return result


def _face_vertices(every: Shapes) -> tuple[Ints, ...]:
    """Return the vertices of the finest level whose mean is nose, left eye, right eye, left ear and right ear."""
    level, mean = every.levels[0], every.levels[0].rest[-1]
    main = main_bones(level.bones, level.weights)
    face = np.flatnonzero((level.vertex_part == 0) & (main == every.bone("head")))
    eyes = level.vertex_region == every.regions.index("eyes")
    skin = face[~eyes[face]]
    nose = skin[np.argsort(-mean[skin, 0], kind="stable")[:3]]
    aside = skin[np.argsort(-np.abs(mean[skin, 1]), kind="stable")]
    ears = [np.array([v for v in aside if mean[v, 1] * side > 0.0][:6]) for side in (1.0, -1.0)]
    both = [np.flatnonzero(eyes & (mean[:, 1] * side > 0.0)) for side in (1.0, -1.0)]
    return (nose, *both, *ears)
