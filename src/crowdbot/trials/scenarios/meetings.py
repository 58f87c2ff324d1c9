"""Meetings: one robot and a few people, the base cases of social navigation.

Sources: Francis et al. 2025, Principles and guidelines for evaluating social robot navigation algorithms,
doi:10.1145/3700599 (the list of scenarios); numbers that are not given there are our own.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Any

from crowdbot.core.fields import Points
from crowdbot.trials.agent import Agent
from crowdbot.trials.builtin_names import TITLES
from crowdbot.trials.crowd import Routing
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import Spawner
from crowdbot.trials.robots.reaction import ReactionSpec
from crowdbot.trials.stage import Stage, Wall
from crowdbot.trials.trial import Trial
from crowdbot.world import DifferentialDrive, Point

from .parts import box, corridor, robot, scenario, uniform
from .preset import Preset, PresetOption, ScenarioCard

WIDTH = PresetOption(3.0, "width of the corridor", "m", 1.2, 20.0)
PERSON = PresetOption(1.2, "speed of the person", "m/s", 0.1, 2.5)
ROBOT = PresetOption(1.0, "speed of the robot", "m/s", 0.1, 3.0)


def frontal(width: float, gap: float, low: float, high: float) -> Trial:
    """A robot and a person meet head-on."""
    half = gap / 2.0
    return scenario(
        "frontal",
        40.0,
        corridor(gap + 7.0, width),
        spawners=[
            Spawner(
                name="person",
                count=1,
                zone=box(half, -0.2, half + 0.4, 0.2),
                goal=box(-half - 2.5, -0.5, -half - 1.5, 0.5),
                speed=uniform(min(low, high), max(low, high)),
            )
        ],
        robots=[robot((-half, 0.0), (half, 0.0))],
    )


def intersection(angle: float, delay: float, width: float, density: float, speed: float, robot_speed: float) -> Trial:
    """Two corridors cross; a person, or a flow, comes from the side."""
    import shapely

    far, turn = 10.0, math.radians(angle)
    along, across = math.cos(turn), math.sin(turn)
    main = shapely.box(-far, -width / 2.0, far, width / 2.0)
    side = shapely.affinity.rotate(main, angle, origin=(0.0, 0.0))
    ground = shapely.set_precision(shapely.union_all([main, side]), 1e-6)
    count = max(1, round(density * width * (far - width)))
    reach = speed * (6.0 / robot_speed + delay)
    parts: dict[str, Any] = {
        "robots": [robot((-6.0, 0.0), (6.0, 0.0), robot_speed)],
        "stage": Stage(area=shapely.to_wkt(ground, trim=True, rounding_precision=6)),
    }
    end = Points.of([(9.0 * along, 9.0 * across)])
    if density == 0.0:
        away = min(max(reach, 1.0), 9.5)
        parts["agents"] = [Agent(name="person", x=-away * along, y=-away * across, goal=end, speed=speed)]
    else:
        half, first, last = width / 2.0 - 0.35, -far + 0.5, -width - 0.5
        corners = [(first, -half), (last, -half), (last, half), (first, half)]
        turned = [(x * along - y * across, x * across + y * along) for x, y in corners]
        goal = [(-x * along - y * across, -x * across + y * along) for x, y in corners]
        parts["spawners"] = [
            Spawner(
                name="side",
                count=count,
                zone=Points.of(turned),
                goal=Points.of(goal),
                speed=Distribution("normal", (speed, min(0.2, speed / 4.0))),
            )
        ]
    return scenario("intersection", 60.0, **parts)


def gesture_crossing(
    gesture: str, distance: float, delay: float, width: float, speed: float, robot_speed: float
) -> Trial:
    """Two corridors cross; a person from the side tells the robot who goes first."""
    trial = intersection(90.0, delay, width, 0.0, speed, robot_speed)
    (person,) = trial.agents
    reaction = ReactionSpec(type="look", gesture=gesture, distance=distance, duration=20.0)
    return dataclasses.replace(trial, agents=(dataclasses.replace(person, reactions=(reaction,)),))


def blind_corner(width: float, speed: float, distance: float) -> Trial:
    """An L-shaped corridor hides a person until the last moment."""
    w = width
    ground = Points.of([(-9, 0), (w, 0), (w, -9), (0, -9), (0, -w), (-9, -w)]).shift(-w / 2.0, w / 2.0)
    return scenario(
        "blind-corner",
        60.0,
        Stage(walkable=ground),
        routing=Routing(radius=0.3),
        agents=[Agent(name="person", x=0.0, y=-distance, goal=Points.of([(-8.0, 0.0)]), speed=speed)],
        robots=[robot((-6.0, -0.1), (0.1, -6.0), 0.8)],
    )


def doorway(door: float, speed: float) -> Trial:
    """A robot and a person go through a door from opposite sides."""
    half = door / 2.0
    return scenario(
        "doorway",
        60.0,
        Stage(
            walkable=box(-6, -3, 6, 3),
            walls=(Wall(Points.of([(0, -3), (0, -half)])), Wall(Points.of([(0, half), (0, 3)]))),
        ),
        routing=Routing(radius=0.27),
        agents=[Agent(name="person", x=5.0, y=0.6, goal=Points.of([(-5.0, 0.6)]), speed=speed)],
        robots=[robot((-4.0, -0.2), (4.0, -0.2), 0.7)],
    )


def elevator(door: float, people: int) -> Trial:
    """People leave a small room that the robot wants to enter."""
    half = door / 2.0
    walls = [[(0, -half), (0, -1.1), (2.2, -1.1), (2.2, 1.1), (0, 1.1), (0, half)]]
    return scenario(
        "elevator",
        60.0,
        Stage(walkable=box(-7, -4, 4, 4), walls=tuple(Wall(Points.of(points)) for points in walls)),
        routing=Routing(radius=0.27),
        journeys=[
            Journey(
                name="out",
                stops=(
                    Point(-1.2, 0.9),
                    Point(-6.0, 3.0),
                ),
            )
        ],
        spawners=[
            Spawner(
                name="leaving", count=people, zone=box(0.4, -0.7, 1.8, 0.7), journey="out", radius=uniform(0.2, 0.25)
            )
        ],
        robots=[robot((-5.0, -1.0), (1.1, 0.0), 0.7)],
    )


def overtaking(width: float, speed: float, robot_speed: float) -> Trial:
    """A robot approaches a slow person from behind."""
    return scenario(
        "overtaking",
        60.0,
        corridor(34.0, width),
        agents=[Agent(name="person", x=-8.0, y=0.0, goal=Points.of([(16.0, 0.0)]), speed=speed)],
        robots=[robot((-12.0, 0.0), (12.0, 0.0), robot_speed)],
    )


def being_overtaken(width: float, speed: float, robot_speed: float) -> Trial:
    """A person approaches a slow robot from behind."""
    return scenario(
        "being-overtaken",
        60.0,
        corridor(34.0, width),
        agents=[Agent(name="person", x=-12.0, y=0.0, goal=Points.of([(16.0, 0.0)]), speed=speed)],
        robots=[robot((-8.0, 0.0), (8.0, 0.0), robot_speed)],
    )


def following(gap: float, speed: float, robot_speed: float) -> Trial:
    """A person walks ahead of the robot in the same direction."""
    return scenario(
        "following",
        60.0,
        corridor(40.0, 2.5),
        agents=[Agent(name="leader", x=-10.0 + gap, y=0.0, goal=Points.of([(19.0, 0.0)]), speed=speed)],
        robots=[robot((-10.0, 0.0), (10.0, 0.0), robot_speed)],
    )


def _formation(people: int, radius: float) -> list[Agent]:
    """Return people who stand on a circle and face its centre; one place, on the left, is free."""
    agents = []
    for k in range(1, people + 1):
        angle = math.pi + 2.0 * math.pi * k / (people + 1)
        agents.append(
            Agent(
                name=f"member{k}",
                x=radius * math.cos(angle),
                y=radius * math.sin(angle),
                heading=math.remainder(angle + math.pi, 2.0 * math.pi),
                group=0,
            )
        )
    return agents


def joining_group(people: int, radius: float) -> Trial:
    """A robot takes the free place in a group of people who talk."""
    return scenario(
        "joining-group",
        40.0,
        Stage(walkable=box(-7, -4, 5, 4)),
        agents=_formation(people, radius),
        robots=[robot((-6.0, 0.0), (-radius - 0.15, 0.0), 0.6, tolerance=0.2)],
    )


def leaving_group(people: int, radius: float) -> Trial:
    """A robot leaves a group of people who talk."""
    free = -radius - 0.15
    return scenario(
        "leaving-group",
        40.0,
        Stage(walkable=box(-7, -4, 5, 4)),
        agents=_formation(people, radius),
        robots=[robot((free, 0.0), (-6.0, 0.0), 0.6)],
    )


def passing_group(gap: float) -> Trial:
    """Two people who talk stand on both sides of the robot's path."""
    half = gap / 2.0
    agents = [
        Agent(name="left", x=0.0, y=half, heading=-math.pi / 2.0, group=0),
        Agent(name="right", x=0.0, y=-half, heading=math.pi / 2.0, group=0),
    ]
    return scenario(
        "passing-group",
        40.0,
        Stage(walkable=box(-7, -4, 7, 4)),
        agents=agents,
        robots=[robot((-5.0, 0.0), (5.0, 0.0), drive=DifferentialDrive(max_speed=1.0, max_turn_rate=1.5))],
    )


