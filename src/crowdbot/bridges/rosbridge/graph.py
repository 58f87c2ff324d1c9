"""RosGraph: topics, services and clients of a rosbridge server."""

from __future__ import annotations

import fnmatch
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any

from crowdbot.bridges.inbox import Inbox
from crowdbot.bridges.interface import RobotInterface
from crowdbot.bridges.verbs.definitions import SERVICES
from crowdbot.core import InputError

from .encoding import OutgoingMessage
from .peer import Peer

NODE = "/crowdbot"
"""Name of the simulation as a node."""
MOST_TOPICS = 1000
EVENTS = 100
"""Number of messages that wait for a client on a topic of events."""


def ros2_type(kind: str) -> str:
    """Return the name of a message type in ROS 2.

    >>> ros2_type("geometry_msgs/Twist"), ros2_type("geometry_msgs/msg/Twist")
    ('geometry_msgs/msg/Twist', 'geometry_msgs/msg/Twist')
    """
    return re.sub(r"^(\w+)/(\w+)$", r"\1/msg/\2", kind)


class RosGraph:
    """What the clients of a server see; used in one thread.

    Args:
        interface: topics and services of the simulation.
        inbox: receives commands and calls.
        later: calls a function with arguments in the thread of the graph, from any thread.
        allowed: patterns of topics and services that clients may use, such as ``/robot/*``; None: all.
    """

    def __init__(
        self,
        interface: RobotInterface,
        inbox: Inbox,
        later: Callable[..., Any],
        allowed: Sequence[str] | None = None,
    ) -> None:
        self.interface, self.inbox, self.later, self.allowed = interface, inbox, later, allowed
        self.sessions: list[Peer] = []
        self.latched: dict[str, OutgoingMessage] = {}
        self.wanted: frozenset[str] = frozenset()
        """Topics that clients subscribe; replaced as a whole, so that other threads can read it."""
        self.now = 0
        """Simulated time [ns]."""
        self.services: dict[str, tuple[Peer, str]] = {}
        self.actions: dict[str, tuple[Peer, str]] = {}
        self.advertised: dict[str, dict[Peer, str]] = {}
        self._latching: set[str] = set()
        """Topics of clients whose latest message late subscribers get."""
        self._outputs = {one.name: one for one in interface.outputs}
        self._inputs = {one.name: one for one in interface.inputs}

    def change(self, interface: RobotInterface) -> None:
        """Announce other topics and services; clients and their subscriptions stay."""
        self.interface = interface
        self._outputs = {one.name: one for one in interface.outputs}
        self._inputs = {one.name: one for one in interface.inputs}
        kept = {name for name in self.latched if name in self._outputs or name in self.advertised}
        self.latched = {name: one for name, one in self.latched.items() if name in kept}

    def deliver(self, messages: Iterable[OutgoingMessage]) -> None:
        """Give messages to the clients that subscribe their topics."""
        for one in messages:
            if one.topic in self._outputs and self._outputs[one.topic].quality.latched:
                self.latched[one.topic] = one
            self.now = max(self.now, one.nanoseconds) if one.topic != "/clock" else one.nanoseconds
            for session in self.sessions:
                session.offer(one)

    def publish(self, sender: Peer, topic: str, fields: Any, latch: bool) -> None:
        """Take a message of a client: a command, or a message for other clients.

        Raises:
            InputError: the topic or the message is not allowed.
        """
        self.check_name(topic)
        if topic in self._inputs:
            self.inbox.receive(topic, fields, "rosbridge")
            return
        if topic in self._outputs:
            raise InputError(f"{topic!r} is sent by the simulation")
        if topic not in self.advertised:
            self.advertise(sender, topic, "", latch)
        kind = self.advertised[topic].get(sender, "")
        message = OutgoingMessage(topic, kind, self.now, lambda: fields)
        if latch or topic in self._latching:
            self.latched[topic] = message
        for session in self.sessions:
            session.offer(message)

    def advertise(self, sender: Peer, topic: str, kind: str, latch: bool = False) -> None:
        """Note that a client publishes a topic.

        Raises:
            InputError: the topic has another type, or there are too many.
        """
        self.check_name(topic)
        known = self.topic_types(topic)
        if kind and known and ros2_type(kind) not in known:
            raise InputError(f"{topic!r} has the type {known[0]}, not {kind[:80]!r}")
        if topic in self._outputs:
            raise InputError(f"{topic!r} is sent by the simulation")
        if topic not in self.advertised and len(self.advertised) >= MOST_TOPICS:
            raise InputError(f"{MOST_TOPICS} topics of clients are too many")
        self.advertised.setdefault(topic, {})[sender] = ros2_type(kind)
        if latch:
            self._latching.add(topic)

    def unadvertise(self, sender: Peer, topic: str) -> None:
        """Forget that a client publishes a topic."""
        self.advertised.get(topic, {}).pop(sender, None)
        if not self.advertised.get(topic):
            self.advertised.pop(topic, None)
            self._latching.discard(topic)
            if topic not in self._outputs:
                self.latched.pop(topic, None)

    def check_name(self, name: str) -> None:
        """Raise :class:`InputError` if clients may not use a topic or service."""
        if not re.fullmatch(r"/?[A-Za-z~_{][\w/~{}.-]{0,250}", name):
            raise InputError(f"{name[:60]!r} is not a name of ROS")
        if self.allowed is None or name.startswith("/rosapi/"):
            return
        if not any(fnmatch.fnmatchcase(name, pattern) for pattern in self.allowed):
            raise InputError(f"{name[:60]!r} is not in the list of allowed topics")

    def queue_depth(self, topic: str) -> int:
        """Return the number of messages that wait for a client that asks for no queue: the newest, or events."""
        found = self._outputs.get(topic)
        return EVENTS if found is not None and not found.rate and not found.quality.latched else 1

    def topic_types(self, topic: str) -> tuple[str, ...]:
        """Return the message types of a topic, the preferred one first."""
        if topic in self._outputs:
            return (self._outputs[topic].kind,)
        if topic in self._inputs:
            return self._inputs[topic].kinds
        return tuple(sorted({kind for kind in self.advertised.get(topic, {}).values() if kind}))

    @property
    def topics(self) -> dict[str, str]:
        """Message types by topic."""
        return {name: (*self.topic_types(name), "")[0] for name in (*self._outputs, *self._inputs, *self.advertised)}

    @property
    def service_types(self) -> dict[str, str]:
        """Types of the services of the simulation and of clients by name."""
        return {one.name: one.kind for one in self.interface.services} | {
            name: kind for name, (_, kind) in self.services.items()
        }

    def positional(self, service: str, values: Sequence[Any]) -> Mapping[str, Any]:
        """Return the fields of a request that is given as a list."""
        one = SERVICES.get(service.rpartition("/")[2])
        names = re.findall(r"(\w+)$", one.request, flags=re.M) if one is not None else []
        return dict(zip(names, values, strict=False))

    def collect_subscriptions(self) -> None:
        """Collect the topics that clients subscribe."""
        self.wanted = frozenset(topic for session in self.sessions for topic in session.subscriptions)

    def remove(self, session: Peer) -> None:
        """Forget a client."""
        if session in self.sessions:
            self.sessions.remove(session)
        for topic in list(self.advertised):
            self.unadvertise(session, topic)
        for kept in (self.services, self.actions):
            for name in [name for name, (owner, _) in kept.items() if owner is session]:
                del kept[name]
        self.collect_subscriptions()
