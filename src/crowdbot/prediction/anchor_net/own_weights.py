"""Weights of AnchorNet, shipped arrays or checkpoints of ``crowdbot train``, and the shapes they must have."""

from __future__ import annotations

import functools
from collections.abc import Mapping
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.prediction.pretrained_weights import ALL, FOLDS, OPEN, Numbers, load_pretrained, read_weights
from crowdbot.prediction.training.checkpoint import load_checkpoint

from .agent_frame import AGENT_FEATURES, NEIGHBOR_FEATURES, PREDICTED_ROWS, SPEED_CLASSES
from .plan_reaction import SHAPES, PlanReaction

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


NO_REACTION = "none"


def load_own_weights(file: str) -> Numbers:
    """Return the arrays of a file of weights; files that did not change are read once.

    Raises:
        DataError: the file is missing or damaged, or has other arrays than those of AnchorNet.
    """
    changed = Path(file).stat().st_mtime_ns if Path(file).is_file() else 0
    known = _KNOWN.get(file)
    if known is None or known[0] != changed:
        numbers = read_weights(Path(file))
        if "content" in numbers:  # a checkpoint of crowdbot train
            numbers = _checkpoint_weights(file)
        wrong = wrong_array(numbers)
        if wrong:
            raise DataError(f"{file} is not a file of AnchorNet weights: {wrong}")
        _KNOWN[file] = known = changed, numbers
    return known[1]


def load_start_weights(name: str) -> Numbers:
    """Return the weights from which a training starts.

    Args:
        name: a file, or the fold of shipped weights: ``open``, ``all`` or a place.

    Raises:
        DataError: see :func:`load_own_weights`; or the weights learned from unbounded features of near neighbors, which
            no training has.

    >>> sorted(load_start_weights("open"))[:3]
    ['alone', 'basis', 'both_1_bias']
    """
    numbers = load_pretrained("anchor-net", name) if name in (OPEN, ALL, *FOLDS) else load_own_weights(name)
    if "unbounded" in numbers:
        raise DataError(f"a training cannot start from the weights {name}; start from {OPEN}, a place or a file")
    return numbers


def load_reaction(name: str) -> Numbers:
    """Return the coefficients of the reaction to the plan of a robot: ``open``, ``none``, or those of a file.

    Raises:
        DataError: the file is missing or damaged, or has other arrays.

    >>> load_reaction("none"), sorted(load_reaction("open"))[-1]
    ({}, 'reaction_room')
    """
    if name == NO_REACTION:
        return {}
    if name == OPEN:
        return load_pretrained("plan-reaction", OPEN)
    changed = Path(name).stat().st_mtime_ns if Path(name).is_file() else 0
    return _reaction_of(name, changed)


@functools.lru_cache(maxsize=16)
def _reaction_of(name: str, changed: int) -> Numbers:
    """Return the coefficients in a file; ``changed`` is its time stamp."""
    del changed
    numbers = read_weights(Path(name))
    wanted = {f"reaction_{field}": (SHAPES,) for field in PlanReaction._fields} | {"reaction_room": ()}
    shapes = {key: values.shape for key, values in numbers.items()}
    if shapes != wanted:
        raise DataError(f"{name} is not a file of a reaction to plans: it has {shapes}, it must have {wanted}")
    return numbers


_KNOWN: dict[str, tuple[int, Numbers]] = {}


def _checkpoint_weights(file: str) -> Numbers:
    """Return the weights in a checkpoint."""
    try:
        weights = load_checkpoint(file, "anchor-net")["weights"]
        numbers = {name: np.asarray(values, dtype=np.float64) for name, values in weights.items()}
    except (KeyError, TypeError, ValueError, AttributeError):
        raise DataError(f"{file} has no AnchorNet weights; train again") from None
    bad = next((name for name, values in numbers.items() if not np.all(np.isfinite(values))), None)
    if bad is not None:
        raise DataError(f"{file}: {bad} has values that are not finite; the file is damaged")
    return numbers
