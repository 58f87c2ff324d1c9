"""Verbs: what the services of a port do with a simulation."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

from crowdbot.bridges.commands import read_heading, read_number, read_point
from crowdbot.bridges.inbox import Inbox, ServiceCall
from crowdbot.bridges.run_control import PAUSED, PLAYING, QUITTING, STOPPED, RunControl
from crowdbot.core import InputError
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

from .entities import ROBOT, Entity, entities, entity_of, filter_entities, state_of_entity
from .results import FAILED, INCORRECT_STATE, NOT_FOUND, OK, UNSUPPORTED, UnsupportedFeature, result
from .spawning import SOURCE, spawn_order, spawnables

NO_RESOURCE, PARSE_ERROR = 102, 103
MOST_TEXT = 1_000_000


def current_world(trial: Trial) -> dict[str, Any]:
    """Return the response of ``GetCurrentWorld``: the trial as XML."""
    return result(world=_world(trial.name, trial.about, {"uri": "", "resource_string": trial_xml(trial)}))


def available_worlds(request: Mapping[str, Any]) -> dict[str, Any]:
    """Return the response of ``GetAvailableWorlds``: the built-in trials."""
    if (request.get("filter") or {}).get("tags"):
        return result(UNSUPPORTED, "worlds have no tags", worlds=[])
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
            return None, result(NO_RESOURCE, "give a uri or a resource_string", world=_world("", "", {}))
        check_trial(trial, trial.seed)
    except InputError as error:
        return None, result(PARSE_ERROR if text else FAILED, str(error), world=_world("", "", {}))
    return trial, result(OK, world=_world(trial.name, trial.about, {"uri": uri, "resource_string": ""}))


def _load(uri: str, folder: Path | None) -> Trial:
    if uri in builtin_trials():
        return load_trial(uri)
    name = uri.removeprefix("file:")
    if folder is None or Path(name).name != name or not (folder / name).is_file():
        raise InputError(f"{uri[:80]!r} is neither a built-in trial nor a file in the folder of the current trial")
    return load_trial(folder / name)


def _world(name: str, about: str, resource: Mapping[str, Any]) -> dict[str, Any]:
    return {"name": name, "world_resource": dict(resource), "description": about, "tags": []}


FEATURES = (0, 1, 6, 8, 9, 10, 11, 12, 14, 20, 21, 22, 23, 24, 25, 26, 31, 32, 40, 41, 44, 45, 50)
"""Supported features of ``simulation_interfaces/SimulatorFeatures``: all but named poses, bounds of entities, convex
bounds, tags, setting the description of an entity, the action of steps, and unloading a world."""
TIME, STATE, SPAWNED, ALL = 1, 2, 4, 255
INVALID_POSE, SPAWN_FAILED = 101, 150
"""Results of ``SetEntityState`` and ``SpawnEntities``."""
SETS = ("set_pose", "set_twist", "set_acceleration")
MOST_STEPS = 10_000_000
ENDED = "the run has ended before the last step"

Fields = Mapping[str, Any]
Response = dict[str, Any] | None
"""Fields of a response, None if it is given later."""


def answer_call(call: ServiceCall, simulation: Simulation, control: RunControl, inbox: Inbox) -> None:
    """Do what a call asks, and answer it, immediately or when it is done."""
    verb = getattr(Verbs(simulation, control, inbox, call.answer), call.service.rpartition("/")[2])
    try:
        response = verb(call.request if isinstance(call.request, Mapping) else {})
    except LookupError as error:
        response = result(NOT_FOUND, str(error.args[0]) if error.args else "not found")
    except UnsupportedFeature as error:
        response = result(UNSUPPORTED, str(error))
    except (InputError, AttributeError, TypeError, ValueError, OverflowError) as error:  # a request of a wrong shape
        response = result(FAILED, str(error))
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
            return result(101, "the simulation is in this state")
        if wanted not in (STOPPED, PLAYING, PAUSED, QUITTING):
            return result(FAILED, f"there is no state {str(wanted)[:40]}")
        if control.steps and wanted != QUITTING:
            return result(INCORRECT_STATE, "the simulation does the steps of step_simulation")
        if wanted == STOPPED:
            return self._restart(STOPPED)
        control.state = wanted
        return result()

    def step_simulation(self, request: Fields) -> Response:
        """Do steps while the simulation is paused; the response comes after the last one."""
        steps, control = request.get("steps", 1), self.control
        if control.state == PLAYING or control.steps:
            return result(INCORRECT_STATE, "the simulation must be paused")
        if isinstance(steps, bool) or not isinstance(steps, int) or not 0 <= steps <= MOST_STEPS:
            return result(FAILED, f"steps = {str(steps)[:40]} must be from 0 to {MOST_STEPS}")
        if steps == 0:
            return result()
        control.state, control.steps = PAUSED, steps
        control.stepped = lambda done: self.answer(result() if done else result(FAILED, ENDED))
        return None

    def reset_simulation(self, request: Fields) -> Response:
        """Begin the trial again, as another episode; or remove what was added."""
        scope = request.get("scope", 0) or ALL
        if scope == SPAWNED:
            for entity in entities(self.simulation):  # others have left or were removed
                if entity.name in self.control.spawned:
                    self._delete(entity)
            self.control.spawned.clear()
            return result()
        if scope in (ALL, TIME | STATE | SPAWNED):
            return self._restart(self.control.state)
        return result(UNSUPPORTED, "time and state are reset together with everything else: use scope 0, 4 or 255")

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
        rows = [self.spawn_entity(one) or {} for one in request["spawn_requests"]]
        failed = any(row["result"]["result"] != OK for row in rows)
        return result(SPAWN_FAILED if failed else OK, "not all were added" if failed else "", results=rows)

    def delete_entity(self, request: Fields) -> Response:
        """Remove a person or robot."""
        entity = entity_of(self.simulation, request.get("entity", request.get("name")))
        self._delete(entity)
        if entity.name in self.control.spawned:
            self.control.spawned.remove(entity.name)
        return result()

    def get_entities(self, request: Fields) -> Response:
        """Return the names of robots and people."""
        return result(entities=[one.name for one in filter_entities(self.simulation, request.get("filters") or {})])

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
        about = "robot" if entity.category == ROBOT else "person"
        return result(info={"category": {"category": entity.category}, "description": about, "tags": []})

    def set_entity_state(self, request: Fields) -> Response:
        """Move a robot or person to another pose, at rest, or let it rest where it is.

        A request without the flags of version 2.1 sets the pose. Accelerations are ignored, as the standard allows.
        """
        entity, state = self._entity(request), request["state"]
        pose, twist, _ = (bool(request.get(name, name == SETS[0])) for name in SETS)
        frame = (state.get("header") or {}).get("frame_id") or "map"
        if frame not in ("map", "world"):
            return result(UNSUPPORTED, f"the pose must be in the frame map, not {str(frame)[:40]}")
        parts = [("twist", kind, axis) for kind in ("linear", "angular") for axis in "xyz"]
        if twist and any(read_number(state, *part) for part in parts):
            return result(UNSUPPORTED, "a robot or person can be set to rest, to no other velocity")
        if not (pose or twist):
            return result(FAILED, "nothing is set: set_pose and set_twist are false")
        try:
            now = state_of_entity(self.simulation, entity)
            x, y = read_point(state if pose else now, "pose", "position")
            heading = read_heading(state if pose else now, "pose", "orientation")
            self._add(MoveOrder(person=entity.number, x=x, y=y, heading=heading, source=SOURCE))
        except InputError as error:
            return result(INVALID_POSE, str(error))
        return result()

    def get_spawnables(self, request: Fields) -> Response:
        """Return what can be added."""
        return spawnables()

    def load_world(self, request: Fields) -> Response:
        """Run another trial, as another episode, which begins paused."""
        trial, response = load_world(request, self.simulation.trial.folder)
        if trial is None:
            return response
        self.control.restart, self.control.state = trial, STOPPED
        self.control.restarted = lambda problem: self.answer(result(FAILED, problem) if problem else response)
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
        self.control.restarted = lambda problem: self.answer(result(FAILED, problem) if problem else result())
        return None

    def _delete(self, entity: Entity) -> None:
        if entity.category == ROBOT:
            self._add(RemoveElementOrder(path=f"robot[{entity.name}]", source=SOURCE))
        else:
            self._add(RemoveOrder(person=entity.number, source=SOURCE))

    def _add(self, order: Order) -> None:
        order.check(self.simulation)
        self.inbox.add(order)
