"""Evaluation, the fifth phase of a step: contacts, arrivals and end conditions."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Protocol, TypeVar

import numpy as np
from numpy.typing import NDArray

from crowdbot.simulation.robot_control import RobotControl
from crowdbot.simulation.step_record import WALL, RobotContact
from crowdbot.simulation.termination import may_be_near
from crowdbot.world import World

__all__ = ["new_events", "note_arrivals", "robot_contacts"]


class _Ended(Protocol):
    @property
    def begin(self) -> float: ...
    @property
    def end(self) -> float: ...


Ended = TypeVar("Ended", bound=_Ended)


def robot_contacts(
    world: World, robots: Sequence[RobotControl], ids: NDArray[np.int64]
) -> dict[int, tuple[RobotContact, ...]]:
    """Return the contacts of robots in the last step by environment, with people and robots first, then with walls.

    Args:
        world: the world after the step.
        robots: the robots.
        ids: ``[E, A]`` identities before the step, since an index may be reused.
    """
    found: dict[int, list[RobotContact]] = {}
    for one in world.contacts:
        robot, other = ids[one.environment, [one.robot, one.other]].tolist()
        found.setdefault(one.environment, []).append(RobotContact(robot, other, one.clearance))
    for control in robots:
        gap = world.wall_clearance(control.agent)
        for e in np.flatnonzero(gap < 0.0).tolist() if gap.min() < 0.0 else ():
            found.setdefault(e, []).append(RobotContact(int(ids[e, control.agent]), WALL, float(gap[e])))
    return {e: tuple(contacts) for e, contacts in found.items()}


def note_arrivals(world: World, robots: Sequence[RobotControl]) -> None:
    """Note which robots are at their goals."""
    position = world.scene.position
    for control in robots:
        if not control.arrived.all() and may_be_near(position, control.agent, control.goal, control.tolerance):
            control.arrive(position[:, control.agent])


def new_events(events: Sequence[Ended], told: NDArray[np.int64], environment: int, until: float) -> tuple[Ended, ...]:
    """Return the events of an environment that ended before ``until`` [s] and were not returned before, by end.

    Args:
        events: all events so far.
        told: ``[E]`` number of events returned so far; it is updated.
        environment: index of the environment.
        until: time [s].
    """
    if not events:
        return ()
    over = sorted((one for one in events if one.end < until), key=lambda one: (one.end, one.begin))
    new, told[environment] = over[int(told[environment]) :], len(over)
    return tuple(new)
