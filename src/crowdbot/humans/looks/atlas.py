"""Pictures of people: skin with a face, hair and clothes, from baked maps and the outfit of a person."""

from __future__ import annotations

import functools
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import stream
from crowdbot.humans.asset import read_asset, shapes
from crowdbot.humans.person import Person
from crowdbot.humans.wardrobe import Outfit, region_colors
from crowdbot.typing import Bytes, Floats

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
EYES = ((0.35, 0.24, 0.16), (0.27, 0.18, 0.12), (0.40, 0.50, 0.58), (0.38, 0.46, 0.36), (0.22, 0.15, 0.10))
DARK_EYES = (0, 1, 4)
PATTERNS = ("plain", "plain", "stripes", "checks", "knit", "print", "block")
BOTTOMS = ("plain", "denim", "denim", "plain", "checks")


@functools.cache
def _maps() -> dict[str, NDArray[np.uint8]]:
    return read_asset("looks_cc0.npz")


@functools.cache
def body_uv(level: int) -> Floats:
    """Return the texture coordinates ``[F, 3, 2]`` of the corners of the mesh of bodies, 0 to 1 from the top left."""
    return _maps()[f"uv{level}"].astype(np.float64) / 65535.0


def paint_body(person: Person, worn: Outfit, variation: int, size: int = SIDE) -> Bytes:
    """Return the picture ``[size, size, 3]`` of a person; ``size`` is 512, 256 or 128.

    >>> from crowdbot.humans.person import person
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
    bottom = "plain" if plain else str(chance.choice(BOTTOMS))
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
    iris = EYES[int(chance.integers(len(EYES)))] if light else EYES[int(chance.choice(DARK_EYES))]
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
