"""Phases of a step of a planar world: motion of people and robots, contacts, and flow of people."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, Twist
from crowdbot.core.outlines import Outlines
from crowdbot.metrics import step_clearance, step_outline_clearance
from crowdbot.models import CrowdModel
from crowdbot.typing import Floats
from crowdbot.world.crowd.contact import ContactModel
from crowdbot.world.crowd.environment_rows import stack_scenes
from crowdbot.world.crowd.limits import CrowdLimits
from crowdbot.world.crowd.wall_crossing import ContactSurfaces

from .crowd.departure import leave_at_goals, leave_in_zone
from .crowd.people_flow import PeopleFlow
from .crowd.portal import PortalTransfer, apply_portals
from .crowd.waypoint import PolygonZone
from .robots.drives.drive import Drive, Twists
from .world import Contact

STILL = Twist()


def show_robots(scene: Scene, robots: Iterable[int], margin: float) -> Scene:
    """Return the scene for the crowd model: it knows which agents are robots, and their radii are larger by a margin.

    >>> shown = show_robots(Scene.of([[0.0, 0.0], [3.0, 0.0]], radius=0.3), [1], 0.1)
    >>> shown.radius.tolist(), shown.robot.tolist()
    ([[0.3, 0.4]], [[False, True]])
    """
    index, wide, robot = list(robots), scene.radius.copy(), np.zeros(scene.shape, dtype=np.bool_)
    for agent in index:
        wide[:, agent] += margin
        robot[:, agent] = True
    return scene.replace(radius=wide, robot=robot if index else None)


def move_people(
    start: Scene,
    step: Callable[[Scene, float], Scene],
    resolve: Callable[[Scene, Scene], Scene],
    limits: CrowdLimits | None,
    dt: float,
    substeps: int,
    radius: Floats,
) -> tuple[Scene, Scene]:
    """Return the scenes before and after the last substep of the crowd.

    Args:
        start: scene at the start of the step, with the radii and goals for the model.
        step: moves people by a time [s].
        resolve: resolves the overlaps between substeps.
        limits: limits of speed and acceleration.
        dt: time step [s].
        substeps: number of substeps.
        radius: ``[E, A]`` radii of all bodies [m], without margins.
    """
    crowd = earlier = start
    h = dt / substeps
    for k in range(substeps):
        if k > 0:
            crowd = resolve(earlier, crowd.replace(radius=radius)).replace(radius=start.radius)
        earlier = crowd
        crowd = step(earlier, h)
        if limits is not None:
            crowd = limits.apply(earlier, crowd, h)
    return earlier, crowd


def step_models(
    scene: Scene, dt: float, models: Sequence[CrowdModel], rngs: Sequence[Generator], together: CrowdModel | None
) -> Scene:
    """Return the scene after a step of the crowd model.

    Args:
        scene: scene of E environments.
        dt: time step [s].
        models, rngs: model and generator of each environment.
        together: a model for all environments at once, None: call the model of each.
    """
    if together is not None:
        return together.step(scene, dt, rngs[0])
    alone = (scene.environments([e]).replace(walls=scene.walls) for e in range(len(models)))
    rows = [model.step(one, dt, rng) for model, one, rng in zip(models, alone, rngs, strict=True)]
    return stack_scenes(rows).replace(walls=scene.walls)


def contact_surfaces(scene: Scene, known: ContactSurfaces | None) -> ContactSurfaces:
    """Return the surfaces of the walls of a scene, the known ones if they still fit."""
    largest = float(scene.radius[scene.active].max(initial=0.0))
    if known is None or known.walls is not scene.walls or known.reach < largest:
        return ContactSurfaces.of(scene.walls, largest)
    return known


def resolve_overlaps(
    earlier: Scene,
    after: Scene,
    contact: ContactModel,
    dt: float,
    surfaces: ContactSurfaces,
    outlines: Outlines | None = None,
) -> Scene:
    """Return the scene with overlaps of people resolved, after a substep of ``dt`` [s]."""
    return contact.resolve_overlaps(earlier, after, dt, surfaces, outlines)


def initial_twist(scene: Scene, robot: int) -> Twists:
    """Return the twist of a robot with its heading and velocity in a scene."""
    heading, velocity = scene.heading[:, robot], scene.velocity[:, robot]
    cos, sin = np.cos(heading), np.sin(heading)
    forward = cos * velocity[:, 0] + sin * velocity[:, 1]
    left = cos * velocity[:, 1] - sin * velocity[:, 0]
    return Twists(forward, np.zeros_like(forward), left)


def check_commands(
    commands: Mapping[int, Twist | Twists], robots: Iterable[int], active: NDArray[np.bool_]
) -> dict[int, Twists]:
    """Return the command of each robot in all environments; absent robots need none.

    Args:
        commands: commands by agent index.
        robots: agent indices of all robots.
        active: ``[E, A]`` present agents.

    Raises:
        InputError: a robot has no command, or an agent that is not a robot has one.
    """
    known = list(robots)
    for robot in commands:
        if robot not in known:
            raise InputError(f"agent {robot} has a command but is not a robot; robots are {sorted(known) or 'none'}")
    for robot in known:
        if robot not in commands and active[:, robot].any():
            raise InputError(f"robot {robot} has no command; give one in every step, Twist() to stop")
    return {robot: Twists.of(commands.get(robot, STILL), len(active)) for robot in known}


def move_robots(
    before: Scene,
    after: Scene,
    drives: Mapping[int, Drive],
    twists: Mapping[int, Twists],
    commands: Mapping[int, Twists],
    dt: float,
) -> tuple[Scene, dict[int, Twists]]:
    """Return the scene with moved robots, and their twists.

    Args:
        before: scene at the start of the step.
        after: scene with moved people.
        drives, twists, commands: drive, current twist and command of each robot by agent index.
        dt: time step [s].
    """
    position, velocity, heading = after.position.copy(), after.velocity.copy(), after.heading.copy()
    new = dict(twists)
    for robot, command in commands.items():
        new[robot] = drives[robot].move(robot, before, twists[robot], command, dt, (position, velocity, heading))
    return after.replace(position=position, velocity=velocity, heading=heading), new


def find_contacts(
    before: Scene, after: Scene, robots: Sequence[int], ghosts: Collection[int], outlines: Outlines | None = None
) -> tuple[Contact, ...]:
    """Return the pairs of a robot and another agent with negative clearance during a step, each once, in order.

    Agents without ``outlines`` are discs.

    >>> start = Scene.of([[0.0, 0.0], [1.0, 0.0]], radius=0.3)
    >>> find_contacts(start, start.replace(position=[[[0.5, 0.0], [1.0, 0.0]]]), [0], ())[0].other
    1
    """
    found: list[Contact] = []
    for number, robot in enumerate(robots):
        if outlines is None:
            gap, least = step_clearance(before.position, after.position, after.radius, after.active, robot)
        else:
            gap, least = step_outline_clearance(
                before.position, before.heading, after.position, after.heading, after.radius, after.active, robot,
                outlines,
            )  # fmt: skip
        if least < 0.0 and robot not in ghosts:
            gap[:, list(robots[: number + 1])] = math.inf
            found += [Contact(e, robot, a, float(gap[e, a])) for e, a in np.argwhere(gap < 0.0).tolist()]
    return tuple(sorted(found))


def exchange_people(
    before: Scene,
    after: Scene,
    leave_radius: float | None,
    exits: Sequence[PolygonZone],
    portals: Sequence[PortalTransfer],
    flow: PeopleFlow,
    elapsed: float | NDArray[np.float64],
) -> Scene:
    """Return the scene after people at their goals and in exits have left, portals were used, and others entered.

    Args:
        before, after: scenes at the start of the step and after the motion.
        leave_radius: distance to the goal [m] below which people leave; None: they stay.
        exits, portals: zones.
        flow: journeys and sources; new people get identities from it.
        elapsed: time since the start [s], one or ``[E]``.
    """
    if leave_radius is not None:
        after = leave_at_goals(after, leave_radius)
    for zone in exits:
        after = leave_in_zone(after, zone)
    after = apply_portals(before, after, portals, flow.ids, flow.following)
    return flow.advance(after, elapsed)
