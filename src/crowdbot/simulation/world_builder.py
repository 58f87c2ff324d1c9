"""Parts of the initial world of a trial."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import Clock, InputError, Scene, Walls
from crowdbot.models import CrowdModel, Mixture
from crowdbot.navigation import DriveLimits
from crowdbot.trials import (
    Agent,
    Crowds,
    InitialPeople,
    PeopleBatch,
    RecordedPeople,
    Spawner,
    Trial,
    own,
)
from crowdbot.world import Avatars, Doors, JourneyAssignment, ReplayedPeople, ReplayedTrack, Router


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


def check_clock(clock: Clock, own: Clock) -> Clock:
    """Return a clock. Raise :class:`InputError` unless it is at tick 0 and has the time step of the trial."""
    if clock.tick or clock.step_ns != own.step_ns:
        raise InputError(
            f"the clock is at tick {clock.tick} with steps of {clock.dt} s, but the trial starts at tick 0 with"
            f" steps of {own.dt} s"
        )
    return clock


def own_walls(trial: Trial) -> Walls | None:
    """Return the walls without the outlines of props, None if there are neither props nor doors."""
    return trial.stage.as_walls(props=False) if trial.stage.props or trial.stage.doors else None


def doors_of(trial: Trial) -> Doors | None:
    """Return the doors of a trial at its start."""
    if not trial.stage.doors:
        return None
    return Doors(trial.stage.doors, pushed=trial.world == "physics")


def start_scenes(trial: Trial, people: PeopleBatch, spare: NDArray[np.int64], walls: Walls) -> Scene:
    """Return the initial scene of E environments: people walking towards their goals, robots at rest, free slots.

    Args:
        trial: the trial.
        people: the people at the beginning.
        spare: ``[E]`` number of free slots for people who enter. Where there are more, the others pad the arrays and
            are external.
        walls: walls of the stage.
    """
    robots, most = trial.robots, int(spare.max())
    away = people.goal - people.position
    distance = np.hypot(away[..., 0], away[..., 1])
    moving = away * (people.speed / np.maximum(distance, 1e-9))[..., None]
    ahead = np.arctan2(moving[..., 1], moving[..., 0])
    moving[:, people_at_rest(people.first)] = 0.0
    places = np.array([robot.position for robot in robots], dtype=np.float64).reshape(-1, 2)
    goals = np.array([robot.goal.position for robot in robots], dtype=np.float64).reshape(-1, 2)
    tops = np.array([limits_of(robot.drive).max_speed for robot in robots])
    count, there = people.position.shape[1], people.position.shape[1] + len(robots)
    agent = np.arange(there + most)
    external = (agent >= count) & ((agent < there) | (agent >= there + spare[:, None]))

    def row(crowd: Any, own: Any, free: float) -> NDArray[np.float64]:
        wide = (np.broadcast_to(own, (len(crowd), *np.shape(own))), np.full((len(crowd), most, *crowd.shape[2:]), free))
        return np.concatenate([crowd, *wide], axis=1)

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
        active=agent < there,
        visible=row(np.ones(people.speed.shape), [robot.visible and not robot.ghost for robot in robots], 1.0) > 0.0,
        external=external,
        group=row(people.group, np.full(len(robots), -1), -1.0).astype(np.int64),
        walls=walls,
    )


def people_at_rest(people: InitialPeople) -> NDArray[np.bool_]:
    """Return ``[N]`` whether a person starts at rest, by the spawner."""
    resting = np.array([isinstance(owner, Spawner) and owner.at_rest for owner in people.owners], dtype=np.bool_)
    return resting[people.owner] if len(resting) else np.zeros(len(people), dtype=np.bool_)


def limits_of(drive: Any, holonomic: bool = False) -> DriveLimits:
    """Return the limits of a drive by field name (default: 1 m/s and 1 rad/s).

    Args:
        drive: the drive.
        holonomic: whether navigators move it in every direction.
    """
    known = {name: float(getattr(drive, name)) for name in DriveLimits._fields if hasattr(drive, name)}
    values: dict[str, Any] = {"max_speed": 1.0, "max_turn_rate": 1.0} | known
    return DriveLimits(**values | {"holonomic": holonomic})


def model_of(trial: Trial, people: InitialPeople, agents: int, seed: int) -> CrowdModel:
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
    values = {}
    for a in members:
        owner = people.owners[people.owner[a]] if a < len(people) else None
        if isinstance(owner, Agent) and owner.parameters:
            values[a] = {parameter.name.replace("-", "_"): parameter.value for parameter in owner.parameters}
    return values


def script_of(people: InitialPeople) -> ReplayedPeople | None:
    """Return the recorded tracks that people follow."""
    if not people.walks:
        return None
    first = len(people) - len(people.walks)
    owners = [people.owners[k] for k in people.owner[first:].tolist()]
    release = [
        owner.reaction_distance if isinstance(owner, RecordedPeople) and owner.mode == "reactive" else 0.0
        for owner in owners
    ]
    tracks = [ReplayedTrack(first + k, walk.time, walk.position) for k, walk in enumerate(people.walks)]
    return ReplayedPeople(tracks, release)


def avatars_of(trial: Trial, end: int, first: int) -> Avatars | None:
    """Return the avatars of a trial in one environment, and its robots whose pose comes from outside.

    Args:
        trial: the trial.
        end: index after that of the last avatar.
        first: index of the first robot.
    """
    led = [(first + k, robot, robot.mirror) for k, robot in enumerate(trial.robots) if robot.mirror is not None]
    if not (trial.avatars or led):
        return None
    count, robots = len(trial.avatars), [agent for agent, _, _ in led]
    sources = [avatar.pose_source() for avatar in trial.avatars]
    sources += [pose.source_from(robot.x, robot.y, robot.heading) for _, robot, pose in led]
    names = [avatar.name for avatar in trial.avatars] + [f"robot/{robot.name}" for _, robot, _ in led]
    delays = [avatar.delay for avatar in trial.avatars] + [pose.delay for _, _, pose in led]
    kinds = [avatar.source for avatar in trial.avatars] + [pose.source for _, _, pose in led]
    external = [name for name, kind in zip(names, kinds, strict=True) if kind == "external"]
    return Avatars([*range(end - count, end), *robots], names, [sources], delays, robots, external)


def journeys_of(trial: Trial, people: InitialPeople, agents: int) -> JourneyAssignment | None:
    """Return the journey of each agent; None if nobody has one."""
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


def set_off(
    scene: Scene, first: int, router: Router | None, journeys: JourneyAssignment | None, given: NDArray[np.float64]
) -> Scene:
    """Return the scene in which the ``first`` people start on their paths around walls to their first waypoints.

    Args:
        scene: the initial scene.
        first: number of people.
        router, journeys: paths and waypoints.
        given: ``[E, N]`` headings [rad], NaN for the walking direction.
    """
    position, aim = scene.position[:, :first], scene.goal[:, :first].copy()
    if router is not None:
        led = np.ones(aim.shape[:2], np.bool_) if journeys is None else journeys.uses_routing(scene)[:, :first]
        aim[led] = router.towards(position[led], aim[led])
    away = aim - position
    distance = np.hypot(away[..., 0], away[..., 1])
    velocity, heading = scene.velocity.copy(), scene.heading.copy()
    velocity[:, :first] = away * (scene.preferred_speed[:, :first] / np.maximum(distance, 1e-9))[..., None]
    ahead = np.arctan2(away[..., 1], away[..., 0])
    heading[:, :first] = np.where(np.isnan(given[:, :first]), ahead, given[:, :first])
    return scene.replace(velocity=velocity, heading=heading)
