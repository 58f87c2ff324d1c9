"""Robots with the quirks of vendors' packages: what the import makes of them, and how they drive."""

from __future__ import annotations

from pathlib import Path

import pytest
from physics_worlds import alone, assert_drives_as_asked
from vendor_texts import VENDORS, write_vendor

from crowdbot.benchmark.drives.laboratory import maker_robot
from crowdbot.core import Twist
from crowdbot.world import import_robot
from crowdbot.world.physics.engine_models import rests_on_castors


@pytest.mark.parametrize("name", VENDORS)
def test_base_and_mass_are_those_of_the_file(tmp_path: Path, name: str) -> None:
    made = import_robot(write_vendor(tmp_path, name), name)
    assert made.kind == VENDORS[name][1]
    assert made.mass == pytest.approx(VENDORS[name][2])


@pytest.mark.parametrize("name", VENDORS)
def test_a_robot_of_a_vendor_drives_as_asked(tmp_path: Path, name: str) -> None:
    assert_drives_as_asked(write_vendor(tmp_path, name))


def test_wheels_whose_meshes_are_missing_get_the_radius_of_the_plugin(tmp_path: Path) -> None:
    made = import_robot(write_vendor(tmp_path, "delivery"), "r")
    rows = {guess.what: guess for guess in made.guesses}
    assert rows["physics world"].value == "wheels"
    assert rows["radius of front_left_wheel_link"].value == "0.165 m"
    assert rows["track"].value == "0.58 m"
    assert made.texts["r.urdf"].count('radius="0.165"') == 4


def test_wheels_at_angles_get_no_shapes(urdf: Path) -> None:
    """The wheels of Pepper have no readable meshes and stand at angles: its base is moved directly."""
    made = import_robot(urdf / "pepper/pepper.urdf", "r")
    assert not any(guess.what.startswith("radius of Wheel") for guess in made.guesses)
    assert 'base="planar"' in made.texts["robot.xml"]


def test_swivel_castors_at_both_ends_leave_weight_on_the_wheels(tmp_path: Path) -> None:
    with maker_robot(write_vendor(tmp_path, "hospital")) as (robot, _):
        world = alone(robot, dt=0.02, physics_dt=0.005)
        body = world.robot_body(0)
        assert rests_on_castors(body._model, body.prefix, robot)
        for _ in range(25):
            world.step({0: Twist()})
        assert body.tilt < 0.01
        model, data = body._model, body._data
        wheels = {int(model.joint(body.prefix + wheel.joint).id) for wheel in robot.wheels}
        geoms = [g for g in range(model.ngeom) if int(model.body_jntadr[model.geom_bodyid[g]]) in wheels]
        held = sum(
            float(data.efc_force[data.contact.efc_address[c]])
            for c in range(data.ncon)
            if set(data.contact.geom[c].tolist()) & set(geoms)
        )
    assert held > 0.5 * 9.81 * robot.model.mass
