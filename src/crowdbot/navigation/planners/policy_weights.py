"""PolicyWeights: the layers of the learned policy, as arrays in a NumPy file that executes no code when read."""

from __future__ import annotations

import functools
import importlib.resources
import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .policy_kernels import OWN_VALUES, PERSON_VALUES

Singles = NDArray[np.float32]

LAYERS = (64, 64, 128)
"""Widths of the first and second layer of a person, and of the layers after the pooling."""
FORMAT = 1


class PolicyWeights(NamedTuple):
    """Weights ``[in, out]`` and biases ``[out]`` of the layers, float32."""

    person1_weight: Singles
    person1_bias: Singles
    person2_weight: Singles
    person2_bias: Singles
    action1_weight: Singles
    action1_bias: Singles
    action2_weight: Singles
    action2_bias: Singles
    action3_weight: Singles
    action3_bias: Singles

    @classmethod
    def shapes(cls) -> dict[str, tuple[int, ...]]:
        """Return the shape of every array by its name.

        >>> PolicyWeights.shapes()["action3_weight"]
        (128, 2)
        """
        person, pooled, wide = LAYERS
        own = len(OWN_VALUES)
        widths = ((own + len(PERSON_VALUES), person), (person, pooled), (pooled + own, wide), (wide, wide), (wide, 2))
        rows = [shape for size in widths for shape in (size, (size[1],))]
        return dict(zip(cls._fields, rows, strict=True))

    def save(self, file: Path, card: Mapping[str, Any]) -> None:
        """Write a file of weights with a card: how they were made, as plain values."""
        text = json.dumps({"format": FORMAT, "card": dict(card)}, sort_keys=True)
        draft = file.with_name(f"{file.name}.part")
        with draft.open("wb") as stream:
            arrays: dict[str, Any] = {name: np.asarray(value, np.float32) for name, value in self._asdict().items()}
            np.savez(stream, content=np.frombuffer(text.encode(), dtype=np.uint8), **arrays)
        os.replace(draft, file)

    @classmethod
    def read(cls, file: Path) -> tuple[PolicyWeights, dict[str, Any]]:
        """Return the weights and the card of a file.

        Raises:
            InputError: the file is missing, damaged, of another format, or its arrays have other shapes.
        """
        if not file.is_file():
            raise InputError(f"there is no file {file}; make one with examples/train_navigator.py --out DIR")
        try:
            with file.open("rb") as stream, np.load(stream, allow_pickle=False) as entries:
                arrays = {name: entries[name] for name in entries.files}
            text = json.loads(arrays.pop("content").tobytes().decode())
            version, card = text["format"], text["card"]
        except Exception as why:  # NumPy raises many kinds of errors at damaged files
            raise InputError(f"{file} has no weights of a policy ({type(why).__name__}: {str(why)[:80]})") from None
        if version != FORMAT:
            raise InputError(f"{file} has format {version}, this crowdbot reads {FORMAT}; train again")
        for name, shape in cls.shapes().items():
            found = arrays.get(name)
            if found is None or found.shape != shape or found.dtype != np.float32 or not np.isfinite(found).all():
                raise InputError(f"{file}: {name} must be {list(shape)} finite numbers of type float32; train again")
        return cls(**{name: arrays[name] for name in cls._fields}), card

    def layers(self) -> tuple[NDArray[np.float64], ...]:
        """Return the arrays for the kernels, in their order."""
        return tuple(np.ascontiguousarray(value, dtype=np.float64) for value in self)


def policy_file() -> Path:
    """Return the file of the weights that are part of the package.

    >>> policy_file().name
    'policy.npz'
    """
    return Path(str(importlib.resources.files("crowdbot").joinpath("assets", "navigators", "policy.npz")))


def read_policy(file: str) -> tuple[NDArray[np.float64], ...]:
    """Return the layers of a file of weights for the kernels; ``""`` is the file of the package.

    A file is read once, and again after it has changed.
    """
    path = Path(file) if file else policy_file()
    changed = path.stat().st_mtime_ns if path.is_file() else 0
    return _layers(path, changed)


@functools.lru_cache(maxsize=16)
def _layers(path: Path, changed: int) -> tuple[NDArray[np.float64], ...]:
    return PolicyWeights.read(path)[0].layers()
