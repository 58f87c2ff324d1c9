"""Robots of other makers in the physics world: real URDFs, cars that steer, and every kind of joint."""

import math

import numpy as np
import pytest
from physics_worlds import alone
from real_robots import ROBOTS
from robot_texts import joint, link, robot

from crowdbot.core import InputError, Twist
from crowdbot.world import AckermannDrive, DifferentialDrive, Omnidirectional, Robot, Wheel, read_urdf
from samples import sample

ROUND = 0.4 * np.stack([np.cos(np.arange(8) * math.pi / 4), np.sin(np.arange(8) * math.pi / 4)], axis=1)


@pytest.mark.parametrize("name", ROBOTS)
def test_real_robots_drive_in_the_physics_world(urdf, name):
    """Pulled along the floor, with motors that hold their joints; roots above the ground are no hindrance."""
    model = read_urdf(urdf / name, colliders="hull")
    made = Robot(
        model.name, model, Omnidirectional(max_speed=1.0, max_acceleration=2.0), base="planar", footprint=ROUND
    )
    held = {j.name: "position" for j in model.movable if j.size == 1 and j.upper - j.lower > 1e-9}
    world = alone(made, motors={0: held})
    for _ in range(40):
        scene = world.step({0: Twist(0.5, 0.0)})
    assert np.all(np.isfinite(world.data.qpos))
    assert np.abs(world.data.qvel).max() < 5.0
    assert world.twists[0].forward[0] == pytest.approx(0.5, rel=0.02)
    assert scene.position[0, 0, 0] > 0.7
    assert world.robot_body(0).tilt < 1e-3
    seen = world.bodies()
    assert np.all(seen.box_centre[0, :, 2] > 0.0)  # nothing lies below the floor


def car(drive=None, wheels=None):
    """Return a car of 40 kg: two rear wheels that drive, two front wheels that steer 0.6 m ahead, 0.4 m apart."""
    box = "<collision><origin xyz='0.3 0 0.2'/><geometry><box size='0.8 0.3 0.1'/></geometry></collision>"
    inertia = "<inertia ixx='1' iyy='2' izz='2.5' ixy='0' ixz='0' iyz='0'/>"
    parts = [
        f"<link name='base'><inertial><origin xyz='0.28 0 0.15'/><mass value='30'/>{inertia}</inertial>{box}</link>"
    ]
    tire = "<geometry><cylinder radius='0.1' length='0.04'/></geometry>"
    tire = f"<collision><origin rpy='1.5707963 0 0'/>{tire}</collision>"
    names = {}
    for end, x in (("rear", 0.0), ("front", 0.6)):
        for side, y in (("left", 0.2), ("right", -0.2)):
            name, parent, place = f"{end}_{side}", "base", f"<origin xyz='{x} {y} 0.1'/>"
            if end == "front":
                parts.append(link(f"{name}_fork", mass=0.5, moments=(0.002,) * 3))
                limit = "<limit lower='-0.8' upper='0.8' effort='30' velocity='5'/>"
                up = f"{place}<axis xyz='0 0 1'/>{limit}"
                parts.append(joint(f"{name}_steer", "revolute", "base", f"{name}_fork", up))
                parent, place = f"{name}_fork", ""
            parts.append(link(name, tire, mass=2.0, moments=(0.01, 0.02, 0.01)))
            axle = f"{place}<axis xyz='0 1 0'/><limit effort='20' velocity='50'/>"
            parts.append(joint(f"{name}_wheel", "continuous", parent, name, axle))
            names[name] = Wheel(f"{name}_wheel", 0.1, f"{name}_steer" if end == "front" else "", end == "rear")
    drive = drive or AckermannDrive(max_speed=2.0, wheelbase=0.6, max_steering=0.5)
    return Robot("car", read_urdf(robot(*parts)), drive, wheels=tuple(names.values()) if wheels is None else wheels)


@pytest.mark.parametrize(("forward", "turn"), sample([(1.0, 0.5), (1.5, 0.0), (0.6, -0.4), (-0.8, 0.3)], 1, rows=True))
def test_a_car_steers_on_its_own_wheels(forward, turn):
    world = alone(car())
    reached = []
    for _ in range(100):
        world.step({0: Twist(forward, turn)})
        reached.append(
            [float(value[0]) for value in (world.twists[0].forward, world.twists[0].turn, world.twists[0].left)]
        )
    mean = np.mean(reached[-20:], axis=0)
    assert mean[0] == pytest.approx(forward, rel=0.02)
    assert mean[1] == pytest.approx(turn, rel=0.02, abs=0.01)
    assert mean[2] == pytest.approx(0.0, abs=0.02)
    joints = world.robot_body(0).joints()
    inner, outer = joints["front_left_steer"][0], joints["front_right_steer"][0]
    assert (abs(inner) > abs(outer)) == (turn / forward > 0.0) or turn == 0.0
    with pytest.raises(InputError, match="'front_left_steer' of car is a wheel; use a Twist command"):
        world.command(0, {"front_left_steer": 0.1})


