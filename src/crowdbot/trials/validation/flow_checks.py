"""Checks of flows of people: unknown names, unreachable goals, zones without room."""

from __future__ import annotations

import functools
import itertools
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple, TypeVar

import numpy as np

from crowdbot.core import InputError, UnreadableValue, did_you_mean, stream, unread_fields
from crowdbot.core.fields import Points, quote_value
from crowdbot.trials.agent import Agent, AgentParameter
from crowdbot.trials.crowd import Crowd, Crowds
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.trials.placement.spawn_placement import points_in
from crowdbot.trials.randomized_model import RandomizedModel
from crowdbot.trials.stage import Stage, area
from crowdbot.trials.trial import Trial
from crowdbot.typing import Floats
from crowdbot.world import Direction, Exit, Point, Portal, Router, Zone

Problems = Iterator[tuple[Any, str]]
"""Elements with a problem, each with the end of a sentence about it."""
T = TypeVar("T")


def skip_unreadable(*checks: Iterator[T]) -> Iterator[T]:
    """Yield the results of several checks; a check ends where it needs code of the user that must not run."""
    for check in checks:
        try:
            yield from check
        except UnreadableValue:
            continue


@dataclass(frozen=True)
class ValidationContext:
    """A trial, and the seed with which its people are placed (default: that of the trial)."""

    trial: Trial
    given_seed: int | None = None

    @property
    def seed(self) -> int:
        """Random seed."""
        return self.trial.seed if self.given_seed is None else self.given_seed

    @property
    def people(self) -> tuple[Agent | Spawner | SourceSpec, ...]:
        """Agents, spawners and sources."""
        return (*self.trial.agents, *self.trial.spawners, *self.trial.sources)

    @functools.cached_property
    def crowds(self) -> tuple[Crowd, ...]:
        """Crowds of the trial."""
        return Crowds.spread(self.trial.crowd)

    @property
    def router(self) -> Router | None:
        """The router of the stage, None without routing or if it is impossible."""
        return None if isinstance(self._routing, str) else self._routing

    @property
    def no_routing(self) -> str:
        """Why routing on this stage is impossible, empty if it is possible."""
        return self._routing if isinstance(self._routing, str) else ""

    @functools.cached_property
    def _routing(self) -> Router | str | None:
        if self.trial.routing is None:
            return None
        try:
            return self.trial.routing.router(self.trial.stage.walking_walls())
        except InputError as error:
            return str(error).removeprefix("Router: ")


BATCHES = 30
"""Number of batches of points in which a place with room for a body is searched."""
SPOTS = 6
"""Number of points that represent a zone."""
OVERLAP = 1e-9
"""Largest overlap [m2] of zones that only touch."""


def arrival_count(trial: Trial) -> int:
    """Return the approximate number of people who enter."""
    return round(sum(source.arrival_count(trial.duration) for source in trial.sources))


def names(checked: ValidationContext) -> Iterator[Problems]:
    """Yield checks of duplicate and unknown names, and of people with no goal or two."""
    trial = checked.trial
    yield duplicate_names(trial.journeys, "journey")
    yield from (_endless_stops(journey.stops) for journey in trial.journeys)
    yield _more_than_fit(trial)
    journeys, crowds = ([item.name for item in ones if item.name] for ones in (trial.journeys, checked.crowds))
    for person in checked.people:
        yield _goals(person)
        yield _arrival(person)
        yield _unknown_name(person, "journey", journeys)
        yield _unknown_name(person, "crowd", crowds)
        if isinstance(person, SourceSpec):
            yield _arrival_times(person)
        if isinstance(person, Agent):
            yield from (_parameter(checked, person, parameter) for parameter in person.parameters)
    yield from (_unknown_name(item, "crowd", crowds) for item in trial.recorded)


def duplicate_names(things: Sequence[Any], others: str) -> Problems:
    """Yield every element with the name of an earlier one."""
    known: set[str] = set()
    for thing in things:
        if thing.name in known:
            yield thing, f"name {thing.name!r} is already used by another {others}; names must differ"
        known.add(thing.name)


