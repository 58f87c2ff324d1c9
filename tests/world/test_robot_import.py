"""A maker's file becomes a robot folder that runs in both worlds, and everything guessed is listed."""

import math

import numpy as np
import pytest
from base_texts import BASES, FOUR, PAIR, base_file, wheels

from crowdbot.cli import main
from crowdbot.core import InputError, RobotError, Scene, Twist
from crowdbot.models import ORCA
from crowdbot.world import PhysicsWorld, PlanarWorld, Robot, check_robot, import_robot, read_urdf
from crowdbot.world.robots.base_kind import recognize_base


def convert(folder, text, *words, name="maker"):
    """Convert a text to a robot folder and return it."""
    file = folder / f"{name}.urdf.xacro"
    file.write_text(text)
    assert main(["new", "robot", str(file), "--out", str(folder / name), *words]) == 0
    return folder / name


DRIVES = {
    "differential": "DifferentialDrive", "skid-steer": "SkidSteerDrive", "mecanum": "MecanumDrive",
    "omnidirectional": "OmniWheelDrive", "ackermann": "AckermannDrive", "tricycle": "TricycleDrive",
    "legged": "LeggedDrive",
}  # fmt: skip


@pytest.mark.parametrize("kind", BASES)
def test_every_kind_of_base_is_recognized_and_runs(tmp_path, capsys, kind):
    folder = convert(tmp_path, base_file(kind))
    table = capsys.readouterr().out
    assert f" {kind} " in table.split("kind of base", 1)[1].splitlines()[0]
    robot = Robot.load(folder)
    check_robot(robot)
    assert robot.model.mass == read_urdf(tmp_path / "maker.urdf.xacro").mass
    assert type(robot.drive).__name__ == DRIVES[kind]
    assert robot.base == ("planar" if kind == "legged" else "wheels")
    lidar = robot.mount("scan").sensor
    assert (lidar.rays, lidar.rate, lidar.range_max, round(lidar.field_of_view, 6)) == (181, 20.0, 12.0, 3.14)
    assert lidar.noise
    scene = Scene.of([[0.0, 0.0]], external=[True], heading=[0.0], radius=robot.radius)
    planar, physics = PlanarWorld(scene, ORCA(), {0: robot.drive}, 0.05), PhysicsWorld(scene, ORCA(), {0: robot}, 0.05)
    for _ in range(40):
        flat, solid = planar.step({0: Twist(0.3)}), physics.step({0: Twist(0.3)})
    assert flat.position[0, 0, 0] > 0.4
    np.testing.assert_allclose(solid.position[0, 0], flat.position[0, 0], atol=0.12)
    assert abs(float(solid.heading[0, 0])) < 0.2


@pytest.mark.parametrize("kind", ["differential", "skid-steer", "ackermann"])
def test_the_printed_commands_run(tmp_path, capsys, monkeypatch, kind):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "maker.xacro").write_text(base_file(kind))
    assert main(["new", "robot", "maker.xacro"]) == 0
    lines = [line for line in capsys.readouterr().out.splitlines() if "  crowdbot " in line]
    assert len(lines) == 4
    for line in lines:
        words = line.split("  crowdbot ")[1].split()
        if words[0] != "render":
            assert main(words) == 0
    assert "Traceback" not in capsys.readouterr().err


def test_the_origin_of_a_car_is_its_rear_axle(tmp_path):
    robot = Robot.load(convert(tmp_path, base_file("ackermann")))
    places = robot.model.poses()
    assert abs(places["rear_left"][0, 3]) < 1e-9
    assert robot.drive.wheelbase == pytest.approx(0.4)
    inner = 0.4 / math.tan(robot.drive.max_steering) - 0.2  # turning radius of the inner wheel
    assert math.atan(0.4 / inner) == pytest.approx(0.5)
    assert sorted(wheel.steering for wheel in robot.wheels if wheel.steering) == [
        "front_left_steer",
        "front_right_steer",
    ]
    assert sum(wheel.driven for wheel in robot.wheels) == 2


PLUGIN = """<gazebo><plugin name='p' filename='libgazebo_ros_diff_drive.so'><wheel_separation>0.4</wheel_separation>
<wheel_diameter>0.2</wheel_diameter><max_wheel_torque>7</max_wheel_torque><max_wheel_acceleration>2.5</max_wheel_acceleration>
<max_linear_velocity>0.6</max_linear_velocity></plugin></gazebo>"""


