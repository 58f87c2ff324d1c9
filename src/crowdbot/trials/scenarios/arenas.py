"""Arenas: scenarios of other simulators, among them circles, corners and blocks.

Sources: the names "delayed circular crossing", "circular crossing with static obstacles" and "corner traffic" with
their sizes (a circle of 7 m; delays up to 5 s; three people of 1 m +- 0.2 m on a circle that is 3 m smaller; arms of
7 m that are 3 m wide; 5 people) are those of social-jym, https://github.com/TommasoVandermeer/social-jym; "1 to 10",
"25 to 25", "block" and "four blocks" are names of examples of UMANS, van Toll et al. 2020,
doi:10.1145/3384382.3384532, whose numbers we could not read. People in the corners of four blocks are an example of
RVO2, van den Berg et al. 2011, doi:10.1007/978-3-642-19457-3_1. Other numbers are our own.
"""

from __future__ import annotations

import dataclasses
import math

from crowdbot.core.fields import Points
from crowdbot.trials.agent import Agent
from crowdbot.trials.builtin_names import TITLES
from crowdbot.trials.crowd import Routing
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.trials.stage import Obstacle, Stage
from crowdbot.trials.trial import RobotSpec, Trial
from crowdbot.world import ContactModel, Zone

from .crowds import circle_crossing
from .parts import STILL, box, number, robot, scenario, uniform
from .preset import Preset, PresetOption

GOLDEN = 0.6180339887498949
"""Golden ratio: the fractional parts of its multiples are spread evenly."""
RADIUS = PresetOption(7.0, "radius of the circle", "m", 4.0, 30.0)


def _seen(robots: tuple[RobotSpec, ...]) -> tuple[RobotSpec, ...]:
    return tuple(dataclasses.replace(item, visible=True) for item in robots)


def delayed_circle(people: int, radius: float, delay: float) -> Trial:
    """A circle crossing with delayed arrivals."""
    plain = circle_crossing(people, radius, 0.35, 40.0, 5.0)
    sources = [
        SourceSpec(
            name=spawner.name,
            zone=spawner.zone,
            goal=spawner.goal,
            rate=1.0,
            timing="regular",
            begin=round(delay * (k * GOLDEN % 1.0), 1),
            max_count=1,
            speed=spawner.speed,
            radius=spawner.radius,
            arrival="stay",
        )
        for k, spawner in enumerate(plain.spawners)
    ]
    return dataclasses.replace(plain, spawners=(), sources=tuple(sources), robots=_seen(plain.robots))


def circle_with_standing(people: int, standing: int, radius: float, size: float) -> Trial:
    """A circle crossing around people who stand."""
    plain = circle_crossing(people, radius, 0.35, 60.0, 5.0)
    inner, spawners = radius - 3.0, []
    for k in range(standing):
        angle = math.pi / max(standing, 1) * (2.0 * k - 0.5)
        x, y = inner * math.cos(angle), inner * math.sin(angle)
        zone = box(x - 0.1, y - 0.1, x + 0.1, y + 0.1)
        broad = uniform(0.8 * size, 1.2 * size)
        spawners.append(
            Spawner(name=f"standing{k + 1}", count=1, zone=zone, stands=True, radius=broad, speed=number(STILL))
        )
    return dataclasses.replace(plain, spawners=(*spawners, *plain.spawners), robots=_seen(plain.robots))


def corner_traffic(people: int, width: float, length: float) -> Trial:
    """People turn a corner, and the robot turns it in the opposite direction."""
    h, far = width / 2.0, length
    ground = Points.of([(-far, -h), (-h, -h), (-h, -far), (h, -far), (h, h), (-far, h)])
    turn, inside = box(-h + 0.3, -h + 0.3, h - 0.3, h - 0.3), h - 0.35
    return scenario(
        "corner-traffic",
        max(60.0, 5.0 * length),
        Stage(walkable=ground),
        routing=Routing(radius=0.3),
        contact=ContactModel(),
        journeys=[
            Journey(name="round", stops=(Zone(turn), Zone(box(-far + 0.3, -inside, -far + 1.3, inside), aim="random")))
        ],
        spawners=[
            Spawner(name="people", count=people, zone=box(-inside, -far + 0.5, inside, -h - 0.5), journey="round")
        ],
        robots=[robot((-far + 1.0, 0.0), (0.0, -far + 1.0), 0.8)],
    )


