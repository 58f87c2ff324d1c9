"""Zones of a trial: their shapes, and whether they are accessible."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from crowdbot.trials.journey import Zone
from crowdbot.trials.notation import Points
from crowdbot.trials.partial_element import has_kind, readable
from crowdbot.trials.stage import Stage, area

from .context import ValidationContext

SMALLEST = 1e-6
"""Smallest area [m2] of a zone where people enter, go or leave."""


@dataclass(frozen=True)
class Area:
    """A zone of an element.

    Fields:
        element: element of the zone.
        name: name of its field.
        label: name of the zone in messages.
        points: corners.
        smallest: smallest area [m2].
        border: whether it may extend beyond the walkable area, like an exit in a door.
    """

    element: Any
    name: str
    label: str
    points: Points
    smallest: float = 0.0
    border: bool = False

    def shape_problem(self) -> str:
        """Return the problem of the shape as the end of a sentence, empty if there is none."""
        wrong = shape_problem(self.points, self.smallest)
        return wrong and f"{self.name.replace('_', '-')} {wrong}"

    def place_problem(self, stage: Stage) -> str:
        """Return why the zone is not accessible as the end of a sentence, empty if it is."""
        zone = area(self.points)
        if not (stage.meets(zone) if self.border else stage.holds(zone)):
            where = "lies" if self.border else "reaches"
            return f"{self.label} {where} outside the walkable area; move it, or make the area larger"
        block = stage.block_around(zone)
        return block and f"{self.label} lies inside {block}; it is not accessible, move it"


def areas(checked: ValidationContext) -> list[Area]:
    """Return the readable zones of a trial."""
    trial, found = checked.trial, list[Area]()
    for group, label, smallest in ((trial.spawners, "spawn zone", 0.0), (trial.sources, "zone", SMALLEST)):
        found += _zones(group, "zone", label, smallest)
        found += _zones(group, "goal", "goal zone", smallest)
    for _, stops in readable(trial.journeys, "stops"):
        found += _zones([stop for stop in stops if has_kind(stop, Zone)], "points", "zone", SMALLEST)
    found += _zones(trial.portals, "zone", "zone", SMALLEST, border=True)
    found += _zones(trial.agents, "goal_zone", "goal zone", 0.0)
    return found + _zones(trial.exits, "zone", "zone", SMALLEST, border=True)


def _zones(things: Sequence[Any], name: str, label: str, smallest: float, border: bool = False) -> list[Area]:
    return [Area(things[k], name, label, points, smallest, border) for k, points in readable(things, name) if points]


def shape_problem(points: Points, smallest: float = 0.0) -> str:
    """Return why points are not the corners of a polygon as the end of a sentence, empty if they are."""
    import shapely

    if len(set(points)) < 3:
        return "must be at least 3 different points"
    polygon = area(points)
    if not polygon.is_valid:
        return f"is not a simple polygon: {shapely.is_valid_reason(polygon).lower()}; list its corners in order"
    if polygon.area > smallest:
        return ""
    return f"has {polygon.area:g} m2, it must have more than {smallest:g} m2" if polygon.area > 0.0 else "has no area"
