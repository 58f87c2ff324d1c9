"""Trials from projects of Menge: obstacle sets, agents and goals, in a project, a scene and a behaviour file (XML).

The format is that of https://github.com/MengeCrowdSim/Menge. A project (``Project``) names scene and behaviour; a scene
(``Experiment``) alone is read, too, with the behaviour beside it if both are named alike (``hallS.xml``,
``hallB.xml``).
"""

from __future__ import annotations

import math
from dataclasses import dataclass
from pathlib import Path

from crowdbot.core import Element, InputError
from crowdbot.core.fields import Points
from crowdbot.models import ORCA, CrowdModel, SocialForce
from crowdbot.trials.files.trial_files import resolve_file
from crowdbot.world import Point, Zone

from .foreign_text import xml_of
from .original import ImportedTrial
from .scene_parts import ImportedScene, as_number, box, move

Spot = tuple[float, float]
MODELS: dict[str, type[CrowdModel]] = {"orca": ORCA, "helbing": SocialForce}
READ = {"AgentProfile", "Common", "Elevation", "SpatialQuery", "Helbing", "Karamouzas", "Orca", "PedVO", "Zanlungo"}
"""Elements of a scene that are read, that act on no person, or that are parameters of models, which have a note."""
STRAIGHT = {"goal", "zero", "const"}
"""Velocity components that need no map: straight to the goal, none, or the same for all."""
MOST_AGENTS = 5000
MOST_STATES = 100
RADIUS, SPEED = 0.19, 1.04
"""Radius [m] and preferred speed [m/s] without a profile."""


@dataclass(frozen=True)
class AgentProfile:
    """Radius [m] and preferred speed [m/s] of a profile."""

    radius: float = RADIUS
    speed: float = SPEED


def import_menge(path: str | Path) -> ImportedTrial:
    """Read a project (``Project``) or a scene (``Experiment``) of Menge.

    States with a goal become the stops of a journey, in the order of the transitions of ``goal_reached``.

    Raises:
        TrialError: a file is missing or malformed, or nothing in it can be imported.
    """
    path = Path(path)
    root = xml_of(path)
    scene = ImportedScene(path, "Menge")
    with scene.named_errors():
        if root.tag == "Experiment":
            name = f"{path.stem[:-1]}B{path.suffix}" if path.stem.endswith("S") else ""
            states = _beside(scene, name) if name and (path.parent / name).is_file() else None
            return _Reader(scene, states, "").trial(root)
        if root.tag != "Project" or not root.attributes.get("scene"):
            raise scene.error("is not a project of Menge: it names no scene")
        agents = _beside(scene, root.attributes["scene"])
        name = root.attributes.get("behavior", "")
        states = _beside(scene, name) if name else None
        return _Reader(scene, states, root.attributes.get("model", "")).trial(agents)


def _beside(scene: ImportedScene, name: str) -> Element:
    """The root element of a file that a project names."""
    try:
        file = resolve_file(name[:200], scene.path.resolve().parent, trust=False)
    except InputError as error:
        raise scene.error(str(error)) from None
    return xml_of(file)


