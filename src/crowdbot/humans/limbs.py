"""Limbs of people as capsules, and their effective mass in a contact."""

from __future__ import annotations

import functools
from typing import NamedTuple

import numpy as np

from crowdbot.typing import Floats, Ints

from .asset import Shapes, persons, shapes

ROUNDS = 12
"""Number of fit iterations; about 10 converge to 0.1 mm."""
HOLD = 0.02
"""Weight of the initial guess in the fit, which bounds capsule ends without nearby vertices."""


class Limb(NamedTuple):
    """One capsule: its bone, the bones whose skin it approximates, its region and its axis.

    ``along`` is the bone at whose head the capsule ends, empty for the bone's own tail, or ``across`` for the trunk.
    """

    name: str
    bone: str
    skin: tuple[str, ...]
    region: str
    along: str = ""


def _side_limbs(s: str) -> tuple[Limb, ...]:
    fingers = (f"hand_{s}", f"fingers_01_{s}", f"fingers_02_{s}", f"thumb_{s}")
    return (
        Limb(f"upperarm_{s}", f"upperarm_{s}", (f"upperarm_{s}",), "arm", f"lowerarm_{s}"),
        Limb(f"forearm_{s}", f"lowerarm_{s}", (f"lowerarm_{s}",), "arm", f"hand_{s}"),
        Limb(f"hand_{s}", f"hand_{s}", fingers, "arm", f"fingers_02_{s}"),
        Limb(f"thigh_{s}", f"thigh_{s}", (f"thigh_{s}",), "leg", f"calf_{s}"),
        Limb(f"shank_{s}", f"calf_{s}", (f"calf_{s}",), "leg", f"foot_{s}"),
        Limb(f"foot_{s}", f"foot_{s}", (f"foot_{s}", f"ball_{s}"), "leg", f"ball_{s}"),
    )


LIMBS: tuple[Limb, ...] = (
    Limb("pelvis", "pelvis", ("pelvis",), "torso", "across"),
    Limb("abdomen", "spine_01", ("spine_01", "spine_02"), "torso", "across"),
    Limb("chest", "spine_03", ("spine_03", "clavicle_l", "clavicle_r"), "torso", "across"),
    Limb("neck", "neck_01", ("neck_01",), "head", "head"),
    Limb("head", "head", ("head",), "head"),
    *_side_limbs("l"),
    *_side_limbs("r"),
)
REGIONS = ("head", "torso", "arm", "leg")

SHARES = {  # percent of body mass: men, women (de Leva 1996, who combines neck and head)
    "head": (6.94, 6.68),
    "chest": (15.96, 15.45),
    "abdomen": (16.33, 14.65),
    "pelvis": (11.17, 12.47),
    "upperarm": (2.71, 2.55),
    "forearm": (1.62, 1.38),
    "hand": (0.61, 0.56),
    "thigh": (14.16, 14.78),
    "shank": (4.33, 4.81),
    "foot": (1.37, 1.29),
}
NECK = 0.15
"""Fraction of the neck in the mass of head and neck (about its volume fraction in the included bodies)."""


def mass_shares(sex: str) -> Floats:
    """Return the fraction of body mass of each limb, in the order of :data:`LIMBS`; the sum is 1.

    Without a sex, the mean of men and women is used.

    Source: Paolo de Leva, "Adjustments to Zatsiorsky-Seluyanov's segment inertia parameters", Journal of Biomechanics
    29(9), 1996, table 4, doi:10.1016/0021-9290(95)00178-6.

    >>> shares = mass_shares("f")
    >>> round(float(shares.sum()), 9), round(float(shares[0]), 3)
    (1.0, 0.125)
    """
    pick = {"m": (1.0, 0.0), "f": (0.0, 1.0)}.get(sex, (0.5, 0.5))
    whole = {part: men * pick[0] + women * pick[1] for part, (men, women) in SHARES.items()}
    whole["neck"] = NECK * whole["head"]
    whole["head"] -= whole["neck"]
    shares = np.array([whole[limb.name.split("_")[0]] for limb in LIMBS])
    return np.asarray(shares / shares.sum())


@functools.cache
def rest_capsules() -> Floats:
    """Return the capsules of each body at rest, ``[P, L, 7]``: start, end, radius [m].

    Each capsule is a least-squares fit of its surface to the skin of its bones (finest level of detail, without hair
    and skirt): the skin is inside and outside of it in about equal parts.
    """
    every = shapes()
    out = np.empty((len(persons()), len(LIMBS), 7))
    for k, limb in enumerate(LIMBS):
        out[:, k] = fit_capsules(limb, every.head, every.tail, _skin_vertices(every, limb))
    return out


