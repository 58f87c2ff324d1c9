"""Things that people hold and push, as rays of sensors meet them."""

import math

import numpy as np
import pytest

from crowdbot.core import Scene, SpatialPose
from crowdbot.humans import People
from crowdbot.sensors import Lidar2D, Lidar3D
from crowdbot.sensors.view import SensorView
from crowdbot.world import PeopleMotion, scene_bodies

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