def block(people: int, size: float) -> Trial:
    """A block obstructs a robot and people who walk towards it."""
    # robots have no map: off the centre of the block they slide along it, at the centre they wait
    goal = (7.0, -min(size / 2.0 + 1.0, 4.3))
    return scenario(
        "block",
        60.0,
        Stage(walkable=box(-10, -5, 10, 5), obstacles=(Obstacle(box(-1.5, -size / 2.0, 1.5, size / 2.0)),)),
        routing=Routing(radius=0.3),
        contact=ContactModel(),
        spawners=[Spawner(name="people", count=people, zone=box(3, -4, 9.5, 4), goal=box(-9.5, -4, -8, 4))],
        robots=[robot((-7.0, size / 4.0), goal)],
    )


def four_blocks(people: int, passage: float) -> Trial:
    """People in four corners walk to the opposite corners between four blocks, and a robot crosses."""
    near, far = passage / 2.0, passage / 2.0 + 4.0
    end = far + 4.0
    corners = {"low_left": (-1, -1), "low_right": (1, -1), "high_right": (1, 1), "high_left": (-1, 1)}

    def corner(x: int, y: int, low: float, high: float) -> Points:
        return box(min(x * low, x * high), min(y * low, y * high), max(x * low, x * high), max(y * low, y * high))

    return scenario(
        "four-blocks",
        90.0,
        Stage(
            walkable=box(-end, -end, end, end),
            obstacles=tuple(Obstacle(corner(x, y, near, far)) for x, y in corners.values()),
        ),
        routing=Routing(radius=0.3),
        contact=ContactModel(),
        spawners=[
            Spawner(
                name=name,
                count=people,
                zone=corner(x, y, far + 0.5, end - 0.5),
                goal=corner(-x, -y, far + 0.5, end - 0.5),
            )
            for name, (x, y) in corners.items()
        ],
        robots=[robot((-end + 1.0, 0.0), (end - 1.0, 0.0))],
    )


def _rotate(points: Points, angle: float) -> Points:
    """Return points rotated about the origin."""
    along, across = math.cos(angle), math.sin(angle)
    return Points.of(
        [(round(x * along - y * across, 6), round(x * across + y * along, 6)) for x, y in points],
    )


def _crowd(name: str, people: int, away: float, angle: float, speed: float) -> Spawner:
    """Return people with about 1 m2 each, who walk across the origin at an angle."""
    half = max(0.8, math.sqrt(people) / 2.0)
    zone = box(-away - half, -half, -away + half, half)
    goal = box(away - half, -half, away + half, half)
    return Spawner(name=name, count=people, zone=_rotate(zone, angle), goal=_rotate(goal, angle), speed=number(speed))


def one_against_ten(people: int, angle: float, speed: float) -> Trial:
    """A crowd crosses the path of the robot."""
    away = 6.0 * speed
    return scenario(
        "one-against-ten",
        60.0,
        Stage(),
        spawners=[_crowd("crowd", people, away, math.radians(angle), speed)],
        robots=[robot((-6.0, 0.0), (6.0, 0.0))],
    )


def crowd_against_crowd(people: int, angle: float, formation: bool) -> Trial:
    """Two crowds meet, and a robot crosses the place where they do."""
    turn, away = math.radians(angle), 6.0 + math.sqrt(people) / 2.0
    ways = {"first": 0.0, "second": turn}
    x, y = -away * math.cos(turn / 2.0), -away * math.sin(turn / 2.0)
    crowds = [] if formation else [_crowd(name, people, away, way, 1.3) for name, way in ways.items()]
    ranks = [item for name, way in ways.items() for item in _formation(name, people, away, way)] if formation else []
    return scenario(
        "crowd-against-crowd",
        60.0,
        Stage(),
        contact=ContactModel(),
        spawners=crowds,
        agents=ranks,
        robots=[robot((x, y), (-x, -y))],
    )


