"""Clothes, hair and skin: numbered outfits for each person, and the images for them."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import stream
from crowdbot.typing import Bytes, Floats

from .asset import Person, read_asset, shapes

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

    >>> from crowdbot.humans.asset import person
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


SIDE = 512
"""Side [pixels] of the picture of a person."""
CHARTS = {
    "head": (0.0, 0.0, 1.0, 0.5),
    "eyes": (0.0, 0.5, 0.125, 0.125),
    "hand": (0.0, 0.625, 0.125, 0.125),
    "hair": (0.125, 0.5, 0.25, 0.25),
    "upperarm": (0.375, 0.5, 0.25, 0.25),
    "forearm": (0.625, 0.5, 0.25, 0.25),
    "shoes": (0.875, 0.5, 0.125, 0.25),
    "top": (0.0, 0.75, 0.375, 0.25),
    "bottom": (0.375, 0.75, 0.1875, 0.25),
    "shin": (0.5625, 0.75, 0.1875, 0.25),
    "skirt": (0.75, 0.75, 0.25, 0.25),
}
"""Left, top, width and height of the region of a body in the picture, as shares of its side."""
SIZES = {"upperarm": (0.18, 0.53), "forearm": (0.18, 0.53), "top": (1.10, 0.64), "bottom": (0.26, 0.92),
         "shin": (0.26, 0.92), "skirt": (1.10, 0.40), "shoes": (0.33, 0.14)}  # fmt: skip
"""Width and height [m] of what a chart shows."""
EYE_COLORS = ((0.35, 0.24, 0.16), (0.27, 0.18, 0.12), (0.40, 0.50, 0.58), (0.38, 0.46, 0.36), (0.22, 0.15, 0.10))
DARK_EYES = (0, 1, 4)
PATTERNS = ("plain", "plain", "stripes", "checks", "knit", "print", "block")
BOTTOM_PATTERNS = ("plain", "denim", "denim", "plain", "checks")


@functools.cache
def _maps() -> dict[str, NDArray[np.uint8]]:
    return read_asset("looks_cc0.npz")


@functools.cache
def body_uv(level: int) -> Floats:
    """Return the texture coordinates ``[F, 3, 2]`` of the corners of the mesh of bodies, 0 to 1 from the top left."""
    return _maps()[f"uv{level}"].astype(np.float64) / 65535.0


def paint_body(person: Person, worn: Outfit, variation: int, size: int = SIDE) -> Bytes:
    """Return the picture ``[size, size, 3]`` of a person; ``size`` is 512, 256 or 128.

    >>> from crowdbot.humans.asset import person
    >>> from crowdbot.humans.wardrobe import outfit
    >>> paint_body(person("man-20"), outfit(person("man-20")), 0, 128).shape
    (128, 128, 3)
    """
    colors = dict(zip(shapes().regions, region_colors(worn), strict=True))
    chance = stream(0, "looks", person.name, variation)
    plain = not person.sex
    found = np.empty((SIDE, SIDE, 3))
    found[:] = colors["skin"]
    _place(found, "head", _head(person, worn, chance))
    _place(found, "eyes", np.tile(np.array(worn.skin), (64, 64, 1)) if plain else _eye(person, chance))
    _place(found, "hand", _bare(worn, 64, 64))
    strand = (_maps()["hair"] / 127.5)[..., None]
    _place(found, "hair", np.tile(colors["hair"], (128, 128, 1)) if plain else _hair(worn, strand))
    top = "plain" if plain else str(chance.choice(PATTERNS))
    bottom = "plain" if plain else str(chance.choice(BOTTOM_PATTERNS))
    accent = np.array(worn.top) * 0.35 + 0.65 * np.array([0.93, 0.92, 0.9] if sum(worn.top) < 1.6 else [0.2, 0.22, 0.3])
    _place(found, "top", _cloth("top", worn.top, accent, top, person, plain))
    for name in ("upperarm", "forearm"):
        bare = not np.allclose(colors[name], worn.top)
        _place(found, name, _bare(worn, 128, 128) if bare else _cloth(name, worn.top, accent, top, person, plain))
    for name, bare in (("bottom", False), ("shin", not np.allclose(colors["shin"], worn.bottom))):
        _place(found, name, _bare(worn, 128, 96) if bare else _cloth(name, worn.bottom, accent, bottom, person, plain))
    _place(found, "skirt", _cloth("skirt", worn.bottom, accent, bottom, person, plain))
    _place(found, "shoes", _shoe(worn, plain))
    image = np.clip(found, 0.0, 1.0)
    while len(image) > size:
        image = 0.25 * (image[::2, ::2] + image[1::2, ::2] + image[::2, 1::2] + image[1::2, 1::2])
    return np.asarray(np.floor(255.0 * image + 0.5), dtype=np.uint8)


def _place(whole: Floats, name: str, part: Floats) -> None:
    left, top, wide, high = (int(SIDE * share) for share in CHARTS[name])
    whole[top : top + high, left : left + wide] = part[:high, :wide]


def _mix(base: Floats, color: Floats | tuple[float, ...], share: NDArray[Any]) -> Floats:
    return np.asarray(base + share[..., None] * (np.asarray(color) - base))


def _bare(worn: Outfit, high: int, wide: int) -> Floats:
    return np.asarray(np.array(worn.skin) * (_maps()["bare"][:high, :wide, None] / 127.5))


def _head(person: Person, worn: Outfit, chance: np.random.Generator) -> Floats:
    """Return the chart of the head: a face with brows, lashes and lips, and the scalp."""
    maps = {name: _maps()[name] / 255.0 for name in ("lips", "brows", "blush", "beard", "wrinkles", "lashes")}
    skin, hair = np.array(worn.skin), np.array(worn.hair)
    base = np.ones((SIDE // 2, SIDE, 1)) * skin
    row = np.arange(SIDE // 2)[:, None] / (SIDE // 2)
    column = np.abs(np.arange(SIDE)[None, :] / SIDE - 0.5) * 2.0
    if person.sex:
        base = _mix(base, skin * (1.0, 0.78, 0.74), 0.45 * maps["blush"])
        rosy = skin * (0.86, 0.55, 0.53) if person.sex == "m" or person.years < 18 else skin * (0.84, 0.42, 0.44)
        base = _mix(base, rosy, (0.55 if person.sex == "m" else 0.8) * maps["lips"])
        base = _mix(base, 0.7 * hair + 0.05, (0.85 if person.sex == "m" else 0.65) * maps["brows"])
        base = _mix(base, (0.07, 0.05, 0.05), (0.6 if person.sex == "m" else 0.9) * maps["lashes"])
        if person.years > 35:
            base = _mix(base, 0.62 * skin, min(0.5, (person.years - 30) / 70.0) * np.clip(maps["wrinkles"], 0.0, 1.0))
        if person.sex == "m" and person.years >= 18:
            beard = float(chance.choice([0.0, 0.18, 0.35, 0.85], p=[0.3, 0.3, 0.2, 0.2]))
            base = _mix(base, 0.75 * hair + 0.04, beard * maps["beard"])
    base = base * (_maps()["shade"][..., None] / 127.5)
    line = 0.245 + 0.25 * np.clip(column - 0.16, 0.0, 0.35)
    share = np.clip((line - row) / 0.02 + 0.5, 0.0, 1.0)
    strand = np.tile(_maps()["hair"], (2, 4)) / 127.5
    return _mix(base, hair * (0.8 + 0.2 * strand[..., None]), share) if person.sex else base


def _hair(worn: Outfit, strand: Floats) -> Floats:
    """Return the chart of hair, whose front edge thins out into the skin."""
    base = np.array(worn.hair) * strand
    row, column = np.arange(128)[:, None] / 128 * 0.42, np.arange(128)[None, :] / 128 * np.pi
    edge = 0.104 + 0.05 * np.clip(column - 0.55, 0.0, 0.8) + 0.022 * (strand[..., 0] - 1.0)
    share = np.clip((row - edge) / 0.006, 0.0, 1.0) * (column < 1.0)
    return _mix(base, np.array(worn.skin) * 0.82, 0.9 * share)


def _eye(person: Person, chance: np.random.Generator) -> Floats:
    """Return the chart of an eye: white, iris and pupil."""
    race = shapes().people[person.index]["race"]
    light = max(race, key=lambda key: (race[key], key)) == "caucasian"
    iris = EYE_COLORS[int(chance.integers(len(EYE_COLORS)))] if light else EYE_COLORS[int(chance.choice(DARK_EYES))]
    y, x = np.mgrid[0:64, 0:64]
    far = np.sqrt((x - 31.5) ** 2 + (y - 31.5) ** 2) / 64.0 * 2.0 * 14.8  # mm
    base = (
        np.ones((64, 64, 1)) * np.array([0.90, 0.87, 0.85]) * (1.0 - 0.18 * np.clip((far - 6.0) / 8.0, 0, 1))[..., None]
    )
    ray = 0.8 + 0.4 * (_maps()["hair"][:64, :64] / 255.0)
    base = _mix(base, (0.10, 0.08, 0.07), np.clip((6.4 - far) / 0.5, 0.0, 1.0))
    base = base + np.clip((5.7 - far) / 0.5, 0.0, 1.0)[..., None] * (np.array(iris) * ray[..., None] - base)
    base = _mix(base, (0.02, 0.02, 0.02), np.clip((2.2 - far) / 0.4, 0.0, 1.0))
    spark = np.sqrt((x - 28.0) ** 2 + (y - 27.0) ** 2)
    return _mix(base, (1.0, 1.0, 1.0), 0.9 * np.clip((2.6 - spark) / 1.0, 0.0, 1.0))


def _cloth(name: str, color: tuple[float, ...], accent: Floats, pattern: str, person: Person, plain: bool) -> Floats:
    """Return the chart of a garment with folds, seams and a pattern."""
    wide, high = (int(SIDE * share) for share in CHARTS[name][2:])
    across, down = SIZES[name]
    x = (np.arange(wide) + 0.5)[None, :] / wide * across * np.ones((high, 1))
    y = (np.arange(high) + 0.5)[:, None] / high * down * np.ones((1, wide))
    base = np.ones((high, wide, 1)) * np.array(color)
    if plain:
        return np.asarray(base)
    chance = stream(0, "pattern", person.name, pattern)
    if pattern == "stripes":
        step = float(chance.choice([0.03, 0.05, 0.08]))
        base = _mix(base, accent, (np.mod(y, step) < 0.45 * step) * 1.0)
    elif pattern == "checks":
        step = float(chance.choice([0.05, 0.08]))
        level = np.clip((y - 0.10) / 0.06, 0.0, 1.0) if name == "top" else np.ones_like(y)  # of the shoulders
        upright = level * (np.mod(x, step) < 0.4 * step)
        base = _mix(base, accent, 0.33 * (np.mod(y, step) < 0.4 * step) + 0.33 * upright)
    elif pattern == "knit":
        base = base * (0.86 + 0.14 * (np.mod(y + 0.5 * np.abs(np.mod(x, 0.02) - 0.01), 0.02) < 0.012))[..., None]
    elif pattern == "block":
        base = _mix(base, accent, (y < 0.30 * down) * 1.0 if name == "top" else np.zeros_like(y))
    elif pattern == "print" and name == "top":
        middle = np.hypot(x - 0.5 * across, 1.2 * (y - 0.24))
        ring = np.clip((0.075 - middle) / 0.004, 0.0, 1.0) * np.clip(1.0 - (0.035 - middle) / 0.004, 0.3, 1.0)
        base = _mix(base, accent, ring)
    elif pattern == "denim":
        weave = _maps()["bare"][np.arange(high)[:, None] % 128, (np.arange(wide)[None, :] * 3) % 128] / 127.5
        base = base * (0.35 + 0.65 * weave)[..., None] + 0.02
        worn = np.exp(-(((x / across - 0.1) / 0.22) ** 2) - ((y / down - 0.38) / 0.16) ** 2)
        base = base + 0.10 * worn[..., None]
    fold = _maps()["folds"][:high, :wide] / 255.0
    shade = 0.80 + 0.40 * fold
    if name == "top":
        shade = shade * (1.0 - 0.30 * np.exp(-(((y - down + 0.02) / 0.006) ** 2)))  # hem
        if pattern in ("plain", "checks") and chance.random() < 0.6:  # buttons and placket
            shade = shade * (1.0 - 0.25 * np.exp(-(((np.abs(x - 0.5 * across) - 0.016) / 0.002) ** 2)) * (y > 0.03))
            dot = np.hypot(x - 0.5 * across, np.mod(y, 0.08) - 0.04)
            base = _mix(base, accent, 0.8 * (dot < 0.006))
    return np.asarray(base * shade[..., None])


def _shoe(worn: Outfit, plain: bool) -> Floats:
    wide, high = (int(SIDE * share) for share in CHARTS["shoes"][2:])
    base = np.ones((high, wide, 1)) * np.array(worn.shoes)
    if plain:
        return np.asarray(base)
    row, column = np.arange(high)[:, None] / high, np.arange(wide)[None, :] / wide
    sole = np.clip((row - 0.84) / 0.01, 0.0, 1.0) * np.ones((1, wide))
    base = _mix(base, (0.86, 0.85, 0.82) if sum(worn.shoes) < 2.0 else (0.55, 0.5, 0.45), sole)
    lace = (np.mod(row * 14.0, 1.0) < 0.4) & (column > 0.45) & (column < 0.72) & (row < 0.55)
    return _mix(base, (0.9, 0.9, 0.9) if sum(worn.shoes) < 1.5 else (0.25, 0.25, 0.28), 0.7 * lace)
