"""YAML files of robots, maps and simulators, read by PyYAML as plain data of limited size."""

from __future__ import annotations

import math
import re
from typing import Any

import yaml

from crowdbot.core.errors import InputError

MOST_LINES = 20_000
MOST_DEPTH = 20
MOST_NODES = 200_000
"""Largest number of values after all aliases are replaced by what they stand for."""
TAG = "tag:yaml.org,2002:"
SCALARS = {
    "bool": (re.compile(r"true|false|yes|no|on|off", re.IGNORECASE), "tTfFyYnNoO"),
    "int": (re.compile(r"[-+]?[0-9][0-9_]{0,99}", re.ASCII), "-+0123456789"),
    "float": (
        re.compile(
            r"[-+]?(?:[0-9][0-9_]*\.?[0-9]*|\.[0-9]+)(?:[eE][-+]?[0-9]{1,4})?|[-+]?\.(?:inf|Inf|INF)|\.(?:nan|NaN|NAN)"
        ),
        "-+.0123456789",
    ),
    "null": (re.compile(r"~|null|Null|NULL|"), ["~", "n", "N", ""]),
    "merge": (re.compile(r"<<"), "<"),
}
"""Plain words that are not texts, and the letters that they begin with.

Unlike YAML 1.1, 1e5 is a number, 010 is ten, and 12:30 and dates are texts: so parameter files mean them.
"""


def parse_yaml(text: str, place: str) -> Any:
    """Return the content of a YAML text: dictionaries, lists, strings, numbers, booleans and None.

    Anchors, aliases and merge keys are followed; tags other than ``!degrees`` and ``!radians`` are refused.

    Args:
        text: the text, one document.
        place: file name for messages.

    Raises:
        InputError: the text is not YAML, has a tag that is not supported, or is too long or nested too deeply.

    >>> parse_yaml("wheel: {radius: 0.1, turns: [1, 2]}  # m\\nangle: !degrees 180", "w.yaml")
    {'wheel': {'radius': 0.1, 'turns': [1, 2]}, 'angle': 3.141592653589793}
    """
    if text.count("\n") >= MOST_LINES:
        raise InputError(f"{place} has more than {MOST_LINES} lines, the maximum of a YAML file")
    try:
        loader = _LOADER(text)
        node = loader.get_single_node()
        if node is None:
            return None
        if _nodes(node, {}, 0) > MOST_NODES:
            raise InputError(f"{place} has more than {MOST_NODES} values with its aliases, the maximum of a YAML file")
        return loader.construct_document(node)
    except yaml.MarkedYAMLError as error:
        mark = error.problem_mark or error.context_mark
        raise InputError(f"{place}:{mark.line + 1 if mark else 1}: {error.problem or error.context}") from None
    except yaml.YAMLError as error:
        raise InputError(f"{place} is not YAML: {str(error).splitlines()[0][:200]}") from None
    except (RecursionError, _TooDeepError):
        raise InputError(f"{place} is nested more than {MOST_DEPTH} levels deep, or an alias contains itself") from None


class _TooDeepError(Exception):
    """A node is nested too deeply."""


def _nodes(node: Any, known: dict[int, int], depth: int) -> int:
    """Return the number of values of a node, those of its aliases each time that they stand there."""
    if depth > MOST_DEPTH:
        raise _TooDeepError
    if id(node) not in known:
        inner = node.value if isinstance(node, yaml.CollectionNode) else []
        rows = [part for row in inner for part in (row if isinstance(row, tuple) else (row,))]
        known[id(node)] = 1 + sum(_nodes(row, known, depth + 1) for row in rows)
    return known[id(node)]


def _refuse(node: Any, problem: str) -> yaml.MarkedYAMLError:
    return yaml.MarkedYAMLError(problem=problem, problem_mark=node.start_mark)


def _bool(loader: Any, node: Any) -> bool:
    text = str(loader.construct_scalar(node)).lower()
    if text not in ("true", "yes", "on", "false", "no", "off"):
        raise _refuse(node, f"{text[:40]!r} is not a truth value")
    return text in ("true", "yes", "on")


def _int(loader: Any, node: Any) -> int:
    value = _number(loader, node)
    if isinstance(value, int):
        return value
    raise _refuse(node, f"{value} is not a whole number")


def _number(loader: Any, node: Any) -> float | int:
    text = str(loader.construct_scalar(node)).replace("_", "").lower()
    try:
        return int(text) if text.lstrip("+-").isdigit() else float(text.replace(".inf", "inf").replace(".nan", "nan"))
    except ValueError:
        raise _refuse(node, f"{text[:40]!r} is not a number") from None


def _angle(loader: Any, node: Any) -> float:
    value = _number(loader, node)
    return math.radians(value) if node.tag == "!degrees" else float(value)


def _unknown(_loader: Any, node: Any) -> None:
    tag = node.tag.replace(TAG, "!!")
    raise _refuse(node, f"the tag {tag[:40]!r} is not supported; only !degrees and !radians are")


def _loader_class() -> Any:
    """Return PyYAML's safe loader with the scalars above, and without its other types."""
    safe = yaml.SafeLoader.yaml_constructors
    known = {TAG + name: safe[TAG + name] for name in ("map", "seq", "str", "null")}
    loader: Any = type("Loader", (yaml.SafeLoader,), {"yaml_implicit_resolvers": {}, "yaml_constructors": known})
    for name, (pattern, first) in SCALARS.items():
        loader.add_implicit_resolver(TAG + name, re.compile(rf"(?:{pattern.pattern})\Z", pattern.flags), list(first))
    for tag, construct in (("bool", _bool), ("int", _int), ("float", _number)):
        loader.add_constructor(TAG + tag, construct)
    for tag in ("!degrees", "!radians"):
        loader.add_constructor(tag, _angle)
    loader.add_constructor(None, _unknown)
    return loader


_LOADER = _loader_class()
