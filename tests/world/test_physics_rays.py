"""Rays of sensors in the physics world, against MuJoCo's own rays on the same bodies, and against skins."""

import mujoco
import numpy as np
import pytest
from physics_worlds import alone, crowded

from crowdbot.core import InputError, Pose, Scene, SpatialPose, Twist
from crowdbot.models import ORCA
from crowdbot.sensors.beams import sort_beams, unit_vectors
from crowdbot.sensors.ray_casting import cast_rays
from crowdbot.world import Chair, Cube, PeopleMotion, PhysicsStage, PhysicsWorld, Robot, Table, Tree, scene_bodies

FAR = 60.0
ROOM = [[(-7.0, -7.0), (-7.0, 7.0), (7.0, 7.0), (7.0, -7.0)], [(3.0, 3.0), (5.0, 3.0), (5.0, 4.0), (3.0, 4.0)]]


@pytest.fixture(scope="module")
def world():
    """People who have bodies near a robot, walls and props; some of it was pushed."""
    robot = Robot.load("cuybot")
    scene = crowded(12, robot, seed=3, size=5.0)
    scene = scene.replace(walls=Scene.of([[0.0, 0.0]], walls=ROOM).walls)
    stage = PhysicsStage(
        props=(
            Cube(1.2, 0.0),
            Table(-4.0, 4.0, heading=0.4),
            Cube(-3.0, -4.0, fixed=True, heading=0.3),
            Chair(-2.5, 3.0, heading=1.0),
        )
    )
    made = PhysicsWorld(scene, ORCA(), {12: robot}, 0.1, stage=stage)
    for _ in range(15):
        made.step({12: Twist(0.5, 0.1)})
    return made


def theirs(world, pose, directions, groups=(1, 0, 0, 1, 1, 0)):
    """Return distances ``[R]`` and names of what MuJoCo's rays meet, without what only is looked at."""
    mujoco.mj_forward(world.engine_model, world.data)
    group = np.array(groups, dtype=np.uint8)  # 0 is the stage, 3 colliders of robots, 4 people
    distance, names, which = np.full(len(directions), np.inf), [], np.zeros(1, np.int32)
    for k, way in enumerate(directions @ pose.matrix[0].T):  # mj_multiRay takes limbs to be where they were compiled
        found = mujoco.mj_ray(world.engine_model, world.data, pose.position[0], way, group, 1, -1, which)
        distance[k] = found if which[0] >= 0 else np.inf
        names.append(world.engine_model.geom(which[0]).name if which[0] >= 0 else "")
    return distance, names


def embodied(world):
    """Return the scene with only those people whose bodies the engine knows now, where they are in it."""
    agents = world._people_bodies.agent
    known = np.isin(np.arange(world.scene.shape[1]), agents[agents >= 0]) | world.scene.external[0]
    return world.body_scene().replace(active=world.scene.active & known[None])


@pytest.mark.parametrize("height", [0.15, 0.45, 1.1])
def test_rays_equal_mujocos_on_people_walls_and_props(world, height):
    """To 1e-9 on limbs, walls, floor and boxes; the engine gets the limbs of the walk, not those that lag behind."""
    scene = embodied(world)
    assert scene.active[0].sum() > 5
    slots = np.flatnonzero(world._people_bodies.agent >= 0)
    held = world._people_bodies  # limbs of who was touched lag behind the walk, so the engine gets the walk
    place = scene.position[0, held.agent[slots]]
    held._fresh[slots], held._late[slots] = True, False
    ends = world.people.ends[world.people.row[held.agent[slots]]]
    held._move(slots, ends - np.tile(np.column_stack([place, np.zeros(len(place))]), 2)[:, None])
    held.install(world.engine_model)
    for axis in (0, 1):
        world.data.qpos[held._place[slots] + axis] = place[:, axis]
    pose = SpatialPose.of((-0.9, 0.7, height), 0.02, 0.05, 0.3)
    azimuth = np.linspace(-np.pi, np.pi, 400, endpoint=False)
    directions = unit_vectors(azimuth[None], np.radians(np.linspace(-25.0, 20.0, 12))[:, None]).reshape(-1, 3)
    other, names = theirs(world, pose, directions)
    ours = cast_rays(scene.without(12), pose, sort_beams(directions), FAR)
    robot = np.array([name.startswith("robot") for name in names])
    same = ~robot
    assert np.mean(same) > 0.8
    both = same & np.isfinite(other) & np.isfinite(ours.distance[0])
    error = np.abs(ours.distance[0][both] - other[both])
    assert np.array_equal(np.isfinite(ours.distance[0][same]), np.isfinite(other[same]))
    assert error.max() < 1e-9
    kinds = {-2: "wall", -3: "floor", -4: "prop"}
    hits = ours.hit[0]
    agree = [names[k].startswith(kinds.get(int(hits[k]), "person")) for k in np.flatnonzero(same & np.isfinite(other))]
    assert all(agree)
    for kind in ("person", "wall/", "floor", "prop0"):
        assert any(name.startswith(kind) for name in names), kind


