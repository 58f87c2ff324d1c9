"""Topics, services and actions of the clients of a rosbridge server."""

from __future__ import annotations

import itertools
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from typing import Any, Protocol

from rosbags.interfaces import Nodetype

from crowdbot.bridges.inbox import Inbox, ServiceCall
from crowdbot.bridges.interface import PACKAGE, SERVICES, RobotInterface, interface_store, request_kind, response_kind
from crowdbot.bridges.joint_actions import ABORTED, CANCELED, REJECTED, SUCCEEDED
from crowdbot.bridges.socket_transport import SessionGraph
from crowdbot.core import InputError

from .frames import OutgoingMessage, field


class PeerCalls(Protocol):
    """Calls of a client."""

    def hand(self, caller: Peer, asked: Mapping[str, Any], sent: Mapping[str, Any]) -> None:
        """Give the client a call of another one.

        Raises:
            InputError: too many calls wait for it.
        """

    def cancel(self, caller: Peer, name: str, action: str) -> bool:
        """Tell the client that a goal is cancelled; return whether it has the goal."""

    def fail(self, frame: Mapping[str, Any], text: str) -> None:
        """Answer a call of this client with an error."""

    def forget(self, caller: Peer) -> None:
        """Drop the calls of a client that has gone."""


class Peer(Protocol):
    """A client of a server."""

    @property
    def subscriptions(self) -> Mapping[str, Any]:
        """Subscriptions by topic."""

    @property
    def calls(self) -> PeerCalls:
        """Its calls."""

    def offer(self, message: OutgoingMessage) -> None:
        """Let a message wait if the client subscribes its topic."""

    def reply(self, frame: Mapping[str, Any], fragment_size: int | None = None, compression: str = "none") -> None:
        """Send a frame."""


NODE = "/crowdbot"
"""Name of the simulation as a node."""
MOST_TOPICS = 1000
MOST_LATCHED = 16 << 20
"""Memory [bytes] of the latched messages of all clients."""
EVENTS = 100
"""Number of messages that wait for a client on a topic of events."""


def ros2_type(kind: str) -> str:
    """Return the name of a message type in ROS 2.

    >>> ros2_type("geometry_msgs/Twist"), ros2_type("geometry_msgs/msg/Twist")
    ('geometry_msgs/msg/Twist', 'geometry_msgs/msg/Twist')
    """
    return re.sub(r"^(\w+)/(\w+)$", r"\1/msg/\2", kind)


class RosGraph(SessionGraph):
    """What the clients of a server of rosbridge see. They and their subscriptions stay when the topics change."""

    sessions: list[Peer]

    def __init__(
        self,
        interface: RobotInterface,
        inbox: Inbox,
        later: Callable[..., Any],
        allowed: Sequence[str] | None = None,
    ) -> None:
        super().__init__(interface, inbox, later, allowed)
        self.latched: dict[str, OutgoingMessage] = {}
        self.services: dict[str, tuple[Peer, str]] = {}
        self.actions: dict[str, tuple[Peer, str]] = {}
        self.advertised: dict[str, dict[Peer, str]] = {}
        self._latching: set[str] = set()
        """Topics of clients whose latest message late subscribers get."""
        self._outputs = {output.name: output for output in interface.outputs}
        self._inputs = {input_topic.name: input_topic for input_topic in interface.inputs}

    def change(self, interface: RobotInterface) -> None:
        self.interface = interface
        self._outputs = {output.name: output for output in interface.outputs}
        self._inputs = {input_topic.name: input_topic for input_topic in interface.inputs}
        kept = {name for name in self.latched if name in self._outputs or name in self.advertised}
        self.latched = {name: item for name, item in self.latched.items() if name in kept}

    def deliver(self, messages: Iterable[OutgoingMessage]) -> None:
        for message in messages:
            if message.topic in self._outputs and self._outputs[message.topic].quality.latched:
                self.latched[message.topic] = message
            self.now = max(self.now, message.nanoseconds) if message.topic != "/clock" else message.nanoseconds
            for session in self.sessions:
                session.offer(message)

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
        message = OutgoingMessage.relayed(topic, kind, self.now, fields)
        if latch or topic in self._latching:
            others = sum(
                item.memory for name, item in self.latched.items() if name in self.advertised and name != topic
            )
            if others + message.memory > MOST_LATCHED:
                raise InputError(
                    f"{topic!r}: with this message, the latched messages of clients take"
                    f" {(others + message.memory) / 2**20:.1f} MiB, more than {MOST_LATCHED >> 20} MiB;"
                    " unadvertise other latched topics"
                )
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
        if not name.startswith("/rosapi/") and not self.allows(name):
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
        return {service.name: service.kind for service in self.interface.services} | {
            name: kind for name, (_, kind) in self.services.items()
        }

    def positional(self, service: str, values: Sequence[Any]) -> Mapping[str, Any]:
        """Return the fields of a request that is given as a list."""
        definition = SERVICES.get(service.rpartition("/")[2])
        fields = interface_store().fielddefs[request_kind(definition)][1] if definition is not None else []
        return {name: value for (name, _), value in zip(fields, values, strict=False)}

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


