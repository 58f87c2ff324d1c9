"""Spawning: people, robots and props that other programs add."""

from __future__ import annotations

import math
import re
import urllib.parse
from collections.abc import Mapping
from typing import Any
from xml.sax.saxutils import quoteattr

from crowdbot.bridges.commands import read_heading, read_point
from crowdbot.core import InputError
from crowdbot.simulation import AddElementOrder, AddPersonOrder, Order, Simulation
from crowdbot.world import builtin_robots, next_person

from .entities import entities
from .results import FAILED, NOT_FOUND, OK, result

NAME_NOT_UNIQUE, NAME_INVALID, NO_RESOURCE, NAMESPACE_INVALID, PARSE_ERROR, INVALID_POSE = 101, 102, 104, 105, 106, 109
"""Results of ``simulation_interfaces/SpawnResult``."""
PROPS = ("cube", "table", "tree")
SPAWNABLES = {
    "person": "a person who walks 10 m ahead; person?goal_x=5&goal_y=3&speed=1.2 sets the goal [m] and the speed [m/s]",
    **{f"robot/{name}": "a robot that is commanded from outside" for name in builtin_robots()},
    **dict.fromkeys(PROPS, "a prop"),
}
"""Resources that can be added, with a line for people."""
SOURCE = "services"
"""Source of the orders of services."""
AHEAD = 10.0


def spawnables() -> dict[str, Any]:
    """Return the response of ``GetSpawnables``."""
    rows = [
        {"entity_resource": {"uri": uri, "resource_string": ""}, "description": about, "spawn_bounds": {}}
        for uri, about in SPAWNABLES.items()
    ]
    return result(spawnables=rows)


def spawn_order(
    request: Mapping[str, Any], simulation: Simulation, waiting: int
) -> tuple[Order | None, dict[str, Any]]:
    """Return the order of a ``SpawnEntity`` request, None with an error, and the response.

    Args:
        request: fields of the request.
        simulation: the simulation.
        waiting: number of people and robots whose orders wait.
    """
    try:
        return _checked_order(request, simulation, waiting)
    except SpawnError as error:
        return None, result(error.code, str(error), entity_name="")
    except InputError as error:
        return None, result(FAILED, str(error), entity_name="")


class SpawnError(InputError):
    """An entity cannot be added, for a reason that the standard has a code for."""

    def __init__(self, code: int, text: str) -> None:
        super().__init__(text)
        self.code = code


def _checked_order(
    request: Mapping[str, Any], simulation: Simulation, waiting: int
) -> tuple[Order | None, dict[str, Any]]:
    resource = request.get("entity_resource") or request
    uri, text = str(resource.get("uri") or ""), str(resource.get("resource_string") or "")
    if not uri and not text:
        raise SpawnError(NO_RESOURCE, "give a uri or a resource_string")
    name, space = str(request.get("name") or ""), str(request.get("entity_namespace") or "").strip("/")
    taken = {one.name for one in entities(simulation)}
    renames = bool(request.get("allow_renaming"))
    if name in taken and not renames:
        raise SpawnError(NAME_NOT_UNIQUE, f"there is an entity {name[:80]!r}")
    pose = _read_pose(request.get("initial_pose") or {})
    if uri:
        order, chosen = _order(uri, name, pose, simulation, waiting, taken)
    else:
        order, chosen = _element_order(text, simulation)
    if name and chosen != name and not renames:
        raise SpawnError(NAME_INVALID, f"the entity will be {chosen!r}: leave the name empty, or allow renaming")
    if space not in ("", chosen):
        raise SpawnError(NAMESPACE_INVALID, f"the topics of an entity are under its name, {chosen!r}")
    order.check(simulation)
    return order, result(OK, entity_name=chosen)


def _read_pose(pose: Mapping[str, Any]) -> tuple[float, float, float]:
    frame = (pose.get("header") or {}).get("frame_id") or "map"
    if frame not in ("map", "world"):
        raise SpawnError(INVALID_POSE, f"the pose must be in the frame map, not {frame[:40]}")
    try:
        return *read_point(pose, "pose", "position"), read_heading(pose, "pose", "orientation")
    except InputError as error:
        raise SpawnError(INVALID_POSE, str(error)) from None


def _element_order(text: str, simulation: Simulation) -> tuple[Order, str]:
    """Return the order of an element, and its name, or the kind of element that it is."""
    order = AddElementOrder(xml=text, source=SOURCE)
    try:
        order.check(simulation)
    except InputError as error:
        raise SpawnError(PARSE_ERROR, str(error)) from None
    head = re.search(r"<([A-Za-z][\w-]*)[^>]*", text)  # behind a declaration or comment
    name = re.search(r"""\bname\s*=\s*(["'])(.*?)\1""", head[0]) if head else None
    return order, name[2] if name else head[1] if head else "element"


def _order(
    uri: str, name: str, pose: tuple[float, float, float], simulation: Simulation, waiting: int, taken: set[str]
) -> tuple[Order, str]:
    x, y, heading = pose
    kind, _, query = uri.partition("?")
    if kind == "person":
        values = {key: _number(key, text) for key, text in urllib.parse.parse_qsl(query)}
        if unknown := {*values} - {"goal_x", "goal_y", "speed", "radius"}:
            raise InputError(f"a person has no {', '.join(sorted(unknown))[:80]}; it has goal_x, goal_y, speed, radius")
        goal = {"goal_x": x + AHEAD * math.cos(heading), "goal_y": y + AHEAD * math.sin(heading)}
        person: dict[str, Any] = {**goal, **values}
        number = next_person(simulation.world) + waiting
        return AddPersonOrder(x=x, y=y, source=SOURCE, **person), f"person_{number}"
    if kind in PROPS:
        xml = f'<{kind} x="{x!r}" y="{y!r}"{f" heading={chr(34)}{heading!r}{chr(34)}" if kind != "tree" else ""}/>'
        return AddElementOrder(xml=xml, parent="stage", source=SOURCE), name or kind
    if kind in SPAWNABLES:
        _check_bodies(simulation)
        base = name or kind.removeprefix("robot/")
        name = next(word for k in range(len(taken) + 2) if (word := base if k == 0 else f"{base}_{k}") not in taken)
        xml = (
            f"<robot name={quoteattr(name)} type={quoteattr(kind.removeprefix('robot/'))} x='{x!r}' y='{y!r}'"
            f" heading='{heading!r}'><goal x='{x!r}' y='{y!r}' tolerance='0.1'/><navigator type='external'/></robot>"
        )
        return AddElementOrder(xml=xml, source=SOURCE), name
    raise SpawnError(NOT_FOUND, f"{uri[:80]!r} is not known; get_spawnables lists what can be added")


def _check_bodies(simulation: Simulation) -> None:
    try:
        simulation.world.body_scene()
    except InputError:
        raise InputError('a robot can be added to trials with bodies only: set bodies="limbs" in the trial') from None


def _number(key: str, text: str) -> float:
    try:
        return float(text)
    except ValueError:
        raise InputError(f"{key[:40]} = {text[:40]!r} must be a number") from None
