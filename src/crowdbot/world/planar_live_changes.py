"""Robots and props that are added to and removed from a running world."""

from __future__ import annotations

import itertools
import math
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from crowdbot.core import InputError, Twist, Walls, did_you_mean
from crowdbot.typing import Floats
from crowdbot.world.robots.drives.drive import Drive, Twists

from .crowd.environment_rows import pad_ids, resize_scene, set_models
from .robots.robot import Robot

if TYPE_CHECKING:
    from .physics.people_motion import PeopleMotion

FARTHEST = 1e6
"""Largest coordinate [m] of a robot."""


def chosen_environments(count: int, environments: Sequence[int] | None) -> list[int]:
    """Return the environments ``environments``, None: all of ``count``.

    Raises:
        InputError: an environment does not exist or is given twice.
    """
    chosen = list(range(count)) if environments is None else [int(e) for e in environments]
    if len(set(chosen)) != len(chosen) or not all(0 <= e < count for e in chosen):
        raise InputError(f"environments = {chosen}: give each environment once, from 0 to {count - 1}")
    return chosen


def check_robot_place(robot: Robot, place: tuple[float, float, float]) -> None:
    """Raise :class:`InputError` if a robot cannot be added at x, y [m], heading [rad]."""
    x, y, heading = place
    if not isinstance(robot, Robot):
        raise InputError(f"robot is a {type(robot).__name__}; give a Robot such as Robot.load('turtlebot2')")
    if not (math.isfinite(x) and math.isfinite(y) and max(abs(x), abs(y)) <= FARTHEST and math.isfinite(heading)):
        raise InputError(
            f"the place x = {x}, y = {y} m, heading = {heading} rad of a robot must be finite and at most"
            f" {FARTHEST:g} m away from 0"
        )


def robot_environments(world: Any, agent: int, environments: Sequence[int] | None) -> list[int]:
    """Return the environments in which a robot is to be removed, None: all in which it is present.

    Raises:
        InputError: an environment does not exist, or the robot is not present in it.
    """
    active, robots = world.scene.active, sorted(world.twists)
    if environments is None and agent in robots:
        environments = np.flatnonzero(active[:, agent]).tolist()
    chosen = chosen_environments(len(active), environments)
    if agent not in robots or not chosen or not active[chosen, agent].all():
        present = [robot for robot in robots if active[chosen or slice(None), robot].all()]
        raise InputError(f"agent {agent} is not a robot that is present; present are {present or 'none'}")
    return chosen


def widen(world: Any, agents: int) -> None:
    """Add absent agents to all environments of a planar or physics world, so that each has at least ``agents``."""
    if agents > world.scene.shape[1]:
        world.scene, world._previous = resize_scene(world.scene, agents), resize_scene(world._previous, agents)
        world._traffic.ids = pad_ids(world._traffic.ids, agents)
        world.ids = world._traffic.ids
        set_models(world, [world.model] * len(world.slots) if world._models is None else world._models)
    for people in people_motions(world):
        people.grow(agents)


def absent_robot(world: Any, agent: int, drive: Drive, latency: float, outline: Floats | None) -> None:
    """Make an agent without a body an absent robot in all environments."""
    widen(world, agent + 1)
    world.slots[:] = np.maximum(world.slots, agent + 1)
    world.drives, world.latency = {**world.drives, agent: drive}, {**world.latency, agent: latency}
    world.twists = {**world.twists, agent: Twists.of(Twist(), len(world.slots))}
    world.added_robots = world.added_robots | {agent}
    if outline is not None:
        world.outlines = {**world.outlines, agent: outline}
        world._outline_table = None
    external = world.scene.external.copy()
    external[:, agent] = True
    world.scene = world.scene.replace(external=external)


def put_robot_at(
    world: Any, agent: int, robot: Robot, place: tuple[float, float, float], ghost: bool, environments: Sequence[int]
) -> None:
    """Make an agent a robot, at rest at a place x, y [m], heading [rad] in some environments, absent in the others."""
    absent_robot(world, agent, robot.drive, robot.latency, robot.outline)
    x, y, heading = place
    flow, rows = world._traffic, list(environments)
    if rows:
        flow.ids[rows, agent] = flow.following[rows]
        flow.following[rows] += 1
    top = float(getattr(robot.drive, "max_speed", 1.0))
    values = {
        "position": (x, y), "velocity": 0.0, "heading": math.pi - (math.pi - heading) % (2.0 * math.pi),
        "goal": (x, y), "radius": robot.radius, "preferred_speed": top, "max_speed": top, "visible": not ghost,
        "group": -1,
    }  # fmt: skip
    arrays = {name: getattr(world.scene, name).copy() for name in (*values, "active")}
    for name, value in values.items():
        arrays[name][:, agent] = value
    arrays["active"][rows, agent] = True
    if ghost:
        world.ghosts = [*world.ghosts, agent]
    world.scene = world.scene.replace(**arrays)


