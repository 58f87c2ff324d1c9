"""Images of scenes in the plane, and of cameras with a lens."""

import gc
import math
from typing import NamedTuple

import numpy as np
import pytest
from physics_worlds import facing

from crowdbot.core import InputError, Pose, Scene, SpatialPose, Twist
from crowdbot.models import ORCA
from crowdbot.sensors import Lens, RGBCamera
from crowdbot.world import (
    Cube,
    DifferentialDrive,
    PeopleMotion,
    PhysicsStage,
    PlanarWorld,
    Renderer,
    Robot,
    SceneCamera,
)
from crowdbot.world.rendering.visuals import Visuals


def plain(name="turtlebot2"):
    """Return a scene with a robot at the origin, a person ahead and a wall behind, and the robot."""
    scene = Scene.of(
        [[0.0, 0.0], [3.0, 0.0]], heading=[0.0, math.pi], goal=[[0.0, 0.0], [3.0, 4.0]], external=[True, False],
        walls=[[(6.0, -4.0), (6.0, 4.0)]],
    )  # fmt: skip
    return scene, Robot.load(name)


@pytest.mark.usefixtures("drawing")
def test_the_plane_looks_like_the_physics_world():
    """The same scene gives the same image in both, as long as nobody has moved."""
    deep = facing(Robot.load("turtlebot2"), gap=2.0, walls=[[(4.0, -2.0), (4.0, 2.0)]])
    camera = SceneCamera((-1.0, -2.0, 1.5), (1.0, 0.0, 0.8), width=120, height=90, detail=2)
    flat = Renderer(deep.scene, {0: deep.robot_bodies[0].robot}, deep.stage, deep.people)
    one = deep.render(camera, depth=True, segmentation=True)
    other = flat.images(camera, depth=True, segmentation=True)
    assert set(np.unique(one.segmentation)) >= {-3, -2, 0, 1}
    assert np.mean(one.segmentation == other.segmentation) > 0.999
    both = np.isfinite(one.depth) & (one.segmentation == other.segmentation)
    assert np.median(np.abs(one.depth[both] - other.depth[both])) < 1e-3
    assert np.mean(np.abs(one.rgb.astype(int) - other.rgb)) < 1.0


@pytest.mark.usefixtures("drawing")
def test_people_walk_and_robots_drive_in_the_plane():
    scene, robot = plain()
    motion = PeopleMotion(scene, np.array([1]), seed=4)
    renderer = Renderer(scene, {0: robot}, PhysicsStage(props=(Cube(3.0, -2.0),)), motion)
    camera = SceneCamera((0.1, 0.0, 0.6), (1.0, 0.0, 0.7), width=100, height=60, robot=0, detail=2)
    before = renderer.images(camera, rgb=False, segmentation=True).segmentation
    world = PlanarWorld(scene, ORCA(), {0: robot.drive}, 0.1)
    for _ in range(15):
        now = world.step({0: Twist(0.3, 0.0)})
        motion.walk(now, 0.1)
    renderer.show(now)
    after = renderer.images(camera, rgb=False, segmentation=True).segmentation
    columns = [np.mean(np.argwhere(image == 1)[:, 1]) for image in (before, after)]
    assert columns[1] < columns[0] - 10  # the person went to the left
    assert np.count_nonzero(after == -4) > np.count_nonzero(before == -4)  # the robot came nearer
    renderer.show(now.without(1))
    assert 1 not in renderer.images(camera, rgb=False, segmentation=True).segmentation


@pytest.mark.usefixtures("drawing")
def test_joints_move_what_is_drawn():
    scene, robot = plain("pepper")
    renderer = Renderer(scene, {0: robot})
    camera = SceneCamera((0.2, 0.0, 0.1), (1.0, 0.0, 0.1), width=60, height=40, robot=0, link="Head", detail=2)
    straight = renderer.images(camera, rgb=False, segmentation=True).segmentation
    renderer.show(scene, {0: {"HeadYaw": 1.5}})
    aside = renderer.images(camera, rgb=False, segmentation=True).segmentation
    assert 1 in straight
    assert 1 not in aside


@pytest.mark.usefixtures("drawing")
def test_a_robot_of_which_only_the_size_is_known():
    scene, _ = plain()
    puck = Robot.disc("puck", DifferentialDrive(), 0.3, height=0.5)
    assert puck.radius == pytest.approx(0.3, rel=0.01)
    assert puck.height == pytest.approx(0.51)
    renderer = Renderer(scene, {0: puck})
    seen = renderer.images(
        SceneCamera((-3.0, 0.0, 1.0), (0.0, 0.0, 0.3), width=60, height=40), depth=True, segmentation=True
    )
    assert seen.depth[seen.segmentation == 0].min() == pytest.approx(2.7, abs=0.1)
    with pytest.raises(InputError, match=r"Robot.disc: radius = 0.0 must be finite and above 0"):
        Robot.disc("none", DifferentialDrive(), 0.0)


