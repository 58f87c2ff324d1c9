"""RobotInterface: the topics and services of a trial, with types, quality of service and the commands in messages."""

from __future__ import annotations

import dataclasses
import functools
import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeGuard

import numpy as np
from rosbags.typesys import get_types_from_msg

from crowdbot.core import InputError
from crowdbot.messages import COLLISIONS, FALL_POSES, FALLS, FORCES, MAP, MARKERS, Messages, reading_topics
from crowdbot.recording import LinkFrames
from crowdbot.simulation import GoalOrder, JointOrder, Order, VelocityOrder, read_order
from crowdbot.trials import RobotSpec, Trial

from .joint_trajectory import JointTrajectory
from .simulation_interfaces import MESSAGE_TYPES, SERVICE_TYPES


@dataclass(frozen=True)
class QualityOfService:
    """Delivery of a topic.

    Fields:
        name: name of the class in tables.
        reliable: whether lost messages are sent again; a reliable subscriber does not match a best-effort topic.
        latched: whether a late subscriber gets the latest message (``transient local`` in ROS 2).
        depth: number of messages that are kept for a subscriber.

    >>> SENSOR.reliable, LATCHED.latched
    (False, True)
    """

    name: str
    reliable: bool
    latched: bool
    depth: int


SENSOR = QualityOfService("sensor", False, False, 5)
"""Readings, as ``rmw_qos_profile_sensor_data``."""
CLOCK = QualityOfService("clock", True, False, 1)
"""The clock: reliable, so that both kinds of subscribers match."""
TF = QualityOfService("tf", True, False, 100)
"""Transforms that move."""
LATCHED = QualityOfService("latched", True, True, 1)
"""What is sent once: the map, fixed transforms, descriptions of robots."""
STATE = QualityOfService("state", True, False, 10)
"""Odometry, joints, people, contacts, orders."""
COMMAND = QualityOfService("command", True, False, 10)
"""Commands to the robot; a best-effort publisher does not match. The newest counts, but none is lost on the way."""
QUALITIES = (SENSOR, CLOCK, TF, LATCHED, STATE, COMMAND)


Fields = Mapping[str, Any]
Request = Order | JointTrajectory
"""What a message asks of the simulation; a trajectory becomes one order for each joint and step."""
MOST_JOINTS, MOST_POINTS = 200, 1000
LONGEST_TIME = 2.0**32
"""Largest time in a message [s]; the seconds of ROS have 32 bits."""


def read_number(fields: Any, *path: str) -> float:
    """Return a number of nested fields, 0 if it is missing.

    Raises:
        InputError: it is not a finite number.

    >>> read_number({"linear": {"x": 0.5}}, "linear", "x"), read_number({}, "linear", "x")
    (0.5, 0.0)
    """
    value = fields
    for word in path:
        if not isinstance(value, Mapping):
            raise InputError(f"{'.'.join(path)}: {word} is in a {type(value).__name__}, it must be in an object")
        value = value.get(word, 0.0 if word == path[-1] else {})
    if isinstance(value, bool) or not isinstance(value, int | float) or not math.isfinite(value):
        raise InputError(f"{'.'.join(path)} = {str(value)[:40]!r} must be a finite number")
    return float(value)


def read_point(fields: Any, *path: str) -> tuple[float, float]:
    """Return x and y of a point."""
    return read_number(fields, *path, "x"), read_number(fields, *path, "y")


def read_heading(fields: Any, *path: str) -> float:
    """Return the heading [rad] of a quaternion; one of zeros is the identity.

    >>> read_heading({"z": 1.0, "w": 0.0}) == math.pi
    True
    """
    x, y, z, w = (read_number(fields, *path, axis) for axis in "xyzw")
    if x == y == z == w == 0.0:
        return 0.0
    return math.atan2(2.0 * (w * z + x * y), w * w + x * x - y * y - z * z)


def read_twist(fields: Fields, robot: str, sender: str) -> list[Request]:
    """Return the command of ``geometry_msgs/Twist`` or ``TwistStamped``."""
    twist = fields.get("twist", fields)
    if not isinstance(twist, Mapping) or not ({"linear", "angular"} & {*twist}):
        raise InputError("a command needs linear and angular, as in geometry_msgs/Twist")
    return [
        VelocityOrder(
            robot=robot,
            forward=read_number(twist, "linear", "x"),
            turn=read_number(twist, "angular", "z"),
            left=read_number(twist, "linear", "y"),
            source=sender,
        )
    ]