def test_wheels_of_a_car_roll_about_one_point():
    angles = car().steering(Twist(1.0, 0.5))  # about the point 2 m to the left
    assert angles == {
        "front_left_steer": pytest.approx(math.atan2(0.6, 1.8)),
        "front_right_steer": pytest.approx(math.atan2(0.6, 2.2)),
    }
    assert car().steering(Twist(-1.0, -0.5)) == angles
    assert car().steering(Twist()) == {"front_left_steer": 0.0, "front_right_steer": 0.0}
    speeds = car().wheel_speeds(Twist(1.0, 0.5))
    assert speeds == {"rear_left_wheel": pytest.approx(9.0), "rear_right_wheel": pytest.approx(11.0)}


def test_a_car_needs_wheels_and_a_drive_that_fit():
    with pytest.raises(InputError, match="has a drive DifferentialDrive and steered wheels; use base"):
        alone(car(drive=DifferentialDrive()))
    with pytest.raises(InputError, match="has a drive AckermannDrive and no steered wheels"):
        alone(car(wheels=(Wheel("rear_left_wheel", 0.1), Wheel("rear_right_wheel", 0.1))))
    with pytest.raises(InputError, match="has no driven wheels"):
        alone(car(wheels=(Wheel("front_left_wheel", 0.1, "front_left_steer", driven=False),)))
    with pytest.raises(InputError, match="the steering joint 'front_left_ster' is not a rotating joint, did you mean"):
        car(wheels=(Wheel("front_left_wheel", 0.1, "front_left_ster"),))


def tower():
    """Return a robot with one joint of each kind on its base, and a joint that follows another."""
    base = "<collision><origin xyz='0 0 0.1'/><geometry><box size='0.6 0.6 0.2'/></geometry></collision>"
    heavy = "<inertial><origin xyz='0 0 0.1'/><mass value='60'/>" + (
        "<inertia ixx='3' iyy='3' izz='3' ixy='0' ixz='0' iyz='0'/></inertial>"
    )
    parts = [f"<link name='base'>{heavy}{base}</link>"]
    limit = "<limit lower='-1' upper='1' effort='200' velocity='2'/><dynamics damping='1.0'/>"
    inside = {
        "revolute": f"<origin xyz='0.2 0 0.3'/><axis xyz='0 0 1'/>{limit}",
        "continuous": "<origin xyz='-0.2 0 0.3'/><axis xyz='0 0 1'/><limit effort='20' velocity='9'/>",
        "prismatic": f"<origin xyz='0 0.2 0.3'/><axis xyz='0 0 1'/>{limit}",
        "fixed": "<origin xyz='0 -0.2 0.3'/>",
        "planar": "<origin xyz='0.2 0.2 0.3'/><axis xyz='0 0 1'/><dynamics damping='1.0'/>",
        "floating": "<origin xyz='-0.2 -0.2 0.5'/>",
    }
    parts += [link(kind, mass=0.5, moments=(0.01,) * 3) for kind in inside]
    parts += [joint(f"j_{kind}", kind, "base", kind, text) for kind, text in inside.items()]
    follow = "<mimic joint='j_revolute' multiplier='-0.5' offset='0.1'/>"
    follow += f"<origin xyz='0.2 0.1 0.3'/><axis xyz='0 0 1'/>{limit}"
    parts += [
        link("follower", mass=0.5, moments=(0.01,) * 3),
        joint("j_follower", "revolute", "base", "follower", follow),
    ]
    return Robot("tower", read_urdf(robot(*parts)), Omnidirectional(), base="planar")


def test_all_kinds_of_joints_move_as_they_should():
    world = alone(
        tower(), motors={0: {"j_revolute": "position", "j_continuous": "velocity", "j_prismatic": "position"}}
    )
    world.command(0, {"j_revolute": 0.6, "j_continuous": 3.0, "j_prismatic": 0.2})
    for _ in range(40):
        world.step({0: Twist()})
    robot_bodies = world.robot_body(0)
    joints = robot_bodies.joints()
    assert joints["j_revolute"][0] == pytest.approx(0.6, abs=0.01)
    assert joints["j_continuous"][1] == pytest.approx(3.0, rel=0.02)
    assert joints["j_prismatic"][0] == pytest.approx(0.2, abs=0.01)
    assert joints["j_follower"][0] == pytest.approx(0.1 - 0.5 * joints["j_revolute"][0], abs=0.01)
    assert robot_bodies.frame("fixed")[:3, 3] - robot_bodies.frame("base")[:3, 3] == pytest.approx(
        [0.0, -0.2, 0.3], abs=1e-3
    )
    assert robot_bodies.frame("floating")[2, 3] < 0.4  # falls on
    assert robot_bodies.frame("planar")[2, 3] == pytest.approx(0.3, abs=1e-6)  # in its plane
    world.command(0, {"j_revolute": 5.0})
    for _ in range(40):
        world.step({0: Twist()})
    assert robot_bodies.joints()["j_revolute"][0] == pytest.approx(1.0, abs=0.05)  # its limit


def test_effort_drives_a_joint_too():
    world = alone(tower(), motors={0: {"j_continuous": "effort"}})
    world.command(0, {"j_continuous": 0.02})
    for _ in range(20):
        world.step({0: Twist()})
    assert world.robot_body(0).joints()["j_continuous"][1] == pytest.approx(0.02 / 0.01 * 1.0, rel=0.05)
