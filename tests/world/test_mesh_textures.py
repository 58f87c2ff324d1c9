"""Colours and textures of mesh files are drawn as their makers made them."""

import numpy as np
import pytest
from mesh_texts import BOX_DAE, BOX_MTL, BOX_OBJ, PAINT, PNG, box_glb

from crowdbot.cli import main
from crowdbot.world import Robot, read_urdf
from crowdbot.world.rendering import gl_context
from crowdbot.world.rendering.gl_context import close_gl_context, create_gl_context
from crowdbot.world.urdf import mjcf

TEXT = """<robot name='r'><link name='a'><inertial><mass value='{mass}'/>
<inertia ixx='1' iyy='1' izz='1' ixy='0' ixz='0' iyz='0'/></inertial>
<visual><geometry><mesh filename='{name}'/></geometry>{material}</visual>
<collision><geometry><box size='1 1 1'/></geometry></collision></link></robot>"""


def write(folder, kind, material="", mass=9):
    """Write a robot with a painted box and return its path."""
    folder.mkdir(exist_ok=True)
    (folder / "textures").mkdir(exist_ok=True)
    (folder / "textures" / "paint.png").write_bytes(PNG)
    (folder / "box.mtl").write_text(BOX_MTL.replace("paint.png", "textures/paint.png"))
    data = {
        "obj": BOX_OBJ.encode(),
        "dae": BOX_DAE.replace("paint.png", "./textures/paint.png").encode(),
        "glb": box_glb(),
    }
    (folder / f"box.{kind}").write_bytes(data[kind])
    (folder / "r.urdf").write_text(TEXT.format(name=f"box.{kind}", material=material, mass=mass))
    return folder / "r.urdf"


def look(model):
    """Return the image of a robot's side, seen along y."""
    import mujoco

    made = mjcf(model, base="fixed", floor=True).load()
    data = mujoco.MjData(made)
    mujoco.mj_forward(made, data)
    camera = mujoco.MjvCamera()
    camera.azimuth, camera.elevation, camera.distance = 90.0, 0.0, 2.2
    canvas = create_gl_context(120, 120)
    context = mujoco.MjrContext(made, mujoco.mjtFontScale.mjFONTSCALE_100)
    mujoco.mjr_setBuffer(mujoco.mjtFramebuffer.mjFB_OFFSCREEN, context)
    scene = mujoco.MjvScene(made, maxgeom=20)
    option = mujoco.MjvOption()
    mujoco.mjv_updateScene(made, data, option, None, camera, mujoco.mjtCatBit.mjCAT_ALL.value, scene)
    area, colors = mujoco.MjrRect(0, 0, 120, 120), np.empty((120, 120, 3), dtype=np.uint8)
    mujoco.mjr_render(area, scene, context)
    mujoco.mjr_readPixels(colors, None, area, context)
    close_gl_context(canvas, context)
    return np.flipud(colors).astype(int)


@pytest.mark.parametrize("kind", ["obj", "dae", "glb"])
def test_a_texture_is_drawn_upright(tmp_path, kind):
    model = read_urdf(write(tmp_path, kind))
    assert model.warnings == ()
    (texture,) = model.links["a"].visuals[0].shape.textures
    assert (texture.first, texture.last) == (0, 12)
    image = look(model)
    corners = [[image[40, 40], image[40, 80]], [image[80, 40], image[80, 80]]]
    for row in range(2):
        for column in range(2):
            seen, wanted = corners[row][column], PAINT[row, column].astype(int)
            brightness = seen.sum() / wanted.sum()
            np.testing.assert_allclose(seen, wanted * brightness, atol=25)


@pytest.mark.parametrize("kind", ["obj", "dae"])
def test_textures_move_with_their_mesh_into_the_robot_folder(tmp_path, kind, monkeypatch):
    monkeypatch.chdir(tmp_path)
    file = write(tmp_path / "maker", kind)
    assert main(["new", "robot", str(file), "--out", "painted", "--yes"]) == 0
    robot = Robot.load(tmp_path / "painted")
    shape = robot.model.links["a"].visuals[0].shape
    assert shape.textures == read_urdf(file).links["a"].visuals[0].shape.textures
    assert (tmp_path / "painted" / "meshes" / "box" / "textures" / "paint.png").read_bytes() == PNG
    assert robot.model.warnings == ()


def test_a_colour_of_the_robot_file_comes_first(tmp_path):
    model = read_urdf(write(tmp_path, "obj", "<material name='m'><color rgba='1 0 0 1'/></material>"))
    assert "texture" not in mjcf(model).xml
    assert 'rgba="1 0 0 1"' in mjcf(model).xml


def test_a_texture_of_the_robot_file_is_replaced_by_its_mean_colour(tmp_path):
    material = "<material name='m'><texture filename='textures/paint.png'/></material>"
    model = read_urdf(write(tmp_path, "obj", material))
    mean = PAINT.reshape(-1, 3).mean(axis=0) / 255.0
    np.testing.assert_allclose(model.links["a"].visuals[0].color, [*mean, 1.0], atol=0.02)
    lost = read_urdf(write(tmp_path, "obj", material.replace("paint", "lost")))
    assert "the texture 'textures/lost.png' is missing" in lost.warnings[0]


def test_the_texture_does_not_change_the_physics(tmp_path):
    painted, plain = (read_urdf(write(tmp_path / kind, kind)) for kind in ("glb", "obj"))
    assert painted.mass == plain.mass == 9.0
    assert mjcf(painted).load().body_mass.tolist() == mjcf(plain).load().body_mass.tolist()


def test_a_material_without_its_texture_has_its_colour(tmp_path):
    file = write(tmp_path, "obj")
    (tmp_path / "textures" / "paint.png").unlink()
    model = read_urdf(file)
    assert "'textures/paint.png' of the mesh box.obj is missing; its colour is used" in model.warnings[0]
    assert model.links["a"].visuals[0].shape.colors[0].tolist() == [204, 204, 204, 255]


def test_colours_of_points_are_drawn(tmp_path):
    import trimesh

    box = trimesh.creation.box()
    box.visual.vertex_colors = np.linspace(0, 255, 8 * 4).reshape(8, 4).astype(np.uint8) | [[0, 0, 0, 255]]
    box.export(tmp_path / "box.ply")
    (tmp_path / "r.urdf").write_text(TEXT.format(name="box.ply", material="", mass=1))
    shape = read_urdf(tmp_path / "r.urdf").links["a"].visuals[0].shape
    assert len(np.unique(shape.colors, axis=0)) > 4
    assert mjcf(read_urdf(tmp_path / "r.urdf")).load().ngeom > 4


class Context:
    """An OpenGL context that is current in another thread."""

    free_calls = 0

    def make_current(self):
        raise RuntimeError("EGL_BAD_ACCESS")

    def free(self):
        self.free_calls += 1


def test_a_context_that_another_thread_uses_stays_until_the_end(monkeypatch):
    context = Context()
    monkeypatch.setattr(gl_context, "OPEN", [context])
    monkeypatch.setattr(gl_context, "BUSY", [])
    close_gl_context(context, context)
    assert gl_context.OPEN == gl_context.BUSY == [context]
    assert context.free_calls == 0
