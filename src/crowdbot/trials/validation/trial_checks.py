"""Checks of a trial whose values are allowed one by one: places, overlaps, room for people, periods."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from crowdbot.core import FreeClock, InputError, UnreadableValue, did_you_mean
from crowdbot.core.fields import Points, quote_value
from crowdbot.navigation import PathPlanner
from crowdbot.trials.agent import Avatar
from crowdbot.trials.camera import Camera
from crowdbot.trials.placement.population import gap_to_robot, gap_to_walls, place, smallest_reach, start_outline
from crowdbot.trials.recorded_people import RecordedPeople
from crowdbot.trials.robot import Mount, RobotGoal, RobotSpec
from crowdbot.trials.robots.behavior import BehaviorSpec
from crowdbot.trials.robots.robot_pose import start_problem
from crowdbot.trials.stage import Stage, area
from crowdbot.trials.trial import Trial
from crowdbot.world import Zone

from .flow_checks import (
    Problems,
    ValidationContext,
    arrival_count,
    duplicate_names,
    flows,
    inaccessible_stops,
    names,
    skip_unreadable,
)
from .ground_checks import ground_problems
from .rates import fitting, misfits

SMALLEST = 1e-6
"""Smallest area [m2] of a zone where people enter, go or leave."""


@dataclass(frozen=True)
class Area:
    """A zone of an element.

    Fields:
        element: element of the zone.
        name: name of its field.
        label: name of the zone in messages.
        points: corners.
        smallest: smallest area [m2].
        border: whether it may extend beyond the walkable area, like an exit in a door.
    """

    element: Any
    name: str
    label: str
    points: Points
    smallest: float = 0.0
    border: bool = False

    def shape_problem(self) -> str:
        """Return the problem of the shape as the end of a sentence, empty if there is none."""
        wrong = shape_problem(self.points, self.smallest)
        return wrong and f"{self.name.replace('_', '-')} {wrong}"

    def place_problem(self, stage: Stage) -> str:
        """Return why the zone is not accessible as the end of a sentence, empty if it is."""
        zone = area(self.points)
        if not (stage.meets(zone) if self.border else stage.holds(zone)):
            where = "lies" if self.border else "reaches"
            return f"{self.label} {where} outside the walkable area; move it, or make the area larger"
        block = stage.block_around(zone)
        return block and f"{self.label} lies inside {block}; it is not accessible, move it"


def areas(trial: Trial) -> list[Area]:
    """Return the zones of a trial."""
    found = list[Area]()
    for group, label, smallest in ((trial.spawners, "spawn zone", 0.0), (trial.sources, "zone", SMALLEST)):
        found += _zones(group, "zone", label, smallest)
        found += _zones(group, "goal", "goal zone", smallest)
    stops = [stop for journey in trial.journeys for stop in journey.stops if isinstance(stop, Zone)]
    found += _zones(stops, "points", "zone", SMALLEST)
    found += _zones(trial.portals, "zone", "zone", SMALLEST, border=True)
    found += _zones(trial.agents, "goal_zone", "goal zone", 0.0)
    return found + _zones(trial.exits, "zone", "zone", SMALLEST, border=True)


def _zones(things: Sequence[Any], name: str, label: str, smallest: float, border: bool = False) -> list[Area]:
    rows = ((thing, getattr(thing, name)) for thing in things)
    return [Area(thing, name, label, points, smallest, border) for thing, points in rows if points]


def shape_problem(points: Points, smallest: float = 0.0) -> str:
    """Return why points are not the corners of a polygon as the end of a sentence, empty if they are."""
    import shapely

    if len(set(points)) < 3:
        return "must be at least 3 different points"
    polygon = area(points)
    if not polygon.is_valid:
        return f"is not a simple polygon: {shapely.is_valid_reason(polygon).lower()}; list its corners in order"
    if polygon.area > smallest:
        return ""
    return f"has {polygon.area:g} m2, it must have more than {smallest:g} m2" if polygon.area > 0.0 else "has no area"


MOST_VALUES = 100_000_000
"""Largest number of recorded scenes times agents; an episode is kept in memory."""
MOST_ARRIVALS = 100_000
WALKING = 1.6
"""Assumed speed [m/s] of people between portals."""


def problems_of(trial: Trial, seed: int | None = None) -> list[tuple[Any, str]]:
    """Return the problems of a trial: the element, and the end of a sentence.

    Places are checked if names, periods, sizes and shapes have no problem, paths and room for people if places have
    none: otherwise one problem would be reported as many.

    Args:
        trial: the trial.
        seed: seed of the placement of people (default: the seed of the trial).
    """
    checked, zones = ValidationContext(trial, seed), areas(trial)
    found = [
        *skip_unreadable(
            _periods(checked),
            *(_exact_rates(trial, robot) for robot in trial.robots),
            *_names(trial),
            *names(checked),
            *ground_problems(checked),
            *_size(trial),
        ),
        *((zone.element, wrong) for zone in zones if (wrong := zone.shape_problem())),
        *_stage_shapes(trial.stage),
    ]
    found = found or [
        *((zone.element, wrong) for zone in zones if (wrong := zone.place_problem(trial.stage))),
        *skip_unreadable(
            inaccessible_stops(trial),
            *_robots(trial.stage, trial.robots),
            *(_recording(trial, item) for item in trial.recorded),
            *(_avatar(avatar) for avatar in trial.avatars),
            *(_behavior(item) for owner in checked.people for item in owner.behaviors),
            *(start_problem(robot) for robot in trial.robots),
        ),
    ]
    return found or [*skip_unreadable(*flows(checked)), *_places(checked)]


def _places(checked: ValidationContext) -> list[tuple[Any, str]]:
    """Return the people who do not fit; an avatar whose place only code of the user knows takes no room."""
    trial = checked.trial
    avatars: list[Avatar] = []
    for avatar in trial.avatars:
        with contextlib.suppress(UnreadableValue):
            avatar.start_pose()
            avatars.append(avatar)
    walks = [(item, item.walks(trial.duration)) for item in trial.recorded]
    return place(trial.stage, trial.spawners, trial.robots, checked.seed, trial.agents, walks, avatars)[1]


def _recording(trial: Trial, recording: RecordedPeople) -> Problems:
    """Yield why a recording cannot be replayed."""
    try:
        walks = recording.walks(trial.duration)
    except InputError as error:
        yield recording, f"data={quote_value(recording.data)} {error}"
        return
    if not walks:
        yield (
            recording,
            f"data={quote_value(recording.data)} contains nobody after {recording.begin:g} s; use an earlier begin",
        )


def _avatar(avatar: Avatar) -> Problems:
    """Yield why the source of an avatar gives no pose."""
    try:
        avatar.start_pose()
    except InputError as error:
        yield avatar, f"{avatar.source}={quote_value(getattr(avatar, avatar.source))} {error}"


def _behavior(item: BehaviorSpec) -> Problems:
    """Yield why a behaviour tree cannot be read."""
    try:
        item.behavior()
    except InputError as error:
        yield item, f"file={quote_value(item.file)} cannot be used: {error}"


def _periods(checked: ValidationContext) -> Problems:
    trial = checked.trial
    clock = FreeClock(trial.step)
    for thing, name, period in _all_periods(trial):
        try:
            clock.schedule(period)
        except InputError:
            shortest = f"{clock.step_ns / 1e9:.9g}"
            yield (
                thing,
                f"{name} {period:g} s is shorter than the time step of {trial.step:g} s; take at least {shortest} s, or"
                " a shorter step",
            )


def _all_periods(trial: Trial) -> Iterator[tuple[Any, str, float]]:
    """Yield all periods: the element, a name, and the period [s]."""
    yield trial.recording, "period", trial.recording.period
    yield trial.recording, "markers", trial.recording.markers
    for robot in trial.robots:
        yield robot, "control-period", robot.control_period
        for mount in robot.sensors:
            if mount not in robot.type_sensors and not math.isnan(mount.sensor.rate):  # nan: known when code runs
                yield mount, f"rate {mount.sensor.rate:g} Hz:", 1.0 / mount.sensor.rate


def _exact_rates(trial: Trial, robot: RobotSpec) -> Problems:
    """Yield a robot with ``sensor-rates="exact"`` and sensors that measure more often than once per time step."""
    if robot.sensor_rates == "exact" and (others := _too_frequent(robot, trial.step)):
        rates = ", ".join(f"{mount.name} {mount.sensor.rate:g} Hz" for mount in others)
        step = fitting([trial.recording.period, robot.control_period, *(1.0 / mount.sensor.rate for mount in others)])
        take = f'take step="{step:g}", or leave out' if step else "leave out"
        yield (
            robot,
            f"has sensors of its type that measure more than once per time step of {trial.step:g} s: {rates}; {take}"
            ' sensor-rates="exact" to let them measure as often as the step allows',
        )


def _too_frequent(robot: RobotSpec, step: float) -> list[Mount]:
    """Return the sensors of a robot's type whose period is shorter than a time step [s]."""
    clock, found = FreeClock(step), []
    for mount in misfits(robot, step):
        try:
            clock.schedule(1.0 / mount.sensor.rate)
        except InputError:
            found.append(mount)
    return found


