"""SDF models are read as the URDF of the same robot."""

import numpy as np
import pytest

from crowdbot.cli import main
from crowdbot.core import RobotError
from crowdbot.world import Robot, read_urdf
from samples import sizes

LINK = """<link name='{name}'><pose{relative}>{pose}</pose><inertial><pose>0.01 0 0.02 0 0 0</pose><mass>{mass}</mass>
<inertia><ixx>0.02</ixx><iyy>0.03</iyy><izz>0.04</izz><ixy>0.001</ixy></inertia></inertial>
<collision name='c'><geometry>{shape}</geometry>{surface}</collision>
<visual name='v'><pose>0 0 0 0 0 0</pose><geometry>{shape}</geometry>
<material><diffuse>0.2 0.4 0.6 1</diffuse></material></visual>{more}</link>"""
BOX = "<box><size>0.4 0.3 0.1</size></box>"
WHEEL = "<cylinder><radius>0.1</radius><length>0.04</length></cylinder>"
JOINT = """<joint name='{name}' type='revolute'>{pose}<parent>base</parent><child>{name}_wheel</child>
<axis><xyz{frame}>{axis}</xyz><limit><lower>-1e16</lower><upper>1e16</upper><effort>5</effort></limit>
<dynamics><damping>0.1</damping></dynamics></axis></joint>"""
SENSOR = """<sensor name='scan' type='gpu_lidar'><pose>0.1 0 0.1 0 0 0</pose><update_rate>5</update_rate><lidar><scan>
<horizontal><samples>90</samples><min_angle>-1</min_angle><max_angle>1</max_angle></horizontal></scan>
<range><min>0.1</min><max>8</max></range></lidar></sensor>"""
MU = "<surface><friction><ode><mu>0</mu></ode></friction></surface>"


def link(name, pose, shape=WHEEL, mass=1.0, relative="", surface="", more=""):
    row = {"name": name, "pose": pose, "shape": shape, "mass": mass, "surface": surface, "more": more}
    return LINK.format(relative=f" relative_to='{relative}'" if relative else "", **row)


def joint(name, axis="0 0 1", pose="", frame=""):
    return JOINT.format(name=name, axis=axis, pose=f"<pose>{pose}</pose>" if pose else "", frame=frame)


def model(*parts):
    return f"<sdf version='1.9'><model name='m'>{''.join(parts)}</model></sdf>"


CAR = model(
    link("base", "0 0 0.1 0 0 0", BOX, 10.0, more=SENSOR),
    link("left_wheel", "0 0.2 0.1 -1.5707963267948966 0 0"),
    link("right_wheel", "0 -0.2 0 -1.5707963267948966 0 0", relative="base"),
    link("ball", "-0.15 0 0.03 0 0 0", "<sphere><radius>0.03</radius></sphere>", 0.1, surface=MU),
    joint("left"),
    joint("right", "0 1 0", frame=" expressed_in='__model__'"),
    "<joint name='b' type='fixed'><parent>base</parent><child>ball</child></joint>",
    "<plugin filename='gz-sim-diff-drive-system' name='d'><wheel_separation>0.4</wheel_separation>"
    "<max_linear_velocity>0.7</max_linear_velocity></plugin>",
)


def test_a_model_is_read():
    urdf = read_urdf(CAR)
    assert (urdf.name, urdf.root, urdf.mass) == ("m", "base", pytest.approx(12.1))
    poses = urdf.poses()
    np.testing.assert_allclose(poses["left_wheel"][:3, 3], [0.0, 0.2, 0.0], atol=1e-12)
    np.testing.assert_allclose(poses["right_wheel"][:3, 3], [0.0, -0.2, 0.0], atol=1e-12)
    for name in ("left", "right"):
        turning = urdf.joints[name]
        assert (turning.kind, turning.motor.effort, turning.damping) == ("continuous", 5.0, 0.1)
        np.testing.assert_allclose(poses[turning.child][:3, :3] @ turning.axis, [0.0, 1.0, 0.0], atol=1e-12)
    assert urdf.links["ball"].friction == 0.0
    assert urdf.links["base"].visuals[0].color == (0.2, 0.4, 0.6, 1.0)
    assert urdf.links["base"].inertial.tensor[0, 1] == pytest.approx(0.001)


def test_a_pose_of_a_joint_moves_the_frame_but_not_the_shapes():
    plain = model(link("base", "0 0 0 0 0 0"), link("left_wheel", "1 0 0 0 0 0.5"), joint("left"))
    moved = model(
        link("base", "0 0 0 0 0 0"), link("left_wheel", "1 0 0 0 0 0.5"), joint("left", pose="0.3 0 0 0.2 0 0")
    )
    one, other = read_urdf(plain), read_urdf(moved)
    np.testing.assert_allclose(one.inertial().center, other.inertial().center, atol=1e-12)
    np.testing.assert_allclose(one.inertial().tensor, other.inertial().tensor, atol=1e-12)
    for a, b in ((one, other),):
        shapes = [m.poses()["left_wheel"] @ m.links["left_wheel"].visuals[0].origin for m in (a, b)]
        np.testing.assert_allclose(shapes[0], shapes[1], atol=1e-12)
    assert not np.allclose(one.joints["left"].origin, other.joints["left"].origin)


