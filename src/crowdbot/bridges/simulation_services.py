"""What the services of ``simulation_interfaces`` and ``std_srvs`` do with a simulation."""

from __future__ import annotations

import math
import re
import urllib.parse
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple
from xml.sax.saxutils import quoteattr

import numpy as np

from crowdbot.core import InputError, did_you_mean
from crowdbot.recording import versions
from crowdbot.simulation import (
    AddElementOrder,
    AddPersonOrder,
    MoveOrder,
    Order,
    RemoveElementOrder,
    RemoveOrder,
    Simulation,
)
from crowdbot.trials import Trial, builtin_trials, check_trial, load_trial, parse_trial, trial_xml
from crowdbot.world import builtin_robots, next_person

from . import simulation_interfaces as si
from .fields import stamp_fields
from .inbox import Inbox, ServiceCall
from .interface import Fields, read_heading, read_number, read_point
from .run_control import RunControl


class UnsupportedFeature(InputError):
    """A request uses an optional feature of the standard that this program does not have."""


def result(code: int = si.RESULT_OK, message: str = "", **fields: Any) -> dict[str, Any]:
    """Return a response with its result and other fields.

    >>> result(si.RESULT_NOT_FOUND, "no robot")
    {'result': {'result': 2, 'error_message': 'no robot'}}
    """
    return {"result": {"result": code, "error_message": message}, **fields}


LONGEST, MOST_REPEATS = 200, 4
"""Largest length of a name filter, and of the number of its repetitions, which bounds the time of a search."""


class Entity(NamedTuple):
    """A robot or person.

    Fields:
        name: name of the robot, or ``person_`` and the id.
        category: a category of ``simulation_interfaces/EntityCategory``, robot or human.
        number: id in the simulation.
        slot: index in the scene.
    """

    name: str
    category: int
    number: int
    slot: int


def entities(simulation: Simulation) -> list[Entity]:
    """Return robots, then people by id.

    >>> from crowdbot.trials import load_trial
    >>> [one.name for one in entities(Simulation(load_trial("frontal"), 0))]
    ['robot', 'person_0']
    """
    world = simulation.world
    ids, active = world.ids[0], world.scene.active[0]
    found = [
        Entity(robot.robot.name, si.CATEGORY_ROBOT, int(ids[robot.agent]), robot.agent)
        for robot in simulation.robots
        if active[robot.agent]
    ]
    robots = {one.slot for one in found} | {robot.agent for robot in simulation.robots}
    slots = sorted((int(slot) for slot in np.flatnonzero(active[: world.slots[0]])), key=lambda slot: int(ids[slot]))
    return found + [
        Entity(f"person_{ids[slot]}", si.CATEGORY_HUMAN, int(ids[slot]), slot) for slot in slots if slot not in robots
    ]


def entity_of(simulation: Simulation, name: Any) -> Entity:
    """Return the entity of a name.

    Raises:
        LookupError: there is none.
    """
    known = {entity.name: entity for entity in entities(simulation)}
    if name not in known:
        raise LookupError(f"there is no entity {str(name)[:80]!r}{did_you_mean(str(name)[:80], known)}")
    return known[name]


def filter_entities(simulation: Simulation, filters: Mapping[str, Any]) -> list[Entity]:
    """Return the entities that match ``simulation_interfaces/EntityFilters``.

    Raises:
        UnsupportedFeature: the filter has tags, or bounds that are neither a box nor a sphere.
        InputError: the name filter or a value is not allowed.
    """
    tags, bounds = filters.get("tags") or {}, filters.get("bounds") or {}
    if tags.get("tags"):
        raise UnsupportedFeature("entities have no tags")
    points = bounds.get("points") or []
    if points and (bounds.get("type") not in (si.TYPE_BOX, si.TYPE_SPHERE) or len(points) != 2):
        raise UnsupportedFeature("bounds must be a box (1) or a sphere (3) with two points")
    found = entities(simulation)
    if filters.get("filter"):
        wanted = _compile(filters["filter"])
        found = [one for one in found if wanted.search(one.name)]
    if filters.get("categories"):
        kinds = {item.get("category") if isinstance(item, Mapping) else item for item in filters["categories"]}
        found = [one for one in found if one.category in kinds]
    if points:
        found = [one for one in found if _distance(simulation, one, bounds["type"], points) <= 0.0]
    return found


