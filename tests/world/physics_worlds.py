"""Small physics worlds that tests share."""

import math

import numpy as np

from crowdbot.benchmark import measure_drives
from crowdbot.core import Scene
from crowdbot.humans import People
from crowdbot.models import ORCA
from crowdbot.world import Omnidirectional, PhysicsWorld, Robot, read_urdf


def ram(mass, height, push=None):
    """Return a robot that is a beam across at a height, pulled along the floor."""
    inertial = (
        f"<inertial><origin xyz='0 0 {height}'/><mass value='{mass}'/>"
        "<inertia ixx='5' iyy='5' izz='5' ixy='0' ixz='0' iyz='0'/></inertial>"
    )
    beam = f"<collision><origin xyz='0.3 0 {height}'/><geometry><box size='0.1 0.6 0.1'/></geometry></collision>"
    text = f"<robot name='ram'><link name='base'>{inertial}{beam}</link></robot>"
    drive = Omnidirectional(max_speed=5.0, max_turn_rate=1.0, max_acceleration=100.0, max_turn_acceleration=10.0)
    return Robot("ram", read_urdf(text), drive, base="planar")


def assert_drives_as_asked(file):
    """Import the robot of a maker and check that it drives as it is asked to."""
    grid = measure_drives([], steps=[0.005], quick=True, makers=[file]).makers[0].grid
    assert grid.overshoot <= 0.05
    assert grid.steady_error <= 0.05
    assert grid.path_error <= 0.05
    assert grid.acceleration <= 1.1
    assert grid.turn_acceleration <= 1.1
    assert not grid.fallen


def facing(robot, gap=1.0, heading=math.pi, walls=(), who="man-20", **options):
    """Return a world with a robot at the origin and one person ahead of it, who stands and does not step aside."""
    place = [[0.0, 0.0], [gap, 0.0]]
    scene = Scene.of(
        place, goal=place, heading=[0.0, heading], external=[True, False], radius=[robot.radius, 0.25],
        preferred_speed=[1.0, 0.0], max_speed=[1.0, 0.0], walls=walls,
    )  # fmt: skip
    return PhysicsWorld(scene, ORCA(), {0: robot}, **({"dt": 0.02, "people": People.of([who])} | options))


def alone(robot, walls=(), **options):
    """Return a world with a robot only."""
    scene = Scene.of([[0.0, 0.0]], heading=[0.0], external=[True], radius=[robot.radius], walls=walls)
    return PhysicsWorld(scene, ORCA(), {0: robot}, **({"dt": 0.05} | options))


def coasting(world):
    """Switch the motors of the base off."""
    world.engine_model.actuator_gainprm[:] = 0.0
    world.engine_model.actuator_biasprm[:] = 0.0


def crowded(count, robot, seed=0, size=12.0):
    """Return a scene of people on a square who walk to and fro, with a robot in the middle as the last agent."""
    from crowdbot.core import stream

    draw = stream(seed, "crowded")
    side = int(np.ceil(np.sqrt(count)))
    grid = np.stack(np.meshgrid(np.arange(side), np.arange(side)), axis=-1).reshape(-1, 2)[:count]
    place = (grid + 0.5) / side * size - 0.5 * size + draw.uniform(-0.1, 0.1, (count, 2))
    goal = draw.uniform(-0.5 * size, 0.5 * size, (count, 2))
    here = np.hypot(*place.T) > robot.radius + 0.5
    return Scene.of(
        np.vstack([place, [0.0, 0.0]]), goal=np.vstack([goal, [0.0, 0.0]]), active=np.append(here, True),
        radius=np.append(np.full(count, 0.25), robot.radius), external=np.append(np.zeros(count, dtype=bool), True),
        max_speed=1.8,
    )  # fmt: skip
