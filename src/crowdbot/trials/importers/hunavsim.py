"""Trials from agent files of HuNavSim: people with goals, groups and behaviour trees, in one YAML file.

HuNavSim: Perez-Higueras, Otero, Caballero, Merino 2023, HuNavSim: A ROS 2 Human Navigation Simulator for Benchmarking
Human-Aware Robot Navigation, doi 10.1109/LRA.2023.3316072, arXiv 2305.01303.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from crowdbot.core import InputError, TrialError, parse_yaml
from crowdbot.models import GroupForce
from crowdbot.trials.agent import Agent
from crowdbot.trials.files.trial_files import resolve_file
from crowdbot.trials.journey import Journey
from crowdbot.trials.robots.behavior import BehaviorSpec
from crowdbot.trials.robots.reaction import ReactionSpec
from crowdbot.trials.stage import Stage
from crowdbot.trials.trial import End, Trial
from crowdbot.trials.xml.trial_text import read_trial_bytes
from crowdbot.world import Point

from .original import ImportedTrial

DURATION = 120.0
LARGEST = 1e6
MOST_BYTES = 4_000_000
BEHAVIOURS = {1: "", 2: "impassive", 3: "look", 4: "scared", 5: "curious", 6: "block"}
"""Kind of reaction of each behaviour: regular, impassive, surprised, scared, curious, threatening."""
TREES = {1: "Regular", 2: "Regular", 3: "Surprised", 4: "Scared", 5: "Curious", 6: "Threatening"}
"""Behaviour tree of each behaviour, without ``BT`` before and ``Nav.xml`` behind it."""
SEES = {1: "regular", 2: "impassive"}
"""How robots are seen during the regular walk, by behaviour; with the others they are left out of the forces."""
TREE_FOLDER = "behavior_trees"
"""Folder of the trees, beside the folder of the agent file in the package of HuNavSim."""
UNDEFINED = -1
"""Behaviour of an agent without one, which HuNavSim takes for regular."""
NEARER = 0.1
"""Distance [m] that the condition ``IsGoalReached`` adds to the radius of a goal."""
KNOWN = {
    "id", "skin", "behavior", "behavior_tree", "group_id", "max_vel", "radius", "init_pose", "goal_radius",
    "cyclic_goals", "goals",
}  # fmt: skip
"""Keys of an agent, except the names of its goals."""
CUSTOM = 1
ROBOT_RADIUS = 0.3
"""Radius [m] of the robot in distances of behaviours, which are those of centres."""
FORCES = ("goal_force_factor", "obstacle_force_factor", "social_force_factor", "other_force_factor")


def import_hunavsim(path: str | Path) -> ImportedTrial:
    """Read an agent file of HuNavSim (YAML with ``hunav_loader``).

    Agents have the behaviour tree of their behaviour, such as ``BTScaredNav.xml``, which is looked for in
    ``behavior_trees`` beside the file and beside its folder, as in the package of HuNavSim. Where it is not found,
    behaviours become reactions to robots: surprised people stop and look, threatening people block the robot. Goals
    become journeys, which begin again if the goals are cyclic. The model is the social force model with groups.
    Values that are missing are those of the loader of HuNavSim.

    Raises:
        TrialError: the file is missing or malformed, there are no agents, or a value is wrong.
    """
    path = Path(path)
    data = read_trial_bytes(path)
    if len(data) > MOST_BYTES:
        raise TrialError(f"{path} is larger than {MOST_BYTES} bytes, the limit of an agent file")
    try:
        whole = parse_yaml(data.decode("utf-8-sig"), str(path))
    except UnicodeDecodeError:
        raise TrialError(f"{path} is not a text in UTF-8") from None
    except InputError as error:
        raise TrialError(str(error)) from None
    content = whole
    for key in ("hunav_loader", "ros__parameters"):
        content = content.get(key) if isinstance(content, dict) else None
    if not isinstance(content, dict):
        raise TrialError(f"{path} is not an agent file of HuNavSim: it lacks hunav_loader with ros__parameters")
    reader = _Reader(path, content)
    return ImportedTrial(((path.stem, reader.trial()),), tuple(reader.notes))


@dataclass
class _Reader:
    """Converts an agent file, and notes what is not imported."""

    path: Path
    content: dict[Any, Any]
    notes: dict[str, None] = field(default_factory=dict)
    journeys: dict[tuple[Any, ...], Journey] = field(default_factory=dict)

    def trial(self) -> Trial:
        """Return the trial."""
        names = self.content.get("agents")
        if not isinstance(names, list) or not names:
            raise TrialError(f"{self.path}: agents must be a list of names, and there must be at least one")
        blocks = [self._block(self.content, str(name), "agent") for name in names]
        agents = tuple(self._agent(str(name), block) for name, block in zip(names, blocks, strict=True))
        for key in self.content:
            if key not in ("map", "agents", "global_goals", *names):
                self.notes[f"{str(key)[:40]} is not imported"] = None
        if self.content.get("map"):
            self.notes[f"the map {str(self.content['map'])[:40]}: the stage has no walls, add them"] = None
        self.notes["the robot is not in the file: people react to the robots that you add"] = None
        self.notes["no end by time is in the file: the trial ends after 120 s"] = None
        return Trial(
            name=(self.path.stem.strip() or "imported")[:80],
            about="Imported from HuNavSim.",
            duration=DURATION,
            stage=Stage(),
            crowd=GroupForce(),
            journeys=tuple(self.journeys.values()),
            agents=agents,
            end=End(goal=False, collision=False),
        )

    def _agent(self, name: str, one: dict[Any, Any]) -> Agent:
        place = self._block(one, "init_pose", f"{name}: init_pose")
        speed = min(10.0, max(0.05, self._number(one, "max_vel", name, 1.0)))
        radius = min(5.0, max(0.05, self._number(one, "radius", name, 0.35)))
        group = int(self._number(one, "group_id", name, -1.0))
        if one.get("skin"):
            self.notes["skins are not imported"] = None
        if "id" in one:
            self.notes["ids are not imported: people are numbered in the order of the file"] = None
        for key in one:
            if key not in KNOWN and str(key) not in map(
                str, goals if isinstance(goals := one.get("goals"), list) else ()
            ):
                self.notes[f"{str(key)[:40]} of agents is not imported"] = None
        turn = self._number(place, "h", name, 0.0)
        number, about = self._behavior(name, one)
        trees = self._trees(name, one, number, about)
        further = NEARER if trees and trees[0].behavior().leads_journey else 0.0
        return Agent(
            name=name[:40],
            x=self._number(place, "x", name),
            y=self._number(place, "y", name),
            heading=math.remainder(turn, 2.0 * math.pi),
            journey=self._journey(name, one, further),
            speed=speed,
            radius=radius,
            group=max(-1, group),
            reactions=() if trees else self._reactions(name, number, about, speed, radius),
            behaviors=trees,
        )

    def _journey(self, name: str, one: dict[Any, Any], further: float) -> str:
        """Return the name of the journey of an agent, empty without goals; they are reached ``further`` away [m]."""
        goals = one.get("goals") or []
        reach = max(0.05, round(self._number(one, "goal_radius", name, 0.0) + further, 9))
        if not isinstance(goals, list):
            raise TrialError(f"{self.path}: {name}: goals must be a list of names")
        stops = []
        for goal in goals:
            known = one if goal in one or str(goal) in one else self.content.get("global_goals")
            spot = self._block(known if isinstance(known, dict) else {}, goal, f"{name}: goal {str(goal)[:40]}")
            stops.append(Point(self._number(spot, "x", name), self._number(spot, "y", name), min(1e3, reach)))
        if not stops:
            return ""
        key = (tuple(stops), again := bool(one.get("cyclic_goals", True)))
        then = "again" if again else "stay"
        made = Journey(name=f"way{len(self.journeys) + 1}", then=then, stops=tuple(stops))
        return self.journeys.setdefault(key, made).name

    def _behavior(self, name: str, one: dict[Any, Any]) -> tuple[int, dict[Any, Any]]:
        """Return the number of the behaviour of an agent, and its configuration."""
        about = one.get("behavior", UNDEFINED)
        about = about if isinstance(about, dict) else {"type": about}
        number = int(self._number(about, "type", f"{name}: behavior", 1.0))
        number = 1 if number == UNDEFINED else number
        if number not in BEHAVIOURS:
            raise TrialError(f"{self.path}: {name}: behavior type = {number} must be from 1 to {len(BEHAVIOURS)}")
        return number, about

    def _trees(self, name: str, one: dict[Any, Any], number: int, about: dict[Any, Any]) -> tuple[BehaviorSpec, ...]:
        """Return the behaviour tree of an agent, if its file is there; a note tells what replaces it otherwise."""
        named = one.get("behavior_tree")
        if int(self._number(about, "configuration", name, 0.0)) >= CUSTOM and not named:
            if number in SEES:
                return ()
            self.notes["custom and random configurations of behaviours: reactions replace the trees"] = None
            return ()
        file = str(named).strip() if named else f"BT{TREES[number]}Nav.xml"
        home = self.path.resolve().parent
        for folder, place in ((home, f"{TREE_FOLDER}/{file}"), (home.parent, f"{TREE_FOLDER}/{file}"), (home, file)):
            tree = BehaviorSpec(file=place, regular=SEES.get(number, "ignore"), folder=folder, trust=False)
            try:
                resolve_file(place, folder, trust=False)
            except InputError:
                continue
            try:
                tree.behavior()
            except InputError as error:
                self.notes[f"the behaviour tree {place[:80]}, a reaction replaces it: {error}"] = None
                return ()
            return (tree,)
        if named or number not in SEES:
            self.notes[
                f"the behaviour tree {file[:80]} is not in {TREE_FOLDER} beside the file or its folder: a reaction"
                " replaces it"
            ] = None
        return ()

    def _reactions(
        self, name: str, number: int, about: dict[Any, Any], speed: float, radius: float
    ) -> tuple[ReactionSpec, ...]:
        """Return the reaction that stands for the behaviour of an agent."""
        kind = BEHAVIOURS[number]
        if any(key in about for key in FORCES):
            self.notes["force factors of the behaviours: the model and the reactions have their defaults"] = None
        if not kind:
            return ()
        values: dict[str, Any] = {"speed": 0.0} if kind == "look" else {}
        way = int(self._number(about, "configuration", name, 0.0))
        if way == CUSTOM:
            values |= self._custom(name, kind, about, speed, radius)
        elif way > CUSTOM:
            self.notes["random configurations of behaviours: the reactions have their defaults"] = None
        return (ReactionSpec(type=kind, once=bool(about.get("once", False)), **values),)

    def _custom(self, name: str, kind: str, about: dict[Any, Any], speed: float, radius: float) -> dict[str, Any]:
        """Return the parameters of a reaction that a behaviour sets."""
        custom: dict[str, Any] = {}
        duration, slow, far = (self._number(about, key, name, 0.0) for key in ("duration", "vel", "dist"))
        if duration > 0.0:
            custom["duration"] = min(86_400.0, duration)
        if slow > 0.0 and kind in ("scared", "curious"):
            custom["speed"] = min(1.3, round(slow / speed, 6))
        if far > 0.0 and kind in ("curious", "block"):
            custom["gap"] = min(100.0, max(0.0, round(far - radius - ROBOT_RADIUS, 6)))
        return custom

    def _block(self, values: Mapping[Any, Any], key: Any, what: str) -> dict[Any, Any]:
        block = values.get(key, values.get(str(key)))
        if not isinstance(block, dict):
            raise TrialError(f"{self.path}: {what} {str(key)[:40]!r} is missing, or not a mapping")
        return block

    def _number(self, values: dict[Any, Any], key: str, place: str, otherwise: float | None = None) -> float:
        value = values.get(key, otherwise)
        if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) <= LARGEST:
            raise TrialError(f"{self.path}: {place[:60]}: {key} must be a number up to 1e6, not {str(value)[:40]!r}")
        return float(value)