def read_stamp(fields: Fields) -> int:
    """Return the time [ns] in the header of a ``geometry_msgs/TwistStamped``, 0 without one.

    >>> read_stamp({"header": {"stamp": {"sec": 1, "nanosec": 50}}, "twist": {}}), read_stamp({"linear": {}})
    (1000000050, 0)
    """
    return read_duration(fields, "header", "stamp") if "twist" in fields else 0


def read_duration(fields: Any, *path: str) -> int:
    """Return a time or duration [ns] of nested fields, 0 if it is missing.

    Raises:
        InputError: it is no time.

    >>> read_duration({"wait": {"sec": 1, "nanosec": 50}}, "wait")
    1000000050
    """
    names = (("sec", "secs"), ("nanosec", "nsecs"))  # ROS 2, ROS 1
    seconds, nanoseconds = (sum(read_number(fields, *path, name) for name in pair) for pair in names)
    if abs(seconds) > LONGEST_TIME:
        raise InputError(f"{'.'.join(path)}: {seconds:g} s must be from -{LONGEST_TIME:g} to {LONGEST_TIME:g} s")
    return int(seconds) * 10**9 + int(nanoseconds)


def read_goal(fields: Fields, robot: str, sender: str) -> list[Request]:
    """Return the goal of ``geometry_msgs/PoseStamped``, in the frame of the map."""
    if not isinstance(fields.get("pose"), Mapping):
        raise InputError("a goal needs pose, as in geometry_msgs/PoseStamped")
    header = fields.get("header", {})
    frame = header.get("frame_id", "") if isinstance(header, Mapping) else ""
    if frame not in ("", MAP):
        raise InputError(f"a goal must be in the frame {MAP!r}, not {str(frame)[:40]!r}")
    x, y = read_point(fields, "pose", "position")
    return [GoalOrder(robot=robot, x=x, y=y, source=sender)]


def read_joints(fields: Fields, robot: str, sender: str) -> list[Request]:
    """Return the joint targets of ``sensor_msgs/JointState``: names and positions."""
    names = _joint_names(fields, "name")
    positions = _joint_values(fields, "position", names, "")
    return [
        JointOrder(robot=robot, joint=name, position=value, source=sender)
        for name, value in zip(names, positions, strict=True)
    ]


def read_trajectory(fields: Fields, robot: str, sender: str) -> list[Request]:
    """Return the trajectory of ``trajectory_msgs/JointTrajectory``; accelerations and efforts are not used."""
    names, points = _joint_names(fields, "joint_names"), fields.get("points")
    if not _is_list(points) or not 0 < len(points) <= MOST_POINTS:
        raise InputError(f"a joint trajectory needs points, from 1 to {MOST_POINTS}")
    times, positions, velocities = [], [], []
    for k, point in enumerate(points):
        place = f"points[{k}]."
        if not isinstance(point, Mapping):
            raise InputError(f"{place[:-1]} is a {type(point).__name__}, it must be an object")
        times.append(read_duration(point, "time_from_start"))
        positions.append(_joint_values(point, "positions", names, place))
        given = len(_plain_list(point.get("velocities")) or ())
        velocities.append(_joint_values(point, "velocities", names, place) if given else [math.nan] * len(names))
    begin = read_duration(fields, "header", "stamp")
    arrays = np.array(times, dtype=np.int64), np.array(positions), np.array(velocities)
    return [JointTrajectory(robot, tuple(names), begin, *arrays, sender)]


def _joint_names(fields: Fields, key: str) -> list[str]:
    names = fields.get(key)
    if not _is_list(names) or not 0 < len(names) <= MOST_JOINTS or not all(isinstance(name, str) for name in names):
        raise InputError(f"{key} must be a list of names of joints, from 1 to {MOST_JOINTS}")
    if len({*names}) < len(names):
        raise InputError(f"{key} has a joint twice: {', '.join(names)[:80]}")
    return [*names]


def _joint_values(fields: Fields, key: str, names: Sequence[str], place: str) -> list[float]:
    values = _plain_list(fields.get(key))
    if not _is_list(values) or len(values) != len(names):
        count = len(values) if _is_list(values) else 0
        raise InputError(f"{place}{key} has {count} numbers, it must have {len(names)}, one for each joint")
    return [read_number({place + key: value}, place + key) for value in values]


def _plain_list(values: Any) -> Any:
    return values.tolist() if hasattr(values, "tolist") else values


def read_order_text(fields: Fields, robot: str, sender: str) -> list[Request]:
    """Return the order of ``std_msgs/String`` as JSON, see :func:`crowdbot.simulation.read_order`."""
    if not isinstance(fields.get("data"), str):
        raise InputError("an order needs data with JSON, as in std_msgs/String")
    return [read_order(fields["data"])]


