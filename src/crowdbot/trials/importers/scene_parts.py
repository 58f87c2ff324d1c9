"""Parts of an imported scene: solids, people and robots of a file of another simulator, with notes on what it lacks."""

from __future__ import annotations

import contextlib
import math
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from crowdbot.core import InputError, TrialError, parse_number
from crowdbot.core.fields import Points
from crowdbot.models import CrowdModel, SocialForce
from crowdbot.trials.agent import Agent
from crowdbot.trials.crowd import Routing
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.trials.robot import RobotGoal, RobotSpec
from crowdbot.trials.stage import Obstacle, Stage, Wall
from crowdbot.trials.trial import End, Trial
from crowdbot.world import Point, Zone

from .original import ImportedTrial

if TYPE_CHECKING:
    from crowdbot.world import Drive


Spot = tuple[float, float]
FARTHEST = 1e6
"""Largest coordinate [m]."""
MOST_PEOPLE, MOST_ROBOTS, MOST_SOLIDS, MOST_CORNERS, MOST_STOPS = 5000, 100, 5000, 100_000, 1000
CIRCLE = 24
"""Corners of a circle."""
SPEEDS, RADII = (0.05, 10.0), (0.05, 5.0)
LIKELY_SPEED, LIKELY_RADIUS = 4.0, 1.0
"""Speed [m/s] and radius [m] above which a person is probably something else."""
DURATION = 120.0
REACH = 0.3


def number_in(values: Mapping[Any, Any], key: Any, where: str, otherwise: float | None = None) -> float:
    """A finite number of a mapping, up to a million.

    Raises:
        TrialError: it is missing without ``otherwise``, or not such a number.
    """
    return as_number(values.get(key, otherwise), f"{where}: {key}")


def as_number(value: Any, where: str) -> float:
    """A value as a finite number up to a million.

    Raises:
        TrialError: it is none.
    """
    if isinstance(value, str):
        with contextlib.suppress(InputError):  # the message below has the text
            value = parse_number(value.strip())
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= FARTHEST:
        raise TrialError(f"{where} must be a number up to 1e6, not {str(value)[:40]!r}")
    return float(value)


def move(points: Sequence[Spot], x: float, y: float, turn: float) -> list[Spot]:
    """Points turned about the origin [rad], then shifted.

    >>> move([(1.0, 0.0)], 2.0, 3.0, 0.0)
    [(3.0, 3.0)]
    """
    cos, sin = math.cos(turn), math.sin(turn)
    return [(round(x + cos * u - sin * v, 6), round(y + sin * u + cos * v, 6)) for u, v in points]


def box(x: float, y: float, length: float, width: float, turn: float = 0.0) -> list[Spot]:
    """Corners of a box about its centre, ``length`` along its own x.

    >>> box(1.0, 0.0, 4.0, 2.0)
    [(-1.0, -1.0), (3.0, -1.0), (3.0, 1.0), (-1.0, 1.0)]
    """
    u, v = 0.5 * length, 0.5 * width
    return move([(-u, -v), (u, -v), (u, v), (-u, v)], x, y, turn)


def circle(x: float, y: float, radius: float) -> list[Spot]:
    """Corners of a circle."""
    turns = [2.0 * math.pi * k / CIRCLE for k in range(CIRCLE)]
    return [(round(x + radius * math.cos(turn), 6), round(y + radius * math.sin(turn), 6)) for turn in turns]