def test_parameters_of_the_drive_plugin_are_taken(tmp_path):
    text = base_file("differential").replace("</robot>", f"{PLUGIN}</robot>")
    robot = Robot.load(convert(tmp_path, text))
    assert (robot.drive.max_speed, robot.drive.max_acceleration) == (0.6, 2.5)
    assert robot.model.joints["left_joint"].motor.effort == 7.0
    assert robot.model.joints["left_joint"].motor.kind == "velocity"
    assert robot.model.links["castor"].friction == 0.0


def test_a_plugin_decides_and_an_option_decides_more(tmp_path):
    file = tmp_path / "r.xacro"
    plugin = "<gazebo><plugin name='x' filename='libgazebo_ros_planar_move.so'/></gazebo>"
    file.write_text(base_file("skid-steer").replace("</robot>", f"{plugin}</robot>"))
    assert import_robot(file, "r").kind == "omnidirectional"
    assert import_robot(file, "r", kind="mecanum").kind == "mecanum"
    with pytest.raises(InputError, match=r"kind of base 'mecanom' must be .*did you mean 'mecanum'"):
        import_robot(file, "r", kind="mecanom")


def test_wheels_that_roll_along_y_are_noted(tmp_path):
    file = tmp_path / "r.xacro"
    file.write_text(base_file("differential"))
    assert not any("roll along y" in remark for remark in import_robot(file, "r").remarks)
    across = wheels(("left", 0.2, 0, math.pi / 2), ("right", -0.2, 0, math.pi / 2))
    file.write_text(base_file("differential").replace(wheels(*PAIR), across))
    made = import_robot(file, "r", kind="differential")
    assert any("the wheels roll along y, but the front of a robot is along x" in remark for remark in made.remarks)


@pytest.mark.parametrize("name", ["caster", "wheel_module", "swivel"])
def test_castors_that_must_drive_are_driven_and_steered(tmp_path, name):
    modules = "".join(
        f"<link name='{place}_{name}'/><joint name='{place}_{name}_joint' type='continuous'><parent link='base_link'/>"
        f"<child link='{place}_{name}'/><origin xyz='{x} {y} 0.1'/><axis xyz='0 0 1'/></joint>"
        f"<xacro:wheel name='{place}' x='0' y='0' parent='{place}_{name}'/>"
        for place, x, y, _ in FOUR
    )
    file = tmp_path / "maker.xacro"
    file.write_text(base_file("differential").replace(BASES["differential"], modules))
    assert import_robot(file, "r").kind == "omnidirectional"


@pytest.mark.parametrize("kind", ["differential", "omnidirectional"])
@pytest.mark.parametrize("joints", ["x y theta", "theta", "world_joint x y z theta"])
def test_joints_that_move_the_whole_robot_are_no_legs(tmp_path, kind, joints):
    parent, text = "world", "<link name='world'/>"
    for k, name in enumerate(names := joints.split()):
        child = "base_link" if k == len(names) - 1 else f"virtual_{name}"
        text += "" if child == "base_link" else f"<link name='{child}'/>"
        axis = {"x": "1 0 0", "y": "0 1 0"}.get(name, "0 0 1")
        type_ = {"theta": "continuous", "world_joint": "fixed"}.get(name, "prismatic")
        text += (
            f"<joint name='{name}' type='{type_}'><parent link='{parent}'/><child link='{child}'/><axis xyz='{axis}'/>"
            "<limit lower='-9' upper='9' effort='100' velocity='1'/></joint>"
        )
        parent = child
    file = tmp_path / "maker.xacro"
    file.write_text(base_file(kind).replace("</robot>", f"{text}</robot>"))
    assert import_robot(file, "r").kind == kind


def test_a_receiver_in_all_directions_is_no_omnidirectional_base(tmp_path):
    file = tmp_path / "r.xacro"
    plugin = "<gazebo><plugin name='ir_omni_plugin' filename='libgazebo_ros_create_ir_opcode.so'/></gazebo>"
    file.write_text(base_file("differential").replace("</robot>", f"{plugin}</robot>"))
    assert import_robot(file, "r").kind == "differential"


