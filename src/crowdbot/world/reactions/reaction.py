"""RobotReaction: how a person reacts to a robot, with its parameters.

The kinds follow HuNavSim (Perez-Higueras et al. 2023, HuNavSim: A ROS 2 Human Navigation Simulator for Benchmarking
Human-Aware Robot Navigation, arXiv 2305.01303): regular, impassive, surprised, curious, scared, threatening.
"""

from __future__ import annotations

import dataclasses
import math
from dataclasses import dataclass
from typing import NamedTuple

from crowdbot.core import GESTURES, InputError, did_you_mean

REACTIONS = ("regular", "ignore", "impassive", "curious", "scared", "block", "follow", "give-way", "look")
"""Kinds of reactions. The index of a kind is its code in recordings; 0 means that no reaction is in force."""


class ReactionDefaults(NamedTuple):
    """Default parameters of a kind of reaction, see :class:`RobotReaction`."""

    distance: float = 4.0
    duration: float = 30.0
    pause: float = 10.0
    speed: float = 1.0
    gap: float = 1.0
    repulsion: float = 0.0
    range: float = 1.0


REACTION_DEFAULTS = {
    "regular": ReactionDefaults(),
    "ignore": ReactionDefaults(),
    "impassive": ReactionDefaults(),
    "curious": ReactionDefaults(speed=0.8),
    "scared": ReactionDefaults(duration=40.0, pause=0.0, speed=0.6, repulsion=1.5),
    "block": ReactionDefaults(duration=40.0, speed=1.2, gap=0.6),
    "follow": ReactionDefaults(),
    "give-way": ReactionDefaults(duration=8.0, pause=4.0, gap=0.3),
    "look": ReactionDefaults(duration=6.0),
}
"""Default parameters of each kind. Kinds that are always in force use none of them."""


@dataclass(frozen=True)
class RobotReaction:
    """A reaction of a person to a robot.

    A reaction begins when a robot is seen: within a distance, in the field of view, and not behind a wall. It ends
    after its duration, or when the robot has been out of sight or far away for a second, and can begin again after a
    pause. The kinds:

    - ``regular``: none; robots are treated like other people.
    - ``ignore``: robots are not seen at all. Always in force.
    - ``impassive``: robots are obstacles that stand still. Always in force.
    - ``curious``: the person walks to the robot, stops at the gap and looks at it.
    - ``scared``: the person keeps away from the robot and walks at another speed.
    - ``block``: the person walks in front of the robot and stays there.
    - ``follow``: the person walks behind the robot.
    - ``give-way``: the person steps out of the lane of a moving robot, or stops before it.
    - ``look``: the person walks on at another speed, or stops with speed 0, and turns towards the robot. They can make
      a gesture meanwhile: ``wait`` tells the robot to stand, ``proceed`` to go first, and the person stands. The
      reaction then ends, too, when the one who goes first has passed the other.

    Fields:
        kind: one of :data:`REACTIONS`.
        distance: largest distance between the centres at which the reaction begins [m].
        duration: longest duration [s].
        pause: time after a reaction before the next one [s]; infinity for a single reaction.
        speed: speed during the reaction, as a multiple of the preferred speed, at most 1.3.
        gap: clearance to the robot, or to its lane, that the person aims at [m].
        repulsion: speed away from a robot at contact [m/s], for ``scared``.
        range: clearance at which the repulsion is 1/e of that [m], for ``scared``.
        field_of_view: full angle around the heading in which a robot is seen [rad].
        gesture: one of :data:`crowdbot.core.GESTURES`, for ``look``.
        begin, end: simulated time from which, and until which, the reaction can begin [s].

    Parameters that are None have the values of :data:`REACTION_DEFAULTS`; with the gesture ``proceed``, the speed is 0.

    Raises:
        InputError: the kind is unknown, or a value is not allowed.

    >>> RobotReaction("curious", duration=8.0).duration, RobotReaction("curious").distance
    (8.0, 4.0)
    """

    kind: str
    distance: float | None = None
    duration: float | None = None
    pause: float | None = None
    speed: float | None = None
    gap: float | None = None
    repulsion: float | None = None
    range: float | None = None
    field_of_view: float = math.pi
    gesture: str = "none"
    begin: float = 0.0
    end: float = math.inf

    def __post_init__(self) -> None:
        if self.kind not in REACTIONS:
            raise InputError(
                f"RobotReaction: kind = {self.kind!r}{did_you_mean(str(self.kind), REACTIONS)} must be one of "
                + ", ".join(REACTIONS)
            )
        if self.gesture not in GESTURES:
            raise InputError(
                f"RobotReaction: gesture = {self.gesture!r}{did_you_mean(str(self.gesture), GESTURES)} must be one of "
                + ", ".join(GESTURES)
            )
        if self.gesture != "none" and self.kind != "look":
            raise InputError(f"RobotReaction: a gesture needs the kind 'look', not {self.kind!r}")
        if self.gesture == "proceed" and self.speed is None:
            object.__setattr__(self, "speed", 0.0)
        for name, value in REACTION_DEFAULTS[self.kind]._asdict().items():
            if getattr(self, name) is None:
                object.__setattr__(self, name, value)
        for field in dataclasses.fields(self):
            if field.name in ("kind", "gesture"):
                continue
            value = float(getattr(self, field.name))
            least, most = LIMITS.get(field.name, (0.0, math.inf))
            if not least <= value <= most or (math.isinf(value) and field.name not in ("duration", "pause", "end")):
                raise InputError(f"RobotReaction: {field.name} = {value:g} must be from {least:g} to {most:g}")
        if self.begin >= self.end:
            raise InputError(f"RobotReaction: begin = {self.begin:g} must be below end = {self.end:g}")
        if self.kind in ALWAYS_IN_FORCE and (self.begin, self.end) != (0.0, math.inf):
            raise InputError(f"RobotReaction: begin and end have no effect with the kind {self.kind!r}")

    @property
    def code(self) -> int:
        """Number of the kind in recordings and kernels."""
        return REACTIONS.index(self.kind)


ALWAYS_IN_FORCE = ("regular", "ignore", "impassive")
"""Kinds that are in force all the time, and do not begin or end."""
LIMITS = {"speed": (0.0, 1.3), "range": (0.01, 100.0), "field_of_view": (0.0, 2.0 * math.pi + 1e-9)}
