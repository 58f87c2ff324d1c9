"""Ros2Node: a ROS 2 node of rclpy, of the user's own ROS or of wheels from PyPI."""

from __future__ import annotations

import functools
import importlib
import os
import threading
import warnings
from collections.abc import Sequence
from typing import Any

from crowdbot.bridges.fields import fields_of
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import InputTopic, OutputTopic, RobotInterface
from crowdbot.bridges.quality import QualityOfService
from crowdbot.bridges.verbs.definitions import interface_store
from crowdbot.core import InputError, MissingExtra, import_optional
from crowdbot.recording import StepMessage

from .services import CALLS, add_services

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

    Topics and services whose packages are not installed are left out; :attr:`missing` and :attr:`missing_services` list
    their types, and the node says so in its log. The wheels of PyPI, for instance, have no ``tf2_msgs`` and no
    ``simulation_interfaces``.

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
        """Message types that are not installed."""
        self.missing_services: tuple[str, ...] = ()
        """Service types that are not installed."""
        self._services: Participant | None = None
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
        count = max(len(one.kinds) for one in interface.inputs)
        for k in range(len(self._participants), count):
            self._participants.append(Participant(self._ros, f"{NODE}_{k + 1}" if k else NODE, self.domain))
        missing: dict[str, None] = {}
        self._announce(interface, missing)
        self._listen(interface, inbox, missing)
        if self._services is None:
            self._services = Participant(self._ros, f"{NODE}_services", self.domain, CALLS)
            self.missing_services = add_services(self._services.node, inbox, self.name)
            self._services.start()
        self.missing = tuple(missing)
        if missing:
            self.report("warning", f"not installed, so topics are left out: {', '.join(missing)}")
        for one in self._participants:
            one.start()

    def _announce(self, interface: RobotInterface, missing: dict[str, None]) -> None:
        wanted = {one.name: one for one in interface.outputs}
        for topic, (kind, publisher) in list(self._publishers.items()):
            if topic not in wanted or wanted[topic].kind != kind:
                self._participants[0].node.destroy_publisher(publisher)
                del self._publishers[topic]
        for one in wanted.values():
            if one.name not in self._publishers:
                self._add_publisher(one, missing)

    def _add_publisher(self, one: OutputTopic, missing: dict[str, None]) -> None:
        found = message_class(one.kind)
        if found is None:
            missing[one.kind] = None
            return
        publisher = self._participants[0].node.create_publisher(found, one.name, quality_profile(one.quality))
        self._publishers[one.name] = (one.kind, publisher)

    def _listen(self, interface: RobotInterface, inbox: Inbox, missing: dict[str, None]) -> None:
        """Subscribe every type of each input; a command can come plain or stamped.

        DDS allows one type for each topic in a participant, so the second type of a topic has its own.
        """
        wanted = {(one.name, kind): (one, k) for one in interface.inputs for k, kind in enumerate(one.kinds)}
        for key, (node, subscription) in list(self._subscriptions.items()):
            if key not in wanted:
                node.destroy_subscription(subscription)
                del self._subscriptions[key]
        for (name, kind), (one, k) in wanted.items():
            if (name, kind) not in self._subscriptions:
                self._add_subscription(one, kind, self._participants[k].node, inbox, missing)

    def _add_subscription(self, one: InputTopic, kind: str, node: Any, inbox: Inbox, missing: dict[str, None]) -> None:
        found = message_class(kind)
        if found is None:
            missing[kind] = None
            return
        take = functools.partial(self._take, one.name, kind, inbox)
        subscription = node.create_subscription(found, one.name, take, quality_profile(one.quality), raw=True)
        self._subscriptions[one.name, kind] = (node, subscription)

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
        for one in messages:
            if one.topic in self._publishers:
                self._publishers[one.topic][1].publish(one.cdr)

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
        if not topic.endswith("/"):
            return topic in self._publishers and self._publishers[topic][1].get_subscription_count() > 0
        names = [one for one in self._publishers if one == topic[:-1] or one.startswith(topic)]
        return any(self._publishers[one][1].get_subscription_count() > 0 for one in names)

    def stop(self) -> None:
        """Stop the node."""
        for one in (*self._participants, *([self._services] if self._services else [])):
            one.stop()
        self._participants, self._services = [], None


def message_class(kind: str) -> Any:
    """Return the class of a message type of the ROS installation; None if its package is not installed."""
    package, _, name = kind.split("/")
    try:
        return getattr(importlib.import_module(f"{package}.msg"), name, None)
    except ImportError:
        return None


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