SENSORS = """
<gazebo reference='laser'>
  <sensor name='cam' type='camera'><update_rate>15</update_rate><camera><horizontal_fov>1.2</horizontal_fov>
    <image><width>64</width><height>48</height></image></camera></sensor>
  <sensor name='deep' type='depth_camera'><camera><image><width>64</width><height>48</height></image>
    <clip><near>0.2</near><far>5</far></clip></camera></sensor>
  <sensor name='rings' type='gpu_lidar'><lidar><scan><horizontal><samples>90</samples></horizontal><vertical>
    <samples>4</samples><min_angle>-0.2</min_angle><max_angle>0.1</max_angle></vertical></scan>
    <range><min>0.3</min><max>40</max></range></lidar></sensor>
  <sensor name='imu' type='imu'><update_rate>100</update_rate></sensor>
  <sensor name='echo' type='sonar'><sonar><min>0.1</min><max>3</max><radius>0.4</radius></sonar></sensor>
  <sensor name='place' type='gps'/>
</gazebo>
"""


def test_sensors_of_gazebo_tags(tmp_path, capsys):
    robot = Robot.load(convert(tmp_path, base_file("differential").replace("</robot>", f"{SENSORS}</robot>")))
    made = {mount.name: mount.sensor for mount in robot.mounts}
    kinds = {name: type(sensor).__name__ for name, sensor in made.items()}
    assert kinds == {"scan": "Lidar2D", "cam": "RGBCamera", "deep": "DepthCamera", "rings": "Lidar3D", "imu": "IMU",
                     "echo": "Ultrasound"}  # fmt: skip
    assert (made["cam"].rate, made["cam"].width, made["cam"].field_of_view) == (15.0, 64, 1.2)
    assert (made["deep"].range_min, made["deep"].range_max) == (0.2, 5.0)
    assert (len(made["rings"].elevations), made["rings"].columns, made["rings"].range_max) == (4, 90, 40.0)
    assert made["imu"].rate == 100.0
    assert (made["echo"].range_max, made["echo"].radius) == (3.0, 0.4)
    assert "its type is not supported" in capsys.readouterr().out


RAY = """<gazebo reference='laser'><sensor name='{name}' type='{kind}'><update_rate>10</update_rate><ray><scan>
  <horizontal><samples>{samples}</samples><min_angle>{low}</min_angle><max_angle>{high}</max_angle></horizontal>
  {vertical}</scan><range><min>0.02</min><max>4</max></range></ray>{plugin}</sensor></gazebo>"""
ROWS = "<vertical><samples>5</samples><min_angle>-0.1</min_angle><max_angle>0.1</max_angle></vertical>"
OUTPUT = "<plugin filename='libgazebo_ros_ray_sensor.so'><output_type>sensor_msgs/{}</output_type>{}</plugin>"
RANGE = "<plugin filename='libgazebo_ros_range.so'>{}</plugin>"


@pytest.mark.parametrize(
    ("kind", "samples", "vertical", "plugin", "sensor"),
    [
        ("ray", 5, ROWS, OUTPUT.format("Range", "<radiation_type>ultrasound</radiation_type>"), "Ultrasound"),
        ("ray", 5, ROWS, OUTPUT.format("Range", "<radiation_type>infrared</radiation_type>"), "Infrared"),
        ("ray", 5, ROWS, OUTPUT.format("Range", ""), "Infrared"),
        ("ray", 5, ROWS, RANGE.format("<radiation>ultrasound</radiation><fov>0.5</fov>"), "Ultrasound"),
        ("gpu_ray", 5, "", RANGE.format("<radiation>infrared</radiation>"), "Infrared"),
        ("gpu_ray", 5, "", RANGE.format(""), "Ultrasound"),
        ("gpu_lidar", 1, "", "", "Infrared"),
        ("ray", 5, ROWS, OUTPUT.format("LaserScan", ""), "Lidar2D"),
        ("ray", 2, "", OUTPUT.format("LaserScan", ""), "Lidar2D"),
        ("ray", 90, ROWS, OUTPUT.format("PointCloud2", ""), "Lidar3D"),
        ("gpu_lidar", 90, ROWS, "", "Lidar3D"),
    ],
)
def test_message_and_radiation_decide_the_kind_of_a_ray_sensor(tmp_path, kind, samples, vertical, plugin, sensor):
    """A sonar with rows of beams is a sonar, and a beam alone is a range finder."""
    words = {"name": "near", "kind": kind, "samples": samples, "vertical": vertical, "plugin": plugin}
    text = RAY.format(low=-0.2, high=0.2, **words)
    robot = Robot.load(convert(tmp_path, base_file("differential").replace("</robot>", f"{text}</robot>")))
    (made,) = [mount.sensor for mount in robot.mounts if mount.name == "near"]
    assert type(made).__name__ == sensor
    if sensor == "Ultrasound":
        half = 0.25 if "fov" in plugin else 0.2
        assert made.radius == pytest.approx(4.0 * math.tan(half), abs=1e-4)
    if sensor == "Infrared":
        assert made.dispersion == pytest.approx(0.2 if samples > 1 else math.radians(2.5))
    assert (made.range_max, made.rate) == (4.0, 10.0)


