"""Checks of mesh files before another library reads them: counts that the file cannot hold, loops and copies."""

from __future__ import annotations

import re
import struct
from collections.abc import Mapping
from typing import NamedTuple
from xml.parsers import expat

from crowdbot.core import (
    MOST_PARTS,
    MOST_TRIANGLES,
    InputError,
    check_gltf_table,
    glb_table,
    reject_entities,
    table_rows,
)

__all__ = ["MOST_PARTS", "MOST_TRIANGLES", "check_mesh_bytes"]

MOST_DEPTH = 100
STL_HEADER, STL_TRIANGLE = 84, 50


def check_mesh_bytes(data: bytes, kind: str, name: str) -> None:
    """Raise an error if a mesh file announces more than it holds, or more parts than are allowed.

    Args:
        data: content of the file.
        kind: ``stl``, ``dae``, ``obj``, ``ply`` or ``glb``.
        name: file name for messages.

    Raises:
        InputError: what is wrong, as the end of a sentence.

    >>> check_mesh_bytes(b"x" * 80 + b"\\xff\\xff\\xff\\xff", "stl", "a.stl")
    Traceback (most recent call last):
    crowdbot.core.errors.InputError: it announces 4294967295 triangles, and it has room for 0
    """
    {"stl": _check_stl, "dae": _check_dae, "obj": _check_obj, "ply": _check_ply, "glb": _check_glb}[kind](data, name)


def _check_parts(count: int, what: str) -> None:
    if count > MOST_PARTS:
        raise InputError(f"it has {count} {what}, at most {MOST_PARTS} are allowed; join the parts of the mesh")


def _check_stl(data: bytes, name: str) -> None:
    """Check the count of a binary file, and the number of solids of a text."""
    if data[:5] == b"solid" and b"facet" in data[:2000]:
        _check_parts(data.count(b"endsolid"), "solids")
        return
    if len(data) < STL_HEADER:
        raise InputError(f"it has {len(data)} bytes, a binary STL file has at least {STL_HEADER}")
    count, room = struct.unpack("<I", data[80:84])[0], (len(data) - STL_HEADER) // STL_TRIANGLE
    if count > room:
        raise InputError(f"it announces {count} triangles, and it has room for {room}")
    if count > MOST_TRIANGLES:
        raise InputError(f"it has {count} triangles, at most {MOST_TRIANGLES} are allowed; simplify the mesh")


def _check_obj(data: bytes, name: str) -> None:
    if data[:2] in (b"PK", b"\x1f\x8b"):
        raise InputError("it is a compressed archive, not a mesh; unpack it")
    materials = {row.strip() for row in re.findall(rb"^[ \t]*usemtl([^\n]*)", data, re.MULTILINE)}
    _check_parts(len(materials), "materials")
    if data.count(b"mtllib") > 1:
        _check_parts(data.count(b"mtllib"), "material files")


def _check_ply(data: bytes, name: str) -> None:
    """Check that the counts of the header fit into the file: each row has at least one byte."""
    end = data.find(b"end_header", 0, 100_000)
    if data[:3] != b"ply" or end < 0:
        raise InputError("it has no PLY header")
    room = len(data) - end
    for kind, count in re.findall(rb"^element\s+(\S+)\s+(\S+)", data[:end], re.MULTILINE):
        what = repr(kind.decode("ascii", "replace")[:20])
        digits = count.decode("ascii", "replace")[:40]
        if not digits.isdecimal():
            raise InputError(f"its header announces {digits!r} rows of {what}")
        if int(digits) > room:
            raise InputError(f"it announces {digits} rows of {what}, and it has {room} bytes")


def _check_dae(data: bytes, name: str) -> None:
    if data[:2] in (b"PK", b"\x1f\x8b"):
        raise InputError("it is a compressed archive, not a mesh; unpack it")
    reject_entities(data, name)
    parts = sum(data.count(tag) for tag in (b"<triangles", b"<polylist", b"<polygons", b"<lines", b"<tristrips"))
    _check_parts(parts, "groups of triangles")
    if b"instance_node" in data or data.count(b"instance_geometry") > 1 or data.count(b"<node") > MOST_DEPTH:
        _check_instances(data)


class _SceneNode(NamedTuple):
    """A node or scene: its child nodes, the names of nodes that it uses, and its number of shapes."""

    children: list[_SceneNode]
    uses: list[str]
    shapes: list[int]


class _SceneReader:
    """Reads the nodes of a DAE file, without its arrays."""

    def __init__(self, data: bytes) -> None:
        self.nodes: dict[str, _SceneNode] = {}
        self.scenes: list[_SceneNode] = []
        self._open: list[_SceneNode] = []
        self._depth = 0
        parser = expat.ParserCreate()
        parser.StartElementHandler, parser.EndElementHandler = self._start, self._end
        parser.Parse(data, True)

    def _start(self, name: str, values: Mapping[str, str]) -> None:
        tag = name.rpartition(":")[2]
        self._depth += 1
        if self._depth > MOST_DEPTH:
            raise InputError(f"its elements are nested more than {MOST_DEPTH} levels deep")
        if tag in ("node", "visual_scene"):
            node = _SceneNode([], [], [0])
            if self._open:
                self._open[-1].children.append(node)
            if tag == "visual_scene":
                self.scenes.append(node)
            self.nodes[values.get("id", "")] = node
            self._open.append(node)
        elif tag == "instance_node" and self._open:
            self._open[-1].uses.append(values.get("url", "").removeprefix("#"))
        elif tag == "instance_geometry" and self._open:
            self._open[-1].shapes[0] += 1

    def _end(self, name: str) -> None:
        self._depth -= 1
        if name.rpartition(":")[2] in ("node", "visual_scene"):
            self._open.pop()

    def count(self, node: _SceneNode, above: tuple[int, ...], counts: dict[int, int]) -> int:
        """Return the number of shapes of a node with all nodes below it and that it uses."""
        if id(node) in above or len(above) > MOST_DEPTH:
            raise InputError("its nodes contain themselves")
        if id(node) not in counts:
            below = [*node.children, *(self.nodes[name] for name in node.uses if name in self.nodes)]
            counts[id(node)] = node.shapes[0] + sum(self.count(item, (*above, id(node)), counts) for item in below)
        return counts[id(node)]


def _check_instances(data: bytes) -> None:
    """Check how often shapes are drawn, since nodes may be used by other nodes again and again."""
    reader = _SceneReader(data)
    counts: dict[int, int] = {}
    for scene in reader.scenes:
        _check_parts(reader.count(scene, (), counts), "shapes in its scene")


def _check_glb(data: bytes, name: str) -> None:
    """Check the table of a GLB file: sizes of its arrays, and its nodes."""
    table, room = glb_table(data)
    buffers = table_rows(table, "buffers")
    if any("uri" in buffer and not str(buffer["uri"]).startswith("data:") for buffer in buffers):
        raise InputError("its buffer is in another file, which is not supported; store it in the GLB file")
    check_gltf_table(table, room)