def _names(trial: Trial) -> Iterator[Problems]:
    yield duplicate_names(trial.robots, "robot")
    yield duplicate_names(trial.avatars, "avatar")
    yield from (duplicate_names(robot.sensors, "sensor of this robot") for robot in trial.robots)
    yield duplicate_names(trial.cameras, "camera")
    yield from (_camera(trial.robots, camera) for camera in trial.cameras)


def _camera(robots: Sequence[RobotSpec], camera: Camera) -> Problems:
    if not camera.robot:
        if camera.link:
            yield camera, f"link={quote_value(camera.link)} needs robot: the name of the robot whose link it is"
        return
    bodies = {robot.name: robot for robot in robots}
    if camera.robot not in bodies:
        near = did_you_mean(camera.robot, bodies)
        yield camera, f"robot={quote_value(camera.robot)} is not a robot{near}; there are {', '.join(bodies) or 'none'}"
    elif camera.link and camera.link not in (links := bodies[camera.robot].body.model.links):
        near = did_you_mean(camera.link, links)
        yield camera, f"link={quote_value(camera.link)} is not a link of robot {camera.robot!r}{near}"


def _size(trial: Trial) -> Iterator[Problems]:
    yield _too_long(trial)
    yield _too_many(trial)
    yield _too_large(trial)


