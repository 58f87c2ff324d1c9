"""Trials from worlds of IR-SIM: obstacles, moving obstacles as people, and robots, in one YAML file.

The format is that of https://github.com/hanruihua/ir-sim: ``world``, ``robot`` and ``obstacle``, also below ``irsim``.
"""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError
from crowdbot.models import ORCA, CrowdModel, SocialForce
from crowdbot.trials.files.stage_maps import image_solids
from crowdbot.trials.files.trial_files import resolve_file
from crowdbot.world import Point

from .foreign_text import yaml_of
from .original import ImportedTrial
from .scene_parts import ImportedScene, as_number, box, circle, move, number_in

Spot = tuple[float, float]
STATE, SPEED, GOAL_RADIUS = (1.0, 1.0, 0.0), 1.0, 0.1
"""Defaults of IR-SIM: the place of an object, its largest speed [m/s], and the distance at arrival [m]."""
MOST_OBJECTS, MOST_DRAWS = 5000, 200
RANGE = (0.0, 0.0, -math.pi), (10.0, 10.0, math.pi)
"""Default range of random places: x, y [m] and heading [rad]."""
WORLD = {"height", "width", "step_time", "sample_time", "offset", "name", "plot", "status"}
"""Keys of the world that do not change the scene, or that are read."""
READ = {
    "shape", "state", "goal", "number", "distribution", "kinematics", "behavior", "group_behavior", "name", "vel_max",
    "goal_threshold", "static", "unobstructed", "color", "plot", "role",
}  # fmt: skip


def is_irsim(whole: Any) -> bool:
    """Whether the content of a YAML file is a world of IR-SIM."""
    content = whole.get("irsim", whole) if isinstance(whole, dict) else None
    return isinstance(content, dict) and bool({"world", "obstacle"} & set(content)) and "hunav_loader" not in content


def import_irsim(path: str | Path) -> ImportedTrial:
    """Read a world of IR-SIM (YAML with ``world``, ``robot`` and ``obstacle``).

    Obstacles without a behaviour become solid, those with one become people, and robots stay robots. The dark half of
    an image ``obstacle_map`` becomes solid. Random places and shapes are drawn once.

    Raises:
        TrialError: the file is missing or malformed, or nothing in it can be imported.
    """
    path = Path(path)
    whole = yaml_of(path)
    scene = ImportedScene(path, "IR-SIM", GOAL_RADIUS)
    content = whole.get("irsim", whole) if isinstance(whole, dict) else None
    if not isinstance(content, dict) or not is_irsim(whole):
        raise scene.error("is not a world of IR-SIM: it has neither world nor obstacle")
    world = content.get("world") or {}
    if not isinstance(world, dict):
        raise scene.error("world must be a mapping")
    with scene.named_errors():
        return _Reader(scene, world).trial(content)