class Optics(NamedTuple):
    """What a studio asks of a camera."""

    lens: Lens
    near: float = 0.05
    far: float = 100.0


@pytest.mark.usefixtures("drawing")
@pytest.mark.parametrize("cx", [39.5, 10.0])
def test_a_lens_puts_points_where_it_should(cx):
    """A cube is drawn where the intrinsics say, also with a principal point that is not in the middle."""
    scene = Scene.of([[0.0, 0.0]], external=[True])
    stage = PhysicsStage(props=(Cube(2.1, -0.4, size=0.2),))
    renderer = Renderer(scene, {0: Robot.load("turtlebot2")}, stage)
    lens = Lens(80, 60, 50.0, 45.0, cx, 20.0)
    camera = Optics(lens)
    pose = SpatialPose.of((0.0, 0.0, 0.5), 0.0, 0.1, 0.05)
    seen = renderer.render(camera, pose)
    assert seen["rgb"].shape == (1, 60, 80, 3)
    points = np.array([[2.0, y, z] for y in (-0.5, -0.3) for z in (0.01, 0.2)]) - pose.position
    x, y, z = (points @ pose.matrix[0]).T
    column, row = lens.fx * -y / x + lens.cx, lens.fy * -z / x + lens.cy
    found = np.argwhere(seen["hit"][0] == -4)
    assert found[:, 1].min() == pytest.approx(column.min(), abs=1.0)
    assert found[:, 0].max() == pytest.approx(row.max(), abs=1.5)
    front = seen["depth"][0][seen["hit"][0] == -4]
    assert front.min() == pytest.approx(x.min(), abs=0.02)
    own = RGBCamera(width=80, height=60)
    np.testing.assert_array_equal(own.read(scene, pose, renderer=renderer).rgb, renderer.render(own, pose)["rgb"])


@pytest.mark.usefixtures("drawing")
def test_the_pose_of_a_sensor_in_both_worlds():
    world = facing(Robot.load("qolo"), gap=3.0)
    robot = world.robot_bodies[0].robot
    for mount in robot.mounts:
        flat = robot.sensor_pose(mount.name, world.pose(0))
        deep = world.robot_bodies[0].sensor_pose(mount.name)
        assert flat.position == pytest.approx(deep.position, abs=2e-3)
        assert flat.matrix == pytest.approx(deep.matrix, abs=2e-3)
    assert robot.sensor_pose(robot.mounts[0].name, Pose(np.zeros((3, 2)), np.arange(3.0))).position.shape == (3, 3)


def test_what_cannot_be_shown_is_said():
    scene, robot = plain()
    with pytest.raises(InputError, match="the scene has 2 environments; give one"):
        Renderer(scene.environments([0, 0]), {0: robot})
    with pytest.raises(InputError, match="agent 7 is not in the scene, which has 2 agents"):
        Renderer(scene, {7: robot})
    renderer = Renderer(scene, {0: robot})
    with pytest.raises(InputError, match="the scene has 1 agents, expected 2"):
        renderer.show(Scene.of([[0.0, 0.0]]))
    with pytest.raises(InputError, match="the pose has 2 environments"):
        renderer.render(Optics(Lens.of(8, 8, 1.0)), SpatialPose.of([[0.0, 0.0, 1.0]] * 2))
    with pytest.raises(InputError, match="width = 5000 pixels must be from 1 to 1920"):
        renderer.render(Optics(Lens.of(5000, 8, 1.0)), SpatialPose.of((0.0, 0.0, 1.0)))


@pytest.mark.usefixtures("drawing")
def test_a_renderer_that_is_freed_while_another_draws_does_not_change_its_image(monkeypatch):
    """The garbage collector frees renderers at any time, between any two lines of another one."""
    scene, robot = plain()
    camera = SceneCamera((0.1, 0.0, 0.6), (1.0, 0.0, 0.7), width=100, height=60, robot=0, detail=2)
    renderer = Renderer(scene, {0: robot})
    expected = renderer.images(camera, depth=True)
    freed = [Renderer(scene, {0: robot})]
    freed[0].images(camera)
    arrange = Visuals._arranged

    def free_and_arrange(self, view, active):
        freed.clear()
        gc.collect()
        return arrange(self, view, active)

    monkeypatch.setattr(Visuals, "_arranged", free_and_arrange)
    images = renderer.images(camera, depth=True)
    assert len(freed) == 0
    np.testing.assert_array_equal(images.depth, expected.depth)
    np.testing.assert_array_equal(images.rgb, expected.rgb)
