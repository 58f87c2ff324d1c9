"""Safety layer around any navigator: fields of the scanner, and speed and separation monitoring."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from crowdbot.core import Twist
from crowdbot.core.fields import attribute, check
from crowdbot.navigation.action import Action
from crowdbot.navigation.decisions import Decisions
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.observation_batch import ObservationBatch
from crowdbot.navigation.wall_arrays import wall_arrays
from crowdbot.typing import Floats

TINY = 1e-9


class SafetyState(NamedTuple):
    """Memory of a safety layer.

    Fields:
        inner: memory of the navigator.
        stopped: whether the robot stands after a protective stop.
        since: time of the last decision with a violation [s].
    """

    inner: Any
    stopped: bool = False
    since: float = -math.inf


@dataclass(frozen=True)
class SafetyLayer:
    """Safety layer between the navigator and the drive, which limits twists as a certified safety function would.

    * *Protective field*: a strip in the direction of motion, as wide as the robot and ``side`` on both sides. It is as
      long as the robot needs to stop, ``v response + v^2 / (2 deceleration) + intrusion``. If anything is in it, a
      protective stop follows.
    * *Warning field*: the same strip, longer by ``warning``. If anything is in it, the speed is at most ``slow``.
    * *Speed and separation monitoring* after ISO 13855, ``S = K T + C``: the clearance to each person is at least
      ``approach (response + v / deceleration) + v response + v^2 / (2 deceleration) + intrusion``. The speed is
      reduced to the largest v for which this holds. If it does not hold at rest, a protective stop follows.

    A protective stop commands no motion until nothing is in the protective field of ``slow`` and the separation at
    rest holds for ``restart``. The fields see the last scan; a robot without a scanner sees people and walls. ``K`` is
    1.6 m/s in ISO 13855:2010 for walking people; with 0 there is no separation monitoring, only the fields.

    Fields:
        approach: speed at which people approach, K [m/s].
        response: time from the measurement to the beginning of braking [s].
        intrusion: distance added for what is detected late or inexactly, C [m].
        deceleration: braking deceleration [m/s2].
        side: width of the fields beyond the robot on each side [m].
        warning: length of the warning field beyond the protective field [m].
        slow: largest speed with a violated warning field [m/s].
        restart: time without a violation after which the robot moves again [s].

    Source: ISO 13855:2010; ISO/TS 15066:2016, 5.5.4; ISO 3691-4:2020 for fields of driverless trucks.

    Raises:
        InputError: a number is out of its range.

    >>> layer = SafetyLayer(approach=1.6, response=0.1, intrusion=0.1, deceleration=1.0)
    >>> round(layer.separation(0.5), 3), round(layer.speed_at(1.235), 3)
    (1.235, 0.5)
    """

    approach: float = attribute(
        1.6, about="speed at which people approach, K of ISO 13855", unit="m/s", min=0.0, max=10.0
    )
    response: float = attribute(
        0.1, about="time from the measurement to the beginning of braking", unit="s", min=0.0, max=10.0
    )
    intrusion: float = attribute(
        0.1, about="distance for late or inexact detection, C of ISO 13855", unit="m", min=0.0, max=10.0
    )
    deceleration: float = attribute(1.0, about="braking deceleration", unit="m/s2", exclusive_min=0.0, max=1000.0)
    side: float = attribute(
        0.05, about="width of the fields beyond the robot on each side", unit="m", min=0.0, max=10.0
    )
    warning: float = attribute(
        0.5, about="length of the warning field beyond the protective field", unit="m", min=0.0, max=100.0
    )
    slow: float = attribute(
        0.3, about="largest speed with a violated warning field", unit="m/s", exclusive_min=0.0, max=10.0
    )
    restart: float = attribute(
        1.0, about="time without a violation before the robot moves again", unit="s", min=0.0, max=3600.0
    )

    def __post_init__(self) -> None:
        check(self)

    def around(self, navigator: Navigator) -> Navigator:
        """Return the navigator behind this layer.

        >>> from crowdbot.navigation import Straight
        >>> SafetyLayer().around(Straight()).title()
        'navigator Straight with safety layer'
        """
        return _SafeNavigator(navigator, self)

    def separation(self, speed: float) -> float:
        """Return the clearance to people [m] that a speed [m/s] needs."""
        return self.approach * (self.response + speed / self.deceleration) + self.stopping_length(speed)

    def stopping_length(self, speed: float) -> float:
        """Return the length of the protective field [m] at a speed [m/s]."""
        return speed * self.response + 0.5 * speed * speed / self.deceleration + self.intrusion

    def speed_at(self, clearance: float) -> float:
        """Return the largest speed [m/s] that a clearance to people [m] allows; below 0 if it is too small at rest."""
        rest = clearance - self.separation(0.0)
        if rest < 0.0 or math.isinf(rest):
            return rest
        half = self.response + self.approach / self.deceleration
        return self.deceleration * (math.sqrt(half * half + 2.0 * rest / self.deceleration) - half)

    def limit(self, observation: Observation, twist: Twist, state: SafetyState) -> tuple[Twist, SafetyState]:
        """Return the twist that is allowed, and the next state."""
        speed = math.hypot(twist.forward, twist.left)
        near = max(observation.nearest, 0.0) if len(observation.people) else math.inf
        allowed = self.speed_at(near) if self.approach > 0.0 else math.inf
        ahead = self._free_length(observation, twist) if speed > 0.0 else math.inf
        checked = min(speed, self.slow) if state.stopped else speed
        moving = min(checked, max(allowed, 0.0))
        if allowed < 0.0 or ahead < self.stopping_length(moving):
            return Twist(), SafetyState(state.inner, True, observation.time)
        if state.stopped and observation.time - state.since < self.restart - TINY:
            return Twist(), state
        if ahead < self.stopping_length(moving) + self.warning:
            moving = min(moving, self.slow)
        scale = moving / speed if moving < speed else 1.0
        limited = Twist(twist.forward * scale, twist.turn * scale, twist.left * scale)
        return limited, SafetyState(state.inner, False, state.since)

    def _free_length(self, observation: Observation, twist: Twist) -> float:
        """Return the length of the strip in the direction of motion before the nearest point [m]."""
        points, sizes = _obstacles(observation)
        if len(points) == 0:
            return math.inf
        course = observation.heading + math.atan2(twist.left, twist.forward)
        away = points - observation.position
        along = away[:, 0] * math.cos(course) + away[:, 1] * math.sin(course)
        across = np.abs(away[:, 1] * math.cos(course) - away[:, 0] * math.sin(course))
        inside = (across < observation.radius + self.side + sizes) & (along > 0.0)
        gap = np.hypot(away[inside, 0], away[inside, 1]) - sizes[inside] - observation.radius
        return float(np.min(np.maximum(gap, 0.0), initial=math.inf))


def _obstacles(observation: Observation) -> tuple[Floats, Floats]:
    """Return points ``[P, 2]`` [m] and their radii ``[P]`` [m]: of the scan, otherwise of people and walls."""
    scan: Any = observation.scan
    if scan is not None:
        points = scan.points()[0, :, :2]
        points = points[np.isfinite(points[:, 0])]
        return points, np.zeros(len(points))
    people, segments = observation.people, wall_arrays(observation.walls).segments
    a, along = segments[:, :2], segments[:, 2:] - segments[:, :2]
    # a wall counts with its nearest point and both ends
    share = ((observation.position - a) * along).sum(axis=1) / np.maximum((along**2).sum(axis=1), TINY)
    nearest = a + np.clip(share, 0.0, 1.0)[:, None] * along
    points = np.vstack([people.position, nearest, a, a + along])
    return points, np.concatenate([people.radius, np.zeros(3 * len(segments))])


@dataclass(frozen=True)
class _SafeNavigator(Navigator):
    """A navigator behind a safety layer."""

    always_returns = True

    inner: Navigator
    layer: SafetyLayer

    def begin(self, observation: Observation) -> tuple[Any, ...]:
        return tuple(SafetyState(self.inner.begin(observation)))

    def act(self, observation: Observation, memory: tuple[Any, ...]) -> tuple[Action, tuple[Any, ...]]:
        action, inner = self.inner.decide(observation, memory[0])
        twist, state = self.layer.limit(observation, action.twist, SafetyState(*memory))
        return Action(twist, action.joints), tuple(state._replace(inner=inner))

    def decide_batch(
        self,
        batch: ObservationBatch,
        memories: Sequence[Any],
        robot: str = "",
        timer: Callable[[], float] | None = None,
        limit: float | None = None,
    ) -> Decisions:
        wanted = self.inner.decide_batch(batch, [memory[0] for memory in memories], robot, timer, limit)
        decisions = wanted._replace(memories=list(memories))
        for k, memory in enumerate(memories):
            if k in decisions.failures:
                continue
            begin = timer() if timer else 0.0
            try:
                observation = batch.environment(k)
                twist, state = self.layer.limit(observation, Twist(*wanted.twist[k].tolist()), SafetyState(*memory))
            except Exception as error:  # the other environments go on
                decisions.failures[k], decisions.twist[k] = error, 0.0
                continue
            decisions.twist[k] = twist
            decisions.memories[k] = tuple(state._replace(inner=wanted.memories[k]))
            decisions.seconds[k] += timer() - begin if timer else 0.0
        return decisions

    def _name(self, robot: str) -> str:
        return self.inner._name("") + " with safety layer" + (f" of robot {robot!r}" if robot else "")
