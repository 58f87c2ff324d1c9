"""Mesh files and their convex decomposition for contacts, which is cached."""

from __future__ import annotations

import contextlib
import dataclasses
import hashlib
import importlib.metadata
import io
import json
import logging
import os
import struct
import warnings
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any, NamedTuple
from xml.etree import ElementTree

import numpy as np

from crowdbot.core import InputError, cache_root, did_you_mean, glb_table, import_optional, table_rows

from .mesh_colors import PartColors, join_colors, take_colors
from .mesh_files import MeshFiles
from .mesh_limits import MOST_PARTS, MOST_TRIANGLES, check_mesh_bytes
from .shapes import ConvexPiece, Mesh

FORMATS = ("stl", "dae", "obj", "ply", "glb")
MOST_BYTES = 64_000_000
MOST_PIECES = 16
RESOLUTION = 20_000
"""Number of voxels of the convex decomposition."""
LOOSE = 1.3
"""If the convex hull exceeds the volume of the mesh by this factor, the mesh is decomposed into convex pieces."""
FLAT = 1e-5
"""Smallest thickness of a convex hull by its largest coordinate: MuJoCo holds points in single precision."""
Pieces = tuple[ConvexPiece, ...]
MOST_CACHE_BYTES = 50_000_000


class Submesh(NamedTuple):
    """The part of a mesh file that ``<submesh>`` of SDF names.

    Fields:
        name: name of a node of a DAE or GLB file, or of an object or group of an OBJ file; empty for the whole file.
        center: whether the middle of its bounding box becomes the origin.
    """

    name: str = ""
    center: bool = False


WHOLE = Submesh()


def read_mesh(
    path: Path,
    source: str,
    scale: tuple[float, float, float],
    files: MeshFiles | None = None,
    submesh: Submesh = WHOLE,
) -> Mesh:
    """Read a mesh file in metres. With a mirroring scale, triangles keep facing outwards.

    Args:
        path: an STL, DAE, OBJ, PLY or GLB file. The unit of a DAE file is applied, its "up" axis is ignored, as in ROS.
        source: the file name in the URDF.
        scale: scale along x, y and z.
        files: finds material files and textures (default: only this file is read).
        submesh: the part to read (default: the whole file).

    Raises:
        InputError: the format is not supported, the file has no such part, or it is too large, has no triangles or
            cannot be read.
        MissingExtra: trimesh is not installed.
    """
    kind = path.suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise InputError(f"the mesh format {kind[:20]!r} is not supported; use {', '.join(FORMATS)}")
    if path.stat().st_size > MOST_BYTES:
        raise InputError(f"it is larger than {MOST_BYTES} bytes, the maximum; simplify the mesh")
    data = path.read_bytes()
    check_mesh_bytes(data, kind, path.name)
    unit = _unit(data) if kind == "dae" else 1.0
    trimesh = _load_trimesh(_part(data, kind, submesh.name) if submesh.name else data, kind, unit, scale, files)
    vertices, faces = (
        np.asarray(trimesh.whole.vertices, dtype=np.float64),
        np.asarray(trimesh.whole.faces, dtype=np.int64),
    )
    if not len(faces):
        raise InputError("it has no triangles")
    if vertices.shape[1:] != (3,) or faces.shape[1:] != (3,):
        raise InputError(f"its points have {vertices.shape[-1]} coordinates, 3 are required")
    if not np.all(np.isfinite(vertices)) or np.abs(vertices).max() > 1e4:
        raise InputError("it has points that are not finite or farther than 10 km from the origin")
    if submesh.center:
        corners = vertices[np.unique(faces)]
        vertices = vertices - 0.5 * (corners.min(axis=0) + corners.max(axis=0))
    colors, uv, textures = join_colors(trimesh.parts)
    if colors is not None and len(colors) != len(faces):
        return Mesh(source, vertices, faces)
    return Mesh(source, vertices, faces, colors=colors, uv=uv, textures=textures)


