"""Rooms: a robot enters or leaves a room while people use the same door.

Names are those of Francis et al. 2025, Principles and guidelines for evaluating social robot navigation algorithms,
doi:10.1145/3700599; geometry and numbers are our own. People do not know who goes first: most give way to a robot that
comes out of a room.
"""

from __future__ import annotations

import dataclasses

from crowdbot.core.fields import Points
from crowdbot.trials.builtin_names import TITLES
from crowdbot.trials.crowd import Routing
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import Spawner
from crowdbot.trials.robot import Planner
from crowdbot.trials.robots.reaction import ReactionSpec
from crowdbot.trials.stage import Stage, Wall
from crowdbot.trials.trial import Trial
from crowdbot.world import Point, Zone

from .parts import box, robot, scenario
from .preset import Preset, PresetOption, ScenarioCard

ELEVATOR, ROOM = 2.2, 5.0
"""Sides of a square elevator and of a square room [m]."""

Place = tuple[float, float]


def _at_the_door(
    name: str, side: float, door: float, people: Spawner, journey: Journey, start: Place, goal: Place
) -> Trial:
    """Return a hall on the left of a square room, with the door at the origin, and a robot that plans its path."""
    half, gap = side / 2.0, door / 2.0
    hall = max(4.0, half + 0.5)
    walls = [[(0, -gap), (0, -half), (side, -half), (side, half), (0, half), (0, gap)]]
    return scenario(
        name,
        60.0,
        Stage(walkable=box(-7, -hall, side + 0.5, hall), walls=tuple(Wall(Points.of(points)) for points in walls)),
        routing=Routing(radius=0.27),
        journeys=[journey],
        spawners=[people],
        robots=[dataclasses.replace(robot(start, goal, 0.7), planner=Planner(margin=0.03))],
    )


def entering_room(door: float, people: int) -> Trial:
    """A robot enters a room that people leave."""
    return _at_the_door(
        "entering-room",
        ROOM,
        door,
        Spawner(name="leaving", count=people, zone=box(1.0, -2.0, 3.5, 2.0), journey="out"),
        Journey(name="out", stops=(Point(-1.2, 1.2), Zone(box(-6.7, 1.5, -5.5, 3.5), aim="random"))),
        (-2.4, -1.0),
        (3.0, -1.0),
    )


def _exiting(name: str, side: float, door: float, people: int, share: float) -> Trial:
    """Return people who go into a room, and a robot that comes out."""
    reactions = (ReactionSpec(type="give-way", share=share),) if share else ()
    zone = box(-side / 2.0 - 1.5, 0.4, -side / 2.0 - 0.3, 2.4)
    inside = box(side - 0.9, -side / 2.0 + 0.4, side - 0.4, side / 2.0 - 0.4)
    return _at_the_door(
        name,
        side,
        door,
        Spawner(name="entering", count=people, zone=zone, journey="in", reactions=reactions),
        Journey(name="in", then="stay", stops=(Zone(inside, aim="random"),)),
        (side / 2.0, 0.0),
        (-5.0, -1.0),
    )


def exiting_room(door: float, people: int, gives_way: float) -> Trial:
    """A robot leaves a room that people enter."""
    return _exiting("exiting-room", ROOM, door, people, gives_way)


def exiting_elevator(door: float, people: int, gives_way: float) -> Trial:
    """A robot leaves an elevator that people enter."""
    return _exiting("exiting-elevator", ELEVATOR, door, people, gives_way)


DOOR = PresetOption(0.95, "width of the door", "m", 0.7, 2.0)
ROOM_DOOR = PresetOption(1.1, "width of the door", "m", 0.7, 3.0)
GIVES_WAY = PresetOption(0.8, "share of people who give way to the robot", "", 0.0, 1.0)
AT_DOORS = ("stalled_time", "failures_to_progress", "min_clearance", "people_time_lost")

ROOMS = (
    Preset(
        "entering-room",
        TITLES["entering-room"],
        entering_room,
        {"door": ROOM_DOOR, "people": PresetOption(1, "people who leave", "", 1, 8)},
        cards=(
            ScenarioCard(
                name="Entering Room",
                setup="A room of 5 m by 5 m with an open door; people leave it.",
                robot="Wait beside the door until people are out, then enter.",
                success="People leave first, then the robot is in the room.",
                metrics=AT_DOORS,
                lacks="Doors that are opened, and people who stay in the room.",
            ),
        ),
    ),
    Preset(
        "exiting-room",
        TITLES["exiting-room"],
        exiting_room,
        {"door": ROOM_DOOR, "people": PresetOption(1, "people who enter", "", 1, 8), "gives_way": GIVES_WAY},
        cards=(
            ScenarioCard(
                name="Exiting Room",
                setup="A room of 5 m by 5 m with an open door; people go in.",
                robot="Come out without delay, and leave the door free.",
                success="The robot is out first, then people enter.",
                metrics=AT_DOORS,
                lacks="A rule for who goes first: each person gives way or does not.",
            ),
        ),
    ),
    Preset(
        "exiting-elevator",
        TITLES["exiting-elevator"],
        exiting_elevator,
        {"door": DOOR, "people": PresetOption(1, "people who enter", "", 1, 4), "gives_way": GIVES_WAY},
        cards=(
            ScenarioCard(
                name="Exiting Elevator",
                setup="A cabin of 2.2 m by 2.2 m with an open door; people go in.",
                robot="Come out without delay, and leave the door free.",
                success="The robot is out first, then people enter.",
                metrics=AT_DOORS,
                lacks="Moving doors, other passengers, and a rule for who goes first.",
            ),
        ),
    ),
)
