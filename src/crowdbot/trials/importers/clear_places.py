"""Places that the simulator of a scene allows and a trial does not: people in walls, in each other and in exits.

Other simulators push people out of walls and each other in their first steps, or let zones reach into exits. A trial is
refused then. People, robots and stops are moved to the nearest place with room, zones are cut, and each change has a
note.
"""

from __future__ import annotations

import dataclasses
import math
from collections.abc import Callable, Iterator, Sequence
from typing import Any

import numpy as np
import shapely

from crowdbot.core import InputError
from crowdbot.core.fields import Points
from crowdbot.trials.agent import Agent
from crowdbot.trials.crowd import Routing
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.trials.placement.population import gap_to_disc, place
from crowdbot.trials.placement.spawn_placement import OccupiedDiscs
from crowdbot.trials.robot import RobotSpec
from crowdbot.trials.stage import Stage, area
from crowdbot.trials.trial import Trial
from crowdbot.world import Point, Zone

Spot = tuple[float, float]
Note = Callable[[str], None]
MARGIN = 1e-3
"""Room [m] beyond the radius at a place to which something is moved."""
FARTHEST = 2.0
"""Largest distance [m] by which a person is moved; robots are moved by their diameter if that is more."""
RINGS, ANGLES = 80, 32
SEEDS = 5
"""Placements at random that must have room for all people of a zone."""
OVERLAP = 1e-9
"""Overlap [m2] of zones that only touch."""
SMALLEST = 0.01
"""Smallest area [m2] of what is left of a zone."""
MOST_NAMES = 5
MANY_EDGES = 1000
"""Edges of walls above which routes are tried; a router takes seconds there."""


def clear_places(trial: Trial, note: Note) -> Trial:
    """Return a trial in which people, robots, stops and zones have room, with a note for each kind of change."""
    room = _Room(trial.stage)
    robots = _robots(room, trial.robots, note)
    agents = _agents(room, trial.agents, robots, note)
    ways = {
        journey.name: tuple(kept for stop in journey.stops if (kept := _stop(room, stop, note)) is not None)
        for journey in trial.journeys
    }
    journeys = tuple(
        dataclasses.replace(journey, stops=ways[journey.name]) for journey in trial.journeys if ways[journey.name]
    )
    agents = tuple(_on_its_way(agent, ways, note) for agent in agents)
    spawners, sources = (
        tuple(
            _on_its_way(kept, ways, note)
            for item in items
            if ways.get(item.journey, True) or isinstance(item, Spawner)
            if (kept := _off_exits(item, trial, room, note)) is not None
        )
        for items in (trial.spawners, trial.sources)
    )
    moved = dataclasses.replace(
        trial, robots=robots, agents=agents, journeys=journeys, spawners=spawners, sources=sources
    )
    return dataclasses.replace(moved, spawners=_as_many_as_fit(moved, note), routing=_possible_routing(trial, note))


def _possible_routing(trial: Trial, note: Note) -> Routing | None:
    """The routing of a trial; None if its walls have too many corners for it."""
    if trial.routing is None:
        return None
    walls = trial.stage.walking_walls()
    if len(walls.segments()) > MANY_EDGES:
        try:
            trial.routing.router(walls)
        except InputError as error:
            why = str(error).removeprefix("Router: ")
            note(f"people find no ways around walls, and walk straight to their goals: {why}")
            return None
    return trial.routing


class _Room:
    """Room beside the solids of a stage."""

    def __init__(self, stage: Stage) -> None:
        self.stage = stage
        solids, ground = stage.shapes
        self.ground = ground
        self.blocks = [solid for solid in solids if solid.geom_type == "Polygon"]
        lines = [solid.exterior if solid.geom_type == "Polygon" else solid for solid in solids]
        borders = [] if ground is None else [ground.boundary]
        self.lines = shapely.STRtree([*lines, *borders])

    def clearance(self, spot: Spot) -> float:
        """Distance [m] of a point to the nearest solid; 0 in it."""
        return float(self.stage.clearance([spot])[0])

    def nearest(
        self, spot: Spot, radius: float, farthest: float, free: Callable[[float, float], bool] | None = None
    ) -> Spot | None:
        """The nearest place with room for a disc, on the same side of the walls unless the point is in one.

        Args:
            spot: x, y [m].
            radius: radius of the disc [m].
            farthest: largest distance [m].
            free: whether nobody else is at a place (default: always).
        """
        beside = self.clearance(spot) > MARGIN
        turns = 2.0 * math.pi * np.arange(ANGLES) / ANGLES
        for away in np.linspace(0.0, farthest, RINGS + 1)[1:].tolist():
            ring = np.column_stack([spot[0] + away * np.cos(turns), spot[1] + away * np.sin(turns)])
            room = self.stage.clearance(ring)
            best = np.argsort(-room, kind="stable")[: np.count_nonzero(room >= radius + MARGIN)]
            for x, y in np.round(ring[best], 6).tolist():
                across = beside and len(self.lines.query(shapely.LineString([spot, (x, y)]), predicate="intersects"))
                if not across and (free is None or free(x, y)):
                    return x, y
        return None


