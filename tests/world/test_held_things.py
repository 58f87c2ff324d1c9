"""Things that people hold and push, as rays of sensors meet them."""

import math

import numpy as np
import pytest

from crowdbot.core import Scene, SpatialPose
from crowdbot.humans import People, shapes
from crowdbot.sensors import Lidar2D, Lidar3D
from crowdbot.sensors.view import SensorView
from crowdbot.world import PeopleMotion, scene_bodies
from crowdbot.world.rendering.carried_objects import TYRE, bag_of, carried_parts

SPEED = np.array([[1.0, 0.0]])


def pushing(activity, steps=60, active=True):
    """Return a scene with one person, who has an activity and walks along x to the origin, with bodies."""
    scene = Scene.of([[-0.02 * steps, 0.0]], velocity=SPEED, active=[active])
    motion = PeopleMotion(scene, np.array([0]), People.of(["woman-36"], variation=3))
    motion.begin(scene, activity)
    for k in range(steps):
        scene = scene.replace(position=np.array([[[-0.02 * (steps - 1 - k), 0.0]]]))
        motion.walk(scene, 0.02)
    return scene, scene_bodies(scene, motion)


def nearest(bodies, height):
    """Return the smallest x distance of a level scan from ahead at a height, and who is there."""
    scene = Scene.of([[0.0, 0.0]]).replace(bodies=bodies)
    lidar = Lidar2D(rays=721, field_of_view=math.radians(60.0), range_max=10.0)
    pose = SpatialPose.of((5.0, 0.0, height), yaw=math.pi)
    reading, _ = lidar.measure(SensorView(scene, pose), lidar.begin(), np.random.default_rng(0))
    k = int(np.nanargmin(reading.ranges[0]))
    return 5.0 - float(reading.ranges[0, k]), int(reading.hit[0, k])


@pytest.mark.parametrize(("activity", "ahead"), [("pram", 0.75), ("wheelchair", 0.6)])
def test_a_scanner_sees_what_is_pushed_before_the_person(activity, ahead):
    _, bodies = pushing(activity)
    place, who = nearest(bodies, 0.5)
    assert place > ahead
    assert who == 0
    place, _ = nearest(pushing("walk")[1], 0.5)
    assert place < 0.5


def test_a_parcel_is_seen_before_the_chest():
    carried, _ = nearest(pushing("carry")[1], 0.95)
    plain, _ = nearest(pushing("walk")[1], 0.95)
    assert carried > plain + 0.1


def test_who_is_absent_holds_nothing():
    _, bodies = pushing("pram", steps=5, active=False)
    assert len(bodies.box_owner) == 0
    assert np.all(bodies.radius == 0.0)


def test_walking_people_have_their_limbs_only():
    _, bodies = pushing("walk")
    assert bodies.start.shape[1] == 17
    assert len(bodies.box_owner) == len(bodies.post_owner) == 0


def test_a_chair_stands_under_who_sits():
    scene = Scene.of([[0.0, 0.0]])
    motion = PeopleMotion(scene, np.array([0]), People.of(["man-32"]))
    motion.begin(scene, "sit")
    bodies = scene_bodies(scene, motion)
    assert len(bodies.box_owner) == 6
    assert bodies.box_centre[0, :, 2].min() == pytest.approx(0.21, abs=0.05)
    lidar = Lidar3D(columns=360)
    pose = SpatialPose.of((-3.0, 0.0, 0.3))
    reading, _ = lidar.measure(SensorView(scene.replace(bodies=bodies), pose), lidar.begin(), np.random.default_rng(0))
    assert np.count_nonzero(reading.hit == 0) > 50