def read_clock(fields: Fields, robot: str, sender: str) -> list[Request]:
    """Check ``rosgraph_msgs/Clock``; it gives no order."""
    for word in ("sec", "nanosec"):
        value = read_number(fields, "clock", word)
        if value < 0 or value > 1e10 or value != int(value):
            raise InputError(f"clock.{word} = {value:g} must be a whole number from 0")
    if "clock" not in fields:
        raise InputError("a time needs clock, as in rosgraph_msgs/Clock")
    return []


def _is_list(value: Any) -> TypeGuard[Sequence[Any]]:
    return isinstance(value, Sequence) and not isinstance(value, str | bytes)


READERS: dict[str, Callable[[Fields, str, str], list[Request]]] = {
    "geometry_msgs/msg/Twist": read_twist,
    "geometry_msgs/msg/TwistStamped": read_twist,
    "geometry_msgs/msg/PoseStamped": read_goal,
    "sensor_msgs/msg/JointState": read_joints,
    "trajectory_msgs/msg/JointTrajectory": read_trajectory,
    "std_msgs/msg/String": read_order_text,
    "rosgraph_msgs/msg/Clock": read_clock,
}
"""Functions that read the messages of input topics, by type: fields, robot, sender."""


PACKAGE = "simulation_interfaces"


@dataclass(frozen=True)
class ServiceDefinition:
    """A service of ``simulation_interfaces`` that this program has.

    Fields:
        kind: name of its type, such as ``StepSimulation``.
        about: one line for people.
    """

    kind: str
    about: str


