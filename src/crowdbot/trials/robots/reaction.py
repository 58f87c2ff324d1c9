"""Reactions of people to robots in a trial."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from crowdbot.core import GESTURES, InputError
from crowdbot.core.fields import attribute, check
from crowdbot.world import ALWAYS_IN_FORCE, REACTIONS, RobotReaction, RobotReactions

from .behavior import BehaviorSpec


@dataclass(frozen=True, kw_only=True)
class ReactionSpec:
    """How a share of people reacts to robots.

    Each person draws a reaction by the shares, from a random stream of their own; the rest of the people treats robots
    like people. See :class:`crowdbot.world.RobotReaction` for the kinds.

    Raises:
        InputError: a value is not allowed.

    >>> ReactionSpec(type="curious", share=0.2, distance=4, duration=8).reaction().gap
    1.0
    """

    type: str = attribute(about="kind of reaction", choices=REACTIONS)
    share: float = attribute(1.0, about="share of the people with this reaction", min=0.0, max=1.0)
    distance: float | None = attribute(
        None, about="distance at which a robot that is seen causes the reaction (default: 4)", unit="m",
        exclusive_min=0.0, max=1000.0,
    )  # fmt: skip
    duration: float | None = attribute(
        None, about="longest duration (default: by type)", unit="s", exclusive_min=0.0, max=86_400.0
    )
    pause: float | None = attribute(
        None, about="time before the next reaction (default: by type)", unit="s", min=0.0, max=86_400.0
    )
    once: bool = attribute(False, about="whether a person reacts only once")
    speed: float | None = attribute(
        None, about="speed as a multiple of the preferred speed (default: by type, 0 with the gesture proceed)",
        min=0.0, max=1.3,
    )  # fmt: skip
    gap: float | None = attribute(
        None, about="clearance to the robot, or to its lane, that people aim at (default: by type)", unit="m",
        min=0.0, max=100.0,
    )  # fmt: skip
    repulsion: float | None = attribute(
        None, about="speed of scared people away from a robot at contact (default: 1.5)", unit="m/s", min=0.0, max=10.0
    )
    range: float | None = attribute(
        None, about="clearance at which the repulsion is 1/e of that (default: 1)", unit="m", min=0.01, max=100.0
    )
    field_of_view: float = attribute(
        math.pi, about="full angle around the heading in which robots are seen", unit="rad", exclusive_min=0.0,
        max=2.0 * math.pi,
    )  # fmt: skip
    gesture: str = attribute(
        "none", about="gesture of a person who looks: wait tells the robot to stand, proceed to go first",
        choices=GESTURES,
    )  # fmt: skip
    begin: float = attribute(0.0, about="time from which the reaction can begin", unit="s", min=0.0, max=86_400.0)
    end: float = attribute(
        math.inf, about="time until which the reaction can begin", unit="s", exclusive_min=0.0, max=86_400.0
    )

    def __post_init__(self) -> None:
        check(self)
        for name in ("repulsion", "range"):
            if self.type != "scared" and getattr(self, name) is not None:
                raise InputError(f'{name} acts with type="scared" only, not with type="{self.type}"')
        if self.gesture != "none" and self.type != "look":
            raise InputError(f'gesture="{self.gesture}" acts with type="look" only, not with type="{self.type}"')
        if self.begin >= self.end:
            raise InputError(f'begin="{self.begin:g}" must be below end="{self.end:g}"')
        if self.type in ALWAYS_IN_FORCE and (self.begin, self.end) != (0.0, math.inf):
            raise InputError(f'begin and end have no effect with type="{self.type}", which is always in force')
        if self.once and self.pause is not None:
            raise InputError("pause has no effect with once")

    def reaction(self) -> RobotReaction:
        """Return the reaction of a world."""
        pause = math.inf if self.once else self.pause
        numbers = (self.distance, self.duration, pause, self.speed, self.gap, self.repulsion, self.range)
        return RobotReaction(self.type, *numbers, self.field_of_view, self.gesture, self.begin, self.end)


def check_shares(reactions: Sequence[ReactionSpec], behaviors: Sequence[BehaviorSpec] = ()) -> None:
    """Raise :class:`InputError` if the shares of reactions and behaviours of an element are more than 1 together."""
    total = sum(reaction.share for reaction in reactions) + sum(behavior.share for behavior in behaviors)
    if total > 1.0 + 1e-9:
        kinds = " and ".join(word for word, ones in (("reactions", reactions), ("behaviours", behaviors)) if ones)
        raise InputError(f"the shares of the {kinds} are {total:g} together, they must be at most 1")


def robot_reactions(
    owners: Sequence[Any], owner: Sequence[int], sources: Sequence[Any], agents: int
) -> RobotReactions | None:
    """Return the reactions and behaviour trees of the people of a world; None if there are none.

    Args:
        owners: elements that people come from; those without reactions and behaviours have none.
        owner: index of the element of each initial person.
        sources: sources of the trial.
        agents: number of agents of the world.

    Raises:
        InputError: a behaviour tree cannot be read.
    """
    elements = [*owners, *sources]
    rows = [
        [(spec.reaction(), spec.share) for spec in getattr(element, "reactions", ())]
        + [(spec.behavior(), spec.share) for spec in getattr(element, "behaviors", ())]
        for element in elements
    ]
    groups = [row for row in rows if row]
    if not groups:
        return None
    numbers = iter(range(len(groups)))
    group = [next(numbers) if row else -1 for row in rows]
    members = [group[k] for k in owner] + [-1] * (agents - len(owner))
    return RobotReactions(groups, members, group[len(owners) :])
