"""Rows of forms, made from the tables of models, searches, predictors and degradations."""

from __future__ import annotations

import dataclasses
import importlib
import types
import typing
from collections.abc import Mapping
from typing import Any

from crowdbot import calibration, models, prediction
from crowdbot.core import (
    InputError,
    Parameter,
    builtin_classes,
    did_you_mean,
    field_units,
    parameters,
    required_fields,
)
from crowdbot.data import PROTOCOLS, Degradation

Row = dict[str, Any]

LEARN = "needs a learning part of the recording"
CHOICES = {
    "fold": ("auto", "eth", "hotel", "univ", "zara1", "zara2"),
    "checkpoint": ("auto", "eth", "hotel", "univ", "zara1", "zara2"),
    "of": ("person", "frame"),
}
"""Values of text fields. Files are not among them: the browser may not name files of the server."""
HIDDEN = ("file", "device", "sample", "model", "goal", "cost", "search", "budget", "free", "prior")


def builtin_kinds(kind: str) -> dict[str, type]:
    """Return the built-in classes of a kind that can be made from numbers and words alone, by name.

    Args:
        kind: ``models``, ``goals``, ``costs``, ``searches``, ``predictors`` or ``degradations``.

    >>> "orca" in builtin_kinds("models"), "mixture" in builtin_kinds("models")
    (True, False)
    """
    rooms: dict[str, tuple[types.ModuleType, type]] = {
        "models": (models, models.CrowdModel),
        "goals": (models.goals, models.Goal),
        "costs": (calibration, calibration.Cost),
        "searches": (calibration, calibration.Search),
        "predictors": (prediction, prediction.Predictor),
        "degradations": (importlib.import_module("crowdbot.data.degrade"), Degradation),
    }
    found = builtin_classes(*rooms[kind])
    late = {name for name, one in found.items() if issubclass(one, models.Goal) and (one.knows_future or one.learns)}
    return {name: one for name, one in found.items() if name in late or not required_fields(one)}


def form_rows(cls: type) -> list[Row]:
    """Return the fields of a dataclass that are numbers, switches or choices, for a form of the page.

    >>> from crowdbot.models import ORCA
    >>> row = {row["name"]: row for row in form_rows(ORCA)}["time_horizon"]
    >>> row["unit"], row["kind"]
    ('s', 'number')
    """
    table = {row.name: row for row in parameters(cls)}
    hints, units = typing.get_type_hints(cls), field_units((cls,))
    rows = []
    for field in dataclasses.fields(cls):
        if not field.init or field.default is dataclasses.MISSING:
            continue
        if field.name in table:
            rows.append(_parameter_row(table[field.name], hints[field.name] is int))
        elif field.name not in HIDDEN:
            rows += _plain_row(field.name, field.default, hints[field.name], units.get(field.name, "1"))
    return rows


def written_values(cls: type, values: Mapping[str, Any], what: str) -> dict[str, str]:
    """Return the values that differ from their defaults as words of the command line.

    Raises:
        InputError: a name is not a row of the form, or a value is not of its kind.
    """
    rows = {row["name"]: row for row in form_rows(cls)}
    result = {}
    for name, value in values.items():
        if name not in rows:
            raise InputError(f"{what} has no parameter {name!r}{did_you_mean(name, rows)}; it has {', '.join(rows)}")
        row = rows[name]
        if value is None or value == row["value"]:
            continue
        if row["kind"] == "choice" and value not in row["choices"]:
            raise InputError(f"{what}: {name} = {value!r} is unknown; known are {', '.join(row['choices'])}")
        if isinstance(value, bool) != (row["kind"] == "switch") or not isinstance(value, bool | int | float | str):
            raise InputError(f"{what}: {name} = {value!r:.60} is not a value of this parameter")
        result[name] = str(value).lower() if isinstance(value, bool) else str(value)
    return result


def scheme_tables() -> dict[str, Any]:
    """Return all lists of the dialogs, as `crowdbot list` shows them, with a form for each entry.

    >>> [row["name"] for row in scheme_tables()["predictors"] if row["samples"]]
    ['anchor-net', 'anchors', 'sampled-constant-velocity', 'social-ways']
    >>> [row["name"] for row in scheme_tables()["predictors"] if row["learned"]]
    ['anchor-net', 'anchors', 'social-ways']
    """
    lists = {kind: _listing(kind) for kind in ("models", "goals", "costs", "searches", "predictors", "degradations")}
    predictors = builtin_kinds("predictors")
    for row in lists["predictors"]:
        kind = predictors[row["name"]]
        row["samples"], row["learned"] = kind.draws, kind.learned  # type: ignore[attr-defined]
        row["weights"] = row["name"] in prediction.WEIGHTS_FIELDS
    lists["predictors"] = [row for row in lists["predictors"] if row["name"] != "simulated"]
    for row in lists["models"]:
        row["free"] = [*calibration.ParameterSpace(builtin_kinds("models")[row["name"]]()).names]
    for row in lists["degradations"]:
        kind = builtin_kinds("degradations")[row["name"]]
        row["level"], row["levels"] = kind.level, list(kind.levels)  # type: ignore[attr-defined]
    protocols = [{"name": name, "about": str(about)} for name, about in PROTOCOLS.items()]
    return {**lists, "protocols": protocols, "crowd": form_rows(prediction.Simulated)}


def _listing(kind: str) -> list[dict[str, Any]]:
    from crowdbot.catalogue import builtin_names

    about = builtin_names(kind)[kind]
    rows = []
    for name, item in builtin_kinds(kind).items():
        row = {"name": name, "about": about[name], "parameters": form_rows(item) if kind != "goals" else []}
        if kind == "goals" and item.learns:  # type: ignore[attr-defined]
            row["about"] = f"{about[name]} ({LEARN})"
        rows.append(row)
    return rows


def _parameter_row(row: Parameter, whole: bool) -> Row:
    note = f"calibrated from {row.low:g} to {row.high:g}; {row.source}" if row.high > row.low else row.source
    found: Row = {
        "name": row.name, "label": _label(row.name), "kind": "whole" if whole else "number", "value": row.default,
        "low": row.min, "note": note,
    }  # fmt: skip
    if row.max is not None:
        found["high"] = row.max
    return found | ({} if row.unit == "1" else {"unit": row.unit})


def _plain_row(name: str, value: Any, hint: Any, unit: str) -> list[Row]:
    kind = {bool: "switch", int: "whole", float: "number"}.get(hint)
    if hint is str and name in CHOICES:
        return [{"name": name, "label": _label(name), "kind": "choice", "value": value, "choices": [*CHOICES[name]]}]
    if hint is str and name == "variant":
        kind = "text"
    row: Row = {"name": name, "label": _label(name), "kind": kind, "value": value}
    return [row | ({} if unit == "1" else {"unit": unit})] if kind else []


def _label(name: str) -> str:
    words = name.replace("_", " ")
    return words[:1].upper() + words[1:]
