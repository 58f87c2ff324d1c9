"""Trials from projects of JuPedSim (JPScore): rooms, doors, groups of people and goals, in XML.

The geometry is a file of its own (root element ``geometry``); the project (root element ``JuPedSim``) names it.
"""

from __future__ import annotations

import dataclasses
import itertools
import math
from pathlib import Path
from typing import Any

from crowdbot.core import Element, InputError
from crowdbot.core.fields import Points
from crowdbot.models import CollisionFreeSpeed
from crowdbot.trials.distribution import Distribution
from crowdbot.trials.files.trial_files import resolve_file
from crowdbot.trials.people import SourceSpec, Spawner
from crowdbot.world import Exit, Zone

from .foreign_text import xml_of
from .original import ImportedTrial
from .scene_parts import ImportedScene, as_number, box

Spot = tuple[float, float]
OUTSIDE = "-1"
EXIT_DEPTH = 0.3
"""Depth [m] of the zone behind a door to the outside in which people leave."""
MOST_PEOPLE = 20_000
SILENT = {
    "header", "agents", "operational_models", "route_choice_models", "routing", "geometry", "max_sim_time", "seed",
    "trajectories", "logfile", "output", "num_threads",
}  # fmt: skip
"""Elements of a project that are read, or that do not act on people."""
GROUP = {
    "group_id", "room_id", "subroom_id", "number", "goal_id", "agent_parameter_id", "x_min", "x_max", "y_min", "y_max",
    "startX", "startY", "router_id",
}  # fmt: skip
SOURCE = {
    "id", "caption", "group_id", "frequency", "N_create", "agents_max", "time", "time_min", "time_max", "x_min",
    "x_max", "y_min", "y_max", "startX", "startY",
}  # fmt: skip
ENTRY = 1.0
"""Side [m] of the zone of a source at a point."""
LONGEST = 86_400.0


def import_jupedsim(path: str | Path) -> ImportedTrial:
    """Read a project (``JuPedSim``) or a geometry (``geometry``) of JuPedSim.

    Walls of subrooms become thin walls, obstacles become solid, doors to the outside become goals of people who have no
    other, and groups become spawners in their box, or in the box around their room. Sources let the people of their
    group enter at a regular rate.

    Raises:
        TrialError: a file is missing or malformed, or nothing in it can be imported.
    """
    path = Path(path)
    root = xml_of(path)
    scene = ImportedScene(path, "JuPedSim")
    with scene.named_errors():
        if root.tag == "geometry":
            return _Reader(scene, root).trial(None)
        name = next((item for item in _all(root, "geometry")), None)
        if root.tag != "JuPedSim" or name is None:
            raise scene.error("is not a project of JuPedSim: it has no <geometry>")
        file = (name.stray.strip() or name.attributes.get("file", ""))[:200]
        try:
            found = resolve_file(file, path.resolve().parent, trust=False)
        except InputError as error:
            raise scene.error(f"the geometry {error}") from None
        geometry = xml_of(found)
        return _Reader(scene, geometry).trial(root)


def _all(part: Element, tag: str) -> list[Element]:
    """Elements with a tag at any depth."""
    return [*part.each(tag), *(inner for child in part.children for inner in _all(child, tag))]