IMU_TAG = (
    "<gazebo reference='base_link'><sensor name='imu{}' type='imu'><update_rate>50</update_rate></sensor></gazebo>"
)
LASER_TAG = RAY.format(name="last", kind="ray", samples=90, low=-1.0, high=1.0, vertical="", plugin="")


@pytest.mark.parametrize(("inertial", "laser"), [(3, False), (50, False), (51, False), (78, False), (60, True)])
def test_a_robot_has_as_many_sensors_as_a_trial_takes(tmp_path, inertial, laser, capsys):
    """Sensors of surroundings stay, such as the scanner of the base; iCub has 78 inertial sensors."""
    file = base_file("differential")
    root = "base_link" if "'base_link'" in file or '"base_link"' in file else "base"
    tags = "".join(IMU_TAG.format(k).replace("base_link", root) for k in range(inertial)) + LASER_TAG * laser
    robot = Robot.load(convert(tmp_path, file.replace("</robot>", f"{tags}</robot>")))
    names = [mount.name for mount in robot.mounts]
    assert len(names) == min(50, 1 + inertial + laser)
    assert ("scan" in names, "last" in names) == (True, laser)
    told = f"{1 + inertial + laser} sensors, a robot has at most 50"
    assert (told in capsys.readouterr().out) == (1 + inertial + laser > 50)


def test_a_folder_is_not_replaced_by_mistake(tmp_path, capsys):
    folder = convert(tmp_path, base_file("differential"))
    file = tmp_path / "maker.urdf.xacro"
    assert main(["new", "robot", str(file), "--out", str(folder)]) == 2
    assert "already exists" in capsys.readouterr().err
    assert main(["new", "robot", str(file), "--out", str(folder), "--force"]) == 0
    other = tmp_path / "mine"
    other.mkdir()
    (other / "notes.txt").write_text("keep")
    assert main(["new", "robot", str(file), "--out", str(other), "--force"]) == 2
    assert "is not a robot folder and is not replaced" in capsys.readouterr().err
    assert (other / "notes.txt").read_text() == "keep"
    assert not list(tmp_path.glob("*.part"))


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--package", "x"], "--package 'x' must be NAME=VALUE"),
        (["--package", "x=/nowhere"], "must name an existing folder"),
        (["--arg", "x=1"], "--arg 'x=1' must be NAME:=VALUE"),
        (["--arg", "x:=1"], "there is no argument 'x'"),
        (["--out", "a b"], "'a b' is not a valid robot name"),
    ],
)
def test_wrong_options_are_told(tmp_path, monkeypatch, capsys, words, sentence):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "maker.xacro").write_text(base_file("differential"))
    assert main(["new", "robot", "maker.xacro", *words]) == 2
    assert sentence in capsys.readouterr().err
    assert sorted(path.name for path in tmp_path.iterdir()) == ["maker.xacro"]


def test_a_file_that_is_no_robot_is_told(tmp_path, monkeypatch, capsys):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "README.md").write_text("# Robot")
    assert main(["new", "robot", "README.md"]) == 2
    assert "README.md is no robot file; its name must end with one of .urdf, .xacro" in capsys.readouterr().err
    assert [path.name for path in tmp_path.iterdir()] == ["README.md"]


