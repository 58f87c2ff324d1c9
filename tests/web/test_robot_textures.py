"""Textures of robot meshes are sent with the robot, within limits, and drawn in space."""

import base64
import io

import numpy as np
import pytest
from PIL import Image

from crowdbot.simulation import Simulation
from crowdbot.trials import load_trial
from crowdbot.web.scene import meshes as limits
from crowdbot.web.scene import scene_description, scene_frame, scene_resource
from crowdbot.web.scene.meshes import texture_arrays
from crowdbot.web.state_frame import StateFrame
from crowdbot.world import Robot, link_surface
from crowdbot.world.urdf.shapes import Texture

PAINT = np.array([[[220, 20, 20], [20, 200, 20]], [[20, 20, 220], [230, 210, 20]]], dtype=np.uint8)
"""Colours of the lid: red, green in the upper row; blue, yellow in the lower."""
ROBOT = """<robot name="painted" urdf="painted.urdf" base="planar" about="A box with a painted lid">
  <drive type="differential-drive" max-speed="1.0"/><footprint radius="0.5"/></robot>"""
URDF = """<robot name="painted"><link name="base_link">
  <inertial><mass value="9"/><inertia ixx="1" iyy="1" izz="1" ixy="0" ixz="0" iyz="0"/></inertial>
  <visual><geometry><mesh filename="lid.obj"/></geometry>{material}</visual>
  <visual><origin xyz="0 0 0.25"/><geometry><box size="0.9 0.9 0.4"/></geometry></visual>
  <collision><origin xyz="0 0 0.25"/><geometry><box size="1 1 0.5"/></geometry></collision></link></robot>"""
OBJ = """mtllib lid.mtl
v -0.5 -0.5 0.5\nv 0.5 -0.5 0.5\nv 0.5 0.5 0.5\nv -0.5 0.5 0.5
vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1
usemtl paint\nf 1/1 2/2 3/3\nf 1/1 3/3 4/4
"""
MTL = "newmtl paint\nKd 1 1 1\nmap_Kd paint.png\n"


def png(pixels):
    stream = io.BytesIO()
    Image.fromarray(pixels).save(stream, "PNG")
    return stream.getvalue()


LID = png(np.repeat(np.repeat(PAINT, 32, 0), 32, 1))


def write(folder, image=LID, material=""):
    """Write a robot with a painted lid and return its folder."""
    folder.mkdir(exist_ok=True)
    for name, text in (("robot.xml", ROBOT), ("painted.urdf", URDF.format(material=material)), ("lid.obj", OBJ)):
        (folder / name).write_text(text)
    (folder / "lid.mtl").write_text(MTL)
    (folder / "paint.png").write_bytes(image)
    return folder


def mesh_of(folder):
    simulation = Simulation(load_trial("frontal", trust=True, **{"robot/type": str(folder)}), posed=True)
    return simulation, StateFrame.decode(scene_resource(simulation, "robots/robot.bin", {}).data).arrays


def test_a_texture_is_sent_with_its_triangles(tmp_path):
    _, arrays = mesh_of(write(tmp_path / "painted"))
    assert arrays["textured"].tolist() == [[0, 2, 0]]
    assert arrays["color"][:2].tolist() == [[255] * 4] * 2
    pixels = np.asarray(Image.open(io.BytesIO(arrays["image0"].tobytes())))
    assert (pixels[::63, ::63] == PAINT).all()
    lid = arrays["faces"][:2].ravel()
    np.testing.assert_allclose(arrays["uv"][lid], arrays["vertices"][lid][:, :2] + 0.5, atol=1e-6)
    assert len(arrays["uv"]) == len(arrays["vertices"])


def test_a_colour_of_the_robot_file_replaces_the_texture_as_in_camera_images(tmp_path):
    red = "<material name='m'><color rgba='1 0 0 1'/></material>"
    _, arrays = mesh_of(write(tmp_path / "painted", material=red))
    assert "uv" not in arrays
    assert arrays["color"][:2].tolist() == [[255, 0, 0, 255]] * 2
    surface = link_surface(Robot.load(tmp_path / "painted").model.links["base_link"])
    assert surface.textures == ()