class _Reader:
    """Converts a world."""

    def __init__(self, scene: ImportedScene, world: dict[Any, Any]) -> None:
        self.scene, self.world = scene, world
        self.models: list[CrowdModel] = []
        self.rng = np.random.default_rng(0)
        self.drawn = np.zeros((2 * MOST_OBJECTS, 3))
        """Places and goals that are drawn, with the radius [m] of what is there, as many as ``count``."""
        self.count = 0
        self.full: set[tuple[float, ...]] = set()
        """Ranges without room for a body: its radius is the last value."""
        self.solids: Any = None
        """Solids at places of the file, a geometry of shapely, once they are read."""

    def trial(self, content: dict[Any, Any]) -> ImportedTrial:
        """The trial."""
        for key in content:
            if key not in ("world", "robot", "obstacle", "gui"):
                self.scene.note(f"{str(key)[:40]} is not imported")
        for key, value in self.world.items():
            if key not in WORLD and value is not None and key != "obstacle_map":
                self.scene.note(f"world: {str(key)[:40]} is not imported")
        if self.world.get("obstacle_map") is not None:
            self._grid(self.world["obstacle_map"])
        self.scene.note("the border of the world is no wall, as in IR-SIM")
        count = 0
        entries: list[tuple[str, str, dict[Any, Any], int]] = []
        for role in ("obstacle", "robot"):
            rows = content.get(role) or []
            for k, row in enumerate(rows if isinstance(rows, list) else [rows]):
                label = f"{role} {k + 1}"
                if not isinstance(row, dict):
                    raise self.scene.error(f"{label} must be a mapping")
                number = int(number_in(row, "number", label, 1.0))
                count += max(0, number)
                if count > MOST_OBJECTS:
                    raise self.scene.error(f"more than {MOST_OBJECTS} objects are too many")
                entries.append((label, str(row.get("role") or role), row, number))
        for entry in entries:
            if not _is_random(*entry[2:]):
                self._group(*entry)
        self.solids = self._fixed_solids()
        for entry in entries:
            if _is_random(*entry[2:]):
                self._group(*entry)
        step = min(1.0, max(0.001, number_in(self.world, "step_time", "world", 0.1)))
        return self.scene.trial(step=step, crowd=self.models[0] if self.models else None)

    def _fixed_solids(self) -> Any:
        """The solids and walls so far as one geometry of shapely."""
        import shapely

        polygons = [shapely.Polygon(item.points) for item in self.scene.obstacles]
        return shapely.union_all([*polygons, *(shapely.LineString(item.points) for item in self.scene.walls)])

    def _grid(self, grid: Any) -> None:
        """Add the dark cells of an image that covers the world."""
        own = grid if isinstance(grid, dict) else {"path": grid}
        name = str(own.get("path") or own.get("name") or "")[:200]
        lost, remedy = f"the obstacle_map {name[:60]!r} of world is left out", "put its image beside the world"
        if own.get("path") is None:
            self.scene.note(f"{lost}: IR-SIM makes it at random; save it as an image, and {remedy}")
            return
        width, height = (number_in(self.world, key, "world", 10.0) for key in ("width", "height"))
        low = self.world.get("offset") or [0.0, 0.0]
        x, y = _at(low, 0, "world: offset"), _at(low, 1, "world: offset")
        folder = self.scene.path.resolve().parent
        try:
            solids = image_solids(resolve_file(name, folder, trust=False), width, height)
        except InputError as error:
            self.scene.note(f"{lost}: {error}; {remedy}")
            return
        for solid in solids:
            spots = [(round(x + u, 6), round(y + v, 6)) for u, v in solid.exterior.coords[:-1]]
            self.scene.obstacle(spots, "a part of the obstacle_map")

    def _group(self, label: str, role: str, row: dict[Any, Any], number: int) -> None:
        """Add the objects of one entry."""
        for key, value in row.items():
            if key not in READ and value is not None:
                self.scene.note(f"{label}: {str(key)[:40]} is not imported")
        if row.get("unobstructed"):
            self.scene.note(f"{label} is unobstructed, nothing collides with it, and is left out")
            return
        placed = self._places(label, row, number)
        for k, (state, goals) in enumerate(placed):
            name = self._name(label, row, k, number)
            shape = _item(row.get("shape"), k, dict) or {"name": "circle"}
            if not isinstance(shape, dict):
                raise self.scene.error(f"{name}: shape must be a mapping, such as {{name: circle, radius: 0.2}}")
            if shape.get("random_shape"):
                shape = self._random_shape(label, shape)
            behavior = _item(row.get("behavior"), k, dict) or row.get("group_behavior") or {}
            behavior = behavior if isinstance(behavior, dict) else {"name": behavior}
            if role == "robot":
                self._robot(name, row, k, shape, state, goals)
            elif behavior and row.get("kinematics") and not row.get("static"):
                self._person(name, row, k, shape, state, goals, behavior)
            else:
                self._solid(name, shape, state)

    def _places(self, label: str, row: dict[Any, Any], number: int) -> list[tuple[tuple[float, ...], list[Spot]]]:
        """States and goals of the objects of an entry; none if they are random."""
        how = row.get("distribution") or {}
        kind = _distribution(row)
        if _is_random(row, number):
            self.scene.note(f"{label}: IR-SIM draws its {number} places in each run, here they are drawn once")
            return [self._random_place(label, row, k, how if isinstance(how, dict) else {}) for k in range(number)]
        if kind == "circle":
            width, height = (number_in(self.world, key, "world", 10.0) for key in ("width", "height"))
            low = self.world.get("offset") or [0.0, 0.0]
            own = how if isinstance(how, dict) else {}
            middle = own.get("center") or [_at(low, 0, label) + 0.5 * width, _at(low, 1, label) + 0.5 * height]
            radius = number_in(own, "radius", label, 0.5 * min(width, height) - 0.5)
            x, y = _at(middle, 0, label), _at(middle, 1, label)
            turns = [2.0 * math.pi * k / max(1, number) for k in range(number)]
            spots = [move([(radius, 0.0)], x, y, turn)[0] for turn in turns]
            across = [move([(-radius, 0.0)], x, y, turn)[0] for turn in turns]
            return [((*spot, turn - math.pi), [goal]) for spot, goal, turn in zip(spots, across, turns, strict=True)]
        placed = []
        for k in range(number):
            state = _item(row.get("state"), k, float) or list(STATE)
            place = tuple(_at(state, axis, f"{label}: state", 0.0) for axis in range(3))
            goal = row.get("goal")
            goal = _item(goal, k, float) if number > 1 or _depth(goal) > 2 else goal
            rows = [] if goal is None else goal if _depth(goal) == 2 else [goal]
            placed.append((place, [(_at(spot, 0, f"{label}: goal"), _at(spot, 1, f"{label}: goal")) for spot in rows]))
        return placed

    def _random_place(
        self, label: str, row: dict[Any, Any], k: int, how: dict[Any, Any]
    ) -> tuple[tuple[float, ...], list[Spot]]:
        """A place apart from those drawn before, and a goal, in the range of a distribution."""
        low, high = (
            [_at(how.get(key) or list(RANGE[side]), axis, f"{label}: {key}", RANGE[side][axis]) for axis in range(3)]
            for side, key in enumerate(("range_low", "range_high"))
        )
        if any(a > b for a, b in zip(low, high, strict=True)):
            raise self.scene.error(f"{label}: range_low must not be above range_high")
        shape = _item(row.get("shape"), k, dict) or {}
        reach = _reach(shape if isinstance(shape, dict) else {})
        x, y, turn = self._draw(low, high, reach, label)
        rows = row.get("goal")
        if rows is not None:
            goal = _item(rows, k, float) if _depth(rows) >= 2 else rows
            spots = goal if _depth(goal) == 2 else [goal]
            return (x, y, turn), [(_at(spot, 0, f"{label}: goal"), _at(spot, 1, f"{label}: goal")) for spot in spots]
        moves = row.get("kinematics") is not None and not row.get("static")
        return (x, y, turn), [self._draw(low, high, reach, label)[:2]] if moves else []

    def _draw(self, low: list[float], high: list[float], reach: float, label: str) -> tuple[float, float, float]:
        """A place in a range that is clear of solids and of what is drawn before, and a heading."""
        import shapely

        key = (*low, *high, reach)
        x = y = turn = 0.0
        for _ in range(1 if key in self.full else MOST_DRAWS):
            x, y, turn = (float(value) for value in np.round(self.rng.uniform(np.array(low), np.array(high)), 6))
            there = self.drawn[: self.count]
            apart = np.hypot(x - there[:, 0], y - there[:, 1]) > reach + there[:, 2]
            if apart.all() and not shapely.distance(self.solids, shapely.Point(x, y)) <= reach:  # NaN without solids
                break
        else:
            self.full.add(key)
            self.scene.note(f"{label}: there is no room for all in its range, some may overlap others")
        self.drawn[self.count] = x, y, reach
        self.count += 1
        return x, y, turn

    def _random_shape(self, label: str, shape: dict[Any, Any]) -> dict[Any, Any]:
        """A shape with the sizes that IR-SIM draws in each run."""
        self.scene.note(f"{label} has random shapes in IR-SIM, here they are drawn once")

        def draw(key: str, low: float, high: float) -> float:
            given = shape.get(key) or [low, high]
            ends = sorted((_at(given, 0, f"{label}: {key}"), _at(given, 1, f"{label}: {key}")))
            return round(float(self.rng.uniform(ends[0], ends[1])), 6)

        kind = str(shape.get("name", "circle"))
        if kind == "circle":
            return {"name": kind, "radius": draw("radius_range", 0.1, 1.0)}
        if kind == "rectangle":
            return {"name": kind, "length": draw("length_range", 0.1, 1.0), "width": draw("width_range", 0.1, 1.0)}
        radius, count = draw("avg_radius_range", 0.1, 0.5), draw("num_vertices_range", 4.0, 10.0)
        spots = circle(0.0, 0.0, radius)
        corners = np.linspace(0, len(spots), min(len(spots), max(3, round(count))), endpoint=False).astype(int)
        return {"name": "polygon", "vertices": [list(spots[corner]) for corner in corners]}

    def _name(self, label: str, row: dict[Any, Any], k: int, number: int) -> str:
        name = _item(row.get("name"), k, str)
        return str(name)[:40] if name else label.replace(" ", "_") + (f"_{k + 1}" if number > 1 else "")

    def _speed(self, name: str, row: dict[Any, Any], k: int, behavior: dict[Any, Any]) -> float:
        """Largest speed of an object [m/s]."""
        given = row.get("vel_max")
        given = _item(given, k, float) if given is not None else None
        values = given if isinstance(given, list) else [SPEED if given is None else given]
        own = [key for key in ("vxmax", "maxSpeed") if behavior.get(key) is not None]
        speed = number_in(behavior, own[0], name) if own else _at(values, 0, f"{name}: vel_max")
        return speed

    def _person(
        self,
        name: str,
        row: dict[Any, Any],
        k: int,
        shape: dict[Any, Any],
        state: tuple[float, ...],
        goals: list[Spot],
        behavior: dict[Any, Any],
    ) -> None:
        kind = str(behavior.get("name", ""))
        model: CrowdModel = SocialForce() if kind == "sfm" else ORCA()
        if kind not in ("rvo", "orca", "sfm", "hrvo"):
            self.scene.note(f"the behaviour {kind[:40]!r} of {name}: ORCA replaces it")
        elif [item for item in behavior if item not in ("name", "loop", "wander", "vxmax", "vymax", "maxSpeed")]:
            self.scene.note("parameters of behaviours: the model has its defaults")
        if self.models and type(self.models[0]) is not type(model):
            self.scene.note(f"the behaviour of {name}: all people have the model of the first")
        self.models.append(model)
        if behavior.get("wander"):
            self.scene.note(f"{name} wanders to random goals, which are not imported: it has the goals of the file")
        if not goals:
            self.scene.note(f"{name} has no goal and stands")
        reach = number_in(row, "goal_threshold", name, GOAL_RADIUS)
        stops: list[Point] = self.scene.points(goals, reach)
        self.scene.person(
            name,
            state[0],
            state[1],
            stops,
            then="again" if behavior.get("loop") else "stay",
            heading=None if stops else state[2],
            speed=self._speed(name, row, k, behavior),
            radius=self._radius(name, shape),
        )

    def _robot(
        self,
        name: str,
        row: dict[Any, Any],
        k: int,
        shape: dict[Any, Any],
        state: tuple[float, ...],
        goals: list[Spot],
    ) -> None:
        from crowdbot.world import DifferentialDrive, Omnidirectional

        kinematics = row.get("kinematics") or {}
        kind = str(kinematics.get("name") if isinstance(kinematics, dict) else kinematics)
        speed = min(10.0, max(0.05, self._speed(name, row, k, {})))
        omni = kind.startswith("omni")
        if kind.startswith("acker"):
            self.scene.note(f"{name} steers like a car: it has a differential drive here")
        if len(goals) > 1:
            self.scene.note(f"{name} has {len(goals)} goals: its goal is the last")
        self.scene.robot(
            state[0],
            state[1],
            goals[-1] if goals else None,
            heading=state[2],
            radius=self._radius(name, shape),
            speed=speed,
            drive=Omnidirectional(max_speed=speed) if omni else DifferentialDrive(max_speed=speed),
        )

    def _radius(self, name: str, shape: dict[Any, Any]) -> float:
        """Radius of the disc around a shape [m]."""
        if shape.get("name", "circle") == "circle":
            return number_in(shape, "radius", name, 0.2)
        spots = self._corners(name, shape)
        if not spots:
            return 0.2
        self.scene.note(f"{name} is a {str(shape.get('name'))[:20]}: it becomes the disc around it")
        return max(math.hypot(x, y) for x, y in spots)

    def _corners(self, name: str, shape: dict[Any, Any]) -> list[Spot]:
        """Corners of a shape in its own frame; none if it is unknown."""
        kind = str(shape.get("name", "circle"))
        if kind == "circle":
            center = shape.get("center") or [0.0, 0.0]
            radius = number_in(shape, "radius", name, 0.2)
            return circle(_at(center, 0, name), _at(center, 1, name), radius) if radius > 0.0 else []
        if kind == "rectangle":
            return box(0.0, 0.0, number_in(shape, "length", name, 1.0), number_in(shape, "width", name, 1.0))
        if kind in ("polygon", "linestring"):
            rows = shape.get("vertices")
            if not isinstance(rows, list):
                raise self.scene.error(f"{name}: vertices of a {kind} must be a list of points")
            return [(_at(row, 0, f"{name}: vertices"), _at(row, 1, f"{name}: vertices")) for row in rows]
        self.scene.note(f"{name} has the shape {kind[:40]!r} and is left out")
        return []

    def _solid(self, name: str, shape: dict[Any, Any], state: tuple[float, ...]) -> None:
        spots = move(self._corners(name, shape), state[0], state[1], state[2])
        if not spots:
            return
        if shape.get("name") == "linestring":
            self.scene.wall(spots, name)
        else:
            self.scene.obstacle(spots, name)


