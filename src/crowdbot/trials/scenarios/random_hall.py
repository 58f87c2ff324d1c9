"""Random hall: a hall with rooms, doors, obstacles, tables and flows of people, all drawn from one seed.

The hall is divided again and again by walls with one door each, so every room can be reached from every other. Doors
are wider than the robot, and obstacles keep 1.2 m from walls and from each other, tables with their chairs 0.9 m.
Coordinates follow from integers of PCG64: a seed gives the same trial on every machine. Numbers are our own.
"""

from __future__ import annotations

import dataclasses
from collections.abc import Callable
from typing import NamedTuple

from numpy.random import Generator

from crowdbot.core import stream
from crowdbot.core.fields import Points
from crowdbot.trials.builtin_names import TITLES
from crowdbot.trials.crowd import Routing
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import Spawner
from crowdbot.trials.robot import Planner
from crowdbot.trials.stage import Obstacle, Stage, Wall
from crowdbot.trials.trial import Trial
from crowdbot.world import Chair, ContactModel, Table, Zone

from .parts import box, robot, scenario
from .preset import Preset, PresetOption

SIDE = 320
"""Smallest side of a room [cm]."""
MARGIN = 40
"""Distance of a door from the ends of its wall, and of other walls from a door [cm]."""
AISLE = 120
"""Distance of obstacles from walls and from each other [cm]."""
CLEAR = 60
"""Distance of zones of people and of places of the robot from walls, and of obstacles from zones [cm]."""
ZONE = 200
"""Largest side of the zones in which people turn round [cm]."""
PERSON = 15_000
"""Area of a room for each person at the start [cm2]."""
TRIES = 50
"""Places that are tried for an obstacle or a table before it is left out."""
TABLE = 80
"""Width of a table [cm]."""
SEAT = 60
"""Space beside a table in which its chairs stand [cm]."""
BESIDE = 90
"""Distance of tables with their chairs from walls and from each other [cm]."""
PLACE = 60
"""Length of a table for each chair on a side [cm]."""


QUARTER = 1.5708
"""A quarter of a turn [rad]."""


class Rectangle(NamedTuple):
    """A rectangle with sides along x and y [cm]."""

    left: int
    low: int
    right: int
    high: int

    @property
    def sides(self) -> tuple[int, int]:
        """Width and height."""
        return self.right - self.left, self.high - self.low

    def grow(self, by: int) -> Rectangle:
        """Return the rectangle with its sides moved outwards."""
        return Rectangle(self.left - by, self.low - by, self.right + by, self.high + by)

    def meets(self, other: Rectangle) -> bool:
        """Return whether two rectangles overlap."""
        return self.left < other.right and other.left < self.right and self.low < other.high and other.low < self.high

    def points(self) -> Points:
        """Return the corners [m]."""
        return box(self.left / 100, self.low / 100, self.right / 100, self.high / 100)


class Gap(NamedTuple):
    """A gap in a wall across ``axis`` at ``at``, from ``begin`` to ``end`` along the wall [cm]."""

    axis: int
    at: int
    begin: int
    end: int


def _draw(rng: Generator, low: int, high: int) -> int:
    """Return a whole number from low to high."""
    return int(rng.integers(low, high + 1))


def _part(rng: Generator, room: Rectangle, width: int, height: int) -> Rectangle:
    """Return a rectangle of this size at a random place of a room."""
    left, low = _draw(rng, room.left, room.right - width), _draw(rng, room.low, room.high - height)
    return Rectangle(left, low, left + width, low + height)


def _places(room: Rectangle, axis: int, doors: list[Gap]) -> list[int]:
    """Return where a wall across an axis may divide a room: rooms are large enough, and no door is near its ends."""
    ends = (room[1 - axis], room[3 - axis])
    near = [door for door in doors if door.axis != axis and door.at in ends]
    return [
        at
        for at in range(room[axis] + SIDE, room[axis + 2] - SIDE + 1, 10)
        if all(at < door.begin - MARGIN or at > door.end + MARGIN for door in near)
    ]


