"""Bridges: a running trial as a robot that ROS and other software drives.

The room has one port and several transports. The port is neutral of transport:

* :class:`RobotInterface` lists topics (name, message type, frame, rate, quality of service) and services of a trial
  before anything runs. ``docs/reference/robot-interface.md`` is made from it.
* :class:`BridgePort` converts each step with :class:`crowdbot.recording.StepMessages`, the conversion of the recorder:
  what is recorded is what is sent. It hands :class:`crowdbot.recording.StepMessage` objects to the transports, which
  take ``message`` (fields) or ``cdr`` (bytes); each is made once, and only if a transport wants the topic.
* :class:`Inbox` takes what arrives, in any thread: ``receive(topic, fields, sender)`` for messages and ``call(service,
  request, answer, sender)`` for services, both with nested mappings. Both raise ``InputError`` with a sentence for the
  sender. Memory is bounded; of the velocity commands of a robot only the newest waits.
* Commands and verbs become orders of the simulation: they are applied at an instant, recorded, and replayed to the
  byte. A robot stops 0.5 s (simulated) after its latest command.
* :class:`BridgeRun` runs the trial: in real time, free, on the service ``step_simulation``, after a received
  ``/clock``, or when all robots have a command (:class:`BridgeClock`). A reset or another world begins another episode.

A :class:`Transport` implements ``start``, ``publish``, ``poll``, ``report``, ``wants`` and ``stop``. It keeps the
latest message of each latched topic (``output.quality.latched``) for late subscribers, never blocks, and drops old
messages of slow peers. :func:`fields_of` and :func:`message_of` convert messages to nested mappings and back;
:func:`interface_store` knows the types of the services, too. Service types are those of ``simulation_interfaces`` 2.1.

Names are those of recordings: ``/robot/scan``, ``/robot/cmd_vel``, ``/people``, ``/tf``; the first part is the robot.
"""

from .bridge_run import BridgeRun, run_bridge
from .fields import fields_of, message_of, plain_fields
from .inbox import Inbox, ServiceCall
from .interface import (
    QUALITIES,
    SERVICES,
    InputTopic,
    OutputTopic,
    QualityOfService,
    RobotInterface,
    Service,
    interface_store,
    request_kind,
    response_kind,
)
from .join.command_guard import CommandGuard, DrivingArea, GuardLimits
from .join.join_run import JoinRun, joined_trial
from .join.real_robot_link import RealRobotLink, SimulatedRobot, open_real_robot
from .motion_capture import (
    CaptureSet,
    FootLock,
    MotionBinding,
    MotionCapture,
    MotionSample,
    PoseStream,
    Retargeting,
    SourceSkeleton,
    StreamStatistics,
    open_stream,
    parse_binding,
    parse_captures,
)
from .port import BridgePort, steered_trial
from .run_control import MODES, BridgeClock, CommandLatency, LatencySummary, Pace, RunControl
from .simulation_services import PLAIN_SERVICES, PlainService
from .stack_link import open_stack
from .transport import TRANSPORTS, Transport, is_among, open_transport

__all__ = [
    "MODES",
    "PLAIN_SERVICES",
    "QUALITIES",
    "SERVICES",
    "TRANSPORTS",
    "BridgeClock",
    "BridgePort",
    "BridgeRun",
    "CaptureSet",
    "CommandGuard",
    "CommandLatency",
    "DrivingArea",
    "FootLock",
    "GuardLimits",
    "Inbox",
    "InputTopic",
    "JoinRun",
    "LatencySummary",
    "MotionBinding",
    "MotionCapture",
    "MotionSample",
    "OutputTopic",
    "Pace",
    "PlainService",
    "PoseStream",
    "QualityOfService",
    "RealRobotLink",
    "Retargeting",
    "RobotInterface",
    "RunControl",
    "Service",
    "ServiceCall",
    "SimulatedRobot",
    "SourceSkeleton",
    "StreamStatistics",
    "Transport",
    "fields_of",
    "interface_store",
    "is_among",
    "joined_trial",
    "message_of",
    "open_real_robot",
    "open_stack",
    "open_stream",
    "open_transport",
    "parse_binding",
    "parse_captures",
    "plain_fields",
    "request_kind",
    "response_kind",
    "run_bridge",
    "steered_trial",
]
