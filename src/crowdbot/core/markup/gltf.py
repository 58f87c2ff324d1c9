"""glTF files, with their arrays, images and frames; only files in the folder of the file are read."""

from __future__ import annotations

import base64
import binascii
import re
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from crowdbot.core.errors import InputError
from crowdbot.typing import Floats

from .gltf_table import COMPONENT_BYTES, VALUES, check_gltf_table, glb_table, parse_table, table_rows, whole_value

MOST_BYTES = 256_000_000
"""Largest size of a file, and of all files that it refers to."""
MOST_BUFFERS, MOST_EMPTY = 20, 1_000_000
TYPES = {5120: "<i1", 5121: "<u1", 5122: "<i2", 5123: "<u2", 5125: "<u4", 5126: "<f4"}
UNDERSTOOD = ("KHR_materials_", "KHR_texture_transform", "KHR_lights_punctual", "KHR_mesh_quantization", "KHR_xmp",
              "EXT_texture_webp", "VRM", "VRMC_")  # fmt: skip
"""Extensions without which shapes and colours are read nevertheless."""


@dataclass(frozen=True, eq=False)
class GltfFile:
    """A glTF file: its table, the contents of its buffers, and its folder.

    >>> GltfFile("a.glb", {"nodes": [{"translation": [1, 2, 3]}]}, (), Path()).frames()[0, :3, 3].tolist()
    [1.0, 2.0, 3.0]
    """

    name: str
    table: Mapping[str, Any]
    buffers: tuple[bytes, ...]
    folder: Path

    def rows(self, key: str) -> list[Mapping[str, Any]]:
        """Return a list of objects of the table.

        Raises:
            InputError: the value is something else.
        """
        try:
            return table_rows(self.table, key)
        except InputError as error:
            raise InputError(f"{self.name}: {error}") from None

    def row(self, key: str, number: Any) -> Mapping[str, Any]:
        """Return an object of a list of the table.

        Raises:
            InputError: there is no such object.
        """
        rows = self.rows(key)
        if isinstance(number, bool) or not isinstance(number, int) or not 0 <= number < len(rows):
            raise InputError(f"{self.name} names number {str(number)[:20]} of its {len(rows)} {key}")
        return rows[number]

    def array(self, number: Any) -> NDArray[Any]:
        """Return the values of an accessor ``[N, components]``; normalised integers become numbers from -1 to 1.

        Raises:
            InputError: there is no such accessor, or its kind is not supported.
        """
        one = self.row("accessors", number)
        kind, words = one.get("componentType"), one.get("type")
        if kind not in TYPES or words not in VALUES:
            raise InputError(f"{self.name}: array {number} has the type {str(kind)[:10]} {str(words)[:10]}")
        if "sparse" in one:
            raise InputError(f"{self.name}: array {number} is sparse, which is not supported; save it without")
        count, wide, each = whole_value(one, "count", 0), VALUES[words], COMPONENT_BYTES[kind]
        if one.get("bufferView") is None:
            if count * wide > MOST_EMPTY:
                raise InputError(f"{self.name}: array {number} has {count} rows without data")
            return np.zeros((count, wide))
        view = self.row("bufferViews", one["bufferView"])
        data = self._view(view)
        stride = whole_value(view, "byteStride", 0) or wide * each
        first = whole_value(one, "byteOffset", 0)
        if stride < wide * each or (count and first + (count - 1) * stride + wide * each > len(data)):
            raise InputError(f"{self.name}: array {number} is longer than its part of {len(data)} bytes")
        rows = np.ndarray((count, wide), TYPES[kind], data, first, (stride, each))
        if one.get("normalized") is True and kind != 5126:
            return np.maximum(rows / float(np.iinfo(TYPES[kind]).max), -1.0)
        return rows.astype(np.float64) if kind == 5126 else rows.copy()

    def image(self, number: Any) -> bytes:
        """Return the bytes of an image file.

        Raises:
            InputError: there is no such image, or it lies outside the folder of the file.
        """
        one = self.row("images", number)
        if "uri" in one:
            return _from_address(one["uri"], self.folder, self.name)
        return self._view(self.row("bufferViews", one.get("bufferView")))

    def frames(self) -> Floats:
        """Return the frame ``[N, 4, 4]`` of each node in the scene, without animation.

        Raises:
            InputError: a transformation is not a list of finite numbers.
        """
        nodes = self.rows("nodes")
        parent = {child: k for k, node in enumerate(nodes) for child in node.get("children", ())}
        own = [self._frame(node) for node in nodes]
        found = np.empty((len(nodes), 4, 4))
        for k in range(len(nodes)):
            whole, at = own[k], k
            while at in parent:
                at = parent[at]
                whole = own[at] @ whole
            found[k] = whole
        return found

    def _frame(self, node: Mapping[str, Any]) -> Floats:
        if "matrix" in node:
            return self._numbers(node, "matrix", 16, ()).reshape(4, 4).T
        x, y, z, w = self._numbers(node, "rotation", 4, (0.0, 0.0, 0.0, 1.0)).tolist()
        size = max(x * x + y * y + z * z + w * w, 1e-12)
        s = 2.0 / size
        turn = np.array([
            [1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)],
            [s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)],
            [s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)],
        ])  # fmt: skip
        found = np.eye(4)
        found[:3, :3] = turn * self._numbers(node, "scale", 3, (1.0, 1.0, 1.0))
        found[:3, 3] = self._numbers(node, "translation", 3, (0.0, 0.0, 0.0))
        return found

    def _numbers(self, node: Mapping[str, Any], key: str, count: int, default: tuple[float, ...]) -> Floats:
        value = node.get(key, default)
        try:
            found = np.array(value, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            found = np.zeros(0)
        if found.shape != (count,) or not np.all(np.isfinite(found)) or np.abs(found).max() > 1e6:
            raise InputError(f"{self.name}: {key} of a node must be {count} numbers of at most 1e6")
        return found

    def _view(self, view: Mapping[str, Any]) -> bytes:
        number = view.get("buffer", 0)
        if not isinstance(number, int) or not 0 <= number < len(self.buffers):
            raise InputError(f"{self.name} names number {str(number)[:20]} of its {len(self.buffers)} buffers")
        first, size = whole_value(view, "byteOffset", 0), whole_value(view, "byteLength", 0)
        data = self.buffers[number][first : first + size]
        if len(data) < size:
            raise InputError(f"{self.name}: a part ends at byte {first + size} of a buffer of fewer bytes")
        return data


def read_gltf(path: Path) -> GltfFile:
    """Read a glTF file (``.glb`` or ``.gltf``) with its buffers, up to 256 MB.

    Raises:
        InputError: the file is missing, damaged, too large or compressed, or refers to files outside its folder.
    """
    name, folder = path.name, path.parent
    data = _read(path, name)
    room, rest = 0, b""
    try:
        if data[:4] == b"glTF":
            table, room = glb_table(data)
            rest = data[len(data) - room :] if room else b""
        else:
            table = parse_table(data)
        check_gltf_table(table, room)
        rows = table_rows(table, "buffers")
    except InputError as error:
        raise InputError(f"{name}: {error}") from None
    needed = table.get("extensionsRequired", [])
    for word in needed if isinstance(needed, list) else [needed]:
        if not str(word).startswith(UNDERSTOOD):
            raise InputError(f"{name} needs the extension {str(word)[:40]!r}, which is not read; save it without")
    if len(rows) > MOST_BUFFERS:
        raise InputError(f"{name} has {len(rows)} buffers, at most {MOST_BUFFERS} are allowed")
    buffers = [rest if "uri" not in one else _from_address(one["uri"], folder, name) for one in rows]
    if sum(map(len, buffers)) > MOST_BYTES:
        raise InputError(f"the buffers of {name} are larger than {MOST_BYTES} bytes, the maximum")
    return GltfFile(name, table, tuple(buffers), folder)


def _from_address(address: Any, folder: Path, name: str) -> bytes:
    """Return the bytes of a data address, or of a file in a folder."""
    text = address if isinstance(address, str) else ""
    if text.startswith("data:"):
        head, _, body = text.partition(",")
        try:
            return base64.b64decode(body, validate=True) if head.endswith(";base64") else unquote(body).encode()
        except (binascii.Error, ValueError):
            raise InputError(f"{name}: a data address is not base64") from None
    plain = unquote(text)
    shown = repr(plain[:80])
    if not plain or "\0" in plain or re.match(r"(?i)[a-z][a-z0-9+.-]*:", plain):
        raise InputError(f"{name} refers to {shown}; only files in its folder are read")
    try:
        root = folder.resolve()
        path = (root / plain.replace("\\", "/")).resolve()
    except (OSError, ValueError, RuntimeError):
        raise InputError(f"{name} refers to {shown}, which is not a file name") from None
    if not path.is_relative_to(root):
        raise InputError(f"{name} refers to {shown}, which lies outside its folder; only files in its folder are read")
    if not path.is_file():
        raise InputError(f"{name} refers to {shown}, and there is no such file in its folder")
    return _read(path, path.name)


def _read(path: Path, name: str) -> bytes:
    try:
        if not path.is_file():
            raise InputError(f"there is no glTF file {path}")
        if path.stat().st_size > MOST_BYTES:
            raise InputError(f"{name} is larger than {MOST_BYTES} bytes, the maximum")
        return path.read_bytes()
    except OSError as error:
        raise InputError(f"cannot read {name}: {error.strerror or error}") from None
