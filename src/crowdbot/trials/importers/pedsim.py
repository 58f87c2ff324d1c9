"""Trials from scenarios of pedsim_ros: obstacles, waypoints, agents and sources in one XML file.

The format is that of https://github.com/srl-freiburg/pedsim_ros. Agents walk round their waypoints again and again, or
leave at a waypoint that is a sink.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from crowdbot.core import Element, TrialError
from crowdbot.core.fields import Points
from crowdbot.models import SocialForce
from crowdbot.trials.agent import Agent
from crowdbot.trials.crowd import Routing
from crowdbot.trials.journey import Journey
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.trials.robot import RobotGoal, RobotSpec
from crowdbot.trials.stage import Stage, Wall
from crowdbot.trials.trial import End, Trial
from crowdbot.world import Point

from .foreign_text import xml_of
from .original import ImportedTrial
from .umans import number_of

ROBOT = 2
"""Type of agents that are robots."""
SINK = 2
"""Behaviour ``b`` of waypoints where people leave."""
SPAWN_PERIOD = 5.0
"""Time between two clusters of a source [s]: default of the ROS parameter ``spawn_period``, not in files."""
DURATION = 120.0
STOPS = ("waypoint", "queue")
NARROWEST = 0.1
"""Smallest side of a zone where people begin [m]."""


def import_pedsim(path: str | Path) -> ImportedTrial:
    """Read a scenario of pedsim_ros (root element ``scenario``).

    Agents and sources with an unknown waypoint are left out, with a note.

    Raises:
        TrialError: the file is missing or malformed, or nobody is left.
    """
    path = Path(path)
    root = xml_of(path)
    if root.tag != "scenario":
        raise TrialError(f"{path}:{root.line}: the root element is <{root.tag[:40]}>, pedsim has scenario")
    reader = _Reader(path, {child.attributes.get("id", ""): child for child in root.children if child.tag in STOPS})
    return ImportedTrial(((path.stem, reader.trial(root)),), tuple(reader.notes))


class _UnknownStop(Exception):
    """A cluster goes to a waypoint or a queue that is not in the file."""


@dataclass
class _Reader:
    """Converts a scenario, and notes what is not imported."""

    path: Path
    waypoints: dict[str, Element]
    notes: dict[str, None] = field(default_factory=dict)
    journeys: dict[tuple[tuple[Point, ...], str], Journey] = field(default_factory=dict)
    left_out: list[str] = field(default_factory=list)

    def trial(self, root: Element) -> Trial:
        """Return the trial."""
        walls: list[Wall] = []
        people: list[Agent | Spawner] = []
        sources: list[SourceSpec] = []
        robots: list[RobotSpec] = []
        for child in root.children:
            if child.tag == "obstacle":
                ends = [(number_of(child, f"x{k}"), number_of(child, f"y{k}")) for k in (1, 2)]
                if ends[0] != ends[1]:
                    walls.append(Wall(Points.of(ends)))
            elif child.tag in ("agent", "source"):
                try:
                    if child.tag == "source":
                        sources += self._source(child, len(sources))
                    elif int(number_of(child, "type", 0.0)) == ROBOT:
                        robots.append(self._robot(child, len(robots)))
                    else:
                        people.append(self._people(child, len(people)))
                except _UnknownStop as lost:
                    self._leave_out(child, str(lost))
            elif child.tag not in STOPS:
                self.notes[f"<{child.tag[:40]}> is not imported"] = None
        if not people and not sources:
            why = "".join(f"; {row}" for row in self.left_out[:3])
            raise TrialError(f"{self.path}: there are no agents that are people, and no sources{why}")
        self.notes["no end by time is in the file: the trial ends after 120 s"] = None
        self.notes["speeds and radii are not in the file: those of crowdbot are used"] = None
        return Trial(
            name=(self.path.stem.strip() or "imported")[:80],
            about="Imported from pedsim_ros.",
            duration=DURATION,
            stage=Stage(walls=tuple(walls)),
            routing=Routing(unreachable="nearest") if walls else None,
            crowd=SocialForce(),
            journeys=tuple(self.journeys.values()),
            agents=tuple(person for person in people if isinstance(person, Agent)),
            spawners=tuple(person for person in people if isinstance(person, Spawner)),
            sources=tuple(sources),
            robots=tuple(robots),
            end=End(goal=bool(robots), collision=False),
        )

    def _leave_out(self, cluster: Element, why: str) -> None:
        row = f"<{cluster.tag}> in line {cluster.line} is left out: {why}"
        self.left_out.append(row)
        self.notes[row] = None

    def _stops(self, cluster: Element) -> tuple[tuple[Point, ...], bool]:
        """Return the stops of a cluster up to its first sink, and whether there is a sink."""
        stops = []
        for child in cluster.children:
            if child.tag not in ("addwaypoint", "addqueue"):
                self.notes[f"<{child.tag[:40]}> of {cluster.tag}s is not imported"] = None
                continue
            id = child.attributes.get("id", "")
            if id not in self.waypoints:
                raise _UnknownStop(f"there is no {child.tag.removeprefix('add')} {id[:40]!r}")
            spot = self.waypoints[id]
            if spot.tag == "queue":
                self.notes["queues are not imported: people walk to the place of a queue and do not wait there"] = None
            reach = min(1e3, max(0.3, number_of(spot, "r", 0.3)))
            stops.append(Point(number_of(spot, "x"), number_of(spot, "y"), reach))
            if int(number_of(spot, "b", 0.0)) == SINK:
                return tuple(stops), True
        return tuple(stops), False

    def _journey(self, cluster: Element) -> str:
        """Return the name of the journey of a cluster, which is made at its first use; empty without stops."""
        stops, sink = self._stops(cluster)
        if not stops:
            return ""
        then = "leave" if sink else "again"
        name = f"way{len(self.journeys) + 1}"
        return self.journeys.setdefault((stops, then), Journey(name=name, then=then, stops=stops)).name

    def _extent(self, cluster: Element) -> tuple[int, float, float, float, float]:
        """Return the number of people, the centre and the sides of a cluster."""
        x, y, count = number_of(cluster, "x"), number_of(cluster, "y"), int(number_of(cluster, "n", 1.0))
        dx, dy = number_of(cluster, "dx", 0.0), number_of(cluster, "dy", 0.0)
        if count < 1 or dx < 0.0 or dy < 0.0:
            raise TrialError(f"{self.path}:{cluster.line}: n must be at least 1, dx and dy at least 0")
        return count, x, y, dx, dy

    def _people(self, agent: Element, k: int) -> Agent | Spawner:
        count, x, y, dx, dy = self._extent(agent)
        journey = self._journey(agent)
        if count == 1 and dx == dy == 0.0:
            return Agent(name=f"agent{k + 1}", x=x, y=y, journey=journey)
        zone = _box(x, y, dx, dy)
        return Spawner(name=f"agents{k + 1}", count=count, zone=zone, journey=journey, stands=not journey)

    def _source(self, source: Element, k: int) -> list[SourceSpec]:
        """Return the source of people, or nothing if they have nowhere to go."""
        count, x, y, dx, dy = self._extent(source)
        journey = self._journey(source)
        if not journey:
            self._leave_out(source, "it has no waypoints, and people who enter need a goal")
            return []
        self.notes[
            f"the period of sources is not in the file: n people enter in {SPAWN_PERIOD:g} s, one after another"
        ] = None
        if int(number_of(source, "type", 0.0)) != 0:
            self.notes["types of people of sources are not imported"] = None
        if next(way for way in self.journeys.values() if way.name == journey).then == "again":
            self.notes["a source without a sink: its people never leave, and their number grows to the end"] = None
        rate = min(1e4, count / SPAWN_PERIOD)
        zone = _box(x, y, dx, dy)
        return [SourceSpec(name=f"source{k + 1}", zone=zone, journey=journey, rate=rate, timing="regular")]

    def _robot(self, agent: Element, k: int) -> RobotSpec:
        from crowdbot.navigation import ORCANavigator
        from crowdbot.world import DifferentialDrive

        x, y, (stops, _) = number_of(agent, "x"), number_of(agent, "y"), self._stops(agent)
        goal = RobotGoal(stops[-1].x, stops[-1].y, 0.5) if stops else RobotGoal(x + 10.0, y, 0.5)
        self.notes["robots are discs with a differential drive and ORCA, their goal is their last waypoint"] = None
        return RobotSpec(
            name=f"robot{k + 1}" if k else "robot", x=x, y=y, heading=0.0, goal=goal, drive=DifferentialDrive(),
            navigator=ORCANavigator(),
        )  # fmt: skip


def _box(x: float, y: float, dx: float, dy: float) -> Points:
    """Return the corners of the zone of a cluster."""
    wide, deep = 0.5 * max(dx, NARROWEST), 0.5 * max(dy, NARROWEST)
    return Points.of([(x - wide, y - deep), (x + wide, y - deep), (x + wide, y + deep), (x - wide, y + deep)])