def _distance(simulation: Simulation, entity: Entity, kind: int, points: Any) -> float:
    """Return the distance of an entity from a box or sphere in the plane [m], not above 0 if they overlap."""
    x, y = simulation.world.scene.position[0, entity.slot].tolist()
    first, second = ((read_number(point, "x"), read_number(point, "y")) for point in points)
    if kind == si.TYPE_SPHERE:
        gap = math.dist((x, y), first) - second[0]
    else:
        edges = [sorted(pair) for pair in zip(first, second, strict=True)]
        gap = math.hypot(
            *(max(low - value, 0.0, value - high) for value, (low, high) in zip((x, y), edges, strict=True))
        )
    return gap - float(simulation.world.scene.radius[0, entity.slot])


def _compile(text: Any) -> re.Pattern[str]:
    """Return a regular expression that cannot take long on a name."""
    if not isinstance(text, str) or len(text) > LONGEST:
        raise InputError(f"a name filter must be a text of at most {LONGEST} characters")
    if re.search(r"\)[*+?{]|\\\d|\(\?", text) or len(re.findall(r"[*+{]", text)) > MOST_REPEATS:
        raise InputError(f"a name filter can repeat single characters only, at most {MOST_REPEATS} times")
    try:
        return re.compile(text)
    except (re.error, RecursionError, OverflowError) as error:
        raise InputError(f"the name filter is no regular expression: {error}") from None


def state_of_entity(simulation: Simulation, entity: Entity) -> dict[str, Any]:
    """Return ``simulation_interfaces/EntityState`` in the frame of the map."""
    world, slot = simulation.world, entity.slot
    scene, now = world.scene, int(simulation.ticks[0]) * world.clock.step_ns
    (x, y), (vx, vy) = scene.position[0, slot].tolist(), scene.velocity[0, slot].tolist()
    half = 0.5 * float(scene.heading[0, slot])
    turn = float(world.twists[slot].turn[0]) if slot in world.twists else 0.0
    return {
        "header": {"stamp": stamp_fields(now), "frame_id": "map"},
        "pose": {
            "position": {"x": x, "y": y, "z": 0.0},
            "orientation": {"x": 0.0, "y": 0.0, "z": math.sin(half), "w": math.cos(half)},
        },
        "twist": {"linear": {"x": vx, "y": vy, "z": 0.0}, "angular": {"x": 0.0, "y": 0.0, "z": turn}},
        "acceleration": {},
    }


PROPS = ("cube", "table", "tree")
SPAWNABLES = {
    "person": "a person who walks 10 m ahead; person?goal_x=5&goal_y=3&speed=1.2 sets the goal [m] and the speed [m/s]",
    **{f"robot/{name}": "a robot that is commanded from outside" for name in builtin_robots()},
    **dict.fromkeys(PROPS, "a prop"),
}
"""Resources that can be added, with a line for people."""
SOURCE = "services"
"""Source of the orders of services."""
AHEAD = 10.0


def spawnables() -> dict[str, Any]:
    """Return the response of ``GetSpawnables``."""
    rows = [
        {"entity_resource": {"uri": uri, "resource_string": ""}, "description": about, "spawn_bounds": {}}
        for uri, about in SPAWNABLES.items()
    ]
    return result(spawnables=rows)


def spawn_order(
    request: Mapping[str, Any], simulation: Simulation, waiting: int
) -> tuple[Order | None, dict[str, Any]]:
    """Return the order of a ``SpawnEntity`` request, None with an error, and the response.

    Args:
        request: fields of the request.
        simulation: the simulation.
        waiting: number of people and robots whose orders wait.
    """
    try:
        return _checked_order(request, simulation, waiting)
    except SpawnError as error:
        return None, result(error.code, str(error), entity_name="")
    except InputError as error:
        return None, result(si.RESULT_OPERATION_FAILED, str(error), entity_name="")


