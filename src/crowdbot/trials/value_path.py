"""Value paths: the address of an attribute in a trial, for sweeps, ``--set``, branches and Python."""

from __future__ import annotations

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from crowdbot.core import Element, InputError, did_you_mean
from crowdbot.core.fields import FieldSpec, outline, quote_value

from .robots.robot_parts import replace_robot

STEP = re.compile(r"([A-Za-z][A-Za-z_-]*)(?:\[([^\[\]]+)\])?")
WORD = re.compile(r"[A-Za-z][A-Za-z0-9_-]*")


def set_values(root: Element, kind: type, values: Mapping[str, str]) -> None:
    """Set several attributes. Types are set first, since a new type removes the parameters of the old one.

    Raises:
        InputError: a path does not exist; the message names it.
    """
    for path in sorted(values, key=lambda path: _steps(path)[-1] != "type"):
        try:
            set_value(root, kind, path, values[path])
        except InputError as error:
            raise InputError(f"{quote_value(path)} {error}") from None


def set_value(root: Element, kind: type, path: str, text: str) -> None:
    """Set the attribute at a path in the XML tree of a trial.

    A path names elements and then an attribute, separated by slashes or dots, as in ``duration``,
    ``crowd/time-horizon`` or ``robot[pepper].navigator.max-speed``. Of several elements of one kind, the brackets
    select one by name or by number, counted from 1. A new ``type`` removes the parameters of the old type; the type of
    a robot brings its own body, drive and sensors, see :func:`crowdbot.trials.replace_robot`.

    Args:
        root: the trial, changed in place.
        kind: class of the trial.
        path: address of the attribute.
        text: new value as in XML.

    Raises:
        InputError: the path does not exist.

    >>> from crowdbot.trials import Trial
    >>> root = Element("trial", {}, [Element("crowd", {"type": "orca", "time-horizon": "2"})])
    >>> set_value(root, Trial, "crowd/type", "boids")
    >>> root.children[0].attributes
    {'type': 'boids'}
    """
    *steps, last = _steps(path)
    here, inside = _follow(root, kind, steps)
    _check_attribute(here, inside, last)
    if (here.tag, last) == ("robot", "type"):
        replace_robot(here, text)
        return
    if last == "type" and here.attributes.get("type") != text and _is_mounted(inside):
        own = () if inside is None else tuple(part.word for part in outline(inside) if part.role == "attribute")
        here.attributes = {key: value for key, value in here.attributes.items() if key in (*own, "name")}
    here.attributes[last] = text


def element_at(root: Element, kind: Any, path: str) -> tuple[Element, Any]:
    """Return the element at a path and its class; an optional element that is missing is created.

    Args:
        root: the trial.
        kind: class of the trial.
        path: elements as in :func:`set_value`, such as ``stage``; empty for the trial itself.

    Raises:
        InputError: the path does not exist.
    """
    return _follow(root, kind, _steps(path) if path.strip("/ ") else [])


def remove_at(root: Element, kind: Any, path: str) -> None:
    """Remove the element at a path, such as ``stage/wall[2]``.

    Raises:
        InputError: the path does not exist.

    >>> from crowdbot.trials import Trial
    >>> root = Element("trial", {}, [Element("robot", {"name": "a"}), Element("robot", {"name": "b"})])
    >>> remove_at(root, Trial, "robot[a]")
    >>> [robot.attributes for robot in root.children]
    [{'name': 'b'}]
    """
    *steps, last = _steps(path)
    parent, inside = _follow(root, kind, steps)
    element, _ = _inner(parent, inside, last, create=False)
    parent.children = [child for child in parent.children if child is not element]


def text_of(value: Any) -> str:
    """Return the XML text of a value.

    >>> text_of(True), text_of(0.5), text_of("orca")
    ('true', '0.5', 'orca')
    """
    if isinstance(value, bool | np.bool_):
        return "true" if value else "false"
    return repr(float(value)) if isinstance(value, float) else str(value)


def _steps(path: str) -> list[str]:
    """Return the steps of a path; underscores outside of brackets become hyphens."""
    parts = re.split(r"[/.](?![^\[]*\])", path.strip().strip("/"))
    return [part.partition("[")[0].replace("_", "-") + "".join(part.partition("[")[1:]) for part in parts]


def _is_mounted(kind: Any) -> bool:
    """Return whether the attributes of an element are those of the class of its ``type``."""
    return kind is None or any(part.role == "mounted" for part in outline(kind))


def _check_attribute(here: Element, kind: Any, last: str) -> None:
    if WORD.fullmatch(last) is None:
        raise InputError("is not a path; write elements and an attribute, such as robot[NAME]/goal/x")
    if kind is None or _is_mounted(kind):
        return
    words = [part.word for part in outline(kind) if part.role == "attribute"]
    if last not in words:
        meant = did_you_mean(last, words) or f"; it takes {', '.join(words)}"
        raise InputError(f"names no attribute: <{here.tag}> has no {last!r}{meant}")


def _follow(root: Element, kind: Any, steps: Sequence[str]) -> tuple[Element, Any]:
    for step in steps:
        root, kind = _inner(root, kind, step)
    return root, kind


def _inner(here: Element, kind: Any, step: str, create: bool = True) -> tuple[Element, Any]:
    """Return the element of a step, created if it is optional and missing, and its class."""
    match = STEP.fullmatch(step)
    parts = {word: part for part in (outline(kind) if kind else ()) for word in part.words}
    if match is None or match[1] not in parts:
        meant = did_you_mean(step, parts) or f"; it has {', '.join(parts)}"
        raise InputError(f"does not exist: <{here.tag}> has no element {step[:40]!r}{meant}")
    part: FieldSpec = parts[match[1]]
    inner = None if part.role == "plugged" else part.elements[match[1]]
    there = [child for child in here.children if child.tag == match[1]]
    if create and not there and part.role in ("child", "plugged"):
        there = [Element(match[1])]
        here.children.append(there[0])
    return _chosen(here, there, inner, match[1], match[2]), inner


def _chosen(here: Element, there: list[Element], kind: Any, tag: str, which: str | None) -> Element:
    names = [_name(child, kind) for child in there]
    if which is None:
        if len(there) == 1:
            return there[0]
        if not there:
            raise InputError(f"does not exist: there are 0 <{tag}>")
        choices = ", ".join(f"{tag}[{name or k}]" for k, name in enumerate(names, 1))
        raise InputError(f"is not clear: <{here.tag}> has {len(there)} <{tag}>; choose one: {choices}")
    if which in names:
        return there[names.index(which)]
    if not which.isdecimal():
        raise InputError(f"does not exist: no <{tag}> has the name {which!r}{did_you_mean(which, names)}")
    if not 1 <= int(which) <= len(there):
        raise InputError(f"does not exist: there are {len(there)} <{tag}>, numbered from 1")
    return there[int(which) - 1]


def _name(element: Element, kind: Any) -> str:
    """Return the name of an element, or its default name."""
    if "name" in element.attributes or kind is None:
        return element.attributes.get("name", "")
    return next((str(part.default) for part in outline(kind) if part.word == "name" and not part.required), "")
