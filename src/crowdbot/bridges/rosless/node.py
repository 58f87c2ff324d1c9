"""RoslessNode: the transport ``rosless``, topics of ROS 2 by one small package instead of a ROS installation."""

from __future__ import annotations

import os
import threading
from collections.abc import Sequence
from typing import Any

from crowdbot.bridges.fields import fields_of
from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import OutputTopic, RobotInterface
from crowdbot.bridges.quality import QualityOfService
from crowdbot.bridges.verbs.definitions import interface_store
from crowdbot.core import InputError, import_optional
from crowdbot.messages import Messages
from crowdbot.recording import StepMessage

__all__ = ["RoslessNode"]

LAST_DOMAIN = 232
"""Largest domain whose ports exist on all systems."""
SPIN, ENDING = 0.1, 2.0
"""Longest time [s] until a thread sees that it has to end, and until it has ended."""
HEADER = b"\0\1\0\0"
"""Encapsulation of little-endian CDR."""


class RoslessNode:
    """Publishes the outputs of a trial to ROS 2 and takes its commands, with the bytes of the recorder. Experimental.

    All message types are there, also ``tf2_msgs`` and ``people_msgs``. There are no services, parameters or names of
    nodes: others see topics of a participant without a name. It uses the network interfaces of this computer, not the
    loopback interface, and DDS has no password: everybody in the network can drive the robot.

    Args:
        domain: ROS domain (default: that of ``ROS_DOMAIN_ID``, or 0).

    Raises:
        MissingExtra: rosless is not installed.
        InputError: the domain does not exist.
    """

    name = "rosless"

    def __init__(self, domain: int | None = None) -> None:
        chosen = int(os.environ.get("ROS_DOMAIN_ID") or 0) if domain is None else domain
        if not 0 <= chosen <= LAST_DOMAIN:
            raise InputError(f"ROS domain {chosen} must be from 0 to {LAST_DOMAIN}")
        self._ros: Any = import_optional("rosless", "the bridge rosless", "rosless")
        self.domain = chosen
        self._nodes: list[Any] = []
        self._publishers: dict[str, tuple[str, Any]] = {}
        self._threads: dict[tuple[str, str], tuple[threading.Event, threading.Thread]] = {}
        self._make = Messages()

    @classmethod
    def of(cls, address: str) -> RoslessNode:
        """Return the node of an address on the command line: a domain, or nothing.

        Raises:
            InputError: the address is no domain.
        """
        if address and not (address.isdecimal() and len(address) <= 3):
            raise InputError(f"rosless:{address[:40]} must be rosless or rosless:DOMAIN, such as rosless:7")
        return cls(int(address) if address else None)

    def start(self, interface: RobotInterface, inbox: Inbox) -> None:
        """Join the domain, or change the topics to those of another trial.

        Raises:
            InputError: the domain cannot be joined, with the reason.
        """
        try:
            # Readers of two types on one topic of one node get the bytes of each other, so there is a node for each.
            count = max((len(one.kinds) for one in interface.inputs), default=1)
            self._nodes += [self._ros.Node(self.domain) for _ in range(count - len(self._nodes))]
            self._announce(interface)
            self._listen(interface, inbox)
        except (OSError, RuntimeError, ValueError) as error:
            raise InputError(f"rosless cannot join domain {self.domain}: {error}") from None

    def _announce(self, interface: RobotInterface) -> None:
        wanted = {one.name: one for one in interface.outputs}
        for topic, (kind, publisher) in list(self._publishers.items()):
            if topic not in wanted or wanted[topic].kind != kind:
                publisher.close()
                del self._publishers[topic]
        for one in wanted.values():
            if one.name not in self._publishers:
                self._publishers[one.name] = (one.kind, self._publisher(one))

    def _publisher(self, one: OutputTopic) -> Any:
        self._ros.register_bundle(one.kind, self._make.definition(one.kind))
        return self._nodes[0].advertise(one.name, one.kind, **_quality(one.quality))

    def _listen(self, interface: RobotInterface, inbox: Inbox) -> None:
        wanted = {(one.name, kind): (one, k) for one in interface.inputs for k, kind in enumerate(one.kinds)}
        for key in set(self._threads) - set(wanted):
            self._leave(key)
        for (topic, kind), (one, k) in wanted.items():
            if (topic, kind) not in self._threads:
                found = self._nodes[k].subscribe(topic, kind, **_quality(one.quality))
                end = threading.Event()
                thread = threading.Thread(target=self._take, args=(found, kind, inbox, end), name=topic, daemon=True)
                self._threads[topic, kind] = end, thread
                thread.start()

    def _take(self, subscription: Any, kind: str, inbox: Inbox, end: threading.Event) -> None:
        """Give what arrives on a topic to the inbox."""
        while not end.is_set():
            try:
                message = subscription.read(SPIN)
                if message is not None:
                    inbox.receive(subscription.topic, self._fields(message, kind), self.name)
            except InputError:  # counted by the inbox; there is no log of ROS 2 here
                continue
            except Exception:  # bytes that are no message of the type
                inbox.count.refused += 1
        subscription.close()

    def _fields(self, message: Any, kind: str) -> dict[str, Any]:
        if isinstance(message, bytes):
            return fields_of(interface_store().deserialize_cdr(HEADER + message, kind))
        found: dict[str, Any] = message.to_dict()
        return found

    def _leave(self, key: tuple[str, str]) -> None:
        end, thread = self._threads.pop(key)
        end.set()
        thread.join(ENDING)

    def publish(self, messages: Sequence[StepMessage]) -> None:
        """Publish the bytes of the messages of a step, as they are recorded."""
        for one in messages:
            if one.topic in self._publishers:
                self._publishers[one.topic][1].send_payload(one.cdr)

    def poll(self) -> None:
        """Do nothing: threads give what arrives to the inbox."""

    def report(self, level: str, text: str) -> None:
        """Do nothing: without a node of ROS 2 there is no log."""

    def wants(self, topic: str) -> bool:
        """Return whether a node subscribes a topic, or with a final slash one that starts with it."""
        if not topic.endswith("/"):
            return topic in self._publishers and self._publishers[topic][1].subscriber_count > 0
        names = [one for one in self._publishers if one == topic[:-1] or one.startswith(topic)]
        return any(self._publishers[one][1].subscriber_count > 0 for one in names)

    def stop(self) -> None:
        """Leave the domain."""
        for key in list(self._threads):
            self._threads[key][0].set()
        for key in list(self._threads):
            self._leave(key)
        for _, publisher in self._publishers.values():
            publisher.close()
        self._publishers, self._nodes = {}, []


def _quality(quality: QualityOfService) -> dict[str, Any]:
    """Return the quality of service as rosless takes it."""
    return {
        "reliability": "reliable" if quality.reliable else "best_effort",
        "durability": "transient_local" if quality.latched else "volatile",
        "depth": quality.depth,
    }