class _Reader:
    """Converts a project."""

    def __init__(self, scene: ImportedScene, geometry: Element) -> None:
        self.scene, self.geometry = scene, geometry
        self.rooms: dict[tuple[str, str], list[Spot]] = {}
        self.exits: list[Zone] = []
        self.files: list[Element] = []
        """The project, and the files of goals and sources that it names."""

    def trial(self, project: Element | None) -> ImportedTrial:
        """The trial."""
        unit = self.geometry.attributes.get("unit", "m")
        if unit != "m":
            raise self.scene.error(f"the unit {unit[:20]!r} of the geometry is not m")
        for part in self.geometry.children:
            if part.tag not in ("rooms", "transitions"):
                self.scene.note(f"<{part.tag[:40]}> of the geometry is not imported")
        for room in _all(self.geometry, "room"):
            for subroom in room.each("subroom"):
                self._subroom(room, subroom)
        for door in _all(self.geometry, "transition"):
            self._door(door)
        duration = None
        if project is not None:
            times = _all(project, "max_sim_time")
            duration = self._number(times[0].stray, times[0], "max_sim_time") if times else None
            self._read_files(project)
            self._people(project)
        crowd = CollisionFreeSpeed()
        ((name, trial),) = (done := self.scene.trial(duration=duration, crowd=crowd)).trials
        exits = tuple(Exit(name=f"exit{k + 1}", zone=zone.points) for k, zone in enumerate(self.exits))
        end = dataclasses.replace(trial.end, empty=bool(trial.spawners or trial.agents or trial.sources))
        return ImportedTrial(((name, dataclasses.replace(trial, exits=exits, end=end)),), done.left_out)

    def _number(self, text: str | None, part: Element, key: str) -> float:
        return as_number(text if text is not None else "nothing", f"line {part.line}: {key} of <{part.tag[:40]}>")

    def _value(self, part: Element, key: str) -> float:
        return self._number(part.attributes.get(key), part, key)

    def _vertices(self, part: Element) -> list[Spot]:
        return [(self._value(item, "px"), self._value(item, "py")) for item in part.each("vertex")]

    def _subroom(self, room: Element, subroom: Element) -> None:
        """Add the walls and obstacles of a subroom."""
        ids = room.attributes.get("id", ""), subroom.attributes.get("id", "")
        name = f"subroom {ids[1][:20]} of room {ids[0][:20]}"
        if subroom.attributes.get("class", "").lower() in ("stair", "stairs", "escalator", "escalator_up"):
            self.scene.note(f"{name} is a {subroom.attributes['class'][:20]}: it is level here")
        for part in subroom.children:
            if part.tag == "polygon":
                spots = self._vertices(part)
                self.rooms.setdefault(ids, []).extend(spots)
                self.scene.wall(spots, f"a wall of {name}")
            elif part.tag == "obstacle":
                for k, polygon in enumerate(part.each("polygon")):
                    spots = self._vertices(polygon)
                    spots = spots[:-1] if len(spots) > 1 and spots[0] == spots[-1] else spots
                    self.scene.obstacle(spots, f"obstacle {part.attributes.get('id', str(k))[:20]} of {name}")
            else:
                self.scene.note(f"<{part.tag[:40]}> of subrooms is not imported")

    def _door(self, door: Element) -> None:
        """Add a door to the outside as a zone where people leave; other doors are openings."""
        outside = OUTSIDE in (door.attributes.get("room1_id"), door.attributes.get("room2_id"))
        spots = self._vertices(door)
        if not outside:
            return
        if len(spots) != 2 or spots[0] == spots[1]:
            self.scene.note(
                f"the door {door.attributes.get('id', '')[:20]!r} has no two different ends and is left out"
            )
            return
        (x, y), (u, v) = spots
        length = ((u - x) ** 2 + (v - y) ** 2) ** 0.5
        dx, dy = EXIT_DEPTH * (y - v) / length, EXIT_DEPTH * (u - x) / length
        corners = [(x - dx, y - dy), (u - dx, v - dy), (u + dx, v + dy), (x + dx, y + dy)]
        self.exits.append(Zone(Points.of([(round(a, 6), round(b, 6)) for a, b in corners])))

    def _people(self, project: Element) -> None:
        """Add the groups of people."""
        for part in project.children:
            if part.tag not in SILENT:
                self.scene.note(f"<{part.tag[:40]}> in line {part.line} is not imported")
        sources = self._everywhere("source")
        fed = {source.attributes.get("group_id", "") for source in sources}
        goals = {goal.attributes.get("id", ""): goal for goal in self._everywhere("goal")}
        sets = {item.attributes.get("agent_parameter_id", ""): item for item in _all(project, "agent_parameters")}
        if sets:
            self.scene.note("parameters of operational models other than the speed v0: the model has its defaults")
        count = 0
        groups = [item for part in _all(project, "agents_distribution") for item in part.each("group")]
        for source in sources:
            self._source(source, groups, goals, sets)
        for group in groups:
            name = f"group {group.attributes.get('group_id', str(len(self.scene.spawners) + 1))[:20]}"
            number = int(self._value(group, "number"))
            if number < 1:
                if group.attributes.get("group_id", "") not in fed:
                    self.scene.note(f"{name} has {number} people and is left out")
                continue
            count += number
            if count > MOST_PEOPLE:
                raise self.scene.error(f"more than {MOST_PEOPLE} people are too many")
            if extra := sorted(set(group.attributes) - GROUP):
                self.scene.note(f"{name}: not imported are {', '.join(item[:30] for item in extra[:12])}")
            stops = self._stops(name, group, goals)
            speed = self._speed(sets.get(group.attributes.get("agent_parameter_id", "")))
            if number == 1 and {"startX", "startY"} <= set(group.attributes):
                place = self._value(group, "startX"), self._value(group, "startY")
                self.scene.person(name, *place, stops, then="leave", speed=speed.values[0] if speed else None)
                continue
            zone = self._zone(name, group)
            if zone is None:
                continue
            values: dict[str, Any] = {} if speed is None else {"speed": speed}
            journey = self.scene.journey(stops, "leave")
            self.scene.spawners.append(
                Spawner(
                    name=name[:40], count=number, zone=Points.of(zone), journey=journey, stands=not journey, **values
                )
            )

    def _read_files(self, project: Element) -> None:
        """Read the files of goals and sources."""
        self.files = [project]
        for part in [item for tag in ("goals", "agents_sources") for item in _all(project, tag)]:
            for item in part.each("file"):
                name = item.stray.strip()[:200]
                try:
                    found = resolve_file(name, self.scene.path.resolve().parent, trust=False)
                except InputError as error:
                    self.scene.note(
                        f"<file> of <{part.tag}> in line {item.line} is left out: {error}; put it beside the project"
                    )
                    continue
                self.files.append(xml_of(found))

    def _everywhere(self, tag: str) -> list[Element]:
        """Elements of the project and its files with a tag."""
        return [item for file in self.files for item in ([file] if file.tag == tag else _all(file, tag))]

    def _source(
        self, source: Element, groups: list[Element], goals: dict[str, Element], sets: dict[str, Element]
    ) -> None:
        """Add a source of people of a group, who enter one after another."""
        values = source.attributes
        name = f"source {values.get('id', str(len(self.scene.sources) + 1))[:20]}"
        lost = f"<source> in line {source.line} ({name}) is left out"
        id = values.get("group_id", "")
        group = next((item for item in groups if item.attributes.get("group_id", "") == id), None)
        if group is None:
            self.scene.note(f"{lost}: there is no group {id[:20]!r}; add a <source> with a zone and a goal")
            return
        if extra := sorted(set(values) - SOURCE):
            self.scene.note(f"{name}: not imported are {', '.join(item[:30] for item in extra[:12])}")
        count = self._value(source, "N_create") if "N_create" in values else 1.0
        period = self._value(source, "frequency") if "frequency" in values else 1.0
        most = int(self._value(source, "agents_max")) if "agents_max" in values else -1
        begin = max(self._value(source, key) if key in values else 0.0 for key in ("time", "time_min"))
        end = self._value(source, "time_max") if "time_max" in values else math.inf
        if count <= 0.0 or period <= 0.0 or most == 0 or not 0.0 <= begin < end or begin > LONGEST:
            self.scene.note(f"{lost}: nobody enters by its numbers, check frequency, N_create, agents_max and times")
            return
        if count > 1.0:
            self.scene.note(f"{name}: {count:g} people each {period:g} s enter one after another, not at once")
        if {"startX", "startY"} <= set(values):
            zone: list[Spot] | None = box(self._value(source, "startX"), self._value(source, "startY"), ENTRY, ENTRY)
        else:
            own = {"x_min", "x_max", "y_min", "y_max"} <= set(values)
            zone = self._zone(name, source if own else group)
        stops = self._stops(name, group, goals) if zone else []
        if zone is None or not stops:
            self.scene.note(f"{lost}: it needs a zone, and a goal or a door to the outside; add a <source> with both")
            return
        speed = self._speed(sets.get(group.attributes.get("agent_parameter_id", "")))
        options: dict[str, Any] = {} if speed is None else {"speed": speed}
        self.scene.sources.append(
            SourceSpec(
                name=name[:40],
                zone=Points.of(zone),
                journey=self.scene.journey(stops, "leave"),
                rate=min(1e4, count / period),
                timing="regular",
                begin=begin,
                end=math.inf if end > LONGEST else end,
                max_count=min(MOST_PEOPLE, most) if most > 0 else None,
                **options,
            )
        )

    def _stops(self, name: str, group: Element, goals: dict[str, Element]) -> list[Zone]:
        """The goal of a group, or the nearest exit."""
        id = group.attributes.get("goal_id", "").strip()
        if id and id != OUTSIDE:
            polygon = (
                next((item for goal in [goals[id]] for item in goal.each("polygon")), None) if id in goals else None
            )
            if polygon is not None:
                spots = self._vertices(polygon)
                spots = spots[:-1] if len(spots) > 1 and spots[0] == spots[-1] else spots
                if len(spots) >= 3:
                    return [Zone(Points.of(spots))]
            self.scene.note(f"{name}: there is no goal {id[:20]!r} with a polygon, people go to an exit")
        if not self.exits:
            self.scene.note(f"{name} has neither a goal nor a door to the outside, and stands")
            return []
        if len(self.exits) > 1:
            self.scene.note(f"{name} goes to the exit nearest to the middle of its zone")
        zone = self._zone(name, group) or [(0.0, 0.0)]
        x, y = (sum(spot[axis] for spot in zone) / len(zone) for axis in (0, 1))
        return [min(self.exits, key=lambda one: (_middle(one)[0] - x) ** 2 + (_middle(one)[1] - y) ** 2)]

    def _speed(self, parameters: Element | None) -> Distribution | None:
        """Distribution of the preferred speed of a set of parameters."""
        law = next(iter(parameters.each("v0")), None) if parameters is not None else None
        if law is None:
            return None
        mean = min(10.0, max(0.05, self._value(law, "mu")))
        deviation = self._value(law, "sigma") if "sigma" in law.attributes else 0.0
        low = max(0.05, round(mean - 3.0 * deviation, 6))
        high = min(10.0, round(mean + 3.0 * deviation, 6))
        if deviation <= 0.0 or not low < high:
            return Distribution.of(mean)
        return Distribution("normal", (mean, deviation, low, high))

    def _zone(self, name: str, group: Element) -> list[Spot] | None:
        """Corners of the box where a group begins."""
        keys = ("x_min", "x_max", "y_min", "y_max")
        if set(keys) <= set(group.attributes):
            x0, x1, y0, y1 = (self._value(group, key) for key in keys)
        else:
            room, subroom = group.attributes.get("room_id", ""), group.attributes.get("subroom_id")
            spots = list(
                itertools.chain.from_iterable(
                    corners for ids, corners in self.rooms.items() if ids[0] == room and subroom in (None, ids[1])
                )
            )
            if not spots:
                self.scene.note(f"{name} is in room {room[:20]!r}, which has no walls, and is left out")
                return None
            x0, x1 = min(x for x, _ in spots), max(x for x, _ in spots)
            y0, y1 = min(y for _, y in spots), max(y for _, y in spots)
            self.scene.note(f"{name} begins in the box around its room")
        if not (x0 < x1 and y0 < y1):
            self.scene.note(f"{name} begins in a box without area and is left out")
            return None
        return box(0.5 * (x0 + x1), 0.5 * (y0 + y1), x1 - x0, y1 - y0)


def _middle(zone: Zone) -> Spot:
    count = len(zone.points)
    return sum(x for x, _ in zone.points) / count, sum(y for _, y in zone.points) / count
