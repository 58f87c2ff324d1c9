"""Shapes and meshes of links: volumes, inertia, file formats, convex pieces, what takes the place of what is lost."""

import numpy as np
import pytest
import trimesh
from robot_texts import BALL, joint, link, mesh, robot

from crowdbot.core import MissingExtra, RobotError
from crowdbot.world import read_urdf
from crowdbot.world.urdf import Box, Capsule, Cylinder, Mesh, Sphere, meshes, mjcf, with_pieces
from crowdbot.world.urdf.inertia import unphysical

ROUND = trimesh.creation


@pytest.mark.parametrize(
    ("shape", "twin", "rel"),
    [
        (Box((1.0, 2.0, 3.0)), ROUND.box((1.0, 2.0, 3.0)), 1e-9),
        (Sphere(0.5), ROUND.icosphere(5, 0.5), 2e-3),
        (Cylinder(0.3, 2.0), ROUND.cylinder(0.3, 2.0, sections=400), 2e-3),
        (Capsule(0.3, 1.0), ROUND.capsule(1.0, 0.3, count=[200, 200]), 3e-3),
    ],
)
def test_volume_and_inertia_agree_with_fine_meshes(shape, twin, rel):
    solid = shape.solid()
    assert solid.volume == pytest.approx(twin.volume, rel=rel)
    np.testing.assert_allclose(solid.center, twin.center_mass, atol=1e-3)
    np.testing.assert_allclose(solid.inertia(solid.volume), twin.moment_inertia, rtol=3 * rel, atol=1e-3 * rel)
    np.testing.assert_allclose(shape.points().max(axis=0), twin.bounds[1], rtol=1e-3)


def bracket():
    """A thing that is far from convex."""
    return trimesh.boolean.union([ROUND.box((1.0, 0.1, 0.1)), ROUND.box((0.1, 0.1, 1.0))])


@pytest.mark.parametrize("kind", ["stl", "obj", "ply", "glb", "dae"])
def test_every_format_is_read(tmp_path, kind):
    ROUND.box((1.0, 2.0, 3.0)).export(tmp_path / f"box.{kind}")
    model = read_urdf(write(tmp_path, mesh(f"box.{kind}"), mesh(f"box.{kind}", "collision", "0.1 0.1 -0.1")))
    assert set(model.meshes) == {f"box.{kind}"}
    assert all(remark.kind == "noted" for remark in model.remarks)
    part = model.links["a"]
    np.testing.assert_allclose(np.ptp(part.visuals[0].shape.vertices, axis=0), [1.0, 2.0, 3.0], atol=1e-6)
    solid = part.collisions[0].shape.solid()
    assert solid.volume == pytest.approx(0.006, rel=1e-6)
    np.testing.assert_allclose(solid.inertia(6.0), Box((0.1, 0.2, 0.3)).solid().inertia(6.0), rtol=1e-6, atol=1e-9)


def write(folder, *inside, mass=1.0):
    path = folder / "robot.urdf"
    path.write_text(robot(link("a", "".join(inside), mass=mass)))
    return path


def test_the_unit_of_a_dae_is_applied(tmp_path):
    ROUND.box((1.0, 2.0, 3.0)).export(tmp_path / "box.dae")
    text = (tmp_path / "box.dae").read_text()
    assert 'meter="' in text or "<unit" not in text
    text = text.replace("<asset>", '<asset><unit name="millimeter" meter="0.001"/>') if "<unit" not in text else text
    (tmp_path / "box.dae").write_text(text)
    model = read_urdf(write(tmp_path, mesh("box.dae")))
    np.testing.assert_allclose(
        np.ptp(model.links["a"].visuals[0].shape.vertices, axis=0), [0.001, 0.002, 0.003], rtol=1e-6
    )


def test_a_mesh_that_is_not_convex_is_cut_into_pieces(tmp_path):
    thing = bracket()
    whole = Mesh("bracket", np.array(thing.vertices), np.array(thing.faces))
    cut, coarse = with_pieces(whole)
    assert coarse == ""
    assert 2 <= len(cut.pieces) <= 16
    assert cut.solid().volume == pytest.approx(thing.volume, rel=0.25)
    again, _ = with_pieces(whole)
    assert [p.vertices.tobytes() for p in cut.pieces] == [p.vertices.tobytes() for p in again.pieces]
    hull, _ = with_pieces(whole, "hull")
    assert len(hull.pieces) == 1
    assert hull.solid().volume == pytest.approx(thing.convex_hull.volume, rel=1e-9)


def test_without_a_library_for_pieces_the_hull_is_taken_and_said(tmp_path, monkeypatch):
    monkeypatch.setattr(meshes, "_decompose", lambda body: ())
    bracket().export(tmp_path / "bracket.stl")
    model = read_urdf(write(tmp_path, mesh("bracket.stl", "collision")))
    assert len(model.links["a"].collisions[0].shape.pieces) == 1
    assert "bracket.stl uses its convex hull," in model.warnings[0]


