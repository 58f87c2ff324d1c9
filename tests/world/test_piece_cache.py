"""Convex pieces are computed once, are the same from the cache, and a damaged cache does no harm."""

import numpy as np
import pytest
import trimesh

from crowdbot.world.urdf import Mesh, with_pieces
from crowdbot.world.urdf import meshes as module


@pytest.fixture
def ring(tmp_path, monkeypatch):
    """A ring, whose hull is far larger than itself, an empty cache, and a counter of decompositions."""
    monkeypatch.setenv("CROWDBOT_CACHE", str(tmp_path / "cache"))
    body = trimesh.creation.annulus(0.4, 0.5, 0.1, sections=24)
    calls = []
    compute = module._decompose
    monkeypatch.setattr(module, "_decompose", lambda mesh: calls.append(1) or compute(mesh))
    return (
        Mesh("ring.stl", np.asarray(body.vertices), np.asarray(body.faces, dtype=np.int64)),
        calls,
        tmp_path / "cache",
    )


def equal(one, other):
    pairs = zip(one.pieces, other.pieces, strict=True)
    return all(np.array_equal(a.vertices, b.vertices) and np.array_equal(a.faces, b.faces) for a, b in pairs)


def test_pieces_are_computed_once(ring):
    mesh, calls, _ = ring
    first, second = with_pieces(mesh)[0], with_pieces(mesh)[0]
    assert len(first.pieces) > 1
    assert equal(first, second)
    assert len(calls) == 1
    moved = Mesh("ring.stl", mesh.vertices + 1e-9, mesh.faces)
    with_pieces(moved)
    assert len(calls) == 2


@pytest.mark.parametrize("damage", [b"", b"PK\x03\x04 no archive", b"\x00" * 100])
def test_a_damaged_entry_is_computed_again(ring, damage):
    mesh, calls, folder = ring
    first = with_pieces(mesh)[0]
    (entry,) = (folder / "convex").glob("*.npz")
    entry.write_bytes(damage)
    assert equal(first, with_pieces(mesh)[0])
    assert len(calls) == 2
    np.savez(entry, vertices0=np.zeros((3, 3)), faces0=np.array([[0, 1, 7]]))
    assert equal(first, with_pieces(mesh)[0])
    assert len(calls) == 3


def test_a_folder_that_cannot_be_written_is_not_used(ring, monkeypatch, tmp_path):
    mesh, calls, _ = ring
    (tmp_path / "file").write_text("")
    monkeypatch.setenv("CROWDBOT_CACHE", str(tmp_path / "file"))
    assert equal(with_pieces(mesh)[0], with_pieces(mesh)[0])
    assert len(calls) == 2
