"""Types of ``simulation_interfaces`` 2.1.0 (``python tools/simulation_interfaces.py``).

Source: https://github.com/ros-simulation/simulation_interfaces (Apache License 2.0). Do not edit.
"""

MESSAGE_TYPES = {
    "Bounds": """\
uint8 TYPE_EMPTY = 0
uint8 TYPE_BOX = 1
uint8 TYPE_CONVEX_HULL = 2
uint8 TYPE_SPHERE = 3
uint8 type
geometry_msgs/Vector3[] points
""",
    "EntityCategory": """\
uint8 CATEGORY_OBJECT = 0
uint8 CATEGORY_ROBOT = 1
uint8 CATEGORY_HUMAN = 2
uint8 CATEGORY_DYNAMIC_OBJECT = 4
uint8 CATEGORY_STATIC_OBJECT = 5
uint8 category
""",
    "EntityFilters": """\
string filter
EntityCategory[] categories
TagsFilter tags
Bounds bounds
""",
    "EntityInfo": """\
EntityCategory category
string description
string[] tags
""",
    "EntityState": """\
std_msgs/Header header
geometry_msgs/Pose pose
geometry_msgs/Twist twist
geometry_msgs/Accel acceleration
""",
    "NamedPose": """\
string name
string description
string[] tags
geometry_msgs/Pose pose
""",
    "Resource": """\
string uri
string resource_string
""",
    "Result": """\
uint8 RESULT_FEATURE_UNSUPPORTED = 0
uint8 RESULT_OK = 1
uint8 RESULT_NOT_FOUND = 2
uint8 RESULT_INCORRECT_STATE = 3
uint8 RESULT_OPERATION_FAILED = 4
uint8 result
string error_message
""",
    "SimulationState": """\
uint8 STATE_STOPPED = 0
uint8 STATE_PLAYING = 1
uint8 STATE_PAUSED = 2
uint8 STATE_QUITTING = 3
uint8 STATE_NO_WORLD = 4
uint8 STATE_LOADING_WORLD = 5
uint8 state
""",
    "SimulatorFeatures": """\
uint8 SPAWNING = 0
uint8 DELETING = 1
uint8 NAMED_POSES = 2
uint8 POSE_BOUNDS = 3
uint8 ENTITY_TAGS = 4
uint8 ENTITY_BOUNDS = 5
uint8 ENTITY_BOUNDS_BOX = 6
uint8 ENTITY_BOUNDS_CONVEX = 7
uint8 ENTITY_CATEGORIES = 8
uint8 SPAWNING_RESOURCE_STRING = 9
uint8 ENTITY_STATE_GETTING = 10
uint8 ENTITY_STATE_SETTING = 11
uint8 ENTITY_INFO_GETTING = 12
uint8 ENTITY_INFO_SETTING = 13
uint8 SPAWNABLES = 14
uint8 SIMULATION_RESET = 20
uint8 SIMULATION_RESET_TIME = 21
uint8 SIMULATION_RESET_STATE = 22
uint8 SIMULATION_RESET_SPAWNED = 23
uint8 SIMULATION_STATE_GETTING = 24
uint8 SIMULATION_STATE_SETTING = 25
uint8 SIMULATION_STATE_PAUSE = 26
uint8 STEP_SIMULATION_SINGLE = 31
uint8 STEP_SIMULATION_MULTIPLE = 32
uint8 STEP_SIMULATION_ACTION = 33
uint8 WORLD_LOADING = 40
uint8 WORLD_RESOURCE_STRING = 41
uint8 WORLD_TAGS = 42
uint8 WORLD_UNLOADING = 43
uint8 WORLD_INFO_GETTING = 44
uint8 AVAILABLE_WORLDS = 45
uint8 SPAWNING_ENTITIES = 50
uint16[] features
string[] spawn_formats
string custom_info
""",
    "SpawnEntity": """\
string name
bool allow_renaming
Resource entity_resource
string entity_namespace
geometry_msgs/PoseStamped initial_pose
""",
    "SpawnResult": """\
uint8 NAME_NOT_UNIQUE = 101
uint8 NAME_INVALID = 102
uint8 UNSUPPORTED_FORMAT = 103
uint8 NO_RESOURCE = 104
uint8 NAMESPACE_INVALID = 105
uint8 RESOURCE_PARSE_ERROR = 106
uint8 MISSING_ASSETS = 107
uint8 UNSUPPORTED_ASSETS = 108
uint8 INVALID_POSE = 109
Result result
string entity_name
""",
    "Spawnable": """\
Resource entity_resource
string description
Bounds spawn_bounds
""",
    "TagsFilter": """\
string[] tags
uint8 FILTER_MODE_ANY = 0
uint8 FILTER_MODE_ALL = 1
uint8 filter_mode
""",
    "WorldResource": """\
string name
Resource world_resource
string description
string[] tags
""",
}
"""Definitions of the messages by the name of their type."""