def _too_long(trial: Trial) -> Problems:
    if trial.recording.period > trial.duration:
        yield (
            trial.recording,
            f"period {trial.recording.period:g} s is longer than the duration of {trial.duration:g} s",
        )


def _too_many(trial: Trial) -> Problems:
    coming = arrival_count(trial)
    if coming > MOST_ARRIVALS:
        yield (
            trial.sources[0],
            f"produces about {coming} people together with other sources, more than {MOST_ARRIVALS}; take a lower rate,"
            " an earlier end or fewer at most",
        )


def _too_large(trial: Trial) -> Problems:
    first = len(trial.agents) + len(trial.avatars) + sum(spawner.count for spawner in trial.spawners)
    coming = arrival_count(trial)
    agents = first + coming + len(trial.robots) + _through(trial, first + coming)
    scenes = trial.duration / trial.recording.period
    if scenes * agents > MOST_VALUES:
        yield (
            trial.recording,
            f"period {trial.recording.period:g} s makes {scenes:.0f} scenes of {agents} agents, more than"
            f" {MOST_VALUES} positions in total; use a longer period, a shorter duration or fewer people",
        )


def _through(trial: Trial, people: int) -> int:
    """Return the approximate maximum number of new people from portals."""
    if not trial.portals:
        return 0
    shortest = min(math.hypot(portal.dx, portal.dy) for portal in trial.portals)
    return round(people * trial.duration * WALKING / max(shortest, 0.1))