def with_pieces(mesh: Mesh, method: str = "auto") -> tuple[Mesh, str]:
    """Return the mesh with its convex bodies for contacts, and a remark if they are coarse.

    Args:
        mesh: the mesh.
        method: ``hull`` takes the convex hull; ``pieces`` cuts the mesh into up to 16 convex pieces (V-HACD, Mamou);
            ``auto`` uses pieces if the hull exceeds 1.3 times the volume of the mesh, otherwise the hull. Without the
            package ``vhacdx``, the hull is always used.
    """
    hull = _hull(mesh.vertices)
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    volume = abs(float(np.einsum("ni,ni->n", a - a[0], np.cross(b - a[0], c - a[0])).sum())) / 6.0
    around = hull.solid().volume
    loose = around > LOOSE * max(volume, 1e-12)
    if method == "hull" or (method == "auto" and not loose):
        return dataclasses.replace(mesh, pieces=(hull,)), ""
    pieces = load_or_compute_pieces(mesh, f"V-HACD {MOST_PIECES} {RESOLUTION}, flat pieces thickened", _decompose)
    if pieces:
        return dataclasses.replace(mesh, pieces=pieces), ""
    return (
        dataclasses.replace(mesh, pieces=(hull,)),
        f"uses its convex hull, {around / max(volume, 1e-12):.1f} times its volume"
        " (install vhacdx for a convex decomposition)",
    )


def _trimesh() -> Any:
    module = import_optional("trimesh", "reading meshes of robots", "sim")
    log = logging.getLogger("trimesh")
    if not log.handlers:  # otherwise Python prints the traces of errors that trimesh handles
        log.addHandler(logging.NullHandler())
    return module


class _Loaded(NamedTuple):
    """A mesh file as one trimesh, and its parts with their look."""

    whole: Any
    parts: list[tuple[Any, PartColors]]


def _load_trimesh(
    data: bytes, kind: str, unit: float, scale: tuple[float, float, float], files: MeshFiles | None
) -> _Loaded:
    """Return the content of the file as one trimesh, in metres, with its scale, and its parts."""
    trimesh = _trimesh()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, resolver=files)
            for part in scene.geometry.values():
                _check_faces(part)
            _check_count(scene)
            looks = {
                name: take_colors(part, kind, files)
                for name, part in scene.geometry.items()
                if isinstance(part, trimesh.Trimesh)
            }
            meshes = [part for part in scene.dump() if isinstance(part, trimesh.Trimesh) and len(part.faces)]
            whole = trimesh.util.concatenate(meshes) if meshes else trimesh.Trimesh()
            _check_faces(whole)
            whole.apply_scale(unit)
            whole.apply_transform(np.diag([*scale, 1.0]))
        except InputError:
            raise
        except Exception as error:  # a broken file causes many kinds of exceptions inside the libraries
            raise InputError(f"it cannot be read as {kind}: {type(error).__name__}: {str(error)[:120]}") from None
    return _Loaded(whole, [(part, looks.get(part.metadata.get("name"), PartColors())) for part in meshes])


def _part(data: bytes, kind: str, name: str) -> bytes:
    """Return a mesh file in which only the shapes of a name are left."""
    takers = {"dae": _part_of_dae, "obj": _part_of_obj, "glb": _part_of_glb}
    if kind not in takers:
        raise InputError(f"its parts have no names, so it has no part {name[:60]!r}; use a {', '.join(takers)} file")
    kept, names = takers[kind](data, name)
    if name not in names:
        few = ", ".join(repr(other[:40]) for other in sorted(names)[:8]) or "no names"
        raise InputError(f"it has no part {name[:60]!r}{did_you_mean(name, sorted(names))}; its parts: {few}")
    return kept


