"""Cache of convex decompositions, which take seconds for each mesh.

The cache is a folder of the user (``CROWDBOT_CACHE``, otherwise the one of the system). A damaged or missing entry is
computed again, and a folder that cannot be written is not used.
"""

from __future__ import annotations

import contextlib
import hashlib
import importlib.metadata
import os
import zipfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from crowdbot.core import cache_root

from .shapes import ConvexPiece, Mesh

__all__ = ["load_or_compute_pieces"]

Pieces = tuple[ConvexPiece, ...]
MOST_BYTES = 50_000_000


def load_or_compute_pieces(mesh: Mesh, settings: str, compute: Callable[[Mesh], Pieces]) -> Pieces:
    """Return the convex pieces of a mesh from the cache; otherwise compute and store them.

    Args:
        mesh: the mesh.
        settings: settings of the decomposition; another text is another entry.
        compute: returns the pieces.
    """
    path = cache_root() / "convex" / f"{_key(mesh, settings)}.npz"
    found = _load(path)
    if found is None:
        found = compute(mesh)
        if found:
            _store(path, found)
    return found


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
        if not path.is_file() or path.stat().st_size > MOST_BYTES:
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