def test_an_sdf_becomes_a_robot_folder(tmp_path):
    (tmp_path / "car.sdf").write_text(CAR)
    assert main(["new", "robot", str(tmp_path / "car.sdf"), "--out", str(tmp_path / "car")]) == 0
    robot = Robot.load(tmp_path / "car")
    assert robot.about.startswith("differential")
    assert robot.drive.max_speed == 0.7
    assert (robot.mount("scan").sensor.rays, robot.mount("scan").x) == (90, 0.1)
    assert [wheel.radius for wheel in robot.wheels] == [0.1, 0.1]


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("<sdf/>", "urdf:1: <sdf> contains no <model>"),
        (model(), "contains no <link>"),
        (model(link("a", "0 0 x 0 0 0")), "urdf:1: <pose> contains '0 0 x 0 0 0', which is not a number"),
        (model(link("a", "0 0 0")), "it must be 6 numbers"),
        (model(link("a", "0 0 0 0 0 0", relative="b")), "has no frame 'b'"),
        (
            model(link("a", "0 0 0 0 0 0", relative="b"), link("b", "0 0 0 0 0 0", relative="a")),
            "has a pose relative to itself: a -> b -> a",
        ),
        (model(link("base", "0 0 0 0 0 0"), joint("left")), "has no frame 'left_wheel'"),
        (
            model(link("a", "0 0 0 0 0 0"), "<joint name='j' type='screw'><parent>a</parent><child>a</child></joint>"),
            "'j' type='screw' must be revolute, continuous, prismatic, fixed",
        ),
        (model("<link name='a'><visual name='v'/></link>"), "<visual> needs <geometry> with a shape"),
    ],
)
def test_what_is_wrong_is_said(text, sentence):
    with pytest.raises(RobotError) as caught:
        read_urdf(text)
    assert sentence in str(caught.value)


def test_what_is_left_out_is_told():
    urdf = read_urdf(
        model(
            link("a", "0 0 0 0 0 0", "<plane><normal>0 0 1</normal></plane>"),
            "<include><uri>model://x</uri></include>",
            "<joint name='j' type='fixed'><parent>world</parent><child>a</child></joint>",
        )
    )
    assert len([text for text in urdf.warnings if "is left out" in text]) == 4


@pytest.mark.needs("trimesh")
@pytest.mark.parametrize("center", ["", "<center>true</center>"])
def test_a_submesh_is_one_part_of_the_mesh_also_in_the_robot_folder(tmp_path, center):
    import trimesh

    scene = trimesh.Scene()
    for name, size, middle in (("tyre", (0.2, 0.2, 0.04), (0.3, 0.0, 0.0)), ("rim", (0.1, 0.1, 0.1), (0.0, 0.5, 0.0))):
        scene.add_geometry(trimesh.creation.box(size).apply_translation(middle), node_name=name, geom_name=name)
    (tmp_path / "parts.obj").write_text(scene.export(file_type="obj"))
    mesh = f"<mesh><uri>parts.obj</uri><submesh><name>{{}}</name>{center}</submesh></mesh>"
    base = link("base", "0 0 0 0 0 0", BOX, 10.0)
    text = model(base, link("left_wheel", "0 0.2 0 0 0 0", mesh.format("tyre")), joint("left"))
    (tmp_path / "car.sdf").write_text(text)
    model_of_file = read_urdf(tmp_path / "car.sdf")
    assert main(["new", "robot", str(tmp_path / "car.sdf"), "--out", str(tmp_path / "car"), "--yes"]) == 0
    for robot in (model_of_file, read_urdf(tmp_path / "car" / "car.urdf")):
        for part in (robot.links["left_wheel"].visuals[0], robot.links["left_wheel"].collisions[0]):
            points = part.shape.points()
            np.testing.assert_allclose(np.ptp(points, axis=0), [0.2, 0.2, 0.04], atol=1e-9)
            middle = 0.5 * (points.min(axis=0) + points.max(axis=0))
            np.testing.assert_allclose(middle, [0.0 if center else 0.3, 0.0, 0.0], atol=1e-9)
    (tmp_path / "car.sdf").write_text(text.replace("<name>tyre</name>", "<name>tire</name>"))
    remarks = " ".join(read_urdf(tmp_path / "car.sdf").warnings)
    assert "parts.obj cannot be used: it has no part 'tire', did you mean 'tyre'?; its parts: 'rim', 'tyre'" in remarks


@pytest.mark.parametrize("count", sizes(150, 3000))
def test_damaged_models_are_refused_or_read(count):
    rng = np.random.default_rng(17)
    outcomes = {"read": 0, "refused": 0}
    for _ in range(count):
        text = CAR
        for _ in range(rng.integers(1, 4)):
            at = int(rng.integers(5, len(text)))
            word = ("", "-", "1e9", "<", "nan", "0 ", "base", " name='left'")[rng.integers(8)]
            text = text[:at] + word + text[at + int(rng.integers(0, 5)) :]
        try:
            outcomes["read"] += np.isfinite(read_urdf(text).mass)
        except RobotError as error:
            outcomes["refused"] += all(problem.startswith("urdf") for problem in error.problems)
    assert sum(outcomes.values()) == count
    assert min(outcomes.values()) > 0
