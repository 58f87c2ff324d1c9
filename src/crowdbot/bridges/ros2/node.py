"""Ros2Node: a ROS 2 node of rclpy, of the user's own ROS or of wheels from PyPI, and its services."""

from __future__ import annotations

import functools
import importlib
import os
import queue
import threading
import warnings
from collections.abc import Callable, Sequence
from typing import Any

from crowdbot.bridges.fields import fields_of
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import (
    PACKAGE,
    SERVICES,
    InputTopic,
    OutputTopic,
    QualityOfService,
    RobotInterface,
    interface_store,
)
from crowdbot.bridges.simulation_interfaces import RESULT_OPERATION_FAILED
from crowdbot.bridges.simulation_services import PLAIN_SERVICES, PlainService, result
from crowdbot.bridges.transport import is_among
from crowdbot.core import InputError, MissingExtra, import_optional
from crowdbot.recording import StepMessage

from .actions import GOALS, JointActionServers
from .messages import fill_message, message_fields, ros_class

CALLS = 4
"""Number of calls that can wait for the simulation at the same time; the node needs as many threads."""
ANSWER_TIME = 600.0
"""Longest real time [s] that a call waits for the simulation."""
UNANSWERED = "the simulation does not answer"


def add_services(node: Any, inbox: Inbox, sender: str) -> tuple[str, ...]:
    """Offer the services on a node, and return the types that are not installed.

    A callback blocks its thread until the simulation has answered, which ends with the run at the latest.

    Args:
        node: node of rclpy, in an executor with :data:`CALLS` threads.
        inbox: receives the calls.
        sender: name of the transport.
    """
    missing: dict[str, None] = {}
    group = importlib.import_module("rclpy.callback_groups").ReentrantCallbackGroup()
    for name, plain in PLAIN_SERVICES.items():
        kind = f"std_srvs/srv/{plain.kind}"
        found = ros_class(kind)
        if found is None:
            missing[kind] = None
        else:
            node.create_service(found, name, _plain_callback(plain, node, inbox, sender), callback_group=group)
    for short, definition in SERVICES.items():
        kind = f"{PACKAGE}/srv/{definition.kind}"
        found = ros_class(kind)
        if found is None:
            missing[kind] = None
        else:
            name = f"/crowdbot/{short}"
            node.create_service(found, name, _callback(name, inbox, sender), callback_group=group)
    return tuple(missing)


def _plain_callback(service: PlainService, node: Any, inbox: Inbox, sender: str) -> Callable[[Any, Any], Any]:
    def call(request: Any, response: Any) -> Any:
        answers: queue.SimpleQueue[str] = queue.SimpleQueue()
        try:
            service.call(inbox, answers.put, sender)
            problem = answers.get(timeout=ANSWER_TIME)
        except (InputError, queue.Empty) as error:
            problem = str(error) or UNANSWERED
        if service.kind == "Trigger":
            return fill_message(response, {"success": not problem, "message": problem})
        if problem:  # Empty has no place for it
            node.get_logger().error(problem)
        return response

    return call


def _callback(name: str, inbox: Inbox, sender: str) -> Callable[[Any, Any], Any]:
    def call(request: Any, response: Any) -> Any:
        answers: queue.SimpleQueue[dict[str, Any]] = queue.SimpleQueue()
        try:
            inbox.call(name, message_fields(request), answers.put, sender)
            fields = answers.get(timeout=ANSWER_TIME)
        except (InputError, queue.Empty) as error:
            fields = result(RESULT_OPERATION_FAILED, str(error) or UNANSWERED)
        return fill_message(response, fields)

    return call


SPIN = 0.1
"""Longest time [s] until the thread sees that it has to end."""


class Participant:
    """One node with a thread of its own, in a DDS participant of its own.

    Args:
        ros: the module rclpy.
        name: name of the node.
        domain: ROS domain; None: that of the environment.
        threads: number of callbacks that can run at the same time.

    Raises:
        MissingExtra: a part of ROS is not installed.
        InputError: the node cannot be started.
    """

    def __init__(self, ros: Any, name: str, domain: int | None, threads: int = 1) -> None:
        signals = importlib.import_module("rclpy.signals").SignalHandlerOptions
        try:
            with warnings.catch_warnings():
                warnings.simplefilter("ignore", DeprecationWarning)  # of what ROS imports
                self.context = ros.Context()
                ros.init(context=self.context, domain_id=domain, signal_handler_options=signals.NO)
                self.node = ros.create_node(name, context=self.context)
        except ImportError as error:  # for instance the library of the middleware
            raise MissingExtra(f"the bridge ros2 ({error})", "ros2-wheels") from None
        except RuntimeError as error:
            raise InputError(f"ros2 cannot start a node: {str(error).splitlines()[0]}") from None
        executors = importlib.import_module("rclpy.executors")
        if threads == 1:
            self._executor = executors.SingleThreadedExecutor(context=self.context)
        else:
            self._executor = executors.MultiThreadedExecutor(threads, context=self.context)
        self._executor.add_node(self.node)
        self._end = threading.Event()
        self._thread = threading.Thread(target=self._spin, name=name, daemon=True)

    def start(self) -> None:
        """Start the thread; without effect if it runs."""
        if not self._thread.is_alive():
            self._thread.start()

    def stop(self) -> None:
        """End the thread and the node."""
        self._end.set()
        if self._thread.is_alive():
            self._thread.join()
        self._executor.shutdown()
        self.node.destroy_node()
        self.context.try_shutdown()

    def _spin(self) -> None:
        while not self._end.is_set() and self.context.ok():
            self._executor.spin_once(timeout_sec=SPIN)


