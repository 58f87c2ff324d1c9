"""Gestures of people around any navigator: stand when told to wait, go when told to proceed."""

from __future__ import annotations

import dataclasses
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import GESTURES, Twist
from crowdbot.navigation.action import Action
from crowdbot.navigation.decisions import Decisions
from crowdbot.navigation.navigator import Navigator
from crowdbot.navigation.observation import Observation
from crowdbot.navigation.observation_batch import ObservationBatch
from crowdbot.typing import Bools, Floats

WAIT, PROCEED = (GESTURES.index(name) for name in ("wait", "proceed"))
STILL = 0.1
"""Speed [m/s] below which a person has no way that the robot could stand in."""


@dataclass(frozen=True)
class GestureLayer:
    """Layer around a navigator that obeys the gestures of the people in its observations.

    * ``wait``: the robot stands, unless it is in the way of who tells it so: on the path straight ahead of that person,
      as wide as both. There it drives on to clear the path.
    * ``proceed``: who tells it so counts as standing, so that the navigator does not wait for that person to pass.

    Without gestures, and for people whose gestures are not known, nothing changes. The layer has no memory.

    >>> from crowdbot.core import GESTURES
    >>> from crowdbot.navigation import DriveLimits, Straight, VisiblePeople
    >>> person = VisiblePeople(np.array([[2.0, -2.0]]), np.array([[0.0, 1.0]]), np.array([0.25]),
    ...     gesture=np.array([GESTURES.index("wait")]))
    >>> here = Observation(
    ...     pose=(0.0, 0.0, 0.0), goal=(4.0, 0.0), radius=0.3, limits=DriveLimits(1.0, 2.0), dt=0.1, people=person
    ... )
    >>> GestureLayer().around(Straight()).decide(here, None)[0].twist
    Twist(forward=0.0, turn=0.0, left=0.0)
    """

    def around(self, navigator: Navigator) -> Navigator:
        """Return the navigator behind this layer.

        >>> from crowdbot.navigation import Straight
        >>> GestureLayer().around(Straight()).title()
        'navigator Straight with gestures'
        """
        return _GestureNavigator(navigator)


def told_to_wait(
    robot: Floats, size: Floats, position: Floats, velocity: Floats, radius: Floats, gesture: NDArray[np.int64]
) -> Bools:
    """Return ``[N]`` whether somebody tells the robot to wait who does not have it in their way.

    Args:
        robot: position of the robot ``[N, 2]`` [m].
        size: radius of the robot ``[N]`` [m].
        position, velocity: of people ``[N, A, 2]`` [m], [m/s].
        radius: of people ``[N, A]`` [m].
        gesture: ``[N, A]`` codes of their gestures; 0 for people who are not seen.

    >>> people = np.array([[[2.0, -2.0]]]), np.array([[[0.0, 1.0]]]), np.array([[0.25]]), np.array([[WAIT]])
    >>> [bool(told_to_wait(np.array([[x, 0.0]]), np.array([0.3]), *people)[0]) for x in (0.0, 1.6)]
    [True, False]
    """
    away = robot[:, None] - position
    speed = np.hypot(velocity[..., 0], velocity[..., 1])
    pace = np.maximum(speed, STILL)
    along = (away[..., 0] * velocity[..., 0] + away[..., 1] * velocity[..., 1]) / pace
    aside = np.abs(velocity[..., 0] * away[..., 1] - velocity[..., 1] * away[..., 0]) / pace
    in_the_way = (speed > STILL) & (along > 0.0) & (aside < size[:, None] + radius)
    return np.asarray(((gesture == WAIT) & ~in_the_way).any(axis=1))


@dataclass(frozen=True)
class _GestureNavigator(Navigator):
    """A navigator behind a gesture layer."""

    always_returns = True

    inner: Navigator

    def begin(self, observation: Observation) -> Any:
        return self.inner.begin(observation)

    def act(self, observation: Observation, memory: Any) -> tuple[Action, Any]:
        people = observation.people
        standing = np.where((people.gesture == PROCEED)[:, None], 0.0, people.velocity)
        told = told_to_wait(
            observation.position[None], np.array([observation.radius]), people.position[None], people.velocity[None],
            people.radius[None], people.gesture[None],
        )[0]  # fmt: skip
        seen = dataclasses.replace(observation, people=dataclasses.replace(people, velocity=standing))
        action, after = self.inner.decide(seen, memory)
        return Action(Twist(), action.joints) if told else action, after

    def decide_batch(
        self,
        batch: ObservationBatch,
        memories: Sequence[Any],
        robot: str = "",
        timer: Callable[[], float] | None = None,
        limit: float | None = None,
    ) -> Decisions:
        people = batch.people
        gesture = np.where(people.seen, people.gesture, 0)
        if not gesture.any():
            return self.inner.decide_batch(batch, memories, robot, timer, limit)
        standing = np.where((gesture == PROCEED)[..., None], 0.0, people.velocity)
        seen = dataclasses.replace(batch, people=dataclasses.replace(people, velocity=standing))
        decisions = self.inner.decide_batch(seen, memories, robot, timer, limit)
        told = told_to_wait(batch.pose[:, :2], batch.radius, people.position, people.velocity, people.radius, gesture)
        decisions.twist[told] = 0.0
        return decisions

    def _name(self, robot: str) -> str:
        return self.inner._name("") + " with gestures" + (f" of robot {robot!r}" if robot else "")
