"""A group of N persons with clothes, capsules and skins."""

from __future__ import annotations

import functools
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from crowdbot.core import InputError, kernel
from crowdbot.typing import Floats, Ints

from .activities import ACTIVITIES
from .asset import LEVELS, Level, Person, drawable, person, persons, shapes
from .clip import Clip
from .garments import Drape, bare, drape, garment_cuts
from .limbs import LIMBS, mass_shares
from .posture import Measures, Posture, measures
from .rigged.body_rows import BodyRows, body_rows
from .rigged.rigged_body import RiggedBody
from .wardrobe import Outfit, outfit, region_colors, worn_parts


class SkinnedMesh(NamedTuple):
    """Rest shapes ``rest [P, V, 3]`` [m] of one topology, with ``bones [V, 4]`` and ``weights [V, 4]`` (sum 1)."""

    rest: Floats
    bones: Ints
    weights: Floats


@kernel
def _skin(
    rest: Floats, bones: Ints, weights: Floats, body: Ints, scale: Floats, rotation: Floats, shift: Floats,
    cloth: Floats, group: Ints, cuts: Ints, size: Floats, out: Floats,
) -> None:  # fmt: skip
    """Write ``sum_k w_k (R_k x + t_k)`` for each vertex x of each person, in clothes."""
    for i in range(len(out)):
        for v in range(bones.shape[0]):
            cut = cuts[i, group[v]]
            x = rest[body[i], v, 0] * scale[i] + cloth[cut, v, 0] * size[i]
            y = rest[body[i], v, 1] * scale[i] + cloth[cut, v, 1] * size[i]
            z = rest[body[i], v, 2] * scale[i] + cloth[cut, v, 2] * size[i]
            sx, sy, sz = 0.0, 0.0, 0.0
            for k in range(bones.shape[1]):
                w = weights[v, k]
                if w == 0.0:
                    continue
                b = bones[v, k]
                r = rotation[i, b]
                sx += w * (r[0, 0] * x + r[0, 1] * y + r[0, 2] * z + shift[i, b, 0])
                sy += w * (r[1, 0] * x + r[1, 1] * y + r[1, 2] * z + shift[i, b, 1])
                sz += w * (r[2, 0] * x + r[2, 1] * y + r[2, 2] * z + shift[i, b, 2])
            out[i, v, 0], out[i, v, 1], out[i, v, 2] = sx, sy, sz


def skin_vertices(
    mesh: SkinnedMesh, cloth: Drape, cuts: Ints, size: Floats, body: Ints, scale: Floats, head: Floats,
    rotation: Floats, position: Floats,
) -> Floats:  # fmt: skip
    """Return the vertices ``[N, V, 3]`` [m] of posed people.

    Args:
        mesh: rest shapes and weights.
        cloth: how far clothes hang off the mesh.
        cuts: cut of each group of vertices ``[N, G]``.
        size: ratio of stature to that of ``cloth`` ``[N]``.
        body: row of the rest shape ``[N]``.
        scale: ratio of stature to that of the rest shape ``[N]``.
        head: scaled start of each bone at rest ``[N, B, 3]`` [m].
        rotation, position: current rotation ``[N, B, 3, 3]`` and position ``[N, B, 3]`` [m] of each bone.
    """
    shift = position - np.einsum("nbij,nbj->nbi", rotation, head)
    out = np.empty((len(body), len(mesh.bones), 3))
    _skin(
        mesh.rest, mesh.bones, mesh.weights, body, scale, rotation, shift, cloth.shift, cloth.group, cuts, size, out
    )  # fmt: skip
    return out


SMALLEST, TALLEST = 0.5, 2.5
"""Allowed statures [m]."""


@dataclass(frozen=True)
class Capsules:
    """Limbs of N people in the order of ``LIMBS``: ``start`` and ``end [N, L, 3]`` [m], ``radius [N, L]`` [m]."""

    start: Floats
    end: Floats
    radius: Floats


