"""Meshes that tools/fuzz_readers.py found: one sentence, and no trace in the log of a library."""

import logging

import pytest
import trimesh

from crowdbot.core import InputError
from crowdbot.world.urdf.meshes import read_mesh

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
    def dump(self):
        return [trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [0, 1, 0]], [[0, 1, 7]], process=False)]


def test_a_library_prints_no_trace_of_what_it_handles(tmp_path, capfd):
    path = tmp_path / "body.stl"
    text = trimesh.creation.box().export(file_type="stl_ascii")
    path.write_text(text.replace("facet normal", "facet normal x", 1))
    logging.getLogger("trimesh").handlers.clear()
    assert len(read_mesh(path, "body.stl", ONE).faces) == 12
    assert "Traceback" not in capfd.readouterr().err