FOREIGN = {
    "husky/husky_description/urdf/husky.urdf.xacro": ("skid-steer", 4),
    "jackal/jackal_description/urdf/jackal.urdf.xacro": ("skid-steer", 4),
    "kobuki/kobuki_standalone.urdf.xacro": ("differential", 2),
    "turtlebot3/turtlebot3_description/urdf/turtlebot3_burger.urdf": ("differential", 2),
    "turtlebot3/turtlebot3_description/urdf/turtlebot3_waffle_pi.urdf": ("differential", 2),
}


@pytest.mark.parametrize("name", FOREIGN)
def test_real_robots_become_folders(urdf, tmp_path, name):
    out = tmp_path / "real"
    assert main(["new", "robot", str(urdf / name), "--out", str(out)]) == 0
    robot = Robot.load(out)
    assert robot.model.mass == pytest.approx(read_urdf(urdf / name, colliders="hull").mass, rel=1e-9)
    kind, count = FOREIGN[name]
    assert robot.about.startswith(kind)
    made = import_robot(urdf / name, "real")
    assert sum(guess.what.startswith("wheel ") for guess in made.guesses) == count
    check_robot(robot)


def test_a_missing_robot_file_is_told(tmp_path, capsys):
    assert main(["new", "robot", str(tmp_path / "nothing.urdf.xacro")]) == 2
    assert "there is no robot file" in capsys.readouterr().err


INERTIAL = "<inertial><mass value='1'/><inertia ixx='.01' iyy='.01' izz='.01' ixy='0' ixz='0' iyz='0'/></inertial>"


def link(name, shape, at="0 0 0", visual=""):
    """A link with a collision shape, and perhaps another one that is shown."""
    parts = f"<collision><origin xyz='{at}'/><geometry>{shape}</geometry></collision>"
    parts += f"<visual><origin xyz='{at}' rpy='1.5707963 0 0'/><geometry>{visual}</geometry></visual>" if visual else ""
    return f"<link name='{name}'>{INERTIAL}{parts}</link>"


def joint(name, kind, parent, child, at, axis="0 0 1", limit="lower='-1' upper='1'"):
    limits = "" if kind in ("continuous", "fixed") else f"<limit {limit} effort='9' velocity='1'/>"
    return (
        f"<joint name='{name}' type='{kind}'><parent link='{parent}'/><child link='{child}'/><origin xyz='{at}'/>"
        f"<axis xyz='{axis}'/>{limits}</joint>"
    )


CYLINDER = "<cylinder radius='${radius}' length='0.04'/>"
LOST = "<mesh filename='package://lost/wheel.stl'/>"
PLACEHOLDER = ("ixx='0.003' iyy='0.003' izz='0.005'", "ixx='1' iyy='1' izz='1'")
FOOTPRINT = (
    "<link name='base_footprint'/><joint name='foot' type='fixed'><parent link='base_footprint'/>"
    "<child link='base_link'/><origin xyz='0 0 0.02'/></joint></robot>"
)
DIAMETER = "<gazebo><plugin filename='libdrive.so' name='d'><wheel_diameter>0.25</wheel_diameter></plugin></gazebo>"


def without_wheel_meshes(*changes):
    text = base_file("skid-steer").replace(CYLINDER, LOST)
    for old, new in changes:
        assert old in text
        text = text.replace(old, new)
    return text


@pytest.mark.parametrize(
    ("changes", "values", "radius", "source"),
    [
        ([], {}, 0.1, "cylinder of its inertia"),
        ([("name='front_left'", "name='front_left_wheel'")], {}, 0.1, "cylinder of its inertia"),
        ([PLACEHOLDER, ("</robot>", FOOTPRINT)], {}, 0.12, "height of its axle above base_footprint"),
        ([("</robot>", FOOTPRINT)], {}, 0.12, "above base_footprint; 0.1 m: cylinder of its inertia"),
        ([PLACEHOLDER, ("</robot>", f"{DIAMETER}</robot>")], {}, 0.125, "radius of the drive plugin"),
        ([("</robot>", f"{DIAMETER}</robot>")], {}, 0.125, "radius of the drive plugin; 0.1 m: cylinder of its"),
        ([PLACEHOLDER], {"front_left", "front_right", "rear_left", "rear_right"}, 0.11, "--set"),
    ],
)
def test_wheels_whose_meshes_are_missing_get_a_radius_from_elsewhere(tmp_path, changes, values, radius, source):
    (tmp_path / "maker.xacro").write_text(without_wheel_meshes(*changes))
    made = import_robot(tmp_path / "maker.xacro", "maker", values={f"radius of {name}": str(radius) for name in values})
    rows = [row for row in made.guesses if row.what.startswith("radius of ")]
    assert made.kind == "skid-steer"
    assert len(rows) == 4
    for row in rows:
        assert (row.value, row.status) == (f"{radius:.4g} m", "given" if values else "guess")
        assert source in row.source
    wheel_rows = [row for row in made.guesses if row.what.startswith("wheel ")]
    assert [row.value for row in wheel_rows] == [f"{radius:.4g} m"] * 4
    assert all((row.source.startswith("radius of its shape, a guess")) != bool(values) for row in wheel_rows)
    assert made.texts["maker.urdf"].count(f'radius="{radius:.9g}"') == 4


