"""Trials from scenarios of Arena-Rosnav: people with waypoints, robots and static obstacles, in one JSON file.

The format is that of https://github.com/Arena-Rosnav/arena-rosnav, in two forms: ``obstacles`` with ``dynamic`` and
``static``, and the older ``pedsim_agents`` with ``static_obstacles``.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from crowdbot.core import InputError
from crowdbot.trials.files.stage_maps import map_files

from .foreign_text import json_of
from .original import ImportedTrial
from .scene_parts import ImportedScene, as_number, number_in

Spot = tuple[float, float]
OWN = ("pedsim_agents", "robots", "static_obstacles", "map_path", "robot_position")
"""Keys that only scenarios of Arena-Rosnav have."""
VEHICLES = ("vehicle", "servicerobot", "robot", "forklift", "bicycle")
LOOP, RANDOM = (0, 2), 1
"""Modes of waypoints: in order again and again, or at random."""
SPEED = 1.0
MOST_ENTRIES = 5000
TOP = {"obstacles", "robots", "map", "pedsim_agents", "static_obstacles", "map_path", "robot_position", "robot_goal",
       "resets", "format", "scenario_name", "name", "_comment", "watchers", "dynamic_obstacles"}  # fmt: skip
AGENT = {
    "name", "id", "pos", "waypoints", "waypoint_mode", "type", "model", "vmax", "number_of_peds", "yaml_file", "desc",
    "start_up_mode",
}  # fmt: skip


def is_arena(whole: Any) -> bool:
    """Whether the content of a JSON file is a scenario of Arena-Rosnav."""
    if not isinstance(whole, dict) or "scenario" in whole:
        return False
    obstacles = whole.get("obstacles")
    return any(key in whole for key in OWN) or (isinstance(obstacles, dict) and "dynamic" in obstacles)


def import_arena(path: str | Path) -> ImportedTrial:
    """Read a scenario of Arena-Rosnav (JSON).

    The map is named in the scenario. It is imported if its ROS map (``MAP.yaml`` or ``MAP/map.yaml``) is beside the
    scenario, or in the folder of the world above it (``map/map.yaml``).

    Raises:
        TrialError: the file is missing or malformed, or nothing in it can be imported.
    """
    path = Path(path)
    whole = json_of(path)
    scene = ImportedScene(path, "Arena-Rosnav")
    if not is_arena(whole):
        raise scene.error("is not a scenario of Arena-Rosnav: it has neither obstacles, robots nor pedsim_agents")
    for key, value in whole.items():
        if key not in TOP and value:
            scene.note(f"{str(key)[:40]} is not imported")
    with scene.named_errors():
        return _trial(scene, whole)


def _trial(scene: ImportedScene, whole: dict[str, Any]) -> ImportedTrial:
    """The trial of a scenario."""
    obstacles = whole.get("obstacles") or {}
    if not isinstance(obstacles, dict):
        raise scene.error("obstacles must be an object with the lists dynamic and static")
    for key in obstacles:
        if key not in ("dynamic", "static"):
            for row in _rows(scene, obstacles, key):
                scene.note(f"{_named(row, key)} ({str(key)[:40]}) is not imported")
    for row in [*_rows(scene, obstacles, "dynamic"), *_rows(scene, whole, "pedsim_agents")]:
        _person(scene, row)
    for row in [*_rows(scene, obstacles, "static"), *_rows(scene, whole, "static_obstacles")]:
        model = str(row.get("model") or row.get("model_path") or "unknown")
        scene.note(
            f"the static obstacle {_named(row, 'obstacle')} (model {model[:40]}) is not imported, since its size is not"
            f" in the file; add its outline as <obstacle> around {_spot(scene, row, 'pos', 'obstacle')}"
        )
    robots = _rows(scene, whole, "robots")
    if "robot_position" in whole:
        robots = [*robots, {"start": whole["robot_position"], "goal": whole.get("robot_goal")}]
    for row in robots:
        x, y = _spot(scene, row, "start", "robot")
        goal = _spot(scene, row, "goal", "robot") if row.get("goal") is not None else None
        scene.robot(x, y, goal, heading=_third(row, "start", "robot"))
    if whole.get("resets"):
        scene.note("resets of the scenario are not imported: a trial runs once for each seed")
    name, folder = _map(scene, whole)
    return scene.trial(map=name, folder=folder)


def _map(scene: ImportedScene, whole: dict[str, Any]) -> tuple[str, Path | None]:
    """The ROS map of the scenario and the folder that has it; empty with a note if there is none.

    It is beside the scenario, or where Arena-Rosnav has it: ``worlds/MAP/map`` beside ``worlds/MAP/scenarios``, also
    if the scenario names none, or ``maps/MAP`` beside ``scenarios``.
    """
    folder = scene.path.resolve().parent
    in_world = folder.name == "scenarios" and (folder.parent / "map" / "map.yaml").is_file()
    name = whole.get("map") or whole.get("map_path") or (folder.parent.name if in_world else "")
    if not name:
        return "", None
    name = str(name).strip()[:200]
    names = [name] if name.endswith((".yaml", ".yml")) else [f"{name}/map.yaml", f"{name}.yaml"]
    places = [(folder, item) for item in (*names, *(file.rpartition("/")[2] for file in names))]
    if folder.parent.name == name:
        places.append((folder.parent, "map/map.yaml"))
    places.append((folder.parent, f"maps/{name}/map.yaml"))
    for home, item in places:
        try:
            map_files(item, home, trust=False)
        except InputError:
            continue
        scene.note(f"the stage reads {item[:80]} in the folder of the trial, a copy of that in {home}")
        return item, home
    scene.note(
        f"the map {name[:60]!r} is not beside the scenario as {' or '.join(name[:80] for name in names)}, nor in the"
        " folder above: the stage has no walls, add them"
    )
    return "", None


def _rows(scene: ImportedScene, whole: dict[str, Any], key: str) -> list[dict[str, Any]]:
    rows = whole.get(key) or []
    if not isinstance(rows, list) or not all(isinstance(row, dict) for row in rows):
        raise scene.error(f"{str(key)[:40]} must be a list of objects")
    if len(rows) > MOST_ENTRIES:
        raise scene.error(f"{str(key)[:40]} has {len(rows)} entries, at most {MOST_ENTRIES} are read")
    return rows


def _named(row: dict[str, Any], kind: str) -> str:
    return repr(str(row.get("name", kind))[:40])


def _spot(scene: ImportedScene, row: dict[str, Any], key: str, kind: str) -> Spot:
    value = row.get(key)
    return _pair(scene, value, f"{kind} {_named(row, kind)}: {key}")


def _pair(scene: ImportedScene, value: Any, where: str) -> Spot:
    if not isinstance(value, list) or len(value) < 2:
        raise scene.error(f"{where} must be [x, y, angle], not {str(value)[:40]!r}")
    return as_number(value[0], where), as_number(value[1], where)


def _third(row: dict[str, Any], key: str, kind: str) -> float:
    value = row.get(key)
    return as_number(value[2], f"{kind}: {key}") if isinstance(value, list) and len(value) > 2 else 0.0


def _person(scene: ImportedScene, row: dict[str, Any]) -> None:
    """Add a pedestrian; a vehicle is left out."""
    name = str(row.get("name") or f"person{len(scene.people) + 1}")[:40]
    kind = str(row.get("type", "adult"))
    if kind.lower() in VEHICLES:
        scene.note(f"{name} is a {kind[:40]} and is left out: people and robots are imported")
        return
    if extra := [str(key)[:40] for key in row if key not in AGENT]:
        scene.note(f"parameters of people are not imported: {', '.join(sorted(extra)[:12])}")
    spots = row.get("waypoints") or []
    if not isinstance(spots, list):
        raise scene.error(f"{name}: waypoints must be a list of points")
    stops = scene.points([_pair(scene, spot, f"{name}: waypoint {k + 1}") for k, spot in enumerate(spots)])
    mode = row.get("waypoint_mode", LOOP[0])
    if mode == RANDOM:
        scene.note(f"{name} goes to its waypoints at random in Arena-Rosnav, here in order")
    elif mode not in LOOP:
        scene.note(f"{name}: the waypoint mode {str(mode)[:20]} is unknown; waypoints follow in order, again and again")
    if str(row.get("start_up_mode", "default")) != "default":
        scene.note(f"{name}: the start up mode {str(row['start_up_mode'])[:30]} is not imported, people go at once")
    count = number_in(row, "number_of_peds", name, 1.0)
    if count > 1.0:
        scene.note(f"{name} stands for {count:g} people: one is imported, since the file has one place")
    x, y = _spot(scene, row, "pos", "person")
    speed = number_in(row, "vmax", name, SPEED) if "vmax" in row else None
    heading = None if stops else _third(row, "pos", name)
    scene.person(name, x, y, stops, then="again", heading=heading, speed=speed)
