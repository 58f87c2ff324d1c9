"""Types of the services of ``simulation_interfaces`` 2.1.0, the ROS 2 standard for the control of simulators."""

from __future__ import annotations

import functools
from dataclasses import dataclass
from typing import Any

from rosbags.typesys import get_types_from_msg

from crowdbot.messages import Messages

PACKAGE = "simulation_interfaces"

MESSAGES = {
    "Result": "uint8 result\nstring error_message\n",
    "SimulatorFeatures": "uint16[] features\nstring[] spawn_formats\nstring custom_info\n",
    "SimulationState": "uint8 state\n",
    "Resource": "string uri\nstring resource_string\n",
    "WorldResource": "string name\nsimulation_interfaces/Resource world_resource\nstring description\nstring[] tags\n",
    "EntityState": (
        "std_msgs/Header header\ngeometry_msgs/Pose pose\ngeometry_msgs/Twist twist\ngeometry_msgs/Accel acceleration\n"
    ),
    "EntityCategory": "uint8 category\n",
    "EntityInfo": "simulation_interfaces/EntityCategory category\nstring description\nstring[] tags\n",
    "Bounds": "uint8 type\ngeometry_msgs/Vector3[] points\n",
    "TagsFilter": "string[] tags\nuint8 filter_mode\n",
    "EntityFilters": (
        "string filter\nsimulation_interfaces/EntityCategory[] categories\nsimulation_interfaces/TagsFilter tags\n"
        "simulation_interfaces/Bounds bounds\n"
    ),
    "Spawnable": (
        "simulation_interfaces/Resource entity_resource\nstring description\n"
        "simulation_interfaces/Bounds spawn_bounds\n"
    ),
    "SpawnEntity": (
        "string name\nbool allow_renaming\nsimulation_interfaces/Resource entity_resource\n"
        "string entity_namespace\ngeometry_msgs/PoseStamped initial_pose\n"
    ),
    "SpawnResult": "simulation_interfaces/Result result\nstring entity_name\n",
}
"""Message types, without their constants."""


@dataclass(frozen=True)
class ServiceDefinition:
    """A service type.

    Fields:
        kind: name, such as ``StepSimulation``.
        request, response: definitions of its messages.
        about: one line for people.
    """

    kind: str
    request: str
    response: str
    about: str


RESULT = "simulation_interfaces/Result result\n"
FILTERS = "simulation_interfaces/EntityFilters filters\n"
STATE = "simulation_interfaces/EntityState state\n"
SPAWN = MESSAGES["SpawnEntity"]

SERVICES = {
    "get_simulator_features": ServiceDefinition(
        "GetSimulatorFeatures", "", "simulation_interfaces/SimulatorFeatures features\n", "supported features"
    ),
    "get_simulation_state": ServiceDefinition(
        "GetSimulationState", "", "simulation_interfaces/SimulationState state\n" + RESULT, "playing or paused"
    ),
    "set_simulation_state": ServiceDefinition(
        "SetSimulationState", "simulation_interfaces/SimulationState state\n", RESULT, "play, pause, stop or quit"
    ),
    "step_simulation": ServiceDefinition("StepSimulation", "uint64 steps\n", RESULT, "steps while paused"),
    "reset_simulation": ServiceDefinition("ResetSimulation", "uint8 scope\n", RESULT, "begin the trial again"),
    "spawn_entity": ServiceDefinition("SpawnEntity", SPAWN, RESULT + "string entity_name\n", "add an entity"),
    "spawn_entities": ServiceDefinition(
        "SpawnEntities",
        "simulation_interfaces/SpawnEntity[] spawn_requests\n",
        RESULT + "simulation_interfaces/SpawnResult[] results\n",
        "add entities",
    ),
    "delete_entity": ServiceDefinition("DeleteEntity", "string entity\n", RESULT, "remove a person or robot"),
    "get_entities": ServiceDefinition("GetEntities", FILTERS, RESULT + "string[] entities\n", "names of entities"),
    "get_entities_states": ServiceDefinition(
        "GetEntitiesStates",
        FILTERS,
        RESULT + "string[] entities\nsimulation_interfaces/EntityState[] states\n",
        "poses and velocities",
    ),
    "get_entity_state": ServiceDefinition(
        "GetEntityState", "string entity\n", RESULT + STATE, "pose and velocity of an entity"
    ),
    "set_entity_state": ServiceDefinition(
        "SetEntityState",
        "string entity\n" + STATE + "bool set_pose\nbool set_twist\nbool set_acceleration\n",
        RESULT,
        "move a person or robot",
    ),
    "get_entity_info": ServiceDefinition(
        "GetEntityInfo", "string entity\n", RESULT + "simulation_interfaces/EntityInfo info\n", "category of an entity"
    ),
    "get_spawnables": ServiceDefinition(
        "GetSpawnables",
        "string[] sources\n",
        RESULT + "simulation_interfaces/Spawnable[] spawnables\n",
        "what can be added",
    ),
    "load_world": ServiceDefinition(
        "LoadWorld",
        "simulation_interfaces/Resource world_resource\nbool fail_on_unsupported_element\n"
        "bool ignore_missing_or_unsupported_assets\n",
        RESULT + "simulation_interfaces/WorldResource world\n",
        "run another trial",
    ),
    "get_current_world": ServiceDefinition(
        "GetCurrentWorld", "", RESULT + "simulation_interfaces/WorldResource world\n", "the trial"
    ),
    "get_available_worlds": ServiceDefinition(
        "GetAvailableWorlds",
        "string[] additional_sources\nsimulation_interfaces/TagsFilter filter\nbool offline_only\n"
        "bool continue_on_error\n",
        RESULT + "simulation_interfaces/WorldResource[] worlds\n",
        "trials that can be loaded",
    ),
}
"""Services by the last part of their name."""


def request_kind(service: ServiceDefinition) -> str:
    """Return the message type of the requests of a service in the store.

    >>> request_kind(SERVICES["step_simulation"])
    'simulation_interfaces/msg/StepSimulation_Request'
    """
    return f"{PACKAGE}/msg/{service.kind}_Request"


def response_kind(service: ServiceDefinition) -> str:
    """Return the message type of the responses of a service in the store."""
    return f"{PACKAGE}/msg/{service.kind}_Response"


@functools.cache
def interface_store() -> Any:
    """Return the message library of rosbags with the types of this file.

    >>> interface_store().types["simulation_interfaces/msg/StepSimulation_Request"](steps=3).steps
    3
    """
    store = Messages().store
    for name, text in MESSAGES.items():
        store.register(get_types_from_msg(text, f"{PACKAGE}/msg/{name}"))
    for service in SERVICES.values():
        store.register(get_types_from_msg(service.request or "\n", request_kind(service)))
        store.register(get_types_from_msg(service.response, response_kind(service)))
    return store
