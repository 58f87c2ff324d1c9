"""Import of buildings in binary glTF: walls where the building is cut at the height of bodies, doors, and pictures."""

from __future__ import annotations

import re
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError, TrialError
from crowdbot.core.fields import Points
from crowdbot.models import ORCA
from crowdbot.trials.stage import Stage, Wall
from crowdbot.trials.trial import End, Trial
from crowdbot.typing import Floats
from crowdbot.world import Building, Door, read_building

from .original import ImportedTrial

HEIGHTS = (0.25, 0.9, 1.6)
"""Heights above the floor [m] at which a building is cut."""
STRAIGHT = 0.02
"""Largest distance [m] of a wall from the cut."""
SHORTEST = 0.05
MOST_WALLS, MOST_DOORS = 5000, 100
GRID = 0.005
"""Step [m] of the corners of walls."""


def is_building(path: Path) -> bool:
    """Return whether a file is a binary glTF file by its name."""
    return path.suffix.lower() == ".glb"


def import_building(path: str | Path) -> ImportedTrial:
    """Read a building into the stage of a trial without people.

    The file is in metres with y up, as glTF requires; x stays, and -z becomes y. The floor is the largest level area
    near the lowest point. Whatever is cut at 0.25, 0.9 or 1.6 m above the floor becomes thin walls, within 2 cm. Nodes
    whose name contains ``door`` become doors that open by approach. Pictures show the building with its materials.

    Args:
        path: a ``.glb`` file.

    Raises:
        TrialError: the file is missing, damaged or too large, nothing is cut, or there are too many walls.
    """
    path = Path(path)
    try:
        building = read_building(path)
    except InputError as error:
        raise TrialError(str(error)) from None
    corners = building.corners
    rings = outlines(corners)
    if not rings:
        raise TrialError(f"{path}: nothing is {HEIGHTS[0]:g}, {HEIGHTS[1]:g} or {HEIGHTS[2]:g} m above the floor")
    if len(rings) > MOST_WALLS:
        raise TrialError(f"{path}: {len(rings)} walls are more than {MOST_WALLS}; leave out furniture and details")
    fits = re.fullmatch(r"[A-Za-z0-9_. -]{1,80}\.glb", path.name) is not None
    trial = Trial(
        name=(path.stem.strip() or "building")[:80],
        about="Imported from glTF.",
        duration=60.0,
        stage=Stage(
            walls=tuple(Wall(Points.of(ring)) for ring in rings), wall_height=_tall(corners), doors=_doors(building),
            building=path.name if fits else "", folder=path.parent,
        ),
        crowd=ORCA(),
        end=End(goal=False, collision=False),
    )  # fmt: skip
    notes = ["people and robots are not in the file: the trial has only the stage"]
    notes.append(
        "pictures show the building as long as its file is beside the trial"
        if fits
        else f"textures: rename {path.name} to letters, digits, '_', '-' and '.glb' at its end, and import it again"
    )
    notes += ["upper floors, ramps and stairs: people walk on the level floor only"]
    return ImportedTrial(((path.stem, trial),), tuple(notes))


def _doors(building: Building) -> tuple[Door, ...]:
    """Return the doors with different names."""
    doors: list[Door] = []
    for door in building.doors:
        name, number = door.name, 2
        while name in [door.name for door in doors]:
            name, number = f"{door.name[:74]} {number}", number + 1
        points = Points.of([door.start, door.end])
        doors.append(Door(name=name, points=points, opening="approach", height=door.height))
    return tuple(doors[:MOST_DOORS])


def cut(corners: Floats, height: float) -> Floats:
    """Return the lines ``[N, 2, 2]`` [m] in which a plane at a height [m] cuts triangles ``[T, 3, 3]``.

    >>> cut(np.array([[[0.0, 0, 0], [2, 0, 0], [0, 0, 2]]]), 1.0)[0].tolist()
    [[1.0, 0.0], [0.0, 0.0]]
    """
    above = corners[..., 2] > height
    mixed = above.any(axis=1) & ~above.all(axis=1)
    a, b = corners[mixed], np.roll(corners[mixed], -1, axis=1)
    crossing = above[mixed] != np.roll(above[mixed], -1, axis=1)  # two edges of each triangle
    first, second = a[crossing], b[crossing]
    share = (height - first[:, 2:]) / (second[:, 2:] - first[:, 2:])
    return np.asarray((first + share * (second - first))[:, :2].reshape(-1, 2, 2))


def outlines(corners: Floats) -> list[list[tuple[float, float]]]:
    """Return the lines in which triangles ``[T, 3, 3]`` [m] are cut at body height, joined and straightened.

    >>> upright = np.array([[[0.0, 0, 0], [2, 0, 0], [2, 0, 2]], [[0, 0, 0], [2, 0, 2], [0, 0, 2]]])
    >>> outlines(upright)
    [[(2.0, 0.0), (0.0, 0.0)]]
    """
    import shapely

    lines = np.concatenate([cut(corners, height) for height in HEIGHTS])
    rounded = np.round(lines / GRID) * GRID
    rounded = rounded[np.any(rounded[:, 0] != rounded[:, 1], axis=1)]
    if not len(rounded):
        return []
    whole: Any = shapely.line_merge(shapely.set_precision(shapely.union_all(shapely.linestrings(rounded)), GRID))
    found = []
    for part in shapely.get_parts(shapely.simplify(whole, STRAIGHT)):
        if part.length >= SHORTEST:
            found.append([(round(x, 3), round(y, 3)) for x, y in shapely.get_coordinates(part).tolist()])
    return sorted(found)


def _tall(corners: Floats) -> float:
    """Return the height of the walls: that of the building, from 1 to 3 m."""
    return float(np.clip(round(float(corners[..., 2].max()), 2), 1.0, 3.0))