def test_a_phone_lies_along_the_cheek_of_who_calls():
    scene = Scene.of([[0.0, 0.0]])
    motion = PeopleMotion(scene, np.array([0]), People.of(["man-44"], variation=2))
    motion.begin(scene, "phone")
    bodies = scene_bodies(scene, motion)
    phone = bodies.box_centre[0, 0] - motion.posture().position[0, shapes().bone("head")]
    assert abs(phone[0] - 0.07) < 0.07
    assert -0.16 < phone[1] < -0.06
    assert abs(phone[2]) < 0.07
    w, x, y, z = bodies.box_turn[0, 0]
    assert abs(2.0 * (y * z - w * x)) > 0.9  # the back of the phone looks aside
    assert 2.0 * (x * z - w * y) < -0.5  # and its lower end down


@pytest.mark.parametrize(("activity", "radius", "wheels"), [("pram", 0.14, 4), ("wheelchair", 0.30, 4)])
def test_wheels_are_rings_with_spokes_and_stand_on_the_floor(activity, radius, wheels):
    scene = Scene.of([[0.0, 0.0]])
    motion = PeopleMotion(scene, np.array([0]), People.of(["woman-36"]))
    motion.begin(scene, activity)
    state = motion.state
    parts = carried_parts(motion.people, motion.posture(), state.yaw, state.blend, 0, False)
    tyres = [part for part in parts if part.shape.solid.kind == "cylinder" and part.shape.solid.size[1] == TYRE]
    assert len(tyres) == wheels
    assert max(part.shape.solid.size[0] for part in tyres) == radius
    for part in tyres:
        corner = part.mesh.corner.reshape(-1, 3)
        far = np.hypot(*corner.T[:2])
        assert far.min() > part.shape.solid.size[0] - 2.0 * TYRE - 1e-9
        assert far.max() == pytest.approx(part.shape.solid.size[0])
        assert (corner @ part.turn.T + part.place)[:, 2].min() == pytest.approx(0.0, abs=0.01)
        across = np.cross(
            part.mesh.corner[:, 1] - part.mesh.corner[:, 0], part.mesh.corner[:, 2] - part.mesh.corner[:, 0]
        )
        assert np.all(np.einsum("ni,ni->n", across, part.mesh.normal[:, 0]) > 0.0)


def test_the_strap_of_a_handbag_lies_over_the_shoulder():
    people = People.of(["woman-36"], variation=next(
        k for k in range(100) if bag_of(People.of(["woman-36"], variation=k), 0) == "handbag"))  # fmt: skip
    scene = Scene.of([[0.0, 0.0]])
    motion = PeopleMotion(scene, np.array([0]), people)
    motion.begin(scene, "walk")
    state, posture = motion.state, motion.posture()
    parts = carried_parts(people, posture, state.yaw, state.blend, 0, False)
    strap = np.concatenate([p.mesh.corner.reshape(-1, 3) @ p.turn.T + p.place for p in parts[1:]])
    skin = people.skin(posture, 0)[0, shapes().levels[0].vertex_region == shapes().regions.index("top")]
    top = strap[strap[:, 2].argmax()]
    near = skin[np.linalg.norm(skin[:, :2] - top[:2], axis=1) < 0.03]
    assert 0.0 < top[2] - near[:, 2].max() < 0.04


def test_a_pram_has_a_tub_that_is_open_above_and_a_hood_ahead():
    scene = Scene.of([[0.0, 0.0]])
    motion = PeopleMotion(scene, np.array([0]), People.of(["woman-36"]))
    motion.begin(scene, "pram")
    parts = carried_parts(motion.people, motion.posture(), motion.state.yaw, motion.state.blend, 0, False)
    tub, hood = (part for part in parts if not part.mesh.closed)
    low, high = ((part.mesh.corner.reshape(-1, 3) @ part.turn.T + part.place).mean(axis=0) for part in (tub, hood))
    assert high[0] > low[0] + 0.1
    assert high[2] > low[2] + 0.1
    assert np.all(np.einsum("tci,tci->tc", tub.mesh.normal, tub.mesh.corner - [0.0, 0.0, 0.12]) > 0.0)
    assert np.all(np.einsum("tci,tci->tc", hood.mesh.normal, hood.mesh.corner) > 0.0)