def _reach(shape: dict[Any, Any]) -> float:
    """Largest distance [m] of a shape from its place, also of one whose sizes are drawn later."""
    sizes = [shape.get(key) for key in ("radius", "length", "width")]
    if shape.get("random_shape"):
        ranges = [value for key, value in shape.items() if str(key).endswith(("radius_range", "th_range"))]
        sizes += [1.0, *(size for value in ranges if isinstance(value, list) for size in value)]
    rows = shape.get("vertices")
    corners = [row for row in rows if isinstance(row, list)] if isinstance(rows, list) else []
    sizes += [2.0 * value for row in corners for value in row if isinstance(value, int | float)]
    return max([0.3, *(abs(float(size)) for size in sizes if isinstance(size, int | float) and abs(size) < 1e3)])


def _distribution(row: dict[Any, Any]) -> str:
    how = row.get("distribution") or {}
    return str(how.get("name", "manual") if isinstance(how, dict) else how)


def _is_random(row: dict[Any, Any], number: int) -> bool:
    """Whether the places of an entry are random."""
    return _distribution(row) == "random" and (number > 1 or "state" not in row)


def _depth(value: Any) -> int:
    """Levels of lists, of which only the first elements are looked at."""
    return 1 + _depth(value[0]) if isinstance(value, list) and value else 0


def _item(value: Any, k: int, kind: type) -> Any:
    """The value of the k-th object: an element of a list of values, or the one value of all.

    A list of fewer values than objects repeats its last, as in IR-SIM.
    """
    several = isinstance(value, list) and value and (kind is not float or isinstance(value[0], list))
    return value[min(k, len(value) - 1)] if several else value


def _at(value: Any, k: int, where: str, otherwise: float | None = None) -> float:
    """The k-th number of a list."""
    if not isinstance(value, list | tuple) or (len(value) <= k and otherwise is None):
        return as_number(str(value)[:40] if not isinstance(value, list | tuple) else "nothing", where)
    return as_number(value[k], where) if len(value) > k else float(otherwise or 0.0)
