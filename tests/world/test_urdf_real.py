"""Real robots: held against an independent reader (yourdfpy), and alive in MuJoCo."""

import logging

import numpy as np
import pytest
import yourdfpy
from real_robots import EMPTY, ROBOTS, XACRO, is_weighed

from crowdbot.core import RobotError
from crowdbot.world import read_urdf
from crowdbot.world.urdf.inertia import unphysical

models = {}


def ours(urdf, name):
    if name not in models:
        models[name] = read_urdf(urdf / name, colliders="hull")
    return models[name]


def theirs(urdf, name, graph=True):
    logging.getLogger("yourdfpy").setLevel(logging.ERROR)
    return yourdfpy.URDF.load(str(urdf / name), load_meshes=False, build_scene_graph=graph)


def test_files_without_a_link_are_refused_in_one_sentence(urdf):
    assert EMPTY
    for path in EMPTY:
        with pytest.raises(RobotError, match="contains no <link>") as caught:
            read_urdf(path)
        assert len(caught.value.problems) == 1


def test_every_robot_file_is_a_robot_a_xacro_or_empty(urdf):
    assert {urdf / name for name in ROBOTS} | {*XACRO, *EMPTY} >= set(urdf.rglob("*.urdf")) | set(urdf.rglob("*.xacro"))


@pytest.mark.parametrize("name", ROBOTS)
def test_links_joints_and_limits_agree(urdf, name):
    model, other = ours(urdf, name), theirs(urdf, name)
    assert set(model.links) == set(other.link_map)
    assert set(model.joints) == set(other.joint_map)
    assert model.root == other.base_link
    for key, joint in model.joints.items():
        twin = other.joint_map[key]
        assert (joint.kind, joint.parent, joint.child) == (twin.type, twin.parent, twin.child)
        if joint.kind in ("revolute", "prismatic"):
            assert (joint.lower, joint.upper) == (twin.limit.lower or 0.0, twin.limit.upper or 0.0)
        if joint.kind not in ("fixed", "floating") and twin.limit is not None:
            assert joint.motor.effort == (np.inf if twin.limit.effort is None else twin.limit.effort)
            assert joint.motor.velocity == (np.inf if twin.limit.velocity is None else twin.limit.velocity)
        if twin.dynamics is not None:
            assert (joint.damping, joint.friction) == (
                float(twin.dynamics.damping or 0),
                float(twin.dynamics.friction or 0),
            )
        assert (joint.mimic is None) == (twin.mimic is None)
        if joint.mimic:
            said = (twin.mimic.joint, twin.mimic.multiplier, twin.mimic.offset)
            assert (joint.mimic.joint, joint.mimic.multiplier, joint.mimic.offset) == said


@pytest.mark.parametrize("name", ROBOTS)
def test_masses_that_are_given_are_kept(urdf, name):
    model, other = ours(urdf, name), theirs(urdf, name)
    for key, twin in other.link_map.items():
        if twin.inertial is not None and twin.inertial.mass:
            inertial = model.links[key].inertial
            assert inertial.mass == twin.inertial.mass
            place = np.eye(4) if twin.inertial.origin is None else twin.inertial.origin
            np.testing.assert_allclose(inertial.center, place[:3, 3], atol=1e-12)
            turned = place[:3, :3] @ twin.inertial.inertia @ place[:3, :3].T
            if not unphysical(turned):
                np.testing.assert_allclose(inertial.tensor, turned, rtol=1e-6, atol=1e-12)


def total_of(other):
    """The slow twin: mass, centre and inertia of all links, through the other reader's kinematics."""
    bodies = []
    for name, link in other.link_map.items():
        if link.inertial is None:
            continue
        origin = np.eye(4) if link.inertial.origin is None else link.inertial.origin
        matrix = other.get_transform(name) @ origin
        bodies.append((link.inertial.mass, matrix[:3, 3], matrix[:3, :3] @ link.inertial.inertia @ matrix[:3, :3].T))
    mass = sum(m for m, _, _ in bodies)
    center = sum(m * c for m, c, _ in bodies) / mass
    shifts = [(m, c - center, i) for m, c, i in bodies]
    return mass, center, sum(i + m * ((d @ d) * np.eye(3) - np.outer(d, d)) for m, d, i in shifts)


def test_total_mass_and_inertia_agree(urdf):
    names = [name for name in ROBOTS if is_weighed(name)]
    assert names
    for name in names:
        check_total(urdf, name)


def check_total(urdf, name):
    whole = ours(urdf, name).inertial()
    mass, center, tensor = total_of(theirs(urdf, name))
    assert whole.mass == pytest.approx(mass, rel=1e-9)
    np.testing.assert_allclose(whole.center, center, atol=1e-9)
    np.testing.assert_allclose(whole.tensor, tensor, rtol=1e-6, atol=1e-9)


@pytest.mark.parametrize("name", ROBOTS)
def test_kinematics_agree_at_any_position(urdf, name):
    model, other = ours(urdf, name), theirs(urdf, name)
    rng = np.random.default_rng(3)
    names = [joint for joint in other.actuated_joint_names if model.joints[joint].mimic is None]
    for _ in range(3):
        asked = {joint: rng.uniform(-1.5, 1.5) for joint in names}
        if names:
            other.update_cfg(asked)
        poses = model.poses(asked)
        for link in model.links:
            np.testing.assert_allclose(poses[link], other.get_transform(link), atol=1e-9)