class SpawnError(InputError):
    """An entity cannot be added, for a reason that the standard has a code for."""

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code


def _checked_order(
    request: Mapping[str, Any], simulation: Simulation, waiting: int
) -> tuple[Order | None, dict[str, Any]]:
    resource = request.get("entity_resource") or request
    uri, text = str(resource.get("uri") or ""), str(resource.get("resource_string") or "")
    if not uri and not text:
        raise SpawnError(si.SPAWN_ENTITY_NO_RESOURCE, "give a uri or a resource_string")
    name, space = str(request.get("name") or ""), str(request.get("entity_namespace") or "").strip("/")
    taken = {entity.name for entity in entities(simulation)}
    renames = bool(request.get("allow_renaming"))
    if name in taken and not renames:
        raise SpawnError(si.NAME_NOT_UNIQUE, f"there is an entity {name[:80]!r}")
    pose = _read_pose(request.get("initial_pose") or {})
    if uri:
        order, chosen = _order(uri, name, pose, simulation, waiting, taken)
    else:
        order, chosen = _element_order(text, simulation)
    if name and chosen != name and not renames:
        raise SpawnError(si.NAME_INVALID, f"the entity will be {chosen!r}: leave the name empty, or allow renaming")
    if space not in ("", chosen):
        raise SpawnError(si.NAMESPACE_INVALID, f"the topics of an entity are under its name, {chosen!r}")
    order.check(simulation)
    return order, result(si.RESULT_OK, entity_name=chosen)


def _read_pose(pose: Mapping[str, Any]) -> tuple[float, float, float]:
    frame = (pose.get("header") or {}).get("frame_id") or "map"
    if frame not in ("map", "world"):
        raise SpawnError(si.SPAWN_ENTITY_INVALID_POSE, f"the pose must be in the frame map, not {frame[:40]}")
    try:
        return *read_point(pose, "pose", "position"), read_heading(pose, "pose", "orientation")
    except InputError as error:
        raise SpawnError(si.SPAWN_ENTITY_INVALID_POSE, str(error)) from None


def _element_order(text: str, simulation: Simulation) -> tuple[Order, str]:
    """Return the order of an element, and its name, or the kind of element that it is."""
    order = AddElementOrder(xml=text, source=SOURCE)
    try:
        order.check(simulation)
    except InputError as error:
        raise SpawnError(si.SPAWN_ENTITY_RESOURCE_PARSE_ERROR, str(error)) from None
    head = re.search(r"<([A-Za-z][\w-]*)[^>]*", text)  # behind a declaration or comment
    name = re.search(r"""\bname\s*=\s*(["'])(.*?)\1""", head[0]) if head else None
    return order, name[2] if name else head[1] if head else "element"


def _order(
    uri: str, name: str, pose: tuple[float, float, float], simulation: Simulation, waiting: int, taken: set[str]
) -> tuple[Order, str]:
    x, y, heading = pose
    kind, _, query = uri.partition("?")
    if kind == "person":
        values = {key: _number(key, text) for key, text in urllib.parse.parse_qsl(query)}
        if unknown := {*values} - {"goal_x", "goal_y", "speed", "radius"}:
            raise InputError(f"a person has no {', '.join(sorted(unknown))[:80]}; it has goal_x, goal_y, speed, radius")
        goal = {"goal_x": x + AHEAD * math.cos(heading), "goal_y": y + AHEAD * math.sin(heading)}
        person: dict[str, Any] = {**goal, **values}
        number = next_person(simulation.world) + waiting
        return AddPersonOrder(x=x, y=y, source=SOURCE, **person), f"person_{number}"
    if kind in PROPS:
        xml = f'<{kind} x="{x!r}" y="{y!r}"{f" heading={chr(34)}{heading!r}{chr(34)}" if kind != "tree" else ""}/>'
        return AddElementOrder(xml=xml, parent="stage", source=SOURCE), name or kind
    if kind in SPAWNABLES:
        _check_bodies(simulation)
        base = name or kind.removeprefix("robot/")
        name = next(word for k in range(len(taken) + 2) if (word := base if k == 0 else f"{base}_{k}") not in taken)
        xml = (
            f"<robot name={quoteattr(name)} type={quoteattr(kind.removeprefix('robot/'))} x='{x!r}' y='{y!r}'"
            f" heading='{heading!r}'><goal x='{x!r}' y='{y!r}' tolerance='0.1'/><navigator type='external'/></robot>"
        )
        return AddElementOrder(xml=xml, source=SOURCE), name
    raise SpawnError(si.RESULT_NOT_FOUND, f"{uri[:80]!r} is not known; get_spawnables lists what can be added")


