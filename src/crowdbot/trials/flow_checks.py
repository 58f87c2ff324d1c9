"""What makes the ways of people impossible: names that nothing has, goals nobody reaches, zones without room."""

from __future__ import annotations

import itertools
from collections.abc import Collection, Iterator, Sequence
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError, stream
from crowdbot.core.errors import did_you_mean
from crowdbot.world import Router

from .agent import Agent
from .attribute import shown
from .checked import Checked, Problems
from .company import points_in
from .crowd import Crowds, crowd_names
from .distribution import Distribution
from .drawn import Drawn
from .journey import Direction, Journey, Point, Zone
from .notation import Points
from .people import Source, Spawner
from .stage import Stage, area

__all__ = ["expected", "flows", "names"]

Floats = NDArray[np.float64]

BATCHES = 30
"""So many batches of points of a zone are tried for one where a body has room."""
SPOTS = 6
"""So many points of a zone stand for all."""
OVERLAP = 1e-9
"""Zones that share less than this [m2] touch only."""


def expected(checked: Checked) -> int:
    """Return about how many people come in."""
    if checked.duration is None:
        return 0
    return round(sum(source.expected(checked.duration) for source in checked.sources))


def names(checked: Checked) -> Problems:
    """Yield names that are taken or that nothing has, and people who have no way to go or two."""
    known = [journey.name for journey in checked.journeys]
    for k, journey in enumerate(checked.journeys):
        if journey.name in known[:k]:
            yield journey, f"name {journey.name!r} is taken by another journey; give each its own"
        yield from _endless(journey)
    crowds = crowd_names(checked.crowd)
    first = len(checked.agents) + sum(spawner.count for spawner in checked.spawners)
    if checked.capacity is not None and first > checked.capacity:
        last = (*checked.agents, *checked.spawners)[-1]
        yield last, f"makes {first} people at the beginning, more than the capacity {checked.capacity}"
    for one in checked.people:
        yield from _goals(one)
        if one.journey and "journey" not in checked.broken:
            yield from _named(one, "journey", known)
        if one.crowd and checked.crowd is not None and "crowd" not in checked.broken:
            yield from _named(one, "crowd", crowds)
        if isinstance(one, Source) and one.begin >= one.end:
            yield one, f"begin {one.begin:g} s must be before end {one.end:g} s"
        if isinstance(one, Agent) and one.parameters:
            yield from _own(checked, one, crowds)
    for recorded in checked.recorded:
        if recorded.crowd and checked.crowd is not None and "crowd" not in checked.broken:
            yield from _named(recorded, "crowd", crowds)


def flows(checked: Checked) -> Problems:
    """Yield zones without room and ways that lead nowhere; every shape is right and in its place."""
    assert checked.stage is not None
    router = None
    if checked.routing is not None:
        try:
            router = checked.routing.router(checked.stage.as_walls())
        except InputError as error:
            yield checked.routing, f"is impossible on this stage: {str(error).removeprefix('Router: ')}"
            return
    for source in checked.sources:
        yield from _entrance(checked.stage, source)
    for journey in checked.journeys:
        for stop in journey.stops:
            yield from _stop(checked.stage, stop, router)
    yield from _straight_out(checked)
    if router is not None and router.unreachable == "error":
        yield from _legs(checked, router)


def _named(one: Any, word: str, known: Collection[str]) -> Problems:
    name = getattr(one, word)
    if name not in known:
        there = f"there are {', '.join(known)}" if known else f"no {word} has a name here"
        yield one, f"{word}={shown(name)} is not the name of a {word}{did_you_mean(name, known)}; {there}"


def _goals(one: Agent | Spawner | Source) -> Problems:
    stands = isinstance(one, Agent) or getattr(one, "stands", False)
    if one.goal and one.journey:
        yield one, 'has both a goal and a journey; give one of them: goal="x,y x,y x,y" or journey="name"'
    elif stands and isinstance(one, Spawner) and (one.goal or one.journey):
        yield one, 'has people who stand, and a goal or a journey; leave out stands="true", or where they go'
    elif not (one.goal or one.journey or stands):
        yield one, 'needs a goal zone or a journey: goal="x,y x,y x,y" or journey="name"'
    elif one.journey and one.arrival != "leave":
        yield one, f'arrival="{one.arrival}" goes with a goal zone; for a journey say then="{one.arrival}" in it'


def _own(checked: Checked, agent: Agent, crowds: Sequence[str]) -> Problems:
    """Yield parameters that the model of a person does not have, or cannot take."""
    if checked.crowd is None:
        return
    several = isinstance(checked.crowd, Crowds)
    models = checked.crowd.models if isinstance(checked.crowd, Crowds) else (checked.crowd,)
    model = models[crowds.index(agent.crowd) if several and agent.crowd in crowds else 0]
    draws = {one.name.replace("-", "_"): Distribution.of(one.value) for one in agent.parameters}
    for sentence in Drawn.problems(model.model if isinstance(model, Drawn) else model, draws):
        yield agent, f"parameter {sentence.replace('drawn', 'given', 1)}"