def test_a_flat_mesh_can_touch(tmp_path):
    flat = trimesh.Trimesh([[0, 0, 0], [1, 0, 0], [1, 1, 0], [0, 1, 0]], [[0, 1, 2], [0, 2, 3]])
    flat.export(tmp_path / "flat.stl")
    model = read_urdf(write(tmp_path, mesh("flat.stl", "collision")), colliders="hull")
    assert model.links["a"].collisions[0].shape.solid().volume == pytest.approx(0.001, rel=0.05)


@pytest.mark.parametrize(
    ("name", "content", "message"),
    [
        ("a.stl", b"", "cannot be used: it"),
        ("a.stl", b"\x00" * 80 + b"\xff\xff\xff\xff", "cannot be used: it"),
        ("a.ply", b"ply\nformat ascii 1.0\nelement vertex 99999999\nend_header\n", "cannot be used: it"),
        ("a.glb", b"glTF\x02\x00\x00\x00\xff\xff\xff\xff", "it has no GLB header"),
        ("a.obj", b"v 1 2\nf 1 2 3", "cannot be used: it"),
        ("a.obj", b"v nan 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "cannot be used: it"),
        ("a.obj", b"v 1e9 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3", "farther than 10 km from the origin"),
        ("a.dae", b"<COLLADA/>", "cannot be used: it"),
        ("a.dae", b"<!DOCTYPE x [<!ENTITY a 'b'>]><COLLADA>&a;</COLLADA>", "must not have a DOCTYPE or entities"),
        ("a.fbx", b"x", "the mesh format 'fbx' is not supported; use stl, dae, obj, ply, glb"),
    ],
    ids=lambda value: value[:24] if isinstance(value, str) else "",
)
def test_broken_meshes_are_replaced_and_said(tmp_path, name, content, message):
    (tmp_path / name).write_bytes(content)
    model = read_urdf(write(tmp_path, mesh(name), BALL.format(radius=0.5)))
    assert message in model.warnings[0]
    assert model.warnings[0].endswith("its colliders are shown instead")
    assert model.links["a"].visuals[0].shape == Sphere(0.5)


def test_materials_outside_the_folder_are_not_read(tmp_path):
    (tmp_path / "a.obj").write_text(
        "mtllib ../../../../etc/passwd\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 2 4\nf 1 3 4\nf 2 3 4\n"
    )
    model = read_urdf(write(tmp_path, mesh("a.obj")))
    (warning,) = model.warnings
    assert (
        "'../../../../etc/passwd' of the mesh a.obj is outside the folder of the robot; its colour is used" in warning
    )
    assert model.links["a"].visuals[0].shape.colors is None


def test_a_mesh_that_is_too_large_is_not_loaded(tmp_path, monkeypatch):
    ROUND.box((1, 1, 1)).export(tmp_path / "a.stl")
    monkeypatch.setattr(meshes, "MOST_BYTES", 100)
    assert "larger than 100 bytes" in read_urdf(write(tmp_path, mesh("a.stl"))).warnings[0]


def test_without_trimesh_the_extra_is_named(tmp_path, monkeypatch):
    ROUND.box((1, 1, 1)).export(tmp_path / "a.stl")
    monkeypatch.setitem(__import__("sys").modules, "trimesh", None)
    with pytest.raises(MissingExtra, match=r"pip install 'crowdbot\[sim\]'"):
        read_urdf(write(tmp_path, mesh("a.stl")))


def test_what_takes_the_place_of_lost_colliders(tmp_path):
    lost = mesh("gone.stl", "collision")
    seen = "<visual><geometry><box size='1 1 1'/></geometry></visual>"
    beside = read_urdf(write(tmp_path, lost, BALL.format(radius=0.5)))
    assert [part.shape for part in beside.links["a"].collisions] == [Sphere(0.5)]
    assert beside.warnings[0].endswith("gone.stl is missing; for contacts, only its other colliders are used")
    assert read_urdf(write(tmp_path, lost, seen)).links["a"].collisions[0].shape == Box((1.0, 1.0, 1.0))
    alone = read_urdf(write(tmp_path, lost, mass=60.0))
    assert alone.warnings[0].endswith("for contacts, the box of equal inertia is used")
    np.testing.assert_allclose(alone.links["a"].collisions[0].shape.size, [0.1] * 3, rtol=1e-6)
    light = read_urdf(write(tmp_path, lost, mass=0.008))
    assert light.warnings[0].endswith("for contacts, a cube of its mass at 1000 kg/m3 is used")
    np.testing.assert_allclose(light.links["a"].collisions[0].shape.size, [0.02] * 3)
    frame = read_urdf(robot(f"<link name='a'>{lost}</link>"))
    assert frame.warnings[0].endswith("the link has no colliders")


@pytest.mark.parametrize(
    ("moments", "words"),
    [
        ((1.0, 1.0, 3.0), "violate the triangle inequality"),
        ((0.0, 0.0, 0.0), "must all be above 0"),
        ((-1.0, 1.0, 1.0), "must all be above 0"),
    ],
)
def test_unphysical_inertia_becomes_that_of_the_shape(moments, words):
    shape = "<collision><geometry><box size='1 2 3'/></geometry></collision>"
    model = read_urdf(robot(link("a", shape, mass=12.0, moments=moments)))
    assert "its inertia is replaced by that of its shape with a mass of 12 kg" in model.warnings[0]
    assert words in model.warnings[0]
    np.testing.assert_allclose(np.diag(model.links["a"].inertial.tensor), [13.0, 10.0, 5.0])
    ball = read_urdf(robot(link("a", mass=12.0, moments=moments))).links["a"].inertial
    assert ball.mass == 12.0
    assert unphysical(ball.tensor) == ""


def test_a_thin_rod_is_physical_and_left_alone():
    model = read_urdf(robot(link("a", moments=(1.0, 1.0, 1e-9))))
    assert model.warnings == ()
    exact = read_urdf(robot(link("a", moments=(1.0, 2.0, 3.0)))).links["a"].inertial.tensor
    np.testing.assert_allclose(np.diag(exact), [1.0, 2.0, 3.0], rtol=1e-8)


def test_what_moves_without_mass_gets_a_gram():
    model = read_urdf(
        robot(
            link("a"),
            "<link name='b'/>",
            link("c"),
            joint("j", "continuous", "a", "b"),
            joint("k", "continuous", "b", "c"),
        )
    )
    assert model.links["b"].inertial.mass == 0.001
    assert "'b' moves but has neither mass nor shape" in model.warnings[0]
    fixed = read_urdf(
        robot(
            link("a"), "<link name='b'/>", link("c"), joint("j", "continuous", "a", "b"), joint("k", "fixed", "b", "c")
        )
    )
    assert fixed.warnings == ()


def test_an_inertia_far_too_large_for_the_shape_is_noted():
    model = read_urdf(robot(link("a", BALL.format(radius=0.05), mass=0.1, moments=(1, 1, 1))))
    assert "has the inertia of a body 13 m across" in model.warnings[0]
    assert model.links["a"].inertial.tensor[0, 0] == 1.0


def test_colours(tmp_path):
    box = "<geometry><box size='1 1 1'/></geometry>"
    rows = (
        "<material name='red'><color rgba='1 0 0 1'/></material>",
        link("a", f"<visual>{box}<material name='red'/></visual>"),
        link("b", f"<visual>{box}<material name='own'><color rgba='0 2 0 0.5'/></material></visual>"),
        link("c", f"<visual>{box}<material name='unknown'/></visual><visual>{box}<material name='own'/></visual>"),
        joint("j", "fixed", "a", "b"),
        joint("k", "fixed", "a", "c"),
    )
    model = read_urdf(robot(*rows))
    colors = {name: [part.color for part in linked.visuals] for name, linked in model.links.items()}
    assert colors == {"a": [(1, 0, 0, 1)], "b": [(0, 1, 0, 0.5)], "c": [None, (0, 1, 0, 0.5)]}
    assert any("uses the colour 'unknown'" in text for text in model.warnings)
    with pytest.raises(RobotError, match='<color> rgba="1 1" must be 4 numbers'):
        read_urdf(robot("<material name='x'><color rgba='1 1'/></material>", link("a")))


def test_colours_of_a_mesh_are_kept_and_a_material_comes_first(tmp_path):
    scene = trimesh.Scene()
    for k, color in enumerate(((255, 0, 0, 255), (0, 0, 255, 255))):
        box = trimesh.creation.box((1.0, 1.0, 1.0 + k))
        box.visual = trimesh.visual.TextureVisuals(material=trimesh.visual.material.PBRMaterial(baseColorFactor=color))
        scene.add_geometry(box)
    scene.export(tmp_path / "two.glb")
    shown = read_urdf(write(tmp_path, mesh("two.glb")))
    colors = {geom.attributes["rgba"] for geom in geoms_of(shown)}
    assert colors == {"1 0 0 1", "0 0 1 1"}
    painted = mesh("two.glb").replace("</visual>", "<material name='g'><color rgba='0 1 0 1'/></material></visual>")
    assert {geom.attributes["rgba"] for geom in geoms_of(read_urdf(write(tmp_path, painted)))} == {"0 1 0 1"}


def geoms_of(model):
    """Return the visual geoms of a robot."""
    found, waiting = [], [mjcf(model, base="fixed").root]
    while waiting:
        element = waiting.pop()
        waiting += element.children
        found += [element] if element.tag == "geom" and element.attributes.get("group") == "2" else []
    return found
