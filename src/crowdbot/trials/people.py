"""Spawners and sources: people placed before a trial begins, and people who enter while it runs."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass

from crowdbot import world
from crowdbot.core import InputError
from crowdbot.core.fields import Points, attribute, check, children

from .distribution import Distribution
from .human_kinds import ABOUT_ACTIVITY, ABOUT_BODY, check_words
from .journey import Journey
from .robots.behavior import BehaviorSpec
from .robots.reaction import ReactionSpec, check_shares

WALKING_SPEED = Distribution("normal", (1.34, 0.26))
"""Free walking speed [m/s] (Weidmann 1993, Transporttechnik der Fussgaenger, https://doi.org/10.3929/ethz-a-000687810)."""
BODY_RADIUS = Distribution("uniform", (0.17, 0.23))
"""Radius of bodies [m]: discs of about the area of a trunk, in the mean as large as those of the validation page."""


@dataclass(frozen=True)
class Group:
    """A group size among the people of a spawner, and its relative frequency.

    >>> Group(2, 0.5).share
    0.5
    """

    size: int = attribute(about="number of people in the group, 1 for no group", min=1, max=50)
    share: float = attribute(1.0, about="relative frequency of this size", exclusive_min=0.0)

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, kw_only=True)
class Spawner:
    """People at random places of a zone, who walk to a random point of a goal zone or follow a journey.

    Members of a group start near each other and have the same goal and speed.

    Raises:
        InputError: a value is not allowed.

    >>> Spawner(count=3, zone=[(0, 0), (2, 0), (2, 2)], goal="8,0 9,0 9,2", radius=0.25).speed.extent
    (0.56, 2.12)
    """

    name: str = attribute("", about="name for messages")
    count: int = attribute(about="number of people", min=0, max=100_000)
    zone: Points = attribute(
        about="corners x,y of the spawn zone, which contains the centres of people", unit="m", points=3
    )
    goal: Points = attribute(Points(), about="corners x,y of the goal zone; not with a journey", unit="m", points=3)
    journey: str = attribute("", about="name of the journey; not with a goal zone")
    speed: Distribution = attribute(WALKING_SPEED, about="preferred speed", unit="m/s", exclusive_min=0.0, max=10.0)
    radius: Distribution = attribute(BODY_RADIUS, about="radius of the body", unit="m", exclusive_min=0.0, max=5.0)
    arrival: str = attribute("leave", about="behaviour in the goal zone", choices=("leave", "stay"))
    crowd: str = attribute("", about="name of the crowd (default: the first)")
    body: str = attribute("", about=ABOUT_BODY)
    activity: str = attribute("", about=ABOUT_ACTIVITY)
    stands: bool = attribute(False, about="whether people stand still, without goal and journey")
    heading: float | None = attribute(
        None, about="initial heading (default: towards the goal; random for standing people)", unit="rad"
    )
    at_rest: bool = attribute(False, about="whether people start at rest (default: at their preferred speed)")
    layout: str = attribute(
        "zone",
        about="start: anywhere in the zone; at a random angle of the ellipse in the box of the zone, with the opposite"
        " point as goal; or in the left or right half of that box, with a goal in the other half",
        choices=("zone", "circle", "halves"),
    )
    noise: float = attribute(
        0.0, about="largest deviation of x and y from the ellipse of the layout", unit="m", min=0.0, max=100.0
    )
    groups: tuple[Group, ...] = children("group", about="group sizes (default: no groups)", max=50)
    reactions: tuple[ReactionSpec, ...] = children("reaction", about="reactions to robots (default: none)", max=50)
    behaviors: tuple[BehaviorSpec, ...] = children("behavior", about="behaviour trees (default: none)", max=50)

    def __post_init__(self) -> None:
        check(self)
        check_words(self.body, self.activity)
        check_shares(self.reactions, self.behaviors)
        if self.layout != "circle" and self.noise:
            raise InputError('Spawner: noise acts with layout="circle" only')
        if self.layout not in ("circle", "halves"):
            return
        if self.groups:
            raise InputError(f'Spawner: layout="{self.layout}" has no groups')
        if self.journey or self.stands or self.arrival != "stay":
            raise InputError(f'Spawner: layout="{self.layout}" needs a goal zone and arrival="stay"')


@dataclass(frozen=True, kw_only=True)
class SourceSpec:
    """People who enter while the trial runs, at random places of a zone, as soon as there is room.

    Raises:
        InputError: a value is not allowed.

    >>> SourceSpec(zone=[(0, 0), (2, 0), (2, 2)], goal="8,0 9,0 9,2", rate=0.5, begin=10).arrival_count(60.0)
    26.0
    """

    name: str = attribute("", about="name for messages")
    zone: Points = attribute(about="corners x,y of the zone where people enter", unit="m", points=3)
    goal: Points = attribute(Points(), about="corners x,y of the goal zone; not with a journey", unit="m", points=3)
    journey: str = attribute("", about="name of the journey; not with a goal zone")
    rate: float = attribute(about="mean number of people per second", unit="1/s", exclusive_min=0.0, max=1e4)
    timing: str = attribute(
        "poisson", about="arrivals as a Poisson process, or at regular intervals", choices=("poisson", "regular")
    )
    begin: float = attribute(0.0, about="start of the arrivals", unit="s", min=0.0, max=86_400.0)
    end: float = attribute(math.inf, about="end of the arrivals", unit="s", exclusive_min=0.0, max=86_400.0)
    max_count: int | None = attribute(None, about="maximum number of people", min=0, max=100_000)
    speed: Distribution = attribute(WALKING_SPEED, about="preferred speed", unit="m/s", exclusive_min=0.0, max=10.0)
    radius: Distribution = attribute(BODY_RADIUS, about="radius of the body", unit="m", exclusive_min=0.0, max=5.0)
    arrival: str = attribute("leave", about="behaviour in the goal zone", choices=("leave", "stay"))
    crowd: str = attribute("", about="name of the crowd (default: the first)")
    body: str = attribute("", about=ABOUT_BODY)
    activity: str = attribute("", about=ABOUT_ACTIVITY)
    reactions: tuple[ReactionSpec, ...] = children("reaction", about="reactions to robots (default: none)", max=50)
    behaviors: tuple[BehaviorSpec, ...] = children("behavior", about="behaviour trees (default: none)", max=50)

    def __post_init__(self) -> None:
        check(self)
        check_words(self.body, self.activity)
        check_shares(self.reactions, self.behaviors)

    def arrival_count(self, duration: float) -> float:
        """Return the number of arrivals within a duration [s]: the maximum if regular, the mean if random."""
        come = self.rate * max(0.0, min(self.end, duration) - self.begin) + 1.0
        return come if self.max_count is None else min(come, float(self.max_count))

    def source(self, journeys: Sequence[Journey], crowds: Sequence[str]) -> world.PeopleSource:
        """Return the source of a world, given the journeys and the names of the crowds of the trial."""
        named = next((journey.journey() for journey in journeys if journey.name == self.journey), None)
        goal = named or world.WaypointSequence((world.Zone(self.goal, aim="random"),), self.arrival)
        return world.PeopleSource(
            world.Zone(self.zone),
            goal,
            self.rate,
            self.timing,
            self.begin,
            self.end,
            self.max_count,
            self.speed,
            self.radius,
            crowds.index(self.crowd) if self.crowd else 0,
        )