def _check_bodies(simulation: Simulation) -> None:
    try:
        simulation.world.body_scene()
    except InputError:
        raise InputError('a robot can be added to trials with bodies only: set bodies="limbs" in the trial') from None


def _number(key: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{key[:40]} = {text[:40]!r} must be a number") from None


MOST_TEXT = 1_000_000


def current_world(trial: Trial) -> dict[str, Any]:
    """Return the response of ``GetCurrentWorld``: the trial as XML."""
    return result(world=_world(trial.name, trial.about, {"uri": "", "resource_string": trial_xml(trial)}))


def available_worlds(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return the response of ``GetAvailableWorlds``: the built-in trials."""
    if (request.get("filter") or {}).get("tags"):
        return result(si.RESULT_FEATURE_UNSUPPORTED, "worlds have no tags", worlds=[])
    return result(worlds=[_world(name, "", {"uri": name, "resource_string": ""}) for name in builtin_trials()])


def load_world(request: Mapping[str, Any], folder: Path | None) -> tuple[Trial | None, dict[str, Any]]:
    """Return the trial of a ``LoadWorld`` request, None with an error, and the response.

    The URI is the name of a built-in trial, or of a trial file in the folder of the current trial; the text is a trial
    as XML, which cannot load files or code.

    Args:
        request: fields of the request; ``world_resource``, or ``uri`` and ``resource_string`` of older versions.
        folder: folder of the current trial; None: it has none.
    """
    resource = request.get("world_resource") or request
    uri, text = str(resource.get("uri") or ""), str(resource.get("resource_string") or "")
    try:
        if uri:
            trial = _load(uri, folder)
        elif text:
            if len(text) > MOST_TEXT:
                raise InputError(f"a trial has at most {MOST_TEXT} characters")
            trial = parse_trial(text.encode(), place="load_world", folder=None, trust=False)
        else:
            return None, result(si.LOAD_WORLD_NO_RESOURCE, "give a uri or a resource_string", world=_world("", "", {}))
        check_trial(trial, trial.seed)
    except InputError as error:
        return None, result(
            si.LOAD_WORLD_RESOURCE_PARSE_ERROR if text else si.RESULT_OPERATION_FAILED,
            str(error),
            world=_world("", "", {}),
        )
    return trial, result(si.RESULT_OK, world=_world(trial.name, trial.about, {"uri": uri, "resource_string": ""}))


def _load(uri: str, folder: Path | None) -> Trial:
    if uri in builtin_trials():
        return load_trial(uri)
    name = uri.removeprefix("file:")
    if folder is None or Path(name).name != name or not (folder / name).is_file():
        raise InputError(f"{uri[:80]!r} is neither a built-in trial nor a file in the folder of the current trial")
    return load_trial(folder / name)


def _world(name: str, about: str, resource: Mapping[str, Any]) -> dict[str, Any]:
    return {"name": name, "world_resource": dict(resource), "description": about, "tags": []}


FEATURES = (
    si.SPAWNING,
    si.DELETING,
    si.ENTITY_BOUNDS_BOX,
    si.ENTITY_CATEGORIES,
    si.SPAWNING_RESOURCE_STRING,
    si.ENTITY_STATE_GETTING,
    si.ENTITY_STATE_SETTING,
    si.ENTITY_INFO_GETTING,
    si.SPAWNABLES,
    si.SIMULATION_RESET,
    si.SIMULATION_RESET_SPAWNED,
    si.SIMULATION_STATE_GETTING,
    si.SIMULATION_STATE_SETTING,
    si.SIMULATION_STATE_PAUSE,
    si.STEP_SIMULATION_SINGLE,
    si.STEP_SIMULATION_MULTIPLE,
    si.WORLD_LOADING,
    si.WORLD_RESOURCE_STRING,
    si.WORLD_INFO_GETTING,
    si.AVAILABLE_WORLDS,
    si.SPAWNING_ENTITIES,
)
"""Supported features of ``simulation_interfaces/SimulatorFeatures``: all but a reset of time or state alone, named
poses, bounds of entities, convex bounds, tags, setting the description of an entity, the action of steps, and unloading
a world."""
SETS = ("set_pose", "set_twist", "set_acceleration")
MOST_STEPS = 10_000_000
ENDED = "the run has ended before the last step"

Response = dict[str, Any] | None
"""Fields of a response, None if it is given later."""


def answer_call(call: ServiceCall, simulation: Simulation, control: RunControl, inbox: Inbox) -> None:
    """Do what a call asks, and answer it, immediately or when it is done."""
    verb = getattr(Verbs(simulation, control, inbox, call.answer), call.service.rpartition("/")[2])
    try:
        response = verb(call.request if isinstance(call.request, Mapping) else {})
    except LookupError as error:
        response = result(si.RESULT_NOT_FOUND, str(error.args[0]) if error.args else "not found")
    except UnsupportedFeature as error:
        response = result(si.RESULT_FEATURE_UNSUPPORTED, str(error))
    except (InputError, AttributeError, TypeError, ValueError, OverflowError) as error:  # a request of a wrong shape
        response = result(si.RESULT_OPERATION_FAILED, str(error))
    if response is not None:
        call.answer(response)


class Verbs:
    """The services, one method each: fields of the request in, fields of the response out.

    Orders are applied at the current instant, before the next step, and recorded; a replay applies them again.

    Args:
        simulation: the simulation.
        control: state of its run.
        inbox: gets the orders.
        answer: receives a response that is given later.

    >>> from crowdbot.bridges.interface import RobotInterface
    >>> from crowdbot.trials import load_trial
    >>> trial = load_trial("frontal")
    >>> verbs = Verbs(Simulation(trial, 0), RunControl(), Inbox(RobotInterface.of(trial)), print)
    >>> verbs.get_entities({})["entities"]
    ['robot', 'person_0']
    """

    def __init__(
        self, simulation: Simulation, control: RunControl, inbox: Inbox, answer: Callable[[dict[str, Any]], None]
    ) -> None:
        self.simulation, self.control, self.inbox, self.answer = simulation, control, inbox, answer

    def get_simulator_features(self, request: Fields) -> Response:
        """Return the supported features."""
        about = f"crowdbot {versions()['version']}: orders are recorded, and a replay applies them again"
        return {"features": {"features": list(FEATURES), "spawn_formats": ["crowdbot"], "custom_info": about}}

    def get_simulation_state(self, request: Fields) -> Response:
        """Return whether the simulation plays."""
        return result(state={"state": self.control.state})

    def set_simulation_state(self, request: Fields) -> Response:
        """Play, pause, stop (begin again and pause) or quit."""
        wanted, control = request["state"]["state"], self.control
        if wanted == control.state:
            return result(si.ALREADY_IN_TARGET_STATE, "the simulation is in this state")
        if wanted not in (si.STATE_STOPPED, si.STATE_PLAYING, si.STATE_PAUSED, si.STATE_QUITTING):
            return result(si.RESULT_OPERATION_FAILED, f"there is no state {str(wanted)[:40]}")
        if control.steps and wanted != si.STATE_QUITTING:
            return result(si.RESULT_INCORRECT_STATE, "the simulation does the steps of step_simulation")
        if wanted == si.STATE_STOPPED:
            return self._restart(si.STATE_STOPPED)
        control.state = wanted
        return result()

    def step_simulation(self, request: Fields) -> Response:
        """Do steps while the simulation is paused; the response comes after the last one."""
        steps, control = request.get("steps", 1), self.control
        if control.state == si.STATE_PLAYING or control.steps:
            return result(si.RESULT_INCORRECT_STATE, "the simulation must be paused")
        if isinstance(steps, bool) or not isinstance(steps, int) or not 0 <= steps <= MOST_STEPS:
            return result(si.RESULT_OPERATION_FAILED, f"steps = {str(steps)[:40]} must be from 0 to {MOST_STEPS}")
        if steps == 0:
            return result()
        control.state, control.steps = si.STATE_PAUSED, steps
        control.stepped = lambda done: self.answer(result() if done else result(si.RESULT_OPERATION_FAILED, ENDED))
        return None

    def reset_simulation(self, request: Fields) -> Response:
        """Begin the trial again, as another episode; or remove what was added."""
        scope = request.get("scope", 0) or si.SCOPE_ALL
        if scope == si.SCOPE_SPAWNED:
            for entity in entities(self.simulation):  # others have left or were removed
                if entity.name in self.control.spawned:
                    self._delete(entity)
            self.control.spawned.clear()
            return result()
        if scope in (si.SCOPE_ALL, si.SCOPE_TIME | si.SCOPE_STATE | si.SCOPE_SPAWNED):
            return self._restart(self.control.state)
        return result(
            si.RESULT_FEATURE_UNSUPPORTED,
            "time and state are reset together with everything else: use scope 0, 4 or 255",
        )

    def spawn_entity(self, request: Fields) -> Response:
        """Add a person, a robot or a prop."""
        waiting = [self.inbox.count_orders(AddPersonOrder), self.inbox.count_orders(AddElementOrder, "<robot")]
        order, response = spawn_order(request, self.simulation, sum(waiting))
        if order is not None:
            self._add(order)
            if isinstance(order, AddPersonOrder) or "<robot" in getattr(order, "xml", ""):
                self.control.spawned.append(response["entity_name"])
        return response

    def spawn_entities(self, request: Fields) -> Response:
        """Add several entities; some can fail."""
        rows = [self.spawn_entity(item) or {} for item in request["spawn_requests"]]
        failed = any(row["result"]["result"] != si.RESULT_OK for row in rows)
        if failed:
            return result(si.ENTITIES_SPAWN_FAILED, "not all were added", results=rows)
        return result(results=rows)

    def delete_entity(self, request: Fields) -> Response:
        """Remove a person or robot."""
        entity = entity_of(self.simulation, request.get("entity", request.get("name")))
        self._delete(entity)
        if entity.name in self.control.spawned:
            self.control.spawned.remove(entity.name)
        return result()

    def get_entities(self, request: Fields) -> Response:
        """Return the names of robots and people."""
        return result(
            entities=[entity.name for entity in filter_entities(self.simulation, request.get("filters") or {})]
        )

    def get_entities_states(self, request: Fields) -> Response:
        """Return the names, poses and velocities of robots and people."""
        found = filter_entities(self.simulation, request.get("filters") or {})
        states = [state_of_entity(self.simulation, one) for one in found]
        return result(entities=[one.name for one in found], states=states)

    def get_entity_state(self, request: Fields) -> Response:
        """Return the pose and velocity of a robot or person."""
        return result(state=state_of_entity(self.simulation, self._entity(request)))

    def get_entity_info(self, request: Fields) -> Response:
        """Return the category of a robot or person."""
        entity = self._entity(request)
        about = "robot" if entity.category == si.CATEGORY_ROBOT else "person"
        return result(info={"category": {"category": entity.category}, "description": about, "tags": []})

    def set_entity_state(self, request: Fields) -> Response:
        """Move a robot or person to another pose, at rest, or let it rest where it is.

        A request without the flags of version 2.1 sets the pose. Accelerations are ignored, as the standard allows.
        """
        entity, state = self._entity(request), request["state"]
        pose, twist, _ = (bool(request.get(name, name == SETS[0])) for name in SETS)
        frame = (state.get("header") or {}).get("frame_id") or "map"
        if frame not in ("map", "world"):
            return result(si.RESULT_FEATURE_UNSUPPORTED, f"the pose must be in the frame map, not {str(frame)[:40]}")
        parts = [("twist", kind, axis) for kind in ("linear", "angular") for axis in "xyz"]
        if twist and any(read_number(state, *part) for part in parts):
            return result(si.RESULT_FEATURE_UNSUPPORTED, "a robot or person can be set to rest, to no other velocity")
        if not (pose or twist):
            return result(si.RESULT_OPERATION_FAILED, "nothing is set: set_pose and set_twist are false")
        try:
            now = state_of_entity(self.simulation, entity)
            x, y = read_point(state if pose else now, "pose", "position")
            heading = read_heading(state if pose else now, "pose", "orientation")
            self._add(MoveOrder(person=entity.number, x=x, y=y, heading=heading, source=SOURCE))
        except InputError as error:
            return result(si.SET_ENTITY_STATE_INVALID_POSE, str(error))
        return result()

    def get_spawnables(self, request: Fields) -> Response:
        """Return what can be added."""
        return spawnables()

    def load_world(self, request: Fields) -> Response:
        """Run another trial, as another episode, which begins paused."""
        trial, response = load_world(request, self.simulation.trial.folder)
        if trial is None:
            return response
        self.control.restart, self.control.state = trial, si.STATE_STOPPED
        self.control.restarted = lambda problem: self._answer_restart(problem, response)
        return None

    def get_current_world(self, request: Fields) -> Response:
        """Return the trial."""
        return current_world(self.simulation.trial)

    def get_available_worlds(self, request: Fields) -> Response:
        """Return the built-in trials."""
        return available_worlds(request)

    def _entity(self, request: Fields) -> Entity:
        return entity_of(self.simulation, request.get("entity", request.get("name")))

    def _restart(self, state: int) -> Response:
        self.control.restart, self.control.state = self.control.begun or self.simulation.trial, state
        self.control.restarted = lambda problem: self._answer_restart(problem, result())
        return None

    def _answer_restart(self, problem: str, response: dict[str, Any]) -> None:
        self.answer(result(si.RESULT_OPERATION_FAILED, problem) if problem else response)

    def _delete(self, entity: Entity) -> None:
        if entity.category == si.CATEGORY_ROBOT:
            self._add(RemoveElementOrder(path=f"robot[{entity.name}]", source=SOURCE))
        else:
            self._add(RemoveOrder(person=entity.number, source=SOURCE))

    def _add(self, order: Order) -> None:
        order.check(self.simulation)
        self.inbox.add(order)


@dataclass(frozen=True)
class PlainService:
    """A service that calls a service of the port.

    Fields:
        kind: ``Empty`` or ``Trigger`` of ``std_srvs``.
        verb: the last part of the name of the service of the port.
        request: fields of its request.
        about: one line for people.
    """

    kind: str
    verb: str
    request: Mapping[str, Any]
    about: str

    def call(self, inbox: Inbox, answer: Callable[[str], None], sender: str) -> None:
        """Ask the simulation; ``answer`` later gets an empty text, or the problem.

        Raises:
            InputError: the run has ended, or too many calls wait.
        """

        def read(response: Mapping[str, Any]) -> None:
            result = response["result"]
            done = result["result"] in (si.RESULT_OK, si.ALREADY_IN_TARGET_STATE)
            answer("" if done else str(result["error_message"]) or "refused")

        inbox.call(f"/crowdbot/{self.verb}", self.request, read, sender)


PLAIN_SERVICES = {
    "/crowdbot/pause": PlainService("Empty", "set_simulation_state", {"state": {"state": si.STATE_PAUSED}}, "pause"),
    "/crowdbot/unpause": PlainService("Empty", "set_simulation_state", {"state": {"state": si.STATE_PLAYING}}, "go on"),
    "/crowdbot/reset": PlainService("Empty", "reset_simulation", {}, "begin the trial again, as another episode"),
    "/crowdbot/step": PlainService("Trigger", "step_simulation", {"steps": 1}, "one step while paused"),
}
"""The services by their name."""
