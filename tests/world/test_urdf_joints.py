"""Joints: all six kinds, their kinematics against MuJoCo's, springs, motors, those that follow others."""

import math

import mujoco
import numpy as np
import pytest
from robot_texts import BALL, joint, link, robot

from crowdbot.core import InputError
from crowdbot.world import read_urdf
from crowdbot.world.urdf import BaseServo, Motor, mjcf

LIMIT = "<limit lower='-1' upper='1' effort='5' velocity='2'/>"
ORIGIN = "<origin xyz='0.1 0.2 0.3' rpy='0.4 0.5 0.6'/>"
AXIS = "<axis xyz='1 2 -2'/>"


def two(kind, inside=LIMIT, more=""):
    return read_urdf(robot(link("a", BALL.format(radius=0.5)), link("b"), joint("j", kind, "a", "b", inside), more))


@pytest.mark.parametrize(
    ("kind", "position", "places"),
    [
        ("revolute", 0.7, {"j": 0.7}),
        ("continuous", -4.0, {"j": -4.0}),
        ("prismatic", 0.3, {"j": 0.3}),
        ("planar", (0.2, -0.3, 0.9), {"j/x": 0.2, "j/y": -0.3, "j": 0.9}),
        (
            "floating",
            (0.1, 0.2, 0.3, 0.5, 0.5, -0.5, 0.5),
            {"j/x": 0.1, "j/y": 0.2, "j/z": 0.3, "j": (0.5, 0.5, -0.5, 0.5)},
        ),
    ],
)
def test_all_kinds_move_as_in_mujoco(kind, position, places):
    model = two(kind, LIMIT + ORIGIN + AXIS)
    physics = mjcf(model, base="fixed").load()
    data = mujoco.MjData(physics)
    for name, value in places.items():
        data.joint(name).qpos = value
    mujoco.mj_forward(physics, data)
    matrix = model.poses({"j": position})["b"]
    np.testing.assert_allclose(data.site("b").xpos, matrix[:3, 3], atol=1e-12)
    np.testing.assert_allclose(data.site("b").xmat.reshape(3, 3), matrix[:3, :3], atol=1e-12)


def test_a_planar_joint_keeps_to_its_plane():
    model = two("planar", AXIS)
    normal = np.array([1.0, 2.0, -2.0]) / 3.0
    for x, y in ((1.0, 0.0), (0.0, 1.0), (-0.4, 2.0)):
        place = model.poses({"j": (x, y, 1.0)})["b"][:3, 3]
        assert abs(place @ normal) < 1e-12
        assert np.linalg.norm(place) == pytest.approx(math.hypot(x, y))


def test_limits_damping_friction_springs_and_motors_reach_mujoco():
    inside = LIMIT + "<dynamics damping='0.3' friction='0.2' spring_stiffness='7' spring_reference='0.5'/>"
    model = two("revolute", inside, "<transmission name='t'><joint name='j'><hardwareInterface>"
                "hardware_interface/PositionJointInterface</hardwareInterface></joint></transmission>")  # fmt: skip
    found = model.joints["j"]
    assert (found.lower, found.upper, found.damping, found.friction) == (-1.0, 1.0, 0.3, 0.2)
    assert (found.stiffness, found.rest, found.motor) == (7.0, 0.5, Motor(5.0, 2.0, "position"))
    physics = mjcf(model, base="fixed").load()
    hinge = physics.joint("j")
    assert hinge.range.tolist() == [-1.0, 1.0]
    assert (hinge.damping[0], hinge.frictionloss[0], hinge.stiffness[0]) == (0.3, 0.2, 7.0)
    assert physics.qpos_spring[hinge.qposadr[0]] == 0.5
    assert physics.actuator("j").forcerange.tolist() == [-5.0, 5.0]


def test_springs_and_friction_of_gazebo_and_motors_of_ros2_control_are_read():
    more = (
        "<gazebo reference='j'><springStiffness>3.5</springStiffness><springReference>-0.25</springReference></gazebo>"
        "<gazebo reference='a'><mu1>0.4</mu1></gazebo><gazebo reference='b'><mu1>0.0</mu1></gazebo>"
        "<ros2_control name='c'><joint name='j'><command_interface name='velocity'/></joint></ros2_control>"
    )
    model = two("continuous", "", more)
    assert (model.joints["j"].stiffness, model.joints["j"].rest, model.joints["j"].motor.kind) == (
        3.5,
        -0.25,
        "velocity",
    )
    assert (model.links["a"].friction, model.links["b"].friction) == (0.4, 0.0)
    assert mjcf(model).load().geom("a/0").friction[0] == 0.4