SERVICES = {
    "get_simulator_features": ServiceDefinition("GetSimulatorFeatures", "supported features"),
    "get_simulation_state": ServiceDefinition("GetSimulationState", "playing or paused"),
    "set_simulation_state": ServiceDefinition("SetSimulationState", "play, pause, stop or quit"),
    "step_simulation": ServiceDefinition("StepSimulation", "steps while paused"),
    "reset_simulation": ServiceDefinition("ResetSimulation", "begin the trial again"),
    "spawn_entity": ServiceDefinition("SpawnEntity", "add an entity"),
    "spawn_entities": ServiceDefinition("SpawnEntities", "add entities"),
    "delete_entity": ServiceDefinition("DeleteEntity", "remove a person or robot"),
    "get_entities": ServiceDefinition("GetEntities", "names of entities"),
    "get_entities_states": ServiceDefinition("GetEntitiesStates", "poses and velocities"),
    "get_entity_state": ServiceDefinition("GetEntityState", "pose and velocity of an entity"),
    "set_entity_state": ServiceDefinition("SetEntityState", "move a person or robot"),
    "get_entity_info": ServiceDefinition("GetEntityInfo", "category of an entity"),
    "get_spawnables": ServiceDefinition("GetSpawnables", "what can be added"),
    "load_world": ServiceDefinition("LoadWorld", "run another trial"),
    "get_current_world": ServiceDefinition("GetCurrentWorld", "the trial"),
    "get_available_worlds": ServiceDefinition("GetAvailableWorlds", "trials that can be loaded"),
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
    """Return the message library of rosbags with the types of ``simulation_interfaces``.

    >>> interface_store().types["simulation_interfaces/msg/StepSimulation_Request"](steps=3).steps
    3
    """
    store = Messages().store
    for name, text in MESSAGE_TYPES.items():
        store.register(get_types_from_msg(text, f"{PACKAGE}/msg/{name}"))
    for service in SERVICES.values():
        request, _, response = SERVICE_TYPES[service.kind].partition("---\n")
        store.register(get_types_from_msg(request or "\n", request_kind(service)))
        store.register(get_types_from_msg(response, response_kind(service)))
    return store


OPTICAL = ("/image", "/labels", "/camera_info")
"""Topics of a camera that are in its optical frame."""
SHARED = ("/clock", "/tf", "/tf_static", "/map")
"""Topics of the scene that a real robot has, too; the localisation in ``/tf`` is perfect."""
EXACT = ("/reading", "/labels")
"""Topics of a sensor that say more than its readings: who was met, without noise."""


@dataclass(frozen=True)
class OutputTopic:
    """A topic that the simulation sends.

    Fields:
        name: name, such as ``/robot/scan``.
        kind: message type, such as ``sensor_msgs/msg/LaserScan``.
        frame: coordinate frame of the header, empty without one.
        rate: messages per second of simulated time [Hz]; 0: when something happens, or once if latched.
        quality: quality of service.
        robot: name of the robot, empty for the scene.
        about: one line for people.
        truth: whether it says what no real robot can measure; robot software that is scored does not get it.
    """

    name: str
    kind: str
    frame: str
    rate: float
    quality: QualityOfService
    robot: str = ""
    about: str = ""
    truth: bool = False


@dataclass(frozen=True)
class InputTopic:
    """A topic that the simulation receives.

    Fields:
        name: name, such as ``/robot/cmd_vel``.
        kinds: message types that are accepted; a transport that needs one takes the first.
        robot: name of the robot, empty for the scene.
        quality: quality of service.
        about: one line for people.
    """

    name: str
    kinds: tuple[str, ...]
    robot: str = ""
    quality: QualityOfService = COMMAND
    about: str = ""

    def requests(self, fields: Mapping[str, Any], sender: str = "") -> list[Request]:
        """Return what a message asks of the simulation.

        Raises:
            InputError: a value is not allowed.
        """
        if not isinstance(fields, Mapping):
            raise InputError(f"a message on {self.name} must be an object")
        return READERS[self.kinds[0]](fields, self.robot, sender)


@dataclass(frozen=True)
class Service:
    """A service of the simulation; request and response are nested mappings.

    Fields:
        name: name, such as ``/crowdbot/step_simulation``.
        kind: service type, such as ``simulation_interfaces/srv/StepSimulation``.
        about: one line for people.
    """

    name: str
    kind: str
    about: str = ""


@dataclass(frozen=True)
class JointAction:
    """An action of a robot: programs send a goal, and get feedback and a result.

    Fields:
        name: name, such as ``/pepper/follow_joint_trajectory``.
        robot: name of the robot.
        kind: action type.
        about: one line for people.
    """

    name: str
    robot: str
    kind: str = "control_msgs/action/FollowJointTrajectory"
    about: str = "joint positions at times, with feedback and a result"


@dataclass(frozen=True)
class RobotInterface:
    """Topics, services and actions of a trial.

    Fields:
        trial: the trial.
        outputs, inputs, services, actions: topics that are sent, topics that are received, services, and actions.

    >>> from crowdbot.trials import load_trial
    >>> interface = RobotInterface.of(load_trial("frontal"))
    >>> [one.name for one in interface.inputs][:2], interface.output("/robot/scan").rate
    (['/robot/cmd_vel', '/robot/goal_pose'], 10.0)
    """

    trial: Trial
    outputs: tuple[OutputTopic, ...]
    inputs: tuple[InputTopic, ...]
    services: tuple[Service, ...]
    actions: tuple[JointAction, ...] = ()

    @classmethod
    def of(cls, trial: Trial, follows_clock: bool = False) -> RobotInterface:
        """Return the interface of a trial.

        Args:
            trial: the trial.
            follows_clock: whether ``/clock`` is received instead of sent.
        """
        outputs, inputs = _scene_outputs(trial, follows_clock), list[InputTopic]()
        for robot in trial.robots:
            outputs += _robot_outputs(robot, 1.0 / trial.step)
            inputs += _robot_inputs(robot)
        order = "any order of the simulation as JSON"
        inputs.append(InputTopic("/crowdbot/order", ("std_msgs/msg/String",), quality=STATE, about=order))
        if follows_clock:
            inputs.append(InputTopic("/clock", ("rosgraph_msgs/msg/Clock",), quality=CLOCK, about="external time"))
        services = tuple(
            Service(f"/crowdbot/{name}", f"simulation_interfaces/srv/{item.kind}", item.about)
            for name, item in SERVICES.items()
        )
        taken = {input_topic.name for input_topic in inputs}
        actions = tuple(
            JointAction(f"/{robot.name}/follow_joint_trajectory", robot.name)
            for robot in trial.robots
            if robot.body.model.movable
        )
        sent = tuple(output for output in outputs if output.name not in taken)
        return cls(trial, sent, tuple(inputs), services, actions)

    def output(self, name: str) -> OutputTopic:
        """Return an output topic.

        Raises:
            InputError: there is none of this name.
        """
        for item in self.outputs:
            if item.name == name:
                return item
        raise InputError(f"there is no topic {name!r}")


def _scene_outputs(trial: Trial, follows_clock: bool) -> list[OutputTopic]:
    every, period = 1.0 / trial.step, 1.0 / trial.recording.period
    clock = OutputTopic("/clock", "rosgraph_msgs/msg/Clock", "", every, CLOCK, about="simulated time")
    rows = [
        *([] if follows_clock else [clock]),
        OutputTopic("/tf", "tf2_msgs/msg/TFMessage", "", every, TF, about="frames that move (REP-105)"),
        OutputTopic("/tf_static", "tf2_msgs/msg/TFMessage", "", 0.0, LATCHED, about="fixed frames"),
        OutputTopic("/map", "nav_msgs/msg/OccupancyGrid", MAP, 0.0, LATCHED, about="walls and obstacles"),
        OutputTopic("/people", "people_msgs/msg/People", MAP, period, STATE, about="true people"),
        OutputTopic(
            "/crowd/markers", MARKERS, MAP, 1.0 / trial.recording.markers, STATE, about="shapes for viewers", truth=True
        ),
        OutputTopic(
            "/crowdbot/contacts", "crowdbot_msgs/msg/Contacts", MAP, 0.0, STATE, about="contacts of robots", truth=True
        ),
        OutputTopic(
            FORCES, "crowdbot_msgs/msg/Forces", MAP, 0.0, STATE, about="contact forces (physics world)", truth=True
        ),
        OutputTopic(
            FALLS, "crowdbot_msgs/msg/Falls", MAP, 0.0, STATE, about="falls of people that are over", truth=True
        ),
        OutputTopic(
            FALL_POSES,
            "crowdbot_msgs/msg/FallPoses",
            MAP,
            0.0,
            STATE,
            about="poses of people out of balance",
            truth=True,
        ),
        OutputTopic(
            COLLISIONS, "crowdbot_msgs/msg/Collisions", MAP, 0.0, STATE, about="contacts that have ended", truth=True
        ),
        OutputTopic(
            "/crowdbot/orders", "std_msgs/msg/String", "", 0.0, STATE, about="orders that were applied", truth=True
        ),
        OutputTopic(
            "/crowdbot/reactions", "std_msgs/msg/String", "", 0.0, STATE, about="reactions to robots", truth=True
        ),
        OutputTopic(
            "/crowdbot/gestures", "std_msgs/msg/String", "", 0.0, STATE, about="gestures to robots", truth=True
        ),
    ]
    return [dataclasses.replace(row, truth=row.name not in SHARED) for row in rows]


def _robot_outputs(robot: RobotSpec, every: float) -> list[OutputTopic]:
    name, frames = robot.name, LinkFrames(robot)
    sensors = {mount.name for mount in robot.sensors}
    odometry = "nav_msgs/msg/Odometry"
    rows = [
        OutputTopic(f"/{name}/ground_truth/odom", odometry, MAP, every, STATE, name, "true pose and velocity", True)
    ]
    if "odom" not in sensors:
        measured = any(mount.sensor.encoders for mount in robot.sensors)
        about = "odometry" if measured else "exact odometry, without a sensor of it"
        rows.append(OutputTopic(f"/{name}/odom", odometry, frames.odom, every, STATE, name, about))
    if "joint_states" not in sensors and robot.body.model.movable:
        rows.append(
            OutputTopic(f"/{name}/joint_states", "sensor_msgs/msg/JointState", "", every, STATE, name, "joints")
        )
    if "robot_description" not in sensors:
        about = "URDF"
        rows.append(OutputTopic(f"/{name}/robot_description", "std_msgs/msg/String", "", 0.0, LATCHED, name, about))
    for mount in robot.sensors:
        topic, rate = f"{name}/{mount.name}", min(every, float(mount.sensor.rate))
        for ending, kind in reading_topics(mount.sensor).items():
            frame = f"{topic}_optical" if ending in OPTICAL else topic
            frame = frames.odom if kind == odometry else frame
            about = type(mount.sensor).__name__
            truth = mount.sensor.truth or ending in EXACT
            rows.append(OutputTopic(f"/{topic}{ending}", kind, frame, rate, SENSOR, name, about, truth))
    return rows


def _robot_inputs(robot: RobotSpec) -> list[InputTopic]:
    name = robot.name
    twists = ("geometry_msgs/msg/Twist", "geometry_msgs/msg/TwistStamped")
    rows = [
        InputTopic(f"/{name}/cmd_vel", twists, name, COMMAND, "velocity"),
        InputTopic(f"/{name}/goal_pose", ("geometry_msgs/msg/PoseStamped",), name, STATE, "goal in the map"),
    ]
    if robot.body.model.movable:
        joints, path = "sensor_msgs/msg/JointState", "trajectory_msgs/msg/JointTrajectory"
        rows += [
            InputTopic(f"/{name}/joint_command", (joints,), name, STATE, "joint positions"),
            InputTopic(f"/{name}/joint_trajectory", (path,), name, STATE, "joint positions at times"),
        ]
    return rows
