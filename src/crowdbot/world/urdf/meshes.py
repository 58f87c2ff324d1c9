"""Meshes from files, and the convex bodies that stand for them in contacts."""

from __future__ import annotations

import io
import logging
import warnings
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import InputError, import_optional, reject_entities

from .shapes import ConvexPiece, Mesh

__all__ = ["FORMATS", "read_mesh", "with_pieces"]

FORMATS = ("stl", "dae", "obj", "ply", "glb")
MOST_BYTES = 64_000_000
MOST_TRIANGLES = 2_000_000
MOST_PIECES = 16
LOOSE = 1.3
"""A hull that holds so many times the volume of its mesh is too coarse; the mesh is cut into convex pieces then."""


def read_mesh(path: Path, source: str, scale: tuple[float, float, float]) -> Mesh:
    """Read a mesh file in metres; a mirroring scale keeps its triangles facing outwards.

    Nothing but this one file is read: no materials, textures or buffers beside it.

    Args:
        path: an STL, DAE, OBJ, PLY or GLB file. The unit that a DAE file states is applied; its "up" axis is not, as
            in ROS.
        source: how the URDF names it.
        scale: along x, y and z.

    Raises:
        InputError: the file is of another kind, too large, holds no triangles, or cannot be read.
        MissingExtra: trimesh is not installed.
    """
    kind = path.suffix.lower().lstrip(".")
    if kind not in FORMATS:
        raise InputError(f"a mesh must be {', '.join(FORMATS)}, not {kind[:20]!r}")
    if path.stat().st_size > MOST_BYTES:
        raise InputError(f"it is larger than {MOST_BYTES} bytes; simplify the mesh")
    data = path.read_bytes()
    if kind == "dae":
        reject_entities(data, path.name)
    loaded = _loaded(data, kind)
    loaded.apply_transform(np.diag([*scale, 1.0]))
    vertices, faces = np.asarray(loaded.vertices, dtype=np.float64), np.asarray(loaded.faces, dtype=np.int64)
    if not len(faces):
        raise InputError("it holds no triangles")
    if len(faces) > MOST_TRIANGLES:
        raise InputError(f"it holds {len(faces)} triangles, at most {MOST_TRIANGLES} are read; simplify the mesh")
    if faces.min() < 0 or faces.max() >= len(vertices):
        raise InputError(f"a triangle names the point {faces.max()}, and it holds {len(vertices)} points")
    if not np.all(np.isfinite(vertices)) or np.abs(vertices).max() > 1e4:
        raise InputError("it holds points that are not finite or farther away than 10 km")
    return Mesh(source, vertices, faces)


def with_pieces(mesh: Mesh, method: str = "auto") -> tuple[Mesh, str]:
    """Return the mesh with the convex bodies that stand for it, and a sentence when they are coarse.

    Args:
        mesh: as read.
        method: ``hull`` takes the convex hull; ``pieces`` cuts the mesh into up to 16 convex pieces (V-HACD, Mamou);
            ``auto`` takes the hull unless it holds 1.3 times the volume of the mesh, then pieces. Without the package
            ``vhacdx`` it is always the hull.
    """
    hull = _hull(mesh.vertices)
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    volume = abs(float(np.einsum("ni,ni->n", a - a[0], np.cross(b - a[0], c - a[0])).sum())) / 6.0
    around = hull.solid().volume
    loose = around > LOOSE * max(volume, 1e-12)
    if method == "hull" or (method == "auto" and not loose):
        return Mesh(mesh.source, mesh.vertices, mesh.faces, (hull,)), ""
    pieces = _decomposed(mesh)
    if pieces:
        return Mesh(mesh.source, mesh.vertices, mesh.faces, pieces), ""
    return (
        Mesh(mesh.source, mesh.vertices, mesh.faces, (hull,)),
        f"is wrapped in its convex hull of {around / max(volume, 1e-12):.1f} times its volume"
        " (with the package vhacdx it would be cut into convex pieces)",
    )


def _trimesh() -> Any:
    module = import_optional("trimesh", "reading meshes of robots", "sim")
    log = logging.getLogger("trimesh")
    if not log.handlers:  # otherwise Python prints the traces of errors that trimesh handles
        log.addHandler(logging.NullHandler())
    return module


def _loaded(data: bytes, kind: str) -> Any:
    """Return one trimesh of all that is in the file, in metres."""
    trimesh = _trimesh()
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        try:
            scene = trimesh.load_scene(io.BytesIO(data), file_type=kind, resolver=None)
            meshes = [part for part in scene.dump() if isinstance(part, trimesh.Trimesh) and len(part.faces)]
            whole = trimesh.util.concatenate(meshes) if meshes else trimesh.Trimesh()
        except Exception as error:  # a broken file fails in many ways inside the libraries
            raise InputError(f"it cannot be read as {kind}: {type(error).__name__}: {str(error)[:120]}") from None
    factor = _unit(data) if kind == "dae" else 1.0
    whole.apply_scale(factor)
    return whole


def _unit(data: bytes) -> float:
    """Return the metres of one unit of a DAE file."""
    import re

    found = re.search(rb"<unit[^>]*\bmeter\s*=\s*[\"']([0-9.eE+-]{1,20})[\"']", data)
    try:
        value = float(found.group(1)) if found else 1.0
    except ValueError:
        return 1.0
    return value if 1e-6 <= value <= 1e6 else 1.0


def _hull(vertices: Any) -> ConvexPiece:
    """Return the convex hull; a flat mesh is given the thickness of 1 mm first."""
    from scipy.spatial import ConvexHull, QhullError

    points = np.unique(np.asarray(vertices, dtype=np.float64), axis=0)
    try:
        return _faced(points, ConvexHull(points))
    except (QhullError, ValueError):
        thick = np.concatenate([points + shift for shift in 0.0005 * np.vstack([np.eye(3), -np.eye(3)])])
        return _faced(thick, ConvexHull(thick))


def _faced(points: Any, hull: Any) -> ConvexPiece:
    """Return the hull's corners and triangles, every triangle turned outwards."""
    used = np.sort(hull.vertices)
    number = np.full(len(points), -1)
    number[used] = np.arange(len(used))
    faces, corners = number[hull.simplices], points[used]
    a, b, c = (corners[faces[:, k]] for k in range(3))
    inward = np.einsum("ni,ni->n", np.cross(b - a, c - a), hull.equations[:, :3]) < 0.0
    faces[inward] = faces[inward][:, ::-1]
    return ConvexPiece(corners, faces.astype(np.int64))


def _decomposed(mesh: Mesh) -> tuple[ConvexPiece, ...]:
    """Return convex pieces, none when no library can make them."""
    body = _trimesh().Trimesh(mesh.vertices, mesh.faces, process=True)
    try:
        from trimesh.decomposition import convex_decomposition

        parts = convex_decomposition(body, maxConvexHulls=MOST_PIECES, resolution=20_000, asyncACD=False)
    except ImportError:
        return ()
    pieces = [_hull(part["vertices"]) for part in parts]
    return tuple(piece for piece in pieces if piece.solid().volume > 0.0)
