"""Effective mass of a limb that strikes something, from its joints and the masses of its segments."""

from __future__ import annotations

import numpy as np

from crowdbot.typing import Floats

from .limbs import LIMBS

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
