"""JSON has no NaN and no infinity: numbers that are not finite become null on their way to a browser."""

from __future__ import annotations

import dataclasses
import math
from typing import Any

import numpy as np


def plain_number(value: Any) -> float | int | None:
    """Return a number for JSON; None where it is not finite."""
    number = value.item() if isinstance(value, np.generic) else value
    return number if number is None or math.isfinite(number) else None


def clean_json(value: Any) -> Any:
    """Return a value with None in the place of numbers that are not finite."""
    if isinstance(value, float):
        return plain_number(value)
    if isinstance(value, dict):
        return {key: clean_json(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [clean_json(item) for item in value]
    return (
        clean_json(dataclasses.asdict(value))
        if dataclasses.is_dataclass(value) and not isinstance(value, type)
        else value
    )