NODE = "crowdbot"
LAST_DOMAIN = 232
"""Largest domain whose ports exist on all systems."""
RANGE = "ROS_AUTOMATIC_DISCOVERY_RANGE"


class Ros2Node:
    """A ROS 2 node that publishes the outputs of a trial and takes its commands, with the messages of the recorder.

    Topics, actions and services whose packages are not installed are left out; :attr:`missing` and
    :attr:`missing_services` list their types, and the node says so in its log. The wheels of PyPI have no ``tf2_msgs``,
    ``control_msgs`` and ``simulation_interfaces``, for instance.

    Nodes on other computers are not seen unless a host is given or ``ROS_AUTOMATIC_DISCOVERY_RANGE`` is set.

    Args:
        domain: ROS domain (default: that of ``ROS_DOMAIN_ID``, or 0).
        everywhere: whether nodes on other computers of the network can connect.

    Raises:
        MissingExtra: rclpy is not installed, or its environment is not set up.
        InputError: the domain does not exist.
    """

    name = "ros2"

    def __init__(self, domain: int | None = None, everywhere: bool = False) -> None:
        if domain is not None and not 0 <= domain <= LAST_DOMAIN:
            raise InputError(f"ROS domain {domain} must be from 0 to {LAST_DOMAIN}")
        self._ros: Any = import_optional("rclpy", "the bridge ros2 (or source your own ROS 2)", "ros2-wheels")
        self.domain, self.everywhere = domain, everywhere
        self.missing: tuple[str, ...] = ()
        """Types of messages and actions that are not installed."""
        self.missing_services: tuple[str, ...] = ()
        """Service types that are not installed."""
        self._services: Participant | None = None
        self._acting: Participant | None = None
        self._actions: JointActionServers | None = None
        self._participants: list[Participant] = []
        self._publishers: dict[str, tuple[str, Any]] = {}
        self._subscriptions: dict[tuple[str, str], Any] = {}

    @classmethod
    def of(cls, address: str, host: str = "") -> Ros2Node:
        """Return the node of an address on the command line: a domain, or nothing.

        Raises:
            InputError: the address is no domain.
        """
        if address and not (address.isdecimal() and len(address) <= 3):
            raise InputError(f"ros2:{address[:40]} must be ros2 or ros2:DOMAIN, such as ros2:7")
        return cls(int(address) if address else None, everywhere=host not in ("", "127.0.0.1", "localhost"))

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Start the node, or change its topics to those of another trial.

        Raises:
            InputError: the node cannot be started, with the reason.
        """
        if RANGE not in os.environ:
            os.environ[RANGE] = "SUBNET" if self.everywhere else "LOCALHOST"
        count = max(len(input_topic.kinds) for input_topic in interface.inputs)
        for k in range(len(self._participants), count):
            self._participants.append(Participant(self._ros, f"{NODE}_{k + 1}" if k else NODE, self.domain))
        missing: dict[str, None] = {}
        self._announce(interface, missing)
        self._listen(interface, inbox, missing)
        if self._services is None:
            self._services = Participant(self._ros, f"{NODE}_services", self.domain, CALLS)
            self.missing_services = add_services(self._services.node, inbox, self.name)
            self._services.start()
        self._offer(interface, inbox, missing)
        self.missing = tuple(missing)
        if missing:
            self.report("warning", f"not installed, so topics and actions are left out: {', '.join(missing)}")
        for participant in self._participants:
            participant.start()

    def _offer(self, interface: RobotInterface, inbox: Inbox, missing: dict[str, None]) -> None:
        """Offer the actions; their node exists once a trial has some whose type is installed."""
        kinds = {action.kind: ros_class(action.kind) for action in interface.actions}
        missing.update(dict.fromkeys(kind for kind, found in kinds.items() if found is None))
        actions = [action for action in interface.actions if kinds[action.kind] is not None]
        if actions and self._acting is None:
            self._acting = Participant(self._ros, f"{NODE}_actions", self.domain, GOALS + 2)
            self._actions = JointActionServers(self._acting.node, inbox, self.name)
            self._acting.start()
        if self._actions is not None:
            self._actions.offer(actions)

    def _announce(self, interface: RobotInterface, missing: dict[str, None]) -> None:
        wanted = {output.name: output for output in interface.outputs}
        for topic, (kind, publisher) in list(self._publishers.items()):
            if topic not in wanted or wanted[topic].kind != kind:
                self._participants[0].node.destroy_publisher(publisher)
                del self._publishers[topic]
        for item in wanted.values():
            if item.name not in self._publishers:
                self._add_publisher(item, missing)

    def _add_publisher(self, output_topic: OutputTopic, missing: dict[str, None]) -> None:
        found = ros_class(output_topic.kind)
        if found is None:
            missing[output_topic.kind] = None
            return
        publisher = self._participants[0].node.create_publisher(
            found, output_topic.name, quality_profile(output_topic.quality)
        )
        self._publishers[output_topic.name] = (output_topic.kind, publisher)

    def _listen(self, interface: RobotInterface, inbox: Inbox, missing: dict[str, None]) -> None:
        """Subscribe every type of each input; a command can come plain or stamped.

        DDS allows one type for each topic in a participant, so the second type of a topic has its own.
        """
        wanted = {
            (input_topic.name, kind): (input_topic, k)
            for input_topic in interface.inputs
            for k, kind in enumerate(input_topic.kinds)
        }
        for key, (node, subscription) in list(self._subscriptions.items()):
            if key not in wanted:
                node.destroy_subscription(subscription)
                del self._subscriptions[key]
        for (name, kind), (item, k) in wanted.items():
            if (name, kind) not in self._subscriptions:
                self._add_subscription(item, kind, self._participants[k].node, inbox, missing)

    def _add_subscription(
        self, input_topic: InputTopic, kind: str, node: Any, inbox: Inbox, missing: dict[str, None]
    ) -> None:
        found = ros_class(kind)
        if found is None:
            missing[kind] = None
            return
        take = functools.partial(self._take, input_topic.name, kind, inbox)
        subscription = node.create_subscription(
            found, input_topic.name, take, quality_profile(input_topic.quality), raw=True
        )
        self._subscriptions[input_topic.name, kind] = (node, subscription)

    def _take(self, topic: str, kind: str, inbox: Inbox, data: bytes) -> None:
        """Give a message to the inbox; runs in the thread of the node."""
        try:
            message = interface_store().deserialize_cdr(data, kind)
            inbox.receive(topic, fields_of(message), self.name)
        except InputError as error:
            self.report("error", str(error))
        except Exception as error:  # rosbags raises many kinds of errors for bytes of another type
            self.report("error", f"a message on {topic} is no {kind}: {error}")

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Publish the bytes of the messages of a step, as they are recorded."""
        for message in messages:
            if message.topic in self._publishers:
                self._publishers[message.topic][1].publish(message.cdr)

    def poll(self) -> None:
        """Do nothing: the thread of the node gives what arrives to the inbox."""

    def report(self, level: str, text: str) -> None:
        """Write a problem to the log of the node, which others receive on ``/rosout``."""
        log = self._participants[0].node.get_logger()
        if level == "info":  # rclpy allows one severity for each line of code
            log.info(text)
        elif level == "warning":
            log.warning(text)
        else:
            log.error(text)

    def wants(self, topic: str) -> bool:
        """Return whether a node subscribes a topic, or with a final slash one that starts with it."""
        named = [publisher for name, (_, publisher) in self._publishers.items() if is_among(topic, (name,))]
        return any(publisher.get_subscription_count() > 0 for publisher in named)

    def stop(self) -> None:
        """Stop the node."""
        for participant in (*self._participants, self._services, self._acting):
            if participant is not None:
                participant.stop()
        self._participants, self._services, self._acting, self._actions = [], None, None, None


def quality_profile(quality: QualityOfService) -> Any:
    """Return the quality of service as rclpy takes it."""
    qos = importlib.import_module("rclpy.qos")
    reliable, best_effort = qos.ReliabilityPolicy.RELIABLE, qos.ReliabilityPolicy.BEST_EFFORT
    latched, volatile = qos.DurabilityPolicy.TRANSIENT_LOCAL, qos.DurabilityPolicy.VOLATILE
    return qos.QoSProfile(
        depth=quality.depth,
        history=qos.HistoryPolicy.KEEP_LAST,
        reliability=reliable if quality.reliable else best_effort,
        durability=latched if quality.latched else volatile,
    )