def flows(checked: ValidationContext) -> Iterator[Problems]:
    """Yield checks of zones without room and of unreachable stops."""
    trial = checked.trial
    if why := checked.no_routing:
        yield iter([(trial.routing, f"is impossible on this stage: {why}")])
        return
    yield from (_entrance(trial.stage, source) for source in trial.sources)
    yield from (_stop(checked, stop) for journey in trial.journeys for stop in journey.stops)
    coming: tuple[Spawner | SourceSpec, ...] = (*trial.spawners, *trial.sources)
    yield from (_exit_overlap(item, k, way) for item in coming for k, way in enumerate(trial.exits, 1))
    yield from (_portal_loop(*pair) for pair in itertools.combinations(trial.portals, 2))
    yield from (_first_leg(checked, person) for person in checked.people)
    for journey in trial.journeys:
        yield from (_leg(checked, k, *pair) for k, pair in enumerate(itertools.pairwise(journey.stops), 2))


def _portal_loop(first: Portal, second: Portal) -> Problems:
    """Yield a portal into a second one that leads back into the first: people would jump between them in every step."""
    import shapely.affinity

    there = shapely.affinity.translate(area(first.zone), first.dx, first.dy).intersection(area(second.zone))
    back = shapely.affinity.translate(there, second.dx, second.dy).intersection(area(first.zone))
    if back.area > OVERLAP:
        name = f" {second.name!r}" if second.name else ""
        yield first, f"leads into the portal{name} that leads back into it; move its exit out of that zone"


def _unknown_name(one: Any, word: str, names: Sequence[str]) -> Problems:
    """Yield an element that refers to an unknown name."""
    if (name := getattr(one, word)) and name not in names:
        there = f"there are {', '.join(names)}" if names else f"no {word} has a name"
        yield one, f"{word}={quote_value(name)} is not the name of a {word}{did_you_mean(name, names)}; {there}"


def _goals(one: Any) -> Problems:
    stands = isinstance(one, Agent) or getattr(one, "stands", False)
    if one.goal and one.journey:
        yield one, 'has both a goal and a journey; give one of them: goal="x,y x,y x,y" or journey="name"'
    elif stands and isinstance(one, Spawner) and (one.goal or one.journey):
        yield one, 'has stands="true" and a goal or a journey; leave out one of them'
    elif not (one.goal or one.journey or stands):
        yield one, 'needs a goal zone or a journey: goal="x,y x,y x,y" or journey="name"'


def _arrival(one: Agent | Spawner | SourceSpec) -> Problems:
    if one.journey and one.arrival != "leave" and not one.goal and not getattr(one, "stands", False):
        yield one, f'arrival="{one.arrival}" needs a goal zone; for a journey write then="{one.arrival}" in it'


def _arrival_times(source: SourceSpec) -> Problems:
    if source.begin >= source.end:
        yield source, f"begin {source.begin:g} s must be before end {source.end:g} s"


def _more_than_fit(trial: Trial) -> Problems:
    if trial.capacity is None:
        return
    first = len(trial.agents) + sum(spawner.count for spawner in trial.spawners)
    if first > trial.capacity:
        last = (*trial.agents, *trial.spawners)[-1]
        yield last, f"makes {first} people at the beginning, more than the capacity {trial.capacity}"


def _parameter(checked: ValidationContext, agent: Agent, parameter: AgentParameter) -> Problems:
    """Yield a parameter that the model of a person does not have or allow."""
    crowds = [crowd for crowd in checked.crowds if crowd.name == agent.crowd or not agent.crowd]
    if not crowds:
        return
    given = crowds[0].model
    model = given.model if isinstance(given, RandomizedModel) else given
    if unread_fields(type(model)):  # defaults that are known only when code runs
        return
    draws = {parameter.name.replace("-", "_"): Distribution.of(parameter.value)}
    for sentence in RandomizedModel.problems(model, draws):
        yield parameter, sentence.replace("drawn", "given", 1)


def _endless_stops(stops: Sequence[Any]) -> Problems:
    for k, stop in enumerate(stops[:-1]):
        if isinstance(stop, Direction):
            yield stop, f"is stop {k + 1} of {len(stops)} and has no end; a direction must be the last stop"


def _entrance(stage: Stage, source: SourceSpec) -> Problems:
    for label, points in (("zone", source.zone), ("goal zone", source.goal)):
        if points and (block := stage.block_in(area(points), OVERLAP)):
            yield source, f"{label} reaches into {block}; move it, or cut it there"
            return
    radius = source.radius.extent[1]
    batches = itertools.islice(points_in(source.zone, stream(0, "check", "source")), BATCHES)
    if not any(np.any(stage.clearance(points) >= radius) for points in batches):
        yield (
            source,
            f"zone of {area(source.zone).area:.2f} m2 leaves no room for a body of radius {radius:g} m beside walls;"
            " move it, or make it larger",
        )