def fit_capsules(limb: Limb, heads: Floats, tails: Floats, points: Floats) -> Floats:
    """Return the capsule of a limb of P bodies at rest, ``[P, 7]``: start, end, radius [m].

    Args:
        limb: the limb.
        heads, tails: start and end of each bone ``[P, B, 3]`` [m].
        points: vertices of the skin of the limb ``[P, V, 3]`` [m].
    """
    return _fit(points, *_ends(limb, heads, tails, points))


def main_bones(bones: Ints, weights: Floats) -> Ints:
    """Return the bone with the largest weight of each vertex, from ``bones`` and ``weights [V, 4]``."""
    return np.asarray(bones[np.arange(len(bones)), np.argmax(weights, axis=1)])


def _ends(limb: Limb, heads: Floats, tails: Floats, points: Floats) -> tuple[Floats, Floats]:
    """Return the initial guess of both ends, ``[P, 3]``."""
    every = shapes()
    head, tail = heads[:, every.bone(limb.bone)], tails[:, every.bone(limb.bone)]
    if limb.along == "across":
        middle = points.mean(axis=1)
        aside = np.array([0.0, 0.25 * 0.2, 0.0])
        return middle - aside, middle + aside
    if limb.along == "":
        return head + 0.35 * (tail - head), head + 0.55 * (tail - head)
    goal = heads[:, every.bone(limb.along)]
    return head + 0.15 * (goal - head), head + 0.85 * (goal - head)


def _skin_vertices(every: Shapes, limb: Limb) -> Floats:
    level = every.levels[0]
    worn = np.isin(level.vertex_part, [every.parts.index(p) for p in ("skin", "top", "legs")])
    main = main_bones(level.bones, level.weights)
    return level.rest[:, worn & np.isin(main, [every.bone(b) for b in limb.skin])]


def _fit(points: Floats, start: Floats, end: Floats) -> Floats:
    """Fit capsules with Gauss-Newton on ``distance to the axis - radius``, regularised to the initial guess."""
    gap = _project_on_axis(points, start, end)[1]
    guess = np.concatenate([start, end, np.sqrt((gap**2).sum(-1)).mean(axis=1)[:, None]], axis=1)
    hold = np.diag([HOLD] * 6 + [1e-6])
    value = guess.copy()
    for _ in range(ROUNDS):
        t, gap = _project_on_axis(points, value[:, :3], value[:, 3:6])
        distance = np.sqrt((gap**2).sum(-1))
        normal = gap / np.maximum(distance, 1e-9)[..., None]
        slope = np.concatenate([-(1.0 - t)[..., None] * normal, -t[..., None] * normal, -np.ones_like(t)[..., None]], 2)
        residual = distance - value[:, 6:]
        count = points.shape[1]
        normal_matrix = np.einsum("pvi,pvj->pij", slope, slope) / count + hold
        right = np.einsum("pvi,pv->pi", slope, residual) / count + (value - guess) @ hold
        value = value - np.linalg.solve(normal_matrix, right[..., None])[..., 0]
        value[:, 6] = np.maximum(value[:, 6], 0.01)
    return value


def _project_on_axis(points: Floats, start: Floats, end: Floats) -> tuple[Floats, Floats]:
    """Return the nearest position on the axis (0 to 1) and the vector from there to each point."""
    axis = end - start
    length2 = np.maximum((axis**2).sum(-1), 1e-12)
    t = np.clip(np.einsum("pvi,pi->pv", points - start[:, None], axis) / length2[:, None], 0.0, 1.0)
    return t, points - (start[:, None] + t[..., None] * axis[:, None])


CHAINS = (("pelvis", "thigh", "shank", "foot"), ("chest", "upperarm", "forearm", "hand"))
NAMES = tuple(limb.name for limb in LIMBS)


def limb_chain(limb: str) -> tuple[str, ...]:
    """Return the limbs of the arm or leg of a limb, from the trunk outwards; empty for trunk and head.

    >>> limb_chain("foot_l"), limb_chain("head")
    (('thigh_l', 'shank_l', 'foot_l'), ())
    """
    stem, _, side = limb.partition("_")
    return next((tuple(f"{name}_{side}" for name in chain[1:]) for chain in CHAINS if stem in chain[1:]), ())


