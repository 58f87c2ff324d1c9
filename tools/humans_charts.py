"""Texture coordinates of the bodies: where each corner of the mesh lies in the picture of a person."""

from __future__ import annotations

import numpy as np

from crowdbot.humans.asset import shapes
from crowdbot.humans.wardrobe import CHARTS

SIDE = 512
HEAD_AXIS, HEAD_LOW, HEAD_TALL = 0.03, 1.40, 0.345
"""Axis x [m] of the cylinder around the head, its lower end and height [m], on the mean adult."""
EYE_RADIUS = 0.0148


def corner_uv(k: int) -> np.ndarray:
    """The texture coordinates ``[F, 3, 2]`` of the corners of a level."""
    every = shapes()
    level = every.levels[k]
    place = level.rest[-1][level.faces]
    main = level.bones[np.arange(len(level.bones)), np.argmax(level.weights, axis=1)]
    region = np.array(every.regions)[level.face_region]
    head = np.isin(np.array(every.bones)[main], ("head", "neck_01", "spine_03"))[level.faces].all(axis=1)
    found = np.zeros((*place.shape[:2], 2))
    for f in range(len(place)):
        name = "head" if region[f] == "scalp" or (region[f] == "skin" and head[f]) else region[f]
        chart = CHARTS[{"skin": "hand"}.get(name, name)]
        uv = _local(name, place[f])
        if name == "head":
            found[f] = uv
        else:
            found[f] = np.array(chart[:2]) + np.clip(uv, 0.02, 0.98) * np.array(chart[2:])
    return np.clip(found, 0.0, 1.0)


def _local(name: str, p: np.ndarray) -> np.ndarray:
    """Coordinates from 0 to 1 in the chart of a region."""
    x, y, z = p.T
    if name == "head":
        turn = _angle(y, x - HEAD_AXIS)
        return np.column_stack([0.5 + turn / (2.0 * np.pi), 0.5 * (1.0 - (z - HEAD_LOW) / HEAD_TALL)])
    if name == "eyes":
        side = np.sign(y.mean())
        return np.column_stack([0.5 + (y - side * 0.0295) / (2 * EYE_RADIUS), 0.5 - (z - 1.590) / (2 * EYE_RADIUS)])
    if name == "hair":
        return np.column_stack([np.abs(_angle(y, x - HEAD_AXIS)) / np.pi, (1.76 - z) / 0.42])
    if name in ("top", "skirt"):
        low, tall = (0.86, 0.64) if name == "top" else (0.48, 0.40)
        return np.column_stack([0.5 + _angle(y, x) / (2.3 * np.pi), 1.0 - (z - low) / tall])
    if name in ("upperarm", "forearm"):
        return _around(p, (0.009, 0.178, 1.355), (0.18, 0.467, 1.05))
    if name in ("bottom", "shin"):
        return _around(p, (-0.008, 0.104, 0.99), (0.002, 0.183, 0.077))
    if name == "shoes":
        return np.column_stack([(x + 0.12) / 0.33, 1.0 - z / 0.14])
    return np.column_stack([(np.abs(y) - 0.40) / 0.15, (1.07 - z) / 0.16])  # hands


def _around(p: np.ndarray, first: tuple[float, ...], last: tuple[float, ...]) -> np.ndarray:
    """Half turns about an axis of the left side, and the share of the way along it."""
    q = p * (1.0, np.sign(p[:, 1].mean()) or 1.0, 1.0)
    a, b = np.array(first), np.array(last)
    axis = (b - a) / np.linalg.norm(b - a)
    along = (q - a) @ axis / np.linalg.norm(b - a)
    off = q - a - ((q - a) @ axis)[:, None] * axis
    front = np.array([1.0, 0.0, 0.0]) - axis[0] * axis
    other = np.cross(axis, front)
    return np.column_stack([np.abs(_angle(off @ other, off @ front)) / np.pi, along])


def _angle(y: np.ndarray, x: np.ndarray) -> np.ndarray:
    """Angles of the corners of a triangle without a jump, in reach of that of its centre."""
    middle = np.arctan2(y.mean(), x.mean())
    turn = np.arctan2(y, x)
    return turn - 2.0 * np.pi * np.round((turn - middle) / (2.0 * np.pi))