def _robots(room: _Room, robots: Sequence[RobotSpec], note: Note) -> tuple[RobotSpec, ...]:
    kept: list[RobotSpec] = []
    for robot in robots:

        def free(x: float, y: float, radius: float = robot.radius) -> bool:
            return all(gap_to_disc(other, (x, y), radius) >= 0.0 for other in kept)

        farthest = max(FARTHEST, 2.0 * robot.radius)
        if room.clearance(robot.position) < robot.radius or not free(*robot.position):
            there = room.nearest(robot.position, robot.radius, farthest, free)
            if there is None:
                note(
                    f"{robot.name} starts in a wall or another robot at {_at(robot.position)}, without room within"
                    f" {farthest:g} m, and is left out"
                )
                continue
            note(f"{robot.name} starts in a wall or a robot at {_at(robot.position)}, and is moved to {_at(there)}")
            robot = dataclasses.replace(robot, x=there[0], y=there[1])  # noqa: PLW2901
        goal = robot.goal
        if room.clearance(goal.position) + goal.tolerance < robot.radius or _in_block(room, goal.position):
            there = room.nearest(goal.position, robot.radius, farthest)
            if there is not None:
                note(f"the goal of {robot.name} at {_at(goal.position)} is in a wall, and is moved to {_at(there)}")
                robot = dataclasses.replace(robot, goal=dataclasses.replace(goal, x=there[0], y=there[1]))  # noqa: PLW2901
        kept.append(robot)
    return tuple(kept)


def _agents(room: _Room, agents: Sequence[Agent], robots: Sequence[RobotSpec], note: Note) -> tuple[Agent, ...]:
    """Return the agents; those that stand right keep their places."""
    if not agents:
        return ()
    taken = OccupiedDiscs(2.0 * max(agent.radius for agent in agents))

    def free(x: float, y: float, radius: float) -> bool:
        return taken.free(x, y, radius, gap=0.0) and all(gap_to_disc(robot, (x, y), radius) >= 0.0 for robot in robots)

    places: dict[int, Spot | None] = {}
    beside = room.stage.clearance([agent.position for agent in agents]).tolist()
    for k, (agent, away) in enumerate(zip(agents, beside, strict=True)):
        if away >= agent.radius - OVERLAP and free(agent.x, agent.y, agent.radius - OVERLAP):
            taken.add(agent.x, agent.y, agent.radius)
            places[k] = agent.position
    moved: list[str] = []
    lost: list[str] = []
    full: set[tuple[int, int, float]] = set()
    farthest = 0.0
    for k, agent in enumerate(agents):
        if k in places:
            continue
        radius, cell = agent.radius, (round(agent.x), round(agent.y), agent.radius)
        there = None
        if cell not in full:
            there = room.nearest(agent.position, radius, FARTHEST, lambda x, y, radius=radius: free(x, y, radius))  # type: ignore[misc]
        places[k] = there
        if there is None:
            full.add(cell)
            lost.append(agent.name)
            continue
        taken.add(*there, agent.radius)
        moved.append(agent.name)
        farthest = max(farthest, math.dist(agent.position, there))
    where = "in walls, robots or each other"
    if moved:
        note(
            f"{_people(moved)} {where}, moved to the nearest place with room, by up to {max(0.01, farthest):.2f} m:"
            f" {_names(moved)}"
        )
    if lost:
        note(f"{_people(lost)} {where}, without room within {FARTHEST:g} m, left out: {_names(lost)}")
    return tuple(
        agent if spot == agent.position else dataclasses.replace(agent, x=spot[0], y=spot[1])
        for k, agent in enumerate(agents)
        if (spot := places[k]) is not None
    )


def _people(names: Sequence[str]) -> str:
    return f"{len(names)} people stand" if len(names) > 1 else "1 person stands"


def _names(names: Sequence[str]) -> str:
    more = f" and {len(names) - MOST_NAMES} more" if len(names) > MOST_NAMES else ""
    return ", ".join(names[:MOST_NAMES]) + more


def _on_its_way(item: Any, ways: dict[str, tuple[Any, ...]], note: Note) -> Any:
    """A person or spawner, who stands if all stops of the journey are left out."""
    if ways.get(item.journey, True):
        return item
    note(f"{item.name} has no goal that can be reached, and stands")
    return dataclasses.replace(item, journey="", **({"stands": True} if isinstance(item, Spawner) else {}))