SERVICE_TYPES = {
    "DeleteEntity": """\
string entity
---
Result result
""",
    "GetAvailableWorlds": """\
string[] additional_sources
TagsFilter filter
bool offline_only
bool continue_on_error
---
uint8 DEFAULT_SOURCES_FAILED = 101
Result result
WorldResource[] worlds
""",
    "GetCurrentWorld": """\
---
uint8 NO_WORLD_LOADED = 101
Result result
WorldResource world
""",
    "GetEntities": """\
EntityFilters filters
---
Result result
string[] entities
""",
    "GetEntitiesStates": """\
EntityFilters filters
---
Result result
string[] entities
EntityState[] states
""",
    "GetEntityBounds": """\
string entity
---
Result result
Bounds bounds
""",
    "GetEntityInfo": """\
string entity
---
Result result
EntityInfo info
""",
    "GetEntityState": """\
string entity
---
Result result
EntityState state
""",
    "GetNamedPoseBounds": """\
string name
---
Result result
Bounds bounds
""",
    "GetNamedPoses": """\
TagsFilter tags
---
Result result
NamedPose[] poses
""",
    "GetSimulationState": """\
---
SimulationState state
Result result
""",
    "GetSimulatorFeatures": """\
---
SimulatorFeatures features
""",
    "GetSpawnables": """\
string[] sources
---
Result result
Spawnable[] spawnables
""",
    "LoadWorld": """\
Resource world_resource
bool fail_on_unsupported_element
bool ignore_missing_or_unsupported_assets
---
uint8 UNSUPPORTED_FORMAT = 101
uint8 NO_RESOURCE = 102
uint8 RESOURCE_PARSE_ERROR = 103
uint8 MISSING_ASSETS = 104
uint8 UNSUPPORTED_ASSETS = 105
uint8 UNSUPPORTED_ELEMENTS = 106
Result result
WorldResource world
""",
    "ResetSimulation": """\
uint8 SCOPE_DEFAULT = 0
uint8 SCOPE_TIME = 1
uint8 SCOPE_STATE = 2
uint8 SCOPE_SPAWNED = 4
uint8 SCOPE_ALL = 255
uint8 scope
---
Result result
""",
    "SetEntityInfo": """\
string entity
EntityInfo info
---
Result result
""",
    "SetEntityState": """\
string entity
EntityState state
bool set_pose
bool set_twist
bool set_acceleration
---
uint8 INVALID_POSE = 101
Result result
""",
    "SetSimulationState": """\
SimulationState state
---
uint8 ALREADY_IN_TARGET_STATE = 101
uint8 STATE_TRANSITION_ERROR = 102
uint8 INCORRECT_TRANSITION = 103
Result result
""",
    "SpawnEntities": """\
SpawnEntity[] spawn_requests
---
uint8 ENTITIES_SPAWN_FAILED = 150
Result result
SpawnResult[] results
""",
    "SpawnEntity": """\
string name
bool allow_renaming
Resource entity_resource
string entity_namespace
geometry_msgs/PoseStamped initial_pose
---
uint8 NAME_NOT_UNIQUE = 101
uint8 NAME_INVALID = 102
uint8 UNSUPPORTED_FORMAT = 103
uint8 NO_RESOURCE = 104
uint8 NAMESPACE_INVALID = 105
uint8 RESOURCE_PARSE_ERROR = 106
uint8 MISSING_ASSETS = 107
uint8 UNSUPPORTED_ASSETS = 108
uint8 INVALID_POSE = 109
Result result
string entity_name
""",
    "StepSimulation": """\
uint64 steps 1
---
Result result
""",
    "UnloadWorld": """\
---
uint8 NO_WORLD_LOADED = 101
Result result
""",
}
"""Definitions of the services, request and response, by the name of their type."""

