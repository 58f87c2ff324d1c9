"""Trials from scenarios of pedsim_ros: obstacles, waypoints and agents in one XML file.

The format is that of https://github.com/srl-freiburg/pedsim_ros. Agents walk round their waypoints again and again.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from crowdbot.core import Element, TrialError
from crowdbot.models import SocialForce
from crowdbot.trials.agent import Agent
from crowdbot.trials.crowd import Routing
from crowdbot.trials.journey import Journey, Point
from crowdbot.trials.notation import Points
from crowdbot.trials.people import Spawner
from crowdbot.trials.robot import RobotGoal, RobotSpec
from crowdbot.trials.stage import Stage, Wall
from crowdbot.trials.trial import End, Trial
from crowdbot.trials.xml.trial_text import parse_trial_xml, read_trial_bytes

from .original import ImportedTrial
from .umans import number_of

__all__ = ["import_pedsim"]

ROBOT = 2
"""Type of agents that are robots."""
DURATION = 120.0
NARROWEST = 0.1
"""Smallest side of a zone where people begin [m]."""


def import_pedsim(path: str | Path) -> ImportedTrial:
    """Read a scenario of pedsim_ros (root element ``scenario``).

    Raises:
        TrialError: the file is missing or malformed, or there are no agents.
    """
    path = Path(path)
    root = parse_trial_xml(read_trial_bytes(path), str(path))
    if root.tag != "scenario":
        raise TrialError(f"{path}:{root.line}: the root element is <{root.tag[:40]}>, pedsim has scenario")
    reader = _Reader(path, {one.attributes.get("id", ""): one for one in root.children if one.tag == "waypoint"})
    return ImportedTrial(((path.stem, reader.trial(root)),), tuple(reader.notes))


@dataclass
class _Reader:
    """Converts a scenario, and notes what is not imported."""

    path: Path
    waypoints: dict[str, Element]
    notes: dict[str, None] = field(default_factory=dict)
    journeys: dict[tuple[Point, ...], Journey] = field(default_factory=dict)

    def trial(self, root: Element) -> Trial:
        """Return the trial."""
        walls: list[Wall] = []
        people: list[Agent | Spawner] = []
        robots: list[RobotSpec] = []
        for one in root.children:
            if one.tag == "obstacle":
                ends = [(number_of(one, f"x{k}"), number_of(one, f"y{k}")) for k in (1, 2)]
                if ends[0] != ends[1]:
                    walls.append(Wall(Points.of(ends)))
            elif one.tag == "agent" and int(number_of(one, "type", 0.0)) == ROBOT:
                robots.append(self._robot(one, len(robots)))
            elif one.tag == "agent":
                people.append(self._people(one, len(people)))
            elif one.tag != "waypoint":
                self.notes[f"<{one.tag[:40]}> is not imported"] = None
        if not people:
            raise TrialError(f"{self.path}: there are no agents that are people")
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
            agents=tuple(one for one in people if isinstance(one, Agent)),
            spawners=tuple(one for one in people if isinstance(one, Spawner)),
            robots=tuple(robots),
            end=End(goal=bool(robots), collision=False),
        )

    def _stops(self, agent: Element) -> tuple[Point, ...]:
        stops = []
        for one in agent.children:
            if one.tag != "addwaypoint":
                self.notes[f"<{one.tag[:40]}> of agents is not imported"] = None
                continue
            id = one.attributes.get("id", "")
            if id not in self.waypoints:
                raise TrialError(f"{self.path}:{one.line}: there is no waypoint {id[:40]!r}")
            spot = self.waypoints[id]
            reach = min(1e3, max(0.3, number_of(spot, "r", 0.3)))
            stops.append(Point(number_of(spot, "x"), number_of(spot, "y"), reach))
        return tuple(stops)

    def _people(self, agent: Element, k: int) -> Agent | Spawner:
        stops = self._stops(agent)
        journey = ""
        if stops:
            way = self.journeys.setdefault(
                stops, Journey(name=f"way{len(self.journeys) + 1}", then="again", stops=stops)
            )
            journey = way.name
        x, y, count = number_of(agent, "x"), number_of(agent, "y"), int(number_of(agent, "n", 1.0))
        dx, dy = number_of(agent, "dx", 0.0), number_of(agent, "dy", 0.0)
        if count < 1 or dx < 0.0 or dy < 0.0:
            raise TrialError(f"{self.path}:{agent.line}: n must be at least 1, dx and dy at least 0")
        if count == 1 and dx == dy == 0.0:
            return Agent(name=f"agent{k + 1}", x=x, y=y, journey=journey)
        wide, deep = 0.5 * max(dx, NARROWEST), 0.5 * max(dy, NARROWEST)
        zone = [(x - wide, y - deep), (x + wide, y - deep), (x + wide, y + deep), (x - wide, y + deep)]
        return Spawner(name=f"agents{k + 1}", count=count, zone=Points.of(zone), journey=journey, stands=not journey)

    def _robot(self, agent: Element, k: int) -> RobotSpec:
        from crowdbot.navigation import ORCANavigator
        from crowdbot.world import DifferentialDrive

        x, y, stops = number_of(agent, "x"), number_of(agent, "y"), self._stops(agent)
        goal = RobotGoal(stops[-1].x, stops[-1].y, 0.5) if stops else RobotGoal(x + 10.0, y, 0.5)
        self.notes["robots are discs with a differential drive and ORCA, their goal is their last waypoint"] = None
        return RobotSpec(
            name=f"robot{k + 1}" if k else "robot", x=x, y=y, heading=0.0, goal=goal, drive=DifferentialDrive(),
            navigator=ORCANavigator(),
        )  # fmt: skip
