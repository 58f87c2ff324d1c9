"""Several imported robots with meshes and textures share a physics world, and each keeps its own shape."""

import struct

import numpy as np
import pytest
from maker_texts import write_stl
from mesh_texts import BOX_MTL, BOX_OBJ, PNG

from crowdbot.cli import main
from crowdbot.core import Element, InputError
from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial
from crowdbot.world import Robot, drive_tests, worlds_of
from crowdbot.world.physics.mjcf_model import MjcfModel

INERTIA = "<inertia ixx='{0}' iyy='{0}' izz='{0}' ixy='0' ixz='0' iyz='0'/>"
WHEEL = f"""<link name='{{side}}_wheel'><inertial><mass value='1'/>{INERTIA.format(0.003)}</inertial>
<collision><geometry><cylinder radius='0.1' length='0.04'/></geometry></collision></link>
<joint name='{{side}}_wheel_joint' type='continuous'><parent link='base_link'/><child link='{{side}}_wheel'/>
<origin xyz='0 {{y}} 0.1' rpy='-1.5707963 0 0'/><axis xyz='0 0 1'/></joint>"""
CART = f"""<robot name='cart'><link name='base_link'>
<inertial><origin xyz='0 0 0.2'/><mass value='20'/>{INERTIA.format(0.5)}</inertial>
<visual><origin xyz='0 0 0.4'/><geometry><mesh filename='box.obj' scale='0.2 0.2 0.2'/></geometry></visual>
<collision><origin xyz='0 0 0.2'/><geometry><box size='0.5 0.4 0.2'/></geometry></collision>
<collision><origin xyz='0.2 0 0.05'/><geometry><sphere radius='0.05'/></geometry></collision>
<collision><origin xyz='0 0 0.3'/>
<geometry><mesh filename='tower.stl' scale='0.001 0.001 0.001'/></geometry></collision>
</link>{WHEEL.format(side="left", y=0.25)}{WHEEL.format(side="right", y=-0.25)}</robot>"""
TRIAL = """<trial name="two" duration="2" step="0.05" world="physics"><stage walkable="-8,-5 8,-5 8,5 -8,5"/>
<crowd type="orca"/><agent x="0" y="4" goal="3,4"/>
<robot name="a" type="slim" x="-6" y="1"><goal x="6" y="1"/><navigator type="orca"/></robot>
<robot name="b" type="wide" x="-6" y="-2"><goal x="6" y="-2"/><navigator type="orca"/></robot></trial>"""
RADII = {"slim": 50.0, "wide": 120.0}
"""Radius of the tower of each robot [mm]."""


@pytest.fixture
def trial(tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    for name, radius in RADII.items():
        source = tmp_path / f"{name}-source"
        source.mkdir()
        (source / "box.obj").write_text(BOX_OBJ)
        (source / "box.mtl").write_text(BOX_MTL)
        (source / "paint.png").write_bytes(PNG)
        write_stl(source / "tower.stl", radius)
        (source / "cart.urdf").write_text(CART)
        assert main(["new", "robot", str(source / "cart.urdf"), "--out", name, "--yes"]) == 0
    (tmp_path / "two.xml").write_text(TRIAL)
    return load_trial(tmp_path / "two.xml")


def test_both_drive_and_each_has_its_own_mesh(trial):
    simulation = Simulation(trial, 0)
    simulation.begin()
    start = simulation.world.environment_scene(0).position[0, -2:].copy()
    for _ in range(40):
        simulation.advance()
    moved = simulation.world.environment_scene(0).position[0, -2:] - start
    assert np.all(moved[:, 0] > 0.3)
    model = worlds_of(simulation.world)[0].engine_model
    assert model.ntex >= 2
    radii = {}
    for mesh in range(model.nmesh):
        begin, count = model.mesh_vertadr[mesh], model.mesh_vertnum[mesh]
        corners = model.mesh_vert[begin : begin + count]
        radii.setdefault(model.mesh(mesh).name.split("/")[0], []).append(float(np.ptp(corners, axis=0).max()) / 2)
    assert [max(radii[f"robot{agent}"]) for agent in (1, 2)] == pytest.approx([0.1, 0.12], abs=1e-3)
    assert [min(radii[f"robot{agent}"]) for agent in (1, 2)] == pytest.approx([0.05, 0.1], abs=1e-3)


def fender(folder, tilt):
    """Write an STL file of a plate without thickness that leans by an angle [rad], in the precision of STL files."""
    turn = np.array([[np.cos(tilt), 0.0, np.sin(tilt)], [0.0, 1.0, 0.0], [-np.sin(tilt), 0.0, np.cos(tilt)]])
    corners = np.array([[-0.2, -0.05, 0.0], [0.15, -0.05, 0.0], [0.15, 0.05, 0.0], [-0.2, 0.05, 0.0]]) @ turn.T + 0.3
    triangles = corners[[[0, 1, 2], [0, 2, 3]]].astype("<f4")
    rows = b"".join(struct.pack("<12fH", 0, 0, 0, *triangle.ravel(), 0) for triangle in triangles)
    (folder / "fender.stl").write_bytes(bytes(80) + struct.pack("<I", len(triangles)) + rows)


@pytest.mark.parametrize("tilt", [0.0, 0.1, 0.7, 1.2, -0.4, np.pi / 2])
def test_a_plate_without_thickness_is_a_body_in_the_physics_world(tmp_path, monkeypatch, tilt):
    monkeypatch.chdir(tmp_path)
    fender(tmp_path, tilt)
    plate = "<collision><geometry><mesh filename='fender.stl'/></geometry></collision></link>"
    text = CART.split("<collision><origin xyz='0 0 0.3'/>", maxsplit=1)[0].replace("<visual><origin xyz='0 0 0.4'/>"
        "<geometry><mesh filename='box.obj' scale='0.2 0.2 0.2'/></geometry></visual>", "")  # fmt: skip
    wheels = CART.partition("</link>")[2]
    (tmp_path / "cart.urdf").write_text(text + plate + wheels)
    assert main(["new", "robot", str(tmp_path / "cart.urdf"), "--out", "bare", "--yes"]) == 0
    robot = Robot.load(tmp_path / "bare")
    shape = robot.model.links["base_link"].collisions[-1].shape
    volume = sum(piece.solid().volume for piece in shape.pieces)
    assert 0.35 * 0.1 * 0.0005 < volume < 0.36 * 0.11 * 0.002
    assert [test.problem for test in drive_tests(robot)] == ["", ""]


def test_what_the_physics_engine_refuses_is_an_error_of_the_input():
    model = MjcfModel(Element("mujoco", {}, [Element("no-such-section")]), {}, {}, frozenset(), {})
    with pytest.raises(InputError, match="MuJoCo refuses the world: .*no-such-section"):
        model.load(0.01)
