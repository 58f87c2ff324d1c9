"""Journeys: sequences of stops, and the exits and portals of people."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crowdbot import world
from crowdbot.core import InputError
from crowdbot.core.fields import attribute, check, children

from .notation import NAME, Points

TOLERANCE = 0.3


@dataclass(frozen=True)
class Point:
    """A stop at a point."""

    x: float = attribute(about="x coordinate", unit="m")
    y: float = attribute(about="y coordinate", unit="m")
    tolerance: float = attribute(TOLERANCE, about="arrival tolerance", unit="m", exclusive_min=0.0)

    def __post_init__(self) -> None:
        check(self)

    def stop(self) -> world.Waypoint:
        """Return the waypoint of a world."""
        return world.PointWaypoint(self.x, self.y, self.tolerance)


@dataclass(frozen=True)
class Direction:
    """A direction to walk in without end: the last stop of a journey. Routing does not apply to it."""

    heading: float = attribute(about="counter-clockwise from +x", unit="rad", min=-2.0 * math.pi, max=2.0 * math.pi)

    def __post_init__(self) -> None:
        check(self)

    def stop(self) -> world.Waypoint:
        """Return the waypoint of a world."""
        return world.HeadingWaypoint(self.heading)


@dataclass(frozen=True)
class Zone:
    """A stop in a polygon."""

    points: Points = attribute(about="corners x,y of the zone", unit="m", points=3)
    aim: str = attribute(
        "nearest",
        about="target in the zone: its nearest point, or a random point per person",
        choices=("nearest", "random"),
    )
    tolerance: float = attribute(TOLERANCE, about="arrival tolerance of the random point", unit="m", exclusive_min=0.0)

    def __post_init__(self) -> None:
        check(self)

    def stop(self) -> world.Waypoint:
        """Return the waypoint of a world."""
        return world.PolygonZone(self.points, self.aim, self.tolerance)


@dataclass(frozen=True, kw_only=True)
class Journey:
    """A sequence of stops; spawners and sources refer to it by name.

    >>> Journey(name="home", stops=[Point(5, 0), Zone([(9, 0), (10, 0), (10, 2)])]).then
    'leave'
    """

    name: str = attribute(about="name that spawners and sources refer to", pattern=NAME)
    then: str = attribute(
        "leave", about="behaviour at the last stop: leave, stay or begin again", choices=("leave", "stay", "again")
    )
    stops: tuple[Point | Direction | Zone, ...] = children(
        {"point": Point, "direction": Direction, "zone": Zone}, about="stops, in order", min=1, max=1000
    )

    def __post_init__(self) -> None:
        check(self)

    def journey(self) -> world.WaypointSequence:
        """Return the waypoint sequence of a world."""
        return world.WaypointSequence(tuple(stop.stop() for stop in self.stops), self.then)


@dataclass(frozen=True, kw_only=True)
class Exit:
    """A zone in which all people leave, whatever their goal; robots are not affected."""

    name: str = attribute("", about="name for messages")
    zone: Points = attribute(about="corners x,y of the zone", unit="m", points=3)

    def __post_init__(self) -> None:
        check(self)

    def out(self) -> world.PolygonZone:
        """Return the exit of a world."""
        return world.PolygonZone(self.zone)


@dataclass(frozen=True, kw_only=True)
class Portal:
    """A zone that moves people elsewhere, with a new id; robots are not affected.

    >>> Portal(zone="25,-5 30,-5 30,5 25,5", dx=-50).dy
    0.0
    """

    name: str = attribute("", about="name for messages")
    zone: Points = attribute(about="corners x,y of the zone", unit="m", points=3)
    dx: float = attribute(0.0, about="offset from the zone to the exit of the portal", unit="m")
    dy: float = attribute(0.0, about="offset from the zone to the exit of the portal", unit="m")

    def __post_init__(self) -> None:
        check(self)
        if self.dx == 0.0 and self.dy == 0.0:
            raise InputError("needs dx or dy: the offset of the exit from the zone")

    def gate(self) -> world.PortalTransfer:
        """Return the portal of a world."""
        return world.PortalTransfer(world.PolygonZone(self.zone), self.dx, self.dy)
