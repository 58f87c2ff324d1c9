"""NetworkWeights: the layers of a learned navigator, as arrays in a NumPy file that executes no code when read."""

from __future__ import annotations

import functools
import importlib.resources
import itertools
import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, ClassVar, Self

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

from .policy_kernels import OWN_VALUES, PERSON_VALUES

Singles = NDArray[np.float32]

LAYERS = (64, 64, 128)
"""Widths of the first and second layer of a person, and of the layers after the pooling."""
FORMAT = 1
PARTS = ("weight", "bias")


def dense_layers(name: str, *sizes: int) -> dict[str, tuple[int, int]]:
    """Return inputs and outputs of fully connected layers in a row by their names.

    >>> dense_layers("action", 70, 128, 2)
    {'action1': (70, 128), 'action2': (128, 2)}
    """
    return {f"{name}{k}": pair for k, pair in enumerate(itertools.pairwise(sizes), start=1)}


@dataclass(frozen=True)
class NetworkWeights:
    """Weights ``[in, out]`` and biases ``[out]`` of the layers of a network, float32, in the order of its kernel."""

    navigator: ClassVar[str]
    """Name of the navigator, and of the file of its weights in the package."""
    training: ClassVar[str] = "examples/train_navigator.py"
    """The example that makes such weights."""
    widths: ClassVar[Mapping[str, tuple[int, int]]]
    """Inputs and outputs of every layer by its name."""

    @classmethod
    def shapes(cls) -> dict[str, tuple[int, ...]]:
        """Return the shape of every array by its name.

        >>> PolicyWeights.shapes()["action3_weight"]
        (128, 2)
        """
        rows = cls.widths.items()
        return {f"{k}_{part}": size for k, (a, b) in rows for part, size in zip(PARTS, ((a, b), (b,)), strict=True)}

    @classmethod
    def of_layers(cls, layers: Mapping[str, tuple[Any, Any]]) -> Self:
        """Return the weights from a weight ``[in, out]`` and a bias of every layer by its name."""
        pairs = ((f"{k}_{part}", value) for k, pair in layers.items() for part, value in zip(PARTS, pair, strict=True))
        return cls(**{name: np.array(value, np.float32) for name, value in pairs})

    def save(self, file: Path, card: Mapping[str, Any]) -> None:
        """Write a file of weights with a card: how they were made, as plain values."""
        text = json.dumps({"format": FORMAT, "card": dict(card)}, sort_keys=True)
        draft = file.with_name(f"{file.name}.part")
        with draft.open("wb") as stream:
            arrays: dict[str, Any] = {name: np.asarray(value, np.float32) for name, value in vars(self).items()}
            np.savez(stream, content=np.frombuffer(text.encode(), dtype=np.uint8), **arrays)
        os.replace(draft, file)

    @classmethod
    def read(cls, file: Path) -> tuple[Self, dict[str, Any]]:
        """Return the weights and the card of a file.

        Raises:
            InputError: the file is missing, damaged, of another format, or its arrays have other shapes.
        """
        if not file.is_file():
            raise InputError(f"there is no file {file}; make one with {cls.training} --out DIR")
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
        return cls(**{name: arrays[name] for name in cls.shapes()}), card

    def layers(self) -> tuple[NDArray[np.float64], ...]:
        """Return the arrays for the kernels, in their order."""
        return tuple(np.ascontiguousarray(getattr(self, name), dtype=np.float64) for name in self.shapes())


@dataclass(frozen=True)
class PolicyWeights(NetworkWeights):
    """Layers of the navigator ``policy``."""

    navigator: ClassVar[str] = "policy"
    widths: ClassVar[Mapping[str, tuple[int, int]]] = dense_layers(
        "person", len(OWN_VALUES) + len(PERSON_VALUES), *LAYERS[:2]
    ) | dense_layers("action", LAYERS[1] + len(OWN_VALUES), LAYERS[2], LAYERS[2], 2)

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


def policy_file(navigator: str = PolicyWeights.navigator) -> Path:
    """Return the file of the weights of a learned navigator that are part of the package.

    >>> policy_file().name
    'policy.npz'
    """
    return Path(str(importlib.resources.files("crowdbot").joinpath("assets", "navigators", f"{navigator}.npz")))


def read_layers(kind: type[NetworkWeights], file: str) -> tuple[NDArray[np.float64], ...]:
    """Return the layers of a file of weights for the kernels; ``""`` is the file of the package.

    A file is read once, and again after it has changed.
    """
    path = Path(file) if file else policy_file(kind.navigator)
    changed = path.stat().st_mtime_ns if path.is_file() else 0
    return _layers(kind, path, changed)  # type: ignore[arg-type]  # classes are hashable


@functools.lru_cache(maxsize=16)
def _layers(kind: type[NetworkWeights], path: Path, changed: int) -> tuple[NDArray[np.float64], ...]:
    return kind.read(path)[0].layers()
