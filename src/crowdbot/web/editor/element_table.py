"""Element table: the elements and attributes of trial files, for the forms of the editor."""

from __future__ import annotations

import dataclasses
import functools
import math
from typing import Any

from crowdbot.core import builtin_classes
from crowdbot.trials import Distribution, Points, Trial, outline


@functools.cache
def element_table() -> dict[str, Any]:
    """Return what each element takes, made from the same outline as the reader and the schema, as JSON.

    The result has a row for each kind of element: ``about``, ``attributes`` (rows of a form: name, kind, value, unit,
    low, high, choices, required, note), ``children`` (kind by XML name) and, for elements with ``type``, ``types`` with
    the attributes of each built-in name. The kind of the root is ``Trial``.

    >>> table = element_table()
    >>> table["Trial"]["children"]["robot"], table["RobotSpec"]["children"]["navigator"]
    ('RobotSpec', 'navigation.Navigator')
    """
    table: dict[str, Any] = {}
    _add_kind(Trial, table)
    return table


def _add_kind(cls: type, table: dict[str, Any]) -> str:
    name = cls.__name__
    if name in table:
        return name
    row: dict[str, Any] = {"about": _first_line(cls), "attributes": [], "children": {}}
    table[name] = row
    for part in outline(cls):
        if part.role == "attribute":
            row["attributes"].append(_attribute(part))
        elif part.role in ("child", "children"):
            row["children"] |= {word: _add_kind(kind, table) for word, kind in part.elements.items()}
        elif part.role == "plugged":
            row["children"][part.word] = _add_plugin(part.plug, table)
        else:
            row["types"] = _types(part.plug)
    return name


def _add_plugin(plug: Any, table: dict[str, Any]) -> str:
    name = f"{plug.room}.{plug.contract}"
    if name not in table:
        _, contract = plug.places()
        table[name] = {"about": _first_line(contract), "attributes": [], "children": {}, "types": _types(plug)}
    return name


def _types(plug: Any) -> dict[str, Any]:
    room, contract = plug.places()
    return {
        name: {
            "about": _first_line(cls),
            "attributes": [_field(field) for field in dataclasses.fields(cls) if field.init],
        }
        for name, cls in builtin_classes(room, contract).items()
    }


def _first_line(cls: type) -> str:
    return (cls.__doc__ or "").strip().partition("\n")[0]


def _attribute(part: Any) -> dict[str, Any]:
    rule = part.rule
    row = {"name": part.word, "label": part.word, "note": part.about, "required": part.required}
    row |= {"unit": rule.unit, "value": None if part.required else _plain(part.default), "kind": "text"}
    if rule.choices:
        row |= {"kind": "choice", "choices": list(rule.choices)}
    elif part.kind is bool:
        row["kind"] = "switch"
    elif part.kind in (int, float):
        low = rule.min if rule.exclusive_min is None else rule.exclusive_min
        row |= {"kind": "whole" if part.kind is int else "number", "low": low, "high": rule.max}
    elif part.kind is Points:
        row["kind"] = "points"
    elif part.kind is Distribution:
        row["kind"] = "distribution"
    return row


def _field(one: Any) -> dict[str, Any]:
    has = one.default is not dataclasses.MISSING
    default = one.default if has else None
    kind = {bool: "switch", int: "whole", float: "number"}.get(type(default), "text")
    word = one.name.replace("_", "-")
    return {"name": word, "label": word, "kind": kind, "value": _plain(default), "required": not has}


def _plain(value: Any) -> Any:
    if isinstance(value, bool | int | str) or value is None:
        return value
    if isinstance(value, float):
        return value if math.isfinite(value) else str(value)
    return str(value)
