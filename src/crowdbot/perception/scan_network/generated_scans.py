"""Generated scans with labels: legs and bodies of people among walls, columns, poles and furniture."""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from crowdbot.core import Pose
from crowdbot.sensors import cast_plane
from crowdbot.typing import Floats, Ints

RAYS = (360, 450, 541, 720, 811, 1080)
"""Numbers of beams in a full turn."""
SPACE = 10.0
"""Half width of the place of the objects [m]."""


class LabelledScan(NamedTuple):
    """A scan of a full turn and the people in it.

    Fields:
        ranges, angles: ``[R]`` [m], [rad]; inf without a return.
        person: ``[R]`` index of the person that the beam met, -1 for everything else.
        centre: ``[N, 2]`` of the people in the frame of the scanner [m].
    """

    ranges: Floats
    angles: Floats
    person: Ints
    centre: Floats


def generate_scan(rng: np.random.Generator) -> LabelledScan:
    """Return a scan of a random place.

    Half of the scans are at the height of legs: two discs of 5 to 9 cm, up to a stride apart along the walking
    direction. The others are at the height of bodies, discs of 18 to 30 cm. People walk in part in groups of two.
    There are walls, and objects that look like people: columns, poles, bins, and four legs of chairs and tables.

    >>> scan = generate_scan(np.random.default_rng(0))
    >>> scan.ranges.shape == scan.angles.shape, set(scan.person.tolist()) <= {-1, *range(len(scan.centre))}
    (True, True)
    """
    rays = int(rng.choice(RAYS))
    centre = _places(rng, int(rng.integers(1, 25)))
    at_legs = rng.random() < 0.5
    discs, radius, owner = _legs(rng, centre) if at_legs else _bodies(rng, centre)
    things, widths = _furniture(rng)
    discs = np.concatenate([discs, things])
    radius = np.concatenate([radius, widths])
    owner = np.concatenate([owner, np.full(len(things), -1)])
    angles: Floats = -math.pi + 2.0 * math.pi / rays * np.arange(float(rays))
    clear = np.linalg.norm(discs, axis=1) > radius + 0.2
    discs, radius, owner = discs[clear], radius[clear], owner[clear]
    ranges, hit = cast_plane(
        Pose.of((0.0, 0.0), 0.0), angles, discs[None], radius[None], _walls(rng), float(rng.uniform(12.0, 30.0))
    )
    person = np.where(hit[0] >= 0, owner[np.maximum(hit[0], 0)], -1)
    noise = rng.normal(0.0, rng.uniform(0.002, 0.03), rays)
    lost = rng.random(rays) < rng.uniform(0.0, 0.02)
    measured = np.where(lost, np.inf, np.maximum(ranges[0] + noise, 0.02))
    return LabelledScan(measured, angles, np.where(np.isfinite(measured), person, -1), centre)


def _places(rng: np.random.Generator, count: int) -> Floats:
    """Return centres of people; every third one has a companion beside."""
    centre = rng.uniform(-0.9 * SPACE, 0.9 * SPACE, (count, 2)) * rng.choice([0.4, 1.0])
    aside = rng.uniform(0.0, 2.0 * math.pi, count)
    beside = centre + rng.uniform(0.5, 0.9, count)[:, None] * np.stack([np.cos(aside), np.sin(aside)], axis=-1)
    places = np.concatenate([centre, beside[: count // 3]])
    kept: list[Floats] = []
    for place in places:
        if np.linalg.norm(place) > 0.6 and all(np.linalg.norm(place - other) > 0.45 for other in kept):
            kept.append(place)
    return np.array(kept).reshape(-1, 2)


def _legs(rng: np.random.Generator, centre: Floats) -> tuple[Floats, Floats, Ints]:
    count = len(centre)
    heading, stride = rng.uniform(0.0, 2.0 * math.pi, count), 0.4 * np.sin(rng.uniform(0.0, 2.0 * math.pi, count))
    along = np.stack([np.cos(heading), np.sin(heading)], axis=-1)
    left = np.stack([-np.sin(heading), np.cos(heading)], axis=-1)
    half = 0.5 * (stride[:, None] * along + rng.uniform(0.12, 0.28, count)[:, None] * left)
    radius = rng.uniform(0.05, 0.09, count)
    return np.concatenate([centre + half, centre - half]), np.tile(radius, 2), np.tile(np.arange(count), 2)


def _bodies(rng: np.random.Generator, centre: Floats) -> tuple[Floats, Floats, Ints]:
    return centre, rng.uniform(0.18, 0.3, len(centre)), np.arange(len(centre))


def _furniture(rng: np.random.Generator) -> tuple[Floats, Floats]:
    """Return columns, poles and bins, and the legs of chairs and tables."""
    count = int(rng.integers(0, 12))
    round_things = rng.uniform(-SPACE, SPACE, (count, 2))
    widths = rng.choice([rng.uniform(0.01, 0.05), rng.uniform(0.3, 0.6)], count) * rng.uniform(0.7, 1.3, count)
    places, radii = [round_things], [widths]
    for _ in range(int(rng.integers(0, 8))):
        turn, half = rng.uniform(0.0, math.pi), 0.5 * rng.uniform(0.35, 1.2)
        corner = half * math.sqrt(2.0) * np.exp(1j * (turn + math.pi / 2 * np.arange(4)))
        middle = rng.uniform(-SPACE, SPACE, 2)
        places.append(middle + np.stack([corner.real, corner.imag], axis=-1))
        radii.append(np.full(4, rng.uniform(0.01, 0.03)))
    return np.concatenate(places), np.concatenate(radii)


def _walls(rng: np.random.Generator) -> Floats:
    """Return a room of random size and turn, boxes and pieces of walls, as segments ``[S, 4]``."""
    corners = [rng.uniform(3.0, 12.0, 2) * [sx, sy] for sx, sy in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    loops = [np.array(corners)] if rng.random() < 0.8 else []
    for _ in range(int(rng.integers(0, 8))):
        turn, size = rng.uniform(0.0, math.pi), rng.uniform([0.05, 0.1], [0.6, 3.0])
        axis = np.array([[math.cos(turn), math.sin(turn)], [-math.sin(turn), math.cos(turn)]])
        middle = rng.uniform(1.5, SPACE) * np.exp(1j * rng.uniform(0.0, 2.0 * math.pi))
        box = 0.5 * size * [[-1, -1], [1, -1], [1, 1], [-1, 1]] @ axis + [middle.real, middle.imag]
        loops.append(box)
    if not loops:
        return np.zeros((0, 4))
    return np.concatenate([np.concatenate([loop, np.roll(loop, -1, axis=0)], axis=1) for loop in loops])