@pytest.mark.parametrize("name", ROBOTS)
@pytest.mark.parametrize("base", ["free", "planar", "fixed", "kinematic"])
def test_they_live_in_mujoco(urdf, name, base):
    import mujoco

    from crowdbot.world.urdf import mjcf

    model = ours(urdf, name)
    physics = mjcf(model, base=base, floor=True, place=(0.0, 0.0, 1.5)).load()
    assert physics.body_mass.sum() == pytest.approx(model.mass, rel=1e-6)
    data = mujoco.MjData(physics)
    mujoco.mj_forward(physics, data)
    if base != "kinematic":  # a mocap body is put to its place by who moves it
        poses = model.poses()
        start = np.eye(4)
        start[2, 3] = 1.5
        for link in model.links:
            site = data.site(link)
            matrix = start @ poses[link]
            np.testing.assert_allclose(site.xpos, matrix[:3, 3], atol=1e-6)
            np.testing.assert_allclose(site.xmat.reshape(3, 3), matrix[:3, :3], atol=1e-6)
    for _ in range(20):
        mujoco.mj_step(physics, data)
    assert np.all(np.isfinite(data.qpos))


def test_pepper_without_its_meshes_says_what_is_missing_and_stands_in(urdf):
    model = ours(urdf, "pepper/pepper.urdf")
    assert not model.meshes
    replaced = [remark.text for remark in model.remarks if remark.kind == "replaced"]
    assert any(
        "pepper_meshes/meshes/1.0/HeadPitch.dae is missing; its colliders are shown instead" in t for t in replaced
    )
    assert any("HeadPitch_0.10.stl is missing; for contacts, the box of equal inertia" in text for text in replaced)
    assert all(link.collisions for link in model.links.values() if link.inertial and link.visuals)
    head = model.links["Head"].collisions[0].shape
    assert 0.1 < max(head.size) < 0.3


def test_links_without_inertia_get_one_and_it_is_said(urdf):
    model = ours(urdf, "urdf_tutorial/06-flexible.urdf")
    repaired = [remark.text for remark in model.remarks if remark.kind == "repaired"]
    assert (
        "06-flexible.urdf:14: <link> 'base_link' has no inertial, like all links of the file; mass 75.4 kg"
        in repaired[0]
    )
    assert any(text.endswith("moves but has neither mass nor shape; its mass is set to 0.001 kg") for text in repaired)
    for link in model.links.values():
        assert (link.inertial is None) == (link.name in ("left_tip", "right_tip"))  # mere frames: their meshes are lost
        assert link.inertial is None or unphysical(link.inertial.tensor) == ""


def kobuki(base):
    wheel = "<visual><geometry><mesh filename='package://kobuki_description/meshes/wheel.dae'/></geometry></visual>"
    body = (
        "<visual><origin xyz='0.001 0 0.05199'/><geometry><mesh filename='{}'/></geometry></visual>"
        "<collision><origin xyz='0 0 0.05949'/><geometry><cylinder length='0.10938' radius='0.178'/></geometry>"
        "</collision>"
    )
    body = body.format(base)
    return (
        f"<robot name='kobuki'><link name='base_link'><inertial><origin xyz='0.01 0 0'/><mass value='2.4'/>"
        f"<inertia ixx='0.019995' iyy='0.019995' izz='0.03675' ixy='0' ixz='0' iyz='0'/></inertial>{body}</link>"
        f"<link name='wheel'>{wheel}</link><joint name='wheel' type='continuous'><parent link='base_link'/>"
        f"<child link='wheel'/><origin xyz='0 0.115 0.025' rpy='-1.570796326 0 0'/><axis xyz='0 0 1'/></joint></robot>"
    )


@pytest.mark.parametrize(
    "name",
    [
        "package://kobuki_description/meshes/main_body.dae",
        "meshes/main_body.dae",
        "package://a/b/c/meshes/main_body.dae",
    ],
)
def test_dae_meshes_of_the_kobuki_are_read_in_metres(urdf, name):
    model = read_urdf(kobuki(name), folder=urdf / "kobuki")
    assert set(model.meshes) == {name, "package://kobuki_description/meshes/wheel.dae"}
    vertices = model.links["base_link"].visuals[0].shape.vertices
    np.testing.assert_allclose(np.ptp(vertices, axis=0), [0.3518, 0.35, 0.1243], atol=2e-4)
    assert model.links["base_link"].collisions[0].shape.radius == 0.178
    weight = model.links["wheel"].inertial.mass  # from the bounding box of what is seen
    assert 0.05 < weight < 0.11


def test_file_addresses_inside_the_folder_are_read(urdf):
    path = urdf / "kobuki" / "meshes" / "main_body.dae"
    assert len(read_urdf(kobuki(f"file://{path.resolve()}"), folder=urdf / "kobuki").meshes) == 2
