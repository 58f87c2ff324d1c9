"""Body asset: shapes, skeleton, skin weights and regions of the available persons."""

from __future__ import annotations

import functools
import importlib.resources
import json
from collections.abc import Iterable
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import UnknownName
from crowdbot.typing import Floats, Ints

LEVELS = 3
"""Levels of detail: 0 is the finest."""
UNIT = 1e-4
"""Length of one unit of the stored vertices [m]."""


@dataclass(frozen=True)
class Level:
    """One level of detail. Bodies differ only in the rest shape.

    Fields: ``rest [P, V, 3]`` [m], ``faces [F, 3]``, ``bones [V, 4]`` and ``weights [V, 4]`` (sum 1), and the part and
    region of each vertex and face as indices into the names of :class:`Shapes`.
    """

    rest: Floats
    faces: Ints
    bones: Ints
    weights: Floats
    vertex_part: Ints
    vertex_region: Ints
    face_part: Ints
    face_region: Ints


@dataclass(frozen=True)
class Shapes:
    """All bodies of the asset; ``head`` and ``tail`` are the bone ends at rest [m]."""

    people: tuple[dict[str, Any], ...]
    bones: tuple[str, ...]
    parents: Ints
    parts: tuple[str, ...]
    regions: tuple[str, ...]
    head: Floats
    tail: Floats
    levels: tuple[Level, ...]

    def bone(self, name: str) -> int:
        """Return the index of a bone."""
        return self.bones.index(name)


@functools.cache
def shapes() -> Shapes:
    """Return the bodies of the asset; the last one is the mannequin, which is the mean of the adults."""
    stored = read_asset("humans_cc0.npz")
    people = tuple(json.loads(str(stored["people"])))
    adult = np.array([person["years"] >= 18 for person in people])
    return Shapes(
        people=people,
        bones=tuple(str(b) for b in stored["bones"]),
        parents=stored["parents"].astype(np.int64),
        parts=tuple(str(p) for p in stored["part_names"]),
        regions=tuple(str(r) for r in stored["regions"]),
        head=_append_mean(stored["joint_head"].astype(np.float64), adult),
        tail=_append_mean(stored["joint_tail"].astype(np.float64), adult),
        levels=tuple(_level(stored, k, adult) for k in range(LEVELS)),
    )


def read_asset(name: str) -> dict[str, NDArray[Any]]:
    """Return the arrays of a file of the bodies."""
    place = importlib.resources.files("crowdbot").joinpath("assets", "humans", name)
    with importlib.resources.as_file(place) as path, np.load(path, allow_pickle=False) as file:
        return {key: file[key] for key in file.files}


def _level(stored: dict[str, NDArray[Any]], k: int, adult: NDArray[np.bool_]) -> Level:
    counts = stored[f"lod{k}_parts"].astype(np.int64)
    weights = stored[f"lod{k}_weights"].astype(np.float64)
    return Level(
        rest=_append_mean(stored[f"lod{k}_verts"] * UNIT, adult),
        faces=stored[f"lod{k}_faces"].astype(np.int64),
        bones=stored[f"lod{k}_bones"].astype(np.int64),
        weights=weights / weights.sum(axis=1, keepdims=True),
        vertex_part=np.repeat(np.arange(len(counts)), counts[:, 0]),
        vertex_region=stored[f"lod{k}_region"].astype(np.int64),
        face_part=np.repeat(np.arange(len(counts)), counts[:, 1]),
        face_region=stored[f"lod{k}_face_region"].astype(np.int64),
    )


def _append_mean(values: Floats, adult: NDArray[np.bool_]) -> Floats:
    return np.concatenate([values, values[adult].mean(axis=0, keepdims=True)])


WORD = {("m", True): "man", ("f", True): "woman", ("m", False): "boy", ("f", False): "girl"}


@dataclass(frozen=True)
class Person:
    """One available body.

    Fields: ``name`` (kind and age, such as ``woman-36``), ``sex`` (``m``, ``f``, or empty for the mannequin),
    ``years``, ``height`` [m], ``mass`` [kg] (body volume times the density of water), ``index`` in the asset.
    """

    name: str
    sex: str
    years: int
    height: float
    mass: float
    index: int


@functools.cache
def persons() -> tuple[Person, ...]:
    """Return all persons, adults first, the mannequin last.

    >>> everyone = persons()
    >>> len(everyone), everyone[0].name, everyone[-1].name, sum(p.sex == "f" and p.years >= 18 for p in everyone)
    (45, 'man-20', 'mannequin', 20)
    """
    people = [
        Person(
            name=f"{WORD[row['sex'], row['years'] >= 18]}-{row['years']:02d}",
            sex=row["sex"],
            years=int(row["years"]),
            height=float(row["H"]),
            mass=float(row["mass"]),
            index=i,
        )
        for i, row in enumerate(shapes().people)
    ]
    adults = [p for p in people if p.years >= 18]
    mean = [float(np.mean([getattr(p, field) for p in adults])) for field in ("height", "mass")]
    return (*people, Person("mannequin", "", 0, mean[0], mean[1], len(people)))


def names() -> tuple[str, ...]:
    """Return the names of all persons, such as ``man-20`` or ``mannequin``.

    >>> names()[20:23]
    ('woman-20', 'woman-22', 'woman-24')
    """
    return tuple(p.name for p in persons())


def person(name: str) -> Person:
    """Return the person with this name.

    Raises:
        UnknownName: there is no person with this name.

    >>> person("boy-08").height
    1.28
    """
    found = {p.name: p for p in persons()}
    if name not in found:
        raise UnknownName("person", name, found)
    return found[name]


def drawable(kinds: Iterable[str]) -> tuple[Person, ...]:
    """Return the persons whose kind (``man``, ``woman``, ``boy``, ``girl``, ``mannequin``) is among ``kinds``."""
    wanted = set(kinds)
    return tuple(p for p in persons() if p.name.split("-")[0] in wanted)
