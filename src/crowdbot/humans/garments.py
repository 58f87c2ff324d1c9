"""How far clothes hang off the body: trousers, shorts, shirts and sleeves that are wider than the limbs in them."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.typing import Bools, Floats, Ints

from .asset import Level, shapes
from .wardrobe import Outfit

TORSO, ARMS, LEGS = 0, 1, 2
"""Groups of vertices that have a cut of their own."""
TIGHT, LONG, SHORT = 0, 1, 2
"""Cuts: on the skin, down to wrist or ankle, and down to elbow or knee."""
SLEEVES = {"none": TIGHT, "long": LONG, "short": SHORT}
TROUSERS = {"skirt": TIGHT, "long": LONG, "short": SHORT}
EASE = 0.008
"""Distance of cloth from the limb [m]."""
TUBE = 0.071
"""Radius of trousers below the knee [m] (assumed: straight trousers are 0.22 m wide at the hem)."""
FLARE = 0.014
"""Further distance of the hems of shorts and short sleeves [m]."""
OVERLAP = 0.02
"""Length by which a hem covers what it ends at [m]."""
SEAT = 0.6
"""Share by which cloth is closer to the back of the thighs, on which people sit."""
REACH = 0.12
"""Largest distance [m] of the vertices that a hem takes along."""
HANG = 0.7
"""Share of the hollow between chest and hips that a shirt bridges."""


class Drape(NamedTuple):
    """Cloth of a level of detail on a body of the stature ``height`` [m].

    Fields: ``shift [3, V, 3]`` [m] by which each cut moves the vertices at rest, and ``group [V]`` of each vertex.
    """

    shift: Floats
    group: Ints
    height: float


def garment_cuts(worn: Outfit) -> tuple[int, int, int]:
    """Return the cut of shirt, sleeves and trousers of an outfit; below a skirt, legs are tight.

    >>> from crowdbot.humans import outfit, person
    >>> garment_cuts(outfit(person("man-32"), 1)), garment_cuts(outfit(person("mannequin")))
    ((1, 2, 1), (0, 0, 0))
    """
    if worn.skin == worn.top:
        return TIGHT, TIGHT, TIGHT
    return LONG, SLEEVES[worn.sleeves], TROUSERS[worn.legs]


@functools.cache
def drape(level: int) -> Drape:
    """Return the cloth of a level of detail, made from the shape of the mannequin.

    >>> cloth = drape(2)
    >>> cloth.shift.shape, [round(float(abs(cut).max()), 3) for cut in cloth.shift]
    ((3, 447, 3), [0.0, 0.067, 0.016])
    """
    mesh = shapes().levels[level]
    region = mesh.vertex_region
    group = np.zeros(len(region), dtype=np.int64)
    group[_of(region, "upperarm", "forearm")] = ARMS
    group[_of(region, "bottom", "shin")] = LEGS
    shift = np.zeros((3, len(region), 3))
    shift[LONG] = _legs(mesh, "bottom", "shin") + _sleeves(mesh, "top", "upperarm", "forearm") + _shirt(mesh)
    shift[SHORT] = _legs(mesh, "bottom") + _sleeves(mesh, "top", "upperarm")
    return Drape(shift, group, float(shapes().levels[0].rest[-1, :, 2].max()))


@functools.cache
def bare(vertices: int) -> Drape:
    """Return no cloth on a mesh with this number of vertices."""
    return Drape(np.zeros((1, vertices, 3)), np.zeros(vertices, dtype=np.int64), 1.0)


def _of(region: Ints, *names: str) -> Bools:
    return np.isin(region, [shapes().regions.index(name) for name in names])


def _hem(mesh: Level, *names: str) -> tuple[Bools, Bools, float]:
    """Return the inner vertices ``[V]`` of regions, those next to other regions, and the height [m] of that line."""
    cloth = _of(mesh.face_region, *names)
    inside = np.zeros(len(mesh.vertex_region), dtype=np.bool_)
    inside[mesh.faces[cloth]] = True
    line = np.zeros_like(inside)
    line[mesh.faces[~cloth]] = True
    line &= inside
    hem = np.zeros_like(inside)
    hem[mesh.faces[cloth & line[mesh.faces].any(axis=1)]] = True
    height = float(np.max(mesh.rest[-1][line, 2], initial=0.0))
    return inside & ~line, hem & ~line & (mesh.rest[-1][:, 2] < height + REACH), height


def _rise(value: Floats, low: float, high: float) -> Floats:
    """Return 0 at ``low`` and 1 at ``high``, smooth between."""
    share = np.clip((value - low) / (high - low), 0.0, 1.0)
    return np.asarray(share * share * (3.0 - 2.0 * share))


def _middle(points: Floats, height: Floats, columns: list[int]) -> Floats:
    """Return the middle of the cross-section of ``points`` at each height [m], in some columns."""
    rows = np.arange(points[:, 2].min(), points[:, 2].max(), 0.02)
    near = [points[np.abs(points[:, 2] - row) < 0.025][:, columns] for row in rows]
    middle = np.array([0.5 * (part.min(axis=0) + part.max(axis=0)) for part in near])
    smooth = np.apply_along_axis(lambda c: np.convolve(np.pad(c, 2, "edge"), np.full(5, 0.2), "valid"), 0, middle)
    return np.stack([np.interp(height, rows, column) for column in smooth.T], axis=-1)


def _legs(mesh: Level, *names: str) -> Floats:
    """Return how trousers ``[V, 3]`` [m] move the vertices: straight tubes below the knee, wide hems of shorts."""
    place, fine = mesh.rest[-1], shapes().levels[0]
    inside, hem, line = _hem(mesh, *names)
    moved: Floats = np.zeros_like(place)
    for side in (1.0, -1.0):
        leg = fine.rest[-1][_of(fine.vertex_region, "bottom", "shin")]
        here = np.flatnonzero(inside & (side * place[:, 1] > 0.0) & _of(mesh.vertex_region, "bottom", "shin"))
        x, y, z = place[here].T
        away = np.stack([x, y], axis=-1) - _middle(leg[side * leg[:, 1] > 0.0], z, [0, 1])
        radius = np.linalg.norm(away, axis=1)
        more = EASE * _rise(-z, -0.86, -0.76)
        more = np.maximum(more, (TUBE - radius) * _rise(-z, -0.56, -0.46))
        if len(names) == 1:
            more += FLARE * _rise(-z, -0.78, -0.60)
        inward = side * away[:, 1] < 0.0
        more = np.where(inward, more * _rise(-z, -0.80, -0.62), more)
        more = np.where(away[:, 0] < 0.0, more * (1.0 - SEAT * _rise(z, 0.58, 0.66)), more)
        moved[here, :2] = away / np.maximum(radius, 1e-9)[:, None] * more[:, None]
        moved[here, 2] = np.where(hem[here], np.minimum(line - OVERLAP - z, 0.0), 0.0)
    return moved


def _sleeves(mesh: Level, *names: str) -> Floats:
    """Return how sleeves ``[V, 3]`` [m] move the vertices of the arms."""
    every, place = shapes(), mesh.rest[-1]
    inside, hem, _ = _hem(mesh, *names)
    moved: Floats = np.zeros_like(place)
    for side in "lr":
        shoulder, elbow, wrist = (every.head[-1][every.bone(f"{name}_{side}")] for name in
                                  ("upperarm", "lowerarm", "hand"))  # fmt: skip
        left = place[:, 1] > 0.0
        here = np.flatnonzero(inside & (left == (side == "l")) & _of(mesh.vertex_region, "upperarm", "forearm"))
        off = place[here] - shoulder
        upper, lower = elbow - shoulder, wrist - elbow
        along = np.clip(off @ upper / (upper @ upper), 0.0, 1.0)
        further = np.clip((place[here] - elbow) @ lower / (lower @ lower), 0.0, 1.0)
        away = off - along[:, None] * upper - further[:, None] * lower
        away /= np.maximum(np.linalg.norm(away, axis=1), 1e-9)[:, None]
        more = EASE * _rise(along, 0.1, 0.5) * (1.0 - 0.6 * _rise(further, 0.7, 1.0))
        if len(names) == 2:
            more += FLARE * _rise(along, 0.15, 0.6)
        moved[here] = more[:, None] * away
        moved[here] += np.where(hem[here], OVERLAP, 0.0)[:, None] * upper / np.linalg.norm(upper)
    return moved


def _shirt(mesh: Level) -> Floats:
    """Return how a shirt ``[V, 3]`` [m] moves the vertices of the trunk: it hangs from the chest over the hips."""
    place, fine = mesh.rest[-1], shapes().levels[0]
    trunk = fine.rest[-1][_of(fine.vertex_region, "top")]
    trunk = trunk[np.abs(trunk[:, 1]) < 0.188]
    here = np.flatnonzero(_of(mesh.vertex_region, "top"))
    z = place[here, 2]
    angle, radius, away = _around(trunk, place[here])
    hull = np.zeros_like(radius)
    for height, share in ((1.20, _rise(z, 0.88, 1.20)), (0.885, 1.0 - _rise(z, 0.88, 1.20))):
        ring = trunk[np.abs(trunk[:, 2] - height) < 0.03]
        turn, wide, _ = _around(trunk, ring)
        order = np.argsort(turn)
        hull += share * np.interp(angle, turn[order], wide[order], period=2.0 * np.pi)
    more = np.maximum(HANG * (hull - radius) * _rise(-z, -1.22, -1.12), 0.0)
    more += EASE * _rise(-z, -1.38, -1.20) + 0.5 * EASE * _rise(-z, -0.98, -0.88)
    moved: Floats = np.zeros_like(place)
    moved[here, :2] = more[:, None] * away
    moved[here, 2] = -OVERLAP * _rise(-z, -0.93, -0.88)
    return moved


def _around(trunk: Floats, points: Floats) -> tuple[Floats, Floats, NDArray[np.float64]]:
    """Return angle [rad], distance [m] and direction ``[N, 2]`` of points from the middle of the trunk."""
    off = points[:, :2] - np.stack([_middle(trunk, points[:, 2], [0])[:, 0], np.zeros(len(points))], axis=-1)
    far = np.linalg.norm(off, axis=1)
    return np.arctan2(off[:, 1], off[:, 0]), far, off / np.maximum(far, 1e-9)[:, None]
