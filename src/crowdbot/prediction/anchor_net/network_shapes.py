"""Shapes of the arrays of AnchorNet; the compiled kernels rely on them."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np
from numpy.typing import NDArray

from .agent_frame import AGENT_FEATURES, NEIGHBOR_FEATURES, PREDICTED_ROWS, SPEED_CLASSES

LAYERS = ("own_1", "own_2", "query", "near_1", "near_2", "both_1", "both_2", "out")
OTHERS = ("basis", "centres", "spread", "width", "temperature", "widening", "nobody", "alone")
NEEDED = (*OTHERS, *(f"{layer}_{part}" for layer in LAYERS for part in ("weight", "bias")))


def wrong_array(numbers: Mapping[str, NDArray[np.float64]]) -> str:
    """Return what is wrong with the first array that is missing or has a wrong shape; empty if none.

    >>> wrong_array({})
    'basis is missing'
    """
    missing = [name for name in (*NEEDED, *(("share",) if "reach" in numbers else ())) if name not in numbers]
    if missing:
        return f"{missing[0]} is missing"
    for name, wanted in _shapes(numbers).items():
        if name in numbers and numbers[name].shape != wanted:
            return f"{name} has shape {list(numbers[name].shape)}, it must be {list(wanted)}"
    return ""


def _shapes(numbers: Mapping[str, NDArray[np.float64]]) -> dict[str, tuple[int, ...]]:
    """Return the shape of every array; the sizes of hidden layers and the number of anchors are free."""
    outputs = {layer: numbers[f"{layer}_bias"].size for layer in LAYERS}
    anchors = len(numbers["centres"]) if numbers["centres"].ndim else 0
    coefficients, classes = numbers["spread"].size, len(SPEED_CLASSES) + 1
    inputs = {
        "own_1": AGENT_FEATURES,
        "own_2": outputs["own_1"],
        "query": outputs["own_2"],
        "near_1": NEIGHBOR_FEATURES,
        "near_2": outputs["near_1"],
        "both_1": outputs["own_2"] + outputs["near_2"],
        "both_2": outputs["both_1"],
        "out": outputs["both_2"],
    }
    outputs["query"] = outputs["near_2"]
    outputs["out"] = anchors * coefficients + anchors + 2 * coefficients
    shapes: dict[str, tuple[int, ...]] = {
        "spread": (coefficients,),
        "centres": (anchors, coefficients),
        "width": (anchors, coefficients),
        "basis": (coefficients, 2 * PREDICTED_ROWS),
        "temperature": (classes,),
        "widening": (classes,),
        "nobody": (outputs["near_2"],),
        "alone": (outputs["near_2"],),
        "reach": (),
        "line_share": (),
        "share": (anchors,),
    }
    for layer in LAYERS:
        shapes |= {f"{layer}_weight": (inputs[layer], outputs[layer]), f"{layer}_bias": (outputs[layer],)}
    return shapes
