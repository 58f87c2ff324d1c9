"""Crowd crossings of CrowdNav: random angles, a robot that knows everybody's state, and decisions every 0.25 s.

Source: Chen et al. 2019, Crowd-robot interaction, doi:10.1109/ICRA.2019.8794134, with the configuration of the authors'
code. People and robots move at the velocity that they choose, without limits of the acceleration.
"""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Any

from crowdbot import navigation
from crowdbot.models import ORCA
from crowdbot.sensors import GroundTruthPeople
from crowdbot.trials.builtin_names import TITLES
from crowdbot.trials.people import Spawner
from crowdbot.trials.robots.reaction import ReactionSpec
from crowdbot.trials.stage import Stage
from crowdbot.trials.trial import Mount, RecordingSpec, RobotGoal, RobotSpec, Trial
from crowdbot.world import Omnidirectional

from .parts import box, number, scenario
from .preset import Preset, PresetOption

STEP = 0.25
"""Time step and control period [s]."""
SIDE = 10.0
"""Side of the square in which people swap sides [m]."""
MARGIN = 0.02
"""Margin that people who see the robot add to its radius [m]: 0.01 m for each body."""
INSTANT = 1e6
"""Acceleration of a drive that reaches each velocity in one step [m/s2, rad/s2]."""
SLOWEST = 1e-6
"""Turn rate of the robot, which keeps its heading [rad/s]; a drive needs one above 0."""

ORCA_OF_CROWDNAV = navigation.ORCANavigator(
    safety=MARGIN, share=0.5, time_horizon=5.0, neighbor_distance=10.0, max_neighbors=10, reaction=STEP
)
"""ORCA of the robot with the settings of CrowdNav, which adds 0.01 m to each radius even without a safety margin."""


def _robot(radius: float, visible: bool) -> RobotSpec:
    """Return the robot that goes from the lowest to the highest point."""
    return RobotSpec(
        x=0.0,
        y=-radius,
        heading=math.pi / 2.0,
        radius=0.3,
        visible=visible,
        holonomic=True,
        control_period=STEP,
        goal=RobotGoal(0.0, radius, 0.3),
        drive=Omnidirectional(1.0, SLOWEST, INSTANT, INSTANT),
        navigator=ORCA_OF_CROWDNAV,
        sensors=(Mount(name="people", sensor=GroundTruthPeople(range_max=100.0, visible_only=False, rate=1.0 / STEP)),),
    )


def _crossing(
    layout: str, default: int, people: int, visible: bool, limit: float, radius: float = 4.0, noise: float = 0.0
) -> Trial:
    """Return people who cross the path of a robot, on a circle or between the halves of a square."""
    half = radius if layout == "circle" else 0.5 * SIDE
    square = box(-half, -half, half, half)
    return scenario(
        f"crowdnav-{'circle' if layout == 'circle' else 'square'}-{default}",
        limit,
        Stage(),
        step=STEP,
        heading_jitter=0.0,
        robot_margin=MARGIN,
        recording=RecordingSpec(period=STEP, markers=2.0 * STEP),
        crowd=ORCA(10.0, 10.0, 5.0, 5.0, max_speed=1.0, reciprocal=True),
        spawners=[
            Spawner(
                name="people",
                count=people,
                zone=square,
                goal=square,
                speed=number(1.0),
                radius=number(0.3),
                arrival="stay",
                at_rest=True,
                layout=layout,
                noise=noise,
            )
        ],
        robots=[_robot(radius, visible)],
    )


def _preset(layout: str, people: int, radius: float) -> Preset:
    """Return the preset of a layout with a number of people."""
    word = "circle" if layout == "circle" else "square"
    name = f"crowdnav-{word}-{people}"
    own = {
        "people": PresetOption(people, "people", "", 1, 60),
        "visible": PresetOption(False, "whether people see the robot"),
        "limit": PresetOption(25.0, "duration", "s", 5.0, 600.0),
    }
    if layout == "circle":
        own |= {
            "radius": PresetOption(radius, "radius of the circle", "m", 2.0, 30.0),
            "noise": PresetOption(0.5, "largest deviation of x and y from the circle", "m", 0.0, 2.0),
        }
    make: Any = functools.partial(_crossing, layout, people)
    return Preset(name, TITLES[name], make, own, f"CrowdNav: {word} crossing with {people} people", model="orca")


def attention_ladder(attention: float, people: int, limit: float) -> Trial:
    """Return a circle of which a share of people sees the robot."""
    trial = _crossing("circle", 10, people, True, limit, 4.0, 0.5)
    blind = (ReactionSpec(type="ignore", share=1.0 - attention),) if attention < 1.0 else ()
    spawners = [dataclasses.replace(spawner, reactions=blind) for spawner in trial.spawners]
    return dataclasses.replace(trial, name="attention-ladder", spawners=tuple(spawners))


ATTENTION = Preset(
    "attention-ladder",
    TITLES["attention-ladder"],
    attention_ladder,
    {
        "attention": PresetOption(0.5, "share of people who see the robot", "", 0.0, 1.0),
        "people": PresetOption(10, "people", "", 1, 60),
        "limit": PresetOption(25.0, "duration", "s", 5.0, 600.0),
    },
    model="orca",
)

CROWDNAV = (
    ATTENTION,
    *(_preset("circle", people, radius) for people, radius in ((5, 4.0), (10, 4.0), (20, 4.0))),
    *(_preset("halves", people, 4.0) for people in (5, 10, 20)),
)
