"""Images of the physics world: colours, metric depth and who is where in them."""

import gc
import math

import numpy as np
import pytest
from physics_worlds import alone, facing

from crowdbot.core import InputError, Scene, Twist
from crowdbot.models import ORCA
from crowdbot.world import Cube, PhysicsStage, PhysicsWorld, Robot, SceneCamera
from crowdbot.world.rendering import gl_context


@pytest.fixture(scope="module")
def world():
    scene = Scene.of(
        [[0.0, 0.0], [3.0, 0.0], [3.0, 1.5]], heading=[0.0, math.pi, 0.0], external=[True, False, False],
        goal=[[0.0, 0.0], [3.0, 0.0], [3.0, 1.5]], walls=[[(5.0, -3.0), (5.0, 3.0)]], active=[True, True, False],
    )  # fmt: skip
    stage = PhysicsStage(props=(Cube(3.0, -1.0, size=0.4),), wall_height=2.5)
    return PhysicsWorld(scene, ORCA(), {0: Robot.load("turtlebot2")}, 0.1, stage=stage)


@pytest.mark.usefixtures("drawing")
def test_depth_is_metric_and_everyone_is_named(world):
    camera = SceneCamera((0.0, 0.0, 1.0), (1.0, 0.0, 1.0), width=160, height=120, view=math.radians(60.0))
    seen = world.render(camera, rgb=True, depth=True, segmentation=True)
    assert seen.rgb.shape == (120, 160, 3)
    assert seen.rgb.dtype == np.uint8
    assert set(np.unique(seen.segmentation)) == {-4, -3, -2, -1, 1}
    up = (59.5 - np.arange(120)) / (60.0 / math.tan(0.5 * camera.view))
    wall = seen.segmentation == -2
    assert seen.depth[wall] == pytest.approx(4.99, abs=0.005)
    floor = seen.segmentation == -3
    expected = np.broadcast_to((-1.0 / np.minimum(up, -1e-9))[:, None], floor.shape)
    edge = floor & np.roll(floor, 1, 0) & np.roll(floor, -1, 0) & (expected < 20.0)
    assert seen.depth[edge] == pytest.approx(expected[edge], rel=0.01)
    assert np.all(np.isinf(seen.depth[seen.segmentation == -1]))
    person = seen.depth[seen.segmentation == 1]
    assert 2.6 < person.min() < 2.99
    assert person.max() < 3.3
    cube = seen.depth[seen.segmentation == -4]
    assert cube.min() == pytest.approx(2.8, abs=0.02)
    column = np.flatnonzero(np.any(seen.segmentation == -4, axis=0))
    assert column.min() > 80  # it lies to the right


@pytest.mark.usefixtures("drawing")
def test_skins_follow_the_walk_and_the_camera_its_robot(world):
    camera = SceneCamera((0.2, 0.0, 0.4), (1.0, 0.0, 0.5), width=80, height=60, robot=0, detail=2)
    first = world.render(camera, segmentation=True, rgb=False)
    assert first.rgb is None
    assert first.depth is None
    place = world.scene.position.copy()
    place[0, 1] = 3.0, 1.2
    before = world.scene
    world.scene = before.replace(position=place, goal=place)
    world.step({0: Twist()})
    second = world.render(camera, segmentation=True, rgb=False)
    columns = [np.mean(np.argwhere(image.segmentation == 1)[:, 1]) for image in (first, second)]
    assert columns[1] < columns[0] - 10
    world.robot_bodies[0].put(0.0, 0.0, math.pi)
    world.scene = before.replace(heading=np.array([[math.pi, 0.0, 0.0]]))
    world.step({0: Twist()})
    assert 1 not in world.render(camera, segmentation=True, rgb=False).segmentation


@pytest.mark.usefixtures("drawing")
def test_the_same_world_gives_the_same_image():
    def image():
        world = facing(Robot.load("turtlebot2"), gap=1.5)
        return world.render(SceneCamera((-1.0, -1.5, 1.5), (1.0, 0.0, 0.8), width=80, height=60, detail=2)).rgb

    one = image()
    assert np.array_equal(one, image())
    assert one.std() > 10.0


@pytest.mark.usefixtures("drawing")
def test_contexts_are_given_back():
    world = alone(Robot.load("turtlebot2"))
    gc.collect()
    count = len(gl_context.OPEN)
    for detail in (2, 1):
        world.render(SceneCamera((-1.0, -1.5, 1.5), (1.0, 0.0, 0.8), width=8, height=8, detail=detail))
        assert len(gl_context.OPEN) == count + 1
    del world
    gc.collect()
    assert len(gl_context.OPEN) == count


@pytest.mark.usefixtures("drawing")
def test_what_cannot_be_drawn_is_said(world, monkeypatch):
    for wrong, match in (
        ({"width": 0}, "width = 0 pixels must be from 1 to 1920"),
        ({"view": 0.0}, "view = 0.0 rad must be above 0"),
        ({"near": 2.0, "far": 1.0}, "near = 2.0 m must be above 0 and below far = 1.0 m"),
        ({"detail": 3}, "detail = 3 must be 0, 1 or 2"),
        ({"target": (0.0, 0.0, 1.0)}, "must be two different points"),
    ):
        with pytest.raises(InputError, match=match):
            SceneCamera(**({"position": (0.0, 0.0, 1.0), "target": (1.0, 0.0, 1.0)} | wrong))
    with pytest.raises(InputError, match="agent 2 is not a robot"):
        world.render(SceneCamera((0.0, 0.0, 1.0), (1.0, 0.0, 1.0), robot=2))
    with pytest.raises(InputError, match="turtlebot2 has no link 'lasr_link', did you mean 'laser_link'"):
        world.render(SceneCamera((0.0, 0.0, 1.0), (1.0, 0.0, 1.0), robot=0, link="lasr_link"))
    gl_context.backend.cache_clear()
    monkeypatch.setenv("MUJOCO_GL", "pencil")
    with pytest.raises(InputError, match="MUJOCO_GL = 'pencil' must be one of egl, osmesa"):
        gl_context.backend()
    monkeypatch.delenv("MUJOCO_GL")
    monkeypatch.delenv("PYOPENGL_PLATFORM", raising=False)
    monkeypatch.setattr(gl_context, "_works", lambda name: False)
    monkeypatch.setattr(gl_context.sys, "platform", "linux")
    with pytest.raises(InputError, match="neither EGL nor OSMesa works; install one"):
        gl_context.backend()
    gl_context.backend.cache_clear()


def test_a_camera_that_looks_down_has_ahead_on_top():
    place, forward, up = SceneCamera((0.0, 0.0, 3.0), (0.0, 0.0, 0.0)).axes(np.eye(4))
    assert place.tolist() == [0.0, 0.0, 3.0]
    assert forward.tolist() == [0.0, 0.0, -1.0]
    assert up.tolist() == [1.0, 0.0, 0.0]