def _stage_shapes(stage: Stage) -> list[tuple[Any, str]]:
    """Return the parts of a stage with an invalid shape: the element, and the end of a sentence."""
    rows: list[tuple[Any, str, Points]] = [(obstacle, "points", obstacle.points) for obstacle in stage.obstacles]
    rows += [(stage, "walkable", stage.walkable)] if stage.walkable else []
    return [(thing, f"{name} {wrong}") for thing, name, points in rows if (wrong := shape_problem(points))]


def _robots(stage: Stage, robots: Sequence[RobotSpec]) -> Iterator[Problems]:
    for k, robot in enumerate(robots):
        yield _robot_place(stage, robot, "starts", robot)
        yield _robot_place(stage, robot, "has its goal", robot.goal)
        yield from (_robot_overlap(robot, other) for other in robots[:k])
        yield _robot_path(stage, robot)


def _robot_place(stage: Stage, robot: RobotSpec, word: str, there: RobotSpec | RobotGoal) -> Problems:
    reach = there.tolerance if isinstance(there, RobotGoal) else 0.0
    if problem := robot_place_problem(stage, robot, there.position, reach, starts=there is robot):
        yield robot, f"{word} {problem}"


def robot_place_problem(
    stage: Stage, robot: RobotSpec, place: tuple[float, float], reach: float = 0.0, *, starts: bool = False
) -> str:
    """Return why a robot cannot be at a place, as the end of a sentence; empty if it can.

    A robot with an outline may turn: it fits where the disc in its outline does. At its start its heading is known.

    Args:
        stage: the stage.
        robot: the robot.
        place: x, y [m].
        reach: distance to the place [m] that is close enough.
        starts: whether the place is the start of the robot, with its heading there.

    >>> from crowdbot.navigation import Straight
    >>> robot = RobotSpec(type="qolo", x=0, y=0, goal=RobotGoal(5, 0), navigator=Straight())
    >>> robot_place_problem(Stage(walkable=[(-1, -1), (9, -1), (9, 1), (-1, 1)]), robot, (12.0, 0.0))
    'at 12,0 outside the walkable area'
    """
    import shapely

    room = float(stage.clearance([place])[0])
    block = stage.block_around(shapely.Point(place))
    if not stage.holds(shapely.Point(place)):
        return f"at {place[0]:g},{place[1]:g} outside the walkable area"
    if block:
        return f"at {place[0]:g},{place[1]:g} inside {block}"
    if room + reach >= robot.radius:
        return ""
    if start_outline(robot) is None:
        return f"{room:.2f} m from a wall, and its radius is {robot.radius:g} m"
    if starts and (gap := gap_to_walls(stage, robot)) < 0.0:
        return f"{room:.2f} m from a wall, and its outline reaches {-gap:.2f} m into it; move or turn it"
    least = smallest_reach(robot)
    return f"{room:.2f} m from a wall, and its outline needs {least:.2f} m in any pose" if room + reach < least else ""


def _robot_path(stage: Stage, robot: RobotSpec) -> Problems:
    """Yield why the path planner of a robot finds no path from start to goal."""
    if robot.planner is None:
        return
    try:
        walls = stage.driving_walls(robot.body.max_step, robot.body.max_slope)
        planner = PathPlanner.for_stage(walls, robot.radius, robot.planner.margin, robot.body.half_width)
        planner.waypoints(robot.position, robot.goal.position)
    except InputError as error:
        reason = str(error).removeprefix("PathPlanner: ").removeprefix("no path: ").removeprefix("Router: ")
        yield (
            robot,
            f'has <planner margin="{robot.planner.margin:g}"/> but no path to its goal: {reason}; take a smaller'
            " margin, or leave the planner out",
        )


def _robot_overlap(robot: RobotSpec, other: RobotSpec) -> Problems:
    away = float(np.hypot(robot.x - other.x, robot.y - other.y))
    if away >= robot.radius + other.radius or (gap := gap_to_robot(robot, other)) >= 0.0:
        return
    if start_outline(robot) is None and start_outline(other) is None:
        why = f"and their radii add up to {robot.radius + other.radius:g} m"
    else:
        why = f"and their outlines overlap by {-gap:.2f} m"
    yield robot, f"starts {away:.2f} m from robot {other.name!r}, {why}"
