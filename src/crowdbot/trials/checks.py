"""What makes a trial impossible although every value is allowed: places, overlaps, people who do not fit, periods."""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Sequence
from typing import Any

import numpy as np

from crowdbot.core import FreeClock, InputError, TrialError
from crowdbot.core.errors import did_you_mean

from .attribute import shown
from .checked import Checked, Problems
from .flow_checks import expected, flows, names
from .recorded_people import RecordedPeople, Walk
from .spawn import place
from .stage import Obstacle, Stage
from .sweep import sweep_problems
from .trial import Robot, Trial
from .zones import areas, crooked

__all__ = ["check_trial", "problems_of"]

MOST_VALUES = 100_000_000
"""An episode is held in memory: recorded scenes times agents must not exceed this."""
MOST_ARRIVALS = 100_000
WALKING = 1.6
"""About how fast [m/s] people go from portal to portal."""


def check_trial(trial: Trial, seed: int | None = None) -> None:
    """Raise :class:`TrialError` with every problem of a trial.

    Args:
        trial: made in Python or read.
        seed: places people with it; None is the trial's own.
    """
    whole = Checked.all_of(trial)
    checked = whole if seed is None else dataclasses.replace(whole, seed=seed)
    found = [f"trial {trial.name!r}: {_called(thing)} {sentence}" for thing, sentence in problems_of(checked)]
    if trial.sweeps and not found:
        found = sweep_problems(trial, seed)
    if found:
        raise TrialError(*found)


def problems_of(checked: Checked) -> list[tuple[Any, str]]:
    """Return every problem: the element that has it, and the end of a sentence about it."""
    too_large = [*_size(checked)]
    found = [*_periods(checked), *_names(checked), *names(checked), *too_large]
    if checked.stage is None:
        return found
    zones = areas(checked)
    shapes = [*_stage_shapes(checked.stage), *(problem for zone in zones for problem in zone.crooked())]
    found += shapes
    if any(thing is checked.stage or isinstance(thing, Obstacle) for thing, _ in shapes):
        return found
    bad = {id(thing) for thing, _ in shapes}
    lost = [p for zone in zones if id(zone.element) not in bad for p in zone.misplaced(checked.stage)]
    found += lost + [*_robots(checked.stage, checked.robots)]
    bad |= {id(thing) for thing, _ in lost}
    if not bad:
        found += [*flows(checked)]
    if too_large:
        return found
    walks, unread = _recordings(checked)
    spawners = [spawner for spawner in checked.spawners if id(spawner) not in bad]
    agents = [agent for agent in checked.agents if id(agent) not in bad]
    return found + unread + place(checked.stage, spawners, checked.robots, checked.seed, agents, walks)[1]


def _recordings(checked: Checked) -> tuple[list[tuple[RecordedPeople, Sequence[Walk]]], list[tuple[Any, str]]]:
    """Return the recordings that can be read, and why others cannot."""
    read: list[tuple[RecordedPeople, Sequence[Walk]]] = []
    problems: list[tuple[Any, str]] = []
    for one in checked.recorded:
        try:
            walks = one.walks(checked.duration or 0.0)
        except InputError as error:
            problems.append((one, f"data={shown(one.data)} {error}"))
            continue
        if not walks:
            problems.append((one, f"data={shown(one.data)} has nobody from {one.begin:g} s on; take an earlier begin"))
        read.append((one, walks))
    return read, problems


def _periods(checked: Checked) -> Problems:
    if checked.step is None:
        return
    clock = FreeClock(checked.step)
    periods: list[tuple[Any, str, float]] = []
    if checked.recording:
        periods += [(checked.recording, f"recording {n}", getattr(checked.recording, n)) for n in ("period", "markers")]
    for robot in checked.robots:
        periods.append((robot, "control-period", robot.control_period))
        carried = robot.usual["sensors"]
        for mount in robot.sensors:
            if robot.rates == "nearest" and mount in carried:
                continue
            thing = robot if mount in carried else mount
            whose = f'sensor {mount.name!r} of its type (rates="nearest" lets it fit): ' if mount in carried else ""
            periods.append((thing, f"{whose}rate {mount.sensor.rate:g} Hz:", 1.0 / mount.sensor.rate))
            if mount.sensor.delay > 0.0:
                periods.append((thing, f"{whose}delay", mount.sensor.delay))
    fits = _fitting([period for _, _, period in periods])
    for thing, name, period in periods:
        try:
            clock.every(period)
        except InputError:
            yield thing, f"{name} {period:g} s is not a whole number of time steps of {checked.step:g} s{fits}"