@dataclass(frozen=True, eq=False)
class People:
    """N persons, each with an outfit number and scaled to a stature.

    Fields: ``persons``, ``variation [N]``, ``height [N]`` [m]; ``clips``: activities beside the built-in ones;
    ``own``: imported bodies, whose rows follow those of the asset.

    >>> people = People.of(["woman-36", "man-20", "mannequin"], variation=[0, 7, 0], height=[1.6, 1.7, 1.8])
    >>> people.mass.round(1).tolist(), people.faces(2).shape
    ([53.9, 59.7, 76.3], (739, 3))
    """

    persons: tuple[Person, ...]
    variation: Ints
    height: Floats
    clips: tuple[Clip, ...] = ()
    own: tuple[RiggedBody, ...] = ()

    @classmethod
    def of(
        cls,
        names: Sequence[str],
        variation: ArrayLike = 0,
        height: ArrayLike | None = None,
        own: Sequence[RiggedBody] = (),
    ) -> People:
        """Return the persons with these names.

        Args:
            names: names as in :func:`crowdbot.humans.names`; they may be repeated.
            variation: number of the outfit, for all or for each; a whole number, at least 0.
            height: stature [m], for all or for each (default: that of the person).
            own: imported bodies that ``names`` may also contain.

        Raises:
            UnknownName: there is no person with this name.
            InputError: the number of values is wrong, a variation is negative, or a stature is not from 0.5 to 2.5 m.
        """
        if isinstance(names, str):
            raise InputError(f"People.of takes a list of names, as [{names!r}], not the text {names!r}")
        first = len(persons())
        extra = {item.name: Person(item.name, "", 0, item.height, item.mass, first + k) for k, item in enumerate(own)}
        found = tuple(extra[name] if name in extra else person(name) for name in names)
        usual = np.array([p.height for p in found], dtype=np.float64)
        tall = usual if height is None else _per_person("height", height, len(found))
        bad = ~((tall >= SMALLEST) & (tall <= TALLEST))
        if np.any(bad):
            raise InputError(f"height {tall[bad][0]} m of a person must be from {SMALLEST} to {TALLEST} m")
        number = _per_person("variation", variation, len(found))
        if np.any(~(number >= 0) | (number != np.floor(number))):
            raise InputError(
                f"variation {number[~(number >= 0) | (number != np.floor(number))][0]} must be a whole number,"
                " at least 0"
            )
        return cls(found, number.astype(np.int64), tall.copy(), (), tuple(own))

    @classmethod
    def sample(cls, count: int, rng: np.random.Generator, kinds: Sequence[str] = ("man", "woman")) -> People:
        """Return ``count`` random persons with random outfits.

        Args:
            count: number of persons.
            rng: random generator.
            kinds: any of ``man``, ``woman``, ``boy``, ``girl`` and ``mannequin``.

        Raises:
            InputError: there is no person of these kinds.
        """
        pool = drawable(kinds)
        if not pool:
            raise InputError(
                f"there is no person of the kinds {', '.join(kinds)}; choose man, woman, boy, girl or mannequin"
            )
        chosen = rng.integers(len(pool), size=count)
        return cls.of([pool[k].name for k in chosen], rng.integers(1000, size=count))

    def __len__(self) -> int:
        """Return the number of people."""
        return len(self.persons)

    @functools.cached_property
    def activities(self) -> tuple[str, ...]:
        """Names of all activities: the built-in ones and those of the clips."""
        return (*ACTIVITIES, *(clip.name for clip in self.clips))

    @functools.cached_property
    def body(self) -> Ints:
        """Row of each person in :attr:`rows` ``[N]``: that in the asset, or after it for imported bodies."""
        return np.array([p.index for p in self.persons], dtype=np.int64)

    @functools.cached_property
    def rows(self) -> BodyRows:
        """Bodies at rest: those of the asset, then imported ones."""
        return body_rows(self.own)

    @functools.cached_property
    def own_body(self) -> Ints:
        """Number of the imported body of each person in ``own`` ``[N]``, -1 for included ones."""
        return np.maximum(self.body - len(persons()), -1)

    @functools.cached_property
    def asset_rows(self) -> tuple[Ints, Floats]:
        """Row in the asset ``[N]`` and scale ``[N]`` of each person, of the mannequin instead of imported bodies."""
        mannequin = persons()[-1]
        own = self.own_body >= 0
        scale = np.where(own, self.height / mannequin.height, self.scale)
        return np.where(own, mannequin.index, self.body), scale

    @functools.cached_property
    def scale(self) -> Floats:
        """Ratio of stature to that of the rest shape ``[N]``."""
        return np.asarray(self.height / np.array([p.height for p in self.persons], dtype=np.float64))

    @functools.cached_property
    def measures(self) -> Measures:
        """Lengths of the bodies [m]."""
        return measures(self.rows.head[self.body], self.rows.sole[self.body], self.scale, self.height)

    @functools.cached_property
    def mass(self) -> Floats:
        """Mass ``[N]`` [kg]: mass of the rest shape times the cube of the scale."""
        return np.array([p.mass for p in self.persons]) * self.scale**3

    @functools.cached_property
    def limb_mass(self) -> Floats:
        """Mass of each limb ``[N, L]`` [kg] (de Leva 1996)."""
        shares = np.array([mass_shares(p.sex) for p in self.persons]).reshape(len(self), len(LIMBS))
        return np.asarray(self.mass[:, None] * shares)

    @functools.cached_property
    def outfits(self) -> tuple[Outfit, ...]:
        """Outfit of each person."""
        return tuple(outfit(p, int(v)) for p, v in zip(self.persons, self.variation, strict=True))

    @functools.cached_property
    def cuts(self) -> Ints:
        """Cut of shirt, sleeves and trousers of each person ``[N, 3]``; imported bodies have none."""
        cuts = np.array([garment_cuts(worn) for worn in self.outfits], dtype=np.int64).reshape(len(self), 3)
        return np.where(self.own_body[:, None] >= 0, 0, cuts)

    def limbs(self, posture: Posture) -> Capsules:
        """Return the capsules of all people in world coordinates."""
        bones = [shapes().bone(limb.bone) for limb in LIMBS]
        rest = self.rows.capsules[self.body] * self.scale[:, None, None]
        turn, place = posture.rotation[:, bones], posture.position[:, bones]
        head = self.measures.head[:, bones]

        def transform(points: Floats) -> Floats:
            return np.asarray(place + np.einsum("nlij,nlj->nli", turn, points - head))

        return Capsules(transform(rest[..., :3]), transform(rest[..., 3:6]), rest[..., 6].copy())

    def skin(self, posture: Posture, level: int = 2, numbers: Ints | None = None) -> Floats:
        """Return the vertices ``[N, V, 3]`` [m] of skin and clothes, including parts that are not worn.

        Args:
            posture: posture of these people.
            level: level of detail, from 0 (4198 vertices) to 2 (447 vertices). Clothes hang off the body at each.
            numbers: only these people (default: all).
        """
        whole = np.arange(len(self)) if numbers is None else numbers
        mesh = self.mesh(level)
        if not self.own:
            common = mesh.included
            return self._skin(whole, SkinnedMesh(common.rest, common.bones, common.weights), drape(level), posture)
        result = np.zeros((len(whole), mesh.points[-1], 3))
        for k in range(-1, len(self.own)):
            rows = np.flatnonzero(self.own_body[whole] == k)
            own = mesh.included if k < 0 else self.own[k].levels[level]
            rest = own.rest if k < 0 else own.rest[None]
            if len(rows):
                skinned = SkinnedMesh(rest, own.bones, own.weights)
                cloth = drape(level) if k < 0 else bare(rest.shape[1])
                result[rows, mesh.vertex_span(k)] = self._skin(whole[rows], skinned, cloth, posture)
        return result

    def _skin(self, rows: Ints, mesh: SkinnedMesh, cloth: Drape, posture: Posture) -> Floats:
        body = self.body[rows] if len(mesh.rest) > 1 else np.zeros(len(rows), dtype=np.int64)
        return skin_vertices(
            mesh, cloth, self.cuts[rows], self.height[rows] / cloth.height, body, self.scale[rows],
            self.measures.head[rows], posture.rotation[rows], posture.position[rows],
        )  # fmt: skip

    def mesh(self, level: int = 2) -> GroupMesh:
        """Return the vertices and triangles of all bodies of the group at a level of detail.

        Each person has all of them in :meth:`skin`, and wears those of :meth:`clothing_mask`.
        """
        return group_mesh(self.own, _level(level))

    def faces(self, level: int = 2) -> Ints:
        """Return the triangles ``[F, 3]`` as indices of vertices, counter-clockwise seen from outside."""
        return self.mesh(level).faces

    def clothing_mask(self, level: int = 2) -> NDArray[np.bool_]:
        """Return the mask ``[N, F]`` of triangles of the skin and of clothes that the person wears."""
        mesh = self.mesh(level)
        result = np.zeros((len(self), mesh.triangles[-1]), dtype=np.bool_)
        for k, (worn, own) in enumerate(zip(self.outfits, self.own_body.tolist(), strict=True)):
            result[k, mesh.face_span(own)] = True if own >= 0 else np.isin(mesh.included.face_part, worn_parts(worn))
        return result

    def face_colors(self, level: int = 2) -> Floats:
        """Return the colour ``[N, F, 3]`` of each triangle: red, green, blue from 0 to 1."""
        mesh = self.mesh(level)
        result = np.zeros((len(self), mesh.triangles[-1], 3))
        for k, worn in enumerate(self.outfits):
            result[k, mesh.face_span(-1)] = region_colors(worn)[mesh.included.face_region]
        for k, body in enumerate(self.own):
            result[:, mesh.face_span(k)] = body.face_colors(level)
        return result

    def vertex_colors(self, level: int = 2) -> Floats:
        """Return the colour ``[N, V, 3]`` of each vertex; :meth:`face_colors` has sharper edges of clothes."""
        mesh = self.mesh(level)
        result = np.zeros((len(self), mesh.points[-1], 3))
        for k, worn in enumerate(self.outfits):
            result[k, mesh.vertex_span(-1)] = region_colors(worn)[mesh.included.vertex_region]
        for k, body in enumerate(self.own):
            result[:, mesh.vertex_span(k)][:, body.levels[level].faces] = body.face_colors(level)[:, None]
        return result


