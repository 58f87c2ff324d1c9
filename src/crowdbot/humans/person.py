"""Available persons: 40 adults, 4 children and a mannequin, by name."""

from __future__ import annotations

import functools
from collections.abc import Iterable
from dataclasses import dataclass

import numpy as np

from crowdbot.core import UnknownName

from .asset import shapes

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
    found = [
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
    adults = [p for p in found if p.years >= 18]
    mean = [float(np.mean([getattr(p, field) for p in adults])) for field in ("height", "mass")]
    return (*found, Person("mannequin", "", 0, mean[0], mean[1], len(found)))


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
