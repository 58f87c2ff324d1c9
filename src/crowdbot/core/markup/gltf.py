"""glTF files."""

from __future__ import annotations

import base64
import binascii
import json
import re
import struct
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import numpy as np
from numpy.typing import NDArray

from crowdbot.core.errors import InputError
from crowdbot.typing import Floats

MOST_TRIANGLES = 2_000_000
MOST_PARTS = 2000
"""Maximum number of parts of a mesh, such as nodes, materials and named solids; each takes about 1 ms to read."""
MOST_HEADER = 16_000_000
MOST_DEPTH = 100
COMPONENT_BYTES = {5120: 1, 5121: 1, 5122: 2, 5123: 2, 5125: 4, 5126: 4}
VALUES = {"SCALAR": 1, "VEC2": 2, "VEC3": 3, "VEC4": 4, "MAT2": 4, "MAT3": 9, "MAT4": 16}


def glb_table(data: bytes) -> tuple[Mapping[str, Any], int]:
    """Return the JSON table of a GLB file, and the number of bytes of its data.

    Raises:
        InputError: what is wrong, as the end of a sentence.
    """
    if data[:4] != b"glTF" or len(data) < 20:
        raise InputError("it has no GLB header")
    size, chunk = struct.unpack("<I", data[12:16])[0], data[16:20]
    if chunk != b"JSON" or size > min(len(data) - 20, MOST_HEADER):
        raise InputError(f"its table has {size} bytes, at most {min(len(data) - 20, MOST_HEADER)} are possible")
    table = parse_table(data[20 : 20 + size])
    return table, max(0, len(data) - 20 - size - 8)


def parse_table(data: bytes) -> Mapping[str, Any]:
    """Return the JSON table of a glTF file.

    Raises:
        InputError: what is wrong, as the end of a sentence.
    """
    try:
        table = json.loads(data)
    except (ValueError, RecursionError) as error:
        raise InputError(f"its table is not valid JSON: {str(error)[:80]}") from None
    if not isinstance(table, dict):
        raise InputError("its table is not a JSON object")
    return table


def check_gltf_table(table: Mapping[str, Any], room: int) -> None:
    """Raise an error if a table announces more than its data holds, too many parts, or nodes without end.

    Args:
        table: the JSON table of the file.
        room: bytes of the data of a GLB file.

    Raises:
        InputError: what is wrong, as the end of a sentence.

    >>> check_gltf_table({"nodes": [{"children": [0]}]}, 0)
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: its nodes are a loop, or nested more than 100 levels deep
    """
    buffers, views = table_rows(table, "buffers"), table_rows(table, "bufferViews")
    for number, view in enumerate(views):
        first, size = whole_value(view, "byteOffset", 0), whole_value(view, "byteLength", 0)
        if view.get("buffer", 0) == 0 and "uri" not in (buffers[0] if buffers else {}) and first + size > room:
            raise InputError(f"its part {number} ends at byte {first + size}, and it has {room} bytes of data")
    for number, accessor in enumerate(table_rows(table, "accessors")):
        _check_accessor(number, accessor, views)
    primitives = [row for mesh in table_rows(table, "meshes") for row in table_rows(mesh, "primitives")]
    _check_parts(len(primitives), "primitives")
    _check_nodes(table_rows(table, "nodes"))


def _check_parts(count: int, what: str) -> None:
    if count > MOST_PARTS:
        raise InputError(f"it has {count} {what}, at most {MOST_PARTS} are allowed; join the parts of the mesh")


def _check_accessor(number: int, accessor: Mapping[str, Any], views: Sequence[Mapping[str, Any]]) -> None:
    count = whole_value(accessor, "count", 0)
    each = COMPONENT_BYTES.get(accessor.get("componentType", 0), 4) * VALUES.get(accessor.get("type", ""), 1)
    view = accessor.get("bufferView")
    if view is None:
        if count > 3 * MOST_TRIANGLES:
            raise InputError(f"its array {number} has {count} rows, at most {3 * MOST_TRIANGLES} are allowed")
        return
    if not isinstance(view, int) or not 0 <= view < len(views):
        raise InputError(f"its array {number} names the part {str(view)[:20]}, and there are {len(views)}")
    room = whole_value(views[view], "byteLength", 0) - whole_value(accessor, "byteOffset", 0)
    if count * each > room and count > 0:
        raise InputError(f"its array {number} has {count} rows of {each} bytes, and its part has {max(room, 0)} bytes")


def _check_nodes(nodes: Sequence[Mapping[str, Any]]) -> None:
    """Check that each node has at most one parent, as the format says; otherwise copies of copies never end."""
    _check_parts(len(nodes), "nodes")
    if not all(isinstance(node.get("children", []), list) for node in nodes):
        raise InputError("the children of a node are not a list")
    children = [child for node in nodes for child in node.get("children", ())]
    if any(not isinstance(child, int) or not 0 <= child < len(nodes) for child in children):
        raise InputError("a node has a child that does not exist")
    if len(set(children)) < len(children):
        raise InputError("a node has several parents")
    parent = {child: k for k, node in enumerate(nodes) for child in node.get("children", ())}
    for start in range(len(nodes)):
        at, steps = start, 0
        while at in parent:
            at, steps = parent[at], steps + 1
            if steps > MOST_DEPTH:
                raise InputError(f"its nodes are a loop, or nested more than {MOST_DEPTH} levels deep")


def table_rows(table: Mapping[str, Any], key: str) -> list[Mapping[str, Any]]:
    """Return a list of objects of the table.

    Raises:
        InputError: the value is something else, as the end of a sentence.
    """
    result = table.get(key, [])
    if not isinstance(result, list) or not all(isinstance(row, dict) for row in result):
        raise InputError(f"{key!r} in its table is not a list of objects")
    return result


def whole_value(row: Mapping[str, Any], key: str, default: int) -> int:
    """Return a count or size of the table.

    Raises:
        InputError: the value is something else, as the end of a sentence.
    """
    value = row.get(key, default)
    if not isinstance(value, int) or value < 0:
        raise InputError(f"{key} = {str(value)[:40]} in its table must be a whole number of at least 0")
    return value


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
        result = np.empty((len(nodes), 4, 4))
        for k in range(len(nodes)):
            whole, at = own[k], k
            while at in parent:
                at = parent[at]
                whole = own[at] @ whole
            result[k] = whole
        return result

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
        frame = np.eye(4)
        frame[:3, :3] = turn * self._numbers(node, "scale", 3, (1.0, 1.0, 1.0))
        frame[:3, 3] = self._numbers(node, "translation", 3, (0.0, 0.0, 0.0))
        return frame

    def _numbers(self, node: Mapping[str, Any], key: str, count: int, default: tuple[float, ...]) -> Floats:
        value = node.get(key, default)
        try:
            numbers = np.array(value, dtype=np.float64)
        except (TypeError, ValueError, OverflowError):
            numbers = np.zeros(0)
        if numbers.shape != (count,) or not np.all(np.isfinite(numbers)) or np.abs(numbers).max() > 1e6:
            raise InputError(f"{self.name}: {key} of a node must be {count} numbers of at most 1e6")
        return numbers

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
    buffers = [rest if "uri" not in row else _from_address(row["uri"], folder, name) for row in rows]
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
