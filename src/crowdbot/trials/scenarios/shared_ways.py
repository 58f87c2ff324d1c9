"""Shared paths: base cases of one robot and a few people on the same path, or waiting for the robot.

Names are those of Francis et al. 2025, Principles and guidelines for evaluating social robot navigation algorithms,
doi:10.1145/3700599; geometry and numbers are our own. People cannot follow a robot or take anything from it; the
descriptions of such scenarios say what happens instead.
"""

from __future__ import annotations

import math

from crowdbot.trials.agent import Agent
from crowdbot.trials.builtin_names import TITLES
from crowdbot.trials.notation import Points
from crowdbot.trials.stage import Stage
from crowdbot.trials.trial import Trial

from .parts import STILL, box, corridor, robot, scenario
from .preset import Preset, PresetOption

WIDTH = PresetOption(3.0, "width of the corridor", "m", 1.6, 20.0)
ROBOT = PresetOption(1.0, "speed of the robot", "m/s", 0.1, 3.0)
BACK = math.pi
"""Heading [rad] towards the start of the robot."""


def robot_ahead(gap: float, speed: float, robot_speed: float) -> Trial:
    """A robot goes ahead of a person to the goal of the person."""
    return scenario(
        "leading",
        60.0,
        corridor(40.0, 2.5),
        agents=[Agent(name="follower", x=-10.0 - gap, y=0.0, goal=Points.of([(18.0, 0.0)]), speed=speed)],
        robots=[robot((-10.0, 0.0), (10.0, 0.0), robot_speed)],
    )


def pedestrian_obstruction(width: float, people: int, gives_way: bool) -> Trial:
    """People stand in the path of the robot."""
    speed = 1.34 if gives_way else STILL
    across = [0.6 * (k - (people - 1) / 2.0) for k in range(people)]
    return scenario(
        "pedestrian-obstruction",
        40.0,
        corridor(16.0, width),
        agents=[Agent(name=f"person{k + 1}", x=0.0, y=y, heading=BACK, speed=speed) for k, y in enumerate(across)],
        robots=[robot((-6.0, 0.0), (6.0, 0.0))],
    )


def down_path(width: float, people: int, against: int, speed: float) -> Trial:
    """People walk along the path of the robot in both directions."""
    side = width / 2.0 - 0.6
    agents = [
        Agent(
            name=f"ahead{k + 1}",
            x=-6.0 + 2.5 * k,
            y=side * (-1.0) ** (k + 1),
            goal=Points.of([(16.0, side * (-1.0) ** (k + 1))]),
            speed=speed,
        )
        for k in range(people)
    ]
    agents += [
        Agent(
            name=f"towards{k + 1}",
            x=8.0 - 2.5 * k,
            y=side * (-1.0) ** k,
            goal=Points.of([(-16.0, side * (-1.0) ** k)]),
            speed=speed,
        )
        for k in range(against)
    ]
    return scenario("down-path", 60.0, corridor(36.0, width), agents=agents, robots=[robot((-9.0, 0.0), (9.0, 0.0))])


def parallel_walk(gap: float, speed: float, robot_speed: float) -> Trial:
    """A robot and a person go side by side."""
    side = gap / 2.0
    return scenario(
        "parallel-walk",
        60.0,
        corridor(30.0, gap + 1.8),
        agents=[Agent(name="person", x=-10.0, y=side, goal=Points.of([(14.0, side)]), speed=speed)],
        robots=[robot((-10.0, -side), (10.0, -side), robot_speed)],
    )


def object_handover(reach: float, approach: float) -> Trial:
    """A robot approaches a waiting person and stops within reach."""
    turn = math.radians(approach)
    x, y = -6.0 * math.cos(turn), -6.0 * math.sin(turn)
    return scenario(
        "object-handover",
        40.0,
        Stage(walkable=box(-8, -7.5, 8, 7.5)),
        agents=[Agent(name="taker", x=0.0, y=0.0, heading=BACK, speed=STILL)],
        robots=[robot((x, y), (-reach, 0.0), 0.6, tolerance=0.15)],
    )


SHARED_WAYS = (
    Preset(
        "leading",
        TITLES["leading"],
        robot_ahead,
        {
            "gap": PresetOption(1.75, "distance between their centres at the beginning", "m", 0.6, 8.0),
            "speed": PresetOption(1.0, "speed of the person", "m/s", 0.1, 2.5),
            "robot_speed": ROBOT,
        },
        "P&G: leading",
    ),
    Preset(
        "pedestrian-obstruction",
        TITLES["pedestrian-obstruction"],
        pedestrian_obstruction,
        {
            "width": WIDTH,
            "people": PresetOption(1, "people who stand in the path", "", 1, 20),
            "gives_way": PresetOption(False, "whether they step aside"),
        },
        "P&G: pedestrian obstruction",
        model="orca",  # people who stand step aside
    ),
    Preset(
        "down-path",
        TITLES["down-path"],
        down_path,
        {
            "width": WIDTH,
            "people": PresetOption(2, "people who walk in the direction of the robot", "", 0, 4),
            "against": PresetOption(1, "people who walk towards the robot", "", 0, 3),
            "speed": PresetOption(0.8, "speed of the people", "m/s", 0.1, 2.5),
        },
        "P&G, SEAN: down path",
    ),
    Preset(
        "parallel-walk",
        TITLES["parallel-walk"],
        parallel_walk,
        {
            "gap": PresetOption(1.2, "distance between their paths", "m", 0.6, 5.0),
            "speed": PresetOption(1.0, "speed of the person", "m/s", 0.1, 2.5),
            "robot_speed": ROBOT,
        },
        "P&G: parallel walk",
    ),
    Preset(
        "object-handover",
        TITLES["object-handover"],
        object_handover,
        {
            "reach": PresetOption(0.9, "distance between their centres at which the robot stops", "m", 0.6, 2.0),
            "approach": PresetOption(
                30.0, "angle between the heading of the person and the start of the robot", "deg", -90.0, 90.0
            ),
        },
        "P&G: object handover",
    ),
)
