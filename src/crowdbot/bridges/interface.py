"""RobotInterface: the topics and services of a trial, before anything runs."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from crowdbot.core import InputError
from crowdbot.messages import COLLISIONS, FALL_POSES, FALLS, FORCES, MAP, MARKERS, reading_topics
from crowdbot.recording import LinkFrames
from crowdbot.simulation import Order
from crowdbot.trials import RobotSpec, Trial

from .commands import READERS
from .quality import CLOCK, COMMAND, LATCHED, SENSOR, STATE, TF, QualityOfService
from .verbs.definitions import SERVICES

OPTICAL = ("/image", "/labels", "/camera_info")
"""Topics of a camera that are in its optical frame."""


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
    """

    name: str
    kind: str
    frame: str
    rate: float
    quality: QualityOfService
    robot: str = ""
    about: str = ""


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

    def orders(self, fields: Mapping[str, Any], sender: str = "") -> list[Order]:
        """Return the orders of a message.

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
class RobotInterface:
    """Topics and services of a trial.

    Fields:
        trial: the trial.
        outputs, inputs, services: topics that are sent, topics that are received, and services.

    >>> from crowdbot.trials import load_trial
    >>> interface = RobotInterface.of(load_trial("frontal"))
    >>> [one.name for one in interface.inputs][:2], interface.output("/robot/scan").rate
    (['/robot/cmd_vel', '/robot/goal_pose'], 10.0)
    """

    trial: Trial
    outputs: tuple[OutputTopic, ...]
    inputs: tuple[InputTopic, ...]
    services: tuple[Service, ...]

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
            Service(f"/crowdbot/{name}", f"simulation_interfaces/srv/{one.kind}", one.about)
            for name, one in SERVICES.items()
        )
        taken = {one.name for one in inputs}
        return cls(trial, tuple(one for one in outputs if one.name not in taken), tuple(inputs), services)

    def output(self, name: str) -> OutputTopic:
        """Return an output topic.

        Raises:
            InputError: there is none of this name.
        """
        for one in self.outputs:
            if one.name == name:
                return one
        raise InputError(f"there is no topic {name!r}")


def _scene_outputs(trial: Trial, follows_clock: bool) -> list[OutputTopic]:
    every, period = 1.0 / trial.step, 1.0 / trial.recording.period
    clock = OutputTopic("/clock", "rosgraph_msgs/msg/Clock", "", every, CLOCK, about="simulated time")
    return [
        *([] if follows_clock else [clock]),
        OutputTopic("/tf", "tf2_msgs/msg/TFMessage", "", every, TF, about="frames that move (REP-105)"),
        OutputTopic("/tf_static", "tf2_msgs/msg/TFMessage", "", 0.0, LATCHED, about="fixed frames"),
        OutputTopic("/map", "nav_msgs/msg/OccupancyGrid", MAP, 0.0, LATCHED, about="walls and obstacles"),
        OutputTopic("/people", "people_msgs/msg/People", MAP, period, STATE, about="true people"),
        OutputTopic("/crowd/markers", MARKERS, MAP, 1.0 / trial.recording.markers, STATE, about="shapes for viewers"),
        OutputTopic("/crowdbot/contacts", "crowdbot_msgs/msg/Contacts", MAP, 0.0, STATE, about="contacts of robots"),
        OutputTopic(FORCES, "crowdbot_msgs/msg/Forces", MAP, 0.0, STATE, about="contact forces (physics world)"),
        OutputTopic(FALLS, "crowdbot_msgs/msg/Falls", MAP, 0.0, STATE, about="falls of people that are over"),
        OutputTopic(FALL_POSES, "crowdbot_msgs/msg/FallPoses", MAP, 0.0, STATE, about="poses of people out of balance"),
        OutputTopic(COLLISIONS, "crowdbot_msgs/msg/Collisions", MAP, 0.0, STATE, about="contacts that have ended"),
        OutputTopic("/crowdbot/orders", "std_msgs/msg/String", "", 0.0, STATE, about="orders that were applied"),
        OutputTopic("/crowdbot/reactions", "std_msgs/msg/String", "", 0.0, STATE, about="reactions to robots"),
    ]


def _robot_outputs(robot: RobotSpec, every: float) -> list[OutputTopic]:
    name, frames = robot.name, LinkFrames(robot)
    sensors = {mount.name for mount in robot.sensors}
    odometry = "nav_msgs/msg/Odometry"
    rows = [OutputTopic(f"/{name}/ground_truth/odom", odometry, MAP, every, STATE, name, "true pose and velocity")]
    if "odom" not in sensors:
        rows.append(OutputTopic(f"/{name}/odom", odometry, frames.odom, every, STATE, name, "odometry"))
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
            rows.append(OutputTopic(f"/{topic}{ending}", kind, frame, rate, SENSOR, name, about))
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
            InputTopic(f"/{name}/joint_trajectory", (path,), name, STATE, "joint positions of the last point"),
        ]
    return rows
