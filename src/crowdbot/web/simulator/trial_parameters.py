"""Parameters of built-in trials as rows of a form."""

from __future__ import annotations

from typing import Any

from crowdbot.trials import PRESETS

__all__ = ["parameter_rows"]


def parameter_rows(name: str) -> list[dict[str, Any]]:
    """Return the parameters of a built-in trial as rows of a form."""
    preset = PRESETS.get(name)
    rows: list[dict[str, Any]] = []
    for key, one in preset.options.items() if preset is not None else ():
        kinds = {bool: "switch", int: "whole", float: "number", str: "text"}
        row = {
            "name": key,
            "label": one.about,
            "unit": one.unit,
            "value": one.default,
            "kind": kinds[type(one.default)],
        }
        low, high = one.low, one.high
        row |= {} if abs(low) == float("inf") else {"low": low}
        row |= {} if abs(high) == float("inf") else {"high": high}
        rows.append(row | ({"kind": "choice", "choices": list(one.choices)} if one.choices else {}))
    return rows