def test_those_that_follow_others():
    rows = [link(name) for name in "abcd"]
    rows += [
        joint("j", "continuous", "a", "b", "<axis xyz='0 0 1'/>"),
        joint("k", "continuous", "b", "c", "<axis xyz='0 0 1'/><mimic joint='j' multiplier='2' offset='0.1'/>"),
        joint("l", "continuous", "c", "d", "<axis xyz='0 0 1'/><mimic joint='k' multiplier='-1'/>"),
    ]
    model = read_urdf(robot(*rows))
    places = model.positions({"j": 0.5})
    assert [float(places[name][0]) for name in "jkl"] == pytest.approx([0.5, 1.1, -1.1])
    assert [item.name for item in model.movable] == ["j"]
    with pytest.raises(InputError, match="the joint 'k' of r follows 'j'; its position cannot be set"):
        model.poses({"k": 1.0})
    physics = mjcf(model, base="fixed", motors={"j": "position"}).load()
    assert physics.neq == 2
    data = mujoco.MjData(physics)
    physics.opt.gravity[:] = 0.0
    data.ctrl[:] = 0.5
    for _ in range(3000):
        mujoco.mj_step(physics, data)
    assert [float(data.joint(name).qpos[0]) for name in "jkl"] == pytest.approx([0.5, 1.1, -1.1], abs=0.02)


@pytest.mark.parametrize(
    ("positions", "message"),
    [
        ({"jj": 1.0}, "r has no joint 'jj', did you mean 'j'?"),
        ({"j": math.nan}, "joint 'j': position \\[nan\\] must be 1 finite numbers"),
        ({"j": (1.0, 2.0)}, "must be 1 finite numbers \\(revolute\\)"),
    ],
)
def test_wrong_positions_are_explained(positions, message):
    with pytest.raises(InputError, match=message):
        two("revolute").poses(positions)


def test_limits_that_leave_no_way_are_noted_and_hold():
    model = two("revolute", "<limit lower='0' upper='0' effort='0' velocity='0'/>")
    assert "has the limits 0 to 0, which allow no motion" in model.warnings[-1]
    assert mjcf(model, base="fixed").load().nv == 0


def test_wrong_words_are_explained():
    model = two("revolute")
    for asked, message in (
        ({"base": "planer"}, "base = 'planer' must be one of free, planar, fixed, kinematic, did you mean 'planar'?"),
        ({"motors": {"x": "velocity"}}, "r has no movable joint 'x'"),
        ({"motors": {"j": "speed"}}, "motor of 'j': 'speed' must be position, velocity, effort, or empty"),
        ({"base": "fixed", "servo": BaseServo(1.0, 1.0)}, "a base servo needs base='free' or base='planar'"),
    ):
        with pytest.raises(InputError, match=message.replace("?", "\\?")):
            mjcf(model, **asked)
    with pytest.raises(InputError, match="max_force = 0.0 must be finite and above 0"):
        BaseServo(0.0, 1.0)
    with pytest.raises(InputError, match="the base 'a' of r has no mass; use base='fixed' or base='kinematic'"):
        mjcf(read_urdf("<robot name='r'><link name='a'/></robot>"))


def test_two_of_a_kind_fit_in_one_world():
    model = two("continuous", "")
    world = mujoco.MjSpec.from_string(mjcf(model, prefix="one_", place=(0.0, 0.0, 1.0)).xml)
    other = mujoco.MjSpec.from_string(mjcf(model, place=(2.0, 0.0, 1.0)).xml)
    world.attach(other, prefix="other_", frame=world.worldbody.add_frame())
    both = world.compile()
    assert [both.body(name).pos[0] for name in ("one_a", "other_a")] == [0.0, 2.0]


def test_own_parts_pass_through_each_other_unless_asked():
    ball = BALL.format(radius=0.2)
    model = read_urdf(
        robot(
            link("a"),
            link("b", ball),
            link("c", ball),
            joint("j", "continuous", "a", "b"),
            joint("k", "continuous", "a", "c"),
        )
    )
    for inside, contacts in ((False, 0), (True, 1)):
        physics = mjcf(model, base="fixed", inside=inside).load()
        data = mujoco.MjData(physics)
        mujoco.mj_forward(physics, data)
        assert data.ncon == contacts


def test_a_wheel_touches_in_one_point():
    shape = "<geometry><cylinder radius='0.1' length='0.04'/></geometry>"
    wheel = f"<collision><origin rpy='1.5707963 0 0'/>{shape}</collision>"
    model = read_urdf(robot(link("a"), link("w", wheel), joint("j", "continuous", "a", "w", "<axis xyz='0 1 0'/>")))
    assert mjcf(model).load().geom("w/0").type == mujoco.mjtGeom.mjGEOM_ELLIPSOID
    across = read_urdf(robot(link("a"), link("w", wheel), joint("j", "continuous", "a", "w", "<axis xyz='1 0 0'/>")))
    assert mjcf(across).load().geom("w/0").type == mujoco.mjtGeom.mjGEOM_CYLINDER


def test_a_servo_pulls_the_base_to_its_twist_in_its_own_frame():
    model = two("continuous", "")
    physics = mjcf(model, base="planar", heading=0.5, servo=BaseServo(50.0, 50.0)).load()
    data = mujoco.MjData(physics)
    for name, speed in (("base_forward", 0.4), ("base_left", 0.2), ("base_turn", 0.8)):
        data.actuator(name).ctrl = speed
    for _ in range(2000):
        mujoco.mj_step(physics, data)
    speed = np.zeros(6)
    mujoco.mj_objectVelocity(physics, data, mujoco.mjtObj.mjOBJ_XBODY, 1, speed, 1)
    np.testing.assert_allclose(speed[[3, 4, 2]], [0.4, 0.2, 0.8], rtol=0.02)