class _Reader:
    """Converts a project."""

    def __init__(self, scene: ImportedScene, states: Element | None, model: str) -> None:
        self.scene, self.model = scene, model
        self.states: dict[str, Element] = {}
        self.next: dict[str, str] = {}
        self.goals: dict[tuple[str, str], Element] = {}
        self.selectors: dict[str, Point | Zone | Element | None] = {}
        if states is None:
            scene.note("the behaviour is not beside the scene: people have no goals")
            return
        for part in states.children:
            if part.tag == "State":
                self.states[part.attributes.get("name", "")] = part
            elif part.tag == "GoalSet":
                for goal in part.each("Goal"):
                    self.goals[part.attributes.get("id", ""), goal.attributes.get("id", "")] = goal
            elif part.tag == "Transition":
                self._transition(part)
            else:
                scene.note(f"<{part.tag[:40]}> of the behaviour is not imported")

    def trial(self, root: Element) -> ImportedTrial:
        """The trial."""
        if root.tag != "Experiment":
            raise self.scene.error(f"the scene has the root element <{root.tag[:40]}>, it must be <Experiment>")
        profiles = self._profiles(root)
        step = 0.05
        for part in root.children:
            if part.tag == "ObstacleSet":
                self._obstacles(part)
            elif part.tag == "AgentGroup":
                self._group(part, profiles)
            elif part.tag == "Common" and "time_step" in part.attributes:
                step = min(1.0, max(0.001, self._number(part, "time_step")))
            elif part.tag == "Elevation" and part.attributes.get("type") != "flat":
                self.scene.note("the elevation is not imported: the ground is level")
            elif part.tag not in READ:
                self.scene.note(f"<{part.tag}> in line {part.line} is not imported")
        kind = MODELS.get(self.model, ORCA)
        if self.model not in MODELS:
            named = f"the model {self.model[:40]!r}" if self.model else "no model is in the scene"
            self.scene.note(f"{named}: ORCA with its defaults replaces it")
        else:
            self.scene.note("parameters of the models: the model has its defaults")
        return self.scene.trial(step=step, crowd=kind())

    def _number(self, part: Element, key: str, otherwise: float | None = None) -> float:
        text = part.attributes.get(key)
        if text is None and otherwise is not None:
            return otherwise
        where = f"line {part.line}: {key} of <{part.tag[:40]}>"
        return as_number(text if text is not None else "nothing", where)

    def _profiles(self, root: Element) -> dict[str, AgentProfile]:
        """Profiles by name; one that inherits has the values of the other unless it has its own."""
        profiles: dict[str, AgentProfile] = {}
        for part in root.each("AgentProfile"):
            base = profiles.get(part.attributes.get("inherits", ""), AgentProfile())
            radius, speed = base.radius, base.speed
            for common in part.each("Common"):
                radius = self._number(common, "r", radius)
                speed = self._number(common, "pref_speed", speed)
                for law in common.each("Property"):
                    name = law.attributes.get("name", "")
                    keys = [key for key in ("value", "mean") if key in law.attributes]
                    middle = self._number(law, keys[0]) if keys else None
                    if middle is None and {"min", "max"} <= set(law.attributes):
                        middle = 0.5 * (self._number(law, "min") + self._number(law, "max"))
                    if law.attributes.get("dist", "c") != "c":
                        self.scene.note(f"the distribution of {name[:30]} is not imported: all have its middle")
                    if middle is not None and name == "pref_speed":
                        speed = middle
                    elif middle is not None and name == "r":
                        radius = middle
            profiles[part.attributes.get("name", "")] = AgentProfile(radius, speed)
        return profiles

    def _obstacles(self, part: Element) -> None:
        if part.attributes.get("type", "explicit") != "explicit":
            kind = part.attributes.get("type", "")[:40]
            self.scene.note(f"the obstacle set of type {kind!r} in line {part.line} is not imported")
            return
        for k, obstacle in enumerate(part.each("Obstacle")):
            spots = [(self._number(item, "p_x"), self._number(item, "p_y")) for item in obstacle.each("Vertex")]
            name = f"obstacle {k + 1} in line {obstacle.line}"
            if obstacle.attributes.get("closed", "1").strip() in ("1", "true") and len(spots) > 2:
                self.scene.obstacle(spots, name)
            else:
                self.scene.wall(spots, name)

    def _group(self, part: Element, profiles: dict[str, AgentProfile]) -> None:
        """Add the agents of a group."""
        chosen = {}
        for tag in ("ProfileSelector", "StateSelector"):
            selector = next(iter(part.each(tag)), Element(tag))
            if selector.attributes.get("type", "const") != "const":
                self.scene.note(f"the <{tag}> in line {selector.line} is not constant: its first choice is taken")
            first = next(iter(selector.children), selector)
            chosen[tag] = selector.attributes.get("name") or first.attributes.get("name", "")
        for inner in part.children:
            if inner.tag not in ("ProfileSelector", "StateSelector", "Generator"):
                self.scene.note(f"<{inner.tag[:40]}> of the agents in line {part.line} is not imported")
        if chosen["ProfileSelector"] not in profiles:
            self.scene.note(f"there is no profile {chosen['ProfileSelector'][:40]!r}: its agents have the usual values")
        profile = profiles.get(chosen["ProfileSelector"], AgentProfile())
        for generator in part.each("Generator"):
            for x, y in self._places(generator):
                stops, then = self._way(chosen["StateSelector"], (x, y))
                name = f"agent{len(self.scene.people) + 1}"
                self.scene.person(name, x, y, stops, then=then, speed=profile.speed, radius=profile.radius)

    def _places(self, generator: Element) -> list[Spot]:
        """Places of the agents of a generator."""
        kind = generator.attributes.get("type", "explicit")
        if kind == "explicit":
            return [(self._number(item, "p_x"), self._number(item, "p_y")) for item in generator.each("Agent")]
        if kind != "rect_grid":
            self.scene.note(f"the generator of type {kind[:40]!r} in line {generator.line} is left out")
            return []
        if "displace_dist" in generator.attributes:
            self.scene.note("random displacements of agents on a grid are not imported")
        columns, rows = (int(self._number(generator, f"count_{axis}", 1.0)) for axis in "xy")
        if columns * rows > MOST_AGENTS or min(columns, rows) < 0:
            raise self.scene.error(f"line {generator.line}: {columns} x {rows} agents, at most {MOST_AGENTS} are read")
        dx, dy = (self._number(generator, f"offset_{axis}", 0.0) for axis in "xy")
        x, y, turn = (self._number(generator, key, 0.0) for key in ("anchor_x", "anchor_y", "rotation"))
        grid = [(column * dx, row * dy) for row in range(rows) for column in range(columns)]
        return move(grid, x, y, math.radians(turn))

    def _transition(self, part: Element) -> None:
        """Keep where people go after a goal; other conditions are named."""
        condition = next(iter(part.each("Condition")), None)
        kind = condition.attributes.get("type", "") if condition is not None else ""
        to = part.attributes.get("to", "")
        sources = part.attributes.get("from", "").split(",")
        if part.each("Target") or kind not in ("goal_reached", "auto") or not to:
            self.scene.note(f"the transition from {sources[0][:40]!r} in line {part.line} is not imported")
            return
        distance = self._number(condition, "distance", 0.0) if condition is not None else 0.0
        if distance > 0.0:
            self.scene.goal_radius = max(self.scene.goal_radius, min(5.0, distance))
        for name in sources:
            self.next.setdefault(name.strip(), to)

    def _way(self, state: str, start: Spot) -> tuple[list[Point | Zone], str]:
        """Stops of an agent that begins in a state, and what it does then."""
        stops: list[Point | Zone] = []
        seen: list[str] = []
        while state and state not in seen and len(seen) < MOST_STATES:
            seen.append(state)
            if state not in self.states:
                if self.states:
                    self.scene.note(f"there is no state {state[:40]!r}: people stay")
                return stops, "stay"
            stop = self._goal(self.states[state], start)
            stops += [stop] if stop is not None else []
            state = self.next.get(state, "")
        return stops, "again" if state and len(stops) > 1 else "stay"

    def _goal(self, state: Element, start: Spot) -> Point | Zone | None:
        """Goal of a state; None if people stay where they are."""
        name = state.attributes.get("name", "")
        if name not in self.selectors:
            self.selectors[name] = self._selector(state)
        selector = self.selectors[name]
        if isinstance(selector, Element):
            sides = [self._number(selector, f"mirror_{axis}", 1.0) > 0.0 for axis in "xy"]
            x, y = (-value if side else value for value, side in zip(start, sides, strict=True))
            return self.scene.points([(x, y)])[0]
        return selector

    def _selector(self, state: Element) -> Point | Zone | Element | None:
        """The goal that is the same for all people of a state, or the selector that mirrors their place."""
        name = state.attributes.get("name", "")[:40]
        for part in state.each("Action"):
            self.scene.note(f"the action {part.attributes.get('type', '')[:30]!r} of state {name!r} is not imported")
        for part in state.each("VelComponent"):
            kind = part.attributes.get("type", "goal")
            if kind not in STRAIGHT:
                self.scene.note(
                    f"the velocity component {kind[:30]!r} of state {name!r} is not imported: routes avoid walls"
                )
        for part in state.children:
            if part.tag not in ("Action", "VelComponent", "GoalSelector"):
                self.scene.note(f"<{part.tag[:40]}> of state {name!r} is not imported")
        selector = next(iter(state.each("GoalSelector")), None)
        kind = selector.attributes.get("type", "identity") if selector is not None else "identity"
        if selector is None or kind in ("identity", "mirror"):
            return selector if kind == "mirror" else None
        known = selector.attributes.get("goal_set", "")
        if kind == "explicit":
            goal = self.goals.get((known, selector.attributes.get("goal", "")))
        else:
            goal = next((goal for (group, _), goal in self.goals.items() if group == known), None)
            self.scene.note(f"the goal selector {kind[:30]!r} of state {name!r}: the first goal of its set is taken")
        if goal is None:
            self.scene.note(f"state {name!r} has no goal that is in the file: people skip it")
            return None
        return self._stop(goal)

    def _stop(self, goal: Element) -> Point | Zone | None:
        kind = goal.attributes.get("type", "point")
        if kind in ("point", "circle"):
            reach = self._number(goal, "radius", 0.0)
            spot = self._number(goal, "x"), self._number(goal, "y")
            return self.scene.points([spot], max(self.scene.goal_radius, reach))[0]
        if kind == "AABB":
            x0, y0, x1, y1 = (self._number(goal, key) for key in ("min_x", "min_y", "max_x", "max_y"))
            corners = box(0.5 * (x0 + x1), 0.5 * (y0 + y1), x1 - x0, y1 - y0)
        elif kind == "OBB":
            width, height = self._number(goal, "width"), self._number(goal, "height")
            turn = math.radians(self._number(goal, "angle", 0.0))
            place = self._number(goal, "x"), self._number(goal, "y")
            corners = move([(0.0, 0.0), (width, 0.0), (width, height), (0.0, height)], *place, turn)
        else:
            self.scene.note(f"goals of type {kind[:30]!r} are not imported")
            return None
        return Zone(Points.of(corners))