def test_the_ground_of_other_wheels_gives_a_radius(tmp_path):
    """Two wheels have a cylinder, and the axles of the others are as high."""
    text = base_file("skid-steer").replace("</xacro:macro>", "</xacro:macro><xacro:macro name='lost' params='name x y'>"
        "<link name='${name}'/><joint name='${name}_joint' type='continuous'><parent link='base_link'/>"
        "<child link='${name}'/><origin xyz='${x} ${y} 0.1'/><axis xyz='0 1 0'/></joint></xacro:macro>", 1)  # fmt: skip
    more = "<xacro:lost name='wheel_a' x='0' y='0.2'/><xacro:lost name='wheel_b' x='0' y='-0.2'/></robot>"
    (tmp_path / "maker.xacro").write_text(text.replace("</robot>", more))
    made = import_robot(tmp_path / "maker.xacro", "maker")
    rows = {row.what: row for row in made.guesses}
    assert rows["radius of wheel_a"].value == "0.1 m"
    assert "height of its axle above the lowest point of front_left" in rows["radius of wheel_a"].source
    assert sum(row.what.startswith("wheel ") for row in made.guesses) == 6


def test_wheels_of_unknown_radius_are_refused_with_the_options(tmp_path):
    (tmp_path / "maker.xacro").write_text(without_wheel_meshes(PLACEHOLDER))
    with pytest.raises(RobotError) as caught:
        import_robot(tmp_path / "maker.xacro", "maker")
    for part in (
        "maker.xacro: the meshes of the wheels front_left, front_right, rear_left, rear_right cannot be read",
        "--package NAME=FOLDER",
        "--set 'radius of front_left=0.1'",
        "--base planar",
    ):
        assert part in str(caught.value)
    assert import_robot(tmp_path / "maker.xacro", "maker", kind="planar").kind == "planar"


@pytest.mark.parametrize(("kind", "inner"), [("ackermann", 0.8049), ("tricycle", 0.6)])
@pytest.mark.parametrize("limit", ["lower='0' upper='0'", "lower='0.1' upper='0.1'", ""])
def test_steering_joints_whose_limits_allow_no_motion_get_the_common_angle(tmp_path, kind, inner, limit):
    (tmp_path / "maker.xacro").write_text(base_file(kind).replace("lower='-0.5' upper='0.5'", limit))
    made = import_robot(tmp_path / "maker.xacro", "maker")
    rows = {row.what: row for row in made.guesses}
    assert rows["max-steering"].value == "0.6 rad"
    assert rows["max-steering"].source == "common value; <limit> of the steering joints allows no motion"
    limits = [row for what, row in rows.items() if what.startswith("limit of ")]
    assert [row.value for row in limits] == [f"{inner:.4g} rad"] * (2 if kind == "ackermann" else 1)
    given = "0.1 to 0.1" if "0.1" in limit else "0 to 0"
    assert {(row.source, row.status) for row in limits} == {(f"max-steering; the file has {given}", "guess")}
    joints = read_urdf(made.texts["maker.urdf"]).joints
    turns = [(-joint.lower, joint.upper) for joint in joints.values() if joint.name.endswith("_steer")]
    assert turns == [pytest.approx((inner, inner), abs=1e-4)] * len(limits)


