"""Trials from scenarios of UMANS: agents, obstacles and policies in one XML file or in several.

UMANS: van Toll et al. 2020, Generalized microscopic crowd simulation using costs in velocity space,
doi 10.1145/3384382.3384532. Without a value in the file, the radius is 0.24 m and the preferred speed 1.3 m/s.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from pathlib import Path

from crowdbot import models
from crowdbot.core import Element, InputError, TrialError, parse_number
from crowdbot.core.fields import Points
from crowdbot.models import CrowdModel
from crowdbot.trials.agent import Agent
from crowdbot.trials.crowd import Crowds
from crowdbot.trials.stage import Obstacle, Stage
from crowdbot.trials.trial import End, Trial

from .foreign_text import xml_of
from .original import ImportedTrial

RADIUS, SPEED = 0.24, 1.3
LARGEST = 1e6
COSTS: dict[str, type[CrowdModel]] = {
    "ORCA": models.ORCA,
    "PowerLaw": models.PowerLaw,
    "SocialForcesAvoidance": models.SocialForce,
    "TtcaDca": models.VBM,
    "PLEdestrians": models.PLEdestrians,
    "Moussaid": models.Heuristics,
}
"""Crowd models of cost functions; their parameters are not imported."""
GOAL_COSTS = ("GoalReachingForce", "GoalReaching")


def import_umans(path: str | Path) -> ImportedTrial:
    """Read a scenario of UMANS (root element ``Simulation``); files that it names are relative to its folder.

    Raises:
        TrialError: a file is missing or malformed, or there are no agents.
    """
    path = Path(path)
    root = _read(path, "Simulation")
    reader = _Reader(path)
    return ImportedTrial(((path.stem, reader.trial(root)),), tuple(reader.notes))


def number_of(element: Element, key: str, otherwise: float | None = None) -> float:
    """Return the number of an attribute.

    Raises:
        TrialError: it is missing without ``otherwise``, not a number, or beyond a million.
    """
    text = element.attributes.get(key)
    if text is None:
        if otherwise is None:
            raise TrialError(f"line {element.line}: <{element.tag[:40]}> lacks {key}")
        return otherwise
    try:
        value = parse_number(text)
    except InputError as error:
        raise TrialError(f"line {element.line}: <{element.tag[:40]}> {key}={text[:40]!r} {error}") from None
    if abs(value) > LARGEST:
        raise TrialError(f"line {element.line}: <{element.tag[:40]}> {key}={text[:40]!r} is more than 1e6")
    return value


def _read(path: Path, tag: str) -> Element:
    root = xml_of(path)
    if root.tag != tag:
        raise TrialError(f"{path}:{root.line}: the root element is <{root.tag[:40]}>, this file of UMANS has {tag}")
    return root


@dataclass
class _Reader:
    """Converts a scenario, and notes what is not imported."""

    path: Path
    notes: dict[str, None] = field(default_factory=dict)

    def trial(self, root: Element) -> Trial:
        """Return the trial."""
        for child in root.children:
            if child.tag not in ("World", "Agents", "Policies", "Obstacles"):
                self.notes[f"<{child.tag[:40]}> is not imported"] = None
        world = next((child for child in root.children if child.tag == "World"), Element("World"))
        if world.attributes.get("type", "Infinite") != "Infinite":
            self.notes["the world is infinite here, not a torus"] = None
        names, crowd = self._crowds(self._block(root, "Policies"))
        agents = self._agents(self._block(root, "Agents"), names, isinstance(crowd, Crowds))
        solids = [*self._block(root, "Obstacles"), *self._block(world, "Obstacles")]
        rings = [_corners(solid) for solid in solids if solid.tag == "Obstacle"]
        step = min(1.0, max(0.001, number_of(root, "delta_time", 0.1)))
        return Trial(
            name=(self.path.stem.strip() or "imported")[:80],
            about="Imported from UMANS.",
            duration=min(86_400.0, max(step, number_of(root, "end_time", 100.0))),
            step=step,
            stage=Stage(obstacles=tuple(Obstacle(Points.of(ring)) for ring in rings)),
            crowd=crowd,
            agents=tuple(agents),
            end=End(goal=False, collision=False, empty=any(agent.arrival == "leave" for agent in agents)),
        )

    def _block(self, parent: Element, tag: str) -> list[Element]:
        """Return the children of a block, which may be in another file."""
        block = next((child for child in parent.children if child.tag == tag), None)
        if block is None:
            return []
        file = block.attributes.get("file")
        return (block if file is None else _read(self.path.parent / file, tag)).children

    def _crowds(self, policies: list[Element]) -> tuple[dict[str, str], CrowdModel]:
        """Return the crowd names of policies by id, and the crowd model of all of them."""
        found: dict[str, CrowdModel] = {}
        names = {}
        for policy in policies:
            costs = [child.attributes.get("name", "") for child in policy.children if child.tag == "costfunction"]
            known = [COSTS[cost] for cost in costs if cost in COSTS]
            for cost in costs:
                if cost not in COSTS and cost not in GOAL_COSTS:
                    self.notes[f"the cost function {cost[:40]} is not imported"] = None
            if not known:
                self.notes["a policy without a known cost function: ORCA replaces it"] = None
            model = (known or [models.ORCA])[0]
            name = model.__name__.lower()
            names[policy.attributes.get("id", "0")] = name
            found.setdefault(name, model())
        if found:
            self.notes["parameters of the policies: the models have their defaults"] = None
        if len(found) < 2:
            return names, next(iter(found.values()), models.ORCA())
        return names, Crowds(tuple(found.values()), names=tuple(found))

    def _agents(self, rows: list[Element], names: dict[str, str], several: bool) -> list[Agent]:
        agents = []
        for k, item in enumerate(row for row in rows if row.tag == "Agent"):
            inner = {child.tag: child for child in item.children}
            if "pos" not in inner:
                raise TrialError(f"line {item.line}: <Agent> lacks <pos>")
            goal = inner.get("goal")
            policy = inner["Policy"].attributes.get("id", "0") if "Policy" in inner else "0"
            leaves = item.attributes.get("remove_at_goal", "false").lower() in ("true", "1")
            if number_of(item, "start_time", 0.0) > 0.0:
                self.notes["start times: all agents are there from the beginning"] = None
            agents.append(
                Agent(
                    name=f"agent{k + 1}",
                    x=number_of(inner["pos"], "x"),
                    y=number_of(inner["pos"], "y"),
                    goal=Points() if goal is None else Points.of([(number_of(goal, "x"), number_of(goal, "y"))]),
                    speed=min(10.0, max(0.05, number_of(item, "pref_speed", SPEED))),
                    radius=min(5.0, max(0.05, number_of(item, "rad", RADIUS))),
                    arrival="leave" if leaves else "stay",
                    crowd=names.get(policy, "") if several else "",
                )
            )
        if not agents:
            raise TrialError(f"{self.path}: there are no agents")
        return agents


def _corners(obstacle: Element) -> list[tuple[float, float]]:
    points = [
        (number_of(child, "x"), number_of(child, "y")) for child in obstacle.children if child.tag.lower() == "point"
    ]
    if len(points) < 3:
        raise TrialError(f"line {obstacle.line}: <Obstacle> has {len(points)} points, it needs at least 3")
    return points