def _level(level: int) -> int:
    if level not in range(LEVELS):
        raise InputError(f"level of detail {level} is not allowed, it must be from 0 to {LEVELS - 1}")
    return int(level)


def _per_person(name: str, value: ArrayLike, count: int) -> Floats:
    array = np.asarray(value, dtype=np.float64)
    if array.shape not in ((), (count,)):
        raise InputError(
            f"{name} has shape {list(array.shape)}, it must be one number or one for each of {count} people"
        )
    return np.broadcast_to(array, (count,))


class GroupMesh(NamedTuple):
    """Triangles of the included bodies, followed by those of each imported body.

    Fields:
        faces: ``[F, 3]`` indices of vertices.
        points: first vertex of the included bodies and of each imported one, and the number of vertices ``[K + 2]``.
        triangles: the same of the triangles ``[K + 2]``.
        included: the level of detail of the included bodies.
    """

    faces: Ints
    points: tuple[int, ...]
    triangles: tuple[int, ...]
    included: Level

    def vertex_span(self, own: int) -> slice:
        """Return the vertices of an imported body by its number, or of the included ones for -1."""
        return slice(self.points[own + 1], self.points[own + 2])

    def face_span(self, own: int) -> slice:
        """Return the triangles of an imported body by its number, or of the included ones for -1."""
        return slice(self.triangles[own + 1], self.triangles[own + 2])


def group_mesh(own: tuple[RiggedBody, ...], level: int) -> GroupMesh:
    """Return the mesh of a group with some imported bodies at a level of detail."""
    included = shapes().levels[level]
    faces, points, triangles = [included.faces], [0, included.rest.shape[1]], [0, len(included.faces)]
    for body in own:
        mesh = body.levels[level]
        faces.append(mesh.faces + points[-1])
        points.append(points[-1] + len(mesh.rest))
        triangles.append(triangles[-1] + len(mesh.faces))
    whole = np.concatenate(faces) if own else included.faces
    return GroupMesh(whole, tuple(points), tuple(triangles), included)