TYPE_EMPTY = 0
TYPE_BOX = 1
TYPE_CONVEX_HULL = 2
TYPE_SPHERE = 3
CATEGORY_OBJECT = 0
CATEGORY_ROBOT = 1
CATEGORY_HUMAN = 2
CATEGORY_DYNAMIC_OBJECT = 4
CATEGORY_STATIC_OBJECT = 5
RESULT_FEATURE_UNSUPPORTED = 0
RESULT_OK = 1
RESULT_NOT_FOUND = 2
RESULT_INCORRECT_STATE = 3
RESULT_OPERATION_FAILED = 4
STATE_STOPPED = 0
STATE_PLAYING = 1
STATE_PAUSED = 2
STATE_QUITTING = 3
STATE_NO_WORLD = 4
STATE_LOADING_WORLD = 5
SPAWNING = 0
DELETING = 1
NAMED_POSES = 2
POSE_BOUNDS = 3
ENTITY_TAGS = 4
ENTITY_BOUNDS = 5
ENTITY_BOUNDS_BOX = 6
ENTITY_BOUNDS_CONVEX = 7
ENTITY_CATEGORIES = 8
SPAWNING_RESOURCE_STRING = 9
ENTITY_STATE_GETTING = 10
ENTITY_STATE_SETTING = 11
ENTITY_INFO_GETTING = 12
ENTITY_INFO_SETTING = 13
SPAWNABLES = 14
SIMULATION_RESET = 20
SIMULATION_RESET_TIME = 21
SIMULATION_RESET_STATE = 22
SIMULATION_RESET_SPAWNED = 23
SIMULATION_STATE_GETTING = 24
SIMULATION_STATE_SETTING = 25
SIMULATION_STATE_PAUSE = 26
STEP_SIMULATION_SINGLE = 31
STEP_SIMULATION_MULTIPLE = 32
STEP_SIMULATION_ACTION = 33
WORLD_LOADING = 40
WORLD_RESOURCE_STRING = 41
WORLD_TAGS = 42
WORLD_UNLOADING = 43
WORLD_INFO_GETTING = 44
AVAILABLE_WORLDS = 45
SPAWNING_ENTITIES = 50
NAME_NOT_UNIQUE = 101
NAME_INVALID = 102
SPAWN_ENTITY_UNSUPPORTED_FORMAT = 103
SPAWN_ENTITY_NO_RESOURCE = 104
NAMESPACE_INVALID = 105
SPAWN_ENTITY_RESOURCE_PARSE_ERROR = 106
SPAWN_ENTITY_MISSING_ASSETS = 107
SPAWN_ENTITY_UNSUPPORTED_ASSETS = 108
SPAWN_ENTITY_INVALID_POSE = 109
SPAWN_RESULT_UNSUPPORTED_FORMAT = 103
SPAWN_RESULT_NO_RESOURCE = 104
SPAWN_RESULT_RESOURCE_PARSE_ERROR = 106
SPAWN_RESULT_MISSING_ASSETS = 107
SPAWN_RESULT_UNSUPPORTED_ASSETS = 108
SPAWN_RESULT_INVALID_POSE = 109
FILTER_MODE_ANY = 0
FILTER_MODE_ALL = 1
DEFAULT_SOURCES_FAILED = 101
NO_WORLD_LOADED = 101
LOAD_WORLD_UNSUPPORTED_FORMAT = 101
LOAD_WORLD_NO_RESOURCE = 102
LOAD_WORLD_RESOURCE_PARSE_ERROR = 103
LOAD_WORLD_MISSING_ASSETS = 104
LOAD_WORLD_UNSUPPORTED_ASSETS = 105
UNSUPPORTED_ELEMENTS = 106
SCOPE_DEFAULT = 0
SCOPE_TIME = 1
SCOPE_STATE = 2
SCOPE_SPAWNED = 4
SCOPE_ALL = 255
SET_ENTITY_STATE_INVALID_POSE = 101
ALREADY_IN_TARGET_STATE = 101
STATE_TRANSITION_ERROR = 102
INCORRECT_TRANSITION = 103
ENTITIES_SPAWN_FAILED = 150