Request = Mapping[str, Any]
Answer = dict[str, Any]


def answer_rosapi(graph: RosGraph, name: str, request: Request) -> Answer:
    """Return the response of a service of rosapi.

    Args:
        graph: topics and services.
        name: last part of the name of the service.
        request: fields of the request.

    Raises:
        InputError: a field is missing or has another type, or a message type is unknown.
    """
    return ROSAPI[name](graph, request)


def type_details(kind: str) -> list[Answer]:
    """Return ``rosapi_msgs/TypeDef`` of a message type and of all types in it.

    Raises:
        InputError: the type is unknown.

    >>> [one["type"] for one in type_details("geometry_msgs/Twist")]
    ['geometry_msgs/msg/Twist', 'geometry_msgs/msg/Vector3']
    """
    store, rest, found = interface_store(), [ros2_type(kind)], dict[str, Answer]()
    while rest:
        name = rest.pop(0)
        if name in found:
            continue
        if name not in store.fielddefs:
            raise InputError(f"the message type {name[:80]!r} is unknown")
        constants, parts = store.fielddefs[name]
        rows = [(word, *_field(node)) for word, node in parts]
        found[name] = {
            "type": name,
            "fieldnames": [row[0] for row in rows],
            "fieldtypes": [row[1] for row in rows],
            "fieldarraylen": [row[2] for row in rows],
            "examples": ["" if row[2] < 0 else "[]" for row in rows],
            "constnames": [row[0] for row in constants],
            "constvalues": [str(row[2]) for row in constants],
        }
        rest += [row[1] for row in rows if "/" in row[1]]
    return list(found.values())


def _field(node: Any) -> tuple[str, int]:
    """Return type and length of a field: -1 for one value, 0 for a list of any length."""
    kind, detail = node
    if kind in (Nodetype.ARRAY, Nodetype.SEQUENCE):
        inner, size = detail
        return _field(inner)[0], size if kind == Nodetype.ARRAY else 0
    return (detail if kind == Nodetype.NAME else detail[0]), -1


def _text(request: Request, name: str) -> str:
    value = request.get(name)
    if not isinstance(value, str):
        raise InputError(f"the request needs {name!r}")
    return value


def _topics(graph: RosGraph, request: Request) -> Answer:
    found = graph.topics
    return {"topics": list(found), "types": list(found.values())}


def _raw_types(graph: RosGraph, request: Request) -> Answer:
    found, store = graph.topics, interface_store()
    kinds = found.values()
    texts = [store.generate_msgdef(kind, ros_version=2)[0] if kind in store.fielddefs else "" for kind in kinds]
    return _topics(graph, request) | {"typedefs_full_text": texts}


def _topic_type(graph: RosGraph, request: Request) -> Answer:
    return {"type": (*graph.topic_types(_text(request, "topic")), "")[0]}


def _topics_for_type(graph: RosGraph, request: Request) -> Answer:
    kind = ros2_type(_text(request, "type"))
    return {"topics": [name for name in graph.topics if kind in graph.topic_types(name)]}


def _services(graph: RosGraph, request: Request) -> Answer:
    return {"services": [*graph.service_types, *(f"/rosapi/{name}" for name in ROSAPI)]}


def _service_type(graph: RosGraph, request: Request) -> Answer:
    return {"type": graph.service_types.get(_text(request, "service"), "")}


def _services_for_type(graph: RosGraph, request: Request) -> Answer:
    kind = _text(request, "type")
    return {"services": [name for name, service_type_ in graph.service_types.items() if service_type_ == kind]}


def _service_node(graph: RosGraph, request: Request) -> Answer:
    service = _text(request, "service")
    return {"node": NODE if service in graph.service_types else ""}


def _service_providers(graph: RosGraph, request: Request) -> Answer:
    kind = _text(request, "service")
    return {"providers": [name for name, service_type_ in graph.service_types.items() if service_type_ == kind]}


