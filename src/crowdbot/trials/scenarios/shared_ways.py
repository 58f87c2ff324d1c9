"""Shared paths: base cases of one robot and a few people on the same path, or waiting for the robot.

Names are those of Francis et al. 2025, Principles and guidelines for evaluating social robot navigation algorithms,
doi:10.1145/3700599; geometry and numbers are our own. People cannot follow a robot or take anything from it; the
descriptions of such scenarios say what happens instead.
"""

from __future__ import annotations

import math

from crowdbot.core.fields import Points
from crowdbot.trials.agent import Agent
from crowdbot.trials.builtin_names import TITLES
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import Spawner
from crowdbot.trials.robots.reaction import ReactionSpec
from crowdbot.trials.stage import Stage
from crowdbot.trials.trial import Trial
from crowdbot.world import Direction

from .parts import STILL, box, corridor, robot, scenario
from .preset import Preset, PresetOption, ScenarioCard

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


def crash_cart(width: float, people: int, gives_way: float, robot_speed: float) -> Trial:
    """A fast robot goes along a corridor with people to a person who waits."""
    side = width / 2.0 - 0.4
    reactions = (ReactionSpec(type="give-way", share=gives_way, distance=6.0),) if gives_way else ()
    ways = {"east": people // 2, "west": people - people // 2}
    return scenario(
        "crash-cart",
        60.0,
        corridor(40.0, width),
        journeys=[Journey(name="east", stops=(Direction(0.0),)), Journey(name="west", stops=(Direction(BACK),))],
        agents=[Agent(name="taker", x=14.9, y=0.0, heading=BACK, speed=STILL)],
        spawners=[
            Spawner(name=way, count=count, zone=box(-8, -side, 12, side), journey=way, reactions=reactions)
            for way, count in ways.items()
            if count
        ],
        robots=[robot((-14.0, 0.0), (14.0, 0.0), robot_speed)],
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
        cards=(
            ScenarioCard(
                name="Leading",
                setup="A person walks behind the robot to the same goal.",
                robot="Go ahead at the speed of the person, and wait if they fall back.",
                success="The person arrives with the robot.",
                metrics=("mean_nearest_distance", "mean_speed", "mean_jerk"),
                lacks=(
                    "Following: the person walks at an own pace, whatever the robot does, and no built-in navigator "
                    "waits."
                ),
            ),
        ),
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
        model="orca",  # people who stand step aside
        cards=(
            ScenarioCard(
                name="Pedestrian Obstruction",
                setup="A corridor; people stand in its middle.",
                robot="Go around them where there is room, else wait.",
                success="The robot passes without contact.",
                metrics=("min_clearance", "personal_space_compliance", "stalled_time", "time_to_goal"),
                lacks="Asking people to step aside; `gives_way=true` lets them do it by themselves.",
            ),
        ),
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
        "SEAN: down path",
        cards=(
            ScenarioCard(
                name="Down Path",
                setup="A corridor; people walk with the robot and against it.",
                robot="Go along with the others, at their speed where it cannot pass.",
                success="The robot arrives without a contact.",
                metrics=("min_clearance", "time_to_goal", "stalled_time", "path_efficiency"),
                lacks="Lanes of more than a few people; see `two-way`.",
            ),
        ),
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
        cards=(
            ScenarioCard(
                name="Accompanying Peer",
                setup="A person walks beside the robot to a goal beside its own.",
                robot="Stay beside the person.",
                success="Both arrive together.",
                metrics=("mean_nearest_distance", "personal_space_compliance", "mean_jerk"),
                lacks="The bond: the person does not adapt, and no built-in navigator is told whom to accompany.",
            ),
        ),
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
        cards=(
            ScenarioCard(
                name="Object Handover",
                setup="An open space; a person stands and waits.",
                robot="Approach from the front and stop within reach.",
                success="The robot stands within reach of the person.",
                metrics=("min_clearance", "max_acceleration", "min_ttc"),
                lacks="The object, arms and hands: the trial ends when the robot is there.",
            ),
        ),
    ),
    Preset(
        "crash-cart",
        TITLES["crash-cart"],
        crash_cart,
        {
            "width": WIDTH,
            "people": PresetOption(6, "people who walk in the corridor", "", 0, 40),
            "gives_way": PresetOption(0.8, "share of people who give way to the robot", "", 0.0, 1.0),
            "robot_speed": PresetOption(1.5, "speed of the robot", "m/s", 0.1, 3.0),
        },
        cards=(
            ScenarioCard(
                name="Crash Cart",
                setup="A corridor; people walk both ways and most give way; somebody waits at its end.",
                robot="Go fast and on a line that people understand early, without touching anybody.",
                success="The robot stops within reach of the waiting person, with little delay.",
                metrics=("time_to_goal", "min_ttc", "max_impact_speed", "max_fear", "stalled_time"),
                lacks="Alarm and lights, the load, and the handover.",
            ),
        ),
    ),
)
