"""Construction of the initial world of a trial."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError, Scene, TrialError, Walls
from crowdbot.models import CrowdModel, Mixture
from crowdbot.navigation import DriveLimits
from crowdbot.trials import (
    Agent,
    Crowds,
    InitialPeople,
    PeopleAppearance,
    RecordedPeople,
    RobotSpec,
    Trial,
    crowd_names,
    element_word,
    expand_sweeps,
    own,
    people_appearance,
    place,
)
from crowdbot.world import Avatars, JourneyAssignment, PeopleSource, PlanarWorld, ReplayedPeople, ReplayedTrack, Router

from .mounted_sensor import spatial

__all__ = ["begin_world", "build_world", "check_clock", "environment_index", "limits_of", "own_walls", "start_scene"]


def begin_world(trial: Trial, seed: int, posed: bool = False) -> tuple[PlanarWorld, InitialPeople]:
    """Return the world of a trial at its start, with bodies of people where they are needed, and the people.

    Args:
        trial, seed: the trial and its seed.
        posed: add bodies even if no sensor needs them.

    Raises:
        TrialError: people cannot be placed with this seed.
    """
    recorded = [(one, one.walks(trial.duration)) for one in trial.recorded]
    people, problems = place(trial.stage, trial.spawners, trial.robots, seed, trial.agents, recorded, trial.avatars)
    if problems:
        what = ((element_word(type(one)), one.name, sentence) for one, sentence in problems)
        raise TrialError(*(f"trial {trial.name!r}: {word} {name!r}: {sentence}" for word, name, sentence in what))
    world, figures = build_world(trial, people, seed)
    if posed and figures is None:
        figures = people_appearance(trial, people, world.scene.shape[1], seed)
    if figures is not None:
        first, stage = trial.people, trial.stage
        world.embody(
            {first + k: robot.body for k, robot in enumerate(trial.robots)},
            stage.physical(),
            figures.people,
            riders=figures.riders,
            activity=figures.activity,
            walls=own_walls(trial),
            seed=seed,
        )
    if world.avatars is not None:
        world.avatars.pose(world)
    return world, people


def environment_index(environments: Sequence[int] | NDArray[Any], count: int, new: int | None = None) -> Any:
    """Return indices of environments as an array.

    Args:
        environments: the indices.
        count: number of environments.
        new: number of environments that replace them, each once; None: they may be repeated.

    Raises:
        InputError: an environment does not exist, or the number is wrong.
    """
    index = np.asarray(environments)
    if index.ndim != 1 or not index.size or index.dtype.kind not in "iu":
        raise InputError(f"environments = {environments!r} must be a list of one or more whole numbers")
    if index.min() < 0 or index.max() >= count:
        raise InputError(f"environments = {index.tolist()}: each must be from 0 to {count - 1}")
    if new is not None and (len(index) != new or len(np.unique(index)) != new):
        raise InputError(f"environments = {index.tolist()} and {new} new ones: give each environment once")
    return index.astype(np.int64)


def check_clock(clock: Clock, own: Clock) -> None:
    """Raise :class:`InputError` unless a clock is at tick 0 and has the time step of the trial."""
    if clock.tick or clock.step_ns != own.step_ns:
        raise InputError(
            f"the clock is at tick {clock.tick} with steps of {clock.dt} s, but the trial starts at tick 0 with"
            f" steps of {own.dt} s"
        )


def own_walls(trial: Trial) -> Walls | None:
    """Return the walls without the outlines of props, None if there are no props."""
    return trial.stage.as_walls(props=False) if trial.stage.props else None


def build_world(trial: Trial, people: InitialPeople, seed: int) -> tuple[PlanarWorld, PeopleAppearance | None]:
    """Return the initial world of a trial: people, robots, then free slots for people who enter.

    Bodies of people are included if the world has bodies or a sensor needs them.

    Ids are assigned to people first, then to robots, then to people who enter; initial ids equal indices. Free slots
    have negative ids.
    """
    if trial.sweeps:
        count = len(expand_sweeps(trial))
        raise TrialError(f"trial {trial.name!r} has {count} variants in its sweeps; run one of them")
    sources = [source.source(trial.journeys, crowd_names(trial.crowd)) for source in trial.sources]
    first = len(people)
    scene = start_scene(trial, people, spare := _spare(trial, first, sources, seed))
    there = first + len(trial.robots)
    router = None if trial.routing is None else trial.routing.router(scene.walls)
    figures = people_appearance(trial, people, scene.shape[1], seed) if _embodied(trial) else None
    journeys = _journeys(trial, people, scene.shape[1])
    whole: dict[str, Any] = {
        "dt": trial.step,
        "seed": seed,
        "robot_margin": trial.robot_margin,
        "router": router,
        "contact": None if trial.contact is None else trial.contact.bodies(),
        "limits": None if trial.limits is None else trial.limits.limits(),
        "journeys": journeys,
        "sources": sources,
        "exits": [way.out() for way in trial.exits],
        "portals": [portal.gate() for portal in trial.portals],
        "script": _script(people),
        "avatars": _avatars(trial, len(people) - len(people.walks)),
        "heading_jitter": trial.heading_jitter,
        "substeps": trial.substeps,
        "ids": np.concatenate([np.arange(there), -1 - np.arange(spare)]),
    }
    model = _model(trial, people, scene.shape[1], seed)
    robots = {first + k: robot for k, robot in enumerate(trial.robots)}
    if trial.world == "physics":
        world = _with_bodies(trial, scene, model, robots, figures, whole)
    else:
        latency = {agent: robot.latency for agent, robot in robots.items()}
        drives = {agent: robot.drive for agent, robot in robots.items()}
        ghosts = [agent for agent, robot in robots.items() if robot.ghost]
        world = PlanarWorld(scene, model, drives, latency=latency, ghosts=ghosts, **whole)
    walkers = first - len(people.walks) - len(trial.avatars)
    if walkers and (router or journeys):
        world.scene = _setting_off(world.scene, walkers, router, journeys, people.heading)
    return world, figures


def _embodied(trial: Trial) -> bool:
    """Return whether anything needs the bodies of people."""
    if trial.world == "physics":
        return True
    kind = trial.bodies or PlanarWorld.people_shape
    return any(spatial(robot, mount, kind) for robot in trial.robots for mount in robot.sensors)


def _with_bodies(
    trial: Trial, scene: Scene, model: CrowdModel, robots: Mapping[int, RobotSpec], figures: Any, whole: dict[str, Any]
) -> PlanarWorld:
    from crowdbot.world import PhysicsWorld

    stage = trial.stage
    return PhysicsWorld(
        scene.replace(walls=stage.as_walls(props=False), wall_height=stage.wall_height),
        model,
        {agent: robot.body for agent, robot in robots.items()},
        stage=stage.physical(),
        people=figures.people,
        riders=figures.riders,
        physics_dt=trial.physics_step,
        **whole,
    )


def start_scene(trial: Trial, people: InitialPeople, spare: int = 0) -> Scene:
    """Return the initial scene, E = 1: people walking towards their goals, robots at rest, free slots."""
    robots = trial.robots
    away = people.goal - people.position
    distance = np.hypot(away[:, 0], away[:, 1])
    moving = away * (people.speed / np.maximum(distance, 1e-9))[:, None]
    ahead = np.arctan2(moving[:, 1], moving[:, 0])
    places = np.array([robot.position for robot in robots], dtype=np.float64).reshape(-1, 2)
    goals = np.array([robot.goal.position for robot in robots], dtype=np.float64).reshape(-1, 2)
    tops = np.array([limits_of(robot.drive).max_speed for robot in robots])
    agent = np.arange(len(people) + len(robots) + spare)
    is_robot = (agent >= len(people)) & (agent < len(people) + len(robots))

    def row(crowd: Any, own: Any, free: float) -> NDArray[np.float64]:
        return np.concatenate([crowd, own, np.full((spare, *np.shape(crowd)[1:]), free)])

    return Scene.of(
        row(people.position, places, 0.0),
        row(moving, np.zeros((len(robots), 2)), 0.0),
        heading=row(
            np.where(np.isnan(people.heading), ahead, people.heading), [robot.heading for robot in robots], 0.0
        ),
        radius=row(people.radius, [robot.radius for robot in robots], 0.25),
        goal=row(people.goal, goals, 0.0),
        preferred_speed=row(people.speed, tops, 0.0),
        max_speed=row(1.3 * people.speed, tops, 0.0),
        active=agent < len(people) + len(robots),
        visible=row(np.ones(len(people)), [robot.visible and not robot.ghost for robot in robots], 1.0).astype(bool),
        external=is_robot,
        group=row(people.group, np.full(len(robots), -1), -1.0).astype(np.int64),
        walls=trial.stage.as_walls(),
    )


def limits_of(drive: Any, holonomic: bool = False) -> DriveLimits:
    """Return the limits of a drive by field name (default: 1 m/s and 1 rad/s).

    Args:
        drive: the drive.
        holonomic: whether navigators move it in every direction.
    """
    known = {name: float(getattr(drive, name)) for name in DriveLimits._fields if hasattr(drive, name)}
    values: dict[str, Any] = {"max_speed": 1.0, "max_turn_rate": 1.0} | known
    return DriveLimits(**values | {"holonomic": holonomic})


def _spare(trial: Trial, first: int, sources: Sequence[PeopleSource], seed: int) -> int:
    """Return the number of free slots: the maximum number of people who enter, up to the capacity."""
    end = trial.ticks * trial.step
    come = sum(source.come_by(end, seed, number) for number, source in enumerate(sources))
    return come if trial.capacity is None else min(come, max(0, trial.capacity - first))


def _model(trial: Trial, people: InitialPeople, agents: int, seed: int) -> CrowdModel:
    """Return the crowd model; with several crowds, a mixture with a model for each person."""
    if not isinstance(trial.crowd, Crowds):
        return own(trial.crowd, seed, 0, agents, _values(people, range(len(people))))
    which = _chosen(people, agents, "crowd", trial.crowd.names, 0)
    models = [
        own(model, seed, k, agents, _values(people, np.flatnonzero(which == k).tolist()))
        for k, model in enumerate(trial.crowd.models)
    ]
    return Mixture(tuple(models), which)


def _values(people: InitialPeople, members: Iterable[int]) -> dict[int, dict[str, float]]:
    """Return the individual parameters of people, if any."""
    found = {}
    for a in members:
        owner = people.owners[people.owner[a]] if a < len(people) else None
        if isinstance(owner, Agent) and owner.parameters:
            found[a] = {one.name.replace("-", "_"): one.value for one in owner.parameters}
    return found


def _script(people: InitialPeople) -> ReplayedPeople | None:
    """Return the recorded tracks that people follow."""
    if not people.walks:
        return None
    first = len(people) - len(people.walks)
    owners = [people.owners[k] for k in people.owner[first:].tolist()]
    release = [
        one.reaction_distance if isinstance(one, RecordedPeople) and one.mode == "reactive" else 0.0 for one in owners
    ]
    tracks = [ReplayedTrack(first + k, walk.time, walk.position) for k, walk in enumerate(people.walks)]
    return ReplayedPeople(tracks, release)


def _avatars(trial: Trial, end: int) -> Avatars | None:
    """Return the avatars of a trial, whose indices end before ``end``."""
    if not trial.avatars:
        return None
    sources = [avatar.pose_source() for avatar in trial.avatars]
    agents = end - len(sources) + np.arange(len(sources))
    names = [avatar.name for avatar in trial.avatars]
    return Avatars(agents, names, [sources], [avatar.delay for avatar in trial.avatars])


def _journeys(trial: Trial, people: InitialPeople, agents: int) -> JourneyAssignment | None:
    which = _chosen(people, agents, "journey", tuple(journey.name for journey in trial.journeys), -1)
    if np.all(which < 0):
        return None
    return JourneyAssignment(tuple(journey.journey() for journey in trial.journeys), which)


def _chosen(people: InitialPeople, agents: int, word: str, names: tuple[str, ...], otherwise: int) -> NDArray[np.int64]:
    """Return ``[A]`` the index of the journey or crowd of each agent, from its spawner or recording."""

    def index(owner: Any) -> int:
        name = getattr(owner, word, "")
        return names.index(name) if name else otherwise

    whole = np.full(agents, otherwise, dtype=np.int64)
    whole[: len(people)] = np.array([index(owner) for owner in people.owners], dtype=np.int64)[people.owner]
    return whole


def _setting_off(
    scene: Scene, first: int, router: Router | None, journeys: JourneyAssignment | None, given: NDArray[np.float64]
) -> Scene:
    """Return the scene in which the ``first`` people start on their paths around walls to their first waypoints."""
    position, aim = scene.position[0, :first], scene.goal[0, :first].copy()
    if router is not None:
        led = np.ones(first, dtype=np.bool_) if journeys is None else journeys.uses_routing(scene)[0, :first]
        aim[led] = router.towards(position[led], aim[led])
    away = aim - position
    distance = np.hypot(away[:, 0], away[:, 1])
    velocity, heading = scene.velocity.copy(), scene.heading.copy()
    velocity[0, :first] = away * (scene.preferred_speed[0, :first] / np.maximum(distance, 1e-9))[:, None]
    ahead = np.arctan2(away[:, 1], away[:, 0])
    heading[0, :first] = np.where(np.isnan(given[:first]), ahead, given[:first])
    return scene.replace(velocity=velocity, heading=heading)
