"""Crowds: a robot among many people.

Sources: Chen et al. 2019, Crowd-robot interaction, doi:10.1109/ICRA.2019.8794134 (circle and square crossing); Liu et
al. 2023, Intention aware robot crowd navigation, doi:10.1109/ICRA48891.2023.10160660 (dense circle); Fruin 1971,
Pedestrian planning and design (levels of service behind the densities); other numbers are our own.
"""

from __future__ import annotations

import math
from typing import Any

from crowdbot.core.fields import Points
from crowdbot.models import ORCA
from crowdbot.trials.builtin_names import TITLES
from crowdbot.trials.crowd import Routing
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.trials.robots.reaction import ReactionSpec
from crowdbot.trials.stage import Obstacle, Stage, Wall
from crowdbot.trials.trial import Trial
from crowdbot.world import ContactModel, Direction, Exit, Omnidirectional, Portal, Zone

from .parts import box, corridor, flow, number, pairs, robot, scenario
from .preset import Preset, PresetOption, ScenarioCard

DENSITIES = (0.05, 0.1, 0.25, 0.5, 0.75, 1.0, 1.5, 2.0, 3.0)
"""Densities of the density ladder [people/m2]; the last one is a stress test."""

LENGTH, HALF = 40.0, 20.0
DEEP = 4.0
"""Depth of portals [m]."""
EAST = Journey(name="east", stops=(Direction(0.0),))
WEST = Journey(name="west", stops=(Direction(math.pi),))
SOUTH = Journey(name="south", stops=(Direction(-math.pi / 2.0),))
NORTH = Journey(name="north", stops=(Direction(math.pi / 2.0),))
DENSITY = PresetOption(0.3, "density of people", "1/m2", 0.0, 3.0)
GROUPS = PresetOption(0.0, "share of people in groups of two and three", "", 0.0, 1.0)
WIDTH = PresetOption(6.0, "width of the corridor", "m", 2.0, 20.0)


def ends(length: float, width: float) -> tuple[Portal, Portal]:
    """Return portals at both ends of a corridor: people who leave at one end enter at the other."""
    x, y = length / 2.0, width / 2.0
    return (
        Portal(name="right", zone=box(x, -y, x + DEEP, y), dx=-length),
        Portal(name="left", zone=box(-x - DEEP, -y, -x, y), dx=length),
    )


def _count(density: float, length: float, width: float) -> int:
    return round(density * length * width)


def _flow_corridor(name: str, width: float, flows: dict[str, float], groups: float) -> Trial:
    """Return a corridor in which people walk east and west at densities [1/m2], and a robot goes east."""
    y = width / 2.0 - 0.25
    zone = box(-HALF + 0.5, -y, HALF - 0.5, y)
    people = [flow(way, _count(density, LENGTH, width), zone, way) for way, density in flows.items()]
    people = [Spawner(**_fields(person), groups=pairs(groups)) for person in people if person.count]
    return scenario(
        name,
        90.0,
        corridor(LENGTH + 10.0, width),
        contact=ContactModel(),
        journeys=[EAST, WEST],
        spawners=people,
        portals=ends(LENGTH, width),
        robots=[robot((-12.0, 0.0), (12.0, 0.0))],
    )


def _fields(spawner: Spawner) -> dict[str, Any]:
    return {"name": spawner.name, "count": spawner.count, "zone": spawner.zone, "journey": spawner.journey}


def one_way_with(density: float, width: float, groups: float) -> Trial:
    """People walk in the direction of the robot."""
    return _flow_corridor("one-way-with", width, {"east": density}, groups)


def one_way_against(density: float, width: float, groups: float) -> Trial:
    """People walk against the robot."""
    return _flow_corridor("one-way-against", width, {"west": density}, groups)


def two_way(density: float, width: float, groups: float) -> Trial:
    """People walk in both directions."""
    return _flow_corridor("two-way", width, {"east": density / 2.0, "west": density / 2.0}, groups)


