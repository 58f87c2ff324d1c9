"""Placement of people at random in zones, clear of walls, robots and each other."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, UnreadableValue, stream
from crowdbot.core.outlines import Outlines, body_gap, inscribed_radius, wall_gap
from crowdbot.trials.agent import Agent, Avatar
from crowdbot.trials.people import Spawner
from crowdbot.trials.recorded_people import RecordedPeople, Walk
from crowdbot.trials.robot import RobotSpec
from crowdbot.trials.stage import Stage, area
from crowdbot.typing import Floats

from .spawn_layouts import goal_discs
from .spawn_placement import InitialPeople, OccupiedDiscs, SpawnPlacement


def start_outline(robot: RobotSpec) -> Floats | None:
    """Return the outline ``[K, 2]`` of a robot in its frame [m]; None for a disc.

    A robot that cannot be read completely is a disc: another problem is reported first, and the disc holds its outline.
    """
    try:
        return robot.body.outline if robot.type and math.isfinite(robot.heading) else None
    except (UnreadableValue, InputError):
        return None


def gap_to_disc(robot: RobotSpec, place: tuple[float, float], radius: float) -> float:
    """Return the clearance [m] of a robot at its start to a disc; negative if they overlap."""
    outline = start_outline(robot)
    if outline is None:
        return math.hypot(place[0] - robot.x, place[1] - robot.y) - robot.radius - radius
    pose = (robot.x, robot.y, robot.heading, robot.radius, 0, len(outline))
    return float(body_gap(*pose, *place, 0.0, radius, 0, 0, np.ascontiguousarray(outline)))


def gap_to_robot(robot: RobotSpec, other: RobotSpec) -> float:
    """Return the clearance [m] of two robots at their starts; negative if they overlap.

    >>> from crowdbot.navigation import Straight
    >>> from crowdbot.trials import RobotGoal, RobotSpec
    >>> pair = [RobotSpec(type="cuybot", x=0, y=y, goal=RobotGoal(5, y), navigator=Straight()) for y in (0.0, 0.6)]
    >>> round(gap_to_robot(*pair), 3), round(0.6 - 2 * pair[0].radius, 3)
    (0.068, -0.182)
    """
    first, second = start_outline(robot), start_outline(other)
    if first is None and second is None:
        return gap_to_disc(robot, other.position, other.radius)
    table = Outlines.of({k: item for k, item in enumerate((first, second)) if item is not None}, 2)
    begin, middle, end = table.first.tolist()
    return float(
        body_gap(
            robot.x, robot.y, robot.heading if first is not None else 0.0, robot.radius, begin, middle,
            other.x, other.y, other.heading if second is not None else 0.0, other.radius, middle, end, table.corner,
        )
    )  # fmt: skip


def gap_to_walls(stage: Stage, robot: RobotSpec) -> float:
    """Return the clearance [m] of the outline of a robot at its start to walls and solids; inf without any."""
    outline = start_outline(robot)
    if outline is None:
        return float(stage.clearance([robot.position])[0]) - robot.radius
    corner = np.ascontiguousarray(outline)
    pose = (robot.x, robot.y, robot.heading, corner, 0, len(corner))
    return min((float(wall_gap(*pose, *wall)) for wall in stage.as_walls().segments().tolist()), default=math.inf)


def smallest_reach(robot: RobotSpec) -> float:
    """Return the radius [m] of the largest disc around the origin in the body of a robot: it needs this in any pose."""
    outline = start_outline(robot)
    return robot.radius if outline is None else max(0.0, inscribed_radius(outline))


MOST_PROBLEMS = 100
EXACT = 1e-9


def place(
    stage: Stage,
    spawners: Sequence[Spawner],
    robots: Sequence[RobotSpec],
    seed: int,
    agents: Sequence[Agent] = (),
    recorded: Sequence[tuple[RecordedPeople, Sequence[Walk]]] = (),
    avatars: Sequence[Avatar] = (),
) -> tuple[InitialPeople, list[tuple[Any, str]]]:
    """Return the people at the beginning of a trial, and the elements that cannot be placed, each with a sentence.

    Spawner k draws from ``stream(seed, "spawner", k, ...)`` only, with separate streams for positions, goals, speeds
    and radii. People keep clear of agents, robots, recorded people, avatars and the people of earlier spawners.

    >>> zone = [(0, 0), (2, 0), (2, 2), (0, 2)]
    >>> people, problems = place(Stage(), [Spawner(count=50, zone=zone, goal=zone, radius=0.3)], [], seed=0)
    >>> len(people) < 50, problems[0][1][:20]
    (True, 'only 12 of 50 people')
    """
    taken, problems, first = place_fixed(stage, spawners, robots, agents, recorded, avatars)
    replayed = [
        recorded_people(walks, item.radius.draw(stream(seed, "recorded", k, "radius"), len(walks)))
        for k, (item, walks) in enumerate(recorded)
    ]
    groups, led, robot_goals = [first], _avatars(avatars), goal_discs(robots)
    for index, spawner in enumerate(spawners):
        if len(problems) >= MOST_PROBLEMS:
            break
        company = SpawnPlacement(stage, spawner, index, taken, seed, robot_goals)
        group = company.people(1 + max((int(g.group.max(initial=-1)) for g in groups), default=-1))
        groups.append(group)
        if len(group) < spawner.count:
            problems.append((spawner, _too_many(spawner, len(group))))
    walks = tuple(walk for _, walks in recorded for walk in walks)
    owners = (*agents, *spawners[: len(groups) - 1], *avatars, *(item for item, _ in recorded))
    sizes = [len(agents), *(1 for _ in groups[1:]), len(avatars), *(1 for _ in replayed)]
    return InitialPeople.concatenate([*groups, led, *replayed], sizes, owners, walks), problems


def place_fixed(
    stage: Stage,
    spawners: Sequence[Spawner],
    robots: Sequence[RobotSpec],
    agents: Sequence[Agent],
    recorded: Sequence[tuple[RecordedPeople, Sequence[Walk]]],
    avatars: Sequence[Avatar] = (),
) -> tuple[OccupiedDiscs, list[tuple[Any, str]], InitialPeople]:
    """Return the discs of robots, agents, recorded people and avatars, the problems of agents, and the agents.

    They are the same for all seeds.
    """
    widest = [s.radius.extent[1] for s in spawners] + [item.radius.extent[1] for item, _ in recorded]
    widest += [robot.radius for robot in robots] + [agent.radius for agent in agents]
    widest += [avatar.radius for avatar in avatars]
    taken = OccupiedDiscs(2.0 * max(widest, default=1.0))
    for robot in robots:
        taken.add(robot.x, robot.y, robot.radius)
    problems: list[tuple[Any, str]] = [*_place_agents(stage, agents, robots, taken)]
    for _, walks in recorded:
        for walk in walks:
            if walk.time[0] <= 0.0:
                taken.add(*_begin(walk), 0.3)
    for avatar, pose in zip(avatars, [avatar.start_pose() for avatar in avatars], strict=True):
        taken.add(pose.x, pose.y, avatar.radius)
    return taken, problems, _agents(agents)


def _place_agents(
    stage: Stage, agents: Sequence[Agent], robots: Sequence[RobotSpec], taken: OccupiedDiscs
) -> Iterator[tuple[Agent, str]]:
    """Yield agents that overlap something, and add all agents to the occupied discs.

    An agent may stand in the disc of a robot beside its outline; people of spawners keep clear of the disc.
    """
    if not agents:
        return
    others = OccupiedDiscs(taken.cell)
    room = stage.clearance([agent.position for agent in agents])
    for agent, free in zip(agents, room.tolist(), strict=True):
        where = f"at {agent.x:g},{agent.y:g}"
        if free < agent.radius - EXACT:
            yield agent, f"stands {where}, {free:.2f} m from a wall, and the radius is {agent.radius:g} m"
        elif not others.free(agent.x, agent.y, agent.radius - EXACT, gap=0.0) or any(
            gap_to_disc(robot, agent.position, agent.radius - EXACT) < 0.0 for robot in robots
        ):
            yield agent, f"stands {where} and overlaps a person or a robot; move one of them"
        others.add(agent.x, agent.y, agent.radius)
        taken.add(agent.x, agent.y, agent.radius)


def _agents(agents: Sequence[Agent]) -> InitialPeople:
    place = np.array([agent.position for agent in agents], dtype=np.float64).reshape(-1, 2)
    goal = np.array([agent.goal[0] if agent.goal else agent.position for agent in agents], dtype=np.float64)
    return InitialPeople(
        place,
        goal.reshape(-1, 2),
        np.array([agent.radius for agent in agents], dtype=np.float64),
        np.array([agent.speed for agent in agents], dtype=np.float64),
        np.array([agent.facing for agent in agents], dtype=np.float64),
        np.array([agent.group for agent in agents], dtype=np.int64),
        np.arange(len(agents)),
    )


def _avatars(avatars: Sequence[Avatar]) -> InitialPeople:
    poses = [avatar.start_pose() for avatar in avatars]
    place = np.array([(pose.x, pose.y) for pose in poses], dtype=np.float64).reshape(-1, 2)
    return InitialPeople(
        place,
        place.copy(),
        np.array([avatar.radius for avatar in avatars], dtype=np.float64),
        np.full(len(avatars), 1.34),
        np.array([pose.heading for pose in poses], dtype=np.float64),
        np.full(len(avatars), -1, dtype=np.int64),
        np.arange(len(avatars)),
    )


def recorded_people(walks: Sequence[Walk], radius: NDArray[np.float64]) -> InitialPeople:
    """Return the people of a recording with their radii ``[N]`` [m]."""
    count = len(walks)
    last = np.array([walk.position[-1] for walk in walks], dtype=np.float64).reshape(-1, 2)
    return InitialPeople(
        np.array([_begin(walk) for walk in walks], dtype=np.float64).reshape(-1, 2),
        last,
        radius,
        np.full(count, 1.34),
        np.full(count, np.nan),
        np.full(count, -1, dtype=np.int64),
        np.zeros(count, dtype=np.int64),
    )


def _begin(walk: Walk) -> tuple[float, float]:
    """Return the position of a recorded person at the beginning of the trial, or at the first appearance."""
    return tuple(float(np.interp(max(0.0, walk.time[0]), walk.time, walk.position[:, k])) for k in (0, 1))  # type: ignore[return-value]


def _too_many(spawner: Spawner, fit: int) -> str:
    if fit == 0:
        return (
            f"spawn zone of {area(spawner.zone).area:.2f} m2 leaves no room for a single body beside walls, robots and"
            " other people; move it, or make it larger"
        )
    return (
        f"only {fit} of {spawner.count} people fit into the spawn zone of {area(spawner.zone).area:.2f} m2 beside"
        " walls, robots and each other; make it larger, or take fewer or smaller people"
    )
