"""Door: an element of the stage that closes a passage."""

from __future__ import annotations

import math
from dataclasses import dataclass

from crowdbot import world
from crowdbot.core import InputError, parse_number
from crowdbot.core.fields import Points, attribute, check


@dataclass(frozen=True, kw_only=True)
class Door:
    """A door in a passage. It opens by a change of ``open``, at times, by approach, or by a push.

    >>> door = Door(name="hall", points=[(2, 0), (2, 1)], opening="schedule", times="5 20")
    >>> door.leaf().times
    (5.0, 20.0)
    """

    name: str = attribute(about="name of the door", pattern=r"\S.{0,79}")
    points: Points = attribute(about="x,y of the hinge (or the side to which it slides) and of the other end", unit="m")
    kind: str = attribute("hinged", about="hinged or sliding leaf", choices=("hinged", "sliding"))
    opening: str = attribute(
        "order",
        about="what opens it: the value of open, times, approach of people and robots, or a push",
        choices=("order", "schedule", "approach", "push"),
    )
    open: bool = attribute(False, about="whether it is open at the start; while it runs, orders change it")
    times: str = attribute("", about="times at which a scheduled door opens or closes, separated by spaces", unit="s")
    distance: float = attribute(1.5, about="distance at which approach opens it", unit="m", min=0.0, max=100.0)
    hold: float = attribute(2.0, about="time for which it then stays open", unit="s", min=0.0, max=86_400.0)
    duration: float = attribute(1.0, about="time to open or close", unit="s", min=0.01, max=3600.0)
    angle: float = attribute(
        math.pi / 2, about="angle of the open leaf, counter-clockwise", unit="rad", min=-math.pi, max=math.pi
    )
    height: float = attribute(2.1, about="height", unit="m", min=0.1, max=100.0)
    mass: float = attribute(20.0, about="mass of a leaf that is pushed", unit="kg", min=0.1, max=1e4)
    closer: float = attribute(
        10.0, about="torque of the closer of a leaf that is pushed, at the full angle", min=0.0, max=1000.0
    )

    def __post_init__(self) -> None:
        check(self)
        if len(self.points) != 2 or self.points[0] == self.points[1]:
            raise InputError(f"points has {len(self.points)} points; give two different ones, the hinge first")
        try:
            given = _times(self.times)
        except InputError as error:
            raise InputError(f'times="{self.times[:60]}" {error}') from None
        if self.opening == "schedule" and not given:
            raise InputError('opening="schedule" needs times, such as times="5 20"')
        if self.opening != "schedule" and self.times:
            raise InputError(f'times need opening="schedule", not "{self.opening}"')
        if self.opening == "push" and self.kind == "sliding":
            raise InputError('opening="push" needs a hinged door')
        if self.angle == 0.0:
            raise InputError("angle must not be 0")

    def leaf(self) -> world.DoorLeaf:
        """Return the door of a world."""
        (x, y), (end_x, end_y) = self.points
        return world.DoorLeaf(
            self.name, x, y, end_x, end_y, self.kind, self.opening, _times(self.times), self.distance, self.hold,
            self.duration, self.angle, self.height, self.mass, self.closer,
        )  # fmt: skip


def _times(text: str) -> tuple[float, ...]:
    """Return the numbers of a text, which must increase."""
    times = tuple(parse_number(word) for word in text.split())
    if list(times) != sorted(set(times)) or any(time < 0.0 for time in times):
        raise InputError("must increase, from 0 s on")
    return times
