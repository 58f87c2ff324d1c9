"""Layers of small perceptrons: read from a file, and run with NumPy."""

from __future__ import annotations

import functools
import importlib.resources
from pathlib import Path
from zipfile import BadZipFile

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import DataError
from crowdbot.typing import Floats

Layers = tuple[NDArray[np.float32], ...]
"""Weights ``[I, O]`` and biases ``[O]`` of the layers, in turn."""

LARGEST = 5_000_000
"""Largest size of a file of weights [bytes]."""


@functools.lru_cache(maxsize=8)
def read_layers(file: str, built_in: str, owner: str, inputs: int, outputs: int) -> Layers:
    """Return weights and biases of the layers in a file with the arrays ``layer0``, ``layer1`` and so on.

    Args:
        file: the file (.npz); empty for the built-in one.
        built_in: name of the built-in file.
        owner: class of the weights, for error messages.
        inputs, outputs: number of values of the first and of the last layer.

    Raises:
        DataError: the file cannot be read, or does not fit.
    """
    shipped = importlib.resources.files("crowdbot") / "assets/perception" / built_in
    with importlib.resources.as_file(shipped) as own:
        path = Path(file) if file else own
        try:
            if path.stat().st_size > LARGEST:
                raise DataError(f"{path}: a file of weights has at most {LARGEST / 1e6:g} MB")
            with np.load(path, allow_pickle=False) as stored:
                layers = tuple(stored[f"layer{k}"].astype(np.float32) for k in range(min(12, len(stored.files))))
        except (OSError, ValueError, KeyError, BadZipFile, EOFError) as error:
            raise DataError(f"{path} has no weights of {owner}: {error}") from None
    width, fits = inputs, len(layers) >= 2 and len(layers) % 2 == 0
    for k in range(0, len(layers) - 1, 2):
        fits = fits and layers[k].ndim == 2 and len(layers[k]) == width and layers[k + 1].shape == layers[k].shape[1:]
        width = layers[k].shape[-1] if fits else 0
    if not fits or width != outputs or not all(np.isfinite(layer).all() for layer in layers):
        raise DataError(f"{path} has no weights of {owner}: the shapes {[layer.shape for layer in layers]} do not fit")
    return layers


def run_layers(layers: Layers, inputs: Floats) -> Floats:
    """Return the outputs ``[B, O]`` of inputs ``[B, I]``, with rectifiers between the layers."""
    value = inputs.astype(np.float32)
    for k in range(0, len(layers), 2):
        value = value @ layers[k] + layers[k + 1]
        if k + 2 < len(layers):
            np.maximum(value, 0.0, out=value)
    return value.astype(np.float64)
