"""Journeys: named sequences of stops."""

from __future__ import annotations

from dataclasses import dataclass

from crowdbot.core.fields import NAME, attribute, check, children
from crowdbot.world import Direction, Point, WaypointSequence, Zone


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

    def journey(self) -> WaypointSequence:
        """Return the waypoint sequence of a world."""
        return WaypointSequence(self.stops, self.then)