def _stop(room: _Room, stop: Any, note: Note) -> Any:
    """A stop of a journey off the solids; None without room near it."""
    if isinstance(stop, Point) and (
        _in_block(room, (stop.x, stop.y)) or not room.stage.holds(shapely.Point(stop.x, stop.y))
    ):
        there = room.nearest((stop.x, stop.y), 0.0, FARTHEST)
        end = "left out, without room" if there is None else f"moved to {_at(there)}"
        note(f"a goal at {_at((stop.x, stop.y))} lies in a solid, and is {end}")
        return None if there is None else dataclasses.replace(stop, x=there[0], y=there[1])
    if isinstance(stop, Zone):
        cut = _cut(stop.points, room.blocks, room.ground)
        if cut != stop.points:
            end = "left out, without room" if cut is None else "cut there"
            note(f"a goal zone around {_at(_middle(stop.points))} reaches into a solid, and is {end}")
            return None if cut is None else dataclasses.replace(stop, points=cut)
    return stop


def _off_exits(item: Any, trial: Trial, room: _Room, note: Note) -> Any:
    """A spawner or source whose zone does not overlap exits; None without room beside them."""
    exits = [area(way.zone) for way in trial.exits]
    source = isinstance(item, SourceSpec)
    cut = _cut(item.zone, [*exits, *(room.blocks if source else [])], room.ground)
    if cut == item.zone:
        return item
    inside = room.ground is None or room.ground.covers(area(item.zone))
    what = "exits or solids" if source else "exits"
    what = what if inside else f"{what} or outside the walkable area"
    if cut is None:
        why = ", where people would leave at once," if inside and not source else ""
        note(f"the zone of {item.name} lies in {what}{why or ','} and is left out")
        return None
    before, after = area(item.zone).area, area(cut).area
    why = "" if source or not inside else ", where people would leave at once"
    note(f"the zone of {item.name} reaches into {what}{why}: it is cut from {before:.3g} to {after:.3g} m2")
    return dataclasses.replace(item, zone=cut)


def _as_many_as_fit(trial: Trial, note: Note) -> tuple[Spawner, ...]:
    """The spawners with at most as many people as have room in several placements."""
    if not trial.spawners:
        return ()
    fit = np.array([spawner.count for spawner in trial.spawners])
    for seed in range(trial.seed, trial.seed + SEEDS):
        people, problems = place(trial.stage, trial.spawners, trial.robots, seed, trial.agents)
        if problems:
            placed = people.spawner
            fit = np.minimum(fit, np.bincount(placed[placed >= 0], minlength=len(fit))[: len(fit)])
    kept = []
    for spawner, count in zip(trial.spawners, fit.tolist(), strict=True):
        if count < spawner.count:
            size = f"{area(spawner.zone).area:.3g} m2"
            note(
                f"{count} of {spawner.count} people of {spawner.name} fit into their zone of {size} without overlaps:"
                " the others are left out"
            )
        if count or not spawner.count:
            kept.append(dataclasses.replace(spawner, count=count) if count < spawner.count else spawner)
    return tuple(kept)


def _in_block(room: _Room, spot: Spot) -> bool:
    return bool(room.stage.block_around(shapely.Point(spot)))


def _cut(points: Points, solids: Sequence[Any], ground: Any = None) -> Points | None:
    """The largest part of a polygon outside others and on the ground, as corners; None if there is hardly any.

    Args:
        points: corners of the polygon.
        solids: polygons that it must not overlap.
        ground: the walkable area, None for everywhere.
    """
    zone = area(points)
    if not zone.is_valid:
        return points
    if ground is not None and not ground.buffer(OVERLAP).covers(zone):
        inside = _largest(zone.intersection(ground.buffer(-MARGIN, join_style="mitre")))
        return None if inside is None else _cut(inside, solids)
    near = [solid.buffer(MARGIN, join_style="mitre") for solid in solids if zone.intersection(solid).area > OVERLAP]
    if not near:
        return points
    return _largest(zone.difference(shapely.union_all(near)))


def _largest(shape: Any) -> Points | None:
    """Corners of the largest polygon of a shape; None if it has less than ``SMALLEST``."""
    rest = max(_without_holes(shape), key=lambda part: part.area, default=None)
    if rest is None or rest.area < SMALLEST:
        return None
    return Points.of([(round(x, 6), round(y, 6)) for x, y in rest.simplify(0.0).exterior.coords[:-1]])


def _without_holes(shape: Any) -> Iterator[Any]:
    """The polygons of a shape; those with holes in two parts beside the first hole."""
    for part in shapely.get_parts(shape):
        if part.geom_type != "Polygon":
            continue
        if not part.interiors:
            yield part
            continue
        x, (low, bottom, high, top) = shapely.Polygon(part.interiors[0]).centroid.x, part.bounds
        for side in (shapely.box(low, bottom, x, top), shapely.box(x, bottom, high, top)):
            yield from _without_holes(part.intersection(side))


def _middle(points: Points) -> Spot:
    middle = area(points).centroid
    return middle.x, middle.y


def _at(spot: Spot) -> str:
    return f"{spot[0]:.3g},{spot[1]:.3g}"