def _fitting(periods: Sequence[float]) -> str:
    """Return which step all periods are whole numbers of, as the end of a sentence."""
    step = math.gcd(*(round(period * 1e9) for period in periods)) / 1e9
    if step < 0.005:
        return ""
    while step > 0.1:
        step /= 2.0
    return f'; with step="{step:g}" all are'


def _names(checked: Checked) -> Problems:
    robots = [robot.name for robot in checked.robots]
    for k, robot in enumerate(checked.robots):
        if robot.name in robots[:k]:
            yield robot, f"name {robot.name!r} is taken by another robot; give each its own"
        mounts = [mount.name for mount in robot.sensors]
        for n, mount in enumerate(robot.sensors):
            if mount.name in mounts[:n]:
                yield mount, f"name {mount.name!r} is taken by another sensor of this robot; give each its own"
    yield from _cameras(checked)


def _cameras(checked: Checked) -> Problems:
    bodies = {robot.name: robot for robot in checked.robots}
    for k, camera in enumerate(checked.cameras):
        if camera.name in [other.name for other in checked.cameras[:k]]:
            yield camera, f"name {camera.name!r} is taken by another camera; give each its own"
        if not camera.robot:
            if camera.link:
                yield camera, f"link={shown(camera.link)} needs robot: the name of the robot whose link it is"
        elif camera.robot not in bodies:
            if "robot" not in checked.broken:
                near = did_you_mean(camera.robot, bodies)
                yield camera, f"robot={shown(camera.robot)} is no robot{near}; there are {', '.join(bodies) or 'none'}"
        elif camera.link and camera.link not in (links := bodies[camera.robot].body.model.links):
            near = did_you_mean(camera.link, links)
            yield camera, f"link={shown(camera.link)} is no link of robot {camera.robot!r}{near}"


def _size(checked: Checked) -> Problems:
    if checked.duration is None or checked.recording is None:
        return
    if checked.recording.period > checked.duration:
        yield (
            checked.recording,
            f"recording period {checked.recording.period:g} s is longer than the duration of {checked.duration:g} s",
        )
    coming = expected(checked)
    if coming > MOST_ARRIVALS:
        yield (
            checked.sources[0],
            f"lets people in, about {coming} together with other sources, more than {MOST_ARRIVALS}; take a lower rate,"
            " an earlier end or fewer at most",
        )
    first = len(checked.agents) + sum(spawner.count for spawner in checked.spawners)
    agents = first + coming + len(checked.robots) + _through(checked, first + coming)
    scenes = checked.duration / checked.recording.period
    if scenes * agents > MOST_VALUES:
        yield (
            checked.recording,
            f"recording period {checked.recording.period:g} s makes {scenes:.0f} scenes of {agents} agents, more than"
            f" {MOST_VALUES} places together; take a longer period, a shorter duration or fewer people",
        )


def _through(checked: Checked, people: int) -> int:
    """Return about how many people at most come out of portals as new ones."""
    if not checked.portals or checked.duration is None:
        return 0
    shortest = min(math.hypot(portal.dx, portal.dy) for portal in checked.portals)
    return round(people * checked.duration * WALKING / max(shortest, 0.1))


def _stage_shapes(stage: Stage) -> Problems:
    for obstacle in stage.obstacles:
        if wrong := crooked(obstacle.points):
            yield obstacle, f"points {wrong}"
    if stage.walkable and (wrong := crooked(stage.walkable)):
        yield stage, f"walkable {wrong}"


def _robots(stage: Stage, robots: Sequence[Robot]) -> Problems:
    import shapely

    for k, robot in enumerate(robots):
        for name, spot, reach in (
            ("starts", robot.position, 0.0),
            ("has its goal", robot.goal.position, robot.goal.tolerance),
        ):
            room = float(stage.clearance([spot])[0])
            block = stage.block_around(shapely.Point(spot))
            if not stage.holds(shapely.Point(spot)):
                yield robot, f"{name} at {spot[0]:g},{spot[1]:g} outside the walkable area"
            elif block:
                yield robot, f"{name} at {spot[0]:g},{spot[1]:g} inside {block}"
            elif room + reach < robot.radius:
                yield robot, f"{name} {room:.2f} m from a wall, and its radius is {robot.radius:g} m"
        for other in robots[:k]:
            away = float(np.hypot(robot.x - other.x, robot.y - other.y))
            if away < robot.radius + other.radius:
                yield (
                    robot,
                    f"starts {away:.2f} m from robot {other.name!r}, and their radii add up to"
                    f" {robot.radius + other.radius:g} m",
                )


def _called(thing: Any) -> str:
    if isinstance(thing, Obstacle):
        return "obstacle"
    name = getattr(thing, "name", "")
    return type(thing).__name__.lower() + (f" {name!r}" if name else "")
