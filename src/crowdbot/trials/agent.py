"""Agents: single people of a trial, each with its own start, goal and body."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from .fields import FieldProblem, attribute, check, children
from .human_kinds import ABOUT_ACTIVITY, ABOUT_BODY, check_words, word_problems
from .notation import Points

__all__ = ["Agent", "AgentParameter"]


@dataclass(frozen=True)
class AgentParameter:
    """A parameter of the crowd model for one person.

    >>> AgentParameter("time-horizon", 1.5).value
    1.5
    """

    name: str = attribute(about="name of a parameter of the crowd model")
    value: float = attribute(about="value for this person")

    def __post_init__(self) -> None:
        check(self)


@dataclass(frozen=True, kw_only=True)
class Agent:
    """One person. A person without a goal and a journey stays in place.

    Raises:
        InputError: a value is not allowed.

    >>> Agent(x=1, y=2, goal="8,0", speed=1.3).goal
    ((8.0, 0.0),)
    """

    name: str = attribute("", about="name for messages")
    x: float = attribute(about="start x", unit="m")
    y: float = attribute(about="start y", unit="m")
    heading: float | None = attribute(
        None, about="start heading, counter-clockwise from +x (default: towards the goal)", unit="rad"
    )
    goal: Points = attribute(Points(), about="goal point x,y; not with a journey", unit="m", points=1)
    goal_zone: Points = attribute(Points(), about="corners x,y of the goal zone", unit="m")
    journey: str = attribute("", about="name of the journey; not with a goal")
    speed: float = attribute(1.34, about="preferred speed", unit="m/s", exclusive_min=0.0, max=10.0)
    radius: float = attribute(0.25, about="radius of the body", unit="m", exclusive_min=0.0, max=5.0)
    arrival: str = attribute("leave", about="behaviour at the goal", choices=("leave", "stay"))
    crowd: str = attribute("", about="name of the crowd (default: the first)")
    group: int = attribute(-1, about="number of the group, -1 for none", min=-1, max=1e6)
    body: str = attribute("", about=ABOUT_BODY)
    outfit: int | None = attribute(None, about="number of the appearance (clothes and colours)", min=0, max=1e6)
    activity: str = attribute("", about=ABOUT_ACTIVITY)
    parameters: tuple[AgentParameter, ...] = children("parameter", about="model parameters of this person", max=100)

    def __post_init__(self) -> None:
        check(self)
        check_words(self.body, self.activity)

    @staticmethod
    def mistakes(values: Mapping[str, Any]) -> list[FieldProblem]:
        """Return the problems of bodies and activities, independent of other problems of the element."""
        found = word_problems(values.get("body", ""), values.get("activity", ""))
        return [((), sentence) for sentence in found]

    @property
    def count(self) -> int:
        """Number of people: 1."""
        return 1

    @property
    def position(self) -> tuple[float, float]:
        """Start ``x, y`` [m]."""
        return self.x, self.y

    @property
    def facing(self) -> float:
        """Heading at the start [rad]; NaN means towards the goal."""
        if self.heading is None:
            return math.nan if self.goal or self.journey else 0.0
        return self.heading
