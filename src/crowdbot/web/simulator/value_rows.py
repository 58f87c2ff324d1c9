"""Values of a trial by their paths, and parameters of built-in trials, as rows of a form."""

from __future__ import annotations

import dataclasses
from collections.abc import Iterator
from typing import Any

from crowdbot.core import builtin_classes, builtin_name
from crowdbot.trials import PRESETS, Trial, outline

AT_START = (
    "name", "about", "seed", "world", "physics-step", "bodies", "step", "capacity", "spawner", "agent", "recorded",
    "avatar", "journey", "sweep", "camera", "recording", "duration",
)  # fmt: skip
"""Parts of a trial that an order cannot change or that are not worth it."""
ROBOT_START = ("name", "type", "x", "y", "heading", "pose")
MOST = 2000


def value_rows(trial: Trial) -> list[dict[str, Any]]:
    """Return the values of a trial: path as for ``--set``, text, kind, unit, range, choices, note.

    ``live`` says whether the value can change while the trial runs.

    >>> from crowdbot.trials import load_trial
    >>> rows = {row["path"]: row for row in value_rows(load_trial("frontal"))}
    >>> rows["robot/goal/x"]["unit"], rows["robot/navigator/type"]["live"], rows["step"]["live"]
    ('m', True, False)
    """
    return [row for _, row in zip(range(MOST), _rows(trial, ""), strict=False)]


def _rows(thing: Any, path: str) -> Iterator[dict[str, Any]]:
    cls: type = type(thing)
    for part in outline(cls):
        value = getattr(thing, part.name)
        where = f"{path}/{part.word}" if path else part.word
        if part.role == "attribute":
            yield _attribute_row(where, part, value)
        elif part.role == "child" and value is not None:
            yield from _rows(value, where)
        elif part.role == "children":
            ones = part.into.spread(value) if part.into else value
            words = [_word(part, item) for item in ones]
            for k, (item, word) in enumerate(zip(ones, words, strict=True)):
                number = 1 + words[:k].count(word)
                which = f"[{getattr(item, 'name', '') or number}]" if words.count(word) > 1 else ""
                yield from _rows(item, f"{path}/{word}{which}" if path else f"{word}{which}")
        elif part.role == "plugged" and value is not None:
            yield from _plug_rows(where, part, value)
        elif part.role == "mounted" and value is not None:
            yield from _plug_rows(path, part, value)


def _word(part: Any, value: Any) -> str:
    words: dict[str, Any] = dict(part.elements)
    return next(word for word, kind in words.items() if isinstance(value, kind))


def _attribute_row(path: str, part: Any, value: Any) -> dict[str, Any]:
    rule = part.rule
    row: dict[str, Any] = {"path": path, "text": _text(value), "live": _is_live(path), "note": part.about}
    row |= {"kind": _kind(part.kind, value), "unit": "" if rule is None else rule.unit}
    if rule is not None and rule.choices:
        row |= {"kind": "choice", "choices": list(rule.choices)}
    if rule is not None:
        row |= {"low": rule.min if rule.min is not None else rule.exclusive_min, "high": rule.max}
    return row


def _plug_rows(path: str, part: Any, value: Any) -> Iterator[dict[str, Any]]:
    room, contract = part.plug.places()
    names = list(builtin_classes(room, contract))
    own = builtin_name(type(value), contract)
    live = _is_live(f"{path}/type")
    yield {
        "path": f"{path}/type", "text": own, "kind": "choice", "live": live, "unit": "", "note": part.about,
        "choices": names if own in names else [own, *names],
    }  # fmt: skip
    for field in dataclasses.fields(value) if dataclasses.is_dataclass(value) else ():
        inner = getattr(value, field.name)
        if not field.init or not isinstance(inner, bool | int | float | str):
            continue
        table = field.metadata.get("parameter")
        row: dict[str, Any] = {"path": f"{path}/{field.name.replace('_', '-')}", "text": _text(inner), "live": live}
        row |= {"kind": _kind(type(inner), inner), "unit": "", "note": ""}
        if table is not None:
            row |= {"unit": "" if table.unit == "1" else table.unit, "low": table.min, "high": table.max}
            row["note"] = table.source
        yield row


def _is_live(path: str) -> bool:
    first, _, rest = path.partition("/")
    first = first.partition("[")[0]
    return first not in AT_START and not (first == "robot" and rest.partition("/")[0] in ROBOT_START)


def _kind(kind: Any, value: Any) -> str:
    if kind is bool or isinstance(value, bool):
        return "switch"
    if kind is int:
        return "whole"
    return "number" if kind is float else "text"


def _text(value: Any) -> str:
    if value is None:
        return ""
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.12g}" if isinstance(value, float) else str(value)


def parameter_rows(name: str) -> list[dict[str, Any]]:
    """Return the parameters of a built-in trial as rows of a form."""
    preset = PRESETS.get(name)
    rows: list[dict[str, Any]] = []
    for key, item in preset.options.items() if preset is not None else ():
        kinds = {bool: "switch", int: "whole", float: "number", str: "text"}
        row = {
            "name": key,
            "label": item.about,
            "unit": item.unit,
            "value": item.default,
            "kind": kinds[type(item.default)],
        }
        low, high = item.low, item.high
        row |= {} if abs(low) == float("inf") else {"low": low}
        row |= {} if abs(high) == float("inf") else {"high": high}
        rows.append(row | ({"kind": "choice", "choices": list(item.choices)} if item.choices else {}))
    return rows