def _part_of_dae(data: bytes, name: str) -> tuple[bytes, set[str]]:
    """Return the file and the names of its shapes: those of the nearest node around with a name, as in Gazebo."""
    try:
        root = ElementTree.fromstring(data)  # noqa: S314, check_mesh_bytes has rejected entities
    except ElementTree.ParseError as error:
        raise InputError(f"it cannot be read as dae: {error}") from None
    names, waiting = set(), [(root, "")]
    while waiting:
        element, around = waiting.pop()
        for child in list(element):
            tag = child.tag.rpartition("}")[2]
            if tag == "instance_geometry":
                names.add(around)
                if around != name:
                    element.remove(child)
            waiting.append((child, (child.get("name") or child.get("id") or around) if tag == "node" else around))
    return ElementTree.tostring(root), names


def _part_of_obj(data: bytes, name: str) -> tuple[bytes, set[str]]:
    """Return the file and the names of its objects and groups; points stay, since triangles count them."""
    kept, names, here = [], set(), ""
    for line in data.splitlines():
        word, _, rest = line.strip().partition(b" ")
        if word in (b"o", b"g"):
            here = rest.strip().decode("utf-8", "replace")
        elif word == b"f":
            names.add(here)
        if word not in (b"o", b"g", b"f", b"l", b"p") or here == name:
            kept.append(line)
    return b"\n".join(kept), names


def _part_of_glb(data: bytes, name: str) -> tuple[bytes, set[str]]:
    """Return the file and the names of its nodes with a mesh."""
    table, _ = glb_table(data)
    rows = [(str(node.get("name", "")), node) for node in table_rows(table, "nodes")]
    names = {label for label, node in rows if "mesh" in node}
    nodes = [{key: node[key] for key in node if key != "mesh" or label == name} for label, node in rows]
    text = json.dumps({**table, "nodes": nodes}).encode()
    text += b" " * (-len(text) % 4)
    rest = data[20 + struct.unpack("<I", data[12:16])[0] :]
    return b"glTF" + struct.pack("<III", 2, 20 + len(text) + len(rest), len(text)) + b"JSON" + text + rest, names


def _check_count(scene: Any) -> None:
    """Raise an error if the scene has too many triangles after all copies of its parts."""
    names = [scene.graph[node][1] for node in scene.graph.nodes_geometry]
    count = sum(len(getattr(scene.geometry[name], "faces", ())) for name in names)
    if count > MOST_TRIANGLES:
        raise InputError(f"it has {count} triangles, at most {MOST_TRIANGLES} are allowed; simplify the mesh")
    if len(names) > MOST_PARTS:
        raise InputError(f"it has {len(names)} parts, at most {MOST_PARTS} are allowed; join the parts of the mesh")


def _check_faces(part: Any) -> None:
    """Raise an error if a triangle names a point that does not exist; transformations would fail on it."""
    faces, count = getattr(part, "faces", None), len(getattr(part, "vertices", ()))
    if faces is not None and len(faces) and (faces.min() < 0 or faces.max() >= count):
        raise InputError(f"a triangle names the point {faces.max()}, and it holds {count} points")


def _unit(data: bytes) -> float:
    """Return the length unit of a DAE file [m]."""
    import re

    match = re.search(rb"<unit[^>]*\bmeter\s*=\s*[\"']([0-9.eE+-]{1,20})[\"']", data)
    try:
        value = float(match.group(1)) if match else 1.0
    except ValueError:
        return 1.0
    return value if 1e-6 <= value <= 1e6 else 1.0


def _hull(vertices: Any) -> ConvexPiece:
    """Return the convex hull; a flat mesh gets a thickness of 1 mm."""
    from scipy.spatial import ConvexHull, QhullError

    points = np.unique(np.asarray(vertices, dtype=np.float64), axis=0)
    if not _is_flat(points):
        with contextlib.suppress(QhullError, ValueError):
            return _orient_faces(points, ConvexHull(points))
    thick = np.concatenate([points + shift for shift in 0.0005 * np.vstack([np.eye(3), -np.eye(3)])])
    return _orient_faces(thick, ConvexHull(thick))


def _is_flat(points: Any) -> bool:
    """Return whether points lie in a plane, to rounding: a slanted plate of a file is never exactly flat."""
    away = points - points.mean(axis=0)
    thinnest = np.linalg.eigh(away.T @ away)[1][:, 0]
    return bool(np.ptp(away @ thinnest) < FLAT * np.abs(points).max())


