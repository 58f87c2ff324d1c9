"""Clothes, hair and skin: numbered outfits for each person, as colours of body regions."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from crowdbot.core import stream
from crowdbot.typing import Floats

from .asset import shapes
from .person import Person

Color = tuple[float, float, float]

SKIN: dict[str, tuple[str, ...]] = {
    "caucasian": ("f1d3bd", "e8bfa2", "dcae8c", "c99873"),
    "asian": ("eccfa8", "dfb98d", "cda277", "b98a60"),
    "african": ("8d5a3b", "74462c", "5c3723", "472a1c"),
}
"""Skin colours by main ancestry of the shape, light to dark."""
HAIR = ("16110e", "2a1c14", "46301f", "6d4a2b", "99703f", "c9a566", "7d3b1e")
DARK_HAIR = 3
"""Number of hair colours for all skin colours; the others are for light skin."""
GREY = ("8f8f8f", "b5b3b0", "d6d4d0")
TOPS = (
    "b3252b", "2c6e49", "d9a21b", "23262e", "7a8a99", "6b3f8f", "e7e5df", "1f4f9e", "5b2c1f", "c8663a",
    "3a8f98", "d48fa6", "40532f", "93a8c9", "f0d9a8", "7d1f3f",
)  # fmt: skip
BOTTOMS = ("1f2a44", "2f3b4c", "17181b", "5a4b3a", "3e5f8a", "4a4d52", "8a7a62", "30402f", "6b2f2f", "c2b79d")
SHOES = ("121212", "e8e6e1", "5a3520", "2b2f38", "8d2626", "7c7d80")
EYES = "23201d"
PLAIN = "b9b4ab"
"""Colour of the mannequin for outfit 0; later numbers use the colours of tops."""


@dataclass(frozen=True)
class Outfit:
    """Outfit of a person: colours (red, green, blue, 0 to 1), clothes and hair style.

    Fields: colours ``skin``, ``hair``, ``top``, ``bottom``, ``shoes``; ``sleeves`` (``long``, ``short`` or ``none``);
    ``legs`` (``long`` or ``short`` trousers, or ``skirt``); ``style`` of the hair (``cropped``, ``short`` or ``long``).
    """

    skin: Color
    hair: Color
    top: Color
    bottom: Color
    shoes: Color
    sleeves: str
    legs: str
    style: str


def outfit(person: Person, variation: int = 0) -> Outfit:
    """Return an outfit of a person; ``variation`` determines all of it except the skin colour.

    Colours of tops and bottoms do not repeat within ten consecutive numbers.

    >>> from crowdbot.humans.person import person
    >>> len({outfit(person("woman-36"), k) for k in range(20)})
    20
    """
    if not person.sex:
        plain = _color(PLAIN if variation == 0 else TOPS[(variation - 1) % len(TOPS)])
        return Outfit(plain, plain, plain, plain, plain, "long", "long", "cropped")
    always, chance = stream(0, "wardrobe", person.name), stream(0, "wardrobe", person.name, variation)
    race = shapes().people[person.index]["race"]
    origin = max(race, key=lambda key: (race[key], key))
    tone = SKIN[origin][int(always.integers(len(SKIN[origin])))]
    tops, bottoms = always.permutation(len(TOPS)), always.permutation(len(BOTTOMS))
    light = origin == "caucasian"
    grey = person.years > 45 and chance.random() < (person.years - 40) / 40
    hairs = GREY if grey else HAIR[: len(HAIR) if light else DARK_HAIR]
    female = person.sex == "f"
    return Outfit(
        skin=_color(tone),
        hair=_color(hairs[int(chance.integers(len(hairs)))]),
        top=_shade(_color(TOPS[tops[variation % len(TOPS)]]), chance),
        bottom=_shade(_color(BOTTOMS[bottoms[variation % len(BOTTOMS)]]), chance),
        shoes=_color(SHOES[int(chance.integers(len(SHOES)))]),
        sleeves=str(chance.choice(["long", "short", "none"], p=[0.5, 0.4, 0.1] if female else [0.55, 0.45, 0.0])),
        legs=str(chance.choice(["long", "short", "skirt"], p=[0.6, 0.15, 0.25] if female else [0.75, 0.25, 0.0])),
        style=str(chance.choice(["cropped", "short", "long"], p=[0.0, 0.35, 0.65] if female else [0.4, 0.55, 0.05])),
    )


def worn_parts(worn: Outfit) -> list[int]:
    """Return the indices of the mesh parts that are visible with an outfit."""
    named = ["skin", "top", "legs"]
    named += ["skirt"] if worn.legs == "skirt" else []
    named += [f"hair_{worn.style}"] if worn.style != "cropped" else []
    return [shapes().parts.index(name) for name in named]


def region_colors(worn: Outfit) -> Floats:
    """Return the colour of each region, ``[regions, 3]``."""
    bare_legs = worn.legs != "long"
    plain = worn.skin == worn.top
    colors = {
        "skin": worn.skin,
        "scalp": worn.hair,
        "top": worn.top,
        "bottom": worn.bottom,
        "shoes": worn.shoes,
        "eyes": worn.skin if plain else _color(EYES),
        "hair": worn.hair,
        "skirt": worn.bottom,
        "forearm": worn.top if worn.sleeves == "long" else worn.skin,
        "shin": worn.skin if bare_legs else worn.bottom,
        "upperarm": worn.skin if worn.sleeves == "none" else worn.top,
    }
    return np.array([colors[region] for region in shapes().regions])


def _color(text: str) -> Color:
    red, green, blue = (int(text[k : k + 2], 16) / 255.0 for k in (0, 2, 4))
    return red, green, blue


def _shade(color: Color, chance: np.random.Generator) -> Color:
    light = float(chance.uniform(0.88, 1.08))
    red, green, blue = (round(min(light * part, 1.0), 4) for part in color)
    return red, green, blue
