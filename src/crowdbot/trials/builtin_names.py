"""Names and titles of the built-in trials, which are known without building or importing a scenario."""

from __future__ import annotations

import importlib.resources
from importlib.resources.abc import Traversable

from crowdbot.core import parse_xml

SIZES = (50, 100, 200, 350)
FLOWS = {
    "with": ("1D+", "with the robot", ("east",)),
    "against": ("1D-", "against the robot", ("west",)),
    "both": ("1Dx", "with and against the robot", ("east", "west")),
    "cross": ("2D", "across the path of the robot, from one side", ("south",)),
    "cross-both": ("2Dx", "across the path of the robot, from both sides", ("south", "north")),
}
"""Flows by name: name in the challenge, description, journeys of people."""

TITLES = {
    "frontal": "A robot and a person meet head-on in a corridor.",
    "intersection": "Two corridors cross; a person (or a flow, with a density) crosses the path of the robot.",
    "intersection-gesture-wait": "A person from the side of a crossing tells the robot to wait, and walks on.",
    "intersection-gesture-proceed": "A person from the side of a crossing tells the robot to go first, and stands.",
    "blind-corner": "An L-shaped corridor hides a person until they are near.",
    "doorway": "A robot and a person go through a narrow door from opposite sides.",
    "elevator": "People leave a small room that the robot wants to enter.",
    "entering-room": "A robot enters a room through the door through which people come out.",
    "exiting-room": "A robot comes out of a room through the door through which people go in.",
    "exiting-elevator": "A robot comes out of a small room that people want to enter.",
    "overtaking": "A robot approaches a slow person from behind in a corridor.",
    "being-overtaken": "A person approaches a slow robot from behind in a corridor.",
    "following": "A person walks ahead of the robot in the same direction.",
    "joining-group": "A robot takes the free place in a group of people who stand and talk.",
    "leaving-group": "A robot leaves a group of people who stand and talk.",
    "passing-group": "Two people who talk stand on both sides of the robot's path.",
    "leading": "A robot goes ahead of a person, who walks behind it at their own pace; the robot does not wait.",
    "pedestrian-obstruction": "People stand side by side in the middle of a corridor, and the robot has to pass.",
    "down-path": "The robot goes along a corridor in which people walk, some in its direction and some towards it.",
    "parallel-walk": "A robot and a person go side by side along a corridor.",
    "object-handover": "The robot approaches a waiting person and stops within reach. The trial ends there; nothing is "
    "handed over.",
    "crash-cart": "A fast robot goes along a corridor with people, of whom most give way, to a waiting person.",
    "robot-crowding": "A robot leaves a crowd of people who come close and look at it.",
    "one-way-with": "People walk along an endless corridor in the direction of the robot.",
    "one-way-against": "People walk along an endless corridor against the robot.",
    "two-way": "People walk along an endless corridor in both directions.",
    "density-ladder": "An endless two-way corridor of 20 m by 5 m, from 0.05 to 3 people/m2.",
    "perpendicular-flow": "An endless flow of people crosses the path of the robot, from one side or both.",
    "circle-crossing": "People on a circle and a robot that they do not see go to the opposite side.",
    "dense-circle": "Twenty people on a larger circle and a robot that they do not see go to the opposite side.",
    "square-crossing": "People on two sides of a square swap sides, and the robot crosses their paths.",
    "static-crowd": "People stand alone or in groups, and the robot passes between them.",
    "random-goals": "People walk between random goals in a square.",
    "bottleneck": "People enter on the left and leave through a door; a robot crosses the hall behind it.",
    "delayed-circle": "A circle crossing in which people enter one after another within a few seconds.",
    "circle-with-standing": "A circle crossing around people who stand in the circle and need much room.",
    "corner-traffic": "People turn the corner of a corridor, and the robot turns it in the opposite direction.",
    "block": "People walk around a block in the middle of a hall, and a robot comes towards them.",
    "four-blocks": "People in four corners walk to the opposite corners between four blocks; a robot crosses the "
    "centre.",
    "one-against-ten": "A crowd of ten crosses the path of the robot at an angle, or walks towards it.",
    "crowd-against-crowd": "Two crowds meet, scattered or in ranks, and a robot crosses the place where they do.",
    "attention-ladder": "A circle crossing of CrowdNav in which a share of the people sees the robot.",
    "random-hall": "A robot crosses a random hall with rooms, doors, obstacles and flows; `layout` is its seed.",
    **{
        f"crowdnav-{kind}-{count}": f"CrowdNav: {count} people {words}, and a robot that they do not see crosses; it"
        " knows everybody's state."
        for kind, words in (("circle", "on a circle go to the opposite side"), ("square", "swap the sides of a square"))
        for count in (5, 10, 20)
    },
    "challenge-alone": "CrowdBot challenge, scenario without a crowd: the robot alone in a corridor of 50 m by 10 m.",
    **{
        f"challenge-{kind}-{size}": (
            f"CrowdBot challenge, {code}: {size} people walk {words}, in a corridor of 50 m by 10 m."
        )
        for kind, (code, words, _) in FLOWS.items()
        for size in SIZES
    },
}
"""One line about each preset, by name, in the order of the presets."""

GROUPS = {
    "frontal": "Meetings with a few people",
    "one-way-with": "Streams in corridors",
    "circle-crossing": "Crowds in open places",
    "crowdnav-circle-5": "CrowdNav",
    "challenge-alone": "CrowdBot challenge",
}
"""Groups of presets, by the first preset of each."""


def builtin_trials() -> tuple[str, ...]:
    """Return the names of the built-in trials.

    >>> {"crossing-flows", "intersection"} <= set(builtin_trials())
    True
    """
    return tuple(sorted({*_files(), *TITLES}))


def trial_titles() -> dict[str, str]:
    """Return one line about each built-in trial, by name.

    >>> trial_titles()["frontal"]
    'A robot and a person meet head-on in a corridor.'
    """
    found = dict(TITLES)
    for name, file in _files().items():
        if name not in TITLES:
            found[name] = parse_xml(file.read_bytes(), file.name).attributes.get("about", "")
    return dict(sorted(found.items()))


def trial_groups() -> dict[str, str]:
    """Return the group of each built-in trial, by name, group after group.

    >>> trial_groups()["two-way"], list(trial_groups().values())[-1]
    ('Streams in corridors', 'CrowdBot challenge')
    """
    group, found = "", dict.fromkeys((name for name in _files() if name not in TITLES), "Examples in XML")
    for name in TITLES:
        group = GROUPS.get(name, group)
        found[name] = group
    return found


def _files() -> dict[str, Traversable]:
    """Return the trial files of the package by name."""
    folder = importlib.resources.files("crowdbot").joinpath("assets", "trials")
    return {item.name.removesuffix(".xml"): item for item in folder.iterdir() if item.name.endswith(".xml")}