def _service_details(make: Callable[[Any], str]) -> Callable[[RosGraph, Request], Answer]:
    def answer(graph: RosGraph, request: Request) -> Answer:
        kind = _text(request, "type")
        for item in SERVICES.values():
            if kind in (f"{PACKAGE}/srv/{item.kind}", f"{PACKAGE}/{item.kind}"):
                return {"typedefs": type_details(make(item))}
        raise InputError(f"the service type {kind[:80]!r} is unknown")

    return answer


def _nodes(graph: RosGraph, request: Request) -> Answer:
    return {"nodes": [NODE, *(f"/rosbridge_client_{k + 1}" for k in range(len(graph.sessions)))]}


def _node_details(graph: RosGraph, request: Request) -> Answer:
    if _text(request, "node") != NODE:
        return {"subscribing": [], "publishing": [], "services": []}
    inputs = [input_topic.name for input_topic in graph.interface.inputs]
    outputs = [output.name for output in graph.interface.outputs]
    return {
        "subscribing": inputs,
        "publishing": outputs,
        "services": [service.name for service in graph.interface.services],
    }


def _publishers(graph: RosGraph, request: Request) -> Answer:
    topic = _text(request, "topic")
    own = [NODE] if topic in {output.name for output in graph.interface.outputs} else []
    clients = [f"/rosbridge_client_{graph.sessions.index(item) + 1}" for item in graph.advertised.get(topic, {})]
    return {"publishers": own + clients}


def _subscribers(graph: RosGraph, request: Request) -> Answer:
    topic = _text(request, "topic")
    own = [NODE] if topic in {input_topic.name for input_topic in graph.interface.inputs} else []
    rows = [f"/rosbridge_client_{k + 1}" for k, session in enumerate(graph.sessions) if topic in session.subscriptions]
    return {"subscribers": own + rows}


def _time(graph: RosGraph, request: Request) -> Answer:
    seconds, rest = divmod(graph.now, 10**9)
    return {"time": {"sec": seconds, "nanosec": rest, "secs": seconds, "nsecs": rest}}  # ROS 2, and ROS 1 for roslibpy


def _message_details(graph: RosGraph, request: Request) -> Answer:
    return {"typedefs": type_details(_text(request, "type"))}


def _action_servers(graph: RosGraph, request: Request) -> Answer:
    own = [action.name for action in graph.interface.actions]
    return {"action_servers": [SIMULATE_STEPS, *own, *graph.actions]}


ROSAPI: dict[str, Callable[[RosGraph, Request], Answer]] = {
    "topics": _topics,
    "topics_and_raw_types": _raw_types,
    "topic_type": _topic_type,
    "topics_for_type": _topics_for_type,
    "publishers": _publishers,
    "subscribers": _subscribers,
    "services": _services,
    "service_type": _service_type,
    "services_for_type": _services_for_type,
    "service_node": _service_node,
    "service_providers": _service_providers,
    "service_request_details": _service_details(request_kind),
    "service_response_details": _service_details(response_kind),
    "nodes": _nodes,
    "node_details": _node_details,
    "message_details": _message_details,
    "action_servers": _action_servers,
    "get_time": _time,
    "get_ros_version": lambda graph, request: {"version": 2, "distro": "humble"},
    "interfaces": lambda graph, request: {"interfaces": sorted(interface_store().fielddefs)},
    "get_param_names": lambda graph, request: {"names": []},
    "has_param": lambda graph, request: {"exists": False},
    "get_param": lambda graph, request: {"value": request.get("default_value", request.get("default", ""))},
}
"""Functions by the last part of the name of the service."""


SIMULATE_STEPS, STEP = "/crowdbot/simulate_steps", "/crowdbot/step_simulation"
"""The action of the simulation, ``simulation_interfaces/action/SimulateSteps``, and the service that does its work."""
PORTIONS, MOST_CALLS, MOST_OFFERS = 20, 200, 200
Frame = Mapping[str, Any]