def _orient_faces(points: Any, hull: Any) -> ConvexPiece:
    """Return vertices and triangles of the hull, with all triangles facing outwards."""
    used = np.sort(hull.vertices)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    faces, corners = number[hull.simplices], points[used]
    a, b, c = (corners[faces[:, k]] for k in range(3))
    inward = np.einsum("ni,ni->n", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return ConvexPiece(corners, faces.astype(np.int64))


def _decompose(mesh: Mesh) -> tuple[ConvexPiece, ...]:
    """Return convex pieces, or none if no library is available."""
    body = _trimesh().Trimesh(mesh.vertices, mesh.faces, process=True)
    try:
        from trimesh.decomposition import convex_decomposition

        parts = convex_decomposition(body, maxConvexHulls=MOST_PIECES, resolution=RESOLUTION, asyncACD=False)
    except ImportError:
        return ()
    pieces = [_hull(part["vertices"]) for part in parts]
    return tuple(piece for piece in pieces if piece.solid().volume > 0.0)


def load_or_compute_pieces(mesh: Mesh, settings: str, compute: Callable[[Mesh], Pieces]) -> Pieces:
    """Return the convex pieces of a mesh from the cache; otherwise compute and store them.

    Args:
        mesh: the mesh.
        settings: settings of the decomposition; another text is another entry.
        compute: returns the pieces.
    """
    path = cache_root() / "convex" / f"{_key(mesh, settings)}.npz"
    pieces = _load(path)
    if pieces is None:
        pieces = compute(mesh)
        if pieces:
            _store(path, pieces)
    return pieces


def _key(mesh: Mesh, settings: str) -> str:
    versions = [f"{name} {_version(name)}" for name in ("trimesh", "vhacdx", "scipy")]
    sum_ = hashlib.blake2b("\n".join([settings, *versions]).encode(), digest_size=16)
    for array in (mesh.vertices, mesh.faces):
        sum_.update(repr((array.shape, array.dtype.str)).encode() + np.ascontiguousarray(array).tobytes())
    return sum_.hexdigest()


def _version(name: str) -> str:
    try:
        return importlib.metadata.version(name)
    except importlib.metadata.PackageNotFoundError:
        return ""


def _load(path: Path) -> Pieces | None:
    """Return the pieces of an entry, or None if it is missing or damaged."""
    try:
        if not path.is_file() or path.stat().st_size > MOST_CACHE_BYTES:
            return None
        with path.open("rb") as stream, np.load(stream, allow_pickle=False) as stored:
            pieces = [(stored[f"vertices{k}"], stored[f"faces{k}"]) for k in range(len(stored.files) // 2)]
    except (OSError, ValueError, KeyError, AttributeError, TypeError, zipfile.BadZipFile, EOFError, MemoryError):
        return None
    return tuple(ConvexPiece(*piece) for piece in pieces) if pieces and all(map(_is_piece, pieces)) else None


def _is_piece(piece: tuple[Any, Any]) -> bool:
    vertices, faces = piece
    shaped = vertices.ndim == faces.ndim == 2 and vertices.shape[1] == faces.shape[1] == 3 and len(faces) > 0
    typed = shaped and vertices.dtype == np.float64 and faces.dtype == np.int64
    return bool(typed and np.all(np.isfinite(vertices)) and faces.min() >= 0 and faces.max() < len(vertices))


def _store(path: Path, pieces: Pieces) -> None:
    rows: dict[str, Any] = {f"vertices{k}": piece.vertices for k, piece in enumerate(pieces)}
    rows |= {f"faces{k}": piece.faces for k, piece in enumerate(pieces)}
    part = path.with_name(f"{path.stem}.{os.getpid()}.part.npz")
    try:
        path.parent.mkdir(parents=True, exist_ok=True)
        np.savez_compressed(part, **rows)
        part.replace(path)
    except OSError:  # a cache that cannot be written is not used
        with contextlib.suppress(OSError):
            part.unlink(missing_ok=True)