def _formation(name: str, people: int, away: float, angle: float) -> list[Agent]:
    """Return people in ranks, 1 m apart, each with a goal mirrored at the centre."""
    wide = math.ceil(math.sqrt(people))
    places = [(-away - k // wide + (wide - 1) / 2.0, k % wide - (wide - 1) / 2.0) for k in range(people)]
    starts = _rotate(Points.of(places), angle)
    goals = _rotate(Points.of([(x + 2.0 * away, y) for x, y in places]), angle)
    return [
        Agent(name=f"{name}{k + 1}", x=x, y=y, goal=Points.of([goal]), speed=1.3)
        for k, ((x, y), goal) in enumerate(zip(starts, goals, strict=True))
    ]


ARENAS = (
    Preset(
        "delayed-circle",
        TITLES["delayed-circle"],
        delayed_circle,
        {
            "people": PresetOption(5, "people", "", 1, 60),
            "radius": RADIUS,
            "delay": PresetOption(5.0, "maximum delay of a person", "s", 0.0, 60.0),
        },
        "social-jym: delayed circular crossing",
        model="orca",
    ),
    Preset(
        "circle-with-standing",
        TITLES["circle-with-standing"],
        circle_with_standing,
        {
            "people": PresetOption(2, "people who walk", "", 1, 60),
            "standing": PresetOption(3, "people who stand", "", 0, 8),
            "radius": RADIUS,
            "size": PresetOption(1.0, "radius of standing people, +- 20 %", "m", 0.2, 1.5),
        },
        "social-jym: circular crossing with static obstacles",
        model="orca",
    ),
    Preset(
        "corner-traffic",
        TITLES["corner-traffic"],
        corner_traffic,
        {
            "people": PresetOption(5, "people", "", 1, 40),
            "width": PresetOption(3.0, "width of the corridor", "m", 1.6, 6.0),
            "length": PresetOption(7.0, "length of both arms, from the centre of the corner", "m", 5.0, 30.0),
        },
        "social-jym: corner traffic",
    ),
    Preset(
        "block",
        TITLES["block"],
        block,
        {
            "people": PresetOption(12, "people", "", 0, 40),
            "size": PresetOption(4.0, "width of the block", "m", 1.0, 7.0),
        },
        "UMANS: block",
    ),
    Preset(
        "four-blocks",
        TITLES["four-blocks"],
        four_blocks,
        {
            "people": PresetOption(5, "people in each corner", "", 0, 12),
            "passage": PresetOption(2.5, "distance between blocks", "m", 1.2, 8.0),
        },
        "UMANS: four blocks; RVO2: blocks",
    ),
    Preset(
        "one-against-ten",
        TITLES["one-against-ten"],
        one_against_ten,
        {
            "people": PresetOption(10, "people in the crowd", "", 1, 60),
            "angle": PresetOption(90.0, "angle between the paths, 180 for head-on", "deg", 45.0, 180.0),
            "speed": PresetOption(1.2, "speed of the people", "m/s", 0.5, 2.5),
        },
        "UMANS: 1 to 10 at 45, 90 and 180 degrees",
    ),
    Preset(
        "crowd-against-crowd",
        TITLES["crowd-against-crowd"],
        crowd_against_crowd,
        {
            "people": PresetOption(25, "people in each crowd", "", 1, 100),
            "angle": PresetOption(180.0, "angle between the paths of the crowds", "deg", 60.0, 180.0),
            "formation": PresetOption(False, "whether people walk in ranks"),
        },
        "UMANS: 25 to 25, 50 to 50 in formation, 100 to 100",
    ),
)
