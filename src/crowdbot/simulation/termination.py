"""Termination: departure of people at their goals, and end conditions of a trial, in all environments at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import kernel, some
from crowdbot.trials import Agent, End, EndCondition, InitialPeople, Spawner, Trial, area
from crowdbot.typing import Bools, Floats, Ints
from crowdbot.world import World

GoalZone = tuple[Ints, Any, Any]
"""Indices of people, the zone of their goal, and its bounds."""

ARRIVED = 0.3
"""Distance [m] to the own goal point within which people in a goal zone leave."""
ROUNDING = 1e-6
"""Relative margin of squared distances against rounding."""
FALLEN = -1
"""Number of the end condition that somebody has fallen."""
FINISHED = "finished"
"""Outcome of a run whose end is planned: nobody is left, or its duration is over and no goal would have ended it."""


def goal_zones(people: InitialPeople) -> list[GoalZone]:
    """Return the people who leave at their goal, with the prepared goal zones; empty for a point goal."""
    import shapely

    members: dict[Any, list[int]] = {}
    for a, k in enumerate(people.owner.tolist()):
        owner = people.owners[k]
        if isinstance(owner, Spawner | Agent) and owner.goal and owner.arrival == "leave":
            zone = owner.goal_zone if isinstance(owner, Agent) else owner.goal
            members.setdefault(zone, []).append(a)
    zones = [area(points) if points else shapely.Polygon() for points in members]
    shapely.prepare(zones)
    return [
        (np.array(who, dtype=np.int64), zone, tuple(map(float, zone.bounds)))
        for who, zone in zip(members.values(), zones, strict=True)
    ]


def leave_goal_zones(world: World, zones: Sequence[GoalZone]) -> None:
    """Remove the people who are in the zone of their goal, or at their own goal point in it."""
    if not zones:
        return
    import shapely

    scene, ids = world.scene, world.ids
    close = np.zeros(scene.shape, dtype=np.bool_)
    people = (np.ascontiguousarray(scene.active), ids, *map(np.ascontiguousarray, (scene.position, scene.goal)))
    arrays: Any = (*people, close)
    gone: Bools | None = None
    for members, zone, bounds in zones:
        if not _find_close(members, bounds, *arrays):
            continue
        rows, columns = np.nonzero(close)
        close[rows, columns] = False
        position = scene.position[rows, columns]
        away = np.hypot(*(scene.goal[rows, columns] - position).T)
        leaves = shapely.contains_xy(zone, position[:, 0], position[:, 1]) | (away < ARRIVED)
        if leaves.any():
            gone = np.zeros(scene.shape, dtype=np.bool_) if gone is None else gone
            gone[rows, columns] = leaves
    if gone is not None:
        world.scene = scene.replace(active=scene.active & ~gone)


@kernel
def _find_close(
    members: Ints, bounds: tuple[float, float, float, float], active: Bools, ids: Ints, position: Floats, goal: Floats,
    close: Bools,
) -> bool:  # fmt: skip
    """Mark the members in the bounding box of their zone or near their goal; return whether there are any."""
    west, south, east, north = bounds
    near2, some = ARRIVED * ARRIVED * (1.0 + ROUNDING), False
    for e in range(len(active)):
        for a in members:
            if not active[e, a] or ids[e, a] != a:
                continue
            x, y = position[e, a, 0], position[e, a, 1]
            dx, dy = goal[e, a, 0] - x, goal[e, a, 1] - y
            if (west <= x <= east and south <= y <= north) or dx * dx + dy * dy < near2:
                close[e, a], some = True, True
    return some


@kernel
def _is_any_near(position: Floats, agent: int, point: Floats, distance: Floats) -> bool:
    for e in range(len(position)):
        dx, dy = position[e, agent, 0] - point[e, 0], position[e, agent, 1] - point[e, 1]
        if dx * dx + dy * dy < distance[e] * distance[e] * (1.0 + ROUNDING):
            return True
    return False


def may_be_near(position: Floats, agent: int, point: Floats, distance: Floats) -> bool:
    """Return False if an agent is in no environment within a distance ``[E]`` [m] of a point ``[E, 2]`` [m].

    A margin covers rounding.

    >>> points = np.tile([3.0, 4.0], (4, 1))
    >>> [may_be_near(np.zeros((4, 2, 2)), 1, points, np.full(4, distance)) for distance in (4.9, 5.0)]
    [False, True]
    """
    return bool(_is_any_near(np.ascontiguousarray(position), agent, point, distance))


def note_events(
    event: NDArray[np.int8], contacts: Sequence[int], robots: Sequence[Any], collision: int, success: int
) -> None:
    """Note the first event ``[E]`` of each environment, 0 before.

    Args:
        event: first events; modified in place.
        contacts: environments in which a robot has a contact.
        robots: controls of the robots; success is the arrival of all that :func:`arrivals_of` counts.
        collision, success: the numbers of the events.
    """
    arrivals = arrivals_of(robots)
    arrives = bool(arrivals) and all(map(some, arrivals))
    if not (contacts or arrives):
        return
    open_ = event == 0
    collided = np.zeros(len(event), dtype=np.bool_)
    collided[list(contacts)] = True
    arrived = np.all(arrivals, axis=0) if arrivals else np.zeros(len(event), dtype=np.bool_)
    event[open_ & collided] = collision
    event[open_ & ~collided & arrived] = success


def arrivals_of(robots: Sequence[Any]) -> list[Bools]:
    """Return which robots have arrived, ``[E]`` for each whose arrival ends a run.

    Ghosts do not count, unless all robots are ghosts: such a run ends as it would with the robots.

    >>> from types import SimpleNamespace as Control
    >>> real, ghost = (Control(robot=Control(ghost=one), arrived=np.array([not one])) for one in (False, True))
    >>> len(arrivals_of([real, ghost])), len(arrivals_of([ghost]))
    (1, 1)
    """
    real = [control.arrived for control in robots if not control.robot.ghost]
    return real or [control.arrived for control in robots]


def end_condition_numbers(trial: Trial, world: World, people: InitialPeople, robots: Mapping[str, int]) -> Ints | None:
    """Return the number of the end condition that holds in each environment ``[E]``.

    It is 0 for none, -1 if somebody has fallen, 1 if nobody is left, and 2 + k for condition k of the trial. None if
    the trial has no conditions.

    Args:
        trial: trial with end conditions.
        world: current world.
        people: initial and recorded people.
        robots: agent index of each robot by name, in the order of the trial.
    """
    end = trial.end
    if not (end.empty or end.fall or end.conditions):
        return None
    met = np.zeros(len(world.slots), dtype=np.int64)
    if end.fall:
        for e, now in enumerate(world.times.tolist()):
            if any(fall.end <= now + ROUNDING for fall in world.falls_of(e)):
                met[e] = FALLEN
    if end.empty:
        alone = _people_count(world) == len(trial.avatars)  # avatars never leave
        if alone.any():
            met[(met == 0) & alone & ~_expects_people(trial, world, people)] = 1
    for number, condition in enumerate(end.conditions):
        value = _value(condition, world, robots)
        if value is not None:
            below = condition.below
            holds = value < below if below is not None else value > (condition.above or 0.0)
            met[(met == 0) & holds] = 2 + number
    return met


def run_outcome(end: End, event: str, number: int, over: bool, robots: bool) -> str | None:
    """Return the outcome of a run that ends now, None while it continues.

    Args:
        end: end conditions of the trial.
        event: first event, ``collision`` or ``success``, empty for none.
        number: number of the end condition that holds, see :func:`end_condition_numbers`.
        over: whether the duration is over.
        robots: whether there are robots.

    >>> run_outcome(End(), "", 1, False, True), run_outcome(End(fall=True), "", FALLEN, False, True)
    ('finished', 'fall')
    >>> run_outcome(End(), "", 0, True, True), run_outcome(End(goal=False), "", 0, True, True)
    ('timeout', 'finished')
    """
    if (event == "collision" and end.collision) or (event == "success" and end.goal):
        return event
    if number == FALLEN:
        return "fall"
    if number:
        return FINISHED if number == 1 else end.conditions[number - 2].outcome
    if not over:
        return None
    return event or ("timeout" if robots and end.goal else FINISHED)


def _people_count(world: World) -> Ints:
    scene = world.scene
    return np.asarray(np.count_nonzero(scene.active & ~scene.external, axis=1))


def _expects_people(trial: Trial, world: World, people: InitialPeople) -> NDArray[np.bool_]:
    """Return ``[E]`` whether more people can enter."""
    found = world.waiting_count > 0
    for e, time in enumerate(world.times.tolist()):
        walks = any(walk.time[0] > time for walk in people.walks)
        come = (source.arrival_count(trial.duration) > source.arrival_count(time) for source in trial.sources)
        found[e] |= walks or any(come)
    return np.asarray(found)


def _value(condition: EndCondition, world: World, robots: Mapping[str, int]) -> NDArray[Any] | None:
    if condition.what == "time":
        return world.times
    if condition.what == "people":
        return _people_count(world)
    agent = robots.get(condition.robot) if condition.robot else next(iter(robots.values()), None)
    return None if agent is None else world.scene.position[:, agent, 0 if condition.what == "x" else 1]
