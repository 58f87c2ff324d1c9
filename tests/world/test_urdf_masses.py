"""Masses are those of the file: a link without <inertial> weighs nothing."""

import xml.etree.ElementTree as ElementTree

import pytest
from real_robots import ROBOTS
from robot_texts import BALL, joint, link, robot

from crowdbot.world import read_urdf

SHAPE = BALL.format(radius=0.2)
BARE = f"<link name='b'>{SHAPE}</link>"


def test_a_fixed_link_without_inertial_weighs_nothing():
    model = read_urdf(robot(link("a", mass=5.0), BARE, joint("j", "fixed", "a", "b")))
    assert model.mass == 5.0
    assert model.links["b"].inertial is None
    assert model.warnings == ()


def test_a_frame_above_the_mass_weighs_nothing():
    model = read_urdf(robot(BARE, link("a", mass=5.0), joint("j", "fixed", "b", "a")))
    assert model.mass == 5.0
    assert model.warnings == ()


@pytest.mark.parametrize("inertial", ["", "<inertial><mass value='0'/></inertial>"])
def test_a_moving_link_without_mass_gets_a_small_one_and_it_is_told(inertial):
    bare = f"<link name='b'>{inertial}{SHAPE}</link>"
    model = read_urdf(robot(link("a", mass=5.0), bare, joint("j", "continuous", "a", "b")))
    assert model.mass == pytest.approx(5.1)
    assert model.warnings == (
        "urdf:3: <link> 'b' moves but neither it nor a link fixed to it has a mass; its mass is set to 0.1 kg, add"
        " <inertial> if it is heavier",
    )


def test_a_small_moving_link_weighs_what_its_shape_does():
    bare = f"<link name='b'>{BALL.format(radius=0.01)}</link>"
    model = read_urdf(robot(link("a", mass=5.0), bare, joint("j", "continuous", "a", "b")))
    assert model.links["b"].inertial.mass == pytest.approx(4.0 / 3.0 * 3.141592653589793 * 1e-3, rel=1e-9)


def test_a_base_without_mass_gets_a_small_one():
    model = read_urdf(robot(BARE, link("a", mass=1.0), joint("j", "continuous", "b", "a")))
    assert model.links["b"].inertial.mass == 0.1
    frame = read_urdf(robot("<link name='b'/>", link("a", mass=1.0), joint("j", "continuous", "b", "a")))
    assert frame.mass == 1.0


def test_a_file_without_any_mass_gets_those_of_its_shapes():
    model = read_urdf(robot(f"<link name='a'>{SHAPE}</link>", BARE, joint("j", "fixed", "a", "b")))
    assert model.mass == pytest.approx(2.0 * 33.51, rel=1e-3)
    assert len(model.warnings) == 2
    assert "has no inertial, like all links of the file; mass 33.5 kg" in model.warnings[0]


@pytest.mark.parametrize("name", ROBOTS)
def test_real_robots_weigh_what_their_file_says(urdf, name):
    values = [float(mass.get("value")) for mass in ElementTree.parse(urdf / name).iter("mass")]
    if not sum(values):
        return
    model = read_urdf(urdf / name, colliders="hull")
    told = [text for text in model.warnings if "its mass is set to" in text]
    assert model.mass == pytest.approx(sum(values), abs=0.101 * len(told), rel=1e-9)
