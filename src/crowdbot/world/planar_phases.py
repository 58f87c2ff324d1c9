"""Phases of a step of a planar world: motion of people and robots, contacts, and flow of people."""

from __future__ import annotations

import math
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.random import Generator
from numpy.typing import NDArray

from crowdbot.core import InputError, Scene, Twist, kernel
from crowdbot.core.outlines import Outlines
from crowdbot.metrics import step_clearance, step_outline_clearance
from crowdbot.models import CrowdModel
from crowdbot.typing import Bools, Floats, Ints
from crowdbot.world.crowd.contact import ContactModel
from crowdbot.world.crowd.environment_rows import stack_scenes
from crowdbot.world.crowd.limits import CrowdLimits
from crowdbot.world.crowd.wall_crossing import ContactSurfaces

from .crowd.agent_arrays import BOOL, FLOAT, dense
from .crowd.people_flow import PeopleFlow
from .crowd.portal import Exit, Portal, apply_portals
from .crowd.waypoint import Zone, is_inside
from .robots.drives.drive import Drive, Twists
from .world import Contact


def leave_at_goals(scene: Scene, radius: float) -> Scene:
    """Return the scene without the people within a radius [m] of their goal; robots stay.

    >>> leave_at_goals(Scene.of([[0.0, 0.0], [1.0, 0.0]], goal=[[0.1, 0.0], [9.0, 0.0]]), 0.3).active.tolist()
    [[False, True]]
    """
    pairs, goal = (*scene.shape, 2), scene.goal
    stay = np.empty(scene.shape, dtype=np.bool_)
    some = _stay_away(*_people(scene), dense(goal, pairs, FLOAT), float(radius), stay)
    return scene.replace(active=stay) if some else scene


def leave_in_zone(scene: Scene, zone: Exit | Zone) -> Scene:
    """Return the scene without the people in a zone; robots stay.

    >>> corner = Zone(((0, 0), (2, 0), (2, 2), (0, 2)))
    >>> leave_in_zone(Scene.of([[1.0, 1.0], [3.0, 1.0]]), corner).active.tolist()
    [[False, True]]
    """
    stay = np.empty(scene.shape, dtype=np.bool_)
    return scene.replace(active=stay) if _stay_outside(*_people(scene), zone.ring, stay) else scene


def _people(scene: Scene) -> tuple[Floats, Bools, Bools]:
    shape = scene.shape
    return (
        dense(scene.position, (*shape, 2), FLOAT),
        dense(scene.active, shape, BOOL),
        dense(scene.external, shape, BOOL),
    )


@kernel
def _stay_away(position: Floats, active: Bools, external: Bools, goal: Floats, radius: float, stay: Bools) -> bool:
    """Write who stays, and return whether somebody leaves."""
    some = False
    for e in range(len(active)):
        for a in range(active.shape[1]):
            stay[e, a] = active[e, a]
            if active[e, a] and not external[e, a]:
                x, y = goal[e, a, 0] - position[e, a, 0], goal[e, a, 1] - position[e, a, 1]
                if x * x + y * y < radius * radius:
                    stay[e, a], some = False, True
    return some


@kernel
def _stay_outside(position: Floats, active: Bools, external: Bools, ring: Floats, stay: Bools) -> bool:
    """Write who stays, and return whether somebody leaves."""
    some = False
    for e in range(len(active)):
        for a in range(active.shape[1]):
            stay[e, a] = active[e, a]
            if active[e, a] and not external[e, a] and is_inside(ring, position[e, a, 0], position[e, a, 1]):
                stay[e, a], some = False, True
    return some


STILL = Twist()


def show_crowd(scene: Scene, flow: PeopleFlow, heading_jitter: float, robots: Sequence[int], margin: float) -> Scene:
    """Return the scene for the crowd model.

    People aim at the next point of their path, rotated by a constant angle up to ``heading_jitter`` [rad]. The model
    knows which agents are robots, and their radii are larger by a margin [m].

    >>> from crowdbot.models import ORCA
    >>> flow = PeopleFlow.of(scene := Scene.of([[0.0, 0.0], [3.0, 0.0]], radius=0.3), ORCA(), [0], None, None, None, ())
    >>> shown = show_crowd(scene, flow, 0.0, [1], 0.1)
    >>> shown.radius.tolist(), shown.robot.tolist()
    ([[0.3, 0.4]], [[False, True]])
    """
    moving = flow.guide(scene)
    shape, wish = moving.shape, moving.preferred_velocity
    index, pairs = np.array(robots, dtype=np.int64), (*shape, 2)
    values: tuple[Any, ...] = (
        dense(moving.position, pairs, FLOAT), dense(moving.goal if wish is None else wish, pairs, FLOAT),
        dense(moving.radius, shape, FLOAT), dense(moving.active, shape, BOOL), dense(moving.external, shape, BOOL),
        wish is None, heading_jitter > 0.0, flow.ids, flow.seeds, index, float(margin),
    )  # fmt: skip
    out = np.empty(pairs), np.empty(shape), np.empty(shape, dtype=BOOL)
    for anew in (False, True):
        whole: Any = (*values, *flow.turns(heading_jitter, anew)[1:], *out)
        if _show(*whole):
            break
    aim, wide, robot = out
    changes: dict[str, Any] = {"goal" if wish is None else "preferred_velocity": aim} if heading_jitter > 0.0 else {}
    return moving.replace(**changes, radius=wide, robot=robot if len(index) else None)


@kernel
def _show(
    position: Floats, aim: Floats, radius: Floats, active: Bools, external: Bools, around: bool, turned: bool,
    new_ids: Ints, new_seeds: Ints, robots: Ints, margin: float, ids: Ints, seeds: Ints, cos: Floats, sin: Floats,
    out: Floats, wide: Floats, robot: Bools,
) -> bool:  # fmt: skip
    """Write the rotated goals or desired velocities, the radii and who is a robot.

    Return whether the angles belong to the identities and seeds.

    Args:
        around: whether the aims are points, which turn around the agent.
        turned: whether aims are rotated.
    """
    for e in range(len(active)):
        if turned and seeds[e] != new_seeds[e]:
            return False
        for a in range(active.shape[1]):
            wide[e, a], robot[e, a] = radius[e, a], False
            if not turned:
                continue
            if ids[e, a] != new_ids[e, a]:
                return False
            x, y = aim[e, a, 0], aim[e, a, 1]
            if active[e, a] and not external[e, a]:
                cx, cy = (position[e, a, 0], position[e, a, 1]) if around else (0.0, 0.0)
                dx, dy = x - cx, y - cy
                x, y = cx + (cos[e, a] * dx - sin[e, a] * dy), cy + (sin[e, a] * dx + cos[e, a] * dy)
            out[e, a, 0], out[e, a, 1] = x, y
        for agent in robots:
            wide[e, agent] += margin
            robot[e, agent] = True
    return True


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
    rows = [model.step(item, dt, rng) for model, item, rng in zip(models, alone, rngs, strict=True)]
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
    contacts: list[Contact] = []
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
            contacts += [Contact(e, robot, a, float(gap[e, a])) for e, a in np.argwhere(gap < 0.0).tolist()]
    return tuple(sorted(contacts))


def exchange_people(
    before: Scene,
    after: Scene,
    leave_radius: float | None,
    exits: Sequence[Exit | Zone],
    portals: Sequence[Portal],
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