PEOPLE = PresetOption(4, "people in the group", "", 1, 8)
CIRCLE = PresetOption(1.2, "radius of the circle", "m", 0.6, 3.0)
GESTURE = {
    "distance": PresetOption(
        6.0, "distance of the robot that is seen from which the person makes the gesture", "m", 1.0, 20.0
    ),
    "delay": PresetOption(0.0, "delay of the person at the crossing without the gesture", "s", -2.0, 2.0),
    "width": PresetOption(3.0, "width of the corridors", "m", 1.2, 6.0),
    "speed": PERSON,
    "robot_speed": ROBOT,
}
HIDDEN = "Gestures that are misread, or hidden from cameras: a robot that sees the person knows the gesture."

MEETINGS = (
    Preset(
        "frontal",
        TITLES["frontal"],
        frontal,
        {
            "width": WIDTH,
            "gap": PresetOption(9.0, "distance between them at the beginning", "m", 3.0, 40.0),
            "low": PresetOption(1.0, "smallest speed of the person", "m/s", 0.1, 2.5),
            "high": PresetOption(1.4, "largest speed of the person", "m/s", 0.1, 2.5),
        },
        "UMANS: 1 to 1, 180 degrees",
        cards=(
            ScenarioCard(
                name="Frontal Approach",
                setup="A corridor; a person walks towards the robot.",
                robot="Pass the person on one side, decided early.",
                success="Both pass and reach their goals.",
                metrics=("min_clearance", "personal_space_compliance", "stalled_time", "legibility"),
                lacks="Glances, greetings and other signals.",
            ),
            ScenarioCard(
                name="Narrow Hallway",
                setup="A corridor in which a robot of 0.6 m and a person just pass each other.",
                robot="Keep to one side and slow down, or let the person pass.",
                success="Both pass without contact; nobody has to go back.",
                metrics=("min_clearance", "min_wall_clearance", "stalled_time", "failures_to_progress"),
                lacks="Turned shoulders: bodies are discs for the crowd model.",
                values={"width": 1.2},
            ),
        ),
    ),
    Preset(
        "intersection",
        TITLES["intersection"],
        intersection,
        {
            "angle": PresetOption(90.0, "angle between the paths", "deg", 30.0, 150.0),
            "delay": PresetOption(0.0, "delay of the person at the crossing", "s", -2.0, 2.0),
            "width": PresetOption(3.0, "width of the corridors", "m", 1.2, 6.0),
            "density": PresetOption(0.0, "people in the side corridor, 0 for one person", "1/m2", 0.0, 2.0),
            "speed": PERSON,
            "robot_speed": ROBOT,
        },
        "SEAN: cross path; UMANS: 1 to 1, 90 and 135 degrees (`angle`)",
        cards=(
            ScenarioCard(
                name="Intersection No Gesture",
                setup="Two corridors; a person from the side would meet the robot at the crossing.",
                robot="Pass before or behind the person, without signals.",
                success="Both cross without a collision.",
                metrics=("min_ttc", "min_clearance", "stalled_time", "people_time_lost"),
                lacks="Right of way and gestures.",
            ),
        ),
    ),
    Preset(
        "intersection-gesture-wait",
        TITLES["intersection-gesture-wait"],
        functools.partial(gesture_crossing, "wait"),
        GESTURE,
        cards=(
            ScenarioCard(
                name="Intersection Gesture Wait",
                setup="Two corridors; a person from the side tells the robot to wait, and walks on.",
                robot="Stand before the crossing until the person has passed.",
                success="The person passes first, then the robot crosses.",
                metrics=("gesture_compliance", "min_ttc", "min_clearance", "people_time_lost"),
                lacks=HIDDEN,
            ),
        ),
    ),
    Preset(
        "intersection-gesture-proceed",
        TITLES["intersection-gesture-proceed"],
        functools.partial(gesture_crossing, "proceed"),
        GESTURE,
        cards=(
            ScenarioCard(
                name="Intersection Gesture Proceed",
                setup="Two corridors; a person from the side tells the robot to go first, and stands meanwhile.",
                robot="Cross without waiting for the person.",
                success="The robot passes first, then the person crosses.",
                metrics=("gesture_compliance", "stalled_time", "min_clearance", "people_time_lost"),
                lacks=HIDDEN,
            ),
        ),
    ),
    Preset(
        "blind-corner",
        TITLES["blind-corner"],
        blind_corner,
        {
            "width": PresetOption(1.8, "width of the corridors", "m", 1.4, 4.0),
            "speed": PERSON,
            "distance": PresetOption(7.0, "distance of the person from the corner", "m", 1.0, 7.5),
        },
        cards=(
            ScenarioCard(
                name="Blind Corner",
                setup="An L-shaped corridor; a person comes around the corner.",
                robot="Slow down before the corner and leave room.",
                success="No collision; nobody is obstructed.",
                metrics=("min_ttc", "max_impact_speed", "min_clearance", "max_acceleration"),
                lacks="Startled people, and steps that are heard around the corner.",
            ),
        ),
    ),
    Preset(
        "doorway",
        TITLES["doorway"],
        doorway,
        {"door": PresetOption(0.95, "width of the door", "m", 0.7, 3.0), "speed": PERSON},
        cards=(
            ScenarioCard(
                name="Narrow Doorway",
                setup="Two rooms and a door for one; a person comes through it from the other side.",
                robot="Wait beside the door, or go through first if there is time.",
                success="Both pass; the door is never blocked.",
                metrics=("stalled_time", "failures_to_progress", "min_clearance", "people_time_lost"),
                lacks="The person does not hold the door or wave the robot through.",
            ),
        ),
    ),
    Preset(
        "elevator",
        TITLES["elevator"],
        elevator,
        {
            "door": PresetOption(0.95, "width of the door", "m", 0.7, 2.0),
            "people": PresetOption(1, "people who leave", "", 1, 4),
        },
        cards=(
            ScenarioCard(
                name="Entering Elevator",
                setup="A cabin of 2.2 m by 2.2 m with an open door; people leave it.",
                robot="Wait beside the door until people are out, then enter.",
                success="People leave first, then the robot is in the cabin.",
                metrics=("people_time_lost", "stalled_time", "min_clearance"),
                lacks="Moving doors, other passengers who wait, and the turn inside.",
            ),
        ),
    ),
    Preset(
        "overtaking",
        TITLES["overtaking"],
        overtaking,
        {
            "width": WIDTH,
            "speed": PresetOption(0.7, "speed of the person", "m/s", 0.1, 2.5),
            "robot_speed": PresetOption(1.2, "speed of the robot", "m/s", 0.1, 3.0),
        },
        cards=(
            ScenarioCard(
                name="Robot Overtaking",
                setup="A corridor; a person walks ahead, slower than the robot.",
                robot="Overtake with a gap, without cutting in.",
                success="The robot passes the person.",
                metrics=("min_clearance", "personal_space_compliance", "time_to_goal", "max_acceleration"),
                lacks="Sounds: the robot is not heard, and has no horn.",
            ),
        ),
    ),
    Preset(
        "being-overtaken",
        TITLES["being-overtaken"],
        being_overtaken,
        {
            "width": WIDTH,
            "speed": PresetOption(1.4, "speed of the person", "m/s", 0.1, 2.5),
            "robot_speed": PresetOption(0.6, "speed of the robot", "m/s", 0.1, 3.0),
        },
        cards=(
            ScenarioCard(
                name="Pedestrian Overtaking",
                setup="A corridor; a faster person comes from behind.",
                robot="Keep course and speed on one side.",
                success="The person passes the robot.",
                metrics=("min_clearance", "path_irregularity", "people_time_lost"),
                lacks="A robot that is blind backwards: `orca` knows the people on all sides.",
            ),
        ),
    ),
    Preset(
        "following",
        TITLES["following"],
        following,
        {
            "gap": PresetOption(1.75, "distance between their centres at the beginning", "m", 0.6, 10.0),
            "speed": PresetOption(1.0, "speed of the person", "m/s", 0.1, 2.5),
            "robot_speed": PresetOption(1.0, "speed of the robot", "m/s", 0.1, 3.0),
        },
        cards=(
            ScenarioCard(
                name="Following",
                setup="A person walks ahead at constant speed.",
                robot="Follow at a constant distance.",
                success="The robot is behind the person all the way.",
                metrics=("mean_nearest_distance", "personal_space_compliance", "mean_jerk"),
                lacks=(
                    "The task itself: the robot goes to the goal of the person, and no built-in navigator is told "
                    "whom to follow."
                ),
            ),
        ),
    ),
    Preset(
        "joining-group",
        TITLES["joining-group"],
        joining_group,
        {"people": PEOPLE, "radius": CIRCLE},
        "SEAN: join group",
        cards=(
            ScenarioCard(
                name="Join Group",
                setup="People stand in a circle and talk; one place is free.",
                robot="Approach from the open side and stop at the free place.",
                success="The robot stands in the circle.",
                metrics=("group_intrusion", "group_space_share", "min_clearance", "max_acceleration"),
                lacks="The group does not make room or greet the robot.",
            ),
        ),
    ),
    Preset(
        "leaving-group",
        TITLES["leaving-group"],
        leaving_group,
        {"people": PEOPLE, "radius": CIRCLE},
        "SEAN: leave group",
        cards=(
            ScenarioCard(
                name="Leave Group",
                setup="People stand in a circle and talk; the robot is one of them.",
                robot="Leave backwards or with a slow turn, not through the circle.",
                success="The robot is away; people keep their places.",
                metrics=("group_intrusion", "group_space_share", "min_clearance"),
                lacks="Saying goodbye; the group does not close.",
            ),
        ),
    ),
    Preset(
        "passing-group",
        TITLES["passing-group"],
        passing_group,
        {"gap": PresetOption(2.0, "distance between their centres", "m", 0.8, 5.0)},
    ),
)
