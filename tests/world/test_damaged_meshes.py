"""Meshes that tools/fuzz_readers.py found: one sentence, and no trace in the log of a library."""

import json
import logging
import struct
import types

import numpy as np
import pytest
import trimesh

from crowdbot.core import InputError
from crowdbot.world.urdf.meshes import read_mesh
from samples import sizes

ONE = (1.0, 1.0, 1.0)


def test_a_triangle_beyond_the_points_is_rejected(tmp_path, monkeypatch):
    path = tmp_path / "body.ply"
    body = trimesh.creation.box()
    text = body.export(file_type="ply", encoding="ascii").decode()
    head, faces = text[: text.index("\n3 ")], text[text.index("\n3 ") :]
    path.write_text(head + faces.replace("\n3 1 ", "\n3 900 ", 1))
    with pytest.raises(InputError, match="a triangle names the point 900, and it holds 8 points|cannot be read as ply"):
        read_mesh(path, "body.ply", ONE)
    monkeypatch.setattr(trimesh, "load_scene", lambda *_, **__: _Scene())
    with pytest.raises(InputError, match="a triangle names the point 7, and it holds 3 points"):
        read_mesh(path, "body.ply", ONE)


def test_points_of_two_coordinates_are_rejected(tmp_path):
    path = tmp_path / "body.obj"
    path.write_text("v 0 0\nv 1 0\nv 0 1\nf 1 2 3\n")
    with pytest.raises(InputError, match="its points have 2 coordinates, 3 are required|cannot be read as obj"):
        read_mesh(path, "body.obj", ONE)


class _Scene:
    def __init__(self):
        self.geometry, self.graph = {}, types.SimpleNamespace(nodes_geometry=[])

    def dump(self):
        return [trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]], process=False)]


def glb(meshes=2, matrix=None):
    """Return the bytes of a GLB file with boxes."""
    scene = trimesh.Scene()
    for k in range(meshes):
        scene.add_geometry(trimesh.creation.box((1.0, 1.0, 1.0 + k)), transform=matrix)
    return bytearray(scene.export(file_type="glb"))


@pytest.mark.parametrize("scale", [ONE, (-1.0, 1.0, 1.0), (0.001, 0.001, 0.001)])
@pytest.mark.parametrize("index", [8, 900, 2**32 - 1])
@pytest.mark.parametrize("matrix", [None, np.diag([-1.0, 1.0, 1.0, 1.0])])
def test_a_face_index_beyond_the_points_of_a_glb_is_rejected(tmp_path, index, scale, matrix):
    path = tmp_path / "body.glb"
    data = glb(matrix=matrix)
    length = struct.unpack("<I", data[12:16])[0]
    table = json.loads(data[20 : 20 + length])
    view = table["bufferViews"][table["accessors"][table["meshes"][1]["primitives"][0]["indices"]]["bufferView"]]
    place = 28 + length + view.get("byteOffset", 0)
    data[place : place + 4] = struct.pack("<I", index)
    path.write_bytes(data)
    with pytest.raises(InputError, match="a triangle names the point|cannot be read as glb"):
        read_mesh(path, "body.glb", scale)


def mesh_bytes(kind):
    if kind == "glb":
        return bytes(glb())
    text = trimesh.creation.box().export(file_type=kind)
    return text.encode() if isinstance(text, str) else bytes(text)


@pytest.mark.parametrize("count", sizes(60, 2500))
@pytest.mark.parametrize("kind", ["glb", "stl", "obj", "ply"])
def test_damaged_meshes_are_refused_in_a_sentence(tmp_path, kind, count):
    rng = np.random.default_rng(7)
    whole = mesh_bytes(kind)
    path = tmp_path / f"body.{kind}"
    refused = 0
    for _ in range(count):
        data = bytearray(whole)
        for place in rng.integers(0, len(data), rng.integers(1, 8)):
            data[place] = int(rng.integers(0, 256))
        path.write_bytes(data[: rng.integers(1, len(data) + 1)] if rng.random() < 0.2 else data)
        try:
            assert len(read_mesh(path, path.name, (-1.0, 1.0, 2.0)).faces) > 0
        except InputError as error:
            refused += bool(str(error))
    assert refused > 0


def test_a_library_prints_no_trace_of_what_it_handles(tmp_path, capfd):
    path = tmp_path / "body.stl"
    text = trimesh.creation.box().export(file_type="stl_ascii")
    path.write_text(text.replace("facet normal", "facet normal x", 1))
    logging.getLogger("trimesh").handlers.clear()
    assert len(read_mesh(path, "body.stl", ONE).faces) == 12
    assert "Traceback" not in capfd.readouterr().err