def test_the_robot_is_met_where_its_colliders_are(world):
    """Boxes to 1e-6; wheels are boxes for rays, so that they may be met a little earlier."""
    scene = embodied(world)
    empty = scene.replace(active=scene.external.copy())
    x, y = scene.position[0, 12]
    for angle in np.linspace(0.0, 2.0 * np.pi, 9)[:-1]:
        pose = SpatialPose.of((x + 1.5 * np.cos(angle), y + 1.5 * np.sin(angle), 0.6), yaw=angle + np.pi)
        directions = unit_vectors(np.linspace(-0.2, 0.2, 21))
        ours = cast_rays(empty, pose, sort_beams(directions), FAR)
        other, names = theirs(world, pose, directions, (1, 0, 0, 1, 0, 0))
        column = np.array([name.startswith("robot12/column") for name in names])
        assert column.any()
        assert np.abs(ours.distance[0] - other)[column & (ours.hit[0] == 12)].max() < 1e-6
        assert np.mean(ours.hit[0][column] == 12) > 0.9


def test_skins_and_capsules_are_within_5_cm_of_each_other():
    """On bodies in mid-stride, in the mean over the rays that meet both."""
    scene = Scene.of(
        [[2.0, 0.0], [0.0, 2.0], [-2.0, 0.3], [0.4, -2.2]], velocity=[[0.0, 1.2], [1.0, 0.0], [0.5, 0.9], [0.0, 0.0]],
        heading=[1.57, 0.0, 1.0, 0.0],
    )  # fmt: skip
    motion = PeopleMotion(scene, np.arange(4), seed=5)
    for _ in range(7):
        scene = scene.replace(position=scene.position + 0.1 * scene.velocity)
        motion.walk(scene, 0.1)
    seen = scene.replace(bodies=scene_bodies(scene, motion, skins=0))
    pose = SpatialPose.of((0.0, 0.0, 1.0))
    directions = unit_vectors(np.linspace(-np.pi, np.pi, 720)[None], np.radians(np.linspace(-40.0, 30.0, 60))[:, None])
    flat = sort_beams(directions.reshape(-1, 3))
    round_, true = cast_rays(seen, pose, flat, 20.0), cast_rays(seen, pose, flat, 20.0, skins=True)
    both = (round_.hit >= 0) & (round_.hit == true.hit)
    assert both.sum() > 2000
    assert set(round_.hit[both]) == {0, 1, 2, 3}
    gap = round_.distance[both] - true.distance[both]
    assert np.abs(gap).mean() < 0.05
    assert abs(gap.mean()) < 0.02
    either = (round_.hit >= 0) | (true.hit >= 0)
    assert both.sum() / either.sum() > 0.8


def test_trees_and_robots_of_all_kinds_have_bodies():
    stage = PhysicsStage(props=(Tree(3.0, 0.0, height=4.0, crown=1.0),))
    for name in ("pepper", "qolo", "wheelchair", "turtlebot2", "differential"):
        world = alone(Robot.load(name), stage=stage)
        seen = world.body_scene()
        pose = SpatialPose.of((-3.0, 0.0, 0.15 if name != "turtlebot2" else 0.06))
        hits = cast_rays(seen, pose, sort_beams(unit_vectors(np.linspace(-0.5, 0.5, 101))), FAR)
        assert 0 in hits.hit
        away = hits.distance[0][hits.hit[0] == 0].min()
        assert away == pytest.approx(3.0 - world.robot_bodies[0].robot.radius, abs=0.35)
        trunk = cast_rays(seen.without(0), pose, sort_beams(unit_vectors(np.zeros(1))), FAR)
        assert trunk.hit.tolist() == [[-4]]
        assert trunk.distance[0, 0] == pytest.approx(6.0 - 0.15, abs=1e-9)
    crown = SpatialPose.of((0.0, 0.0, 3.2))
    leaves = cast_rays(seen.without(0), crown, sort_beams(unit_vectors(np.zeros(1))), FAR)
    assert leaves.distance[0, 0] == pytest.approx(2.0, abs=0.06)


def test_bodies_follow_the_scene_in_the_plane():
    robot = Robot.load("turtlebot2")
    scene = Scene.of([[1.0, 2.0], [4.0, 0.0]], heading=[0.5, 0.0], external=[True, False])
    motion = PeopleMotion(scene, np.array([1]))
    found = scene_bodies(scene, motion, {0: robot})
    assert found.parts[found.part[0]] == "pelvis"
    assert found.post_foot[0, :, :2].mean(axis=0) == pytest.approx([1.0, 2.0], abs=0.1)
    gone = scene_bodies(scene.without(1), motion, {0: robot}, skins=2)
    assert np.all(gone.radius[0, gone.owner == 1] == 0.0)
    assert np.all(np.isnan(gone.skins.vertices))
    own = cast_rays(
        scene.replace(bodies=found).without(0),
        Pose.of((1.0, 2.0), 0.0).to_spatial(0.1),
        sort_beams(unit_vectors(np.zeros(8))),
        9.0,
    )
    assert 0 not in own.hit
    moved = scene_bodies(scene, None, {0: Robot.load("pepper")}, joints={0: {"HeadYaw": 1.0}})
    assert not np.array_equal(moved.start, scene_bodies(scene, None, {0: Robot.load("pepper")}).start)
    with pytest.raises(InputError, match="the scene has 2 environments; give one"):
        scene_bodies(scene.environments([0, 0]), motion)