def inaccessible_stops(trial: Trial) -> Problems:
    """Yield the stops of journeys at inaccessible points."""
    import shapely

    for stop in (stop for journey in trial.journeys for stop in journey.stops if isinstance(stop, Point)):
        point = shapely.Point(stop.x, stop.y)
        if not trial.stage.holds(point):
            yield stop, f"at {stop.x:g},{stop.y:g} lies outside the walkable area"
        elif block := trial.stage.block_around(point):
            yield stop, f"at {stop.x:g},{stop.y:g} lies inside {block}"


def _stop(checked: ValidationContext, stop: Point | Direction | Zone) -> Problems:
    stage = checked.trial.stage
    if isinstance(stop, Zone):
        if stop.aim == "nearest" or checked.router is None:
            if block := stage.block_in(area(stop.points), OVERLAP):
                yield stop, f"zone reaches into {block}; move it, or cut it there"
        elif not len(_spots(checked.router, stop.points)):
            radius = checked.router.radius
            yield stop, f"zone leaves no room for a body of radius {radius:g} m, which routing requires"


def _exit_overlap(one: Spawner | SourceSpec, number: int, way: Exit) -> Problems:
    """Yield spawners and sources in an exit."""
    if area(one.zone).intersection(area(way.zone)).area > OVERLAP:
        called = repr(way.name) if way.name else str(number)
        yield one, f"zone overlaps exit {called}, where people would leave at once; move one of them"


class _Place(NamedTuple):
    """Begin or end of a path: any point of it (``anywhere``), or the best one."""

    points: Points
    anywhere: bool = True

    @classmethod
    def of(cls, stop: Point | Direction | Zone) -> _Place | None:
        """Return the place of a stop; None for a direction."""
        if isinstance(stop, Point):
            return cls(Points.of([(stop.x, stop.y)]))
        return cls(stop.points, stop.aim == "random") if isinstance(stop, Zone) else None


def _first_leg(checked: ValidationContext, one: Any) -> Problems:
    """Yield people without a path to their goal or to the first stop of their journey."""
    router = checked.router
    if router is None or router.unreachable != "error" or not (one.goal or one.journey):
        return
    journey = next((journey for journey in checked.trial.journeys if journey.name == one.journey), None)
    first = _Place(one.goal) if one.goal else journey and _Place.of(journey.stops[0])
    what = (
        ("the goal" if isinstance(one, Agent) else "the goal zone")
        if one.goal
        else f"the first stop of journey {one.journey!r}"
    )
    start, word = (one.zone, "zone") if not isinstance(one, Agent) else (Points.of([one.position]), "place")
    if first and not _is_path(router, _Place(start), first):
        yield one, f"there is no path from its {word} to {what} for a body of radius {router.radius:g} m"


def _leg(checked: ValidationContext, number: int, here: Any, there: Any) -> Problems:
    """Yield a stop without a path from the previous one."""
    router = checked.router
    if router is None or router.unreachable != "error":
        return
    begin, end = _Place.of(here), _Place.of(there)
    if begin and end and not _is_path(router, begin, end):
        yield there, f"there is no path to stop {number} from the one before for a body of radius {router.radius:g} m"


def _is_path(router: Router, begin: _Place, end: _Place) -> bool:
    begins, ends = _sample_points(router, begin.points), _sample_points(router, end.points)
    every, last = (all if begin.anywhere else any), (all if end.anywhere else any)
    return every(last(_is_reachable(router, here, there) for there in ends) for here in begins)


def _is_reachable(router: Router, here: Floats, there: Floats) -> bool:
    try:
        router.towards(here, there)
    except InputError:
        return False
    return True


def _sample_points(router: Router, points: Points) -> Sequence[Floats]:
    """Return a few points of a zone, with room for a body if possible; a single point is returned as it is."""
    if len(points) == 1:
        return [np.array(points[0])]
    return _spots(router, points) or [*itertools.islice(_points(points), SPOTS)]


def _spots(router: Router, points: Points) -> Sequence[Floats]:
    """Return a few points of a zone with room for a body."""
    return [*itertools.islice((point for point in _points(points) if router.holds(point[None])[0]), SPOTS)]


def _points(zone: Points) -> Iterator[Floats]:
    batches = itertools.islice(points_in(zone, stream(0, "check", "spot")), BATCHES)
    return (point for batch in batches for point in batch)