def _divide(rng: Generator, hall: Rectangle, rooms: int, door: int) -> tuple[list[Rectangle], list[Gap], list[Wall]]:
    """Return rooms, doors and walls of a hall; fewer rooms if they would be too small."""
    found, doors, walls = [hall], list[Gap](), list[Wall]()
    while len(found) < rooms:
        options = [
            (room.sides[axis], k, axis, places)
            for k, room in enumerate(found)
            for axis in (0, 1)
            if (places := _places(room, axis, doors))
        ]
        if not options:
            break
        _, k, axis, places = max(options, key=lambda option: option[0])
        room, at = found.pop(k), places[_draw(rng, 0, len(places) - 1)]
        low, high = room[1 - axis], room[3 - axis]
        width = _draw(rng, door, door + 40)
        begin = _draw(rng, low + MARGIN, high - MARGIN - width)
        doors.append(Gap(axis, at, begin, begin + width))
        for ends in ((low, begin), (begin + width, high)):
            line = [(at, end) if axis == 0 else (end, at) for end in ends]
            walls.append(Wall(Points.of([(x / 100, y / 100) for x, y in line])))
        first, second = [*room], [*room]
        first[axis + 2] = second[axis] = at
        found += [Rectangle(*first), Rectangle(*second)]
    return found, doors, walls


def _obstacle_size(rng: Generator) -> tuple[int, int]:
    return _draw(rng, 40, 120), _draw(rng, 40, 120)


def _table_size(rng: Generator) -> tuple[int, int]:
    """Return the size of a table with the space of its chairs, along x or along y."""
    size = PLACE * _draw(rng, 2, 3), TABLE + 2 * SEAT
    return size if _draw(rng, 0, 1) else size[::-1]


def _solids(
    rng: Generator,
    rooms: list[Rectangle],
    kept: list[Rectangle],
    count: int,
    size: Callable[[Generator], tuple[int, int]],
    aisle: int = AISLE,
) -> list[Rectangle]:
    """Return rectangles with an aisle to walls and to each other, clear of what is kept; some may find no place."""
    found: list[Rectangle] = []
    for _ in range(count):
        for _ in range(TRIES):
            width, height = size(rng)
            room = rooms[_draw(rng, 0, len(rooms) - 1)].grow(-aisle)
            if room.sides[0] < width or room.sides[1] < height:
                continue
            place = _part(rng, room, width, height)
            if not any(place.meets(other) for other in [*(item.grow(aisle) for item in found), *kept]):
                found.append(place)
                break
    return found


