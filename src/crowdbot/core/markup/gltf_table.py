"""Checks of the table of a glTF file before its arrays are read: sizes, counts and loops of nodes."""

from __future__ import annotations

import json
import struct
from collections.abc import Mapping, Sequence
from typing import Any

from crowdbot.core.errors import InputError

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
    primitives = [one for mesh in table_rows(table, "meshes") for one in table_rows(mesh, "primitives")]
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
    found = table.get(key, [])
    if not isinstance(found, list) or not all(isinstance(row, dict) for row in found):
        raise InputError(f"{key!r} in its table is not a list of objects")
    return found


def whole_value(row: Mapping[str, Any], key: str, default: int) -> int:
    """Return a count or size of the table.

    Raises:
        InputError: the value is something else, as the end of a sentence.
    """
    value = row.get(key, default)
    if not isinstance(value, int) or value < 0:
        raise InputError(f"{key} = {str(value)[:40]} in its table must be a whole number of at least 0")
    return value
