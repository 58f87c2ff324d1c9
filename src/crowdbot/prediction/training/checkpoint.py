"""Checkpoints: weights, settings and the digest of the data in one file that executes no code when read.

The file is a NumPy ``.npz``: the entry ``content`` is JSON, in which ``{"$array": "a3"}`` refers to the entry ``a3``.
"""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from crowdbot.core import InputError

FORMAT = 1
"""Version of the file format."""
ARRAY, PAIRS = "$array", "$pairs"


def save_checkpoint(file: Path, kind: str, content: Mapping[str, Any]) -> None:
    """Write a checkpoint atomically.

    Args:
        file: output file; its folder is created if missing.
        kind: name of the predictor, such as ``social-ways``.
        content: nested dictionaries, lists, strings, numbers, None, arrays and tensors.
    """
    arrays: dict[str, NDArray[Any]] = {}
    text = json.dumps({"format": FORMAT, "kind": kind, "content": _pack(dict(content), arrays)}, allow_nan=True)
    file.parent.mkdir(parents=True, exist_ok=True)
    draft = file.with_name(f"{file.name}.part")
    with draft.open("wb") as stream:
        np.savez(stream, content=np.frombuffer(text.encode(), dtype=np.uint8), **arrays)  # type: ignore[arg-type]
        stream.flush()
        os.fsync(stream.fileno())
    os.replace(draft, file)


def load_checkpoint(file: Path | str, kind: str | None = None) -> dict[str, Any]:
    """Return the content of a checkpoint, with tensors as arrays.

    Raises:
        InputError: the file is missing, damaged, not a checkpoint, or has another kind or format.

    >>> import tempfile
    >>> file = Path(tempfile.mkdtemp()) / "one.npz"
    >>> save_checkpoint(file, "toy", {"weight": np.ones(2), "rows": {0: [1.5, None]}})
    >>> load_checkpoint(file, "toy")
    {'weight': array([1., 1.]), 'rows': {0: [1.5, None]}}
    """
    path = Path(file)
    if not path.is_file():
        raise InputError(f"there is no checkpoint {path}; create one with crowdbot train")
    try:
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as entries:
            arrays = {name: entries[name] for name in entries.files}
        text = json.loads(arrays.pop("content").tobytes().decode())
        content = _unpack(text["content"], arrays)
        found, version = text["kind"], text["format"]
    except Exception as why:  # NumPy raises many kinds of errors at damaged files
        raise InputError(
            f"{path} is no checkpoint of crowdbot or is damaged ({type(why).__name__}: {str(why)[:80]});"
            " train again or take another file"
        ) from None
    if version != FORMAT or not isinstance(content, dict):
        raise InputError(f"{path} has checkpoint format {version}, this crowdbot reads {FORMAT}; train again")
    if kind is not None and found != kind:
        raise InputError(f"{path} is a checkpoint of {found}, not of {kind}")
    return content


def _pack(value: Any, arrays: dict[str, NDArray[Any]]) -> Any:
    if hasattr(value, "detach"):
        value = value.detach().cpu().numpy()
    if isinstance(value, np.ndarray):
        if value.dtype.kind not in "fiub":
            raise InputError(f"a checkpoint contains arrays of numbers, not of {value.dtype}")
        name = f"a{len(arrays)}"
        arrays[name] = value
        return {ARRAY: name}
    if isinstance(value, np.generic):
        return value.item()
    if isinstance(value, dict):
        if all(isinstance(key, str) for key in value):
            return {key: _pack(item, arrays) for key, item in value.items()}
        return {PAIRS: [[key, _pack(item, arrays)] for key, item in value.items()]}
    if isinstance(value, list | tuple):
        return [_pack(item, arrays) for item in value]
    if value is None or isinstance(value, str | int | float):
        return value
    raise InputError(f"a checkpoint cannot contain a {type(value).__name__}")


def _unpack(value: Any, arrays: Mapping[str, NDArray[Any]]) -> Any:
    if isinstance(value, list):
        return [_unpack(item, arrays) for item in value]
    if not isinstance(value, dict):
        return value
    if value.keys() == {ARRAY}:
        return arrays[value[ARRAY]]
    if value.keys() == {PAIRS}:
        return {key: _unpack(item, arrays) for key, item in value[PAIRS]}
    return {key: _unpack(item, arrays) for key, item in value.items()}
