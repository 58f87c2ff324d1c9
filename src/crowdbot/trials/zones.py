"""Zones of a trial, whoever has them: their shapes, and whether anybody can be there."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from .checked import Checked, Problems
from .journey import Zone
from .notation import Points
from .stage import Stage, area

__all__ = ["Area", "areas", "crooked"]

SMALLEST = 1e-6
"""A zone that people come in by, go to or leave by is at least this large [m2]."""


@dataclass(frozen=True)
class Area:
    """A zone of an element.

    Fields:
        element: whose it is.
        word: its attribute.
        label: what it is called.
        points: its corners.
        smallest: area that it must have [m2].
        border: whether it may reach out of the walkable area, as an exit in a door does.
    """

    element: Any
    word: str
    label: str
    points: Points
    smallest: float = 0.0
    border: bool = False

    def crooked(self) -> Problems:
        """Yield what is wrong with the shape."""
        if wrong := crooked(self.points, self.smallest):
            yield self.element, f"{self.word} {wrong}"

    def misplaced(self, stage: Stage) -> Problems:
        """Yield why nobody can be there."""
        zone = area(self.points)
        block = stage.block_around(zone)
        if not (stage.meets(zone) if self.border else stage.holds(zone)):
            where = "lies" if self.border else "reaches"
            yield self.element, f"{self.label} {where} outside the walkable area; move it, or make the area larger"
        elif block:
            yield self.element, f"{self.label} lies inside {block}; nobody can be there, move it"


def areas(checked: Checked) -> list[Area]:
    """Return every zone of a trial."""
    found = []
    for group, label, smallest in ((checked.spawners, "spawn zone", 0.0), (checked.sources, "zone", SMALLEST)):
        for one in group:
            found.append(Area(one, "zone", label, one.zone, smallest))
            if one.goal:
                found.append(Area(one, "goal", "goal zone", one.goal, smallest))
    for journey in checked.journeys:
        zones = (stop for stop in journey.stops if isinstance(stop, Zone))
        found += [Area(stop, "points", "zone", stop.points, SMALLEST) for stop in zones]
    for portal in checked.portals:
        found.append(Area(portal, "zone", "zone", portal.zone, SMALLEST, border=True))
    for agent in checked.agents:
        if agent.goal_zone:
            found.append(Area(agent, "goal-zone", "goal zone", agent.goal_zone))
    return found + [Area(way, "zone", "zone", way.zone, SMALLEST, border=True) for way in checked.exits]


def crooked(points: Points, smallest: float = 0.0) -> str:
    """Return why points are not the corners of a polygon, as the end of a sentence; empty when they are."""
    import shapely

    if len(set(points)) < 3:
        return "must be at least 3 different points"
    polygon = area(points)
    if not polygon.is_valid:
        return f"is no simple polygon: {shapely.is_valid_reason(polygon).lower()}; list its corners in order"
    if polygon.area > smallest:
        return ""
    return f"has {polygon.area:g} m2, it must have more than {smallest:g} m2" if polygon.area > 0.0 else "has no area"