class CallRelay:
    """Calls of a client, and services and actions that it offers.

    Args:
        session: the client.
        graph: topics and services.
    """

    def __init__(self, session: Peer, graph: RosGraph) -> None:
        self.session, self.graph = session, graph
        self._numbers = itertools.count(1)
        self._asked: dict[str, tuple[Peer, Frame]] = {}
        """Calls of other clients that this one has not answered: caller and frame."""
        self._goals: dict[str, bool] = {}
        """Goals of the action of the simulation, and whether each goes on."""
        self._followed: dict[str, ServiceCall] = {}
        """Goals of actions of robots."""
        self._open = 0

    @property
    def operations(self) -> dict[str, Callable[[Frame], None]]:
        """Functions by operation."""
        return {
            "call_service": self._call_service,
            "advertise_service": lambda frame: self._offer(frame, "service", self.graph.services),
            "unadvertise_service": lambda frame: self._withdraw(frame, "service", self.graph.services),
            "service_response": lambda frame: self._answer(frame, done=True),
            "advertise_action": lambda frame: self._offer(frame, "action", self.graph.actions),
            "unadvertise_action": lambda frame: self._withdraw(frame, "action", self.graph.actions),
            "send_action_goal": self._send_goal,
            "cancel_action_goal": self._cancel_goal,
            "action_feedback": lambda frame: self._answer(frame, done=False),
            "action_result": lambda frame: self._answer(frame, done=True),
        }

    def close(self) -> None:
        """Tell the callers that this client has gone."""
        for caller, frame in list(self._asked.values()):
            caller.calls.fail(frame, "the client that offers it has gone")
        self._asked.clear()
        self._goals.clear()
        for call in self._followed.values():  # nobody watches the robot any more
            call.canceled = True
        self._followed.clear()

    def forget(self, caller: Peer) -> None:
        """Drop the calls of a client that has gone."""
        for number in [number for number, (item, _) in self._asked.items() if item is caller]:
            del self._asked[number]

    def fail(self, frame: Frame, text: str) -> None:
        """Answer a call or a goal of this client with an error."""
        if frame["op"] == "call_service":
            self._respond(frame, text, False)
        else:
            self._result(frame, {}, ABORTED, False, text)

    def _call_service(self, frame: Frame) -> None:
        service, values = field(frame, "service", str), field(frame, "args", (dict, list), {})
        try:
            self.graph.check_name(service)
            request = self.graph.positional(service, values) if isinstance(values, list) else values
            if service in self.graph.services:
                provider = self.graph.services[service][0]
                provider.calls.hand(self.session, frame, {**frame, "args": request})
            elif service.rpartition("/")[2] in ROSAPI and "rosapi" in service:
                self._respond(frame, answer_rosapi(self.graph, service.rpartition("/")[2], request), True)
            else:
                self._ask(service, request, lambda response: self._respond(frame, response, True))
        except InputError as error:
            self._respond(frame, str(error), False)

    def _ask(self, service: str, request: Frame, answer: Callable[[dict[str, Any]], None]) -> None:
        """Call a service of the simulation; the answer comes in the thread of the graph."""
        if self._open >= MOST_CALLS:
            raise InputError(f"{MOST_CALLS} calls wait; wait for their responses")

        def finish(response: dict[str, Any]) -> None:
            self._open -= 1
            answer(response)

        self.graph.inbox.call(service, request, lambda response: self.graph.later(finish, response), "rosbridge")
        self._open += 1

    def _respond(self, frame: Frame, values: Any, good: bool) -> None:
        name = _identity(frame)
        size, compression = frame.get("fragment_size"), frame.get("compression", "none")
        size = size if isinstance(size, int) and size > 0 else None
        row = {"op": "service_response", **name, "service": frame["service"], "values": values, "result": good}
        self.session.reply(row, size, compression if compression == "png" else "none")

    def _offer(self, frame: Frame, what: str, offered: dict[str, tuple[Peer, str]]) -> None:
        name, kind = field(frame, what, str), field(frame, "type", str)
        self.graph.check_name(name)
        own = {SIMULATE_STEPS, *(action.name for action in self.graph.interface.actions)}
        if (name in self.graph.service_types and name not in self.graph.services) or name in own:
            raise InputError(f"{name!r} is offered by the simulation")
        if name in offered and offered[name][0] is not self.session:
            raise InputError(f"{name!r} is offered by another client")
        if len(offered) >= MOST_OFFERS:
            raise InputError(f"{MOST_OFFERS} of them are too many")
        offered[name] = (self.session, ros2_type(kind))

    def _withdraw(self, frame: Frame, what: str, offered: dict[str, tuple[Peer, str]]) -> None:
        name = field(frame, what, str)
        if name not in offered or offered[name][0] is not self.session:
            raise InputError(f"{name[:60]!r} is not offered by this client")
        del offered[name]

    def hand(self, caller: Peer, asked: Frame, sent: Frame) -> None:
        """Give this client a call or a goal of another one.

        Raises:
            InputError: too many calls wait for it.
        """
        if len(self._asked) >= MOST_CALLS:
            raise InputError("too many calls wait for the client that offers it")
        number = f"{asked['op']}:{next(self._numbers)}"
        self._asked[number] = (caller, {key: value for key, value in asked.items() if key != "args"})
        self.session.reply({**sent, "id": number})

    def cancel(self, caller: Peer, name: str, action: str) -> bool:
        """Tell this client that a goal of another one is cancelled; return whether it has the goal."""
        for number, (item, asked) in self._asked.items():
            if item is caller and asked.get("id") == name:
                self.session.reply({"op": "cancel_action_goal", "id": number, "action": action})
                return True
        return False

    def _answer(self, frame: Frame, done: bool) -> None:
        """Give a response, feedback or result of this client to the caller."""
        number = field(frame, "id", str)
        if number not in self._asked:
            raise InputError(f"nobody waits for {number[:60]!r}")
        caller, asked = self._asked.pop(number) if done else self._asked[number]
        name = _identity(asked)
        try:
            caller.reply({key: value for key, value in frame.items() if key != "id"} | name)
        except ValueError:
            if done:
                caller.calls.fail(asked, "the response has numbers that are not finite")
            raise

    def _send_goal(self, frame: Frame) -> None:
        action, name = field(frame, "action", str), field(frame, "id", str, "")
        values = field(frame, "args", (dict, list), {})
        try:
            self.graph.check_name(action)
            if action in self.graph.actions:
                self.graph.actions[action][0].calls.hand(self.session, frame, frame)
                return
            if name in self._goals or name in self._followed or len(self._goals) + len(self._followed) >= MOST_CALLS:
                raise InputError(f"a goal {name[:40]!r} is active, or there are too many")
            if any(item.name == action for item in self.graph.interface.actions):
                self._followed[name] = self._follow(frame, action, name, values)
                return
            if action != SIMULATE_STEPS:
                raise InputError(f"there is no action {action[:60]!r}")
            steps = values.get("steps", 1) if isinstance(values, dict) else values[0] if values else 1
            if isinstance(steps, bool) or not isinstance(steps, int) or steps < 1:
                raise InputError("steps must be a whole number from 1")
            self._go_on(frame, 0, steps)
            self._goals[name] = True
        except InputError as error:
            self._result(frame, {}, ABORTED, False, str(error))

    def _follow(self, frame: Frame, action: str, name: str, values: Any) -> ServiceCall:
        """Hand a goal to a robot; feedback and result come in the thread of the graph."""
        later, followed = self.graph.later, self._followed

        def tell(fields: dict[str, Any]) -> None:
            if name in followed:
                self._feedback(frame, fields)

        def finish(response: dict[str, Any]) -> None:
            if followed.pop(name, None) is not None:
                state, end = response["status"], response["result"]
                good = state != REJECTED
                self._result(frame, end, state if good else ABORTED, good, end["error_string"])

        return self.graph.inbox.call(
            action,
            values if isinstance(values, dict) else {},
            lambda response: later(finish, response),
            "rosbridge",
            (lambda fields: later(tell, fields)) if frame.get("feedback") else lambda fields: None,
        )

    def _go_on(self, frame: Frame, done: int, steps: int) -> None:
        """Do the next portion of the steps of a goal."""
        portion = min(max(1, steps // PORTIONS), steps - done)

        def finish(response: dict[str, Any]) -> None:
            name = str(frame.get("id", ""))
            if name not in self._goals:
                return
            good, now = response["result"]["result"] == 1, done + portion
            if frame.get("feedback") and good:
                values = {"completed_steps": now, "remaining_steps": steps - now}
                self._feedback(frame, values)
            if good and now < steps and self._goals[name]:
                self._go_on(frame, now, steps)
                return
            going = self._goals.pop(name)
            state = ABORTED if not good else SUCCEEDED if going else CANCELED
            self._result(frame, {"result": response["result"]}, state, good)

        self._ask(STEP, {"steps": portion}, finish)

    def _cancel_goal(self, frame: Frame) -> None:
        action, name = field(frame, "action", str), field(frame, "id", str, "")
        if action in self.graph.actions and self.graph.actions[action][0].calls.cancel(self.session, name, action):
            return
        if name in self._followed:
            self._followed[name].canceled = True
            self.graph.inbox.wake()
            return
        if name not in self._goals:
            raise InputError(f"there is no goal {name[:60]!r}")
        self._goals[name] = False

    def _feedback(self, frame: Frame, values: Frame) -> None:
        name = _identity(frame)
        self.session.reply({"op": "action_feedback", **name, "action": frame["action"], "values": values})

    def _result(self, frame: Frame, values: Any, state: int, good: bool, text: str = "") -> None:
        name = _identity(frame)
        row = {"op": "action_result", **name, "action": frame["action"], "status": state, "result": good}
        self.session.reply({**row, "values": values if good else text or values})


def _identity(frame: Frame) -> dict[str, Any]:
    """Return the id of a frame, if it is one."""
    name = frame.get("id")
    return {"id": name} if isinstance(name, str | int) else {}