def striking_mass(start: Floats, end: Floats, mass: Floats, limb: str, share: float, normal: Floats) -> float:
    """Return the mass [kg] that a limb has in an impact at one of its points.

    Arms and legs are chains of rods on joints without torque, since an impact is shorter than the reaction of muscles;
    the first rod hangs on the rest of the body. So a foot that swings ahead has its own mass and a part of that of the
    shank. Trunk and head have the mass of their own segment.

    Args:
        start, end: ends of the limbs ``[L, 3]`` [m], in the order of :data:`LIMBS`.
        mass: masses of the limbs ``[L]`` [kg].
        limb: name of the limb that strikes.
        share: where on the limb, from 0 at ``start`` to 1 at ``end``.
        normal: unit vector ``[3]`` of the impact.

    >>> from crowdbot.humans import Gait, People
    >>> people = People.of(["man-36"])
    >>> gait = Gait(people, 0)
    >>> state = gait.start(np.zeros((1, 2)), np.zeros(1), np.zeros((1, 2)))
    >>> found = people.limbs(gait.posture(state))
    >>> one = found.start[0], found.end[0], people.limb_mass[0]
    >>> ahead = np.array([1.0, 0.0, 0.0])
    >>> [round(striking_mass(*one, name, 0.5, ahead), 1) for name in ("foot_l", "thigh_l", "hand_l")]
    [1.6, 16.2, 0.5]
    """
    chain = limb_chain(limb)
    if not chain:
        return float(mass[NAMES.index(limb)])
    rows = [NAMES.index(name) for name in chain]
    points = _joints(start[rows], end[rows])
    struck = chain.index(limb)
    place = points[struck] + share * (points[struck + 1] - points[struck])
    rest = max(float(mass.sum() - mass[rows].sum()), 1e-3)
    return _chain_mass(points, mass[rows], rest, struck, place, normal)


def _joints(start: Floats, end: Floats) -> Floats:
    """Return the joints ``[R + 1, 3]`` of a chain of R rods: neighbouring ends of the limbs meet halfway."""
    points = np.concatenate([start, end[-1:]])
    points[1:-1] = 0.5 * (start[1:] + end[:-1])
    return np.asarray(points)


def _chain_mass(points: Floats, mass: Floats, rest: float, struck: int, place: Floats, normal: Floats) -> float:
    """Return the effective mass of a chain of rods between ``points``, of which the first hangs on a mass ``rest``.

    The unknowns are the velocity changes by a unit impulse: of the rest of the body, and velocity of the centre and
    rotation of each rod. The multipliers are the impulses in the joints.
    """
    count = len(mass)
    size, joints = 3 + 6 * count, 3 * count
    matrix = np.zeros((size + joints, size + joints))
    right = np.zeros(size + joints)
    matrix[:3, :3] = rest * np.eye(3)
    for k in range(count):
        rod = points[k + 1] - points[k]
        first = 3 + 6 * k
        matrix[first : first + 3, first : first + 3] = mass[k] * np.eye(3)
        inertia = mass[k] / 12.0 * (rod @ rod * np.eye(3) - np.outer(rod, rod)) + 1e-6 * np.eye(3)
        matrix[first + 3 : first + 6, first + 3 : first + 6] = inertia
        row = size + 3 * k
        link = np.zeros((3, size))
        link[:, first : first + 3], link[:, first + 3 : first + 6] = np.eye(3), _cross(-0.5 * rod)
        if k:
            before = points[k] - points[k - 1]
            link[:, first - 6 : first - 3], link[:, first - 3 : first] = -np.eye(3), -_cross(0.5 * before)
        else:
            link[:, :3] = -np.eye(3)
        matrix[row : row + 3, :size], matrix[:size, row : row + 3] = link, link.T
    first, center = 3 + 6 * struck, 0.5 * (points[struck] + points[struck + 1])
    right[first : first + 3], right[first + 3 : first + 6] = normal, np.cross(place - center, normal)
    change = np.linalg.solve(matrix, right)
    return 1.0 / max(float(right[:size] @ change[:size]), 1e-9)


def _cross(arm: Floats) -> Floats:
    """Return the matrix that maps a rotation to the velocity of the end of an arm."""
    x, y, z = arm.tolist()
    return np.array([[0.0, z, -y], [-z, 0.0, x], [y, -x, 0.0]])