def _endless(journey: Journey) -> Problems:
    for k, stop in enumerate(journey.stops[:-1]):
        if isinstance(stop, Direction):
            yield stop, f"is stop {k + 1} of {len(journey.stops)} and has no end; a direction must be the last stop"


def _entrance(stage: Stage, source: Source) -> Problems:
    for label, points in (("zone", source.zone), ("goal zone", source.goal)):
        if points and (block := stage.block_in(area(points), OVERLAP)):
            yield (
                source,
                f"{label} reaches into {block}; move it, or cut it there",
            )
            return
    radius = source.radius.extent[1]
    batches = itertools.islice(points_in(source.zone, stream(0, "check", "source")), BATCHES)
    if not any(np.any(stage.clearance(points) >= radius) for points in batches):
        yield (
            source,
            f"zone of {area(source.zone).area:.2f} m2 leaves no room for a body of radius {radius:g} m beside walls;"
            " move it, or make it larger",
        )


def _stop(stage: Stage, stop: Point | Direction | Zone, router: Router | None) -> Problems:
    import shapely

    if isinstance(stop, Point):
        block = stage.block_around(shapely.Point(stop.x, stop.y))
        if not stage.holds(shapely.Point(stop.x, stop.y)):
            yield stop, f"at {stop.x:g},{stop.y:g} lies outside the walkable area"
        elif block:
            yield stop, f"at {stop.x:g},{stop.y:g} lies inside {block}"
    elif isinstance(stop, Zone) and (router is None or stop.aim == "nearest"):
        if block := stage.block_in(area(stop.points), OVERLAP):
            yield stop, f"zone reaches into {block}; move it, or cut it there"
    elif isinstance(stop, Zone) and router is not None and not len(_spots(router, stop.points)):
        yield stop, f"zone leaves no room for a body of radius {router.radius:g} m, which routing asks for"


def _straight_out(checked: Checked) -> Problems:
    """Yield those who would leave where they come in."""
    coming: tuple[Spawner | Source, ...] = (*checked.spawners, *checked.sources)
    for one in coming:
        for number, way in enumerate(checked.exits, 1):
            if area(one.zone).intersection(area(way.zone)).area > OVERLAP:
                called = repr(way.name) if way.name else str(number)
                yield one, f"zone overlaps exit {called}, where people would leave at once; move one of them"


class _Place(NamedTuple):
    """Where a way begins or ends; ``anywhere`` in it, or where it suits the person best."""

    points: Points
    anywhere: bool = True

    @classmethod
    def of(cls, stop: Point | Direction | Zone) -> _Place | None:
        """Return the place of a stop; None of a direction."""
        if isinstance(stop, Point):
            return cls(Points.of([(stop.x, stop.y)]))
        return cls(stop.points, stop.aim == "random") if isinstance(stop, Zone) else None


def _legs(checked: Checked, router: Router) -> Problems:
    """Yield ways around walls that lead nowhere, each once: into a journey or to a goal, and from stop to stop."""
    for one in checked.people:
        if isinstance(one, Agent) and not (one.goal or one.journey):
            continue
        journey = next((journey for journey in checked.journeys if journey.name == one.journey), None)
        first = _Place(one.goal) if one.goal else journey and _Place.of(journey.stops[0])
        what = (
            ("the goal" if isinstance(one, Agent) else "the goal zone")
            if one.goal
            else f"the first stop of journey {one.journey!r}"
        )
        start, word = (one.zone, "zone") if not isinstance(one, Agent) else (Points.of([one.position]), "place")
        if first and not _leads(router, _Place(start), first):
            yield one, f"no way leads from its {word} to {what} for a body of radius {router.radius:g} m"
    for journey in checked.journeys:
        for k, (here, there) in enumerate(itertools.pairwise(journey.stops), 2):
            begin, end = _Place.of(here), _Place.of(there)
            if begin and end and not _leads(router, begin, end):
                yield there, f"no way leads to stop {k} from the one before for a body of radius {router.radius:g} m"


def _leads(router: Router, begin: _Place, end: _Place) -> bool:
    begins, ends = _any(router, begin.points), _any(router, end.points)
    every, last = (all if begin.anywhere else any), (all if end.anywhere else any)
    return every(last(_reached(router, here, there) for there in ends) for here in begins)


def _reached(router: Router, here: Floats, there: Floats) -> bool:
    try:
        router.towards(here, there)
    except InputError:
        return False
    return True


def _any(router: Router, points: Points) -> Sequence[Floats]:
    """Return a few points of a zone, where a body has room if there are any; the point itself of a single one."""
    if len(points) == 1:
        return [np.array(points[0])]
    return _spots(router, points) or [*itertools.islice(_points(points), SPOTS)]


def _spots(router: Router, points: Points) -> Sequence[Floats]:
    """Return a few points of a zone at which a body has room."""
    return [*itertools.islice((point for point in _points(points) if router.holds(point[None])[0]), SPOTS)]


def _points(zone: Points) -> Iterator[Floats]:
    batches = itertools.islice(points_in(zone, stream(0, "check", "spot")), BATCHES)
    return (point for batch in batches for point in batch)