def remove_robot_at(world: Any, agent: int, environments: Sequence[int]) -> None:
    """Make a robot absent in some environments; its agent stays and takes no commands."""
    active = world.scene.active.copy()
    active[environments, agent] = False
    world.scene = world.scene.replace(active=active)
    rest_robot(world, agent, environments)


def rest_robot(world: Any, agent: int, environments: Sequence[int]) -> None:
    """Let a robot stand in some environments: its velocity is 0 until the next command."""
    left = ~np.isin(np.arange(len(world.slots)), environments)
    twist = world.twists[agent]
    still = Twists(*(np.where(left, part, 0.0) for part in (twist.forward, twist.turn, twist.left)))
    world.twists = {**world.twists, agent: still}


def match_robots(world: Any, other: Any) -> None:
    """Make robots that were added to one of two worlds of a trial absent robots of the other.

    Raises:
        InputError: a person has the place of such a robot.
    """
    for item, two in ((world, other), (other, world)):
        for agent in sorted(item.added_robots - two.added_robots):
            if agent < two.scene.shape[1] and two.scene.active[:, agent].any():
                raise InputError(f"agent {agent} is a robot in one environment and a person in another")
            absent_robot(two, agent, item.drives[agent], item.latency.get(agent, 0.0), item.outlines.get(agent))


def keep_added_robots(world: Any, how: dict[str, Any]) -> dict[str, Any]:
    """Return new values of a world that leave the robots unchanged that were added while it runs."""
    kept = world.added_robots
    if not kept:
        return how
    rest: dict[str, Any] = {}
    for name in ("drives", "latency"):
        if name in how:
            rest[name] = {agent: getattr(world, name)[agent] for agent in kept} | dict(how[name])
    if "ghosts" in how:
        rest["ghosts"] = [*how["ghosts"], *(agent for agent in world.ghosts if agent in kept)]
    return {**how, **rest}


def prop_number(names: Sequence[str], name: str) -> int:
    """Return the number of a prop.

    Raises:
        InputError: there is no prop of this name.
    """
    if not name or name not in names:
        known = [name for name in names if name]
        meant = did_you_mean(name, known)
        raise InputError(f"there is no prop {name!r}{meant}; props are {', '.join(known) or 'none'}")
    return list(names).index(name)


def new_prop_name(names: Sequence[str], name: str) -> str:
    """Return the name of a new prop, ``prop`` with its number by default.

    Raises:
        InputError: the name is taken.
    """
    numbers = (f"prop{k}" for k in itertools.count(len(names)))
    name = name or next(number for number in numbers if number not in names)
    if name in names:
        raise InputError(f"there is already a prop {name!r}; names of props must differ")
    return name


def without_last(names: list[str]) -> list[str]:
    """Return names without empty ones at the end."""
    count = len(names)
    while count and not names[count - 1]:
        count -= 1
    return names[:count]


def live_prop_names(world: Any) -> list[str]:
    """Return the names of the props of a planar or physics world by number; that of a removed one is empty."""
    names: list[str] = world._prop_names if world.walls_fixed else props_of(world)[0]
    return names


def props_of(world: Any) -> tuple[list[str], list[Any]]:
    """Return names and outlines of the props of a planar world; the name of a removed one is empty."""
    from .physics.scenery import prop_outline

    if not hasattr(world, "_prop_outlines"):
        props = world._bodies[0].stage.props if world._bodies else ()
        world._prop_outlines = ([f"prop{k}" for k in range(len(props))], [prop_outline(prop) for prop in props])
    result: tuple[list[str], list[Any]] = world._prop_outlines
    return result


def replace_walls(world: Any, walls: Walls) -> None:
    """Replace the walls of a planar world, in the scenes before and after its last step."""
    world.scene, world._previous = world.scene.replace(walls=walls), world._previous.replace(walls=walls)


def people_motions(world: Any) -> list[PeopleMotion]:
    """Return the bodies of people in each environment, empty without bodies."""
    if world._bodies is not None:
        return [bodies.people for bodies in world._bodies]
    return [] if world.people is None else [world.people]