def density_ladder(density: float) -> Trial:
    """An endless corridor of 20 m by 5 m."""
    y, count = 2.5 - 0.35, _count(density, 20.0, 5.0)
    zone = box(-9.7, -y, 9.7, y)
    body = 0.25 if density < 1.75 else 0.2
    people = [
        Spawner(name=way, count=n, zone=zone, journey=way, radius=number(body))
        for way, n in (("east", count - count // 2), ("west", count // 2))
        if n
    ]
    return scenario(
        "density-ladder",
        60.0,
        corridor(30.0, 5.0),
        contact=ContactModel(),
        journeys=[EAST, WEST],
        spawners=people,
        portals=ends(20.0, 5.0),
        robots=[robot((-8.0, 0.0), (8.0, 0.0))],
    )


def crossing(density: float, both: bool) -> Trial:
    """People cross the path of the robot."""
    side = 12.0
    ways = ("south", "north") if both else ("south",)
    count = _count(density, side, side) // len(ways)
    low = Portal(name="low", zone=box(-6, -6 - DEEP, 6, -6), dy=side)
    high = Portal(name="high", zone=box(-6, 6, 6, 6 + DEEP), dy=-side)
    return scenario(
        "perpendicular-flow",
        60.0,
        Stage(walls=(Wall(Points.of([(-6.5, -10), (-6.5, -2)])), Wall(Points.of([(-6.5, 2), (-6.5, 10)])),
                     Wall(Points.of([(6.5, -10), (6.5, -2)])), Wall(Points.of([(6.5, 2), (6.5, 10)])))),
        contact=ContactModel(),
        journeys=[SOUTH, NORTH],
        spawners=[flow(way, count, box(-5.7, -5.7, 5.7, 5.7), way) for way in ways if count],
        portals=[low, high],
        robots=[robot((-8.0, 0.0), (8.0, 0.0))],
    )  # fmt: skip


def circle_crossing(people: int, radius: float, noise: float, limit: float, horizon: float) -> Trial:
    """People on a circle and a robot go to the opposite side."""
    spawners, r = [], radius
    right = (people + 1) // 2
    for k in range(people):
        # the robot goes from the lowest to the highest point, so nobody starts there
        side, place, of = (0.0, k, right) if k < right else (math.pi, k - right, people - right)
        angle = side - math.pi / 2.0 + math.pi * (place + 1) / (of + 1)
        x, y = r * math.cos(angle), r * math.sin(angle)
        spawners.append(
            Spawner(
                name=f"person{k + 1}",
                count=1,
                zone=box(x - noise, y - noise, x + noise, y + noise),
                goal=box(-x - noise, -y - noise, -x + noise, -y + noise),
                speed=number(1.0),
                radius=number(0.3),
                arrival="stay",
            )
        )
    return scenario(
        "circle-crossing",
        limit,
        Stage(),
        crowd=ORCA(neighbor_distance=10.0, max_neighbors=10.0, time_horizon=horizon, time_horizon_walls=horizon),
        spawners=spawners,
        robots=[robot((0.0, -radius), (0.0, radius), drive=Omnidirectional(max_speed=1.0), visible=False)],
    )


def dense_circle(people: int, radius: float) -> Trial:
    """Twenty people on a circle."""
    return circle_crossing(people, radius, 0.4, 50.0, 5.0)


def square_crossing(people: int, side: float) -> Trial:
    """People on the left and on the right of a square swap sides."""
    h, left = side / 2.0, people // 2
    west, east = box(-h, -h, -h + 1.5, h), box(h - 1.5, -h, h, h)
    spawners = [
        Spawner(name="left", count=left, zone=west, goal=east, speed=number(1.0), radius=number(0.3), arrival="stay"),
        Spawner(
            name="right",
            count=people - left,
            zone=east,
            goal=west,
            speed=number(1.0),
            radius=number(0.3),
            arrival="stay",
        ),
    ]
    return scenario(
        "square-crossing",
        30.0,
        Stage(),
        spawners=[spawner for spawner in spawners if spawner.count],
        robots=[robot((0.0, -h), (0.0, h))],
    )


def static_crowd(density: float, groups: float) -> Trial:
    """Standing people."""
    return scenario(
        "static-crowd",
        60.0,
        Stage(walkable=box(-8, -4, 8, 4)),
        spawners=[
            Spawner(
                name="standing",
                count=max(1, _count(density, 10.0, 7.0)),
                zone=box(-5, -3.5, 5, 3.5),
                stands=True,
                groups=pairs(groups),
            )
        ],
        robots=[robot((-7.0, 0.0), (7.0, 0.0))],
    )


def random_goals(people: int, side: float) -> Trial:
    """People walk between random goals."""
    h = side / 2.0
    inside = box(-h + 0.5, -h + 0.5, h - 0.5, h - 0.5)
    return scenario(
        "random-goals",
        90.0,
        Stage(walkable=box(-h, -h, h, h)),
        contact=ContactModel(),
        journeys=[Journey(name="about", then="again", stops=(Zone(inside, aim="random"),))],
        spawners=[Spawner(name="people", count=people, zone=inside, journey="about")],
        robots=[robot((-h + 1.0, -h + 1.0), (h - 1.0, h - 1.0))],
    )


def robot_crowding(people: int, curious: float) -> Trial:
    """People around a robot come close, and the robot leaves."""
    return scenario(
        "robot-crowding",
        60.0,
        Stage(walkable=box(-8, -8, 8, 8)),
        contact=ContactModel(),
        journeys=[Journey(name="about", then="again", stops=(Zone(box(-5, -5, 5, 5), aim="random"),))],
        spawners=[
            Spawner(
                name="people",
                count=people,
                zone=box(-4, -4, 4, 4),
                journey="about",
                reactions=(ReactionSpec(type="curious", share=curious, distance=5.0, gap=0.5),) if curious else (),
            )
        ],
        robots=[robot((0.0, 0.0), (6.5, 0.0))],
    )


def bottleneck(door: float, rate: float) -> Trial:
    """People enter on the left and leave through a door; a robot crosses the hall behind it."""
    half = door / 2.0
    near = half - 0.1 if half > 0.4 else half
    return scenario(
        "bottleneck",
        60.0,
        Stage(
            walkable=box(-10, -5, 10, 5),
            walls=(Wall(Points.of([(0, -5), (0, -half)])), Wall(Points.of([(0, half), (0, 5)]))),
            obstacles=(Obstacle(box(-4, 1, -3, 3)),),
        ),
        routing=Routing(radius=min(0.3, half - 0.05)),
        crowd=ORCA(neighbor_distance=5.0, max_neighbors=10.0, time_horizon=2.0, time_horizon_walls=0.5),
        contact=ContactModel(),
        journeys=[
            Journey(
                name="through",
                stops=(
                    Zone(box(0.5, -near, 1.5, near)),
                    Zone(box(9, -4.5, 10, 4.5), aim="random"),
                ),
            )
        ],
        spawners=[flow("hall", 6, box(-7, -4.5, -5, 4.5), "through")],
        sources=[SourceSpec(name="entrance", zone=box(-9.7, -4.5, -8, 4.5), journey="through", rate=rate)],
        exits=[Exit(name="right", zone=box(8.8, -5, 10, 5))],
        robots=[robot((3.0, -4.0), (3.0, 4.0), 0.65)],
    )


CROWDS = (
    Preset(
        "one-way-with",
        TITLES["one-way-with"],
        one_way_with,
        {"density": DENSITY, "width": WIDTH, "groups": GROUPS},
        "UMANS: one-way flow; CrowdBot: 1-D, with the flow",
        cards=(
            ScenarioCard(
                name="Parallel Traffic",
                setup="An endless corridor; a flow walks in the direction of the robot.",
                robot="Join the flow at its speed.",
                success="The robot arrives; the flow is not slowed down.",
                metrics=("velocity_loss_2_5m", "neighbor_speed_ratio", "personal_space_compliance", "time_to_goal"),
                lacks="Ends of the corridor: people who leave enter again.",
            ),
        ),
    ),
    Preset(
        "one-way-against",
        TITLES["one-way-against"],
        one_way_against,
        {"density": DENSITY, "width": WIDTH, "groups": GROUPS},
        "social-jym: parallel traffic (14 m by 3 m: `width=3`); CrowdBot: 1-D, against the flow",
    ),
    Preset(
        "two-way",
        TITLES["two-way"],
        two_way,
        {"density": DENSITY, "width": WIDTH, "groups": GROUPS},
        "UMANS: corridor; CrowdBot: bi-directional",
    ),
    Preset(
        "density-ladder",
        TITLES["density-ladder"],
        density_ladder,
        {"density": PresetOption(0.5, f"density: {', '.join(f'{d:g}' for d in DENSITIES)}", "1/m2", 0.0, 3.0)},
    ),
    Preset(
        "perpendicular-flow",
        TITLES["perpendicular-flow"],
        crossing,
        {"density": DENSITY, "both": PresetOption(False, "whether people come from both sides")},
        "social-jym: perpendicular traffic; CrowdBot: 2-D crossing",
        cards=(
            ScenarioCard(
                name="Perpendicular Traffic",
                setup="A flow crosses the path of the robot.",
                robot="Cross through gaps, without stopping the flow.",
                success="The robot is across; nobody is obstructed.",
                metrics=("min_ttc", "velocity_loss_2_5m", "gate_flow_loss", "time_to_goal"),
                lacks="Traffic lights and right of way.",
            ),
        ),
    ),
    Preset(
        "circle-crossing",
        TITLES["circle-crossing"],
        circle_crossing,
        {
            "people": PresetOption(5, "people", "", 1, 60),
            "radius": PresetOption(4.0, "radius of the circle", "m", 2.0, 30.0),
            "noise": PresetOption(0.35, "half width of the square in which a person starts", "m", 0.05, 2.0),
            "limit": PresetOption(25.0, "duration", "s", 5.0, 600.0),
            "horizon": PresetOption(5.0, "time horizon of people", "s", 0.5, 10.0),
        },
        "CrowdNav: circle crossing; social-jym: circular crossing (`radius=7`); UMANS: circle 5 to 50 (`people`)",
        model="orca",
        cards=(
            ScenarioCard(
                name="Circular Crossing",
                setup="People on a circle and the robot go to the opposite side.",
                robot="Pass the crowded centre or go around it.",
                success="Everybody arrives without a contact.",
                metrics=("time_to_goal", "min_clearance", "discomfort_share"),
                lacks="People who see the robot: they do not, as in CrowdNav; `robot/visible=true` changes it.",
            ),
        ),
    ),
    Preset(
        "dense-circle",
        TITLES["dense-circle"],
        dense_circle,
        {
            "people": PresetOption(20, "people", "", 1, 60),
            "radius": PresetOption(8.49, "radius of the circle", "m", 2.0, 30.0),
        },
        "CrowdNav_Prediction_AttnGraph: 20 people",
        model="orca",
    ),
    Preset(
        "square-crossing",
        TITLES["square-crossing"],
        square_crossing,
        {
            "people": PresetOption(10, "people", "", 1, 60),
            "side": PresetOption(10.0, "side of the square", "m", 5.0, 40.0),
        },
        "CrowdNav: square crossing",
        model="orca",
    ),
    Preset(
        "static-crowd",
        TITLES["static-crowd"],
        static_crowd,
        {"density": PresetOption(0.25, "density of people", "1/m2", 0.0, 1.5), "groups": GROUPS},
        "social-jym: robot crowding; CrowdBot: static crowd",
        model="orca",  # people who stand step aside
    ),
    Preset(
        "random-goals",
        TITLES["random-goals"],
        random_goals,
        {
            "people": PresetOption(30, "people", "", 1, 400),
            "side": PresetOption(20.0, "side of the square", "m", 6.0, 100.0),
        },
        "social-jym: crowd navigation; MengeROS, ir-sim: wandering",
        cards=(
            ScenarioCard(
                name="Crowd Navigation",
                setup="A square; people walk between random places.",
                robot="Go through gaps and make steady progress.",
                success="The robot crosses the crowd without a contact.",
                metrics=("personal_space_compliance", "path_efficiency", "stalled_time", "crowd_disturbance"),
                lacks="People who stop, talk or change their mind; see `static-crowd` and `two-crowds`.",
            ),
        ),
    ),
    Preset(
        "robot-crowding",
        TITLES["robot-crowding"],
        robot_crowding,
        {
            "people": PresetOption(16, "people", "", 1, 60),
            "curious": PresetOption(0.7, "share of people who come close to the robot", "", 0.0, 1.0),
        },
        cards=(
            ScenarioCard(
                name="Robot Crowding",
                setup="People walk around the robot; most come to it, stop at 0.5 m and look.",
                robot="Start slowly, wait for a gap, and leave.",
                success="The robot is out of the crowd without a contact.",
                metrics=("min_clearance", "contacts", "stalled_time", "intimate_share"),
                lacks="Touching and teasing; `block` reactions of people are near to it.",
            ),
        ),
    ),
    Preset(
        "bottleneck",
        TITLES["bottleneck"],
        bottleneck,
        {
            "door": PresetOption(1.4, "width of the door", "m", 0.7, 6.0),
            "rate": PresetOption(0.7, "arrivals", "1/s", 0.01, 10.0),
        },
        "Seyfried, Juelich: doors of 0.8 to 5 m (`door`)",
    ),
)