@pytest.mark.parametrize(
    "image",
    [b"\x89PNG\r\n\x1a\n" + bytes(50), b"<svg onload='alert(1)'/>", LID[: len(LID) // 2], b""],
    ids=["broken", "svg", "half", "empty"],
)
def test_hostile_images_never_reach_the_browser(tmp_path, image):
    _, arrays = mesh_of(write(tmp_path / "painted", image))
    assert not [name for name in arrays if name.startswith("image")]
    assert len(arrays["color"]) == len(arrays["faces"])


def test_large_images_are_halved_and_equal_ones_sent_once(monkeypatch):
    noise = png(np.random.default_rng(0).integers(0, 256, (64, 64, 3), dtype=np.uint8))
    uv = np.zeros((6, 2))
    same = texture_arrays([Texture(0, 1, noise), Texture(1, 2, noise)], uv)
    assert same["textured"].tolist() == [[0, 1, 0], [1, 2, 0]]
    assert same["image0"].tobytes() == noise
    monkeypatch.setattr(limits, "MOST_BYTES", 9_000)
    found = texture_arrays([Texture(0, 1, noise), Texture(1, 2, LID)], uv)
    assert len(found["image0"]) <= 4_500
    assert Image.open(io.BytesIO(found["image0"].tobytes())).size == (32, 32)
    monkeypatch.setattr(limits, "MOST_IMAGES", 1)
    assert texture_arrays([Texture(0, 1, noise), Texture(1, 2, LID)], uv)["textured"].tolist() == [[0, 1, 0]]
    assert texture_arrays([], uv) == {}


PAGE = """async ({ files, description, frame }) => {
  const { Scene3D, decodeFrame } = crowdbotPlayer;
  const bytes = (text) => Uint8Array.from(atob(text), (one) => one.charCodeAt(0));
  const url = (path) => URL.createObjectURL(new Blob([bytes(files[path])]));
  document.body.innerHTML = "<canvas style='width:300px;height:300px'></canvas>";
  const canvas = document.querySelector("canvas");
  const scene = window.scene = new Scene3D(canvas, url);
  await scene.load(description);
  scene.apply(decodeFrame(bytes(frame).buffer));
  const [x, y] = scene.state.place("robot", description.robots[0].id);
  scene.setCamera("free");
  scene._views.camera.position.set(x - 0.02, y, 3.2);
  scene._views.controls.target.set(x, y, 0.5);
  scene.render();
  const flat = document.createElement("canvas");
  flat.width = flat.height = 300;
  flat.getContext("2d").drawImage(canvas, 0, 0, 300, 300);
  const at = (px, py) => Array.from(flat.getContext("2d").getImageData(px, py, 1, 1).data.slice(0, 3));
  return { textures: scene.info().textures, seen: [[at(130, 130), at(170, 130)], [at(130, 170), at(170, 170)]] };
}"""


@pytest.mark.parametrize("broken", [False, True])
def test_the_lid_is_drawn_in_its_colours(browser, tmp_path, broken):
    from importlib import resources

    simulation, _ = mesh_of(write(tmp_path / "painted"))
    names = [f"bodies/{level}.bin" for level in range(3)] + ["robots/robot.bin"]
    files = {name: scene_resource(simulation, name, {}).data for name in names}
    if broken:  # the page itself does not trust an image either
        files["robots/robot.bin"] = files["robots/robot.bin"].replace(b"\x89PNG", b"\x89PNX")
    found = {name: base64.b64encode(data).decode() for name, data in files.items()}
    frame = base64.b64encode(scene_frame(simulation, []).encode()).decode()
    context = browser.new_context(viewport={"width": 300, "height": 300})
    page, faults = context.new_page(), []
    page.on("pageerror", lambda one: faults.append(str(one)))
    page.set_content("<!doctype html><title>robot</title>")
    script = resources.files("crowdbot").joinpath("assets", "web", "player.js").read_text("utf-8")
    page.add_script_tag(content=script, type="module")
    page.wait_for_function("() => Boolean(globalThis.crowdbotPlayer)")
    answer = page.evaluate(PAGE, {"files": found, "description": scene_description(simulation), "frame": frame})
    page.screenshot(path=tmp_path / "lid.png")
    context.close()
    assert faults == []
    seen = np.array(answer["seen"], dtype=float)
    if broken:
        assert np.ptp(seen, axis=2).max() < 30  # plain
        return
    # ahead of the robot, x, is up in the picture, and its left, y, is left
    heading = float(scene_frame(simulation, []).arrays["botplace"][0, 2])
    assert heading == pytest.approx(0.0, abs=1e-6)
    wanted = np.array([[PAINT[0, 1], PAINT[1, 1]], [PAINT[0, 0], PAINT[1, 0]]], dtype=float)
    for row in range(2):
        for column in range(2):
            share = np.dot(seen[row, column], wanted[row, column]) / (
                np.linalg.norm(seen[row, column]) * np.linalg.norm(wanted[row, column])
            )
            assert share > 0.95, (row, column, seen.tolist())
