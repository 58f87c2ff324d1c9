"""rosapi: the services with which clients look at topics, services and message types."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import TYPE_CHECKING, Any

from rosbags.interfaces import Nodetype

from crowdbot.bridges.verbs.definitions import PACKAGE, SERVICES, interface_store, request_kind, response_kind
from crowdbot.core import InputError

from .graph import ros2_type

if TYPE_CHECKING:
    from .graph import RosGraph


NODE = "/crowdbot"
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
    return {"services": [name for name, one in graph.service_types.items() if one == kind]}


def _service_node(graph: RosGraph, request: Request) -> Answer:
    service = _text(request, "service")
    return {"node": NODE if service in graph.service_types else ""}


def _service_providers(graph: RosGraph, request: Request) -> Answer:
    kind = _text(request, "service")
    return {"providers": [name for name, one in graph.service_types.items() if one == kind]}


def _service_details(make: Callable[[Any], str]) -> Callable[[RosGraph, Request], Answer]:
    def answer(graph: RosGraph, request: Request) -> Answer:
        kind = _text(request, "type")
        for one in SERVICES.values():
            if kind in (f"{PACKAGE}/srv/{one.kind}", f"{PACKAGE}/{one.kind}"):
                return {"typedefs": type_details(make(one))}
        raise InputError(f"the service type {kind[:80]!r} is unknown")

    return answer


def _nodes(graph: RosGraph, request: Request) -> Answer:
    return {"nodes": [NODE, *(f"/rosbridge_client_{k + 1}" for k in range(len(graph.sessions)))]}


def _node_details(graph: RosGraph, request: Request) -> Answer:
    if _text(request, "node") != NODE:
        return {"subscribing": [], "publishing": [], "services": []}
    inputs = [one.name for one in graph.interface.inputs]
    outputs = [one.name for one in graph.interface.outputs]
    return {"subscribing": inputs, "publishing": outputs, "services": [one.name for one in graph.interface.services]}


def _publishers(graph: RosGraph, request: Request) -> Answer:
    topic = _text(request, "topic")
    own = [NODE] if topic in {one.name for one in graph.interface.outputs} else []
    clients = [f"/rosbridge_client_{graph.sessions.index(one) + 1}" for one in graph.advertised.get(topic, {})]
    return {"publishers": own + clients}


def _subscribers(graph: RosGraph, request: Request) -> Answer:
    topic = _text(request, "topic")
    own = [NODE] if topic in {one.name for one in graph.interface.inputs} else []
    rows = [f"/rosbridge_client_{k + 1}" for k, one in enumerate(graph.sessions) if topic in one.subscriptions]
    return {"subscribers": own + rows}


def _time(graph: RosGraph, request: Request) -> Answer:
    seconds, rest = divmod(graph.now, 10**9)
    return {"time": {"sec": seconds, "nanosec": rest, "secs": seconds, "nsecs": rest}}  # ROS 2, and ROS 1 for roslibpy


def _message_details(graph: RosGraph, request: Request) -> Answer:
    return {"typedefs": type_details(_text(request, "type"))}


def _action_servers(graph: RosGraph, request: Request) -> Answer:
    return {"action_servers": ["/crowdbot/simulate_steps", *graph.actions]}


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
