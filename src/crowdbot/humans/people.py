"""A group of N persons with clothes, capsules and skins."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError

from .asset import LEVELS, shapes
from .limbs import LIMBS, mass_shares, rest_capsules
from .measures import Measures, measures
from .person import Person, drawable, person
from .posture import Posture
from .skin import skin_vertices
from .wardrobe import Outfit, outfit, region_colors, worn_parts

__all__ = ["Capsules", "People"]

Floats = NDArray[np.float64]
Ints = NDArray[np.int64]
SMALLEST, TALLEST = 0.5, 2.5
"""Allowed statures [m]."""


@dataclass(frozen=True)
class Capsules:
    """Limbs of N people: ``start`` and ``end`` ``[N, L, 3]`` [m] and ``radius`` ``[N, L]`` [m], as in ``LIMBS``."""

    start: Floats
    end: Floats
    radius: Floats


@dataclass(frozen=True, eq=False)
class People:
    """N persons, each with a numbered outfit and scaled to a stature.

    Fields: ``persons``, ``variation [N]``, ``height [N]`` [m].

    >>> people = People.of(["woman-36", "man-20", "mannequin"], variation=[0, 7, 0], height=[1.6, 1.7, 1.8])
    >>> people.mass.round(1).tolist(), people.faces(2).shape
    ([53.9, 59.7, 76.3], (739, 3))
    """

    persons: tuple[Person, ...]
    variation: Ints
    height: Floats

    @classmethod
    def of(cls, names: Sequence[str], variation: ArrayLike = 0, height: ArrayLike | None = None) -> People:
        """Return the persons of these names.

        Args:
            names: as in :func:`crowdbot.humans.names`; a name may come often.
            variation: number of the outfit, for all or for each; any whole number from 0.
            height: stature [m], for all or for each; None takes that of the person.

        Raises:
            UnknownName: there is no person of a name.
            InputError: a number of values does not fit, a variation is below 0, or a stature is not 0.5 to 2.5 m.
        """
        if isinstance(names, str):
            raise InputError(f"People.of takes a list of names, as [{names!r}], not the text {names!r}")
        found = tuple(person(name) for name in names)
        own = np.array([p.height for p in found], dtype=np.float64)
        tall = own if height is None else _each("height", height, len(found))
        bad = ~((tall >= SMALLEST) & (tall <= TALLEST))
        if np.any(bad):
            raise InputError(f"height {tall[bad][0]} m of a person is not {SMALLEST} to {TALLEST} m")
        number = _each("variation", variation, len(found))
        if np.any(~(number >= 0) | (number != np.floor(number))):
            raise InputError(
                f"variation {number[~(number >= 0) | (number != np.floor(number))][0]} is not a whole number from 0"
            )
        return cls(found, number.astype(np.int64), tall.copy())

    @classmethod
    def sample(cls, count: int, rng: np.random.Generator, kinds: Sequence[str] = ("man", "woman")) -> People:
        """Return ``count`` persons, drawn by ``rng`` with their outfits.

        Args:
            count: N.
            rng: of the draw.
            kinds: among ``man``, ``woman``, ``boy``, ``girl`` and ``mannequin``.

        Raises:
            InputError: nobody is of these kinds.
        """
        pool = drawable(kinds)
        if not pool:
            raise InputError(f"nobody is of the kinds {', '.join(kinds)}; take man, woman, boy, girl or mannequin")
        chosen = rng.integers(len(pool), size=count)
        return cls.of([pool[k].name for k in chosen], rng.integers(1000, size=count))

    def __len__(self) -> int:
        """Return N."""
        return len(self.persons)

    @functools.cached_property
    def body(self) -> Ints:
        """``[N]``, the row of each person in the file of shapes."""
        return np.array([p.index for p in self.persons], dtype=np.int64)

    @functools.cached_property
    def scale(self) -> Floats:
        """``[N]``, stature over that of the shape."""
        return np.asarray(self.height / np.array([p.height for p in self.persons], dtype=np.float64))

    @functools.cached_property
    def measures(self) -> Measures:
        """Lengths of the bodies [m]."""
        return measures(self.body, self.scale, self.height)

    @functools.cached_property
    def mass(self) -> Floats:
        """``[N]`` [kg], that of the shape times the cube of the scale."""
        return np.array([p.mass for p in self.persons]) * self.scale**3

    @functools.cached_property
    def limb_mass(self) -> Floats:
        """``[N, L]`` [kg], mass of every limb (de Leva 1996)."""
        shares = np.array([mass_shares(p.sex) for p in self.persons]).reshape(len(self), len(LIMBS))
        return np.asarray(self.mass[:, None] * shares)

    @functools.cached_property
    def outfits(self) -> tuple[Outfit, ...]:
        """Outfit of each person."""
        return tuple(outfit(p, int(v)) for p, v in zip(self.persons, self.variation, strict=True))

    def limbs(self, posture: Posture) -> Capsules:
        """Return the capsules of everyone in the world."""
        bones = [shapes().bone(limb.bone) for limb in LIMBS]
        rest = rest_capsules()[self.body] * self.scale[:, None, None]
        turn, place = posture.rotation[:, bones], posture.position[:, bones]
        head = self.measures.head[:, bones]

        def placed(points: Floats) -> Floats:
            return np.asarray(place + np.einsum("nlij,nlj->nli", turn, points - head))

        return Capsules(placed(rest[..., :3]), placed(rest[..., 3:6]), rest[..., 6].copy())

    def skin(self, posture: Posture, level: int = 2) -> Floats:
        """Return the vertices ``[N, V, 3]`` [m] of skin and clothes, parts that are not worn included.

        Args:
            posture: of the same people.
            level: of detail, 0 (4198 vertices) to 2 (447 vertices).
        """
        return skin_vertices(
            shapes().levels[_level(level)],
            self.body,
            self.scale,
            self.measures.head,
            posture.rotation,
            posture.position,
        )

    def faces(self, level: int = 2) -> Ints:
        """Return the triangles ``[F, 3]`` as indices of vertices, counter-clockwise seen from outside."""
        return shapes().levels[_level(level)].faces

    def clothing_mask(self, level: int = 2) -> NDArray[np.bool_]:
        """Return ``[N, F]``, whether the triangle belongs to what the person wears."""
        part = shapes().levels[_level(level)].face_part
        return np.array([np.isin(part, worn_parts(o)) for o in self.outfits]).reshape(len(self), len(part))

    def face_colors(self, level: int = 2) -> Floats:
        """Return ``[N, F, 3]``, red, green and blue from 0 to 1 of every triangle."""
        region = shapes().levels[_level(level)].face_region
        return np.array([region_colors(o)[region] for o in self.outfits]).reshape(len(self), len(region), 3)

    def vertex_colors(self, level: int = 2) -> Floats:
        """Return ``[N, V, 3]``, red, green and blue from 0 to 1 of every vertex (hems are sharper by triangle)."""
        region = shapes().levels[_level(level)].vertex_region
        return np.array([region_colors(o)[region] for o in self.outfits]).reshape(len(self), len(region), 3)


def _level(level: int) -> int:
    if level not in range(LEVELS):
        raise InputError(f"level of detail {level} is not 0 to {LEVELS - 1}")
    return int(level)


def _each(name: str, value: ArrayLike, count: int) -> Floats:
    array = np.asarray(value, dtype=np.float64)
    if array.shape not in ((), (count,)):
        raise InputError(
            f"{name} has shape {list(array.shape)}, it must be one number or one for each of {count} people"
        )
    return np.broadcast_to(array, (count,))