def _furniture(rng: Generator, place: Rectangle) -> list[Table | Chair]:
    """Return a table in the middle of its place, and a chair at most of its seats, pushed in or drawn back."""
    along = 0 if place.sides[1] == TABLE + 2 * SEAT else 1
    middle = [(place.left + place.right) / 2, (place.low + place.high) / 2]
    long = place.sides[along]
    found: list[Table | Chair] = [
        Table(middle[0] / 100, middle[1] / 100, heading=along * QUARTER, length=long / 100, width=TABLE / 100)
    ]
    for side in (-1, 1):
        for k in range(long // PLACE):
            taken, back, shift, turn = _draw(rng, 0, 3), _draw(rng, 10, 38), _draw(rng, -6, 6), _draw(rng, -30, 30)
            if not taken:
                continue
            at = [0.0, 0.0]
            at[along] = middle[along] + PLACE * (k + 0.5) - long / 2 + shift
            at[1 - along] = middle[1 - along] + side * (TABLE / 2 + back)
            inwards = -side * QUARTER if along == 0 else (2.0 * QUARTER if side > 0 else 0.0)
            found.append(Chair(at[0] / 100, at[1] / 100, heading=round(inwards + turn / 100, 4)))
    return found


def random_hall(
    layout: int,
    length: float,
    width: float,
    rooms: int,
    door: float,
    obstacles: int,
    tables: int,
    flows: int,
    people: int,
) -> Trial:
    """Return a hall drawn from a seed: rooms, doors, obstacles, tables with chairs, flows between rooms, and the robot.

    The robot starts in one room and has its goal in another.
    """
    rng = stream(layout, "random-hall")
    whole = [_draw(rng, round(75 * side), round(100 * side)) for side in (length, width)]
    hall = Rectangle(0, 0, *whole)
    parts, _, walls = _divide(rng, hall, rooms, round(100 * door))

    journeys, spawners, kept = list[Journey](), list[Spawner](), list[Rectangle]()
    room_for = [part.sides[0] * part.sides[1] // PERSON for part in parts]
    for k in range(flows):
        first, second = (int(i) for i in rng.permutation(len(parts))[:2]) if len(parts) > 1 else (0, 0)
        turns = []
        for i in (second, first):
            inner = parts[i].grow(-CLEAR)
            turns.append(_part(rng, inner, *(min(side, ZONE) for side in inner.sides)))
        kept += [zone.grow(CLEAR) for zone in turns]
        name = f"flow{k + 1}"
        stops = tuple(Zone(zone.points(), aim="random") for zone in turns)
        journeys.append(Journey(name=name, then="again", stops=stops))
        count = min(people, room_for[first])
        room_for[first] -= count
        spawners.append(Spawner(name=name, count=count, zone=parts[first].grow(-30).points(), journey=name))

    begin = parts[_draw(rng, 0, len(parts) - 1)]
    middle = [sum(begin[axis::2]) / 2 for axis in (0, 1)]
    end = max(parts, key=lambda room: sum(abs(sum(room[axis::2]) / 2 - middle[axis]) for axis in (0, 1)))
    if end is begin:  # one room: from the left to the right
        begin, end = begin._replace(right=begin.left + SIDE // 2), begin._replace(left=begin.right - SIDE // 2)
    start_place, goal = (_part(rng, room.grow(-CLEAR), 0, 0) for room in (begin, end))
    kept += [place.grow(2 * CLEAR) for place in (start_place, goal)]
    ends = [(place.left / 100, place.low / 100) for place in (start_place, goal)]
    solid = _solids(rng, parts, kept, obstacles, _obstacle_size)
    kept += [item.grow(BESIDE) for item in solid]
    places = _solids(rng, parts, kept, tables, _table_size, BESIDE)
    furniture = [prop for place in places for prop in _furniture(rng, place)]
    return scenario(
        "random-hall",
        60.0 + 3 * sum(whole) // 100,
        Stage(
            walkable=hall.points(),
            walls=tuple(walls),
            obstacles=tuple(Obstacle(item.points()) for item in solid),
            props=tuple(furniture),
        ),
        routing=Routing(radius=0.3),
        contact=ContactModel(),
        journeys=journeys,
        spawners=[spawner for spawner in spawners if spawner.count],
        robots=[dataclasses.replace(robot(ends[0], ends[1]), planner=Planner())],
    )


RANDOM = (
    Preset(
        "random-hall",
        TITLES["random-hall"],
        random_hall,
        {
            "layout": PresetOption(0, "seed of the hall, its flows and the task", "", 0, 10**9),
            "length": PresetOption(18.0, "largest length of the hall; at least 3/4 of it", "m", 8.0, 60.0),
            "width": PresetOption(12.0, "largest width of the hall; at least 3/4 of it", "m", 8.0, 60.0),
            "rooms": PresetOption(4, "rooms; fewer if one would be narrower than 3.2 m", "", 1, 20),
            "door": PresetOption(1.2, "smallest width of doors; at most 0.4 m more", "m", 0.9, 2.0),
            "obstacles": PresetOption(3, "obstacles; those without a place are left out", "", 0, 20),
            "tables": PresetOption(0, "tables with chairs; those without a place are left out", "", 0, 20),
            "flows": PresetOption(3, "flows of people to and fro between two rooms", "", 0, 8),
            "people": PresetOption(5, "people of each flow; fewer in a small room", "", 0, 40),
        },
        "Arena: task generator, random maps",
    ),
)