def test_a_car_whose_steering_joints_were_locked_turns_in_the_physics_world(tmp_path):
    text = base_file("ackermann").replace("lower='-0.5' upper='0.5'", "lower='0' upper='0'")
    robot = Robot.load(convert(tmp_path, text))
    scene = Scene.of([[0.0, 0.0]], external=[True], heading=[0.0], radius=robot.radius)
    world = PhysicsWorld(scene, ORCA(), {0: robot}, 0.05)
    for _ in range(30):
        state = world.step({0: Twist(0.3, 0.3)})
    assert float(state.heading[0, 0]) > 0.2


@pytest.mark.parametrize("axis", ["0 1 0", "1 0 0", "0 1 0.2"])
def test_locked_steering_joints_with_a_level_axis_are_refused(tmp_path, axis):
    text = base_file("ackermann").replace(
        "<axis xyz='0 0 1'/><limit lower='-0.5' upper='0.5'", f"<axis xyz='{axis}'/><limit"
    )
    (tmp_path / "maker.xacro").write_text(text)
    with pytest.raises(RobotError) as caught:
        import_robot(tmp_path / "maker.xacro", "maker")
    assert "the joint 'front_left_steer' above the wheel 'front_left' cannot steer: its limits are 0 to 0 rad" in str(
        caught.value
    )
    assert "or give --base skid-steer" in str(caught.value)
    made = import_robot(tmp_path / "maker.xacro", "maker", kind="skid-steer")
    assert len([row for row in made.guesses if row.what.startswith("wheel ")]) == 4


@pytest.mark.parametrize(
    ("mass", "wheel", "density"),
    [("20", "1", ""), ("2", "0.1", ""), ("0.02", "0.001", "1.5"), ("0.5", "0.01", "7.8"), ("9000", "1", "1.1e+05")],
)
def test_a_mass_that_no_robot_has_is_marked(tmp_path, mass, wheel, density):
    text = base_file("differential").replace("value='20'", f"value='{mass}'")
    (tmp_path / "maker.xacro").write_text(text.replace("value='1'", f"value='{wheel}'"))
    (row,) = [row for row in import_robot(tmp_path / "maker.xacro", "maker").guesses if row.what == "mass"]
    assert row.status == ("doubtful" if density else "file")
    assert row.source.endswith(f"; implausible: {density} kg/m3 in the box around its colliders") == bool(density)


def lifted_hand(travel, fingers):
    """A lift, a wrist and fingers that hang down to the ground."""
    text = link("lift", "<box size='.1 .1 .1'/>") + link("wrist", "<box size='.05 .05 .05'/>")
    text += joint("raise", "prismatic", "base", "lift", ".3 0 .2", limit=f"lower='0' upper='{travel}'")
    text += joint("turn", "revolute", "lift", "wrist", "0 0 -.05")
    for k in range(fingers):
        side = 0.02 * (k - 0.5 * (fingers - 1))
        text += link(f"finger{k}", "<box size='.01 .01 .24'/>")
        text += joint(f"close{k}", "revolute", "wrist", f"finger{k}", f"0 {side} -.03", "1 0 0")
    return text


WHEELS = "".join(
    link(f"roller{k}", "<box size='.2 .04 .2'/>", visual="<cylinder radius='.1' length='.04'/>")
    + joint(f"spin{k}", "continuous", "base", f"roller{k}", f"0 {y} 0", "0 1 0")
    for k, y in enumerate((0.2, -0.2))
)


@pytest.mark.parametrize(
    ("parts", "kind"),
    [
        (lifted_hand(1.1, 2), "planar"),
        (lifted_hand(0.2, 2), "planar"),
        (lifted_hand(0.5, 3), "planar"),
        (WHEELS, "differential"),
        (WHEELS + lifted_hand(1.1, 2), "differential"),
    ],
)
def test_hands_are_no_legs_and_wheels_may_collide_as_boxes(tmp_path, parts, kind):
    file = tmp_path / "maker.urdf"
    body = link("base", "<box size='.4 .3 .1'/>", "0 0 .05")
    file.write_text(f"<robot name='maker'>{body}{parts}</robot>")
    base = recognize_base(read_urdf(file))
    assert (base.kind, base.legs) == (kind, ())
    assert [wheel.radius for wheel in base.wheels] == pytest.approx([0.1, 0.1] if kind == "differential" else [])