@dataclass
class ImportedScene:
    """Collects the parts of a scene. Each part that is left out or that looks wrong gets a note.

    Fields:
        path: file of the scene, for messages.
        simulator: name of the simulator.
        goal_radius: distance [m] at which people have reached a goal.
    """

    path: Path
    simulator: str
    goal_radius: float = REACH
    notes: dict[str, None] = field(default_factory=dict)
    walls: list[Wall] = field(default_factory=list)
    obstacles: list[Obstacle] = field(default_factory=list)
    people: list[Agent] = field(default_factory=list)
    spawners: list[Spawner] = field(default_factory=list)
    sources: list[SourceSpec] = field(default_factory=list)
    robots: list[RobotSpec] = field(default_factory=list)
    journeys: dict[tuple[Any, str], Journey] = field(default_factory=dict)
    corners: int = 0
    beyond: int = 0
    """Robots beyond the largest number of a trial."""

    def note(self, sentence: str) -> None:
        """Note what is not imported, or imported in another way; each sentence once."""
        self.notes[sentence] = None

    def error(self, sentence: str) -> TrialError:
        """An error with the name of the file."""
        return TrialError(f"{self.path}: {sentence}")

    @contextlib.contextmanager
    def named_errors(self) -> Iterator[None]:
        """Put the name of the file before the message of an error that lacks it."""
        try:
            yield
        except TrialError as error:
            if str(error).startswith(str(self.path)):
                raise
            raise self.error(str(error)) from None

    def wall(self, points: Sequence[Spot], name: str) -> None:
        """Add a thin wall; one without length is left out."""
        kept = [point for k, point in enumerate(points) if k == 0 or point != points[k - 1]]
        if len(kept) < 2:
            self.note(f"{name} has no length and is left out")
            return
        self._count(kept, name)
        self.walls.append(Wall(Points.of(kept)))

    def obstacle(self, points: Sequence[Spot], name: str) -> None:
        """Add a solid polygon; one without area is left out."""
        import shapely

        ring = shapely.Polygon(points) if len(points) >= 3 else shapely.Polygon()
        if not ring.is_valid:
            self.note(f"{name} crosses itself: its outline is a thin wall")
            self.wall([*points, points[0]], name)
        elif ring.area < 1e-6:
            self.note(f"{name} has no area and is left out")
        else:
            self._count(points, name)
            self.obstacles.append(Obstacle(Points.of(points)))

    def journey(self, stops: Sequence[Point | Zone], then: str) -> str:
        """Name of the journey through stops, which is made at its first use; empty without stops."""
        if not stops:
            return ""
        if len(stops) > MOST_STOPS:
            raise self.error(f"a person has {len(stops)} goals, at most {MOST_STOPS} are read")
        made = Journey(name=f"way{len(self.journeys) + 1}", then=then, stops=tuple(stops))
        return self.journeys.setdefault((tuple(stops), then), made).name

    def points(self, spots: Sequence[Spot], reach: float | None = None) -> list[Point]:
        """Stops at points."""
        reach = min(1e3, max(0.05, self.goal_radius if reach is None else reach))
        return [Point(x, y, reach) for x, y in spots]

    def person(
        self,
        name: str,
        x: float,
        y: float,
        stops: Sequence[Point | Zone] = (),
        *,
        then: str = "stay",
        heading: float | None = None,
        speed: float | None = None,
        radius: float | None = None,
    ) -> None:
        """Add a person; a speed or a radius that no person has is noted."""
        if len(self.people) >= MOST_PEOPLE:
            raise self.error(f"more than {MOST_PEOPLE} people are too many")
        values: dict[str, Any] = {}
        if speed is not None:
            values["speed"] = self._limited(name, "speed", speed, "m/s", SPEEDS, LIKELY_SPEED)
        if radius is not None:
            values["radius"] = self._limited(name, "radius", radius, "m", RADII, LIKELY_RADIUS)
        if heading is not None:
            values["heading"] = math.remainder(heading, 2.0 * math.pi)
        journey = self.journey(stops, then)
        self.people.append(Agent(name=name[:40], x=x, y=y, journey=journey, **values))

    def robot(
        self,
        x: float,
        y: float,
        goal: Spot | None,
        *,
        heading: float = 0.0,
        radius: float = 0.3,
        speed: float = 1.0,
        drive: Drive | None = None,
    ) -> None:
        """Add a robot with ORCA; without a goal it has one 1 m ahead. Robots beyond the hundredth are people."""
        from crowdbot.navigation import ORCANavigator
        from crowdbot.world import DifferentialDrive

        if len(self.robots) >= MOST_ROBOTS:
            self.beyond += 1
            stops = [] if goal is None else self.points([goal])
            self.person(f"robot{MOST_ROBOTS + self.beyond}", x, y, stops, heading=heading, speed=speed, radius=radius)
            return
        self.note("robots are discs with the navigator ORCA: give the type and the navigator of yours")
        name = f"robot{len(self.robots) + 1}" if self.robots else "robot"
        speed = min(SPEEDS[1], max(SPEEDS[0], speed))
        if goal is None:
            self.note(f"{name} has no goal in the file: its goal is 1 m ahead")
            goal = move([(1.0, 0.0)], x, y, heading)[0]
        self.robots.append(
            RobotSpec(
                name=name,
                x=x,
                y=y,
                heading=math.remainder(heading, 2.0 * math.pi),
                radius=min(RADII[1], max(RADII[0], radius)),
                goal=RobotGoal(goal[0], goal[1], max(0.1, self.goal_radius)),
                drive=drive or DifferentialDrive(max_speed=speed),
                navigator=ORCANavigator(speed=speed),
            )
        )

    def trial(
        self,
        *,
        duration: float | None = None,
        step: float = 0.05,
        crowd: CrowdModel | None = None,
        map: str = "",
        area: str = "",
        folder: Path | None = None,
    ) -> ImportedTrial:
        """The trial of the scene with its notes.

        Args:
            duration: longest time [s]; 120 s with a note if None.
            step: time step [s].
            crowd: crowd model (default: social force).
            map: ROS map in the folder.
            area: walkable area as WKT.
            folder: folder of the map (default: that of the file).

        Raises:
            TrialError: nothing is left of the file.
        """
        people = bool(self.people or self.spawners or self.sources)
        if not (self.walls or self.obstacles or people or self.robots or map or area):
            why = "".join(f"; {sentence}" for sentence in list(self.notes)[:3])
            raise self.error(f"there are no solids, people or robots that can be imported{why}")
        if duration is None:
            self.note(f"no end by time is in the file: the trial ends after {DURATION:g} s")
        if self.beyond:
            self.note(
                f"a trial has at most {MOST_ROBOTS} robots: the other {self.beyond} are people of the crowd model, of"
                " the same size and speed"
            )
        if not people:
            self.note("people are not in the file: add them")
        if not self.robots:
            self.note("robots are not in the file: people react to the robots that you add")
        folder = folder or self.path.resolve().parent
        solid = bool(self.walls or self.obstacles or map or area)
        walls, obstacles = tuple(self.walls), tuple(self.obstacles)
        try:
            stage = Stage(walls=walls, obstacles=obstacles, map=map, area=area, folder=folder, trust=False)
        except InputError as error:
            raise self.error(str(error)) from None
        trial = Trial(
            name=(self.path.stem.strip() or "imported")[:80],
            about=f"Imported from {self.simulator}.",
            duration=DURATION if duration is None else min(86_400.0, max(step, duration)),
            step=step,
            stage=stage,
            routing=Routing(unreachable="nearest") if solid and self.journeys else None,
            crowd=crowd or SocialForce(),
            journeys=tuple(self.journeys.values()),
            agents=tuple(self.people),
            spawners=tuple(self.spawners),
            sources=tuple(self.sources),
            robots=tuple(self.robots),
            end=End(goal=bool(self.robots), collision=False),
            folder=folder if map else None,
        )
        return ImportedTrial(((self.path.stem, trial),), tuple(self.notes))

    def _limited(
        self, name: str, what: str, value: float, unit: str, limits: tuple[float, float], likely: float
    ) -> float:
        if value > likely:
            self.note(f"{name[:40]} has a {what} of {value:g} {unit}, which is unlikely for a person")
        if not limits[0] <= value <= limits[1]:
            kept = min(limits[1], max(limits[0], value))
            self.note(f"{name[:40]}: the {what} of {value:g} {unit} becomes {kept:g} {unit}")
            return kept
        return value

    def _count(self, points: Sequence[Spot], name: str) -> None:
        for x, y in points:
            if not max(abs(x), abs(y)) <= FARTHEST:
                raise self.error(f"{name[:40]} is more than {FARTHEST:g} m from the origin")
        self.corners += len(points)
        if self.corners > MOST_CORNERS or len(self.walls) + len(self.obstacles) >= MOST_SOLIDS:
            raise self.error(f"more than {MOST_SOLIDS} solids or {MOST_CORNERS} corners are too many")
